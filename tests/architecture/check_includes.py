"""check_includes.py ROOT: the shape of the house. Includes run along the arrows of arrows.txt only, which
docs/architecture.md shows. Programs see the public headers alone, and the library neither allocates, prints nor exits, but
for the files of SYSTEM_FILES, which do so for all. The program sees src/platform, too.

A line of arrows.txt: a room of src or of cli, and the rooms that its files may include, besides their own; a header stands for
itself alone. The rooms that a line names stand above it, so that no arrows run in a circle.

Nor do the modules of a room include each other in a circle, a module being a .c file and the header of its name; CIRCLES are the
rooms in which some do."""

import pathlib
import re
import sys

ARROWS = pathlib.Path(__file__).with_name("arrows.txt")
PICTURE = "docs/architecture.md"
PROGRAMS = ["cli", "examples", "bench"]
CIRCLES = {"io", "io/compressed", "io/las", "mesh", "query", "reconstruct/labels", "reconstruct/noise", "triangulation"}
SYSTEM_FILES = {"src/base/memory.c", "src/base/context_new.c", "src/platform/pages_posix.c", "src/platform/pages_wasi.c",
                "src/platform/pages_windows.c", "src/platform/program_posix.c", "src/platform/program_windows.c"}
FORBIDDEN = re.compile(r"(?<![\w.>])(malloc|calloc|realloc|reallocarray|aligned_alloc|posix_memalign|strn?dup|free"
                       r"|v?[fda]?printf|f?puts|f?putc|putchar|perror|_?exit|_Exit|quick_exit|abort)\s*\(")
COMMENT_OR_TEXT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.S)
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.M)


def find_included(root, path, included):
    """The folders and name, below the root, of what an include line names; empty for headers of the system."""
    for folder in (path.parent, root / "src", root / "include", root):
        found = (folder / included).resolve()
        if found.is_file() and found.is_relative_to(root):
            return found.relative_to(root).parts
    return ()


def room_of(parts):
    """The room of a file: its folder, of src without that name."""
    return "/".join(parts[1:-1] if parts[0] == "src" else parts[:-1])


def read_arrows(text):
    """The rooms that each room may include; and complaints."""
    arrows, wrong = {}, []
    for line in text.splitlines():
        room, _, seen = line.partition(":")
        for other in seen.split():
            if (other.rpartition("/")[0] if other.endswith(".h") else other) not in arrows:
                wrong.append("arrows.txt: %s includes %s, which is not above it" % (room, other))
        arrows[room] = {room, *seen.split()}
    return arrows, wrong


def may_include(arrows, path_parts, included_parts):
    if not included_parts or included_parts[:2] == ("include", "brio"):
        return True
    if path_parts[0] not in ("src", "cli"):
        return included_parts[0] == path_parts[0]
    if path_parts[0] == "cli" and included_parts[0] == "src" and room_of(included_parts) != "platform":
        return False
    seen = arrows.get(room_of(path_parts), ())
    return room_of(included_parts) in seen or "/".join(included_parts[included_parts[0] == "src":]) in seen


def circles(root, files):
    """The rooms whose modules include each other in a circle, each with one."""
    rooms = {}
    for path in files:
        name = path.relative_to(root)
        if name.parts[0] not in ("src", "cli"):
            continue
        modules = rooms.setdefault(room_of(name.parts), {})
        for included in INCLUDE.findall(path.read_text(encoding="utf-8")):
            parts = find_included(root, path, included)
            if parts and parts[:-1] == name.parts[:-1] and pathlib.Path(parts[-1]).stem != name.stem:
                modules.setdefault(name.stem, set()).add(pathlib.Path(parts[-1]).stem)
    for room, modules in rooms.items():
        left = dict(modules)
        while True:  # modules that include none of those that are left are in no circle
            free = [m for m, others in left.items() if not any(o in left for o in others)]
            if not free:
                break
            for module in free:
                del left[module]
        if left:
            yield room, sorted(left)


def complaints(root, arrows, path):
    text, name = path.read_text(encoding="utf-8"), path.relative_to(root)
    for match in INCLUDE.finditer(text):
        if not may_include(arrows, name.parts, find_included(root, path, match.group(1))):
            yield "%s:%d: must not include %s" % (name, text.count("\n", 0, match.start(1)) + 1, match.group(1))
    if name.parts[0] != "src" or name.as_posix() in SYSTEM_FILES:
        return
    code = COMMENT_OR_TEXT.sub(lambda match: "\n" * match.group().count("\n"), text)
    for match in FORBIDDEN.finditer(code):
        yield "%s:%d: must not call %s" % (name, code.count("\n", 0, match.start(1)) + 1, match.group(1))


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = [path for top in ["src", *PROGRAMS] for path in sorted((root / top).rglob("*"))
             if path.suffix in (".c", ".h", ".cpp")]
    table = ARROWS.read_text(encoding="utf-8")
    arrows, wrong = read_arrows(table)
    if "```\n" + table + "```\n" not in (root / PICTURE).read_text(encoding="utf-8"):
        wrong.append("%s does not show the arrows of %s" % (PICTURE, ARROWS.name))
    wrong += [line for path in files for line in complaints(root, arrows, path)]
    wrong += ["%s: modules include each other in a circle, among %s: part what all need from what needs all" % (room, " ".join(some))
              for room, some in circles(root, files) if room not in CIRCLES]
    print("\n".join([*wrong, "%d files, %d complaints" % (len(files), len(wrong))]))
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
