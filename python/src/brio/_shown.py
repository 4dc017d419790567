"""What a page and a picture show of a result: a mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import Floats
from ._delaunay import Delaunay
from ._dynamic import DynamicDelaunay
from ._hull import ConvexHull
from ._mesh import Mesh
from ._periodic import PeriodicDelaunay, PeriodicVoronoi
from ._voronoi import Voronoi

MOST_CELLS = 8000  # as brio voronoi --view


def mesh_of(value: Any) -> Mesh:
    """Returns the mesh of a result of brio, or of an array of points."""
    if isinstance(value, Mesh):
        return value
    if isinstance(value, DynamicDelaunay):
        return mesh_of(value.snapshot())
    if isinstance(value, PeriodicDelaunay):
        return Mesh(value.image_positions, tetrahedra=value.simplices)
    if isinstance(value, Delaunay):
        places = _in_space(value.points)
        return Mesh(places, tetrahedra=value.simplices) if value.points.shape[1] == 3 else Mesh(places, value.simplices)
    if isinstance(value, ConvexHull):
        places, number = _in_space(value.points)[value.vertices], np.zeros(len(value.points), np.int64)
        number[value.vertices] = np.arange(len(value.vertices))
        return Mesh(places, number[value.simplices]) if value.ndim == 3 else Mesh(places, edges=number[value.simplices])
    if isinstance(value, Voronoi):
        return _of_regions(value) if value.ndim == 2 else _of_cells(value.cells)
    if isinstance(value, PeriodicVoronoi):
        return _of_cells(value._compute(True, False, None))
    return Mesh(value)


def _in_space(points: Floats) -> Floats:
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _evenly(shown: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns an even choice of MOST_CELLS of more cells."""
    return shown if len(shown) <= MOST_CELLS else shown[np.arange(MOST_CELLS) * len(shown) // MOST_CELLS]


def _of_regions(voronoi: Voronoi) -> Mesh:
    """The bounded cells of the plane, a polygon each."""
    counts, begin = np.diff(voronoi.region_offsets), voronoi.region_offsets
    sites = voronoi._sites
    region = voronoi.point_region[sites]
    unbounded = np.zeros(len(counts), bool)
    unbounded[np.repeat(np.arange(len(counts)), counts)[voronoi.region_items < 0]] = True
    chosen = _evenly(np.flatnonzero(~unbounded[region] & (counts[region] > 2)))
    corners = [voronoi.region_items[begin[r]:begin[r + 1]] for r in region[chosen]]
    sites = sites[chosen]
    items = np.concatenate(corners) if corners else np.empty(0, np.int64)
    return _polygons(_in_space(voronoi.vertices), counts[region[chosen]], items, sites.astype(np.uint32), voronoi.volumes[sites])


def _of_cells(cells: dict[str, Any]) -> Mesh:
    """The bounded cells of space, each a closed solid of its own, as brio_cells_mesh makes them."""
    vertices, corner = cells["vertices"], cells["face_vertices"].astype(np.int64)
    of_face = np.repeat(np.arange(len(cells["site"])), np.diff(cells["face_offsets"]).astype(np.int64))
    sizes = np.diff(cells["corner_offsets"]).astype(np.int64)
    of_corner = np.repeat(of_face, sizes)
    wrong = np.zeros(len(cells["site"]), bool)
    wrong[of_corner[~np.isfinite(vertices).all(axis=1)[corner]]] = True
    wanted = np.zeros(len(wrong), bool)
    wanted[_evenly(np.flatnonzero(cells["bounded"] & ~wrong & (np.bincount(of_face, minlength=len(wrong)) > 0)))] = True
    kept = wanted[of_face] & (sizes > 2)
    used, items = np.unique((of_corner * len(vertices) + corner)[np.repeat(kept, sizes)], return_inverse=True)
    cell = of_face[kept]
    return _polygons(vertices[used % max(1, len(vertices))], sizes[kept], items.ravel(), cells["site"][cell], cells["volume"][cell])


def _polygons(vertices: Floats, sizes: NDArray[np.int64], corners: NDArray[np.int64], sites: NDArray[np.uint32], volumes: Floats) -> Mesh:
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.uint64)
    mesh: Mesh = Mesh._of(_native.mesh(np.ascontiguousarray(vertices), offsets, corners.astype(np.uint32), None, None, {}, None, {}))
    mesh.face_properties = {"site": sites, "volume": volumes}
    return mesh
