"""Highest speeds of strokes by local fits: what a filter's overshoot and the noise's own maximum add is told."""

from __future__ import annotations

from functools import cache
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning, Repetitions
from elbowscrew.motion.difference import summed_rotation
from elbowscrew.motion.movements.boundaries import Cycles
from elbowscrew.motion.movements.phases import nearest_rows
from elbowscrew.motion.tracking.inserted import recorded_poses
from elbowscrew.quantities import in_digits

# Widths of the fits, frames to either side: from five poses to most of a stroke.
_LEAST_HALF: Final = 2
_WIDTH_STEP: Final = 1.25
_WIDEST_SHARE: Final = 0.6
# A fit is as good as narrower ones that differ by no more than so many standard deviations; the one taken is some
# steps narrower, so that what it leaves out is less than its noise.
_ALIKE: Final = 2.0
_STEPS_BACK: Final = 2

# Sum of the squared binomials: the variance of a fifth difference of white noise.
_FIFTH_DIFFERENCE: Final = 252.0
_MAD: Final = 0.6745

_MOST_CYCLES: Final = 40
_MOST_ROWS: Final = 400
_TOLD_SHARE: Final = 0.02
_TOLD_SD: Final = 3.0


class PeakSpeed(NamedTuple):
    """Highest speed and its standard deviation, units of the rotation a second."""

    speed: float
    sd: float


def peak_speed(rotation: Float, first: int, last: int, step_s: float, noise: float) -> PeakSpeed | None:
    """Highest speed between two rows of a rotation, by cubic fits to its neighbors.

    Where it is highest is taken from straight fits, whose slope is a mean of speeds and overshoots nowhere. The width
    is the largest at which the cubic fit agrees there with all narrower ones.

    Parameters
    ----------
    rotation : ndarray, shape (N, 3)
        Rotation vectors summed over time.
    first, last : int
        Rows of the stroke; rows beside it are used as well.
    step_s : float
        Seconds from row to row.
    noise : float
        Standard deviation of a component in a row.

    Returns
    -------
    PeakSpeed or None
        None where no fit has its rows.

    References
    ----------
    Lepski 1991, Theory of Probability and its Applications 35 (choice of the width).
    """
    fits: list[tuple[Float, Float, float]] = []
    half = float(_LEAST_HALF)
    while half <= max(_WIDEST_SHARE * (last - first), _LEAST_HALF):
        fit = _fits(rotation, first, last, round(half))
        if fit is None:
            break
        fits.append((fit[0] / step_s, fit[1] / step_s, noise * fit[2] / step_s))
        half = max(_WIDTH_STEP * half, half + 1.0)
    for k in range(len(fits) - 1, -1, -1):
        straight, cubic, sd = fits[k]
        at = int(np.nanargmax(straight))
        differences = np.array([abs(cubic[at] - other[at]) for _, other, _ in fits[:k]])
        allowed = np.array([_ALIKE * np.sqrt(max(more**2 - sd**2, 0.0)) for _, _, more in fits[:k]])
        if not (differences > allowed).any():
            _, taken, taken_sd = fits[max(k - _STEPS_BACK, 0)]
            return PeakSpeed(float(taken[at]), float(np.hypot(taken_sd, 0.5 * abs(cubic[at] - taken[at]))))
    return None


def _fits(rotation: Float, first: int, last: int, half: int) -> tuple[Float, Float, float] | None:
    """Speeds a row by straight and by cubic fits, and the noise of the latter for noise 1; NaN beside what is lost."""
    low, high = max(first - half, 0), min(last + half + 1, len(rotation))
    if high - low < 2 * half + 1:
        return None
    straight, cubic, gain = _weights(half)
    centers = slice(low + half - first, high - half - first)
    speeds = np.full((2, last - first + 1), np.nan)
    for row, weights in zip(speeds, (straight, cubic), strict=True):
        derivative = [np.convolve(one, weights[::-1], mode="valid") for one in rotation[low:high].T]
        row[centers] = length(np.stack(derivative, axis=1))
    if not np.isfinite(speeds).any():
        return None
    return speeds[0], speeds[1], gain


@cache
def _weights(half: int) -> tuple[Float, Float, float]:
    """Weights of neighbors in the slope of a straight and of a cubic fit, and the noise of the latter for noise 1."""
    offset = np.arange(-half, half + 1.0)
    cubic = np.linalg.pinv((offset / half)[:, None] ** np.arange(4))[1] / half
    return offset / (offset @ offset), cubic, float(length(cubic))


def _noise_along(series: Float, first: int, last: int) -> float | None:
    """Noise of a summed rotation (N, 3) along the way from one row to another; None where nothing tells it."""
    wobble, way = np.abs(np.diff(series, 5, axis=0)), series[last] - series[first]
    wobble = wobble[np.isfinite(wobble[:, 0])]
    if not len(wobble) or not way.any():
        return None
    noise = np.median(wobble, axis=0) / _MAD / np.sqrt(_FIFTH_DIFFERENCE)
    return float(length(noise * way) / length(way))


def speed_doubts(quat: Float, elapsed: Float, cycles: Cycles, repetitions: Repetitions) -> tuple[QualityWarning, ...]:
    """Tell of strokes whose highest speed, of filtered poses, differs from that by local fits to the poses themselves.

    Parameters
    ----------
    quat : ndarray, shape (N, 4)
        Rotations as they were recorded.
    elapsed : ndarray, shape (N,)
        Their clock, seconds.
    cycles : Cycles
    repetitions : Repetitions
        With the highest speeds of the same cycles.
    """
    recorded = recorded_poses(quat)
    quat, elapsed = quat[recorded], elapsed[recorded]
    time = elapsed - elapsed[0]
    off: list[tuple[float, float, PeakSpeed]] = []
    chosen = evenly_thinned(np.arange(cycles.start_s.size), _MOST_CYCLES)
    times = np.stack([cycles.start_s, cycles.inversion_s, cycles.end_s], axis=1)[chosen]
    for k, (start, top, end) in zip(chosen.tolist(), nearest_rows(elapsed, times).tolist(), strict=True):
        ways = (repetitions.outward_speed[k], repetitions.back_speed[k])
        before, after = ways if cycles.sense[k] > 0.0 else ways[::-1]  # speeds are empty where there is no sense
        for first, last, told in ((start, top, before), (top, end, after)):
            every = -(-(last - first + 1) // _MOST_ROWS)
            room = last - first
            part = slice(max(first - room, 0), last + room + 1)
            series = summed_rotation(quat[part])[::every]
            if not np.isfinite(told) or last - first < 2 * _LEAST_HALF * every or len(series) < 12:
                continue
            begin = (first - part.start) // every
            noise = _noise_along(series, begin, begin + (last - first) // every)
            if noise is None:
                continue
            step_s = float(np.median(np.diff(time[part]))) * every
            found = peak_speed(series, begin, begin + (last - first) // every, step_s, noise)
            if found is not None and abs(told - found.speed) > max(_TOLD_SHARE * found.speed, _TOLD_SD * found.sd):
                off.append((abs(told / found.speed - 1.0), float(told), found))
    if not off:
        return ()
    share, told, found = max(off, key=lambda one: one[0])
    sd = f" (sd {in_digits(np.degrees(found.sd))})" if np.isfinite(found.sd) else ""
    strokes = "1 stroke" if len(off) == 1 else f"{len(off)} strokes"
    message = (
        f"the highest speed of {strokes} is off by more than {100.0 * _TOLD_SHARE:.0f} %, by {100.0 * share:.0f} % at "
        f"worst: {np.degrees(told):.4g} deg/s by the filter, {np.degrees(found.speed):.4g}{sd} "
        "by a local fit to the poses; a filter overshoots where a motion sets in or turns "
        "at once, smooths what is faster than its cut-off, and leaves the noise below it (--lowpass HZ sets it)"
    )
    return (QualityWarning(code="speeds-off", message=message, count=len(off)),)
