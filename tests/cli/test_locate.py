"""brio locate: tetrahedra and nearest vertices of places."""

import struct

from brio_cli import CliTest, COMMON_FACTS, count, CUBE, main

PLACES = [(0.25, 0.5, 0.125), (1, 1, 1), (2, 0, 0), (0, 0, 0.5)]


def read_npy(path):
    with open(path, "rb") as f:
        data = f.read()
    length = struct.unpack("<H", data[8:10])[0]
    return eval(data[10:10 + length].decode()), data[10 + length:]  # a literal that the program wrote


class Locate(CliTest):
    def test_facts_of_a_run(self):
        facts = self.facts("locate", self.xyz("p.xyz", CUBE), "--at", self.xyz("q.xyz", PLACES), "-o",
                           self.path("a.csv"))
        self.assert_schema(facts, {**COMMON_FACTS, "inside": count, "outside": count, "points": count,
                                   "tetrahedra": count})
        self.assertEqual((facts["inside"], facts["outside"]), (3, 1))

    def test_rows_stand_in_the_order_of_the_places(self):
        self.expect(0, "locate", self.xyz("p.xyz", CUBE), "--at", self.xyz("q.xyz", PLACES), "-o", self.path("a.csv"))
        with open(self.path("a.csv"), encoding="utf-8") as f:
            rows = f.read().split()
        self.assertEqual(rows[0], "tetrahedron,vertex")
        self.assertEqual([int(row.split(",")[1]) for row in rows[1:]], [0, 7, 4, 0])
        self.assertEqual([int(row.split(",")[0]) < 0 for row in rows[1:]], [False, False, True, False])

    def test_an_array_of_numpy_has_the_same_numbers(self):
        points, places = self.xyz("p.xyz", CUBE), self.xyz("q.xyz", PLACES)
        self.expect(0, "locate", points, "--at", places, "-o", self.path("a.npy"))
        text = self.expect(0, "locate", points, "--at", places, "-o", "-", "--format", "csv").text
        header, data = read_npy(self.path("a.npy"))
        self.assertEqual(header, {"descr": "<i8", "fortran_order": False, "shape": (4, 2)})
        numbers = [int(x) for row in text.split()[1:] for x in row.split(",")]
        self.assertEqual(list(struct.unpack("<8q", data)), numbers)

    def test_points_in_a_plane_have_triangles(self):
        """All places were outside, with exit 0."""
        square = self.xyz("p.xyz", [(x, y, 0) for x in (0, 1) for y in (0, 1)])
        for more in [], ["--plane", "xy"], ["--plane", "fit"]:
            facts = self.facts("locate", square, "--at", self.xyz("q.xyz", PLACES), "-o", self.path("a.csv"), *more)
            self.assertEqual((facts["inside"], facts["outside"], facts["triangles"]), (3, 1, 2))
            with open(self.path("a.csv"), encoding="utf-8") as f:
                rows = f.read().split()
            self.assertEqual(rows[0], "triangle,vertex")
            self.assertEqual([int(row.split(",")[0]) < 0 for row in rows[1:]], [False, False, True, False])
            self.assertEqual([int(row.split(",")[1]) for row in rows[1:]][1:], [3, 2, 0])

    def test_points_on_a_line_have_nearest_vertices_alone(self):
        line = self.xyz("p.xyz", [(0, 0, 0), (1, 2, 3), (2, 4, 6)])
        run = self.expect(0, "locate", line, "--at", self.xyz("q.xyz", PLACES), "-o", "-", "--format", "csv")
        self.assertEqual(run.text.split()[1:], ["-1,0", "-1,0", "-1,0", "-1,0"])
        self.assertIn("on a line", run.err)

    def test_wrong_usage(self):
        points = self.xyz("p.xyz", CUBE)
        self.usage("--at FILE is missing", "locate", points, "-o", self.path("a.csv"))
        self.usage("writes .csv and .npy", "locate", points, "--at", points, "-o", self.path("a.ply"))
        self.usage("-o FILE is missing", "locate", points, "--at", points)

    def test_extensions_in_capitals(self):
        points = self.xyz("p.xyz", CUBE)
        for name in ["A.CSV", "A.Npy"]:
            self.expect(0, "locate", points, "--at", points, "-o", self.path(name))


if __name__ == "__main__":
    main()
