"""How a page is set: what belongs together on one line, and signs as they are printed."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable
from typing import Final

# What is not read as text: data, code, and what is marked as a name, which is shown as it was given.
_KEPT: Final = re.compile(
    r"<(script|style|pre|code|metadata)\b[^>]*>"
    r'|<(\w+)\b[^>]*\stranslate="no"[^>]*>'
    r"|<[^>]*>"
)
_INLINE: Final = re.compile(r"</?(?:small|span|strong)\b")
_UNIT: Final = r"(?:%|(?:deg|rad|mm|m)(?:/(?:s|rad))?|Hz|ms|s|min|°)(?![\w⁻])"
_BEFORE_UNIT: Final = re.compile(rf"(?<=[\d⁰¹²³⁴⁵⁶⁷⁸⁹]) (?={_UNIT})")
_UNIT_ALONE: Final = re.compile(rf" (?={_UNIT})")
_AFTER_SIGN: Final = re.compile(r"(?<=±) (?=\d)")
_MINUS: Final = re.compile(r"(?<![\w./–-])-(?=\d)")
_APOSTROPHE: Final = r"(?:'|&\#39;|&\#x27;)"
_QUOTED: Final = re.compile(rf"(?<!\w){_APOSTROPHE}(?=\S)(.+?)(?<=\S){_APOSTROPHE}(?!\w)", re.DOTALL)
_OF: Final = re.compile(rf"(?<=\w){_APOSTROPHE}")
_HELD: Final = "\N{NO-BREAK SPACE}"


def typeset(page: str, names: Iterable[str] = ()) -> str:
    """Set the text of a page: numbers stay with their units, minus signs, apostrophes and quotes are those of print.

    Parameters
    ----------
    page : str
        HTML. Tags, scripts, styles, code, data and elements marked with ``translate="no"`` stay as they are.
    names : iterable of str
        What stands in sentences just as a user or a file wrote it, escaped for HTML.

    Returns
    -------
    str
        The same page to a byte if it is set again.
    """
    head, body, text = page.partition("<body>")
    changed = sorted({name for name in names if name and _set(name) != name}, key=len, reverse=True)
    names_in = re.compile("(" + "|".join(map(re.escape, changed)) + ")") if changed else None
    parts: list[str] = []
    end, number = 0, False  # whether the text so far ends in a number that nothing but a change of size follows
    while (tag := _KEPT.search(text, end)) is not None:
        parts.append(_set_between(text[end : tag.start()], number, names_in))
        if end < tag.start():
            number = parts[-1][-1].isdigit()
        if not _INLINE.match(tag[0]):
            number = False
        end = _end_of(tag)
        parts.append(text[tag.start() : end])
    parts.append(_set_between(text[end:], number, names_in))
    return head + body + "".join(parts)


def _end_of(tag: re.Match[str]) -> int:
    """Where what stays as it is ends: at the end of the element, or of the tag where that is all."""
    element = tag[1] or tag[2]
    if element is None:
        return tag.end()
    close = f"</{element}>"
    found = tag.string.find(close, tag.end())
    return tag.end() if found < 0 else found + len(close)


def _set_between(text: str, number: bool, names: re.Pattern[str] | None) -> str:
    """Set the text between two tags, of which `names` stay as they are."""
    if not text:
        return text
    if number:
        held = _UNIT_ALONE.match(text)
        text = _HELD + text[1:] if held else text
    if names is None:
        return _set(text)
    return "".join(part if k % 2 else _set(part) for k, part in enumerate(names.split(text)))


@functools.lru_cache(maxsize=4096)
def _set(text: str) -> str:
    """Set a text; most of a page's stand on that of the next trial, too."""
    text = _BEFORE_UNIT.sub(_HELD, text)
    text = _AFTER_SIGN.sub(_HELD, text)
    text = _MINUS.sub("\N{MINUS SIGN}", text)
    text = _QUOTED.sub("\N{LEFT SINGLE QUOTATION MARK}\\1\N{RIGHT SINGLE QUOTATION MARK}", text)
    return _OF.sub("\N{RIGHT SINGLE QUOTATION MARK}", text)
