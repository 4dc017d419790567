"""Triangulations that live: points are inserted, removed and moved."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import Floats, as_array, as_rows, as_weights
from ._calls import Progress, reporting
from ._delaunay import Delaunay
from ._periodic import PeriodicDelaunay, as_cell, as_periodic, of_handle
from .errors import ArgumentError, NotFiniteError

Indices = NDArray[np.uint32]


class DynamicDelaunay:
    """The Delaunay or regular triangulation of points in space that are inserted, removed and moved.

    After any changes it is the triangulation of the points that are left: its snapshot equals ``brio.Delaunay`` of them,
    ties included. A call that raises leaves it as it was.

    Parameters
    ----------
    points : array_like, shape (n, 3), optional
        They get the indices 0 to n - 1.
    weights : array_like, shape (n,), optional
        With weights w, distances are power distances: squared distance minus w.
    cell, periodic, reach : optional
        In space that repeats: see ``brio.PeriodicDynamicDelaunay``, which this makes then.
    weighted : bool
        Whether points may have weights; implied by `weights`.
    threads : int
        The most threads of the library, for building anew; 0 is one for each processor.
    progress : bool or callable, optional
        As of ``brio.Delaunay``.

    Attributes
    ----------
    indices : ndarray of uint32
        The indices of the points that are there, ascending. A point keeps its index.
    points : ndarray of float64, shape (len(indices), 3)
        A copy of their positions.
    weights : ndarray of float64, or None
        A copy of their weights.
    facts : dict
        Counts: indices given out, points, vertices, simplices, hull, dimension; moves that changed no simplex (in_place)
        or needed the point to be taken out (replaced), and how often all was built anew.

    Examples
    --------
    >>> import brio
    >>> tri = brio.DynamicDelaunay([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> tri.insert([[0.2, 0.2, 0.2], [1, 1, 1]]).tolist()
    [4, 5]
    >>> tri.facts["simplices"]
    6
    >>> tri.remove([4])
    >>> sorted(tri.neighbors(0).tolist())
    [1, 2, 3]
    >>> tri.move([5], [[2, 2, 2]])
    >>> tri.snapshot().simplices.shape
    (2, 4)
    """

    def __new__(cls, points: Any = None, weights: Any = None, *, cell: Any = None, **options: Any) -> Any:
        if cell is None or issubclass(cls, PeriodicDynamicDelaunay):
            return object.__new__(cls)
        if cls is not DynamicDelaunay:
            raise TypeError("%s with cell=: a class for space that repeats is derived from PeriodicDynamicDelaunay" % cls.__name__)
        return object.__new__(PeriodicDynamicDelaunay)

    def __init__(self, points: Any = None, weights: Any = None, *, cell: Any = None, weighted: bool = False, threads: int = 0,
                 progress: bool | Progress | None = None) -> None:
        self.threads = threads
        self.progress = progress
        self.weighted = bool(weighted) or weights is not None
        self._handle = _native.dynamic_new(int(self.weighted))
        if points is not None:
            self.insert(points, weights)
        elif weights is not None:
            raise ArgumentError("weights: there are no points; weighted=True allows weights of points that come later")

    # --- changes ---

    def insert(self, points: Any, weights: Any = None) -> Indices:
        """Inserts points, shape (n, 3); returns their indices. Weights that are not given are 0."""
        rows = as_rows(points, "points")
        heavy = as_weights(weights, len(rows))
        with reporting(self.progress) as report:
            try:
                first = _native.dynamic_insert(self._handle, rows, heavy, self.threads, report)
            except NotFiniteError as error:
                _calls.name_guilty(error, rows, heavy)
                raise
        return np.arange(first, first + len(rows), dtype=np.uint32)

    def remove(self, indices: Any) -> None:
        """Removes the points of these indices. Points that they hid come back."""
        self._change(_as_indices(indices), None, None)

    def move(self, indices: Any, points: Any, weights: Any = None) -> None:
        """Moves the points of these indices to other positions; without weights, theirs stay."""
        which, rows = _as_indices(indices), as_rows(points, "points")
        self._change(which, rows, as_weights(weights, len(which)))

    def move_all(self, points: Any) -> None:
        """Moves all points, in the order of `indices`."""
        self._change(None, as_rows(points, "points"), None)

    def reweight(self, indices: Any, weights: Any) -> None:
        """Gives the points of these indices other weights."""
        which = _as_indices(indices)
        if weights is None:
            raise ArgumentError("weights: one a point is wanted, not None")
        self._change(which, None, as_weights(weights, len(which)))

    def _change(self, indices: Indices | None, points: Floats | None, weights: Floats | None) -> None:
        with reporting(self.progress) as report:
            _native.dynamic_change(self._handle, indices, points, weights, self.threads, report)

    # --- questions ---

    @property
    def facts(self) -> dict[str, int]:
        """Counts; see the class."""
        facts: dict[str, int] = _native.dynamic_facts(self._handle)
        return facts

    def __len__(self) -> int:
        return self.facts["points"]

    def _arrays(self) -> tuple[Indices, Floats, Floats]:
        return _of_bytes(_native.dynamic_points(self._handle))

    @property
    def indices(self) -> Indices:
        """The indices of the points that are there, ascending."""
        return self._arrays()[0]

    @property
    def points(self) -> Floats:
        """Their positions."""
        return self._arrays()[1]

    @property
    def weights(self) -> Floats | None:
        """Their weights, or None."""
        return self._arrays()[2] if self.weighted else None

    def neighbors(self, index: int) -> Indices:
        """Returns the indices of the vertices that share an edge with one; none for a point that is no vertex."""
        which = _as_indices([index])
        return np.frombuffer(_native.dynamic_neighbors(self._handle, int(which[0])), np.uint32)

    def find_vertices(self, queries: Any) -> NDArray[np.int64]:
        """Returns, for each position, the indices of the vertices of a simplex that holds it; -1 outside of the hull."""
        rows = as_rows(queries, "queries")
        out = np.empty((len(rows), 4), np.uint32)
        _native.dynamic_locate(self._handle, rows, out)
        found = out.astype(np.int64)
        found[out == np.iinfo(np.uint32).max] = -1
        return found

    def _snapshot(self) -> tuple[Any, Floats, Floats | None]:
        """Returns the triangulation, its points and its weights, of one moment: another thread may change what comes after."""
        with reporting(self.progress) as report:
            handle, arrays = _native.dynamic_snapshot(self._handle, self.threads, report)
        _, points, weights = _of_bytes(arrays)
        return handle, points, weights if self.weighted else None

    def snapshot(self) -> Delaunay:
        """Returns the triangulation as it is now: rows of its points are those of `indices`."""
        handle, points, weights = self._snapshot()
        same = object.__new__(Delaunay)
        same.__dict__ = {"threads": self.threads, "progress": self.progress, "_closed": False, "points": points,
                         "weights": weights, "_handle": handle}
        return same


class PeriodicDynamicDelaunay(DynamicDelaunay):
    """The same of points in space that repeats: ``brio.DynamicDelaunay(points, cell=...)`` makes it.

    After any changes it is ``brio.Delaunay(points, cell=cell)`` of the points that are left. The grid on which positions
    are exact is chosen with the first points and stays; `points` are the positions on it. Points may be in any cell, and
    may move over its borders.

    Parameters
    ----------
    points, weights, weighted, threads, progress
        As of ``brio.DynamicDelaunay``.
    cell : array_like, shape (3, 3) or (3,)
        The vectors of the cell, a row each, of any shape; or the lengths of a box.
    periodic : str or three truth values
        The directions that repeat: "xy" is a slab.
    reach : float, optional
        Where not all directions repeat: points may be half of it, less the vectors of the cell, away from the first
        ones, in coordinates in which vectors of the cell go anywhere. The grid is as much coarser.

    Attributes
    ----------
    indices, points, weights
        As of ``brio.DynamicDelaunay``.
    cell : ndarray of float64, shape (3, 3)
        The vectors as they are used: on the grid.
    facts : dict
        Counts: indices given out, points, translates that are kept, and as of ``brio.DynamicDelaunay``; what was moved
        when points and cell were put on the grid; snapshots that questions needed.

    Examples
    --------
    >>> import brio
    >>> gas = brio.DynamicDelaunay([[0.1, 0.1, 0.1], [0.6, 0.5, 0.4]], cell=[1, 1, 1])
    >>> gas.move([0], [[-0.1, 0.1, 0.1]])  # over the border
    >>> gas.snapshot().check()
    True
    """

    def __init__(self, points: Any = None, weights: Any = None, *, cell: Any, periodic: Any = True, reach: float = 0,
                 weighted: bool = False, threads: int = 0, progress: bool | Progress | None = None) -> None:
        self.threads = threads
        self.progress = progress
        self.weighted = bool(weighted) or weights is not None
        self.periodic = as_periodic(periodic)
        self._given = as_cell(cell)
        unused = tuple(int(not repeats) for repeats in self.periodic)
        rows = as_rows(np.empty((0, 3)) if points is None else points, "points")

        def build(p: Floats, w: Floats | None, threads: int, report: Any) -> Any:
            return _native.dynamic_new_periodic(p, w, int(self.weighted), self._given, unused, float(reach), threads, report)

        self._handle = _calls.of_points(build, rows, as_weights(weights, len(rows)), threads, progress)
        vectors = np.reshape(self.facts["cell"], (3, 3))
        self.cell = np.where(np.asarray(self.periodic)[:, None], vectors, self._given)

    def neighbors(self, index: int) -> tuple[Indices, NDArray[np.int32]]:  # type: ignore[override]
        """Returns the vertices that share an edge with one: ``points[indices] + shifts @ cell``, as two arrays.

        A vertex can have several neighbours that are translates of one point, also of itself.
        """
        which = _as_indices([index])
        rows = np.frombuffer(_native.dynamic_neighbors(self._handle, int(which[0])), np.uint32).reshape(-1, 4)
        return rows[:, 0], rows[:, 1:].view(np.int32)

    def find_vertices(self, queries: Any) -> tuple[NDArray[np.int64], NDArray[np.int32]]:  # type: ignore[override]
        """Returns, for each position, the indices and the shifts of the vertices of a simplex that holds it.

        The shapes are (n, 4) and (n, 4, 3); indices are -1 outside of the hull.
        """
        rows = as_rows(queries, "queries")
        out = np.empty((len(rows), 16), np.uint32)
        _native.dynamic_locate(self._handle, rows, out)
        images = out.reshape(-1, 4, 4)
        found = images[:, :, 0].astype(np.int64)
        found[images[:, :, 0] == np.iinfo(np.uint32).max] = -1
        return found, np.ascontiguousarray(images[:, :, 1:]).view(np.int32)

    def snapshot(self) -> PeriodicDelaunay:  # type: ignore[override]
        """Returns the triangulation as it is now: rows of its points are those of `indices`."""
        handle, points, weights = self._snapshot()
        return of_handle(handle, points, weights, self._given, self.periodic)


def _of_bytes(arrays: tuple[bytearray, bytearray, bytearray]) -> tuple[Indices, Floats, Floats]:
    indices, points, weights = arrays
    return np.frombuffer(indices, np.uint32), np.frombuffer(points).reshape(-1, 3), np.frombuffer(weights)


def _as_indices(indices: Any) -> Indices:
    array = as_array(indices, "indices")
    if array.ndim != 1 or (array.dtype.kind not in "iu" and array.size):
        raise ArgumentError(f"indices: integers in one dimension are wanted, not {array.dtype} of shape {array.shape}")
    if array.size and (array.min() < 0 or array.max() >= 2**32):
        raise ArgumentError(f"indices: there is no point {array[(array < 0) | (array >= 2**32)][0]}")
    return np.ascontiguousarray(array, np.uint32)
