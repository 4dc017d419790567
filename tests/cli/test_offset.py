"""brio offset: surfaces at a distance."""

from brio_cli import CERTIFICATE, CliTest, COMMON_FACTS, count, CUBE, main, number, OCTAHEDRON, OCTAHEDRON_FACES


class Offset(CliTest):
    def test_offset_without_a_distance(self):
        self.usage("--distance", "offset", self.xyz("a.xyz", CUBE), "-o", "x.ply")

    def test_offset_of_an_open_mesh(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        run = self.expect(3, "offset", "--distance", "0.1", mesh, "-o", self.path("out.ply"))
        self.assertIn("along 3 edges", run.err)
        self.assertIn("--labeling global", run.err)
        self.assert_only(self.folder, "m.off")

    def test_facts_of_a_run(self):
        points, out = self.cloud("a.ply", 2000, "sphere"), self.path("out.ply")
        seconds = {key: number for key in "read noise delaunay poles power label crust certify write total".split()}
        counts = "samples vertices faces".split()
        for distance, volume in [(0.5, 14.137), (-0.5, 0.5236)]:
            facts = self.facts("offset", points, "--distance", str(distance), "-o", out)
            self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in counts}, "method": str,
                                       "distance": number, "certificate": CERTIFICATE, "seconds": seconds})
            self.assertEqual(facts["distance"], distance)
            self.assertTrue(facts["certificate"]["closed"])
            self.assertAlmostEqual(facts["certificate"]["volume"] / volume, 1, delta=0.03)
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.assertEqual(self.facts("offset", mesh, "-D", "0.1", "-o", out)["labeling"], "mesh")
        greedy = self.facts("offset", mesh, "-D", "0.1", "-o", out, "--labeling", "greedy")
        self.assertEqual(greedy["labeling"], "greedy")
        simple = self.facts("offset", points, "-D", "0.5", "-o", out, "--simplify")
        self.assertTrue(simple["certificate"]["closed"])

    def test_offset_that_swallows_everything(self):
        points = self.cloud("a.ply", 500, "sphere")
        run = self.expect(3, "offset", points, "--distance", "-1.5", "-o", self.path("out.ply"))
        self.assertIn("swallows the whole object", run.err)
        self.assert_only(self.folder, "a.ply")


if __name__ == "__main__":
    main()
