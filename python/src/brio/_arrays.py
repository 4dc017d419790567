"""Arrays of the caller, as the library takes them: C-contiguous, aligned float64 is taken as it is, all else is converted."""

import operator
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import ArgumentError

Floats = NDArray[np.float64]
MOST_TILES = 65536

_MOST_EXACT = 2**53  # all integers up to here are doubles


def refuse_masked(values: Any, name: str) -> None:
    """Refuses masked arrays, also in lists: numpy would take the numbers under the mask."""
    if isinstance(values, np.ma.MaskedArray):
        raise ArgumentError(f"{name}: masked arrays are not taken: leave the masked rows out")
    if not isinstance(values, list | tuple):
        return
    kinds = set(map(type, values))
    if any(issubclass(kind, list | tuple | np.ma.MaskedArray) for kind in kinds):
        for value in values:
            refuse_masked(value, name)


def _taken(values: Any, name: str) -> NDArray[Any]:
    refuse_masked(values, name)
    if hasattr(values, "detach"):  # a tensor, maybe one that records gradients, maybe on another device
        values = values.detach()
        values = values.cpu() if hasattr(values, "cpu") else values
    if hasattr(values, "__dlpack__") and not hasattr(values, "__array__"):
        return np.from_dlpack(values)
    return np.asarray(values)


def as_array(values: Any, name: str) -> NDArray[Any]:
    """Takes arrays, lists, DataFrames, tensors, and what speaks DLPack."""
    try:
        return _taken(values, name)
    except ArgumentError:
        raise
    except (TypeError, ValueError, OverflowError, BufferError, RuntimeError) as error:
        raise ArgumentError(f"{name}: not an array: {error}") from error


def _refuse_rounded(array: NDArray[Any], floats: NDArray[Any], name: str) -> None:
    """Refuses integers that doubles cannot hold: as coordinates they would move in silence."""
    if not (array.dtype.kind in "iu" and array.dtype.itemsize == 8) and array.dtype.kind != "O":
        return
    for place in np.flatnonzero(np.abs(floats) >= _MOST_EXACT):
        value = array.ravel()[place]
        if isinstance(value, int | np.integer) and int(value) != int(floats.ravel()[place]):
            raise ArgumentError(f"{name}: the integer {value} is no double: the nearest is {floats.ravel()[place]:.0f}")


def _converted(values: Any, name: str, kinds: str) -> NDArray[Any]:
    """Returns a C-contiguous, aligned array of float64, or of complex128 where `kinds` has c."""
    try:
        array = _taken(values, name)
        if array.dtype.kind not in kinds:
            raise ArgumentError(f"{name}: numbers are wanted, not {array.dtype}")
        wanted = np.complex128 if array.dtype.kind == "c" else np.float64
        out = np.require(array, wanted, ["C", "A"]).reshape(array.shape)
        _refuse_rounded(array, out, name)
        return out
    except ArgumentError:
        raise
    except (TypeError, ValueError, OverflowError, BufferError, RuntimeError) as error:
        raise ArgumentError(f"{name}: not an array of numbers: {error}") from error


def as_floats(values: Any, name: str) -> Floats:
    """Returns a C-contiguous, aligned array of float64; without a copy if `values` is one."""
    if type(values) is np.ndarray and values.dtype == np.float64 and values.dtype.isnative:
        if values.flags.c_contiguous and values.flags.aligned:
            return values
    return _converted(values, name, "biufO")


def as_values(values: Any, name: str) -> NDArray[Any]:
    """Returns a C-contiguous, aligned array of float64 or complex128."""
    return _converted(values, name, "biufOc")


def as_rows(values: Any, name: str, columns: tuple[int, ...] = (3,)) -> Floats:
    """Returns an array of rows of so many numbers."""
    rows = as_floats(values, name)
    if rows.ndim != 2 or rows.shape[1] not in columns:
        wanted = " or ".join(f"n by {k}" for k in columns)
        raise ArgumentError(f"{name}: an array of shape {wanted} is wanted, not of shape {rows.shape}")
    return rows


def as_weights(weights: Any, count: int) -> Floats | None:
    """Returns one number a point, or None."""
    if weights is None:
        return None
    array = as_floats(weights, "weights")
    if array.shape != (count,):
        raise ArgumentError(f"weights: an array of shape ({count},) is wanted, one a point, not of shape {array.shape}")
    return array


def as_box(box: Any, ndim: int) -> Floats:
    """Returns low and high corner as one array of 2 ndim numbers."""
    array = as_floats(box, "box")
    if array.shape not in ((2, ndim), (2 * ndim,)):
        hint = f"; an array of {ndim} pairs is taken transposed: box.T" if array.shape == (ndim, 2) else ""
        raise ArgumentError(f"box: the low corner and the high one are wanted, in an array of shape (2, {ndim}) or "
                            f"({2 * ndim},), not of shape {array.shape}{hint}")
    return array.reshape(2 * ndim)


def as_threads(threads: Any) -> int:
    """Takes a number of threads; 0 is one for each processor."""
    return as_count(threads, "threads")


def as_text(value: Any, name: str) -> str:
    """Takes a string that C can have."""
    if not isinstance(value, str):
        raise ArgumentError(f"{name}: a string is wanted, not {value!r}")
    if "\0" in value or any("\ud800" <= letter <= "\udfff" for letter in value):
        raise ArgumentError(f"{name}: text without the character 0 and without surrogates is wanted, not {value!r}")
    return value


def as_path(path: Any, name: str = "path", what: str = "a file") -> bytes:
    """Takes a path as the system has it."""
    try:
        taken = os.fsencode(path)
    except (TypeError, UnicodeEncodeError) as error:
        raise ArgumentError(f"{name}: the name of {what} is wanted, not {path!r}") from error
    if b"\0" in taken:
        raise ArgumentError(f"{name}: a name without the character 0 is wanted, not {path!r}")
    return taken


def as_queries(xi: Any, columns: int) -> tuple[Floats, tuple[int, ...]]:
    """Returns positions as rows, and the shape of the answers: that of `xi` without its last axis."""
    if as_array(xi, "xi").ndim == 0:
        raise IndexError("xi: a position is an array of coordinates, not a number")
    array = as_floats(xi, "xi")
    if array.shape[-1] != columns:
        raise ArgumentError(f"xi: positions of {columns} coordinates are wanted, along the last axis, "
                            f"not an array of shape {array.shape}")
    return array.reshape(-1, columns), array.shape[:-1]


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Makes an array read-only."""
    array.flags.writeable = False
    return array


_OF_THE_CALLER = ("points", "weights", "box")


def freeze_all(attributes: dict[str, Any]) -> dict[str, Any]:
    """Makes the arrays among an object's attributes read-only, except for those that may be the caller's."""
    for name, value in attributes.items():
        if isinstance(value, np.ndarray) and name not in _OF_THE_CALLER:
            frozen(value)
    return attributes


def as_number(value: Any, name: str) -> float:
    """Takes a number."""
    try:
        if not isinstance(value, str | bytes):
            return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(f"{name}: a number is wanted, not {value!r}") from error
    raise ArgumentError(f"{name}: a number is wanted, not {value!r}")


def as_count(value: Any, name: str, least: int = 0, most: int = 2**31 - 1) -> int:
    """Takes a whole number from `least` to `most`."""
    try:
        count = operator.index(value)
    except TypeError as error:
        raise ArgumentError(f"{name}: a whole number is wanted, not {value!r}") from error
    if not least <= count <= most:
        raise ArgumentError(f"{name}: a whole number from {least} to {most} is wanted, not {count}")
    return count
