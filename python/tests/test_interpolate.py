"""Interpolation: exact where it must be, and natural neighbours against areas of clipped cells."""

import numpy as np
import pytest

import brio
from test_delaunay import turned_grid

GENERATOR = np.random.default_rng(3)
BOTH = [brio.LinearNDInterpolator, brio.NaturalNeighbourInterpolator]


def clip(polygon, normal, limit):
    """The part of a convex polygon where normal . x <= limit."""
    out = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        da, db = normal @ a - limit, normal @ b - limit
        if da <= 0:
            out.append(a)
        if (da < 0) != (db < 0) and da != db:
            out.append(a + (b - a) * da / (da - db))
    return np.array(out).reshape(-1, 2)


def area(polygon):
    x, y = polygon.T if len(polygon) else (np.zeros(0), np.zeros(0))
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def cell(points, k):
    """The Voronoi cell of a point within a large square."""
    polygon = np.array([[-50.0, -50], [50, -50], [50, 50], [-50, 50]])
    for j, other in enumerate(points):
        if j != k:
            polygon = clip(polygon, 2 * (other - points[k]), other @ other - points[k] @ points[k])
    return polygon


def sibson(points, values, query):
    with_query = np.vstack([points, query])
    taken = np.array([area(cell(points, k)) - area(cell(with_query, k)) for k in range(len(points))])
    return taken @ values / taken.sum()


def test_natural_neighbours_against_clipped_cells():
    points, values = GENERATOR.random((15, 2)), GENERATOR.random(15)
    height = brio.NaturalNeighbourInterpolator(points, values)
    for query in 0.3 + 0.4 * GENERATOR.random((12, 2)):
        assert np.isclose(height(query), sibson(points, values, query), atol=1e-6)


@pytest.mark.parametrize("interpolator", BOTH)
@pytest.mark.parametrize("d", [2, 3])
def test_linear_functions_and_values_at_points(interpolator, d):
    points = GENERATOR.random((300, d))
    plane = points @ np.arange(1, d + 1) + 2
    height = interpolator(points, plane)
    assert (height(points) == plane).all()
    queries = 1.4 * GENERATOR.random((500, d)) - 0.2
    out = height(queries)
    outside = brio.Delaunay(points).find_simplex(queries) < 0
    assert (np.isnan(out) == outside).all()
    assert np.allclose(out[~outside], (queries @ np.arange(1, d + 1) + 2)[~outside], atol=1e-12)


@pytest.mark.parametrize("interpolator", BOTH)
@pytest.mark.parametrize("d", [2, 3])
def test_grid_and_hull(interpolator, d):
    points = np.stack(np.meshgrid(*[np.arange(4.0)] * d), -1).reshape(-1, d)
    height = interpolator(points, points.sum(axis=1))
    queries = np.concatenate([points, 3 * GENERATOR.integers(0, 7, (200, d)) / 6])
    assert np.allclose(height(queries), queries.sum(axis=1))


@pytest.mark.parametrize("interpolator", BOTH)
def test_shapes_and_types(interpolator):
    points = GENERATOR.random((50, 2))
    values = GENERATOR.random((50, 3, 2)) + 1j
    height = interpolator(points, values)
    assert height(np.full((4, 5, 2), 0.5)).shape == (4, 5, 3, 2)
    assert height(0.5, 0.5).shape == (3, 2) and height(0.5, 0.5).dtype == np.complex128
    assert np.allclose(height([[0.5, 0.5]]).imag, 1)
    assert (interpolator(points, values.real, fill_value=-7)([[9, 9], [np.nan, 0]]) == -7).all()
    assert np.isnan(interpolator(points, values.real)([[9, 9], [np.nan, 0]])).all()
    tri = brio.Delaunay(points)
    assert interpolator(tri, values).tri is tri
    with pytest.raises(ValueError, match="one row a point"):
        interpolator(points, values[:-1])


@pytest.mark.parametrize("interpolator", BOTH)
@pytest.mark.parametrize("d", [2, 3])
def test_values_of_no_components(interpolator, d):
    points = GENERATOR.random((20, d))
    queries = np.concatenate([points[:3], np.full((2, d), 9), np.full((1, d), np.nan)])
    for shape in (0,), (2, 0), (0, 3):
        for dtype in np.float64, np.complex128:
            for fill in np.nan, 7:
                out = interpolator(points, np.empty((20, *shape), dtype), fill)(queries)
                assert out.shape == (6, *shape) and out.dtype == dtype


def test_rescale():
    points = GENERATOR.random((80, 2)) * [1, 1000]
    height = brio.LinearNDInterpolator(points, points.sum(axis=1), rescale=True)
    assert np.isclose(height(0.5, 500), 500.5)


def test_natural_neighbours_refuse_weights():
    with pytest.raises(brio.ArgumentError, match="weights"):
        brio.NaturalNeighbourInterpolator(brio.Delaunay(GENERATOR.random((9, 3)), np.zeros(9)), np.zeros(9))


@pytest.mark.parametrize("d", [2, 3])
def test_same_as_scipy(d):
    interpolate = pytest.importorskip("scipy.interpolate")
    points, values = GENERATOR.random((500, d)), GENERATOR.random((500, 2))
    queries = 1.2 * GENERATOR.random((1000, d)) - 0.1
    mine = brio.LinearNDInterpolator(points, values)(queries)
    theirs = interpolate.LinearNDInterpolator(points, values)(queries)
    assert np.allclose(mine, theirs, equal_nan=True)


@pytest.mark.parametrize("interpolator", BOTH)
@pytest.mark.parametrize("d", [2, 3])
def test_places_on_the_sides_of_a_turned_grid(interpolator, d):
    """NaN where rounding put a place outside; wrong values in slivers at the hull, and of natural neighbours beside some of them."""
    generator = np.random.default_rng(8)
    slope = np.arange(1.0, d + 1)
    for n in (2, 3, 4, 5) * 6:
        points, sides = turned_grid(n, d, generator)
        height = interpolator(points, points @ slope)
        assert np.allclose(height(sides), sides @ slope, rtol=0, atol=1e-12)
        exact = interpolator(points, points @ slope, tol=0)
        outside = brio.Delaunay(points).find_simplex(sides, tol=0) < 0
        assert (np.isnan(exact(sides)) == outside).all() and outside.any()
        assert np.allclose(exact(sides)[~outside], sides[~outside] @ slope, rtol=0, atol=1e-12)
        filled = interpolator(points, points @ slope, fill_value=-99)
        assert np.allclose(filled(sides), sides @ slope, rtol=0, atol=1e-12) and filled(np.full(d, 99.0)) == -99


@pytest.mark.parametrize("tol", [-1, np.nan, "x"])
def test_tolerances_that_are_none(tol):
    with pytest.raises(brio.ArgumentError, match="tol"):
        brio.LinearNDInterpolator(np.eye(3), [1, 2, 3], tol=tol)
