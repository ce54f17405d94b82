"""What the command line calls figures and widths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from elbowscrew.errors import UsageError, asked_back
from elbowscrew.view.figure_names import ALL, FIGURE_CHOICES, OVERLAY, chosen_figures

WIDTHS_MM: Final = {
    "single": 85.0,
    "one-and-half": 120.0,
    "double": 170.0,
    "elsevier-single": 90.0,
    "elsevier-one-and-half": 140.0,
    "elsevier-double": 190.0,
    "springer-single": 84.0,
    "springer-double": 174.0,
    "ieee-single": 88.9,
    "ieee-double": 181.9,
    "plos-single": 132.0,
    "plos-double": 190.5,
}
"""Widths of figures by name; the first three fit the columns of all common journals."""

_LEAST_MM, _MOST_MM = 60.0, 400.0


def figure_names(given: Sequence[str]) -> tuple[str, ...]:
    """Split names of figures at their commas, each once.

    Raises
    ------
    UsageError
        If one is not known.
    """
    names = tuple(dict.fromkeys(name.strip() for text in given for name in text.split(",") if name.strip()))
    unknown = [name for name in names if name not in (*FIGURE_CHOICES, ALL)]
    if unknown or not names:
        mean = asked_back(",".join(unknown), (*FIGURE_CHOICES, ALL))
        found = f"{', '.join(unknown) or 'none'}{mean}"
        msg = f"--figures: expected {ALL} or some of {', '.join(FIGURE_CHOICES)}, found {found}"
        raise UsageError(msg)
    return (*chosen_figures(names), *([OVERLAY] if OVERLAY in names else []))


def width_mm(text: str) -> float:
    """Read a width on paper.

    Raises
    ------
    UsageError
        If it is neither a word nor a number of millimeters that a figure fits into.
    """
    try:
        width = WIDTHS_MM[text] if text in WIDTHS_MM else float(text.strip().removesuffix("mm"))
    except ValueError:
        width = float("nan")
    if not _LEAST_MM <= width <= _MOST_MM:
        named = ", ".join(WIDTHS_MM)
        msg = f"--width: expected {named} or millimeters from {_LEAST_MM:g} to {_MOST_MM:g}, found {text!r}"
        raise UsageError(msg + asked_back(text, WIDTHS_MM))
    return width
