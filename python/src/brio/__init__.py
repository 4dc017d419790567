"""Exact Delaunay triangulation and surface reconstruction of very large point sets."""

from . import errors
from ._delaunay import Delaunay
from ._hull import ConvexHull
from ._interpolate import LinearNDInterpolator, NaturalNeighbourInterpolator
from ._version import __version__
from ._voronoi import Voronoi
from .errors import *  # noqa: F403

__all__ = ["ConvexHull", "Delaunay", "LinearNDInterpolator", "NaturalNeighbourInterpolator", "Voronoi", "__version__",
           "errors"]
