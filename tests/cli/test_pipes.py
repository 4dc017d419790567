"""Standard input and standard output in place of files."""

import os
import subprocess

from brio_cli import BRIO, CliTest, main


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

    def test_one_pipe_as_input_and_output_is_refused(self):
        """The run waited for ever, for what it would write itself."""
        pipe = self.path("pipe")
        os.mkfifo(pipe)
        held = os.open(pipe, os.O_RDWR)
        self.addCleanup(os.close, held)
        formats = ["--input-format", "xyz", "--format", "ply"]
        self.usage("the input and -o name the same file", "surface", pipe, "-o", pipe, *formats)
        self.usage("the input and -o name the same file", "convert", pipe, pipe, *formats)
        for names in ("-", pipe), (pipe, "-"), ("-", "-"), ("/dev/stdin", pipe):
            done = subprocess.run([BRIO, "convert", *names, *formats], stdin=held, stdout=held, stderr=subprocess.PIPE,
                                  timeout=60)
            self.assertEqual(done.returncode, 1, names)
            self.assertIn(b"name the same file", done.stderr)

    def test_file_appended_to_itself_is_refused(self):
        points = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 0)])
        with open(points, "ab") as f:
            done = subprocess.run([BRIO, "convert", points, "-", "--format", "xyz"], stdout=f, stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"name the same file", done.stderr)

    def test_quiet_chain_says_nothing(self):
        made = self.expect(0, "generate", "grid", "-n", "8", "-o", "-", "--format", "xyz", "--quiet")
        self.assertEqual(made.err, "")


if __name__ == "__main__":
    main()
