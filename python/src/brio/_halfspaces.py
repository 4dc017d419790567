"""Intersections of halfspaces, under scipy's names, by the hull of their dual points."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, as_floats, as_rows, freeze_all
from ._calls import Progress
from ._hull import ConvexHull
from ._scipy import other_class
from .errors import ArgumentError, NoAnswerError

Ints = NDArray[np.int32]


class HalfspaceIntersection:
    """The polygon or polytope where all inequalities A x + b <= 0 hold.

    A halfspace at distance d from the interior point has the dual point normal / d. The facets of the convex hull of the
    dual points are the corners of the intersection. Dual points are rounded to doubles; of these the hull is exact. Names,
    shapes and types are those of ``scipy.spatial.HalfspaceIntersection``.

    Parameters
    ----------
    halfspaces : array_like, shape (n, ndim + 1)
        Rows [A, b]; ndim is 2 or 3.
    interior_point : array_like, shape (ndim,)
        A point strictly inside of all halfspaces.
    threads, progress, incremental, qhull_options, fallback
        As for Delaunay.

    Attributes
    ----------
    halfspaces, interior_point : ndarray of float64
    intersections : ndarray of float64, shape (nfacet, ndim)
        The corners, in the order of `dual_facets`.
    dual_points : ndarray of float64, shape (n, ndim)
    dual_facets : list of lists of int
        For each corner the halfspaces that meet there.
    dual_vertices : ndarray of int32
        The halfspaces that bound the intersection, ascending.
    dual_equations : ndarray of float64, shape (nfacet, ndim + 1)
    dual_volume, dual_area : float
        Of the hull of the dual points.

    Examples
    --------
    >>> import brio
    >>> square = brio.HalfspaceIntersection([[-1, 0, 0], [0, -1, 0], [1, 0, -2], [0, 1, -2], [1, 1, -9]], [1, 1])
    >>> sorted(square.intersections.tolist())
    [[0.0, 0.0], [0.0, 2.0], [2.0, 0.0], [2.0, 2.0]]
    >>> square.dual_vertices.tolist()
    [0, 1, 2, 3]
    """

    halfspaces: Floats
    interior_point: Floats
    intersections: Floats
    dual_points: Floats
    dual_facets: list[list[int]]
    dual_vertices: Ints
    dual_equations: Floats
    dual_volume: float
    dual_area: float

    def __new__(cls, halfspaces: Any, interior_point: Any = None, *, fallback: str | None = None, **options: Any) -> Any:
        scipys: dict[str, Any] = {key: options[key] for key in ("incremental", "qhull_options") if key in options}
        rows = as_floats(halfspaces, "halfspaces")
        normals = rows[:, :-1] if rows.ndim == 2 and rows.shape[1] else rows
        other = other_class("HalfspaceIntersection", normals, fallback, scipys, (halfspaces, interior_point))
        return object.__new__(cls) if other is None else other

    def __init__(self, halfspaces: Any, interior_point: Any, *, incremental: bool = False,
                 qhull_options: str | bytes | None = None, threads: int = 0, progress: bool | Progress | None = None,
                 fallback: str | None = None) -> None:
        self.threads, self.progress, self._closed = threads, progress, False
        rows = as_rows(halfspaces, "halfspaces", (3, 4))
        inside = as_floats(interior_point, "interior_point")
        if inside.shape != (rows.shape[1] - 1,):
            raise ArgumentError(f"interior_point: an array of shape ({rows.shape[1] - 1},) is wanted, "
                                f"not of shape {inside.shape}")
        self._build(rows.copy(), inside.copy())

    def _build(self, halfspaces: Floats, inside: Floats) -> None:
        distances = halfspaces[:, -1] + halfspaces[:, :-1] @ inside
        outside = np.flatnonzero(~(distances < 0))
        if len(outside):
            raise NoAnswerError(f"the interior point is not feasible: it is not strictly inside of halfspace {outside[0]}, "
                                f"{halfspaces[outside[0]]}", outside)
        dual = halfspaces[:, :-1] / -distances[:, None]
        hull = ConvexHull(dual, threads=self.threads, progress=self.progress)
        if hull.ndim == 2:
            facets, equations = hull.simplices.tolist(), hull.equations
        else:
            facets = hull.polygons
            sizes = np.diff(hull.polygon_offsets) - 2
            equations = hull.equations[np.cumsum(sizes) - sizes]
        if not (equations[:, -1] < 0).all():
            raise NoAnswerError("the intersection of the halfspaces is unbounded")
        self.halfspaces, self.interior_point, self.dual_points = halfspaces, inside, dual
        self.dual_facets, self.dual_vertices, self.dual_equations = facets, np.sort(hull.vertices), equations
        self.dual_volume, self.dual_area = hull.volume, hull.area
        self.intersections = equations[:, :-1] / -equations[:, -1:] + inside
        freeze_all(self.__dict__)

    @property
    def ndim(self) -> int:
        return len(self.interior_point)

    def add_halfspaces(self, halfspaces: Any, restart: bool = False) -> None:
        """Adds halfspaces and intersects again, all of them."""
        if self._closed:
            raise RuntimeError("the intersection is closed: it takes no more halfspaces")
        rows = as_floats(halfspaces, "halfspaces")
        if rows.ndim > 2:
            raise ArgumentError(f"halfspaces: a 2D array is wanted, not one of shape {rows.shape}")
        rows = as_rows(np.atleast_2d(rows), "halfspaces", (self.ndim + 1,))
        bigger = object.__new__(HalfspaceIntersection)
        bigger.threads, bigger.progress, bigger._closed = self.threads, self.progress, False
        bigger._build(np.concatenate([self.halfspaces, rows]), self.interior_point)
        self.__dict__ = bigger.__dict__  # at once: other threads may read

    def close(self) -> None:
        """Ends the adding of halfspaces."""
        self._closed = True

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "progress": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(freeze_all(state))

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self.halfspaces, self.interior_point

    def __repr__(self) -> str:
        return f"<brio.HalfspaceIntersection of {len(self.halfspaces)} halfspaces: {len(self.intersections)} corners>"
