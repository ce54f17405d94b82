"""By which law a movement begins and ends, judged by the shape of its flanks, and where its foot lies by that law.

Minimum jerk is what is expected of people. Beside it stand a cycloidal and a harmonic law, and speeds that rise evenly
over a share of the time and are constant from there on, as those of robots and isokinetic machines: from constant speed
to a third of the time.
"""

from __future__ import annotations

from functools import cache
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.motion.movements.feet import LAW_SD, LOW_SHARE, crossing, minimum_jerk, pooled, slope_at
from elbowscrew.motion.movements.swings import Swings, lowpass_series
from elbowscrew.motion.smoothing.filtering import noise_gain

# The shape is told from the half-way and the quarter crossing and a low one: this share of the rise, or five times the
# noise. What the filter makes of a corner does not matter where it passes five cycles in the time of a stroke.
_QUARTER: Final = 0.25
_LOWEST: Final = 0.02
_HIGHEST: Final = 0.10
_OVER_NOISE: Final = 5.0
_CYCLES_A_STROKE: Final = 5.0
_HIGHEST_HZ_SHARE: Final = 0.2

# A joint rests before a stroke if so many samples lie there; without a rest the level it leaves is off by such a share.
_FEWEST_STILL: Final = 3
_TIP_SHARE: Final = 0.005

# How likely the laws are before the shape is seen, and by how much of itself a true ratio may be off.
_RAMPS: Final = np.linspace(0.0, 0.34, 18)
_PRIOR: Final = np.concatenate([[0.72, 0.10, 0.10, 0.02], np.full(17, 0.03 / 17), [0.03]])
# A mean coverage of 95 % hides that movements of a law that is rarely looked for are covered less: in the spread the
# harmonic one, whose foot lies farthest from that by minimum jerk, has three times its weight.
_SPREAD_WEIGHT: Final = np.concatenate([[1.0, 1.0, 3.0], np.ones(_PRIOR.size - 3)])
_GENTLE: Final = 3
# A flank may follow none of the laws: then any ratio in a wide range is as likely, and its foot lies between theirs.
_ANY_RATIO: Final = 8.0
_ANY_SCALE: Final = 1.2
_ANY_SCALE_SD: Final = 0.12
_SHAPE_SD: Final = 0.01
_ALIKE_SD: Final = 0.05
_OTHER_LAW_SD: Final = 0.035
_IN_DOUBT: Final = 0.05


class Sharp(NamedTuple):
    """The rotation under a filter that leaves the shape of a stroke.

    Attributes
    ----------
    series : ndarray, shape (N,)
        Radians.
    noise : float
        Standard deviation of what the filter left of the noise, radians.
    apart : float
        Samples from one to the next that is independent of it.
    share : float
        Height, as a share of a typical rise, that is clear of the noise.
    """

    series: Float
    noise: float
    apart: float
    share: float


class Shapes(NamedTuple):
    """One side of flanks, low or top, from the half-way crossing on; shape (F,) each, samples; NaN where not seen.

    Attributes
    ----------
    ratio, ratio_var : ndarray
        Time from the half-way crossing to the low one over that to the quarter crossing, and its variance by noise.
    reach, reach_var : ndarray
        The former of the two times.
    share : float
        Height of the low crossing, as a share of the rise.
    """

    ratio: Float
    ratio_var: Float
    reach: Float
    reach_var: Float
    share: float


class Distances(NamedTuple):
    """Distances from half-way crossings to feet, shape (F,): values, variances by the law, and doubts about it."""

    kappa: Float
    law_var: Float
    in_doubt: Bool


def sharp_of(swings: Swings, rise: float, duration: float) -> Sharp:
    """Filter a rotation as little as its noise allows, beside strokes of a rise (rad) and a duration (samples)."""
    least = _CYCLES_A_STROKE / max(duration, 1.0)
    wanted = _LOWEST * rise / _OVER_NOISE
    quiet = 0.5 * (wanted / swings.noise) ** 2 if swings.noise > 0.0 else 1.0
    cutoff_hz = min(max(least, quiet, swings.cutoff), _HIGHEST_HZ_SHARE) * swings.rate_hz
    series = lowpass_series(swings.level, swings.rate_hz, cutoff_hz)
    gain = noise_gain(swings.rate_hz, cutoff_hz)
    noise = swings.noise * float(np.sqrt(gain))
    return Sharp(series, noise, 1.0 / gain, round(max(_LOWEST, _OVER_NOISE * noise / max(rise, 1e-12)), 3))


def shapes_of(
    sharp: Sharp, froms: Index, tos: Index, from_values: Float, to_values: Float, feet: tuple[Float, Float]
) -> Shapes:
    """Shape of flanks on the side of `froms`, whose value they leave for that of `tos`.

    Parameters
    ----------
    sharp : Sharp
    froms, tos : ndarray of int64, shape (F,)
        Samples of the two ends of every flank, in either order in time.
    from_values, to_values : ndarray, shape (F,)
        Radians.
    feet : tuple of ndarray, shape (F,)
        Half-way crossings, and the distances from them to the feet by minimum jerk, samples.
    """
    found = np.full((froms.size, 4), np.nan)
    rows = zip(
        froms.tolist(), tos.tolist(), from_values.tolist(), to_values.tolist(), *(v.tolist() for v in feet), strict=True
    )
    for k, (first, last, base, peak, near, kappa) in enumerate(rows):
        sense = 1.0 if peak > base else -1.0
        rest = _rest_before(first, last, near, kappa)
        still = sharp.series[rest]
        base_sd = sharp.noise * np.sqrt(sharp.apart / max(still.size, 1))
        if still.size >= _FEWEST_STILL:
            base = float(still.mean())
        rise = peak - base
        base_sd = base_sd if still.size >= _FEWEST_STILL else _TIP_SHARE * abs(rise)
        if max(sharp.share, _OVER_NOISE * sharp.noise / max(abs(rise), 1e-12)) > _HIGHEST:
            continue
        low, high = min(first, last), max(first, last)
        flank, offset = sense * sharp.series[low : high + 1], low
        start, stop = first - offset, last - offset
        # From within the upper half, back to where the flank leaves its base.
        inner = round(near + 0.25 * (last - near)) - offset
        times = [crossing(flank, inner, start, sense * (base + level * rise)) for level in (0.5, _QUARTER, sharp.share)]
        if stop == start or not abs(times[0] - times[2]) > abs(times[0] - times[1]) > 0.0:
            continue
        slopes = [max(slope_at(flank, at), 1e-12) for at in times]
        var = [(sharp.noise / slope) ** 2 for slope in slopes]
        var[2] += (base_sd / slopes[2]) ** 2
        reach, quarter = abs(times[0] - times[2]), abs(times[0] - times[1])
        ratio = reach / quarter
        ratio_var = (var[2] + ratio**2 * var[1] + (ratio - 1.0) ** 2 * var[0]) / quarter**2
        found[k] = ratio, ratio_var, reach, var[0] + var[2]
    return Shapes(found[:, 0], found[:, 1], found[:, 2], found[:, 3], sharp.share)


def _rest_before(first: int, last: int, half: float, kappa: float) -> slice:
    """Samples of the rest between a reversal and the foot of the flank that leaves it."""
    if first < last:
        return slice(first, max(int(half - kappa) + 1, first))
    return slice(min(int(np.ceil(half + kappa)), first + 1), first + 1)


def _positions(time: Float) -> Float:
    """Positions of all laws at times from 0 to 1/2, shape (L, T); minimum jerk, cycloidal and harmonic come first."""
    gentle = (
        minimum_jerk(time),
        time - np.sin(2.0 * np.pi * time) / (2.0 * np.pi),
        0.5 - 0.5 * np.cos(np.pi * time),
    )
    ramp = np.maximum(_RAMPS, 1e-9)[:, None]
    ramped = np.where(time < ramp, 0.5 * time**2 / ramp, time - 0.5 * ramp) / (1.0 - ramp)
    return np.concatenate([gentle, ramped])


@cache
def _laws(share: float) -> tuple[Float, Float]:
    """For every law: its ratio, and the distance to its foot over the one to the height `share`."""
    time = np.linspace(0.0, 0.5, 4001)
    levels = np.array([share, _QUARTER])
    low, quarter = np.array([0.5 - np.interp(levels, position, time) for position in _positions(time)]).T
    return low / quarter, 0.5 / low


def by_shape(kappa: Float, shapes: Shapes, alike: Bool) -> Distances:
    """Distances to the feet by what the shape of like flanks says of their law.

    Parameters
    ----------
    kappa : ndarray, shape (F,)
        Distances to the feet by the law of minimum jerk, samples.
    shapes : Shapes
        Of the same side.
    alike : ndarray of bool, shape (F,)
        The flanks that are taken to have one law.

    Notes
    -----
    Each law is weighed by its prior and by how well it explains the ratio, a normal likelihood; ratios of like flanks
    are drawn together where they do not differ. The distance is the weighted median of those of the laws,
    and its variance that of the mixture about it, in which the harmonic law counts three times.
    """
    value, law_var = kappa.copy(), (LAW_SD * kappa) ** 2
    in_doubt = np.zeros(kappa.size, dtype=np.bool_)
    seen = alike & np.isfinite(shapes.ratio)
    gentle = _laws(LOW_SHARE)[1]
    # By gentle laws the foot is told from the height that it is told from by minimum jerk, by others from the low one.
    beside = np.tile(np.append(gentle / gentle[0], _ANY_SCALE / _laws(_LOWEST)[1][0]), (kappa.size, 1))
    weight = np.tile(_PRIOR, (kappa.size, 1))
    if seen.any():
        ratios, scales = _laws(shapes.share)
        ratio, ratio_var = _drawn_together(shapes.ratio, shapes.ratio_var, seen)
        reach, _ = _drawn_together(shapes.reach / kappa, shapes.reach_var / kappa**2, seen)
        beside[:, _GENTLE:] = reach[:, None] * np.append(scales[_GENTLE:], _ANY_SCALE)
        sd = np.sqrt(ratio_var)[:, None]
        likelihood = np.exp(-0.5 * ((ratios - ratio[:, None]) / sd) ** 2) / (sd * np.sqrt(2.0 * np.pi))
        weight *= np.column_stack([likelihood, np.full(kappa.size, 1.0 / _ANY_RATIO)])
        weight /= weight.sum(axis=1, keepdims=True)
    own_sd = np.full(_PRIOR.size, _OTHER_LAW_SD)
    own_sd[[0, -1]] = LAW_SD, _ANY_SCALE_SD
    # The weighted median: that of one law where it has over half of the weight.
    order = np.argsort(beside, axis=1)
    below = np.cumsum(np.take_along_axis(weight, order, axis=1), axis=1) < 0.5
    scale = np.take_along_axis(beside, np.take_along_axis(order, below.sum(axis=1)[:, None], axis=1), axis=1)[:, 0]
    wide = weight * _SPREAD_WEIGHT
    wide /= wide.sum(axis=1, keepdims=True)
    spread = (wide * ((beside - scale[:, None]) ** 2 + (own_sd * beside) ** 2)).sum(axis=1)
    value[alike] *= scale[alike]
    law_var[alike] = (spread * kappa**2)[alike]
    in_doubt[alike] = (spread > (_IN_DOUBT * scale) ** 2)[alike]
    return Distances(value, law_var, in_doubt)


def _drawn_together(values: Float, by_noise: Float, seen: Bool) -> tuple[Float, Float]:
    """Values (F,), those seen drawn to their median as far as they do not differ, the others there; their variances."""
    known, noise = values[seen], float(np.median(by_noise[seen]))
    middle = float(np.median(known))
    drawn, variance = np.full(values.size, middle), np.full(values.size, noise / known.size)
    drawn[seen] = pooled(known, noise + (_ALIKE_SD * middle) ** 2)
    off = float(np.abs(known - middle).max())
    kept = float(np.abs(drawn[seen] - middle).max()) / off if off > 0.0 else 0.0
    variance[seen] += kept**2 * (by_noise[seen] - noise / known.size)
    variance[~seen] += float(np.median(np.abs(known - middle))) ** 2
    return drawn, variance + (_SHAPE_SD * middle) ** 2
