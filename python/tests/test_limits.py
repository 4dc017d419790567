"""scratch= and max_memory=: the same bits in files and within a limit; neither outlives its call."""

import copy
import os
import pickle
import threading

import numpy as np
import pytest

import brio

GENERATOR = np.random.default_rng(23)
CLOUD = GENERATOR.random((2000, 3))
BALL = GENERATOR.normal(size=(1000, 3))
BALL /= np.linalg.norm(BALL, axis=1)[:, None]
LARGE = GENERATOR.random((20_000, 3))


@pytest.fixture
def folder(tmp_path):
    """A scratch folder, in which nothing ever has a name."""
    yield tmp_path
    assert os.listdir(tmp_path) == []


def arrays(made):
    """All arrays and numbers of a result."""
    if isinstance(made, brio.Mesh):
        numbers = [*made.properties.values(), *made.face_properties.values()]
        return [made.vertices, made.face_offsets, made.face_vertices, made.tetrahedra, made.edges, *numbers]
    if isinstance(made, brio.Delaunay):
        return [made.simplices, made.neighbors, made.representatives, made.checksum, made.find_simplex(CLOUD[:99, : made.ndim])]
    if isinstance(made, brio.PeriodicVoronoi):
        return [made.volumes, made.areas, made.neighbor_points, made.face_areas]
    if isinstance(made, brio.Voronoi):
        return [made.vertices, made.ridge_points, made.volumes]
    if isinstance(made, brio.ConvexHull):
        return [made.simplices, made.volume, made.neighbors]
    if isinstance(made, (brio.AlphaComplex, brio.PeriodicAlphaComplex)):
        return [*made.simplices, *made.values]
    return [made]


MAKERS = {
    "Delaunay": lambda o: brio.Delaunay(CLOUD, **o), "regular": lambda o: brio.Delaunay(CLOUD, 0.01 * CLOUD[:, 0], **o),
    "plane": lambda o: brio.Delaunay(CLOUD[:, :2], **o), "periodic": lambda o: brio.Voronoi(CLOUD[:500], cell=[1, 1, 1], **o),
    "Voronoi": lambda o: brio.Voronoi(CLOUD, **o), "ConvexHull": lambda o: brio.ConvexHull(BALL, **o),
    "alpha_complex": lambda o: brio.alpha_complex(CLOUD, **o), "AlphaShape": lambda o: brio.AlphaShape(CLOUD, 0.01, **o),
    "periodic alpha": lambda o: brio.alpha_complex(CLOUD[:300], cell=[1, 1, 1], **o),
    "labeled-delaunay": lambda o: brio.reconstruct(BALL, **o), "power-crust": lambda o: brio.reconstruct(BALL, "power-crust", **o),
    "cocone": lambda o: brio.reconstruct(BALL, "cocone", **o), "tight-cocone": lambda o: brio.reconstruct(BALL, "tight-cocone", **o),
    "oriented_normals": lambda o: brio.oriented_normals(BALL, **o), "offset": lambda o: brio.offset(BALL, 0.1, **o),
    "medial_axis": lambda o: brio.medial_axis(BALL, **o), "thin": lambda o: brio.thin(CLOUD, 0.1, **o),
    "outliers": lambda o: brio.outliers(CLOUD, **o)}


@pytest.mark.parametrize("name", MAKERS)
def test_the_same_bits_in_scratch_files(folder, name):
    in_memory, in_files = arrays(MAKERS[name]({})), arrays(MAKERS[name]({"scratch": folder, "max_memory": 2e8}))
    assert len(in_memory) == len(in_files)
    for one, other in zip(in_memory, in_files):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", MAKERS)
def test_refusals(name, folder):
    for limits, kind in (({"scratch": folder / "none"}, brio.OpenError), ({"scratch": ""}, brio.OpenError),
                         ({"scratch": 5}, brio.ArgumentError), ({"max_memory": 0}, brio.ArgumentError),
                         ({"max_memory": np.nan}, brio.ArgumentError), ({"max_memory": "8G"}, brio.ArgumentError),
                         ({"max_memory": 5000}, brio.OutOfMemoryError)):
        with pytest.raises(kind):
            MAKERS[name](limits)


@pytest.mark.parametrize("make, options", [
    (brio.Delaunay, {}), (brio.Delaunay, {"cell": [1, 1, 1]}), (lambda p, **o: brio.Delaunay(p[:, :2], **o), None),
    (brio.reconstruct, {"method": "labeled-delaunay"}), (brio.reconstruct, {"method": "power-crust"}),
    (brio.reconstruct, {"method": "cocone"}), (brio.reconstruct, {"method": "cocone", "pieces": 4}),
    (brio.reconstruct, {"method": "tight-cocone"})])
def test_estimates(make, options):
    """What is estimated is enough, and what is estimated over the limit is refused before the work."""
    points = np.concatenate([BALL] + [BALL * (2 + k) for k in range(3)])
    need = brio.estimate_memory(points[:, :2] if options is None else points, **(options or {}))
    heard = []
    with pytest.raises(brio.OutOfMemoryError, match="about .* MiB needed, over the limit of .* MiB"):
        make(points, max_memory=need - 1, progress=lambda *said: heard.append(said), **(options or {}))
    assert heard == []
    make(points, max_memory=1.15 * need, **(options or {}))


def test_estimates_refuse(folder):
    for call in (lambda: brio.estimate_memory(CLOUD, method="x"), lambda: brio.estimate_memory(CLOUD, pieces=3),
                 lambda: brio.estimate_memory(CLOUD, CLOUD[:, 0], method="cocone"), lambda: brio.estimate_memory([[1.0]]),
                 lambda: brio.estimate_memory(CLOUD[:, :2], cell=[1, 1, 1]), lambda: brio.estimate_memory(CLOUD[:, :2], method="cocone"),
                 lambda: brio.estimate_memory(CLOUD, [1.0]), lambda: brio.estimate_memory(CLOUD, threads=-1)):
        with pytest.raises(brio.ArgumentError):
            call()
    with pytest.raises(brio.NotFiniteError) as caught:
        brio.Delaunay([[0, 0, 0], [np.nan, 0, 0]], max_memory=1e9)
    assert caught.value.indices.tolist() == [1]


def test_files_take_the_place_of_memory(folder):
    """What a limit refuses has room in files, and so has what is computed later."""
    with pytest.raises(brio.OutOfMemoryError, match=r"about 6.\d MiB needed, over the limit of 5.7 MiB"):
        brio.Delaunay(LARGE, max_memory=6e6, threads=1)
    tri = brio.Delaunay(LARGE, scratch=folder, max_memory=6e6, threads=1)
    assert tri.checksum == brio.Delaunay(LARGE).checksum
    tri.verify()
    assert (tri.find_simplex(LARGE[:50]) >= 0).all()
    other = pickle.loads(pickle.dumps(tri))
    assert other._limits == tri._limits == copy.copy(tri)._limits and other.checksum == tri.checksum


def test_a_mesh_of_a_file_has_its_arrays_in_scratch(folder, tmp_path_factory):
    path = tmp_path_factory.mktemp("mesh") / "points.ply"
    brio.write(path, LARGE)
    with pytest.raises(brio.OutOfMemoryError):
        brio.read(path, max_memory=4e5)
    assert np.array_equal(brio.read(path, scratch=folder, max_memory=4e5).vertices, LARGE)


def test_neither_outlives_its_call(folder):
    """Calls take contexts that others had: a limit and a folder are those of one call, also where it failed."""
    for limits in ({"max_memory": 1000}, {"scratch": folder}, {"scratch": folder / "none"}):
        for _ in range(2):
            try:
                brio.outliers(CLOUD, **limits)
            except (brio.OutOfMemoryError, brio.OpenError):
                pass
            assert brio.outliers(CLOUD).sum() == 0
    kept = [brio.Delaunay(LARGE) for _ in range(2)]  # what others hold does not count
    assert brio.Delaunay(CLOUD[:100], max_memory=1.5e6).nsimplex > 0 and len(kept) == 2


def test_each_thread_has_its_own(folder):
    outcomes = {}

    def work(most):
        try:
            outcomes[most] = len(brio.outliers(LARGE, max_memory=most, threads=1))
        except brio.OutOfMemoryError as error:
            outcomes[most] = "limit %d" % most in str(error)

    threads = [threading.Thread(target=work, args=(most,)) for most in (10**4, 10**5, 5 * 10**5, 10**9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [outcomes[most] for most in (10**4, 10**5, 5 * 10**5)] == [True] * 3 and outcomes[10**9] == len(LARGE)


@pytest.mark.parametrize("tiles", [1, 3])
def test_surfaces_from_tiles(folder, tiles):
    seen = set()

    def look(stage, share):
        seen.update(os.listdir(folder))

    known = brio.reconstruct(BALL)
    made = brio.reconstruct(BALL, tiles=tiles, scratch=folder, progress=look)
    assert all(np.array_equal(one, other) for one, other in zip(arrays(known), arrays(made)))
    assert known.report == made.report and np.array_equal(known.samples, made.samples)
    normals = brio.oriented_normals(BALL, tiles=tiles, scratch=folder)
    assert np.array_equal(normals, brio.oriented_normals(BALL)) and seen <= {"brio-tiles-1"}


def test_refusals_of_tiles(folder):
    for options in ({"tiles": 3}, {"tiles": -1}, {"tiles": 1.5}, {"tiles": 65537}, {"tiles": "3"}):
        with pytest.raises(brio.ArgumentError, match="tiles"):
            brio.reconstruct(BALL, **options, **({} if options == {"tiles": 3} else {"scratch": folder}))
    with pytest.raises(TypeError, match="tiles"):
        brio.reconstruct(BALL, "cocone", tiles=3, scratch=folder)
    with pytest.raises(brio.OutOfMemoryError, match="take about"):
        brio.reconstruct(LARGE, tiles=1, scratch=folder, max_memory=10e6)


def test_tiles_are_made(folder):
    """The surface of a cloud that is triangulated in tiles has files meanwhile."""
    seen = set()
    brio.reconstruct(np.concatenate([BALL, 1.5 * BALL, 2 * BALL]), tiles=3, scratch=folder,
                     progress=lambda stage, share: seen.update(os.listdir(folder)))
    assert seen == {"brio-tiles-1"}
