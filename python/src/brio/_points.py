"""Points chosen among points."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import Floats, as_count, as_rows
from ._calls import Path, Progress


def _rows(points: Any) -> Floats:
    """Positions of points, or of the vertices of a Mesh."""
    vertices = getattr(points, "vertices", None)
    return as_rows(points if vertices is None else vertices, "points")


def nearest(points: Floats, queries: Floats, threads: int, progress: bool | Progress | None) -> NDArray[np.uint32]:
    """Returns the index of the point nearest to each query; among equally near ones, of the lexicographically first."""
    out = np.empty(len(queries), np.uint32)
    with _calls.reporting(progress) as report:
        _native.nearest(np.ascontiguousarray(points), np.ascontiguousarray(queries), out, threads, report)
    return out


def thin(points: Any, spacing: float, *, threads: int = 0, progress: bool | Progress | None = None,
         scratch: Path | None = None, max_memory: float | None = None) -> NDArray[np.bool_]:
    """Chooses points that are at least `spacing` from each other, such that every other point is nearer to a chosen one.

    The choice depends on the set of positions and the spacing alone, not on the order of the points.

    Parameters
    ----------
    points : array_like, shape (n, 3), or Mesh
    spacing : float
        In the unit of the points; greater than 0.
    threads, progress, scratch, max_memory
        As for Delaunay.

    Returns
    -------
    ndarray of bool, shape (n,)
        True for the chosen points: ``points[brio.thin(points, 0.1)]``, or ``mesh.select(brio.thin(mesh, 0.1))``.

    Examples
    --------
    >>> import brio
    >>> int(brio.thin([[0, 0, 0], [0.1, 0, 0], [1, 0, 0]], 0.5).sum())
    2
    """
    rows = _rows(points)
    out = np.zeros(len(rows), np.bool_)

    def call(p: Floats, w: None, t: int, report: Any) -> None:
        _native.thin(p, spacing, out, t, report)

    _calls.of_points(call, rows, None, threads, progress, (scratch, max_memory))
    return out


def outliers(points: Any, neighbours: int = 12, *, factor: float = 3.0, threads: int = 0,
             progress: bool | Progress | None = None, scratch: Path | None = None,
             max_memory: float | None = None) -> NDArray[np.bool_]:
    """Finds stray points: those whose mean distance to their nearest points is large by the measure of these points.

    Where points become sparse by and by none is an outlier. More than `neighbours` stray points that are close together
    are not found.

    Parameters
    ----------
    points : array_like, shape (n, 3), or Mesh
    neighbours : int
        1 to 63; 8 to 16 are usual.
    factor : float
        An outlier is more than so many times as far from its nearest points as the lower quartile of these points are
        from theirs; 1 or more.
    threads, progress, scratch, max_memory
        As for Delaunay.

    Returns
    -------
    ndarray of bool, shape (n,)
        True for outliers: ``points[~brio.outliers(points)]``, or ``mesh.select(~brio.outliers(mesh))``.

    Examples
    --------
    >>> import brio, numpy as np
    >>> points = np.random.default_rng(1).random((500, 3))
    >>> points[7] = 5, 5, 5
    >>> np.flatnonzero(brio.outliers(points)).tolist()
    [7]
    """
    rows, count = _rows(points), as_count(neighbours, "neighbours", 1, 63)
    out = np.zeros(len(rows), np.bool_)

    def call(p: Floats, w: None, t: int, report: Any) -> None:
        _native.outliers(p, count, factor, out, t, report)

    _calls.of_points(call, rows, None, threads, progress, (scratch, max_memory))
    return out
