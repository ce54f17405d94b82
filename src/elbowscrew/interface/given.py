"""What a public function was given that is not what it takes; looked for only after it has failed."""

from __future__ import annotations

import inspect
import numbers
import os
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import elbowscrew
from elbowscrew.errors import shown

_WORDS: Final = {"str": "path", "StrPath": "path", "os.PathLike[str]": "path", "Findings": "Analysis"}
_NUMBERS: Final[dict[object, type]] = {float: numbers.Real, int: numbers.Integral}
_SHORTENED: Final = ("collections.abc.", "typing.", "elbowscrew.model.")


def wrong_type(function: Callable[..., object], args: Sequence[object], kwargs: Mapping[str, object]) -> str | None:
    """Say which argument does not fit its annotation.

    Parameters
    ----------
    function : callable
    args : sequence
    kwargs : mapping of str to object
        What it was called with.

    Returns
    -------
    str or None
        A line; None if all fit as far as can be told, so that the fault is not the caller's.
    """
    signature = inspect.signature(function)
    try:
        given = signature.bind(*args, **kwargs).arguments
    except TypeError:  # told by Python itself
        return None
    for name, value in given.items():
        annotation = signature.parameters[name].annotation
        kind = _evaluated(annotation, function)
        if typing.get_origin(kind) is typing.Unpack:
            hints = typing.get_type_hints(typing.get_args(kind)[0])
            known = [(one, found, hints[one], _words(hints[one])) for one, found in value.items() if one in hints]
        else:
            known = [(name, value, kind, str(annotation))]
        for one, found, hint, words in known:
            if not _fits(found, hint):
                parts = dict.fromkeys(_in_words(part, words) for part in words.split(" | ") if part != "None")
                what = "None" if found is None else f"{type(found).__name__} {shown(found)}"
                return f"{function.__name__}: {one}: expected {' or '.join(parts)}, found {' '.join(what.split())}"
            if isinstance(found, str) and not _is_text(found):
                return f"{function.__name__}: {one}: expected text that can name a file, found {shown(found)}"
    return None


def _evaluated(annotation: object, function: Callable[..., object]) -> Any:
    """Evaluate an annotation where the function is defined; or as a name of ours; what neither knows fits all."""
    try:
        return eval(annotation, function.__globals__) if isinstance(annotation, str) else annotation  # noqa: S307 - ours
    except NameError:
        return getattr(elbowscrew, str(annotation), Any)


def _words(hint: Any) -> str:
    text = hint.__name__ if isinstance(hint, type) else str(hint)
    for start in _SHORTENED:
        text = text.replace(start, "")
    return text


def _in_words(part: str, whole: str) -> str:
    if part == "str" and "PathLike" not in whole:
        return part
    return _WORDS.get(part, part.replace("StrPath", "path"))


def _fits(value: object, kind: Any) -> bool:
    """Whether a value is of a type, but for what a list or a mapping holds."""
    origin = typing.get_origin(kind)
    if origin in (typing.Union, types.UnionType):
        return any(_fits(value, one) for one in typing.get_args(kind))
    if origin is typing.Literal:
        return isinstance(value, str)  # which of them, the function itself tells
    if kind is None or kind is Any:
        return kind is Any or value is None
    kind = _NUMBERS.get(kind, origin or kind)
    return isinstance(value, kind) if isinstance(kind, type) else True


def _is_text(text: str) -> bool:
    try:
        return b"\0" not in os.fsencode(text)
    except UnicodeEncodeError:
        return False
