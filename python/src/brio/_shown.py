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

MOST_CELLS, BEYOND = 8000, 0.25  # as brio voronoi --view (cli/files/shown_cells.c)


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
        near = _is_near(value.vertices, value.points if value.box is None else None)
        return _of_regions(value, near) if value.ndim == 2 else _of_cells(value.cells, near)
    if isinstance(value, PeriodicVoronoi):
        cells = value._compute(True, False, None)
        return _of_cells(cells, _is_near(cells["vertices"]))
    return Mesh(value)


def _in_space(points: Floats) -> Floats:
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _evenly(shown: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns an even choice of MOST_CELLS of more cells."""
    return shown if len(shown) <= MOST_CELLS else shown[np.arange(MOST_CELLS) * len(shown) // MOST_CELLS]


def _is_near(vertices: Floats, points: Floats | None = None) -> NDArray[np.bool_]:
    """Whether vertices are finite, and not beyond the box of the points by more than a part of its longest side."""
    inside = np.isfinite(vertices)
    if points is not None:
        low, high = points.min(axis=0, initial=np.inf), points.max(axis=0, initial=-np.inf)
        with np.errstate(over="ignore"):
            beyond = BEYOND * (high - low).max()
            inside &= (vertices >= low - beyond) & (vertices <= high + beyond)
    near: NDArray[np.bool_] = np.logical_and.reduce(inside, axis=1)
    return near


def _of_regions(voronoi: Voronoi, near: NDArray[np.bool_]) -> Mesh:
    """The bounded cells of the plane whose vertices are near, a polygon each."""
    counts, begin = np.diff(voronoi.region_offsets), voronoi.region_offsets
    sites = voronoi._sites
    region = voronoi.point_region[sites]
    wrong, items = np.zeros(len(counts), bool), voronoi.region_items
    wrong[np.repeat(np.arange(len(counts)), counts)[(items < 0) | ~near[items]]] = True
    chosen = _evenly(np.flatnonzero(~wrong[region] & (counts[region] > 2)))
    corners = [voronoi.region_items[begin[r]:begin[r + 1]] for r in region[chosen]]
    sites = sites[chosen]
    items = np.concatenate(corners) if corners else np.empty(0, np.int64)
    return _polygons(_in_space(voronoi.vertices), counts[region[chosen]], items, sites.astype(np.uint32), voronoi.volumes[sites])


def _of_cells(cells: dict[str, Any], near: NDArray[np.bool_]) -> Mesh:
    """The bounded cells of space whose vertices are near, each a closed solid, as brio_cells_mesh makes them."""
    vertices, corner = cells["vertices"], cells["face_vertices"].astype(np.int64)
    of_face = np.repeat(np.arange(len(cells["site"])), np.diff(cells["face_offsets"]).astype(np.int64))
    sizes = np.diff(cells["corner_offsets"]).astype(np.int64)
    of_corner = np.repeat(of_face, sizes)
    wrong = np.zeros(len(cells["site"]), bool)
    wrong[of_corner[~near[corner]]] = True
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
