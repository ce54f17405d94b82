"""The clock of a recording, evenly by frame number where the file's times allow it, and the rows of frame numbers."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Recording
from elbowscrew.model.clock import time_resolution

_TIME_TOLERANCE_FRAMES: Final = 0.5
# A clock keeps one rate if the median of so many steps is nowhere off by more than this share.
_RATE_STEPS: Final = 16
_RATE_TOLERANCE: Final = 0.1
_STEPS_BESIDE: Final = 7


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


def other_rate(elapsed: Float, rate_hz: float) -> tuple[float, float] | None:
    """Rate (Hz) that a clock keeps for a while in place of its own, and since when (s); None if it keeps one rate.

    Parameters
    ----------
    elapsed : ndarray, shape (N,)
        Seconds, increasing.
    rate_hz : float
    """
    rates = _rates(elapsed, rate_hz)
    other = np.flatnonzero(np.abs(rate_hz / rates - 1.0) > _RATE_TOLERANCE)
    return (float(rates[other[0]]), float(elapsed[other[0] * _RATE_STEPS])) if other.size else None


def fastest_rate(elapsed: Float, rate_hz: float) -> float:
    """Highest rate (Hz) that a clock keeps for a while; its own where it keeps one."""
    return float(_rates(elapsed, rate_hz).max(initial=rate_hz))


def step_ratios(elapsed: Float, rate_hz: float) -> Float:
    """Steps of a clock over the usual one, shape (N - 1,): well over 1 where frames are missing.

    The usual step is that of the rate or, where the clock has another one for a while, any between that and the medians
    of the steps before and after.

    Parameters
    ----------
    elapsed : ndarray, shape (N,)
        Seconds, increasing.
    rate_hz : float

    Examples
    --------
    >>> two_rates = np.concatenate([np.arange(40) * 0.01, 0.4 + np.arange(40) * 0.02])
    >>> bool(np.allclose(step_ratios(two_rates, 75.0), 1.0))
    True
    """
    steps = np.diff(elapsed)
    if other_rate(elapsed, rate_hz) is None:
        return steps * rate_hz
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(steps, _STEPS_BESIDE, mode="reflect"), _STEPS_BESIDE)
    medians = np.median(windows, axis=1)
    usual = np.stack([np.full(steps.size, 1.0 / rate_hz), medians[: steps.size], medians[_STEPS_BESIDE + 1 :]])
    return steps / np.clip(steps, usual.min(axis=0), usual.max(axis=0))


def _rates(elapsed: Float, rate_hz: float) -> Float:
    """Rates (Hz) of blocks of steps, neither ruled by a hole nor by times that jitter."""
    steps = np.diff(elapsed)
    count = steps.size // _RATE_STEPS
    blocks = steps[: count * _RATE_STEPS].reshape(count, _RATE_STEPS)
    usual = 1.0 / rate_hz
    nearest: Float = np.clip(usual, *np.sort([blocks.mean(axis=1), np.median(blocks, axis=1)], axis=0))
    return 1.0 / nearest


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
