"""run.py [--check]: runs the ten examples, each in a process of its own, and writes docs/python/images and
docs/python/gallery.md. --check writes the pictures to a temporary folder instead, and holds the page against the examples."""

import multiprocessing
import os
import pathlib
import runpy
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


def draw(example, picture):
    sys.argv = [str(example), str(picture)]
    runpy.run_path(str(example), run_name="__main__")


def main():
    os.environ["MPLBACKEND"] = "agg"
    import matplotlib.pyplot  # noqa: F401 once for all examples: their processes are forks of this one

    check = "--check" in sys.argv
    examples = sorted(HERE.glob("[0-9]*.py"))
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        target = pathlib.Path(folder) if check else PAGE.parent / "images"
        target.mkdir(exist_ok=True)
        for example in examples:
            picture = target / (example.stem + ".png")
            process = multiprocessing.get_context("fork").Process(target=draw, args=(example, picture))
            process.start()
            process.join()
            sound = process.exitcode == 0 and picture.exists() and picture.read_bytes()[:4] == b"\x89PNG"
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
