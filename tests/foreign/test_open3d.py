"""test_open3d.py: clouds and meshes from brio to Open3D and back, in every format that both have.

A file that one writes has the same points, colours, normals and triangles for the other, or `lost` of brio names what is
missing. BRIO names the program brio, OPEN3D_PYTHON a Python that has Open3D (default: out/open3d-env, which
`scripts/setup.sh rivals` makes); without it the tests are skipped.
"""

import json
import os
import subprocess
import unittest

import numpy

from test_foreign import ForeignTest, main

BRIO = os.environ.get("BRIO", "brio")
HERE = os.path.dirname(os.path.abspath(__file__))
PYTHON = os.environ.get("OPEN3D_PYTHON", os.path.join(HERE, "..", "..", "out", "open3d-env", "bin", "python"))
COUNT = 60
COLOURS, NORMALS = ["red", "green", "blue"], ["nx", "ny", "nz"]
# format: what Open3D takes from a file of it beside the points, and how near the points are: texts of Open3D have ten digits
CLOUDS = {"ply": (["colors", "normals"], 0), "pcd": (["colors", "normals"], 1e-6), "xyz": ([], 1e-9), "xyzn": (["normals"], 1e-9),
          "xyzrgb": (["colors"], 1e-9), "pts": (["colors"], 1e-9)}
MESHES = {"ply": (["colors", "normals"], 1e-6), "obj": (["colors", "normals"], 1e-6), "off": (["colors"], 1e-6), "stl": ([], 1e-6),
          "glb": (["colors", "normals"], 1e-6)}
# Options by which it is written for Open3D, which takes doubles for zeros.
OPTIONS = {"pcd": ["--float32"]}
# Open3D has colours as doubles, and rounds them as it likes.
COLOUR, NORMAL = 1.01 / 255, 1e-5


def set_up():
    return os.path.exists(PYTHON) and subprocess.run([PYTHON, "-c", "import open3d"], capture_output=True, check=False).returncode == 0


@unittest.skipUnless(set_up(), "no Open3D: scripts/setup.sh rivals installs it")
class Open3DTest(ForeignTest):
    def brio(self, *arguments):
        run = subprocess.run([BRIO, "convert", *arguments, "--json", "--quiet"], capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, (arguments, run.stderr.decode()))
        return json.loads(run.stdout)

    def open3d(self, *jobs):
        """One process for all: it takes long to begin."""
        run = subprocess.run([PYTHON, os.path.join(HERE, "open3d_arrays.py"), *sum(jobs, ())], capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr.decode())

    def arrays(self, kind):
        """Points in a box with normals and colours, and triangles that share no corner."""
        normals = self.random.standard_normal((COUNT, 3))
        normals /= numpy.linalg.norm(normals, axis=1)[:, None]
        made = {"points": numpy.round(self.random.random((COUNT, 3)) * 8, 3), "normals": normals,
                "colors": self.random.integers(0, 256, (COUNT, 3)) / 255}
        if kind == "mesh":
            made["triangles"] = numpy.arange(COUNT).reshape(-1, 3)
        return made

    def write(self, kind, path, made):
        """A PLY file of this test's making."""
        fields = [(axis, "f8") for axis in "xyz"] + [(c, "u1") for c in COLOURS] + [(n, "f4") for n in NORMALS]
        rows = numpy.zeros(COUNT, fields)
        for k in range(3):
            rows["xyz"[k]], rows[NORMALS[k]] = made["points"][:, k], made["normals"][:, k]
            rows[COLOURS[k]] = numpy.rint(made["colors"][:, k] * 255)
        names = {"<f8": "double", "|u1": "uchar", "<f4": "float"}
        header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % COUNT
        header += "".join("property %s %s\n" % (names[rows.dtype[n].str], n) for n in rows.dtype.names)
        faces = b""
        if kind == "mesh":
            header += "element face %d\nproperty list uchar int vertex_indices\n" % len(made["triangles"])
            table = numpy.zeros(len(made["triangles"]), [("n", "u1"), ("v", "<i4", 3)])
            table["n"], table["v"] = 3, made["triangles"]
            faces = table.tobytes()
        with open(path, "wb") as file:
            file.write((header + "end_header\n").encode() + rows.tobytes() + faces)

    def expect(self, what, made, found, carried, near):
        places = found["points"]
        if what[-1] == "stl":  # corners by themselves, in the order of the triangles
            places = places[found["triangles"]].reshape(-1, 3)
            made = {"points": made["points"][made["triangles"]].reshape(-1, 3)}
        self.assertEqual(places.shape, made["points"].shape, what)
        self.assertLessEqual(numpy.abs(places - made["points"]).max(), near, what)
        for name in carried:
            self.assertEqual(found[name].shape, made[name].shape, (what, name))
            self.assertLessEqual(numpy.abs(found[name] - made[name]).max(), COLOUR if name == "colors" else NORMAL, (what, name))
        if "triangles" in made and what[-1] != "stl":
            self.expect_equal(found["triangles"], made["triangles"], what)

    def from_brio(self, kind, formats):
        made = self.arrays(kind)
        self.write(kind, self.path("first.ply"), made)
        lost = {name: self.brio(self.path("first.ply"), self.path("out." + name), *OPTIONS.get(name, []))["lost"] for name in formats}
        self.open3d(*(("read", kind, self.path("out." + name), self.path(name + ".npz")) for name in formats))
        for name, (carried, near) in formats.items():
            with self.subTest(kind=kind, to=name):
                carried = [n for n in carried if not {"colors": "red", "normals": "nx"}[n] in lost[name]]
                self.expect((kind, name), made, dict(numpy.load(self.path(name + ".npz"))), carried, near)

    def to_brio(self, kind, formats):
        made = self.arrays(kind)
        numpy.savez(self.path("made.npz"), **made)
        self.open3d(*(("write", kind, self.path("theirs." + name), self.path("made.npz")) for name in formats))
        for name in formats:
            self.brio(self.path("theirs." + name), self.path(name + ".ply"))
        self.open3d(*(("read", kind, self.path(name + ".ply"), self.path(name + ".npz")) for name in formats))
        for name, (carried, near) in formats.items():
            with self.subTest(kind=kind, of=name):
                self.expect((kind, name), made, dict(numpy.load(self.path(name + ".npz"))), carried, near)

    def test_open3d_reads_clouds(self):
        self.from_brio("cloud", CLOUDS)

    def test_open3d_reads_meshes(self):
        self.from_brio("mesh", MESHES)

    def test_clouds_of_open3d(self):
        self.to_brio("cloud", CLOUDS)

    def test_meshes_of_open3d(self):
        self.to_brio("mesh", MESHES)


if __name__ == "__main__":
    main()
