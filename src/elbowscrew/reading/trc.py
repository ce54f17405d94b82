"""Marker trajectories in TRC files: five header lines with tabs, then a line a frame."""

from __future__ import annotations

from itertools import islice
from typing import Final

import numpy as np

from elbowscrew.errors import NoBodiesError, RecordingError
from elbowscrew.model import Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, MarkerBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, cut_warnings, frame_rate
from elbowscrew.reading.options import ASK_FOR_MARKERS, ReadOptions, stated_unit
from elbowscrew.reading.source import TextSource

_HEADER_LINES: Final = 5


def recognizes(cells: list[str]) -> bool:
    """Tell by the first cell."""
    return cells[:1] == ["pathfiletype"]


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a TRC file; see `elbowscrew.reading.registry.read_recording`."""
    rows = [[cell.strip() for cell in line.split("\t")] for line in islice(source.lines(), _HEADER_LINES)]
    if len(rows) < _HEADER_LINES or rows[3][:1] != ["Frame#"]:
        msg = (
            f"{source.path}:4: the header is cut: expected 'Frame#' in the first cell of line 4; export the take again"
        )
        raise RecordingError(msg)
    for name, k in ((name, k) for k, name in enumerate(rows[3]) if k >= 2 and name):
        labels = [cell[:1].upper() for cell in rows[4][k : k + 3]]
        if labels != ["X", "Y", "Z"] or any(rows[3][k + 1 : k + 3]):
            found = ", ".join(rows[4][k : k + 3])
            msg = f"{source.path}:5: marker {name!r}: expected its X, Y, Z below its name, found {found}"
            raise RecordingError(msg)
    stated = dict(zip(rows[1], rows[2], strict=False))
    unit = stated_unit(source.path, stated.get("Units", ""), options)
    names = {name: k for k, name in enumerate(rows[3]) if k >= 2 and name}
    if len(names) != sum(1 for name in rows[3][2:] if name):
        msg = f"{source.path}:4: a marker's name appears twice; give the markers different names"
        raise RecordingError(msg)
    wanted = {name: k for name, k in names.items() if options.wants(name)}
    if not wanted:
        told = ", ".join(list(names)[:8])
        msg = f"{source.path}: no rigid bodies in the file (markers: {told}); {ASK_FOR_MARKERS}"
        raise NoBodiesError(msg)
    columns = [0, 1, *(k + axis for k in wanted.values() for axis in range(3))]
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    markers = [MarkerBuilder(name) for name in wanted]
    line = _HEADER_LINES
    for block in read_blocks(source, line, columns, max(columns) + 1):
        check_frames(source, line, block)
        frames.append(block[:, 0].astype(np.int64))
        times.append(block[:, 1])
        for k, marker in enumerate(markers):
            marker.append(METERS[unit] * block[:, 2 + 3 * k : 5 + 3 * k])
        line += len(block)
    frame, time_s = frames.finish(), times.finish()
    if not frame.size:
        msg = f"{source.path}:{_HEADER_LINES + 1}: no frame follows the header"
        raise RecordingError(msg)
    cut = cut_warnings(source, stated.get("NumFrames", ""), frame.size)
    rate, warnings = frame_rate(source.path, stated.get("DataRate", ""), frame, time_s)
    return Recording(
        bodies=(),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        markers=tuple(marker.finish() for marker in markers),
        source=Source(path=str(source.path), sha256=source.sha256, layout="TRC", length_unit=unit),
        warnings=(*warnings, *cut, *(warning for marker in markers for warning in marker.warnings())),
    )
