"""Exact Delaunay triangulation and surface reconstruction of very large point sets."""

from . import errors
from ._alpha import AlphaComplex, AlphaShape, alpha_complex
from ._curves import Curve, curve, spanning_tree
from ._delaunay import Delaunay
from ._dynamic import DynamicDelaunay, PeriodicDynamicDelaunay
from ._files import Conversion, build_info, convert, read, write
from ._halfspaces import HalfspaceIntersection
from ._hull import ConvexHull
from ._interpolate import LinearNDInterpolator, NaturalNeighbourInterpolator, griddata
from ._mesh import Certificate, Coverage, Distance, Mesh, simplify
from ._periodic import PeriodicAlphaComplex, PeriodicAlphaShape, PeriodicDelaunay, PeriodicVoronoi
from ._points import outliers, thin
from ._reconstruct import BallUnion, Surface, ball_union, estimate_memory, medial_axis, offset, oriented_normals, reconstruct
from ._spherical import SphericalVoronoi
from ._tiled import TiledDelaunay, TileFaces, TilePart
from ._version import __version__
from ._view import Page, Picture, picture, view
from ._voronoi import Voronoi
from .errors import *  # noqa: F403

__all__ = [
    "AlphaComplex", "AlphaShape", "Certificate", "Conversion", "ConvexHull", "Coverage", "Curve", "Delaunay", "Distance",
    "DynamicDelaunay", "PeriodicDynamicDelaunay",
    "HalfspaceIntersection", "LinearNDInterpolator", "Mesh", "NaturalNeighbourInterpolator", "Page", "PeriodicAlphaComplex",
    "PeriodicAlphaShape", "PeriodicDelaunay", "PeriodicVoronoi", "Picture",
    "SphericalVoronoi", "Surface", "TileFaces", "TilePart", "TiledDelaunay",
    "Voronoi", "__version__", "alpha_complex", "ball_union", "build_info", "convert", "curve", "errors", "estimate_memory", "griddata", "medial_axis",
    "offset", "oriented_normals", "outliers", "picture", "read", "reconstruct", "simplify", "spanning_tree", "thin", "view", "write",
    *errors.__all__,
]
