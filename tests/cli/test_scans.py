"""Files of scans that are written: E57 and PTX, read back by parsers of this file and by brio."""

import struct
import xml.etree.ElementTree as tree

import formats
import whole_files
from brio_cli import CliTest, main

E57 = "{http://www.astm.org/COMMIT/E57/2010-e57-v1.0}"
TYPES = {(0, 255): "B", (-128, 127): "b", (0, 65535): "H", (-2**15, 2**15 - 1): "h", (0, 2**32 - 1): "I",
         (-2**31, 2**31 - 1): "i", (0, 0): ""}
UTM = (500000.123, 5400000.456, 77.001)


def e57_content(data):
    """The content of all pages, whose checksums are right."""
    assert len(data) % 1024 == 0
    pages = [data[i:i + 1024] for i in range(0, len(data), 1024)]
    for page in pages:
        assert struct.unpack(">I", page[1020:])[0] == whole_files.crc32c(page[:1020])
    return b"".join(page[:1020] for page in pages)


def logical(physical):
    assert physical % 1024 < 1020
    return physical // 1024 * 1020 + physical % 1024


def e57_points(content, points):
    """The values of a section of points by the names of their fields."""
    fields = []
    for field in points.find(E57 + "prototype"):
        name = field.tag.replace(E57, "").split("}")[-1]
        if field.get("type") == "Float":
            fields.append((name, "f" if field.get("precision") == "single" else "d", 0))
        else:
            low, high = int(field.get("minimum")), int(field.get("maximum"))
            fields.append((name, TYPES[low, high].upper(), low))
    at = logical(int(points.get("fileOffset")))
    kind, length, data, index = struct.unpack("<B7xQQQ", content[at:at + 32])
    assert (kind, index) == (1, 0)
    end, at = at + length, logical(data)
    streams = [b""] * len(fields)
    while at < end:
        kind, _, size, count = struct.unpack("<BBHH", content[at:at + 6])
        assert (kind, count, (size + 1) % 4) == (1, len(fields), 0)
        lengths = struct.unpack("<%dH" % count, content[at + 6:at + 6 + 2 * count])
        place = at + 6 + 2 * count
        for i, part in enumerate(lengths):
            streams[i] += content[place:place + part]
            place += part
        assert place <= at + size + 1
        at += size + 1
    count = int(points.get("recordCount"))
    out = {}
    for (name, letter, low), stream in zip(fields, streams):
        values = struct.unpack("<%d%s" % (count, letter), stream) if letter else (0,) * count
        out[name] = [value + low for value in values]
    return out


def read_e57(path):
    """The XML section and the points of each scan."""
    with open(path, "rb") as file:
        data = file.read()
    content = e57_content(data)
    name, major, minor, length, xml, xml_length, page = struct.unpack("<8sIIQQQQ", content[:48])
    assert (name, major, minor, length, page) == (b"ASTM-E57", 1, 0, len(data), 1024)
    root = tree.fromstring(content[logical(xml):logical(xml) + xml_length])
    return root, [(scan, e57_points(content, scan.find(E57 + "points"))) for scan in root.find(E57 + "data3D")]


class ScansTest(CliTest):
    def convert(self, source, target, *options):
        return self.facts("convert", source, self.path(target), "--quiet", *options)

    def rows(self, name):
        self.convert(self.path(name), "rows.csv")
        with open(self.path("rows.csv")) as file:
            names, *rows = file.read().splitlines()
        return names.split(","), [tuple(map(float, row.split(","))) for row in rows]


class Written(ScansTest):
    TEXT = "x,y,z,R,G,B,intensity,heat,Class,2nd name\n"

    def test_fields_of_an_e57_file(self):
        self.file("a.csv", self.TEXT + "".join("%r,%r,%r,%d,7,255,%r,%r,3,%d\n" % (
            UTM[0] + i / 7, UTM[1] + i / 3, UTM[2], i % 256, i / 9, -i / 11, i) for i in range(2000)))
        facts = self.convert(self.path("a.csv"), "a.e57")
        self.assertEqual((facts["lost"], facts["renamed"]), ([], ["2nd name"]))
        _, [(scan, points)] = read_e57(self.path("a.e57"))
        self.assertTrue(points["cartesianX"] == [UTM[0] + i / 7 for i in range(2000)])
        self.assertEqual(points["colorRed"], [i % 256 for i in range(2000)])
        self.assertEqual(points["heat"], [-i / 11 for i in range(2000)])
        self.assertEqual(set(points), {"cartesianX", "cartesianY", "cartesianZ", "cartesianInvalidState", "colorRed",
                                       "colorGreen", "colorBlue", "intensity", "heat", "Class", "_2nd_name"})
        self.assertEqual(float(scan.find(E57 + "cartesianBounds/" + E57 + "xMaximum").text), UTM[0] + 1999 / 7)
        self.assertEqual(scan.find(E57 + "colorLimits/" + E57 + "colorBlueMaximum").text, "255")
        self.assertIsNone(scan.find(E57 + "pose"))
        names, rows = self.rows("a.e57")
        self.assertEqual(names, "x,y,z,red,green,blue,intensity,heat,Class,_2nd_name".split(","))
        self.assertEqual(rows[1999][3:], (1999 % 256, 7, 255, 1999 / 9, -1999 / 11, 3, 1999))

    def test_types_of_every_width(self):
        header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
        kinds = ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"]
        ends = [(-128, 127), (0, 255), (-2**15, 2**15 - 1), (0, 65535), (-2**31, 2**31 - 1), (0, 2**32 - 1), (-0.5, 1.25),
                (-1e300, 0.1)]
        header += "".join("property %s of_%s\n" % (kind, kind) for kind in kinds) + "end_header\n"
        self.file("a.ply", header + "".join("1 2 %d %s\n" % (k, " ".join(repr((low, high, 1)[k]) for low, high in ends))
                                            for k in range(3)))
        self.assertEqual(self.convert(self.path("a.ply"), "a.e57")["lost"], [])
        _, [(_, points)] = read_e57(self.path("a.e57"))
        for kind, (low, high) in zip(kinds, ends):
            self.assertEqual(points["of_" + kind], [low, high, 1], kind)
        self.convert(self.path("a.e57"), "b.ply", "--ascii")
        with open(self.path("b.ply")) as file:
            text = file.read()
        for kind in kinds:
            self.assertIn("property %s of_%s\n" % (kind, kind), text)

    def test_a_scan_for_each_place_of_a_scanner(self):
        places = [(500005.5, 5400000.75, 78), (500001.25, 5400000.75, 78)]
        text = "x,y,z,x_origin,y_origin,z_origin\n" + "".join(
            "%r,%r,%r,%r,%r,%r\n" % (UTM[0] + i / 7, UTM[1], UTM[2], *place) for place in places for i in range(3000))
        facts = self.convert(self.file("a.csv", text), "a.e57")
        self.assertEqual(facts["lost"], [])
        _, scans = read_e57(self.path("a.e57"))
        self.assertEqual(len(scans), 2)
        for (scan, points), place in zip(scans, places):
            pose = scan.find(E57 + "pose/" + E57 + "translation")
            self.assertEqual(tuple(float(pose.find(E57 + axis).text) for axis in "xyz"), place)
            self.assertTrue([x + place[0] for x in points["cartesianX"]] == [UTM[0] + i / 7 for i in range(3000)])
        self.convert(self.path("a.csv"), "a.ptx")
        for name in ["a.e57", "a.ptx"]:
            there = [(UTM[0] + i / 7, UTM[1], UTM[2]) for i in range(3000)] * 2
            self.assertTrue([row[:3] for row in self.rows(name)[1]] == there, name)
            facts = self.convert(self.path(name), "again." + name[2:])
            self.assertEqual(facts["lost"], [])
            with open(self.path(name), "rb") as one, open(self.path("again." + name[2:]), "rb") as two:
                self.assertTrue(one.read() == two.read(), name)

    def test_numbers_of_scans(self):
        """A number that counts the scans is no field; any other one stays a property."""
        place = "x,y,z,scan\n"
        self.convert(self.file("a.csv", place + "1,2,3,0\n4,5,6,1\n7,8,9,1\n"), "a.e57")
        self.assertEqual([len(points["cartesianX"]) for _, points in read_e57(self.path("a.e57"))[1]], [1, 2])
        self.assertEqual(self.rows("a.e57"), (["x", "y", "z", "scan"], [(1, 2, 3, 0), (4, 5, 6, 1), (7, 8, 9, 1)]))
        facts = self.convert(self.file("b.csv", place + "1,2,3,5\n4,5,6,7\n"), "b.e57")
        self.assertEqual((facts["lost"], facts["renamed"]), ([], ["scan"]))
        self.assertEqual(self.rows("b.e57"), (["x", "y", "z", "scan_2", "scan"], [(1, 2, 3, 5, 0), (4, 5, 6, 7, 1)]))
        self.assertEqual(self.convert(self.path("b.csv"), "b.ptx")["lost"], ["scan"])

    def test_places_of_a_scanner_that_moves(self):
        """A place for each point stays with the point: there are no scans of one point."""
        text = "x,y,z,x_origin,y_origin,z_origin\n" + "".join("1,2,%d,%d,0,5\n" % (i, i) for i in range(5000))
        self.assertEqual(self.convert(self.file("a.csv", text), "a.e57")["lost"], [])
        self.assertEqual(len(read_e57(self.path("a.e57"))[1]), 1)
        self.assertTrue(self.rows("a.e57")[1] == [(1, 2, i, i, 0, 5) for i in range(5000)])
        self.assertEqual(self.convert(self.path("a.csv"), "a.ptx")["lost"], ["x_origin", "y_origin", "z_origin"])

    def test_what_a_place_far_away_rounds_is_named(self):
        text = "x,y,z,x_origin,y_origin,z_origin\n0.1,0.2,0.3,1e9,0,0\n"
        for name in ["a.e57", "a.ptx"]:
            facts = self.convert(self.file("a.csv", text), name)
            self.assertEqual(facts["lost"], ["precision"])
            x = self.rows(name)[1][0][0]
            self.assertTrue(0 < abs(x - 0.1) <= facts["moved"] < 1e-6)

    def test_the_viewpoint_of_a_pcd_file(self):
        head = ("VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 1 2 3 %s\nPOINTS 1\n"
                "DATA ascii\n4 5 6\n")
        for turn, lost in [("1 0 0 0", []), ("0 1 0 0", ["turns of scanners"])]:
            self.assertEqual(self.convert(self.file("a.pcd", head % turn), "a.e57")["lost"], lost)
            self.assertEqual(read_e57(self.path("a.e57"))[1][0][1]["cartesianX"], [3])
            self.assertEqual(self.convert(self.path("a.pcd"), "a.ply")["lost"], ["viewpoint"])

    def test_no_points(self):
        for name in ["a.e57", "a.ptx"]:
            self.convert(self.file("a.xyz", ""), name)
            self.assertEqual(self.facts("info", self.path(name))["points"], 0)

    def test_a_pipe(self):
        self.usage("needs a file, no pipe", "convert", self.file("a.xyz", "1 2 3\n"), "-o", "-", "--format", "e57")
        run = self.expect(0, "convert", self.path("a.xyz"), "-o", "-", "--format", "ptx")
        self.assertEqual(run.text.splitlines()[:2], ["1", "1"])

    def test_coordinate_system(self):
        root = '<coordinateMetadata type="String">A[&lt;"b" &amp; c&gt;]</coordinateMetadata>'
        name = self.file("a.e57", whole_files.e57(whole_files.e57_axes(), 2, root=root))
        self.assertEqual(self.convert(name, "b.e57")["lost"], [])
        self.assertEqual(read_e57(self.path("b.e57"))[0].find(E57 + "coordinateMetadata").text, 'A[<"b" & c>]')

    def test_texts_that_are_no_xml(self):
        # a fuzzer's finding: bytes that are no UTF-8 made a file that no program reads
        wkt = b'A["\xe4\x01 & \xef\xbf\xbf"]\0'
        self.file("a.las", whole_files.las(minor=4, form=6, encoding=16, vlrs=[whole_files.vlr("LASF_Projection", 2112, wkt)]))
        self.convert(self.path("a.las"), "b.e57")
        self.assertEqual(read_e57(self.path("b.e57"))[0].find(E57 + "coordinateMetadata").text, 'A["\u00e4? & ?"]')

    def test_more_than_a_block_of_points_streams(self):
        text = "x,y,z,intensity\n" + "".join("%d,0,1,%d\n" % (i, i % 7) for i in range(70000))
        facts = self.convert(self.file("a.csv", text), "a.e57")
        self.assertTrue(facts["streamed"])
        self.assertEqual(self.facts("info", self.path("a.e57"))["points"], 70000)


class Grids(ScansTest):
    TEXT = "x,y,z,intensity,row_index,column_index\n"

    def lines(self, name):
        with open(self.path(name)) as file:
            return file.read().splitlines()

    def test_a_grid_with_holes(self):
        facts = self.convert(self.file("a.csv", self.TEXT + "1,2,3,0.5,1,0\n4,5,6,0.25,0,2\n"), "a.ptx")
        self.assertEqual(facts["lost"], [])
        lines = self.lines("a.ptx")
        self.assertEqual(lines[:2], ["3", "2"])
        self.assertEqual(lines[10:], ["0 0 0 0.5", "1 2 3 0.5", "0 0 0 0.5", "0 0 0 0.5", "4 5 6 0.25", "0 0 0 0.5"])
        self.assertEqual(self.convert(self.path("a.ptx"), "a.e57")["lost"], [])
        names, rows = self.rows("a.e57")
        self.assertEqual([dict(zip(names, row))["row_index"] for row in rows], [1, 0])
        self.assertEqual([dict(zip(names, row))["column_index"] for row in rows], [0, 2])

    def test_what_is_no_grid_is_a_row(self):
        for rows in ["1,2,3,1,0,1\n4,5,6,1,0,0\n",  # not column by column
                     "1,2,3,1,0,0\n4,5,6,1,0,0\n",  # a place twice
                     "1,2,3,1,0.5,0\n4,5,6,1,1,0\n",  # a fraction
                     "1,2,3,1,0,0\n4,5,6,1,9,999999\n"]:  # nearly empty
            facts = self.convert(self.file("a.csv", self.TEXT + rows), "a.ptx")
            self.assertEqual(facts["lost"], ["row_index", "column_index"], rows)
            self.assertEqual(self.lines("a.ptx")[:2], ["2", "1"])

    def test_a_point_at_the_scanner_is_no_missing_one(self):
        facts = self.convert(self.file("a.csv", self.TEXT + "0,0,0,1,0,0\n1,2,3,1,1,0\n"), "a.ptx")
        self.assertEqual((facts["lost"], facts["moved"] < 1e-29), (["precision"], True))
        self.assertEqual(len(self.rows("a.ptx")[1]), 2)

    def test_what_ptx_has_no_place_for_is_named(self):
        text = "x,y,z,red,green,blue,alpha,heat\n1,2,3,4,5,6,7,8\n"
        self.assertEqual(self.convert(self.file("a.csv", text), "a.ptx")["lost"], ["alpha", "heat"])
        self.assertEqual(self.lines("a.ptx")[10], "1 2 3 0.5 4 5 6")

    def test_scans_of_one_place_are_named(self):
        self.convert(self.file("a.csv", "x,y,z\n1,2,3\n"), "a.ptx")
        self.file("b.ptx", 2 * ("\n".join(self.lines("a.ptx")) + "\n"))
        self.assertEqual(self.convert(self.path("b.ptx"), "b.csv")["lost"], ["scans"])
        self.assertEqual(self.convert(self.path("b.ptx"), "b.e57")["lost"], ["scans"])


class Millimetres(ScansTest):
    """Coordinates of a survey keep their last millimetre in every format, or `lost` has precision and `moved` how far."""

    def test_every_format(self):
        points = [tuple(round(origin + k * step, 3) for origin in UTM) for k, step in enumerate([0, 0.001, 1.234, 7777.777])]
        self.xyz("survey.xyz", points)
        held = {e: kind["holds"] for kind in formats.formats() for e in formats.written_of(kind) if e != "stl"}
        for extension, holds in held.items():
            for options in [[], ["--float32"]]:
                facts = self.convert(self.path("survey.xyz"), "a." + extension, *options)
                found = [row[:3] for row in self.rows("a." + extension)[1]]
                moved = max(abs(a - b) for p, q in zip(points, found) for a, b in zip(p, q))
                self.assertEqual("precision" in facts["lost"], moved > 0, (extension, options))
                self.assertLessEqual(moved, facts.get("moved", 0) * (1 + 1e-12), (extension, options))
                if not options and "doubles" in holds:
                    self.assertEqual(moved, 0, extension)
                elif not options and "singles" not in holds:  # the steps of LAS are decimal, doubles are not
                    self.assertLessEqual(moved, 1e-9, extension)


if __name__ == "__main__":
    main()
