"""Meshes, files, surfaces, alpha shapes, and other packages' objects."""

import copy
import pickle
import sys
import types

import numpy as np
import pytest

import brio

GENERATOR = np.random.default_rng(4)
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.fixture(scope="module")
def ball():
    points = GENERATOR.normal(size=(2000, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def test_mesh_and_certificate():
    mesh = brio.Mesh(CORNERS, TRIANGLES)
    c = mesh.certificate
    assert c.closed and c.manifold and c.oriented and c.components == 1 and c.genus == 0 and c.genera == [0]
    assert np.isclose(c.volume, 1 / 6) and mesh.self_intersections() == 0
    assert np.allclose(mesh.normals[0], -np.ones(3) / np.sqrt(3)) and (mesh.faces == TRIANGLES).all()
    assert brio.Mesh(CORNERS, TRIANGLES[:3]).certificate.boundary_edges == 3
    assert mesh.distance(brio.Mesh(CORNERS + 0.5, TRIANGLES), samples=1000).hausdorff > 0.1


def test_polygons_are_cut_into_fans():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0], [0.5, 2, 0]])
    mesh = brio.Mesh(square, [[0, 1, 2, 3], [3, 2, 4]])
    assert mesh.polygons == [[0, 1, 2, 3], [3, 2, 4]] and mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 4]]


@pytest.mark.parametrize("faces", [[[0, 1, 4]], [[0, 1, -1]], [["a"]], 7, [[0.5, 1, 2]]])
def test_bad_faces(faces):
    with pytest.raises((brio.ArgumentError, TypeError)):
        brio.Mesh(CORNERS, faces)


@pytest.mark.parametrize("name", ["a.ply", "a.obj", "a.off", "a.stl", "a.vtu"])
def test_files_keep_meshes(name, tmp_path):
    mesh = brio.Mesh(CORNERS, TRIANGLES, properties={"heat": np.arange(4, dtype=np.float32), "kind": np.arange(4)})
    brio.write(tmp_path / name, mesh)
    again = brio.read(tmp_path / name)
    assert again.certificate == mesh.certificate
    if name in ("a.ply", "a.vtu"):
        assert again.properties["heat"].tolist() == [0, 1, 2, 3] and again.properties["kind"].dtype == np.int32


def test_files_that_fail(tmp_path):
    with pytest.raises(brio.OpenError) as caught:
        brio.read(tmp_path / "absent.ply")
    assert caught.value.status == 40 and isinstance(caught.value, OSError)
    (tmp_path / "bad.ply").write_text("ply\nnonsense\n")
    with pytest.raises(brio.FormatError, match="bad.ply"):
        brio.read(tmp_path / "bad.ply")
    with pytest.raises(brio.WriteError):
        brio.write(tmp_path / "no" / "where.ply", CORNERS)
    with pytest.raises(ValueError):
        brio.read("with\0nul.ply")


@pytest.mark.parametrize("method", ["labeled-delaunay", "power-crust", "cocone", "tight_cocone"])
def test_reconstruction_of_a_ball(ball, method):
    surface = brio.reconstruct(ball, method, attributes={"x": ball[:, 0], "place": ball})
    c = surface.certificate
    assert c.manifold and c.oriented and c.genus == 0 and c.components == 1 and abs(c.volume - 4 * np.pi / 3) < 0.1
    assert surface.points is ball and np.abs(surface.properties["x"] - surface.vertices[:, 0]).max() < 0.2
    assert surface.properties["place"].shape == surface.vertices.shape
    assert ((surface.normals * surface.vertices).sum(axis=1) > 0.7).mean() > 0.99
    normals = brio.oriented_normals(ball, method)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1) and ((normals * ball).sum(axis=1) > 0.8).mean() > 0.99


def test_options_reach_the_library(ball):
    assert len(brio.reconstruct(ball, simplify=True).faces) < len(brio.reconstruct(ball).faces) / 2
    assert "confidence" in brio.reconstruct(ball, confidence=True).properties
    assert brio.reconstruct(ball, noise="keep").samples is not None
    with pytest.raises(TypeError, match="no option"):
        brio.reconstruct(ball, colour=1)
    with pytest.raises(brio.ArgumentError, match="noise"):
        brio.reconstruct(ball, noise="loud")
    with pytest.raises(brio.ArgumentError, match="method"):
        brio.reconstruct(ball, "magic")
    with pytest.raises(brio.NoAnswerError):
        brio.reconstruct(CORNERS[:2])


def test_attributes_of_a_file_are_carried(ball, tmp_path):
    brio.write(tmp_path / "ball.ply", brio.Mesh(ball, properties={"index": np.arange(2000)}))
    surface = brio.reconstruct(brio.read(tmp_path / "ball.ply"))
    assert (surface.properties["index"] == surface.samples).all()


def test_offset_and_medial_axis(ball):
    far = np.linalg.norm(brio.offset(ball, 0.5).vertices, axis=1)
    assert abs(far - 1.5).max() < 0.05
    axis = brio.medial_axis(ball)
    assert np.linalg.norm(axis.vertices, axis=1).max() < 0.2 and abs(axis.properties["radius"] - 1).max() < 0.2
    assert (axis.properties["side"] == -1).all()


def prism():
    """A closed 32-gon prism of radius 1 and height 2."""
    n = 32
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([np.insert(ring, 2, z, axis=1) for z in (-1, 1)] + [[[0, 0, -1], [0, 0, 1]]])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    low, high = np.full(n, 2 * n), np.full(n, 2 * n + 1)
    return brio.Mesh(points, np.concatenate([np.stack(t, axis=1) for t in (
        (i, j, n + j), (i, n + j, n + i), (low, j, i), (high, n + i, n + j))]))


def test_offset_of_a_mesh_goes_by_its_faces():
    outer, inner = brio.offset(prism(), 0.1), brio.offset(prism(), -0.1)
    for surface, volume in [(outer, 8.287357), (inner, 4.546175)]:
        assert surface.certificate.closed and abs(surface.certificate.volume / volume - 1) < 5e-4
    coarser = brio.offset(prism(), 0.1, error=0.005)
    assert len(coarser.vertices) < len(outer.vertices)
    with pytest.raises(brio.errors.ArgumentError):
        brio.offset(prism(), 0.1, sharp=True)
    with pytest.raises(brio.errors.ArgumentError):
        brio.offset(prism().vertices, 0.1, error=0.001)


def test_medial_axis_of_a_mesh_samples_its_faces():
    axis = brio.medial_axis(prism(), spacing=0.1)
    radius = np.linalg.norm(axis.vertices[:, :2], axis=1)
    assert len(axis.vertices) > 1000 and radius.max() < 1 and np.abs(axis.vertices[:, 2]).max() < 1
    assert 0.9 < axis.properties["radius"].max() < 1.01
    with pytest.raises(brio.errors.ArgumentError):
        brio.medial_axis(prism().vertices, spacing=0.1)


def test_simplification(ball):
    surface = brio.reconstruct(ball)
    fewer = brio.simplify(surface, len(surface.faces) // 4)
    assert len(fewer.faces) <= len(surface.faces) // 4 + 1
    assert (fewer.certificate.closed, fewer.certificate.genus) == (True, 0)
    assert np.abs(np.linalg.norm(fewer.vertices, axis=1) - 1).max() < 0.2
    assert len(surface.simplify(tolerance=1e-12).faces) == len(surface.faces)
    for arguments in [{}, {"faces": -1}, {"tolerance": -1.0}, {"tolerance": np.inf}]:
        with pytest.raises(brio.ArgumentError):
            surface.simplify(**arguments)


def test_alpha_complex_against_the_definition():
    points = GENERATOR.random((30, 3))
    complex = brio.alpha_complex(points)
    edges, values = complex.simplices[1], complex.values[1]
    half = ((points[edges[:, 0]] - points[edges[:, 1]]) ** 2).sum(axis=1) / 4
    gabriel = complex.gabriel[1]
    assert np.allclose(values[gabriel], half[gabriel]) and (values[~gabriel] >= half[~gabriel] - 1e-12).all()
    entered = [value for _, value in complex.filtration()]
    assert entered == sorted(entered) and len(entered) == sum(map(len, complex.values))
    shape = complex.shape(complex.auto_alpha())
    assert shape.certificate.closed and shape.certificate.manifold and shape.counts["uncovered"] == 0


@pytest.mark.parametrize("weighted", [False, True])
def test_alpha_complex_of_the_plane(weighted):
    points = GENERATOR.random((200, 2))
    weights = 0.001 * GENERATOR.random(200) if weighted else None
    complex = brio.alpha_complex(points, weights)
    assert complex.ndim == 2 and [part.shape[1] for part in complex.simplices] == [1, 2, 3]
    corner = points[complex.simplices[2]]
    edges = corner[:, 1:] - corner[:, :1]
    w = np.zeros((200,)) if weights is None else weights
    w = w[complex.simplices[2]]
    right = ((edges**2).sum(axis=2) - w[:, 1:] + w[:, :1]) / 2
    centre = np.linalg.solve(edges, right[..., None])[..., 0]
    assert np.allclose(complex.values[2], (centre**2).sum(axis=1) - w[:, 0])
    entered = [value for _, value in complex.filtration()]
    assert entered == sorted(entered) and len(entered) == sum(map(len, complex.values))
    alpha = complex.auto_alpha()
    shape = complex.shape(alpha)
    c = shape.certificate
    assert shape.counts["uncovered"] == 0 and c.components == 1 and c.oriented
    assert len(shape.faces) == (complex.values[2] <= alpha).sum() and len(shape.edges) == c.boundary_edges
    area = np.cross(*shape.vertices[shape.edges].swapaxes(0, 1))[:, 2].sum() / 2  # the triangles are left of the border
    assert np.isclose(area, c.area)


def test_alpha_shapes_of_the_plane():
    ring = GENERATOR.random((4000, 2)) * 2 - 1
    ring = ring[np.abs(np.hypot(*ring.T) - 0.7) < 0.3]
    shape = brio.AlphaShape(ring, 0.01)
    assert shape.certificate.boundary_loops == 2 and abs(shape.certificate.area - np.pi * (1 - 0.16)) < 0.15
    with pytest.raises(brio.NoAnswerError):
        brio.AlphaShape(ring, 0)
    with pytest.raises(brio.ArgumentError):
        brio.AlphaShape(ring, np.nan)
    with pytest.raises(brio.NoAnswerError):
        brio.alpha_complex([[0, 0], [1, 1], [2, 2]])


def test_alpha_complex_of_the_plane_against_gudhi():
    gudhi = pytest.importorskip("gudhi")
    points = GENERATOR.random((300, 2))
    mine = {simplex: value for simplex, value in brio.alpha_complex(points).filtration()}
    tree = gudhi.AlphaComplex(points=points, precision="exact").create_simplex_tree()
    theirs = {tuple(sorted(simplex)): value for simplex, value in tree.get_filtration()}
    assert set(mine) == set(theirs)
    assert np.allclose([mine[s] for s in theirs], list(theirs.values()), rtol=1e-12, atol=0)


@pytest.mark.parametrize("d", [2, 3])
def test_alpha_complexes_do_not_follow_points_that_are_added(d):
    points = GENERATOR.random((60, d))
    tri = brio.Delaunay(points)
    complex, wanted = brio.AlphaComplex(tri), brio.alpha_complex(points)
    alpha = wanted.auto_alpha()
    tri.add_points(GENERATOR.random((40, d)))
    for other in (complex, copy.copy(complex), copy.deepcopy(complex), pickle.loads(pickle.dumps(complex))):
        assert other.auto_alpha() == alpha and (other.simplices[d] == wanted.simplices[d]).all()
        shape = other.shape(alpha)
        assert (shape.faces == wanted.shape(alpha).faces).all() and (shape.edges == wanted.shape(alpha).edges).all()
    assert tri.npoints == 100 and len(brio.AlphaComplex(tri).points) == 100


def test_alpha_shape_of_a_ball(ball):
    solid = ball * GENERATOR.random((2000, 1)) ** (1 / 3)
    shape = brio.AlphaShape(solid, 0.05)
    assert shape.alpha == 0.05 and 3 < shape.certificate.volume < 4.2


# --- properties, choosing, files ---


def test_thin_and_outliers():
    points = GENERATOR.random((3000, 3))
    chosen = brio.thin(points, 0.1)
    distance = np.linalg.norm(points[chosen][:, None] - points, axis=2)
    assert (np.sort(distance, axis=1)[:, 0] == 0).all() and distance.min(axis=0).max() < 0.1
    near = np.linalg.norm(points[chosen][:, None] - points[chosen], axis=2)
    assert near[near > 0].min() >= 0.1
    stray = np.concatenate([points, [[3, 3, 3], [-2, 0, 0]]])
    assert np.flatnonzero(brio.outliers(stray)).tolist() == [3000, 3001]
    assert (brio.outliers(brio.Mesh(stray)) == brio.outliers(stray)).all()
    assert len(brio.Mesh(points).select(chosen).vertices) == chosen.sum()
    assert brio.outliers(stray, factor=1e6).sum() == 0
    for call in (lambda: brio.thin(points, 0), lambda: brio.thin(points, np.nan), lambda: brio.outliers(points, 0),
                 lambda: brio.outliers(points, 64), lambda: brio.outliers(points, factor=0.5)):
        with pytest.raises(brio.ArgumentError):
            call()
    points[5] = np.nan
    for call in (lambda: brio.thin(points, 0.1), lambda: brio.outliers(points)):
        with pytest.raises(brio.NotFiniteError) as caught:
            call()
        assert caught.value.indices.tolist() == [5]


def test_selected_vertices_keep_what_they_join():
    mesh = brio.Mesh(np.concatenate([CORNERS, [[5, 5, 5]]]), [[0, 2, 1], [0, 1, 3, 2]], tetrahedra=[[0, 1, 2, 3]],
                     edges=[[0, 4], [2, 1]], properties={"n": np.arange(5), "rgb": np.arange(15).reshape(5, 3)})
    some = mesh.select([2, 1, 0])
    assert (some.vertices == CORNERS[[2, 1, 0]]).all() and some.polygons == [[2, 0, 1]] and some.edges.tolist() == [[0, 1]]
    assert len(some.tetrahedra) == 0 and some.properties["n"].tolist() == [2, 1, 0]
    assert some.properties["rgb"].tolist() == [[6, 7, 8], [3, 4, 5], [0, 1, 2]]
    assert len(mesh.select(np.zeros(5, bool)).vertices) == 0 and mesh.select(np.ones(5, bool)).polygons == mesh.polygons
    for which in [[5], [-1], [0, 0], [True], [0.5], [[1]], "ab"]:
        with pytest.raises(brio.ArgumentError):
            mesh.select(which)


def test_carried_properties_keep_types_and_names():
    scan = brio.Mesh([[0, 0, 0], [9, 0, 0], [1, 0, 0]],
                     properties={"label": np.array([7, 8, 9], np.int64), "x": np.eye(3), "name": np.array(["a", "b", "c"])})
    mesh = brio.Mesh([[8, 0, 0], [0, 0, 0], [0.5, 0, 0]], properties={"label": [1.0, 2.0, 3.0]})
    mesh.carry_properties(scan)
    mesh.carry_properties(scan, samples=[2, 1, 0])
    assert mesh.properties["label"].tolist() == [1, 2, 3]
    assert mesh.properties["input_label"].tolist() == [8, 7, 7] and mesh.properties["input_label"].dtype == np.int64
    assert mesh.properties["input_label_2"].tolist() == [9, 8, 7]
    assert mesh.properties["name"].tolist() == ["b", "a", "a"] and mesh.properties["x"].tolist() == np.eye(3)[[1, 0, 0]].tolist()
    for samples in [[0, 1], [0, 1, 3], [0, 1, -1], [0.0, 1.0, 2.0]]:
        with pytest.raises(brio.ArgumentError):
            mesh.carry_properties(scan, samples)
    with pytest.raises(brio.ArgumentError):
        mesh.carry_properties(brio.Mesh(np.empty((0, 3))))


@pytest.mark.parametrize("name", ["a.ply", "a.vtu", "a.pcd"])
@pytest.mark.parametrize("values", [
    np.array([2**53 + 1, 0, 1, 2], np.int64), np.array([2**64 - 1, 0, 1, 2], np.uint64), np.array([2**63 - 1, 0, 1, 2]),
    np.array([[0, 2**60 + 1]] * 4),
    pytest.param(np.array([1, 2, 3, np.longdouble(1) / 3], np.longdouble), marks=pytest.mark.skipif(
        np.finfo(np.longdouble).nmant == 52, reason="longdouble is a double here"))])
def test_properties_that_files_would_round(values, name, tmp_path):
    with pytest.raises(brio.ArgumentError, match="property big: files would round"):
        brio.Mesh(CORNERS, properties={"big": values}).write(tmp_path / name)
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize("values", [
    np.array([2**53, -(2**53), 2**60, 3], np.int64), np.array([2**63, 2**40, 0, 2**64 - 2**11], np.uint64),
    np.array([2**32 - 1, 0, 1, 2], np.uint32), np.array([2**31 - 1, -(2**31), 1, 2]),
    np.array([0.1, np.nan, np.inf, 1e-320]).astype(np.longdouble), np.array([2**62, 1, 2, 3], ">i8")])
def test_large_properties_are_written_exactly(values, tmp_path):
    for options in {}, {"ascii": True}, {"float32": True}:
        brio.Mesh(CORNERS, properties={"big": values}).write(tmp_path / "a.ply", **options)
        again = brio.read(tmp_path / "a.ply").properties["big"].tolist()
        assert all(a == b or a != a and b != b for a, b in zip(again, values.tolist(), strict=True))


def test_properties_that_would_have_one_name_in_a_file(tmp_path):
    with pytest.raises(brio.ArgumentError, match="a_0"):
        brio.Mesh(CORNERS, properties={"a": np.ones((4, 2)), "a_0": np.zeros(4)}).write(tmp_path / "a.ply")


def test_texts_of_complexes_and_interpolators():
    assert repr(brio.alpha_complex(CORNERS)) == "<brio.AlphaComplex of 4 points: 15 simplices>"
    text = "<brio.LinearNDInterpolator of 4 points: values of shape (2,)>"
    assert repr(brio.LinearNDInterpolator(CORNERS, np.ones((4, 2)))) == text


def test_attributes_with_a_name_of_the_surface(ball):
    surface = brio.reconstruct(ball, confidence=True, attributes={"confidence": np.arange(2000)})
    assert (surface.properties["input_confidence"] == surface.samples).all()
    assert surface.properties["confidence"].dtype == np.float32


def test_simplified_meshes_keep_properties(ball):
    surface = brio.reconstruct(ball, attributes={"number": np.arange(2000), "place": ball})
    fewer = surface.simplify(500)
    assert np.abs(fewer.properties["place"] - fewer.vertices).max() < 0.3
    assert (fewer.properties["place"] == ball[fewer.properties["number"]]).all()


def test_merged_vertices():
    corners = CORNERS[TRIANGLES.ravel()]
    apart = brio.Mesh(corners, np.arange(len(corners)).reshape(-1, 3), properties={"n": np.arange(len(corners))})
    assert not apart.certificate.closed
    whole = apart.merge_vertices()
    assert whole.certificate.closed and len(whole.vertices) == len(CORNERS)
    first = [np.flatnonzero((corners == v).all(axis=1))[0] for v in whole.vertices]
    assert (np.asarray(whole.properties["n"]) == first).all()
    moved = brio.Mesh(corners + 1e-4 * np.random.default_rng(1).random(corners.shape), apart.faces)
    assert len(moved.merge_vertices().vertices) == len(corners) and moved.merge_vertices(0.001).certificate.closed
    for wrong in (-1, np.nan, np.inf, "0", None):
        with pytest.raises(brio.ArgumentError):
            apart.merge_vertices(wrong)


def test_conversion_merges(tmp_path):
    corners = CORNERS[TRIANGLES.ravel()]
    brio.Mesh(corners, np.arange(len(corners)).reshape(-1, 3)).write(tmp_path / "a.ply")
    done = brio.convert(tmp_path / "a.ply", tmp_path / "b.ply", merge=True)
    assert (done.points, done.merged, done.degenerate) == (len(CORNERS), len(corners) - len(CORNERS), 0)
    assert brio.read(tmp_path / "b.ply").certificate.closed
    assert brio.convert(tmp_path / "a.ply", tmp_path / "c.ply", merge=100.0).degenerate == len(TRIANGLES)
    assert brio.convert(tmp_path / "a.ply", tmp_path / "d.ply").points == len(corners)
    with pytest.raises(brio.ArgumentError):
        brio.convert(tmp_path / "a.ply", tmp_path / "e.ply", merge=-1.0)


def test_components_and_subdivision():
    two = brio.Mesh(np.concatenate([CORNERS, CORNERS * 3 + 9]), np.concatenate([TRIANGLES, TRIANGLES[:3] + 4]),
                    properties={"n": np.arange(8)})
    assert two.keep_components(largest=True).properties["n"].tolist() == [4, 5, 6, 7]
    assert two.keep_components(least_faces=4).properties["n"].tolist() == [0, 1, 2, 3]
    with pytest.raises(brio.NoAnswerError):
        two.keep_components(least_faces=9)
    with pytest.raises(brio.ArgumentError):
        two.keep_components(least_faces=-1)
    finer = two.subdivide()
    assert len(finer.faces) == 28 and finer.certificate.components == 2 and (finer.vertices[:8] == two.vertices).all()


def test_subdivided_meshes_keep_properties():
    properties = {"rgb": np.arange(12, dtype=np.uint8).reshape(4, 3), "label": np.arange(4) + 2**40, "place": CORNERS,
                  "half": np.arange(4, dtype=np.float16), "big": np.arange(4, dtype=">f4"), "name": np.array(list("abcd")),
                  "flag": np.array([True, False, True, False]), "number": np.arange(4.0), "0_0": np.ones((4, 2, 2)),
                  "nothing": np.empty((4, 0)), "complex": np.arange(4) * 1j}
    mesh = brio.Mesh(CORNERS, TRIANGLES, properties=properties)
    for levels in 1, 2:
        finer = mesh.subdivide(levels)
        assert list(finer.properties) == list(properties)
        for name, values in properties.items():
            assert finer.properties[name].dtype == values.dtype and (finer.properties[name][:4] == values).all()
            assert finer.properties[name].shape == (len(finer.vertices), *values.shape[1:])
        number = finer.properties["label"] - 2**40
        assert (finer.properties["rgb"] == properties["rgb"][number]).all()
        assert (finer.properties["name"] == properties["name"][number]).all()
        assert (finer.properties["0_0"] == 1).all() and (finer.properties["half"] == finer.properties["number"]).all()
    once = mesh.subdivide()
    middles = {tuple(2 * place) for place in once.properties["place"][4:]}
    assert middles == {tuple(CORNERS[i] + CORNERS[j]) for i in range(4) for j in range(i)}
    assert brio.Mesh(CORNERS, TRIANGLES).subdivide().properties == {}


def test_columns_of_texts(tmp_path):
    path = tmp_path / "rows.txt"
    path.write_text("1 10 0.5 7 7\n2 20 1.5 8 8\n")
    for columns in ("-,heat,x,y,z", ["-", "heat", "x", "y", "z"], (None, "heat", "x", "y", "z")):
        mesh = brio.read(path, columns=columns)
        assert mesh.vertices.tolist() == [[0.5, 7, 7], [1.5, 8, 8]] and mesh.properties["heat"].tolist() == [10, 20]
    assert brio.read(path).vertices.tolist() == [[1, 10, 0.5], [2, 20, 1.5]]
    with pytest.raises(brio.ArgumentError):
        brio.read(path, columns="x,y")
    brio.write(tmp_path / "a.ply", CORNERS)
    with pytest.raises(brio.ArgumentError):
        brio.read(tmp_path / "a.ply", columns="x,y,z")


def test_formats_by_name(tmp_path):
    path = tmp_path / "stations.of-1987"
    path.write_text("1 2 3 4\n5 6 7 8\n")
    with pytest.raises(brio.FormatError):
        brio.read(path)
    for name in ("xyz", ".XYZ", "txt"):
        assert brio.read(path, format=name).vertices.tolist() == [[1, 2, 3], [5, 6, 7]]
    assert brio.read(path, format="csv", columns=["-", "x", "y", "z"]).vertices.tolist() == [[2, 3, 4], [6, 7, 8]]
    for wrong in ("", "tiff", 5, b"xyz"):
        with pytest.raises(brio.ArgumentError, match="format"):
            brio.read(path, format=wrong)
    with pytest.raises(brio.FormatError):
        brio.read(path, format="ply")
    for wrong in (5, [5], ["x,y", "z"], b"x,y,z"):
        with pytest.raises(brio.ArgumentError, match="columns"):
            brio.read(path, format="xyz", columns=wrong)


def test_conversion(tmp_path):
    points = np.concatenate([GENERATOR.random((2000, 3)), [[9, 9, 9]]])
    brio.Mesh(points, [[0, 1, 2]], properties={"heat": np.arange(2001, dtype=np.float32)}).write(tmp_path / "a.ply")
    done = brio.convert(tmp_path / "a.ply", tmp_path / "b.xyz", outliers=12, thin=0.1, box=[[0, 0, 0], [9, 9, 9]])
    again = brio.read(tmp_path / "b.xyz", columns="x,y,z,heat")
    assert (done.points_read, done.outliers) == (2001, 1) and done.points == len(again.vertices) < 1000
    assert done.points + done.thinned + done.outliers == 2001 and (done.faces == 0 or "faces" in done.lost)
    assert (again.vertices == points[again.properties["heat"].astype(int)]).all()
    lost = brio.convert(tmp_path / "a.ply", tmp_path / "c.stl").lost
    assert "heat" in lost
    for options in [{"box": [1, 2, 3]}, {"outliers": -1}, {"outliers": 64}, {"thin": -1.0}, {"columns": "x,y,z"}]:
        with pytest.raises(brio.ArgumentError):
            brio.convert(tmp_path / "a.ply", tmp_path / "d.xyz", **options)
    with pytest.raises(brio.OpenError):
        brio.convert(tmp_path / "absent.ply", tmp_path / "d.xyz")
    assert not (tmp_path / "d.xyz").exists()


def test_a_cancelled_conversion_leaves_no_file(tmp_path):
    brio.write(tmp_path / "a.ply", GENERATOR.random((300_000, 3)))
    with pytest.raises(brio.CancelledError):
        brio.convert(tmp_path / "a.ply", tmp_path / "b.xyz", thin=0.001, progress=lambda *_: True)
    assert [path.name for path in tmp_path.iterdir()] == ["a.ply"]
    with pytest.raises(brio.CancelledError):
        brio.Delaunay(GENERATOR.random((200_000, 3)), progress=lambda *_: True)


def test_las_files_keep_the_steps_of_their_coordinates(tmp_path):
    points = GENERATOR.integers(0, 10**6, (100, 3)) * 0.001 + 4e5
    brio.write(tmp_path / "a.las", points)
    first = brio.read(tmp_path / "a.las")
    first.write(tmp_path / "b.las")
    assert (brio.read(tmp_path / "b.las").vertices == first.vertices).all()
    first.select(np.arange(50)).write(tmp_path / "c.las")
    assert (brio.read(tmp_path / "c.las").vertices == first.vertices[:50]).all()
    head = (tmp_path / "a.las").read_bytes()[131:155]
    assert (tmp_path / "b.las").read_bytes()[131:155] == head == (tmp_path / "c.las").read_bytes()[131:155]


def test_copies_and_pickles_keep_the_steps_of_coordinates(tmp_path):
    brio.write(tmp_path / "a.las", GENERATOR.integers(0, 10**6, (100, 3)) * 0.001 + 4e5)
    file = bytearray((tmp_path / "a.las").read_bytes())
    file[131:155] = np.full(3, 1 / 3, "<f8").tobytes()  # no step that a writer would try
    (tmp_path / "a.las").write_bytes(file)
    mesh = brio.read(tmp_path / "a.las")
    for clone in (copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))):
        clone(mesh).write(tmp_path / "b.las")
        assert (brio.read(tmp_path / "b.las").vertices == mesh.vertices).all()
        assert (tmp_path / "b.las").read_bytes()[131:179] == file[131:179]


def test_what_the_build_reads(tmp_path):
    import gzip

    info = brio.build_info()
    assert info["version"] == brio.__version__ and set(info) == {"version", "zlib", "zstd", "expat", "cjson", "free_threaded"}
    path = tmp_path / "a.xyz.gz"
    path.write_bytes(gzip.compress(b"1 2 3\n"))
    if info["zlib"]:
        assert brio.read(path).vertices.tolist() == [[1, 2, 3]]
    else:
        with pytest.raises(brio.Error, match="zlib"):
            brio.read(path)


def test_copies_and_pickles(ball):
    mesh = brio.Mesh(CORNERS, [[0, 1, 2, 3]], tetrahedra=[[0, 1, 2, 3]], edges=[[0, 1]], properties={"n": np.arange(4)})
    surface = brio.reconstruct(ball, attributes={"place": ball})
    points = GENERATOR.random((50, 3))
    for clone in (copy.deepcopy, copy.copy, lambda thing: pickle.loads(pickle.dumps(thing))):
        again = clone(mesh)
        assert again.polygons == mesh.polygons and again.properties["n"].tolist() == [0, 1, 2, 3]
        assert again.tetrahedra.tolist() == [[0, 1, 2, 3]] and again.edges.tolist() == [[0, 1]]
        assert clone(brio.Mesh(CORNERS)).polygons == [] and not again.vertices.flags.writeable
        other = clone(surface)
        assert type(other) is brio._reconstruct.Surface and (other.samples == surface.samples).all()
        assert other.certificate == surface.certificate and other.simplify(500).properties["place"].shape[1] == 3
        assert clone(brio.ConvexHull(points)).volume == brio.ConvexHull(points).volume
        assert (clone(brio.Voronoi(points)).volumes == brio.Voronoi(points).volumes).all()
        shape = clone(brio.AlphaShape(points))
        assert shape.complex.auto_alpha() == shape.alpha and len(shape.complex.shape(shape.alpha).faces) == len(shape.faces)
        for interpolator in (brio.LinearNDInterpolator, brio.NaturalNeighbourInterpolator):
            assert np.isclose(clone(interpolator(points, points[:, 0]))(points.mean(axis=0)), points[:, 0].mean())


def test_arrays_of_copies_are_read_only_as_those_of_the_original(ball):
    surface = brio.reconstruct(ball)
    assert len(surface.faces) and len(surface.normals)
    for clone in (copy.deepcopy, copy.copy, lambda thing: pickle.loads(pickle.dumps(thing))):
        again = clone(surface)
        for name in ("vertices", "faces", "normals", "samples", "face_vertices"):
            assert (getattr(again, name) == getattr(surface, name)).all()
            assert not getattr(again, name).flags.writeable and not getattr(surface, name).flags.writeable, name


# --- objects of other packages ---


def test_objects_of_trimesh():
    pytest.importorskip("trimesh")
    assert brio.Mesh(CORNERS, TRIANGLES).to_trimesh().is_watertight
    assert len(brio.Mesh(CORNERS).to_trimesh().vertices) == 4


COLORS = np.array([[51, 102, 153], [255, 0, 0], [0, 255, 0], [64, 128, 191]])
NORMALS = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0.6, 0.8]], np.float32)


def coloured(kind=np.uint8, scale=1, names=("red", "green", "blue"), faces=TRIANGLES):
    channels = (COLORS * scale).astype(kind)
    return brio.Mesh(CORNERS, faces, properties={**dict(zip(names, channels.T)), **dict(zip(("nx", "ny", "nz"), NORMALS.T))})


@pytest.mark.parametrize("mesh", [
    coloured(), coloured(np.uint16, 257), coloured(np.uint16), coloured(np.int32), coloured(np.float32, 1 / 255),
    coloured(names=("Red", "GREEN", "blue")), coloured(names=("r", "g", "b")),
    coloured(names=("diffuse_red", "diffuse_green", "diffuse_blue")),
    brio.Mesh(CORNERS, TRIANGLES, properties={"colour": COLORS.astype(np.uint8), "normals": NORMALS}),
    brio.Mesh(CORNERS, TRIANGLES, properties={"rgba": np.insert(COLORS, 3, 255, 1).astype(np.uint8), "normals": NORMALS})])
def test_colours_and_normals_for_other_packages(mesh, stub_of_open3d):
    """They were lost."""
    trimesh = pytest.importorskip("trimesh")
    cloud = brio.Mesh(mesh.vertices, properties=mesh.properties)
    solid = mesh.to_trimesh()
    assert solid.visual.kind == "vertex" and (solid.visual.vertex_colors[:, :3] == COLORS).all()
    assert np.allclose(solid.vertex_normals, NORMALS) and set(mesh.properties) <= set(solid.vertex_attributes)
    points = cloud.to_trimesh()
    assert isinstance(points, trimesh.PointCloud) and (np.asarray(points.colors)[:, :3] == COLORS).all()
    assert set(points.metadata) >= set(mesh.properties)
    for made, colors in ((mesh.to_open3d(), "vertex_colors"), (cloud.to_open3d(), "colors")):
        assert np.allclose(getattr(made, colors), COLORS / 255)
        assert np.allclose(made.vertex_normals if made.is_mesh else made.normals, NORMALS)


def test_meshes_without_colours_for_other_packages(stub_of_open3d):
    trimesh = pytest.importorskip("trimesh")
    plain = brio.Mesh(CORNERS, TRIANGLES, properties={"red": [1, 2, 3, 4]})
    assert plain.vertex_colors() is None and plain.to_trimesh().visual.kind != "vertex"
    assert np.allclose(plain.to_open3d().vertex_normals, plain.normals) and plain.to_open3d().vertex_colors is None
    cloud = brio.Mesh(CORNERS).to_open3d()
    assert cloud.colors is None and cloud.normals is None and isinstance(brio.Mesh(CORNERS).to_trimesh(), trimesh.PointCloud)


def test_opacity_of_colours():
    properties = dict(zip(("red", "green", "blue", "alpha"), np.array([[0, 51, 255, 102]] * 4, np.uint8).T))
    assert np.allclose(brio.Mesh(CORNERS, properties=properties).vertex_colors(), [0, 0.2, 1, 0.4])


@pytest.fixture
def stub_of_open3d(monkeypatch):
    """The part of Open3D that Mesh.to_open3d uses, where it is not installed: types and shapes as Open3D asks for them."""
    try:
        import open3d  # noqa: F401
    except ImportError:
        pass
    else:
        pytest.skip("open3d is here: test_colours_of_open3d uses it")

    def vectors(kind):
        def take(array):
            assert array.dtype == kind and array.ndim == 2 and array.shape[1] == 3 and array.flags.c_contiguous
            return array
        return take

    def shape(is_mesh, names):
        class Shape:
            def __init__(self, *parts):
                self.parts, self.is_mesh = parts, is_mesh
                for name in names:
                    setattr(self, name, None)
        return Shape

    stub = types.ModuleType("open3d")
    stub.utility = types.SimpleNamespace(Vector3dVector=vectors(np.float64), Vector3iVector=vectors(np.int32))
    stub.geometry = types.SimpleNamespace(PointCloud=shape(False, ["colors", "normals"]),
                                          TriangleMesh=shape(True, ["vertex_colors", "vertex_normals"]))
    monkeypatch.setitem(sys.modules, "open3d", stub)


def test_colours_of_open3d():
    pytest.importorskip("open3d")
    mesh, cloud = coloured().to_open3d(), coloured(faces=None).to_open3d()
    assert np.allclose(np.asarray(mesh.vertex_colors), COLORS / 255) and np.allclose(np.asarray(cloud.colors), COLORS / 255)
    assert np.allclose(np.asarray(mesh.vertex_normals), NORMALS) and np.allclose(np.asarray(cloud.normals), NORMALS)


def test_objects_of_meshio():
    pytest.importorskip("meshio")
    mesh = brio.Mesh(CORNERS, TRIANGLES, tetrahedra=[[0, 1, 2, 3]], properties={"h": np.arange(4)}).to_meshio()
    assert {block.type for block in mesh.cells} == {"triangle", "tetra"} and "h" in mesh.point_data


def test_objects_of_pyvista():
    pytest.importorskip("pyvista")
    assert brio.Mesh(CORNERS, TRIANGLES).to_pyvista().n_cells == 4
    assert brio.Mesh(CORNERS, tetrahedra=[[0, 1, 2, 3]]).to_pyvista().n_cells == 1


def test_objects_of_open3d():
    pytest.importorskip("open3d")
    assert brio.Mesh(CORNERS, TRIANGLES).to_open3d().is_watertight()


def test_medial_axis_by_voronoi_facets_and_the_scale_axis(ball):
    axis = brio.medial_axis(ball, method="voronoi", rho=6)
    assert set(axis.properties) >= {"radius", "side"} and len(axis.faces) > 100
    assert len(brio.medial_axis(ball, scale_axis=1.2).vertices) < len(brio.medial_axis(ball).vertices)
    for options in ({"method": "voronoi", "scale": 2}, {"theta": 1}, {"method": "thinning"}):
        with pytest.raises(brio.errors.ArgumentError):
            brio.medial_axis(ball, **options)


def test_union_of_balls_is_measured():
    two = brio.ball_union([[0, 0, 0], [1, 0, 0]], [1, 1], error=0.01)
    assert abs(two.volume - 27 / 12 * np.pi) < 1e-12 and abs(two.areas.sum() - two.area) < 1e-12
    assert (two.components, two.tunnels, two.voids, two.exposed) == (1, 0, 0, 2)
    assert two.certificate.closed and two.certificate.manifold
    for centres, radii in (([[0, 0, 0]], [1, 2]), ([[0, 0, 0]], [-1])):
        with pytest.raises(brio.errors.ArgumentError):
            brio.ball_union(centres, radii)
