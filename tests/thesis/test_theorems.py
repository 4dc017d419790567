"""docs/thesis-theorems.md: every statement of the dissertation has a row, and what a row names exists.

An answer names tests as `FILE: function` (or `function`, of the file named before), commands as `brio COMMAND --option ...`,
figures of bench/thesis after `make thesis`, or begins with "None: " and says why there is none."""

import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "bench", "thesis"))
import figures

BRIO = os.environ.get("BRIO", "brio")
# The numbers that the dissertation's statements have: one sequence; and two properties.
KINDS = {1: "lemma", 2: "observation", 4: "theorem", 9: "theorem", 11: "theorem", 15: "observation", 18: "theorem", 19: "theorem",
         20: "observation", 22: "theorem", 23: "corollary", 25: "theorem", 26: "theorem", 32: "corollary", 34: "theorem",
         35: "observation", 37: "corollary", 41: "corollary", 43: "theorem", 44: "observation", 46: "theorem", 48: "corollary",
         49: "observation", 52: "observation", 54: "theorem"}
STATEMENTS = ["%s %d" % (KINDS.get(i, "lemma"), i) for i in range(1, 58)] + ["property I", "property II"]
FIGURES = ["1.1"] + ["%d.%d" % (c, i) for c, n in ((2, 10), (3, 13), (4, 7), (5, 10)) for i in range(1, n + 1)] + \
    ["A.%d" % i for i in range(1, 4)] + ["B.%d" % i for i in range(1, 7)]


def rows():
    """(section, cells) of each row of a table."""
    section, found = "", []
    with open(os.path.join(ROOT, "docs", "thesis-theorems.md"), encoding="utf-8") as f:
        for line in f:
            if line.startswith("## "): section = line[3:].strip()
            elif line.startswith("| "): found.append((section, [c.strip() for c in line.strip().strip("|").split(" | ")]))
    heads = {"statement", "algorithm", "figure", "question"}
    return [(s, cells) for s, cells in found if cells[0] not in heads]


def named_figures(text):
    """'2.4 to 2.6, A.1' as a list."""
    names = []
    for part in text.split(", "):
        first, _, last = part.partition(" to ")
        chapter = first.split(".")[0]
        names += ["%s.%d" % (chapter, i) for i in range(int(first.split(".")[1]), int((last or first).split(".")[1]) + 1)]
    return names


class Page(unittest.TestCase):
    def test_every_statement_and_figure_has_one_row(self):
        self.assertEqual(sorted(cells[0] for s, cells in rows() if s == "Statements"), sorted(STATEMENTS))
        self.assertEqual(sorted(n for s, cells in rows() if s == "Figures" for n in named_figures(cells[0])), sorted(FIGURES))
        for section in "Algorithms", "Open questions":
            self.assertGreater(sum(s == section for s, _ in rows()), 8)

    def test_no_row_is_empty(self):
        for _, cells in rows():
            with self.subTest(row=cells[0]):
                self.assertEqual(len(cells), 3)
                answer = cells[2]
                if answer.startswith("None: "): self.assertGreater(len(answer.split()), 5)
                else: self.assertTrue("`" in answer or answer.endswith("above"), answer)

    def test_named_tests_exist(self):
        for _, cells in rows():
            file = ""
            for name in re.findall(r"`([^`]*)`", cells[2]):
                if name.split()[0] in ("brio", "make"): continue
                with self.subTest(row=cells[0], name=name):
                    path, _, function = name.rpartition(": ")
                    file = path or file
                    with open(os.path.join(ROOT, file), encoding="utf-8") as f: text = f.read()
                    if file.endswith(".py"):
                        self.assertIn("def %s(self" % function, text)
                        continue
                    self.assertIn("RUN(%s);" % function, text)
                    self.assertIn("static void %s(void) {" % function, text)

    def test_named_commands_exist(self):
        helps = {}
        for _, cells in rows():
            for line in re.findall(r"`brio ([^`]*)`", cells[2]):
                command, *options = line.split()
                if command not in helps:
                    run = subprocess.run([BRIO, command, "--help"], stdout=subprocess.PIPE, check=False, text=True)
                    helps[command] = run.stdout if run.returncode == 0 else ""
                with self.subTest(row=cells[0], line=line):
                    self.assertTrue(helps[command], "no such command")
                    for option in options:
                        if option.startswith("--"): self.assertRegex(helps[command], r"(?m)^  (?:-\w, )?%s\b" % option)

    def test_named_figures_exist(self):
        made = {f.name for f in figures.figures(2000000, 256 << 20, [1, 2, 4], [5, 10])}
        for _, cells in rows():
            match = re.search(r"`make thesis`: ([\w.-]+)(?:; counted: ([\w.-]+))?", cells[2])
            for name in match.groups() if match else ():
                if name: self.assertIn(name, made, cells[0])
        for name in made:
            if re.match(r"\d+\.\d+$", name):
                self.assertTrue(any("`make thesis`: %s" % name in cells[2] for _, cells in rows()), name)


if __name__ == "__main__":
    unittest.main()
