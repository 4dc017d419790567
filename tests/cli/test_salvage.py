"""Files that end early: --salvage keeps the rows that are whole and says how many miss."""

import struct

from brio_cli import CliTest, main

POINTS = [(i + 0.5, -i, 100 + i) for i in range(6)]
FACES = [(0, 1, 2), (1, 2, 3), (2, 3, 4)]


def text(rows):
    return "".join(" ".join(map(repr, row)) + "\n" for row in rows)


class Salvage(CliTest):
    def cut(self, name, content, end):
        """The points of a file without its last bytes, and the report."""
        self.file(name, content[:end])
        facts = self.facts("convert", self.path(name), self.path("out.csv"), "--salvage", "--quiet")
        with open(self.path("out.csv")) as f:
            rows = [tuple(map(float, line.split(",")[:3])) for line in f.read().splitlines()[1:]]
        return rows, facts

    def expect_whole_rows(self, name, content, ends):
        """ends: the byte behind each row, a text's line feed included."""
        start = ends[0] - (ends[1] - ends[0])
        for end in range(start, len(content), 5):
            rows, facts = self.cut(name, content, end)
            whole = sum(place <= end for place in ends)
            self.assertEqual(rows, POINTS[:whole], (name, end))
            self.assertEqual(facts["missing"], len(POINTS) - whole, (name, end))
            self.bad_input("promises|ends", "info", self.path(name))
        self.assertEqual(self.cut(name, content, len(content))[1]["missing"], 0)

    def ends_of_lines(self, header):
        ends, at = [], len(header)
        for row in POINTS:
            at += len(text([row]))
            ends.append(at)
        ends[-1] -= 1  # the last row of those that are announced needs no line feed
        return ends

    PLY = "ply\nformat %s 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
    PCD = ("VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 6\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
           "POINTS 6\nDATA %s\n")

    def test_texts(self):
        for name, header in [("a.ply", self.PLY % "ascii"), ("a.pcd", self.PCD % "ascii"), ("a.off", "OFF\n6 0 0\n"),
                             ("a.pts", "6\n"),
                             ("a.ptx", "6\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")]:
            # a row cut within its last number looks whole where it is the last one
            content, ends = header + text(POINTS), self.ends_of_lines(header)
            for end in [*range(len(header) + 1, len(content) - 4, 5), *ends[:2], ends[1] - 1]:
                rows, facts = self.cut(name, content.encode(), end)
                whole = sum(place <= end for place in ends)
                self.assertEqual((rows, facts["missing"]), (POINTS[:whole], len(POINTS) - whole), (name, end))
            self.assertEqual(self.cut(name, content.encode(), len(content))[1]["missing"], 0)

    def test_binary(self):
        rows = b"".join(struct.pack("<3d", *p) for p in POINTS)
        npy = repr({"descr": [(axis, "<f8") for axis in "xyz"], "fortran_order": False, "shape": (6,)})
        npy += " " * (-(len(npy) + 11) % 64) + "\n"
        for name, header in [("a.ply", (self.PLY % "binary_little_endian").encode()), ("a.pcd", (self.PCD % "binary").encode()),
                             ("a.npy", b"\x93NUMPY\1\0" + struct.pack("<H", len(npy)) + npy.encode())]:
            self.expect_whole_rows(name, header + rows, [len(header) + 24 * (i + 1) for i in range(6)])

    def test_faces_that_miss_are_named(self):
        header = (self.PLY % "%s").replace("end_header", "element face 3\nproperty list uchar int vertex_indices\nend_header")
        ascii_file = header % "ascii" + text(POINTS) + text((3, *face) for face in FACES)
        binary = (header % "binary_little_endian").encode() + b"".join(struct.pack("<3d", *p) for p in POINTS)
        binary += b"".join(struct.pack("<B3i", 3, *face) for face in FACES)
        off = "OFF\n6 3 0\n" + text(POINTS) + text((3, *face) for face in FACES)
        for name, content, end, faces, lost in [
                ("a.ply", ascii_file.encode(), -3, 2, ["1 rows of face"]), ("a.ply", ascii_file.encode(), -25, 0, ["3 rows of face"]),
                ("a.ply", binary, -1, 2, ["1 rows of face"]), ("a.ply", binary, -14, 1, ["2 rows of face"]),
                ("a.off", off.encode(), -3, 2, ["1 rows of face"])]:
            self.file(name, content[:end])
            facts = self.facts("convert", self.path(name), self.path("out.ply"), "--salvage", "--quiet")
            self.assertEqual((facts["points"], facts["missing"], facts["faces"], facts["lost"]), (6, 0, faces, lost), (name, end))
        for name, content in [("b.ply", binary[:-45]), ("c.ply", ascii_file.encode()[:-28]), ("d.off", off.encode()[:-28])]:
            facts = self.facts("convert", self.file(name, content), self.path("out.ply"), "--salvage", "--quiet")
            self.assertEqual((facts["points"], facts["missing"], facts["lost"]), (5, 1, ["3 rows of face"]), name)

    def test_rows_of_a_text_that_announces_nothing(self):
        facts = self.facts("info", self.file("a.xyz", "1 2 3 4\n5 6 7 8\n9 1"), "--salvage")
        self.assertEqual((facts["points"], facts["missing"]), (2, 1))
        facts = self.facts("info", self.file("b.csv", "x,y,z,heat\n5,6,7,8\n9,1,2"), "--salvage")
        self.assertEqual((facts["points"], facts["missing"]), (1, 1))
        self.assertEqual(self.facts("info", self.file("c.xyz", "1 2 3\n4 5 6"), "--salvage")["points"], 2)
        self.bad_input("expected 3 numbers", "info", self.file("d.xyz", "1 2 3\n4 5\n6 7 8\n"), "--salvage")

    def test_the_rows_of_a_node_file(self):
        header, rows = "6 3 0 0\n", "".join("%d %s" % (i, text([p])) for i, p in enumerate(POINTS))
        rows_4, facts = self.cut("a.node", (header + rows).encode(), -20)
        self.assertEqual((rows_4, facts["missing"]), (POINTS[:4], 2))

    def test_another_scan_that_does_not_begin(self):
        scan = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3\n"
        self.file("a.ptx", scan + scan[:20])
        facts = self.facts("convert", self.path("a.ptx"), self.path("out.csv"), "--salvage", "--quiet")
        self.assertEqual((facts["points"], facts["lost"]), (1, ["1 rows of scan's header"]))

    def test_more_than_a_block(self):
        header = (self.PLY % "binary_little_endian").replace("vertex 6", "vertex 200000").encode()
        self.file("a.ply", header + struct.pack("<3d", 1, 2, 3) * 150000 + bytes(5))
        facts = self.facts("convert", self.path("a.ply"), self.path("out.las"), "--salvage", "--quiet")
        self.assertEqual((facts["points"], facts["missing"]), (150000, 50000))


if __name__ == "__main__":
    main()
