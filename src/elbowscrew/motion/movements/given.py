"""Cycles whose times somebody else knows: where they turn, and what is no cycle."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.boundaries import Cycles
from elbowscrew.motion.movements.pace import paced_swings_of

# Times that differ by less are the same: they may have been written with six decimals.
_SAME_S: Final = 1e-6
_FEWEST_FRAMES: Final = 10


def given_cycles(times: Float, first_s: float, course: Float, elapsed: Float, rate_hz: float) -> Cycles:
    """Take cycles between times that were given; each turns where it is farthest from its own start and end.

    Parameters
    ----------
    times : ndarray, shape (C, 2)
        Starts and ends, in the recording's own time.
    first_s : float
        That time at the first frame.
    course : ndarray, shape (N,)
        Rotation that is cut, radians; NaN without a pose.
    elapsed : ndarray, shape (N,)
        Seconds since the first frame.
    rate_hz : float

    Returns
    -------
    Cycles
        Without a sense where the noise may make as large a swing.

    Raises
    ------
    SettingError
        If a cycle does not lie in the recording, not after the one before it, or has fewer than ten frames.
    """
    span, before = float(elapsed[-1] - elapsed[0]), 0.0
    for start, end in (times - first_s).tolist():
        called = f"--cycles: a cycle from {start + first_s:g} to {end + first_s:g} s"
        if not before - _SAME_S <= start < end <= span + _SAME_S:
            msg = f"{called}; expected one after the other, within the recording's {first_s:g} to {span + first_s:g} s"
            raise SettingError(msg)
        frames = round((end - start) * rate_hz)
        if frames < _FEWEST_FRAMES:
            msg = f"{called}; expected {_FEWEST_FRAMES} frames or more, found {frames} at {rate_hz:g} a second"
            raise SettingError(msg)
        before = end
    known = np.flatnonzero(np.isfinite(course))
    even = np.arange(round(span * rate_hz) + 1) / rate_hz
    swings = paced_swings_of(np.interp(even, elapsed[known] - elapsed[0], course[known]), rate_hz)
    turns, senses = np.empty(len(times)), np.zeros(len(times))
    for k, (start, end) in enumerate((times - first_s).tolist()):
        inside = slice(int(np.searchsorted(even, start)), int(np.searchsorted(even, end, side="right")))
        angle = swings.smooth[inside]
        off = angle - np.linspace(angle[0], angle[-1], angle.size)
        turn = int(np.argmax(np.abs(off)))
        turns[k] = even[inside][turn]
        senses[k] = np.sign(off[turn]) if abs(off[turn]) >= swings.noise_swing else 0.0
    none, unknown = ((),) * len(times), np.full(len(times), np.nan)
    return Cycles(
        start_s=times[:, 0] - first_s,
        inversion_s=turns,
        end_s=times[:, 1] - first_s,
        start_sd_s=unknown,
        inversion_sd_s=unknown,
        end_sd_s=unknown,
        incomplete=np.zeros(len(times), dtype=np.bool_),
        sense=senses,
        start_reasons=none,
        inversion_reasons=none,
        end_reasons=none,
    )
