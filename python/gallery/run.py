"""run.py [--check]: runs the ten examples, each in a process of its own, and writes docs/python/images and
docs/python/gallery.md. --check writes the pictures to a temporary folder instead, and holds the page against the examples."""

import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs/python/gallery.md"


def page(examples):
    lines = ["# Gallery", "", "Ten examples of the Python package; `python/gallery/run.py` runs them and writes this page.", ""]
    for example in examples:
        text = example.read_text(encoding="utf-8")
        title = text.split('"""')[1].strip().partition("\n")[0]
        body = text.split('"""', 2)[2].strip()
        lines += ["## " + title, "", "![%s](images/%s.png)" % (title, example.stem), "", "```python", body, "```", ""]
    return "\n".join(lines)


def main():
    check = "--check" in sys.argv
    examples = sorted(HERE.glob("[0-9]*.py"))
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        target = pathlib.Path(folder) if check else PAGE.parent / "images"
        target.mkdir(exist_ok=True)
        for example in examples:
            picture = target / (example.stem + ".png")
            done = subprocess.run([sys.executable, str(example), str(picture)], env={**os.environ, "MPLBACKEND": "agg"})
            sound = done.returncode == 0 and picture.exists() and picture.read_bytes()[:4] == b"\x89PNG"
            print("%s %s" % (example.name, "" if sound else "FAILS"))
            wrong += not sound
    if not check:
        PAGE.write_text(page(examples), encoding="utf-8")
    elif PAGE.read_text(encoding="utf-8") != page(examples):
        print("docs/python/gallery.md is not what the examples say: run python/gallery/run.py")
        wrong += 1
    return 1 if wrong or len(examples) != 10 else 0


if __name__ == "__main__":
    sys.exit(main())
