"""griddata, SphericalVoronoi and HalfspaceIntersection, against definitions and against scipy."""

import copy
import pickle

import numpy as np
import pytest

import brio

GENERATOR = np.random.default_rng(21)


# --- griddata ---


@pytest.mark.parametrize("method", ["linear", "natural", "nearest"])
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("values", [np.arange(50.0), np.arange(100.0).reshape(50, 2), np.arange(50) * (1 + 2j)])
def test_griddata_at_the_points_and_beyond(method, d, values):
    points = GENERATOR.random((50, d))
    for given in (points, tuple(points.T)):
        assert np.array_equal(brio.griddata(given, values, given, method), values)
    far = brio.griddata(points, values, [[9.0] * d], method, fill_value=-5)
    assert (far == (values[np.argmin(((points - 9) ** 2).sum(axis=1))] if method == "nearest" else -5)).all()
    grid = tuple(np.meshgrid(*[np.linspace(0.4, 0.6, 4)] * d))
    assert brio.griddata(points, values, grid, method).shape == (4,) * d + values.shape[1:]


@pytest.mark.parametrize("method", ["linear", "nearest"])
@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("rescale", [False, True])
def test_griddata_as_in_scipy(method, d, rescale):
    interpolate = pytest.importorskip("scipy.interpolate")
    points = GENERATOR.random((60, d)) * [1, 30, 500][:d]
    values = GENERATOR.random(60) + 1j * GENERATOR.random(60)
    xi = (GENERATOR.random((200, d)) * 1.2 - 0.1) * [1, 30, 500][:d]
    if d == 1:
        points, xi = points[:, 0], xi[:, 0]
    ours = brio.griddata(points, values, xi, method, rescale=rescale)
    theirs = interpolate.griddata(points, values, xi, method, rescale=rescale)
    if d == 3 and method == "linear" and rescale:  # cospherical points apart, simplices are the same ones
        theirs = np.where(np.isnan(theirs), ours, theirs)
    assert np.allclose(ours, theirs, equal_nan=True, atol=1e-9)


def test_griddata_on_a_line():
    x, y = np.array([3.0, 0, 1]), np.array([30, 0, 10])
    assert brio.griddata(x, y, [0, 0.5, 2, 3, 4, -1, np.nan], fill_value=-7).tolist() == [0, 5, 20, 30, -7, -7, -7]
    assert brio.griddata(x, y, [-5, 0.5, 0.51, 9], "nearest").tolist() == [0, 0, 10, 30]


def test_griddata_nearest_keeps_types_and_takes_nan():
    out = brio.griddata([[0, 0], [1, 1]], [1, 2], [[0.1, 0], [np.nan, 0]], "nearest")
    assert out[0] == 1 and np.isnan(out[1])


@pytest.mark.parametrize("method", ["cubic", "magic", None, 3])
def test_griddata_by_methods_that_are_not_offered(method):
    points, values = GENERATOR.random((30, 2)), np.arange(30.0)
    with pytest.raises(brio.NotOfferedError if method == "cubic" else brio.ArgumentError):
        brio.griddata(points, values, points, method)
    if method == "cubic":
        pytest.importorskip("scipy.interpolate")
        assert np.allclose(brio.griddata(points, values, points, method, fallback="scipy"), values)


@pytest.mark.parametrize("call", [
    lambda: brio.griddata(np.eye(3), [1, 2], [[0, 0, 0]], "nearest"), lambda: brio.griddata(np.eye(3), [1, 2], [[0, 0, 0]]),
    lambda: brio.griddata(np.eye(3), [1, 2, 3], [[0, 0]], "nearest"), lambda: brio.griddata(5, [1], [[0, 0]]),
    lambda: brio.griddata([[np.nan, 0]], [1], [[0, 0]], "nearest"), lambda: brio.griddata(np.eye(3), [1, 2, 3], [[0, 0, 0]],
                                                                                       fallback="x")])
def test_griddata_refuses(call):
    with pytest.raises(brio.ArgumentError):
        call()


@pytest.mark.parametrize("method", ["linear", "natural"])
def test_data_over_a_plane_and_a_line_in_space(method):
    """All values were NaN."""
    for axes in ([[1, 0, 0], [0, 1, 0]], [[0.1, 0.2, 0.3], [0.7, -0.1, 0.2]], [[1, 0, 0], [0, 0, 1]]):
        places = GENERATOR.random((60, 2))
        values, inside = places @ [2, 3], 0.3 + 0.4 * GENERATOR.random((20, 2))
        points, xi = places @ axes, inside @ axes + 2 * np.cross(*axes)  # off the plane: projected
        assert np.allclose(brio.griddata(points, values, xi, method), inside @ [2, 3])
        assert np.isnan(brio.griddata(points, values, [np.array([5, 5]) @ axes], method)).all()
    line = GENERATOR.random(20)
    for way in ([1, 0, 0], [0.1, 0.2, 0.3], [0.1, 0.3]):
        found = brio.griddata(np.outer(line, way), line, np.outer([0.4, 0.5], way), method, fill_value=-1)
        assert np.allclose(found, [0.4, 0.5])
        assert brio.griddata(np.outer(line, way), line, np.outer([2.0], way), method, fill_value=-1) == -1
        with pytest.raises(brio.NoAnswerError, match="one position"):
            brio.griddata(np.outer([1, 1, 1], way), [1, 2, 3], np.outer([1], way), method)


# --- SphericalVoronoi ---


def sphere(n, d):
    points = GENERATOR.normal(size=(n, d))
    return points / np.linalg.norm(points, axis=1)[:, None]


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("radius, center", [(1, None), (2.5, [1, 2, 3])])
def test_spherical_vertices_are_equally_far_from_their_points(d, radius, center):
    center = None if center is None else center[:d]
    points = radius * sphere(60, d) + (0 if center is None else np.array(center))
    vor = brio.SphericalVoronoi(points, radius, center)
    if d == 3:
        vor.sort_vertices_of_regions()
    far = np.linalg.norm(vor.vertices[:, None] - points, axis=2)
    for k, region in enumerate(vor.regions):
        assert np.allclose(far[region, k], far[region].min(axis=1))
    whole = 2 * np.pi * radius if d == 2 else 4 * np.pi * radius**2
    areas = vor.calculate_areas()
    assert np.isclose(areas.sum(), whole) and (areas > 0).all()
    if d == 3:
        samples = radius * sphere(20000, 3) + vor.center
        share = np.bincount(((samples[:, None] - points) ** 2).sum(axis=2).argmin(axis=1), minlength=60) / 20000
        assert np.allclose(areas / whole, share, atol=0.01)


def test_spherical_regions_are_rounds():
    vor = brio.SphericalVoronoi(sphere(200, 3))
    vor.sort_vertices_of_regions()
    for point, region in zip(vor.points, vor.regions):
        ring = vor.vertices[region]
        assert ((np.cross(ring, np.roll(ring, -1, axis=0)) @ point) > 0).all()  # counterclockwise


@pytest.mark.parametrize("d", [2, 3])
def test_spherical_areas_as_in_scipy(d):
    spatial = pytest.importorskip("scipy.spatial")
    points = sphere(100, d)
    if d == 3:
        assert np.allclose(brio.SphericalVoronoi(points).calculate_areas(), spatial.SphericalVoronoi(points).calculate_areas())
    half = points.copy()
    half[:, 0] = np.abs(half[:, 0])
    whole = brio.SphericalVoronoi(half).calculate_areas().sum()
    assert np.isclose(whole, 2 * np.pi if d == 2 else 4 * np.pi)


@pytest.mark.parametrize("points, options", [
    ([[1, 0, 0]] * 4, {}), ([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], {}), (np.eye(3) * 2, {}),
    (np.concatenate([np.eye(3), -np.eye(3), np.eye(3)]), {}), (np.concatenate([np.eye(3), -np.eye(3)]), {"radius": None}),
    (np.concatenate([np.eye(3), -np.eye(3)]), {"radius": -1}), (np.concatenate([np.eye(3), -np.eye(3)]), {"center": [1, 2]}),
    (np.concatenate([np.eye(3), -np.eye(3)]), {"center": [0, 0, 0.5]}), ([[np.nan, 0, 0]], {}), ([], {}), (5, {}),
    (np.zeros((0, 3)), {}), (np.eye(4), {})])
def test_spheres_that_are_none(points, options):
    with pytest.raises(ValueError):
        brio.SphericalVoronoi(points, **options)


# --- HalfspaceIntersection ---


@pytest.mark.parametrize("d", [2, 3])
def test_corners_of_halfspaces(d):
    normals = sphere(40, d)
    halfspaces = np.column_stack([normals, -1 - GENERATOR.random(40)])
    inside = 0.2 * GENERATOR.random(d)
    made = brio.HalfspaceIntersection(halfspaces, inside)
    values = made.intersections @ halfspaces[:, :-1].T + halfspaces[:, -1]
    assert (values < 1e-9).all()
    for corner, facet in enumerate(made.dual_facets):
        assert np.allclose(values[corner, facet], 0, atol=1e-9) and len(facet) >= d
    assert made.dual_vertices.tolist() == sorted({k for facet in made.dual_facets for k in facet})
    assert np.isclose(made.dual_volume, brio.ConvexHull(made.dual_points).volume)
    redundant = np.setdiff1d(np.arange(40), made.dual_vertices)
    assert (values[:, redundant] < 0).all()


@pytest.mark.parametrize("d", [2, 3])
def test_halfspaces_as_in_scipy(d):
    spatial = pytest.importorskip("scipy.spatial")
    halfspaces = np.column_stack([sphere(40, d), -np.ones(40)])
    ours, theirs = (module.HalfspaceIntersection(halfspaces, np.zeros(d)) for module in (brio, spatial))
    assert np.allclose(*(np.array(sorted(x.intersections.round(9).tolist())) for x in (ours, theirs)))
    assert np.isclose(ours.dual_volume, theirs.dual_volume) and np.isclose(ours.dual_area, theirs.dual_area)
    assert ours.dual_vertices.tolist() == sorted(theirs.dual_vertices.tolist())


SQUARE = [[1, 0, -1], [0, 1, -1], [-1, 0, -1], [0, -1, -1]]


def test_added_halfspaces_and_copies():
    made = brio.HalfspaceIntersection(SQUARE, [0, 0])
    made.add_halfspaces([1, 1, -1])
    assert len(made.intersections) == 5 and made.halfspaces.shape == (5, 3)
    for again in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made)):
        assert (again.intersections == made.intersections).all() and not again.intersections.flags.writeable
    made.close()
    with pytest.raises(RuntimeError):
        made.add_halfspaces([1, 1, -1])
    assert "4 halfspaces: 4 corners" in repr(brio.HalfspaceIntersection(SQUARE, [0, 0]))
    vor = brio.SphericalVoronoi(sphere(20, 3))
    assert pickle.loads(pickle.dumps(vor)).regions == vor.regions and "20 points" in repr(vor)


@pytest.mark.parametrize("halfspaces, inside, kind", [
    (SQUARE, [1, 0], brio.NoAnswerError), (SQUARE, [5, 0], brio.NoAnswerError), (SQUARE[:2], [0, 0], brio.NoAnswerError),
    (SQUARE[:3], [0, 0], brio.NoAnswerError), (SQUARE, [0, 0, 0], brio.ArgumentError), (SQUARE, 0, brio.ArgumentError),
    (SQUARE, [[0, 0]], brio.ArgumentError), (SQUARE, [np.nan, 0], brio.NoAnswerError), ([1, 2, 3], [0, 0], brio.ArgumentError),
    ([[1, 0, 0, 0, -1]], [0, 0, 0, 0], brio.NotOfferedError), ([["a"]], [0], brio.ArgumentError)])
def test_halfspaces_without_an_answer(halfspaces, inside, kind):
    with pytest.raises(kind):
        brio.HalfspaceIntersection(halfspaces, inside)
