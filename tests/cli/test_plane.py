"""brio delaunay --plane: facts, planes, weights, output; the triangles of 20 sets without ties against scipy's."""

import unittest

from brio_cli import CliTest, COMMON_FACTS, count, main, number

try:
    import numpy
    from scipy.spatial import Delaunay
except ImportError:
    Delaunay = None


class Usage(CliTest):
    def test_options_of_tetrahedra(self):
        points = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
        for more in ["--locate", "jump"], ["--rounds"], ["--record-every", "9"]:
            self.usage("--plane goes with", "delaunay", points, "--plane", "xy", *more)
        self.usage("xy, yz, zx|plane", "delaunay", points, "--plane", "xz")
        self.usage("cannot hold", "delaunay", points, "--plane", "xy", "-o", "out.node")

    def test_memory_is_estimated(self):
        points = self.cloud("a.ply", 200000)
        run = self.expect(4, "delaunay", points, "--plane", "xy", "--max-memory", "20M")
        self.assertRegex(run.err, "memory")
        self.assertEqual(self.facts("delaunay", points, "--plane", "xy", "--max-memory", "60M")["points"], 200000)


class Orders(CliTest):
    def test_triangles_do_not_depend_on_the_order(self):
        """The counters do: random points far from each other are found by longer walks than along a curve."""
        points, found = self.cloud("a.ply", 3000), {}
        for order in ("brio", "brio-octree", "brio-kdtree", "octree", "hilbert", "random", "input"):
            facts = self.facts("delaunay", points, "--plane", "xy", "--order", order, "--verify")
            self.assertTrue(facts["verified"])
            found[order] = facts
        self.assertEqual(len({facts["checksum"] for facts in found.values()}), 1)
        self.assertGreater(len({facts["created"] for facts in found.values()}), 4)
        self.assertGreater(found["random"]["walk_steps"], 4 * found["brio"]["walk_steps"])
        again = self.facts("delaunay", points, "--plane", "xy", "--order", "random", "--seed", "7")
        self.assertEqual(again["checksum"], found["random"]["checksum"])
        self.assertNotEqual(again["created"], found["random"]["created"])
        halves = self.facts("delaunay", points, "--plane", "xy", "--order", "brio-octree", "--block-size", "9", "--round-ratio", "0.3")
        self.assertNotEqual(halves["created"], found["brio-octree"]["created"])
        self.usage("--round-ratio: the insertion order has no rounds", "delaunay", points, "--plane", "xy", "--order", "hilbert",
                   "--round-ratio", "0.5")


class TriangleTest(CliTest):
    def triangles(self, name):
        with open(self.path(name), encoding="ascii") as f:
            words = " ".join(line for line in f if not line.startswith("#")).split()
        points, faces = int(words[1]), int(words[2])
        rest = words[4 + 3 * points:]
        self.assertEqual(rest[::4], ["3"] * faces)
        return [tuple(map(int, rest[i + 1:i + 4])) for i in range(0, 4 * faces, 4)]


class Facts(TriangleTest):
    def test_facts_of_a_run(self):
        keys = ("points vertices duplicates hidden triangles hull_edges created destroyed walk_steps incircle_calls "
                "exact_calls").split()
        facts = self.facts("delaunay", self.cloud("a.ply", 2000), "--plane", "yz", "-o", self.path("out.vtu"),
                           "--verify")
        self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in keys}, "dimension": int,
                                   "seconds": {key: number for key in "read order insert write total".split()}})
        self.assertRegex(facts["checksum"], r"\A[0-9a-f]{16}\Z")
        self.assertIs(facts["verified"], True)
        self.assertEqual(facts["triangles"] + 2 + facts["hull_edges"], 2 * facts["vertices"])
        self.assertEqual(facts["created"] - facts["destroyed"], facts["triangles"] + facts["hull_edges"])
        self.assertNotIn("tetrahedra", facts)

    def test_planes_and_their_orientation(self):
        a, b, c = (0, 0, 7), (2, 0, 1), (0, 1, 5)
        turned = {"xy": [a, b, c], "yz": [(p[2], p[0], p[1]) for p in (a, b, c)],
                  "zx": [(p[1], p[2], p[0]) for p in (a, b, c)]}
        for plane, points in turned.items():
            self.expect(0, "delaunay", self.xyz("a.xyz", points), "--plane", plane, "-o", self.path("a.off"))
            (triangle,) = self.triangles("a.off")
            first = triangle.index(0)
            self.assertEqual(triangle[first:] + triangle[:first], (0, 1, 2), plane)

    def test_weights_hide_points(self):
        points = self.xyz("a.xyz", [(0, 0, 0), (4, 0, 1), (0, 4, 2), (1, 1, 3)])
        facts = self.facts("delaunay", points, "--plane", "xy", "--weights", self.file("w", "9\n9\n9\n0\n"), "--verify")
        self.assertEqual((facts["weighted"], facts["hidden"], facts["triangles"]), (True, 1, 1))

    def test_points_without_triangles(self):
        for points, dimension in [([], -1), ([(1, 2, 3)] * 3, 0), ([(i, 2 * i, i * i) for i in range(5)], 1)]:
            facts = self.facts("delaunay", self.xyz("a.xyz", points), "--plane", "xy", "--verify")
            self.assertEqual((facts["dimension"], facts["triangles"], facts["verified"]), (dimension, 0, True))


def sets_without_ties():
    """name: #P by 2 of random doubles, whose four points are never on a circle."""
    for seed in range(20):
        random_ = numpy.random.default_rng(seed)
        n = [50, 500, 2000, 5000][seed % 4]
        points = random_.random((n, 2))
        if seed % 5 == 1:
            points = random_.normal(size=(n, 2))
        elif seed % 5 == 2:
            points = points * [1000, 1] + [1e4, -3]
        elif seed % 5 == 3:
            points = random_.random((n, 2)) * 10.0 ** -random_.integers(0, 4, (n, 1)) + random_.integers(0, 3, (n, 2))
        elif seed % 5 == 4:
            angle = random_.random(n) * 6.283
            points = (1 + 0.1 * random_.random((n, 1))) * numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1)
        yield "%d points, seed %d" % (n, seed), points


@unittest.skipIf(Delaunay is None, "there is no scipy")
class Scipy(TriangleTest):
    def test_twenty_sets_without_ties(self):
        for name, points in sets_without_ties():
            rows = numpy.column_stack([points, numpy.zeros(len(points))]).tolist()
            self.expect(0, "delaunay", self.xyz("a.xyz", rows), "--plane", "xy", "-o", self.path("a.off"), "--verify")
            ours = {tuple(sorted(t)) for t in self.triangles("a.off")}
            theirs = {tuple(sorted(map(int, t))) for t in Delaunay(points).simplices}
            self.assertEqual(ours, theirs, name)


if __name__ == "__main__":
    main()
