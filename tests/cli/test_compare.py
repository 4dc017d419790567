"""brio compare: distances of two surfaces."""

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

    def test_compare_with_points_alone(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.bad_input("found no faces", "compare", mesh, self.xyz("a.xyz", CUBE))

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
