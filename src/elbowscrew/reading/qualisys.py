"""Rigid bodies in Qualisys's 6D export (tab-separated): keys and values, a line of columns, then a line a frame.

For each body ``<name> X``, ``Y``, ``Z`` in millimeters, three angles, ``Residual``, and ``Rot[0]`` to ``Rot[8]``: the
matrix from body to laboratory, column by column. The angles are not read: users choose their names and order.
"""

from __future__ import annotations

import csv
import re
from itertools import islice
from typing import Final

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, cut_warnings, frame_rate
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import TextSource

_HEADER_LINES: Final = 32
_UNIT: Final = "mm"
_ROTATION: Final = tuple(f"rot[{k}]" for k in range(9))


def recognizes(cells: list[str]) -> bool:
    """Tell by the first cell, which all of Qualisys's exports have, of markers, too."""
    return cells[0] == "no_of_frames"


def read(source: TextSource, _options: ReadOptions) -> Recording:
    """Read a 6D export; see `elbowscrew.reading.registry.read_recording`."""
    stated, names, titles, line = _header(source)
    bodies = _body_columns(source, names, titles, line)
    columns = [0, 1, *(k for wanted in bodies.values() for k in wanted)]
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    builders = [BodyBuilder(name) for name in bodies]
    number = line
    for block in read_blocks(source, line, columns, len(titles), nan_word=True):
        check_frames(source, number, block)
        frames.append(block[:, 0].astype(np.int64))
        times.append(block[:, 1])
        for k, builder in enumerate(builders):
            cells = block[:, 2 + 12 * k : 14 + 12 * k]
            builder.append_matrices(_matrices(cells[:, 3:]), METERS[_UNIT] * cells[:, :3])
        number += len(block)
    frame, time_s = frames.finish(), times.finish()
    if not frame.size:
        msg = f"{source.path}:{line + 1}: no frame follows the header; export the take again"
        raise RecordingError(msg)
    rate, warnings = frame_rate(source.path, stated.get("frequency", ""), frame, time_s)
    return Recording(
        bodies=tuple(builder.finish() for builder in builders),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout="Qualisys 6D",
            length_unit=_UNIT,
            rotation_type="matrix",
            metadata=stated,
        ),
        warnings=(
            *warnings,
            *cut_warnings(source, stated.get("no_of_frames", ""), frame.size),
            *(warning for builder in builders for warning in builder.warnings()),
        ),
    )


def _matrices(cells: Float) -> Float:
    """Rotation matrices (n, 3, 3) of nine cells that go down the columns."""
    return np.swapaxes(cells.reshape(-1, 3, 3), 1, 2)


def _header(source: TextSource) -> tuple[dict[str, str], list[str], list[str], int]:
    """Give what the file states, the bodies' names, the titles of the columns, and how many lines that is."""
    stated: dict[str, str] = {}
    names: list[str] = []
    for number, text in enumerate(islice(source.lines(), _HEADER_LINES), start=1):
        try:
            cells = source.cells(text)
        except csv.Error as error:
            msg = f"{source.path}:{number}: not a line of a TSV file: {error}; export the take again"
            raise RecordingError(msg) from error
        while cells and not cells[-1]:
            cells.pop()
        key = cells[0].casefold() if cells else ""
        if key == "body_names":
            names = cells[1:]
        elif key == "frame" and names:
            return stated, names, cells, number
        elif key:
            stated[key] = " ".join(cells[1:])
    if "marker_names" in stated or not names:
        msg = (
            f"{source.path}: no 6D export of Qualisys: no line BODY_NAMES with names (positions of markers are read "
            "from TRC and C3D); export 6D data, or the markers as C3D"
        )
        raise RecordingError(msg)
    msg = (
        f"{source.path}: nothing says which column is what: no line begins with 'Frame' and 'Time'; export the take "
        "again with its column header"
    )
    raise RecordingError(msg)


def _body_columns(source: TextSource, names: list[str], titles: list[str], line: int) -> dict[str, list[int]]:
    """Columns of X, Y, Z and of the nine cells of the matrix, of every body; all faults at once."""
    faults = [] if titles[1:2] and titles[1].casefold() == "time" else ["the second column is not 'Time'"]
    if len(set(names)) != len(names):
        faults.append("a body's name stands twice")
    starts = [k for k, title in enumerate(titles) if re.search(r"(?:^| )x$", title.casefold())]
    if len(starts) != len(names):
        faults.append(f"{len(names)} bodies are named, and {len(starts)} columns are an X")
    found = {}
    for name, start, end in zip(names, starts, [*starts[1:], len(titles)], strict=False):
        own = [title.casefold() for title in titles[start:end]]
        if titles[start] != f"{name} X" or own[1:3] != ["y", "z"] or [t for t in own if t in _ROTATION] != [*_ROTATION]:
            faults.append(f"body {name!r} has not X, Y, Z and Rot[0] to Rot[8] of its own")
            continue
        found[name] = [*range(start, start + 3), *(start + own.index(title) for title in _ROTATION)]
    if faults:
        msg = f"{source.path}:{line}: {'; '.join(faults[:5])}; export the take again, with rotation matrices"
        raise RecordingError(msg)
    return found
