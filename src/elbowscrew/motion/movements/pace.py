"""The filter under the cuts: as the rhythm of the motion allows, but no slower than its shortest stroke."""

from __future__ import annotations

import itertools
from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.feet import LOW_SHARE, foot_scale
from elbowscrew.motion.movements.swings import Swings, largest_noise_swing, swings_of

# The filter passes so many cycles in the time of every stroke. Fewer of them make a stroke longer, and its neighbors
# begin and end elsewhere: a stroke out in 0.2 s and back in 1.2 s was cut 50 ms off.
_CYCLES_A_STROKE: Final = 2.0
_HIGHEST_SHARE: Final = 0.2
# As much of the least swing as the noise may make under a faster filter.
_NOISE_SHARE: Final = 0.5
_NO_MORE: Final = 1.02
_ROUNDS: Final = 6
_STEP: Final = 0.9


def paced_swings_of(
    twist: Float, rate_hz: float, noise: float | None = None, least_swing: float | None = None
) -> Swings:
    """Smooth a rotation and find where it turns, under a filter that its shortest stroke passes.

    Parameters
    ----------
    twist : ndarray, shape (N,)
    rate_hz : float
    noise, least_swing : float, optional
        As `swings_of` has them. The filter is made no faster than keeps the noise well below the least swing.
    """
    swings = swings_of(twist, rate_hz, noise, least_swing)
    for _ in range(_ROUNDS):
        wanted = _passing_all(swings)
        if wanted <= _NO_MORE * swings.cutoff_hz:
            break
        swings = swings_of(twist, rate_hz, swings.noise, least_swing, wanted)
    return swings


def _passing_all(swings: Swings) -> float:
    """Cut-off (Hz) that the shortest stroke wants, as far as rate and noise allow it."""
    rate_hz, count = swings.rate_hz, swings.level.size
    wanted = min(_CYCLES_A_STROKE * rate_hz / _shortest_stroke(swings), _HIGHEST_SHARE * rate_hz)
    most = _NOISE_SHARE * swings.least
    while wanted > swings.cutoff_hz and largest_noise_swing(swings.noise, count, rate_hz, wanted) > most:
        wanted *= _STEP
    return wanted


def _shortest_stroke(swings: Swings) -> float:
    """Duration (samples) of the shortest stroke between two turns, from 10 to 90 % of it by minimum jerk."""
    turns = swings.reversals.tolist()
    shortest = np.inf
    for first, last in itertools.pairwise(turns):
        share = (swings.smooth[first : last + 1] - swings.smooth[first]) / (swings.smooth[last] - swings.smooth[first])
        low, high = int(np.argmax(share > LOW_SHARE)), int(np.flatnonzero(share < 1.0 - LOW_SHARE)[-1])
        shortest = min(shortest, max(high - low, 1))
    return foot_scale(LOW_SHARE) * shortest
