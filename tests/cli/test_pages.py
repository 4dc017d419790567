"""The manual pages and the completions that the build makes."""

import os
import pathlib
import re
import shutil
import subprocess

from brio_cli import BRIO, CliTest, main

PAGES = pathlib.Path(BRIO).resolve().parent / "pages"


def pages():
    return sorted((PAGES / "man1").glob("*.1"))


class PagesTest(CliTest):
    def setUp(self):
        if not (PAGES / "written").exists():
            self.skipTest("the build made no pages beside the program")
        super().setUp()

    def need(self, program):
        if not shutil.which(program):
            self.skipTest("there is no " + program)


class Manual(PagesTest):
    def test_a_page_for_each_command(self):
        commands = re.findall(r"(?m)^  ([a-z]+)(?:  |$)", self.expect(0, "--help").text.split("\nhelp:")[0])
        self.assertEqual([p.name for p in pages()], sorted(["brio.1"] + ["brio-%s.1" % name for name in commands]))

    def test_pages_say_what_the_help_says(self):
        for page in pages()[1:] if pages()[0].name == "brio.1" else pages():
            command = page.stem.partition("-")[2]
            if not command:
                continue
            text = page.read_text(encoding="ascii").replace("\\-", "-").replace("\\fR", "").replace("\\fB", "")
            for option in re.findall(r"(?m)^  (?:-\w, )?(--[a-z0-9-]+)", self.expect(0, "help", command).text):
                self.assertRegex(text, r"(?m)^(-\w, )?%s\b|, %s\b" % (option, option), command)

    def test_groff_has_no_complaint(self):
        self.need("groff")
        for page in pages():
            done = subprocess.run(["groff", "-man", "-Tascii", "-ww", str(page)], capture_output=True)
            self.assertEqual((done.returncode, done.stderr), (0, b""), page.name)
            self.assertTrue(done.stdout.isascii())

    def test_mandoc_has_no_complaint(self):
        self.need("mandoc")
        for page in pages():
            done = subprocess.run(["mandoc", "-Tlint", str(page)], capture_output=True)
            self.assertEqual(done.stdout, b"", page.name)


class Bash(PagesTest):
    def setUp(self):
        self.need("bash")
        super().setUp()

    def complete(self, *words):
        """What bash offers for the last of the words."""
        script = 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _brio; printf "%s\\n" "${COMPREPLY[@]}"'
        done = subprocess.run(["bash", "--norc", "-c", script, "bash", str(PAGES / "bash" / "brio"), "brio", *words],
                              capture_output=True, cwd=self.folder, timeout=60)
        self.assertEqual(done.stderr, b"")
        return sorted(done.stdout.decode().split())

    def test_commands(self):
        self.assertEqual(self.complete("su"), ["subdivide", "surface"])
        self.assertEqual(self.complete("help", "meth"), ["methods"])
        self.assertIn("iso", self.complete(""))

    def test_options_are_those_of_the_help(self):
        for command in self.complete(""):
            if command.startswith("-") or command == "help":
                continue
            listed = re.findall(r"(?m)^  (?:-\w, )?(--[a-z0-9-]+)", self.expect(0, "help", command).text)
            self.assertEqual(self.complete(command, "--"), sorted(listed), command)

    def test_words_that_options_take(self):
        names = sorted(self.methods())
        self.assertEqual(self.complete("surface", "--method", ""), names)
        self.assertEqual(self.complete("surface", "a.ply", "--method", "=", "co"), ["cocone"])
        self.assertEqual(self.complete("surface", "a.ply", "--method", "="), names)
        self.assertEqual(self.complete("medial", "--sides", "o"), ["outer"])
        self.assertEqual(self.complete("generate", "so"), ["solid"])
        self.assertEqual(self.complete("alpha", "x.ply", "--format", "vt"), ["vtk", "vtp", "vtu"])
        self.assertEqual(self.complete("surface", "--theta", ""), [])

    def test_files_by_extension(self):
        for name in ["a.ply", "B.PLY", "a.map", "a.doc", "a.csv"]:
            self.file(name, "")
        os.mkdir(self.path("folder"))
        self.assertEqual(self.complete("surface", ""), ["B.PLY", "a.csv", "a.ply", "folder"])
        self.assertEqual(self.complete("iso", "a"), ["a.map"])
        self.assertEqual(self.complete("locate", "a.ply", "-o", "a"), ["a.csv"])
        self.assertEqual(self.complete("locate", "a.ply", "--at", "a"), ["a.csv", "a.doc", "a.map", "a.ply"])
        self.assertEqual(self.complete("info", "--scratch", ""), ["folder"])


class Zsh(PagesTest):
    """Drives an interactive zsh through a terminal of its own, its module zpty."""

    SCRIPT = r"""
zmodload zsh/zpty || exit 77
zpty z zsh -f -i
zpty -w z "PS1=; unsetopt prompt_cr prompt_sp; fpath=($1 \$fpath); autoload -Uz compinit; compinit -u -D; LISTMAX=1000"
zpty -w z "zstyle ':completion:*' list-colors ''; bindkey '^I' complete-word; bindkey '^X' list-choices; print REA''DY"
zpty -r z out '*READY*' || exit 1
zpty -n -w z "$2"$'\t'
sleep 0.7
zpty -n -w z $'\x15print EN\'\'D\n'
zpty -r z out '*END*'
print -r -- "$out"
zpty -d z
"""

    def complete(self, line):
        done = subprocess.run(["zsh", "-f", "-c", self.SCRIPT, "zsh", str(PAGES / "zsh"), line], capture_output=True,
                              cwd=self.folder, timeout=60)
        if done.returncode == 77:
            self.skipTest("this zsh has no module zpty")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.decode(errors="replace")

    def test_commands_options_and_words(self):
        self.need("zsh")
        done = subprocess.run(["zsh", "-n", str(PAGES / "zsh" / "_brio")], capture_output=True)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertIn("brio voronoi", self.complete("brio voro"))
        self.assertIn("--labeling", self.complete("brio surface --labe"))
        self.assertIn("tight-cocone", self.complete("brio surface --method tig"))


if __name__ == "__main__":
    main()
