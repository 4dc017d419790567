"""Convex hulls, under scipy's names."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import Floats, as_rows, freeze_all, frozen
from ._calls import Limits, Path, Progress
from ._scaled import aligned, cross, difference, product, run_sums, shifted, split, total, units
from ._scipy import other_class
from .errors import NoAnswerError

Ints = NDArray[np.int32]


class ConvexHull:
    """The convex hull of points in the plane or in space, exactly.

    Vertices are the strictly extreme points. Names, shapes and types are those of ``scipy.spatial.ConvexHull``. In space,
    facets of more than three vertices are fans of triangles with one equation; ``polygons`` has them as they are.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
    threads, progress, scratch, max_memory, incremental, qhull_options, fallback
        As for Delaunay.

    Attributes
    ----------
    vertices : ndarray of int32, shape (nvertices,)
        Indices of points; counterclockwise in the plane, ascending in space.
    simplices : ndarray of int32, shape (nfacet, ndim)
        Edges, or triangles, counterclockwise seen from outside.
    neighbors : ndarray of int32, shape (nfacet, ndim)
        The simplex on the other side of each vertex.
    equations : ndarray of float64, shape (nfacet, ndim + 1)
        Unit normals to the outside, and offsets.
    volume, area : float
        In the plane, the area and the perimeter.
    good : None
        scipy's mask of the facets that are visible from a point; None there, too, without Qhull's option QG, which brio
        does not offer.
    polygon_offsets, polygon_vertices : ndarray
        Facet f has the vertices ``polygon_vertices[polygon_offsets[f]:polygon_offsets[f + 1]]``; in space only.

    Examples
    --------
    >>> import brio
    >>> hull = brio.ConvexHull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [1, 0.5]])
    >>> hull.vertices.tolist(), hull.volume, hull.area
    ([0, 1, 2, 3], 2.0, 6.0)
    """

    points: Floats
    vertices: Ints
    simplices: Ints
    neighbors: Ints
    equations: Floats
    volume: float
    area: float
    polygon_offsets: NDArray[np.int64]
    polygon_vertices: Ints

    def __new__(cls, points: Any, *, fallback: str | None = None, **options: Any) -> Any:
        scipys: dict[str, Any] = {key: options[key] for key in ("incremental", "qhull_options") if key in options}
        other = other_class("ConvexHull", points, fallback, scipys)
        return object.__new__(cls) if other is None else other

    def __init__(self, points: Any, *, incremental: bool = False, qhull_options: str | bytes | None = None,
                 threads: int = 0, progress: bool | Progress | None = None, scratch: Path | None = None,
                 max_memory: float | None = None, fallback: str | None = None) -> None:
        self._limits: Limits = (scratch, max_memory)
        self.threads, self.progress, self._closed = threads, progress, False
        self.good = None
        self._build(as_rows(points, "points", (2, 3)))

    def _build(self, points: Floats) -> None:
        d = points.shape[1]
        space = points if d == 3 else np.column_stack([points, np.zeros(len(points))])
        samples = np.empty(len(points), np.uint32)

        def hull(p: Floats, w: None, threads: int, report: Any) -> Any:
            return _native.convex_hull(p, {"polygons": 1}, 0.0, samples, threads, report)

        views = _native.mesh_views(_calls.of_points(hull, space, None, self.threads, self.progress, self._limits))
        offsets = np.asarray(views["face_offsets"]).astype(np.int64)
        corners = samples[np.asarray(views["face_vertices"])].astype(np.int32)
        if len(offsets) < (2 if d == 2 else 5):
            raise NoAnswerError(f"the points have no hull with an inside: they lie in a flat of dimension below {d}")
        self.points, self.polygon_offsets, self.polygon_vertices = points, offsets, corners
        if d == 2:
            self.vertices = corners
            self._set_edges()
        else:
            self.vertices = samples[: len(np.asarray(views["vertices"]))].astype(np.int32)
            self._set_triangles()
        freeze_all(self.__dict__)

    # --- in the plane ---

    def _set_edges(self) -> None:
        count = len(self.vertices)
        self.simplices = np.stack([self.vertices, np.roll(self.vertices, -1)], axis=1)
        order = np.arange(count, dtype=np.int32)
        self.neighbors = np.stack([np.roll(order, -1), np.roll(order, 1)], axis=1)
        start, end = self.points[self.simplices[:, 0]], self.points[self.simplices[:, 1]]
        along, lengths = units(difference(end, start))
        self._set_planes(np.stack([along[:, 1], -along[:, 0]], axis=1), start)
        self.area = total(lengths)
        first = self.points[self.vertices[:1]]
        self.volume = total(cross(difference(start, first), difference(end, first)), 2)

    # --- in space ---

    def _set_triangles(self) -> None:
        offsets, corners = self.polygon_offsets, self.polygon_vertices
        sizes = np.diff(offsets) - 2
        facet = np.repeat(np.arange(len(sizes)), sizes)
        first = offsets[:-1][facet]
        step = np.arange(len(facet)) - np.repeat(np.cumsum(sizes) - sizes, sizes) + 1
        self.simplices = np.stack([corners[first], corners[first + step], corners[first + step + 1]], axis=1)
        self.neighbors = _neighbors(self.simplices)
        corner = self.points[self.simplices]
        twice = cross(difference(corner[:, 1], corner[:, 0]), difference(corner[:, 2], corner[:, 0]))
        normals, twice_areas = units(run_sums(twice, np.cumsum(sizes) - sizes))
        self._set_planes(normals[facet], corner[:, 0])
        self.area = total(twice_areas, 2)
        self.volume = total(product(difference(corner[:, 0], self.points[self.vertices[0]]), twice), 6)

    # --- both ---

    def _set_planes(self, normals: Floats, on: Floats) -> None:
        """Sets the equations, from the normal of each plane and a point on it."""
        near, exponent = aligned(split(on), 1)
        self.equations = np.column_stack([normals, shifted(-(normals * near).sum(axis=1), exponent)])

    @property
    def polygons(self) -> list[list[int]]:
        """The facets as lists of points, counterclockwise seen from outside."""
        flat, ends = self.polygon_vertices.tolist(), self.polygon_offsets.tolist()
        return [flat[i:j] for i, j in zip(ends[:-1], ends[1:])]

    # --- sizes ---

    @property
    def ndim(self) -> int:
        return int(self.points.shape[1])

    @property
    def npoints(self) -> int:
        return len(self.points)

    @property
    def nsimplex(self) -> int:
        return len(self.simplices)

    @cached_property
    def coplanar(self) -> Ints:
        """scipy lists points here only if Qhull is asked to: there are none."""
        return frozen(np.empty((0, 3), np.int32))

    @property
    def min_bound(self) -> Floats:
        return frozen(self.points.min(axis=0))

    @property
    def max_bound(self) -> Floats:
        return frozen(self.points.max(axis=0))

    def add_points(self, points: Any, restart: bool = False) -> None:
        """Adds points and builds the hull again, from all points."""
        if self._closed:
            raise RuntimeError("the hull is closed: it takes no more points")
        both = np.concatenate([self.points, as_rows(points, "points", (self.ndim,))])
        bigger = ConvexHull(both, threads=self.threads, progress=self.progress, scratch=self._limits[0],
                            max_memory=self._limits[1])
        self.__dict__ = bigger.__dict__  # at once: other threads may read

    def close(self) -> None:
        """Ends the adding of points."""
        self._closed = True

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "progress": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(freeze_all(state))

    def __getnewargs__(self) -> tuple[Any, ...]:
        return (self.points,)

    def __repr__(self) -> str:
        return f"<brio.ConvexHull of {self.npoints} points: {len(self.vertices)} vertices, {self.nsimplex} simplices>"


def _neighbors(triangles: Ints) -> Ints:
    """The triangle beyond the edge opposite to each corner, in a closed oriented surface."""
    edges = triangles[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2).astype(np.int64)
    width = int(triangles.max()) + 1
    there = edges[:, 0] * width + edges[:, 1]
    back = edges[:, 1] * width + edges[:, 0]
    order = np.argsort(there)
    mate = order[np.searchsorted(there, back, sorter=order)]
    return (mate // 3).reshape(-1, 3).astype(np.int32)
