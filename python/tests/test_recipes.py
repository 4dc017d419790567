"""The recipes of docs/python/space-that-repeats.md run, each by itself, and print what stands there."""

import contextlib
import io
import pathlib
import re

import pytest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/python/space-that-repeats.md"
RECIPES = re.findall(r"^## ([^\n]*)\n(?:(?!^## ).)*?```python\n(.*?)```\n\n```text\n(.*?)```", PAGE.read_text("utf-8"), re.S | re.M)


def test_every_recipe_is_found():
    assert len(RECIPES) == PAGE.read_text("utf-8").count("\n## ")


@pytest.mark.parametrize("name, code, said", RECIPES, ids=[recipe[0] for recipe in RECIPES])
def test_recipe(name, code, said):
    for module in re.findall(r"^(?:import|from) (\w+)", code, re.M):
        pytest.importorskip(module)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, name, "exec"), {"__name__": "recipe"})
    assert printed.getvalue() == said
