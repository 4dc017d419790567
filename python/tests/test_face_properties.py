"""Properties of faces: through files, and through what changes a mesh."""

import copy
import pickle
import types

import numpy as np
import pytest

import brio

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
COLOUR = np.arange(12, dtype=np.uint8).reshape(4, 3)


def tetrahedron():
    return brio.Mesh(CORNERS, TRIANGLES, face_properties={"heat": np.arange(4.0), "rgb": COLOUR})


@pytest.mark.parametrize("name", ["a.ply", "a.vtu", "a.vtp", "a.vtk"])
def test_files_keep_them(name, tmp_path):
    tetrahedron().write(tmp_path / name)
    again = brio.read(tmp_path / name).face_properties
    assert again["heat"].tolist() == [0, 1, 2, 3] and again["green"].tolist() == COLOUR[:, 1].tolist()
    assert brio.convert(tmp_path / name, tmp_path / "b.stl").lost == [
        f"{name} of faces" for name in ("heat", "red", "green", "blue")]


def test_faces_that_stay_keep_them():
    two = brio.Mesh(np.concatenate([CORNERS, CORNERS + 5, CORNERS[:1]]), np.concatenate([TRIANGLES, TRIANGLES + 4, [[0, 8, 1]]]),
                    face_properties={"n": np.arange(9), "word": np.array([f"w{i}" for i in range(9)])})
    merged = two.merge_vertices()
    assert merged.face_properties["n"].tolist() == list(range(8)) and merged.face_properties["word"][7] == "w7"
    chosen = merged.select(np.arange(8) >= 4)
    assert chosen.face_properties["n"].tolist() == [4, 5, 6, 7]
    assert merged.keep_components(largest=True).face_properties["n"].tolist() == [0, 1, 2, 3]
    fine = merged.subdivide()
    assert fine.face_properties["n"].tolist() == np.repeat(np.arange(8), 4).tolist()
    assert fine.face_properties["word"].tolist() == [f"w{i // 4}" for i in range(32)]


def test_simplified_triangles_keep_them():
    points = np.random.default_rng(2).normal(size=(800, 3))
    surface = brio.reconstruct(points / np.linalg.norm(points, axis=1)[:, None])
    surface.face_properties = {"n": np.arange(len(surface.faces))}
    numbers = surface.simplify(300).face_properties["n"]
    assert len(numbers) == 300 and (np.diff(numbers) > 0).all()


def test_copies_and_pickles():
    for clone in (copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))):
        again = clone(tetrahedron())
        assert (again.face_properties["rgb"] == COLOUR).all()
        assert again.subdivide().face_properties["heat"].shape == (16,)


def test_wrong_ones_are_refused(tmp_path):
    with pytest.raises(brio.ArgumentError, match="face property heat: one row a face is wanted, 4"):
        brio.Mesh(CORNERS, TRIANGLES, face_properties={"heat": np.arange(3)})
    with pytest.raises(brio.ArgumentError):
        brio.Mesh(CORNERS, face_properties={"heat": np.arange(3)})
    mesh = tetrahedron()
    mesh.face_properties["late"] = np.arange(9)
    with pytest.raises(brio.ArgumentError, match="late"):
        mesh.write(tmp_path / "a.ply")


def test_other_packages(monkeypatch):
    made = {}
    monkeypatch.setitem(__import__("sys").modules, "meshio", types.SimpleNamespace(
        Mesh=lambda points, cells, **data: made.update(cells=cells, **data)))
    brio.Mesh(CORNERS, [[0, 1, 2, 3], [0, 1, 2]], edges=[[0, 1]], face_properties={"n": [7, 8]}).to_meshio()
    assert [kind for kind, _ in made["cells"]] == ["triangle", "quad", "line"]
    assert [part.tolist() for part in made["cell_data"]["n"]] == [[8], [7], [0]]
    pyvista = pytest.importorskip("pyvista")
    grid = tetrahedron().to_pyvista()
    assert isinstance(grid, pyvista.PolyData) and grid.cell_data["rgb"].tolist() == COLOUR.tolist()
