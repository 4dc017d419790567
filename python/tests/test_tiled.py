"""Triangulations in tiles are those of all points; nothing of them dangles, and their files go with them."""

import gc
import itertools
import os
import sys
import threading
import tracemalloc

import numpy as np
import pytest

import brio

GENERATOR = np.random.default_rng(17)
BOX = [0, 0, 0, 1, 1, 1]
CLOUD = GENERATOR.random((1000, 3))
WEIGHTS = 0.01 * GENERATOR.random(1000)
posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no fork and no limits of processes")


@pytest.fixture
def folder(tmp_path):
    """A scratch folder, which must be empty at the end."""
    yield tmp_path
    gc.collect()
    assert os.listdir(tmp_path) == []


def rows(array):
    """The rows, sorted, each in ascending order."""
    ordered = np.sort(np.asarray(array).astype(np.int64), axis=1)
    return ordered[np.lexsort(ordered.T)]


def gathered(tri):
    return rows(np.concatenate([part.indices[part.simplices] for part in tri]))


def sets():
    """Small sets of points, with and without weights: random, with ties, with duplicates, on a sphere."""
    for seed in range(6):
        rng = np.random.default_rng(seed)
        count = int(rng.integers(5, 200))
        kinds = (lambda: rng.random((count, 3)), lambda: rng.integers(0, 5, (count, 3)).astype(float),
                 lambda: np.repeat(rng.random((count, 3)), 2, axis=0),
                 lambda: np.concatenate([rng.normal(size=(count, 3)), np.eye(3), -np.eye(3)]))
        points = kinds[seed % 4]()
        yield points, None if seed % 2 else rng.random(len(points)) * 0.05


@pytest.mark.parametrize("tiles", [1, 2, 7, 64])
@pytest.mark.parametrize("weights", [None, WEIGHTS])
def test_parts_are_the_triangulation_of_all_points(folder, tiles, weights):
    whole = brio.Delaunay(CLOUD, weights)
    with brio.TiledDelaunay(CLOUD, weights, scratch=folder, tiles=tiles) as tri:
        assert tri.checksum == whole.checksum
        assert np.array_equal(gathered(tri), rows(whole.simplices))
        assert {name: tri.facts[name] for name in whole.facts} == whole.facts
        for part in tri:
            assert np.array_equal(part.points, CLOUD[part.indices])
            assert weights is None or np.array_equal(part.weights, weights[part.indices])
            a, b, c, d = (part.points[part.simplices[:, k]] for k in range(4))
            assert (np.linalg.det(np.stack([b - a, c - a, d - a], axis=1)) < 0).sum() in (0, len(part.simplices))
            assert len(np.unique(part.indices)) == len(part.indices)
        assert np.array_equal(tri.min_bound, CLOUD.min(axis=0)) and np.array_equal(tri.max_bound, CLOUD.max(axis=0))


def test_random_sets(folder):
    for (points, weights), tiles in itertools.product(sets(), (2, 9)):
        with brio.TiledDelaunay(points, weights, scratch=folder, tiles=tiles) as tri:
            whole = brio.Delaunay(points, weights)
            assert tri.checksum == whole.checksum and np.array_equal(gathered(tri), rows(whole.simplices))
            assert tri.facts["hidden"] == whole.facts["hidden"] and tri.facts["duplicates"] == whole.facts["duplicates"]


@pytest.mark.parametrize("points", [np.empty((0, 3)), [[1, 2, 3]], [[1, 2, 3]] * 4, np.eye(3), np.indices((5, 5, 1)).reshape(3, -1).T])
def test_points_without_tetrahedra(folder, points):
    with brio.TiledDelaunay(points, scratch=folder, tiles=3) as tri:
        whole = brio.Delaunay(np.asarray(points, float))
        assert tri.facts["simplices"] == 0 and tri.facts["dimension"] == whole.facts["dimension"]
        assert tri.checksum == whole.checksum and gathered(tri).shape == (0, 4)
        assert all(part.neighbors[0].shape == (0, 4) for part in tri)


def test_neighbours_agree(folder):
    """Each names the other, across the same three points; those of the hull are as many as it has facets."""
    with brio.TiledDelaunay(CLOUD, scratch=folder, tiles=7) as tri:
        parts, hull = list(tri), 0
        points = [part.indices[part.simplices] for part in parts]
        for part, mine in zip(parts, points):
            tiles, facing = part.neighbors
            assert tiles.dtype == facing.dtype == np.int32 and not tiles.flags.writeable
            hull += int((tiles < 0).sum())
            for other in range(7):
                row, facet = np.nonzero(tiles == other)
                there = facing[row, facet]
                back = (parts[other].neighbors[0][there] == part.tile) & (parts[other].neighbors[1][there] == row[:, None])
                assert (back.sum(axis=1) == 1).all()
                away = np.nonzero(back)[1]
                ours, theirs = mine[row].astype(np.int64), points[other][there].astype(np.int64)
                ours[np.arange(len(row)), facet] = -1
                theirs[np.arange(len(row)), away] = -1
                assert np.array_equal(np.sort(ours, axis=1), np.sort(theirs, axis=1))
        assert hull == tri.facts["hull"]


@pytest.mark.parametrize("weights", [None, WEIGHTS])
@pytest.mark.parametrize("ordered", [False, True])
def test_cells_are_those_of_all_points(folder, weights, ordered):
    known = brio.Voronoi(CLOUD, weights, box=BOX).cells
    place = np.full(len(CLOUD), -1)
    place[known["site"]] = np.arange(len(known["site"]))
    blocks = []
    with brio.TiledDelaunay(CLOUD, weights, scratch=folder, tiles=5, stars="ordered-faces") as tri:
        facts = tri.cells(blocks.append, box=BOX, ordered=ordered)
        assert facts["volume_sum"] == pytest.approx(1, abs=1e-12) and facts["cells"] == len(known["site"])
    sites = np.concatenate([block["site"] for block in blocks])
    assert sorted(sites) == sorted(known["site"]) and (not ordered or np.array_equal(sites, known["site"]))
    for name in ("volume", "area", "centroid", "bounded"):
        np.testing.assert_array_equal(np.concatenate([block[name] for block in blocks]), known[name][place[sites]])
    faces = np.concatenate([np.diff(block["face_offsets"]) for block in blocks])
    assert np.array_equal(faces, np.diff(known["face_offsets"])[place[sites]]) and facts["faces"] == faces.sum()


def test_cells_have_what_is_asked_for(folder):
    with brio.TiledDelaunay(CLOUD[:200], scratch=folder, tiles=2, stars=True) as tri:
        blocks = []
        tri.cells(blocks.append, areas=False, centroids=False, faces=False)
        tri.cells(blocks.append, vertices=True)
    assert set(blocks[0]) == {"site", "volume", "bounded"}
    assert {"vertices", "face_vertices", "corner_offsets"} <= set(blocks[-1])
    last = blocks[-1]
    assert last["corner_offsets"][-1] == len(last["face_vertices"]) and last["face_vertices"].max() < len(last["vertices"])


def test_alpha_shapes_are_those_of_all_points(folder):
    whole = brio.AlphaShape(CLOUD, 0.01)
    with brio.TiledDelaunay(CLOUD, scratch=folder, tiles=6, stars=True) as tri:
        given = []
        facts = tri.alpha_shape(0.01, given.append)
        assert facts == tri.alpha_shape(0.01)
        with pytest.raises(brio.NoAnswerError):
            tri.alpha_shape(1e-9)
    assert facts["tetrahedra"] == whole.counts["tetrahedra"] and facts["faces"] == len(whole.faces)
    assert [part.tile for part in given] == sorted({part.tile for part in given})
    assert all(np.array_equal(part.points, CLOUD[part.indices]) for part in given)
    ours = np.concatenate([part.points[part.faces] for part in given])
    theirs = whole.vertices[whole.faces]
    assert np.array_equal(*(np.unique(np.sort(faces.view("f8,f8,f8").reshape(-1, 3), axis=1), axis=0) for faces in (ours, theirs)))


class OnDisk:
    """Like what h5py opens: it has a shape, and reads what is asked for."""

    def __init__(self, values):
        self.values, self.most = values, 0
        self.shape, self.ndim = values.shape, 2

    def __getitem__(self, rows):
        self.most = max(self.most, len(self.values[rows]))
        return self.values[rows]

    def __array__(self, *args, **options):
        raise AssertionError("read as a whole")


def test_forms_of_points(folder, tmp_path_factory):
    path = tmp_path_factory.mktemp("points") / "points.npy"
    rounded = CLOUD.astype(np.float32)
    np.save(path, rounded)
    known = brio.Delaunay(rounded).checksum
    halves = rounded[:700], rounded[700:]
    for form in (rounded.tolist(), np.load(path, mmap_mode="r"), np.asfortranarray(rounded), OnDisk(rounded), iter(halves),
                 (part for part in halves), ((part, None) for part in halves)):
        with brio.TiledDelaunay(form, scratch=folder, tiles=3) as tri:
            assert tri.checksum == known
    with brio.TiledDelaunay(scratch=folder, tiles=3) as tri:
        tri.read(path)
        tri.run()
        assert tri.checksum == known
    with brio.TiledDelaunay(zip(np.array_split(CLOUD, 4), np.array_split(WEIGHTS, 4)), scratch=folder, tiles=3) as tri:
        assert tri.checksum == brio.Delaunay(CLOUD, WEIGHTS).checksum


def test_weights_of_a_file(folder, tmp_path_factory):
    path = tmp_path_factory.mktemp("points") / "points.ply"
    brio.Mesh(CLOUD, properties={"heavy": WEIGHTS}).write(path)
    with brio.TiledDelaunay(scratch=folder, tiles=3) as tri:
        tri.read(path, weights="heavy")
        tri.run()
        assert tri.checksum == brio.Delaunay(CLOUD, WEIGHTS).checksum
    with brio.TiledDelaunay(scratch=folder) as tri:
        with pytest.raises(brio.ArgumentError, match="'light'"):
            tri.read(path, weights="light")
        with pytest.raises(brio.ArgumentError, match="xyq"):
            tri.read(path, format="xyq")
        with pytest.raises(brio.OpenError):
            tri.read(str(path) + "-")


def test_blocks_are_read_in_slices_and_not_kept(folder):
    long = OnDisk(np.broadcast_to(np.array([1.0, 2, 3]), (200_000, 3)))
    block = GENERATOR.random((60_000, 3))
    with brio.TiledDelaunay(scratch=folder, tiles=2) as tri:
        tri.add(long)
        assert long.most <= 65536 and tri.facts["points"] == 200_000
        before = sys.getrefcount(block)
        tracemalloc.start()
        for _ in range(4):
            tri.add(block)
        held = tracemalloc.get_traced_memory()[0]
        tracemalloc.stop()
        assert sys.getrefcount(block) == before and held < 100_000


# --- lifetimes ---


def test_arrays_outlive_everything_else(folder):
    tri = brio.TiledDelaunay(CLOUD, scratch=folder, tiles=4)
    parts = list(tri)
    neighbors = parts[1].neighbors
    arrays = [(part.points, part.indices, part.simplices) for part in parts] + [neighbors]
    copies = [tuple(array.copy() for array in some) for some in arrays]
    tri.close()
    tri.close()
    del tri, parts
    gc.collect()
    for k in range(3):  # what was freed would be another's now
        brio.Delaunay(GENERATOR.random((3000, 3)))
    for some, same in zip(arrays, copies):
        assert all(np.array_equal(a, b) and not a.flags.writeable for a, b in zip(some, same))


def test_a_part_keeps_the_triangulation(folder):
    part = brio.TiledDelaunay(CLOUD, scratch=folder, tiles=4).part(2)
    gc.collect()
    assert len(os.listdir(folder)) == 1 and part.neighbors[0].shape == (len(part.simplices), 4)
    other = brio.TiledDelaunay(CLOUD, scratch=folder, tiles=4)
    late = other.part(0)
    other.close()
    with pytest.raises(brio.ArgumentError, match="closed"):
        late.neighbors


def test_what_stays_after_the_end(folder):
    with brio.TiledDelaunay(CLOUD, scratch=folder, tiles=2) as tri:
        checksum, facts = tri.checksum, tri.facts
    assert tri.checksum == checksum and tri.facts == facts and "1000 points" in repr(tri)
    for call in (lambda: tri.part(0), tri.run, lambda: tri.add(CLOUD), lambda: tri.cells(print), lambda: next(iter(tri))):
        with pytest.raises(brio.ArgumentError, match="closed"):
            call()


def test_files_go_however_it_ends(folder):
    with pytest.raises(ZeroDivisionError), brio.TiledDelaunay(CLOUD, scratch=folder) as tri:
        assert len(os.listdir(folder)) == 1
        raise ZeroDivisionError
    assert os.listdir(folder) == []
    for _ in range(2):
        with pytest.raises(brio.NotFiniteError):
            brio.TiledDelaunay(np.full((4, 3), np.nan), scratch=folder)
    tri = brio.TiledDelaunay(CLOUD, scratch=folder)
    tri.itself = tri
    del tri
    gc.collect()
    assert os.listdir(folder) == []


@posix
def test_a_child_of_a_fork_leaves_the_files_and_they_go_at_the_end_of_the_program(alone, folder):
    assert alone("""
import os, sys, numpy as np, brio
tri = brio.TiledDelaunay(np.random.default_rng(1).random((500, 3)), scratch=sys.argv[1], tiles=3)
tri.itself, part = tri, tri.part(0)
child = os.fork()
if not child:
    try:
        tri.part(1)
    except brio.ArgumentError as error:
        refused = "forked" in str(error)
    assert part.points.shape[1] == 3
    tri.close()
    del tri.itself, tri, part
    sys.exit(0 if refused else 1)
assert os.waitpid(child, 0)[1] == 0
print(sum(len(part.simplices) for part in tri) == tri.facts["simplices"], len(part.neighbors[0]) == len(part.simplices))
""", str(folder)).split() == ["True", "True"]


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="counts threads where Linux lists them")
def test_contexts_are_used_again(folder):
    """The threads of a context of the library stay."""
    counts = []
    for k in range(8):
        with brio.TiledDelaunay(CLOUD, scratch=folder, tiles=1, threads=3) as tri:
            tri.part(0)
        brio.Delaunay(CLOUD, threads=3, max_memory=1e8)
        counts.append(len(os.listdir("/proc/self/task")))
    assert counts[-1] == counts[2]


# --- functions of the user, threads, progress ---


def test_what_a_function_raises_ends_the_work(folder):
    with brio.TiledDelaunay(CLOUD, scratch=folder, tiles=4, stars=True) as tri:
        calls = []

        def fail(block):
            calls.append(block)
            raise LookupError("no")

        for work in (tri.cells, lambda take: tri.alpha_shape(0.01, take)):
            calls.clear()
            with pytest.raises(LookupError, match="no"):
                work(fail)
            assert len(calls) == 1

        def meddle(block):
            for call in (lambda: tri.part(0), lambda: tri.facts, tri.close):
                with pytest.raises(RuntimeError, match="another call"):
                    call()

        tri.cells(meddle)
        assert tri.checksum == brio.Delaunay(CLOUD).checksum


def test_threads_do_not_meet_in_one_triangulation(folder):
    inside, go = threading.Event(), threading.Event()
    tri = brio.TiledDelaunay(CLOUD, scratch=folder, tiles=2, stars=True)
    thread = threading.Thread(target=tri.cells, args=(lambda block: inside.set() or go.wait(10),))
    thread.start()
    assert inside.wait(10)
    with pytest.raises(RuntimeError):
        tri.part(0)
    assert brio.Delaunay(CLOUD).nsimplex == brio.Delaunay(CLOUD, threads=1).nsimplex  # others are not held up
    go.set()
    thread.join()
    assert tri.part(0).tile == 0
    tri.close()


def test_triangulations_side_by_side(folder):
    """The interpreter's lock is not held: four work at a time, and drop each other's parts."""
    sums, known = [], brio.Delaunay(CLOUD).checksum

    def work():
        with brio.TiledDelaunay(CLOUD, scratch=folder, tiles=4) as tri:
            sums.append((tri.checksum, sum(len(part.simplices) for part in tri)))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(sums) == 4 and len(set(sums)) == 1 and sums[0][0] == known


def test_progress_and_a_run_that_goes_on(folder):
    heard = []

    def stop(stage, share):
        heard.append(share)
        return share > 0.3

    many = GENERATOR.random((20_000, 3))
    with brio.TiledDelaunay(scratch=folder, tiles=10, threads=1) as tri:
        tri.add(many)
        tri.progress = stop
        with pytest.raises(brio.CancelledError):
            tri.run()
        assert heard and heard == sorted(heard) and heard[-1] < 1
        with pytest.raises(brio.ArgumentError, match="not triangulated yet"):
            tri.part(0)
        tri.progress = None
        tri.run()
        assert tri.checksum == brio.Delaunay(many).checksum


# --- refusals ---


def test_refusals(folder):
    new = lambda **options: brio.TiledDelaunay(scratch=folder, **options)
    for wrong in ({"tiles": 0}, {"tiles": 65537}, {"tiles": 2.0}, {"stars": "yes"}, {"stars": []}, {"key": -1}, {"key": 2**64},
                  {"max_memory": 0}, {"weights": [1.0]}, {"threads": -1}):
        with pytest.raises(brio.ArgumentError):
            new(**wrong)
    with pytest.raises(brio.OutOfMemoryError, match="tiles need about"):
        new(tiles=65536, max_memory=20e6)
    with pytest.raises(TypeError):
        brio.TiledDelaunay(CLOUD)
    for where, kind in ((folder / "none", brio.OpenError), ("", brio.OpenError), (None, brio.ArgumentError), ("a\0b", brio.ArgumentError)):
        with pytest.raises(kind):
            brio.TiledDelaunay(CLOUD, scratch=where)
    tri = new(tiles=2)
    for points, weights in (([[1, 2]], None), ([1, 2, 3], None), (CLOUD, [1.0]), (CLOUD, WEIGHTS[:, None]), ("text", None), (None, None),
                            (iter([CLOUD]), WEIGHTS), (iter([[1, 2, 3]]), None), (np.ma.masked_all((3, 3)), None), (5, None)):
        with pytest.raises(brio.ArgumentError):
            tri.add(points, weights)
    assert tri.facts["points"] == 0
    for call in (lambda: tri.part(0), lambda: tri.checksum, lambda: tri.cells(print), lambda: tri.alpha_shape(1)):
        with pytest.raises(brio.ArgumentError, match="not triangulated yet"):
            call()
    tri.add(CLOUD[:50])
    with pytest.raises(brio.ArgumentError, match="no weights"):
        tri.add(CLOUD[:5], WEIGHTS[:5])
    tri.run()
    for call in (tri.run, lambda: tri.add(CLOUD), lambda: tri.part(2), lambda: tri.part(-1), lambda: tri.part(0.5), lambda: tri.cells(5),
                 lambda: tri.alpha_shape(1, 5), lambda: tri.alpha_shape("a")):
        with pytest.raises(brio.ArgumentError):
            call()
    for call in (lambda: tri.cells(print), lambda: tri.alpha_shape(1)):
        with pytest.raises(brio.ArgumentError, match="stars"):
            call()


def test_points_that_are_not_finite_are_named(folder):
    points, weights = np.zeros((100_000, 3)), np.zeros(100_000)
    points[70_001, 1], points[70_003, 2], weights[70_002] = np.inf, np.nan, np.nan
    with brio.TiledDelaunay(scratch=folder) as tri:
        tri.add(np.ones((5, 3)), np.zeros(5))
        with pytest.raises(brio.NotFiniteError, match="point 70006: y is infinite") as caught:
            tri.add(points, weights)
        assert caught.value.indices.tolist() == [70_006, 70_007, 70_008]


def test_a_limit_of_memory_says_how_many_tiles_would_do(folder):
    many = GENERATOR.random((40_000, 3))
    with brio.TiledDelaunay(scratch=folder, tiles=1, threads=1, max_memory=20e6) as tri:
        tri.add(many)
        with pytest.raises(brio.OutOfMemoryError, match=r"of 1 tiles .* take about (\d+) tiles") as caught:
            tri.run()
    enough = int(str(caught.value).split()[-2])
    with brio.TiledDelaunay(many, scratch=folder, tiles=enough, threads=1, max_memory=20e6) as tri:
        assert tri.facts["simplices"] == brio.Delaunay(many).nsimplex


def test_a_folder_of_another_run(folder):
    with brio.TiledDelaunay(scratch=folder, key=7, tiles=2) as first:
        with pytest.raises(brio.OpenError, match="in use"):
            brio.TiledDelaunay(scratch=folder, key=7, tiles=2)
        with brio.TiledDelaunay(scratch=folder, key=8, tiles=2) as other:
            assert not first.has_points and not other.has_points


@posix
def test_a_killed_process_leaves_what_the_next_goes_on_with(alone, folder):
    program = """
import os, signal, sys, numpy as np, brio
points = np.random.default_rng(1).random((3000, 3))
tri = brio.TiledDelaunay(points, scratch=sys.argv[1], tiles=4, key=2**64 - 1)
if tri.facts["resumed"] == 0:
    os._exit(0)
print(tri.has_points, tri.facts["resumed"], tri.checksum == brio.Delaunay(points).checksum)
"""
    assert alone(program, str(folder)) == ""
    assert alone(program, str(folder)).split() == ["True", "4", "True"]


@posix
def test_a_full_disk(alone, folder):
    """A limit on the size of files ends what writes them: an exception of brio, and nothing is left."""
    assert alone("""
import os, resource, sys, numpy as np, brio
resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, resource.RLIM_INFINITY))
points = np.random.default_rng(1).random((50_000, 3))
for work in (lambda: brio.TiledDelaunay(points, scratch=sys.argv[1], tiles=2), lambda: brio.Delaunay(points, scratch=sys.argv[1])):
    try:
        work()
    except brio.Error as error:
        print(type(error).__name__, os.listdir(sys.argv[1]))
""", str(folder)).split("\n")[:2] == ["WriteError []", "OutOfMemoryError []"]
