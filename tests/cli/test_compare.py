"""brio compare: distances of two surfaces."""

import json
import re

from brio_cli import CliTest, COMMON_FACTS, CUBE, main, number, OCTAHEDRON, OCTAHEDRON_FACES


class Compare(CliTest):
    def test_facts_of_a_run(self):
        a = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        b = self.off("b.off", [(2 * x, 2 * y, 2 * z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        facts = self.facts("compare", a, b, "--samples", "1000")
        keys = "mean rms p95 hausdorff normal_consistency diagonal".split()
        self.assert_schema(facts, {**COMMON_FACTS, "input": list, **{key: number for key in keys}})
        self.assertEqual(facts["input"], [a, b])
        self.assertAlmostEqual(facts["percent_of_diagonal"]["mean"], 100 * facts["mean"] / facts["diagonal"])

    def test_compare_of_a_surface_with_itself(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("compare", mesh, mesh, "--samples", "500")
        self.assertLess(facts["hausdorff"], 1e-12)
        self.assertAlmostEqual(facts["normal_consistency"], 1)

    def test_two_clouds(self):
        self.bad_input("found no faces", "compare", self.xyz("a.xyz", CUBE), self.xyz("b.xyz", CUBE))

    def test_two_surfaces_within(self):
        a = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        b = self.off("b.off", [(x + 0.1, y, z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        self.assertIs(self.facts("compare", a, b, "--samples", 500, "--within", 0.2)["within"], True)
        self.assertIn("more than 0.01", self.expect(5, "compare", a, b, "--samples", 500, "--within", 0.01).err)

    def test_two_surfaces_are_shown_by_the_distances_of_the_first(self):
        a = self.off("a.off", [(1.25 * x, 1.25 * y, 1.25 * z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        b = self.off("b.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("compare", a, b, "--samples", 500, "-o", self.path("c.ply"), "--view", self.path("c.html"), "--picture",
                           self.path("c.png"), "--picture-size", "90x60")
        self.assertLessEqual(facts["hausdorff"], 0.25 + 1e-12)
        ranges = self.facts("info", self.path("c.ply"))["ranges"]["distance"]
        self.assertEqual(ranges, [0.25, 0.25])
        with open(self.path("c.html"), encoding="utf-8") as f:
            layer = json.loads(re.search(r'class="layer">(.*?)</script>', f.read()).group(1))
        self.assertEqual((layer["faces"], [p["name"] for p in layer["properties"]]), (8, ["distance"]))
        moved = self.off("d.off", [(1.1 * x, y, 0.8 * z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        picture = self.facts("compare", moved, b, "--samples", 500, "--picture", self.path("d.png"))["picture"]
        self.assertAlmostEqual(picture["high"], 0.1, 9)
        self.assertLess(picture["low"], 0)


class Cloud(CliTest):
    """Points of an octahedron: |x| + |y| + |z| - 1 over the root of 3 where a face is nearest."""

    POINTS = [(0, 0, 0), (1 / 3, 1 / 3, 1 / 3), (0.5, 0.5, 0.5), (0.2, 0.1, -0.1), (2, 0, 0), (-0.9, -0.9, 0.9)]

    def distance(self, p):
        return 1.0 if p == (2, 0, 0) else (sum(map(abs, p)) - 1) / 3**0.5

    def test_signed_distances(self):
        mesh, cloud, out = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.xyz("a.xyz", self.POINTS), self.path("d.csv")
        for pair in [(cloud, mesh), (mesh, cloud)]:
            facts = self.facts("compare", *pair, "-o", out)
            with open(out) as f:
                rows = [list(map(float, line.split(","))) for line in f.read().split()[1:]]
            wanted = [self.distance(p) for p in self.POINTS]
            for row, d in zip(rows, wanted):
                self.assertAlmostEqual(row[3], d, places=14)
            self.assertAlmostEqual(facts["signed_mean"], sum(wanted) / 6)
            self.assertAlmostEqual(facts["mean"], sum(map(abs, wanted)) / 6)
            self.assertAlmostEqual(facts["hausdorff"], max(map(abs, wanted)))
            self.assertAlmostEqual(facts["percentiles"]["p50"], sorted(wanted)[2])
            self.assertEqual(sum(facts["histogram"]["counts"]), 6)
            self.assertAlmostEqual(facts["histogram"]["low"], min(wanted))

    def test_faces_that_look_inwards(self):
        mesh = self.off("m.off", OCTAHEDRON, [f[::-1] for f in OCTAHEDRON_FACES])
        facts = self.facts("compare", self.xyz("a.xyz", [(0, 0, 0)]), mesh)
        self.assertAlmostEqual(facts["signed_mean"], -1 / 3**0.5)

    def test_within(self):
        mesh, cloud = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.xyz("a.xyz", self.POINTS)
        facts = self.facts("compare", cloud, mesh, "--within", 0.5, code=5)
        self.assertEqual((facts["within"], facts["outside"]), (False, 3))
        self.assertEqual(self.facts("compare", cloud, mesh, "--within", 1)["outside"], 0)

    def test_other_properties_stay(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        cloud = self.file("a.csv", "x,y,z,distance,label\n0,0,0,7,1\n1,1,1,8,2\n")
        run = self.expect(0, "compare", cloud, mesh, "-o", self.path("d.csv"))
        self.assertIn("the property distance of the points is now input_distance", run.err)
        with open(self.path("d.csv")) as f:
            self.assertEqual(f.readline().strip(), "x,y,z,input_distance,label,distance")

    def test_wrong_uses(self):
        mesh, cloud = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.xyz("a.xyz", self.POINTS)
        self.usage("--samples is for two surfaces", "compare", cloud, mesh, "--samples", 10)
        self.expect(3, "compare", self.file("e.xyz", ""), mesh)


class Figures(CliTest):
    def test_surface_without_area_is_named(self):
        mesh, flat = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.off("f.off", [(1, 1, 1)] * 3, [(0, 1, 2)])
        self.assertRegex(self.expect(3, "compare", mesh, flat).err, r"f\.off: the faces of the second mesh have area 0")

    def test_sizes_near_the_ends_of_doubles(self):
        """Squares of areas vanish or overflow: the figures were 6 % of the diagonal, or none."""
        for size in (1e-300, 1e-170, 1e-90, 1e-80, 1, 1e78, 1e80, 1e150, 1e300):
            mesh = self.off("m.off", [(size * x, size * y, size * z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
            if 1e-100 < size < 1e100:
                area = self.facts("check", mesh)["certificate"]["area"]
                self.assertAlmostEqual(area / size**2, 4 * 3**0.5, places=12)
            facts = self.facts("compare", mesh, mesh, "--samples", "100")
            self.assertAlmostEqual(facts["normal_consistency"], 1)
            self.assertAlmostEqual(facts["diagonal"] / size, 12**0.5)
            for distance in "mean", "rms", "p95", "hausdorff":
                self.assertLess(facts[distance] / size, 1e-14)
                self.assertLess(facts["percent_of_diagonal"][distance], 1e-12)
        mesh = self.off("m.off", [(8e307 * x, 8e307 * y, 8e307 * z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        self.assertIn("cannot hold the distances", self.expect(3, "compare", mesh, mesh).err)


if __name__ == "__main__":
    main()
