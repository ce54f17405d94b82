"""What is wrong with settings, in one line: in the options' names, or in the keywords of Python."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from pydantic import ValidationError

from elbowscrew.declaring import option_name
from elbowscrew.errors import asked_back, shown

_QUOTED: Final = re.compile(r"'([^']+)'")
_OPTION: Final = re.compile(r"--([a-z][a-z-]*[a-z])(?:([ =])([\w.+-]+))?")
_NUMBER: Final = re.compile(r"[+-]?\d+(\.\d+)?")

Keywords = Mapping[str, tuple[str, tuple[str, ...]]]
"""Keyword and choices by the names of options."""


def told_faults(
    error: ValidationError, location: str, known: Sequence[str], named: Callable[[str], str] = option_name
) -> str:
    """Tell all faults in one line.

    Parameters
    ----------
    error : pydantic.ValidationError
    location : str
        Where the values stand; the line begins with it.
    known : sequence of str
        All names there are.
    named : callable
        Told the name of a field, gives that by which it is told.
    """
    faults: list[Any] = error.errors()
    parts = {fault["loc"][0] for fault in faults if len(fault["loc"]) > 1}
    # A list that is empty only because none of its values was taken is no fault of its own.
    own = [one for one in faults if one["type"] != "too_short" or one["loc"][0] not in parts]
    return "; ".join(_sentence(location, fault, known, named) for fault in own)


def _sentence(location: str, fault: Any, known: Sequence[str], named: Callable[[str], str]) -> str:
    key = named(str(fault["loc"][0])) if fault["loc"] else ""
    if fault["type"] == "extra_forbidden":
        close = difflib.get_close_matches(key, known, n=1)
        hint = f"did you mean {close[0]!r}?" if close else f"possible keys: {', '.join(known)}"
        return f"{location}: unknown key {shown(key)}; {hint}"
    message = str(fault["msg"]).removeprefix("Value error, ").replace("Input should", "should")
    if not key or fault["type"] == "value_error":  # our own checks say themselves what they found
        return f"{location}: {key}: {message}" if key else f"{location}: {message}"
    mean = asked_back(fault["input"], _QUOTED.findall(str(fault.get("ctx", {}).get("expected", ""))))
    return f"{location}: {key}: {message}, found {shown(fault['input'])}{mean}"


def in_keywords(message: str, keywords: Keywords, others: Mapping[str, str] | None = None) -> str:
    """Put keywords in place of a message's options.

    Parameters
    ----------
    message : str
    keywords : mapping
        Keyword and choices by the names of options.
    others : mapping of str to str, optional
        What stands for options that are no such keyword.
    """

    def keyword(found: re.Match[str]) -> str:
        option, after, value = found[1], found[2] or "", found[3] or ""
        if others and option in others:
            return others[option] + after + value
        name, choices = keywords.get(option, ("", ()))
        if not name:
            return found[0]
        is_list = found.string[found.end() :].startswith(",")
        if value in choices and not is_list:
            return f'{name}="{value}"'
        if _NUMBER.fullmatch(value):
            return f"{name}={value}"
        return name + after + value

    return _OPTION.sub(keyword, message) if "--" in message else message
