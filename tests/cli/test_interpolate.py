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
