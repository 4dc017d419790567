"""Exact Delaunay triangulation and surface reconstruction of very large point sets."""

from . import errors
from ._alpha import AlphaComplex, AlphaShape, alpha_complex
from ._delaunay import Delaunay
from ._hull import ConvexHull
from ._interpolate import LinearNDInterpolator, NaturalNeighbourInterpolator
from ._mesh import Certificate, Distance, Mesh, read, simplify, write
from ._reconstruct import Surface, medial_axis, offset, oriented_normals, reconstruct
from ._version import __version__
from ._voronoi import Voronoi
from .errors import *  # noqa: F403

__all__ = [
    "AlphaComplex", "AlphaShape", "Certificate", "ConvexHull", "Delaunay", "Distance", "LinearNDInterpolator", "Mesh",
    "NaturalNeighbourInterpolator", "Surface", "Voronoi", "__version__", "alpha_complex", "errors", "medial_axis", "offset",
    "oriented_normals", "read", "reconstruct", "simplify", "write", *errors.__all__,
]
