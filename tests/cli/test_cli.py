"""The command line's contract: options, exit codes, JSON, and that nothing half-written is ever left behind.

BRIO names the program. Python's standard library is all that is needed.
"""

import contextlib
import json
import os
import re
import resource
import shutil
import signal
import struct
import subprocess
import tempfile
import threading
import time
import unittest

BRIO = os.environ.get("BRIO", "brio")
COMMANDS = ["delaunay", "surface", "medial", "offset", "check", "compare", "iso", "info", "generate", "subdivide"]
COMMON_OPTIONS = ["--output", "--format", "--input-format", "--ascii", "--float32", "--json", "--threads", "--seed",
                  "--max-memory", "--scratch", "--quiet", "--progress", "--help"]
OWN_OPTIONS = {
    "delaunay": ["--weights", "--weights-mod", "--unweighted", "--order", "--block-size", "--round-ratio", "--locate",
                 "--all-conflicts", "--subgraph", "--rounds", "--record-every", "--verify"],
    "surface": ["--method", "--triangulate", "--theta", "--boundaries", "--density", "--pieces", "--simplify",
                "--labeling", "--noise", "--sampling-density", "--sharp", "--open", "--normals", "--vertex-normals",
                "--self-intersections"],
    "medial": ["--sides", "--labeling", "--noise", "--simplify", "--scale", "--redundancy", "--crust", "--sampling-density",
               "--sharp"],
    "offset": ["--distance", "--triangulate", "--simplify", "--labeling", "--noise", "--sampling-density", "--sharp",
               "--vertex-normals", "--self-intersections"],
    "check": ["--weights", "--weights-mod", "--unweighted", "--open", "--self-intersections"],
    "compare": ["--samples"],
    "info": [],
    "iso": ["--level", "--sigma", "--resolution", "--points", "--blobbiness", "--delaunay-conforming",
            "--vertex-normals", "--self-intersections"],
    "generate": ["--points", "--noise", "--views", "--truth", "--truth-resolution"],
    "subdivide": ["--levels"],
}

CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
# Two flat tetrahedra over and under a triangle: the sphere of either holds the apex of the other.
FLAT = [(1, 0, 0), (-0.5, 0.8, 0), (-0.5, -0.8, 0), (0, 0, 0.1), (0, 0, -0.1)]
FLAT_WRONG = [(0, 1, 2, 3), (0, 2, 1, 4)]
FLAT_RIGHT = [(0, 1, 4, 3), (1, 2, 4, 3), (2, 0, 4, 3)]
OCTAHEDRON = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
OCTAHEDRON_FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


class Run:
    """What a run of the program gave."""

    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    @property
    def text(self):
        return self.out.decode()


class CliTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="brio-cli-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def file(self, name, content):
        if isinstance(content, str):
            content = content.encode()
        with open(self.path(name), "wb") as f:
            f.write(content)
        return self.path(name)

    def xyz(self, name, points):
        return self.file(name, "".join("%r %r %r\n" % tuple(p) for p in points))

    def off(self, name, points, faces):
        lines = ["OFF", "%d %d 0" % (len(points), len(faces))]
        lines += ["%r %r %r" % tuple(p) for p in points]
        lines += [" ".join(map(str, (len(f),) + tuple(f))) for f in faces]
        return self.file(name, "\n".join(lines) + "\n")

    def tetrahedra(self, name, points, tetrahedra):
        node = ["%d 3 0 0" % len(points)] + ["%d %r %r %r" % ((i,) + tuple(p)) for i, p in enumerate(points)]
        ele = ["%d 4 0" % len(tetrahedra)] + ["%d %d %d %d %d" % ((i,) + tuple(t)) for i, t in enumerate(tetrahedra)]
        self.file(name + ".ele", "\n".join(ele) + "\n")
        return self.file(name + ".node", "\n".join(node) + "\n")

    def run_brio(self, *arguments, stdin=b"", stdout=subprocess.PIPE, preexec_fn=None):
        done = subprocess.run([BRIO, *map(str, arguments)], input=stdin, stdout=stdout, stderr=subprocess.PIPE,
                              preexec_fn=preexec_fn, cwd=self.folder, timeout=120)
        return Run(done.returncode, done.stdout, done.stderr.decode(errors="replace"))

    def expect(self, code, *arguments, **how):
        run = self.run_brio(*arguments, **how)
        self.assertEqual(run.code, code, "brio %s\n%s" % (" ".join(map(str, arguments)), run.err))
        if code:
            self.assertRegex(run.err, r"\A(brio: .+\n)+\Z")
        return run

    def facts(self, *arguments, code=0, **how):
        run = self.expect(code, *arguments, "--json", **how)
        self.assertEqual(run.text.count("\n"), 1, "one line, one object")
        return json.loads(run.text, parse_constant=lambda c: self.fail("JSON with " + c))

    def usage(self, message, *arguments, **how):
        run = self.expect(1, *arguments, **how)
        self.assertRegex(run.err, message)
        self.assertRegex(run.err, r"brio: see 'brio (\w+ )?--help'\n\Z")
        self.assertEqual(run.out, b"")

    def cloud(self, name, n, kind="cube"):
        self.expect(0, "generate", kind, "-n", n, "-o", self.path(name), "--quiet")
        return self.path(name)

    def assert_only(self, folder, *names):
        self.assertEqual(sorted(os.listdir(folder)), sorted(names))


class Help(CliTest):
    def test_version_is_printed(self):
        self.assertRegex(self.expect(0, "--version").text, r"\Abrio \d+\.\d+\.\d+\n\Z")

    def test_help_lists_every_command(self):
        text = self.expect(0, "--help").text
        for command in COMMANDS:
            self.assertRegex(text, r"(?m)^  %s " % command)

    def test_help_of_each_command_lists_every_option(self):
        for command in COMMANDS:
            text = self.expect(0, command, "--help").text
            listed = re.findall(r"(?m)^  (?:-\w, )?(--[a-z0-9-]+)", text)
            self.assertEqual(sorted(listed), sorted(COMMON_OPTIONS + OWN_OPTIONS[command]), command)

    def test_help_wins_over_other_mistakes(self):
        self.expect(0, "delaunay", "--nonsense", "--help")


class Usage(CliTest):
    def test_no_command(self):
        self.usage("no command")

    def test_medial_and_offset(self):
        points = self.xyz("a.xyz", CUBE)
        self.usage("--distance", "offset", points, "-o", "x.ply")
        self.usage("no faces", "medial", points, "-o", "x.ply", "--labeling", "mesh")
        self.usage("less than 1", "medial", points, "-o", "x.ply", "--scale", "0.5")
        self.usage("negative", "medial", points, "-o", "x.ply", "--redundancy", "-1")
        self.usage("obj", "medial", points, "-o", "x.obj")

    def test_unknown_command_near_a_name(self):
        self.usage("unknown command 'delauney'; did you mean 'delaunay'", "delauney", "x")

    def test_unknown_command_far_from_all(self):
        run = self.expect(1, "xylophone")
        self.assertNotIn("did you mean", run.err)

    def test_unknown_option_near_a_name(self):
        self.usage("unknown option '--weihgts'; did you mean '--weights'", "delaunay", "a.xyz", "--weihgts", "w")

    def test_unknown_option_with_a_value(self):
        self.usage("unknown option '--jsn=1'; did you mean '--json'", "info", "a.xyz", "--jsn=1")

    def test_unknown_short_option(self):
        self.usage("unknown option '-q'", "info", "a.xyz", "-q")

    def test_no_operand(self):
        for command in COMMANDS:
            self.usage("expected", command)

    def test_operand_too_many(self):
        self.usage("one argument too many: 'b'", "delaunay", "a", "b")

    def test_option_without_its_value(self):
        self.usage("needs a value", "delaunay", "a.xyz", "-o")
        self.usage("needs a value", "delaunay", "a.xyz", "-o", "--quiet")

    def test_flag_with_a_value(self):
        self.usage("takes no value", "info", "a.xyz", "--quiet=yes")

    def test_values_of_a_wrong_kind(self):
        for arguments in [("--threads", "two"), ("--threads", "-1"), ("--threads", "100000"), ("--seed", "-3"),
                          ("--seed", "18446744073709551616"), ("--max-memory", "8X"), ("--max-memory", "-1G"),
                          ("--max-memory", "nan"), ("--round-ratio", "1"), ("--round-ratio", "0"),
                          ("--round-ratio", "inf"), ("--weights-mod", "1.5"), ("--weights-mod", "5000"),
                          ("--input-format", "doc"), ("--format", "doc", "-o", "-")]:
            self.usage(".", "delaunay", "a.xyz", *arguments)

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

    def test_output_without_a_known_extension(self):
        self.usage("--format", "delaunay", "a.xyz", "-o", "out.npy")

    def test_output_that_cannot_hold_tetrahedra(self):
        self.usage("cannot hold", "delaunay", "a.xyz", "-o", "out.obj")

    def test_standard_output_without_format(self):
        self.usage("--format", "delaunay", "a.xyz", "-o", "-")

    def test_surface_without_output(self):
        self.usage("-o", "surface", "a.xyz")

    def test_output_of_a_command_that_writes_none(self):
        for operands in [("check", "a"), ("info", "a"), ("compare", "a", "b")]:
            self.usage("writes no file", *operands, "-o", "x.ply")

    def test_two_sources_of_weights(self):
        self.usage("only one of", "delaunay", "a.xyz", "--weights", "w", "--weights-mod", "-3")

    def test_standard_input_wanted_twice(self):
        self.usage("standard input", "compare", "-", "-")
        self.usage("standard input", "delaunay", "-", "--weights", "-")

    def test_usage_is_found_before_the_input_is_read(self):
        self.usage("cannot hold", "delaunay", "missing.xyz", "-o", "out.off")

    def test_values_in_each_spelling(self):
        points = self.xyz("a.xyz", CUBE)
        for spelling in [("--weights-mod", "-3"), ("--weights-mod=-3",)]:
            self.assertEqual(self.facts("delaunay", points, *spelling)["weighted"], True)
        for spelling in [("-n", "7"), ("-n7",), ("--points=7",), ("-n", "7e0")]:
            self.assertEqual(self.facts("generate", "cube", *spelling)["points"], 7)

    def test_operands_that_look_like_options(self):
        self.xyz("--json.xyz", CUBE)
        self.assertEqual(self.expect(0, "info", "--", "--json.xyz").text.split()[0], "command")

    def test_sizes_in_each_unit(self):
        points = self.xyz("a.xyz", CUBE * 100)
        for size, code in [("1K", 4), ("1KiB", 4), ("0.001M", 4), ("100000kb", 0), ("1g", 0), ("1.5GiB", 0),
                           ("2e9", 0)]:
            self.expect(code, "delaunay", points, "--max-memory", size)


class InputErrors(CliTest):
    def bad(self, message, *arguments, **how):
        run = self.expect(2, *arguments, **how)
        self.assertRegex(run.err, message)
        return run

    def test_missing_file(self):
        for command in ["delaunay", "info", "check"]:
            self.bad(r"missing\.ply: No such file", command, "missing.ply")
        self.bad(r"missing\.ply: No such file", "surface", "missing.ply", "-o", "x.ply")

    def test_folder_as_input(self):
        self.bad("directory|folder", "info", self.folder, "--input-format", "ply")

    def test_unknown_extension(self):
        self.bad("format", "info", self.file("a.doc", "hello"))

    def test_truncated_binary_ply(self):
        self.cloud("whole.ply", 1000)
        with open(self.path("whole.ply"), "rb") as f:
            content = f.read()
        self.bad("cut.ply.*byte", "delaunay", self.file("cut.ply", content[:-100]))

    def test_header_that_promises_4e12_vertices(self):
        header = ("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float x\n"
                  "property float y\nproperty float z\nend_header\n")
        self.bad("promise.ply", "delaunay", self.file("promise.ply", header.encode() + bytes(1200)))

    def test_header_that_promises_4e9_vertices_in_text(self):
        header = ("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n0 0 0\n")
        self.bad("promise.ply", "delaunay", self.file("promise.ply", header))

    def test_nan_names_the_first_point_and_their_number(self):
        points = self.file("a.xyz", "0 0 0\n1 0 0\n0 nan 0\n0 0 1\ninf 0 0\n")
        self.bad(r"a\.xyz: point 2\b.*\by is NaN\b.*\b2 such points", "delaunay", points)

    def test_nan_in_binary(self):
        header = ("ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
                  "property double z\nend_header\n")
        data = struct.pack("<6d", 0, 0, 0, 1, 2, float("nan"))
        self.bad(r"a\.ply: point 1\b.*\bz is NaN", "delaunay", self.file("a.ply", header.encode() + data))

    def test_text_that_is_no_number_names_the_line(self):
        self.bad(r"a\.xyz.*3", "delaunay", self.file("a.xyz", "0 0 0\n1 0 0\n0 one 0\n0 0 1\n"))

    def test_check_of_points_alone(self):
        self.bad("points only", "check", self.xyz("a.xyz", CUBE))

    def test_compare_with_points_alone(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.bad("found no faces", "compare", mesh, self.xyz("a.xyz", CUBE))


class NoAnswer(CliTest):
    def test_surface_of_three_points(self):
        points = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
        self.expect(3, "surface", points, "-o", self.path("out.ply"))
        self.assert_only(self.folder, "a.xyz")

    def test_surface_of_an_empty_file(self):
        self.expect(3, "surface", self.file("a.xyz", ""), "-o", self.path("out.ply"))
        self.assert_only(self.folder, "a.xyz")

    def test_surface_of_a_plane(self):
        points = self.xyz("a.xyz", [(x, y, 0) for x in range(6) for y in range(6)])
        self.expect(3, "surface", points, "-o", self.path("out.ply"))

    def test_medial_axis_of_a_plane(self):
        points = self.xyz("a.xyz", [(x, y, 0) for x in range(6) for y in range(6)])
        self.expect(3, "medial", points, "-o", self.path("out.ply"))
        self.assert_only(self.folder, "a.xyz")

    def test_medial_axis_of_an_open_mesh(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        for command in (["medial"], ["offset", "--distance", "0.1"]):
            run = self.expect(3, *command, mesh, "-o", self.path("out.ply"))
            self.assertIn("along 3 edges", run.err)
            self.assertIn("--labeling global", run.err)
        self.assert_only(self.folder, "m.off")

    def test_offset_that_swallows_everything(self):
        points = self.cloud("a.ply", 500, "sphere")
        run = self.expect(3, "offset", points, "--distance", "-1.5", "-o", self.path("out.ply"))
        self.assertIn("swallows the whole object", run.err)
        self.assert_only(self.folder, "a.ply")


class Memory(CliTest):
    def test_limit_of_one_kilobyte(self):
        points = self.xyz("a.xyz", CUBE)
        for arguments in [("delaunay", points), ("surface", points, "-o", "x.ply"), ("info", points),
                          ("generate", "cube", "-n", "1000", "-o", "x.xyz")]:
            self.expect(4, *arguments, "--max-memory", "1K")
        self.assert_only(self.folder, "a.xyz")

    def test_estimate_over_the_limit_is_refused_before_the_start(self):
        points = self.cloud("a.ply", 200000)
        start = time.monotonic()
        run = self.expect(4, "delaunay", points, "--max-memory", "20M")
        self.assertRegex(run.err, "about .* needed")
        self.assertLess(time.monotonic() - start, 2)

    def assert_estimated(self, estimate, *arguments):
        peak = self.facts(*arguments)["peak_bytes"]
        self.assertLess(abs(estimate - peak), 0.15 * peak, arguments)

    def test_estimates_are_within_15_per_cent_of_the_peak(self):
        if self.facts("generate", "cube", "-n", "10")["peak_bytes"] > 12 << 20:
            self.skipTest("this build takes memory for itself")
        for kind in ["cube", "scan", "grid", "sphere", "torus"]:
            points = self.cloud(f"{kind}.ply", 60000, kind)
            for threads in ["1", "2"]:
                estimates = self.facts("info", points, "--threads", threads)["estimate_bytes"]
                self.assert_estimated(estimates["delaunay"], "delaunay", points, "--threads", threads)
        surface = self.path("surface.ply")
        points = self.cloud("few.ply", 20000, "scan")
        self.assert_estimated(self.facts("info", points)["estimate_bytes"]["surface"], "surface", points, "-o", surface)
        self.assert_estimated(self.facts("info", points)["estimate_bytes"]["medial"], "medial", points)
        self.assert_estimated(self.facts("info", points)["estimate_bytes"]["offset"], "offset", points, "-o", surface,
                              "--distance", "0.01")
        self.facts("surface", points, "-o", surface, "--method", "cocone")
        self.assert_estimated(self.facts("info", surface)["estimate_bytes"]["subdivide"],
                              "subdivide", surface, "-o", self.path("fine.ply"))

    def test_limit_between_two_estimates(self):
        """Weights that hide most points take less memory: the estimate knows."""
        points = self.cloud("a.ply", 60000)
        self.expect(4, "delaunay", points, "--max-memory", "18M")
        self.facts("delaunay", points, "--max-memory", "18M", "--weights-mod", "-3")

    def test_memory_that_the_system_refuses(self):
        points = self.cloud("a.ply", 200000)

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (40 << 20, 40 << 20))

        if self.run_brio("--version", preexec_fn=limit).code:
            self.skipTest("this build does not start in 40 MB of address space")
        self.expect(4, "delaunay", points, "--threads", "1", "-o", self.path("x.vtu"), preexec_fn=limit)
        self.assert_only(self.folder, "a.ply")

    def test_scratch_folder_takes_the_big_arrays(self):
        points = self.cloud("a.ply", 50000)
        os.mkdir(self.path("scratch"))
        plain = self.facts("delaunay", points)
        mapped = self.facts("delaunay", points, "--scratch", self.path("scratch"))
        self.assertEqual(plain["checksum"], mapped["checksum"])
        self.assert_only(self.path("scratch"))

    def test_scratch_folder_that_is_missing(self):
        self.expect(2, "delaunay", self.xyz("a.xyz", CUBE), "--scratch", self.path("missing"))


class Check(CliTest):
    def test_closed_surface(self):
        facts = self.facts("check", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES))
        c = facts["certificate"]
        self.assertEqual((c["closed"], c["manifold"], c["oriented"]), (True, True, True))
        self.assertEqual((c["components"], c["genus"], c["genera"], c["boundary_loops"]), (1, 0, [0], 0))
        self.assertIsNone(c["self_intersections"])

    def test_open_surface(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        facts = self.facts("check", mesh, code=5)
        self.assertEqual((facts["certificate"]["closed"], facts["certificate"]["boundary_edges"]), (False, 3))
        self.assertEqual((facts["exit"], "not closed" in facts["error"]), (5, True))
        self.assertFalse(self.facts("check", mesh, "--open")["certificate"]["closed"])

    def test_surface_with_a_flipped_face(self):
        faces = [OCTAHEDRON_FACES[0][::-1]] + OCTAHEDRON_FACES[1:]
        mesh = self.off("m.off", OCTAHEDRON, faces)
        self.assertFalse(self.facts("check", mesh, "--open", code=5)["certificate"]["oriented"])

    def test_surface_with_a_face_too_many(self):
        mesh = self.off("m.off", OCTAHEDRON + [(3, 3, 3)], OCTAHEDRON_FACES + [(0, 2, 6)])
        self.assertFalse(self.facts("check", mesh, "--open", code=5)["certificate"]["manifold"])

    def test_failed_check_reports_to_people_too(self):
        run = self.expect(5, "check", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1]))
        self.assertRegex(run.text, r"closed +no")
        self.assertRegex(run.err, "brio: the surface is not closed")

    def test_right_tetrahedra(self):
        facts = self.facts("check", self.tetrahedra("t", FLAT, FLAT_RIGHT))
        self.assertEqual((facts["verified"], facts["canonical"]), (True, True))

    def test_wrong_tetrahedra(self):
        facts = self.facts("check", self.tetrahedra("t", FLAT, FLAT_WRONG), code=5)
        self.assertEqual((facts["verified"], facts["exit"]), (False, 5))

    def test_tetrahedra_that_leave_a_part_uncovered(self):
        self.expect(5, "check", self.tetrahedra("t", FLAT, FLAT_RIGHT[:2]))

    def test_tetrahedra_that_overlap(self):
        self.expect(5, "check", self.tetrahedra("t", FLAT, FLAT_RIGHT + FLAT_RIGHT[:1]))

    def test_neighbours_on_one_side_of_their_facet(self):
        points = [(1, 2, 0), (0, 2, 1), (2, 0, 1), (0, 1, 2), (0, 0, 0), (0, 1, 1), (0, 2, 2), (0, 1, 0)]
        right = [(5, 4, 7, 2), (5, 4, 2, 3), (0, 4, 2, 7), (0, 5, 7, 2), (0, 5, 2, 3), (0, 1, 7, 5), (0, 1, 5, 3),
                 (0, 6, 3, 2), (0, 6, 1, 3)]
        self.assertTrue(self.facts("check", self.tetrahedra("t", points, right))["verified"])
        wrong = right[:5] + [(0, 1, 6, 5)] + right[6:]
        self.assertFalse(self.facts("check", self.tetrahedra("t", points, wrong), code=5)["verified"])

    def test_other_triangulation_of_a_cube_is_verified_but_not_canonical(self):
        fives = [[(0, 1, 2, 4), (3, 2, 1, 7), (5, 1, 4, 7), (6, 4, 2, 7), (1, 2, 4, 7)],
                 [(1, 3, 0, 5), (2, 0, 3, 6), (4, 0, 5, 6), (7, 3, 6, 5), (0, 3, 5, 6)]]
        found = [self.facts("check", self.tetrahedra("t", CUBE, five)) for five in fives]
        self.assertTrue(all(f["verified"] for f in found))
        self.assertFalse(all(f["canonical"] for f in found))

    def test_index_out_of_range_is_a_fault_of_the_file(self):
        self.expect(2, "check", self.tetrahedra("t", FLAT, [(0, 1, 2, 9)]))

    def test_output_of_delaunay_passes(self):
        for extension in ["ply", "node"]:
            out = self.path("out." + extension)
            self.expect(0, "delaunay", self.cloud("a.xyz", 500), "-o", out, "--weights-mod", "-12")
            weights = ["--weights-mod", "-12"] if extension == "node" else []
            facts = self.facts("check", out, *weights)
            self.assertEqual((facts["verified"], facts["canonical"], facts["weighted"]), (True, True, True))

    def test_weighted_output_fails_as_unweighted(self):
        out = self.path("out.ply")
        self.expect(0, "delaunay", self.cloud("a.xyz", 500), "-o", out, "--weights-mod", "-12")
        self.assertFalse(self.facts("check", out, "--unweighted", code=5)["verified"])


class Writing(CliTest):
    @contextlib.contextmanager
    def mounted(self, options):
        """A small file system of its own."""
        if os.geteuid() != 0 or not shutil.which("mount"):
            self.skipTest("mounting a file system needs root")
        folder = self.path("mounted")
        os.mkdir(folder)
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True)
        if mount.returncode:
            self.skipTest("no file system can be mounted here: " + mount.stderr.decode().strip())
        try:
            yield folder
        finally:
            subprocess.run(["umount", folder], check=True)

    def test_full_disk_leaves_nothing(self):
        points = self.cloud("a.ply", 20000)
        with self.mounted("size=64k") as folder:
            for name in ["out.ply", "out.vtu", "out.node"]:
                self.expect(6, "delaunay", points, "-o", os.path.join(folder, name))
            self.assert_only(folder)

    def test_full_disk_keeps_the_old_file(self):
        points = self.cloud("a.ply", 20000)
        with self.mounted("size=64k") as folder:
            old = os.path.join(folder, "out.ply")
            with open(old, "w") as f:
                f.write("old")
            self.expect(6, "delaunay", points, "-o", old)
            self.assert_only(folder, "out.ply")
            with open(old) as f:
                self.assertEqual(f.read(), "old")

    def test_read_only_file_system(self):
        with self.mounted("ro") as folder:
            self.expect(6, "delaunay", self.xyz("a.xyz", CUBE), "-o", os.path.join(folder, "out.ply"))
            self.assert_only(folder)

    def test_protected_folder(self):
        folder = self.path("protected")
        os.mkdir(folder)
        os.chmod(folder, 0o555)
        os.chmod(self.folder, 0o755)
        points = self.xyz("a.xyz", CUBE)
        other = (lambda: (os.setgid(65534), os.setuid(65534))) if os.geteuid() == 0 else None
        run = self.run_brio("--version", preexec_fn=other) if other else None
        if run and run.code:
            self.skipTest("another user cannot run the program")
        self.expect(6, "delaunay", points, "-o", os.path.join(folder, "out.ply"), preexec_fn=other)
        self.assert_only(folder)

    def test_limit_on_the_file_size_leaves_nothing(self):
        points = self.cloud("a.ply", 20000)
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
        self.expect(6, "delaunay", points, "-o", self.path("out.ply"), preexec_fn=limit)
        self.assert_only(self.folder, "a.ply")

    def test_missing_folder_is_told_before_the_work(self):
        run = self.expect(6, "delaunay", "also-missing.ply", "-o", self.path("missing/out.ply"))
        self.assertIn("missing", run.err)

    def test_folder_of_the_output_s_name(self):
        os.mkdir(self.path("out.ply"))
        self.expect(6, "delaunay", self.xyz("a.xyz", CUBE), "-o", self.path("out.ply"))
        self.assert_only(self.path("out.ply"))

    def test_standard_output_that_is_full(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        points = self.cloud("a.ply", 20000)
        with open("/dev/full", "wb") as full:
            self.expect(6, "delaunay", points, "-o", "-", "--format", "ply", stdout=full)
            self.expect(6, "info", points, "--json", stdout=full)
            self.expect(6, "info", points, stdout=full)

    def test_reader_that_went_away(self):
        points = self.cloud("a.ply", 50000)
        process = subprocess.Popen([BRIO, "delaunay", points, "-o", "-", "--format", "ply"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        process.stdout.close()
        error = process.stderr.read()
        process.stderr.close()
        self.assertEqual(process.wait(), 6, error)

    def test_device_is_written_in_place(self):
        self.expect(0, "delaunay", self.xyz("a.xyz", CUBE), "-o", "/dev/null", "--format", "ply")
        self.assertFalse(os.path.isfile("/dev/null"))

    def test_output_onto_the_input(self):
        points = self.cloud("a.ply", 300)
        self.expect(0, "delaunay", points, "-o", points)
        self.assertTrue(self.facts("check", points)["verified"])
        self.assert_only(self.folder, "a.ply")

    def test_name_of_the_greatest_length(self):
        points = self.xyz("a.xyz", CUBE)
        name = "n" * 251 + ".ply"
        self.expect(0, "delaunay", points, "-o", self.path(name))
        self.assert_only(self.folder, "a.xyz", name)
        self.expect(6, "delaunay", points, "-o", self.path("n" + name))
        self.assert_only(self.folder, "a.xyz", name)

    def test_link_to_no_file_makes_the_file_that_it_names(self):
        os.mkdir(self.path("sub"))
        os.symlink("sub/file.ply", self.path("link.ply"))
        self.expect(0, "delaunay", self.xyz("a.xyz", CUBE), "-o", self.path("link.ply"))
        self.assertTrue(os.path.islink(self.path("link.ply")))
        self.assert_only(self.path("sub"), "file.ply")

    def test_link_into_a_missing_folder_is_told_before_the_work(self):
        os.symlink("missing/file.ply", self.path("link.ply"))
        run = self.expect(6, "delaunay", "also-missing.ply", "-o", self.path("link.ply"))
        self.assertIn("missing", run.err)
        self.assert_only(self.folder, "link.ply")

    def test_loop_of_links(self):
        for a, b in ["ab", "ba"]:
            os.symlink(b + ".ply", self.path(a + ".ply"))
        self.expect(6, "delaunay", "also-missing.ply", "-o", self.path("a.ply"))
        self.assert_only(self.folder, "a.ply", "b.ply")

    def test_old_file_keeps_its_permissions(self):
        points = self.xyz("a.xyz", CUBE)
        for mode in [0o600, 0o640, 0o755]:
            old = self.file("out.ply", "old")
            os.chmod(old, mode)
            self.expect(0, "delaunay", points, "-o", old)
            self.assertEqual(os.stat(old).st_mode & 0o7777, mode)

    def test_failed_verification_would_write_nothing_new(self):
        facts = self.facts("delaunay", self.cloud("a.ply", 300), "--verify", "-o", self.path("out.ply"))
        self.assertIs(facts["verified"], True)
        self.assertIn("verify", facts["seconds"])


class Interrupt(CliTest):
    def start(self, *arguments, **how):
        process = subprocess.Popen([BRIO, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   cwd=self.folder, **how)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def wait_for_stage(self, process, stages):
        """Reads the progress until one of the stages shows; False when the run ended before."""
        for line in process.stderr:
            if any(line.decode().startswith(stage) for stage in stages):
                return True
        return False

    def interrupted(self, number, stages, *arguments):
        process = self.start(*arguments, "--progress")
        shown = self.wait_for_stage(process, stages)
        process.send_signal(number)
        drain = threading.Thread(target=process.stdout.read)
        drain.start()
        process.stderr.read()
        drain.join()
        return process.wait(timeout=60), shown

    def test_signals_in_a_big_run(self):
        points = self.cloud("a.ply", 400000)
        for number in [signal.SIGINT, signal.SIGTERM]:
            code, shown = self.interrupted(number, ["insert", "order"], "delaunay", points, "-o", self.path("out.vtu"))
            self.assertTrue(shown, "the run showed no stage of the triangulation")
            self.assertEqual(code, 130)
            self.assert_only(self.folder, "a.ply")

    def test_signal_while_the_file_is_written(self):
        points = self.cloud("a.ply", 100000)
        code, _ = self.interrupted(signal.SIGINT, ["write"], "delaunay", points, "--ascii", "-o", self.path("out.vtu"))
        self.assertIn(code, [0, 130])  # 0 when the file was complete before the signal came
        self.assert_only(self.folder, "a.ply", *(["out.vtu"] if code == 0 else []))

    def test_signal_while_standard_input_waits(self):
        process = self.start("delaunay", "-", "--input-format", "xyz", "-o", self.path("out.vtu"),
                             stdin=subprocess.PIPE)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        try:
            self.assertEqual(process.wait(timeout=10), 130)
        finally:
            process.stdin.close()
        self.assert_only(self.folder)

    def expect_interruption(self, process):
        """One signal must end a run that waits."""
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "the run did not wait")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=10), 130)

    def fifo(self, name, other_side):
        """A FIFO whose other side is not there, or is there and stalls."""
        os.mkfifo(self.path(name))
        if other_side:
            file = os.open(self.path(name), os.O_RDWR | os.O_NONBLOCK)
            self.addCleanup(os.close, file)
        return self.path(name)

    def test_output_fifo_that_nobody_reads_ignored_signals(self):
        points = self.cloud("a.ply", 20000)
        for name in ["alone.ply", "stalled.ply"]:
            fifo = self.fifo(name, other_side=name == "stalled.ply")
            self.expect_interruption(self.start("delaunay", points, "-o", fifo, "--quiet"))
        self.assert_only(self.folder, "a.ply", "alone.ply", "stalled.ply")

    def test_standard_output_that_nobody_reads(self):
        points = self.cloud("a.ply", 20000)
        self.expect_interruption(self.start("delaunay", points, "-o", "-", "--format", "ply"))

    def test_report_that_nobody_reads(self):
        fifo = os.open(self.fifo("out", other_side=True), os.O_WRONLY)
        self.addCleanup(os.close, fifo)
        with contextlib.suppress(BlockingIOError):
            os.set_blocking(fifo, False)
            while True:
                os.write(fifo, b"full" * 1024)
        os.set_blocking(fifo, True)
        process = subprocess.Popen([BRIO, "info", self.xyz("a.xyz", CUBE), "--json"], stdout=fifo)
        self.addCleanup(process.kill)
        self.expect_interruption(process)

    def test_input_fifo_that_nobody_writes(self):
        for name in ["alone.ply", "stalled.ply"]:
            fifo = self.fifo(name, other_side=name == "stalled.ply")
            self.expect_interruption(self.start("delaunay", fifo, "-o", self.path("out.vtu")))
            self.expect_interruption(self.start("delaunay", self.xyz("a.xyz", CUBE), "--weights", fifo))
        self.assert_only(self.folder, "a.xyz", "alone.ply", "stalled.ply")

    def test_fifos_carry_points(self):
        points, a, b = self.cloud("a.ply", 20000), self.fifo("a.fifo", False), self.fifo("b.fifo", False)
        first = self.start("delaunay", a, "--input-format", "ply", "-o", b, "--format", "ply")
        last = self.start("check", b, "--input-format", "ply")
        with open(points, "rb") as source, open(a, "wb") as sink:
            shutil.copyfileobj(source, sink)
        self.assertEqual((first.wait(timeout=60), last.wait(timeout=60)), (0, 0))

    def test_json_of_an_interrupted_run(self):
        process = self.start("delaunay", self.cloud("a.ply", 400000), "--json", "--progress")
        self.assertTrue(self.wait_for_stage(process, ["insert", "order"]))
        process.send_signal(signal.SIGINT)
        process.stderr.read()
        facts = json.loads(process.stdout.read())
        self.assertEqual((process.wait(), facts["exit"]), (130, 130))


def number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def count(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def vector(value):
    return isinstance(value, list) and len(value) == 3 and all(map(number, value))


CERTIFICATE = {"closed": bool, "manifold": bool, "oriented": bool, "components": count, "genus": int, "genera": list,
               "boundary_edges": count, "boundary_loops": count, "self_intersections": type(None)}
COMMON_FACTS = {"command": str, "input": str, "threads": count, "seconds": {"total": number}, "peak_bytes": count}


class Json(CliTest):
    def assert_schema(self, value, schema, where=""):
        for key, kind in schema.items():
            self.assertIn(key, value, where)
            if isinstance(kind, dict):
                self.assert_schema(value[key], kind, where + key + ".")
            elif isinstance(kind, type):
                self.assertIs(type(value[key]), kind, where + key)
            else:
                self.assertTrue(kind(value[key]), "%s%s: %r" % (where, key, value[key]))

    def test_delaunay(self):
        keys = ("points vertices duplicates hidden tetrahedra hull_facets created destroyed walk_steps insphere_calls "
                "exact_calls").split()
        facts = self.facts("delaunay", self.cloud("a.ply", 2000), "-o", self.path("out.vtu"))
        seconds = {key: number for key in "read order insert write total".split()}
        self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in keys}, "dimension": int,
                                   "seconds": seconds})
        self.assertRegex(facts["checksum"], r"\A[0-9a-f]{16}\Z")
        self.assertEqual(facts["points"], facts["vertices"] + facts["duplicates"] + facts["hidden"])
        self.assertEqual(facts["created"] - facts["destroyed"], facts["tetrahedra"] + facts["hull_facets"])
        self.assertNotIn("verified", facts)

    def test_orders(self):
        points = self.cloud("a.ply", 6000)
        orders = [["brio"], ["brio-octree"], ["brio-kdtree"], ["octree"], ["hilbert"], ["random"], ["input"],
                  ["brio-octree", "--block-size", "50"], ["octree", "--block-size", "1"],
                  ["brio-kdtree", "--round-ratio", "0.3"]]
        runs = [self.facts("delaunay", points, "--threads", "1", "--order", *order) for order in orders]
        self.assertEqual(len({run["checksum"] for run in runs}), 1)
        self.assertEqual(len({run["created"] for run in runs}), len(runs))
        for order in ["brio", "hilbert", "random", "input"]:
            self.usage("octree", "delaunay", points, "--order", order, "--block-size", "9")
        for order in ["octree", "hilbert", "random", "input"]:
            self.usage("has no rounds", "delaunay", points, "--order", order, "--round-ratio", "0.3")

    def test_counters_of_rounds(self):
        points = self.cloud("a.ply", 9000)
        keys = "points tetrahedra created destroyed walk_steps insphere_calls history".split()
        for arguments in [["--rounds"], ["--rounds", "--order", "brio-octree"], ["--rounds", "--order", "hilbert"],
                          ["--record-every", "4000"]]:
            facts = self.facts("delaunay", points, *arguments)
            for entry in facts["rounds"]:
                self.assert_schema(entry, {**{key: count for key in keys}, "locate_seconds": number, "seconds": number})
                self.assertEqual(entry["created"] - entry["destroyed"], entry["tetrahedra"])
            self.assertEqual(facts["rounds"][-1]["created"], facts["created"])
        self.assertEqual([entry["points"] for entry in facts["rounds"]], [4000, 8000, 9000])
        table = self.expect(0, "delaunay", points, "--rounds").text.split("\nrounds")[1]
        self.assertRegex(table, r"\A +\n +points +tetrahedra .*history +locate_seconds +seconds\n( +[0-9.]+){9}\n")
        self.assertNotIn("rounds", self.facts("delaunay", points))
        self.usage("only one of", "delaunay", points, "--rounds", "--record-every", "9")

    def test_surface(self):
        points = self.cloud("a.ply", 2000, "sphere")
        facts = self.facts("surface", points, "-o", self.path("out.ply"))
        seconds = {key: number for key in "read noise delaunay poles power label crust certify write total".split()}
        counts = "samples vertices faces poles hidden_poles inner outer confused".split()
        self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in counts}, "method": str, "labeling": str,
                                   "noise": number, "smoothed": bool, "energy": number, "certificate": CERTIFICATE, "seconds": seconds})
        self.assertEqual((facts["method"], facts["samples"]), ("power-crust", 2000))
        c = facts["certificate"]
        self.assertEqual((c["closed"], c["manifold"], c["oriented"], c["genus"]), (True, True, True, 0))

    def test_medial(self):
        points, out = self.cloud("a.ply", 2000, "sphere"), self.path("out.ply")
        counts = "samples poles hidden_poles inner outer unlabelled vertices edges triangles tetrahedra".split()
        seconds = {key: number for key in "read noise delaunay poles power label shape write total".split()}
        schema = {**COMMON_FACTS, **{key: count for key in counts}, "labeling": str, "noise": number,
                  "smoothed": bool, "seconds": seconds}
        facts = self.facts("medial", points, "-o", out)
        self.assert_schema(facts, schema)
        self.assertEqual((facts["samples"], facts["unlabelled"]), (2000, 0))
        self.assertEqual(facts["labeling"], self.facts("surface", points, "-o", self.path("mesh.ply"))["labeling"])
        self.assertEqual(facts["poles"], facts["inner"] + facts["outer"])
        self.assertEqual(set(self.facts("info", out)["properties"]), {"radius", "side"})
        mesh = self.path("mesh.ply")
        facts = self.facts("medial", mesh, "-o", out, "--sides", "both")
        self.assert_schema(facts, schema)
        self.assertEqual(facts["labeling"], "mesh")
        self.assertEqual(self.facts("medial", mesh, "-o", out, "--labeling", "global")["labeling"], "global")

    def test_medial_facts_without_an_output(self):
        facts = self.facts("medial", self.cloud("torus.ply", 500, "torus"))
        self.assertEqual(facts["vertices"] - facts["edges"] + facts["triangles"] - facts["tetrahedra"], 0)

    def test_medial_simplified_with_its_crust(self):
        points, crust = self.cloud("a.ply", 2000, "torus"), self.path("crust.ply")
        whole = self.facts("medial", points, "-o", self.path("out.vtp"))
        facts = self.facts("medial", points, "-o", self.path("out.vtp"), "--simplify", "--crust", crust)
        self.assertLess(facts["vertices"], whole["vertices"])
        self.assertGreater(facts["left_out"], 0)
        self.assert_schema(facts, {"certificate": CERTIFICATE})
        self.assertEqual((facts["certificate"]["closed"], facts["certificate"]["genus"]), (True, 1))
        self.assertTrue(self.facts("check", crust)["certificate"]["manifold"])

    def appended_arrays(self, name):
        """The arrays of a VTK file by section and name, and the attributes of its piece."""
        with open(self.path(name), "rb") as f:
            xml, data = f.read().split(b"\n_", 1)
        codes = {"Int32": "i", "Int64": "q", "UInt8": "B", "Int8": "b", "Float64": "d"}
        arrays, section = {}, None
        for tag in re.findall(r"<(\w+)([^>]*)>", xml.decode()):
            if tag[0] != "DataArray":
                section = tag[0]
                continue
            facts = dict(re.findall(r'(\w+)="([^"]*)"', tag[1]))
            at = int(facts["offset"])
            size, = struct.unpack_from("<Q", data, at)
            code = codes[facts["type"]]
            count = size // struct.calcsize(code)
            arrays[section, facts["Name"]] = struct.unpack_from("<%d%s" % (count, code), data, at + 8)
        return arrays, dict(re.findall(r'(NumberOf[PVLS]\w+)="(\d+)"', xml.decode()))

    def test_power_shape_in_files(self):
        points = self.cloud("a.ply", 300, "torus")
        facts = self.facts("medial", points, "-o", self.path("out.ply"), "--ascii")
        n, e, t, k = (facts[key] for key in "vertices edges triangles tetrahedra".split())
        self.assertEqual(n - e + t - k, 0)  # a solid torus
        self.assertGreater(k, 0)
        with open(self.path("out.ply")) as f:
            lines = f.read().split("end_header\n")[1].splitlines()
        rows = [tuple(map(float, line.split())) for line in lines[:n]]
        faces = [tuple(map(int, line.split()))[1:] for line in lines[n:n + t]]
        solids = [tuple(map(int, line.split()))[1:] for line in lines[n + t:n + t + k]]
        edges = [tuple(map(int, line.split())) for line in lines[n + t + k:]]
        self.assertEqual((len(rows), len(faces), len(solids), len(edges)), (n, t, k, e))
        self.assertTrue(all(0 <= a < b < n for a, b in edges))
        sides = {tuple(sorted((f[i], f[i - 1]))) for f in faces for i in range(3)}
        self.assertTrue(sides <= set(edges))
        facets = {tuple(sorted(q[:i] + q[i + 1:])) for q in solids for i in range(4)}
        self.assertTrue(facets <= {tuple(sorted(f)) for f in faces})
        self.expect(0, "medial", points, "-o", self.path("out.vtp"))
        arrays, piece = self.appended_arrays("out.vtp")
        self.assertEqual(piece, {"NumberOfPoints": str(n), "NumberOfVerts": "0", "NumberOfLines": str(e),
                                 "NumberOfStrips": "0", "NumberOfPolys": str(t)})
        self.assertEqual(arrays["Points", "Points"], tuple(x for row in rows for x in row[:3]))
        self.assertEqual(arrays["PointData", "radius"], tuple(row[3] for row in rows))
        self.assertEqual(arrays["PointData", "side"], (-1,) * n)
        self.assertEqual(arrays["Lines", "connectivity"], tuple(v for edge in edges for v in edge))
        self.assertEqual(arrays["Lines", "offsets"], tuple(range(2, 2 * e + 1, 2)))
        self.assertEqual(arrays["Polys", "connectivity"], tuple(v for face in faces for v in face))
        self.assertEqual(arrays["Polys", "offsets"], tuple(range(3, 3 * t + 1, 3)))
        self.assertEqual(arrays["Verts", "connectivity"], ())
        self.expect(0, "medial", points, "-o", self.path("out.vtu"))
        arrays, _ = self.appended_arrays("out.vtu")
        self.assertEqual(arrays["Cells", "types"], (10,) * k + (7,) * t + (3,) * e)
        self.assertEqual(arrays["Cells", "connectivity"][:4 * k], tuple(v for q in solids for v in q))
        self.assertEqual(arrays["Cells", "connectivity"][4 * k + 3 * t:], tuple(v for edge in edges for v in edge))
        self.assertEqual(arrays["Cells", "offsets"][-1], 4 * k + 3 * t + 2 * e)
        for extension in ("ply", "vtu"):  # tetrahedra survive writing and reading
            self.expect(0, "medial", points, "-o", self.path("out." + extension))
            info = self.facts("info", self.path("out." + extension))
            self.assertEqual((info["points"], info["faces"], info["tetrahedra"]), (n, t, k))
        self.expect(0, "medial", points, "-o", self.path("out.xyz"))
        self.expect(2, "info", self.path("out.vtp"))

    def test_points_in_a_vtp_file_are_cells(self):
        self.expect(0, "generate", "ball", "-n", 20, "-o", self.path("b.vtp"))
        arrays, piece = self.appended_arrays("b.vtp")
        self.assertEqual((piece["NumberOfVerts"], piece["NumberOfLines"]), ("20", "0"))
        self.assertEqual(arrays["Verts", "connectivity"], tuple(range(20)))
        self.assertEqual(arrays["Verts", "offsets"], tuple(range(1, 21)))

    def test_offset(self):
        points, out = self.cloud("a.ply", 2000, "sphere"), self.path("out.ply")
        seconds = {key: number for key in "read noise delaunay poles power label crust certify write total".split()}
        counts = "samples vertices faces poles hidden_poles inner outer".split()
        for distance, volume in [(0.5, 14.137), (-0.5, 0.5236)]:
            facts = self.facts("offset", points, "--distance", str(distance), "-o", out)
            self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in counts}, "method": str,
                                       "distance": number, "certificate": CERTIFICATE, "seconds": seconds})
            self.assertEqual(facts["distance"], distance)
            self.assertTrue(facts["certificate"]["closed"])
            self.assertAlmostEqual(facts["certificate"]["volume"] / volume, 1, delta=0.03)
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.assertEqual(self.facts("offset", mesh, "-D", "0.1", "-o", out)["labeling"], "mesh")
        self.assertEqual(self.facts("offset", mesh, "-D", "0.1", "-o", out, "--labeling", "greedy")["labeling"], "greedy")
        simple = self.facts("offset", points, "-D", "0.5", "-o", out, "--simplify")
        self.assertTrue(simple["certificate"]["closed"])

    def test_cocone(self):
        points = self.cloud("a.ply", 2000, "sphere")
        seconds = {key: number for key in
                   "read delaunay poles candidates label manifold density certify write total".split()}
        counts = "samples vertices faces unused candidates pruned relabeled".split()
        sampling = {"r_median": number, "r_p95": number, "outside_guarantee": count, "outside_share": number}
        for method in ("cocone", "tight-cocone"):
            facts = self.facts("surface", points, "-o", self.path("out.ply"), "--method", method)
            self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in counts}, "method": str,
                                       "certificate": CERTIFICATE, "seconds": seconds, "sampling": sampling})
            self.assertEqual((facts["method"], facts["vertices"], facts["faces"]), (method, 2000, 3996))
            c = facts["certificate"]
            self.assertEqual((c["closed"], c["manifold"], c["oriented"], c["genus"]), (True, True, True, 0))
        bounded = self.facts("surface", points, "-o", self.path("out.ply"), "--method", "cocone", "--boundaries")
        self.assertLess(bounded["boundary_samples"], 100)
        pieces = self.facts("surface", points, "-o", self.path("out.ply"), "--method", "cocone", "--pieces", "4")
        self.assertEqual((pieces["faces"], pieces["unmatched"]), (3996, 0))
        self.assertGreaterEqual(pieces["pieces"], 4)

    def test_theta_without_a_guarantee_warns(self):
        points = self.cloud("a.ply", 2000, "sphere")
        for theta, warns in (("0.25", True), ("0.26", False)):
            done = self.expect(0, "surface", points, "-o", self.path("out.ply"), "--method", "cocone", "--theta", theta)
            self.assertEqual("no guarantee holds" in done.err, warns)

    def test_labelings(self):
        points = self.cloud("a.ply", 2000, "sphere")
        more = {"greedy": [], "naive": ["unreached"], "theoretical": ["unreached"],
                "global": ["energy_greedy", "undecided", "toggled"]}
        for labeling, keys in more.items():
            facts = self.facts("surface", points, "-o", self.path("out.ply"), "--labeling", labeling)
            self.assertEqual(facts["labeling"], labeling)
            self.assertTrue(facts["certificate"]["closed"])
            self.assertTrue({"energy", *keys} <= set(facts))
        self.usage("unknown name", "surface", points, "-o", self.path("out.ply"), "--labeling", "best")

    def test_noise(self):
        scan, out = self.path("scan.ply"), self.path("out.ply")
        self.expect(0, "generate", "scan", "-n", 20000, "--noise", 0.4, "-o", scan, "--quiet")
        found = self.facts("surface", scan, "-o", out)
        self.assertGreater(found["noise"], 0.1)
        self.assertTrue(found["smoothed"] and found["certificate"]["closed"])
        kept = self.facts("surface", scan, "-o", out, "--noise", "keep")
        self.assertEqual((kept["noise"], kept["smoothed"]), (0, False))
        clean = self.cloud("a.ply", 2000, "sphere")
        self.assertFalse(self.facts("surface", clean, "-o", out)["smoothed"])
        for command in ("surface", "medial", ("offset", "-D", "0.1")):
            command = (command,) if isinstance(command, str) else command
            self.assertTrue(self.facts(command[0], clean, *command[1:], "-o", out, "--noise", "smooth")["smoothed"])
        self.usage("unknown name", "surface", clean, "-o", out, "--noise", "some")

    def test_surface_outputs(self):
        points, out, normals = self.cloud("a.ply", 2000, "sphere"), self.path("out.ply"), self.path("n.csv")
        whole = self.facts("surface", points, "-o", out, "--self-intersections")
        self.assertIsInstance(whole["certificate"]["self_intersections"], int)
        simple = self.facts("surface", points, "-o", out, "--simplify", "--vertex-normals", "--normals", normals)
        self.assertLess(simple["faces"], whole["faces"])
        self.assertIsNone(simple["certificate"]["self_intersections"])
        self.assertTrue({"nx", "ny", "nz"} <= set(self.facts("info", out)["properties"]))
        with open(normals) as f:
            rows = [line.replace(",", " ").split() for line in f][-2000:]
        for row in rows:
            x, y, z, a, b, c = map(float, row)
            self.assertGreater(x * a + y * b + z * c, 0.98)
        sharp = self.facts("surface", points, "-o", out, "--sharp", "-R", "0.05", "--open", "50")
        self.assertGreater(sharp["bad_cells"], 0)
        self.assertEqual(sharp["left_out"], 0)
        self.usage("between 0 and 1", "surface", points, "-o", out, "-R", "1")
        self.usage("a positive number", "surface", points, "-o", out, "--open", "-1")
        self.expect(6, "surface", points, "-o", out, "--normals", self.path("missing/n.ply"))

    def test_check_of_self_intersections(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("check", mesh, "--self-intersections")
        self.assertEqual(facts["certificate"]["self_intersections"], 0)
        twice = self.off("t.off", OCTAHEDRON + [(x + .5, y, z) for x, y, z in OCTAHEDRON],
                         OCTAHEDRON_FACES + [tuple(v + len(OCTAHEDRON) for v in face) for face in OCTAHEDRON_FACES])
        self.assertIn("pairs of faces", self.expect(5, "check", twice, "--self-intersections").err)
        self.expect(0, "check", twice)

    def test_options_of_another_surface_method(self):
        for option in [("--theta", "0.3"), ("--boundaries",), ("--density",), ("--pieces", "3")]:
            self.usage("cocone", "surface", "a.xyz", "-o", "x.ply", *option)
        for option in [("--triangulate",), ("--simplify",), ("--labeling", "greedy"), ("--noise", "keep"),
                       ("-R", "0.3"), ("--sharp",),
                       ("--open", "4"), ("--normals", "n.ply")]:
            self.usage("power-crust", "surface", "a.xyz", "-o", "x.ply", "--method", "cocone", *option)
        self.usage("pi/2", "surface", "a.xyz", "-o", "x.ply", "--method", "cocone", "--theta", "2")

    def test_check(self):
        mesh = self.facts("check", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES))
        self.assert_schema(mesh, {**COMMON_FACTS, "certificate": CERTIFICATE})
        tetrahedra = self.facts("check", self.tetrahedra("t", FLAT, FLAT_RIGHT))
        self.assert_schema(tetrahedra, {**COMMON_FACTS, "verified": bool, "canonical": bool})

    def test_compare(self):
        a = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        b = self.off("b.off", [(2 * x, 2 * y, 2 * z) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        facts = self.facts("compare", a, b, "--samples", "1000")
        keys = "mean rms p95 hausdorff normal_consistency diagonal".split()
        self.assert_schema(facts, {**COMMON_FACTS, "input": list, **{key: number for key in keys}})
        self.assertEqual(facts["input"], [a, b])
        self.assertAlmostEqual(facts["percent_of_diagonal"]["mean"], 100 * facts["mean"] / facts["diagonal"])

    def test_info(self):
        facts = self.facts("info", self.cloud("a.ply", 500))
        self.assert_schema(facts, {**COMMON_FACTS, "points": count, "faces": count, "tetrahedra": count,
                                   "box": {"min": vector, "max": vector}, "duplicates": count, "spacing": number,
                                   "estimate_bytes": {"delaunay": count, "surface": count, "medial": count,
                                                      "offset": count}, "properties": dict})

    def test_generate(self):
        facts = self.facts("generate", "ball", "-n", "50", "-o", self.path("b.xyz"))
        self.assert_schema(facts, {**COMMON_FACTS, "points": count})

    def test_keys_stand_in_their_order(self):
        facts = self.facts("generate", "ball", "-n", "50")
        self.assertEqual(list(facts), ["command", "input", "threads", "points", "seconds", "peak_bytes"])

    def test_failed_runs(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        failures = [(1, ["delaunay"]), (1, ["delaunay", "a", "--nonsense"]), (1, ["nonsense"]),
                    (2, ["delaunay", "missing.ply"]), (3, ["surface", self.file("a.xyz", "")]),
                    (4, ["delaunay", self.xyz("b.xyz", CUBE), "--max-memory", "1K"]), (5, ["check", mesh]),
                    (6, ["delaunay", self.path("b.xyz"), "-o", "missing/x.ply"])]
        for code, arguments in failures:
            facts = self.facts(*arguments, code=code)
            self.assertEqual(facts["exit"], code)
            self.assertIsInstance(facts["error"], str)

    def test_with_data_on_standard_output(self):
        facts = self.facts("delaunay", self.xyz("a.xyz", CUBE), "-o", "-", "--format", "ply", code=1)
        self.assertIn("standard output", facts["error"])

    def test_strings_of_any_bytes(self):
        self.xyz("a.xyz", CUBE)
        names = [b'quote"back\\slash.xyz', b"line\nfeed\ttab.xyz", "\u00fcml\u00e4ut \u20ac \U0001f600.xyz".encode(),
                 b"not utf-8 \xff\xc3(.xyz"]
        for name in names:
            target = os.path.join(self.folder.encode(), name)
            shutil.copy(self.path("a.xyz").encode(), target)
            done = subprocess.run([BRIO.encode(), b"info", target, b"--json"], stdout=subprocess.PIPE)
            facts = json.loads(done.stdout.decode())
            self.assertEqual(facts["input"], target.decode(errors="replace"))

    def test_numbers_read_back_exactly(self):
        low, high = (0.1, 1e-300, -1 / 3), (0.30000000000000004, 1.7976931348623157e308, 5e-324)
        facts = self.facts("info", self.xyz("a.xyz", [low, high]))
        self.assertEqual(facts["box"], {"min": list(low), "max": list(high)})

    def test_nothing_but_the_object_on_standard_output(self):
        run = self.expect(0, "info", self.xyz("a.xyz", CUBE), "--json", "--progress")
        self.assertEqual(json.loads(run.text)["points"], 8)

    def test_quiet_run_says_nothing(self):
        run = self.expect(0, "info", self.xyz("a.xyz", CUBE), "--quiet")
        self.assertEqual((run.out, run.err), (b"", ""))


class Pipes(CliTest):
    def test_points_through_standard_input(self):
        facts = self.facts("delaunay", "-", "--input-format", "xyz", stdin=b"0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
        self.assertEqual((facts["tetrahedra"], facts["input"]), (1, "-"))

    def test_format_of_standard_input_by_its_content(self):
        self.expect(0, "generate", "cube", "-n", "20", "-o", self.path("a.ply"))
        with open(self.path("a.ply"), "rb") as f:
            self.assertEqual(self.facts("info", "-", stdin=f.read())["points"], 20)
        self.assertEqual(self.facts("info", "-", stdin=b"0 0 0\n1 0 0\n")["points"], 2)

    def test_chain_of_commands(self):
        made = self.expect(0, "generate", "sphere", "-n", "300", "-o", "-", "--format", "xyz")
        self.assertIn("points", made.err)
        solid = self.expect(0, "delaunay", "-", "--input-format", "xyz", "-o", "-", "--format", "ply", stdin=made.out)
        self.assertTrue(solid.out.startswith(b"ply\n"))
        self.assertTrue(self.facts("check", "-", "--input-format", "ply", stdin=solid.out)["verified"])

    def test_quiet_chain_says_nothing(self):
        made = self.expect(0, "generate", "grid", "-n", "8", "-o", "-", "--format", "xyz", "--quiet")
        self.assertEqual(made.err, "")

    def test_text_and_binary_hold_the_same(self):
        for extension in ["ply", "vtu"]:
            for flags in [[], ["--ascii"]]:
                self.expect(0, "generate", "cube", "-n", "100", "-o", self.path("x." + extension), *flags)
                facts = self.facts("delaunay", self.path("x." + extension))
                self.assertEqual(facts["checksum"], self.facts("delaunay", self.cloud("a.xyz", 100))["checksum"])

    def test_single_precision_rounds_the_coordinates(self):
        self.expect(0, "generate", "cube", "-n", "10", "-o", self.path("a.ply"), "--float32", "--ascii")
        with open(self.path("a.ply")) as f:
            header, _, body = f.read().partition("end_header\n")
        self.assertIn("property float x", header)
        for text in body.split():
            value = float(text)
            self.assertAlmostEqual(struct.unpack("f", struct.pack("f", value))[0], value, delta=1e-9)


class Properties(CliTest):
    PLY = ("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty double quality\nend_header\n"
           "0 0 0 10 0.25\n1 0 0 20 0.5\n0 1 0 30 0.125\n0 0 1 40 1e-9\n1 1 1 255 -7\n")

    def test_info_names_them(self):
        facts = self.facts("info", self.file("a.ply", self.PLY))
        self.assertEqual(facts["properties"], {"red": "uint8", "quality": "float64"})

    def test_they_survive_delaunay(self):
        self.expect(0, "delaunay", self.file("a.ply", self.PLY), "-o", self.path("b.ply"), "--ascii")
        with open(self.path("b.ply")) as f:
            header, _, body = f.read().partition("end_header\n")
        names = re.findall(r"(?m)^property (?!list)(\w+) (\w+)$", header)
        self.assertEqual([name for _, name in names], ["x", "y", "z", "red", "quality"])
        rows = [list(map(float, line.split())) for line in body.splitlines()[:5]]
        self.assertEqual([row[3] for row in rows], [10, 20, 30, 40, 255])
        self.assertEqual([row[4] for row in rows], [0.25, 0.5, 0.125, 1e-9, -7])

    def test_faces_of_the_input_do_not_reach_the_output(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.expect(0, "delaunay", mesh, "-o", self.path("b.ply"))
        facts = self.facts("info", self.path("b.ply"))
        self.assertEqual((facts["points"], facts["faces"]), (6, 0))
        self.assertEqual(facts["tetrahedra"], 4)

    def test_tetrahedra_of_the_input_are_replaced(self):
        wrong = self.tetrahedra("t", FLAT, FLAT_WRONG)
        self.expect(0, "delaunay", wrong, "-o", self.path("b.ply"))
        self.assertEqual(self.facts("check", self.path("b.ply"))["tetrahedra"], 3)


class Weights(CliTest):
    # A light point at the centre of four heavy ones has no power cell.
    POINTS = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1), (0, 0, 0)]

    def weighted_ply(self, kind="double"):
        rows = "".join("%r %r %r %d\n" % (*p, 0 if p == (0, 0, 0) else 10) for p in self.POINTS)
        return self.file("w.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n"
                                  "property double z\nproperty %s weight\nend_header\n%s" % (kind, rows))

    def test_file_of_weights_with_comments(self):
        weights = self.file("w.txt", "# heavy corners\n10\n 10 # one more\n\n10\r\n1e1\n0\n")
        facts = self.facts("delaunay", self.xyz("a.xyz", self.POINTS), "--weights", weights, "--verify")
        self.assertEqual((facts["hidden"], facts["vertices"], facts["tetrahedra"]), (1, 4, 1))
        self.assertEqual((facts["weighted"], facts["verified"]), (True, True))

    def test_property_named_weight_is_used(self):
        for kind in ["double", "float", "int"]:
            self.assertEqual(self.facts("delaunay", self.weighted_ply(kind))["hidden"], 1)

    def test_property_is_ignored_when_unweighted(self):
        facts = self.facts("delaunay", self.weighted_ply(), "--unweighted")
        self.assertEqual((facts["hidden"], facts["weighted"]), (0, False))

    def test_file_wins_over_the_property(self):
        weights = self.file("w.txt", "0\n" * 5)
        self.assertEqual(self.facts("delaunay", self.weighted_ply(), "--weights", weights)["hidden"], 0)

    def test_modular_weights_are_those_of_the_rule(self):
        points = self.cloud("a.xyz", 2000)
        weights = self.file("w.txt", "".join("%r\n" % (i * 7919 % 1000 * 2.0 ** -14) for i in range(2000)))
        by_file = self.facts("delaunay", points, "--weights", weights)
        by_rule = self.facts("delaunay", points, "--weights-mod", "-14")
        self.assertEqual(by_file["checksum"], by_rule["checksum"])
        self.assertGreater(by_rule["hidden"], 0)

    def test_weights_through_standard_input(self):
        points = self.xyz("a.xyz", self.POINTS)
        self.assertEqual(self.facts("delaunay", points, "--weights", "-", stdin=b"10\n10\n10\n10\n0\n")["hidden"], 1)

    def test_output_holds_the_weights(self):
        points = self.xyz("a.xyz", self.POINTS)
        weights = self.file("w.txt", "10\n10\n10\n10\n0\n")
        self.expect(0, "delaunay", points, "--weights", weights, "-o", self.path("b.ply"))
        self.assertTrue(self.facts("check", self.path("b.ply"))["weighted"])

    def test_too_few_weights(self):
        run = self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", self.file("w.txt", "1\n2\n3\n"))
        self.assertRegex(run.err, r"w\.txt:3: .*3 weights for 5 points")

    def test_too_many_weights(self):
        weights = self.file("w.txt", "#\n" + "1\n" * 9)
        run = self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", weights)
        self.assertRegex(run.err, r"w\.txt:7: .*9 weights for 5 points")

    def test_weight_that_is_no_number(self):
        for text in ["1\nheavy\n", "1\nnan\n", "1\n1e999\n", "1\n2 3\n"]:
            run = self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", self.file("w.txt", text))
            self.assertRegex(run.err, r"w\.txt:2: ")

    def test_file_of_one_endless_line(self):
        weights = self.file("w.txt", "1" * 100000)
        self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", weights)

    def test_missing_file_of_weights(self):
        self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", "missing.txt")


class Answers(CliTest):
    def test_delaunay_of_an_empty_file(self):
        facts = self.facts("delaunay", self.file("a.xyz", ""), "-o", self.path("out.ply"))
        self.assertEqual((facts["points"], facts["dimension"], facts["tetrahedra"]), (0, -1, 0))
        self.assertEqual(self.facts("info", self.path("out.ply"))["points"], 0)

    def test_delaunay_of_fewer_dimensions(self):
        for points, dimension in [([(1, 2, 3)], 0), ([(0, 0, 0), (1, 1, 1), (2, 2, 2)], 1), (CUBE[:4], 2), (CUBE, 3)]:
            facts = self.facts("delaunay", self.xyz("a.xyz", points), "--verify")
            self.assertEqual((facts["dimension"], facts["verified"]), (dimension, True))

    def test_duplicates_are_counted(self):
        points = self.xyz("a.xyz", CUBE + CUBE[:3] + [(-0.0, 0.0, -0.0)])
        self.assertEqual(self.facts("delaunay", points)["duplicates"], 4)
        self.assertEqual(self.facts("info", points)["duplicates"], 4)

    def test_every_order_and_number_of_threads_gives_the_same(self):
        points = self.cloud("a.ply", 3000)
        runs = [[], ["--order", "hilbert"], ["--order", "random"], ["--order", "input"], ["--threads", "1"],
                ["--seed", "99"], ["--round-ratio", "0.5"], ["--locate", "walk"], ["--locate", "jump"],
                ["--locate", "hierarchy"], ["--locate", "history"], ["--locate", "history", "--all-conflicts"]]
        self.assertEqual(len({self.facts("delaunay", points, *run)["checksum"] for run in runs}), 1)

    def test_every_location_gives_the_same(self):
        mesh = self.path("torus.ply")
        self.expect(0, "iso", self.ball_map("a.map"), "--level", "-6", "-o", mesh)
        plain = self.facts("delaunay", mesh)["checksum"]
        for location in ["walk", "jump", "hierarchy", "history", "trace", "neighbour"]:
            facts = self.facts("delaunay", mesh, "--locate", location, "--verify")
            self.assertTrue(facts["checksum"] == plain and facts["verified"], location)
            self.assertEqual("subgraph" in facts, location in ("trace", "neighbour"))
            self.assertEqual(facts["trace_intersections"] > 0, location == "trace")
        for kind in ["bounded", "mst", "tree", "all"]:
            facts = self.facts("delaunay", mesh, "--locate", "trace", "--subgraph", kind)
            self.assertEqual((facts["checksum"], facts["subgraph"]["kind"]), (plain, kind))
        self.assertEqual(self.facts("delaunay", mesh, "--locate", "trace")["subgraph"]["max_degree"], 3)

    def test_meshes_to_go_along(self):
        faces = OCTAHEDRON_FACES + [(0, 1, 2)]  # edges of three faces
        mesh = self.off("m.off", OCTAHEDRON + [(9, 9, 9), (1, 0, 0)], faces)
        plain = self.facts("delaunay", mesh)["checksum"]
        facts = self.facts("delaunay", mesh, "--locate", "trace", "-o", self.path("t.ply"))
        self.assertEqual((facts["checksum"], facts["subgraph"]["kind"], facts["duplicates"]), (plain, "mst", 1))
        self.assertEqual(self.facts("info", self.path("t.ply"))["faces"], 0)
        self.expect(3, "delaunay", mesh, "--locate", "trace", "--subgraph", "bounded")
        points = self.expect(2, "delaunay", self.xyz("p.xyz", CUBE), "--locate", "trace")
        self.assertIn("found no faces", points.err)
        self.usage("--locate trace and neighbour", "delaunay", mesh, "--subgraph", "mst")
        self.expect(4, "delaunay", self.cloud("c.ply", 2000), "--locate", "history", "--max-memory", "1M")

    def test_history_is_counted(self):
        points = self.cloud("a.ply", 3000)
        plain = self.facts("delaunay", points)
        path = self.facts("delaunay", points, "--locate", "history")
        conflicts = self.facts("delaunay", points, "--locate", "history", "--all-conflicts")
        self.assertEqual((plain["history"], plain["history_tests"]), (0, 0))
        self.assertEqual(path["history"], path["created"])
        self.assertGreater(path["history_tests"], 3000)
        self.assertGreater(conflicts["history_tests"], path["history_tests"])

    def test_threads_are_those_asked_for(self):
        self.assertEqual(self.facts("delaunay", self.xyz("a.xyz", CUBE), "--threads", "1")["threads"], 1)
        self.assertGreaterEqual(self.facts("delaunay", self.path("a.xyz"))["threads"], 1)

    def test_surface_triangulated(self):
        points = self.cloud("a.ply", 1500, "torus")
        facts = self.facts("surface", points, "-o", self.path("out.off"), "--triangulate")
        self.assertEqual(facts["certificate"]["genus"], 1)
        with open(self.path("out.off")) as f:
            body = [line.split() for line in f if line.strip() and not line.startswith("#")]
        faces = [line for line in body[2:] if line[0] == "3" and len(line) == 4]
        self.assertGreaterEqual(len(faces), facts["faces"])

    def test_info_spacing_of_a_grid(self):
        facts = self.facts("info", self.cloud("a.xyz", 1000, "grid"))
        self.assertEqual((facts["spacing"], facts["box"]), (1, {"min": [0, 0, 0], "max": [9, 9, 9]}))

    def test_info_of_one_place(self):
        facts = self.facts("info", self.xyz("a.xyz", [(1, 2, 3)] * 5))
        self.assertEqual((facts["duplicates"], facts["spacing"]), (4, None))

    def test_info_of_an_empty_file(self):
        facts = self.facts("info", self.file("a.xyz", ""))
        self.assertEqual((facts["points"], facts["box"], facts["spacing"]), (0, None, None))

    def test_info_of_a_mesh(self):
        facts = self.facts("info", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES))
        self.assertEqual((facts["points"], facts["faces"], facts["tetrahedra"]), (6, 8, 0))

    def test_info_spacing_at_extreme_scales(self):
        for scale in [1e-200, 1e200]:
            facts = self.facts("info", self.xyz("a.xyz", [tuple(scale * c for c in p) for p in CUBE]))
            self.assertAlmostEqual(facts["spacing"] / scale, 1)

    def test_generate_repeats_with_the_seed(self):
        outputs = [self.expect(0, "generate", "scan", "-n", "500", "-o", "-", "--format", "xyz", *seed).out
                   for seed in ([], [], ["--seed", "1"], ["--seed", "2"])]
        self.assertEqual(outputs[0], outputs[1])
        self.assertEqual(outputs[0], outputs[2])
        self.assertNotEqual(outputs[0], outputs[3])

    def test_generate_of_every_kind(self):
        listed = self.expect(0, "generate", "--help").text
        for kind in ["cube", "ball", "sphere", "torus", "cylinder", "grid", "clusters", "moment"]:
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

    def ball_map(self, name, size=20):
        """A CCP4 map whose values fall with the distance from the middle."""
        header = struct.pack("<10i", size, size, size, 2, 0, 0, 0, size, size, size)
        header += struct.pack("<6f", size, size, size, 90, 90, 90) + struct.pack("<3i", 1, 2, 3)
        header = header.ljust(208, b"\0") + b"MAP \x44\x44\0\0"
        middle = (size - 1) / 2
        distance = lambda *p: sum((x - middle) ** 2 for x in p) ** 0.5
        values = [distance(x, y, z) for z in range(size) for y in range(size) for x in range(size)]
        return self.file(name, header.ljust(1024, b"\0") + struct.pack("<%df" % len(values), *[-v for v in values]))

    def test_iso_from_a_map(self):
        ball = self.ball_map("a.map")
        facts = self.facts("iso", ball, "--level", "-6", "-o", self.path("s.ply"))
        self.assertEqual(facts["input"], ball)
        certificate = self.facts("check", self.path("s.ply"))["certificate"]
        self.assertTrue(certificate["closed"] and certificate["manifold"] and certificate["genus"] == 0)
        self.assertAlmostEqual(certificate["volume"] / (4 / 3 * 3.14159265 * 6 ** 3), 1, delta=0.05)
        self.assertEqual(facts["points"], self.facts("info", self.path("s.ply"))["points"])
        wanted = self.facts("iso", ball, "--level", "-6", "-n", "20000", "-o", self.path("s.ply"))
        self.assertAlmostEqual(wanted["points"] / 20000, 1, delta=0.1)
        with open(ball, "rb") as f:
            piped = self.expect(0, "iso", "-", "--level", "-6", "-o", "-", "--format", "off", "--quiet",
                                stdin=f.read())
        self.assertTrue(piped.out.startswith(b"OFF"))

    def test_iso_by_its_name_of_version_0_1(self):
        ball, old, new = self.ball_map("a.map"), self.path("old.ply"), self.path("new.ply")
        facts = self.facts("generate", "iso", ball, "--level", "-6", "-o", old)
        self.assertEqual(facts["command"], "iso")
        self.assertTrue(facts["certificate"]["closed"])
        self.facts("iso", ball, "--level", "-6", "-o", new)
        with open(old, "rb") as a, open(new, "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_iso_of_delaunay_triangles(self):
        ball, mesh = self.ball_map("a.map"), self.path("s.ply")
        self.facts("iso", ball, "--level", "-6", "--delaunay-conforming", "-o", mesh)
        certificate = self.facts("check", mesh, "--self-intersections")["certificate"]
        self.assertTrue(certificate["closed"] and certificate["manifold"] and certificate["genus"] == 0)
        self.assertEqual(certificate["self_intersections"], 0)
        self.assertAlmostEqual(certificate["volume"] / (4 / 3 * 3.14159265 * 6 ** 3), 1, delta=0.05)

    def test_iso_from_atoms(self):
        atom = "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00  0.00           C\n"
        self.facts("iso", self.file("a.pdb", atom), "--level", "1", "--resolution", "60",
                   "-o", self.path("s.ply"))
        self.assertAlmostEqual(self.facts("check", self.path("s.ply"))["certificate"]["volume"], 20.58, delta=0.4)
        self.usage("standard deviations", "iso", self.path("a.pdb"), "--level", "1", "--sigma",
                   "-o", self.path("s.ply"))

    def test_iso_refusals(self):
        ball, out = self.ball_map("a.map", 8), self.path("s.ply")
        self.usage("expected IN, got 0 arguments", "iso", "-o", out)
        self.usage("--level L", "iso", ball, "-o", out)
        self.usage("one of -n and --resolution", "iso", ball, "--level", "1", "-n", "5", "--resolution",
                   "5", "-o", out)
        self.usage("noise", "iso", ball, "--level", "1", "--noise", "0", "-o", out)
        self.usage("level", "generate", "cube", "-n", "5", "--level", "1", "-o", out)
        self.usage("one argument too many", "generate", "cube", "x", "-n", "5", "-o", out)
        self.usage("cannot hold", "iso", ball, "--level", "1", "-o", self.path("s.xyz"))
        self.expect(3, "iso", ball, "--level", "9", "-o", out)
        self.expect(2, "iso", self.path("missing.map"), "--level", "1", "-o", out)
        self.expect(2, "iso", self.file("b.map", "MAP"), "--level", "1", "-o", out)
        self.expect(4, "iso", self.ball_map("c.map", 60), "--level", "-6", "-o", out, "--max-memory", "1M")
        self.assert_only(self.folder, "a.map", "b.map", "c.map")

    def test_subdivide(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("subdivide", mesh, "--levels", "3", "-o", self.path("s.off"))
        self.assertEqual((facts["levels"], facts["vertices"], facts["faces"]), (3, 258, 512))
        self.assertTrue(facts["certificate"]["closed"] and facts["certificate"]["genus"] == 0)
        with open(self.path("s.off")) as f:
            rows = [line.split() for line in f if not line.startswith("#")]
        self.assertEqual([tuple(map(float, row)) for row in rows[2:8]], OCTAHEDRON)

    def test_subdivide_refusals(self):
        mesh, out = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.path("s.ply")
        self.usage("between 1 and 15", "subdivide", mesh, "--levels", "0", "-o", out)
        self.usage("-o FILE is missing", "subdivide", mesh)
        self.expect(3, "subdivide", self.xyz("p.xyz", CUBE), "-o", out)
        square = self.off("q.off", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])
        self.assertIn("face 0 has 4 corners", self.expect(3, "subdivide", square, "-o", out).err)
        self.expect(4, "subdivide", mesh, "--levels", "15", "-o", out, "--max-memory", "100M")
        self.assert_only(self.folder, "m.off", "p.xyz", "q.off")

    def test_compare_of_a_surface_with_itself(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("compare", mesh, mesh, "--samples", "500")
        self.assertLess(facts["hausdorff"], 1e-12)
        self.assertAlmostEqual(facts["normal_consistency"], 1)

    def test_progress_is_shown_when_forced(self):
        run = self.expect(0, "delaunay", self.cloud("a.ply", 100000), "--progress", "--quiet")
        self.assertRegex(run.err, r"(?m)^\w.*\[[#-]{30}\] +\d+ %")
        self.assertTrue(run.err.endswith("\n"))

    def test_progress_is_silent_without_a_terminal(self):
        self.assertEqual(self.expect(0, "delaunay", self.cloud("a.ply", 100000), "--quiet").err, "")


if __name__ == "__main__":
    unittest.main()
