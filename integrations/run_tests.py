#!/usr/bin/env python3
"""run_tests.py: each integration, used as its README says. BRIO_PYTHON names the folder of the package brio, BRIO the program.

What needs a package that is missing is skipped, with the reason. Blender is its Python package bpy; without it the add-on's own Python runs with
a stand-in of bpy, and QGIS always has one: its packages are those of a whole desktop."""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
BRIO = os.environ.get("BRIO", "brio")
if os.environ.get("BRIO_PYTHON"):
    sys.path.insert(0, os.environ["BRIO_PYTHON"])

import numpy as np  # noqa: E402


def module_of(path, name):
    spec = importlib.util.spec_from_file_location(name, HERE / path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def sphere(count=2000):
    rows = np.random.default_rng(1).normal(size=(count, 3))
    return rows / np.linalg.norm(rows, axis=1)[:, None]


class PyVista(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            import pyvista
        except ImportError as error:
            raise unittest.SkipTest("no PyVista: %s" % error) from error
        if not hasattr(pyvista, "register_dataset_accessor"):
            raise unittest.SkipTest("PyVista %s has no accessors: 0.48 and later have" % pyvista.__version__)
        cls.pyvista = pyvista
        module_of("pyvista/brio_pyvista.py", "brio_pyvista")

    def test_a_surface_is_closed_and_carries_properties(self):
        cloud = self.pyvista.PolyData(sphere())
        cloud["height"] = cloud.points[:, 2]
        surface = cloud.brio.surface()
        self.assertEqual(list(surface.field_data["closed"]), [1])
        self.assertEqual(surface.n_open_edges, 0)
        self.assertEqual(surface.n_points - surface.n_cells // 2, 2)  # a sphere
        np.testing.assert_allclose(surface["height"], surface.points[:, 2], atol=1e-6)

    def test_normals_of_the_dataset_are_taken_and_no_property_is_invented(self):
        cloud = self.pyvista.PolyData(sphere())
        cloud["Normals"] = cloud.points
        self.assertGreater(cloud.brio.surface().volume, 4)

    def test_outliers_are_left_out(self):
        rows = np.vstack([sphere(), [[50.0, 0, 0]]])
        surface = self.pyvista.PolyData(rows).brio.surface(outliers=True)
        self.assertLess(surface.bounds[1], 2)

    def test_tetrahedra_fill_the_hull(self):
        rows = np.random.default_rng(2).integers(0, 5, (200, 3)).astype(float)
        corners = [[x, y, z] for x in (0, 4) for y in (0, 4) for z in (0, 4)]
        cells = self.pyvista.PolyData(np.vstack([rows, corners])).brio.delaunay_3d()
        self.assertAlmostEqual(cells.volume, 64, places=6)
        sizes = cells.compute_cell_sizes(length=False, area=False)["Volume"]
        self.assertGreater(abs(sizes).min(), 0)  # none of no volume, on a grid

    def test_weights_hide_points(self):
        cloud = self.pyvista.PolyData(np.vstack([sphere(100), [[0.0, 0, 0]]]))
        cloud["w"] = np.append(np.full(100, 9.0), -9.0)
        self.assertNotIn(100, cloud.brio.delaunay_3d(weights="w").cells.reshape(-1, 5)[:, 1:])

    def test_cells_fill_the_box_and_are_in_the_points_order(self):
        rows = np.random.default_rng(3).random((100, 3))
        cloud = self.pyvista.PolyData(rows)
        cloud["index"] = np.arange(100)
        cells = cloud.brio.voronoi(box=[[0, 0, 0], [1, 1, 1]])
        self.assertEqual(list(cells.cell_data["index"]), list(range(100)))
        self.assertAlmostEqual(cells.cell_data["volume"].sum(), 1, places=9)
        for k in (0, 50, 99):  # each holds its point
            low, high = np.array(cells.get_cell(k).bounds).reshape(3, 2).T
            self.assertTrue((low <= rows[k]).all() and (rows[k] <= high).all())

    def test_a_picture_off_screen(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = os.environ.get("BRIO_PICTURE", os.path.join(folder, "picture.png"))
            environment = {**os.environ, "PYTHONPATH": os.environ.get("BRIO_PYTHON", "")}
            done = subprocess.run([sys.executable, HERE / "pyvista/draw.py", picture], capture_output=True, text=True, env=environment, timeout=300)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(os.path.getsize(picture), 10000)


class Meshio(unittest.TestCase):
    def run_command(self, *words):
        environment = {**os.environ, "PYTHONPATH": os.environ.get("BRIO_PYTHON", "")}
        return subprocess.run([sys.executable, HERE / "meshio/brio_mesh.py", *words], capture_output=True, text=True, env=environment, timeout=300)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_formats_of_the_others_are_read_and_written(self):
        try:
            import meshio
            import trimesh
        except ImportError as error:
            self.skipTest(str(error))
        source, surface, cells = (self.folder / n for n in ("points.inp", "surface.inp", "cells.inp"))
        meshio.write(source, meshio.Mesh(sphere(800), [("triangle", np.array([[0, 1, 2]]))]))
        done = self.run_command("surface", source, surface)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        facts = json.loads(done.stdout)
        self.assertEqual((facts["closed"], facts["genus"], facts["by"]), (1, 0, "meshio"))
        back = meshio.read(surface)
        self.assertTrue(trimesh.Trimesh(back.points, back.cells_dict["triangle"]).is_watertight)
        done = self.run_command("delaunay", source, cells)
        self.assertEqual(len(meshio.read(cells).cells_dict["tetra"]), json.loads(done.stdout)["tetrahedra"])

    def test_a_hull_has_its_vertices_alone(self):
        np.savetxt(self.folder / "p.xyz", np.vstack([np.indices((3, 3, 3)).reshape(3, -1).T]))
        facts = json.loads(self.run_command("hull", self.folder / "p.xyz", self.folder / "h.ply").stdout)
        self.assertEqual((facts["vertices"], facts["volume"]), (8, 8.0))

    def test_what_cannot_be_read_or_written_is_said_and_leaves_no_file(self):
        np.savetxt(self.folder / "p.xyz", sphere(100))
        done = self.run_command("surface", self.folder / "p.xyz", self.folder / "out.nothing")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no library writes it", done.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["p.xyz"])
        self.assertIn("no library reads it", self.run_command("surface", self.folder / "none.abc", "x.ply").stderr)
        self.assertIn("no_such", self.run_command("surface", self.folder / "p.xyz", self.folder / "x.ply", "no_such=1").stderr)


def stand_in_of_bpy():
    """As much of bpy as the add-on's own Python asks for when it is imported."""
    bpy = types.ModuleType("bpy")
    bpy.types = types.SimpleNamespace(Operator=type("Operator", (), {}), Menu=type("Menu", (), {}))
    bpy.props = types.SimpleNamespace(**{n: (lambda **facts: facts) for n in ("EnumProperty", "BoolProperty")})
    return bpy


class Blender(unittest.TestCase):
    def test_the_operators_work_on_rows(self):
        import brio

        before = sys.modules.get("bpy")
        sys.modules["bpy"] = stand_in_of_bpy()
        try:
            addon = module_of("blender/__init__.py", "brio_addon")
        finally:
            sys.modules.pop("bpy")
            if before:
                sys.modules["bpy"] = before
        surface = addon.BrioSurface()
        surface.method, surface.outliers = "labeled-delaunay", True
        name, vertices, faces, words = surface.work(brio, np.vstack([sphere(1000), [[30.0, 0, 0]]]))
        self.assertEqual((name, len(vertices) - len(faces) // 2), ("surface", 2))
        self.assertIn("closed, genus 0, 1 components", words)
        name, vertices, faces, words = addon.BrioHull().work(brio, np.indices((3, 3, 3)).reshape(3, -1).T.astype(float))
        self.assertEqual((len(vertices), faces.max()), (8, 7))
        self.assertIn("volume 8", words)

    def test_in_blender(self):
        python = HERE.parent / "out/blender-env/bin/python"
        if not python.exists() or subprocess.run([python, "-c", "import bpy"], capture_output=True, timeout=300).returncode:
            self.skipTest("no bpy in out/blender-env: sh scripts/setup.sh blender")
        environment = {**os.environ, "PYTHONPATH": os.environ.get("BRIO_PYTHON", "")}
        done = subprocess.run([python, HERE / "blender/try_in_blender.py"], capture_output=True, text=True, env=environment, timeout=600)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("surface closed", done.stdout)

    def test_the_zip_has_manifest_code_and_wheels(self):
        import tomllib

        with tempfile.TemporaryDirectory() as folder:
            for tag in ("manylinux2014_x86_64.manylinux_2_17_x86_64", "win_amd64", "macosx_13_0_arm64", "musllinux_1_1_x86_64"):
                (pathlib.Path(folder) / ("brio_geometry-0.3.0-cp311-abi3-%s.whl" % tag)).write_bytes(b"wheel")
            subprocess.run([sys.executable, HERE / "blender/pack.py", folder, folder + "/brio.zip"], check=True, capture_output=True)
            with zipfile.ZipFile(folder + "/brio.zip") as archive:
                manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
                names = archive.namelist()
        self.assertEqual(manifest["platforms"], ["linux-x64", "macos-arm64", "windows-x64"])
        self.assertEqual(len(manifest["wheels"]), 3)
        self.assertTrue(all(w[2:] in names for w in manifest["wheels"]))


class StandIn:
    """Of QGIS: an algorithm that is given the parameters as they are, and kinds of parameters that keep their names."""

    Double = 1

    def __init__(self, *names, **more):
        self.names = names

    def __getattr__(self, name):
        if name.startswith("parameterAs"):
            return lambda parameters, key, context: parameters[key]
        raise AttributeError(name)


class Qgis(unittest.TestCase):
    def setUp(self):
        core = types.ModuleType("qgis.core")
        core.QgsProcessingException = type("QgsProcessingException", (Exception,), {})
        core.__getattr__ = lambda name: StandIn
        sys.modules.update({"qgis": types.ModuleType("qgis"), "qgis.core": core})
        self.addCleanup(lambda: [sys.modules.pop(n, None) for n in ("qgis", "qgis.core")])
        self.wrong = core.QgsProcessingException
        self.module = module_of("qgis/brio_terrain.py", "brio_terrain")
        self.feedback = types.SimpleNamespace(pushInfo=lambda text: None, isCanceled=lambda: False)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def parameters(self, cloud):
        return {"CLOUD": str(cloud), "CLASSES": "", "CELL": 0.5, "MAX_EDGE": 0.0, "RASTER": str(self.folder / "h.tif"), "MESH": str(self.folder / "t.ply")}

    def test_a_slope_becomes_a_raster_and_triangles(self):
        rows = np.random.default_rng(1).random((500, 2)) * 10
        np.savetxt(self.folder / "p.xyz", np.column_stack([rows, 2 * rows[:, 0]]))
        algorithm = self.module.BrioTerrain()
        added = []
        algorithm.addParameter = algorithm.addOutput = added.append
        algorithm.initAlgorithm()
        parameters = self.parameters(self.folder / "p.xyz")
        self.assertEqual({p.names[0] for p in added}, {*parameters, "TRIANGLES"})
        result = algorithm.processAlgorithm(parameters, None, self.feedback)
        self.assertGreater(result["TRIANGLES"], 900)
        self.assertTrue((self.folder / "h.tif").stat().st_size > 400 and (self.folder / "t.ply").exists())

    def test_a_failure_is_said_in_the_programs_words(self):
        with self.assertRaises(self.wrong) as caught:
            self.module.BrioTerrain().processAlgorithm(self.parameters(self.folder / "none.las"), None, self.feedback)
        self.assertIn("none.las", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
