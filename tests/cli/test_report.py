"""What the program says: the report for people, JSON, warnings, hints, help."""

import fcntl
import math
import os
import pty
import re
import struct
import subprocess
import termios

from brio_cli import BRIO, CliTest, CUBE, main, OCTAHEDRON, OCTAHEDRON_FACES

INTERNAL = "unused specks relabeled handles energy undecided confused toggled".split()


def lines_of(text):
    """The first-level labels of a report: what stands before two blanks or the line's end."""
    return [re.split(r"  +", line)[0] for line in text.splitlines() if line and line[0] != " "]


class People(CliTest):
    def test_certificate_before_internals(self):
        points, out = self.cloud("a.ply", 500, "sphere"), self.path("out.ply")
        for method in ("labeled-delaunay", "power-crust"):
            labels = lines_of(self.expect(0, "surface", points, "-o", out, "--method", method).text)
            self.assertEqual(labels[:7], ["input", "output", "method", "distinct points", "vertices", "faces", "certificate"])
            self.assertEqual(labels[-2:], ["seconds", "memory"])
            self.assertFalse(set(INTERNAL) & set(labels))
            whole = self.expect(0, "surface", points, "-o", out, "--method", method, "--verbose").text
            self.assertLess(whole.index("\ncertificate\n"), whole.index("\ninternals\n"))
            self.assertRegex(whole, r"\n  undecided +\d+\n")
            self.assertRegex(whole, r"\nseconds\n  read +0\.\d+\n")

    def test_lines_that_say_nothing_are_left_out(self):
        closed = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        text = self.expect(0, "check", closed).text
        self.assertNotIn("boundary", text)
        self.assertNotIn("genus by component", text)
        self.assertRegex(text, r"self-intersections +not counted\n")
        self.assertRegex(self.expect(0, "check", closed, "--verbose").text, r"\n  boundary loops +0\n")
        opened = self.off("b.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        self.assertRegex(self.expect(0, "check", opened, "--open").text, r"\n  boundary loops +1\n")
        two = self.off("c.off", OCTAHEDRON + [(x + 9, y, z) for x, y, z in OCTAHEDRON],
                       OCTAHEDRON_FACES + [tuple(v + 6 for v in f) for f in OCTAHEDRON_FACES])
        self.assertRegex(self.expect(0, "check", two).text, r"\n  genus by component +0 0\n")

    def commands(self):
        """A run of every command, with what it needs and some options that add lines."""
        points, out = self.cloud("a.ply", 200, "sphere"), self.path("out.ply")
        mesh, places = self.path("mesh.ply"), self.xyz("at.xyz", CUBE)
        self.expect(0, "hull", points, "-o", mesh, "--quiet")
        values = self.file("v.csv", "x,y,z,t\n" + "".join("%d,%d,%d,%d\n" % (*p, i) for i, p in enumerate(CUBE)))
        yield "delaunay", points, "--verify", "--weights-mod", "-9"
        yield "delaunay", points, "--plane", "xy", "--verify"
        yield "delaunay", mesh, "--locate", "trace", "--rounds"
        for how in [["--keep-largest"], ["--method", "power-crust", "--sharp", "--labeling", "naive", "--open", "90"],
                    ["--method", "cocone", "--density", "--boundaries"], ["--method", "cocone", "--pieces", "2"]]:
            yield "surface", points, "-o", out, *how
        yield "medial", points, "-o", out, "--method", "voronoi"
        yield "medial", points, "-o", out, "--simplify", "--crust", self.path("crust.ply")
        yield "balls", out, "-o", self.path("union.ply")
        yield "hull", points, "-o", out
        yield "alpha", points, "--alpha", "auto", "-o", out
        yield "offset", points, "-D", "0.1", "-o", out
        yield "offset", mesh, "-D", "0.1", "-o", out
        octahedron = self.off("o.off", OCTAHEDRON, OCTAHEDRON_FACES)
        yield "restricted", octahedron, "--surface", octahedron, "-o", out
        yield "tree", points, "-o", out
        yield "surface", self.xyz("ring.xyz", [(math.cos(i / 9), math.sin(i / 9), 0) for i in range(50)]), "-o", out
        yield "check", mesh, "--self-intersections"
        yield "compare", mesh, mesh, "--samples", "100"
        yield "compare", points, mesh, "--within", "9"
        yield "check", mesh, "--samples", points
        yield "iso", self.ball_map("b.map", 12), "--level", "-3", "-o", out
        yield "info", mesh
        yield "view", mesh, "-o", self.path("page.html")
        yield "hull", points, "--view", self.path("hull.html")
        yield "generate", "scan", "-n", "100", "--truth", self.path("t.ply"), "--truth-resolution", "12", "-o", out
        yield "subdivide", mesh, "-o", out
        yield "simplify", mesh, "--faces", "60", "-o", out
        yield "terrain", points, "--max-edge", "1", "--raster", self.path("t.asc"), "--cell", "0.2", "-o", out
        yield "locate", points, "--at", places, "-o", self.path("l.csv")
        yield "interpolate", values, "--at", places, "--property", "t", "-o", self.path("i.csv")
        yield "voronoi", places, "--box", "0,0,0,1,1,1", "-o", self.path("c.csv")

    def test_every_line_is_explained_in_ascii(self):
        seen = set()
        for arguments in self.commands():
            run, manual = self.expect(0, *arguments, "--verbose"), self.expect(0, "help", arguments[0], "--verbose")
            self.assertTrue((run.out + run.err.encode() + manual.out).isascii(), arguments[0])
            explained = re.findall(r"(?m)^ +(\S+(?: \S+)*)(?:  |$)", manual.text)
            text, _, internals = run.text.partition("\ninternals\n")
            certificate = re.search(r"\ncertificate\n((?:  .*\n)+)", text)
            labels = lines_of(text) + [re.split(r"  +", line)[1] for part in (internals, certificate and certificate.group(1))
                                       for line in (part or "").splitlines()]
            self.assertEqual(sorted(set(labels) - set(explained)), [], arguments[0])
            seen.add(arguments[0])
        listed = set(re.findall(r"(?m)^  ([a-z]+)(?:  |$)", self.expect(0, "--help").text)) - {"done"}
        self.assertLessEqual({name for name in listed if name not in ("convert", "view")}, seen)


class Json(CliTest):
    def test_internals_are_an_object(self):
        points, out = self.cloud("a.ply", 500, "sphere"), self.path("out.ply")
        facts = self.facts("surface", points, "-o", out)
        self.assertEqual(set(facts["internals"]), {"unused", "specks", "relabeled", "handles", "energy", "undecided"})
        self.assertNotIn("energy", facts)
        self.assertEqual(facts["output"], out)
        named = "created destroyed walk_steps insphere_calls exact_calls".split()
        self.assertLessEqual(set(named), set(self.facts("delaunay", points)))
        named = "poles inner outer unlabelled edges triangles".split()
        self.assertLessEqual(set(named), set(self.facts("medial", points, "-o", out)))

    def test_genus_by_component_beside_genera(self):
        certificate = self.facts("check", self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES))["certificate"]
        self.assertEqual((certificate["genera"], certificate["genus_by_component"]), ([0], [0]))

    def test_warnings_and_hints(self):
        # A cloud without a surface: of 300 points the default bridges gaps with each of the seeds 1 to 3.
        cube, out = self.cloud("a.ply", 300, "cube"), self.path("out.ply")
        facts = self.facts("surface", cube, "-o", out)
        self.assertRegex("\n".join(facts["warnings"]), r"(?m)^[0-9.]+ % of the surface is a guess")
        self.assertIn("--open K leaves out", facts["warnings"][0])
        wider = self.facts("surface", cube, "-o", out, "--open", "1.5")
        self.assertLess(wider["bridges"]["area_share"], facts["bridges"]["area_share"])
        flat = self.facts("surface", self.xyz("b.xyz", [(x, y, 0) for x in range(4) for y in range(4)]), "-o", out, code=3)
        self.assertIn("b.xyz: ", flat["error"])
        self.assertTrue(any("--plane" in hint for hint in flat["hints"]))


class Messages(CliTest):
    def test_error_before_hints(self):
        flat = self.xyz("b.xyz", [(x, y, 0) for x in range(4) for y in range(4)])
        for method in ("labeled-delaunay", "power-crust", "cocone", "tight-cocone"):
            err = self.expect(3, "surface", flat, "-o", self.path("out.ply"), "--method", method).err
            self.assertRegex(err, r"\Abrio: \S*b\.xyz: .+\n(brio: hint: .+\n)+\Z")
            self.assertIn("brio delaunay", err)
        err = self.expect(3, "surface", flat, "-o", self.path("out.ply"), "--quiet").err
        self.assertEqual(err.count("\n"), 1)

    def test_open_with_too_small_holes(self):
        err = self.expect(3, "surface", self.cloud("a.ply", 500, "sphere"), "-o", self.path("o.ply"), "--open", "0.001").err
        self.assertRegex(err, "hint: a larger --open K")

    def test_empty_input_is_named(self):
        self.assertRegex(self.expect(3, "surface", self.file("a.xyz", ""), "-o", self.path("o.ply")).err, r"a\.xyz: no points")

    def test_wrong_words_list_the_right_ones(self):
        for arguments in [("surface", "a", "-o", "b.ply", "--method"), ("delaunay", "a", "--order")]:
            self.usage(r"unknown name 'xyzzy', expected [a-z-]+, .* or [a-z-]+\n", *arguments, "xyzzy")
        names = self.methods()
        self.usage("expected %s or %s; did you mean 'cocone'" % (", ".join(names[:-1]), names[-1]), "surface", "a",
                   "-o", "b.ply", "--method", "cocoon")

    def test_memory_hints(self):
        err = self.expect(4, "surface", self.cloud("a.ply", 500), "-o", self.path("o.ply"), "--max-memory", "1M").err
        self.assertRegex(err, r"hint: --scratch DIR")
        self.assertIn("brio info", err)

    def test_unknown_format_hint(self):
        self.assertIn("hint: --input-format", self.expect(2, "info", self.file("a.doc", "hello")).err)

    def test_a_mistyped_option_has_no_hint_beside_its_sentence(self):
        self.assertNotIn("hint", self.expect(1, "surface", "--metod", "x").err)

    def test_an_option_of_another_method_is_named(self):
        self.usage(r"brio: --noise is for --method labeled-delaunay or power-crust, and the method is cocone", "surface",
                   "a", "-o", "b.ply", "--method", "cocone", "--noise", "keep")

    def test_warnings_have_one_form(self):
        points = self.cloud("a.ply", 500, "sphere")
        err = self.expect(0, "surface", points, "-o", self.path("o.ply"), "--method", "cocone", "--theta", "0.2").err
        self.assertRegex(err, r"\Abrio: warning: --theta: .+\n\Z")
        run = self.expect(0, "surface", points, "-o", self.path("o.ply"), "--method", "cocone", "--theta", "0.2", "--quiet")
        self.assertEqual((run.out, run.err), (b"", ""))


class Help(CliTest):
    def test_each_way_to_ask(self):
        self.assertEqual(self.expect(0, "help").out, self.expect(0, "--help").out)
        self.assertEqual(self.expect(0, "-h").out, self.expect(0, "--help").out)
        self.assertEqual(self.expect(0, "-V").out, self.expect(0, "--version").out)
        self.assertEqual(self.expect(0, "help", "surface").out, self.expect(0, "surface", "--help").out)
        self.assertEqual(self.expect(0, "generate", "iso", "--help").out, self.expect(0, "help", "iso").out)
        self.assertIn("cocone", self.expect(0, "help", "methods").text)
        self.usage("unknown command 'surfac'; did you mean 'surface'", "help", "surfac")

    def test_options_stand_with_their_method(self):
        text = self.expect(0, "help", "surface").text
        places = [text.index(words) for words in ["--method NAME", "\noptions of labeled-delaunay and", "\n  --open K",
                                                  "\noptions of power-crust", "\n  -B, --sharp", "\noptions of cocone and", "--theta",
                                                  "options of cocone:", "--pieces", "options of every command", "examples:"]]
        self.assertEqual(places, sorted(places))

    def test_every_command_has_an_example_that_names_it(self):
        for name in re.findall(r"(?m)^  ([a-z]+)  +\w.*", self.expect(0, "--help").text.split("\nhelp:")[0]):
            self.assertRegex(self.expect(0, "help", name).text, r"\nexamples:\n  brio %s " % name)

    def extensions(self, command, title):
        text = " ".join(self.expect(0, "help", command).text.split())
        found = re.search(title + r": ((?:\.[a-z0-9]+ ?)+)", text)
        return found.group(1).replace(".", "").split() if found else []

    def test_files_that_are_read_are_those_of_the_error(self):
        error = self.expect(2, "info", self.file("a.doc", "hello")).err
        self.assertEqual(sorted(self.extensions("info", "reads")), sorted(re.findall(r" \.([a-z0-9]+)", error)))

    def test_files_that_are_written(self):
        needs = {"alpha": ["--alpha", "auto"], "offset": ["-D", "1"], "iso": ["--level", "1"], "locate": ["--at", "b.xyz"],
                 "interpolate": ["--at", "b.xyz", "--property", "p"]}
        for command in ["delaunay", "surface", "medial", "hull", "alpha", "offset", "voronoi", "iso", "subdivide", "locate",
                        "interpolate"]:
            names = self.extensions(command, "writes")
            self.assertTrue(names, command)
            for name in names:  # found before the input is
                self.expect(2, command, "missing.ply", "-o", "out." + name, *needs.get(command, []))
        for name in self.extensions("generate", "writes"):
            if name != "stl":  # which holds no points, but solids
                self.expect(0, "generate", "cube", "-n", "9", "-o", "out." + name)

    def test_narrow_terminal(self):
        for columns in (34, 50, 80, 200):
            text = self.on_terminal(columns, "help", "surface").partition("\nexamples:")[0]
            self.assertLessEqual(max(map(len, text.splitlines())), max(min(columns, 100), 34))

    def on_terminal(self, columns, *arguments):
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([BRIO, *arguments], stdout=slave, stderr=slave, stdin=subprocess.DEVNULL)
        os.close(slave)
        out = b""
        while True:
            try:
                part = os.read(master, 65536)
            except OSError:
                break
            if not part:
                break
            out += part
        os.close(master)
        self.assertEqual(process.wait(), 0)
        return out.decode().replace("\r\n", "\n")


if __name__ == "__main__":
    main()
