"""test_colours.py: colours and normals from every format that holds them to every other one, read by other programs.

BRIO names the program brio. A test is skipped with its reason where the other program's package is missing.
"""

import itertools
import json
import os
import subprocess
import unittest

import numpy

from test_foreign import ForeignTest, main, missing

BRIO = os.environ.get("BRIO", "brio")
FORMATS = ["ply", "obj", "vtu", "vtp", "glb", "las", "pcd", "npy", "csv"]
COUNT = 256
BYTES = numpy.stack([numpy.arange(COUNT), numpy.arange(COUNT)[::-1], numpy.arange(COUNT) * 7 % 256], axis=1)


class ColoursTest(ForeignTest):
    def setUp(self):
        super().setUp()
        self.points = self.random.integers(0, 64, (COUNT, 3)).astype(float)
        self.normals = numpy.tile([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0.6, -0.8]], (COUNT // 4, 1)).astype("f4")

    def brio(self, *arguments):
        run = subprocess.run([BRIO, "convert", *map(str, arguments), "--json", "--quiet"], capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr.decode())
        return json.loads(run.stdout)

    def write(self, name, colours, kind):
        """A PLY file of this test's making with a colour and a normal for each point."""
        fields = [(axis, "f8") for axis in "xyz"] + [(c, kind) for c in ("red", "green", "blue")]
        rows = numpy.zeros(COUNT, fields + [(n, "f4") for n in ("nx", "ny", "nz")])
        for k in range(3):
            rows["xyz"[k]], rows[fields[3 + k][0]] = self.points[:, k], colours[:, k]
            rows[("nx", "ny", "nz")[k]] = self.normals[:, k]
        names = {"f8": "double", "u1": "uchar", "u2": "ushort", "f4": "float"}
        header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % COUNT
        header += "".join("property %s %s\n" % (names[rows.dtype[n].str[1:]], n) for n in rows.dtype.names) + "end_header\n"
        with open(self.path(name), "wb") as file:
            file.write(header.encode() + rows.tobytes())
        return self.path(name)

    def bytes_of(self, path):
        """The colours of a file as bytes, and its normals, through brio's PLY."""
        self.brio(path, self.path("bytes.ply"))
        rows = self.read(self.path("bytes.ply"))
        colours = numpy.stack([rows[c] for c in ("red", "green", "blue")], axis=1)
        self.assertEqual(colours.dtype, numpy.uint8, path)
        return colours, numpy.stack([rows[c] for c in ("nx", "ny", "nz")], axis=1).astype("f4")

    def test_every_pair_of_formats(self):
        """Bytes come back from every chain, and nothing is named as lost but what the format cannot hold."""
        first = self.write("a.ply", BYTES, "u1")
        for source in FORMATS:
            at = self.path("b." + source)
            self.assertEqual(self.brio(first, at)["lost"], [], source)
            for target in FORMATS:
                to = self.path("c." + target)
                facts = self.brio(at, to)
                self.assertNotIn("colour depth", facts["lost"], (source, target))
                self.assertFalse({"red", "green", "blue", "nx", "ny", "nz"} & set(facts["lost"]), (source, target))
                colours, normals = self.bytes_of(to)
                self.expect_equal(colours, BYTES, (source, target))
                self.expect_equal(normals, self.normals, (source, target))

    def test_sixteen_bits(self):
        """Only formats that hold bytes alone lose the lower ones, and say so."""
        words = BYTES * 257 - (BYTES > 0)
        deep = self.write("a.ply", words, "u2")
        for source, target in itertools.product(["npy", "las"], FORMATS):
            at, to = self.path("b." + source), self.path("c." + target)
            self.assertEqual(self.brio(deep, at)["lost"], [], source)
            lost = "colour depth" in self.brio(at, to)["lost"]
            self.assertEqual(lost, target in ("ply", "vtu", "vtp", "pcd"), (source, target))
            self.expect_equal(self.bytes_of(to)[0], words >> 8, (source, target))

    @unittest.skipIf(missing("trimesh"), missing("trimesh"))
    def test_trimesh(self):
        import trimesh
        for kind, colours in (("u1", BYTES), ("u2", BYTES * 257), ("f4", BYTES / 255)):
            first = self.write("a.ply", colours, kind)
            for extension in ("ply", "glb", "obj"):
                self.brio(first, self.path("a2." + extension))
                cloud = trimesh.load(self.path("a2." + extension))
                if isinstance(cloud, trimesh.Scene):
                    cloud = next(iter(cloud.geometry.values()))
                seen = cloud.colors if hasattr(cloud, "colors") else cloud.visual.vertex_colors
                if extension == "obj" and not len(seen):
                    continue  # trimesh reads colours of OBJ with faces only
                self.expect_equal(numpy.asarray(seen)[:, :3], BYTES, (kind, extension))

    @unittest.skipIf(missing("trimesh"), missing("trimesh"))
    def test_a_mesh_of_obj_in_trimesh(self):
        import trimesh
        with open(self.path("a.off"), "w") as file:
            file.write("COFF\n3 1 0\n0 0 0 255 0 7 255\n1 0 0 0 128 9 255\n0 1 0 3 4 255 255\n3 0 1 2\n")
        self.brio(self.path("a.off"), self.path("a.obj"))
        mesh = trimesh.load(self.path("a.obj"), process=False)
        self.expect_equal(mesh.visual.vertex_colors[:, :3], [[255, 0, 7], [0, 128, 9], [3, 4, 255]], "obj")

    @unittest.skipIf(missing("meshio"), missing("meshio"))
    def test_meshio(self):
        import meshio
        self.brio(self.write("a.ply", BYTES * 257, "u2"), self.path("a.vtu"))
        mesh = meshio.read(self.path("a.vtu"))
        self.expect_equal(mesh.point_data["RGB"], BYTES, "vtu")

    @unittest.skipIf(missing("pyvista"), missing("pyvista"))
    def test_pyvista(self):
        import pyvista
        self.brio(self.write("a.ply", BYTES * 257, "u2"), self.path("a.vtp"))
        mesh = pyvista.read(self.path("a.vtp"))
        self.assertEqual(mesh.point_data["RGB"].dtype, numpy.uint8)
        self.expect_equal(mesh.point_data["RGB"], BYTES, "vtp")

    @unittest.skipIf(missing("laspy"), missing("laspy"))
    def test_laspy(self):
        import laspy
        for kind, colours in (("u1", BYTES), ("f4", BYTES / 255)):
            self.brio(self.write("a.ply", colours, kind), self.path("a.las"))
            las = laspy.read(self.path("a.las"))
            self.expect_equal(numpy.stack([las.red, las.green, las.blue], axis=1), BYTES * 257, kind)

    @unittest.skipIf(missing("pypcd4"), missing("pypcd4"))
    def test_pypcd4(self):
        import pypcd4
        first = self.write("a.ply", BYTES, "u1")
        for options in ([], ["--ascii"], ["--compress"], ["--float32"]):
            self.brio(first, self.path("a.pcd"), *options)
            cloud = pypcd4.PointCloud.from_path(self.path("a.pcd"))
            self.assertEqual(cloud.fields, ("x", "y", "z", "rgb", "normal_x", "normal_y", "normal_z"))
            packed = numpy.ascontiguousarray(cloud.pc_data["rgb"]).view("u4")
            self.expect_equal(packed, BYTES[:, 0] << 16 | BYTES[:, 1] << 8 | BYTES[:, 2], options)
            for axis, column in zip("xyz", self.points.T):
                self.expect_equal(cloud.pc_data[axis], column, options)

    @unittest.skipIf(missing("pypcd4"), missing("pypcd4"))
    def test_files_of_pypcd4(self):
        import pypcd4
        for count in (3, 2000):
            points = self.random.standard_normal((count, 4)).astype("f4")
            cloud = pypcd4.PointCloud.from_points(points, ("x", "y", "z", "intensity"), ("f4",) * 4)
            for encoding in ("ASCII", "BINARY", "BINARY_COMPRESSED"):
                cloud.save(self.path("a.pcd"), encoding=getattr(pypcd4.Encoding, encoding))
                rows = self.read(self.path("a.pcd"))
                for name, column in zip(("x", "y", "z", "intensity"), points.T):
                    if encoding == "ASCII":
                        self.assertTrue(numpy.allclose(rows[name], column, atol=1e-6), name)
                    else:
                        self.expect_equal(rows[name].astype("f4"), column, (encoding, count, name))


if __name__ == "__main__":
    main()
