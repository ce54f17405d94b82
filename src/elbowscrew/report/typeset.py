"""How a page is set: what belongs together on one line, and signs as they are printed."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

# What is not read as text: data, code, and what is marked as a name, which is shown as it was given.
_KEPT: Final = re.compile(
    r"<(?P<whole>script|style|pre|code|metadata)\b[^>]*>.*?</(?P=whole)>"
    r'|<(?P<named>\w+)\b[^>]*\stranslate="no"[^>]*>.*?</(?P=named)>'
    r"|<[^>]*>",
    re.DOTALL,
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
    for tag in _KEPT.finditer(text):
        parts.append(_set_between(text[end : tag.start()], number, names_in))
        if end < tag.start():
            number = parts[-1][-1].isdigit()
        if not _INLINE.match(tag[0]):
            number = False
        parts.append(tag[0])
        end = tag.end()
    parts.append(_set_between(text[end:], number, names_in))
    return head + body + "".join(parts)


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


def _set(text: str) -> str:
    text = _BEFORE_UNIT.sub(_HELD, text)
    text = _AFTER_SIGN.sub(_HELD, text)
    text = _MINUS.sub("\N{MINUS SIGN}", text)
    text = _QUOTED.sub("\N{LEFT SINGLE QUOTATION MARK}\\1\N{RIGHT SINGLE QUOTATION MARK}", text)
    return _OF.sub("\N{RIGHT SINGLE QUOTATION MARK}", text)
