"""brio alpha: alpha shapes and the alpha filtration."""

import math

from brio_cli import CERTIFICATE, CliTest, COMMON_FACTS, count, CUBE, main, number


class Alpha(CliTest):
    def test_facts_of_a_run(self):
        points, out = self.cloud("a.ply", 1000, "ball"), self.path("out.ply")
        seconds = {key: number for key in "read delaunay values filtration shape certify write total".split()}
        counts = "samples tetrahedra vertices faces uncovered".split()
        internals = "simplices split singular_vertices singular_edges singular_facets".split()
        facts = self.facts("alpha", points, "--alpha", "auto", "--filtration", self.path("f.txt"), "-o", out)
        self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in counts}, "method": str, "alpha": number,
                                   "radius": number, "certificate": CERTIFICATE, "seconds": seconds,
                                   "internals": {key: count for key in internals}})
        self.assertTrue(facts["certificate"]["closed"] and facts["certificate"]["manifold"])
        self.assertEqual(facts["uncovered"], 0)
        self.assertAlmostEqual(facts["radius"] ** 2, facts["alpha"])
        with open(self.path("f.txt")) as lines:
            rows = [line.split() for line in lines]
        self.assertEqual(len(rows), facts["internals"]["simplices"])
        values = [float(row[-1]) for row in rows]
        self.assertEqual(values, sorted(values))
        seen = set()
        for row in rows:
            simplex = tuple(map(int, row[1:-1]))
            self.assertEqual(len(simplex), int(row[0]) + 1)
            for i in range(len(simplex)):
                self.assertTrue(len(simplex) == 1 or simplex[:i] + simplex[i + 1:] in seen, simplex)
            seen.add(simplex)
        less = self.facts("alpha", points, "--alpha", facts["alpha"] * (1 - 1e-9), "-o", out)
        self.assertTrue(less["uncovered"] > 0 or less["certificate"]["components"] > 1)

    def test_edges_for_ripser(self):
        run = self.facts("alpha", self.xyz("a.xyz", CUBE), "--alpha", "1", "--filtration", self.path("f.sparse"))
        with open(self.path("f.sparse")) as lines:
            rows = [line.split() for line in lines]
        self.assertEqual(set(map(len, rows)), {3})
        self.assertEqual(run["samples"], 8)
        self.assertEqual([float(row[2]) for row in rows][:12], [0.25] * 12)

    def test_weights(self):
        points = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
        weights = self.file("w.txt", "0.25\n0\n0\n0\n")
        self.facts("alpha", points, "-A", "1", "--weights", weights, "--filtration", self.path("f.txt"))
        with open(self.path("f.txt")) as lines:
            self.assertEqual(lines.readline(), "0 0 -0.25\n")

    def scaled(self, path, exponent):
        """A copy of a file of points, times 2^exponent."""
        with open(path) as lines:
            rows = [[math.ldexp(float(x), exponent) for x in line.split()] for line in lines if line[0] != "#"]
        return self.xyz(f"scaled{exponent}.xyz", rows)

    def test_radii_beyond_doubles_are_refused(self):
        points, out = self.cloud("a.xyz", 300, "sphere"), self.path("out.ply")
        usual = self.facts("alpha", points, "--alpha", "auto", "-o", out)
        for exponent in (-500, 505):
            facts = self.facts("alpha", self.scaled(points, exponent), "--alpha", "auto", "-o", out)
            self.assertEqual([facts[key] for key in ("vertices", "faces", "tetrahedra")],
                             [usual[key] for key in ("vertices", "faces", "tetrahedra")])
            self.assertEqual(facts["alpha"], math.ldexp(usual["alpha"], 2 * exponent))
        for exponent in (-560, -530, 515):
            run = self.expect(3, "alpha", self.scaled(points, exponent), "--alpha", "auto", "-o", out)
            self.assertIn("beyond doubles: scale the points", run.err)
        self.expect(3, "alpha", self.scaled(points, -560), "--alpha", "0", "-o", out)

    def test_filtration_beyond_doubles_is_warned_of(self):
        cube = [[math.ldexp(x, 520) for x in row] for row in CUBE]
        run = self.expect(3, "alpha", self.xyz("a.xyz", cube), "-A", "1", "--filtration", self.path("f.txt"))
        self.assertIn("squared radii in the filtration are beyond doubles", run.err)
        run = self.expect(0, "alpha", self.xyz("b.xyz", CUBE), "-A", "1", "--filtration", self.path("g.txt"))
        self.assertNotIn("beyond doubles", run.err)

    def test_wrong_usage_and_no_answer(self):
        points = self.xyz("a.xyz", CUBE)
        self.usage("--alpha", "alpha", points, "-o", self.path("x.ply"))
        self.usage("'wide'", "alpha", points, "--alpha", "wide", "-o", self.path("x.ply"))
        run = self.expect(3, "alpha", points, "--alpha", "0.1", "-o", self.path("x.ply"))
        self.assertIn("alpha = 0.1", run.err)
        flat = self.xyz("b.xyz", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
        self.assertIn("dimension 2", self.expect(3, "alpha", flat, "-A", "auto", "-o", self.path("x.ply")).err)
        self.assert_only(self.folder, "a.xyz", "b.xyz")


if __name__ == "__main__":
    main()
