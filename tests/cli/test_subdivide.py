"""brio subdivide: butterfly subdivision."""

from brio_cli import CliTest, CUBE, main, OCTAHEDRON, OCTAHEDRON_FACES


class Subdivide(CliTest):
    def test_subdivide(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("subdivide", mesh, "--levels", "3", "-o", self.path("s.off"))
        self.assertEqual((facts["levels"], facts["vertices"], facts["faces"]), (3, 258, 512))
        self.assertTrue(facts["certificate"]["closed"] and facts["certificate"]["genus"] == 0)
        with open(self.path("s.off")) as f:
            rows = [line.split() for line in f if not line.startswith("#")]
        self.assertEqual([tuple(map(float, row)) for row in rows[2:8]], OCTAHEDRON)

    def test_coordinates_near_the_end_of_doubles(self):
        """New vertices were infinite and no numbers, in files that brio cannot read."""
        out = self.path("s.ply")
        mesh = self.off("m.off", [(1.5e308, 0, 0), (1.5e308, 1e308, 0), (1.4e308, 0, 1e308)], [(0, 1, 2)])
        self.facts("subdivide", mesh, "-o", out)
        low, high = (self.facts("info", out)["box"][end] for end in ("min", "max"))
        self.assertTrue(all(abs(x) < 1.6e308 for x in low + high))
        mesh = self.off("m.off", [(1.5e308, 0, 0), (-1.5e308, 1e308, 0), (1.4e308, -1.7e308, 1e308)], [(0, 1, 2)])
        self.assertIn("doubles cannot hold vertex", self.expect(3, "subdivide", mesh, "-o", out).err)

    def test_subdivide_refusals(self):
        mesh, out = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.path("s.ply")
        self.usage("between 1 and 15", "subdivide", mesh, "--levels", "0", "-o", out)
        self.usage("-o FILE is missing", "subdivide", mesh)
        self.expect(3, "subdivide", self.xyz("p.xyz", CUBE), "-o", out)
        square = self.off("q.off", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])
        self.assertIn("face 0 has 4 corners", self.expect(3, "subdivide", square, "-o", out).err)
        self.expect(4, "subdivide", mesh, "--levels", "15", "-o", out, "--max-memory", "100M")
        self.assert_only(self.folder, "m.off", "p.xyz", "q.off")

    def test_levels_that_no_index_can_number_are_refused_with_the_number(self):
        """1.6e12 faces were begun."""
        solid = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        run = self.expect(4, "subdivide", solid, "--levels", 14, "-o", self.path("b.ply"))
        self.assertIn("14 levels make 2147483648 faces of 8", run.err)


if __name__ == "__main__":
    main()
