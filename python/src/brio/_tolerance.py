"""Positions that are outside of the hull by rounding: scipy's tolerance of barycentric coordinates.

A position is within the tolerance of a simplex if none of its barycentric coordinates there is below -tol. Where the simplex
at the hull is too flat to have a transform, its neighbours count in its place; their coordinate towards it may be down to
-sqrt(tol), as in scipy.

Few positions outside are so near to the hull. A position at most `reach` from the hull is inside once it is moved a little
towards a point deep inside; so the library's exact location tells the others at once. From the simplex that holds the moved
position a walk leads to the position. Where the walk ends at the hull, all simplices there are tried.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _geometry
from ._arrays import Floats
from ._scaled import shifted

if TYPE_CHECKING:
    from ._delaunay import Delaunay

Ints = NDArray[np.int32]

STANDARD = 100 * float(np.finfo(np.float64).eps)  # scipy's
_STEPS = 100  # of a walk; chosen: walks begin near their end
_PAIRS = 1 << 20  # of positions and simplices at a time


def coordinates(tri: "Delaunay", simplices: NDArray[Any], rows: Floats) -> Floats:
    """Returns the barycentric coordinates of each position in its simplex; NaN where that is too flat."""
    exponent = tri._core[0]
    return _applied(_transforms(tri, simplices), shifted(rows, -exponent))


def _transforms(tri: "Delaunay", simplices: NDArray[Any]) -> Floats:
    """Returns the transforms of some simplices, in coordinates divided by 2**tri._core[0]."""
    corners = shifted(tri.points[tri.simplices[simplices]].reshape(-1, tri.ndim), -tri._core[0])
    return _geometry.barycentric_transforms(corners, np.arange(len(corners)).reshape(-1, tri.ndim + 1))


def _applied(transform: Floats, rows: Floats) -> Floats:
    with np.errstate(all="ignore"):
        part = np.einsum("...ij,...j->...i", transform[..., :-1, :], rows - transform[..., -1, :])
        return np.concatenate([part, 1 - part.sum(axis=-1, keepdims=True)], axis=-1)


def core(tri: "Delaunay") -> tuple[int, Floats, float, float]:
    """Returns an exponent, and in coordinates divided by 2**exponent a point deep inside, its depth, and the extent."""
    points = tri._unchanged_points()
    exponent = int(np.frexp(np.abs(points).max())[1])
    corners = shifted(points[tri.convex_hull], -exponent)
    middle = corners.reshape(-1, tri.ndim).mean(axis=0)
    with np.errstate(all="ignore"):
        edges = corners[:, 1:] - corners[:, :1]
        normals = edges[:, 0][:, ::-1] * [1, -1] if tri.ndim == 2 else np.cross(edges[:, 0], edges[:, 1])
        heights = np.abs(((middle - corners[:, 0]) * normals).sum(axis=1)) / np.linalg.norm(normals, axis=1)
    extent = np.linalg.norm(np.ptp(corners.reshape(-1, tri.ndim), axis=0))
    return exponent, middle, float(np.nanmin(heights, initial=np.inf)), float(extent)


def border(tri: "Delaunay") -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Returns the simplices at the hull that have a transform, these, and which coordinates lead to a flat simplex."""
    mates = tri.neighbors
    is_flat = np.zeros(tri.nsimplex, np.bool_)
    seen, ahead = [], np.flatnonzero((mates < 0).any(axis=1))
    while len(ahead):  # flat simplices at the hull, and flat ones behind these
        flat = np.isnan(_transforms(tri, ahead)[:, 0, 0])
        seen.append(ahead)
        is_flat[ahead[flat]] = True
        behind = np.unique(mates[ahead[flat]])
        ahead = np.setdiff1d(behind[behind >= 0], np.concatenate(seen))
    numbers = np.concatenate(seen)
    numbers = np.sort(numbers[~is_flat[numbers]])
    towards = mates[numbers]
    return numbers.astype(np.int32), _transforms(tri, numbers), (towards >= 0) & is_flat[towards]


def _moved(tri: "Delaunay", rows: Floats, tol: float) -> Floats:
    """Moves positions towards a point deep inside, so far that those within the tolerance are inside."""
    exponent, middle, depth, extent = tri._core
    reach = 2 * (tri.ndim + 1) * max(tol, tol**0.5) * extent
    share = min(1.0, 2 * reach / (reach + depth))
    with np.errstate(all="ignore"):
        near = shifted(rows, -exponent)
        moved: Floats = shifted(near + share * (middle - near), exponent)
    return moved


def _walk(tri: "Delaunay", start: Ints, rows: Floats, tol: float) -> Ints:
    """Walks to simplices within the tolerance of the positions; -1 where a walk ends at the hull or at a flat simplex."""
    out, at, left = np.full(len(rows), -1, np.int32), start.copy(), np.arange(len(rows))
    for _ in range(_STEPS):
        if not len(left):
            break
        share = coordinates(tri, at[left], rows[left])
        there = share.min(axis=1) >= -tol
        out[left[there]] = at[left[there]]
        mates = tri.neighbors[at[left]]
        share[(mates < 0) | np.isnan(share)] = np.inf
        way = share.argmin(axis=1)
        each = np.arange(len(left))
        goes_on = ~there & (share[each, way] < -tol)
        at[left[goes_on]] = mates[each, way][goes_on]
        left = left[goes_on]
    return out


def _try_border(tri: "Delaunay", rows: Floats, tol: float) -> Ints:
    """Looks through all simplices at the hull: among several the one where the position is least far out."""
    numbers, transform, to_flat = tri._border
    limits = np.where(to_flat, max(tol, tol**0.5), tol)
    near_rows = shifted(rows, -tri._core[0])
    out = np.full(len(rows), -1, np.int32)
    step = max(1, _PAIRS // max(1, len(numbers)))
    for first in range(0, len(rows) if len(numbers) else 0, step):
        share = _applied(transform[None], near_rows[first : first + step, None]) / limits
        least = share.min(axis=2)
        best = least.argmax(axis=1)
        near = least[np.arange(len(best)), best] >= -1
        out[first : first + step][near] = numbers[best[near]]
    return out


def find_within(tri: "Delaunay", rows: Floats, tol: float) -> Ints:
    """Returns for positions outside of the hull a simplex that they are within the tolerance of, or -1."""
    out = np.full(len(rows), -1, np.int32)
    if not tri.nsimplex or not len(rows):
        return out
    moved = _moved(tri, rows, tol)
    start = np.full(len(rows), -1, np.int32)
    finite = np.isfinite(moved).all(axis=1)
    start[finite] = tri._locate(np.ascontiguousarray(moved[finite]))
    near = np.flatnonzero(start >= 0)
    if len(near):
        out[near] = _walk(tri, start[near], rows[near], tol)
        rest = near[out[near] < 0]
        if len(rest):
            out[rest] = _try_border(tri, rows[rest], tol)
    return out
