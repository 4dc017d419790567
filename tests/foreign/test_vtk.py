"""test_vtk.py: VTU and VTP files of VTK, PyVista and meshio are read, in every encoding, and they read what brio writes.

BRIO_FILES names the example program 03_files, which reads one file and writes another; BRIO names the program brio. A test
is skipped with its reason where the other program's package is missing.
"""

import itertools
import os
import subprocess
import unittest

import numpy

import ply_mesh
from test_foreign import FILES, ForeignTest, main, missing

BRIO = os.environ.get("BRIO", "brio")
WAYS = {"raw": [], "compressed": ["--compress"], "text": ["--ascii"]}


class VtkFileTest(ForeignTest):
    def setUp(self):
        super().setUp()
        run = subprocess.run([BRIO, "generate", "ball", "-n", "9", "-o", self.path("try.vtu"), "--compress"],
                             capture_output=True, check=False)
        if b"built without" in run.stderr:
            self.skipTest("brio was built without zlib")

    def read_mesh(self, name):
        self.convert(self.path(name), self.path("read.ply"))
        return ply_mesh.read(self.path("read.ply"))

    def refused(self, name, part):
        run = subprocess.run([FILES, self.path(name), self.path("read.ply")], capture_output=True, check=False)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(part, run.stderr.decode())

    def brio(self, *arguments):
        run = subprocess.run([BRIO, *map(str, arguments), "--quiet"], capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr.decode())

    def expect_column(self, mesh, name, values):
        self.expect_equal(mesh["vertex"][name], values, name)


@unittest.skipIf(missing("vtk"), missing("vtk"))
class VtkTest(VtkFileTest):
    SCALARS = {"a": "i1", "b": "u1", "c": "i2", "d": "u2", "e": "i4", "f": "u4", "g": "f4", "h": "f8", "wide": "i8",
               "wide_too": "u8"}

    def add_data(self, grid, n, real):
        from vtk import vtkPoints
        from vtk.util.numpy_support import numpy_to_vtk
        kept = {"points": self.random.standard_normal((n, 3)).astype(real)}
        for name, kind in self.SCALARS.items():
            kept[name] = self.random.integers(0, 100, n).astype(kind)
        kept["v"], kept["Normals"] = (self.random.standard_normal((n, 3)).astype("f4") for _ in range(2))
        kept["RGB"] = self.random.integers(0, 256, (n, 3)).astype("u1")
        points = vtkPoints()
        points.SetData(numpy_to_vtk(kept["points"], deep=True))
        grid.SetPoints(points)
        for name, values in kept.items():
            if name != "points":
                array = numpy_to_vtk(values, deep=True)
                array.SetName(name)
                grid.GetPointData().AddArray(array)
        cell_data = numpy_to_vtk(numpy.arange(grid.GetNumberOfCells(), dtype="f8"), deep=True)
        cell_data.SetName("of cells")
        grid.GetCellData().AddArray(cell_data)
        return kept

    def poly_data(self, n, real):
        from vtk import vtkCellArray, vtkPolyData
        data = vtkPolyData()
        cells = {"Verts": [[3], [4]], "Lines": [[0, 1], [5, 2, 7]], "Strips": [[4, 1, 2, 9, 8]],
                 "Polys": [[i, (i + 3) % n, (i + 7) % n, (i + 1) % n, (i + 2) % n][:3 + i % 3] for i in range(n)]}
        for name, rows in cells.items():
            array = vtkCellArray()
            for row in rows:
                array.InsertNextCell(len(row), row)
            getattr(data, "Set" + name)(array)
        kept = self.add_data(data, n, real)
        kept["faces"] = [[4, 1, 2], [1, 9, 2], [2, 9, 8]] + cells["Polys"]
        kept["edges"] = [[0, 1], [5, 2], [2, 7]]
        return data, kept

    def grid(self, n, real):
        from vtk import vtkUnstructuredGrid
        data = vtkUnstructuredGrid()
        cells = [(10, [0, 1, 2, 3]), (12, list(range(8))), (5, [2, 1, 0]), (9, [0, 1, 2, 4]), (7, [0, 1, 2, 5, 6]),
                 (3, [8, 9]), (1, [4]), (8, [0, 1, 2, 3]), (6, [0, 1, 2, 3]), (24, list(range(10))), (13, list(range(6)))]
        for kind, corners in cells * (n // 20):
            data.InsertNextCell(kind, len(corners), corners)
        kept = self.add_data(data, n, real)
        kept["faces"] = [[2, 1, 0], [0, 1, 2, 4], [0, 1, 2, 5, 6], [0, 1, 3, 2], [0, 1, 2], [1, 3, 2]] * (n // 20)
        kept["edges"], kept["tetrahedra"] = [[8, 9]] * (n // 20), [[0, 1, 2, 3], [0, 1, 2, 3]] * (n // 20)
        return data, kept

    def check(self, mesh, kept, what):
        self.expect_equal(ply_mesh.points(mesh), kept["points"].astype(float), what)
        for name in self.SCALARS:
            self.expect_column(mesh, name, kept[name])
        for name, columns in (("v", ("v_0", "v_1", "v_2")), ("Normals", ("nx", "ny", "nz")),
                              ("RGB", ("red", "green", "blue"))):
            for i, column in enumerate(columns):
                self.expect_column(mesh, column, kept[name][:, i])
        self.assertEqual(mesh.get("face", []), kept["faces"], what)
        self.assertEqual(ply_mesh.edges(mesh), kept["edges"], what)
        self.assertEqual(mesh.get("tetrahedron", []), kept.get("tetrahedra", []), what)

    def writers(self, grid):
        """Every way in which VTK can write a file, one after the other, with its description."""
        from vtk import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter
        poly = grid.IsA("vtkPolyData")
        for mode, compressor, order, header in itertools.product(
                ("Ascii", "Binary", "Appended", "Raw"), ("None", "ZLib"), ("Little", "Big"), ("32", "64")):
            writer = (vtkXMLPolyDataWriter if poly else vtkXMLUnstructuredGridWriter)()
            writer.SetInputData(grid)
            getattr(writer, "SetDataModeTo" + ("Appended" if mode == "Raw" else mode))()
            writer.SetEncodeAppendedData(mode != "Raw")
            getattr(writer, "SetCompressorTypeTo" + compressor)()
            getattr(writer, f"SetByteOrderTo{order}Endian")()
            getattr(writer, "SetHeaderTypeToUInt" + header)()
            yield writer, f"{mode} {compressor} {order} {header}"

    def test_read(self):
        for extension, make in (("vtp", self.poly_data), ("vtu", self.grid)):
            for real in "f4", "f8":
                grid, kept = make(1000, real)
                for writer, what in self.writers(grid):
                    if real == "f4" and not what.endswith("Little 32"):
                        continue
                    writer.SetFileName(self.path("a." + extension))
                    writer.SetBlockSize(4096)
                    writer.Write()
                    self.check(self.read_mesh("a." + extension), kept, f"{extension} {real} {what}")

    def test_legacy_read(self):
        from vtk import vtkPolyDataWriter, vtkUnstructuredGridWriter
        for make, kind in ((self.poly_data, vtkPolyDataWriter), (self.grid, vtkUnstructuredGridWriter)):
            for real, mode, version in itertools.product(("f4", "f8"), ("ASCII", "Binary"), (42, 51)):
                grid, kept = make(1000, real)
                writer = kind()
                writer.SetInputData(grid)
                getattr(writer, "SetFileTypeTo" + mode)()
                writer.SetFileVersion(version)
                writer.SetFileName(self.path("a.vtk"))
                writer.Write()
                if mode == "Binary":
                    self.check(self.read_mesh("a.vtk"), kept, f"{real} {version}")
                else:  # VTK writes fewer digits than the numbers have
                    mesh = self.read_mesh("a.vtk")
                    self.assertTrue(numpy.allclose(ply_mesh.points(mesh), kept["points"]))
                    self.expect_column(mesh, "e", kept["e"])
                    self.assertEqual(mesh.get("face", []), kept["faces"], version)

    def test_legacy_write(self):
        from vtk import vtkUnstructuredGridReader
        from vtk.util.numpy_support import vtk_to_numpy
        columns = self.random.standard_normal((300, 4))
        numpy.savetxt(self.path("a.csv"), columns, "%.17g", ",", header="x,y,z,h", comments="")
        for command, kind, options in itertools.product(("delaunay", "hull"), (10, 5), ([], ["--ascii"])):
            if (command == "delaunay") != (kind == 10):
                continue
            self.brio(command, self.path("a.csv"), "-o", self.path("b.vtk"), *options)
            self.brio(command, self.path("a.csv"), "-o", self.path("b.vtu"), *options)
            reader = vtkUnstructuredGridReader()
            reader.SetFileName(self.path("b.vtk"))
            reader.ReadAllFieldsOn()
            reader.Update()
            found, expected = reader.GetOutput(), self.read_by_vtk("b.vtu")
            self.expect_equal(vtk_to_numpy(found.GetPoints().GetData()), vtk_to_numpy(expected.GetPoints().GetData()), command)
            self.expect_equal(vtk_to_numpy(found.GetPointData().GetArray("h")),
                              vtk_to_numpy(expected.GetPointData().GetArray("h")), command)
            self.assertEqual({found.GetCellType(i) for i in range(found.GetNumberOfCells())}, {kind})
            self.expect_equal(vtk_to_numpy(found.GetCells().GetConnectivityArray()),
                              vtk_to_numpy(expected.GetCells().GetConnectivityArray()), command)

    def test_pieces(self):
        """What VTK reads of a file of several pieces."""
        from vtk import vtkXMLPolyDataReader
        from vtk.util.numpy_support import vtk_to_numpy
        grid, _ = self.poly_data(500, "f8")
        for writer, what in self.writers(grid):
            if not what.endswith("Little 32"):
                continue
            writer.SetNumberOfPieces(4)
            writer.SetFileName(self.path("a.vtp"))
            writer.Write()
            reader = vtkXMLPolyDataReader()
            reader.SetFileName(self.path("a.vtp"))
            reader.Update()
            found, mesh = reader.GetOutput(), self.read_mesh("a.vtp")
            self.expect_equal(ply_mesh.points(mesh), vtk_to_numpy(found.GetPoints().GetData()), what)
            self.expect_column(mesh, "h", vtk_to_numpy(found.GetPointData().GetArray("h")))
            polys = found.GetPolys()
            ends = vtk_to_numpy(polys.GetOffsetsArray())
            corners = vtk_to_numpy(polys.GetConnectivityArray())
            faces = [corners[a:b].tolist() for a, b in zip(ends, ends[1:])]
            self.assertEqual(sorted(faces), sorted(f for f in mesh["face"] if f in faces), what)
            strips = found.GetStrips()
            self.assertEqual(len(mesh["face"]), len(faces) + strips.GetNumberOfConnectivityIds() - 2 *
                             strips.GetNumberOfCells(), what)

    def test_refused(self):
        from vtk import vtkImageData, vtkXMLImageDataWriter
        grid, _ = self.grid(40, "f8")
        for name in "LZ4", "LZMA":
            writer = next(self.writers(grid))[0]
            writer.SetDataModeToAppended()
            getattr(writer, "SetCompressorTypeTo" + name)()
            writer.SetFileName(self.path("a.vtu"))
            writer.Write()
            self.refused("a.vtu", f"vtk{name}DataCompressor; expected vtkZLibDataCompressor")
        image = vtkImageData()
        image.SetDimensions(2, 2, 2)
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(image)
        writer.SetFileName(self.path("a.vtu"))
        writer.Write()
        self.refused("a.vtu", "UnstructuredGrid or PolyData")

    def read_by_vtk(self, name):
        from vtk import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
        reader = (vtkXMLPolyDataReader if name.endswith("p") else vtkXMLUnstructuredGridReader)()
        reader.SetFileName(self.path(name))
        reader.Update()
        self.assertEqual(reader.GetErrorCode(), 0)
        return reader.GetOutput()

    def test_write(self):
        from vtk.util.numpy_support import vtk_to_numpy
        n = 3000
        columns = self.random.standard_normal((n, 4))
        numpy.savetxt(self.path("a.csv"), columns, "%.17g", ",", header="x,y,z,h", comments="")
        for way, options in WAYS.items():
            self.brio("delaunay", self.path("a.csv"), "-o", self.path("b.vtu"), *options)
            self.brio("hull", self.path("a.csv"), "-o", self.path("b.vtp"), *options)
            grid, hull = self.read_by_vtk("b.vtu"), self.read_by_vtk("b.vtp")
            self.expect_equal(vtk_to_numpy(grid.GetPoints().GetData()), columns[:, :3], way)
            self.expect_equal(vtk_to_numpy(grid.GetPointData().GetArray("h")), columns[:, 3], way)
            self.assertEqual({grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}, {10}, way)
            corners = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
            a, b, c, d = (columns[corners[:, i], :3] for i in range(4))
            volume = numpy.abs(numpy.einsum("ij,ij->i", b - a, numpy.cross(c - a, d - a))).sum() / 6
            at = vtk_to_numpy(hull.GetPoints().GetData())
            faces = vtk_to_numpy(hull.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            inside = numpy.einsum("ij,ij->i", at[faces[:, 0]], numpy.cross(at[faces[:, 1]], at[faces[:, 2]])).sum() / 6
            self.assertAlmostEqual(volume, inside, 6, way)

    def test_write_lines(self):
        from vtk.util.numpy_support import vtk_to_numpy
        self.brio("generate", "torus", "-n", 3000, "-o", self.path("a.ply"))
        found = []
        for way, options in WAYS.items():
            self.brio("medial", self.path("a.ply"), "-o", self.path("b.vtp"), *options)
            data = self.read_by_vtk("b.vtp")
            found.append([data.GetNumberOfLines(), data.GetNumberOfPolys(), *(
                vtk_to_numpy(data.GetLines().GetConnectivityArray()).tolist()), data.GetBounds()])
            mesh = self.read_mesh("b.vtp")
            self.assertEqual((len(ply_mesh.edges(mesh)), len(mesh["face"])), tuple(found[-1][:2]), way)
            self.assertGreater(found[-1][0], 0)
        self.assertTrue(found[0] == found[1] == found[2])


@unittest.skipIf(missing("pyvista"), missing("pyvista"))
class PyVistaTest(VtkFileTest):
    def test_both_ways(self):
        import pyvista
        sphere = pyvista.Sphere(theta_resolution=20, phi_resolution=20)
        sphere["height"] = sphere.points[:, 2].astype(float)
        sphere["RGBA"] = self.random.integers(0, 256, (sphere.n_points, 4)).astype(numpy.uint8)
        for grid, name in ((sphere, "a.vtp"), (sphere.delaunay_3d(), "a.vtu")):
            for binary in True, False:
                grid.save(self.path(name), binary=binary)
                mesh = self.read_mesh(name)
                self.expect_equal(ply_mesh.points(mesh), grid.points.astype(float), name)
                self.expect_column(mesh, "height", grid["height"])
                for i, column in enumerate(("red", "green", "blue", "alpha")):
                    self.expect_column(mesh, column, grid["RGBA"][:, i])
                self.convert(self.path(name), self.path("b" + name[1:]))
                again = pyvista.read(self.path("b" + name[1:]))
                self.assertEqual((again.n_points, again.n_cells), (grid.n_points, grid.n_cells))
                self.expect_equal(again.points, grid.points, name)
                self.expect_equal(again["height"], grid["height"], name)
        self.assertAlmostEqual(again.volume, grid.volume, 6)


@unittest.skipIf(missing("meshio"), missing("meshio"))
class MeshioVtuTest(VtkFileTest):
    CELLS = {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]], "triangle": [[0, 1, 2]], "quad": [[0, 1, 2, 3]], "line": [[4, 5]],
             "hexahedron": [[0, 1, 2, 3, 4, 5, 6, 7]], "vertex": [[1]]}

    def test_read(self):
        import meshio
        points = self.random.standard_normal((9, 3))
        data = {"one": points[:, 0] * 2, "whole": numpy.arange(9), "vector": points * 3}
        mesh = meshio.Mesh(points, list(self.CELLS.items()), data)
        for options in ({"binary": False}, {"compression": None}, {"compression": "zlib"},
                        {"compression": "zlib", "header_type": "UInt64"}):
            meshio.vtu.write(self.path("a.vtu"), mesh, **options)
            found = self.read_mesh("a.vtu")
            # its text has twelve digits
            close = numpy.allclose if options == {"binary": False} else numpy.array_equal
            self.assertTrue(close(ply_mesh.points(found), points), options)
            self.assertTrue(close(found["vertex"]["one"], data["one"]), options)
            self.assertTrue(close(found["vertex"]["vector_2"], points[:, 2] * 3), options)
            self.expect_column(found, "whole", data["whole"])
            self.assertEqual(found["face"], [[0, 1, 2], [0, 1, 2, 3]])
            self.assertEqual(found["tetrahedron"], self.CELLS["tetra"])
            self.assertEqual(ply_mesh.edges(found), [[4, 5]])
        for form, binary in itertools.product(("vtk42", "vtk51"), (False, True)):
            meshio.write(self.path("a.vtk"), mesh, file_format=form, binary=binary)
            found = self.read_mesh("a.vtk")
            self.assertTrue(numpy.allclose(ply_mesh.points(found), points), form)
            self.assertTrue(numpy.allclose(found["vertex"]["vector_2"], points[:, 2] * 3), form)
            self.assertEqual(found["face"], [[0, 1, 2], [0, 1, 2, 3]])
            self.assertEqual(found["tetrahedron"], self.CELLS["tetra"])
        meshio.vtu.write(self.path("a.vtu"), mesh, compression="lzma")
        self.refused("a.vtu", "vtkLZMADataCompressor")

    def test_write(self):
        import meshio
        columns = self.random.standard_normal((50, 4))
        numpy.savetxt(self.path("a.csv"), columns, "%.17g", ",", header="x,y,z,h", comments="")
        for way, options in WAYS.items():
            self.brio("delaunay", self.path("a.csv"), "-o", self.path("b.vtu"), *options)
            found = meshio.read(self.path("b.vtu"))
            self.expect_equal(found.points, columns[:, :3], way)
            self.expect_equal(found.point_data["h"].ravel(), columns[:, 3], way)
            self.assertEqual(list(found.cells_dict), ["tetra"])
            if way == "compressed":
                continue
            self.brio("convert", self.path("b.vtu"), "-o", self.path("b.vtk"), *options)
            legacy = meshio.read(self.path("b.vtk"))
            self.expect_equal(legacy.points, found.points, way)
            self.expect_equal(legacy.point_data["h"].ravel(), columns[:, 3], way)
            self.expect_equal(legacy.cells_dict["tetra"], found.cells_dict["tetra"], way)


if __name__ == "__main__":
    main()
