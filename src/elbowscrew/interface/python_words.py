"""Messages in Python's words: they are written with the command line's options, which a script does not have."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import fields
from typing import Final, ParamSpec, TypeVar

from elbowscrew.errors import ElbowscrewError, UsageError
from elbowscrew.setting_faults import Keywords, in_keywords

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
    return in_keywords(message, _names(), _OTHERS) if "--" in message else message


@functools.cache
def _names() -> Keywords:
    from elbowscrew.declaring import option_name
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
    from elbowscrew.settings import SETTING_KEYWORDS
    from elbowscrew.simulate import Simulation

    named: dict[str, tuple[str, tuple[str, ...]]] = {
        option_name(field.name): (field.name, ()) for kind in (ComparisonPlan, Simulation) for field in fields(kind)
    }
    return named | SETTING_KEYWORDS


def public(function: Callable[Given, Found]) -> Callable[Given, Found]:
    """Give a function as it stands in `elbowscrew`: its errors speak of keywords, and it is pickled from there."""

    @functools.wraps(function)
    def spoken(*args: Given.args, **kwargs: Given.kwargs) -> Found:
        try:
            return function(*args, **kwargs)
        except ElbowscrewError as error:
            error.args = (in_python(str(error)), *error.args[1:])
            raise
        except (TypeError, AttributeError, ValueError) as error:
            from elbowscrew.interface.given import wrong_type

            fault = wrong_type(function, args, kwargs)
            if fault is None:
                raise
            raise UsageError(fault) from error

    spoken.__module__ = "elbowscrew"
    return spoken
