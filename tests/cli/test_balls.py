"""brio balls: volumes, what is counted, and the surface of unions of balls."""

import math
import re

from brio_cli import CliTest, main


class Balls(CliTest):
    def test_two_balls_have_the_volume_of_the_formula(self):
        balls, out = self.file("a.csv", "x,y,z,radius\n0,0,0,1\n1,0,0,1\n"), self.path("out.ply")
        self.assertEqual(self.expect(0, "balls", balls).err, "", "radii are what it asks for")
        facts = self.facts("balls", balls, "-o", out, "--error", "0.001")
        self.assertAlmostEqual(facts["union_volume"], 8 * math.pi / 3 - 5 * math.pi / 12, delta=1e-12)
        self.assertAlmostEqual(facts["union_area"], 6 * math.pi, delta=1e-12)
        self.assertEqual((facts["balls"], facts["exposed"], facts["union_components"], facts["tunnels"], facts["voids"]), (2, 2, 1, 0, 0))
        self.assertEqual((facts["patches"], facts["arcs"], facts["corners"]), (2, 1, 0))
        self.assertTrue(facts["certificate"]["closed"] and facts["certificate"]["manifold"])
        self.assertAlmostEqual(facts["certificate"]["volume"], facts["union_volume"], delta=0.02)
        coarse = self.facts("balls", balls, "-o", out, "--error", "0.05")
        self.assertLess(coarse["faces"], facts["faces"] / 10)

    def test_faces_have_the_colours_of_their_balls(self):
        balls, out = self.file("a.csv", "x,y,z,radius,red,green,blue\n0,0,0,1,200,10,30\n1,0,0,1,0,90,255\n"), self.path("out.ply")
        self.expect(0, "balls", balls, "-o", out, "--error", "0.1", "--ascii", "--quiet")
        with open(out, encoding="ascii") as f:
            head, rows = f.read().split("end_header\n")
        faces = [row.split() for row in rows.splitlines() if row.startswith("3 ")][-int(re.search(r"element face (\d+)", head).group(1)):]
        names = re.findall(r"property \w+ (\w+)", head[head.index("element face"):])
        self.assertEqual(names[-4:], ["ball", "red", "green", "blue"])
        self.assertEqual({tuple(f[4:]) for f in faces}, {("0", "200", "10", "30"), ("1", "0", "90", "255")})

    def test_colours_of_16_bits_were_white_and_parts_of_1_black(self):
        """Faces take colours as they are; how deep these are, the writer tells: PLY has bytes."""
        out = self.path("out.ply")
        for rows, seen in (("0,0,0,1,0.5,0,1\n1,0,0,1,0.25,0,0.5\n", {(0, 128, 0, 255), (1, 64, 0, 128)}),
                           ("0,0,0,1,65535,257,0\n1,0,0,1,25700,0,514\n", {(0, 255, 1, 0), (1, 100, 0, 2)})):
            self.expect(0, "balls", self.file("a.csv", "x,y,z,radius,red,green,blue\n" + rows), "-o", out, "--error", "0.1", "--ascii", "--quiet")
            with open(out, encoding="ascii") as f:
                text = f.read()
            faces = text.splitlines()[-int(re.search(r"element face (\d+)", text).group(1)):]
            self.assertEqual({tuple(map(float, row.split()[4:])) for row in faces}, seen)

    def test_weights_are_squares_and_may_be_in_a_file(self):
        points, weights = self.xyz("a.xyz", [(0, 0, 0), (5, 0, 0)]), self.file("w.txt", "4\n1\n")
        facts = self.facts("balls", points, "--weights", weights)
        self.assertAlmostEqual(facts["union_volume"], 4 * math.pi / 3 * 9, delta=1e-11)
        self.assertNotIn("certificate", facts)
        self.usage("no radii", "balls", points)
        self.usage("-o OUT is missing", "balls", points, "--weights", weights, "--error", "0.1")
        nothing = self.file("n.txt", "0\n-1\n")
        self.assertIn("no ball", self.expect(3, "balls", points, "--weights", nothing).err)

    def test_balls_of_a_torus_have_its_tunnel(self):
        """The union of inner polar balls has the surface's topology (lemma 47)."""
        axis, out = self.path("axis.ply"), self.path("out.ply")
        self.expect(0, "medial", self.cloud("a.ply", 1500, "torus"), "-o", axis, "--quiet")
        facts = self.facts("balls", axis, "-o", out)
        self.assertEqual((facts["union_components"], facts["tunnels"], facts["voids"]), (1, 1, 0))
        found = facts["certificate"]
        self.assertEqual((found["closed"], found["manifold"], found["components"], found["genus"]), (True, True, 1, 1))
        self.assertEqual(self.facts("check", out)["certificate"]["genus"], 1)


if __name__ == "__main__":
    main()
