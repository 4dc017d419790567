"""check_versions.py ROOT CMAKE CC: what docs/versions.md promises.

1. The shared library exports the functions that exported.txt lists and nothing else, and the header declares the same.
2. A program compiled with the frozen header of this version (brio_0_2.h) runs with a library all of whose structs of
   options, statistics and results have one more field, at their end.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SIZED = re.compile(r"(typedef struct (brio_\w+) \{\n    size_t size;\n.*?)(\n\} \2;)", re.S)


def run(*command, **more):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          encoding="utf-8", **more)
    if done.returncode:
        sys.exit("%s:\n%s" % (" ".join(map(str, command)), done.stdout[-4000:]))
    return done.stdout


def grow(header):
    """One more field for each struct that begins with its size."""
    text = header.read_text(encoding="utf-8")
    names = [match.group(2) for match in SIZED.finditer(text)]
    header.write_text(SIZED.sub(r"\1\n    int later_field, reserved_later;\3", text), encoding="utf-8")
    return names


def build(root, cmake, compiler, folder):
    run(cmake, "-S", root, "-B", folder, "-DCMAKE_C_COMPILER=" + compiler, "-DCMAKE_BUILD_TYPE=Debug",
        "-DBUILD_SHARED_LIBS=ON", "-DBRIO_TESTS=OFF")
    run(cmake, "--build", folder, "--target", "brio", "-j", "2")
    return folder / "libbrio.so"


def exported(library):
    lines = run("nm", "-D", "--defined-only", library).splitlines()
    return sorted(line.split()[2].split("@")[0] for line in lines if line.split()[1] == "T")


def main():
    root, cmake, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
    here = root / "tests/interface"
    for program in "nm", "readelf":
        if not shutil.which(program):
            print("skipped: interface.versions: there is no %s" % program)
            return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        later = folder / "later"
        shutil.copytree(root, later, ignore=shutil.ignore_patterns("build", "build-*", ".git", "out"))
        grown = grow(later / "include/brio/brio.h")
        library = build(later, cmake, compiler, folder / "build")

        expected = (here / "exported.txt").read_text(encoding="utf-8").split()
        declared = sorted(set(re.findall(r"BRIO_API\s+[\w\s*]*?\b(brio_\w+)\s*\(",
                                         (root / "include/brio/brio.h").read_text(encoding="utf-8"))))
        found = exported(library)
        for title, names in (("exported by the library", found), ("declared by the header", declared)):
            if names != expected:
                sys.exit("%s, not in exported.txt: %s\nin exported.txt, not %s: %s"
                         % (title, sorted(set(names) - set(expected)), title, sorted(set(expected) - set(names))))
        soname = re.search(r"SONAME.*\[(.*)\]", run("readelf", "-d", library)).group(1)

        (folder / "frozen/brio").mkdir(parents=True)
        shutil.copy(here / "brio_0_2.h", folder / "frozen/brio/brio.h")
        run(compiler, "-O1", "-o", folder / "consumer", here / "consumer.c", "-I", folder / "frozen", library)
        output = run(folder / "consumer", env=dict(os.environ, LD_LIBRARY_PATH=str(library.parent)), cwd=folder)
    wanted = "dimension 3, 1500 vertices\ninterpolated 1\nclosed 1, genus 1, 1500 samples\noffset 0.1\nshape 1\ncocone 1\nlabeled 1500\nwhole\n"
    if output != wanted:
        sys.exit("the consumer printed\n%sexpected\n%s" % (output, wanted))
    print("%d functions exported by %s; %d structs grown: %s" % (len(found), soname, len(grown), " ".join(grown)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
