"""check_versions.py ROOT LIBRARY [CMAKE CC]: what docs/versions.md promises.

1. LIBRARY shows the functions that exported.txt lists and nothing else, and the headers declare the same.
2. Each struct that begins with its size has the fields that the frozen headers of this version (brio_0_3) have, in their order,
   and others behind these only.
3. With CMAKE and CC: a shared library is built, all of whose structs of options, statistics and results have one more field, at
   their end. It exports the same functions, and a program compiled with the frozen headers runs with it.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SIZED = re.compile(r"((?:typedef )?struct (brio_\w+) \{\n    size_t size;\n.*?)(\n\}(?: \2)?;)", re.S)


def run(*command, **more):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          encoding="utf-8", **more)
    if done.returncode:
        sys.exit("%s:\n%s" % (" ".join(map(str, command)), done.stdout[-4000:]))
    return done.stdout


def headers(root):
    return sorted(path for path in (root / "include/brio").glob("*.h") if path.name not in ("testdata.h", "laboratory.h"))  # of libraries beside it


def grow(root):
    """One more field for each struct that begins with its size."""
    names = []
    for header in headers(root):
        text = header.read_text(encoding="utf-8")
        names += [match.group(2) for match in SIZED.finditer(text)]
        header.write_text(SIZED.sub(r"\1\n    int later_field, reserved_later;\3", text), encoding="utf-8")
    return names


def fields(folder):
    """The fields of each struct that begins with its size, without comments."""
    found = {}
    for header in sorted(folder.glob("*.h")):
        for match in SIZED.finditer(re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.S)):
            found[match.group(2)] = [" ".join(field.split()) for field in match.group(1).split("{", 1)[1].split(";") if field.strip()]
    return found


def check_frozen(root):
    now = fields(root / "include/brio")
    for name, first in fields(root / "tests/interface/brio_0_3").items():
        here = now.get(name, [])
        if here[:len(first)] != first:
            at = next((i for i, field in enumerate(first) if i >= len(here) or here[i] != field))
            sys.exit("%s: a program compiled with version 0.3 has '%s' where this header has '%s': append new fields, and change no other "
                     "(before 0.3 is released: freeze its headers anew)"
                     % (name, first[at], here[at] if at < len(here) else "no field"))


def build(root, cmake, compiler, folder):
    run(cmake, "-S", root, "-B", folder, "-DCMAKE_C_COMPILER=" + compiler, "-DCMAKE_BUILD_TYPE=Debug",
        "-DBUILD_SHARED_LIBS=ON", "-DBRIO_TESTS=OFF")
    run(cmake, "--build", folder, "--target", "brio", "-j", "2")
    return folder / "libbrio.so"


def exported(library):
    """The functions of brio that a static or a shared library shows to programs."""
    rows = [line.split() for line in run("readelf", "-sW", library).splitlines()]
    return sorted({row[7].split("@")[0] for row in rows
                   if len(row) > 7 and row[3:6] == ["FUNC", "GLOBAL", "DEFAULT"] and row[6] != "UND"})


def check_names(root, library, expected):
    declared = sorted(set(re.findall(r"BRIO_API\s+[\w\s*]*?\b(brio_\w+)\s*\(",
                                     "".join(path.read_text(encoding="utf-8") for path in headers(root)))))
    for title, names in (("exported by the library", exported(library)), ("declared by the headers", declared)):
        if names != expected:
            sys.exit("%s, not in exported.txt: %s\nin exported.txt, not %s: %s"
                     % (title, sorted(set(names) - set(expected)), title, sorted(set(expected) - set(names))))


def check_later_library(root, cmake, compiler, expected):
    """Returns the names of the structs that have one more field."""
    here = root / "tests/interface"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        later = folder / "later"
        shutil.copytree(root, later, ignore=shutil.ignore_patterns("build", "build-*", ".git", "out"))
        grown = grow(later)
        library = build(later, cmake, compiler, folder / "build")
        check_names(root, library, expected)
        shutil.copytree(here / "brio_0_3", folder / "frozen/brio")
        run(compiler, "-O1", "-o", folder / "consumer", here / "consumer.c", "-I", folder / "frozen", library, "-lm")
        output = run(folder / "consumer", env=dict(os.environ, LD_LIBRARY_PATH=str(library.parent)), cwd=folder)
    wanted = "dimension 3, 1500 vertices\ninterpolated 1\nclosed 1, genus 1, 1500 samples\noffset 0.1\nshape 1\ncocone 1\nlabeled 1500\nwhole\n"
    if output != wanted:
        sys.exit("the consumer printed\n%sexpected\n%s" % (output, wanted))
    return grown


def main():
    root, library = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    if not shutil.which("readelf"):
        print("skipped: interface.versions: there is no readelf")
        return 77
    expected = (root / "tests/interface/exported.txt").read_text(encoding="utf-8").split()
    check_names(root, library, expected)
    check_frozen(root)
    print("%d functions exported" % len(expected))
    if len(sys.argv) > 4:
        grown = check_later_library(root, sys.argv[3], sys.argv[4], expected)
        print("%d structs grown: %s" % (len(grown), " ".join(grown)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
