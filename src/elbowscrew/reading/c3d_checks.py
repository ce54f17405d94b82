"""C3D files that are refused before a library believes what they say of themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from elbowscrew.errors import RecordingError, shown
from elbowscrew.reading.c3d_parameters import BLOCK, DEC, Statements

_UNKNOWN: Final = 0xFFFF
"""What a count of frames is that two bytes do not hold."""
_BYTES_OF_A_ROTATION: Final = 4 * (4 * 4 + 1)
_NEARLY: Final = 1e-4


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where positions stand, by one of the file's two statements: in bytes, but for the counts."""

    start: int
    points: int
    analog: int
    word_bytes: int
    frames: int

    def left_over(self, end: int) -> int:
        """Bytes between the last frame and the end of the points."""
        return end - self.start - self.frames * (4 * self.points + self.analog) * self.word_bytes

    def fits(self, end: int) -> bool:
        """Whether the last frame ends in the last block, or before one that only fills up."""
        return 0 <= self.left_over(end) <= BLOCK


def check_sizes(path: Path, stated: Statements) -> None:
    """Refuse a file that cannot hold what its parameters state, or whose points' places are not certain.

    It ends among them, or they have more values than it has bytes, or fewer frames stand in it. Nothing else is judged
    here: what cannot be followed is left to the reader.

    Raises
    ------
    RecordingError
        If it is so.
    """
    if stated.are_cut:  # the library would go on for seconds
        raise _refused(path, "it ends among its parameters; copy or export the take again")
    values = 0
    for one, _ in stated.entries():
        values += 0 if one is None else one.count
        if one is not None and values > stated.size:
            raise _refused(
                path,
                f"its parameters up to {shown(one.name)} state {values} values, where the whole file has {stated.size} "
                "bytes; export the take again",
            )
    _check_places(path, stated)


def samples_a_frame(stated: Statements) -> int:
    """Analog samples of one channel in a frame, by the two rates.

    The library leaves off what is behind the point, and takes 4.9999999, which is what single precision makes of
    119.88 / 23.976, for 4; see `elbowscrew.reading.c3d_mending.mended`.
    """
    points, analog = stated.number("POINT", "RATE") or stated.rate_hz, stated.number("ANALOG", "RATE")
    if analog is None or not points:
        return 1
    ratio = analog / points
    if not math.isfinite(ratio) or not 0.0 <= ratio <= _UNKNOWN:
        return _UNKNOWN + 1
    return round(ratio) if abs(ratio - round(ratio)) < _NEARLY and stated.processor != DEC else int(ratio)


def _check_places(path: Path, stated: Statements) -> None:
    """Refuse where header and parameters contradict each other and the file's length does not say which is right.

    Points and analog samples of a frame stand together: of one that is not told, all positions behind it are shifted.
    The library takes the first byte and the kind of number from the header, all else from the parameters.
    """
    header = _Layout(
        stated.data_at, stated.word(1), stated.word(2), stated.word_bytes, stated.word(4) - stated.word(3) + 1
    )
    scale = stated.number("POINT", "SCALE")
    if scale is not None and (not math.isfinite(scale) or not scale or (scale < 0.0) != (header.word_bytes == 4)):
        kind = "floats" if header.word_bytes == 4 else "whole numbers"
        raise _refused(path, f"its header tells of {kind}, but POINT:SCALE is {scale:g}; export the take again")
    samples = samples_a_frame(stated)
    if samples > _UNKNOWN:
        raise _refused(path, "POINT:RATE and ANALOG:RATE are no possible rates together; export the take again")
    read = replace(
        header,
        points=stated.whole_number("POINT", "USED"),
        analog=stated.whole_number("ANALOG", "USED") * samples,
        frames=stated.whole_number("POINT", "FRAMES") or header.frames,
    )
    start = BLOCK * (stated.whole_number("POINT", "DATA_START") - 1)
    told = replace(read, start=start if start > 0 else header.start)
    countless = stated.word(4) == _UNKNOWN
    end = _end_of_points(stated)
    if replace(header, frames=0) != replace(told, frames=0):
        others = {one for one in (header, told) if replace(one, frames=0) != replace(read, frames=0)}
        certain = read.fits(end) and not any(one.fits(end) for one in others)
    else:
        certain = countless or header.frames == read.frames or read.fits(end)
    if not certain:
        msg = (
            f"{path}: the header tells of {header.points} points and {header.analog} analog words a frame, the "
            f"parameters of {read.points} and {read.analog}, in {header.frames} and {read.frames} frames from byte "
            f"{header.start} and {told.start}, and the file's length does not fit the latter alone: where a position "
            "stands is not certain; export the take again"
        )
        raise RecordingError(msg)
    if countless and read.frames != _UNKNOWN:  # as many at the least
        return
    missing = -read.left_over(end)
    turning = stated.whole_number("ROTATION", "USED")
    if turning:
        ratio = stated.number("ROTATION", "RATIO")
        if ratio is not None and not 1.0 <= ratio <= _UNKNOWN:
            raise _refused(path, f"ROTATION:RATIO is {ratio:g}, no possible one; export the take again")
        rotations = turning * read.frames * int(ratio or 1)
        missing = max(missing, _rotations_at(stated) + rotations * _BYTES_OF_A_ROTATION - stated.size)
    if missing > 0:
        raise _refused(path, f"it is cut: it states {read.frames} frames, and ends before the last; copy it again")


def _rotations_at(stated: Statements) -> int:
    return BLOCK * (stated.whole_number("ROTATION", "DATA_START") - 1)


def _end_of_points(stated: Statements) -> int:
    at = _rotations_at(stated) if stated.whole_number("ROTATION", "USED") else 0
    return at if stated.data_at < at < stated.size else stated.size


def _refused(path: Path, reason: str) -> RecordingError:
    return RecordingError(f"{path}: not a C3D file that can be read: {reason}")
