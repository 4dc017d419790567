"""Properties of vertices: arrays with one row a vertex."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array
from .errors import ArgumentError

Properties = dict[str, NDArray[Any]]


def as_property(name: str, values: Any, count: int, of: str = "vertex") -> NDArray[Any]:
    """Returns an array of one row a vertex, of any type."""
    array = as_array(values)
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
        flat = values.reshape(len(values), -1)
        for k in range(flat.shape[1]):
            out[name if values.ndim == 1 else f"{name}_{k}"] = _scalar(flat[:, k], name)
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
