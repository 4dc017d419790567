"""Triangulations and cells of points in space that repeats."""

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import Floats, as_box, as_floats, as_number, as_queries, as_rows, as_weights, freeze_all, frozen
from ._calls import UNLIMITED, Limits, Path, Progress
from ._estimate import TRIANGULATION, require_memory
from ._mesh import Mesh
from .errors import ArgumentError, CheckError

Ints = NDArray[np.int64]
_IMAGES, _POSITIONS, _SIMPLICES, _MATES, _HULL, _REPRESENTATIVES = range(6)


def as_cell(cell: Any) -> Floats:
    """Takes three vectors as rows, or three lengths of a box."""
    rows = as_floats(cell, "cell")
    if rows.shape == (3,):
        return np.diag(rows)
    if rows.shape != (3, 3):
        raise ArgumentError(f"cell: 3 by 3 numbers, a vector a row, or 3 lengths are wanted, not an array of shape {rows.shape}")
    return np.ascontiguousarray(rows)


def as_periodic(periodic: Any) -> tuple[bool, bool, bool]:
    """Takes directions as letters, such as "xy", or as three truth values."""
    if isinstance(periodic, str):
        if not periodic or set(periodic) - set("xyz"):
            raise ArgumentError(f'periodic: letters of "xyz" are wanted, not {periodic!r}')
        return ("x" in periodic, "y" in periodic, "z" in periodic)
    values = np.asarray(periodic)
    if values.shape == ():
        values = np.repeat(values, 3)
    if values.shape != (3,):
        raise ArgumentError(f"periodic: three truth values are wanted, not {periodic!r}")
    return (bool(values[0]), bool(values[1]), bool(values[2]))


def as_weights_or_radii(weights: Any, radii: Any, count: int) -> Floats | None:
    """Takes weights, or their square roots."""
    if radii is None:
        return as_weights(weights, count)
    if weights is not None:
        raise ArgumentError("weights or radii, not both: a weight is the square of a radius")
    taken = as_weights(radii, count)
    return None if taken is None else taken * taken


class PeriodicDelaunay:
    """The Delaunay triangulation of points in space that repeats or, with weights, the regular triangulation.

    ``brio.Delaunay(points, cell=...)`` makes it: one simplex of each class of translates. It is exact on a grid finer
    than 2^-47 of the cell. Up to that grid the origin and the choice of translates do not matter.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        They may lie outside the cell.
    weights : array_like, shape (n,), optional
    cell : array_like, shape (3, 3) or (3,)
        The vectors of the cell, a row each, of any shape; or the lengths of a box.
    periodic : str or three truth values
        The directions that repeat, such as "xy": those of the first and the second vector.
    radii : array_like, shape (n,), optional
        In place of weights: their square roots.
    threads, progress, scratch, max_memory
        As for Delaunay.

    Attributes
    ----------
    image_points, image_shifts : ndarrays of int32, shapes (nimages,) and (nimages, 3)
        The translates that simplices name: image i is ``points[image_points[i]] + image_shifts[i] @ cell``. The first n
        are of the points, one each.
    image_positions : ndarray of float64, shape (nimages, 3)
    simplices : ndarray of int32, shape (nsimplex, 4)
        Indices of images; positive.
    neighbors : ndarray of int32, shape (nsimplex, 4)
        The class of the simplex beyond each facet; -1 at the hull, where not all directions repeat.
    representatives, representative_shifts : ndarrays of int32
        For each point, the vertex that represents it, and which translate of it.
    cell : ndarray of float64, shape (3, 3)
        As it was used.
    facts : dict
        Counts, and what was moved when points and cell were put on the grid.
    checksum : int
        A hash that does not depend on the order of points, the origin, or which translates were given.

    Examples
    --------
    >>> import brio
    >>> tri = brio.Delaunay([[0, 0, 0]], cell=[1, 1, 1])
    >>> tri.nsimplex, tri.facts["images"]
    (6, 8)
    """

    _limits: Limits = UNLIMITED

    def __init__(self, points: Any, weights: Any = None, *, cell: Any, periodic: Any = True, radii: Any = None,
                 threads: int = 0, progress: bool | Progress | None = None, scratch: Path | None = None,
                 max_memory: float | None = None) -> None:
        self._limits = scratch, max_memory
        self.points = as_rows(points, "points", (3,))
        self.weights = as_weights_or_radii(weights, radii, len(self.points))
        self.periodic = as_periodic(periodic)
        vectors = as_cell(cell)
        self._given = np.array(vectors)
        unused = tuple(int(not repeats) for repeats in self.periodic)

        def build(p: Floats, w: Floats | None, threads: int, report: Any) -> Any:
            return _native.periodic(p, w, vectors, unused, threads, report)

        require_memory(self.points, self.weights, TRIANGULATION, threads, self._limits, vectors, unused)
        self._show(_calls.of_points(build, self.points, self.weights, threads, progress, self._limits))

    def _show(self, handle: Any) -> None:
        """Takes what a handle has."""
        vectors = self._given
        self._handle = handle
        self.facts: dict[str, Any] = _native.periodic_facts(self._handle)
        self.cell = np.where(np.asarray(self.periodic)[:, None], np.reshape(self.facts.pop("cell"), (3, 3)), vectors)
        images = self._view(_IMAGES)
        self.image_points, self.image_shifts = images[:, 0], images[:, 1:]
        freeze_all(self.__dict__)

    def _view(self, part: int) -> NDArray[Any]:
        return np.asarray(_native.periodic_view(self._handle, part))

    @property
    def simplices(self) -> NDArray[np.int32]:
        return self._view(_SIMPLICES)

    @property
    def image_positions(self) -> Floats:
        return self._view(_POSITIONS)

    @cached_property
    def neighbors(self) -> NDArray[np.int32]:
        beyond = (self._view(_MATES) >> 2).astype(np.int32)
        beyond[beyond >= self.nsimplex] = -1
        return frozen(beyond)

    @property
    def hull(self) -> NDArray[np.int32]:
        """Facets of the hull, as indices of images."""
        return self._view(_HULL)[:, :3]

    @property
    def representatives(self) -> NDArray[np.int32]:
        return self._view(_REPRESENTATIVES)[:, 0]

    @property
    def representative_shifts(self) -> NDArray[np.int32]:
        return self._view(_REPRESENTATIVES)[:, 1:]

    @property
    def nsimplex(self) -> int:
        return int(self.facts["tetrahedra"])

    @property
    def npoints(self) -> int:
        return len(self.points)

    @cached_property
    def checksum(self) -> int:
        return int(_native.periodic_checksum(self._handle))

    @cached_property
    def _locator(self) -> Any:
        return _native.periodic_locator(self._handle, 0, None)

    def _locate(self, xi: Any, nearest: bool) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        rows, shape = as_queries(xi, 3)
        found = np.empty((len(rows), 4), np.int32)
        _native.periodic_locate(self._locator, rows, int(nearest), found, 0, None)
        return found[:, 0].reshape(shape), found[:, 1:].reshape((*shape, 3))

    def find_simplex(self, xi: Any) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Finds the simplex that holds each position, exactly: its index, and the shift by which it has to be moved.

        Positions may lie in any cell. Where not all directions repeat, positions outside have the index -1.

        Parameters
        ----------
        xi : array_like, shape (..., 3)

        Returns
        -------
        simplices, shifts : ndarrays of int32, shapes (...) and (..., 3)
            Position k is in ``simplices[k]``, moved by ``shifts[k] @ cell``.

        Examples
        --------
        >>> import brio
        >>> tri = brio.Delaunay([[0, 0, 0]], cell=[1, 1, 1])
        >>> first, other = (tri.find_simplex([0.5, 0.2, z]) for z in (0.1, 5.1))
        >>> int(first[0] - other[0]), (other[1] - first[1]).tolist()
        (0, [0, 0, 5])
        """
        return self._locate(xi, False)

    def nearest(self, xi: Any) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Finds the nearest vertex of each position or, with weights, the vertex of least power distance.

        Parameters
        ----------
        xi : array_like, shape (..., 3)

        Returns
        -------
        points, shifts : ndarrays of int32, shapes (...) and (..., 3)
            The vertex is ``points[k] + shifts[k] @ cell``.

        Examples
        --------
        >>> import brio
        >>> tri = brio.Delaunay([[0.1, 0, 0], [0.5, 0.5, 0.5]], cell=[1, 1, 1])
        >>> point, shift = tri.nearest([0.9, 0, 3])
        >>> int(point), shift.tolist()
        (0, [1, 0, 3])
        """
        return self._locate(xi, True)

    def check(self) -> bool:
        """Checks the triangulation exactly, without the code that made it."""
        try:
            _native.periodic_check(self._handle)
        except CheckError:
            return False
        return True

    def __reduce__(self) -> tuple[Any, ...]:
        """What pickle and copy take; the triangulation is made again."""
        return _made_again, (self.points, self.weights, self._given, self.periodic)

    def __repr__(self) -> str:
        return f"<brio.PeriodicDelaunay of {self.npoints} points: {self.nsimplex} simplices>"


def of_handle(handle: Any, points: Floats, weights: Floats | None, cell: Floats, periodic: tuple[bool, bool, bool]) -> PeriodicDelaunay:
    """A triangulation that is there."""
    same = object.__new__(PeriodicDelaunay)
    same.points, same.weights, same.periodic, same._given = points, weights, periodic, np.array(cell)
    same._show(handle)
    return same


def _made_again(points: Floats, weights: Floats | None, cell: Floats, periodic: tuple[bool, bool, bool]) -> PeriodicDelaunay:
    return PeriodicDelaunay(points, weights, cell=cell, periodic=periodic)


class PeriodicVoronoi:
    """The Voronoi cells of points in space that repeats or, with weights, the power cells.

    ``brio.Voronoi(points, cell=...)`` makes it. Cells are those of the points where they are given.

    Parameters
    ----------
    points, weights, cell, periodic, radii, threads, progress, scratch, max_memory
        As for PeriodicDelaunay.
    box : array_like, shape (2, 3) or (6,), optional
        Clips the cells along coordinates in which no vector of the cell goes anywhere, such as z of a slab.
    vertices : bool
        Whether `vertices`, `face_vertices` and `corner_offsets` are made.

    Attributes
    ----------
    volumes, areas : ndarrays of float64, shape (n,)
        Of each point's cell, and of its surface; 0 for points without a cell.
    centroids : ndarray of float64, shape (n, 3)
        NaN for points without a cell. Volumes and neighbours are there at once. Areas, centroids, and areas and normals of
        faces are computed together when one of them is first asked for, which takes about three times as long.
    neighbor_offsets, neighbor_points, neighbor_shifts : ndarrays of int64, int64 and int32
        Face k of point i's cell, k from ``neighbor_offsets[i]`` to ``neighbor_offsets[i + 1] - 1``, is shared with the
        cell of ``points[neighbor_points[k]] + neighbor_shifts[k] @ cell``.
    face_areas, face_normals : ndarrays of float64, shapes (nfaces,) and (nfaces, 3)
        Of each face; normals point out of the cell.
    vertices, face_vertices, corner_offsets : ndarrays, or None
        Face k has the corners ``face_vertices[corner_offsets[k]:corner_offsets[k + 1]]``.
    delaunay : PeriodicDelaunay

    Examples
    --------
    >>> import brio
    >>> fcc = brio.Voronoi([[0, 0, 0]], cell=[[0, 1, 1], [1, 0, 1], [1, 1, 0]])
    >>> fcc.volumes.tolist(), fcc.coordination().tolist()
    ([2.0], [12])
    """

    def __init__(self, points: Any, weights: Any = None, *, cell: Any, periodic: Any = True, radii: Any = None, box: Any = None,
                 vertices: bool = False, threads: int = 0, progress: bool | Progress | None = None,
                 scratch: Path | None = None, max_memory: float | None = None) -> None:
        self.delaunay = PeriodicDelaunay(points, weights, cell=cell, periodic=periodic, radii=radii, threads=threads,
                                         progress=progress, scratch=scratch, max_memory=max_memory)
        self._walls = None if box is None else as_box(box, 3)
        self._threads = threads
        c = self._compute(vertices, not vertices, progress)
        self._site: NDArray[np.uint32] = c["site"]
        count = self.npoints
        if len(self._site) == count:
            self.volumes: Floats = c["volume"]
            self.neighbor_offsets: Ints = c["face_offsets"].view(np.int64)
        else:
            self.volumes = self._of_points(c["volume"], 0.0)
            faces = np.zeros(count, np.int64)
            faces[self._site] = np.diff(c["face_offsets"]).astype(np.int64)
            self.neighbor_offsets = np.concatenate([[0], np.cumsum(faces)])
        self.neighbor_points, self.neighbor_shifts = c["face_neighbours"], c["face_shifts"]
        self.vertices = c["vertices"] if vertices else None
        self.face_vertices = c["face_vertices"] if vertices else None
        self.corner_offsets = c["corner_offsets"] if vertices else None
        if vertices:
            self._sizes = c
        freeze_all(self.__dict__)

    def _compute(self, vertices: bool, quick: bool, progress: bool | Progress | None) -> dict[str, Any]:
        """Computes the cells; `quick`: volumes and neighbours alone."""
        with _calls.reporting(progress, self.delaunay._limits) as report:
            raw = _native.periodic_cells(self.delaunay._handle, self._walls, int(vertices), int(quick), self._threads, report)
        return {name: part if isinstance(part, float) or part is None else np.asarray(part) for name, part in raw.items()}

    def _of_points(self, values: NDArray[Any], missing: float) -> Floats:
        """Makes a row for each point of the rows of cells."""
        if len(values) == self.npoints:
            return frozen(values)
        rows: Floats = np.full((self.npoints, *values.shape[1:]), missing)
        rows[self._site] = values
        return frozen(rows)

    @cached_property
    def _sizes(self) -> dict[str, Any]:
        return self._compute(False, False, None)

    @cached_property
    def areas(self) -> Floats:
        return self._of_points(self._sizes["area"], 0.0)

    @cached_property
    def centroids(self) -> Floats:
        return self._of_points(self._sizes["centroid"], np.nan)

    @property
    def face_areas(self) -> Floats:
        return frozen(self._sizes["face_areas"])

    @property
    def face_normals(self) -> Floats:
        return frozen(self._sizes["face_normals"])

    @property
    def points(self) -> Floats:
        return self.delaunay.points

    @property
    def cell(self) -> Floats:
        return self.delaunay.cell

    @property
    def npoints(self) -> int:
        return self.delaunay.npoints

    def coordination(self, least: float = 0.0) -> Ints:
        """Counts each point's faces of more than the share `least` of its cell's surface.

        Which faces there are is exact. In a lattice whose symmetry doubles cannot hold, such as a hexagonal one, faces of
        rounding's size appear: 1e-9 leaves them out.
        """
        owner = np.repeat(np.arange(self.npoints), np.diff(self.neighbor_offsets))
        return np.bincount(owner[self.face_areas > least * self.areas[owner]], minlength=self.npoints)

    def __repr__(self) -> str:
        return f"<brio.PeriodicVoronoi of {self.npoints} points: {len(self.neighbor_points)} faces>"


class PeriodicAlphaComplex:
    """The simplices of a triangulation in space that repeats, one of each class of translates, with their values.

    ``brio.alpha_complex(points, cell=...)`` makes it. A simplex enters the alpha complex at its value, a squared radius.

    Parameters
    ----------
    tri : PeriodicDelaunay

    Attributes
    ----------
    image_points, image_shifts, image_positions : ndarrays
        The translates that simplices name, as of PeriodicDelaunay; there are more of them here.
    simplices : list of 4 ndarrays of uint32, shapes (n, 1) to (n, 4)
        Indices of images. Vertices, edges, triangles and tetrahedra; these come in the order of ``tri.simplices``.
    values, solid, gabriel : lists of 4 ndarrays
        As of AlphaComplex.

    Examples
    --------
    >>> import brio
    >>> complex = brio.alpha_complex([[0, 0, 0]], cell=[1, 1, 1])
    >>> [len(part) for part in complex.values], complex.auto_alpha()
    ([1, 7, 12, 6], 0.75)
    """

    ndim = 3

    def __init__(self, tri: PeriodicDelaunay, *, threads: int = 0, progress: bool | Progress | None = None) -> None:
        if not isinstance(tri, PeriodicDelaunay):
            raise ArgumentError(f"tri: a brio.Delaunay with a cell is wanted, not {type(tri).__name__}")
        self.tri = tri
        with _calls.reporting(progress, tri._limits) as report:
            views = _native.periodic_alpha(tri._handle, threads, report)
        self._complex = views["complex"]
        images = np.asarray(views["images"])
        self.image_points, self.image_shifts = images[:, 0], images[:, 1:]
        self.image_positions: Floats = np.asarray(views["positions"])
        self.simplices: list[NDArray[np.uint32]] = [np.asarray(view) for view in views["simplices"]]
        self.values: list[Floats] = [np.asarray(view) for view in views["values"]]
        self.solid: list[Floats] = [np.asarray(view) for view in views["solid"]]
        self.gabriel: list[NDArray[np.bool_]] = [np.asarray(view) for view in views["gabriel"]]
        freeze_all(self.__dict__)

    @property
    def points(self) -> Floats:
        return self.tri.points

    def auto_alpha(self) -> float:
        """The least alpha whose tetrahedra, joined with their translates, are one solid that has all vertices."""
        alpha: float = _native.periodic_alpha_auto(self._complex)
        return alpha

    def filtration(self) -> Iterator[tuple[tuple[int, ...], float]]:
        """The simplices by their points, with their values, as they enter: the filtration of a torus.

        Raises NoAnswerError where two simplices have the same points, as in a cell of few: repeat the cell then.
        """
        named = _native.periodic_alpha_by_points(self._complex)
        order = np.empty(sum(len(part) for part in self.values), np.uint32)
        _native.alpha_order(named["complex"], order)
        simplices = [tuple(row) for part in named["simplices"] for row in np.asarray(part).tolist()]
        values = [value for part in self.values for value in part.tolist()]
        for number in order.tolist():
            yield simplices[number], values[number]

    def shape(self, alpha: float) -> "PeriodicAlphaShape":
        """The alpha shape for `alpha`, a squared radius: see PeriodicAlphaShape."""
        alpha = as_number(alpha, "alpha")
        handle, counts = _native.periodic_alpha_shape(self._complex, alpha)
        shape: PeriodicAlphaShape = PeriodicAlphaShape._of(handle)
        shape.alpha, shape.counts, shape.complex = alpha, counts, self
        return shape

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.tri,)

    def __repr__(self) -> str:
        return f"<brio.PeriodicAlphaComplex of {len(self.points)} points: {sum(map(len, self.values))} simplices>"


class PeriodicAlphaShape(Mesh):
    """The alpha shape of points in space that repeats: the border of the tetrahedra of at most alpha, a Mesh.

    ``brio.AlphaShape(points, alpha, cell=...)`` makes it. The surface is closed; the mesh has one triangle of each class of
    translates, and is cut open where the surface goes on at a translate. Its `properties` say which translate a vertex
    is ("point", "shift_a", "shift_b", "shift_c"); vertices of one "sheet" are one vertex of the surface.

    Attributes
    ----------
    alpha : float
    counts : dict
        As of AlphaShape, and of the surface in a cell: "components", "euler" (vertices - edges + faces), "area", and the
        "volume" of the solid.
    complex : PeriodicAlphaComplex

    Examples
    --------
    >>> import brio, itertools
    >>> grid = list(itertools.product(range(4), repeat=3))
    >>> shape = brio.AlphaShape(grid[1:], 0.75, cell=[4, 4, 4])  # a grid without one point
    >>> round(64 - shape.counts["volume"], 9), shape.counts["euler"]
    (1.333333333, 2)
    """

    alpha: float
    counts: dict[str, Any]
    complex: PeriodicAlphaComplex
