"""brio generate: points of each kind."""

from brio_cli import CliTest, COMMON_FACTS, count, main


class Usage(CliTest):
    def test_number_of_points_that_is_none(self):
        for n in ["many", "-5", "1.5", "1e30", ""]:
            self.usage("points", "generate", "cube", "-n", n, "-o", "x.xyz")

    def test_generate_without_a_number(self):
        self.usage("-n N", "generate", "cube", "-o", "x.xyz")

    def test_generate_of_an_unknown_kind(self):
        self.usage("unknown kind 'sphare'; did you mean 'sphere'", "generate", "sphare", "-n", "5", "-o", "x.xyz")

    def test_generate_with_options_of_another_kind(self):
        for option in [("--noise", "0.5"), ("--views", "3"), ("--truth", "t.ply")]:
            self.usage("scan", "generate", "cube", "-n", "5", "-o", "x.xyz", *option)


    def test_generate_of_a_solid_with_a_number_of_points_or_as_points(self):
        self.usage("no number of points", "generate", "solid", "-n", "5", "-o", "x.ply")
        self.usage("cannot", "generate", "solid", "-o", "x.xyz")
        self.usage("did you mean 'machined'", "generate", "solid", "--kind", "machines", "-o", "x.ply")
        self.usage("resolution 3", "generate", "solid", "--resolution", "3", "-o", "x.ply")
        for option in [("--kind", "machined"), ("--resolution", "40")]:
            self.usage("solid", "generate", "cube", "-n", "5", "-o", "x.xyz", *option)


    def test_truth_without_faces_is_refused_before_the_scan_is_written(self):
        for resolution in "1", "3", "32769":
            self.usage("not between 4 and 32768", "generate", "scan", "-n", "50", "-o", self.path("s.ply"), "--truth",
                       self.path("t.ply"), "--truth-resolution", resolution)
        self.assert_only(self.folder)

    def test_scan_with_noise_that_doubles_cannot_hold(self):
        self.usage("noise", "generate", "scan", "-n", "50", "--noise", "1e308", "-o", self.path("s.ply"))
        self.assert_only(self.folder)


class Generate(CliTest):
    def test_facts_of_a_run(self):
        facts = self.facts("generate", "ball", "-n", "50", "-o", self.path("b.xyz"))
        self.assert_schema(facts, {**COMMON_FACTS, "points": count})

    def test_generate_repeats_with_the_seed(self):
        outputs = [self.expect(0, "generate", "scan", "-n", "500", "-o", "-", "--format", "xyz", *seed).out
                   for seed in ([], [], ["--seed", "1"], ["--seed", "2"])]
        self.assertEqual(outputs[0], outputs[1])
        self.assertEqual(outputs[0], outputs[2])
        self.assertNotEqual(outputs[0], outputs[3])

    def test_generate_of_every_kind(self):
        listed = self.expect(0, "generate", "--help").text
        for kind in ["cube", "ball", "sphere", "torus", "cylinder", "grid", "clusters", "moment", "depth"]:
            self.assertEqual(self.facts("generate", kind, "-n", "77")["points"], 77, kind)
            self.assertIn(kind, listed)

    def test_generate_of_the_moment_curve_by_either_name(self):
        outputs = [self.expect(0, "generate", kind, "-n", "50", "-o", "-", "--format", "xyz").out
                   for kind in ["moment", "moment-curve"]]
        self.assertEqual(outputs[0], outputs[1])
        rows = [line.split() for line in outputs[0].decode().splitlines() if not line.startswith("#")]
        self.assertEqual(len(rows), 50)
        for t, square, cube in [map(float, row) for row in rows]:
            self.assertEqual((square, cube), (t * t, t * t * t))

    def test_generate_scan_with_its_truth(self):
        facts = self.facts("generate", "scan", "-n", "2000", "-o", self.path("s.ply"), "--views", "4", "--noise", "0",
                           "--truth", self.path("t.ply"), "--truth-resolution", "40")
        self.assertEqual(facts["points"], self.facts("info", self.path("s.ply"))["points"])
        self.assertIn("view", self.facts("info", self.path("s.ply"))["properties"])
        self.assertTrue(self.facts("check", self.path("t.ply"))["certificate"]["closed"])

    def test_generate_solid_repeats_and_is_certified(self):
        outputs = []
        for name, kind in [("a", "implicit"), ("b", "machined")]:
            for threads in "1", "2":
                facts = self.facts("generate", "solid", "--kind", kind, "--seed", "7", "--resolution", "32", "--threads",
                                   threads, "-o", self.path(name + threads + ".ply"))
                self.assertTrue(facts["certificate"]["closed"] and facts["certificate"]["manifold"])
                self.assertLessEqual(facts["certificate"]["components"], 3)
                with open(self.path(name + threads + ".ply"), "rb") as f:
                    outputs.append(f.read())
            self.assertEqual(facts["faces"], self.facts("check", self.path(name + "1.ply"))["faces"])
        self.assertEqual(outputs[0], outputs[1])
        self.assertEqual(outputs[2], outputs[3])
        self.assertNotEqual(outputs[0], outputs[2])


if __name__ == "__main__":
    main()
