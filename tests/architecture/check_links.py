"""check_links.py ROOT: every link of a page to a file of the project leads to one.

A page that moves, and a file that a page names, break links that nobody follows until a reader does. Pages are the files `*.md`
that the project keeps; a link is `[text](path)` with a relative path, and a heading behind `#` is not looked up.
"""

import os
import re
import subprocess
import sys

LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)]*)?\)")


def pages(root):
    """Names the pages, relative to the root."""
    names = subprocess.run(["git", "-C", root, "ls-files", "*.md"], capture_output=True, text=True)
    if names.returncode == 0:
        return names.stdout.split()
    return [os.path.relpath(os.path.join(folder, name), root)
            for folder, _, files in os.walk(root) for name in files if name.endswith(".md")]


def dead_links(root, page):
    """Yields line number and path of each link of a page that leads nowhere."""
    code = False
    with open(os.path.join(root, page), encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            if line.lstrip().startswith("```"):
                code = not code
            for path in [] if code else LINK.findall(line):
                if "://" in path or path.startswith("mailto:"):
                    continue
                if not os.path.exists(os.path.join(root, os.path.dirname(page), path)):
                    yield number, path


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else "."
    names = pages(root)
    dead = [(page, number, path) for page in names for number, path in dead_links(root, page)]
    for page, number, path in dead:
        print("%s:%d: %s is no file: write the path from the folder of the page" % (page, number, path))
    print("%d pages, %d dead links" % (len(names), len(dead)))
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main())
