"""Cycles, movements and rests of a joint, cut where its rotation turns and stops, with their uncertainty."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.boundaries import (
    Cuts,
    Cycles,
    Movements,
    duration_of,
    long_gaps,
    no_cycles,
    no_movements,
)
from elbowscrew.motion.movements.cycles import Flanks, cycles_of, flanks_of
from elbowscrew.motion.movements.pace import paced_swings_of
from elbowscrew.motion.movements.rests import Strokes, strokes_of
from elbowscrew.motion.movements.swings import fast_content, noise_of
from elbowscrew.motion.movements.unseen import hidden_stretches
from elbowscrew.motion.tracking.inserted import recorded_rows

_FEWEST_SAMPLES: Final = 10


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
    Feet are told from the times of 10 and 50 % of the rise, by the law of minimum jerk, unless the shape of the flanks
    speaks for another law (`foot_laws`): cycloidal, harmonic, or speed that is constant but for ramps.

    Examples
    --------
    >>> time = np.arange(300) / 100.0
    >>> found = cut(np.radians(40.0) * (1.0 - np.cos(2.0 * np.pi * time / 1.5)), time, 100.0)
    >>> found.cycles.inversion_s.round(2).tolist()
    [0.75, 2.25]
    """
    known = np.flatnonzero(np.isfinite(twist))
    if known.size < _FEWEST_SAMPLES:
        return Cuts(
            cycles=no_cycles(),
            movements=no_movements(),
            cutoff_hz=np.nan,
            noise=np.nan,
            least_swing=np.nan,
            excursion=np.nan,
            small=np.empty(0),
            hidden_s=np.empty((0, 2)),
        )
    even = _even(twist, elapsed, rate_hz, known)
    sigma = _white_noise(twist) if noise is None else noise
    swings = paced_swings_of(even, rate_hz, sigma, least_swing)
    gaps = long_gaps(elapsed, known)
    strokes = strokes_of(swings, gaps)
    flanks = flanks_of(swings, strokes)
    fast = bool(flanks.tops.size) and fast_content(swings, flanks.median_rise)
    cycles = cycles_of(swings, flanks, gaps, fast=fast)
    spans = np.column_stack([cycles.start_s, cycles.end_s])
    hidden = hidden_stretches(twist, elapsed - elapsed[0], swings.least, spans)
    lost = (hidden[:, 0, None] < spans[:, 1]) & (hidden[:, 1, None] > spans[:, 0])
    return Cuts(
        cycles=replace(cycles, incomplete=cycles.incomplete | lost.any(axis=0)),
        movements=_movements(strokes, swings.rate_hz, _turns(strokes, flanks, cycles, swings.rate_hz), fast=fast),
        cutoff_hz=swings.cutoff_hz,
        noise=swings.noise,
        least_swing=swings.least,
        excursion=float(np.ptp(swings.smooth)),
        small=swings.small_rad,
        hidden_s=hidden,
    )


def _white_noise(twist: Float) -> float:
    """Noise of a rotation (N,), radians: where frames were put in between, the white noise that is as dense below."""
    recorded = recorded_rows(twist[:, None])
    return noise_of(twist[recorded]) * float(np.sqrt(recorded.step))


def _even(twist: Float, elapsed: Float, rate_hz: float, known: NDArray[np.intp]) -> Float:
    """Rotation on an even clock that begins with the recording: gaps by straight lines, ends by the nearest pose."""
    time = elapsed - elapsed[0]
    count = round(float(time[-1]) * rate_hz) + 1
    if count == time.size and np.abs(time * rate_hz - np.arange(count)).max() < 0.05:
        return np.interp(np.arange(count), known, twist[known])
    return np.interp(np.arange(count) / rate_hz, time[known], twist[known])


def _turns(strokes: Strokes, flanks: Flanks, cycles: Cycles, rate_hz: float) -> Float:
    """Times between strokes (K - 1,): those of the cycles' inversions and of the cuts between them, where these are."""
    turns = 0.5 * (strokes.end[:-1] + strokes.begin[1:]) / rate_hz
    joined = np.flatnonzero(np.diff(flanks.tops) == 2)
    cuts = 0.5 * (cycles.end_s[joined] + cycles.start_s[joined + 1])
    samples = flanks.reversals[np.concatenate([flanks.tops, flanks.tops[joined] + 1])]
    at = np.searchsorted(strokes.bounds[1:-1], samples)
    turns[at] = np.concatenate([cycles.inversion_s, cuts])
    return turns


def _movements(strokes: Strokes, rate_hz: float, turns: Float, *, fast: bool) -> Movements:
    parts = strokes.movements()
    first, last = parts.T
    begin, end = strokes.begin / rate_hz, strokes.end / rate_hz
    onset, offset = begin[first], end[last]
    doubt = np.concatenate([[False], strokes.in_doubt, [False]])[: strokes.begin.size + 1]
    law = strokes.begin_in_doubt[first], strokes.end_in_doubt[last]
    # A movement may be two: a rest in doubt inside it makes no boundary uncertain, but one that is told does.
    reasons = [
        tuple(
            tuple(
                code
                for code, holds in (
                    ("law", other),
                    ("rest-in-doubt", doubt[side]),
                    ("fast", fast),
                    ("gap", gap > 0.0),
                )
                if holds
            )
            for side, gap, other in zip(sides.tolist(), lost_s.tolist(), laws.tolist(), strict=True)
        )
        for sides, lost_s, laws in (
            (first, duration_of(strokes.begin_gap_s[first]), law[0]),
            (last + 1, duration_of(strokes.end_gap_s[last]), law[1]),
        )
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
        stroke_begin_sd_s=strokes.begin_sd / rate_hz,
        stroke_end_sd_s=strokes.end_sd / rate_hz,
        stroke_begin_gap_s=strokes.begin_gap_s,
        stroke_end_gap_s=strokes.end_gap_s,
        outward=strokes.outward,
        reverses=strokes.reverses,
        turn_s=turns,
    )
