"""Values that equal a threshold but for rounding: grids whose spacing no double holds are treated like those of whole numbers, in
every order, far from the origin, turned, and in other units."""

import random
import struct

from brio_cli import CliTest, main

WAYS = {"plain": lambda p: p, "far": lambda p: [c + 1000 for c in p], "turned": lambda p: (-p[1], p[0], p[2]),
        "moved": lambda p: [c + 1 / 7 for c in p]}
PARTS = [1, 3, 7, 10]


class Equal(CliTest):
    def ways(self, points, *names):
        """Files of the points, which are whole numbers, over each of PARTS and times powers of two; with the unit of each."""
        for parts in PARTS:
            for name in names or WAYS:
                for scale in (1, 2**-20):
                    self.what = "1/%d, %s, times %g" % (parts, name, scale)
                    moved = [[c / parts * scale for c in WAYS[name](p)] for p in points]
                    random.Random(parts).shuffle(moved)
                    yield self.xyz("a.xyz", moved), scale / parts

    def test_alpha_of_a_cubic_grid(self):
        """Of 162 tetrahedra 114 were in the shape, of the same value up to rounding."""
        points = [(i, j, k) for i in range(4) for j in range(4) for k in range(4)]
        for file, unit in self.ways(points):
            facts = self.facts("alpha", file, "--alpha", repr(0.75 * unit * unit), "-o", self.path("a.ply"))
            self.assertAlmostEqual(facts["certificate"]["volume"] / unit**3, 27, delta=1e-6, msg=self.what)
            self.assertAlmostEqual(facts["alpha"] / (0.75 * unit * unit), 1, delta=1e-15, msg=self.what)
            less = self.facts("alpha", file, "--alpha", repr(0.7499 * unit * unit), "-o", self.path("a.ply"), code=3)
            self.assertIn("no tetrahedron", less["error"])

    def test_longest_edge_of_a_terrain(self):
        """Triangles of sides 3, 4, 5: half of them were left out where 5 was the most."""
        for file, unit in self.ways([(3 * i, 4 * j, i * j % 5) for i in range(6) for j in range(6)]):
            longest = lambda most: self.facts("terrain", file, "--max-edge", repr(most), "-o", self.path("a.ply"))["triangles"]
            self.assertEqual(longest(5 * unit), 50, self.what)
            self.expect(3, "terrain", file, "--max-edge", repr(4.9995 * unit), "-o", self.path("a.ply"))

    def test_cells_of_a_raster(self):
        """A grid of n by n had n + 1 by n + 1 cells, the last ones empty."""
        for file, unit in self.ways([(i, j, 0) for i in range(8) for j in range(8)], "plain", "far", "turned"):
            facts = self.facts("terrain", file, "--raster", self.path("a.asc"), "--cell", repr(unit))
            self.assertEqual((facts["columns"], facts["rows"], facts["empty_cells"]), (7, 7, 0), self.what)

    def test_levels_of_a_map(self):
        """The values are singles: 0.3 was less than its value, 0.7 more, so that a peak was there or not."""
        size, answers = 9, set()
        for k in range(1, 100, 3):
            values = [0.0] * size**3
            values[size**3 // 2] = k / 100
            header = struct.pack("<10i", size, size, size, 2, 0, 0, 0, size - 1, size - 1, size - 1)
            header += struct.pack("<6f", size - 1, size - 1, size - 1, 90, 90, 90) + struct.pack("<3i", 1, 2, 3)
            header = header.ljust(208, b"\0") + b"MAP \x44\x44\0\0"
            file = self.file("a.map", header.ljust(1024, b"\0") + struct.pack("<%df" % len(values), *values))
            run = self.run_brio("iso", file, "--level", repr(k / 100), "-o", self.path("a.ply"), "--quiet")
            answers.add(run.code)
        self.assertEqual(answers, {3})

    def test_surfaces_as_far_apart_as_they_may_be(self):
        """'the surfaces are 0.1 apart, more than 0.1'."""
        faces = [c for i in range(3) for j in range(3) for c in
                 [(4 * i + j, 4 * i + j + 4, 4 * i + j + 5), (4 * i + j, 4 * i + j + 5, 4 * i + j + 1)]]
        for parts in PARTS:
            for z in (1, 2, 6, 1000):
                sheets = [[(i / parts, j / parts, height / parts) for i in range(4) for j in range(4)] for height in (z, z + 1)]
                one, two = (self.off("%d.off" % k, sheet, faces) for k, sheet in enumerate(sheets))
                cloud = self.xyz("a.xyz", sheets[1])
                with self.subTest(parts=parts, z=z):
                    for other in ([two, "--samples", 500], [cloud]):
                        within = self.facts("compare", one, *other, "--within", repr(1 / parts))
                        self.assertIs(within["within"], True)
                        self.facts("compare", one, *other, "--within", repr(0.9999 / parts), code=5)


if __name__ == "__main__":
    main()
