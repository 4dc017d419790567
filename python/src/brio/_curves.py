"""Meshes of edges: curves through points of a plane, and minimum spanning trees."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import Floats, as_number, as_rows, frozen
from ._calls import Progress
from ._mesh import Mesh
from ._properties import Properties, carry
from .errors import ArgumentError

_METHODS = ["curves", "power-crust"]


class Curve(Mesh):
    """Edges over points: a Mesh, and

    Attributes
    ----------
    points : ndarray of float64, shape (n, 3)
        The points; those of a plane have 0 as their third coordinate.
    samples : ndarray of int64, shape (nvertices,)
        The point that each vertex is, of coincident ones the lowest.
    """

    points: Floats
    samples: NDArray[np.int64]


def _rows(points: Any) -> tuple[Floats, Properties]:
    """Points of space, and their properties. Points of a plane get a column of zeros."""
    if isinstance(points, Mesh):
        return points.vertices, points.properties
    rows = as_rows(points, "points", (2, 3))
    return (rows if rows.shape[1] == 3 else np.column_stack([rows, np.zeros(len(rows))])), {}


def _run(function: Any, points: Any, options: dict[str, Any], threads: int, progress: bool | Progress | None) -> Curve:
    rows, properties = _rows(points)

    def call(p: Floats, w: None, t: int, report: Any) -> Any:
        return function(p, options, 0.0, None, t, report)

    made: Curve = Curve._of(_calls.of_points(call, rows, None, threads, progress))
    made.points = rows
    made.samples = frozen(made.properties["sample"].astype(np.int64))
    carry(properties, made.samples, made.properties)
    return made


def curve(points: Any, method: str = "curves", *, open: float | None = None, closed: bool = False, threads: int = 0,
          progress: bool | Progress | None = None) -> Curve:
    """Finds curves through points of a plane: polylines, with corners and ends, some closed, any number of them.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3), or Mesh
        The plane may lie in space as it likes.
    method : "curves" or "power-crust"
        "power-crust": the edges between inside and outside, closed whatever the points; it has no options.
    open : float, optional
        A curve ends where the next point is over that many times as far as the links near it; 1 or more. By default as far as
        these vary.
    closed : bool
        Curves end nowhere if they can be closed.

    Returns
    -------
    Curve
        A Mesh whose vertices are the distinct points, with `edges` along one curve after the other, `samples`, and the properties
        "curve" (the number of the curve, -1 on none) and "corner" (1 at a corner); a power crust has neither.

    Raises
    ------
    NoAnswerError
        Points off a plane, or all over an area.

    Examples
    --------
    >>> import brio, numpy as np
    >>> angle = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    >>> circle = brio.curve(np.column_stack([np.cos(angle), np.sin(angle)]))
    >>> len(circle.edges), int(circle.properties["curve"].max()) + 1
    (100, 1)
    """
    if method not in _METHODS:
        raise ArgumentError(f"method: one of {', '.join(_METHODS)}, not {method!r}")
    if method == "power-crust":
        if open is not None or closed:
            raise ArgumentError("open, closed: for curves; a power crust is closed")
        return _run(_native.planar_crust, points, {}, threads, progress)
    wide = 0.0 if open is None else as_number(open, "open")
    return _run(_native.curve, points, {"open": wide, "closed": int(closed)}, threads, progress)


def spanning_tree(points: Any, *, threads: int = 0, progress: bool | Progress | None = None) -> Curve:
    """Computes the Euclidean minimum spanning tree of points, of space or of a plane.

    Lengths are compared exactly, and the tree is the same for every order of the points.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3), or Mesh

    Returns
    -------
    Curve
        A Mesh whose vertices are the distinct points, with `edges`, the shortest first, and `samples`.

    Examples
    --------
    >>> import brio
    >>> tree = brio.spanning_tree([[0, 0, 0], [3, 0, 0], [1, 0, 0], [3, 4, 0]])
    >>> tree.edges.tolist()
    [[0, 2], [2, 1], [1, 3]]
    """
    return _run(_native.spanning_tree, points, {}, threads, progress)
