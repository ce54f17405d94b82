"""Movements and the rests between them, from the swings of the joint."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.motion.movements.boundaries import duration_of, gap_at
from elbowscrew.motion.movements.feet import GAP_SD, LOW_SHARE, Feet, feet_of, moves_at_end, pooled, pooled_feet
from elbowscrew.motion.movements.foot_laws import Distances, Shapes, Sharp, by_shape, shapes_of, sharp_of
from elbowscrew.motion.movements.phases import runs_of
from elbowscrew.motion.movements.swings import Swings

SHORTEST_REST_S: Final = 0.25
"""A stop that lasts less is none."""
IN_DOUBT_SD: Final = 2.0
"""A rest is in doubt within so many standard deviations of the shortest."""
_SLOW_SHARE: Final = 0.1
_LEAST_HELD: Final = float(np.radians(2.0))
_SURE: Final = 6.0


class Strokes(NamedTuple):
    """Movements in one sense, each from a turn or stop to the next; samples, shape (K,) each.

    Attributes
    ----------
    bounds : ndarray of int64, shape (K + 1,)
        Turns and stops between which the strokes lie.
    begin, end : ndarray
        Feet of the stroke; where two strokes overlap there, both at the turn between them.
    begin_sd, end_sd : ndarray
    begin_gap_s, end_gap_s : ndarray, shape (K, 2)
        Begin and end of the gap that the foot lies in, or a crossing that it is told from; seconds, NaN where there is
        none.
    outward : ndarray of bool
        Whether the rotation increases.
    reverses : ndarray of bool, shape (K - 1,)
        Whether the motion turns back between a stroke and the next, or only stops.
    begin_in_doubt, end_in_doubt : ndarray of bool
        Whether the law of motion there, and with it the foot, is in doubt.
    sharp : Sharp
        The rotation in which the shape of the strokes is seen.
    rest_s, rest_sd_s : ndarray, shape (K - 1,)
        Time between a stroke's foot and the next one's, seconds; negative where they overlap.
    """

    bounds: Index
    begin: Float
    end: Float
    begin_sd: Float
    end_sd: Float
    begin_gap_s: Float
    end_gap_s: Float
    begin_in_doubt: Bool
    end_in_doubt: Bool
    sharp: Sharp
    outward: Bool
    reverses: Bool
    rest_s: Float
    rest_sd_s: Float

    @property
    def rests(self) -> Bool:
        """Whether the joint rests between a stroke and the next, shape (K - 1,)."""
        return self.rest_s >= SHORTEST_REST_S

    @property
    def in_doubt(self) -> Bool:
        """Whether that is in doubt, shape (K - 1,)."""
        return np.abs(self.rest_s - SHORTEST_REST_S) < IN_DOUBT_SD * self.rest_sd_s

    def movements(self) -> Index:
        """First and last stroke of every movement between rests, shape (M, 2)."""
        stops = np.flatnonzero(self.rests)
        last = np.append(stops, self.begin.size - 1)
        first = np.append(0, stops + 1)
        return np.column_stack([first, last])[: self.begin.size]


def strokes_of(swings: Swings, gaps: Float) -> Strokes:
    """Part the motion at every turn, and at every stop on the way: speed below a tenth of the stroke's highest.

    The local rule has no part in this: a hesitation that is no cycle is movement all the same. The gaps (G, 2) are in
    seconds (`long_gaps`).
    """
    bounds, values = _with_stops(swings)
    count = max(bounds.size - 1, 0)
    outward = np.diff(values) > 0.0
    if count:
        values = _pooled_levels(values, outward, swings)
    lows, tops = np.where(outward, [bounds[:-1], bounds[1:]], [bounds[1:], bounds[:-1]])
    low_values, top_values = np.where(outward, [values[:-1], values[1:]], [values[1:], values[:-1]])
    feet = feet_of(swings.smooth, lows, tops, low_values, top_values, swings.smooth_noise, swings.cutoff)
    before, after, before_var, after_var = _in_time(feet, outward)
    rises = np.abs(np.diff(values))
    typical = (float(np.median(rises)), float(np.median(before + after))) if count else (0.0, 1.0)
    sharp = sharp_of(swings, *typical)
    first = shapes_of(sharp, bounds[:-1], bounds[1:], values[:-1], values[1:], (feet.half, before))
    last = shapes_of(sharp, bounds[1:], bounds[:-1], values[1:], values[:-1], (feet.half, after))
    begins, ends = _by_shape(before, first, outward), _by_shape(after, last, outward)
    before, after = begins.kappa, ends.kappa
    begin, end = feet.half - before, feet.half + after
    begin_at, end_at = np.where(outward, [feet.low_at, feet.top_at], [feet.top_at, feet.low_at])
    begin_gap_s, end_gap_s = (
        gap_at(np.column_stack([foot, at, feet.half]) / swings.rate_hz, gaps)
        for foot, at in ((begin, begin_at), (end, end_at))
    )
    begin_sd = np.hypot(np.sqrt(before_var + begins.law_var), GAP_SD * duration_of(begin_gap_s) * swings.rate_hz)
    end_sd = np.hypot(np.sqrt(after_var + ends.law_var), GAP_SD * duration_of(end_gap_s) * swings.rate_hz)
    rest_s = (begin[1:] - end[:-1]) / swings.rate_hz
    rest_sd_s = np.hypot(begin_sd[1:], end_sd[:-1]) / swings.rate_hz
    over = rest_s < 0.0
    gap, need = np.diff(feet.half), after[:-1] + before[1:]
    middle = feet.half[:-1] + gap * after[:-1] / np.maximum(need, 1e-12)
    end[:-1][over] = begin[1:][over] = middle[over]
    final = swings.smooth.size - 1
    if count and moves_at_end(swings.smooth, 0, int(bounds[1]), swings.cutoff):
        begin[0] = 0.0
    if count and moves_at_end(swings.smooth, final, int(bounds[-2]), swings.cutoff):
        end[-1] = final
    return Strokes(
        bounds=bounds,
        begin=np.clip(begin, 0.0, swings.smooth.size - 1.0),
        end=np.clip(end, 0.0, swings.smooth.size - 1.0),
        begin_sd=begin_sd,
        end_sd=end_sd,
        begin_gap_s=begin_gap_s,
        end_gap_s=end_gap_s,
        begin_in_doubt=begins.in_doubt,
        end_in_doubt=ends.in_doubt,
        sharp=sharp,
        outward=outward,
        reverses=outward[1:] != outward[:-1],
        rest_s=rest_s,
        rest_sd_s=rest_sd_s,
    )


def _by_shape(kappa: Float, shapes: Shapes, outward: Bool) -> Distances:
    """Distances to the feet of one side, by the shapes of the strokes out and of those back."""
    out, back = by_shape(kappa, shapes, outward), by_shape(kappa, shapes, ~outward)
    return Distances(*(np.where(outward, a, b) for a, b in zip(out, back, strict=True)))


def _in_time(feet: Feet, outward: Bool) -> tuple[Float, Float, Float, Float]:
    """Distances from the half-way crossing to the foot before and after it, pooled among like ones; variances."""
    before, after = np.where(outward, [feet.low, feet.top], [feet.top, feet.low])
    before_var, after_var = np.where(outward, [feet.low_var, feet.top_var], [feet.top_var, feet.low_var])
    for kappa, variance in ((before, before_var), (after, after_var)):
        for kind in (outward, ~outward):
            kappa[kind] = pooled_feet(kappa[kind], variance[kind])
    before_foot, after_foot = np.where(
        outward, [feet.low_foot_var, feet.top_foot_var], [feet.top_foot_var, feet.low_foot_var]
    )
    return before, after, before_foot, after_foot


def _pooled_levels(values: Float, outward: Bool, swings: Swings) -> Float:
    """Tops and lows, each drawn together where they do not differ; stops on the way as they are."""
    variance = (2.0 * swings.smooth_noise) ** 2 + swings.noise**2
    rises_to, falls_to = np.append(not outward[0], outward), np.append(outward[0], ~outward)
    rises_on, falls_on = np.append(outward, not outward[-1]), np.append(~outward, outward[-1])
    levels = values.copy()
    for kind in (rises_to & falls_on, falls_to & rises_on):
        levels[kind] = pooled(values[kind], variance)
    return levels


def _with_stops(swings: Swings) -> tuple[Index, Float]:
    """Turning points and the stops between them: samples and values, shape (K + 1,) each."""
    smooth, reversals = swings.smooth, swings.all_reversals
    if reversals.size < 2:
        return np.empty(0, dtype=np.int64), np.empty(0)
    speed = np.abs(np.gradient(smooth))
    samples, values = [int(reversals[0])], [float(smooth[reversals[0]])]
    for first, last in zip(reversals[:-1].tolist(), reversals[1:].tolist(), strict=True):
        for begin, end in _slow_parts(smooth[first : last + 1], speed[first : last + 1]):
            level = float(np.median(smooth[first + begin : first + end + 1]))
            # A joint that is held rests wherever that is; a short stop counts only well inside the stroke.
            held = end - begin >= SHORTEST_REST_S * swings.rate_hz
            least = min(swings.least, max(_LEAST_HELD, _SURE * swings.smooth_noise)) if held else swings.least
            if min(abs(level - values[-1]), abs(float(smooth[last]) - level)) >= least:
                samples.append(first + (begin + end) // 2)
                values.append(level)
        samples.append(last)
        values.append(float(smooth[last]))
    return np.array(samples, dtype=np.int64), np.array(values)


def _slow_parts(part: Float, speed: Float) -> list[tuple[int, int]]:
    """Samples of a stroke, between 10 and 90 % of its swing, where it hardly moves."""
    share = (part - part[0]) / (part[-1] - part[0])
    inner = np.flatnonzero(share > LOW_SHARE)[0], np.flatnonzero(share < 1.0 - LOW_SHARE)[-1]
    slow = speed < _SLOW_SHARE * speed.max()
    slow[: inner[0]] = slow[inner[1] + 1 :] = False
    first, last = runs_of(slow)
    return list(zip(first.tolist(), last.tolist(), strict=True))
