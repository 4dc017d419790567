"""What holds for every command: help, usage, bad input, JSON, progress."""

import json
import os
import re
import shutil
import struct
import subprocess

import formats
from brio_cli import BRIO, CliTest, CUBE, main, OCTAHEDRON, OCTAHEDRON_FACES

COMMANDS = ["delaunay", "surface", "medial", "hull", "alpha", "offset", "check", "compare", "iso", "info", "view", "generate", "subdivide", "simplify", "terrain",
            "locate", "interpolate", "voronoi", "restricted", "tree", "balls"]
COMMON_OPTIONS = ["--output", "--view", "--picture", "--look", "--colour-by", "--picture-size", "--format", "--input-format", "--columns", "--drop-invalid", "--salvage", "--ascii", "--float32", "--compress", "--json",
                  "--threads", "--seed", "--max-memory", "--scratch", "--quiet", "--progress", "--verbose", "--help"]
OWN_OPTIONS = {
    "delaunay": ["--weights", "--weights-mod", "--unweighted", "--cell", "--periodic", "--order", "--block-size", "--round-ratio", "--locate", "--plane",
                 "--first-conflict", "--all-conflicts", "--subgraph", "--rounds", "--record-every", "--page-size", "--cache-size", "--verify", "--neighbors", "--faces",
                 "--edges", "--tiles"],
    "surface": ["--method", "--curves", "--triangulate", "--theta", "--boundaries", "--density", "--pieces", "--simplify",
                "--labeling", "--noise", "--sampling-density", "--sharp", "--open", "--closed", "--normals",
                "--vertex-normals", "--self-intersections", "--explain", "--polygons", "--extraction", "--keep-largest",
                "--min-component", "--from", "--ignore-normals", "--ignore-origins", "--left-out", "--tiles"],
    "medial": ["--sides", "--spacing", "--labeling", "--noise", "--simplify", "--scale", "--redundancy", "--crust", "--scale-axis", "--method", "--theta", "--rho",
               "--sampling-density", "--sharp"],
    "offset": ["--distance", "--error", "--triangulate", "--simplify", "--labeling", "--noise", "--sampling-density", "--sharp",
               "--vertex-normals", "--self-intersections"],
    "hull": ["--polygons", "--order", "--block-size", "--round-ratio"],
    "alpha": ["--alpha", "--filtration", "--weights", "--weights-mod", "--unweighted", "--cell", "--periodic", "--tiles"],
    "check": ["--weights", "--weights-mod", "--unweighted", "--open", "--self-intersections", "--samples"],
    "compare": ["--samples", "--within"],
    "info": [], "view": ["--self-intersections", "--side-by-side", "--points", "--exact", "--title"],
    "iso": ["--level", "--sigma", "--resolution", "--points", "--blobbiness", "--delaunay-conforming",
            "--vertex-normals", "--self-intersections"],
    "generate": ["--points", "--noise", "--views", "--truth", "--truth-resolution", "--kind", "--resolution"],
    "subdivide": ["--levels"],
    "simplify": ["--faces", "--error"],
    "terrain": ["--class", "--max-edge", "--raster", "--cell"],
    "locate": ["--at", "--plane", "--weights", "--weights-mod", "--unweighted", "--cell", "--periodic"],
    "voronoi": ["--weights", "--weights-mod", "--unweighted", "--cell", "--periodic", "--box", "--faces", "--tiles"],
    "interpolate": ["--at", "--plane", "--property", "--method"],
    "restricted": ["--surface"],
    "tree": ["--plane"],
    "balls": ["--error", "--weights", "--weights-mod", "--unweighted"],
}


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

    def test_output_without_a_known_extension(self):
        self.usage("--format", "delaunay", "a.xyz", "-o", "out.what")

    def test_standard_output_without_format(self):
        self.usage("--format", "delaunay", "a.xyz", "-o", "-")

    def test_output_of_a_command_that_writes_none(self):
        for operands in [("check", "a"), ("info", "a")]:
            self.usage("writes no file", *operands, "-o", "x.ply")

    def test_standard_input_wanted_twice(self):
        self.usage("standard input", "compare", "-", "-")
        self.usage("standard input", "delaunay", "-", "--weights", "-")

    def test_usage_is_found_before_the_input_is_read(self):
        self.usage("cannot hold", "delaunay", "missing.xyz", "-o", "out.off")

    def test_formats_that_are_only_read_are_refused_before_the_input_is_read(self):
        for name in ["out" + kind["read"][0] for kind in formats.formats() if not kind["written"]]:
            self.usage("read, not written", "interpolate", "missing.xyz", "--at", "b", "--property", "p", "-o", name)
            self.usage("read, not written", "generate", "cube", "-n", "9", "-o", name)

    def test_surfaces_of_every_command_are_written_in_the_same_formats(self):
        points, mesh = self.cloud("a.ply", 300, "ball"), self.path("mesh.ply")
        for how in [("hull",), ("alpha", "--alpha", "auto"), ("surface",), ("delaunay", "--plane", "xy")]:
            for extension in formats.holding("faces"):
                self.expect(0, how[0], points, *how[1:], "-o", self.path("out." + extension))
        self.expect(0, "hull", points, "-o", mesh)
        self.expect(0, "subdivide", mesh, "-o", self.path("out.vtp"))

    def test_two_outputs_with_one_name(self):
        points, out = self.cloud("a.xyz", 50), self.file("out.csv", "old")
        ply = self.file("out.ply", "old")
        beside = os.path.join(self.folder, ".", "out.ply")
        for arguments in [("alpha", points, "--alpha", "auto", "--filtration", beside, "-o", ply),
                          ("voronoi", points, "--faces", out, "-o", out),
                          ("surface", points, "--normals", beside, "-o", ply),
                          ("medial", points, "--crust", beside, "-o", ply),
                          ("generate", "scan", "-n", "90", "--truth", beside, "-o", ply)]:
            self.usage("name the same file", *arguments)
        with open(out) as f:
            self.assertEqual(f.read(), "old")

    def test_standard_output_for_a_second_file(self):
        points = self.cloud("a.xyz", 50)
        for arguments in [("alpha", points, "--alpha", "auto", "--filtration", "-"),
                          ("voronoi", points, "--faces", "-"),
                          ("surface", points, "-o", self.path("x.ply"), "--normals", "-"),
                          ("medial", points, "-o", self.path("x.ply"), "--crust", "-")]:
            self.usage("a file, not standard output", *arguments)

    def test_values_in_each_spelling(self):
        points = self.xyz("a.xyz", CUBE)
        for spelling in [("--weights-mod", "-3"), ("--weights-mod=-3",)]:
            self.assertEqual(self.facts("delaunay", points, *spelling)["weighted"], True)
        for spelling in [("-n", "7"), ("-n7",), ("--points=7",), ("-n", "7e0")]:
            self.assertEqual(self.facts("generate", "cube", *spelling)["points"], 7)

    def test_operands_that_look_like_options(self):
        self.xyz("--json.xyz", CUBE)
        self.assertEqual(self.expect(0, "info", "--", "--json.xyz").text.split()[:2], ["input", "--json.xyz"])


class InputErrors(CliTest):
    def test_missing_file(self):
        for command in ["delaunay", "info", "check"]:
            self.bad_input(r"missing\.ply: No such file", command, "missing.ply")
        self.bad_input(r"missing\.ply: No such file", "surface", "missing.ply", "-o", "x.ply")

    def test_folder_as_input(self):
        self.bad_input("directory|folder", "info", self.folder, "--input-format", "ply")

    def test_unknown_extension(self):
        self.bad_input("format", "info", self.file("a.doc", "hello"))

    def test_truncated_binary_ply(self):
        self.cloud("whole.ply", 1000)
        with open(self.path("whole.ply"), "rb") as f:
            content = f.read()
        self.bad_input("cut.ply.*byte", "delaunay", self.file("cut.ply", content[:-100]))

    def test_header_that_promises_4e12_vertices(self):
        header = ("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float x\n"
                  "property float y\nproperty float z\nend_header\n")
        self.bad_input("promise.ply", "delaunay", self.file("promise.ply", header.encode() + bytes(1200)))

    def test_header_that_promises_4e9_vertices_in_text(self):
        header = ("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n0 0 0\n")
        self.bad_input("promise.ply", "delaunay", self.file("promise.ply", header))

    def test_nan_names_the_first_point_and_their_number(self):
        points = self.file("a.xyz", "0 0 0\n1 0 0\n0 nan 0\n0 0 1\ninf 0 0\n")
        self.bad_input(r"a\.xyz: point 2\b.*\by is NaN\b.*\b2 such points", "delaunay", points)

    def test_nan_in_binary(self):
        header = ("ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
                  "property double z\nend_header\n")
        data = struct.pack("<6d", 0, 0, 0, 1, 2, float("nan"))
        self.bad_input(r"a\.ply: point 1\b.*\bz is NaN", "delaunay", self.file("a.ply", header.encode() + data))

    def test_text_that_is_no_number_names_the_line(self):
        self.bad_input(r"a\.xyz.*3", "delaunay", self.file("a.xyz", "0 0 0\n1 0 0\n0 one 0\n0 0 1\n"))


class Json(CliTest):
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


class Progress(CliTest):
    def test_progress_is_shown_when_forced(self):
        run = self.expect(0, "delaunay", self.cloud("a.ply", 100000), "--progress", "--quiet")
        self.assertRegex(run.err, r"(?m)^\w.*\[[#-]{30}\] +\d+ %")
        self.assertTrue(run.err.endswith("\n"))

    def test_progress_is_silent_without_a_terminal(self):
        self.assertEqual(self.expect(0, "delaunay", self.cloud("a.ply", 100000), "--quiet").err, "")


class Threads(CliTest):
    def test_threads_are_those_asked_for(self):
        self.assertEqual(self.facts("delaunay", self.xyz("a.xyz", CUBE), "--threads", "1")["threads"], 1)
        self.assertGreaterEqual(self.facts("delaunay", self.path("a.xyz"))["threads"], 1)


if __name__ == "__main__":
    main()
