"""check_map.py ROOT: tests/README.md names every suite of the unit tests, every test of the command line, and every room of src.

The table of that page tells which test belongs to which source. A suite without a row is found by nobody who changes its source.
"""

import os
import re
import sys


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else "."
    with open(os.path.join(root, "tests", "README.md"), encoding="utf-8") as file:
        named = set(re.findall(r"`([^`]+)`", file.read()))
    suites = [name[:-2] for name in os.listdir(os.path.join(root, "tests", "unit")) if re.fullmatch(r"test_\w+\.c", name)]
    commands = ["cli/" + name for name in os.listdir(os.path.join(root, "tests", "cli")) if re.fullmatch(r"test_\w+\.py", name)]
    rooms = ["src/" + name for name in os.listdir(os.path.join(root, "src")) if os.path.isdir(os.path.join(root, "src", name))]
    rooms = [room for room in rooms if not any(name.startswith(room + "/") for name in named)]
    missing = sorted(set(suites + commands + rooms) - named)
    gone = sorted(name for name in named if re.fullmatch(r"test_\w+", name) and name not in suites)
    for name in missing:
        print("tests/README.md: no row names %s: put it where its source is" % name)
    for name in gone:
        print("tests/README.md: there is no suite %s: take it out" % name)
    print("%d suites, %d tests of the command line, %d rooms" % (len(suites), len(commands), len(rooms)))
    return 1 if missing or gone else 0


if __name__ == "__main__":
    sys.exit(main())
