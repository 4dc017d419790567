"""brio iso: surfaces of maps and of atoms."""

from brio_cli import CliTest, main


class Iso(CliTest):
    def test_iso_from_a_map(self):
        ball = self.ball_map("a.map")
        facts = self.facts("iso", ball, "--level", "-6", "-o", self.path("s.ply"))
        self.assertEqual(facts["input"], ball)
        certificate = self.facts("check", self.path("s.ply"))["certificate"]
        self.assertTrue(certificate["closed"] and certificate["manifold"] and certificate["genus"] == 0)
        self.assertAlmostEqual(certificate["volume"] / (4 / 3 * 3.14159265 * 6 ** 3), 1, delta=0.05)
        self.assertEqual(facts["points"], self.facts("info", self.path("s.ply"))["points"])
        wanted = self.facts("iso", ball, "--level", "-6", "-n", "20000", "-o", self.path("s.ply"))
        self.assertAlmostEqual(wanted["points"] / 20000, 1, delta=0.1)
        with open(ball, "rb") as f:
            piped = self.expect(0, "iso", "-", "--level", "-6", "-o", "-", "--format", "off", "--quiet",
                                stdin=f.read())
        self.assertTrue(piped.out.startswith(b"OFF"))

    def test_iso_by_its_name_of_version_0_1(self):
        ball, old, new = self.ball_map("a.map"), self.path("old.ply"), self.path("new.ply")
        facts = self.facts("generate", "iso", ball, "--level", "-6", "-o", old)
        self.assertEqual(facts["command"], "iso")
        self.assertTrue(facts["certificate"]["closed"])
        self.facts("iso", ball, "--level", "-6", "-o", new)
        with open(old, "rb") as a, open(new, "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_iso_of_delaunay_triangles(self):
        ball, mesh = self.ball_map("a.map"), self.path("s.ply")
        self.facts("iso", ball, "--level", "-6", "--delaunay-conforming", "-o", mesh)
        certificate = self.facts("check", mesh, "--self-intersections")["certificate"]
        self.assertTrue(certificate["closed"] and certificate["manifold"] and certificate["genus"] == 0)
        self.assertEqual(certificate["self_intersections"], 0)
        self.assertAlmostEqual(certificate["volume"] / (4 / 3 * 3.14159265 * 6 ** 3), 1, delta=0.05)

    def test_iso_from_atoms(self):
        atom = "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00  0.00           C\n"
        self.facts("iso", self.file("a.pdb", atom), "--level", "1", "--resolution", "60",
                   "-o", self.path("s.ply"))
        self.assertAlmostEqual(self.facts("check", self.path("s.ply"))["certificate"]["volume"], 20.58, delta=0.4)
        self.usage("standard deviations", "iso", self.path("a.pdb"), "--level", "1", "--sigma",
                   "-o", self.path("s.ply"))

    def test_iso_refusals(self):
        ball, out = self.ball_map("a.map", 8), self.path("s.ply")
        self.usage("expected IN, got no argument", "iso", "-o", out)
        self.usage("--level L", "iso", ball, "-o", out)
        self.usage("one of -n and --resolution", "iso", ball, "--level", "1", "-n", "5", "--resolution",
                   "5", "-o", out)
        self.usage("noise", "iso", ball, "--level", "1", "--noise", "0", "-o", out)
        self.usage("level", "generate", "cube", "-n", "5", "--level", "1", "-o", out)
        self.usage("one argument too many", "generate", "cube", "x", "-n", "5", "-o", out)
        self.usage("cannot hold", "iso", ball, "--level", "1", "-o", self.path("s.xyz"))
        self.expect(3, "iso", ball, "--level", "9", "-o", out)
        self.expect(2, "iso", self.path("missing.map"), "--level", "1", "-o", out)
        self.expect(2, "iso", self.file("b.map", "MAP"), "--level", "1", "-o", out)
        self.expect(4, "iso", self.ball_map("c.map", 60), "--level", "-6", "-o", out, "--max-memory", "1M")
        self.assert_only(self.folder, "a.map", "b.map", "c.map")


if __name__ == "__main__":
    main()
