"""Pages that open from disk and ask the network for nothing: templates, what they embed, and how they are written."""

from __future__ import annotations

import base64
import functools
import hashlib
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from html import unescape
from pathlib import Path
from typing import Any, Final

import jinja2
from markupsafe import Markup, escape

from elbowscrew._version import __version__
from elbowscrew.errors import ResultError
from elbowscrew.quantities import rounded
from elbowscrew.report.typeset import typeset
from elbowscrew.results.trial_views import UNREADABLE

MARK: Final = 'name="generator" content="elbowscrew'
"""What a page of ours has at its beginning, so that it may be replaced."""

INDEX: Final = "index.html"
"""The page over a study."""
UNSHOWABLE: Final = (*UNREADABLE, jinja2.UndefinedError)
_HERE: Final = Path(__file__).parent
_NONE: Final = "–"
_DIGEST: Final = re.compile(r"\b[0-9a-f]{64}\b")
_OPTION: Final = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
_HEADING: Final = re.compile(r'<h2 id="([^"]+)"[^>]*>([^<]*)</h2>')


def render(
    template: str,
    *,
    styles: Sequence[str],
    scripts: Sequence[str],
    data: Any,
    content: Mapping[str, Any],
    names: Iterable[str | None] = (),
) -> str:
    """Fill a template.

    Parameters
    ----------
    template : str
        File in ``templates/``.
    styles, scripts : sequence of str
        Files in ``static/``, of styles each stronger than the one before.
    data : object
        What the script works on, as JSON.
    content : mapping
        What the template shows; all of it is escaped.
    names : iterable of str or None
        What users and files gave, which stands in sentences letter by letter.

    Returns
    -------
    str
        The page, whose policy allows its own style and script and nothing else, least of all the network.
    """
    css = "".join(_static(style) for style in styles)
    js = "".join(_static(script) for script in scripts)
    policy = (
        f"default-src 'none'; style-src '{_hash(css)}'; script-src '{_hash(js)}'; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
    page = _environment().get_template(template)
    made = page.render(
        content,
        version=__version__,
        policy=policy,
        style=Markup(css),  # noqa: S704 - a file of this package
        script=Markup(js),  # noqa: S704 - a file of this package
        data=json_for_script(data),
    )
    return typeset(made, [str(escape(name)) for name in names if name])


def json_for_script(data: Any) -> Markup:
    """Write JSON that can stand inside a script element: nothing in it ends the element or a line of it."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)  # noqa: S704 - escaped for this place


def unshowable(folder: Path, error: Exception) -> ResultError:
    """Say that a result is not as this version writes it."""
    what = " ".join(f"{type(error).__name__} {error}".split())
    return ResultError(f"{folder}: not a result of this version of the program: {what}; analyze the trial again")


@functools.cache
def _static(name: str) -> str:
    return (_HERE / "static" / name).read_text(encoding="utf-8")


@functools.cache
def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        auto_reload=False,
    )
    environment.filters.update(
        number=number,
        known=known,
        brief=brief,
        vector=vector,
        percent=percent,
        words=words,
        listed=listed,
        headings=headings,
        broken=broken,
    )
    return environment


def number(value: float | None, decimals: int = 2) -> str:
    """Write a number with a true minus sign; a dash where it is not known."""
    if value is None or not math.isfinite(value):
        return _NONE
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def known(value: float | None, decimals: int = 2) -> str:
    """Write a number, and nothing where it is not defined."""
    return "" if value is None or not math.isfinite(value) else number(value, decimals)


def brief(value: float | None, digits: int = 2) -> str:
    """Write a number to so many digits that count, a very small one with a power of ten."""
    if value is None or not math.isfinite(value):
        return _NONE
    if value == 0.0 or abs(value) < 1e-4:
        return rounded(value, digits).replace("-", "−")
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return number(round(value, decimals), max(decimals, 0))


def vector(values: Iterable[float | None] | None, decimals: int = 1) -> str:
    """Write a vector; a dash where it is not known."""
    values = [] if values is None else list(values)
    if all(value is None or not math.isfinite(value) for value in values):
        return _NONE
    return ", ".join(number(value, decimals) for value in values)


def percent(share: float | None, decimals: int = 1) -> str:
    """Write a share in percent."""
    return _NONE if share is None else f"{number(100.0 * share, decimals)} %"


def broken(text: str) -> Markup:
    """Escape a text, and let lines break within digests of files, words of 64 letters, and not within options."""
    marked = _DIGEST.sub(r'<span class="digest">\g<0></span>', str(escape(text)))
    return Markup(_OPTION.sub(r'<span class="option">\g<0></span>', marked))  # noqa: S704 - escaped here


def headings(html: str) -> list[tuple[str, str]]:
    """Id and text of each section's heading, for a list of contents."""
    return [(found[1], unescape(found[2])) for found in _HEADING.finditer(html)]


def listed(values: Sequence[Any], most: int = 24) -> str:
    """Write a list of numbers, a long one by its ends and how many they are."""
    if len(values) <= most:
        return words(values)
    return f"{words(values[:3])}, … {words(values[-1])}; {len(values)} in all"


def words(value: Any) -> str:
    """Write a setting as a person would."""
    if value is None:
        return _NONE
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return ", ".join(words(part) for part in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
