"""Triangulations: against definitions, against scipy, and on degenerate points."""

import itertools

import numpy as np
import pytest

import brio

GENERATOR = np.random.default_rng(1)


def simplex_set(simplices):
    return set(map(tuple, np.sort(simplices, axis=1).tolist()))


def grid(side, d):
    return np.stack(np.meshgrid(*[np.arange(float(side))] * d), -1).reshape(-1, d)


@pytest.mark.parametrize("d", [2, 3])
def test_spheres_are_empty(d):
    points = GENERATOR.random((60, d))
    tri = brio.Delaunay(points)
    for simplex in tri.simplices:
        corner = points[simplex]
        edges = corner[1:] - corner[0]
        centre = corner[0] + np.linalg.solve(2 * edges, (edges**2).sum(axis=1))
        distance = np.linalg.norm(points - centre, axis=1)
        assert distance.min() >= np.linalg.norm(corner[0] - centre) * (1 - 1e-9)


@pytest.mark.parametrize("d", [2, 3])
def test_simplices_cover_the_hull_once(d):
    points = GENERATOR.random((500, d))
    tri = brio.Delaunay(points)
    sizes = np.linalg.det(points[tri.simplices[:, 1:]] - points[tri.simplices[:, :1]])
    assert (sizes > 0).all()
    assert np.isclose(sizes.sum() / [2, 6][d - 2], brio.ConvexHull(points).volume)


@pytest.mark.parametrize("d", [2, 3])
def test_same_simplices_as_scipy(d):
    spatial = pytest.importorskip("scipy.spatial")
    for n in (d + 1, 10, 100, 3000):
        points = GENERATOR.random((n, d))
        mine, theirs = brio.Delaunay(points), spatial.Delaunay(points)
        assert simplex_set(mine.simplices) == simplex_set(theirs.simplices)
        assert simplex_set(mine.convex_hull) == simplex_set(theirs.convex_hull)
        for name in ("simplices", "neighbors", "equations", "transform", "vertex_to_simplex", "convex_hull", "coplanar",
                     "min_bound", "max_bound"):
            assert getattr(mine, name).shape == getattr(theirs, name).shape, name
            assert getattr(mine, name).dtype == getattr(theirs, name).dtype, name
        order, other = (np.lexsort(np.sort(t.simplices, 1).T) for t in (mine, theirs))
        assert np.allclose(mine.equations[order], theirs.equations[other])
        assert np.isclose(mine.paraboloid_scale, theirs.paraboloid_scale)
        assert np.isclose(mine.paraboloid_shift, theirs.paraboloid_shift)
        for a, b in zip(mine.vertex_neighbor_vertices, theirs.vertex_neighbor_vertices):
            assert a.dtype == b.dtype and a.shape == b.shape
        assert (mine.ndim, mine.npoints, mine.nsimplex) == (theirs.ndim, theirs.npoints, theirs.nsimplex)


@pytest.mark.parametrize("d", [2, 3])
def test_grid_has_no_flat_simplices(d):
    points = grid(7, d)
    tri = brio.Delaunay(points)
    sizes = np.linalg.det(points[tri.simplices[:, 1:]] - points[tri.simplices[:, :1]])
    assert sizes.min() > 0.5 and np.isclose(sizes.sum() / [2, 6][d - 2], 6**d)
    assert not np.isnan(tri.transform).any()
    tri.verify()


@pytest.mark.parametrize("d", [2, 3])
def test_neighbors_are_mutual_and_share_a_facet(d):
    tri = brio.Delaunay(GENERATOR.random((200, d)))
    for s, row in enumerate(tri.neighbors):
        for k, other in enumerate(row):
            if other >= 0:
                assert s in tri.neighbors[other]
                assert set(np.delete(tri.simplices[s], k)) <= set(tri.simplices[other])
    assert (tri.neighbors < 0).sum() == len(tri.convex_hull)


@pytest.mark.parametrize("d", [2, 3])
def test_duplicates_and_hidden(d):
    points = GENERATOR.random((50, d))
    tri = brio.Delaunay(np.concatenate([points, points[:7]]))
    assert tri.duplicates.tolist() == list(range(50, 57)) and tri.hidden.tolist() == []
    assert tri.representatives[50:].tolist() == list(range(7))
    assert tri.coplanar[:, 0].tolist() == list(range(50, 57))
    assert (tri.vertex_to_simplex >= 0).all()
    weights = np.zeros(50)
    weights[3] = -100
    heavy = brio.Delaunay(points, weights)
    assert heavy.hidden.tolist() == [3] or 3 in heavy.convex_hull
    heavy.verify()


def test_weights_against_a_lifted_oracle():
    points, weights = GENERATOR.random((40, 2)), 0.1 * GENERATOR.random(40)
    tri = brio.Delaunay(points, weights)
    lifted = np.column_stack([points, (points**2).sum(1) - weights])
    planes = tri.equations
    z = tri.lift_points(points)[:, -1] - tri.paraboloid_scale * weights
    heights = planes[:, :2] @ points.T + planes[:, 2:3] * z + planes[:, 3:]
    assert (heights <= 1e-9).all() and len(lifted) == tri.npoints


@pytest.mark.parametrize("points", [np.empty((0, 2)), np.empty((0, 3)), np.zeros((1, 3)), np.zeros((5, 2)),
                                    np.outer(np.arange(4.0), [1, 2, 3]), np.outer(np.arange(4.0), [1, 1]),
                                    np.column_stack([grid(3, 2), np.zeros(9)])])
def test_points_in_a_flat(points):
    tri = brio.Delaunay(points)
    assert tri.nsimplex == 0 and tri.simplices.shape == (0, points.shape[1] + 1)
    assert tri.neighbors.shape == tri.simplices.shape and len(tri.equations) == len(tri.transform) == 0
    assert (tri.vertex_to_simplex == -1).all()
    assert (tri.find_simplex(np.zeros((3, points.shape[1]))) == -1).all()
    assert tri.vertex_neighbor_vertices[0].tolist() == [0] * (len(points) + 1)
    tri.verify()
    assert isinstance(tri.checksum, int)


@pytest.mark.parametrize("d", [2, 3])
def test_find_simplex_against_barycentric_coordinates(d):
    tri = brio.Delaunay(GENERATOR.random((100, d)))
    queries = 1.2 * GENERATOR.random((400, d)) - 0.1
    found = tri.find_simplex(queries)
    for query, simplex in zip(queries, found):
        part = np.einsum("sij,sj->si", tri.transform[:, :-1], query - tri.transform[:, -1])
        inside = np.flatnonzero((np.minimum(part.min(axis=1), 1 - part.sum(axis=1)) >= -1e-12))
        assert simplex in inside if len(inside) else simplex == -1
    assert found.dtype == np.int32
    assert tri.find_simplex(queries.reshape(20, 20, d)).shape == (20, 20)
    assert tri.find_simplex([np.nan] * d) == -1 and tri.find_simplex([np.inf] * d) == -1


@pytest.mark.parametrize("d", [2, 3])
def test_find_simplex_takes_the_first_of_several(d):
    points = grid(4, d)
    tri = brio.Delaunay(points)
    for query in itertools.product([0, 0.5, 1, 2.5, 3], repeat=d):
        part = np.einsum("sij,sj->si", tri.transform[:, :-1], np.array(query) - tri.transform[:, -1])
        holds = (part.min(axis=1) >= 0) & (part.sum(axis=1) <= 1)
        assert tri.find_simplex(query) == np.flatnonzero(holds)[0]


def test_find_simplex_with_a_tolerance():
    tri = brio.Delaunay([[0, 0], [1, 0], [0, 1]])
    assert tri.find_simplex([0.5, -1e-9]) == -1
    assert tri.find_simplex([0.5, -1e-9], tol=1e-8) == 0
    assert tri.find_simplex([0.5, -1e-3], tol=1e-8) == -1
    assert tri.find_simplex([0.5, -1e-14]) == 0 and tri.find_simplex([0.5, -1e-14], tol=0) == -1
    for wrong in (-1e-9, np.nan, np.inf, "a", [1, 2]):
        with pytest.raises(brio.ArgumentError, match="tol"):
            tri.find_simplex([0.5, 0.5], tol=wrong)


def turned_grid(n, d, generator):
    """A turned grid, and places on the border of its hull, off by rounding."""
    points = grid(n, d).astype(float)
    turn, _ = np.linalg.qr(generator.normal(size=(d, d)))
    sides = generator.random((100, d)) * (n - 1)
    sides[np.arange(100), generator.integers(0, d, 100)] = generator.integers(0, 2, 100) * (n - 1)
    move = generator.normal(size=d)
    return points @ turn + move, sides @ turn + move


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("exponent", [0, -900, 800])
def test_tolerance_at_hulls_of_slivers(d, exponent):
    """No tolerance reached the simplices behind the slivers of such hulls."""
    generator, outside = np.random.default_rng(7), 0
    for n in (2, 3, 4, 5):
        points, sides = (np.ldexp(x, exponent) for x in turned_grid(n, d, generator))
        tri = brio.Delaunay(points)
        outside += (tri.find_simplex(sides, tol=0) < 0).sum()
        for tol in (None, 1e-12, 1e-6, 0.1):
            found = tri.find_simplex(sides, tol=tol)
            assert (found >= 0).all()
        shares = barycentric_of(tri, found, sides)
        assert (shares[~np.isnan(shares).any(axis=1)] >= -0.1**0.5).all()
    assert outside > 50


def barycentric_of(tri, simplices, queries):
    transform = tri.transform[simplices]
    part = np.einsum("qij,qj->qi", transform[:, :-1], queries - transform[:, -1])
    return np.column_stack([part, 1 - part.sum(axis=1)])


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("tol", [1e-9, 1e-3, 0.1, 1.0])
def test_tolerance_against_all_simplices(d, tol):
    tri = brio.Delaunay(GENERATOR.random((40, d)))
    queries = GENERATOR.random((400, d)) * 1.6 - 0.3
    queries[:40] = tri.points[tri.convex_hull[GENERATOR.integers(0, len(tri.convex_hull), 40)]].mean(axis=1) * (1 + tol / 10)
    found = tri.find_simplex(queries, tol=tol)
    every = np.array([barycentric_of(tri, np.arange(tri.nsimplex), np.tile(q, (tri.nsimplex, 1))).min(axis=1) for q in queries])
    at_hull = (tri.neighbors < 0).any(axis=1)
    within = np.where(at_hull, every, -np.inf).max(axis=1)
    exact = tri.find_simplex(queries, tol=0)
    assert (found[exact >= 0] == exact[exact >= 0]).all()
    others = exact < 0
    assert (found[within >= -tol] >= 0).all()
    chosen = every[np.flatnonzero(others & (found >= 0)), found[others & (found >= 0)]]
    assert (chosen >= -tol).all()


@pytest.mark.parametrize("d", [2, 3])
def test_tolerance_as_in_scipy(d):
    spatial = pytest.importorskip("scipy.spatial")
    points = GENERATOR.random((60, d))
    queries = GENERATOR.random((2000, d)) * 1.4 - 0.2
    ours, theirs = brio.Delaunay(points), spatial.Delaunay(points)
    for tol in (None, 1e-9, 1e-3):
        assert ((ours.find_simplex(queries, tol=tol) < 0) == (theirs.find_simplex(queries, tol=tol) < 0)).all()


def test_threads_and_order_do_not_matter():
    points = GENERATOR.random((20000, 3))
    first = brio.Delaunay(points, threads=1)
    assert brio.Delaunay(points, threads=2).checksum == first.checksum
    assert brio.Delaunay(points[::-1].copy()).checksum == first.checksum
    assert (brio.Delaunay(points, threads=2).simplices == first.simplices).all()


def test_views_are_not_copies():
    points = GENERATOR.random((1000, 3))
    tri = brio.Delaunay(points)
    assert tri.points is points
    assert tri.simplices.strides == (32, 4) and not tri.simplices.flags.owndata and not tri.simplices.flags.writeable
    assert brio.Delaunay(points[:, :2].copy()).simplices.strides == (24, 4)
    simplices = tri.simplices
    kept = simplices.copy()
    del tri
    assert (simplices == kept).all()


def test_arrays_of_many_kinds():
    points = GENERATOR.integers(0, 50, (100, 3)).astype(np.float64)
    wanted = brio.Delaunay(points).checksum
    kinds = [points.astype(np.float32), points.tolist(), tuple(map(tuple, points)), np.asfortranarray(points),
             np.repeat(points, 2, axis=0)[::2], points[::-1][::-1], points.astype(">f8"), points.astype(np.int16),
             points.astype(object), memoryview(points)]
    for kind in kinds:
        assert brio.Delaunay(kind).checksum == wanted
    frozen = points.copy()
    frozen.flags.writeable = False
    assert brio.Delaunay(frozen).checksum == wanted

    class Speaks:
        def __dlpack__(self, **options):
            return points.__dlpack__(**options)

        def __dlpack_device__(self):
            return points.__dlpack_device__()

    assert brio.Delaunay(Speaks()).checksum == wanted


def test_add_points_builds_again():
    points = GENERATOR.random((50, 3))
    tri = brio.Delaunay(points[:20], incremental=True)
    before = tri.simplices
    tri.add_points(points[20:])
    assert tri.npoints == 50 and tri.checksum == brio.Delaunay(points).checksum
    assert len(before) and tri.neighbors.shape == tri.simplices.shape
    tri.close()
    with pytest.raises(RuntimeError):
        tri.add_points(points)
    assert tri.find_simplex(points[0]) >= 0


def test_pickle():
    import pickle

    tri = brio.Delaunay(GENERATOR.random((50, 3)), GENERATOR.random(50) * 0.01)
    again = pickle.loads(pickle.dumps(tri))
    assert again.checksum == tri.checksum and (again.simplices == tri.simplices).all()


def test_what_is_not_offered_says_so():
    for call in (lambda: brio.Delaunay(np.zeros((5, 4))), lambda: brio.Delaunay(np.zeros((5, 2)), furthest_site=True),
                 lambda: brio.Delaunay(np.zeros((5, 2)), qhull_options="QJ"), lambda: brio.Voronoi(np.zeros((5, 5)))):
        with pytest.raises(brio.NotOfferedError, match="not offered"):
            call()
    spatial = pytest.importorskip("scipy.spatial")
    four = GENERATOR.random((20, 4))
    assert isinstance(brio.Delaunay(four, fallback="scipy"), spatial.Delaunay)
    assert isinstance(brio.Delaunay(four[:, :2], qhull_options="QJ", fallback="scipy"), spatial.Delaunay)
    assert isinstance(brio.Voronoi(four, fallback="scipy"), spatial.Voronoi)
    assert isinstance(brio.ConvexHull(four, fallback="scipy"), spatial.ConvexHull)
    assert isinstance(brio.Delaunay(four[:, :3], fallback="scipy"), brio.Delaunay)


@pytest.mark.parametrize("d", [2, 3])
def test_arrays_are_read_only(d):
    points = GENERATOR.random((30, d))
    tri = brio.Delaunay(np.concatenate([points, points[:3]]), np.append(np.full(32, 1.0), 0))
    arrays = {name: getattr(tri, name) for name in dir(tri) if not name.startswith("_")}
    arrays["indptr"], arrays["indices"] = arrays["vertex_neighbor_vertices"]
    arrays = {name: value for name, value in arrays.items() if isinstance(value, np.ndarray)}
    assert {name for name, value in arrays.items() if value.flags.writeable} == {"points", "weights"}
    assert {"duplicates", "hidden", "coplanar", "simplices", "min_bound"} < set(arrays)
    complex = brio.alpha_complex(points)
    assert not complex.order.flags.writeable


def test_a_fallback_that_is_not_known():
    for points in (GENERATOR.random((9, 2)), GENERATOR.random((9, 3)).tolist()):
        for make in (brio.Delaunay, brio.Voronoi, brio.ConvexHull):
            with pytest.raises(brio.ArgumentError, match="fallback"):
                make(points, fallback="x")
