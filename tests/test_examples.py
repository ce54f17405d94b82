"""The examples in the docstrings run and show what they say."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import elbowscrew

MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(elbowscrew.__path__, "elbowscrew.")
    if not module.name.endswith("__main__")
)


@pytest.mark.parametrize("name", ["elbowscrew", *MODULES])
def test_examples(name: str) -> None:
    module = importlib.import_module(name)
    for public in getattr(module, "__all__", ()):  # some are there once they have been asked for
        getattr(module, public)
    result = doctest.testmod(module, extraglobs={"np": __import__("numpy")})
    assert result.failed == 0


def test_there_are_examples() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    found = [test for name in MODULES for test in finder.find(importlib.import_module(name)) if test.examples]
    assert len(found) >= 10
