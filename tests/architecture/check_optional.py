"""check_optional.py ROOT CC: every source that asks whether an optional library is there also compiles without warnings where
none is. Parts that only such a library's code calls stand behind the question, too."""

import pathlib
import subprocess
import sys

FOLDERS = ("src", "cli")


def main():
    root, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    sources = [path for folder in FOLDERS for path in sorted((root / folder).rglob("*.c"))
               if "BRIO_HAS_" in path.read_text(encoding="utf-8")]
    wrong = []
    for path in sources:
        done = subprocess.run([compiler, "-std=c11", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", "-I", str(root / "include"),
                               "-I", str(root / "src"), "-c", str(path), "-o", "/dev/null"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")
        if done.returncode:
            wrong.append("%s does not compile without the optional libraries:\n%s" % (path.relative_to(root), done.stdout[:1000]))
    print("\n".join([*wrong, "%d sources, %d complaints" % (len(sources), len(wrong))]))
    return 1 if wrong or not sources else 0


if __name__ == "__main__":
    sys.exit(main())
