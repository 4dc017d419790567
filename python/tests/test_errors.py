"""Errors: their classes, sentences, statuses and indices; progress and cancelling."""

import numpy as np
import pytest

import brio
from brio import _calls

GENERATOR = np.random.default_rng(5)


def test_every_status_has_a_class():
    for status, kind in brio.errors._BY_STATUS.items():
        error = brio.errors._make_error(status, "point 7: wrong, points 8 and 9 too", [7, 8], "why")
        assert type(error) is kind and error.status == status and str(error) == error.sentence
        assert error.indices.tolist() == [7, 8] and error.reason == "why" and isinstance(error, brio.Error)
    assert type(brio.errors._make_error(12345, "")) is brio.InternalError


@pytest.mark.parametrize("make", [brio.Delaunay, brio.Voronoi, brio.ConvexHull, brio.reconstruct, brio.AlphaShape])
def test_points_that_are_not_finite_are_named(make):
    points = GENERATOR.random((50, 3))
    points[[3, 17], [0, 2]] = np.nan, np.inf
    with pytest.raises(brio.NotFiniteError, match="point 3") as caught:
        make(points)
    assert caught.value.indices.tolist() == [3, 17] and caught.value.status == 11
    assert isinstance(caught.value, ValueError)


def test_weights_that_are_not_finite_are_named():
    weights = np.zeros(50)
    weights[9] = -np.inf
    with pytest.raises(brio.NotFiniteError) as caught:
        brio.Delaunay(GENERATOR.random((50, 2)), weights)
    assert caught.value.indices.tolist() == [9]


@pytest.mark.parametrize("points", [np.zeros(3), np.zeros((2, 2, 2)), 3.0, "abc", None, [[1, 2], [3]], [["a", "b"]],
                                    np.zeros((3, 2), complex), np.ma.masked_all((3, 2)), object(), {}, [[None, 1]],
                                    np.zeros((3, 2), "datetime64[s]"), np.zeros(3, "f8,f8")])
def test_what_is_no_array_of_points(points):
    for make in (brio.Delaunay, brio.Voronoi, brio.ConvexHull, brio.reconstruct, brio.alpha_complex, brio.Mesh):
        with pytest.raises((brio.ArgumentError, brio.NotFiniteError)):
            make(points)


def unaligned(array):
    out = np.frombuffer(bytearray(array.nbytes + 1), np.uint8)[1:].view(array.dtype).reshape(array.shape)
    out[...] = array
    return out


def test_arrays_that_are_not_aligned_are_copied():
    points, faces = GENERATOR.random((9, 3)), np.array([[0, 1, 2]], np.uint32)
    assert np.array_equal(brio.Delaunay(unaligned(points)).simplices, brio.Delaunay(points).simplices)
    assert np.array_equal(brio.Mesh(unaligned(points), unaligned(faces)).vertices, points)
    assert brio.Delaunay(points, unaligned(np.arange(9.0))).checksum == brio.Delaunay(points, np.arange(9.0)).checksum


def test_numbers_beyond_doubles_are_an_argument_error():
    with pytest.raises(brio.ArgumentError, match="points"):
        brio.Delaunay([[10**400, 0, 0]])
    with pytest.raises(brio.ArgumentError, match="values"):
        brio.LinearNDInterpolator([[0, 0, 0]], [10**400])


def test_interpolators_of_no_points():
    for shape in ((0,), (0, 2)):
        found = brio.LinearNDInterpolator(np.zeros((0, 3)), np.zeros(shape))([[0, 0, 0]])
        assert found.shape == (1, *shape[1:]) and np.isnan(found).all()


def test_a_mesh_of_no_points_with_rows_as_properties_can_be_written(tmp_path):
    brio.Mesh(np.zeros((0, 3)), properties={"rows": np.zeros((0, 2))}).write(tmp_path / "none.ply")
    assert len(brio.read(tmp_path / "none.ply").vertices) == 0


RAGGED = [[1, 2, 3], [4, 5]]


@pytest.mark.parametrize("call", [
    lambda m: brio.LinearNDInterpolator(m.vertices, RAGGED), lambda m: m.select(RAGGED),
    lambda m: m.carry_properties(m, RAGGED), lambda m: brio.Mesh(m.vertices, properties={"a": RAGGED}),
    lambda m: brio.Mesh(m.vertices, 5), lambda m: brio.Mesh(m.vertices, [1.5]), lambda m: brio.Mesh(m.vertices, object()),
    lambda m: brio.Mesh(m.vertices, tetrahedra=RAGGED), lambda m: brio.Mesh(m.vertices, edges=RAGGED),
    lambda m: brio.LinearNDInterpolator(m.vertices, [1, 2, 3])([1, 2, 3, 4]),
    lambda m: brio.LinearNDInterpolator(m.vertices, [1, 2, 3])(5),
    lambda m: brio.LinearNDInterpolator(m.vertices, [1, 2, 3])([1, 2], [1, 2, 3], 0)])
def test_lists_that_are_no_array_are_an_argument_error(call):
    with pytest.raises(brio.ArgumentError):
        call(brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))


@pytest.mark.parametrize("weights", [np.zeros(4), np.zeros((5, 1)), 1.0, "abcde", [1, 2, 3, 4, None]])
def test_weights_of_another_shape(weights):
    with pytest.raises((brio.ArgumentError, brio.NotFiniteError), match="weight"):
        brio.Delaunay(GENERATOR.random((5, 3)), weights)


@pytest.mark.parametrize("d", [2, 3])
def test_points_that_were_changed_are_noticed(d):
    points = GENERATOR.random((100, d))
    tri = brio.Delaunay(points)
    points[7] = 5
    for call in (lambda: tri.find_simplex(points), tri.verify, lambda: tri.transform, lambda: tri.equations,
                 lambda: tri.lift_points(points), lambda: tri.duplicates, lambda: brio.AlphaComplex(tri)):
        with pytest.raises(brio.ArgumentError, match="changed"):
            call()
    points[7] = np.nan
    with pytest.raises(brio.ArgumentError, match="changed"):
        tri.verify()


@pytest.mark.parametrize("d", [2, 3])
def test_alpha_shapes_of_points_that_were_changed(d):
    points = GENERATOR.random((100, d))
    complex = brio.alpha_complex(points)
    points[7] = 5
    with pytest.raises(brio.ArgumentError, match="changed"):
        complex.shape(complex.auto_alpha())


@pytest.mark.parametrize("d", [2, 3])
def test_find_simplex_keeps_its_locator_when_points_change(d):
    points = GENERATOR.random((100, d))
    tri, queries = brio.Delaunay(points), GENERATOR.random((50, d))
    wanted = tri.find_simplex(queries)
    points[7] = 5
    assert (tri.find_simplex(queries) == wanted).all()


@pytest.mark.parametrize("interpolator", [brio.LinearNDInterpolator, brio.NaturalNeighbourInterpolator])
@pytest.mark.parametrize("d", [2, 3])
def test_interpolators_of_a_triangulation_with_added_points(interpolator, d):
    tri = brio.Delaunay(GENERATOR.random((20, d)))
    height = interpolator(tri, np.arange(20.0))
    tri.add_points(GENERATOR.random((5, d)))
    for fill in (np.nan, 7):
        height.fill_value = fill
        with pytest.raises(brio.ArgumentError, match="25 points.*20.*added"):
            height(tri.points)


SAMPLES = GENERATOR.normal(size=(300, 3))
SAMPLES /= np.linalg.norm(SAMPLES, axis=1)[:, None]


@pytest.mark.parametrize("call", [brio.reconstruct, brio.oriented_normals])
@pytest.mark.parametrize("method", [None, 5, "magic", ["cocone"]])
def test_methods_that_are_not_known(call, method):
    with pytest.raises(brio.ArgumentError, match="method.*cocone"):
        call(SAMPLES, method)


@pytest.mark.parametrize("name,options", [
    ("seed", {"seed": -1}), ("seed", {"seed": 2**64}), ("seed", {"seed": 1.5}), ("seed", {"seed": None}),
    ("pieces", {"method": "cocone", "pieces": -1}), ("pieces", {"method": "cocone", "pieces": "2"}),
    ("simplify", {"simplify": 2**32}), ("simplify", {"simplify": None}), ("open", {"open": "wide"}),
    ("boundaries", {"method": "cocone", "boundaries": -(2**70)})])
def test_options_out_of_range(name, options):
    with pytest.raises(brio.ArgumentError, match="^%s: .* wanted" % name):
        brio.reconstruct(SAMPLES, **options)


@pytest.mark.parametrize("name,call", [
    ("samples", lambda m: m.distance(m, samples=-1)), ("samples", lambda m: m.distance(m, samples=1e3)),
    ("seed", lambda m: m.distance(m, seed=-1)), ("seed", lambda m: m.distance(m, seed=2**64)),
    ("other", lambda m: m.distance(m.vertices)), ("source", lambda m: m.carry_properties(m.vertices)),
    ("mesh", lambda m: brio.simplify(m.vertices, 5)), ("faces", lambda m: m.simplify(2**70)),
    ("faces", lambda m: m.simplify("5")), ("least_faces", lambda m: m.keep_components(least_faces=-1)),
    ("levels", lambda m: m.subdivide(2**40)), ("levels", lambda m: m.subdivide(None)),
    ("neighbours", lambda m: brio.outliers(m, 2**40)), ("neighbours", lambda m: brio.outliers(m, "5")),
    ("outliers", lambda m: brio.convert("a.ply", "b.ply", outliers=None))])
def test_counts_out_of_range_and_what_is_no_mesh(name, call):
    with pytest.raises(brio.ArgumentError, match="^%s: .* wanted" % name):
        call(brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))


@pytest.mark.parametrize("use", [
    lambda m, path: m.simplify(3), lambda m, path: m.write(path), lambda m, path: m.select([0, 1]),
    lambda m, path: m.subdivide(), lambda m, path: m.keep_components(largest=True),
    lambda m, path: brio.Mesh(m.vertices).carry_properties(m), lambda m, path: brio.reconstruct(m)])
@pytest.mark.parametrize("values", [np.arange(3), np.arange(5.0), 7, [[1], [2, 3]]])
def test_properties_of_a_wrong_length(use, values, tmp_path):
    mesh = brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    mesh.properties["heat"] = values
    with pytest.raises(brio.ArgumentError, match="property heat"):
        use(mesh, tmp_path / "a.ply")


@pytest.mark.parametrize("properties", [5, [1, 2], {5: [1, 2, 3]}, {"a": 3}])
def test_properties_that_are_no_dict_of_arrays(properties):
    with pytest.raises(brio.ArgumentError, match="^property"):
        brio.Mesh(np.eye(3), properties=properties)


def test_attributes_of_a_wrong_length_are_refused_at_once(monkeypatch):
    monkeypatch.setattr(brio._reconstruct, "_run", None)  # no surface is made
    with pytest.raises(brio.ArgumentError, match="attribute heat: one row a point"):
        brio.reconstruct(SAMPLES, attributes={"heat": [1, 2]})


def test_faces_that_are_no_indices_are_refused_before_they_are_read():
    """Row by row, those of a huge array took all memory."""
    huge = np.broadcast_to(0.5, (2**41, 3)), np.broadcast_to(1, (2**41, 3, 1)), np.broadcast_to("a", (2**41, 3))
    for faces in (*huge, np.array([[0.0, 1, 2]]), np.array([0, 1, 2]), [[0, 1, 2.5]]):
        with pytest.raises(brio.ArgumentError, match="faces: rows of indices, or a list of polygons, are wanted, not"):
            brio.Mesh(np.zeros((3, 3)), faces)
    for faces in ([], np.zeros((0, 3)), None, np.empty(0, object)):
        assert len(brio.Mesh(np.zeros((3, 3)), faces).faces) == 0


def test_arguments_of_alpha_shapes():
    points = np.random.default_rng(1).random((9, 3))
    for wrong in (points, None, brio.Mesh(points)):
        with pytest.raises(brio.ArgumentError, match="a brio.Delaunay is wanted"):
            brio.AlphaComplex(wrong)
    for wrong in ("auto", [1, 2], "x"):
        with pytest.raises(brio.ArgumentError, match="alpha"):
            brio.AlphaShape(points, wrong)
        with pytest.raises(brio.ArgumentError, match="distance: a number is wanted"):
            brio.offset(points, wrong)


def test_errors_can_be_pickled():
    import pickle

    error = pickle.loads(pickle.dumps(brio.NotFiniteError("point 3", [3])))
    assert error.sentence == "point 3" and error.indices.tolist() == [3]


def test_progress_is_reported():
    seen = []
    brio.Delaunay(GENERATOR.random((150_000, 3)), threads=1, progress=lambda stage, part: seen.append((stage, part)))
    assert seen and all(isinstance(stage, str) and 0 <= part <= 1 for stage, part in seen)
    assert [part for _, part in seen] == sorted(part for _, part in seen)


def test_progress_can_cancel():
    with pytest.raises(brio.CancelledError) as caught:
        brio.Delaunay(GENERATOR.random((300_000, 3)), progress=lambda stage, part: True)
    assert caught.value.status == 32

    def fails(stage, part):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        brio.Delaunay(GENERATOR.random((300_000, 3)), progress=fails)
    with pytest.raises(TypeError, match="progress"):
        brio.Delaunay(GENERATOR.random((30, 3)), progress=7)


def test_a_bar_without_tqdm(capsys, monkeypatch):
    monkeypatch.setattr(_calls, "_bar", _calls._Line)
    brio.Delaunay(GENERATOR.random((300_000, 3)), threads=1, progress=True)
    assert "%" in capsys.readouterr().err


def test_a_progress_function_may_build_and_drop_others():
    kept = []

    def nested(stage, part):
        kept[:] = [brio.Delaunay(GENERATOR.random((100, 3)))]

    brio.Delaunay(GENERATOR.random((100_000, 3)), progress=nested).verify()
    kept[0].verify()
