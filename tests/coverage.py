"""coverage.py EXPORT ROOT MISSED: the table of make coverage, from what llvm-cov exports.

A row for each folder of ROOT: lines and branches, those that were reached, and their share. Writes the lines that nothing
reached to MISSED, as FILE:LINE: TEXT. A line counts as reached if one of its regions is.
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


def main():
    export, root, missed = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    rows = collections.defaultdict(lambda: [0, 0, 0, 0])
    lines = []
    for file in json.loads(export.read_text())["data"][0]["files"]:
        path = pathlib.Path(file["filename"])
        name = path.relative_to(root)
        text = path.read_text().splitlines()
        counts = {n: c for n, c in line_counts(file["segments"]).items() if holds_code(text[n - 1])}
        branches = [side for b in file["branches"] for side in b[4:6]]
        reached = [sum(c > 0 for c in counts.values()), sum(c > 0 for c in branches)]
        for row in str(name.parent), "all":
            for i, number in enumerate((len(counts), reached[0], len(branches), reached[1])):
                rows[row][i] += number
        lines += ["%s:%d: %s\n" % (name, n, text[n - 1].strip()) for n, c in sorted(counts.items()) if not c]
    missed.write_text("".join(lines))
    print("%-34s %7s %7s %6s  %8s %7s %6s" % ("folder", "lines", "reached", "%", "branches", "reached", "%"))
    for name in sorted(rows, key=lambda name: (name == "all", name)):
        row = rows[name]
        print("%-34s %7d %7d %6.1f  %8d %7d %6.1f" % (
            name, row[0], row[1], 100 * row[1] / max(row[0], 1), row[2], row[3], 100 * row[3] / max(row[2], 1)))


if __name__ == "__main__":
    main()
