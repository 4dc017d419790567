"""brio convert: round trips, choices among points, what is lost, memory."""

import os
import random
import struct
import subprocess
import unittest

from brio_cli import (BRIO, CliTest, COMMON_FACTS, count, CUBE, main, OCTAHEDRON, OCTAHEDRON_FACES,
                      PLY_WITH_PROPERTIES)

HOLDING = ["ply", "xyz", "csv", "npy", "vtu", "node", "las"]  # points with their properties; vtp is not read
LOST = {"node": ["names of properties"]}


class Convert(CliTest):
    def convert(self, *arguments):
        return self.facts("convert", *arguments)

    def rows(self, path):
        """The points of a file, as texts with all digits."""
        out = self.path("rows.xyz")
        self.convert(path, out)
        with open(out) as f:
            return [line.split() for line in f if not line.startswith("#")]

    def ends(self, path):
        """Coordinates and the last property: LAS puts its own before it."""
        return [row[:3] + row[-1:] for row in self.rows(path)]

    def test_facts_of_a_run(self):
        facts = self.convert(self.cloud("a.ply", 500), self.path("b.las"))
        self.assert_schema(facts, {**COMMON_FACTS, "input": str, "points": count, "faces": count, "lost": list,
                                   "streamed": bool})
        self.assertEqual((facts["points"], facts["faces"]), (500, 0))

    def test_output_option_names_the_target(self):
        a, b = self.cloud("a.ply", 10), self.path("b.xyz")
        self.facts("convert", a, "-o", b)
        self.assertEqual(len(self.rows(b)), 10)
        self.usage("two outputs", "convert", a, b, "-o", self.path("c.xyz"))
        self.usage("expected A B", "convert", a)

    def test_round_trips_between_all_formats_of_points(self):
        points = "".join("%r %r %r\n" % (i / 8 - 3, i * i / 64, i % 7) for i in range(100))
        first = self.file("a.xyz", "# x y z class\n" + "".join(
            line[:-1] + " %d\n" % (i % 5) for i, line in enumerate(points.splitlines(True))))
        expected = self.ends(first)
        for a in HOLDING:
            one = self.path("one." + a)
            self.assertEqual(self.convert(first, one)["lost"], LOST.get(a, []), a)
            self.assertEqual(self.ends(one), expected, a)
            for b in HOLDING:
                two = self.path("two." + b)
                self.assertEqual(self.convert(one, two)["lost"], LOST.get(b, []), (a, b))
                self.assertEqual(self.ends(two), expected, (a, b))

    def test_blocks_are_the_whole(self):
        # more points than a block has, from each format that is read in blocks, against `generate` writing at once
        n = 70000
        whole = {e: self.path("whole." + e) for e in ("ply", "xyz", "npy", "las")}
        for path in whole.values():
            self.facts("generate", "scan", "-n", str(n), "-o", path)
        for source in ("ply", "xyz", "npy"):
            for target in ("xyz", "las"):
                facts = self.convert(whole[source], self.path("b." + target))
                self.assertTrue(facts["streamed"])
                with open(whole[target], "rb") as a, open(self.path("b." + target), "rb") as b:
                    one, two = a.read(), b.read()
                if target == "xyz" or source == "npy":  # text has properties as doubles
                    self.assertTrue(one == two, (source, target))

    def test_crop_keeps_the_border(self):
        points = [(x, y, 0) for x in range(10) for y in range(10)]
        for extension in ("ply", "las", "npy", "xyz", "vtu"):
            facts = self.convert(self.xyz("a.xyz", points), self.path("b." + extension), "--crop", "2,3,0,5,4.5,0")
            self.assertEqual((facts["points"], facts["points_read"]), (8, 100))
            self.assertEqual({(float(x), float(y)) for x, y, *_ in self.rows(self.path("b." + extension))},
                             {(x, y) for x in (2, 3, 4, 5) for y in (3, 4)})

    def test_crop_of_a_mesh_keeps_whole_faces(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.convert(mesh, self.path("b.ply"), "--crop", "-1,-1,0,1,1,1")
        self.assertEqual((facts["points"], facts["faces"]), (5, 4))

    def test_crop_to_nothing(self):
        for extension in ("ply", "las", "npy", "xyz", "vtu", "obj"):
            facts = self.convert(self.xyz("a.xyz", CUBE), self.path("b." + extension), "--crop", "5,5,5,6,6,6")
            self.assertEqual(facts["points"], 0)

    def test_bad_choices(self):
        a, b = self.xyz("a.xyz", CUBE), self.path("b.ply")
        self.usage("--crop", "convert", a, b, "--crop", "1,2,3")
        self.usage("empty", "convert", a, b, "--crop", "1,0,0,0,1,1")
        self.usage("--thin", "convert", a, b, "--thin", "-1")
        self.usage("--drop-outliers", "convert", a, b, "--drop-outliers", "64")
        self.assertFalse(os.path.exists(b))

    def test_thin(self):
        points = [(i * 0.1, 0, 0) for i in range(100)]
        for arguments in ([], ["--threads", "1"]):
            facts = self.convert(self.xyz("a.xyz", points), self.path("b.ply"), "--thin", "1", *arguments)
            xs = sorted(float(row[0]) for row in self.rows(self.path("b.ply")))
            self.assertEqual(facts["points"] + facts["thinned"], 100)
            self.assertTrue(all(b - a > 1 - 1e-9 for a, b in zip(xs, xs[1:])), xs)
            self.assertTrue(all(b - a < 2 for a, b in zip(xs, xs[1:])), xs)

    def test_outliers_go_before_thinning(self):
        points = [(i * 0.1, j * 0.1, 0) for i in range(30) for j in range(30)] + [(1, 1, 9)]
        facts = self.convert(self.xyz("a.xyz", points), self.path("b.ply"), "--drop-outliers", "8", "--thin", "0.5")
        self.assertEqual(facts["outliers"], 1)
        self.assertTrue(all(float(row[2]) == 0 for row in self.rows(self.path("b.ply"))))

    def test_lost_is_named(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        a = self.file("a.ply", PLY_WITH_PROPERTIES)
        self.assertEqual(self.convert(mesh, self.path("b.xyz"))["lost"], ["faces"])
        self.assertEqual(self.convert(a, self.path("b.obj"))["lost"], ["red", "quality"])
        self.assertEqual(self.convert(self.xyz("c.xyz", [(0.1, 0, 0)]), self.path("b.ply"), "--float32")["lost"],
                         ["precision"])
        self.assertEqual(self.convert(self.xyz("c.xyz", [(1 / 3, 0, 0), (1e6, 0, 0)]), self.path("b.las"))["lost"],
                         ["precision"])
        node = self.path("t.node")
        self.facts("delaunay", self.xyz("c.xyz", CUBE), "-o", node)
        self.assertEqual(self.convert(node, self.path("b.obj"))["lost"], ["tetrahedra"])
        self.assertIn("warning", self.expect(0, "convert", mesh, self.path("b.xyz")).err)

    def test_properties_that_get_another_name_or_value_are_named(self):
        a = self.file("a.csv", "x,y,z,a b,intensity,id\n1,2,3,4,0.5,344522987.5\n4,5,6,7,0.25,1e300\n")
        for b, names in (("b.ply", ["a b"]), ("b.las", ["intensity"])):
            report = self.convert(a, self.path(b))
            self.assertEqual((report["lost"], report["renamed"]), ([], names), b)
        self.assertEqual(self.convert(a, self.path("b.glb"))["lost"], ["precision"])
        self.assertEqual(self.convert(a, self.path("b.vtu"))["lost"], [])

    def test_points_that_are_not_finite_are_an_error_or_left_out_and_counted(self):
        a = self.file("a.xyz", "0 0 0\nnan 0 0\n1 0 0\n0 inf 0\n0 1 0\n")
        self.assertIn("2 such points", self.expect(2, "convert", a, self.path("b.ply")).err)
        for b in ("b.ply", "b.vtu", "b.las"):
            report = self.convert(a, self.path(b), "--drop-invalid")
            self.assertEqual((report["points"], report["dropped"]), (3, 2), b)
            self.assertEqual(self.facts("info", self.path(b))["points"], 3, b)
        mesh = self.file("m.off", "OFF\n5 2 0\n0 0 0\nnan 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 2 3 4\n")
        report = self.convert(mesh, self.path("b.ply"), "--drop-invalid")
        self.assertEqual((report["points"], report["faces"], report["dropped"]), (4, 1, 1))

    def test_csv_has_commas_and_no_comment_wherever_it_goes(self):
        a = self.xyz("a.xyz", CUBE)
        self.convert(a, self.path("b.csv"))
        self.convert(a, self.path("b.data"), "--format", "csv")
        with open(self.path("b.csv"), "rb") as f:
            expected = f.read()
        self.assertEqual(expected.split(b"\n")[0], b"x,y,z")
        with open(self.path("b.data"), "rb") as f:
            self.assertEqual(f.read(), expected)
        self.assertEqual(self.expect(0, "convert", a, "-", "--format", "csv").out, expected)

    def test_more_properties_than_readers_take_are_refused(self):
        for count, extension in ((257, "glb"), (4094, "npy"), (4094, "ply"), (4094, "csv")):
            a = self.file("a.node", "1 3 %d 0\n0 1 2 3%s\n" % (count, " 1" * count))
            b = self.path("b." + extension)
            self.usage("%d properties" % count, "convert", a, b)
            self.assertFalse(os.path.exists(b))

    def test_a_file_to_itself(self):
        a = self.xyz("a.xyz", CUBE)
        os.symlink(a, self.path("s.xyz"))
        os.link(a, self.path("h.xyz"))
        for b in (a, self.path("s.xyz"), self.path("h.xyz")):
            self.usage("the same file", "convert", a, b)
        self.assertEqual(len(self.rows(a)), 8)
        for beside in ("edge", "face", "neigh", "ele"):
            self.file("t." + beside, "1 2 3\n" * 8)
            self.usage("the same file", "delaunay", self.path("t." + beside), "--input-format", "xyz", "-o",
                       self.path("t.node"))

    def test_pipes(self):
        a = self.cloud("a.ply", 1000)
        with open(a, "rb") as f:
            content = f.read()
        expected = self.rows(a)
        for extension in ("las", "ply", "npy", "xyz"):
            b = self.path("b." + extension)
            self.expect(0, "convert", "-", b, stdin=content)
            if extension != "las":
                self.assertEqual(self.rows(b), expected)
            out = self.expect(0, "convert", a, "-", "--format", extension).out
            self.assertEqual(len(self.rows(self.file("c." + extension, out))), 1000)
            out = self.expect(0, "convert", a, "-", "--format", extension, "--crop", "0,0,0,1,1,0.5").out
            self.assertTrue(0 < len(self.rows(self.file("c." + extension, out))) < 1000)

    def test_column_that_late_rows_lack(self):
        a = self.file("a.xyz", "1 2 3 4\n" * 70000 + "1 2 3\n")
        facts = self.convert(a, self.path("b.npy"))
        self.assertEqual((facts["points"], facts["streamed"]), (70001, True))
        rows = self.rows(self.path("b.npy"))
        self.assertEqual((rows[0], rows[-1]), (["1", "2", "3", "4"], ["1", "2", "3", "nan"]))
        with open(a, "rb") as f:
            self.expect(0, "convert", "-", self.path("c.npy"), stdin=f.read())
        self.assertEqual(self.rows(self.path("c.npy"))[-1], ["1", "2", "3", "nan"])

    def test_not_finite_far_in_the_file(self):
        a = self.file("a.xyz", "1 2 3\n" * 70000 + "1 nan 3\n" + "1 2 3\n" * 70000 + "inf 1 1\n")
        self.bad_input(r"point 70000: y is NaN \(2 such points", "convert", a, self.path("b.ply"))
        self.assertFalse(os.path.exists(self.path("b.ply")))

    def test_memory_is_that_of_blocks(self):
        records = 5000000  # 100 MB
        header = bytearray(227)
        header[0:4], header[24], header[25] = b"LASF", 1, 2
        struct.pack_into("<HI", header, 94, 227, 227)
        struct.pack_into("<BHI", header, 104, 0, 20, records)
        struct.pack_into("<6d", header, 131, 0.01, 0.01, 0.01, 0, 0, 0)
        block = b"".join(struct.pack("<iii8x", i * 7 % 1000, i * 11 % 1000, i) for i in range(10000))
        a = self.file("a.las", b"")
        with open(a, "wb") as f:
            f.write(header)
            for _ in range(records // 10000):
                f.write(block)
        sanitized = "asan" in subprocess.run(["ldd", BRIO], stdout=subprocess.PIPE).stdout.decode()
        if sanitized:
            self.skipTest("the sanitizer's memory counts")
        for extension in ("ply", "las"):
            facts = self.convert(a, self.path("b." + extension), "--threads", "2")
            self.assertEqual(facts["points"], records)
            self.assertLess(facts["peak_bytes"], 64 << 20)
            os.remove(self.path("b." + extension))


class SinglePrecision(CliTest):
    """--float32 of a conversion merged points without a word, and did not give way."""

    def ball(self, n, centre, radius):
        rng = random.Random(n)
        return [tuple(c + radius * rng.uniform(-1, 1) for c in centre) for _ in range(n)]

    def coordinates(self, name):
        """The type of x in a PLY file."""
        with open(self.path(name), "rb") as f:
            header = f.read().split(b"end_header")[0].decode()
        return header.split("\nproperty ")[1].split()[0]

    def gives_way(self, points, *options, why):
        run = self.expect(0, "convert", points, self.path("out.ply"), "--float32", *options)
        self.assertRegex(run.err, "warning: .*out.ply: in double precision: single precision " + why)
        self.assertEqual(self.coordinates("out.ply"), "double")
        facts = self.facts("convert", points, self.path("out.ply"), "--float32", *options)
        self.assertIs(facts["float32"], False)
        self.assertEqual(facts["lost"], [])
        self.assertFalse({"moved", "merged"} & set(facts))

    def stays(self, points, *options):
        facts = self.facts("convert", points, self.path("out.ply"), "--float32", *options)
        self.assertEqual(self.coordinates("out.ply"), "float")
        self.assertNotIn("float32", facts)
        return facts

    def test_points_that_would_be_one_give_way(self):
        self.gives_way(self.xyz("small.xyz", self.ball(302, (0, 0, 0), 1e-165)), why="would merge 301 of 302")
        self.gives_way(self.xyz("far.xyz", self.ball(490, (4e6, 4e6, 4e6), 1e-3)), why="would merge 4.. of 490")

    def test_points_that_would_move_over_their_neighbours_give_way(self):
        self.gives_way(self.xyz("far.xyz", [(4e6 + 0.77 * i, 4e6, 0) for i in range(300)]), why="would move")

    def test_coordinates_beyond_singles_give_way(self):
        huge = self.xyz("huge.xyz", self.ball(50, (0, 0, 0), 1) + [(0, -1e39, 0)])
        self.gives_way(huge, why="cannot hold -1e.39")
        self.stays(huge, "--crop=-2,-2,-2,2,2,2")

    def test_a_late_block_counts(self):
        points = [(i % 300, i // 300, 0) for i in range(70000)] + self.ball(2000, (5e6, 5e6, 5e6), 1)
        self.gives_way(self.xyz("late.xyz", points), why="would merge 1... of 72000")

    def test_a_mesh_gives_way(self):
        mesh = self.off("a.off", [tuple(1e-60 * x for x in p) for p in OCTAHEDRON], OCTAHEDRON_FACES)
        self.gives_way(mesh, why="would merge 5 of 6")

    def test_thinned_points_are_as_far_apart_as_asked(self):
        points = self.xyz("far.xyz", self.ball(2000, (4e6, 4e6, 0), 3))
        self.gives_way(points, "--thin", 0.5, why="would ")
        facts = self.stays(points, "--thin", 2)
        self.assertTrue(0 < facts["moved"] < 0.5 and "merged" not in facts)

    def test_a_few_that_merge_are_counted(self):
        points = self.ball(5000, (0, 0, 0), 1) + [(0.1, 0.2, 0.3), (0.1 + 1e-12, 0.2, 0.3)]
        self.assertEqual(self.stays(self.xyz("a.xyz", points))["merged"], 1)

    def test_a_stl_file_says_what_merges(self):
        mesh = self.off("a.off", [tuple(4e6 + 1e-3 * x for x in p) for p in OCTAHEDRON], OCTAHEDRON_FACES)
        run = self.expect(0, "convert", mesh, self.path("out.stl"))
        self.assertRegex(run.err, "out.stl: single precision merges 5 points with others")

    def test_a_pipe_is_written_and_says_how_far_points_move(self):
        text = "".join("%r %r %r\n" % p for p in self.ball(490, (4e6, 4e6, 4e6), 1e-3)).encode()
        run = subprocess.run([BRIO, "convert", "-", self.path("out.ply"), "--float32"], input=text, capture_output=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn(b"move points by up to", run.stderr)
        self.assertEqual(self.coordinates("out.ply"), "float")

    def test_options_that_change_nothing_are_named(self):
        run = self.expect(0, "convert", self.xyz("a.xyz", CUBE), self.path("out.las"), "--float32")
        self.assertIn("--float32 changes nothing in this format", run.err)


if __name__ == "__main__":
    main()
