"""brio offset: surfaces at a distance."""

import math

from brio_cli import CERTIFICATE, CliTest, COMMON_FACTS, count, CUBE, main, number, OCTAHEDRON, OCTAHEDRON_FACES


def prism(test):
    """A closed 32-gon prism (radius 1, height 2) without a vertex between its rims."""
    n = 32
    points = [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), z) for z in (-1, 1) for i in range(n)]
    faces = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return test.off("prism.off", points, faces + [tuple(reversed(range(n))), tuple(range(n, 2 * n))])


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
        greedy = self.facts("offset", mesh, "-D", "0.1", "-o", out, "--labeling", "greedy")
        self.assertEqual(greedy["labeling"], "greedy")
        simple = self.facts("offset", points, "-D", "0.5", "-o", out, "--simplify")
        self.assertTrue(simple["certificate"]["closed"])

    def test_offset_of_a_mesh_goes_by_its_faces(self):
        """A prism whose vertices are on its rims only; by its vertices it had 7.806 and 4.077."""
        mesh, out = prism(self), self.path("out.ply")
        for distance, volume in [(0.1, 8.287357), (-0.1, 4.546175)]:
            facts = self.facts("offset", mesh, "--distance", str(distance), "-o", out)
            self.assert_schema(facts, {**COMMON_FACTS, "method": str, "distance": number, "proven_error": number,
                                       "samples": count, "vertices": count, "faces": count, "certificate": CERTIFICATE})
            self.assertEqual((facts["method"], facts["labeling"]), ("mesh", "mesh"))
            self.assertLessEqual(facts["proven_error"], 0.001)
            self.assertAlmostEqual(facts["certificate"]["volume"] / volume, 1, delta=5e-4)
            self.assertTrue(self.facts("check", out, "--self-intersections")["certificate"]["manifold"])
        finer = self.facts("offset", mesh, "--distance", "0.1", "--error", "0.0002", "-o", out)
        self.assertLessEqual(finer["proven_error"], 0.0002)

    def test_cube_is_not_refused(self):
        faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        mesh = self.off("cube.off", corners, faces)
        facts = self.facts("offset", mesh, "-D", "-0.25", "-o", self.path("out.ply"))
        self.assertAlmostEqual(facts["certificate"]["volume"], 0.125, delta=1e-6)

    def test_options_that_mean_nothing(self):
        mesh, points, out = prism(self), self.cloud("a.ply", 500, "sphere"), self.path("out.ply")
        for option in [("--sharp",), ("--simplify",), ("--noise", "smooth"), ("-R", "0.4")]:
            self.usage("is for points", "offset", mesh, "-D", "0.1", "-o", out, *option)
        self.usage("--error is for closed meshes", "offset", points, "-D", "0.1", "-o", out, "--error", "0.01")
        self.usage("not less than its distance", "offset", mesh, "-D", "0.1", "-o", out, "--error", "0.2")
        self.usage("not 0", "offset", mesh, "-D", "0", "-o", out)

    def test_distances_that_doubles_cannot_hold(self):
        """1e308 of points was an error about a point that is not finite."""
        for source in [self.cloud("a.ply", 500, "sphere"), prism(self)]:
            self.usage("of the offset is more than", "offset", source, "-D", "1e308", "-o", self.path("out.ply"))
            self.expect(3, "offset", source, "-D", "-1e308", "-o", self.path("out.ply"))

    def test_memory_that_a_small_error_needs(self):
        run = self.expect(4, "offset", prism(self), "-D", "0.1", "--error", "1e-7", "-o", self.path("out.ply"),
                          "--max-memory", "100M")
        self.assertIn("needed, over the limit", run.err)

    def test_offset_that_swallows_a_mesh(self):
        run = self.expect(3, "offset", prism(self), "-D", "-1", "-o", self.path("out.ply"))
        self.assertIn("swallows the whole object", run.err)
        self.assertNotIn("--labeling", run.err)

    def test_offset_that_swallows_everything(self):
        points = self.cloud("a.ply", 500, "sphere")
        run = self.expect(3, "offset", points, "--distance", "-1.5", "-o", self.path("out.ply"))
        self.assertIn("swallows the whole object", run.err)
        self.assert_only(self.folder, "a.ply")


if __name__ == "__main__":
    main()
