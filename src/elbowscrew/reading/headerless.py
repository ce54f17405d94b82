"""What rows of numbers alone do not say, and where it comes from: unit, clock, and the names of bodies."""

from __future__ import annotations

from elbowscrew.errors import Missing, MissingStatementError
from elbowscrew.model import QualityWarning
from elbowscrew.reading.options import ASK_FOR_UNITS, ReadOptions
from elbowscrew.reading.source import TextSource


def unit_and_rate(source: TextSource, options: ReadOptions) -> tuple[str, float]:
    """Give the unit of length and the frames a second that the options state.

    Raises
    ------
    MissingStatementError
        If one is not stated; it asks for both at once.
    """
    if options.units is None or options.rate_hz is None:
        asked = [
            Missing("units", "states no unit of length", ASK_FOR_UNITS),
            Missing("rate_hz", "has no times", "--rate HZ"),
        ]
        raise MissingStatementError.of(source.path, *(one for one in asked if getattr(options, one.setting) is None))
    return options.units, options.rate_hz


def first_row(source: TextSource, group: int) -> list[str]:
    """Cells of the first line with any content, in groups of so many, beside which there may be one at the beginning.

    Blank groups at its end are bodies that are lost in this row, other blank cells there are none.
    """
    cells = source.cells(source.first_filled()[1])
    count = len(cells)
    while not cells[count - 1]:
        count -= 1
    return cells[: len(cells) - (len(cells) - count) % group]


def body_names(source: TextSource, count: int) -> list[str]:
    """Name one body as its file, as nothing else names it, and several by their places."""
    return [source.path.stem] if count == 1 else [f"body {k}" for k in range(1, count + 1)]


def one_body_warnings(source: TextSource, count: int, options: ReadOptions) -> tuple[QualityWarning, ...]:
    """Say that a body that is alone in the recording is no joint; nothing of several."""
    if count > 1 or not options.alone:
        return ()
    name = source.path.name
    message = (
        f"the file has the poses of one body only: its motion in the laboratory is told, not that of a joint; for a "
        f"joint give both files, the proximal body's first, as in 'analyze PROXIMAL{source.path.suffix} {name}'"
    )
    return (QualityWarning(code="one-body", message=message),)
