"""Every file of shared/repro/reports, field and attack, small files that showed faults: its right values, or its sentence.

A file without a row fails the test. A program among them has the names of the tests that hold what it shows, which have
to exist.
"""

import csv
import os
import re
import struct
import unittest

from brio_cli import CliTest, main

PROJECT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
REPRO = os.path.join(os.environ.get("BRIO_SHARED") or os.path.join(PROJECT, "..", "shared"), "repro")
FOLDERS = ["reports", "field", "attack"]

ATOMS = {"atomic_number", "radius", "occupancy", "temperature_factor", "residue"}
ATOMS_LEFT_OUT = {"HEADER", "names of atoms", "names of residues", "chains"}
COLOURS = {"red", "green", "blue"}
PROGRAM, HELPER = "program", "helper"

# file: (points, faces, properties that must be there, what `info` says is left out), or the sentence of a refusal.
FILES = {
    "reports/chunk0.laz": (10, 0, {"intensity"}, set()),
    "reports/colours.obj": (4, 4, COLOURS, set()),
    "reports/count0.pcd": (4, 0, {"ring"}, set()),
    "reports/flat_at.csv": (2, 0, set(), set()),
    "reports/flat_stations.csv": (4, 0, {"temperature"}, set()),
    "reports/infrow.ply": r"point 0: x is infinite \(1 such point in all\)",
    "reports/lowertype.pcd": (4, 0, {"ring"}, set()),
    "reports/modelnet.off": (4, 4, set(), set()),
    "reports/nanrow.ply": r"point 1: x is NaN \(1 such point in all\)",
    "reports/pdal.npy": (4, 0, {"intensity"}, set()),
    "reports/prism.off": (66, 128, set(), set()),
    "reports/quoted.csv": (2, 0, set(), set()),
    "reports/split_cube.obj": (24, 6, set(), set()),
    "reports/string_array.vtp": (3, 1, set(), {"label"}),
    "reports/tristrips.ply": (4, 4, set(), set()),
    "reports/truncated.las": r"the header promises at least 46 bytes after byte 719, the file has 36",
    "reports/two_extra_vlrs.las": (2, 0, {"deviation", "confidence"}, set()),
    "reports/upper.pcd": (4, 0, set(), set()),
    "reports/voro_ids.xyz": (5, 0, {"column4"}, set()),
    "field/f11_above.e57": (144, 0, set(), {"names of scans", "poses"}),
    "field/f11_above.pcd": (144, 0, set(), {"viewpoint"}),
    "field/f11_above.ply": (144, 0, {"nx", "ny", "nz"}, set()),
    "field/f11_above.ptx": (144, 0, {"intensity"}, {"order in rows", "poses"}),
    "field/f11_below.e57": (144, 0, set(), {"names of scans", "poses"}),
    "field/f11_below.pcd": (144, 0, set(), {"viewpoint"}),
    "field/f11_below.ply": (144, 0, {"nx", "ny", "nz"}, set()),
    "field/f11_below.ptx": (144, 0, {"intensity"}, {"order in rows", "poses"}),
    "field/f16_capital.pcd": (12, 0, {"intensity"}, set()),
    "field/f17_blank.ply": (4, 0, set(), set()),
    "field/f17_blank_binary.ply": (4, 0, set(), set()),
    "field/f17_capital_xyz.ply": (4, 0, set(), set()),
    "field/f18_count.asc": (12, 0, COLOURS, set()),
    "field/f18_normals.asc": (12, 0, {"column4", "column5", "column6"}, set()),
    "field/f18_rf.asc": (12, 0, COLOURS, set()),
    "field/f18_rf.txt": (12, 0, COLOURS | {"intensity"}, set()),
    "field/f19_leica.pts": (12, 0, COLOURS | {"intensity"}, set()),
    "field/f19_leica4.pts": (12, 0, {"intensity"}, set()),
    "field/f19_leica6.pts": (12, 0, COLOURS, set()),
    "field/f19_two_scans.pts": (12, 0, COLOURS | {"intensity"}, set()),
    "field/f20_points3D.txt": (12, 0, COLOURS, {"tracks"}),
    "field/f21_atoms.ent": (12, 0, ATOMS, ATOMS_LEFT_OUT - {"HEADER"}),
    "field/f21_atoms.pdb": (12, 0, ATOMS, ATOMS_LEFT_OUT),
    "field/f22_las15.las": (12, 0, {"gps_time"}, set()),
    "field/f22_las15_7.las": (12, 0, COLOURS, set()),
    "field/f23_bounds_real.e57": (12, 0, {"intensity"}, {"names of scans"}),
    "field/f23_length0.e57": (12, 0, set(), {"names of scans"}),
    "field/f23_length32.e57": (12, 0, set(), {"names of scans"}),
    "field/f23_nan.e57": r"point 1: x is NaN \(4 such points in all\)",
    "field/f23_no_turn.e57": (12, 0, set(), {"names of scans", "poses"}),
    "field/f23_state16.e57": (4, 0, set(), {"names of scans"}),
    "field/f23_state_float.e57": (4, 0, set(), {"names of scans"}),
    "field/f23_state_no_bounds.e57": (4, 0, set(), {"names of scans"}),
    "field/f23_state_scaled.e57": (4, 0, set(), {"names of scans"}),
    "field/f23_zeros_behind.e57": (12, 0, set(), {"names of scans"}),
    "field/f25_long.ply": (4, 0, {"the_distance_to_the_nearest_wall_in_metres"}, set()),
    "field/f25_names.ply": (4, 0, COLOURS | {"intensity", "own_number"}, set()),
    "field/f26_double.xyz": (12, 0, set(), set()),
    "field/f26_quads.obj": (8, 6, set(), set()),
    "field/f2_e57.e57": (12, 0, {"intensity"}, {"names of scans"}),
    "field/f2_ptx.ptx": (12, 0, {"intensity"}, {"order in rows"}),
    "field/f2_ptx_rgb.ptx": (12, 0, COLOURS | {"intensity"}, {"order in rows"}),
    "field/f2_xyz.xyz": (12, 0, {"intensity", "classification"}, set()),
    "field/f3_geokeys.las": (12, 0, set(), set()),
    "field/f3_other_vlr.las": (12, 0, set(), set()),
    "field/f3_wkt.las": (12, 0, set(), set()),
    "field/f3_wkt_evlr.las": (12, 0, set(), set()),
    "field/f4_gps.las": (12, 0, {"gps_time"}, set()),
    "field/f4_gps_14.las": (12, 0, {"gps_time"}, set()),
    "field/f5_mrgb.obj": (4, 4, COLOURS, set()),
    "field/f5_rgb.obj": (4, 4, COLOURS, set()),
    "field/f5_rgb255.obj": (4, 4, COLOURS, set()),
    "field/f6_rgb16.las": (12, 0, COLOURS, set()),
    "field/f6_rgb8.las": (12, 0, COLOURS, set()),
    "field/f6_rgb8_14.las": (12, 0, COLOURS, set()),
    "field/f8_both.e57": (12, 0, set(), {"names of scans", "spherical coordinates"}),
    "field/f8_elements.ply": (4, 4, set(), {"neighbours", "camera", "material"}),
    "field/f8_extra.las": (12, 0, set(), {"extra bytes that nothing describes"}),
    "field/f8_extra_some.las": (12, 0, {"height"}, {"extra bytes that nothing describes"}),
    "field/f8_extra_untyped.las": (12, 0, {"height"}, {"blob (extra bytes without a type)"}),
    "field/f8_face_colour.off": (4, 4, set(), set()),
    "field/f8_face_rgb.ply": (4, 4, set(), set()),
    "field/f8_images.e57": (12, 0, set(), {"names of scans", "images", "poses"}),
    "field/f8_normals.obj": (4, 4, {"nx", "ny", "nz"}, set()),
    "field/f8_texcoords.ply": (4, 4, set(), {"texcoord of face", "textures"}),
    "field/f8_texture.glb": (4, 4, set(), {"materials", "textures", "texture coordinates"}),
    "field/f8_texture.obj": (4, 4, set(),
                             {"materials", "objects", "texture coordinates", "lines", "normals of corners"}),
    "field/f8_tristrips.ply": (4, 4, set(), set()),
    "field/f8_wave.las": (12, 0, set(), {"waveforms"}),
    "field/f8_wave_14.las": (12, 0, set(), {"waveforms"}),
    "attack/vor_a.ply": (400, 0, set(), set()),
    "attack/vor_perm.ply": (400, 0, set(), set()),
    # beside f8_texture.obj
    "field/f8_texture.mtl": HELPER,
    "field/f8_texture.png": HELPER,
}

# program: tests, as FILE:NAME. What writes files or runs the cases is a helper.
PROGRAMS = {
    "reports/box_3x2.py": ["python/tests/test_arrays.py:class"],
    "reports/copc_chunk0.py": ["tests/cli/test_repro.py:chunk0.laz"],
    "reports/find_simplex_tol.py": ["python/tests/test_delaunay.py:tol"],
    "reports/offset_prism.py": ["tests/cli/test_repro.py:test_offsets_of_a_prism"],
    "reports/open_hole.py": ["tests/cli/test_surface.py:hemisphere"],
    "reports/two_extra_vlrs.py": ["tests/cli/test_repro.py:test_extra_bytes_of_several_records"],
    "field/e57_write.py": HELPER,
    "field/facing.py": HELPER,
    "field/f7_colours.py": ["python/tests/test_surfaces.py:to_open3d().vertex_normals"],
    "field/las_write.py": HELPER,
    "field/make_files.py": HELPER,
    "field/run_all.sh": HELPER,
    "field/shapes.py": HELPER,
    "attack/c1_control.sh": ["tests/cli/test_wrong_uses.py:test_no_control_character_of_any_text_reaches_the_terminal"],
    "attack/header.py": ["tests/cli/test_limits.py:properties"],
    "attack/instances_glb.py": ["tests/cli/test_limits.py:test_instances_of_gltf"],
    "attack/non_utf8_name.py": ["python/tests/test_arrays.py:test_paths_that_are_not_utf8"],
    "attack/offset_far.sh": ["tests/cli/test_offset.py:test_distances_that_doubles_cannot_hold"],
    "attack/outliers_factor1.py": ["tests/unit/test_sampling.c:equal_spacings_are_no_outliers"],
    "attack/rows_cols_convert.sh": ["tests/cli/test_limits.py:test_few_wide_rows_among_many_short_ones"],
    "attack/slow_files.py": ["tests/cli/test_limits.py:test_entries_of_an_archive_that_overlap"],
    "attack/stdout_replaced.sh": ["tests/cli/test_output.py:dev/stdout"],
    "attack/subdivide.sh": ["tests/cli/test_subdivide.py:test_levels_that_no_index_can_number_are_refused_with_the_number"],
    "attack/vor_box_faces.py": ["tests/cli/test_voronoi_exact.py:vor_"],
}


def of(name):
    return os.path.join(REPRO, name)


@unittest.skipUnless(os.path.isdir(REPRO), "no folder of small files that showed faults: " + REPRO)
class Repro(CliTest):
    def rows(self, *arguments):
        """The rows of a file, converted to a table."""
        self.expect(0, "convert", *arguments, "-o", self.path("rows.csv"), "--quiet")
        with open(self.path("rows.csv")) as table:
            return [{name: float(x) for name, x in row.items()} for row in csv.DictReader(table)]

    def converted(self, name, out, *options):
        return self.facts("convert", of(name), "-o", self.path(out), *options)

    def test_every_file_has_a_row(self):
        there = set()
        for folder in FOLDERS:
            there |= {folder + "/" + name for name in os.listdir(of(folder)) if name != "README.md"
                      and os.path.isfile(of(folder + "/" + name))}
        self.assertEqual(there - set(FILES) - set(PROGRAMS), set(), "files without a row")

    def test_what_every_file_holds(self):
        for name, right in FILES.items():
            with self.subTest(name):
                if right == HELPER or not os.path.exists(of(name)):
                    continue
                if isinstance(right, str):
                    self.bad_input(right, "info", of(name))
                    continue
                points, faces, properties, left_out = right
                facts = self.facts("info", of(name))
                self.assertEqual((facts["points"], facts["faces"]), (points, faces))
                self.assertLessEqual(properties, set(facts["properties"]))
                self.assertEqual(set(facts.get("left_out") or []), left_out)
                if not faces:
                    self.assertEqual(len(self.rows(of(name))), points)

    def test_what_is_left_out_is_lost(self):
        for name, right in FILES.items():
            if not isinstance(right, tuple) or not right[3] or name.endswith(("f11_above.pcd", "f11_below.pcd")):
                continue
            with self.subTest(name):
                self.assertLessEqual(right[3], set(self.converted(name, "out.ply")["lost"]))

    def test_programs_have_tests(self):
        for name, tests in PROGRAMS.items():
            for test in [] if tests == HELPER else tests:
                with self.subTest(name):
                    path, word = test.split(":")
                    with open(os.path.join(PROJECT, path)) as source:
                        self.assertIn(word, source.read())

    def test_extra_bytes_of_several_records(self):
        rows = self.rows(of("reports/two_extra_vlrs.las"))
        self.assertEqual([(row["deviation"], row["confidence"]) for row in rows], [(3840, 6), (1, 2)])

    def test_points_that_are_not_finite(self):
        for name, dropped, points in [("reports/nanrow.ply", 1, 4), ("reports/infrow.ply", 1, None),
                                      ("field/f23_nan.e57", 4, 8)]:
            facts = self.facts("info", of(name), "--drop-invalid")
            self.assertEqual(facts["dropped"], dropped)
            if points:
                self.assertEqual(facts["points"], points)

    def test_whole_points_of_a_file_that_ends_early(self):
        facts = self.facts("info", of("reports/truncated.las"), "--salvage")
        self.assertEqual((facts["points"], facts["missing"]), (1, 1))

    def test_offsets_of_a_prism(self):
        """By the vertices the volumes were 7.806 and 4.077."""
        for distance, volume in [("0.1", 8.287), ("-0.1", 4.546)]:
            self.expect(0, "offset", of("reports/prism.off"), "--distance", distance, "-o", self.path("out.ply"))
            facts = self.facts("check", self.path("out.ply"))
            self.assertTrue(facts["certificate"]["closed"])
            self.assertAlmostEqual(facts["certificate"]["volume"], volume, delta=0.005 * volume)

    def test_interpolation_in_a_plane(self):
        self.expect(0, "interpolate", of("reports/flat_stations.csv"), "--at", of("reports/flat_at.csv"), "--property",
                    "temperature", "-o", self.path("out.csv"))
        with open(self.path("out.csv")) as table:
            self.assertEqual([float(row["temperature"]) for row in csv.DictReader(table)], [25, 27.5])

    def test_a_cube_of_parts_is_closed_when_it_is_merged(self):
        run = self.expect(5, "check", of("reports/split_cube.obj"))
        self.assertRegex(run.err, "16 vertices are at the positions of others: .*--merge")
        self.expect(0, "convert", of("reports/split_cube.obj"), "--merge", "-o", self.path("out.ply"))
        self.expect(0, "check", self.path("out.ply"))

    def test_strips_of_triangles(self):
        for name in ["reports/tristrips.ply", "field/f8_tristrips.ply"]:
            self.assertEqual(self.converted(name, "out.off")["lost"], [])
            self.expect(0, "check", self.path("out.off"))

    def test_identifiers_are_no_coordinates(self):
        facts = self.facts("voronoi", of("reports/voro_ids.xyz"), "--box", "0,0,0,1,1,1", "-o", self.path("out.csv"))
        self.assertTrue(any("--columns -,x,y,z" in text for text in facts["warnings"]))
        self.expect(0, "voronoi", of("reports/voro_ids.xyz"), "--box", "0,0,0,1,1,1", "--columns", "-,x,y,z", "-o",
                    self.path("out.csv"))
        with open(self.path("out.csv")) as table:
            volumes = [float(row["volume"]) for row in csv.DictReader(table)]
        for volume, right in zip(volumes, [0.157, 0.231, 0.155, 0.184, 0.271]):
            self.assertAlmostEqual(volume, right, delta=6e-4)

    def test_colours(self):
        first = lambda name, *how: [self.rows(of(name), *how)[0][c] for c in ("red", "green", "blue")]
        with self.subTest("obj"):
            self.converted("field/f5_rgb.obj", "points.ply")
            text = self.expect(0, "convert", of("field/f5_rgb.obj"), "-o", "-", "--format", "ply", "--ascii").out
            self.assertIn(b"property uchar red", text)
            self.assertRegex(text.decode(), r"(?m)^[^\n]* 51 102 153$")
        with self.subTest("las to ply: bytes"):
            text = self.expect(0, "convert", of("field/f6_rgb16.las"), "-o", "-", "--format", "ply", "--ascii").out
            self.assertIn(b"property uchar red", text)
            self.converted("field/f6_rgb16.las", "colours.ply")
            row = self.rows(self.path("colours.ply"))[0]
            self.assertEqual([row[c] for c in ("red", "green", "blue")], [255, 0, 128])
        with self.subTest("8 bits in 16"):
            for name in ["field/f6_rgb8.las", "field/f6_rgb8_14.las"]:
                self.converted(name, "colours.glb")
                row = self.rows(self.path("colours.glb"))[0]
                share = row["red"] / (255 if row["red"] <= 255 else 65535), row["green"]
                self.assertEqual(share, (1, 0))
        with self.subTest("old names"):
            self.assertEqual(first("field/f25_names.ply"), [200, 100, 0])

    def test_a_pose_without_a_turn(self):
        row = self.rows(of("field/f23_no_turn.e57"))[0]
        self.assertEqual([row[c] for c in "xyz"], [11.25, 17.25, 33.5])

    def test_las_that_others_open(self):
        """Intensity was a field and extra bytes of the same name."""
        for name in ["field/f2_ptx.ptx", "field/f2_ptx_rgb.ptx", "field/f2_e57.e57", "field/f2_xyz.xyz"]:
            with self.subTest(name):
                given, facts = self.rows(of(name)), self.converted(name, "out.las")
                with open(self.path("out.las"), "rb") as file:
                    self.assertEqual(re.findall(rb"intensity\0", file.read()), [], "extra bytes of the name of a field")
                kept = self.rows(self.path("out.las"))
                where = "intensity_2" if "intensity_2" in kept[0] else "intensity"
                self.assertEqual([row[where] for row in kept], [row["intensity"] for row in given])
                self.assertEqual("intensity" in facts.get("renamed", []), where == "intensity_2")

    def test_coordinate_systems_and_the_kind_of_times(self):
        for name in ["field/f3_geokeys.las", "field/f3_wkt.las", "field/f3_wkt_evlr.las"]:
            with self.subTest(name):
                self.assertEqual(self.converted(name, "out.las")["lost"], [])
                self.assertEqual(self.facts("info", self.path("out.las"))["crs"], self.facts("info", of(name))["crs"])
        for name in ["field/f4_gps.las", "field/f4_gps_14.las"]:
            with self.subTest(name):
                self.converted(name, "out.las")
                with open(self.path("out.las"), "rb") as file:
                    encoding, = struct.unpack_from("<H", file.read(8), 6)
                self.assertEqual(encoding & 1, 1)

    def test_what_is_renamed_is_not_lost(self):
        facts = self.converted("field/f25_long.ply", "out.las")
        self.assertEqual((facts["lost"], facts["renamed"]), ([], ["the_distance_to_the_nearest_wall_in_metres"]))
        self.assertEqual(self.converted("field/f25_names.ply", "out.node")["lost"], ["names of properties"])

    def test_polygons_that_are_cut_up(self):
        """Nothing was lost by the report, and 4e-7 of each coordinate."""
        self.assertEqual(self.converted("field/f26_double.xyz", "out.glb")["lost"], ["precision"])
        for out in ["out.stl", "out.glb"]:
            self.assertEqual(self.converted("field/f26_quads.obj", out)["lost"], ["polygons of more than three corners"])

    def test_atoms(self):
        for name in ["field/f21_atoms.pdb", "field/f21_atoms.ent"]:
            self.expect(0, "iso", of(name), "--level", "1", "-o", self.path("out.ply"))

    def test_surfaces_face_the_scanner(self):
        """Both looked down."""
        for name, sign in [("above", 1), ("below", -1)]:
            for kind in ["ply", "pcd", "ptx", "e57"]:
                with self.subTest(name + "." + kind):
                    self.expect(0, "surface", of("field/f11_%s.%s" % (name, kind)), "--open", "5", "-o", self.path("out.off"))
                    with open(self.path("out.off")) as file:
                        lines = [line for line in file.read().split("\n") if not line.startswith("#")]
                    points, faces, _ = map(int, lines[1].split())
                    at = [list(map(float, line.split()[:3])) for line in lines[2:2 + points]]
                    up = 0
                    for line in lines[2 + points:2 + points + faces]:
                        a, b, c = (at[int(i)] for i in line.split()[1:4])
                        up += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                    self.assertGreater(sign * up, 0)

    def test_faces_of_cells_for_any_order_of_the_points(self):
        counts = {name: self.facts("voronoi", of("attack/" + name), "-o", self.path("out.npy"))["faces"]
                  for name in ["vor_a.ply", "vor_perm.ply"]}
        self.assertEqual(len(set(counts.values())), 1, counts)


if __name__ == "__main__":
    main()
