"""Properties of vertices: arrays with one row a vertex."""

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array
from .errors import ArgumentError

Properties = dict[str, NDArray[Any]]


def as_property(name: str, values: Any, count: int, of: str = "vertex") -> NDArray[Any]:
    """Returns an array of one row a vertex, of any type."""
    array = as_array(values, name)
    if array.ndim == 0 or len(array) != count:
        raise ArgumentError(f"{name}: one row a {of} is wanted, {count}, not {array.shape}")
    return array


def carry(source: Properties, rows: NDArray[Any], to: Properties) -> None:
    """Adds rows of properties to others. A name that is taken becomes input_NAME, or input_NAME_2 and so on."""
    for name, values in source.items():
        free, n = name, 1
        while free in to:
            free, n = (f"input_{name}", 2) if n == 1 else (f"input_{name}_{n}", n + 1)
        to[free] = values[rows]


def scalars(properties: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Properties as files take them: one number each, of a type of PLY. Rows of numbers become several properties."""
    out: dict[str, NDArray[Any]] = {}
    for name, values in properties.items():
        flat = values.reshape(len(values), prod(values.shape[1:]))
        for k in range(flat.shape[1]):
            out[name if values.ndim == 1 else f"{name}_{k}"] = _scalar(flat[:, k], name)
    return out


def for_means(properties: Properties, count: int) -> Properties:
    """Columns for the library to take means of: those of floating-point properties, and numbers of vertices."""
    out: Properties = {"number": np.arange(count, dtype=np.uint32)}
    for k, values in enumerate(properties.values()):
        if values.dtype.kind == "f":
            flat = values.reshape(len(values), prod(values.shape[1:]))
            for j in range(flat.shape[1]):
                out[f"{k}_{j}"] = np.ascontiguousarray(flat[:, j], np.float32 if values.itemsize <= 4 else np.float64)
    return out


def from_means(columns: Properties, like: Properties) -> Properties:
    """Returns the properties of these columns, which for_means made of `like`: names, types and shapes of rows as in `like`."""
    out: Properties = {}
    rows = columns["number"]
    for k, (name, values) in enumerate(like.items()):
        if values.dtype.kind == "f":
            out[name] = np.empty((len(rows), *values.shape[1:]), values.dtype)
            flat = out[name].reshape(len(rows), prod(values.shape[1:]))
            for j in range(flat.shape[1]):
                flat[:, j] = columns[f"{k}_{j}"]
        else:
            out[name] = values[rows]
    return out


def _scalar(column: NDArray[Any], name: str) -> NDArray[Any]:
    if column.dtype.kind == "b":
        return np.ascontiguousarray(column, np.uint8)
    if column.dtype.kind in "iu" and column.dtype.itemsize == 8:
        small = np.int32 if not len(column) or (-(2**31) <= column.min() and column.max() < 2**31) else np.float64
        return np.ascontiguousarray(column, small)
    if column.dtype.kind == "f" and column.dtype.itemsize == 2:
        return np.ascontiguousarray(column, np.float32)
    if column.dtype.kind not in "iuf":
        raise ArgumentError(f"property {name}: files take numbers, not {column.dtype}")
    return np.ascontiguousarray(column, column.dtype.newbyteorder("="))
