"""The clock of a recording, evenly by frame number where the file's times allow it, and the rows of frame numbers."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.model import Recording
from elbowscrew.model.clock import time_resolution

_TIME_TOLERANCE_FRAMES: Final = 0.5


def allowed_offset(recording: Recording) -> float:
    """How far times may stray from an even clock in all, seconds: half a frame either way, and their rounding."""
    return 2.0 * _TIME_TOLERANCE_FRAMES / recording.rate_hz + time_resolution(recording.time_s)


def elapsed_time(recording: Recording) -> NDArray[np.float64]:
    """Seconds since the first row, shape (N,), strictly increasing.

    Exports round the time to milliseconds and the row-tagged layout writes when a frame arrived, while the cameras
    run evenly: where frame numbers increase and stay within half a frame of the times, they are the better clock.
    Otherwise (numbers that repeat, a clock of its own) the times are.

    Raises
    ------
    RecordingError
        If neither increases throughout.
    """
    frame, time_s = recording.frame, recording.time_s
    if frame.size < 2:
        return np.zeros(frame.size)
    even: NDArray[np.float64] = (frame - frame[0]) / recording.rate_hz
    offset = (time_s - time_s[0]) - even
    if (np.diff(frame) > 0).all() and np.ptp(offset) <= allowed_offset(recording):
        return even
    if (np.diff(time_s) > 0.0).all():
        since_start: NDArray[np.float64] = time_s - time_s[0]
        return since_start
    row = int(np.flatnonzero(np.diff(time_s) <= 0.0)[0]) + 1
    msg = (
        f"time does not increase at frame {frame[row]} ({time_s[row]:g} s after {time_s[row - 1]:g} s), nor do the "
        "frame numbers give a clock; export the take again, or cut it there"
    )
    raise RecordingError(msg)


def row_of_frame(frame: NDArray[np.int64], wanted: int, option: str) -> int:
    """Row of a frame number.

    Raises
    ------
    SettingError
        If the number is not in the recording or stands there twice.
    """
    rows = np.flatnonzero(frame == wanted)
    if rows.size == 1:
        return int(rows[0])
    if rows.size:
        msg = f"--{option} {wanted}: the frame number stands {rows.size} times in the file; choose another frame"
    else:
        msg = f"--{option} {wanted}: no such frame; the file has frames {frame.min()} to {frame.max()}"
    raise SettingError(msg)
