"""The clock of a recording: evenly by frame number where the file's times allow it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError
from elbowscrew.model import Recording

_TIME_TOLERANCE_FRAMES: Final = 0.5


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
    if (np.diff(frame) > 0).all() and np.ptp(offset) * recording.rate_hz <= 2.0 * _TIME_TOLERANCE_FRAMES:
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
