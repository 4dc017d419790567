"""coverage.py EXPORT ROOT FOLDER: the table of make coverage, from what llvm-cov exports.

A row for each folder of ROOT: lines and sides of branches, those that were reached, and their share. Branches within macros,
as those of BRIO_TRY and BRIO_FORWARD, are counted where the macro is used. Writes to FOLDER what nothing reached: missed.txt, lines as FILE:LINE:
TEXT, and sides.txt, sides of branches as FILE:LINE: never true (or false): TEXT. A line counts as reached if one of its
regions is.
"""

import collections
import json
import pathlib
import sys


def line_counts(segments):
    """The count of each line that has code: the greatest of the regions on it."""
    counts = {}
    for here, after in zip(segments, segments[1:]):
        line, _, count, has_count, _, is_gap = here[:6]
        if not has_count or is_gap:
            continue
        last = after[0] if after[1] > 1 else after[0] - 1
        for number in range(line, max(last, line) + 1):
            counts[number] = max(counts.get(number, 0), count)
    return counts


def holds_code(text):
    text = text.strip()
    return bool(text) and text not in ("{", "}", "};", "} else {", "done:") and not text.startswith(("/*", "*", "//"))


def sides_of(file):
    """(line, "true" or "false", count) of each side of the branches of a file. A macro that is expanded in a macro is listed
    for each of them: the same branch of the same use counts once."""
    found = [(b[0], b[1], b[0], b[1], b) for b in file["branches"]]
    for use in file["expansions"]:
        found += [(*use["source_region"][:2], b[0], b[1], b) for b in use["branches"]]
    counts = collections.Counter()
    for line, column, inner_line, inner_column, b in found:
        for side, count in ("true", b[4]), ("false", b[5]):
            key = line, column, inner_line, inner_column, side
            counts[key] = max(counts[key], count)
    return [(key[0], key[-1], count) for key, count in sorted(counts.items())]


def main():
    export, root, folder = map(pathlib.Path, sys.argv[1:4])
    rows = collections.defaultdict(lambda: [0, 0, 0, 0])
    lines, missed_sides = [], []
    for file in json.loads(export.read_text())["data"][0]["files"]:
        path = pathlib.Path(file["filename"])
        name = path.relative_to(root)
        text = path.read_text().splitlines()
        counts = {n: c for n, c in line_counts(file["segments"]).items() if holds_code(text[n - 1])}
        sides = sides_of(file)
        reached = [sum(c > 0 for c in counts.values()), sum(c > 0 for _, _, c in sides)]
        for row in str(name.parent), "all":
            for i, number in enumerate((len(counts), reached[0], len(sides), reached[1])):
                rows[row][i] += number
        lines += ["%s:%d: %s\n" % (name, n, text[n - 1].strip()) for n, c in sorted(counts.items()) if not c]
        missed_sides += ["%s:%d: never %s: %s\n" % (name, n, side, text[n - 1].strip()) for n, side, c in sides if not c]
    (folder / "missed.txt").write_text("".join(lines))
    (folder / "sides.txt").write_text("".join(missed_sides))
    print("%-34s %7s %7s %6s  %8s %7s %6s" % ("folder", "lines", "reached", "%", "sides", "reached", "%"))
    for name in sorted(rows, key=lambda name: (name == "all", name)):
        row = rows[name]
        print("%-34s %7d %7d %6.1f  %8d %7d %6.1f" % (
            name, row[0], row[1], 100 * row[1] / max(row[0], 1), row[2], row[3], 100 * row[3] / max(row[2], 1)))


if __name__ == "__main__":
    main()
