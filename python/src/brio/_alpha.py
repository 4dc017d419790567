"""Alpha complexes and alpha shapes. Alpha is a squared radius, as in the papers, GUDHI and CGAL."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import Floats, as_number, frozen
from ._calls import Path, Progress, reporting
from ._delaunay import Delaunay
from ._mesh import Mesh
from .errors import ArgumentError, NoAnswerError


class AlphaComplex:
    """The simplices of a Delaunay or regular triangulation with their values in the alpha filtration.

    Attributes
    ----------
    ndim : int
    simplices : list of ndim + 1 ndarrays of uint32, shapes (n, 1) to (n, ndim + 1)
        Vertices, edges, triangles and, in space, tetrahedra.
    values : list of ndim + 1 ndarrays of float64
        The least alpha at which each simplex is in the complex.
    solid : list of ndim + 1 ndarrays of float64
        The least alpha at which a tetrahedron (in the plane, a triangle) with the simplex is.
    gabriel : list of ndim + 1 ndarrays of bool
    order : ndarray of uint32
        The numbers of all simplices as they enter: those of vertices come first, then edges, and so on.
    """

    def __init__(self, tri: Delaunay) -> None:
        if not isinstance(tri, Delaunay):
            raise ArgumentError(f"tri: a brio.Delaunay is wanted, not {type(tri).__name__}")
        self._tri = tri = tri._as_it_is()
        with reporting(tri.progress, tri._limits) as report:
            views = _native.alpha_values(tri._handle, tri.points, tri.weights, tri.threads, report)
        self.points, self.weights, self._complex, self.ndim = tri.points, tri.weights, views["complex"], tri.ndim
        self.simplices: list[NDArray[np.uint32]] = [np.asarray(view) for view in views["simplices"]]
        self.values: list[Floats] = [np.asarray(view) for view in views["values"]]
        self.solid: list[Floats] = [np.asarray(view) for view in views["solid"]]
        self.gabriel: list[NDArray[np.bool_]] = [np.asarray(view) for view in views["gabriel"]]
        order = np.empty(sum(len(part) for part in self.values), np.uint32)
        _native.alpha_order(self._complex, order)
        self.order: NDArray[np.uint32] = frozen(order)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._tri,)

    def __repr__(self) -> str:
        return f"<brio.AlphaComplex of {len(self.points)} points: {len(self.order)} simplices>"

    def auto_alpha(self) -> float:
        """The least alpha whose tetrahedra are one solid, or whose triangles one region, that has all vertices."""
        alpha: float = _native.alpha_auto(self._complex)
        return alpha

    def filtration(self) -> Iterator[tuple[tuple[int, ...], float]]:
        """The simplices with their values, as they enter: faces before what they bound."""
        simplices = [tuple(row) for part in self.simplices for row in part.tolist()]
        values = [value for part in self.values for value in part.tolist()]
        for number in self.order.tolist():
            yield simplices[number], values[number]

    def shape(self, alpha: float) -> "AlphaShape":
        """The alpha shape for `alpha`, a squared radius: see AlphaShape."""
        alpha = as_number(alpha, "alpha")
        handle, counts = (self._in_plane if self.ndim == 2 else self._in_space)(alpha)
        shape: AlphaShape = AlphaShape._of(handle)
        shape.alpha, shape.counts, shape.complex = alpha, counts, self
        return shape

    def _in_space(self, alpha: float) -> tuple[Any, dict[str, int]]:
        made: tuple[Any, dict[str, int]] = _native.alpha_shape(self._complex, self.points, self.weights, alpha)
        return made

    def _in_plane(self, alpha: float) -> tuple[Any, dict[str, int]]:
        """The triangles of at most `alpha`, and their border."""
        if np.isnan(alpha):
            raise ArgumentError("alpha is NaN")
        points = self.points.copy()  # other threads may write to the caller's array
        _native.triangulation_has_points(self._tri._handle, points, self.weights)
        inside = self.values[2] <= alpha
        if not inside.any():
            raise NoAnswerError(f"no triangle has a value of at most alpha = {alpha:g}")
        if max(abs(alpha), np.abs(self.values[0]).max()) < np.finfo(np.float64).tiny:  # as brio_alpha_shape
            raise NoAnswerError(f"squared radii of at most alpha = {alpha:g} are beyond doubles: scale the points up")
        triangles, mates = self._tri.simplices[inside], self._tri.neighbors[inside]
        is_border = (mates < 0) | ~inside[mates]
        border = np.concatenate([triangles[is_border[:, k]][:, [(k + 1) % 3, (k + 2) % 3]] for k in range(3)])
        used = np.unique(triangles)
        place = np.zeros(len(points), np.uint32)
        place[used] = np.arange(len(used), dtype=np.uint32)
        vertices = np.column_stack([points[used], np.zeros(len(used))])
        counts = {"triangles": int(inside.sum()), "vertices": len(used),
                  "uncovered": int((self.solid[0] > alpha).sum()),
                  "singular_vertices": int(((self.values[0] <= alpha) & (self.solid[0] > alpha)).sum()),
                  "singular_edges": int(((self.values[1] <= alpha) & (self.solid[1] > alpha)).sum())}
        offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.uint64)
        corners = place[triangles.ravel()]
        return _native.mesh(vertices, offsets, corners, None, np.ascontiguousarray(place[border]), {}, None, {}), counts


def alpha_complex(points: Any, weights: Any = None, *, threads: int = 0, progress: bool | Progress | None = None,
                  scratch: Path | None = None, max_memory: float | None = None, cell: Any = None, periodic: Any = True) -> Any:
    """Computes the alpha filtration of points in the plane or in space or, with weights, the weighted one.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
    weights : array_like, shape (n,), optional
    threads, progress, scratch, max_memory
        As for Delaunay.
    cell, periodic
        Of points in space that repeats: as of PeriodicDelaunay.

    Returns
    -------
    AlphaComplex, or PeriodicAlphaComplex with a cell

    Examples
    --------
    >>> import brio
    >>> complex = brio.alpha_complex([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]])
    >>> [len(part) for part in complex.values]
    [4, 6, 4, 1]
    >>> sorted(complex.values[1].tolist())
    [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
    """
    if cell is not None:
        from ._periodic import PeriodicAlphaComplex, PeriodicDelaunay

        tri = PeriodicDelaunay(points, weights, cell=cell, periodic=periodic, threads=threads, progress=progress,
                               scratch=scratch, max_memory=max_memory)
        return PeriodicAlphaComplex(tri, threads=threads, progress=progress)
    if periodic is not True:
        raise ArgumentError("periodic: there is no cell, whose vectors it names")
    return AlphaComplex(Delaunay(points, weights, threads=threads, progress=progress, scratch=scratch, max_memory=max_memory))


class AlphaShape(Mesh):
    """The alpha shape of points, a Mesh: in space the closed, manifold border of the tetrahedra of at most alpha.

    In the plane the faces are the triangles of at most alpha (z is 0), and `edges` their border, with the triangles to
    its left.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
    alpha : float, optional
        A squared radius; the default is the least one of a single solid (in the plane, region) that has all vertices.
    weights, threads, progress, scratch, max_memory
        As for Delaunay.
    cell, periodic
        Of points in space that repeats: the result is a PeriodicAlphaShape.

    Attributes
    ----------
    alpha : float
    counts : dict
        Of the tetrahedra (triangles) in the complex, of vertices on the surface and of those in no tetrahedron
        ("uncovered"), of simplices that bound no tetrahedron ("singular_...").
    complex : AlphaComplex

    Examples
    --------
    >>> import brio, itertools
    >>> shape = brio.AlphaShape(list(itertools.product(range(3), repeat=3)))
    >>> shape.alpha, round(shape.certificate.volume, 9)
    (0.75, 8.0)
    >>> flat = brio.AlphaShape([[0, 0], [1, 0], [1, 1], [0, 1], [9, 0]], 1.0)
    >>> len(flat.faces), len(flat.edges), flat.counts["uncovered"]
    (2, 4, 1)
    """

    alpha: float
    counts: dict[str, int]
    complex: AlphaComplex

    def __new__(cls, points: Any = None, alpha: float | None = None, weights: Any = None, *, cell: Any = None,
                **options: Any) -> Any:
        if cell is None:
            return super().__new__(cls)
        complex = alpha_complex(points, weights, cell=cell, **options)
        return complex.shape(complex.auto_alpha() if alpha is None else alpha)

    def __init__(self, points: Any, alpha: float | None = None, weights: Any = None, *, threads: int = 0,
                 progress: bool | Progress | None = None, scratch: Path | None = None, max_memory: float | None = None,
                 cell: None = None, periodic: Any = True) -> None:
        complex = alpha_complex(points, weights, threads=threads, progress=progress, scratch=scratch, max_memory=max_memory,
                                cell=cell, periodic=periodic)
        made = complex.shape(complex.auto_alpha() if alpha is None else alpha)
        self._take(made._handle)
        self.alpha, self.counts, self.complex = made.alpha, made.counts, complex
