"""Points that span no space: none, one, two, all at one place, on a line, three, in a plane. One rule for every command:

- What is a list for its points, of nothing is the empty list: simplices, cells, places, files (exit 0).
- What is one thing that such points have not, as a surface or a solid, is no answer (exit 3), with a sentence that says what
  they are. A hull of any dimension is one; of no points there is none. Values are interpolated between points: of none, or of
  points at one place, there are none.
- A command that needs faces says so: `check`, `compare` and `restricted` that the file is not of their kind (exit 2), `subdivide` and
  `simplify` that there is nothing to work on (exit 3).
"""

import re
import subprocess

from brio_cli import BRIO, CliTest, main

SETS = {
    "none": [],
    "one": [(1, 2, 3)],
    "two": [(0, 0, 0), (1, 1, 1)],
    "same": [(1, 2, 3)] * 5,
    "line": [(i, i, i) for i in range(6)],
    "three": [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
    "plane": [(x, y, 0) for x in range(4) for y in range(4)],
}
DIMENSION = {"none": -1, "one": 0, "same": 0, "two": 1, "line": 1, "three": 2, "plane": 2}
DISTINCT = {"none": 0, "one": 1, "two": 2, "same": 1, "line": 6, "three": 3, "plane": 16}

# command line: the exit code of each set, in the order of SETS, and the sentence of a refusal.
SOLID = r"no points, no surface|lie on an area|\d+ distinct points (of dimension \d bound|span) no solid|no inside found|no pole with a cell"
RUNS = {
    "delaunay {p}": ("0000000", None),
    "delaunay {p} --verify": ("0000000", None),
    "delaunay {p} --plane xy": ("0000000", None),
    "delaunay {p} -o {o}.vtu": ("0000000", None),
    "delaunay {p} --tiles 2 --scratch {d} --view {o}.html": ("0000000", None),
    "delaunay {p} --cell 9,9,9 --view {o}.html": ("0000000", None),
    "voronoi {p} --tiles 2 --scratch {d} --view {o}.html": ("3333333", r"no cell ends|their cells are computed without tiles only"),
    "voronoi {p} -o {o}.csv": ("0000000", None),
    "voronoi {p} --box 0,0,0,9,9,9 -o {o}.csv": ("0000000", None),
    "locate {p} --at {p} -o {o}.csv": ("0000000", None),
    "convert {p} -o {o}.xyz": ("0000000", None),
    "convert {p} --thin 0.1 -o {o}.xyz": ("0000000", None),
    "convert {p} --drop-outliers 8 -o {o}.xyz": ("0000000", None),
    "convert {p} --merge -o {o}.ply": ("0000000", None),
    "convert {p} --tiles 3 --scratch {d} -o {o}.vpc": ("0000000", None),
    "convert {p} --tiles 3 --scratch {d} -o {o}.pvtp": ("0000000", None),
    "info {p}": ("0000000", None),
    "interpolate {p} --at {p} --property h -o {o}.csv": ("3303000", r"no points, so no values|all points are at one position"),
    "hull {p} -o {o}.ply": ("3000000", r"no points, so no convex hull"),
    "alpha {p} --alpha auto -o {o}.ply": ("3333333", r"of dimension -?\d have no tetrahedra, so no alpha complex"),
    "alpha {p} --alpha 1 -o {o}.ply": ("3333333", r"of dimension -?\d have no tetrahedra, so no alpha complex"),
    "alpha {p} --alpha 1 --tiles 2 --scratch {d} -o {o}.pvtp": ("3333333", r"of dimension -?\d have no tetrahedra, so no alpha complex"),
    "surface {p} -o {o}.ply": ("3333333", SOLID),
    "surface {p} --tiles 2 --scratch {d} -o {o}.ply": ("3333333", SOLID),
    "surface {p} --curves -o {o}.ply": ("3000003", SOLID),
    "tree {p} -o {o}.ply": ("0000000", None),
    "surface {p} --method power-crust -o {o}.ply": ("3333333", SOLID),
    "surface {p} --method cocone -o {o}.ply": ("3333333", SOLID),
    "surface {p} --method tight-cocone -o {o}.ply": ("3333333", SOLID),
    "medial {p} -o {o}.ply": ("3333333", SOLID),
    "balls {p} -o {o}.ply": ("1111111", r"no radii: expected a property radius or weight, or --weights FILE"),
    "offset {p} --distance 0.1 -o {o}.ply": ("3333333", SOLID),
    "check {p}": ("2222222", r"expected faces or tetrahedra to check, found points only"),
    "compare {p} {p}": ("2222222", r"expected a surface at least once, found no faces"),
    "restricted {p} --surface {p}": ("2222222", r"expected a surface, found no faces"),
    "subdivide {p} -o {o}.ply": ("3333333", r"has no faces"),
    "simplify {p} --faces 4 -o {o}.ply": ("3333333", r"has no faces"),
    "terrain {p} -o {o}.ply": ("3333300", r"points? on the map make no triangle"),
    "view {p} -o {o}.html": ("0000000", None),
    "view {p} --picture {o}.png": ("0000000", None),
}
# read no points
OTHERS = {"generate", "iso"}


class Degenerate(CliTest):
    def points(self, name):
        rows = SETS[name]
        header = ("ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
                  "property double h\nend_header\n" % len(rows))
        return self.file(name + ".ply", header + "".join("%r %r %r %r\n" % (*row, sum(row)) for row in rows))

    def test_every_command_is_here(self):
        help_text = subprocess.run([BRIO, "help"], stdout=subprocess.PIPE, check=True).stdout.decode()
        commands = set(re.findall(r"(?m)^  ([a-z]+)  +\S", help_text.split("\nhelp:")[0]))
        self.assertGreater(len(commands), 10)
        self.assertEqual(commands, {line.split()[0] for line in RUNS} | OTHERS)

    def test_codes_and_sentences(self):
        paths = {name: self.points(name) for name in SETS}
        for line, (codes, sentence) in RUNS.items():
            for (name, path), code in zip(paths.items(), codes):
                with self.subTest("%s: %s" % (line, name)):
                    run = self.expect(int(code), *line.format(p=path, o=self.path("out"), d=self.folder).split())
                    if code != "0":
                        self.assertRegex(run.err, sentence)

    def test_what_such_points_have(self):
        for name, rows in SETS.items():
            with self.subTest(name):
                path, out = self.points(name), self.path("out.csv")
                facts = self.facts("delaunay", path)
                self.assertEqual((facts["dimension"], facts["tetrahedra"]), (DIMENSION[name], 0))
                self.assertEqual(facts["points"] - facts["duplicates"], DISTINCT[name])
                facts = self.facts("voronoi", path, "--box", "-9,-9,-9,9,9,9", "-o", out)
                self.assertEqual(facts["points"], len(rows))
                if rows:  # the cells fill the box
                    self.assertAlmostEqual(facts["volume"] / 18 ** 3, 1, places=12)
                if rows:
                    self.assertEqual(self.facts("hull", path, "-o", self.path("hull.ply"))["dimension"], DIMENSION[name])
                self.assertEqual(self.facts("convert", path, "--merge", "-o", self.path("merged.ply"))["points"],
                                 DISTINCT[name])

    def test_values_at_the_points_are_theirs(self):
        for name in ["two", "line", "three", "plane"]:
            with self.subTest(name):
                path = self.points(name)
                self.expect(0, "interpolate", path, "--at", path, "--property", "h", "-o", self.path("out.csv"))
                with open(self.path("out.csv")) as table:
                    values = [float(line.split(",")[0]) for line in table.read().split("\n")[1:] if line]
                for value, row in zip(values, SETS[name]):
                    self.assertAlmostEqual(value, sum(row), places=12)

    def test_no_points_at_all_for_places(self):
        """Sixteen values that are no numbers, and exit code 0."""
        run = self.expect(3, "interpolate", self.points("none"), "--at", self.points("plane"), "--property", "h", "-o",
                          self.path("out.csv"))
        self.assertIn("no points, so no values to interpolate between", run.err)


if __name__ == "__main__":
    main()
