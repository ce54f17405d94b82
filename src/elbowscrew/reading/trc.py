"""Marker trajectories in TRC files: some header lines, names over axes, then a line a frame.

Programs write the header with doubled tabs, blanks or commas, names of markers that have no columns, and unnamed
markers behind the named ones in some lines; what cannot be told apart is refused.
"""

from __future__ import annotations

import csv
from collections import Counter
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.model import QualityWarning, Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, MarkerBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, cut_warnings, rate_and_times
from elbowscrew.reading.options import ReadOptions, nothing_wanted, stated_unit
from elbowscrew.reading.source import TextSource

_HEADER_LINES: Final = 16
_NAMES_TOLD: Final = 5


class _Header(NamedTuple):
    """What is stated, the first column of each marker by its name, names without columns, cells and lines.

    `in_order` says that the names do not stand over their columns and were taken one after the other.
    """

    stated: dict[str, str]
    columns: dict[str, int]
    nowhere: list[str]
    in_order: bool
    width: int
    lines: int


def recognizes(cells: list[str]) -> bool:
    """Tell by the first word."""
    return cells[0].startswith("pathfiletype")


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a TRC file; see `elbowscrew.reading.registry.read_recording`."""
    header = _header(source)
    unit = stated_unit(source.path, header.stated.get("units", ""), options)
    wanted = {name: k for name, k in header.columns.items() if options.wants(name)}
    if not wanted:
        raise nothing_wanted(source.path, "no rigid bodies in the file", list(header.columns), options)
    columns = [0, 1, *(k + axis for k in wanted.values() for axis in range(3))]
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    markers = [MarkerBuilder(name) for name in wanted]
    line = header.lines
    for block in read_blocks(source, line, columns, header.width, group=3, nan_word=True):
        check_frames(source, line, block)
        frames.append(block[:, 0].astype(np.int64))
        times.append(block[:, 1])
        for k, marker in enumerate(markers):
            marker.append(METERS[unit] * block[:, 2 + 3 * k : 5 + 3 * k])
        line += len(block)
    frame, time_s = frames.finish(), times.finish()
    if not frame.size:
        msg = f"{source.path}:{header.lines + 1}: no frame follows the header"
        raise RecordingError(msg)
    cut = cut_warnings(source, header.stated.get("numframes", ""), frame.size)
    rate, time_s, warnings = rate_and_times(source.path, header.stated.get("datarate", ""), frame, time_s)
    if header.nowhere:
        told = ", ".join(header.nowhere[:_NAMES_TOLD])
        message = f"{len(header.nowhere)} markers are named in the header and have no columns ({told}): left out"
        warnings.append(QualityWarning(code="markers-without-columns", message=message, severity="note"))
    if header.in_order:
        message = "the markers' names do not stand over their columns: taken in order, as there are as many"
        warnings.append(QualityWarning(code="markers-in-order", message=message, severity="note"))
    return Recording(
        bodies=(),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        markers=tuple(marker.finish() for marker in markers),
        source=Source(
            path=str(source.path), sha256=source.sha256, layout="TRC", length_unit=unit, markers=tuple(header.columns)
        ),
        warnings=(*warnings, *cut, *(warning for marker in markers for warning in marker.warnings())),
    )


def _header(source: TextSource) -> _Header:
    """Find the line of names by its first cell; the axes follow it, what the file states of itself stands above it."""
    rows = []
    for number, line in enumerate(source.head(_HEADER_LINES), start=1):
        try:
            rows.append(source.cells(line))
        except csv.Error as error:
            msg = f"{source.path}:{number}: not a line of a TRC file: {error}; export the take again"
            raise RecordingError(msg) from error
    at = next((k for k, row in enumerate(rows) if row and row[0].casefold().rstrip("#") == "frame"), None)
    if at is None or at + 1 >= len(rows):
        msg = (
            f"{source.path}:{min(len(rows), 4)}: the header is cut: expected a line that begins with 'Frame#' and one "
            "of axes below it; export the take again"
        )
        raise RecordingError(msg)
    keys = next((k for k, row in enumerate(rows[: at - 1]) if " ".join(row).casefold().startswith("datarate")), None)
    stated = {} if keys is None else _pairs(rows[keys], rows[keys + 1])
    names, axes = rows[at], rows[at + 1]
    columns, nowhere, in_order, width = _marker_columns(source, at + 1, names, axes)
    blank = next((k for k, row in enumerate(rows[at + 2 :]) if any(row)), 0)
    return _Header(stated, columns, nowhere, in_order, width, at + 2 + blank)


def _pairs(keys: list[str], values: list[str]) -> dict[str, str]:
    """Keys and values one below the other; without the blank cells where these are not, and at blanks if need be."""
    while values and not values[-1] and len(values) > len(keys):
        values = values[:-1]
    if not all(keys) or len(values) != len(keys):
        keys, values = [cell for cell in keys if cell], [cell for cell in values if cell]
    if len(keys) != len(values) or any(" " in key for key in keys):
        keys, values = " ".join(keys).split(), " ".join(values).split()
    return {key.casefold(): value for key, value in zip(keys, values, strict=False)} if len(keys) == len(values) else {}


def _marker_columns(
    source: TextSource, line: int, names: list[str], axes: list[str]
) -> tuple[dict[str, int], list[str], bool, int]:
    """First column of each marker, the names that have none, whether they are taken in order, and the cells of a line.

    A name stands over its X; where one does not, all are taken in order if there are as many as columns for them. Of
    markers of one name each has its number behind it.
    """
    found = [(name, k) for k, name in enumerate(names) if k >= 2 and name]
    labels = [cell for cell in axes if cell]
    if any(cell and cell[0].upper() != "XYZ"[(k - 2) % 3] for k, cell in enumerate(axes)):
        axes = ["", "", *labels]
    begins = [k for k in range(2, len(axes), 3) if any(axes[k : k + 3])]
    whole = [cell[0].upper() for cell in labels] == [*"XYZ"] * len(begins)
    in_order = not all(k % 3 == 2 for _, k in found) and len(found) == len(begins)
    if in_order:
        found = [(name, k) for (name, _), k in zip(found, begins, strict=True)]
    wrong = next((one for one in found if one[1] % 3 != 2), None)
    if not whole or wrong is not None:
        name, k = wrong or (found[0] if found else ("", 2))
        told = ", ".join(axes[k : k + 3]) or "nothing"
        msg = (
            f"{source.path}:{line + 1}: marker {name!r}: expected its X, Y, Z below its name, or as many names as X, "
            f"Y, Z, found {told} there, and {len(found)} names and {len(labels)} axes in all"
        )
        raise RecordingError(msg)
    there = [(name, k) for name, k in found if k in begins]
    twice, seen = Counter(name for name, _ in there), Counter[str]()
    columns = {}
    for name, k in there:
        seen[name] += 1
        columns[name if twice[name] == 1 else f"{name} ({seen[name]})"] = k
    return columns, [name for name, k in found if k not in begins], in_order, max((k + 3 for k in begins), default=2)
