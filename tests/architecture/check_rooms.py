"""check_rooms.py ROOT: how large rooms and files are, and what they may name.

  - No file of src and cli has more than LINES lines; LONG are those that have, which may not grow.
  - A folder holds 3 to 30 files. FOLDERS lists the others, with the number of files that they have now: it may only fall
    towards 30.
  - Files under 50 lines outside of src/platform, which has a file for each system, and headers that one file alone includes besides the .c of their name, do not become more than
    SMALL and SINGLE. Where the number falls, the check says so: write the new number here.
  - A format's name, BRIO_FORMAT_PLY and its like, stands in src/io alone; NAMED are the files of cli that still ask for one by
    name, each with the names.
  - No text of cli lists the extensions of LISTED formats or more: brio_format_list makes such lists. OWN are the files whose
    commands write files themselves.
  - No line is wider than COLUMNS columns; WIDE are the rooms whose comments are wider, each with the number of such lines.

Each complaint names the file and the way out.
"""

import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from count_house import SMALL as SMALL_LINES, files_of, single_headers, without_comments

LINES, COLUMNS, FEWEST, MOST = 600, 120, 3, 30
SMALL, SINGLE = 235, 76
FOLDERS = {"src/base": 46, "src/io": 50, "src/mesh": 44, "src/plane": 33, "src/platform": 31, "src/predicates": 31, "src/reconstruct/cocone": 35,
           "src/reconstruct/labeled_delaunay": 36, "src/testdata": 31, "src/triangulation": 54}
WIDE = {"include": 12, "src/reconstruct": 19}
LONG = {}
FORMAT = re.compile(r"\bBRIO_FORMAT_(?!AUTO\b|MOST\b|LIST\b)([A-Z0-9_]+)\b")
NAMED = {
    "cli/commands/convert.c": "PLY",
    "cli/commands/delaunay.c": "NODE",
}
LISTED = 3
OWN = {"cli/commands/voronoi.c"}


def check_sizes(root, files):
    folders = {}
    for path in files:
        name = path.relative_to(root).as_posix()
        lines = path.read_text(encoding="utf-8").count("\n")
        if lines > LONG.get(name, LINES) and not name.startswith("include/"):
            yield "%s has %d lines, at most %d: what would a stranger look for in it? Make that a file of its own" % (name, lines, LINES)
        if not name.startswith("include/"):
            folders[path.parent] = folders.get(path.parent, 0) + 1
    formats = (root / "src/io/format_table.c").read_text(encoding="utf-8").count("{sizeof(brio_format_info)")
    for folder, count in sorted(folders.items()):
        name = folder.relative_to(root).as_posix()
        if name in FOLDERS and count <= FOLDERS[name] + (formats if name == "src/io" else 0):  # a file for each format
            continue
        if count > MOST:
            yield "%s has %d files, at most %d: it is two rooms; find the arrows between its parts" % (name, count, FOLDERS.get(name, MOST))
        if count < FEWEST and name != "cli":
            yield "%s has %d files, %d at least: put them into the room of their user" % (name, count, FEWEST)


def check_boxes(root, files):
    small = [p for p in files if p.parent.name != "platform" and p.read_text(encoding="utf-8").count("\n") < SMALL_LINES]
    single = single_headers(root, files)
    for what, found, most, way in (("files under %d lines" % SMALL_LINES, small, SMALL, "put what is new into the file of its user"),
                                   ("headers with one user", single, SINGLE, "put the declarations into the user, or the user's own header")):
        if len(found) > most:
            yield "%d %s, at most %d: %s. These are all:\n  %s" % (
                len(found), what, most, way, "\n  ".join(sorted(p.relative_to(root).as_posix() for p in found)))
        if len(found) < most:
            print("%d %s, and this check allows %d: write the new number into it" % (len(found), what, most))


def check_formats(root, files):
    for path in files:
        name = path.relative_to(root).as_posix()
        found = sorted(set(FORMAT.findall(without_comments(path.read_text(encoding="utf-8")))) - set(NAMED.get(name, "").split()))
        if found and not name.startswith(("include/", "src/io/")):
            yield "%s names the format %s: ask brio_format_facts what a format can do" % (name, ", ".join(found))


def check_lists(root, files):
    table = (root / "src/io/format_table.c").read_text(encoding="utf-8")
    known = {word for row in re.findall(r'\{sizeof\(brio_format_info\),.*?"[^"]*",\s*"([^"]*)"', table, re.S) for word in row.split()}
    for path in files:
        name = path.relative_to(root).as_posix()
        if not name.startswith("cli/") or name in OWN:
            continue
        for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', without_comments(path.read_text(encoding="utf-8"))):
            found = re.findall(r"(?<![\w/<>])\.?(\w+)(?=[ ,;]|$)", text)
            listed = [word for word in found if word in known] if "brio " not in text else []
            if len(set(listed)) >= LISTED:
                yield "%s lists the formats %s: let brio_format_list make the list" % (name, " ".join(listed))


def check_columns(root, files):
    wide = dict.fromkeys(WIDE, 0)
    for path in files:
        name = path.relative_to(root).as_posix()
        later = next((room for room in WIDE if name.startswith(room + "/")), None)
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if len(line) > COLUMNS and later:
                wide[later] += 1
            elif len(line) > COLUMNS and not line.lstrip().startswith("#define"):
                yield "%s:%d has %d columns, at most %d: break the line" % (name, number, len(line), COLUMNS)
    for room, count in wide.items():
        if count > WIDE[room]:
            yield "%s has %d lines of more than %d columns, at most %d: break those that are new" % (room, count, COLUMNS, WIDE[room])


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = files_of(root)
    wrong = [line for check in (check_sizes, check_boxes, check_formats, check_lists, check_columns) for line in check(root, files)]
    print("\n".join([*wrong, "%d files, %d complaints" % (len(files), len(wrong))]))
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
