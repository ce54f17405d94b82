"""Options that several commands share, and values the shell gives as text."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, Literal

from elbowscrew.errors import UsageError

if TYPE_CHECKING:
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

Units = Literal["m", "cm", "mm"]
Rotation = Literal["quaternion", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]
ClosedLaw = Literal[
    "cycloidal", "linear", "harmonic", "polynomial-345", "polynomial-4567", "modified-trapezoid", "modified-sine"
]


class FigureFormat(StrEnum):
    """Formats of figures; an enumeration because typer takes no list of literals."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"
    NONE = "none"


class ExportFormat(StrEnum):
    """Formats of other programs."""

    PARQUET = "parquet"
    MAT = "mat"
    STO = "sto"


def frame_numbers(text: str | None) -> tuple[int, ...] | None:
    """Split ``0,211,449`` into frame numbers.

    Raises
    ------
    UsageError
        If there is anything else between the commas.
    """
    if text is None:
        return None
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError as error:
        msg = f"--keyframes {text!r}: expected frame numbers with commas between them, as in 0,211,449"
        raise UsageError(msg) from error


def names(given: list[str] | None) -> tuple[str, ...] | None:
    """Split names at their commas; an option may be given more than once."""
    if not given:
        return None
    found = tuple(name.strip() for text in given for name in text.split(",") if name.strip())
    if not found:
        msg = "the option of markers is empty: expected names or patterns with commas between them, as in 'UA1,UA2,UA3'"
        raise UsageError(msg)
    return found


def comparison_plan(words: Mapping[str, str | None], numbers: Mapping[str, str | None]) -> ComparisonPlan:
    """Make the plan of a comparison of lists with commas; what is not given stays as it is.

    Raises
    ------
    UsageError
        If a list has something that is no number, or no choice.
    """
    from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan

    given: dict[str, tuple[str, ...] | tuple[int, ...]] = {}
    for name, text in words.items():
        if text is not None:
            given[name] = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    for name, text in numbers.items():
        if text is not None:
            try:
                given[name] = tuple(dict.fromkeys(int(part) for part in text.split(",")))
            except ValueError as error:
                msg = f"--{name} {text!r}: expected whole numbers with commas between them, as in 2,3,4"
                raise UsageError(msg) from error
    return ComparisonPlan(**given)  # type: ignore[arg-type]
