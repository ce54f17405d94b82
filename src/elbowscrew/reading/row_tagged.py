"""The row-tagged layout of Tracking Tools (1.0) and early Motive (1.1): the first cell of a line says what it is."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.model import QualityWarning, Recording, Source, TrackingLoss, out_of_reach
from elbowscrew.reading.builders import ArrayBuilder, BodyBuilder
from elbowscrew.reading.cells import parse_number
from elbowscrew.reading.clock import LAST_FRAME, LATEST_TIME_S, counted_rate, cut_warnings
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import TextSource

TAGS: Final = ("comment", "info", "righthanded", "lefthanded", "frame", "trackable", "rigidbody")
_DEFINITIONS: Final = ("trackable", "rigidbody")
_DECIMAL_COMMA: Final = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?", re.ASCII)
_BLOCK_FRAMES: Final = 1024
_BODY_CELLS: Final = 11  # id, x, y, z, qx, qy, qz, qw, yaw, pitch, roll
_OLD_VERSION: Final = "1.0"


class _Frame(NamedTuple):
    """One frame row: poses as x, y, z, qx, qy, qz, qw by body."""

    frame: int
    time_s: float
    poses: dict[int, list[float]]


@dataclass(slots=True)
class _Parsed:
    """What the lines hold, gathered in one pass."""

    info: dict[str, str] = field(default_factory=dict)
    left_handed: bool = False
    right_handed: bool = False
    names: dict[int, str] = field(default_factory=dict)
    markers: dict[int, list[list[float]]] = field(default_factory=dict)
    frames: ArrayBuilder = field(default_factory=lambda: ArrayBuilder(dtype=np.int64))
    times: ArrayBuilder = field(default_factory=ArrayBuilder)
    bodies: dict[int, BodyBuilder] = field(default_factory=dict)
    unknown: set[int] = field(default_factory=set)
    pending: list[_Frame] = field(default_factory=list)
    begun: bool = False

    def flush(self) -> None:
        """Turn the frames gathered into arrays."""
        if not self.pending:
            return
        self.frames.append(np.array([one.frame for one in self.pending], dtype=np.int64))
        self.times.append(np.array([one.time_s for one in self.pending]))
        for identifier, body in self.bodies.items():
            cells = np.full((len(self.pending), 7), np.nan)
            loss = np.full(len(self.pending), TrackingLoss.ABSENT, dtype=np.uint8)
            for k, one in enumerate(self.pending):
                if identifier in one.poses:
                    cells[k], loss[k] = one.poses[identifier], TrackingLoss.NONE
            body.append(cells[:, [6, 3, 4, 5]], cells[:, :3], loss)
        self.pending.clear()


def recognizes(cells: list[str]) -> bool:
    """Tell by the tag in the first cell; where another title follows 'frame', it is one itself."""
    return cells[0] in TAGS and not (cells[0] == "frame" and cells[1:2] and cells[1][:1].isalpha())


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a file of the row-tagged layout; see `elbowscrew.reading.registry.read_recording`.

    Positions are meters, quaternions x, y, z, w. A body that is missing from a frame's row was not tracked; the
    extended rows, which repeat its last pose then, are not used.
    """
    del options  # a format without options: see the registry
    parsed = _parse(source)
    _validate(source, parsed)
    return _build(source, parsed)


def _parse(source: TextSource) -> _Parsed:
    parsed = _Parsed()
    for number, row in _rows(source):
        tag = row[0].casefold()
        try:
            if tag == "info" and len(row) > 2:
                parsed.info[row[1].casefold()] = row[2]
            elif tag == "righthanded":
                parsed.right_handed = True
            elif tag == "lefthanded":
                parsed.left_handed = True
            elif tag == "frame":
                _parse_frame(parsed, row)
            elif tag in _DEFINITIONS and not parsed.begun:  # after the first frame they are extended rows
                identifier, count = _integer(row[2]), _integer(row[3])
                offsets = [_finite(cell) for cell in row[4 : 4 + 3 * count]]
                if identifier in parsed.names or len(offsets) != 3 * count:
                    msg = f"body {row[1]!r} is defined twice" if identifier in parsed.names else "the row is cut"
                    raise ValueError(msg)
                if out_of_reach(np.array(offsets)):
                    msg = f"a marker of body {row[1]!r} lies over 10 km from it"
                    raise ValueError(msg)
                parsed.names[identifier] = row[1]
                parsed.bodies[identifier] = BodyBuilder(row[1])
                parsed.markers[identifier] = [offsets[k : k + 3] for k in range(0, 3 * count, 3)]
            elif tag not in TAGS:
                msg = f"expected one of {', '.join(TAGS)} in the first cell, found {row[0][:40]!r}"
                raise ValueError(msg)
        except (ValueError, IndexError) as error:
            reason = "the row is cut" if isinstance(error, IndexError) else str(error)
            msg = f"{source.path}:{number}: {reason}; export the take again"
            raise RecordingError(msg) from error
    parsed.flush()
    return parsed


def _rows(source: TextSource) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(source.lines(), start=1):
        if line.strip(source.delimiter + " \t"):
            try:
                row = source.cells(line)
            except csv.Error as error:
                msg = f"{source.path}:{number}: not a line of a CSV file: {error}"
                raise RecordingError(msg) from error
            if source.decimal_comma:
                row = [row[0], *(cell.replace(",", ".") if _looks_decimal(cell) else cell for cell in row[1:])]
            yield number, row


def _looks_decimal(cell: str) -> bool:
    return _DECIMAL_COMMA.fullmatch(cell) is not None


def _integer(text: str) -> int:
    value = _finite(text)
    if abs(value) >= LAST_FRAME or value != int(value):
        msg = f"expected a whole number, found {text[:40]!r}"
        raise ValueError(msg)
    return int(value)


def _finite(text: str) -> float:
    value = parse_number(text)
    if value != value:
        msg = "expected a number, found a blank cell"
        raise ValueError(msg)
    return value


def _parse_frame(parsed: _Parsed, row: list[str]) -> None:
    frame, time_s, count = _integer(row[1]), _finite(row[2]), _integer(row[3])
    if count < 0 or len(row) < 4 + _BODY_CELLS * count:
        raise IndexError
    poses: dict[int, list[float]] = {}
    for k in range(count):
        cells = row[4 + _BODY_CELLS * k : 4 + _BODY_CELLS * (k + 1)]
        identifier = _integer(cells[0])
        if identifier in poses:
            msg = f"body {identifier} appears twice in the frame"
            raise ValueError(msg)
        poses[identifier] = [_finite(cell) for cell in cells[1:8]]
        if identifier not in parsed.bodies:
            parsed.unknown.add(identifier)
    if abs(time_s) > LATEST_TIME_S:
        msg = f"expected a time in seconds, found {time_s:g}"
        raise ValueError(msg)
    parsed.begun = True
    parsed.pending.append(_Frame(frame, time_s, poses))
    if len(parsed.pending) == _BLOCK_FRAMES:
        parsed.flush()


def _validate(source: TextSource, parsed: _Parsed) -> None:
    """Collect all that forbids a safe reading and raise it together."""
    faults = []
    if parsed.left_handed:
        faults.append("left-handed coordinates, in which every rotation is mirrored, are not read")
    if not parsed.begun:
        faults.append("no frame rows")
    if not parsed.names and not parsed.unknown:
        faults.append("no rigid bodies (trackables)")
    unknown = sorted(parsed.unknown)
    if unknown:
        faults.append(
            f"the frames tell of bodies {', '.join(map(str, unknown))} but the definitions of "
            f"{', '.join(map(str, sorted(parsed.names))) or 'none'}, so it is not certain which pose is whose"
        )
    if faults:
        msg = f"{source.path}: {'; '.join(faults)}; export the take again, right-handed and with its rigid bodies"
        raise RecordingError(msg)


def _build(source: TextSource, parsed: _Parsed) -> Recording:
    frame, time_s = parsed.frames.finish(), parsed.times.finish()
    bodies = [
        body.finish(identifier=str(identifier), marker_offsets=np.array(parsed.markers[identifier]).reshape(-1, 3))
        if parsed.markers[identifier]
        else body.finish(identifier=str(identifier))
        for identifier, body in parsed.bodies.items()
    ]
    rate = counted_rate(source.path, frame, time_s)
    warnings = [warning for body in parsed.bodies.values() for warning in body.warnings()]
    warnings += cut_warnings(source, parsed.info.get("framecount", ""), frame.size)
    if not parsed.right_handed:
        message = "the file does not say that its coordinates are right-handed: taken as such"
        warnings.append(QualityWarning(code="handedness", message=message))
    return Recording(
        bodies=tuple(bodies),
        frame=frame,
        time_s=time_s,
        rate_hz=rate,
        source=Source(
            path=str(source.path),
            sha256=source.sha256,
            layout=f"row-tagged {parsed.info.get('version', _OLD_VERSION)}",
            length_unit="m",
            rotation_type="quaternion",
            metadata=parsed.info,
        ),
        warnings=tuple(warnings),
    )
