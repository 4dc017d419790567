"""Alpha complexes and alpha shapes. Alpha is a squared radius, as in the papers, GUDHI and CGAL."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import Floats
from ._calls import Progress, reporting
from ._delaunay import Delaunay
from ._mesh import Mesh
from .errors import NotOfferedError


class AlphaComplex:
    """The simplices of a Delaunay or regular triangulation with their values in the alpha filtration.

    Attributes
    ----------
    simplices : list of four ndarrays of uint32, shapes (n, 1) to (n, 4)
        Vertices, edges, triangles, tetrahedra.
    values : list of four ndarrays of float64
        The least alpha at which each simplex is in the complex.
    solid : list of four ndarrays of float64
        The least alpha at which a tetrahedron with the simplex is.
    gabriel : list of four ndarrays of bool
    order : ndarray of uint32
        The numbers of all simplices as they enter: those of vertices come first, then edges, and so on.
    """

    def __init__(self, tri: Delaunay) -> None:
        with reporting(tri.progress) as report:
            views = _native.alpha_values(tri._handle, tri.points, tri.weights, tri.threads, report)
        self.points, self.weights, self._complex = tri.points, tri.weights, views["complex"]
        self.simplices: list[NDArray[np.uint32]] = [np.asarray(view) for view in views["simplices"]]
        self.values: list[Floats] = [np.asarray(view) for view in views["values"]]
        self.solid: list[Floats] = [np.asarray(view) for view in views["solid"]]
        self.gabriel: list[NDArray[np.bool_]] = [np.asarray(view) for view in views["gabriel"]]
        self.order: NDArray[np.uint32] = np.empty(sum(len(part) for part in self.values), np.uint32)
        _native.alpha_order(self._complex, self.order)

    def auto_alpha(self) -> float:
        """The least alpha whose tetrahedra are one solid that has all vertices."""
        alpha: float = _native.alpha_auto(self._complex)
        return alpha

    def filtration(self) -> Iterator[tuple[tuple[int, ...], float]]:
        """The simplices with their values, as they enter: faces before what they bound."""
        simplices = [tuple(row) for part in self.simplices for row in part.tolist()]
        values = [value for part in self.values for value in part.tolist()]
        for number in self.order.tolist():
            yield simplices[number], values[number]

    def shape(self, alpha: float) -> "AlphaShape":
        """The boundary of the tetrahedra with values of at most `alpha`."""
        handle, counts = _native.alpha_shape(self._complex, self.points, self.weights, float(alpha))
        shape: AlphaShape = AlphaShape._of(handle)
        shape.alpha, shape.counts, shape.complex = float(alpha), counts, self
        return shape


def alpha_complex(points: Any, weights: Any = None, *, threads: int = 0,
                  progress: bool | Progress | None = None) -> AlphaComplex:
    """Computes the alpha filtration of points in space or, with weights, the weighted one.

    Parameters
    ----------
    points : array_like, shape (n, 3)
    weights : array_like, shape (n,), optional

    Returns
    -------
    AlphaComplex

    Examples
    --------
    >>> import brio
    >>> complex = brio.alpha_complex([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]])
    >>> [len(part) for part in complex.values]
    [4, 6, 4, 1]
    >>> sorted(complex.values[1].tolist())
    [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
    """
    tri = Delaunay(points, weights, threads=threads, progress=progress)
    if tri.ndim != 3:
        raise NotOfferedError("alpha complexes of points in the plane are not offered")
    return AlphaComplex(tri)


class AlphaShape(Mesh):
    """The alpha shape of points in space: a closed, manifold Mesh.

    Parameters
    ----------
    points : array_like, shape (n, 3)
    alpha : float, optional
        A squared radius; the default is the least one of a single solid that has all vertices.
    weights, threads, progress
        As for Delaunay.

    Attributes
    ----------
    alpha : float
    counts : dict
        Of the tetrahedra in the complex, of vertices on the surface and of those in no tetrahedron ("uncovered"), of
        simplices that bound no tetrahedron ("singular_...").
    complex : AlphaComplex

    Examples
    --------
    >>> import brio, itertools
    >>> shape = brio.AlphaShape(list(itertools.product(range(3), repeat=3)))
    >>> shape.alpha, round(shape.certificate.volume, 9)
    (0.75, 8.0)
    """

    alpha: float
    counts: dict[str, int]
    complex: AlphaComplex

    def __init__(self, points: Any, alpha: float | None = None, weights: Any = None, *, threads: int = 0,
                 progress: bool | Progress | None = None) -> None:
        complex = alpha_complex(points, weights, threads=threads, progress=progress)
        made = complex.shape(complex.auto_alpha() if alpha is None else alpha)
        self._take(made._handle)
        self.alpha, self.counts, self.complex = made.alpha, made.counts, complex
