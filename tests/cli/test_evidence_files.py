"""Evidence from the file to the labels: a simulated scan in every format that keeps the places of its scanners.

The scan is a wavy ceiling, seen from below by one scanner or by two; points alone do not tell which side was seen. Texts are
written here, line by line; E57 and LAS, which pack bits, by the program, whose writers tests/foreign holds against other readers.
Every file has to give the surface that the points with columns of places give, and that surface has to look down.
"""

import math
import os
import random
import struct

from brio_cli import CliTest, main

SCANNERS = [(1.0, 1.5, -8.0), (3.5, 2.0, -6.0)]
SIDE = 26


def ceiling():
    """Points in steps of 1/1000, those of the first half of the rows first."""
    rng = random.Random(7)
    jitter = lambda: rng.randrange(-30, 31)
    points = []
    for row in range(SIDE):
        for column in range(SIDE):
            x, y = 130 * column + jitter(), 130 * row + jitter()
            points.append((x / 1000, y / 1000, round(250 * math.sin(x / 700) * math.cos(y / 900)) / 1000))
    return points


POINTS = ceiling()


def scans(count):
    """Scanners and what each saw."""
    half = len(POINTS) // 2
    return [(SCANNERS[1], POINTS)] if count == 1 else [(SCANNERS[0], POINTS[:half]), (SCANNERS[1], POINTS[half:])]


def ptx(count):
    """Each scan in its own coordinates: a turn by a quarter about z, and then a move. A line is x y z intensity."""
    out = ""
    for (x, y, z), points in scans(count):
        out += f"{len(points)}\n1\n{x} {y} {z}\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n{x} {y} {z} 1\n"
        for p in points:
            out += "%.3f %.3f %.3f 0.5\n" % (p[1] - y, -(p[0] - x), p[2] - z)
    return out


def pcd(kind):
    (x, y, z), points = scans(1)[0]
    head = (f"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {SIDE}\nHEIGHT {SIDE}\n"
            f"VIEWPOINT {x} {y} {z} 1 0 0 0\nPOINTS {len(points)}\nDATA {kind}\n")
    if kind == "ascii":
        return (head + "".join("%.3f %.3f %.3f\n" % p for p in points)).encode()
    return head.encode() + b"".join(struct.pack("<3d", *p) for p in points)


def columns(count, separator):
    return "".join(separator.join("%.3f" % v for v in (*p, *place)) + "\n" for place, points in scans(count) for p in points)


class EvidenceFiles(CliTest):
    def triangles(self, path):
        """The faces of an OFF file by their corners' positions, the least corner first, and the mean height of their normals."""
        with open(path, encoding="utf-8") as f:
            lines = [line.split() for line in f if line.strip() and line[0] != "#"]
        vertices, faces = (int(w) for w in lines[1][:2])
        at = [tuple(round(float(w), 5) for w in line[:3]) for line in lines[2:2 + vertices]]
        found, up = set(), 0
        for line in lines[2 + vertices:2 + vertices + faces]:
            corners = [at[int(w)] for w in line[1:4]]
            first = corners.index(min(corners))
            found.add(tuple(corners[first:] + corners[:first]))
            (ax, ay, _), (bx, by, _), (cx, cy, _) = corners
            up += (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        return found, up

    def surface_of(self, path, *options):
        facts = self.facts("surface", path, "-o", self.path("out.off"), "--ascii", *options)
        return facts, *self.triangles(self.path("out.off"))

    def converted(self, source, extension):
        path = self.path(os.path.basename(source).split(".")[0] + "-converted." + extension)
        self.expect(0, "convert", source, path, "--quiet")
        return path

    def files(self, count):
        """Files of one scan, or of two."""
        given = self.file("given%d.csv" % count, "x,y,z,x_origin,y_origin,z_origin\n" + columns(count, ","))
        made = [self.file("own%d.ptx" % count, ptx(count)),
                self.file("own%d.xyz" % count, "# x y z x_origin y_origin z_origin\n" + columns(count, " "))]
        if count == 1:
            made += [self.file("text.pcd", pcd("ascii")), self.file("binary.pcd", pcd("binary"))]
        return given, made + [self.converted(given, extension) for extension in ("e57", "ptx", "ply", "las", "laz", "pcd", "npy")]

    def test_a_scanner_above_sees_the_other_side(self):
        text = "x,y,z,x_origin,y_origin,z_origin\n" + "".join("%.3f,%.3f,%.3f,1,1,9\n" % p for p in POINTS)
        facts, _, up = self.surface_of(self.file("above.csv", text))
        self.assertEqual(facts["orientation"], "scanner")
        self.assertGreater(up, 0)

    def test_every_file_gives_the_surface_of_its_columns(self):
        for count in (1, 2):
            given, made = self.files(count)
            facts, expected, up = self.surface_of(given)
            self.assertLess(up, 0)
            self.assertEqual(facts["orientation"], "scanner")
            for path in made:
                with self.subTest(path):
                    found, faces, down = self.surface_of(path)
                    self.assertEqual((found["orientation"], faces == expected), ("scanner", True))
                    self.assertAlmostEqual(found["agreement"], facts["agreement"], 6)
                    self.assertGreater(found["agreement"], 0.98)
                    self.assertAlmostEqual(down, up, 3)

    def test_evidence_of_files_that_is_ignored(self):
        _, alone, _ = self.surface_of(self.file("alone.xyz", "".join("%.3f %.3f %.3f\n" % p for p in POINTS)))
        for path in self.files(1)[1][:4]:
            facts, faces, _ = self.surface_of(path, "--ignore-origins")
            self.assertEqual((facts["orientation"], faces == alone), ("guess", True), path)


if __name__ == "__main__":
    main()
