"""A table of numbers, once it is known which of its columns are the clock, the bodies and the markers."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.column_file import ColumnFile
from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.quaternion import quat_from_euler_angles
from elbowscrew.model import QualityWarning, Recording, Source
from elbowscrew.quantities import METERS
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder, MarkerBuilder
from elbowscrew.reading.cells import read_blocks
from elbowscrew.reading.clock import check_frames, counted_rate, cut_warnings, frames_and_times
from elbowscrew.reading.source import TextSource

# As a matrix' last row may be printed.
_EXACT: Final = 1e-6


class BodyCells(NamedTuple):
    """Where in a row a body stands.

    Attributes
    ----------
    name : str
    rotation : tuple of int
        Columns of a unit quaternion, scalar first, of a matrix row by row, or of three Euler angles.
    position : tuple of int
        Empty for a body without one.
    unit : {"m", "cm", "mm", ""}
        Of the position.
    sequence : str
        Order of the Euler angles: capitals about the body's axes, small letters about the laboratory's.
    degrees : bool
        Whether they are degrees.
    bottom : tuple of int
        Columns of a matrix' last row, 0, 0, 0, 1, if it has one.
    """

    name: str
    rotation: tuple[int, ...]
    position: tuple[int, ...]
    unit: str
    sequence: str = ""
    degrees: bool = False
    bottom: tuple[int, ...] = ()

    @property
    def columns(self) -> tuple[int, ...]:
        """All of them."""
        return (*self.rotation, *self.position, *self.bottom)

    @property
    def rotation_type(self) -> str:
        """What the rotation is, in a word."""
        return {4: "quaternion", 9: "matrix"}.get(len(self.rotation), self.sequence)


class MarkerCells(NamedTuple):
    """Where in a row a marker stands, in which unit."""

    name: str
    position: tuple[int, ...]
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TableCells:
    """Where in a table what stands.

    Attributes
    ----------
    layout : str
        What it is called.
    lines_above : int
        Lines above the first row of numbers.
    width : int
        Cells that a whole row has at the least.
    frame, time : int or None
        Columns of frame numbers and times; without either, each row is a frame.
    time_unit : float
        In seconds.
    rate_hz : float or None
        Frames a second, where there are no times.
    nan_word : bool
        Whether the word "nan" is a blank cell.
    bodies : tuple of BodyCells
    markers : tuple of MarkerCells
    named : ColumnFile or None
        What said so, where that is not the table's own header.
    marker_names : tuple of str
        Of all markers of the table, read or not.
    """

    layout: str
    lines_above: int
    width: int
    frame: int | None
    time: int | None
    time_unit: float = 1.0
    rate_hz: float | None = None
    nan_word: bool = False
    bodies: tuple[BodyCells, ...]
    markers: tuple[MarkerCells, ...]
    named: ColumnFile | None = None
    marker_names: tuple[str, ...] = ()


def read_table(source: TextSource, table: TableCells, *warnings: QualityWarning) -> Recording:
    """Read the rows of a table; what was doubtful before goes on into the recording.

    Raises
    ------
    RecordingError
        For cells that are no numbers, rows that are cut, a clock that does not go on, or a table without rows.
    """
    clock = [column for column in (table.frame, table.time) if column is not None]
    parts = (*(body.columns for body in table.bodies), *(marker.position for marker in table.markers))
    wanted = sorted({*clock, *chain.from_iterable(parts)})
    place = {column: k for k, column in enumerate(wanted)}
    frames, times = ArrayBuilder(dtype=np.int64), ArrayBuilder()
    bodies = [BodyBuilder(one.name, located=bool(one.position)) for one in table.bodies]
    markers = [MarkerBuilder(one.name) for one in table.markers]
    rows = 0
    blocks = read_blocks(
        source, table.lines_above, wanted, table.width, exact=True, nan_word=table.nan_word, blank_rows=not clock
    )
    for block in blocks:
        line = table.lines_above + rows
        frame = None if table.frame is None else block[:, place[table.frame]]
        time_s = None if table.time is None else table.time_unit * block[:, place[table.time]]
        ticks = frames_and_times(frame, time_s, range(rows, rows + len(block)), table.rate_hz)
        check_frames(source, line, ticks)
        frames.append(ticks[:, 0].astype(np.int64))
        times.append(ticks[:, 1])
        for body, builder in zip(table.bodies, bodies, strict=True):
            _append(source, line, builder, body, block[:, [place[column] for column in body.columns]])
        for marker, seen in zip(table.markers, markers, strict=True):
            seen.append(METERS[marker.unit] * block[:, [place[column] for column in marker.position]])
        rows += len(block)
    if not rows:
        msg = f"{source.path}:{table.lines_above + 1}: no frame follows the header"
        raise RecordingError(msg)
    units = (body.unit for body in table.bodies if body.position)
    frame_numbers, seconds = frames.finish(), times.finish()
    return Recording(
        bodies=tuple(body.finish() for body in bodies),
        frame=frame_numbers,
        time_s=seconds,
        rate_hz=counted_rate(source.path, frame_numbers, seconds),
        markers=tuple(marker.finish() for marker in markers),
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout=table.layout,
            length_unit=", ".join(sorted({*units, *(one.unit for one in table.markers)})),
            rotation_type=", ".join(sorted({one.rotation_type for one in table.bodies})),
            columns=table.named,
            markers=table.marker_names,
        ),
        warnings=(
            *(warning for body in bodies for warning in body.warnings()),
            *(warning for marker in markers for warning in marker.warnings()),
            *cut_warnings(source, "", rows),
            *warnings,
        ),
    )


def _append(source: TextSource, line: int, builder: BodyBuilder, body: BodyCells, cells: Float) -> None:
    """Add the frames of one body, whose cells (n, columns) stand behind a line."""
    count = len(body.rotation)
    rotation = cells[:, :count]
    position = METERS[body.unit] * cells[:, count : count + 3] if body.position else None
    if count == 4:
        builder.append(rotation, position)
    elif count == 3:
        angles = np.radians(rotation) if body.degrees else rotation
        fixed = body.sequence.islower()  # about fixed axes, the same as the reverse about the body's own
        order = body.sequence[::-1].upper() if fixed else body.sequence
        builder.append(quat_from_euler_angles(angles[:, ::-1] if fixed else angles, order), position)
    else:
        _check_bottom(source, line, body.name, rotation, cells[:, count + 3 :])
        builder.append_matrices(rotation.reshape(-1, 3, 3), position)


def _check_bottom(source: TextSource, line: int, name: str, rotation: Float, bottom: Float) -> None:
    """Check that known matrices end in 0, 0, 0, 1, if they have such a row: others stand column by column."""
    known = np.isfinite(rotation).all(axis=1) & rotation.any(axis=1)
    bad = known & ~(np.abs(bottom - [0.0, 0.0, 0.0, 1.0][: bottom.shape[1]]) < _EXACT).all(axis=1)
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        found = ", ".join(f"{x:g}" for x in bottom[row])
        msg = (
            f"{source.path}:{line + row + 1}: expected 0, 0, 0, 1 in the last four columns of the matrix of {name!r}, "
            f"found {found}; name its columns row by row"
        )
        raise RecordingError(msg)
