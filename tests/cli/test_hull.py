"""brio hull: the convex hull of points, also of flat ones."""

from brio_cli import CERTIFICATE, CliTest, COMMON_FACTS, count, CUBE, main, number


class Hull(CliTest):
    def test_facts_of_a_run(self):
        points, out = self.cloud("a.ply", 2000), self.path("out.ply")
        seconds = {key: number for key in "read skip hull certify write total".split()}
        counts = ("samples vertices faces facets dimension created destroyed walk_steps beyond_calls "
                  "exact_calls").split()
        facts = self.facts("hull", points, "-o", out)
        self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in counts}, "method": str,
                                   "certificate": CERTIFICATE, "seconds": seconds})
        self.assertTrue(facts["certificate"]["closed"])
        self.assertEqual(facts["faces"], 2 * facts["vertices"] - 4)
        self.assertLess(facts["internals"]["candidates"], 2000)
        self.assertTrue(self.facts("check", out)["certificate"]["manifold"])

    def test_polygons_of_a_cube_with_points_on_its_faces(self):
        points = self.xyz("a.xyz", [(2 * x, 2 * y, 2 * z) for x, y, z in CUBE] + [(1, 1, 0), (1, 0, 0), (1, 1, 1)])
        facts = self.facts("hull", points, "-o", self.path("out.off"), "--polygons")
        self.assertEqual([facts[key] for key in ("vertices", "faces", "facets")], [8, 6, 6])
        self.assertAlmostEqual(facts["certificate"]["volume"], 8)
        facts = self.facts("hull", points, "-o", self.path("out.off"))
        self.assertEqual([facts[key] for key in ("vertices", "faces", "facets")], [8, 12, 6])

    def test_the_hull_does_not_depend_on_the_order(self):
        """The counters do: the next point of a random order is far away, of a curve near."""
        self.xyz("s.xyz", self.sphere(3000))
        points, found, files = self.path("s.xyz"), {}, set()
        for order in ("brio", "brio-octree", "brio-kdtree", "octree", "hilbert", "random", "input"):
            out = self.path("o.ply")
            found[order] = self.facts("hull", points, "-o", out, "--order", order)
            with open(out, "rb") as file:
                files.add(file.read())
            self.assertEqual(found[order]["created"] - found[order]["destroyed"], found[order]["faces"])
        self.assertEqual(len(files), 1)
        self.assertGreater(len({facts["created"] for facts in found.values()}), 4)
        self.assertGreater(found["random"]["walk_steps"], 4 * found["brio"]["walk_steps"])
        again = self.facts("hull", points, "-o", self.path("o.ply"), "--order", "random", "--seed", "7")
        self.assertNotEqual(again["created"], found["random"]["created"])
        ratio = self.facts("hull", points, "-o", self.path("o.ply"), "--round-ratio", "0.5")
        self.assertNotEqual(ratio["created"], found["brio"]["created"])
        self.usage("--block-size: only with", "hull", points, "-o", self.path("o.ply"), "--block-size", "5")
        self.usage("is not between 0 and 1", "hull", points, "-o", self.path("o.ply"), "--round-ratio", "2")

    def test_flat_inputs(self):
        square = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 0)])
        facts = self.facts("hull", square, "-o", self.path("out.ply"), "--polygons")
        self.assertEqual([facts[key] for key in ("dimension", "vertices", "faces")], [2, 4, 1])
        self.assertEqual(facts["certificate"]["boundary_loops"], 1)
        line = self.xyz("b.xyz", [(i, 2 * i, 3 * i) for i in (3, 1, 2)])
        facts = self.facts("hull", line, "-o", self.path("out.ply"))
        self.assertEqual([facts[key] for key in ("dimension", "vertices", "faces")], [1, 2, 0])
        point = self.xyz("c.xyz", [(1, 2, 3)] * 3)
        self.assertEqual(self.facts("hull", point, "-o", self.path("out.ply"))["dimension"], 0)

    def test_wrong_usage_and_bad_input(self):
        self.usage("-o", "hull", self.xyz("a.xyz", CUBE))
        self.expect(3, "hull", self.xyz("b.xyz", []), "-o", self.path("out.ply"))
        self.expect(2, "hull", self.path("missing.xyz"), "-o", self.path("out.ply"))
        self.assert_only(self.folder, "a.xyz", "b.xyz")


if __name__ == "__main__":
    main()
