"""Options that several commands share, and lists that the shell gives as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from elbowscrew.errors import UsageError

if TYPE_CHECKING:
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

LandmarksFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE.toml", rich_help_panel="Bodies and file", help="Landmarks, for the anatomical angles."),
]


TrialFile = Annotated[
    Path,
    typer.Argument(
        metavar="TRIAL",
        help="A recording: Motive, plain table, TRC, C3D, Qualisys 6D or 4 x 4.",
        show_default=False,
    ),
]

DistalFile = Annotated[
    Path | None,
    typer.Argument(
        metavar="[DISTAL]",
        help="The distal body's file, where TRIAL holds the proximal body alone.",
        show_default=False,
    ),
]


def parts(option: str, given: Sequence[str] | None, *, once: bool = True) -> tuple[str, ...] | None:
    """Split a list at its commas; an option may be given more than once, and all it is given counts.

    Parts that are repeated are left out, unless each counts, as of numbers.

    Raises
    ------
    UsageError
        If nothing is left.
    """
    if not given:
        return None
    found = tuple(part.strip() for text in given for part in text.split(",") if part.strip())
    found = tuple(dict.fromkeys(found)) if once else found
    if not found:
        msg = f"--{option}: expected one or more with commas between them, found {','.join(given)!r}"
        raise UsageError(msg)
    return found


def whole_numbers(option: str, given: Sequence[str] | None) -> tuple[int, ...] | None:
    """Read whole numbers, as frames are.

    Raises
    ------
    UsageError
        If one is none.
    """
    if given is None:
        return None
    try:
        return tuple(int(part) for part in given)
    except ValueError as error:
        what = "frame numbers" if option == "keyframes" else "whole numbers"
        msg = f"--{option} {','.join(given)!r}: expected {what} with commas between them, as in 2,3,4"
        raise UsageError(msg) from error


def comparison_plan(
    words: Mapping[str, Sequence[str] | None], numbers: Mapping[str, Sequence[str] | None]
) -> ComparisonPlan:
    """Make the plan of a comparison of lists; what is not given stays as it is.

    Raises
    ------
    UsageError
        If a list has something that is no number, or no choice.
    """
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

    given: dict[str, tuple[str, ...] | tuple[int, ...] | None] = {
        **{name: parts(name, one) for name, one in words.items()},
        **{name: whole_numbers(name, parts(name, one)) for name, one in numbers.items()},
    }
    return ComparisonPlan(**{name: one for name, one in given.items() if one is not None})  # type: ignore[arg-type]
