"""A table whose columns a file of ``--columns`` names: whatever it looks like, somebody has said what it holds."""

from __future__ import annotations

import csv
import re
from contextlib import closing
from dataclasses import replace
from itertools import islice
from typing import Final, NamedTuple

from elbowscrew.column_file import SECONDS, BodyColumns, ColumnFile, MarkerColumns
from elbowscrew.errors import Missing, MissingStatementError, RecordingError, SettingError, did_you_mean
from elbowscrew.model import QualityWarning, Recording
from elbowscrew.quantities import in_digits
from elbowscrew.reading.cells import parse_number
from elbowscrew.reading.clock import numbered
from elbowscrew.reading.options import ASK_FOR_UNITS, ReadOptions, nothing_wanted
from elbowscrew.reading.source import TextSource
from elbowscrew.reading.table import BodyCells, MarkerCells, TableCells, read_table

_PLACE: Final = re.compile(r"#([1-9]\d{0,5})", re.ASCII)
_HEADER_WITHIN: Final = 300
# No joint is recorded so slowly; milliseconds taken for seconds are.
_SLOW_HZ: Final = 2.0


class _Lines(NamedTuple):
    """The lines of a table: the header's cells and number (none and 0 without one), lines above the numbers, cells."""

    header: list[str]
    number: int
    above: int
    width: int


def read(source: TextSource, options: ReadOptions, named: ColumnFile) -> Recording:
    """Read a table by its named columns; see `elbowscrew.reading.registry.read_recording`."""
    lines = _lines(source, named)
    place = _places(source, named, lines)
    rate = _rate(named, options)
    markers = {name: one for name, one in named.markers.items() if options.wants(name)}
    if not named.bodies and not markers:
        raise nothing_wanted(source.path, f"no bodies in {named.name}", list(named.markers), options)
    _ask(source, named, options, markers, rate)
    clock = named.clock
    table = TableCells(
        layout="named columns",
        lines_above=lines.above,
        width=lines.width,
        frame=None if clock.frame is None else place[clock.frame],
        time=None if clock.time is None else place[clock.time],
        time_unit=SECONDS[clock.unit],
        rate_hz=rate,
        nan_word=True,
        named=named,
        marker_names=tuple(named.markers),
        bodies=tuple(_body(name, one, place, one.unit or str(options.units)) for name, one in named.bodies.items()),
        markers=tuple(
            MarkerCells(name, tuple(place[column] for column in one.position), one.unit or str(options.units))
            for name, one in markers.items()
        ),
    )
    _check_first_row(source, named, lines, [column for column in (table.time, table.frame) if column is not None])
    recording = read_table(source, table, *(numbered("the table") if clock.frame is None else ()))
    if clock.time is None or recording.rate_hz >= _SLOW_HZ:
        return recording
    message = (
        f"times in {clock.unit} give {in_digits(recording.rate_hz, 3)} frames a second: if they are in another unit, "
        f'say so in {named.name}, as in unit = "ms" under [clock]'
    )
    return replace(recording, warnings=(QualityWarning(code="slow-clock", message=message), *recording.warnings))


def _body(name: str, columns: BodyColumns, place: dict[str, int], unit: str) -> BodyCells:
    rotation = [place[column] for column in columns.quaternion or columns.matrix or columns.euler or ()]
    position = [place[column] for column in columns.position or ()]
    bottom = rotation[12:]
    if len(rotation) >= 12:
        position = rotation[3:12:4]
        rotation = [rotation[k] for k in (0, 1, 2, 4, 5, 6, 8, 9, 10)]
    elif columns.order == "xyzw":
        rotation = [rotation[-1], *rotation[:-1]]
    return BodyCells(
        name,
        tuple(rotation),
        tuple(position),
        unit,
        sequence=columns.sequence or "",
        degrees=bool(columns.degrees),
        bottom=tuple(bottom),
    )


def _rate(named: ColumnFile, options: ReadOptions) -> float | None:
    """Give the frames a second of a table without times, None if it has them or nobody says."""
    stated, given = named.clock.rate_hz, options.rate_hz
    if given is not None and (named.clock.time is not None or stated not in (None, given)):
        what = "has the times" if named.clock.time is not None else f"says rate_hz = {stated:g}"
        msg = f"--rate {given:g}: [clock] of {named.name} {what} itself; leave --rate out"
        raise SettingError(msg)
    return stated or given


def _ask(
    source: TextSource, named: ColumnFile, options: ReadOptions, markers: dict[str, MarkerColumns], rate: float | None
) -> None:
    """Ask for all that neither the file of columns nor an option says."""
    units = {f"bodies.{name}": one.unit for name, one in named.bodies.items() if one.has_position}
    units |= {f"markers.{name}": one.unit for name, one in markers.items()}
    other = next((key for key, unit in units.items() if unit not in (None, options.units)), None)
    if options.units is not None and other is not None:
        msg = f"--units {options.units}: [{other}] of {named.name} has unit = {units[other]!r}; leave --units out"
        raise SettingError(msg)
    without = [key for key, unit in units.items() if unit is None]
    missing = []
    if without and options.units is None:
        lacks = f"has no unit of length for {', '.join(without[:5])}{' and others' if len(without) > 5 else ''}"
        missing.append(Missing("units", lacks, f"unit in {named.name}, or {ASK_FOR_UNITS}"))
    if named.clock.time is None and rate is None:
        missing.append(Missing("rate_hz", "has no times", f"rate_hz under [clock] of {named.name}, or --rate HZ"))
    if missing:
        raise MissingStatementError.of(source.path, *missing)


def _lines(source: TextSource, named: ColumnFile) -> _Lines:
    """Find the header: the line that is said to be it, or the first that has all names."""
    first = named.table.first_row
    names = {column: key for key, column in named.columns() if not _PLACE.fullmatch(column)}
    if not names and named.table.header is None:
        above = (first or 1) - 1
        return _Lines([], 0, above, len(_cells(source, above + 1, whole=True)))
    if named.table.header is not None:
        header, number = _cells(source, named.table.header), named.table.header
    else:
        header, number = _best_line(source, set(names))
    _check_names(source, named, names, header, number)
    return _Lines(header, number, number if first is None else first - 1, len(header))


def _best_line(source: TextSource, names: set[str]) -> tuple[list[str], int]:
    """Give the line that has most of the names, and its number."""
    best: tuple[list[str], int] = ([], 0)
    most = -1
    for number, line in enumerate(source.head(_HEADER_WITHIN), start=1):
        try:
            cells = source.cells(line)
        except csv.Error:
            continue  # a line of another kind; one that is damaged has none of the names
        count = len(names.intersection(cells))
        if count > most and any(cells):
            best, most = (_without_end(cells), number), count
        if count == len(names):
            break
    return best


def _cells(source: TextSource, number: int, *, whole: bool = False) -> list[str]:
    """Cells of a line, without blank ones at its end if not whole."""
    with closing(source.lines()) as lines:
        line = next(islice(lines, number - 1, None), "")
    try:
        return source.cells(line) if whole else _without_end(source.cells(line))
    except csv.Error as error:
        msg = f"{source.path}:{number}: not a line of a CSV file: {error}"
        raise RecordingError(msg) from error


def _without_end(cells: list[str]) -> list[str]:
    while cells and not cells[-1]:
        cells = cells[:-1]
    return cells


def _check_names(source: TextSource, named: ColumnFile, names: dict[str, str], header: list[str], number: int) -> None:
    for column, key in names.items():
        if header.count(column) == 1:
            continue
        if column in header:
            where = " and ".join(f'"#{k}"' for k, cell in enumerate(header, 1) if cell == column)
            msg = (
                f"{named.name}: {key}: {column!r} stands more than once in {source.path}:{number}; give {where} instead"
            )
        else:
            mean = did_you_mean(column, header)
            told = "" if mean else f"; it has {', '.join(map(repr, header[:12]))}{' and more' if header[12:] else ''}"
            msg = f"{named.name}: {key}: no column {column!r} in {source.path}:{number}{mean}{told}"
        raise SettingError(msg)


def _places(source: TextSource, named: ColumnFile, lines: _Lines) -> dict[str, int]:
    """Give the place of each column, counted from 0."""
    place: dict[str, int] = {}
    meant: dict[int, str] = {}
    for key, column in named.columns():
        found = _PLACE.fullmatch(column)
        by_number = column not in lines.header and found is not None
        k = int(found[1]) - 1 if by_number and found is not None else lines.header.index(column)
        if k >= lines.width:
            where = f"line {lines.number or lines.above + 1} of {source.path} has {lines.width} columns"
            msg = f"{named.name}: {key}: no column {column!r}; {where}"
            raise SettingError(msg)
        if k in meant:
            msg = f"{named.name}: {key}: {column!r} is the column of {meant[k]} already; name another"
            raise SettingError(msg)
        place[column], meant[k] = k, key
    return place


def _check_first_row(source: TextSource, named: ColumnFile, lines: _Lines, clock: list[int]) -> None:
    """Check that numbers follow where they should: below the names, units may stand."""
    for k in clock:
        cells = _cells(source, lines.above + 1)
        text = cells[k] if k < len(cells) else ""
        try:
            parse_number(text.replace(",", ".") if source.decimal_comma else text)
        except ValueError:
            msg = (
                f"{source.path}:{lines.above + 1}: column {k + 1}: expected the clock's first number, found "
                f"{text[:40]!r}; say in {named.name} where the numbers begin, as in first_row = {lines.above + 2} "
                "under [table]"
            )
            raise SettingError(msg) from None
