"""The clock of a recording: evenly by frame number where the file's times allow it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError
from elbowscrew.model import Recording

_TIME_TOLERANCE_FRAMES: Final = 0.5


def time_resolution(time_s: NDArray[np.float64]) -> float:
    """Seconds in the last decimal of the times: 1, 0.1 or 0.01 where a spreadsheet rounded them, else 0.001."""
    for decimals in range(3):
        if (np.round(time_s, decimals) == time_s).all():
            return float(10.0**-decimals)
    return 1e-3


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
