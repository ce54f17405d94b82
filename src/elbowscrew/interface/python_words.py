"""Messages in Python's words: they are written with the command line's options, which a script does not have."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from dataclasses import fields
from typing import Final, ParamSpec, TypeVar

from elbowscrew.errors import ElbowscrewError

_OPTION: Final = re.compile(r"--([a-z][a-z-]*[a-z])(?:([ =])([\w.+-]+))?")
_NUMBER: Final = re.compile(r"[+-]?\d+(\.\d+)?")
_OTHERS: Final = {
    "force": "overwrite=True",
    "landmarks": "landmarks",
    "mesh": "meshes",
    "mesh-unit": "unit",
    "output": "folder",
    "recursive": "recursive=True",
}

Given = ParamSpec("Given")
Found = TypeVar("Found")


def in_python(message: str) -> str:
    """Put the keywords of the Python interface in place of a message's options.

    >>> in_python("there is a result already; give --force to replace it; --max-gap 0.2 fills more; leave --units out")
    'there is a result already; give overwrite=True to replace it; max_gap_s=0.2 fills more; leave units out'
    >>> in_python("--signed yes or no decides")
    'signed="yes" or no decides'
    """
    return _OPTION.sub(_keyword, message) if "--" in message else message


def _keyword(found: re.Match[str]) -> str:
    option, after, value = found[1], found[2] or "", found[3] or ""
    name, choices = _names().get(option, ("", ()))
    if option in _OTHERS:
        return _OTHERS[option] + after + value
    if not name:
        return found[0]
    is_list = found.string[found.end() :].startswith(",")
    if value in choices and not is_list:
        return f'{name}="{value}"'
    if _NUMBER.fullmatch(value):
        return f"{name}={value}"
    return name + after + value


@functools.cache
def _names() -> dict[str, tuple[str, tuple[str, ...]]]:
    """Keyword and choices by the names of options."""
    from elbowscrew.declaring import option_name
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
    from elbowscrew.settings import SETTINGS
    from elbowscrew.simulate import Simulation

    named: dict[str, tuple[str, tuple[str, ...]]] = {
        option_name(field.name): (field.name, ()) for kind in (ComparisonPlan, Simulation) for field in fields(kind)
    }
    return named | {one.option: (one.field, one.choices) for one in SETTINGS}


def public(function: Callable[Given, Found]) -> Callable[Given, Found]:
    """Give a function as it stands in `elbowscrew`: its errors speak of keywords, and it is pickled from there."""

    @functools.wraps(function)
    def spoken(*args: Given.args, **kwargs: Given.kwargs) -> Found:
        try:
            return function(*args, **kwargs)
        except ElbowscrewError as error:
            error.args = (in_python(str(error)), *error.args[1:])
            raise

    spoken.__module__ = "elbowscrew"
    return spoken
