"""Markers in Qualisys's 3D export (tab-separated): keys and values, a line of columns or none, then a line a frame.

For each of ``MARKER_NAMES`` X, Y and Z in millimeters, behind frame numbers and times or without them: then rows are
frames, at the frequency. Blanks and zeros are markers that were not seen.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

from elbowscrew.errors import RecordingError
from elbowscrew.model import Recording
from elbowscrew.reading.cells import parse_number
from elbowscrew.reading.clock import cut_warnings, is_rate, numbered, rate_and_times, stated_rate
from elbowscrew.reading.options import ReadOptions, nothing_wanted
from elbowscrew.reading.source import TextSource
from elbowscrew.reading.table import MarkerCells, TableCells, read_table

HEADER_LINES: Final = 1024
"""More than there are: each event of the take has a line of its own."""
_UNIT: Final = "mm"


class MarkerHeader(NamedTuple):
    """What the file states, the names of its markers, lines above the numbers, and cells of a row."""

    stated: dict[str, str]
    names: list[str]
    lines: int
    width: int


def marker_header(source: TextSource) -> MarkerHeader | None:
    """Give the header of an export of markers; None of another one."""
    stated: dict[str, str] = {}
    names: list[str] = []
    for number, text in enumerate(source.head(HEADER_LINES)):
        cells = [cell.strip() for cell in text.split("\t")]
        while cells and not cells[-1]:
            cells.pop()
        key = cells[0].casefold() if cells else ""
        if key == "marker_names":
            names = cells[1:]
        elif names and (_is_number(source, key) or (not key and text.count("\t") + 1 >= 3 * len(names))):
            return MarkerHeader(stated, names, number, text.count("\t") + 1)
        elif _is_number(source, key):
            return None
        elif key and key not in stated:
            stated[key] = " ".join(cells[1:])
    return None


def _is_number(source: TextSource, text: str) -> bool:
    try:
        parse_number(text.replace(",", ".") if source.decimal_comma else text)
    except ValueError:
        return False
    return bool(text)


def read_markers(source: TextSource, header: MarkerHeader, options: ReadOptions) -> Recording:
    """Read an export of markers; see `elbowscrew.reading.registry.read_recording`."""
    wanted = [(k, name) for k, name in enumerate(header.names) if options.wants(name)]
    if not wanted:
        raise nothing_wanted(source.path, "no rigid bodies in the file", header.names, options)
    first = _first_column(source, header)
    stated_rate = header.stated.get("frequency", "")
    rate = stated_frequency(source, stated_rate) if first == 0 else None
    table = TableCells(
        layout="Qualisys markers",
        lines_above=header.lines,
        width=first + 3 * len(header.names),
        frame=None if first == 0 else 0,
        time=None if first == 0 else 1,
        rate_hz=rate,
        nan_word=True,
        bodies=(),
        markers=tuple(MarkerCells(name, tuple(range(k, k + 3)), _UNIT) for n, name in wanted for k in [first + 3 * n]),
        marker_names=tuple(header.names),
    )
    recording = read_table(source, table, *(() if first else numbered("the file")))
    frames = cut_warnings(
        replace(source, ends_with_newline=True), header.stated.get("no_of_frames", ""), len(recording.frame)
    )
    rate_hz, time_s, doubts = rate_and_times(source.path, stated_rate, recording.frame, recording.time_s)
    return replace(recording, rate_hz=rate_hz, time_s=time_s, warnings=(*recording.warnings, *frames, *doubts))


def _first_column(source: TextSource, header: MarkerHeader) -> int:
    """Column of the first marker's X: 2 behind frame numbers and times, or 0."""
    own = 3 * len(header.names)
    doubled = sorted({name for name in header.names if header.names.count(name) > 1})
    # A tab at the end of a row is no cell.
    found = [first for first in (2, 0) for end in (0, 1) if header.width == first + own + end]
    if doubled or not found:
        what = f"{', '.join(doubled)} twice" if doubled else f"{header.width} cells a row"
        msg = (
            f"{source.path}:{header.lines + 1}: expected X, Y, Z of {len(header.names)} markers of different names, "
            f"behind frame and time or alone, found {what}; export the take again"
        )
        raise RecordingError(msg)
    return found[0]


def stated_frequency(source: TextSource, text: str) -> float:
    """Frames a second, which must be stated where there are no times.

    Raises
    ------
    RecordingError
        If it is no possible rate.
    """
    rate = stated_rate(text)
    if not is_rate(rate):
        msg = f"{source.path}: no times and no FREQUENCY; export the take again with the time of every frame"
        raise RecordingError(msg)
    return rate
