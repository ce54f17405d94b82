"""What the command line calls figures and widths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from elbowscrew.errors import UsageError
from elbowscrew.view.figure_names import FIGURE_CHOICES

SINGLE_MM: Final = 85.0
DOUBLE_MM: Final = 170.0
"""Widths that fit one and two columns of all common journals, whose columns are 84 to 90 and 170 to 190 mm."""

_WIDTHS: Final = {"single": SINGLE_MM, "double": DOUBLE_MM}
_LEAST_MM, _MOST_MM = 60.0, 400.0


def figure_names(given: Sequence[str]) -> tuple[str, ...]:
    """Split names of figures at their commas, each once.

    Raises
    ------
    UsageError
        If one is not known.
    """
    names = tuple(dict.fromkeys(name.strip() for text in given for name in text.split(",") if name.strip()))
    unknown = [name for name in names if name not in FIGURE_CHOICES]
    if unknown or not names:
        msg = f"--figures: expected some of {', '.join(FIGURE_CHOICES)}, found {', '.join(unknown) or 'none'}"
        raise UsageError(msg)
    return names


def width_mm(text: str) -> float:
    """Read a width on paper.

    Raises
    ------
    UsageError
        If it is neither a word nor a number of millimeters that a figure fits into.
    """
    try:
        width = _WIDTHS[text] if text in _WIDTHS else float(text.strip().removesuffix("mm"))
    except ValueError:
        width = float("nan")
    if not _LEAST_MM <= width <= _MOST_MM:
        msg = f"--width: expected single, double or millimeters from {_LEAST_MM:g} to {_MOST_MM:g}, found {text!r}"
        raise UsageError(msg)
    return width
