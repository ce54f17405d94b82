"""Every public function and class says what goes in, what comes out, where it is from, and shows it."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re
import sys
from types import FunctionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest
from numpydoc.validate import validate  # type: ignore[import-untyped]
from pydantic import BaseModel

import elbowscrew
from elbowscrew import geometry

# No docstring, no summary, a summary without a period; parameters missing, unknown, in another order, without a space
# before the colon; no section of returns, of examples, of yields.
FAULTS = {"GL08", "SS01", "SS03", "PR01", "PR02", "PR03", "PR10", "RT01", "EX01", "YD01"}

MODULES = [
    importlib.import_module(f"{geometry.__name__}.{module.name}")
    for module in pkgutil.iter_modules(geometry.__path__)
    if not module.name.startswith("_")
]
GEOMETRY = [
    value
    for module in MODULES
    for name, value in vars(module).items()
    if not name.startswith("_") and (inspect.isfunction(value) or inspect.isclass(value))
    if value.__module__ == module.__name__
]
SURFACE = [getattr(elbowscrew, name) for name in elbowscrew.__all__]


def full_name(thing: Any) -> str:
    return f"{thing.__module__}.{thing.__qualname__}"


def functions(things: list[Any]) -> list[FunctionType]:
    return sorted(filter(inspect.isfunction, things), key=full_name)


def classes(things: list[Any]) -> list[type]:
    return sorted(filter(inspect.isclass, things), key=full_name)


def section(thing: Any, title: str) -> str:
    """Text under a title, up to the next one or the end; empty if there is none."""
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^\w+\n-+\n|\Z)", inspect.getdoc(thing) or "", re.M | re.S)
    return found[1].strip() if found else ""


def fields(kind: type) -> set[str]:
    if issubclass(kind, BaseModel):
        return set(kind.model_fields)
    if dataclasses.is_dataclass(kind):
        return {field.name for field in dataclasses.fields(kind)}
    if issubclass(kind, Exception):
        return {"exit_code"}
    if getattr(kind, "_is_protocol", False):
        return {name for name, value in vars(kind).items() if isinstance(value, property)}
    return set(kind._fields)  # type: ignore[attr-defined]


@pytest.mark.parametrize("function", functions(GEOMETRY + SURFACE), ids=full_name)
def test_functions_are_documented(function: FunctionType) -> None:
    faults = [fault for fault in validate(full_name(function))["errors"] if fault[0] in FAULTS]
    assert not faults


@pytest.mark.parametrize("function", functions(GEOMETRY), ids=full_name)
def test_geometry_tells_shapes_and_sources(function: FunctionType) -> None:
    assert section(function, "References")
    assert "shape" in section(function, "Parameters")


@pytest.mark.parametrize("kind", classes(GEOMETRY + SURFACE), ids=full_name)
def test_classes_name_their_attributes(kind: type) -> None:
    names = re.findall(r"^(\w.*?) : ", section(kind, "Attributes"), re.M)
    assert fields(kind) == {name for line in names for name in line.split(", ")}


def test_there_is_something_to_look_at() -> None:
    assert len(functions(GEOMETRY)) > 80
    assert {full_name(kind) for kind in classes(GEOMETRY)} >= {"elbowscrew.geometry.screw.Screw"}
    assert len(functions(SURFACE)) >= 6


CHOICES = re.compile(r"^(\w+(?:, \w+)*) : .*?\{(\"[^}]*)\}", re.M)


def choices_in(annotation: Any) -> set[str]:
    """Strings that a type allows, those of the parts of a tuple or a union among them."""
    if get_origin(annotation) is Literal:
        return {one for one in get_args(annotation) if isinstance(one, str)}
    return set().union(*map(choices_in, get_args(annotation)))


def documented(thing: Any) -> list[Any]:
    methods = filter(inspect.isfunction, vars(thing).values()) if inspect.isclass(thing) else ()
    return [thing, *methods]


def type_of(thing: Any, name: str) -> Any:
    """What a parameter or a field may be; None where its type is there for type checkers alone."""
    try:
        alone = type("", (), {"__annotations__": {name: thing.__annotations__.get(name)}})
        return get_type_hints(alone, vars(sys.modules[thing.__module__]))[name]
    except NameError:
        return None


def all_documented() -> list[Any]:
    """Every function, class and method of the package with choices in its docstring."""
    found = []
    for module in pkgutil.walk_packages(elbowscrew.__path__, "elbowscrew."):
        if module.name in ("elbowscrew.__main__", "elbowscrew.reading.c3d_worker"):
            continue
        for value in vars(importlib.import_module(module.name)).values():
            if getattr(value, "__module__", "") == module.name and callable(value):
                found += [one for one in documented(value) if CHOICES.search(inspect.getdoc(one) or "")]
    return found


@pytest.mark.parametrize("thing", all_documented(), ids=full_name)
def test_choices_in_docstrings_are_those_of_the_types(thing: Any) -> None:
    for names, told in CHOICES.findall(inspect.getdoc(thing) or ""):
        words = set(re.findall(r'"([^"]+)"', told))
        for name in names.split(", "):
            allowed = choices_in(type_of(thing, name))
            if allowed:
                assert words <= allowed, name
                assert words == allowed or "..." in told, name
