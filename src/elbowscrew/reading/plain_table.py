"""A plain table for recordings of other systems: named columns with units in their names.

``frame, time_s`` or one of them, then for a body ``<name>_e0 .. <name>_e3, <name>_x_m, <name>_y_m, <name>_z_m``, for
one without positions ``<name>_e0 .. <name>_e3`` alone, and for a marker ``<name>_x_m, <name>_y_m, <name>_z_m``; ``_mm``
or ``_cm`` in place of ``_m`` if so. Blank cells are lost frames.
"""

from __future__ import annotations

import csv
import re
from typing import Final

import numpy as np

from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder, MarkerBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, counted_rate, cut_warnings, numbered
from elbowscrew.reading.options import ReadOptions, nothing_wanted
from elbowscrew.reading.source import TextSource

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
    columns, scales = _columns_by_body(source, names, line, len(clock))
    bodies = {name: parts for name, parts in columns.items() if set(_ORIENTATION) <= set(parts)}
    markers = {name: parts for name, parts in columns.items() if set(parts) == set("xyz") and options.wants(name)}
    if not bodies and not markers:
        raise nothing_wanted(source.path, "no rigid bodies in the table", list(columns), options)
    wanted = sorted(set(range(len(clock))).union(*(parts.values() for parts in (*bodies.values(), *markers.values()))))
    index = {column: k + len(_CLOCK) - len(clock) for k, column in enumerate(wanted)}
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    body_builders = {name: BodyBuilder(name, located=name in scales) for name in bodies}
    marker_builders = {name: MarkerBuilder(name) for name in markers}
    number = line
    rows = 0
    for cells_of_block in read_blocks(source, line, wanted, len(names), exact=False):
        block = _with_clock(cells_of_block, clock, options.rate_hz, rows)
        check_frames(source, number, block)
        rows += len(block)
        frames.append(block[:, 0].astype(np.int64))
        times.append(block[:, 1])
        for name, parts in bodies.items():
            quat = block[:, [index[parts[part]] for part in _ORIENTATION]]
            scale = scales.get(name)
            position = None if scale is None else scale * block[:, [index[parts[axis]] for axis in "xyz"]]
            body_builders[name].append(quat, position)
        for name, parts in markers.items():
            marker_builders[name].append(scales[name] * block[:, [index[parts[axis]] for axis in "xyz"]])
        number += len(block)
    frame, time_s = frames.finish(), times.finish()
    if not frame.size:
        msg = f"{source.path}:{line + 1}: no frame follows the header"
        raise RecordingError(msg)
    return Recording(
        bodies=tuple(body.finish() for body in body_builders.values()),
        frame=frame,
        time_s=time_s,
        rate_hz=counted_rate(source.path, frame, time_s),
        markers=tuple(marker.finish() for marker in marker_builders.values()),
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout="plain table",
            length_unit=", ".join(sorted({_unit_of(scale) for scale in scales.values()})),
            rotation_type="quaternion" if bodies else "",
        ),
        warnings=(
            *(warning for body in body_builders.values() for warning in body.warnings()),
            *(warning for marker in marker_builders.values() for warning in marker.warnings()),
            *cut_warnings(source, "", frame.size),
            *(numbered("the table") if clock == _CLOCK[1:] else ()),
        ),
    )


def _check_rate(source: TextSource, clock: list[str], options: ReadOptions) -> None:
    if options.rate_hz is None and clock == _CLOCK[:1]:
        msg = f"{source.path}: the table has frame numbers and no times: give --rate HZ"
        raise SettingError(msg)
    if options.rate_hz is not None and clock != _CLOCK[:1]:
        msg = f"--rate {options.rate_hz:g}: the table has times itself; leave --rate out"
        raise SettingError(msg)


def _with_clock(block: Float, clock: list[str], rate_hz: float | None, rows: int) -> Float:
    """Put the frame number, or the time, in front of a block that is without it, behind so many rows."""
    if clock == _CLOCK[1:]:
        return np.insert(block, 0, np.arange(rows, rows + len(block)), axis=1)
    return block if rate_hz is None else np.insert(block, 1, block[:, 0] / rate_hz, axis=1)


def _header(source: TextSource) -> tuple[list[str], int]:
    for number, text in enumerate(source.lines(), start=1):
        try:
            cells = source.cells(text)
        except csv.Error as error:
            msg = f"{source.path}:{number}: not a line of a CSV file: {error}"
            raise RecordingError(msg) from error
        if any(cells):
            while cells and not cells[-1]:
                cells.pop()
            return cells, number
    raise AssertionError  # the file was recognized by this very line


def _columns_by_body(
    source: TextSource, names: list[str], line: int, first: int
) -> tuple[dict[str, dict[str, int]], dict[str, float]]:
    """Columns of every body and marker by their parts, and the scale of each to meters; all faults at once."""
    columns: dict[str, dict[str, int]] = {}
    scales: dict[str, float] = {}
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
        if found["unit"]:
            scale = METERS[found["unit"]]
            if scales.setdefault(name, scale) != scale:
                faults.append(f"{name!r} has positions in two units")
    for name, parts in columns.items():
        if set(parts) not in (set(_POSE), set(_ORIENTATION), set("xyz")):
            faults.append(f"{name!r} has only {', '.join(sorted(parts))}: expected e0..e3, x, y, z, or either alone")
    if faults:
        msg = f"{source.path}:{line}: {'; '.join(faults[:5])}; see docs/plain-table.md"
        raise RecordingError(msg)
    return columns, scales


def _unit_of(scale: float) -> str:
    return next(unit for unit, meters in METERS.items() if meters == scale)
