#!/usr/bin/env python3
"""count_house.py [ROOT [OTHER_ROOT ...]]: the size of the house, in a column for each checkout.

Counted are the C files and headers of src, cli and include. A static function is called once when its name stands twice in its
file: where it is defined and where it is used (declarations ahead of the definition do not count). A header has one
user when one file at most includes it besides the .c of its own name. Exported functions are those that the public headers mark with BRIO_API or BRIO_EXPERIMENTAL.
"""

import pathlib
import re
import sys

SMALL, LARGE = 50, 600
COMMENT_OR_TEXT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.S)
STATIC = re.compile(r"^static (?!const\b[^(]*=)(?:inline )?[\w\s*]*?\b(\w+)\(", re.M)
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)


def files_of(root):
    return [p for top in ("src", "cli", "include") for p in sorted((root / top).rglob("*")) if p.suffix in (".c", ".h")]


def without_comments(text):
    return COMMENT_OR_TEXT.sub(lambda m: '""' if m.group().startswith('"') else "\n" * m.group().count("\n"), text)


def functions_called_once(text):
    """Static functions of a file, and those whose names the file uses once besides their definition."""
    code = without_comments(text)
    names = set(STATIC.findall(code))
    once = 0
    for name in names:
        declared = len(re.findall(r"^static [^;{}=]*?\b%s\([^;{}]*\);" % name, code, re.M))
        once += len(re.findall(r"\b%s\b" % name, code)) - declared == 2
    return len(names), once


def users_of_headers(root, files):
    """The files that include each header, by the header's path."""
    users = {p: set() for p in files if p.suffix == ".h"}
    for path in files:
        for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
            for folder in (path.parent, root / "src", root, root / "include"):
                found = (folder / name).resolve()
                if found in users:
                    users[found].add(path)
                    break
    return users


def single_headers(root, files):
    """Headers of src and cli that one file at most includes besides the .c of their name."""
    users = users_of_headers(root, files)
    return [h for h, u in users.items()
            if h.relative_to(root).parts[0] != "include" and len({p for p in u if p.stem != h.stem}) <= 1]


def count(root):
    root = root.resolve()
    files = files_of(root)
    texts = {p: p.read_text(encoding="utf-8") for p in files}
    statics = [functions_called_once(t) for t in texts.values()]
    lines = {p: t.count("\n") for p, t in texts.items()}
    users = {h: u for h, u in users_of_headers(root, files).items() if "include" not in h.relative_to(root).parts[:1]}
    public = "".join(t for p, t in texts.items() if p.relative_to(root).parts[0] == "include")
    return [
        ("files", len(files)),
        ("lines", sum(lines.values())),
        ("files under %d lines" % SMALL, sum(n < SMALL for n in lines.values())),
        ("  per cent", round(100 * sum(n < SMALL for n in lines.values()) / len(files))),
        ("files over %d lines" % LARGE, sum(n > LARGE for p, n in lines.items() if "include" not in p.relative_to(root).parts[:1])),
        ("static functions", sum(n for n, _ in statics)),
        ("  called once", sum(n for _, n in statics)),
        ("  per cent", round(100 * sum(n for _, n in statics) / sum(n for n, _ in statics))),
        ("headers", len(users)),
        ("  with one user", len(single_headers(root, files))),
        ("labels done:", sum(len(re.findall(r"^done:", t, re.M)) for t in texts.values())),
        ("asserts", sum(len(re.findall(r"(?<!_)\bassert\(", t)) for t in texts.values())),
        ("exported functions", len(re.findall(r"^(?:BRIO_API|BRIO_EXPERIMENTAL)\b", public, re.M))),
        ("exported types", len(re.findall(r"^typedef\b", public, re.M))),
    ]


def main():
    roots = [pathlib.Path(a) for a in sys.argv[1:]] or [pathlib.Path(__file__).resolve().parents[2]]
    columns = [count(root) for root in roots]
    for rows in zip(*columns):
        print("%-40s" % rows[0][0] + "".join("%10d" % value for _, value in rows))


if __name__ == "__main__":
    main()
