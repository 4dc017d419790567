"""run_page.py FOLDER PAGE...: runs the commands of pages, as a reader types them: in one folder, one after the other.

A block of ```sh is run by bash, which ends at the first command that fails; a block with a title, as ```c title="first.c", is written
to a file of that name. brio, and what the commands need besides, are to be on the path."""

import pathlib
import re
import subprocess
import sys

BLOCK = re.compile(r'(?ms)^```(\w+)(?: title="([\w.]+)")?\n(.*?)^```$')


def run(page, folder):
    """Returns the number of blocks that were run."""
    count = 0
    for language, title, text in BLOCK.findall(pathlib.Path(page).read_text(encoding="utf-8")):
        if title:
            (pathlib.Path(folder) / title).write_text(text, encoding="utf-8")
        elif language == "sh":
            done = subprocess.run(["bash", "-euc", "set -o pipefail\n" + text], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            if done.returncode:
                raise SystemExit("%s: status %d of\n%s\n%s" % (page, done.returncode, text, done.stdout))
            count += 1
    return count


if __name__ == "__main__":
    for page in sys.argv[2:]:
        print("%s: %d blocks" % (page, run(page, sys.argv[1])))
