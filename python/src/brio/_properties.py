"""Properties of vertices: arrays with one row a vertex."""

from collections.abc import Mapping
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array, as_text
from .errors import ArgumentError

Properties = dict[str, NDArray[Any]]


def _rows(name: str, values: Any, count: int, of: str) -> NDArray[Any]:
    array = as_array(values, name)
    if array.ndim == 0 or len(array) != count:
        raise ArgumentError(f"{name}: one row a {of} is wanted, {count}, not an array of shape {array.shape}")
    return array


def as_properties(properties: Any, count: int, what: str = "property", of: str = "vertex") -> Properties:
    """Takes a dict of arrays of any type, each of one row a vertex."""
    if not isinstance(properties, Mapping):
        raise ArgumentError(f"{what}: a dict of arrays is wanted, not {type(properties).__name__}")
    for name in properties:
        as_text(name, f"{what}: its name")
    return {name: _rows(f"{what} {name}", values, count, of) for name, values in properties.items()}


def carry(source: Properties, rows: NDArray[Any], to: Properties) -> None:
    """Adds rows of properties to others. A name that is taken becomes input_NAME, or input_NAME_2 and so on."""
    for name, values in source.items():
        free, n = name, 1
        while free in to:
            free, n = (f"input_{name}", 2) if n == 1 else (f"input_{name}_{n}", n + 1)
        to[free] = values[rows]


def scalars(properties: Properties) -> Properties:
    """Properties as files take them: one number each, of a type of PLY. Rows of numbers become several properties."""
    out: Properties = {}
    for name, values in properties.items():
        flat = values.reshape(len(values), prod(values.shape[1:]))
        for k in range(flat.shape[1]):
            single = name if values.ndim == 1 else f"{name}_{k}"
            if single in out:
                raise ArgumentError(f"properties: two of them would be {single} in a file")
            out[single] = _scalar(flat[:, k], name)
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


# --- colours and normals ---

_COLORS = (("red", "green", "blue", "alpha"), ("r", "g", "b", "a"), ("diffuse_red", "diffuse_green", "diffuse_blue", "alpha"))
_COLOR_ROWS = ("color", "colour", "colors", "colours", "rgb", "rgba")
_NORMALS = ("nx", "ny", "nz")
_NORMAL_ROWS = ("normal", "normals")


def _stacked(properties: Properties, names: tuple[str, ...]) -> NDArray[Any] | None:
    """Returns properties of one number each as columns, if all are there; their names in any case."""
    lower = {name.lower(): values for name, values in properties.items()}
    found = [lower[name] for name in names if name in lower and lower[name].ndim == 1]
    return np.stack(found, axis=1) if len(found) == len(names) else None


def _rows_of(properties: Properties, names: tuple[str, ...], columns: tuple[int, ...]) -> NDArray[Any] | None:
    for name, values in properties.items():
        if name.lower() in names and values.ndim == 2 and values.shape[1] in columns:
            return values
    return None


def _numbers(rows: NDArray[Any] | None) -> NDArray[Any] | None:
    return rows if rows is not None and rows.dtype.kind in "iuf" else None


def colors_of(properties: Properties) -> NDArray[np.float64] | None:
    """Returns colours as rows of 3 or 4 numbers from 0 to 1, or None."""
    rows = None
    for names in _COLORS:
        if rows is None:
            rows = _numbers(_stacked(properties, names))
        if rows is None:
            rows = _numbers(_stacked(properties, names[:3]))
    if rows is None:
        rows = _numbers(_rows_of(properties, _COLOR_ROWS, (3, 4)))
    if rows is None:
        return None
    floats = rows.astype(np.float64)
    if rows.dtype.kind != "f":
        floats /= 255 if rows.dtype.itemsize == 1 or floats.max(initial=0) <= 255 else 65535
    return np.clip(np.nan_to_num(floats), 0, 1)


def normals_of(properties: Properties) -> NDArray[np.float64] | None:
    """Returns the normals among properties, as rows, or None."""
    rows = _numbers(_stacked(properties, _NORMALS))
    if rows is None:
        rows = _numbers(_rows_of(properties, _NORMAL_ROWS, (3,)))
    return None if rows is None else np.ascontiguousarray(rows, np.float64)


# --- numbers as files have them ---


def _scalar(column: NDArray[Any], name: str) -> NDArray[Any]:
    """Returns one number a vertex, of a type that files have, with the same values."""
    if column.dtype.kind == "b":
        return np.ascontiguousarray(column, np.uint8)
    if column.dtype.kind not in "iuf":
        raise ArgumentError(f"property {name}: files take numbers, not {column.dtype}")
    if column.dtype.kind == "f" and column.dtype.itemsize == 2:
        return np.ascontiguousarray(column, np.float32)
    if column.dtype.kind in "iu" and column.dtype.itemsize == 8:
        return _without_loss(column, name, [np.int32, np.float64])
    if column.dtype.itemsize > 8:
        return _without_loss(column, name, [np.float64])
    return np.ascontiguousarray(column, column.dtype.newbyteorder("="))


def _without_loss(column: NDArray[Any], name: str, kinds: list[Any]) -> NDArray[Any]:
    """Returns the column in the first of these types that has all its values."""
    with np.errstate(all="ignore"):
        for kind in kinds:
            smaller = column.astype(kind)
            if _are_equal(smaller, column):
                return smaller
    raise ArgumentError(f"property {name}: files would round its {column.dtype}: they take integers of 32 bits, and doubles")


def _are_equal(smaller: NDArray[Any], column: NDArray[Any]) -> bool:
    """Whether converted numbers are what they were."""
    if column.dtype.kind == "f":
        return bool(np.array_equal(smaller, column, equal_nan=True))
    return bool(smaller.tolist() == column.tolist())  # numpy would round integers to compare them with doubles
