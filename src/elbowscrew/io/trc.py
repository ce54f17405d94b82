"""Marker trajectories in TRC files: five header lines with tabs, then a line a frame."""

from __future__ import annotations

from itertools import islice
from typing import Final

import numpy as np

from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.io.cells import Growing, parse_number, read_blocks
from elbowscrew.io.clock import check_frames, counted_rate, is_rate, rate_of
from elbowscrew.io.options import ReadOptions
from elbowscrew.io.source import TextSource
from elbowscrew.model import Marker, QualityWarning, Recording, Source
from elbowscrew.tables import METERS

_HEADER_LINES: Final = 5


def recognizes(cells: list[str]) -> bool:
    """Tell by the first cell."""
    return cells[:1] == ["pathfiletype"]


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a TRC file; see `elbowscrew.io.reading.read_recording`."""
    rows = [[cell.strip() for cell in line.split("\t")] for line in islice(source.lines(), _HEADER_LINES)]
    if len(rows) < _HEADER_LINES or rows[3][:1] != ["Frame#"]:
        msg = (
            f"{source.path}:4: the header is cut: expected 'Frame#' in the first cell of line 4; export the take again"
        )
        raise RecordingError(msg)
    stated = dict(zip(rows[1], rows[2], strict=False))
    unit = _unit(source, stated.get("Units", ""), options)
    names = {name: k for k, name in enumerate(rows[3]) if k >= 2 and name}
    if len(names) != sum(1 for name in rows[3][2:] if name):
        msg = f"{source.path}:4: a marker's name stands twice; give the markers different names"
        raise RecordingError(msg)
    wanted = {name: k for name, k in names.items() if options.wants(name)}
    if not wanted:
        told = ", ".join(list(names)[:8])
        msg = f"{source.path}: a file of markers ({told}): give --arm-markers and --forearm-markers"
        raise SettingError(msg)
    columns = [0, 1, *(k + axis for k in wanted.values() for axis in range(3))]
    kept = Growing((len(columns),))
    line = _HEADER_LINES
    for block in read_blocks(source, line, columns, max(columns) + 1):
        check_frames(source, line, block)
        kept.append(block)
        line += len(block)
    data = kept.finish()
    if not len(data):
        msg = f"{source.path}:{_HEADER_LINES + 1}: no frame follows the header"
        raise RecordingError(msg)
    frame, time_s = data[:, 0].astype(np.int64), data[:, 1].copy()
    positions = METERS[unit] * data[:, 2:].reshape(len(data), -1, 3)
    warnings: list[QualityWarning] = []
    return Recording(
        bodies=(),
        frame=frame,
        time_s=time_s,
        rate_hz=_rate(source, stated.get("DataRate", ""), rate_of(frame, time_s), warnings)
        if len(data) > 1
        else counted_rate(source.path, frame, time_s),
        markers=tuple(Marker(name=name, position=positions[:, k]) for k, name in enumerate(wanted)),
        source=Source(path=str(source.path), sha256=source.sha256, layout="TRC", length_unit=unit),
        warnings=tuple(warnings),
    )


def _unit(source: TextSource, stated: str, options: ReadOptions) -> str:
    unit = stated.casefold()
    if unit and unit not in METERS:
        msg = f"{source.path}:3: Units: expected {', '.join(METERS)}, found {stated!r}"
        raise RecordingError(msg)
    if unit and options.units not in (None, unit):
        msg = f"--units {options.units}: the file states {stated} itself; leave --units out"
        raise SettingError(msg)
    if not unit and options.units is None:
        msg = f"{source.path}:3: the file does not state its unit of length; give --units m, cm or mm"
        raise SettingError(msg)
    return unit or str(options.units)


def _rate(source: TextSource, text: str, counted: float, warnings: list[QualityWarning]) -> float:
    try:
        stated = parse_number(text)
    except ValueError:
        stated = float("nan")
    if is_rate(counted) and is_rate(stated) and abs(counted - stated) > 0.01 * stated:
        message = f"the header states {stated:g} frames a second, the times give {counted:.4g}: the latter is used"
        warnings.append(QualityWarning(code="frame-rate", message=message))
    if not (is_rate(counted) or is_rate(stated)):
        msg = f"{source.path}: neither the header nor the times give a possible frame rate"
        raise RecordingError(msg)
    return counted if is_rate(counted) else stated
