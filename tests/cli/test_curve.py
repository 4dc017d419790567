"""brio surface of points in a plane: curves, against scenes whose truth is known, and what is refused."""

import math
import random
import re

from brio_cli import CliTest, main
from planar_curves import scenes

FIFTY = 50
RIGHT = 0.95


def turned(points, offset=(3.0, -2.0, 5.0)):
    """The points in a slanting plane."""
    u, v = (0.48, 0.6, 0.64), (0.8, -0.6, 0.0)
    return [tuple(o + x * a + y * b for o, a, b in zip(offset, u, v)) for x, y in points]


class Curves(CliTest):
    def read(self, path):
        """The pairs of samples that edges join; keeps the properties of the vertices."""
        with open(path, encoding="ascii") as file:
            header, body = file.read().split("end_header\n")
        vertices, edges = (int(re.search(r"element %s (\d+)" % name, header).group(1)) for name in ("vertex", "edge"))
        names = re.findall(r"property \w+ (\w+)", header.split("element edge")[0])
        rows = [line.split() for line in body.splitlines()]
        self.properties = {name: [float(row[k]) for row in rows[:vertices]] for k, name in enumerate(names)}
        sample = self.properties["sample"]
        return [(int(sample[int(row[0])]), int(sample[int(row[1])])) for row in rows[vertices:vertices + edges]]

    def curves_of(self, points, *options):
        source, out = self.xyz("c.xyz", [(*p, 0)[:3] for p in points]), self.path("c.ply")
        facts = self.facts("surface", source, "-o", out, "--ascii", *options)
        return facts, self.read(out)

    def is_right(self, name, scene, points):
        facts, joined = self.curves_of(points)
        c = facts["certificate"]
        self.assertEqual(facts["method"], "curves")
        self.assertTrue(c["manifold"])
        self.assertEqual((c["branches"], c["self_intersections"]), (0, 0), name)
        self.assertEqual(sum(self.properties["corner"]) >= c["corners"], True, name)
        self.assertEqual(max(self.properties["curve"]) + 1, c["components"], name)
        links = {tuple(sorted(pair)) for pair in joined}
        return (links == scene.links and (c["components"], c["loops"], c["ends"], c["corners"], c["isolated"], c["closed"]) ==
                (scene.curves, scene.closed, scene.ends, scene.corners, 0, scene.ends == 0))

    def test_fifty_scenes_link_by_link(self):
        wrong = [name for name, scene in scenes(FIFTY) if not self.is_right(name, scene, scene.points)]
        self.assertLessEqual(len(wrong), (1 - RIGHT) * FIFTY, wrong)

    def test_slanting_planes(self):
        wrong = [name for name, scene in scenes(12, seed=2) if not self.is_right(name, scene, turned(scene.points))]
        self.assertEqual(wrong, [])

    def test_edges_go_along_the_curves(self):
        _, scene = next(scenes(1))
        _, joined = self.curves_of(scene.points)
        for (_, b), (c, _) in zip(joined, joined[1:]):
            self.assertEqual(b, c)
        self.assertEqual(joined[-1][1], joined[0][0])

    def test_open_and_closed(self):
        arc = [(math.cos(0.05 * i), math.sin(0.05 * i)) for i in range(100)]  # 5 of 6.28 radians
        gap = 2 * math.sin((2 * math.pi - 4.95) / 2) / (2 * math.sin(0.025))
        ends = lambda *options: self.curves_of(arc, *options)[0]["certificate"]["ends"]
        self.assertEqual((ends(), ends("--open", "auto"), ends("--closed"), ends("--open", "0")), (2, 2, 0, 0))
        self.assertEqual((ends("--open", gap * 0.9), ends("--open", gap * 1.1)), (2, 0))
        self.usage("--open: 0.5 is under 1", "surface", self.path("c.xyz"), "-o", self.path("o.ply"), "--curves", "--open", "0.5")

    def test_properties_of_points(self):
        rows = [(math.cos(0.1 * i), math.sin(0.1 * i), 0, i) for i in range(63)]
        text = ("ply\nformat ascii 1.0\nelement vertex 63\n" + "".join("property double %s\n" % n for n in ("x", "y", "z", "h")) +
                "end_header\n" + "".join("%r %r %r %r\n" % row for row in rows))
        self.expect(0, "surface", self.file("p.ply", text), "-o", self.path("q.ply"), "--ascii", "--quiet")
        self.read(self.path("q.ply"))
        self.assertEqual(self.properties["h"], [float(i) for i in range(63)])

    def test_what_makes_no_curve(self):
        out = self.path("o.ply")
        grid = self.xyz("grid.xyz", [(x, y, 0) for x in range(20) for y in range(20)])
        facts = self.facts("surface", grid, "-o", out, code=3)
        self.assertIn("on an area", facts["error"])
        self.assertTrue(any("--plane xy" in hint for hint in facts["hints"]))
        ball = self.xyz("ball.xyz", self.sphere(300))
        self.assertIn("not in a plane", self.facts("surface", ball, "--curves", "-o", out, code=3)["error"])
        self.assertEqual(self.facts("surface", ball, "-o", out)["method"], "labeled-delaunay")
        ring = self.xyz("ring.xyz", [(math.cos(i / 8), math.sin(i / 8), 0) for i in range(51)])
        self.usage("--noise is for --method labeled-delaunay or power-crust, and the method is curves",
                   "surface", ring, "-o", out, "--noise", "smooth")
        self.usage("--left-out is for", "surface", ring, "-o", out, "--curves", "--left-out", self.path("l.ply"))
        self.usage("exclude each other", "surface", ring, "-o", out, "--curves", "--method", "cocone")
        for name in ("o.stl", "o.off", "o.obj"):
            self.usage("cannot hold edges", "surface", ring, "-o", self.path(name))
        self.assertIn("--curves", " ".join(self.facts("surface", ring, "-o", out, "--method", "cocone", code=3)["hints"]))
        for name in ("o.vtp", "o.vtu", "o.vtk", "o.glb"):
            self.expect(0, "surface", ring, "-o", self.path(name), "--quiet")

    def test_power_crusts(self):
        """Rings have the links of their samples and a shape of the right Euler characteristic; others are closed, too."""
        ring = [(r * math.cos(2 * math.pi * i / n), r * math.sin(2 * math.pi * i / n)) for r, n in ((1, 90), (0.4, 50)) for i in range(n)]
        for points in (ring, turned(ring)):
            facts, joined = self.curves_of(points, "--method", "power-crust")
            c = facts["certificate"]
            self.assertEqual((facts["method"], facts["labeling"], facts["edges"]), ("power-crust", "greedy", 140))
            self.assertEqual((c["closed"], c["manifold"], c["components"], c["loops"], c["isolated"]), (True, True, 2, 2, 0))
            self.assertEqual({tuple(sorted(pair)) for pair in joined},
                             {tuple(sorted((first + i, first + (i + 1) % n))) for first, n in ((0, 90), (90, 50)) for i in range(n)})
            shape = self.facts("medial", self.path("c.xyz"), "-o", self.path("m.ply"), "--crust", self.path("k.ply"))
            self.assertEqual((shape["vertices"], shape["edges"], shape["labeling"]), (facts["internals"]["inner"], shape["vertices"], "greedy"))
            self.assertEqual(self.facts("check", self.path("k.ply"))["certificate"]["loops"], 2)
        facts, _ = self.curves_of([(0.05 * i, 0.3 * math.sin(0.3 * i)) for i in range(60)], "--method", "power-crust")
        self.assertTrue(facts["certificate"]["closed"])
        out = self.path("o.ply")
        for option in (["--sharp"], ["--labeling", "naive"], ["--open", "3"]):
            self.usage("is for points in space", "surface", self.path("c.xyz"), "-o", out, "--method", "power-crust", *option)
        grid = self.xyz("grid.xyz", [(x, y, 0) for x in range(20) for y in range(20)])
        for command in (["surface", grid, "--method", "power-crust"], ["medial", grid]):
            self.assertIn("on an area", self.facts(*command, "-o", out, code=3)["error"])
        ball = self.xyz("ball.xyz", self.sphere(300))
        self.assertEqual(self.facts("surface", ball, "--method", "power-crust", "-o", out)["certificate"]["genus"], 0)

    def test_check_tells_closed_curves_from_others(self):
        def edges(name, count, pairs):
            rows = "".join("%r %r 0\n" % (math.cos(i), math.sin(i)) for i in range(count)) + "".join("%d %d\n" % p for p in pairs)
            return self.file(name, "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
                             "element edge %d\nproperty int vertex1\nproperty int vertex2\nend_header\n%s" % (count, len(pairs), rows))
        ring, star = [(i, (i + 1) % 5) for i in range(5)], [(0, 1), (0, 2), (0, 3)]
        c = self.facts("check", edges("ring.ply", 5, ring))["certificate"]
        self.assertEqual((c["closed"], c["manifold"], c["loops"], c["ends"], c["branches"]), (True, True, 1, 0, 0))
        path = edges("path.ply", 5, ring[:3])
        facts = self.facts("check", path, code=5)
        self.assertIn("not closed: 2 ends in 1 of 1 curves", facts["error"])
        self.assertTrue(any("--open" in hint for hint in facts["hints"]))
        self.assertEqual(self.facts("check", path, "--open")["certificate"]["isolated"], 1)
        for options in [], ["--open"]:
            self.assertIn("branch: 1 vertices", self.facts("check", edges("star.ply", 4, star), *options, code=5)["error"])
        self.assertIn("index 9", self.facts("check", edges("bad.ply", 4, [(0, 9)]), code=2)["error"])
        self.usage("--self-intersections is about faces", "check", path, "--self-intersections")

    def test_thin_is_flat(self):
        """Single precision leaves a slanting plane by 1e-7 of the extent, and a surface by more is none."""
        ring = turned([(math.cos(i / 8), math.sin(i / 8)) for i in range(51)], (0, 0, 0))
        facts, _ = self.curves_of([tuple(round(x, 7) for x in p) for p in ring])
        self.assertEqual(facts["certificate"]["loops"], 1)
        thick = self.xyz("t.xyz", [(x, y, z + 1e-4 * (i % 3)) for i, (x, y, z) in enumerate(ring)])
        self.assertIn("not in a plane", self.facts("surface", thick, "--curves", "-o", self.path("o.ply"), code=3)["error"])

    def test_points_with_few_of_them_off_a_plane_were_refused_as_curves(self):
        """Strays leave all points of a sample in one plane, up to their extent; so do low hills."""
        rng = random.Random(3)
        ball = [[rng.gauss(0, 1) for _ in range(3)] for _ in range(640)]
        ball = [[x / sum(y * y for y in p) ** 0.5 for x in p] for p in ball]
        ball[0], ball[10], ball[20] = [1e6, 0, 0], [0, 1e6, 0], [1e6, 1e6, 3]  # each is in the sample
        hills = [(x, y, 0.001 * math.sin(x) * math.cos(y)) for x in range(30) for y in range(30)]
        for name, points in (("ball.xyz", ball), ("hills.xyz", hills)):
            for options, end in (["--noise", "smooth"], "ply"), (["--simplify"], "vtp"), ([], "off"):
                facts = self.facts("surface", self.xyz(name, points), *options, "-o", self.path("o." + end))
                self.assertEqual(facts["method"], "labeled-delaunay")


if __name__ == "__main__":
    main()
