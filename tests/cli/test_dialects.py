"""Dialects of texts of points, PLY, OBJ, OFF and PCD that other programs write."""

import os
import struct

from brio_cli import CliTest, main
from whole_files import described, las, vlr

SHARED = os.path.join(os.environ.get("BRIO_SHARED", ""), "repro")
FOUR = [(0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4)]
ROWS = "0 0 0\n2 0 0\n0 3 0\n0 0 4\n"
FACES = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"


class DialectTest(CliTest):
    def convert(self, name, content=None):
        """What a file becomes as text: the names, the rows, and the facts."""
        path = name if content is None else self.file(name, content)
        facts = self.facts("convert", path, self.path("out.csv"), "--quiet")
        with open(self.path("out.csv")) as f:
            names, *rows = f.read().splitlines()
        return names.split(","), [tuple(map(float, row.split(","))) for row in rows], facts

    def columns(self, *arguments):
        names, rows, _ = self.convert(*arguments)
        return dict(zip(names, zip(*rows)))

    def expect_four(self, *arguments):
        names, rows, facts = self.convert(*arguments)
        self.assertEqual([row[:3] for row in rows], FOUR)
        return names, rows, facts


class Texts(DialectTest):
    def test_a_colour_and_an_intensity_of_leica(self):
        row = "1 2 3 -900 0 255 77\n4 5 6 100 20 235 77\n"
        names, rows, _ = self.convert("a.pts", "2\n" + row)
        self.assertEqual(names, "x y z intensity red green blue".split())
        self.assertEqual(rows[1], (4, 5, 6, 100, 20, 235, 77))
        self.assertEqual(self.convert("b.pts", "1 2 3 -900\n")[0][3:], ["intensity"])
        self.assertEqual(self.convert("c.pts", "1 2 3 0 255 77\n")[0][3:], ["red", "green", "blue"])
        self.assertEqual(self.convert("d.pts", "1 2 3 0 -0.5 1\n")[0][3:], ["column4", "column5", "column6"])
        self.assertEqual(self.convert("e.xyz", "1 2 3 0 255 77\n")[0][3:], ["column4", "column5", "column6"])

    def test_fixed_columns_are_written_as_others_read_them(self):
        """A .pts file had a line of names and no number of points, .xyzrgb and .xyzn had all columns."""
        rows = "1,2,3,-900,0,255,77,0,0,1\n4.5,5,6,100,20,235,255,0,1,0\n"
        source = self.file("a.csv", "x,y,z,intensity,red,green,blue,nx,ny,nz\n" + rows)
        for name, lines, lost in (("pts", ["2", "1 2 3 -900 0 255 77", "4.5 5 6 100 20 235 255"], ["nx", "ny", "nz"]),
                                  ("xyzrgb", ["1 2 3 0 1 0.3019608", "4.5 5 6 0.078431375 0.92156863 1"],
                                   ["intensity", "nx", "ny", "nz"]),
                                  ("xyzn", ["1 2 3 0 0 1", "4.5 5 6 0 1 0"], ["intensity", "red", "green", "blue"])):
            facts = self.facts("convert", source, self.path("out." + name))
            with open(self.path("out." + name)) as file:
                self.assertEqual([line.rstrip() for line in file], lines, name)
            self.assertEqual(facts["lost"], lost)
            piped = self.expect(0, "convert", source, "-", "--format", name, "--quiet").out
            self.assertEqual(piped.decode().split("\n")[:-1], lines, name)

    def test_counts_before_every_block(self):
        self.assertEqual(len(self.convert("a.pts", "1\n1 2 3 4\n2\n5 6 7 8\n9 1 2 3\n")[1]), 3)
        self.bad_input("promises 3 points, 2 rows follow", "info", self.file("b.pts", "1\n1 2 3\n2\n4 5 6\n"))
        self.bad_input("expected 3 numbers, found 1", "info", self.file("c.pts", "2\n1 2 3\n2\n4 5 6\n"))

    def test_extensions(self):
        for name in ["a.asc", "a.dat", "a.tsv", "a.xyzrgb", "a.xyzn"]:
            self.assertEqual(len(self.convert(name, "1 2 3 0 0.5 1\n")[1]), 1)
        self.assertEqual(self.convert(self.path("a.xyzrgb"))[0][3:], ["red", "green", "blue"])
        self.assertEqual(self.convert(self.path("a.xyzn"))[0][3:], ["nx", "ny", "nz"])

    def test_quotes(self):
        self.assertEqual(self.convert("a.csv", '"x","y","z"\n"1.5","2.5","3.5"\n"2.5",3.5,"4.5"\n')[1],
                         [(1.5, 2.5, 3.5), (2.5, 3.5, 4.5)])

    def test_the_line_for_excel(self):
        self.assertEqual(self.convert("a.csv", "sep=;\nx;y;z\n1,5;2,5;3\n")[1], [(1.5, 2.5, 3)])
        self.bad_input("the separator |", "info", self.file("b.csv", "sep=|\nx|y|z\n1|2|3\n"))

    def test_an_empty_field_between_tabs_keeps_its_place(self):
        """The values behind it moved into its column."""
        columns = self.columns("a.tsv", "x\ty\tz\tPoint size\theat\n1\t2\t3\t4\t5\n6\t7\t8\t\t9\n")
        self.assertEqual(columns["heat"], (5, 9))
        self.assertEqual(columns["Point_size"][0], 4)
        self.assertNotEqual(columns["Point_size"][1], columns["Point_size"][1])

    def test_points_of_colmap(self):
        names, rows, facts = self.convert(
            "points3D.txt", "# 3D point list\n#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
            "# Number of points: 2\n11 1 2 3 0 255 77 0.2 1 0 2 1\n12 4 5 6 1 2 3 0.5 1 5 2 6 3 7\n")
        self.assertEqual(names, "x y z POINT3D_ID red green blue ERROR".split())
        self.assertEqual(rows[1], (4, 5, 6, 12, 1, 2, 3, 0.5))
        self.assertEqual(facts["lost"], ["tracks"])

    def test_names_of_colours_and_normals(self):
        for source, target in [("R G B", "red green blue"), ("r g b", "red green blue"), ("Rf Gf Bf", "red green blue"),
                               ("Red Green Blue", "red green blue"), ("Nx Ny Nz", "nx ny nz"),
                               ("normal_x normal_y normal_z", "nx ny nz"), ("r g bb", "r g bb"),
                               ("diffuse_red diffuse_green diffuse_blue", "red green blue")]:
            self.assertEqual(self.convert("a.txt", "//X Y Z %s\n1 2 3 0 0 1\n" % source)[0][3:], target.split())
        self.assertEqual(self.convert("b.txt", "x y z Intensity\n1 2 3 0\n")[0][3:], ["intensity"])
        self.assertEqual(self.convert("c.txt", "x y z R G B red\n1 2 3 0 0 0 1\n")[0][3:], "R G B red".split())

    def test_whole_numbers_beyond_the_bits_of_a_double_are_named(self):
        text = "x,y,z,id\n1,2,3,%d\n"
        self.assertEqual(self.convert("a.csv", text % (2**53 + 1))[2]["lost"], ["precision"])
        self.assertEqual(self.convert("b.csv", text % 2**60)[2]["lost"], [])
        for quoted in ['"%d"', '" -%d "']:  # numbers in quotes were rounded without a word
            self.assertEqual(self.convert("c.csv", text.replace("%d", quoted) % (2**53 + 1))[2]["lost"], ["precision"])
            self.assertEqual(self.convert("d.csv", text.replace("%d", quoted) % 2**60)[2]["lost"], [])

    def test_atoms_are_points_and_a_density(self):
        pdb = "ATOM      1  C   ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"
        self.assertEqual(self.facts("info", self.file("a.pdb", pdb))["points"], 1)
        self.expect(0, "iso", self.path("a.pdb"), "--level", "1", "-o", self.path("out.ply"))


class Ply(DialectTest):
    HEADER = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float %s\nproperty float %s\nproperty float %s\n"

    def test_blanks_in_the_header(self):
        self.expect_four("a.ply", (self.HEADER % tuple("xyz") + "end_header\n").replace("\n", " \n") + ROWS)

    def test_capitals(self):
        self.expect_four("a.ply", self.HEADER % tuple("XYZ") + "end_header\n" + ROWS)
        names, _, _ = self.convert("b.ply", (self.HEADER % tuple("xyz")).replace("vertex 4", "vertex 1") +
                                   "property float X\nend_header\n1 2 3 4\n")
        self.assertEqual(names[3:], ["X_2"])

    def test_strips_of_triangles(self):
        strip = self.HEADER % tuple("xyz") + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + ROWS
        for corners, faces in [("6 0 2 1 3 0 2", 4), ("7 0 2 1 -1 1 2 3", 2), ("5 0 2 1 1 3", 1), ("2 0 1", 0)]:
            facts = self.facts("convert", self.file("a.ply", strip + corners + "\n"), self.path("out.off"))
            self.assertEqual((facts["faces"], facts["lost"]), (faces, []), corners)
        self.expect(0, "convert", self.file("a.ply", strip + "6 0 2 1 3 0 2\n"), self.path("out.off"))
        facts = self.facts("check", self.path("out.off"))["certificate"]
        self.assertTrue(facts["closed"] and facts["oriented"])

    def test_lists_of_vertices_in_binary(self):
        header = ("ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                  "property float z\nproperty list uchar int view\nproperty uchar red\nelement face 0\n"
                  "property list ushort int vertex_indices\nend_header\n").encode()
        rows = struct.pack("<3fB2iB", 1, 2, 3, 2, 7, 8, 9) + struct.pack("<3fBB", 4, 5, 6, 0, 10)
        _, rows, facts = self.convert("a.ply", header + rows)
        self.assertEqual((rows, facts["lost"]), ([(1, 2, 3, 9), (4, 5, 6, 10)], ["view"]))


class Obj(DialectTest):
    def test_normals_before_every_vertex(self):
        columns = self.columns("a.obj", "vn 0 0 1\nv 0 0 0\nvn 0 1 0\nv 1 0 0\nvn 1 0 0\nv 0 1 0\nf 1//1 2//2 3//3\n")
        self.assertEqual(list(zip(columns["nx"], columns["ny"], columns["nz"])), [(0, 0, 1), (0, 1, 0), (1, 0, 0)])

    def test_normals_of_corners_that_differ_are_named(self):
        facts = self.convert("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 3//2 2//2 1//2\n")[2]
        self.assertIn("normals of corners", facts["lost"])

    def test_vertices_without_a_colour_are_white(self):
        for white, colour in [("1", "0.5 0 1"), ("255", "128 0 255")]:
            columns = self.columns("a.obj", "v 0 0 0\nv 1 0 0 %s\nv 0 1 0\n" % colour)
            self.assertEqual(columns["red"], (float(white), float(colour.split()[0]), float(white)))

    def test_colours_of_zbrush(self):
        columns = self.columns("a.obj", "v 0 0 0\nv 1 0 0\n#MRGB ff336699ffFF0001\n")
        self.assertEqual((columns["red"], columns["green"], columns["blue"]), ((51, 255), (102, 0), (153, 1)))
        self.assertEqual(self.convert("b.obj", "v 0 0 0\nv 1 0 0\n#MRGB ff336699\n")[2]["lost"], ["#MRGB"])

    def test_indices_that_count_backwards_and_lines_that_continue(self):
        self.convert("a.obj", "o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 \\\n -1\no two\nv 0 0 1\nf -4 -3 \\\n-1\n")
        self.expect(0, "convert", self.path("a.obj"), self.path("out.off"))
        with open(self.path("out.off")) as f:
            self.assertEqual(f.read().splitlines()[-2:], ["3 0 1 2", "3 0 1 3"])

    def test_colours_and_normals_are_written(self):
        text = "x,y,z,red,green,blue,nx,ny,nz\n0,0,0,255,0,51,0,0,1\n1,0,0,0,102,255,0,1,0\n"
        self.expect(0, "convert", self.file("a.csv", text), self.path("out.ply"))
        facts = self.facts("convert", self.path("out.ply"), self.path("out.obj"))
        self.assertEqual(facts["lost"], [])
        self.expect(0, "convert", self.path("out.obj"), self.path("back.ply"), "--ascii")
        with open(self.path("back.ply")) as f:
            self.assertEqual(f.read().splitlines()[-2:], ["0 0 0 255 0 51 0 0 1", "1 0 0 0 102 255 0 1 0"])


class Off(DialectTest):
    def test_counts_at_the_keyword(self):
        facts = self.expect_four("a.off", "OFF4 4 0\n" + ROWS + FACES)[2]
        self.assertEqual(facts["lost"], ["faces"])

    def test_letters_in_any_order(self):
        for keyword in ["NCOFF", "CNOFF"]:
            self.assertEqual(self.convert("a.off", keyword + "\n1 0 0\n1 2 3 0 0 1 0.5 0.5 0.5 1\n")[0][3:],
                             "nx ny nz red green blue alpha".split())

    def test_colours_behind_the_coordinates(self):
        self.assertEqual(self.convert("a.off", "OFF\n1 0 0\n1 2 3 255 0 7 255\n")[0][3:], "red green blue alpha".split())
        self.assertEqual(self.convert("b.off", "OFF\n1 0 0\n1 2 3 0.1 0.2\n")[2]["lost"], ["numbers behind the coordinates"])

    def test_binary(self):
        data = b"COFF BINARY\n" + struct.pack(">3i", 3, 1, 0)
        data += b"".join(struct.pack(">7f", *p, 1, 0.5, 0, 1) for p in FOUR[:3]) + struct.pack(">6i", 3, 0, 1, 2, 1, 0)
        names, rows, facts = self.convert("a.off", data)
        self.assertEqual((names[3:], rows[1]), ("red green blue alpha".split(), (2, 0, 0, 1, 0.5, 0, 1)))
        self.assertEqual(facts["lost"], ["faces", "colours of faces"])
        self.bad_input("ends", "info", self.file("b.off", data[:-6]))


class Pcd(DialectTest):
    HEADER = ("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS %s\nSIZE %s\nTYPE %s\nCOUNT %s\nWIDTH 4\n"
              "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA %s\n")

    def test_capitals_and_small_letters_of_types(self):
        self.expect_four("a.pcd", self.HEADER % ("X Y Z", "4 4 4", "F F F", "1 1 1", "ascii") + ROWS)
        self.expect_four("b.pcd", self.HEADER % ("x y z", "4 4 4", "f f f", "1 1 1", "ascii") + ROWS)

    def test_fields_of_no_numbers_and_of_one_name(self):
        head = self.HEADER % ("x y z a _ a", "4 4 4 1 1 2", "F F F U U U", "1 1 1 1 0 1", "binary")
        names, rows, _ = self.expect_four("a.pcd", head.encode() + b"".join(struct.pack("<3fBH", *p, 7, 9) for p in FOUR))
        self.assertEqual((names[3:], rows[0][3:]), (["a", "a_2"], (7, 9)))

    def test_data_that_compression_did_not_make_smaller(self):
        data = b"".join(struct.pack("<4f", *axis) for axis in zip(*FOUR))
        head = self.HEADER % ("x y z", "4 4 4", "F F F", "1 1 1", "binary_compressed")
        self.expect_four("a.pcd", head.encode() + struct.pack("<2I", len(data), len(data)) + data)
        self.bad_input("damaged", "info",
                       self.file("b.pcd", head.encode() + struct.pack("<2I", len(data) - 1, len(data)) + data[:-1]))

    def test_viewpoint_and_rows_are_named(self):
        text = (self.HEADER % ("x y z", "4 4 4", "F F F", "1 1 1", "ascii") + ROWS).replace("WIDTH 4", "WIDTH 2")
        facts = self.convert("a.pcd", text.replace("HEIGHT 1", "HEIGHT 2").replace("VIEWPOINT 0", "VIEWPOINT 5"))[2]
        self.assertEqual(facts["lost"], ["viewpoint", "order in rows"])

    def test_what_is_written_reads_back(self):
        text = "x,y,z,red,green,blue,nx,ny,nz,heat,rgb\n" + "".join(
            "%r,%r,%d,%d,0,255,0,0,1,%r,3\n" % (i / 7, -i / 3, i, i % 256, i / 9) for i in range(3000))
        self.expect(0, "convert", self.file("a.csv", text), self.path("a.ply"))
        before = self.columns(self.path("a.ply"))
        for options in [[], ["--ascii"], ["--compress"]]:
            facts = self.facts("convert", self.path("a.ply"), self.path("a.pcd"), *options)
            self.assertEqual((facts["lost"], facts["renamed"]), ([], ["rgb"]))
            after = self.columns(self.path("a.pcd"))
            self.assertEqual(after.pop("rgb_2"), before["rgb"])
            self.assertEqual(after, {name: values for name, values in before.items() if name != "rgb"}, options)

    def test_a_pipe_as_output(self):
        run = self.expect(0, "convert", self.file("a.xyz", ROWS), "-o", "-", "--format", "pcd", "--ascii")
        self.expect_four("b.pcd", run.out)


class Trackers(DialectTest):
    """Files that the public trackers of laspy, pylas, plyfile's readers, PCL, meshio, trimesh and assimp tell of."""

    PLY = "ply\nformat ascii 1.0\nelement vertex 4\n%sproperty float x\nproperty float y\nproperty float z\n%send_header\n"
    VTU = ('<VTKFile type="UnstructuredGrid"><UnstructuredGrid>%s</UnstructuredGrid></VTKFile>')
    PIECE = ('<Piece NumberOfPoints="4" NumberOfCells="1"><Points><DataArray type="Float32" NumberOfComponents="3" '
             'format="ascii">0 0 0 2 0 0 0 3 0 0 0 4</DataArray></Points><Cells><DataArray type="Int32" Name="connectivity" '
             'format="ascii">0 1 2 3</DataArray><DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>'
             '<DataArray type="UInt8" Name="types" format="ascii">6</DataArray></Cells></Piece>')
    VTK = "# vtk DataFile Version %s\nvtk output\nASCII\nDATASET %s\nPOINTS 4 float\n0 0 0 2 0 0 0 3 0\n0 0 4\n%s"

    def faces(self, name, content):
        return self.facts("convert", self.file(name, content), self.path("out.ply"), "--quiet")["faces"]

    def test_comments_of_ply(self):
        # assimp, CloudCompare: a comment between an element and its properties, and comments without a word
        self.expect_four("a.ply", self.PLY % ("comment Points\ncomment\n", "obj_info\n") + ROWS)

    def test_elements_behind_the_vertices(self):
        # PCL, miniply: a camera, whose row has no line feed; elements of one program; an element without properties
        camera = "element camera 1\nproperty float view_px\nproperty int viewportx\nelement nothing 3\n"
        self.assertEqual(self.expect_four("a.ply", self.PLY % ("", camera) + ROWS + "0.5 640")[2]["lost"], ["camera"])

    def test_bytes_behind_the_announced_rows(self):
        # trimesh: a binary file that is longer than its header says
        head = (self.PLY % ("", "")).replace("ascii", "binary_little_endian").encode()
        self.expect_four("a.ply", head + b"".join(struct.pack("<3f", *p) for p in FOUR) + b"\n\0\0")

    def test_a_last_row_that_lacks_a_colour(self):
        # PCL: the last row of a depth camera's file
        head = (self.PLY % ("", "property uchar red\nproperty uchar green\n")).replace("vertex 4", "vertex 2")
        name = self.file("a.ply", head + "1 2 3 4 5 \n509.09079 -291.39304 -1129.5593 212 ")
        self.bad_input("ends at byte", "info", name)
        facts = self.facts("info", name, "--salvage")
        self.assertEqual((facts["points"], facts["missing"]), (1, 1))

    def test_an_index_that_is_no_number(self):
        # trimesh: the last face of a file has NaN
        self.bad_input("face 0 .*: nan is not the index", "info", self.file(
            "a.ply", self.PLY % ("", "element face 1\nproperty list uchar int vertex_index\n") + ROWS + "3 0 1 nan\n"))

    def test_headers_of_las_that_are_short_or_contradict_the_points(self):
        # LAStools: versions 1.3 and 1.4 with the header of 1.2; laspy, pylas: records longer or shorter than what is described
        for minor in (3, 4):
            content = bytearray(las(form=1))
            content[25] = minor
            self.assertEqual(len(self.convert("a.las", bytes(content))[1]), 4)
        facts = self.convert("b.las", las(form=6, minor=4, extra=lambda i: struct.pack("<I", i)))[2]
        self.assertIn("extra bytes that nothing describes", facts["lost"])
        both = vlr("LASF_Spec", 4, described("Amplitude", 3) + described("Reflectance", 4))
        facts = self.convert("c.las", las(form=3, vlrs=[both]))[2]
        self.assertIn("Amplitude (not in the records)", facts["lost"])
        # rlas: names and texts without the 0 at their end; the working group: a count of points of versions before 1.4, too
        whole = vlr("LASF_Spec", 4, described("n" * 32, 9, text="d" * 32))
        content = bytearray(las(form=6, minor=4, extra=lambda i: struct.pack("<f", i), vlrs=[whole]))
        content[107:111] = struct.pack("<I", 4)
        self.assertEqual(self.columns("d.las", bytes(content))["n" * 32], (0, 1, 2, 3))

    def test_a_las_file_with_fewer_points_than_announced(self):
        # laspy, twice
        name = self.file("a.las", las(n=100)[:-500])
        self.bad_input("the header promises", "info", name)
        facts = self.facts("info", name, "--salvage")
        self.assertEqual((facts["points"], facts["missing"]), (75, 25))

    def test_pcd_whose_first_number_is_a_word_of_the_header(self):
        # PCL: the float 13.26593 has the bytes of DATA
        head = Pcd.HEADER % ("x y z", "4 4 4", "F F F", "1 1 1", "binary")
        content = head.encode() + b"DATA" + struct.pack("<11f", *range(11))
        self.assertEqual(self.convert("a.pcd", content)[1][0], (struct.unpack("<f", b"DATA")[0], 0, 1))

    def test_pcd_headers_that_lack_a_column(self):
        # Livox's tools
        head = (Pcd.HEADER % ("x y z intensity class", "4 4 4 4", "F F F F", "1 1 1 1", "ascii"))
        self.bad_input("expected a size .* for each field", "info", self.file("a.pcd", head + "1 2 3 4 5\n"))

    def test_sections_of_legacy_vtk(self):
        # meshio, vtkio: METADATA, OFFSETS and CONNECTIVITY of version 5, polygons, strips; lines that end as on Windows
        metadata = "\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 4\n\n"
        new = "POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 1 2 0 1 3\n"
        for kind, rest, faces in [("POLYDATA", new, 2), ("POLYDATA", "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n", 2),
                                  ("UNSTRUCTURED_GRID", metadata + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n", 1)]:
            text = self.VTK % ("5.1" if rest is new else "4.2", kind, rest)
            self.assertEqual(self.faces("a.vtk", text), faces, rest)
            self.assertEqual(self.faces("b.vtk", text.replace("\n", "\r\n")), faces, rest)

    def test_long_names_of_other_alphabets_in_legacy_vtk(self):
        """brio did not read the names that it wrote: each byte of them takes three characters."""
        name = "\u0436" * 31
        self.file("a.csv", "x,y,z,%s\n1,2,3,4\n" % name)
        self.expect(0, "convert", self.path("a.csv"), self.path("a.vtk"))
        self.assertEqual(self.columns(self.path("a.vtk"))[name], (4,))

    def test_vtu_of_few_attributes_strips_and_pieces(self):
        # meshio: no version, and no order of bytes, which text has not; a strip; more than one piece
        self.assertEqual(self.faces("a.vtu", self.VTU % self.PIECE), 2)
        self.assertEqual(self.faces("b.vtu", self.VTU % (self.PIECE * 3)), 6)


class Colours(DialectTest):
    def test_the_whole_file_tells_the_depth(self):
        """70,000 rows: the first block has no value beyond 1."""
        text = "x,y,z,R,G,B\n" + "1,2,3,1,0,1\n" * 70000 + "1,2,3,255,0,1\n"
        self.expect(0, "convert", self.file("a.csv", text), self.path("out.ply"), "--ascii")
        with open(self.path("out.ply")) as f:
            rows = f.read().splitlines()
        self.assertEqual((rows[-2], rows[-1]), ("1 2 3 1 0 1", "1 2 3 255 0 1"))
        run = self.expect(2, "convert", "-", self.path("pipe.ply"), stdin=text.encode())
        self.assertIn("has to be a file", run.err)

    def test_a_loss_of_depth_is_named(self):
        for values, lost in [("0.2,0.4,1", []), ("0.25,0,0", ["colour depth"]), ("65535,257,0", []), ("65280,256,0", []),
                             ("65535,258,0", ["colour depth"]), ("255,128,0", [])]:
            self.file("a.csv", "x,y,z,red,green,blue\n1,2,3,%s\n" % values)
            self.assertEqual(self.facts("convert", self.path("a.csv"), self.path("out.ply"))["lost"], lost, values)

    def test_numbers_that_are_no_colours_stay(self):
        self.file("a.csv", "x,y,z,red,green,blue\n1,2,3,-5,70000,0\n")
        self.expect(0, "convert", self.path("a.csv"), self.path("out.ply"), "--ascii")
        with open(self.path("out.ply")) as f:
            self.assertEqual(f.read().splitlines()[-1], "1 2 3 -5 70000 0")


class Reported(DialectTest):
    """Files of the folder of faults, where it is."""

    def test_files_that_were_refused(self):
        points = {"field/f16_capital.pcd": 12, "field/f17_blank.ply": 4, "field/f17_blank_binary.ply": 4,
                  "field/f17_capital_xyz.ply": 4, "field/f18_rf.asc": 12, "field/f18_normals.asc": 12,
                  "field/f18_count.asc": 12, "field/f19_two_scans.pts": 12, "field/f20_points3D.txt": 12,
                  "reports/count0.pcd": 4, "reports/upper.pcd": 4, "reports/lowertype.pcd": 4, "reports/modelnet.off": 4,
                  "reports/quoted.csv": 2}
        if not os.path.isdir(SHARED):
            self.skipTest("there is no folder of faults")
        for name, count in points.items():
            self.assertEqual(self.facts("info", os.path.join(SHARED, name))["points"], count, name)


if __name__ == "__main__":
    main()
