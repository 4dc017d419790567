"""brio terrain: triangles of a map, and rasters of their heights."""

import struct

from brio_cli import CliTest, main

PLANE = [(x, y, 0.5 * x + 2 * y) for x in range(6) for y in range(5)]


class Terrain(CliTest):
    def survey(self, rows):
        return self.file("a.csv", "x,y,z,classification\n" + "".join("%r,%r,%r,%d\n" % row for row in rows))

    def test_classes(self):
        points = self.survey([(*p, 2) for p in PLANE] + [(1.5, 1.5, 90, 6), (2.5, 2.5, 80, 5)])
        facts = self.facts("terrain", points, "--class", "2,8", "-o", self.path("t.ply"))
        self.assertEqual((facts["points"], facts["other_classes"], facts["triangles"]), (32, 2, 40))
        self.assertEqual(self.facts("info", self.path("t.ply"))["properties"], {"classification": "float64"})
        self.assertEqual(self.facts("terrain", points, "-o", self.path("t.ply"))["triangles"], 44)

    def test_longest_edge(self):
        points = self.xyz("a.xyz", PLANE + [(20, 20, 1)])
        facts = self.facts("terrain", points, "--max-edge", 1.5, "-o", self.path("t.ply"))
        self.assertEqual(facts["triangles"], 40)
        self.assertGreater(facts["left_out"], 0)
        self.assertIn("no triangle is left", self.expect(3, "terrain", points, "--max-edge", 0.1, "-o", self.path("u.ply")).err)

    def ascii_grid(self, path):
        with open(path) as f:
            lines = f.read().splitlines()
        header = dict(line.split() for line in lines[:6])
        return header, [list(map(float, line.split())) for line in lines[6:]]

    def test_ascii_grid(self):
        path = self.path("t.asc")
        facts = self.facts("terrain", self.xyz("a.xyz", PLANE), "--raster", path, "--cell", 0.5)
        header, rows = self.ascii_grid(path)
        self.assertEqual((facts["columns"], facts["rows"], facts["empty_cells"]), (10, 8, 0))
        self.assertEqual([float(header[k]) for k in "ncols nrows xllcorner yllcorner cellsize NODATA_value".split()],
                         [10, 8, 0, 0, 0.5, -9999])
        for i, row in enumerate(rows):
            for j, height in enumerate(row):
                self.assertAlmostEqual(height, 0.5 * (0.25 + 0.5 * j) + 2 * (4 - 0.25 - 0.5 * i))

    def test_geotiff_has_the_numbers_of_the_grid(self):
        points = self.xyz("a.xyz", PLANE + [(9, 9, 1)])
        for name in ["t.asc", "t.tif"]:
            self.facts("terrain", points, "--max-edge", 1.5, "--raster", self.path(name), "--cell", 0.75)
        header, rows = self.ascii_grid(self.path("t.asc"))
        with open(self.path("t.tif"), "rb") as f:
            data = f.read()
        order = {b"II": "<", b"MM": ">"}[data[:2]]
        count, = struct.unpack_from(order + "H", data, 8)
        tags = {}
        for i in range(count):
            tag, kind, n = struct.unpack_from(order + "HHI", data, 10 + 12 * i)
            code = {2: "s", 3: "H", 4: "I", 12: "d"}[kind]
            form = order + ("%ds" % n if code == "s" else "%d%s" % (n, code))
            at = 18 + 12 * i if struct.calcsize(form) <= 4 else struct.unpack_from(order + "I", data, 18 + 12 * i)[0]
            tags[tag] = struct.unpack_from(form, data, at)
        self.assertEqual(list(tags), sorted(tags))
        columns, height = tags[256][0], tags[257][0]
        self.assertEqual((columns, height), (int(header["ncols"]), int(header["nrows"])))
        self.assertEqual(len(data), tags[273][0] + 4 * columns * height)
        self.assertEqual(tags[279][0], 4 * columns * height)
        found = struct.unpack_from(order + "%df" % (columns * height), data, tags[273][0])
        for a, b in zip(found, [x for row in rows for x in row]):
            self.assertAlmostEqual(a, b, places=5)
        self.assertIn(-9999, found)
        self.assertEqual(tags[33550], (0.75, 0.75, 0))
        self.assertEqual(tags[33922], (0, 0, 0, 0, 0.75 * height, 0))
        self.assertEqual((tags[34735], tags[42113]), ((1, 1, 0, 1, 1025, 0, 1, 1), (b"-9999\0",)))

    def test_wrong_uses(self):
        points, out = self.xyz("a.xyz", PLANE), self.path("t.ply")
        self.usage("go together", "terrain", points, "--raster", self.path("t.asc"), "-o", out)
        self.usage("a raster is .asc", "terrain", points, "--raster", self.path("t.png"), "--cell", 1)
        self.usage("no list of numbers", "terrain", points, "--class", "2;8", "-o", out)
        self.bad_input("no property classification", "terrain", points, "--class", "2", "-o", out)
        self.expect(4, "terrain", points, "--raster", self.path("t.asc"), "--cell", 1e-9)
        self.expect(3, "terrain", self.xyz("l.xyz", [(i, 0, 0) for i in range(5)]), "-o", out)


if __name__ == "__main__":
    main()
