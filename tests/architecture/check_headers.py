"""check_headers.py ROOT [CC]: the public headers, include/brio, as a reader and a program meet them.

1. No header has more than MOST_LINES lines: a topic that grows beyond them is two topics.
2. brio.h includes every one of them but BESIDE, so that one line suffices for a program.
3. With CC: each can be included alone.
"""

import pathlib
import re
import subprocess
import sys

MOST_LINES = 400
BESIDE = {"testdata.h", "laboratory.h"}  # of libraries that are not installed
INCLUDE = re.compile(r'^#include "(\w+\.h)"', re.M)


def complaints(folder, compiler):
    headers = {path.name: path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.h"))}
    for name, text in headers.items():
        lines = text.count("\n")
        if lines > MOST_LINES:
            yield "%s has %d lines, over %d: divide its topic" % (name, lines, MOST_LINES)
    for name in sorted(set(headers) - set(INCLUDE.findall(headers["brio.h"])) - {"brio.h", *BESIDE}):
        yield "brio.h does not include %s" % name
    for name in headers if compiler else ():
        done = subprocess.run([compiler, "-std=c11", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I", str(folder.parent),
                               "-x", "c", "-"], input="#include <brio/%s>\n" % name, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, encoding="utf-8")
        if done.returncode:
            yield "%s cannot be included alone:\n%s" % (name, done.stdout[:1000])


def main():
    folder = pathlib.Path(sys.argv[1]).resolve() / "include/brio"
    compiler = sys.argv[2] if len(sys.argv) > 2 else None
    wrong = list(complaints(folder, compiler))
    print("\n".join([*wrong, "%d headers, %d complaints" % (len(list(folder.glob("*.h"))), len(wrong))]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
