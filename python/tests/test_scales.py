"""Coordinates near the ends of the range of doubles: results are those of ordinary ones times powers of two, or 0, or infinite."""

import numpy as np
import pytest

import brio
from brio import _scaled

GENERATOR = np.random.default_rng(7)
SCALES = [-900, -600, -400, -340, 340, 400, 600, 1000]


def times(values, exponent):
    with np.errstate(over="ignore"):
        return np.ldexp(values, exponent)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("exponent", SCALES)
@pytest.mark.parametrize("d", [2, 3])
def test_hulls_at_every_scale(d, exponent):
    for points in (GENERATOR.random((60, d)), GENERATOR.integers(0, 3, (60, d)).astype(float)):
        hull, scaled = brio.ConvexHull(points), brio.ConvexHull(times(points, exponent))
        assert scaled.volume == times(hull.volume, d * exponent)
        assert scaled.area == times(hull.area, (d - 1) * exponent)
        assert (scaled.equations[:, :-1] == hull.equations[:, :-1]).all()
        assert (scaled.equations[:, -1] == times(hull.equations[:, -1], exponent)).all()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("exponent", SCALES)
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("weighted", [False, True])
def test_triangulations_at_every_scale(d, exponent, weighted):
    points = GENERATOR.random((60, d))
    weights = 0.001 * GENERATOR.random(60) if weighted and abs(exponent) < 500 else None
    tri = brio.Delaunay(points, weights)
    scaled = brio.Delaunay(times(points, exponent), None if weights is None else times(weights, 2 * exponent))
    assert (scaled.transform[:, :d] == times(tri.transform[:, :d], -exponent)).all()
    assert (scaled.transform[:, d] == times(tri.transform[:, d], exponent)).all()
    assert (scaled.equations[:, :-1] == tri.equations[:, :-1]).all()
    assert (scaled.equations[:, -1] == times(tri.equations[:, -1], exponent)).all()
    assert scaled.paraboloid_scale == times(tri.paraboloid_scale, -exponent)
    assert scaled.paraboloid_shift == times(tri.paraboloid_shift, exponent)
    queries = 2 * GENERATOR.random((20, d)) - 0.5
    assert (scaled.lift_points(times(queries, exponent)) == times(tri.lift_points(queries), exponent)).all()
    assert (scaled.plane_distance(times(queries, exponent)) == times(tri.plane_distance(queries), exponent)).all()
    assert (scaled.find_simplex(times(queries, exponent), tol=0.1) == tri.find_simplex(queries, tol=0.1)).all()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("exponent", SCALES)
def test_areas_of_cells_at_every_scale(exponent):
    points = GENERATOR.random((60, 2))
    volumes = brio.Voronoi(times(points, exponent)).volumes
    assert np.allclose(volumes, times(brio.Voronoi(points).volumes, 2 * exponent), rtol=1e-12, atol=0)


@pytest.mark.filterwarnings("error")
def test_hulls_of_coordinates_of_all_sizes():
    assert brio.ConvexHull([[0, 0], [1e300, 1e300], [1e-300, 0]]).volume == pytest.approx(0.5)
    assert brio.ConvexHull([[0, 0], [1e300, 0], [1e300, 1e-300], [0, 1e-300]]).volume == pytest.approx(1)
    most = np.finfo(float).max
    square = brio.ConvexHull([[-most, -most], [most, -most], [most, most], [-most, most]])
    assert (square.volume, square.area) == (np.inf, np.inf)
    assert sorted(square.equations[:, :2].tolist()) == [[-1, 0], [0, -1], [0, 1], [1, 0]]
    assert (square.equations[:, 2] == -most).all()
    box = np.array([[x, y, z] for x in (0, 1e200) for y in (0, 1e-200) for z in (0, 3)])
    hull = brio.ConvexHull(box)
    assert hull.volume == pytest.approx(3) and hull.area == pytest.approx(6e200)
    assert np.array_equal(np.abs(hull.equations[:, :3]).sum(axis=1), np.ones(12))


@pytest.mark.filterwarnings("error")
def test_a_cell_with_a_vertex_beyond_doubles_is_not_nan():
    volumes = brio.Voronoi([[-1e300, 0], [1e300, 0], [0, 1e-10], [0, -1e300], [0, 1e300]]).volumes
    assert not np.isnan(volumes).any()


def test_numbers_beyond_the_range():
    a, b = GENERATOR.normal(size=(2, 50, 3))
    far, near = (_scaled.difference(np.ldexp(v, e), np.zeros_like(v)) for v, e in ((a, 900), (b, -900)))
    assert np.allclose(_scaled.shifted(*_scaled.cross(far, near)), np.cross(a, b), rtol=1e-14, atol=1e-15)
    assert _scaled.total(_scaled.product(far, far)) == np.inf
    assert np.isclose(_scaled.total(_scaled.product(far, near), 2), (a * b).sum() / 2)
    lengths = _scaled.units(far)[1]
    assert np.allclose(_scaled.shifted(lengths[0], lengths[1] - 900), np.linalg.norm(a, axis=1))
    assert _scaled.total(_scaled.split(np.zeros(3))) == 0
