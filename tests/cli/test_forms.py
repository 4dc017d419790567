"""Forms of E57, NPY, glTF and VTK's files that other programs write."""

import json
import os
import struct

import whole_files
from brio_cli import CliTest, main
from whole_files import DOUBLE, doubles

SHARED = os.path.join(os.environ.get("BRIO_SHARED", ""), "repro")
POSE = ('<pose type="Structure"><rotation type="Structure"><w>%s</w></rotation><translation type="Structure"><x>10</x>'
        '</translation></pose>')


class FormsTest(CliTest):
    def rows(self, content, name="a.e57", *options):
        """The rows of a file as text, and what convert says of it."""
        path = name if content is None else self.file(name, content)
        facts = self.facts("convert", path, self.path("out.csv"), "--quiet", *options)
        with open(self.path("out.csv")) as f:
            names, *rows = f.read().splitlines()
        return [tuple(map(float, row.split(","))) for row in rows], names.split(","), facts


class E57(FormsTest):
    BOTH = [(1, 3, 5), (2, 4, 6)]

    def test_states_of_any_type(self):
        forms = ['type="Integer" minimum="0" maximum="2"', 'type="Integer" minimum="0" maximum="65535"', 'type="Integer"',
                 'type="ScaledInteger" minimum="0" maximum="255" scale="0.5"', 'type="Float" precision="single"', DOUBLE]
        zero_and_two = [b"\x08", struct.pack("<2H", 0, 2), struct.pack("<2Q", 1 << 63, 2 + (1 << 63)), b"\0\2",
                        struct.pack("<2f", 0, 2), doubles(0, 2)]
        for kind in ["cartesian", "spherical"]:
            axes = whole_files.e57_axes(kind, ["Range", "Azimuth", "Elevation"] if kind == "spherical" else "XYZ")
            for attributes, stream in zip(forms, zero_and_two):
                rows, _, _ = self.rows(whole_files.e57(axes + [(kind + "InvalidState", attributes, stream)], 2))
                self.assertEqual(len(rows), 1, attributes)
                if kind == "cartesian":
                    self.assertEqual(rows, [(1, 3, 5)], attributes)

    def test_sections_without_a_length(self):
        for length in [0, 32, None]:
            self.assertEqual(self.rows(whole_files.e57(whole_files.e57_axes(), 2, length=length))[0], self.BOTH)
        self.bad_input("a section of 31 bytes", "info",
                       self.file("a.e57", whole_files.e57(whole_files.e57_axes(), 2, length=31)))
        self.bad_input("need more than the", "info",
                       self.file("a.e57", whole_files.e57(whole_files.e57_axes(), 2000, length=0)))

    def test_zero_bytes_behind_the_xml(self):
        for count in [1, 4, 70000]:
            self.assertEqual(self.rows(whole_files.e57(whole_files.e57_axes(), 2, behind=b"\0" * count))[0], self.BOTH)
        self.bad_input("XML section", "info",
                       self.file("a.e57", whole_files.e57(whole_files.e57_axes(), 2, behind=b"\0\0x")))

    def test_whole_numbers_with_a_decimal_point(self):
        for bounds in [("0", "255"), ("0.0", "255.0"), ("0e0", "2.55e2")]:
            field = ("intensity", 'type="Integer" minimum="%s" maximum="%s"' % bounds, b"\7\xff")
            self.assertEqual([row[3] for row in self.rows(whole_files.e57(whole_files.e57_axes() + [field], 2))[0]], [7, 255])
        for bounds in [("0.5", "255"), ("0", "1e19"), ("0", "nan")]:
            field = ("intensity", 'type="Integer" minimum="%s" maximum="%s"' % bounds, b"\7\xff")
            self.bad_input("expected a whole number", "info",
                           self.file("a.e57", whole_files.e57(whole_files.e57_axes() + [field], 2)))

    def test_a_quaternion_of_zero_does_not_turn(self):
        for w in ["0", "1", "1e200"]:
            rows, _, facts = self.rows(whole_files.e57(whole_files.e57_axes(), 2, POSE % w))
            self.assertEqual(rows, [(11, 3, 5), (12, 4, 6)], w)
            self.assertEqual(facts["lost"], ["poses"])

    def test_points_that_are_not_finite(self):
        nan = float("nan")
        fields = [("cartesian" + name, DOUBLE, doubles(1, nan)) for name in "XYZ"]
        content = whole_files.e57(fields, 2)
        self.bad_input("point 1: x is NaN", "info", self.file("a.e57", content))
        rows, _, facts = self.rows(content, "a.e57", "--drop-invalid")
        self.assertEqual((rows, facts["dropped"]), ([(1, 1, 1)], 1))

    def test_a_coordinate_system_is_kept(self):
        root = '<coordinateMetadata type="String"><![CDATA[PROJCS["UTM"]]]></coordinateMetadata>'
        name = self.file("a.e57", whole_files.e57(whole_files.e57_axes(), 2, root=root))
        self.assertEqual(self.facts("info", name)["crs"], {"wkt": 'PROJCS["UTM"]'})
        name = self.file("b.e57", whole_files.e57(whole_files.e57_axes(), 2, root=root.replace('PROJCS["UTM"]', " ")))
        self.assertNotIn("crs", self.facts("info", name))

    def test_files_of_the_field(self):
        if not os.path.isdir(SHARED):
            self.skipTest("skipped: no shared files")
        for name, points in [("state16", 4), ("state_no_bounds", 4), ("state_scaled", 4), ("state_float", 4), ("length0", 12),
                             ("length32", 12), ("zeros_behind", 12), ("bounds_real", 12), ("no_turn", 12)]:
            facts = self.facts("info", os.path.join(SHARED, "field", "f23_%s.e57" % name))
            self.assertEqual(facts["points"], points, name)


class NumPy(FormsTest):
    def test_capital_letters(self):
        rows, names, _ = self.rows(whole_files.npy([("X", "<f4"), ("Z", "<f4"), ("Y", "<f4")], (1,), struct.pack("<3f", 1, 3, 2)),
                                   "a.npy")
        self.assertEqual((rows, names), ([(1, 2, 3)], ["x", "y", "z"]))
        both = whole_files.npy([(n, "<f4") for n in "xyzX"], (1,), struct.pack("<4f", 1, 2, 3, 4))
        self.assertEqual(self.rows(both, "b.npy")[1][3], "X_2")

    def test_fields_of_several_numbers(self):
        for name, other in [("xyz", "normals"), ("Position", "normal")]:
            rows, names, _ = self.rows(whole_files.npy([(name, "<f4", (3,)), (other, "<f8", 3)], (1,),
                                                       struct.pack("<3f3d", 1, 2, 3, 0, 0, 1)), "a.npy")
            self.assertEqual((rows, names), ([(1, 2, 3, 0, 0, 1)], "x y z nx ny nz".split()))
        rows, names, _ = self.rows(whole_files.npy([(n, "<f4") for n in "xyz"] + [("m", "|u1", (2, 2))], (1,),
                                                   struct.pack("<3f4B", 1, 2, 3, 4, 5, 6, 7)), "a.npy")
        self.assertEqual(rows, [(1, 2, 3, 4, 5, 6, 7)])

    def test_titles_and_objects(self):
        titled = [(("the place", "x"), "<f8"), ("y", "<f8"), ("z", "<f8")]
        self.assertEqual(self.rows(whole_files.npy(titled, (1,), doubles(1, 2, 3)), "a.npy")[0], [(1, 2, 3)])
        objects = [(n, "<f8") for n in "xyz"] + [("o", "|O")]
        self.bad_input("a type", "info", self.file("b.npy", whole_files.npy(objects, (1,), doubles(1, 2, 3, 0))))

    def test_integers_that_a_double_holds_are_not_lost(self):
        for value, lost in [(2**53, []), (2**53 + 1, ["integers beyond 2^53"]), (2**60, []), (2**64 - 1, ["integers beyond 2^53"])]:
            descr = [(n, "<f8") for n in "xyz"] + [("id", "<u8")]
            content = whole_files.npy(descr, (1,), doubles(1, 2, 3) + struct.pack("<Q", value))
            self.assertEqual(self.rows(content, "a.npy")[2]["lost"], lost, value)
            array = '<DataArray type="UInt64" Name="id" format="ascii">%d</DataArray>' % value
            name = self.file("a.vtp", '<VTKFile type="PolyData" byte_order="LittleEndian"><PolyData><Piece NumberOfPoints="1">'
                             '<PointData>%s</PointData><Points><DataArray type="Int8" NumberOfComponents="3" format="ascii">1 2 3'
                             '</DataArray></Points></Piece></PolyData></VTKFile>' % array)
            self.assertEqual(self.facts("info", name).get("left_out", []), lost, value)
            field = ("id", 'type="Integer" minimum="0"', struct.pack("<Q", value % 2**63) * 2)
            facts = self.facts("info", self.file("a.e57", whole_files.e57(whole_files.e57_axes() + [field], 2)))
            self.assertEqual(facts.get("left_out", []), lost, value)


class BesideTheFile(FormsTest):
    """Buffers of glTF in other files."""

    def scene(self, uri, size=36):
        return self.file("scene/a.gltf", json.dumps(whole_files.gltf(uri, size)))

    def setUp(self):
        super().setUp()
        os.makedirs(self.path("scene/below"))
        for name in ["scene/a.bin", "scene/below/a b%.bin", "outside.bin"]:
            self.file(name, whole_files.TRIANGLE)

    def test_buffers_beside_the_file_and_below(self):
        for uri in ["a.bin", "./a.bin", "below/a%20b%25.bin", "below/a b%.bin", "%61.bin"]:
            self.assertEqual(self.facts("info", self.scene(uri))["points"], 3, uri)

    def test_buffers_anywhere_else(self):
        for uri in ["../outside.bin", "below/../../outside.bin", "%2e%2e/outside.bin", "..%2foutside.bin", "/etc/passwd",
                    "file:///etc/passwd", "http://localhost/a.bin", "a.bin%00", "", "..\\outside.bin"]:
            self.bad_input("expected a file in the folder of the glTF file", "info", self.scene(uri))

    def test_buffers_that_are_not_there_or_too_short(self):
        run = self.expect(2, "info", self.scene("none.bin"))
        self.assertRegex(run.err, r"buffers\[0\] is in .*none.bin: No such file")
        self.bad_input("has 37 bytes, the file .* has 36", "info", self.scene("a.bin", 37))
        self.bad_input("no regular file", "info", self.scene("below"))
        os.mkfifo(self.path("scene/fifo"))
        self.bad_input("no regular file", "info", self.scene("fifo"))
        with open(self.scene("a.bin"), "rb") as f:
            self.bad_input("only found beside a file", "info", "-", "--input-format", "gltf", stdin=f.read())


class Vtk(FormsTest):
    def test_words_are_passed_over(self):
        facts = self.facts("info", self.file("a.vtp", whole_files.vtp_of_everything()))
        self.assertEqual((facts["points"], facts["faces"]), (5, 3))
        self.assertIn("label", facts["left_out"])

    def test_a_compressor_that_nothing_is_compressed_by(self):
        text = whole_files.vtp_of_everything()
        named = text.replace("byte_order", 'compressor="vtkLZ4DataCompressor" byte_order')
        self.assertEqual(self.facts("info", self.file("a.vtp", named))["points"], 5)
        self.bad_input("compressed by vtkLZ4DataCompressor", "info",
                       self.file("b.vtp", named.replace('format="ascii"', 'format="binary"')))

    def test_legacy_cells_of_both_kinds(self):
        lists = {b"VERTICES": [[0], [1, 2]], b"LINES": [[0, 1, 2]], b"POLYGONS": [[0, 1, 2], [1, 2, 3]],
                 b"TRIANGLE_STRIPS": [[0, 1, 2, 3]]}
        for fifth, version in [(False, b"2.0"), (False, b"4.2"), (True, b"5.1")]:
            cells = b"".join(whole_files.legacy_lists(name, cells, fifth) for name, cells in lists.items())
            name = self.file("a.vtk", whole_files.legacy(version, whole_files.LEGACY_POINTS + cells))
            run = self.facts("convert", name, self.path("out.vtk"), "--ascii")
            self.assertEqual((run["points"], run["faces"], run["lost"]), (4, 4, []))
            with open(self.path("out.vtk")) as f:
                text = f.read()
            cells = text.split("CELLS 6 22\n")[1].split("\n\n")[0].split("\n")
            self.assertEqual(cells, ["3 0 1 2", "3 1 3 2", "3 0 1 2", "3 1 2 3", "2 0 1", "2 1 2"])

    def test_legacy_files_that_lie(self):
        points, lists = whole_files.LEGACY_POINTS, whole_files.legacy_lists
        for data, message in [(b"POINTS 99999999 float\n", "the file"), (points + b"POLYGONS 9 3\n", "at least one number"),
                              (points + lists(b"POLYGONS", [[0, 1, 9]], False), "point 9, expected one of the 4"),
                              (points + b"POLYGONS 1 4\n" + struct.pack(">4i", 9, 0, 1, 2), "does not end within the list"),
                              (points + b"POLYGONS 1 4\n" + struct.pack(">4i", 2, 0, 1, 2), "1 cells of 3 numbers"),
                              (points + points, "one list of points"), (b"", "POINTS"), (points + b"THINGS 3\n", "a keyword")]:
            self.bad_input(message, "info", self.file("a.vtk", whole_files.legacy(b"3.0", data)))
        self.bad_input("a version from", "info", self.file("a.vtk", whole_files.legacy(b"6.0", points)))
        self.bad_input("POLYDATA or UNSTRUCTURED_GRID", "info",
                       self.file("a.vtk", whole_files.legacy(b"3.0", points, "STRUCTURED_POINTS")))

    def test_legacy_files_keep_what_is_written(self):
        points = self.file("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
                           "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\n"
                           "property float ny\nproperty float nz\nproperty uint heat\nend_header\n500000.123 1 2 1 2 3 0 0 1 4000000000\n"
                           "4 5 6 255 0 9 0 1 0 1\n7 8 9 0 0 0 1 0 0 2\n")
        for options in [[], ["--ascii"]]:
            self.assertEqual(self.facts("convert", points, self.path("out.vtk"), *options)["lost"], [])
            self.expect(0, "convert", self.path("out.vtk"), self.path("back.ply"), "--ascii")
            self.expect(0, "convert", points, self.path("same.ply"), "--ascii")
            with open(self.path("back.ply")) as back, open(self.path("same.ply")) as same:
                self.assertEqual(back.read(), same.read())


if __name__ == "__main__":
    main()
