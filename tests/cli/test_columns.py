"""--columns, and compressed input, for the commands that read points."""

import gzip
import os

from brio_cli import CliTest, CUBE, main

SURVEY = "id;lat;lon;alt\n" + "".join("%d;%s;%s;%s\n" % (i, y, x, z) for i, (x, y, z) in enumerate(CUBE))


class Columns(CliTest):
    def test_named_by_the_caller(self):
        points = self.file("a.csv", SURVEY)
        self.bad_input("latitude and longitude are angles.*--columns", "info", points)
        for value in ("--columns=-,y,x,z",), ("--columns", "id,y,x,z"), ("--columns", "-,y,x,z"):
            facts = self.facts("info", points, *value)
            self.assertEqual(facts["box"], {"min": [0, 0, 0], "max": [1, 1, 1]})

    def test_every_command_that_reads_points(self):
        points, out = self.file("a.csv", SURVEY), self.path("out.ply")
        columns = ("--columns", "-,y,x,z")
        at = self.file("at.csv", SURVEY)
        for arguments in [("delaunay", points), ("hull", points, "-o", out), ("alpha", points, "--alpha", "auto", "-o", out),
                          ("voronoi", points, "-o", self.path("out.csv")),
                          ("locate", points, "--at", at, "-o", self.path("found.csv")), ("info", points)]:
            self.expect(0, *arguments, *columns)

    def test_wrong_names(self):
        points = self.file("a.csv", SURVEY)
        self.usage("z is missing", "info", points, "--columns", "x,y")
        self.usage("x is there twice", "info", points, "--columns", "x,y,z,x")
        self.bad_input("line 2: 4 columns, but 5 are named", "info", points, "--columns", "-,x,y,z,w")

    def test_formats_and_commands_without_columns(self):
        self.usage("only texts of points", "info", self.off("a.off", CUBE, []), "--columns", "x,y,z")
        self.usage("no meaning here", "generate", "cube", "-n", "9", "-o", self.path("x.ply"), "--columns", "x,y,z")
        self.usage("no meaning here", "iso", "a.map", "--level", "1", "-o", self.path("x.ply"), "--columns", "x,y,z")


class Compressed(CliTest):
    def setUp(self):
        super().setUp()
        self.data = gzip.compress(b"0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
        run = self.run_brio("info", "-", stdin=self.data)
        if "built without zlib" in run.err:
            self.skipTest("brio is built without zlib")

    def test_file_and_standard_input(self):
        self.assertEqual(self.facts("info", self.file("a.xyz.gz", self.data))["points"], 4)
        self.assertEqual(self.facts("info", "-", stdin=self.data + self.data)["points"], 8)

    def test_places_are_of_the_decompressed_data(self):
        data = gzip.compress(b"0 0 0\n1 0 x\n")
        self.bad_input("b.xyz.gz, decompressed: line 2", "info", self.file("b.xyz.gz", data))
        self.bad_input("breaks off", "info", self.file("c.xyz.gz", data[:-5]))

    def test_bomb_meets_the_limit(self):
        bomb = self.file("a.xyz.gz", gzip.compress(b"1 2 3\n" * 4000000, 1))
        self.assertLess(os.path.getsize(bomb), 1 << 20)
        self.expect(4, "info", bomb, "--max-memory", "50M")

    def test_densities(self):
        plain = self.ball_map("a.map", 8)
        with open(plain, "rb") as f:
            packed = self.file("b.map.gz", gzip.compress(f.read()))
        counts = [self.facts("iso", name, "--level", "-2", "-o", self.path("x.ply"))["faces"] for name in (plain, packed)]
        self.assertEqual(counts[0], counts[1])

    def test_output_is_not_compressed(self):
        self.usage("x.ply.gz", "hull", self.path("a.xyz"), "-o", self.path("x.ply.gz"))


if __name__ == "__main__":
    main()
