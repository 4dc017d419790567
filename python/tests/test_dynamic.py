"""Triangulations that live: after any changes, those of the points that are left."""

import os
import threading

import numpy as np
import pytest

import brio
from brio._arrays import as_rows

GENERATOR = np.random.default_rng(5)


def is_as_built(tri):
    now = tri.snapshot()
    fresh = brio.Delaunay(tri.points, tri.weights)
    same = [np.array_equal(getattr(now, name), getattr(fresh, name))
            for name in ("simplices", "neighbors", "representatives", "convex_hull")]
    return all(same) and now.checksum == fresh.checksum


@pytest.mark.parametrize("weighted", [False, True])
def test_a_loop_of_changes_ends_as_built(weighted):
    tri = brio.DynamicDelaunay(GENERATOR.integers(0, 5, (40, 3)) / 4, weighted=weighted)
    for step in range(60):
        weights = GENERATOR.random(5) * 0.05 if weighted else None
        new = tri.insert(GENERATOR.random((5, 3)) if step % 2 else GENERATOR.integers(0, 5, (5, 3)) / 4, weights)
        tri.remove(GENERATOR.permutation(tri.indices)[:4])
        some = GENERATOR.permutation(tri.indices)[:6]
        tri.move(some, GENERATOR.random((len(some), 3)))
        if weighted:
            tri.reweight(some, GENERATOR.random(len(some)) * 0.05)
        assert new.dtype == np.uint32 and len(tri) == len(tri.indices) == len(tri.points)
        assert is_as_built(tri)


def test_all_points_move_a_little():
    points = GENERATOR.random((3000, 3))
    tri = brio.DynamicDelaunay(points)
    for _ in range(3):
        points = points + 1e-5 * GENERATOR.standard_normal(points.shape)
        tri.move_all(points)
        assert np.array_equal(tri.points, points) and is_as_built(tri)
    assert tri.facts["in_place"] > 5000


def test_questions():
    points = GENERATOR.random((50, 3))
    tri = brio.DynamicDelaunay(points)
    offsets, neighbours = tri.snapshot().vertex_neighbor_vertices
    for vertex in range(50):
        assert set(tri.neighbors(vertex)) == set(neighbours[offsets[vertex]:offsets[vertex + 1]])
    found = tri.find_vertices([points.mean(axis=0), [9, 9, 9]])
    simplices = set(map(frozenset, tri.snapshot().simplices.tolist()))
    assert frozenset(found[0].tolist()) in simplices and found[1].tolist() == [-1] * 4


def test_what_fails_changes_nothing():
    tri = brio.DynamicDelaunay(GENERATOR.random((30, 3)))
    before = tri.snapshot().checksum
    with pytest.raises(brio.NotFiniteError) as caught:
        tri.insert([[0, 0, 0], [np.nan, 0, 0]])
    assert caught.value.indices.tolist() == [1]
    for wrong in ([99], [-1], [3, 3], [[1]], [0.5]):
        with pytest.raises(brio.ArgumentError):
            tri.remove(wrong)
    with pytest.raises(brio.ArgumentError):
        tri.insert([[0, 0, 0]], [1.0])
    with pytest.raises((ValueError, brio.ArgumentError)):
        tri.move([1, 2], [[0, 0, 0]])
    with pytest.raises((ValueError, brio.ArgumentError)):
        tri.move_all([[0, 0, 0]])
    assert tri.snapshot().checksum == before and len(tri) == 30


def test_a_cancelled_call_changes_nothing():
    tri = brio.DynamicDelaunay(GENERATOR.random((2000, 3)))
    before = tri.snapshot().checksum
    tri.progress = lambda stage, share: True
    with pytest.raises(brio.CancelledError):
        tri.insert(GENERATOR.random((60000, 3)))
    tri.progress = None
    assert tri.snapshot().checksum == before and is_as_built(tri)


@pytest.mark.parametrize("kind, how", [(brio.DynamicDelaunay, {}), (brio.PeriodicDynamicDelaunay, {"cell": [1, 1, 1]})])
def test_a_snapshot_had_the_points_of_another_moment(kind, how):
    class Busy(kind):
        """Another thread changes it whenever its points were read."""

        @property
        def weights(self):
            out = kind.weights.fget(self)
            self.remove(self.indices[:1])
            self.insert(GENERATOR.random((1, 3)))
            return out

    tri = Busy(GENERATOR.random((300, 3)), weighted=True, **how)
    now, still = tri.snapshot(), kind.points.fget(tri)
    assert np.array_equal(now.points, still)
    assert now.check() if how else np.array_equal(now.simplices, brio.Delaunay(now.points, now.weights).simplices)


def test_threads_do_not_meet_in_one_triangulation():
    tri = brio.DynamicDelaunay(GENERATOR.random((500, 3)))
    refused = []

    def work(seed):
        random = np.random.default_rng(seed)
        for _ in range(30):
            try:
                tri.insert(random.random((20, 3)))
            except RuntimeError:
                refused.append(seed)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(tri) == 500 + 20 * (90 - len(refused)) and is_as_built(tri)


def test_points_that_change_places_keep_their_indices():
    points = GENERATOR.random((1500, 3))
    tri = brio.DynamicDelaunay(points)
    for ring in (2, 3):
        some = np.arange(ring) * 400 + 3
        points[some] = np.roll(points[some], 1, axis=0)
        tri.move_all(points)
        assert np.array_equal(tri.points, points) and is_as_built(tri)


def test_weights_without_points_are_refused():
    with pytest.raises(brio.ArgumentError):
        brio.DynamicDelaunay(weights=[1.0])
    assert len(brio.DynamicDelaunay(weighted=True)) == 0


def test_flat_points_and_none_have_answers():
    for points in (np.zeros((0, 3)), [[0, 0, 0]], [[0, 0, 0], [0, 0, 0], [1, 0, 0]]):
        tri = brio.DynamicDelaunay(points)
        assert tri.facts["simplices"] == 0 and len(tri) == len(points)
        assert all(tri.neighbors(i).tolist() == [] for i in range(len(points)))
        assert tri.find_vertices([[0, 0, 0]]).tolist() == [[-1] * 4]
        assert tri.find_vertices(np.zeros((0, 3))).shape == (0, 4)
        tri.move_all(points)
        tri.remove(tri.indices)
        assert len(tri) == 0 and tri.points.shape == (0, 3)
        assert tri.insert(np.zeros((0, 3))).tolist() == []


def test_ten_thousand_steps_end_as_a_fresh_build():
    """Every step inserts, removes and moves some points, and sometimes all of them."""
    long = bool(os.environ.get("BRIO_LONG"))
    steps, every = (10000, 250) if long else (240, 40)
    points = GENERATOR.random((1500, 3))
    tri = brio.DynamicDelaunay(points, threads=1)
    for step in range(1, steps + 1):
        tri.insert(GENERATOR.random((3, 3)))
        tri.remove(GENERATOR.permutation(tri.indices)[:3])
        some = GENERATOR.permutation(tri.indices)[:4]
        tri.move(some, GENERATOR.random((4, 3)))
        if step % 5 == 0:
            now = tri.points
            tri.move_all(now + 1e-5 * GENERATOR.standard_normal(now.shape))
        if step % every == 0:
            assert tri.snapshot().checksum == brio.Delaunay(tri.points).checksum
    assert len(tri) == 1500 and tri.facts["indices"] == 1500 + 3 * steps


class OnlyDlpack:
    """What another library's array shows of itself."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_arrays_of_others_go_in_and_out_by_dlpack():
    points = GENERATOR.random((200, 3))
    assert np.shares_memory(as_rows(OnlyDlpack(points), "points"), points)  # no copy
    tri = brio.DynamicDelaunay(OnlyDlpack(points), OnlyDlpack(np.zeros(200)))
    new = tri.insert(OnlyDlpack(points[:5] + 0.01))
    tri.remove(OnlyDlpack(np.array([3, 4])))
    tri.move(OnlyDlpack(new), OnlyDlpack(points[10:15] + 0.02))
    tri.move_all(OnlyDlpack(tri.points + 1e-4))
    tri.reweight(OnlyDlpack(new), OnlyDlpack(np.full(5, 1e-3)))
    assert is_as_built(tri)
    if np.lib.NumpyVersion(np.__version__) >= "2.1.0":  # older ones export no arrays that cannot be written
        for array in (tri.points, tri.indices, tri.weights, tri.snapshot().simplices, new):
            assert np.shares_memory(np.from_dlpack(array), array)


# --- space that repeats ---

CELL = np.array([[1, 0, 0], [0.5, 0.75, 0], [0.25, -0.5, 1.25]])


def is_as_fresh(tri):
    now = tri.snapshot()
    fresh = brio.Delaunay(tri.points, tri.weights, cell=CELL, periodic=tri.periodic)
    return now.checksum == fresh.checksum and now.nsimplex == fresh.nsimplex and now.check()


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("periodic", ["xyz", "xz"])
def test_changes_in_space_that_repeats_end_as_a_fresh_build(weighted, periodic):
    tri = brio.DynamicDelaunay(GENERATOR.random((60, 3)) @ CELL, cell=CELL, periodic=periodic, weighted=weighted)
    assert isinstance(tri, brio.PeriodicDynamicDelaunay) and tri.weighted == weighted
    for _ in range(8):
        tri.insert((2 * GENERATOR.random((5, 3)) - 0.5) @ CELL, GENERATOR.random(5) * 0.02 if weighted else None)
        tri.remove(GENERATOR.permutation(tri.indices)[:4])
        some = GENERATOR.permutation(tri.indices)[:6]
        tri.move(some, GENERATOR.random((6, 3)) @ CELL)
        tri.move_all(tri.points + 0.01 * GENERATOR.standard_normal((len(tri), 3)))
        if weighted:
            tri.reweight(some, GENERATOR.random(6) * 0.02)
        assert is_as_fresh(tri)
    assert tri.facts["translates"] > tri.facts["points"] == len(tri)


def test_neighbours_in_space_that_repeats_have_shifts():
    points = GENERATOR.random((400, 3))
    tri = brio.DynamicDelaunay(points, cell=[1, 1, 1])
    vor = brio.Voronoi(points, cell=[1, 1, 1])
    for vertex in (0, 7, 399):
        index, shifts = tri.neighbors(vertex)
        span = slice(*vor.neighbor_offsets[vertex:vertex + 2])
        wanted = np.column_stack([vor.neighbor_points[span], vor.neighbor_shifts[span]])
        assert set(map(tuple, np.column_stack([index, shifts]).tolist())) >= set(map(tuple, wanted.tolist()))
    queries = 3 * GENERATOR.random((20, 3)) - 1
    found, shifts = tri.find_vertices(queries)
    corners = points[found] + shifts
    inside = np.linalg.solve((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1), (queries - corners[:, 0])[:, :, None])[:, :, 0]
    assert (inside > -1e-9).all() and (inside.sum(axis=1) < 1 + 1e-9).all()


def test_what_fails_in_space_that_repeats_changes_nothing():
    tri = brio.DynamicDelaunay([[0.5, 0.5, 0.5]], cell=[1, 1, 1])
    before = tri.snapshot().checksum
    for wrong in ([99], [-1], [0, 0]):
        with pytest.raises(brio.ArgumentError):
            tri.remove(wrong)
    with pytest.raises(brio.ArgumentError):
        tri.insert([[1e12, 0, 0]])
    with pytest.raises(brio.ArgumentError):
        brio.DynamicDelaunay([[0, 0, 0]], cell=[1, 1])
    assert tri.snapshot().checksum == before and len(tri) == 1
    assert len(brio.DynamicDelaunay(cell=[1, 1, 1])) == 0


def test_derived_classes_of_space_that_repeats_are_made_whole():
    """One of DynamicDelaunay got an object that was never initialized, one of PeriodicDynamicDelaunay not its own class."""
    class Gas(brio.PeriodicDynamicDelaunay):
        pass

    class Open(brio.DynamicDelaunay):
        pass

    points = np.random.default_rng(3).random((20, 3))
    gas = Gas(points, cell=[1, 1, 1])
    assert type(gas) is Gas and gas.snapshot().checksum == brio.Delaunay(points, cell=[1, 1, 1]).checksum
    assert type(Open(points)) is Open
    with pytest.raises(TypeError, match="derived from PeriodicDynamicDelaunay"):
        Open(points, cell=[1, 1, 1])
