"""brio tree: Euclidean minimum spanning trees against Prim's algorithm over all pairs, in space and in a plane."""

import math
import random
import re

from brio_cli import CliTest, main


def prim(points):
    """The length of the minimum spanning tree."""
    points = sorted(set(points))
    near = {p: math.inf for p in points[1:]}
    at, total = points[0], 0.0
    while near:
        for p in near:
            near[p] = min(near[p], math.dist(p, at))
        at = min(near, key=lambda p: (near[p], p))
        total += near.pop(at)
    return total


class Tree(CliTest):
    def tree_of(self, points, *options):
        out = self.path("t.ply")
        facts = self.facts("tree", self.xyz("t.xyz", points), "-o", out, "--ascii", *options)
        with open(out, encoding="ascii") as file:
            header, body = file.read().split("end_header\n")
        n, m = (int(re.search(r"element %s (\d+)" % name, header).group(1)) for name in ("vertex", "edge"))
        rows = [line.split() for line in body.splitlines()]
        place = [tuple(float(x) for x in row[:3]) for row in rows[:n]]
        edges = [(place[int(row[0])], place[int(row[1])]) for row in rows[n:n + m]]
        self.assertEqual((facts["vertices"], facts["edges"]), (n, m))
        return facts, edges

    def expect_tree(self, points, *options, flat=lambda p: p):
        facts, edges = self.tree_of(points, *options)
        want = prim([flat(p) for p in points])
        self.assertAlmostEqual(facts["length"], want, delta=1e-9 * want)
        self.assertAlmostEqual(sum(math.dist(flat(a), flat(b)) for a, b in edges), want, delta=1e-6 * want)
        parent = {flat(p): flat(p) for p in points}

        def find(p):
            while parent[p] != p:
                p = parent[p]
            return p
        for a, b in edges:
            self.assertNotEqual(find(flat(a)), find(flat(b)), "a cycle")
            parent[find(flat(a))] = find(flat(b))
        self.assertEqual(len({find(p) for p in parent}), 1)
        lengths = [math.dist(flat(a), flat(b)) for a, b in edges]
        self.assertTrue(all(a <= b * (1 + 1e-12) for a, b in zip(lengths, lengths[1:])), "the shortest first")
        return edges

    def test_least_length(self):
        rng = random.Random(4)
        self.expect_tree([tuple(rng.random() for _ in range(3)) for _ in range(150)])
        self.expect_tree([(rng.random(), rng.random(), 7.0) for _ in range(150)])
        self.expect_tree([(float(rng.randrange(5)), float(rng.randrange(5)), float(rng.randrange(3))) for _ in range(90)])
        self.expect_tree([(3.0 * x, 2.0 * x, x / 4) for x in rng.sample(range(100), 20)])

    def test_plane_takes_two_coordinates(self):
        rng = random.Random(5)
        points = [tuple(rng.random() for _ in range(3)) for _ in range(120)]
        for plane, off in (("xy", 2), ("yz", 0), ("zx", 1)):
            edges = self.expect_tree(points, "--plane", plane, flat=lambda p: p[:off] + (0.0,) + p[off + 1:])
            self.assertLessEqual({p for edge in edges for p in edge}, {tuple(map(float, p)) for p in points})

    def test_ties_do_not_depend_on_the_order(self):
        grid = [(x / 10, y / 10, z / 10) for x in range(5) for y in range(5) for z in range(4)]
        _, first = self.tree_of(grid)
        random.Random(6).shuffle(grid)
        self.assertEqual(self.tree_of(grid)[1], first)

    def test_few_points_and_reports(self):
        for points, edges in (([(1, 2, 3)], 0), ([(1, 2, 3)] * 4, 0), ([(0, 0, 0), (3, 4, 0)], 1)):
            facts = self.facts("tree", self.xyz("f.xyz", points))
            self.assertEqual((facts["edges"], facts["length"]), (edges, 5.0 * edges))
        self.assertEqual(self.facts("tree", self.file("e.xyz", ""))["edges"], 0)
        self.usage("cannot hold|this version writes", "tree", self.path("f.xyz"), "-o", self.path("o.stl"))


if __name__ == "__main__":
    main()
