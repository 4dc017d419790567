"""The recipes of pages in docs/python run, each by itself, and print what stands there."""

import contextlib
import io
import pathlib
import re

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/python"
PAGES = "\n".join((FOLDER / name).read_text("utf-8") for name in ("space-that-repeats.md", "more-than-memory.md"))
RECIPES = re.findall(r"^## ([^\n]*)\n(?:(?!^## ).)*?```python\n(.*?)```\n\n```text\n(.*?)```", PAGES, re.S | re.M)


def test_every_recipe_is_found():
    assert len(RECIPES) == PAGES.count("\n## ")


@pytest.mark.parametrize("name, code, said", RECIPES, ids=[recipe[0] for recipe in RECIPES])
def test_recipe(name, code, said):
    for module in re.findall(r"^(?:import|from) (\w+)", code, re.M):
        pytest.importorskip(module)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, name, "exec"), {"__name__": "recipe"})
    assert printed.getvalue() == said
