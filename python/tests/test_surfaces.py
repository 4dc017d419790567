"""Meshes, files, surfaces, alpha shapes, and other packages' objects."""

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
    with pytest.raises(brio.NotOfferedError):
        brio.alpha_complex(points[:, :2].copy())


def test_alpha_shape_of_a_ball(ball):
    solid = ball * GENERATOR.random((2000, 1)) ** (1 / 3)
    shape = brio.AlphaShape(solid, 0.05)
    assert shape.alpha == 0.05 and 3 < shape.certificate.volume < 4.2


def test_objects_of_trimesh():
    pytest.importorskip("trimesh")
    assert brio.Mesh(CORNERS, TRIANGLES).to_trimesh().is_watertight
    assert len(brio.Mesh(CORNERS).to_trimesh().vertices) == 4


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
