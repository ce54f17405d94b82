"""A plain table for recordings of other systems: named columns with units in their names.

``frame, time_s`` or one of them, then for a body ``<name>_e0 .. <name>_e3, <name>_x_m, <name>_y_m, <name>_z_m``, for
one without positions ``<name>_e0 .. <name>_e3`` alone, and for a marker ``<name>_x_m, <name>_y_m, <name>_z_m``; ``_mm``
or ``_cm`` in place of ``_m`` if so. Blank cells are lost frames.
"""

from __future__ import annotations

import csv
import re
from typing import Final

from elbowscrew.errors import Missing, MissingStatementError, RecordingError, SettingError
from elbowscrew.model import Recording
from elbowscrew.reading.clock import numbered
from elbowscrew.reading.options import ReadOptions, nothing_wanted
from elbowscrew.reading.source import TextSource
from elbowscrew.reading.table import BodyCells, MarkerCells, TableCells, read_table

_COLUMN: Final = re.compile(r"(?P<name>.+)_(?:(?P<euler>e[0-3])|(?P<axis>[xyz])_(?P<unit>m|cm|mm))")
_CLOCK: Final = ["frame", "time_s"]
_ORIENTATION: Final = ("e0", "e1", "e2", "e3")
_POSE: Final = (*_ORIENTATION, *"xyz")


def recognizes(cells: list[str]) -> bool:
    """Tell by the first two cells: a clock, and what follows it."""
    return cells[:2] == _CLOCK or (cells[0] in _CLOCK and len(cells) > 1 and _COLUMN.fullmatch(cells[1]) is not None)


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a plain table; see `elbowscrew.reading.registry.read_recording`."""
    names, line = _header(source)
    clock = names[:2] if names[:2] == _CLOCK else names[:1]
    _check_rate(source, clock, options)
    columns, units = _columns_by_body(source, names, line, len(clock))
    bodies = {name: parts for name, parts in columns.items() if set(_ORIENTATION) <= set(parts)}
    all_markers = {name: parts for name, parts in columns.items() if set(parts) == set("xyz")}
    markers = {name: parts for name, parts in all_markers.items() if options.wants(name)}
    if not bodies and not markers:
        raise nothing_wanted(source.path, "no rigid bodies in the table", list(columns), options)
    table = TableCells(
        layout="plain table",
        lines_above=line,
        width=len(names),
        frame=0 if clock[0] == "frame" else None,
        time=clock.index("time_s") if "time_s" in clock else None,
        rate_hz=options.rate_hz,
        marker_names=tuple(all_markers),
        bodies=tuple(
            BodyCells(
                name,
                tuple(parts[part] for part in _ORIENTATION),
                tuple(parts[axis] for axis in "xyz" if axis in parts),
                units.get(name, ""),
            )
            for name, parts in bodies.items()
        ),
        markers=tuple(
            MarkerCells(name, tuple(parts[axis] for axis in "xyz"), units[name]) for name, parts in markers.items()
        ),
    )
    return read_table(source, table, *(numbered("the table") if clock == _CLOCK[1:] else ()))


def _check_rate(source: TextSource, clock: list[str], options: ReadOptions) -> None:
    if options.rate_hz is None and clock == _CLOCK[:1]:
        raise MissingStatementError.of(source.path, Missing("rate_hz", "has frame numbers and no times", "--rate HZ"))
    if options.rate_hz is not None and clock != _CLOCK[:1]:
        msg = f"--rate {options.rate_hz:g}: the table has times itself; leave --rate out"
        raise SettingError(msg)


def _header(source: TextSource) -> tuple[list[str], int]:
    number, text = source.first_filled()
    try:
        cells = source.cells(text)
    except csv.Error as error:
        msg = f"{source.path}:{number}: not a line of a CSV file: {error}"
        raise RecordingError(msg) from error
    while cells and not cells[-1]:
        cells.pop()
    return cells, number


def _columns_by_body(
    source: TextSource, names: list[str], line: int, first: int
) -> tuple[dict[str, dict[str, int]], dict[str, str]]:
    """Columns of every body and marker by their parts, and the unit of each; all faults at once."""
    columns: dict[str, dict[str, int]] = {}
    units: dict[str, str] = {}
    faults = []
    for k, title in enumerate(names[first:], start=first):
        found = _COLUMN.fullmatch(title)
        if found is None:
            faults.append(f"column {k + 1} {title[:40]!r} is neither <name>_e0..e3 nor <name>_x_m, _y_m, _z_m")
            continue
        name, part = found["name"], found["euler"] or found["axis"]
        if part in columns.setdefault(name, {}):
            faults.append(f"column {k + 1} {title[:40]!r} stands twice")
        columns[name][part] = k
        if found["unit"] and units.setdefault(name, found["unit"]) != found["unit"]:
            faults.append(f"{name!r} has positions in two units")
    for name, parts in columns.items():
        if set(parts) not in (set(_POSE), set(_ORIENTATION), set("xyz")):
            faults.append(f"{name!r} has only {', '.join(sorted(parts))}: expected e0..e3, x, y, z, or either alone")
    if faults:
        msg = f"{source.path}:{line}: {'; '.join(faults[:5])}; see docs/reference/plain-table.md"
        raise RecordingError(msg)
    return columns, units
