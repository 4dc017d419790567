"""check_includes.py ROOT: the shape of the house. Includes run downwards only, programs see the public header alone,
and the library neither allocates, prints nor exits, but for the two files of src/base that do so for all."""

import pathlib
import re
import sys

LAYERS = ["base", "predicates", "order", "triangulation", "dual", "surface", "reconstruct"]
MAY_SEE = {layer: set(LAYERS[:i + 1]) for i, layer in enumerate(LAYERS)} | {"io": {"base", "surface", "io"},
                                                                   "estimate": {"base", "order", "estimate"}}
# the rooms of src/reconstruct
MAY_SEE_ROOM = {"labels": {"labels"}, "power_crust": {"labels", "power_crust"}, "cocone": {"cocone"}}
LABEL = ("src", "reconstruct", "labels", "label.h")
PROGRAMS = ["cli", "examples", "bench"]
SYSTEM_FILES = {"src/base/memory.c", "src/base/context.c"}
FORBIDDEN = re.compile(r"(?<![\w.>])(malloc|calloc|realloc|reallocarray|aligned_alloc|posix_memalign|strn?dup|free"
                       r"|v?[fda]?printf|f?puts|f?putc|putchar|perror|_?exit|_Exit|quick_exit|abort)\s*\(")
COMMENT_OR_TEXT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.S)
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.M)


def find_included(root, path, included):
    """The folders and name, below the root, of what an include line names; empty for headers of the system."""
    for folder in (path.parent, root / "src", root / "include"):
        found = (folder / included).resolve()
        if found.is_file() and found.is_relative_to(root):
            return found.relative_to(root).parts
    return ()


def may_include(path_parts, included_parts):
    if not included_parts or included_parts == ("include", "brio", "brio.h"):
        return True
    if path_parts[0] == "src":
        if path_parts[1] == included_parts[1] == "reconstruct":
            return included_parts == LABEL or included_parts[2] in MAY_SEE_ROOM.get(path_parts[2], ())
        return included_parts[0] == "src" and included_parts[1] in MAY_SEE.get(path_parts[1], ())
    return included_parts[0] == path_parts[0]


def complaints(root, path):
    text, name = path.read_text(encoding="utf-8"), path.relative_to(root)
    for match in INCLUDE.finditer(text):
        if not may_include(name.parts, find_included(root, path, match.group(1))):
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
    wrong = [line for path in files for line in complaints(root, path)]
    print("\n".join([*wrong, "%d files, %d complaints" % (len(files), len(wrong))]))
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
