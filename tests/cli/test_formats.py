"""The program's list of formats: no two are alike, and docs/formats.md says the same of each."""

import pathlib
import re

import formats
from brio_cli import CliTest, main

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/formats.md"
SOME_PROPERTIES = {"properties", "colours", "normals", "intensity"}


def rows_of_the_page():
    """The cells of the rows of the table, by their titles."""
    lines = PAGE.read_text(encoding="utf-8").split("| format | points |")[1].split("\n\n")[0].splitlines()
    titles = ["format", "points"] + [cell.strip() for cell in lines[0].strip("| ").split("|")]
    return [dict(zip(titles, [cell.strip() for cell in line.strip("| ").split("|")])) for line in lines[2:]]


class Formats(CliTest):
    def test_numbers_and_extensions_are_one_formats_own(self):
        numbers = [kind["number"] for kind in formats.formats()]
        extensions = [e for kind in formats.formats() for e in kind["read"]]
        self.assertEqual(sorted(numbers), list(range(1, len(numbers) + 1)), "src/io/format_table.c: numbers without a gap")
        self.assertEqual(sorted(extensions), sorted(set(extensions)), "src/io/format_table.c: an extension is there twice")
        for kind in formats.formats():
            self.assertLessEqual(set(kind["written"]), set(kind["read"]), "what is written is read: " + kind["name"])

    def test_each_format_is_in_the_table_of_the_page(self):
        for kind in formats.formats():
            rows = [row for row in rows_of_the_page() if set(kind["read"]) & set(re.findall(r"\.\w+", row["format"])) - {".xyz"}]
            rows += [row for row in rows_of_the_page() if kind["format"] == "xyz" and row["format"].startswith("text")]
            self.assertTrue(rows, "%s: docs/formats.md has no row for it in its first table" % kind["name"])
            listed = {e for row in rows for e in re.findall(r"\.\w+", row["format"])}
            self.assertLessEqual(set(kind["read"]), listed, "docs/formats.md: extensions of %s" % kind["name"])
            self.expect_row(kind, rows[0])

    def expect_row(self, kind, row):
        """What the page calls written is what a file that brio writes can hold."""
        for title, held in (("polygons", {"faces"}), ("tetrahedra", {"tetrahedra"}), ("edges", {"edges"}),
                            ("properties of points", SOME_PROPERTIES)):
            cell = row[title]
            written = cell != "no" and not re.search(r"\bread\b", cell)
            self.assertEqual(bool(held & set(kind["holds"])), written, "docs/formats.md: %s of %s are \"%s\", brio says %s"
                             % (title, kind["name"], cell, kind["holds"] or "read only"))

    def test_the_help_lists_what_programs_are_told(self):
        text = " ".join(self.expect(0, "help", "formats").text.split())
        for kind in formats.formats():
            self.assertIn(" ".join(kind["read"]) + " " + kind["name"], text)
            self.assertEqual(kind["name"] + ", read only" in text, not kind["written"], kind["name"])
        told = self.expect(0, "convert", "--help").text.split("writes:")[1].split("\n\n")[0].split()
        self.assertEqual(sorted(told), sorted(e for kind in formats.formats() for e in kind["written"]))


if __name__ == "__main__":
    main()
