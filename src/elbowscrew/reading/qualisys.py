"""Rigid bodies in Qualisys's 6D export (tab-separated): keys and values, a line of columns, then a line a frame.

The keys may be left out on export, and so may frame numbers and times: then rows are frames, at the frequency.

For each body there are ``<name> X``, ``Y``, ``Z`` in millimeters, three angles, ``Residual``, and ``Rot[0]`` to
``Rot[8]``: the matrix from body to laboratory, column by column. The angles are not read: users choose their names and
order.
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
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, cut_warnings, frames_and_times, rate_and_times
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.qualisys_markers import HEADER_LINES, marker_header, read_markers, stated_frequency
from elbowscrew.reading.source import TextSource

_FIRST_KEYS: Final = ("no_of_frames", "file_version")
_X: Final = re.compile(r"(?:^| )x$")
_UNIT: Final = "mm"
_ROTATION: Final = tuple(f"rot[{k}]" for k in range(9))


def recognizes(cells: list[str]) -> bool:
    """Tell by the first cell, which all of Qualisys's exports have, of markers, too; or by the titles of matrices."""
    return cells[0] in _FIRST_KEYS or _are_titles(cells)


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read an export of bodies or of markers; see `elbowscrew.reading.registry.read_recording`."""
    markers = marker_header(source)
    if markers is not None:
        return read_markers(source, markers, options)
    if options.markers:
        msg = f"{source.path}: markers: bodies (6D) have none; leave it out, and give landmarks as coordinates"
        raise SettingError(msg)
    stated, names, titles, line = _header(source)
    clock = 2 if titles[0].casefold() == "frame" else 0
    rate_hz = None if clock else stated_frequency(source, stated.get("frequency", ""))
    bodies = _body_columns(source, names, titles, line, clock)
    columns = [*range(clock), *(k for wanted in bodies.values() for k in wanted)]
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    builders = [BodyBuilder(name) for name in bodies]
    number = line
    for block in read_blocks(source, line, columns, len(titles), exact=True, nan_word=True, blank_rows=not clock):
        rows = range(number - line + 1, number - line + 1 + len(block))
        ticks = block[:, :2] if clock else frames_and_times(None, None, rows, rate_hz)
        check_frames(source, number, ticks)
        frames.append(ticks[:, 0].astype(np.int64))
        times.append(ticks[:, 1])
        for k, builder in enumerate(builders):
            cells = block[:, clock + 12 * k : clock + 12 * (k + 1)]
            builder.append_matrices(_matrices(cells[:, 3:]), METERS[_UNIT] * cells[:, :3])
        number += len(block)
    frame, time_s = frames.finish(), times.finish()
    if not frame.size:
        msg = f"{source.path}:{line + 1}: no frame follows the header; export the take again"
        raise RecordingError(msg)
    rate, time_s, warnings = rate_and_times(source.path, stated.get("frequency", ""), frame, time_s)
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


def _are_titles(cells: list[str]) -> bool:
    return "rot[0]" in cells


def _matrices(cells: Float) -> Float:
    """Rotation matrices (n, 3, 3) of nine cells that go down the columns."""
    return np.swapaxes(cells.reshape(-1, 3, 3), 1, 2)


def _header(source: TextSource) -> tuple[dict[str, str], list[str], list[str], int]:
    """Give what the file states, the bodies' names, the titles of the columns, and how many lines that is."""
    stated: dict[str, str] = {}
    names: list[str] = []
    for number, text in enumerate(source.head(HEADER_LINES), start=1):
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
        elif _are_titles([cell.casefold() for cell in cells]):
            return stated, names or [cell[:-2] for cell in cells if _X.search(cell.casefold())], cells, number
        elif key and key not in stated:
            stated[key] = " ".join(cells[1:])
    if not names:
        msg = (
            f"{source.path}: no export of Qualisys that is read: no line BODY_NAMES (6D) or MARKER_NAMES (3D) with "
            "names; export 6D or 3D data with the header"
        )
        raise RecordingError(msg)
    msg = (
        f"{source.path}: nothing says which column is what: no line has the titles X, Y, Z and Rot[0] to Rot[8]; "
        "export the take again with its column header"
    )
    raise RecordingError(msg)


def _body_columns(
    source: TextSource, names: list[str], titles: list[str], line: int, clock: int
) -> dict[str, list[int]]:
    """Columns of X, Y, Z and of the nine cells of the matrix, of every body; all faults at once."""
    faults = ["the second column is not 'Time'"] if clock and titles[1].casefold() != "time" else []
    if len(set(names)) != len(names):
        faults.append("a body's name stands twice")
    starts = [k for k, title in enumerate(titles) if _X.search(title.casefold())]
    if starts[:1] != [clock]:
        faults.append(f"the first body's X is not column {clock + 1}")
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
