"""Delaunay and regular triangulations, under scipy's names."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _calls, _geometry, _native
from ._arrays import Floats, as_number, as_queries, as_rows, as_weights, frozen
from ._calls import UNLIMITED, Limits, Path, Progress, reporting
from ._estimate import TRIANGULATION, require_memory
from ._scaled import shifted
from ._scipy import other_class
from ._tolerance import STANDARD, border, core, find_within
from .errors import ArgumentError

Ints = NDArray[np.int32]
_SIMPLICES, _MATES, _HULL, _HULL_MATES, _REPRESENTATIVES = range(5)
_FIND_SIMPLEX, _FIND_LEAST_POWER, _FIND_NEAREST = range(3)


def as_tolerance(tol: Any) -> float:
    """Takes a tolerance of barycentric coordinates; None is scipy's."""
    number = STANDARD if tol is None else as_number(tol, "tol")
    if not 0 <= number < np.inf:
        raise ArgumentError(f"tol: a finite number, 0 or more, is wanted, not {tol!r}")
    return number


class Delaunay:
    """The Delaunay triangulation of points in the plane or in space or, with weights, the regular triangulation.

    It is exact: no rounding makes a simplex wrong. It is the same for every order of the points and every number of
    threads. Names, shapes, types and the use of -1 are those of ``scipy.spatial.Delaunay``.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
        C-contiguous float64 is not copied: do not change it while the object is in use.
    weights : array_like, shape (n,), optional
        With weights w, distances are power distances: squared distance minus w.
    threads : int
        The most threads of the library; 0 is one for each processor.
    progress : bool or callable, optional
        True shows a bar (of tqdm, where it is installed). A function is called with the name of the stage and the share
        that is done, up to 50 times a second; if it returns something true, the work ends with CancelledError.
    scratch : str or path, optional
        A folder: large arrays are in files there, which have no names, in place of memory; also those of what is computed
        later. ``brio.TiledDelaunay`` is for points that do not fit in memory themselves.
    max_memory : int, optional
        The most bytes that a call of the library may hold, its result included: OutOfMemoryError beyond, and without
        `scratch` before the work if ``brio.estimate_memory`` is. What is in `scratch` and numpy's arrays do not count.
    cell : array_like, optional
        Makes a PeriodicDelaunay, of space that repeats; `periodic` and `radii` go with it.
    incremental : bool
        Taken for scipy's sake: add_points works in any case.
    furthest_site, qhull_options
        Not offered; see `fallback`.
    fallback : "scipy", optional
        Returns scipy's object where brio does not offer what is asked for: other dimensions, Qhull's options, the
        triangulation of farthest sites.

    Attributes
    ----------
    points : ndarray of float64, shape (npoints, ndim)
    simplices : ndarray of int32, shape (nsimplex, ndim + 1)
        Indices of points; counterclockwise in the plane, positive in space. A read-only view of the library's array.
    neighbors : ndarray of int32, shape (nsimplex, ndim + 1)
        The simplex beyond the facet opposite to each vertex; -1 at the hull.
    equations : ndarray of float64, shape (nsimplex, ndim + 2)
        Normal and offset of the lifted simplices.
    transform : ndarray of float64, shape (nsimplex, ndim + 1, ndim)
        Barycentric transforms; NaN for simplices too flat for them.
    vertex_to_simplex : ndarray of int32, shape (npoints,)
        A simplex of each point, or of the vertex that represents it; -1 if there are no simplices.
    convex_hull : ndarray of int32, shape (nfaces, ndim)
        Facets of the hull; a read-only view.
    coplanar : ndarray of int32, shape (ncoplanar, 3)
        Points that are no vertices: their index, a simplex, and the vertex that represents them.
    vertex_neighbor_vertices : tuple of two ndarrays of int32
        ``indices[indptr[k]:indptr[k + 1]]`` are the neighbours of vertex k.
    hidden, duplicates : ndarray of int64
        Points that own no cell, and points at the position of another one.
    representatives : ndarray of uint32, shape (npoints,)
        For each point, the vertex that represents it: itself if it is a vertex.
    checksum : int
        A hash of the simplices that does not depend on the order of points.

    Examples
    --------
    >>> import brio
    >>> tri = brio.Delaunay([[0, 0], [1, 0], [0, 1], [3, 3]])
    >>> tri.simplices.tolist()
    [[0, 1, 2], [3, 2, 1]]
    >>> tri.neighbors.tolist()
    [[1, -1, -1], [0, -1, -1]]
    >>> tri.find_simplex([[0.2, 0.2], [1, 1], [5, 5]]).tolist()
    [0, 1, -1]
    """

    furthest_site = False
    points: Floats
    weights: Floats | None
    _handle: Any
    _limits: Limits = UNLIMITED

    def __new__(cls, points: Any, weights: Any = None, *, fallback: str | None = None, **options: Any) -> Any:
        if options.get("cell") is not None:
            from ._periodic import PeriodicDelaunay

            return PeriodicDelaunay(points, weights, **options)
        usual = type(points) is np.ndarray and points.ndim == 2 and points.shape[1] in (2, 3)
        if not usual or options or fallback is not None:
            wanted = ("furthest_site", "incremental", "qhull_options")
            scipys: dict[str, Any] = {key: options[key] for key in wanted if key in options}
            other = other_class("Delaunay", points, fallback, scipys)
            if other is not None:
                return other
        return object.__new__(cls)

    def __init__(self, points: Any, weights: Any = None, *, threads: int = 0, progress: bool | Progress | None = None,
                 scratch: Path | None = None, max_memory: float | None = None, furthest_site: bool = False,
                 incremental: bool = False, qhull_options: str | bytes | None = None, fallback: str | None = None) -> None:
        rows = as_rows(points, "points", (2, 3))
        self._limits = scratch, max_memory
        self.threads = threads
        self.progress = progress
        self._closed = False
        self._build(rows, as_weights(weights, len(rows)))

    def _build(self, points: Floats, weights: Floats | None) -> None:
        function = _native.delaunay if points.shape[1] == 3 else _native.delaunay2
        require_memory(points, weights, TRIANGULATION, self.threads, self._limits)
        handle = _calls.of_points(function, points, weights, self.threads, self.progress, self._limits)
        kept = {"threads": self.threads, "progress": self.progress, "_limits": self._limits, "_closed": self._closed}
        self.__dict__ = dict(kept, points=points, weights=weights, _handle=handle)  # at once: other threads may read

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
    def facts(self) -> dict[str, int]:
        """Counts: points, vertices, duplicates, hidden, simplices, hull; and the dimension of the points."""
        facts: dict[str, int] = _native.triangulation_facts(self._handle)
        return facts

    @cached_property
    def min_bound(self) -> Floats:
        return frozen(self.points.min(axis=0))

    @cached_property
    def max_bound(self) -> Floats:
        return frozen(self.points.max(axis=0))

    # --- views of what C has ---

    def _view(self, part: int) -> NDArray[Any]:
        return np.asarray(_native.triangulation_view(self._handle, part))

    @cached_property
    def simplices(self) -> Ints:
        return self._view(_SIMPLICES)

    @cached_property
    def convex_hull(self) -> Ints:
        return self._view(_HULL)[:, :-1]

    @cached_property
    def representatives(self) -> NDArray[np.uint32]:
        return self._view(_REPRESENTATIVES)

    # --- what is computed when first asked for ---

    def _unchanged_points(self) -> Floats:
        """The points; raises ArgumentError if they were changed since the triangulation was built."""
        state = self.__dict__  # read once: add_points in another thread replaces it
        points: Floats = state["points"]
        _native.triangulation_has_points(state["_handle"], points, state["weights"])
        return points

    @cached_property
    def neighbors(self) -> Ints:
        out = np.empty(self.simplices.shape, np.int32)
        _native.triangulation_neighbors(self._handle, out)
        return frozen(out)

    @cached_property
    def vertex_to_simplex(self) -> Ints:
        out = np.empty(self.npoints, np.int32)
        _native.triangulation_vertex_simplices(self._handle, out)
        return frozen(out[self.representatives] if len(self._others) else out)

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[Ints, Ints]:
        if self.ndim == 3:
            offsets, items = _native.triangulation_lists(self._handle, 0)
            return frozen(np.asarray(offsets).astype(np.int32)), np.asarray(items)
        edges = self.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        return _geometry.csr(np.concatenate([edges, edges[:, ::-1]]), self.npoints)

    @cached_property
    def _others(self) -> NDArray[np.int64]:
        """The points that are no vertices."""
        return frozen(np.flatnonzero(self.representatives != np.arange(self.npoints, dtype=np.uint32)))

    @cached_property
    def duplicates(self) -> NDArray[np.int64]:
        others: NDArray[np.int64] = self._others
        points = self._unchanged_points()
        same: NDArray[np.bool_] = (points[others] == points[self.representatives[others]]).all(axis=1)
        return frozen(others[same])

    @cached_property
    def hidden(self) -> NDArray[np.int64]:
        return frozen(np.setdiff1d(self._others, self.duplicates, assume_unique=True))

    @cached_property
    def coplanar(self) -> Ints:
        others = self._others
        columns = [part.astype(np.int32) for part in (others, self.vertex_to_simplex[others], self.representatives[others])]
        return frozen(np.stack(columns, axis=1))

    @cached_property
    def transform(self) -> Floats:
        return frozen(_geometry.barycentric_transforms(self._unchanged_points(), self.simplices))

    @cached_property
    def _lift(self) -> tuple[float, float, int]:
        """scipy's scale and shift of the lifted coordinate, of points divided by 2**exponent, and the exponent.

        They give that coordinate the size of the others, with the point that scipy adds above all.
        """
        points = self._unchanged_points()
        exponent = int(np.frexp(np.abs(points).max(initial=0))[1])
        near = shifted(points, -exponent)
        squares = (near**2).sum(axis=1)
        low, high = squares.min(initial=np.inf), 1.1 * squares.max(initial=0)
        scale = float(max(np.abs(near).max(), np.ptp(near, axis=0).max()) / (high - low)) if high > low else 1.0
        return scale, float(-low * scale) if high > low else 0.0, exponent

    @property
    def paraboloid_scale(self) -> float:
        scale, _, exponent = self._lift
        return float(shifted(scale, -exponent))

    @property
    def paraboloid_shift(self) -> float:
        _, shift, exponent = self._lift
        return float(shifted(shift, exponent))

    def _lifted(self, rows: Floats, weights: Floats | None = None) -> Floats:
        """Returns the lifted coordinate of positions, divided by 2**self._lift[2]."""
        scale, shift, exponent = self._lift
        squares: Floats = (shifted(rows, -exponent) ** 2).sum(axis=1)
        if weights is not None:
            squares = squares - shifted(weights, -2 * exponent)
        return squares * scale + shift

    @cached_property
    def equations(self) -> Floats:
        points = self._unchanged_points()
        lifted = self._lifted(points, self.weights)
        return frozen(_geometry.lower_planes(points, lifted, self._lift[2], self.simplices))

    # --- checks ---

    @cached_property
    def checksum(self) -> int:
        total: int = _native.triangulation_checksum(self._handle, self.points, self.weights, 1, None)
        return total

    def verify(self) -> None:
        """Checks the triangulation exactly and completely against its points; raises CheckError if it is wrong.

        Examples
        --------
        >>> import brio
        >>> brio.Delaunay([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).verify()
        """
        with reporting(self.progress, self._limits) as report:
            _native.triangulation_verify(self._handle, self.points, self.weights, self.threads, report)

    # --- queries ---

    @cached_property
    def _locator(self) -> Any:
        if self.ndim == 2:
            return _native.locator2(self._handle, self.points, self.weights)
        with reporting(self.progress, self._limits) as report:
            return _native.locator(self._handle, self.points, self.weights, self.threads, report)

    def find_simplex(self, xi: Any, bruteforce: bool = False, tol: float | None = None) -> NDArray[Any]:
        """Finds the simplex that holds each position.

        Parameters
        ----------
        xi : array_like, shape (..., ndim)
        bruteforce : bool
            Taken for scipy's sake: all simplices are found that are there in any case.
        tol : float, optional
            A position outside of the hull counts as inside a simplex at the hull if no barycentric coordinate is below
            -tol there. Where that simplex is too flat to have a `transform`, its neighbours count, and their coordinate
            towards it may be -sqrt(tol). The default is scipy's, 100 units in the last place of 1. With 0 the answers are
            exact.

        Returns
        -------
        ndarray of int32, shape (...)
            The simplex of lowest index whose closure holds the position, exactly; outside of the hull one within the
            tolerance, or -1.
        """
        rows, shape = as_queries(xi, self.ndim)
        return self._find(rows, as_tolerance(tol)).reshape(shape)

    def _find(self, rows: Floats, tol: float) -> Ints:
        finite = np.isfinite(rows).all(axis=1)
        if finite.all():
            out = self._locate(rows)
        else:
            out = np.full(len(rows), -1, np.int32)
            out[finite] = self._locate(rows[finite])
        outside = np.flatnonzero(finite & (out < 0))
        if tol and len(outside):
            out[outside] = find_within(self, rows[outside], tol)
        return out

    @cached_property
    def _core(self) -> tuple[int, Floats, float, float]:
        return core(self)

    @cached_property
    def _border(self) -> tuple[Ints, Floats, NDArray[np.bool_]]:
        return border(self)

    def _locate(self, rows: Floats) -> Ints:
        out = np.empty(len(rows), np.int32)
        if self.ndim == 2:
            _native.locate2(self._locator, rows, out, None)
        else:
            _native.locate(self._locator, rows, _FIND_SIMPLEX, out, self.threads, None)
        return out

    def lift_points(self, x: Any) -> Floats:
        """Lifts positions of shape (..., ndim) to the paraboloid: shape (..., ndim + 1)."""
        rows, shape = as_queries(x, self.ndim)
        z = shifted(self._lifted(rows), self._lift[2])
        return np.column_stack([rows, z]).reshape(*shape, self.ndim + 1)

    def plane_distance(self, xi: Any) -> Floats:
        """Returns the distances of lifted positions, shape (..., ndim), from all simplices: shape (..., nsimplex)."""
        exponent = self._lift[2]
        lifted, offsets = shifted(self.lift_points(xi), -exponent), shifted(self.equations[:, -1], -exponent)
        distances: Floats = shifted(lifted @ self.equations[:, :-1].T + offsets, exponent)
        return distances

    # --- scipy's incremental mode ---

    def add_points(self, points: Any, restart: bool = False, weights: Any = None) -> None:
        """Adds points and builds the triangulation again, from all points: there is no cheaper way here.

        Parameters
        ----------
        points : array_like, shape (n, ndim)
        restart : bool
            Taken for scipy's sake.
        weights : array_like, shape (n,)
            Of the new points; needed if the others have weights.
        """
        if self._closed:
            raise RuntimeError("the triangulation is closed: it takes no more points")
        rows = as_rows(points, "points", (self.ndim,))
        added = as_weights(weights, len(rows))
        if (added is None) != (self.weights is None):
            raise ArgumentError("either all points have weights, or none has")
        both = None if added is None or self.weights is None else np.concatenate([self.weights, added])
        self._build(np.concatenate([self.points, rows]), both)

    def _as_it_is(self) -> "Delaunay":
        """The same triangulation, which later add_points of this one do not change."""
        same: Delaunay = object.__new__(type(self))
        same.__dict__ = self.__dict__.copy()
        return same

    def close(self) -> None:
        """Ends the adding of points. What was computed stays until the object goes."""
        self._closed = True

    def __getstate__(self) -> dict[str, Any]:
        return {"points": self.points, "weights": self.weights, "threads": self.threads, "_limits": self._limits,
                "_closed": self._closed}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.threads, self.progress, self._closed = state["threads"], None, state["_closed"]
        self._limits = state.get("_limits", UNLIMITED)
        self._build(state["points"], state["weights"])

    def __getnewargs__(self) -> tuple[Any, ...]:
        return (self.points,)

    def __repr__(self) -> str:
        return f"<brio.Delaunay of {self.npoints} points: {self.nsimplex} simplices>"
