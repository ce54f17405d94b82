"""Where a movement begins and ends: its half-way crossing, and from there back to the foot of a minimum-jerk law."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float, Index

# The foot is told from the height of 10 % of the rise, or from five times the noise, but from 30 % at most.
LOW_SHARE: Final = 0.1
HIGHEST_SHARE: Final = 0.3
_OVER_NOISE: Final = 5.0
# The filter stills the ends of the record: whether the joint moves there is seen over so many periods of its cut-off.
_PERIODS_AT_AN_END: Final = 0.75

_LAW_TIME: Final = np.linspace(0.0, 1.0, 2001)


def minimum_jerk(time: Float) -> Float:
    """Position of the law of minimum jerk at times from 0 to 1 (Flash and Hogan 1985)."""
    return 10.0 * time**3 - 15.0 * time**4 + 6.0 * time**5


_LAW: Final = minimum_jerk(_LAW_TIME)

# What the filter makes of an isolated minimum-jerk stroke: its kappa, as told from 10 % of the rise between the least
# and the largest value, and the true one, both times the cut-off; longer ones it leaves as they are.
# `tests/motion/movements/test_cuts.py` finds them again.
_TOLD: Final = np.array([0.4703, 0.5250, 0.5913, 0.6672, 0.7500, 0.8380, 0.9294, 1.0232, 1.2151, 1.4105, 1.6076, 4.0])
_TRUE: Final = np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.6, 4.0])

LAW_SD: Final = 0.015
"""Uncertainty of the distance from the half-way crossing to a foot by minimum jerk, as a share of it."""
GAP_SD: Final = 0.5
"""Uncertainty of a foot that is told from a height in a gap, as a share of the gap."""
KIN_SD: Final = 0.02
"""Flanks whose feet differ by less than this share of their length are taken for the same movement."""
_POOLED: Final = 3.0
_LEAST_SLOPE: Final = 1e-12


class Feet(NamedTuple):
    """Flanks between turning points; times in samples, each of shape (F,).

    Attributes
    ----------
    half : ndarray
        Half-way crossing, the one nearest the top.
    low, top : ndarray
        Distance ``kappa`` from there to the foot at the low and to the one at the top; positive.
    half_var, low_var, top_var : ndarray
        Variances of the three by the noise alone.
    low_foot_var, top_foot_var : ndarray
        Variances of the feet themselves: an error of the half-way crossing moves its distance to the foot, too.
    low_at, top_at : ndarray
        Crossings that the distances to the two feet are told from, beside the half-way one.
    share : ndarray
        Height, as a share of the rise, that the feet are told from; over 10 % the noise has decided.
    """

    half: Float
    low: Float
    top: Float
    half_var: Float
    low_var: Float
    top_var: Float
    low_foot_var: Float
    top_foot_var: Float
    low_at: Float
    top_at: Float
    share: Float


def feet_of(
    smooth: Float, lows: Index, tops: Index, low_values: Float, top_values: Float, noise: float, cutoff: float
) -> Feet:
    """Feet of flanks by the law of minimum jerk: ``kappa = 0.5/(0.5 - X(l)) |t50 - t_l|``, X the law's inverse.

    Parameters
    ----------
    smooth : ndarray, shape (N,)
        Filtered rotation, radians.
    lows, tops : ndarray of int64, shape (F,)
        Samples of the two ends of every flank, in either order in time.
    low_values, top_values : ndarray, shape (F,)
        What the flank leads from and to, radians.
    noise : float
        Standard deviation of a sample of `smooth`, radians.
    cutoff : float
        Of the filter that the rotation has gone through, cycles a sample.

    References
    ----------
    Flash and Hogan 1985, Journal of Neuroscience 5 (minimum jerk).
    """
    found = np.empty((lows.size, 11))
    ends = zip(lows.tolist(), tops.tolist(), low_values.tolist(), top_values.tolist(), strict=True)
    for k, (low, top, base, peak) in enumerate(ends):
        rise = max(peak - base, _LEAST_SLOPE)
        share = min(max(LOW_SHARE, _OVER_NOISE * noise / rise), HIGHEST_SHARE)
        half = crossing(smooth, top, low, base + 0.5 * rise)
        inner = int(half) if low < top else int(np.ceil(half))
        foot = crossing(smooth, inner, low, base + share * rise)
        outer = int(np.ceil(half)) if low < top else int(half)
        shoulder = crossing(smooth, outer, top, peak - share * rise, rising=True)
        scale = foot_scale(share)
        variances = [(noise / max(slope_at(smooth, at), _LEAST_SLOPE)) ** 2 for at in (half, foot, shoulder)]
        low_kappa, low_gain = unsmoothed(scale * abs(half - foot), cutoff)
        top_kappa, top_gain = unsmoothed(scale * abs(shoulder - half), cutoff)
        found[k] = (
            half,
            low_kappa,
            top_kappa,
            variances[0],
            (low_gain * scale) ** 2 * (variances[0] + variances[1]),
            (top_gain * scale) ** 2 * (variances[0] + variances[2]),
            (low_gain * scale - 1.0) ** 2 * variances[0] + (low_gain * scale) ** 2 * variances[1],
            (top_gain * scale - 1.0) ** 2 * variances[0] + (top_gain * scale) ** 2 * variances[2],
            foot,
            shoulder,
            share,
        )
    return Feet(*found.T)


def unsmoothed(kappa: float, cutoff: float) -> tuple[float, float]:
    """Distance to the foot before the filter made the stroke longer, and how much it changes with the one given.

    Examples
    --------
    >>> kappa, _ = unsmoothed(0.75 / 0.02, 0.02)
    >>> round(0.02 * kappa, 4)
    0.7
    """
    told = kappa * cutoff
    if told >= _TOLD[-1]:
        return kappa, 1.0
    if told <= _TOLD[0]:
        return kappa * float(_TRUE[0] / _TOLD[0]), float(_TRUE[0] / _TOLD[0])
    k = min(int(_TOLD.searchsorted(told)), _TOLD.size - 1)
    gain = float((_TRUE[k] - _TRUE[k - 1]) / (_TOLD[k] - _TOLD[k - 1]))
    return (float(_TRUE[k - 1]) + gain * (told - float(_TOLD[k - 1]))) / cutoff, gain


def foot_scale(share: float) -> float:
    """``0.5/(0.5 - X(share))``: by how much the distance to the foot is more than the one to a height."""
    return 0.5 / (0.5 - float(np.interp(share, _LAW, _LAW_TIME)))


def crossing(series: Float, start: int, stop: int, level: float, *, rising: bool = False) -> float:
    """Fractional sample where a series, followed from one sample to another, first falls (or rises) to a level."""
    step = 1 if stop >= start else -1
    part = series[start : stop + 1] if step > 0 else series[stop : start + 1][::-1]
    below = part >= level if rising else part <= level
    k = int(np.argmax(below)) if part.size else 0
    if not part.size or not below[k]:
        return float(stop)
    if k == 0:
        return float(start)
    return float(start + step * (k - 1 + (part[k - 1] - level) / (part[k - 1] - part[k])))


def moves_at_end(smooth: Float, end: int, inner: int, cutoff: float) -> bool:
    """Whether the joint moves at an end of the record, at half of the highest speed from there to a reversal.

    The cut-off of the filter is in cycles a sample.
    """
    series = smooth[end : inner + 1] if inner > end else smooth[inner : end + 1][::-1]
    speed, span = np.abs(np.diff(series)), int(np.ceil(_PERIODS_AT_AN_END / cutoff))
    return bool(speed.size > span and speed[:span].mean() >= 0.5 * speed.max() > 0.0)


def slope_at(series: Float, sample: float) -> float:
    """Slope of a series at a fractional sample, over one sample about it, without its sign."""
    high = _at(series, sample + 0.5)
    return abs(high - _at(series, sample - 0.5))


def pooled(values: Float, variance: float) -> Float:
    """Draw values to their median, as far as their differences are no more than their variance explains.

    Parameters
    ----------
    values : ndarray, shape (K,)
        Fewer than three stay as they are.
    variance : float
        Of one value, by its noise.

    References
    ----------
    James and Stein 1961; here ``m + max(0, 1 - 3 variance/var) (x - m)`` about the median m.
    """
    if values.size < 3:
        return values
    middle = float(np.median(values))
    spread = float(np.sum((values - middle) ** 2)) / (values.size - 1)
    kept = max(0.0, 1.0 - _POOLED * variance / spread) if spread > 0.0 else 0.0
    drawn: Float = middle + kept * (values - middle)
    return drawn


def pooled_feet(kappa: Float, variance: Float) -> Float:
    """Distances to the feet of like flanks (F,), pooled where they do not differ."""
    if kappa.size < 3:
        return kappa
    return pooled(kappa, float(np.median(variance)) + (KIN_SD * float(np.median(kappa))) ** 2)


def _at(series: Float, sample: float) -> float:
    k = min(max(int(sample), 0), series.size - 2)
    return float(series[k] + (sample - k) * (series[k + 1] - series[k]))
