"""Cycles, movements and rests of a joint, cut where its rotation turns and stops, with their uncertainty."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.motion.movements.feet import (
    LAW_SD,
    LOW_SHARE,
    Feet,
    crossing,
    feet_of,
    foot_scale,
    pooled,
    pooled_feet,
    slope_at,
    unsmoothed,
)
from elbowscrew.motion.movements.rests import IN_DOUBT_SD, SHORTEST_REST_S, Strokes, strokes_of
from elbowscrew.motion.movements.swings import Swings, fast_content, noise_of, swings_of

Reasons = tuple[str, ...]

REASONS: Final[dict[str, str]] = {
    "small-swing": "a swing there is hardly larger than the smallest that counts",
    "small-beside-neighbors": "a turn there is about as small, beside its neighbors, as a hesitation",
    "noise": "the noise hides the foot of the movement",
    "rest-in-doubt": "a stop there lasts about as long as the shortest rest",
    "fast": "the motion has faster parts than its rhythm, which the cuts do not follow",
    "gap": "it lies where there is no pose",
    "no-dominant-axis": "the rotation has no dominant axis",
}
"""Why a boundary is uncertain: codes and words."""

_FEWEST_SAMPLES: Final = 10
_COUNTED_SHARE: Final = 0.25
_COMPLETE_SHARE: Final = 0.9
_LONGEST_GAP_S: Final = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Cycles:
    """Cycles out and back; a value for each of them, times in seconds from the first frame.

    Attributes
    ----------
    start_s, inversion_s, end_s : ndarray, shape (C,)
        Foot of the movement out, middle of the time at the top, foot of the movement back.
    start_sd_s, inversion_sd_s, end_sd_s : ndarray, shape (C,)
        Their standard deviations: noise, and 2 % of the distance to the half-way crossing, as the law is assumed.
    incomplete : ndarray of bool, shape (C,)
        Whether the recording begins or ends on the way: the joint comes less than 90 % of the way there.
    start_reasons, inversion_reasons, end_reasons : tuple of tuple of str
        Why the boundaries are uncertain, codes of `REASONS`; empty if they are not.
    """

    start_s: Float
    inversion_s: Float
    end_s: Float
    start_sd_s: Float
    inversion_sd_s: Float
    end_sd_s: Float
    incomplete: Bool
    start_reasons: tuple[Reasons, ...]
    inversion_reasons: tuple[Reasons, ...]
    end_reasons: tuple[Reasons, ...]

    @property
    def times_s(self) -> Float:
        """Start, inversion and end, shape (C, 3)."""
        return np.column_stack([self.start_s, self.inversion_s, self.end_s])

    @property
    def uncertain(self) -> Bool:
        """Whether start, inversion and end are uncertain, shape (C, 3)."""
        reasons = zip(self.start_reasons, self.inversion_reasons, self.end_reasons, strict=True)
        return np.array([[bool(one) for one in cycle] for cycle in reasons], dtype=np.bool_).reshape(-1, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class Movements:
    """Movements between rests of a quarter of a second and more; seconds from the first frame.

    Attributes
    ----------
    onset_s, offset_s, onset_sd_s, offset_sd_s : ndarray, shape (M,)
    onset_reasons, offset_reasons : tuple of tuple of str
        Why they are uncertain, codes of `REASONS`.
    stroke_begin_s, stroke_end_s : ndarray, shape (K,)
        The strokes that the movements consist of: motion in one sense.
    outward : ndarray of bool, shape (K,)
        Whether a stroke is outward.
    turns : ndarray of bool, shape (K - 1,)
        Whether the motion turns back between a stroke and the next, or only stops.
    """

    onset_s: Float
    offset_s: Float
    onset_sd_s: Float
    offset_sd_s: Float
    onset_reasons: tuple[Reasons, ...]
    offset_reasons: tuple[Reasons, ...]
    stroke_begin_s: Float
    stroke_end_s: Float
    outward: Bool
    turns: Bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Cuts:
    """What a rotation is cut into.

    Attributes
    ----------
    cycles : Cycles
    movements : Movements
    cutoff_hz : float
        Cut-off of the filter that the cuts are found under, by the motion's own rhythm.
    noise : float
        Standard deviation of the rotation's white noise, radians.
    least_swing : float
        Least swing between turns, radians.
    """

    cycles: Cycles
    movements: Movements
    cutoff_hz: float
    noise: float
    least_swing: float

    def rows(self, seconds: Float, elapsed: Float) -> Float:
        """Fractional rows of a recording at such times; whole at its frames.

        Parameters
        ----------
        seconds : ndarray, shape (K,)
            Since the first frame.
        elapsed : ndarray, shape (N,)
            Times of the frames, seconds.
        """
        return np.interp(seconds, elapsed - elapsed[0], np.arange(elapsed.size, dtype=np.float64))


def cut(
    twist: Float,
    elapsed: Float,
    rate_hz: float,
    noise: float | None = None,
    *,
    least_swing: float | None = None,
) -> Cuts:
    """Cut a rotation into movements, rests and cycles.

    Parameters
    ----------
    twist : ndarray, shape (N,)
        Rotation about one direction, unfiltered, continuous, radians; tops are maxima. NaN where there is no pose.
    elapsed : ndarray, shape (N,)
        Seconds, increasing.
    rate_hz : float
        Frames per second.
    noise : float, optional
        Standard deviation of the white noise of the twist, radians; from its third differences if not given.
    least_swing : float, optional
        Swing (rad) that is known to count; by noise, two degrees and a tenth of the range if not given.

    Returns
    -------
    Cuts
        Of no cycle and no movement where fewer than ten frames have a pose.

    Notes
    -----
    Feet are those of minimum-jerk movements with the same times of 10 and 50 % of the rise. Of cycloidal movements,
    whose ends are less gentle, durations come out 2 % short.

    Examples
    --------
    >>> time = np.arange(300) / 100.0
    >>> found = cut(np.radians(40.0) * (1.0 - np.cos(2.0 * np.pi * time / 1.5)), time, 100.0)
    >>> found.cycles.inversion_s.round(2).tolist()
    [0.75, 2.25]
    """
    known = np.flatnonzero(np.isfinite(twist))
    if known.size < _FEWEST_SAMPLES:
        return _cuts_of(None, None, elapsed, known)
    even = _even(twist, elapsed, rate_hz, known)
    sigma = noise_of(twist) if noise is None else noise
    swings = swings_of(even, rate_hz, sigma, least_swing)
    return _cuts_of(swings, strokes_of(swings), elapsed, known)


def _even(twist: Float, elapsed: Float, rate_hz: float, known: NDArray[np.intp]) -> Float:
    """Rotation on an even clock that begins with the recording: gaps by straight lines, ends by the nearest pose."""
    time = elapsed - elapsed[0]
    count = round(float(time[-1]) * rate_hz) + 1
    if count == time.size and np.abs(time * rate_hz - np.arange(count)).max() < 0.05:
        return np.interp(np.arange(count), known, twist[known])
    return np.interp(np.arange(count) / rate_hz, time[known], twist[known])


class _Flanks(NamedTuple):
    """What the cycles are told from: for each top its two flanks and the places of its valleys."""

    tops: Index
    turns: Index
    values: Float
    rising: Feet
    falling: Feet
    out: Float
    back: Float
    brows: Float


def _flanks(swings: Swings, strokes: Strokes) -> _Flanks:
    """Take the tops that count, and the feet of their flanks, pooled where they do not differ."""
    smooth, turns = swings.smooth, swings.turns
    values = smooth[turns].copy()
    tops = _tops(values)
    lows = np.unique(np.concatenate([tops - 1, tops + 1]))
    variance = (2.0 * swings.smooth_noise) ** 2 + swings.noise**2
    raw = values.copy()
    values[tops], values[lows] = pooled(raw[tops], variance), pooled(raw[lows], variance)
    feet = [
        feet_of(smooth, turns[low], turns[tops], values[low], values[tops], swings.smooth_noise, swings.cutoff)
        for low in (tops - 1, tops + 1)
    ]
    rising, out, before = _with_first_strokes(feet[0], turns[tops - 1], turns[tops], strokes)
    falling, back, after = _with_first_strokes(feet[1], turns[tops + 1], turns[tops], strokes)
    return _Flanks(
        tops=tops,
        turns=turns,
        values=values,
        rising=rising,
        falling=falling,
        out=out,
        back=back,
        brows=np.column_stack([before, after]),
    )


def _with_first_strokes(feet: Feet, lows: Index, tops: Index, strokes: Strokes) -> tuple[Feet, Float, Float]:
    """Distances to the feet, pooled; where the joint stops on the way, to the foot of the flank's lowest stroke.

    The last of the three is where the flank's highest stroke has its foot at the top, NaN where there are no stops.
    """
    first = np.searchsorted(strokes.places, np.minimum(lows, tops))
    last = np.searchsorted(strokes.places, np.maximum(lows, tops))
    stops = last - first > 1
    kappa = feet.low.copy()
    kappa[~stops] = pooled_feet(feet.low[~stops], feet.low_var[~stops])
    variance = feet.low_foot_var.copy()
    rises = lows < tops
    lowest = np.where(rises, first, last - 1)[stops]
    foot = np.where(rises[stops], strokes.begin[lowest], strokes.end[lowest])
    kappa[stops] = np.abs(feet.half[stops] - foot)
    variance[stops] = np.where(rises[stops], strokes.begin_sd[lowest], strokes.end_sd[lowest]) ** 2
    highest = np.where(rises, last - 1, first)[stops]
    brow = np.full(kappa.size, np.nan)
    brow[stops] = np.where(rises[stops], strokes.end[highest], strokes.begin[highest])
    return feet._replace(low_foot_var=variance), kappa, brow


def _tops(values: Float) -> Index:
    """Places of the maxima that count: the first and last one if they fall to their outer side by enough."""
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


class _Turn(NamedTuple):
    """End of one cycle and start of the next in the valley between them, samples, with their variances."""

    end: float
    start: float
    end_var: float
    start_var: float


def _valley(flanks: _Flanks, k: int) -> _Turn:
    """Cut the valley between the tops k and k + 1: at both feet, or where the flanks share the time between them."""
    down, up = float(flanks.falling.half[k]), float(flanks.rising.half[k + 1])
    back, out = float(flanks.back[k]), float(flanks.out[k + 1])
    back_var, out_var = _foot_var(flanks.falling, flanks.back, k), _foot_var(flanks.rising, flanks.out, k + 1)
    gap, need = up - down, back + out
    if need <= gap:
        return _Turn(down + back, up - out, back_var, out_var)
    place = down + gap * back / need
    share = back / need
    # place = (1 - share) down + share up, and share itself depends on the two distances
    halves = ((1.0 - share) ** 2) * float(flanks.falling.half_var[k]) + share**2 * float(flanks.rising.half_var[k + 1])
    spread = (gap / need**2) ** 2 * (out**2 * back_var + back**2 * out_var)
    return _Turn(place, place, halves + spread, halves + spread)


def _foot_var(feet: Feet, kappa: Float, k: int) -> float:
    return float(feet.low_foot_var[k] + (LAW_SD * kappa[k]) ** 2)


def _cycle_samples(swings: Swings, flanks: _Flanks) -> tuple[Float, Float]:
    """Start, inversion and end of every cycle in samples, shape (C, 3), and their standard deviations."""
    count = flanks.tops.size
    joined = np.diff(flanks.tops) == 2
    valleys = {k: _valley(flanks, k) for k in np.flatnonzero(joined).tolist()}
    gaps = flanks.rising.half[1:] - flanks.falling.half[:-1]
    needs = flanks.back[:-1] + flanks.out[1:]
    shares = np.minimum(1.0, gaps / np.maximum(needs, 1e-12))[joined]
    usual = float(np.median(shares)) if shares.size else 1.0
    places, variances = np.empty((count, 3)), np.empty((count, 3))
    for k in range(count):
        rise, fall = float(flanks.rising.half[k]), float(flanks.falling.half[k])
        before, after = valleys.get(k - 1), valleys.get(k)
        start = rise - usual * float(flanks.out[k]) if before is None else before.start
        end = fall + usual * float(flanks.back[k]) if after is None else after.end
        start_var = _foot_var(flanks.rising, flanks.out, k) if before is None else before.start_var
        end_var = _foot_var(flanks.falling, flanks.back, k) if after is None else after.end_var
        top, top_var = _inversion(swings, flanks, k)
        places[k] = max(start, 0.0), top, min(end, swings.smooth.size - 1.0)
        variances[k] = start_var, top_var, end_var
    return places, np.sqrt(variances)


def _inversion(swings: Swings, flanks: _Flanks, k: int) -> tuple[float, float]:
    """Middle of the time at the top, between the feet of the two flanks there; its variance."""
    smooth, place = swings.smooth, int(flanks.tops[k])
    top = int(flanks.turns[place])
    rise, fall = float(flanks.rising.half[k]), float(flanks.falling.half[k])
    scale = foot_scale(LOW_SHARE)
    depth = LOW_SHARE * (flanks.values[place] - flanks.values[[place - 1, place + 1]])
    before = crossing(smooth, top, int(rise), float(smooth[top] - depth[0]))
    after = crossing(smooth, top, int(np.ceil(fall)), float(smooth[top] - depth[1]))
    out, out_gain = unsmoothed(scale * (before - rise), swings.cutoff)
    back, back_gain = unsmoothed(scale * (fall - after), swings.cutoff)
    brows = flanks.brows[k].tolist()
    out = brows[0] - rise if np.isfinite(brows[0]) else out
    back = fall - brows[1] if np.isfinite(brows[1]) else back
    # What is unknown of the law, alike on both sides, leaves the middle between them where it is.
    half_vars = float(flanks.rising.half_var[k]), float(flanks.falling.half_var[k])
    variance = 0.25 * LAW_SD**2 * (out - back) ** 2
    for gain, where, half_var in zip((out_gain, back_gain), (before, after), half_vars, strict=True):
        slope = max(slope_at(smooth, where), 1e-12)
        variance += 0.25 * ((gain * scale * swings.smooth_noise / slope) ** 2 + (gain * scale - 1.0) ** 2 * half_var)
    if rise + out <= fall - back:
        return 0.5 * (rise + out + fall - back), variance
    return rise + (fall - rise) * out / max(out + back, 1e-12), variance


def no_cycles() -> Cycles:
    """Give cycles of which there is none."""
    none = np.empty(0)
    return Cycles(
        start_s=none, inversion_s=none, end_s=none, start_sd_s=none, inversion_sd_s=none, end_sd_s=none,
        incomplete=np.empty(0, dtype=np.bool_), start_reasons=(), inversion_reasons=(), end_reasons=(),
    )  # fmt: skip


def _cuts_of(swings: Swings | None, strokes: Strokes | None, elapsed: Float, known: NDArray[np.intp]) -> Cuts:
    if swings is None or strokes is None:
        none = np.empty(0)
        flags = np.empty(0, dtype=np.bool_)
        movements = Movements(
            onset_s=none, offset_s=none, onset_sd_s=none, offset_sd_s=none, onset_reasons=(), offset_reasons=(),
            stroke_begin_s=none, stroke_end_s=none, outward=flags, turns=flags,
        )  # fmt: skip
        return Cuts(cycles=no_cycles(), movements=movements, cutoff_hz=np.nan, noise=np.nan, least_swing=np.nan)
    flanks = _flanks(swings, strokes)
    gaps = _gaps(elapsed, known)
    fast = bool(flanks.tops.size) and fast_content(swings, _median_rise(flanks))
    return Cuts(
        cycles=_cycles(swings, flanks, gaps, fast=fast),
        movements=_movements(strokes, swings.rate_hz, gaps, fast=fast),
        cutoff_hz=swings.cutoff_hz,
        noise=swings.noise,
        least_swing=swings.least,
    )


def _median_rise(flanks: _Flanks) -> float:
    values, tops = flanks.values, flanks.tops
    return float(np.median(values[tops] - np.maximum(values[tops - 1], values[tops + 1])))


def _cycles(swings: Swings, flanks: _Flanks, gaps: Float, *, fast: bool) -> Cycles:
    places, sd = _cycle_samples(swings, flanks)
    seconds, sd = places / swings.rate_hz, sd / swings.rate_hz
    reasons = _cycle_reasons(swings, flanks, seconds, gaps, fast=fast)
    values, tops, last = flanks.values, flanks.tops, flanks.turns.size - 2
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
        start_reasons=reasons[0],
        inversion_reasons=reasons[1],
        end_reasons=reasons[2],
    )


def _cycle_reasons(
    swings: Swings, flanks: _Flanks, seconds: Float, gaps: Float, *, fast: bool
) -> list[tuple[Reasons, ...]]:
    """Why starts, inversions and ends are uncertain, for each cycle."""
    found: list[list[Reasons]] = [[], [], []]
    close = swings.close_removed
    resting = _doubtful_valleys(swings, flanks)
    for k, place in enumerate(flanks.tops.tolist()):
        low, top, high = flanks.turns[place - 1 : place + 2].tolist()
        between = np.searchsorted(close, (low, top, high))
        removed = bool(between[1] > between[0]), bool(between[2] > between[1])
        own = [
            (low, flanks.rising.share[k], resting.get(k - 1, False), removed[0]),
            (top, LOW_SHARE, False, any(removed)),
            (high, flanks.falling.share[k], resting.get(k, False), removed[1]),
        ]
        for which, (turn, share, rest, hesitates) in enumerate(own):
            reasons = {swings.doubtful.get(turn, ""), swings.doubtful.get(top, "")} - {""}
            reasons |= {"small-beside-neighbors"} if hesitates else set()
            reasons |= {"noise"} if share > LOW_SHARE else set()
            reasons |= {"rest-in-doubt"} if rest else set()
            reasons |= {"fast"} if fast else set()
            reasons |= {"gap"} if _in_gap(float(seconds[k, which]), gaps) else set()
            found[which].append(tuple(code for code in REASONS if code in reasons))
    return [tuple(one) for one in found]


def _doubtful_valleys(swings: Swings, flanks: _Flanks) -> dict[int, bool]:
    """Whether it is in doubt that the joint rests between the tops k and k + 1."""
    doubts = {}
    for k in np.flatnonzero(np.diff(flanks.tops) == 2).tolist():
        rest = flanks.rising.half[k + 1] - flanks.falling.half[k] - flanks.back[k] - flanks.out[k + 1]
        variance = _foot_var(flanks.falling, flanks.back, k) + _foot_var(flanks.rising, flanks.out, k + 1)
        doubts[k] = abs(rest - SHORTEST_REST_S * swings.rate_hz) < IN_DOUBT_SD * float(np.sqrt(variance))
    return doubts


def _movements(strokes: Strokes, rate_hz: float, gaps: Float, *, fast: bool) -> Movements:
    parts = strokes.movements()
    first, last = parts.T
    begin, end = strokes.begin / rate_hz, strokes.end / rate_hz
    onset, offset = begin[first], end[last]
    doubt = np.concatenate([[False], strokes.in_doubt, [False]])[: strokes.begin.size + 1]
    # A movement may be two: a rest in doubt inside it makes no boundary uncertain, but one that is told does.
    reasons = [
        tuple(
            tuple(
                code
                for code, holds in (("rest-in-doubt", doubt[side]), ("fast", fast), ("gap", _in_gap(at, gaps)))
                if holds
            )
            for side, at in zip(sides.tolist(), times.tolist(), strict=True)
        )
        for sides, times in ((first, onset), (last + 1, offset))
    ]
    return Movements(
        onset_s=onset,
        offset_s=offset,
        onset_sd_s=strokes.begin_sd[first] / rate_hz,
        offset_sd_s=strokes.end_sd[last] / rate_hz,
        onset_reasons=reasons[0],
        offset_reasons=reasons[1],
        stroke_begin_s=begin,
        stroke_end_s=end,
        outward=strokes.outward,
        turns=strokes.turns,
    )


def _gaps(elapsed: Float, known: NDArray[np.intp]) -> Float:
    """Begin and end of gaps of over a tenth of a second, shape (G, 2), seconds from the first frame."""
    time = elapsed[known] - elapsed[0]
    long = np.flatnonzero(np.diff(time) > _LONGEST_GAP_S)
    long = long[np.diff(known)[long] > 1]
    return np.column_stack([time[long], time[long + 1]])


def _in_gap(second: float, gaps: Float) -> bool:
    k = int(np.searchsorted(gaps[:, 0], second, side="right")) - 1
    return k >= 0 and second < float(gaps[k, 1])
