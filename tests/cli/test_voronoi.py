"""brio voronoi: Voronoi and power cells."""

import json
import math
import os
import re
import struct

from brio_cli import CliTest, COMMON_FACTS, count, CUBE, main, number

HEADER = "site,volume,area,faces,bounded,cx,cy,cz"
LATTICE = [(x, y, z) for x in range(4) for y in range(4) for z in range(4)]
LATTICE_BOX = "-0.5,-0.5,-0.5,3.5,3.5,3.5"


def rows(text):
    lines = text.splitlines()
    names = lines[0].split(",")
    return [dict(zip(names, map(float, line.split(",")))) for line in lines[1:]]


def read_npy(data):
    """The names and the rows of a structured array in the .npy format, version 1.0."""
    assert data[:8] == b"\x93NUMPY\x01\x00"
    length, = struct.unpack_from("<H", data, 8)
    assert (10 + length) % 64 == 0 and data[9 + length:10 + length] == b"\n"
    header = eval(data[10:10 + length].decode(), {})  # a Python literal, as the format says
    codes = {"<i8": "q", "<f8": "d", "|b1": "?"}
    row = struct.Struct("<" + "".join(codes[kind] for _, kind in header["descr"]))
    return [name for name, _ in header["descr"]], list(row.iter_unpack(data[10 + length:])), header["shape"]


class Voronoi(CliTest):
    def cells(self, *arguments):
        out = self.path("cells.csv")
        facts = self.facts("voronoi", *arguments, "-o", out)
        with open(out) as f:
            text = f.read()
        self.assertEqual(text.splitlines()[0], HEADER)
        return facts, rows(text)

    def test_usage(self):
        points = self.xyz("a.xyz", CUBE)
        self.usage("-o FILE is missing", "voronoi", points)
        self.usage("expected .vtu .npy or .csv", "voronoi", points, "-o", "x.ply")
        self.usage("needs --format", "voronoi", points, "-o", "-")
        for box in ["0,0,0,1,1", "0,0,0,1,1,1,", "0,0,0,1,1,x", "0,0,0,1,1,inf", "0,0,0,1,1,1 "]:
            self.usage("is not x0,y0,z0,x1,y1,z1", "voronoi", points, "-o", "x.csv", "--box", box)
        self.usage("z from 1 to 1 is empty", "voronoi", points, "-o", "x.csv", "--box", "0,0,1,1,1,1")
        self.usage("only one of", "voronoi", points, "-o", "x.csv", "--weights-mod", "-20", "--unweighted")
        self.assert_only(self.folder, "a.xyz")

    def test_box_error_of_a_box_whose_volume_doubles_cannot_hold(self):
        found = set()
        for exponent in [-600, -360, 0, 400, 900]:
            size = 2.0 ** exponent
            points = self.xyz("a.xyz", [tuple(x * size for x in p) for p in LATTICE])
            box = ",".join(repr(float(x) * size) for x in LATTICE_BOX.split(","))
            facts, cells = self.cells(points, "--box=" + box)
            self.assertEqual((len(cells), facts["bounded"]), (64, 64))
            found.add(facts["box_error"])
        self.assertEqual(len(found), 1, found)
        self.assertLess(found.pop(), 1e-14)
        points = self.path("w.csv")
        with open(points, "w") as f:
            f.write("x,y,z,weight\n")
            f.writelines("%r,%r,%r,%r\n" % (*(x * 2.0 ** -400 for x in p), p[0] / 8 * 2.0 ** -800) for p in LATTICE)
        box = ",".join(repr(float(x) * 2.0 ** -400) for x in LATTICE_BOX.split(","))
        facts, _ = self.cells(points, "--box=" + box)
        self.assertLess(facts["box_error"], 1e-14)
        self.assertTrue(facts["weighted"])

    def test_cells_of_a_lattice_in_a_box(self):
        facts, cells = self.cells(self.xyz("a.xyz", LATTICE), "--box=" + LATTICE_BOX)
        self.assert_schema(facts, {**COMMON_FACTS, "cells": count, "bounded": count, "volume": number,
                                   "box_volume": number, "box_error": number})
        self.assertEqual((facts["cells"], facts["bounded"], facts["box_volume"]), (64, 64, 64))
        self.assertLess(facts["box_error"], 1e-14)
        for i, cell in enumerate(cells):
            self.assertEqual((cell["site"], cell["faces"], cell["bounded"]), (i, 6, 1))
            self.assertAlmostEqual(cell["volume"], 1, delta=1e-14)
            self.assertAlmostEqual(cell["area"], 6, delta=1e-13)
            for axis, x in zip(("cx", "cy", "cz"), LATTICE[i]):
                self.assertAlmostEqual(cell[axis], x, delta=1e-14)

    def test_cells_without_a_box(self):
        facts, cells = self.cells(self.xyz("a.xyz", LATTICE))
        self.assertEqual((facts["cells"], facts["bounded"]), (64, 8))
        self.assertAlmostEqual(facts["volume"], 8, delta=1e-13)
        self.assertNotIn("box_volume", facts)
        for cell in cells:
            self.assertEqual(math.isinf(cell["volume"]), not cell["bounded"])
            self.assertEqual(math.isnan(cell["cx"]), not cell["bounded"])

    def test_power_cells(self):
        points, box = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 0), (0.5, 0, 0)]), "--box=-1,-1,-1,2,1,1"
        weights = self.file("w", "0\n0.5\n-2\n")
        facts, cells = self.cells(points, box, "--weights", weights)
        self.assertEqual((facts["weighted"], facts["cells"], facts["hidden"]), (True, 2, 1))
        for cell, volume in zip(cells, (5, 7)):  # the plane between is x = 0.25
            self.assertAlmostEqual(cell["volume"], volume, delta=1e-14)
        self.assertEqual([cell["site"] for cell in cells], [0, 1])

    def test_points_without_tetrahedra(self):
        for points, dimension in [([], -1), ([(1, 1, 1)] * 3, 0), ([(1, 1, 1), (2, 2, 2)], 1), (CUBE[:4], 2)]:
            facts, cells = self.cells(self.xyz("a.xyz", points), "--box=0,0,0,3,3,3")
            self.assertEqual((facts["dimension"], facts["cells"]), (dimension, len(set(points))))
            self.assertAlmostEqual(sum(cell["volume"] for cell in cells), 27 if points else 0, delta=1e-12)

    def test_npy(self):
        points, out = self.xyz("a.xyz", LATTICE), self.path("cells.npy")
        self.expect(0, "voronoi", points, "-o", out)
        with open(out, "rb") as f:
            names, table, shape = read_npy(f.read())
        self.assertEqual(names, HEADER.split(","))
        self.assertEqual((shape, len(table)), ((64,), 64))
        _, cells = self.cells(points)
        for row, cell in zip(table, cells):
            for x, name in zip(row, names):
                self.assertTrue(x == cell[name] or (math.isnan(x) and math.isnan(cell[name])), name)

    def test_vtu(self):
        self.expect(0, "voronoi", self.xyz("a.xyz", LATTICE), "-o", self.path("cells.vtu"))
        arrays, _ = self.appended_arrays("cells.vtu")
        self.assertEqual(arrays["Cells", "types"], (42,) * 8)
        self.assertEqual(arrays["Cells", "offsets"], tuple(range(8, 65, 8)))
        self.assertEqual(set(arrays["CellData", "faces"]), {6})
        self.assertEqual(sorted(arrays["CellData", "site"]), [21, 22, 25, 26, 37, 38, 41, 42])
        stream, ends, begin = arrays["Cells", "faces"], arrays["Cells", "faceoffsets"], 0
        for cell, end in enumerate(ends):
            corners, at = set(), begin + 1
            for _ in range(stream[begin]):
                corners.update(stream[at + 1:at + 1 + stream[at]])
                self.assertEqual(stream[at], 4)
                at += 1 + stream[at]
            self.assertEqual(at, end)
            self.assertEqual(corners, set(arrays["Cells", "connectivity"][8 * cell:8 * cell + 8]))
            begin = end

    def test_what_is_shown(self):
        """Pages and pictures of cells in a box, in space that repeats, and without a box: closed solids, of the volumes of the table."""
        points = self.xyz("a.xyz", LATTICE)
        for how, cells in (("--box=-0.5,-0.5,-0.5,3.5,3.5,3.5",), 64), (("--cell", "4,4,4"), 64), ((), 8):
            run = self.expect(0, "voronoi", points, *how, "--view", self.path("p.html"), "--picture", self.path("p.png"), "--picture-size", "150x100", "--json")
            self.assertEqual("are not shown" in run.err, not how, run.err)
            with open(self.path("p.html"), encoding="utf-8") as f:
                layer = json.loads(re.search(r'class="layer">(.*?)</script>', f.read()).group(1))
            self.assertEqual((layer["faces"], layer["vertices"]), (6 * cells, 8 * cells), how)
            c = layer["certificate"]
            self.assertEqual((c["closed"], c["manifold"], c["components"]), (True, True, cells))
            self.assertAlmostEqual(c["volume"], cells, delta=1e-12)
            self.assertEqual([p["name"] for p in layer["face_properties"]], ["site", "volume"])
            self.assertGreater(os.path.getsize(self.path("p.png")), 1000)
        run = self.expect(3, "voronoi", self.xyz("b.xyz", CUBE), "--view", self.path("q.html"))
        self.assertIn("nothing to show", run.err)

    def test_cells_of_open_sets_were_shown_as_long_needles(self):
        """Those that reach beyond the points' box by more than a quarter of its longest side are not shown, and it is said."""
        points = self.cloud("a.ply", 500, "ball")
        facts = self.facts("voronoi", points, "--view", self.path("p.html"))
        with open(self.path("p.html"), encoding="utf-8") as f:
            layer = json.loads(re.search(r'class="layer">(.*?)</script>', f.read()).group(1))
        shown = layer["certificate"]["components"]
        self.assertTrue(0 < shown < facts["bounded"])
        self.assertIn("--view: %d of 500 cells are not shown" % (500 - shown), facts["warnings"][0])
        box = self.facts("info", points)["box"]
        low, high = box["min"], box["max"]
        far = max(h - l for l, h in zip(low, high)) / 4
        for k in range(3):
            self.assertGreaterEqual(layer["low"][k], low[k] - far)
        self.assertLessEqual(layer["certificate"]["volume"], math.prod(h - l + 2 * far for l, h in zip(low, high)))

    def test_faces(self):
        points, out = self.xyz("a.xyz", LATTICE), self.path("faces.csv")
        facts = self.facts("voronoi", points, "--faces", out, "--box=" + LATTICE_BOX)
        with open(out) as f:
            faces = rows(f.read())
        self.assertEqual((facts["faces"], len(faces)), (6 * 64, 6 * 64))
        self.assertEqual({face["neighbour"] for face in faces if face["neighbour"] < 0}, set(range(-6, 0)))
        for face in faces:
            if face["neighbour"] >= 0:
                way = [b - a for a, b in zip(LATTICE[int(face["site"])], LATTICE[int(face["neighbour"])])]
                self.assertEqual([face["nx"], face["ny"], face["nz"]], way)

    def test_standard_output(self):
        run = self.expect(0, "voronoi", self.xyz("a.xyz", CUBE), "-o", "-", "--format", "csv", "--quiet")
        self.assertEqual(len(rows(run.text)), 8)

    def test_memory_limit_and_target(self):
        points = self.cloud("a.ply", 2000)
        self.expect(4, "voronoi", points, "-o", self.path("x.csv"), "--max-memory", "5M")
        self.expect(6, "voronoi", points, "-o", self.path("no/x.csv"))
        self.assert_only(self.folder, "a.ply")


if __name__ == "__main__":
    main()
