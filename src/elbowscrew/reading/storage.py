"""Orientations in OpenSim's Storage (``.sto``), as OpenSense takes them from inertial sensors.

``key=value`` lines up to ``endheader``, among them ``DataType=Quaternion``, then a table with tabs: ``time``, and for
each segment one cell of four numbers with commas, scalar first, segment to ground. There are no positions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Final

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.model import Recording, Source
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, cut_warnings, numbered, rate_and_times
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import END_OF_STORAGE_HEADER, TextSource

_HEADER_LINES: Final = 64
_KEYS: Final = ("datarate", "datatype", "version", "opensimversion", "nrows", "ncolumns", "indegrees", "units")
_NUMBERS: Final = 4
_LOST: Final = "\t" * (_NUMBERS - 1)


def recognizes(cells: list[str]) -> bool:
    """Tell by the first line, one of the header's keys with its value."""
    key, equals, _ = cells[0].partition("=")
    return bool(equals) and key.strip() in _KEYS


def has_header(source: TextSource) -> bool:
    """Tell by the line that ends a storage's header; what stands before it may begin with any name."""
    return any(line.strip().casefold() == END_OF_STORAGE_HEADER for line in source.head(_HEADER_LINES))


def read(source: TextSource, _options: ReadOptions) -> Recording:
    """Read a storage of orientations; see `elbowscrew.reading.registry.read_recording`."""
    stated, titles, line = _header(source)
    names = _segments(source, stated, titles, line)
    flat = _Flattened(**{field.name: getattr(source, field.name) for field in fields(source)})
    times, builders = ArrayBuilder(), [BodyBuilder(name, located=False) for name in names]
    rows = 0
    width = 1 + _NUMBERS * len(names)
    for block in read_blocks(flat, line, range(width), width, exact=True, nan_word=True):
        check_frames(source, line + rows, np.insert(block[:, :1], 0, np.arange(rows, rows + len(block)), axis=1))
        times.append(block[:, 0])
        for k, builder in enumerate(builders):
            builder.append(block[:, 1 + _NUMBERS * k : 1 + _NUMBERS * (k + 1)], None)
        rows += len(block)
    time_s = times.finish()
    if not rows:
        msg = f"{source.path}:{line + 1}: no frame follows the header; export the take again"
        raise RecordingError(msg)
    frame = np.arange(rows, dtype=np.int64)
    rate, time_s, warnings = rate_and_times(source.path, stated.get("datarate", ""), frame, time_s)
    return Recording(
        bodies=tuple(builder.finish() for builder in builders),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout="OpenSim storage",
            rotation_type="quaternion",
            metadata=stated,
        ),
        warnings=(
            *warnings,
            *cut_warnings(source, stated.get("nrows", ""), rows),
            *(warning for builder in builders for warning in builder.warnings()),
            *numbered("the file"),
        ),
    )


class _Flattened(TextSource):
    """The table with tabs between all numbers; a blank cell is four blanks, so that a row keeps its width."""

    __slots__ = ()

    @property
    def decimal_comma(self) -> bool:
        """No comma is left."""
        return False

    def blocks(self, first_line: int) -> Iterator[list[str]]:
        """As `TextSource.blocks`, flattened."""
        for lines in TextSource.blocks(self, first_line):
            yield [_flat(line) for line in lines]


def _flat(line: str) -> str:
    time, *cells = line.split("\t")
    if all(cell.count(",") == _NUMBERS - 1 for cell in cells):
        return line.replace(",", "\t")
    return "\t".join([time, *(cell.replace(",", "\t") if cell.strip() else _LOST for cell in cells)])


def _header(source: TextSource) -> tuple[dict[str, str], list[str], int]:
    """Give what the file states, the segments' names, and how many lines that is."""
    stated: dict[str, str] = {}
    lines = enumerate(source.head(_HEADER_LINES), start=1)
    for _, text in lines:
        if text.strip().casefold() == END_OF_STORAGE_HEADER:
            break
        key, equals, value = text.partition("=")
        if equals:
            stated[key.strip().casefold()] = value.strip()
    for number, text in lines:
        titles = [title.strip() for title in text.split("\t")]
        while titles and not titles[-1]:
            titles.pop()
        if titles:
            return stated, titles, number
    msg = (
        f"{source.path}: no table follows the header: expected a line 'endheader', then one that begins with 'time'; "
        "export the file again"
    )
    raise RecordingError(msg)


def _segments(source: TextSource, stated: dict[str, str], titles: list[str], line: int) -> list[str]:
    """Names of the segments; what holds no orientations, and columns that nothing tells apart, are refused."""
    kind = stated.get("datatype", "")
    if kind.casefold() != "quaternion":
        found = f"DataType={kind}" if kind else "no DataType"
        msg = (
            f"{source.path}: expected orientations (DataType=Quaternion) in a storage of OpenSim, found {found}: joint "
            "angles and forces (.mot) are no poses of two bodies; give the markers (.trc, .c3d) or orientations (.sto) "
            "that they were computed from, or say by --columns FILE.toml which columns are bodies' poses "
            "(docs/reference/plain-table.md)"
        )
        raise RecordingError(msg)
    clock, *names = titles
    doubled = sorted({name for name in names if names.count(name) > 1})
    if clock.casefold() != "time" or not names or "" in names or doubled:
        found = f"{', '.join(doubled)} twice" if doubled else repr("\t".join(titles)[:60])
        msg = f"{source.path}:{line}: expected 'time' and one column for each segment, found {found}"
        raise RecordingError(msg)
    return names
