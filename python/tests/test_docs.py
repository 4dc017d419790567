"""The examples of the docstrings run; everything public has a docstring with an example or a list of attributes."""

import doctest
import importlib
import inspect
import pkgutil

import pytest

import brio

MODULES = [m.name for m in pkgutil.iter_modules(brio.__path__) if m.name != "_native"]


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_docstrings(name):
    assert doctest.testmod(importlib.import_module("brio." + name)).failed == 0


def test_everything_public_is_documented():
    for name in brio.__all__:
        thing = getattr(brio, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
            for method, value in vars(thing).items() if inspect.isclass(thing) else ():
                if inspect.isfunction(value) and not method.startswith("_"):
                    assert value.__doc__, "%s.%s" % (name, method)


def test_version_is_that_of_the_library():
    assert brio.__version__ == brio._native.version
