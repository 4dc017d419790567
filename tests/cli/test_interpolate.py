"""brio interpolate: values of a property at places."""

import math
import struct

from brio_cli import CliTest, COMMON_FACTS, count, CUBE, main

PLACES = [(0.25, 0.5, 0.125), (1, 1, 1), (2, 0, 0), (0.5, 0.5, 0.5)]


class Interpolate(CliTest):
    def points(self):
        """A cube with the property q = 1 + x + 2 y + 4 z."""
        rows = "".join("%d %d %d %d\n" % (x, y, z, 1 + x + 2 * y + 4 * z) for x, y, z in CUBE)
        return self.file("p.ply", "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
                                  "property double z\nproperty float q\nend_header\n" + rows)

    def values(self, *more):
        places = self.xyz("q.xyz", PLACES)
        text = self.expect(0, "interpolate", self.points(), "--at", places, "--property", "q", "-o", "-", "--format",
                           "csv", *more).text.split()
        self.assertEqual(text[0], "q")
        return [float(x) for x in text[1:]]

    def test_both_methods_reproduce_a_linear_property(self):
        for method in [], ["--method", "natural"], ["--method", "linear"]:
            values = self.values(*method)
            self.assertTrue(math.isnan(values[2]))
            for value, (x, y, z) in zip(values[:2] + values[3:], PLACES[:2] + PLACES[3:]):
                self.assertAlmostEqual(value, 1 + x + 2 * y + 4 * z, 12)

    def map_values(self, text, places, *more, code=0):
        done = self.expect(code, "interpolate", self.file("stations.csv", text), "--at", self.file("at.csv", places),
                           "--property", "t", "-o", "-", "--format", "csv", *more)
        return [float(x) for x in done.text.split()[1:]]

    def test_points_in_a_plane_are_interpolated_in_it(self):
        """All values were NaN, and all places outside, with exit 0."""
        stations = "x,y,z,t\n0,0,0,10\n1,0,0,20\n0,1,0,30\n1,1,0,40\n"
        places = "x,y,z\n0.5,0.5,0\n0.25,0.75,0\n0.5,0.5,99\n7,7,0\n"
        for method in "natural", "linear":
            for more in [], ["--plane", "xy"], ["--plane", "fit"]:
                values = self.map_values(stations, places, "--method", method, *more)
                self.assertEqual([round(v, 12) for v in values[:3]], [25, 27.5, 25])
                self.assertTrue(math.isnan(values[3]))

    def test_planes_by_name(self):
        tilted = "x,y,z,t\n0,0,5,10\n1,0,6,20\n0,1,9,30\n1,1,7,40\n"
        self.assertEqual(self.map_values(tilted, "x,y,z\n0.5,0.5,0\n", "--plane", "xy"), [25])
        for plane, order in (("xy", (0, 1, 2)), ("xz", (0, 2, 1)), ("zx", (0, 2, 1)), ("yz", (1, 2, 0))):
            def row(u, v, w, *more):
                return ",".join(str((u, v, w)[order.index(k)]) for k in range(3)) + "".join(",%g" % m for m in more)
            stations = "x,y,z,t\n" + "".join(row(u, v, u * v + 3, 10 + 10 * u + 20 * v) + "\n" for u in (0, 1) for v in (0, 1))
            values = self.map_values(stations, "x,y,z\n" + row(0.25, 0.75, -8) + "\n", "--plane", plane)
            self.assertAlmostEqual(values[0], 27.5, 12, plane)
        self.usage("plane", "interpolate", "a.csv", "--at", "b.csv", "--property", "t", "--plane", "ab", "-o", "c.csv")

    def test_data_over_a_map_needs_no_z(self):
        stations, places = "x,y,t\n0,0,10\n1,0,20\n0,1,30\n1,1,40\n", "x,y\n0.5,0.5\n0.25,0.75\n"
        self.assertEqual(self.map_values(stations, places, "--plane", "xy"), [25, 27.5])
        self.assertEqual(self.map_values("easting;northing;t\n0;0;10\n1;0;20\n0;1;30\n1;1;40\n", "0.5 0.5\n", "--plane", "xy"),
                         [25])
        self.bad_input("which columns are x, y and z", "interpolate", self.file("s.csv", stations), "--at",
                       self.file("p.csv", places), "--property", "t", "-o", "-", "--format", "csv")

    def test_points_on_a_line_and_at_one_position(self):
        line = "x,y,z,t\n0,0,0,0\n0.1,0.2,0.3,1\n0.7,1.4,2.1,7\n"
        values = self.map_values(line, "x,y,z\n0.15,0.3,0.45\n0.3,0.6,0.9\n5,10,15\n")
        self.assertAlmostEqual(values[0], 1.5, 12)
        self.assertAlmostEqual(values[1], 3, 12)
        self.assertTrue(math.isnan(values[2]))
        run = self.expect(3, "interpolate", self.file("s.csv", "x,y,z,t\n1,2,3,4\n1,2,3,5\n"), "--at",
                           self.file("p.csv", "x,y,z\n1,2,3\n"), "--property", "t", "-o", "-", "--format", "csv")
        self.assertIn("one position", run.err)

    def test_places_inside_and_outside_of_a_map(self):
        stations = self.file("stations.csv", "x,y,z,t\n0,0,0,10\n1,0,0,20\n0,1,0,30\n1,1,0,40\n")
        places = self.file("at.csv", "x,y,z\n0.5,0.5,0\n0.25,0.75,0\n7,7,0\n")
        for more, kind in ([], "tetrahedra"), (["--plane", "xy"], "triangles"):
            facts = self.facts("interpolate", stations, "--at", places, "--property", "t", "-o", self.path("a.ply"), *more)
            self.assertEqual((facts["inside"], facts["outside"]), (2, 1))
            self.assertIn(kind, facts)

    def test_facts_of_a_run(self):
        facts = self.facts("interpolate", self.points(), "--at", self.xyz("q.xyz", PLACES), "--property", "q", "-o",
                           self.path("a.ply"))
        self.assert_schema(facts, {**COMMON_FACTS, "inside": count, "outside": count, "points": count,
                                   "tetrahedra": count})
        self.assertEqual((facts["inside"], facts["outside"]), (3, 1))
        with open(self.path("a.ply"), "rb") as f:
            self.assertIn(b"property double q", f.read())

    def test_an_array_of_numpy(self):
        self.expect(0, "interpolate", self.points(), "--at", self.xyz("q.xyz", PLACES), "--property", "q", "-o",
                    self.path("a.npy"))
        with open(self.path("a.npy"), "rb") as f:
            data = f.read()
        self.assertIn(b"'shape': (4,)", data)
        self.assertEqual(struct.unpack("<4d", data[-32:])[1], 8)

    def test_bad_input(self):
        places = self.xyz("q.xyz", PLACES)
        self.usage("--property NAME is missing", "interpolate", self.points(), "--at", places, "-o", self.path("a.ply"))
        self.bad_input("have no property 'r'", "interpolate", self.points(), "--at", places, "--property", "r", "-o",
                       self.path("a.ply"))

    def test_formats_without_properties_are_refused(self):
        for name in ["out.obj", "out.off", "out.stl"]:
            self.usage("cannot hold", "interpolate", "missing.csv", "--at", "b.xyz", "--property", "p", "-o", name)


if __name__ == "__main__":
    main()
