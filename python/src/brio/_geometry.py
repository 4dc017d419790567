"""Formulas on many simplices at once."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, frozen
from ._scaled import Scaled, aligned, difference, shifted

# scipy's: a simplex whose matrix has a smaller reciprocal condition number has no transform.
LEAST_RCOND = 1000 * np.finfo(np.float64).eps

# Simplices at a time: between two blocks Python looks for signals, and the arrays of one stay in the cache.
BLOCK = 1 << 15


def edges_from(points: Floats, simplices: NDArray[Any], origin: int) -> Scaled:
    """Returns #S by d by d, and an exponent a simplex: row k is the simplex' k-th other vertex minus the vertex `origin`."""
    others = [k for k in range(simplices.shape[1]) if k != origin % simplices.shape[1]]
    edges = difference(points[simplices[:, others]], points[simplices[:, origin]][:, None, :])
    return aligned(edges, (1, 2))


def cofactors(matrix: Floats) -> tuple[Floats, Floats]:
    """Returns, for #S by d by d matrices of rows, the columns of det times the inverse, and det; d is 2 or 3."""
    if matrix.shape[-1] == 2:
        a, b = matrix[:, 0], matrix[:, 1]
        columns = np.stack([np.stack([b[:, 1], -b[:, 0]], -1), np.stack([-a[:, 1], a[:, 0]], -1)], axis=1)
    else:
        a, b, c = matrix[:, 0], matrix[:, 1], matrix[:, 2]
        columns = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    det = np.einsum("si,si->s", matrix[:, 0], columns[:, 0])
    return columns, det


def barycentric_transforms(points: Floats, simplices: NDArray[Any]) -> Floats:
    """Returns scipy's `transform`: for each simplex d rows with the inverse of T, T c = x - r, and the row r.

    NaN marks simplices too flat for it, by scipy's bound on the condition number.
    """
    d = points.shape[1]
    out = np.empty((len(simplices), d + 1, d))
    for first in range(0, len(simplices), BLOCK):
        _transform(points, simplices[first : first + BLOCK], out[first : first + BLOCK])
    return out


def _transform(points: Floats, simplices: NDArray[Any], out: Floats) -> None:
    d = points.shape[1]
    matrix, exponent = edges_from(points, simplices, -1)  # row k: vertex k minus r, so that x - r = sum of c_k row_k
    with np.errstate(all="ignore"):
        columns, det = cofactors(matrix)
        inverse = columns / det[:, None, None]
        rcond = 1 / (np.abs(matrix).sum(axis=2).max(axis=1) * np.abs(inverse).sum(axis=1).max(axis=1))
        flat = ~(rcond >= LEAST_RCOND)
        out[:, :d] = shifted(inverse, -exponent[:, None, None])
    out[:, d] = points[simplices[:, -1]]
    out[flat] = np.nan


def lower_planes(points: Floats, lifted: Floats, exponent: int, simplices: NDArray[Any]) -> Floats:
    """Returns #S by d + 2: the unit normal, pointing down, and the offset of the plane through the lifted vertices.

    Their last coordinates are lifted * 2**exponent.
    """
    d = points.shape[1]
    out = np.empty((len(simplices), d + 2))
    with np.errstate(all="ignore"):
        matrix, exponents = edges_from(points, simplices, -1)
        columns, det = cofactors(matrix)
        rise = shifted(lifted[simplices[:, :-1]] - lifted[simplices[:, -1:]], exponent - exponents[:, None])
        slope = np.einsum("sk,ski->si", rise, columns) / det[:, None]
        out[:, :d] = slope
        out[:, d] = -1
        out[:, : d + 1] /= np.sqrt(1 + (slope**2).sum(axis=1))[:, None]
        last = simplices[:, -1]
        offset = -(out[:, :d] * shifted(points, -exponent)[last]).sum(axis=1) - out[:, d] * lifted[last]
        out[:, d + 1] = shifted(offset, exponent)
    return out


def csr(pairs: NDArray[Any], count: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Returns the second members of pairs, sorted, by first member: offsets and items; each pair once."""
    if len(pairs):
        keys = np.unique(pairs[:, 0].astype(np.int64) * count + pairs[:, 1])
    else:
        keys = np.empty(0, np.int64)
    first, second = np.divmod(keys, max(count, 1))
    offsets = np.zeros(count + 1, np.int32)
    np.cumsum(np.bincount(first, minlength=count), out=offsets[1:])
    return frozen(offsets), frozen(second.astype(np.int32))
