"""brio delaunay and voronoi --cell: points in space that repeats."""

import json
import os
import random
import re

from brio_cli import CliTest, main

FCC = "0,2.025,2.025,2.025,0,2.025,2.025,2.025,0"


def rows(path):
    with open(path) as f:
        lines = f.read().splitlines()
    names = lines[0].split(",")
    return [dict(zip(names, map(float, line.split(",")))) for line in lines[1:]]


class Periodic(CliTest):
    def points(self, n, seed=1):
        rng = random.Random(seed)
        return [tuple(rng.randrange(1 << 20) / (1 << 20) for _ in range(3)) for _ in range(n)]

    def test_usage(self):
        points = self.xyz("a.xyz", [(0, 0, 0)])
        for command in [("delaunay",), ("voronoi", "-o", self.path("x.csv"))]:
            self.usage("--periodic without --cell, but .*a.xyz has no cell", *command, points, "--periodic", "xy")
            for cell in ["1,1", "1,1,1,", "1,1,1,1,1,1,1,1,1,1", "1,x,1", "1,1,inf"]:
                self.usage("is neither ax,ay,az", *command, points, "--cell", cell)
            for directions in ["xw", "x y"]:
                self.usage("is not made of the letters", *command, points, "--cell", "1,1,1", "--periodic", directions)
        self.usage("not with --plane", "delaunay", points, "--cell", "1,1,1", "--plane", "xy")
        self.usage("span no volume", "delaunay", points, "--cell", "1,1,0")
        self.usage("span no volume", "delaunay", points, "--cell", "1e-140,1e-140,0")
        for side, words in (("1e-140", "too short: their greatest coordinate is 1e-140"), ("1e140", "too long: their greatest")):
            self.usage(words, "delaunay", points, "--cell", ",".join([side] * 3))
        self.expect(0, "delaunay", points, "--cell", "1e100,1e100,1e100")

    def test_one_atom_of_a_lattice(self):
        points, out, faces = self.xyz("a.xyz", [(0, 0, 0)]), self.path("cells.csv"), self.path("faces.csv")
        facts = self.facts("voronoi", points, "--cell", FCC, "-o", out, "--faces", faces)
        self.assertEqual((facts["cells"], facts["bounded"], facts["faces"]), (1, 1, 12))
        self.assertAlmostEqual(facts["volume"], 2 * 2.025 ** 3, 11)
        self.assertEqual(rows(out)[0]["faces"], 12)
        shifts = {tuple(row["shift_" + k] for k in "abc") for row in rows(faces)}
        self.assertEqual(len(shifts), 12)
        self.assertEqual({row["neighbour"] for row in rows(faces)}, {0})

    def test_the_cell_of_a_file(self):
        cell, rows = "2 0 0 1 2 0 0 0 3", [(0.25, 0.5, 1), (1.5, 1, 2)]
        lattice = "%s,%s,%s,%s,%s,%s,%s,%s,%s" % tuple(cell.split())
        positions = "\n".join("%g %g %g" % row for row in rows)
        files = [self.file("a.extxyz", "2\nLattice=\"%s\" pbc=\"T T F\"\n%s\n" % (cell, "\n".join("C %g %g %g" % r for r in rows))),
                 self.file("POSCAR", "c\n1\n2 0 0\n1 2 0\n0 0 3\nC\n2\nCartesian\n%s\n" % positions),
                 self.file("a.dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS xy xz yz pp pp ff\n0 3 1\n0 2 0\n0 3 0\n"
                           "ITEM: ATOMS x y z\n%s\n" % positions)]
        wanted = self.facts("delaunay", self.xyz("a.xyz", rows), "--cell", lattice)
        for name in files:
            run = self.expect(0, "delaunay", name, "--unweighted", "--json")
            letters = "xyz" if name.endswith("POSCAR") else "xy"
            self.assertIn("has a cell, which is not used: --periodic %s lets" % letters, run.err, name)
            facts = self.facts("delaunay", name, "--periodic", "xyz", "--unweighted")
            for key in "checksum", "tetrahedra", "cell_volume":
                self.assertEqual(facts[key], wanted[key], name)
            self.assertEqual(self.facts("info", name)["metadata"]["cell.periodic"], letters)

    def test_cells_fill_the_box(self):
        points, out = self.xyz("a.xyz", self.points(300)), self.path("cells.csv")
        facts = self.facts("voronoi", points, "--cell", "1,1,1", "-o", out)
        self.assertAlmostEqual(sum(row["volume"] for row in rows(out)), 1, 12)
        self.assertEqual(facts["bounded"], 300)
        slab = self.facts("voronoi", points, "--cell", "1,1,1", "--periodic", "xy", "--box", "0,0,-1,1,1,3")
        self.assertAlmostEqual(slab["volume"], 4, 12)

    def test_translates_do_not_matter(self):
        points = self.points(100)
        first = self.facts("delaunay", self.xyz("a.xyz", points), "--cell", "1,1,1", "--verify")
        self.assertTrue(first["verified"])
        moved = [(x + i % 3 - 1, y + 0.25, z - i % 5) for i, (x, y, z) in enumerate(points)]
        random.Random(2).shuffle(moved)
        other = self.facts("delaunay", self.xyz("b.xyz", moved), "--cell", "1,0,0,7,1,0,-3,5,1")
        self.assertEqual([first[k] for k in ("checksum", "tetrahedra")], [other[k] for k in ("checksum", "tetrahedra")])

    def test_places_in_any_cell(self):
        """The nearest vertex against all translates; places of one class have one tetrahedron, and shifts that differ as they do."""
        points, places = self.points(40), [(x - 1.5, 3 * y, z + 4) for x, y, z in self.points(50, seed=3)]
        moved = [(x + 2, y - 3, z + 1) for x, y, z in places]
        out, at = self.path("out.csv"), self.xyz("at.xyz", places + moved)
        facts = self.facts("locate", self.xyz("a.xyz", points), "--at", at, "--cell", "1,1,1", "-o", out)
        self.assertEqual((facts["inside"], facts["outside"]), (100, 0))
        found = rows(out)
        for first, other, place in zip(found[:50], found[50:], places):
            self.assertEqual(first["tetrahedron"], other["tetrahedron"])
            shifts = [tuple(row[name + k] for k in "abc") for row in (first, other) for name in ("shift_", "vertex_shift_")]
            for i in range(2):
                self.assertEqual(tuple(b - a for a, b in zip(shifts[i], shifts[2 + i])), (2, -3, 1))
            distance = lambda p, s: sum((x + d - q) ** 2 for x, d, q in zip(p, s, place))
            least = min(sum(min((x - q + d) % 1, (q - x - d) % 1) ** 2 for x, d, q in zip(p, (0, 0, 0), place)) for p in points)
            self.assertAlmostEqual(distance(points[int(first["vertex"])], shifts[1]), least, 12)
        slab = self.facts("locate", self.path("a.xyz"), "--at", at, "--cell", "1,1,1", "--periodic", "xy", "-o", out)
        self.assertEqual((slab["inside"], slab["outside"]), (0, 100))
        self.assertEqual({row["tetrahedron"] for row in rows(out)}, {-1})
        self.usage("--plane: not in space that repeats", "locate", self.path("a.xyz"), "--at", at, "--cell", "1,1,1", "--plane", "xy",
                   "-o", out)

    def test_surfaces_that_repeat(self):
        """A grid without one point has a hole, at the border of the cell as in its middle; the filtration is that of the torus."""
        grid = [(x, y, z) for x in range(4) for y in range(4) for z in range(4)]
        out, values = self.path("out.ply"), self.path("values.txt")
        for hole in [(0, 0, 0), (2, 1, 2)]:
            points = self.xyz("a.xyz", [p for p in grid if p != hole])
            facts = self.facts("alpha", points, "--cell", "4,4,4", "--alpha", "0.75", "-o", out, "--filtration", values)
            self.assertEqual((facts["faces"], facts["surfaces"], facts["euler"], facts["tetrahedra"]), (8, 1, 2, facts["tetrahedra"]))
            self.assertAlmostEqual(facts["volume"], 64 - 4 / 3, 12)
            self.assertEqual(facts["cell"], [4, 0, 0, 0, 4, 0, 0, 0, 4])
            with open(values) as f:
                lines = [line.split() for line in f]
            self.assertEqual(sum((-1) ** int(line[0]) for line in lines), 0)
            self.assertEqual(len({tuple(line[1:-1]) for line in lines}), len(lines))
            self.assertTrue({"point", "shift_a", "sheet"} <= set(self.facts("info", out)["properties"]))
        self.expect(3, "alpha", self.xyz("b.xyz", grid[:2]), "--cell", "4,4,4", "--alpha", "1", "--filtration", values, "-o", out)
        self.usage("has no cell", "alpha", points, "--periodic", "xyz", "--alpha", "1", "-o", out)

    def test_what_is_shown_are_the_tetrahedra_of_the_output(self):
        points, cell = self.xyz("atoms.xyz", [(x + 0.1 * y, y, z) for x in range(3) for y in range(3) for z in range(3)]), ("--cell", "3,3,3")
        facts = self.facts("delaunay", points, *cell, "-o", self.path("x.vtu"), "--view", self.path("x.html"), "--picture", self.path("x.png"), "--picture-size", "60x40")
        written = self.facts("info", self.path("x.vtu"))
        with open(self.path("x.html"), encoding="utf-8") as f:
            layer = json.loads(re.search(r'class="layer">(.*?)</script>', f.read()).group(1))
        self.assertEqual((layer["tetrahedra"], layer["vertices"]), (facts["tetrahedra"], written["points"]))
        self.assertEqual([p["name"] for p in layer["properties"]], ["point", "shift_a", "shift_b", "shift_c"])
        self.assertEqual(self.facts("delaunay", points, *cell, "--view", self.path("y.html"))["checksum"], facts["checksum"])
        self.assertEqual(os.path.getsize(self.path("x.png")), facts["picture"]["bytes"])

    def test_memory_is_estimated(self):
        points = self.xyz("a.xyz", self.points(20000))
        for command, least in [(("delaunay",), 15), (("voronoi", "-o", self.path("x.csv")), 45), (("alpha", "--alpha", "auto", "-o", self.path("x.ply")), 35),
                               (("locate", "--at", points, "-o", self.path("x.csv")), 15)]:
            run = self.expect(4, command[0], points, *command[1:], "--cell", "1,1,1", "--max-memory", "4M")
            needed = re.search("about ([0-9.]+) MiB", run.err)
            self.assertTrue(needed and least < float(needed[1]) < 2 * least, run.err)

    def test_output_names_points_and_translates(self):
        points, out = self.xyz("a.xyz", self.points(20)), self.path("out.vtu")
        facts = self.facts("delaunay", points, "--cell", "1,1,1", "-o", out)
        info = self.facts("info", out)
        self.assertEqual(info["tetrahedra"], facts["tetrahedra"])
        self.assertTrue({"point", "shift_a", "shift_b", "shift_c"} <= set(info["properties"]), info)


if __name__ == "__main__":
    main()
