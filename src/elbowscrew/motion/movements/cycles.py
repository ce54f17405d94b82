"""Cycles out and back: their starts, inversions and ends, from the swings of the joint and the feet of its flanks."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.motion.movements.boundaries import REASONS, Cycles, Reasons, duration_of, gap_at
from elbowscrew.motion.movements.feet import (
    GAP_SD,
    HIGHEST_SHARE,
    LAW_SD,
    LOW_SHARE,
    Feet,
    crossing,
    feet_of,
    foot_scale,
    moves_at_end,
    pooled,
    pooled_feet,
    slope_at,
    unsmoothed,
)
from elbowscrew.motion.movements.foot_laws import Distances, Shapes, by_shape, shapes_of
from elbowscrew.motion.movements.rests import IN_DOUBT_SD, SHORTEST_REST_S, Strokes
from elbowscrew.motion.movements.swings import Swings

_COUNTED_SHARE: Final = 0.25
_COMPLETE_SHARE: Final = 0.9


class Flanks(NamedTuple):
    """What the cycles are found from: for each top its two flanks and the samples of its valleys.

    Attributes
    ----------
    tops : ndarray of int64, shape (C,)
        Indices of the tops among the reversals.
    reversals, values : ndarray, shape (T,)
        Samples of the reversals, and the rotation there, radians.
    rising, falling : Feet
        Of the flank before and after each top.
    out, back : Distances
        From their half-way crossings to their feet in the valleys.
    out_var, back_var : ndarray, shape (C,)
        Variances of those feet, by noise and by what is unknown of the law.
    top_feet : ndarray, shape (C, 2)
        Feet of the flanks at the top, where the joint stops on the way; else NaN.
    """

    tops: Index
    reversals: Index
    values: Float
    rising: Feet
    falling: Feet
    out: Distances
    back: Distances
    out_var: Float
    back_var: Float
    top_feet: Float

    @property
    def median_rise(self) -> float:
        """Median rise of the tops over the higher of their two valleys, radians; NaN where there is no top."""
        values, tops = self.values, self.tops
        if not tops.size:
            return float("nan")
        return float(np.median(values[tops] - np.maximum(values[tops - 1], values[tops + 1])))


def flanks_of(swings: Swings, strokes: Strokes) -> Flanks:
    """Take the tops that count, and the feet of their flanks, pooled where they do not differ."""
    smooth, reversals = swings.smooth, swings.reversals
    values = smooth[reversals].copy()
    tops = _tops(values)
    lows = np.unique(np.concatenate([tops - 1, tops + 1]))
    variance = (2.0 * swings.smooth_noise) ** 2 + swings.noise**2
    raw = values.copy()
    values[tops], values[lows] = pooled(raw[tops], variance), pooled(raw[lows], variance)
    feet = [
        feet_of(smooth, reversals[low], reversals[tops], values[low], values[tops], swings.smooth_noise, swings.cutoff)
        for low in (tops - 1, tops + 1)
    ]
    (rising, falling), ends = feet, []
    for flank, low in ((rising, tops - 1), (falling, tops + 1)):
        shapes = shapes_of(
            strokes.sharp, reversals[low], reversals[tops], values[low], values[tops], (flank.half, flank.low)
        )
        ends.append(_with_first_strokes(flank, shapes, reversals[low], reversals[tops], strokes))
    (out, out_var, before), (back, back_var, after) = ends
    return Flanks(
        tops=tops,
        reversals=reversals,
        values=values,
        rising=rising,
        falling=falling,
        out=out,
        back=back,
        out_var=out_var,
        back_var=back_var,
        top_feet=np.column_stack([before, after]),
    )


def _with_first_strokes(
    feet: Feet, shapes: Shapes, lows: Index, tops: Index, strokes: Strokes
) -> tuple[Distances, Float, Float]:
    """Distances to the feet, pooled; where the joint stops on the way, to the foot of the flank's lowest stroke.

    Beside them are the variances of the feet, and where the flank's highest stroke has its foot at the top, NaN where
    there are no stops.
    """
    first = np.searchsorted(strokes.bounds, np.minimum(lows, tops))
    last = np.searchsorted(strokes.bounds, np.maximum(lows, tops))
    stops = last - first > 1
    kappa = feet.low.copy()
    kappa[~stops] = pooled_feet(feet.low[~stops], feet.low_var[~stops])
    distances = by_shape(kappa, shapes, ~stops)
    variance = feet.low_foot_var + distances.law_var
    rises = lows < tops
    lowest = np.where(rises, first, last - 1)[stops]
    foot = np.where(rises[stops], strokes.begin[lowest], strokes.end[lowest])
    distances.kappa[stops] = np.abs(feet.half[stops] - foot)
    variance[stops] = np.where(rises[stops], strokes.begin_sd[lowest], strokes.end_sd[lowest]) ** 2
    doubt = np.where(rises[stops], strokes.begin_in_doubt[lowest], strokes.end_in_doubt[lowest])
    distances.in_doubt[stops] = doubt
    highest = np.where(rises, last - 1, first)[stops]
    top_foot = np.full(kappa.size, np.nan)
    top_foot[stops] = np.where(rises[stops], strokes.end[highest], strokes.begin[highest])
    return distances, variance, top_foot


def cycles_of(swings: Swings, flanks: Flanks, gaps: Float, *, fast: bool) -> Cycles:
    """Cut the cycles, and tell why a cut is uncertain.

    Parameters
    ----------
    swings : Swings
    flanks : Flanks
    gaps : ndarray, shape (G, 2)
        Seconds without a pose, by `long_gaps`.
    fast : bool
        Whether the motion has fast parts that the filter left out.
    """
    samples, sd = _cycle_samples(swings, flanks)
    seconds, sd = samples / swings.rate_hz, sd / swings.rate_hz
    lost_s = _lost_beside(flanks, samples, gaps * swings.rate_hz) / swings.rate_hz
    sd = np.hypot(sd, GAP_SD * lost_s)
    reasons = _cycle_reasons(swings, flanks, lost_s, fast=fast)
    values, tops, last = flanks.values, flanks.tops, flanks.reversals.size - 2
    incomplete = np.zeros(tops.size, dtype=np.bool_)
    if tops.size and tops[0] == 1:
        incomplete[0] |= _outer_share(values, 1, -1) < _COMPLETE_SHARE
    if tops.size and tops[-1] == last:
        incomplete[-1] |= _outer_share(values, last, 1) < _COMPLETE_SHARE
    return Cycles(
        start_s=seconds[:, 0],
        inversion_s=seconds[:, 1],
        end_s=seconds[:, 2],
        start_sd_s=sd[:, 0],
        inversion_sd_s=sd[:, 1],
        end_sd_s=sd[:, 2],
        incomplete=incomplete,
        sense=np.ones(tops.size),
        start_reasons=reasons[0],
        inversion_reasons=reasons[1],
        end_reasons=reasons[2],
    )


def _lost_beside(flanks: Flanks, samples: Float, gaps: Float) -> Float:
    """Gap that starts, inversions and ends (C, 3) lie in, or a crossing that they are told from; samples, 0 if none."""
    start, top, end = samples.T
    rising, falling = flanks.rising, flanks.falling
    lost = np.column_stack(
        [
            duration_of(gap_at(np.column_stack(times), gaps))
            for times in (
                (start, rising.low_at, rising.half),
                (top, rising.half, rising.top_at, falling.top_at, falling.half),
                (end, falling.half, falling.low_at),
            )
        ]
    )
    shared = np.flatnonzero(end[:-1] == start[1:])
    lost[shared, 2] = lost[shared + 1, 0] = np.maximum(lost[shared, 2], lost[shared + 1, 0])
    return lost


def _cycle_reasons(swings: Swings, flanks: Flanks, lost: Float, *, fast: bool) -> list[tuple[Reasons, ...]]:
    """Why starts, inversions and ends are uncertain, for each cycle."""
    found: list[list[Reasons]] = [[], [], []]
    close = swings.close_removed
    resting = _doubtful_valleys(swings, flanks)
    for k, index in enumerate(flanks.tops.tolist()):
        low, top, high = flanks.reversals[index - 1 : index + 2].tolist()
        between = np.searchsorted(close, (low, top, high))
        removed = bool(between[1] > between[0]), bool(between[2] > between[1])
        own = [
            (low, flanks.rising.share[k], resting.get(k - 1, False), removed[0], flanks.out.in_doubt[k]),
            (top, LOW_SHARE, False, any(removed), False),
            (high, flanks.falling.share[k], resting.get(k, False), removed[1], flanks.back.in_doubt[k]),
        ]
        for which, (reversal, share, rest, hesitates, law) in enumerate(own):
            reasons = {swings.doubtful.get(reversal, ""), swings.doubtful.get(top, "")} - {""}
            reasons |= {"small-beside-neighbors"} if hesitates else set()
            reasons |= {"noise"} if share > LOW_SHARE else set()
            reasons |= {"law"} if law else set()
            reasons |= {"rest-in-doubt"} if rest else set()
            reasons |= {"fast"} if fast else set()
            reasons |= {"gap"} if lost[k, which] > 0.0 else set()
            found[which].append(tuple(code for code in REASONS if code in reasons))
    return [tuple(one) for one in found]


def _doubtful_valleys(swings: Swings, flanks: Flanks) -> dict[int, bool]:
    """Whether it is in doubt that the joint rests between the tops k and k + 1."""
    doubts = {}
    for k in np.flatnonzero(np.diff(flanks.tops) == 2).tolist():
        rest = flanks.rising.half[k + 1] - flanks.falling.half[k] - flanks.back.kappa[k] - flanks.out.kappa[k + 1]
        variance = float(flanks.back_var[k]) + float(flanks.out_var[k + 1])
        doubts[k] = abs(rest - SHORTEST_REST_S * swings.rate_hz) < IN_DOUBT_SD * float(np.sqrt(variance))
    return doubts


def _tops(values: Float) -> Index:
    """Indices of the maxima that count: the first and last one if they fall to their outer side by enough."""
    inner = np.arange(1, values.size - 1)
    tops = inner[(values[inner] > values[inner - 1]) & (values[inner] > values[inner + 1])]
    if tops.size and tops[-1] == values.size - 2 and _outer_share(values, tops[-1], 1) < _COUNTED_SHARE:
        tops = tops[:-1]
    if tops.size and tops[0] == 1 and _outer_share(values, 1, -1) < _COUNTED_SHARE:
        tops = tops[1:]
    return tops.astype(np.int64)


def _outer_share(values: Float, top: int, side: int) -> float:
    """Fall of a top to its outer side, as a share of the one to its inner side."""
    return float((values[top] - values[top + side]) / (values[top] - values[top - side]))


class _Valley(NamedTuple):
    """End of one cycle and start of the next in the valley between them, samples, with their variances."""

    end: float
    start: float
    end_var: float
    start_var: float


def _valley(flanks: Flanks, k: int) -> _Valley:
    """Cut the valley between the tops k and k + 1: at both feet, or where the flanks share the time between them."""
    down, up = float(flanks.falling.half[k]), float(flanks.rising.half[k + 1])
    back, out = float(flanks.back.kappa[k]), float(flanks.out.kappa[k + 1])
    back_var, out_var = float(flanks.back_var[k]), float(flanks.out_var[k + 1])
    gap, need = up - down, back + out
    if need <= gap:
        return _Valley(down + back, up - out, back_var, out_var)
    cut = down + gap * back / need
    share = back / need
    # cut = (1 - share) down + share up, and share itself depends on the two distances
    halves = ((1.0 - share) ** 2) * float(flanks.falling.half_var[k]) + share**2 * float(flanks.rising.half_var[k + 1])
    spread = (gap / need**2) ** 2 * (out**2 * back_var + back**2 * out_var)
    return _Valley(cut, cut, halves + spread, halves + spread)


def _cycle_samples(swings: Swings, flanks: Flanks) -> tuple[Float, Float]:
    """Start, inversion and end of every cycle in samples, shape (C, 3), and their standard deviations."""
    count = flanks.tops.size
    joined = np.diff(flanks.tops) == 2
    valleys = {k: _valley(flanks, k) for k in np.flatnonzero(joined).tolist()}
    gaps = flanks.rising.half[1:] - flanks.falling.half[:-1]
    needs = flanks.back.kappa[:-1] + flanks.out.kappa[1:]
    shares = np.minimum(1.0, gaps / np.maximum(needs, 1e-12))[joined]
    usual = float(np.median(shares)) if shares.size else 1.0
    samples, variances = np.empty((count, 3)), np.empty((count, 3))
    for k in range(count):
        rise, fall = float(flanks.rising.half[k]), float(flanks.falling.half[k])
        before, after = valleys.get(k - 1), valleys.get(k)
        start = rise - usual * float(flanks.out.kappa[k]) if before is None else before.start
        end = fall + usual * float(flanks.back.kappa[k]) if after is None else after.end
        start_var = float(flanks.out_var[k]) if before is None else before.start_var
        end_var = float(flanks.back_var[k]) if after is None else after.end_var
        top, top_var = _inversion(swings, flanks, k)
        final = swings.smooth.size - 1
        low, turn, high = flanks.reversals[flanks.tops[k] - 1 : flanks.tops[k] + 2].tolist()
        if low == 0 and moves_at_end(swings.smooth, 0, turn, swings.cutoff):
            start = 0.0
        if high == final and moves_at_end(swings.smooth, final, turn, swings.cutoff):
            end = final
        samples[k] = max(start, 0.0), top, min(end, final)
        variances[k] = start_var, top_var, end_var
    return samples, np.sqrt(variances)


def _inversion(swings: Swings, flanks: Flanks, k: int) -> tuple[float, float]:
    """Middle of the time at the top, between the feet of the two flanks there; its variance."""
    smooth, index = swings.smooth, int(flanks.tops[k])
    top = int(flanks.reversals[index])
    rise, fall = float(flanks.rising.half[k]), float(flanks.falling.half[k])
    rises = flanks.values[index] - flanks.values[[index - 1, index + 1]]
    # From a long top the noise alone may lead down by as much as its largest swing.
    shares = np.minimum(LOW_SHARE + swings.noise_swing / rises, HIGHEST_SHARE)
    scales = [foot_scale(share) for share in shares.tolist()]
    levels = (smooth[top] - shares * rises).tolist()
    before = crossing(smooth, top, int(rise), levels[0])
    after = crossing(smooth, top, int(np.ceil(fall)), levels[1])
    out, out_gain = unsmoothed(scales[0] * (before - rise), swings.cutoff)
    back, back_gain = unsmoothed(scales[1] * (fall - after), swings.cutoff)
    top_feet = flanks.top_feet[k].tolist()
    out = top_feet[0] - rise if np.isfinite(top_feet[0]) else out
    back = fall - top_feet[1] if np.isfinite(top_feet[1]) else back
    # What is unknown of the law, alike on both sides, leaves the middle between them where it is.
    half_vars = float(flanks.rising.half_var[k]), float(flanks.falling.half_var[k])
    variance = 0.25 * LAW_SD**2 * (out - back) ** 2
    gains = out_gain * scales[0], back_gain * scales[1]
    for gain, at, half_var in zip(gains, (before, after), half_vars, strict=True):
        slope = max(slope_at(smooth, at), 1e-12)
        variance += 0.25 * ((gain * swings.smooth_noise / slope) ** 2 + (gain - 1.0) ** 2 * half_var)
    if rise + out <= fall - back:
        return 0.5 * (rise + out + fall - back), variance
    return rise + (fall - rise) * out / max(out + back, 1e-12), variance
