"""Frame numbers, times and rates that a file may have."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning
from elbowscrew.model.clock import time_resolution
from elbowscrew.reading.cells import parse_number
from elbowscrew.reading.source import TextSource

LATEST_TIME_S: Final = 1e10
LAST_FRAME: Final = 2**53
_LOWEST_HZ: Final = 1e-3
_HIGHEST_HZ: Final = 1e6


def check_frames(source: TextSource, line: int, block: Float) -> None:
    """Check the first two columns of a block that begins behind a line.

    Raises
    ------
    RecordingError
        If one is no whole frame number or no time.
    """
    frame, time_s = block[:, 0], block[:, 1]
    bad = ~((np.abs(frame) < LAST_FRAME) & (np.abs(time_s) < LATEST_TIME_S)) | (np.nan_to_num(frame) % 1.0 != 0.0)
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        msg = (
            f"{source.path}:{line + row + 1}: expected a whole frame number and a time, found {frame[row]:g} and "
            f"{time_s[row]:g} (nan is a blank cell); export the take again"
        )
        raise RecordingError(msg)


def is_rate(value: float) -> bool:
    """Whether a number can be a frame rate, in hertz."""
    return _LOWEST_HZ <= value <= _HIGHEST_HZ


def frames_and_times(
    frame: Float | None, time_s: Float | None, rows: range, rate_hz: float | None
) -> NDArray[np.float64]:
    """Give frame numbers and times (n, 2) of rows of a table that may have only one of them.

    Parameters
    ----------
    frame, time_s : ndarray, shape (n,), or None
        As the table has them.
    rows : range
        The rows' own numbers from 0, which are the frames of a table that has none.
    rate_hz : float or None
        Frames a second, where there are no times.
    """
    frames = np.array(rows, dtype=np.float64) if frame is None else frame
    return np.stack([frames, frames / (rate_hz or np.nan) if time_s is None else time_s], axis=1)


def rate_of(frame: NDArray[np.int64], time_s: Float) -> float:
    """Frames a second from the first row to the last; NaN if the times do not increase so."""
    frames, span = float(frame[-1] - frame[0]), float(time_s[-1] - time_s[0])
    # A span that no rate fits would divide to more than there are numbers.
    return frames / span if span * _HIGHEST_HZ >= 1.0 else float("nan")


def counted_rate(path: Path, frame: NDArray[np.int64], time_s: Float) -> float:
    """Frames a second, of a file that states no rate.

    Raises
    ------
    RecordingError
        If frame numbers and times do not give a possible one.
    """
    rate = rate_of(frame, time_s)
    if not is_rate(rate):
        msg = f"{path}: frame numbers and times do not increase from the first to the last row as a clock does"
        raise RecordingError(msg)
    return rate


def stated_rate(text: str) -> float:
    """Frames a second as a file's text has them, with a comma or a point; NaN if it is no number."""
    try:
        return parse_number(text.replace(",", "."))
    except ValueError:
        return float("nan")


def rate_and_times(
    path: Path, stated: str, frame: NDArray[np.int64], time_s: Float
) -> tuple[float, Float, list[QualityWarning]]:
    """Frames a second as a file states them, unless its times say otherwise, with a warning then; and its times.

    Times that go on a thousand times as far as the stated rate has it are in milliseconds; seconds are given.

    Raises
    ------
    RecordingError
        If neither gives a possible rate.
    """
    rate = stated_rate(stated)
    counted = rate_of(frame, time_s)
    if not is_rate(counted):
        if not is_rate(rate):
            msg = f"{path}: neither the header nor the times give a possible frame rate; export the take again"
            raise RecordingError(msg)
        return rate, time_s, []
    # A time rounded at either end is no disagreement.
    rounding_s = 2.0 * max(time_resolution(time_s), 1e-3)
    if is_rate(rate) and abs(counted - rate) <= rate * (0.01 + rounding_s / (time_s[-1] - time_s[0])):
        return rate, time_s, []
    if is_rate(rate) and abs(1000.0 * counted - rate) <= 0.01 * rate:
        message = (
            f"its times go on by {(time_s[-1] - time_s[0]) / (frame[-1] - frame[0]):.4g} a frame, at {rate:g} frames a "
            "second as the header states: they are taken as milliseconds"
        )
        return rate, 1e-3 * time_s, [QualityWarning(code="times-in-milliseconds", message=message)]
    if np.isfinite(rate):
        message = f"the header states {rate:g} frames a second, the times give {counted:.4g}: the latter is used"
        return counted, time_s, [QualityWarning(code="frame-rate", message=message)]
    return counted, time_s, []


def cut_warnings(source: TextSource, stated: str, rows: int) -> list[QualityWarning]:
    """Warnings of a file that may have been cut: by its own count of frames, and by its last line."""
    found = []
    if stated.isdecimal() and float(stated) != rows:
        message = f"the file states {stated[:20]} frames and has {rows}"
        found.append(QualityWarning(code="frame-count", message=message))
    if not source.ends_with_newline:
        message = "the last line has no line end: the file, and with it the last number, may have been cut"
        found.append(QualityWarning(code="no-final-newline", message=message))
    return found


def numbered(what: str) -> tuple[QualityWarning]:
    """Say that a file, called so, has times alone."""
    message = f"{what} has no frame numbers: its rows are numbered from 0"
    return (QualityWarning(code="frames-numbered", message=message, severity="note"),)
