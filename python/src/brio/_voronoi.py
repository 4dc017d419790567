"""Voronoi and power diagrams, under scipy's names and as arrays."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import Floats, as_box, as_rows, as_weights, freeze_all, frozen
from ._calls import Limits, Path, Progress
from ._delaunay import Delaunay
from ._scaled import cross, difference, run_sums, shifted
from ._scipy import other_class, qhull_words
from .errors import ArgumentError, NoAnswerError

Ints = NDArray[np.int64]
Lists = list[list[int]]


def as_lists(offsets: NDArray[Any], items: NDArray[Any]) -> Lists:
    """Returns the lists that offsets and items stand for."""
    flat, ends = items.tolist(), offsets.tolist()
    return [flat[i:j] for i, j in zip(ends[:-1], ends[1:])]


class Voronoi:
    """The Voronoi diagram of points in the plane or in space or, with weights, the power diagram.

    Vertices that rounding alone would tell apart are one vertex: that is decided exactly. Names and the use of -1 are
    those of ``scipy.spatial.Voronoi``.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
    weights : array_like, shape (n,), optional
    box : array_like, shape (2, ndim) or (2 ndim,), optional
        Low and high corner of a box that clips the cells.
    cell : array_like, optional
        Makes a PeriodicVoronoi, of space that repeats; `periodic`, `radii` and `vertices` go with it.
    threads, progress, scratch, max_memory, incremental, furthest_site, qhull_options, fallback
        As for Delaunay.

    Attributes
    ----------
    vertices : ndarray of float64, shape (nvertices, ndim)
    ridge_points : ndarray of int32, shape (nridges, 2)
        The two points that each ridge lies between.
    ridge_vertices : list of lists of int
        The vertices of each ridge, in order; -1 first where the ridge is unbounded.
    regions : list of lists of int
        The vertices of each region, -1 where it is unbounded. Region 0 is empty, as scipy's point at infinity.
        In the plane, vertices are in counterclockwise order.
    point_region : ndarray of int64, shape (npoints,)
        The region of each point; a point without one has that of the vertex that represents it.
    ridge_offsets, ridge_items, region_offsets, region_items : ndarray of int64
        The same lists as arrays: ridge k is ``ridge_items[ridge_offsets[k]:ridge_offsets[k + 1]]``.
    volumes : ndarray of float64, shape (npoints,)
        Of each point's cell (in the plane: areas); infinite for unbounded cells, 0 for points without a cell.

    Examples
    --------
    >>> import brio
    >>> vor = brio.Voronoi([[x, y] for x in range(3) for y in range(3)])
    >>> sorted(vor.vertices.tolist())
    [[0.5, 0.5], [0.5, 1.5], [1.5, 0.5], [1.5, 1.5]]
    >>> len(vor.regions[vor.point_region[4]])
    4
    >>> float(vor.volumes[4])
    1.0
    """

    points: Floats
    weights: Floats | None
    vertices: Floats
    ridge_points: NDArray[np.int32]
    cells: dict[str, Any]

    def __new__(cls, points: Any, weights: Any = None, *, fallback: str | None = None, **options: Any) -> Any:
        if options.get("cell") is not None:
            from ._periodic import PeriodicVoronoi

            return PeriodicVoronoi(points, weights, **options)
        wanted = ("furthest_site", "incremental", "qhull_options")
        scipys: dict[str, Any] = {key: options[key] for key in wanted if key in options}
        other = other_class("Voronoi", points, fallback, scipys)
        return object.__new__(cls) if other is None else other

    def __init__(self, points: Any, weights: Any = None, *, box: Any = None, threads: int = 0,
                 progress: bool | Progress | None = None, scratch: Path | None = None, max_memory: float | None = None,
                 furthest_site: bool = False, incremental: bool = False, qhull_options: str | bytes | None = None,
                 fallback: str | None = None) -> None:
        rows = as_rows(points, "points", (2, 3))
        self._limits: Limits = (scratch, max_memory)
        self.threads, self.progress, self.furthest_site, self._closed = threads, progress, False, False
        self._empty = 1 if qhull_options is None or "Qz" in qhull_words(qhull_options) else 0
        self.box: Floats | None = None
        if box is not None:
            self.box = as_box(box, rows.shape[1])
        self._build(rows, as_weights(weights, len(rows)))

    def _build(self, points: Floats, weights: Floats | None) -> None:
        self.points, self.weights = points, weights
        build = self._build_space
        if points.shape[1] == 2:
            build = self._build_plane if self.box is None else self._build_rectangle
        build(points, weights)
        freeze_all(self.__dict__)

    def _triangulated(self, points: Floats, weights: Floats | None) -> Delaunay:
        scratch, max_memory = self._limits
        tri: Delaunay = Delaunay(points, weights, threads=self.threads, progress=self.progress, scratch=scratch,
                                 max_memory=max_memory)
        return tri

    # --- in the plane: the dual of the triangulation ---

    def _build_plane(self, points: Floats, weights: Floats | None) -> None:
        tri = self._triangulated(points, weights)
        if tri.facts["dimension"] < 2:
            raise NoAnswerError("points on a line have no Voronoi vertices")
        raw = {name: np.asarray(part) for name, part in _native.voronoi2(tri._handle, points, weights).items()}
        self.vertices = raw["vertices"]
        self._set_ridges_plane(tri, raw["triangle_vertex"])
        counts = np.diff(raw["offsets"]).astype(np.int64)
        sites = np.flatnonzero(counts)
        self._set_regions(tri.representatives, sites, counts[sites], raw["items"].astype(np.int64))

    def _set_ridges_plane(self, tri: Delaunay, classes: NDArray[np.uint32]) -> None:
        simplex = np.repeat(np.arange(tri.nsimplex), 3)
        beyond = tri.neighbors.ravel()
        ends = tri.simplices[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2)
        here = classes[simplex].astype(np.int64)
        there = np.where(beyond < 0, -1, classes[beyond].astype(np.int64))
        wanted = ((beyond < simplex) | (beyond < 0)) & (here != there)
        self.ridge_points = ends[wanted].astype(np.int32)
        self.ridge_items = np.stack([there[wanted], here[wanted]], axis=1).ravel()
        self.ridge_offsets = 2 * np.arange(len(self.ridge_points) + 1)

    # --- in the plane, within a box: the bottoms of prisms ---

    def _build_rectangle(self, points: Floats, weights: Floats | None) -> None:
        """Takes the cells of the points at z = 0 in a box of both signs of z: each is a prism over the cell in the plane."""
        corners = np.asarray(self.box).reshape(2, 2)
        exponent = int(np.frexp(np.abs(corners).max())[1])  # by this power of two no volume leaves the range of doubles
        flat = np.column_stack([shifted(points, -exponent), np.zeros(len(points))])
        box = np.column_stack([shifted(corners, -exponent), [-1.0, 1.0]]).ravel()
        heavy = None if weights is None else shifted(weights, -2 * exponent)
        tri, c = self._cells_of(flat, heavy, box)
        sites = c["site"].astype(np.int64)
        owner = np.repeat(sites, np.diff(c["face_offsets"]).astype(np.int64))
        low = c["vertices"][c["face_vertices"], 2] < 0
        begin, end = _bottom_edges(c["corner_offsets"].astype(np.int64), c["face_vertices"].astype(np.int64), low)
        sides = np.flatnonzero((begin >= 0) & (c["face_neighbours"] >= 0))
        pairs = np.stack([owner[sides], c["face_neighbours"][sides]], axis=1)
        same = _joined(pairs, begin[sides], end[sides], c["vertices"])
        bottoms = c["face_neighbours"] == -5
        counts = np.diff(c["corner_offsets"]).astype(np.int64)
        corners, sizes = _distinct_rounds(same[c["face_vertices"][np.repeat(bottoms, counts)]], counts[bottoms])
        used, items = np.unique(corners, return_inverse=True)
        place = np.full(len(same), -1, np.int64)
        place[used] = np.arange(len(used))
        self.vertices = shifted(c["vertices"][used, :2], exponent)
        ends = place[same[np.stack([begin[sides], end[sides]], axis=1)]]
        wanted = (pairs[:, 0] < pairs[:, 1]) & (ends[:, 0] != ends[:, 1])
        self.ridge_points = pairs[wanted].astype(np.int32)
        self.ridge_items = ends[wanted].ravel()
        self.ridge_offsets = 2 * np.arange(len(self.ridge_points) + 1)
        of_site = np.zeros(len(self.points), np.int64)
        of_site[owner[bottoms]] = sizes
        self._set_regions(tri.representatives, sites, of_site[sites], _reversed_runs(items.ravel(), sizes))

    # --- in space: the library's cells ---

    def _cells_of(self, points: Floats, weights: Floats | None, box: Floats | None) -> tuple[Delaunay, dict[str, Any]]:
        """Returns a triangulation of points in space and the library's cells."""
        tri = self._triangulated(points, weights)

        def cells(p: Floats, w: Floats | None, threads: int, report: Any) -> Any:
            return _native.cells(tri._handle, p, w, box, None, threads, report)

        raw = _calls.of_points(cells, points, weights, self.threads, self.progress, self._limits)
        return tri, {name: part if isinstance(part, float) else np.asarray(part) for name, part in raw.items()}

    def _build_space(self, points: Floats, weights: Floats | None) -> None:
        tri, self.cells = self._cells_of(points, weights, self.box)
        c = self.cells
        self.vertices = c["vertices"]
        corners = np.diff(c["corner_offsets"]).astype(np.int64)
        face_cell = np.repeat(np.arange(len(c["site"])), np.diff(c["face_offsets"]).astype(np.int64))
        owner = c["site"][face_cell].astype(np.int64)
        wanted = owner < c["face_neighbours"]
        self._set_ridges_space(np.stack([owner, c["face_neighbours"]], axis=1), corners, wanted)
        self._set_regions_space(tri, face_cell, corners)

    def _set_ridges_space(self, pairs: Ints, corners: Ints, wanted: NDArray[np.bool_]) -> None:
        open_face = np.isinf(self.cells["face_areas"])[wanted]
        items = self.cells["face_vertices"][np.repeat(wanted, corners)].astype(np.int64)
        counts = corners[wanted]
        starts = np.concatenate([[0], np.cumsum(counts)])
        self.ridge_points = pairs[wanted].astype(np.int32)
        self.ridge_items = np.insert(items, starts[:-1][open_face], -1)
        self.ridge_offsets = np.concatenate([[0], np.cumsum(counts + open_face)])

    def _set_regions_space(self, tri: Delaunay, face_cell: Ints, corners: Ints) -> None:
        c = self.cells
        vertex = c["face_vertices"].astype(np.int64)
        cell = np.repeat(face_cell, corners)
        unbounded = np.flatnonzero(~c["bounded"])
        cell, vertex = np.concatenate([cell, unbounded]), np.concatenate([vertex, np.full(len(unbounded), -1)])
        width = len(self.vertices) + 1
        cell, vertex = np.divmod(np.unique(cell * width + vertex + 1), width)
        self._set_regions(tri.representatives, c["site"].astype(np.int64), np.bincount(cell, minlength=len(c["site"])), vertex - 1)

    # --- both ---

    def _set_regions(self, representatives: NDArray[Any], sites: Ints, counts: Ints, items: Ints) -> None:
        """Region 0 is empty; then come those of the sites."""
        self._sites = sites
        region = np.full(len(self.points), -1, np.int64)
        region[sites] = np.arange(self._empty, self._empty + len(sites))
        self.point_region = region[representatives]
        self.region_offsets = np.concatenate([np.zeros(self._empty + 1, np.int64), np.cumsum(counts)])
        self.region_items = items

    @cached_property
    def regions(self) -> Lists:
        return as_lists(self.region_offsets, self.region_items)

    @cached_property
    def ridge_vertices(self) -> Lists:
        return as_lists(self.ridge_offsets, self.ridge_items)

    @property
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """The vertices of the ridge between two points, by the pair of points."""
        return {(p, q): v for (p, q), v in zip(self.ridge_points.tolist(), self.ridge_vertices)}

    @cached_property
    def volumes(self) -> Floats:
        out = np.zeros(len(self.points))
        if self.ndim == 3:
            out[self.cells["site"]] = self.cells["volume"]
            return frozen(out)
        out[self._sites] = _areas(self.vertices, self.region_offsets, self.region_items)[self._empty :]
        return frozen(out)

    @property
    def ndim(self) -> int:
        return int(self.points.shape[1])

    @property
    def npoints(self) -> int:
        return len(self.points)

    @property
    def min_bound(self) -> Floats:
        return frozen(self.points.min(axis=0))

    @property
    def max_bound(self) -> Floats:
        return frozen(self.points.max(axis=0))

    def add_points(self, points: Any, restart: bool = False, weights: Any = None) -> None:
        """Adds points and builds the diagram again, from all points."""
        if self._closed:
            raise RuntimeError("the diagram is closed: it takes no more points")
        rows = as_rows(points, "points", (self.ndim,))
        added = as_weights(weights, len(rows))
        if (added is None) != (self.weights is None):
            raise ArgumentError("either all points have weights, or none has")
        both = None if added is None or self.weights is None else np.concatenate([self.weights, added])
        bigger = object.__new__(Voronoi)
        for name in ("threads", "progress", "_limits", "furthest_site", "_closed", "_empty", "box"):
            setattr(bigger, name, getattr(self, name))
        bigger._build(np.concatenate([self.points, rows]), both)
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
        return f"<brio.Voronoi of {self.npoints} points: {len(self.vertices)} vertices, {len(self.ridge_points)} ridges>"


def _bottom_edges(offsets: Ints, corners: Ints, low: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Returns, for each face, the two low corners that follow each other, or -1: a side of a prism has one such pair."""
    sizes = np.diff(offsets)
    face = np.repeat(np.arange(len(sizes)), sizes)
    following = np.arange(1, len(corners) + 1)
    ends = offsets[1:][sizes > 0]
    following[ends - 1] = offsets[:-1][sizes > 0]
    here = np.flatnonzero(low & low[following])
    begin, end = np.full(len(sizes), -1, np.int64), np.full(len(sizes), -1, np.int64)
    begin[face[here]], end[face[here]] = corners[here], corners[following[here]]
    return begin, end


def _joined(pairs: Ints, begin: Ints, end: Ints, vertices: Floats) -> Ints:
    """Returns for each corner the first corner of its vertex: a side that two cells share ends at two vertices.

    Cells have corners of their own. The corner where a side begins in one cell is where it ends in the other one. A side
    that only one of the two cells has is so short that rounding made a point of it in the other one: its ends are one vertex.
    So are corners of equal coordinates: a bottom has one of them where a short side has two.
    """
    count = len(vertices)
    width = int(pairs.max(initial=0)) + 1
    there, back = pairs[:, 0] * width + pairs[:, 1], pairs[:, 1] * width + pairs[:, 0]
    order = np.argsort(there)
    place = np.searchsorted(there, back, sorter=order)
    mate = order[np.minimum(place, max(len(order) - 1, 0))]
    both = there[mate] == back if len(order) else np.zeros(0, np.bool_)
    _, equal, of_class = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    a = np.concatenate([begin[both], end[both], begin[~both], np.arange(count)])
    b = np.concatenate([end[mate[both]], begin[mate[both]], end[~both], equal[of_class.ravel()]])
    first = np.arange(count)
    while (first[a] != first[b]).any():  # as often as half a vertex has cells, three or four almost always
        least = np.minimum(first[a], first[b])
        np.minimum.at(first, a, least)
        np.minimum.at(first, b, least)
    return first


def _distinct_rounds(items: Ints, sizes: Ints) -> tuple[Ints, Ints]:
    """Leaves out of runs, each taken as a round, what is equal to the one before it; returns items and sizes."""
    ends = np.cumsum(sizes)
    before = np.arange(-1, len(items) - 1)
    before[(ends - sizes)[sizes > 0]] = ends[sizes > 0] - 1
    kept = items != items[before]
    run = np.repeat(np.arange(len(sizes)), sizes)
    return items[kept], np.bincount(run[kept], minlength=len(sizes))


def _reversed_runs(items: Ints, sizes: Ints) -> Ints:
    """Returns runs one after the other, each backwards."""
    ends = np.cumsum(sizes)
    run = np.repeat(np.arange(len(sizes)), sizes)
    out: Ints = items[(ends - 1)[run] - (np.arange(len(items)) - (ends - sizes)[run])]
    return out


def _areas(vertices: Floats, offsets: Ints, items: Ints) -> Floats:
    """Areas of polygons; infinite for those with -1, or with a vertex that is no double."""
    sizes = np.diff(offsets)
    region = np.repeat(np.arange(len(sizes)), sizes)
    beyond = (items < 0) | ~np.isfinite(vertices[items]).all(axis=1)
    is_open = np.bincount(region, beyond, minlength=len(sizes)) > 0
    is_closed = ~is_open & (sizes > 0)
    corners, sizes = vertices[items[is_closed[region]]], sizes[is_closed]
    starts = np.cumsum(sizes) - sizes
    following = np.arange(1, len(corners) + 1)
    following[starts + sizes - 1] = starts
    origin = corners[np.repeat(starts, sizes)]
    twice, exponent = run_sums(cross(difference(corners, origin), difference(corners[following], origin)), starts)
    areas = np.where(is_open, np.inf, 0.0)
    areas[is_closed] = shifted(twice / 2, exponent)
    return areas
