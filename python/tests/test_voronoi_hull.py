"""Diagrams and hulls: against definitions and scipy."""

import copy
import pickle

import numpy as np
import pytest

import brio
from test_interpolate import area, clip

GENERATOR = np.random.default_rng(2)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("weighted", [False, True])
def test_vertices_are_equally_far_from_their_sites(d, weighted):
    points = GENERATOR.random((200, d))
    weights = 0.001 * GENERATOR.random(200) if weighted else None
    vor = brio.Voronoi(points, weights)
    power = ((vor.vertices[:, None] - points) ** 2).sum(axis=2) - (0 if weights is None else weights)
    nearest = power.min(axis=1)
    for p in np.unique(brio.Delaunay(points, weights).representatives):
        for v in vor.regions[vor.point_region[p]]:
            if v >= 0:
                assert abs(power[v, p] - nearest[v]) <= 1e-9 * max(1, np.abs(vor.vertices[v]).max() ** 2)


@pytest.mark.parametrize("d", [2, 3])
def test_same_diagram_as_scipy(d):
    spatial = pytest.importorskip("scipy.spatial")
    points = GENERATOR.random((300, d))
    mine, theirs = brio.Voronoi(points), spatial.Voronoi(points)
    assert mine.vertices.shape == theirs.vertices.shape
    ridges, other = ({tuple(sorted(k)): v for k, v in vor.ridge_dict.items()} for vor in (mine, theirs))
    # Qhull leaves out some unbounded ridges with one vertex.
    assert set(other) <= set(ridges) and all(len(ridges[k]) == 2 and -1 in ridges[k] for k in set(ridges) - set(other))

    def places(vor, items):
        return sorted(vor.vertices[[v for v in items if v >= 0]].tolist())

    for pair, vertices in other.items():
        assert (-1 in vertices) == (-1 in ridges[pair])
        assert np.allclose(places(mine, ridges[pair]), places(theirs, vertices))
    for p in range(300):
        a, b = mine.regions[mine.point_region[p]], theirs.regions[theirs.point_region[p]]
        assert (-1 in a) == (-1 in b) and np.allclose(places(mine, a), places(theirs, b))
        if -1 in b:
            assert np.isinf(mine.volumes[p])
        else:
            assert np.isclose(mine.volumes[p], spatial.ConvexHull(theirs.vertices[b]).volume)


def test_grid_has_square_regions():
    points = np.stack(np.meshgrid(np.arange(4.0), np.arange(5.0)), -1).reshape(-1, 2)
    vor = brio.Voronoi(points)
    assert len(vor.vertices) == 12
    inside = ~np.isinf(vor.volumes)
    assert inside.sum() == 6 and np.allclose(vor.volumes[inside], 1)
    assert all(len(vor.regions[vor.point_region[p]]) == 4 for p in np.flatnonzero(inside))
    assert (np.diff(vor.region_offsets) == [len(r) for r in vor.regions]).all()


def test_duplicates_share_a_region():
    points = GENERATOR.random((30, 2))
    for d in (2, 3):
        sites = np.column_stack([points, GENERATOR.random((30, d - 2))])
        vor = brio.Voronoi(np.concatenate([sites, sites[:3]]))
        assert (vor.point_region[30:] == vor.point_region[:3]).all()
        assert len(vor.regions) == 31 and vor.regions[0] == []
        assert (vor.volumes[30:] == 0).all()


def test_cells_in_a_box_fill_it():
    points = GENERATOR.random((500, 3))
    vor = brio.Voronoi(points, box=[[0, 0, 0], [1, 1, 1]])
    assert np.isclose(vor.volumes.sum(), 1) and (vor.volumes > 0).all()


def cell_in(points, weights, k, low, high):
    """The power cell of point k in a rectangle, by clipping."""
    polygon = np.array([low, [high[0], low[1]], high, [low[0], high[1]]], float)
    for j in range(len(points)):
        if j != k:
            limit = points[j] @ points[j] - points[k] @ points[k] - weights[j] + weights[k]
            polygon = clip(polygon, 2 * (points[j] - points[k]), limit)
    return polygon


GRID = np.array([[x, y] for x in range(4) for y in range(4)], float)


@pytest.mark.parametrize("points", [GENERATOR.random((40, 2)), GRID, GRID @ [[3, 4], [-4, 3]] / 5, GRID[:4], GRID[:1],
                                    np.concatenate([GRID, GRID[:3]]), GENERATOR.random((40, 2)) * 10 - 5])
@pytest.mark.parametrize("box", [[[0, 0], [1, 1]], [[-0.5, -0.5], [3.5, 3.5]], [[-9, 0.25], [9, 0.75]], [[7, 7], [8, 9]]])
@pytest.mark.parametrize("weighted", [False, True])
def test_cells_in_a_box_of_the_plane(points, box, weighted):
    weights = GENERATOR.random(len(points)) * 0.1 if weighted else np.zeros(len(points))
    low, high = np.array(box, float)
    vor = brio.Voronoi(points, weights if weighted else None, box=box)
    wanted = np.array([area(cell_in(points, weights, k, low, high)) for k in range(len(points))])
    own = np.zeros(len(points), bool)
    own[np.unique(brio.Delaunay(points, weights if weighted else None).representatives)] = True
    assert np.allclose(vor.volumes, np.where(own, wanted, 0), atol=1e-9)
    assert np.isclose(vor.volumes.sum(), np.prod(high - low))
    assert ((vor.vertices >= low - 1e-12) & (vor.vertices <= high + 1e-12)).all()
    for (p, q), ends in zip(vor.ridge_points.tolist(), vor.ridge_vertices):
        powers = [((vor.vertices[ends] - points[s]) ** 2).sum(axis=1) - weights[s] for s in (p, q)]
        assert np.allclose(*powers, atol=1e-9)
        for site in (p, q):  # the ridge is an edge of both regions
            region = vor.regions[vor.point_region[site]]
            assert set(ends) <= set(region) and abs(region.index(ends[0]) - region.index(ends[1])) in (1, len(region) - 1)
    regions = [r for r in vor.regions if r]
    edges = sum(len(r) for r in regions) - len(vor.ridge_points)
    assert len(vor.vertices) - edges + len(regions) == 1  # Euler: the box is filled, and cells share their vertices


@pytest.mark.parametrize("exponent", [-900, -400, 400, 900])
def test_cells_in_a_box_of_the_plane_at_every_scale(exponent):
    points = GENERATOR.random((30, 2))
    near, far = (brio.Voronoi(np.ldexp(points, e), box=np.ldexp([[0.0, 0], [1, 1]], e)) for e in (0, exponent))
    assert (np.ldexp(near.vertices, exponent) == far.vertices).all() and near.regions == far.regions


def test_a_box_of_the_plane_stays_when_points_are_added():
    vor = brio.Voronoi(GRID[:8], box=[0, 0, 3, 3])
    vor.add_points(GRID[8:])
    assert np.isclose(vor.volumes.sum(), 9) and vor.regions == brio.Voronoi(GRID, box=[0, 0, 3, 3]).regions
    with pytest.raises(brio.ArgumentError):
        brio.Voronoi(GRID, box=[3, 3, 0, 0])


def test_no_diagram_of_points_on_a_line():
    with pytest.raises(brio.NoAnswerError, match="line"):
        brio.Voronoi([[0, 0], [1, 1], [2, 2]])


@pytest.mark.parametrize("d", [2, 3])
def test_hull_is_convex_and_closed(d):
    points = GENERATOR.normal(size=(2000, d))
    hull = brio.ConvexHull(points)
    assert (hull.equations[:, :-1] @ points.T + hull.equations[:, -1:] <= 1e-12).all()
    assert np.allclose(np.linalg.norm(hull.equations[:, :-1], axis=1), 1)
    for s, row in enumerate(hull.neighbors):
        for k, other in enumerate(row):
            assert s in hull.neighbors[other] and set(np.delete(hull.simplices[s], k)) <= set(hull.simplices[other])
    assert sorted(set(hull.simplices.ravel())) == sorted(hull.vertices)


@pytest.mark.parametrize("d", [2, 3])
def test_same_hull_as_scipy(d):
    spatial = pytest.importorskip("scipy.spatial")
    points = GENERATOR.random((1000, d))
    mine, theirs = brio.ConvexHull(points), spatial.ConvexHull(points)
    assert np.isclose(mine.volume, theirs.volume) and np.isclose(mine.area, theirs.area)
    assert set(mine.vertices) == set(theirs.vertices)
    assert mine.good is None and theirs.good is None  # without Qhull's option QG
    for name in ("vertices", "simplices", "neighbors", "equations", "coplanar"):
        assert getattr(mine, name).shape == getattr(theirs, name).shape, name
        assert getattr(mine, name).dtype == getattr(theirs, name).dtype, name


def test_hull_of_a_cube_has_six_polygons():
    cube = np.array([[x, y, z] for x in (0, 0.5, 1) for y in (0, 0.5, 1) for z in (0, 0.5, 1)])
    hull = brio.ConvexHull(cube)
    assert len(hull.polygons) == 6 and all(len(p) == 4 for p in hull.polygons) and hull.nsimplex == 12
    assert hull.volume == 1 and hull.area == 6 and len(np.unique(hull.equations.round(12), axis=0)) == 6


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.zeros((4, 2)), np.eye(3), np.outer(np.arange(5.0), [1, 2])])
def test_no_hull_without_an_inside(points):
    with pytest.raises(brio.NoAnswerError):
        brio.ConvexHull(points)


@pytest.mark.parametrize("d", [2, 3])
def test_volumes_of_a_diagram_with_hidden_points(d):
    points, weights = GENERATOR.random((300, d)), 0.03 * (d - 1) * GENERATOR.random(300)
    tri, vor = brio.Delaunay(points, weights), brio.Voronoi(points, weights)
    assert len(tri.hidden) > 50 and (vor.volumes[tri.hidden] == 0).all()
    kept = np.setdiff1d(np.arange(300), tri.hidden)
    alone = brio.Voronoi(points[kept], weights[kept])
    assert np.allclose(vor.volumes[kept], alone.volumes, rtol=1e-9) and (vor.volumes[kept] > 0).all()


def test_volumes_without_the_region_of_infinity():
    points = GENERATOR.random((50, 2))
    assert (brio.Voronoi(points, qhull_options="Qbb").volumes == brio.Voronoi(points).volumes).all()


def test_options_of_qhull_as_bytes():
    for options, regions in (("Qbb", 9), ("Qbb Qz", 10)):
        for kind in (options, options.encode()):
            assert len(brio.Voronoi(GENERATOR.random((9, 2)), qhull_options=kind).regions) == regions
    with pytest.raises(brio.NotOfferedError, match="not offered"):
        brio.Voronoi(np.eye(3), qhull_options=b"\xff")


def test_texts_of_hulls_and_diagrams():
    square = [[0, 0], [1, 0], [0, 1], [1, 1]]
    assert repr(brio.ConvexHull(square)) == "<brio.ConvexHull of 4 points: 4 vertices, 4 simplices>"
    assert repr(brio.Voronoi(square)) == "<brio.Voronoi of 4 points: 1 vertices, 4 ridges>"


@pytest.mark.parametrize("d", [2, 3])
def test_arrays_of_hulls_and_diagrams_are_read_only(d):
    points = GENERATOR.random((30, d))
    for made in (brio.ConvexHull(points), brio.Voronoi(points)):
        for thing in (made, copy.deepcopy(made), pickle.loads(pickle.dumps(made)), copy.copy(made)):
            arrays = {name: getattr(thing, name) for name in dir(thing) if not name.startswith("_")}
            arrays = {name: value for name, value in arrays.items() if isinstance(value, np.ndarray)}
            assert [name for name, value in arrays.items() if value.flags.writeable] == ["points"] and len(arrays) > 6
    assert points.flags.writeable
