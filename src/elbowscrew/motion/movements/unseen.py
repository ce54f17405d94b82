"""What a motion may do where there is no pose: how far it may go in a gap, by its speeds at the gap's two ends."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float, Index

_SLOPE_FRAMES: Final = 5
_SLOPE_S: Final = 0.05
LONGEST_GAP_S: Final = 0.1
"""Shorter gaps hide nothing that counts."""
_CYCLE_SHARE: Final = 0.8


class Gaps(NamedTuple):
    """Stretches without a pose between two that are known, shape (G,) each.

    Attributes
    ----------
    before, after : ndarray of int64
        Rows of the poses beside the gap.
    before_slope, after_slope : ndarray
        Change a second of the series there.
    highest, lowest : ndarray
        How far the series goes in between if it is slowed down evenly: half-way from the higher, or lower, end to where
        the tangents at the two ends meet.
    highest_tip, lowest_tip : ndarray
        Where these meet, or the higher and the lower end: farther it does not go if it only slows down.
    """

    before: Index
    after: Index
    before_slope: Float
    after_slope: Float
    highest: Float
    lowest: Float
    highest_tip: Float
    lowest_tip: Float


def gaps_of(series: Float, time: Float, longer_s: float = 0.0) -> Gaps:
    """Find the gaps of a series (N,), NaN where it is not known, over times (N,) in seconds; those longer than that."""
    known = np.flatnonzero(np.isfinite(series))
    at = np.flatnonzero((np.diff(known) > 1) & (np.diff(time[known]) > longer_s))
    before, after = known[at], known[at + 1]
    slopes = np.zeros((2, at.size))
    for k, place in enumerate(at.tolist()):
        slopes[0, k] = _slope(series, time, known, place, -1)
        slopes[1, k] = _slope(series, time, known, place + 1, 1)
    low, high = np.sort([series[before], series[after]], axis=0)
    span = time[after] - time[before]
    turn = slopes[0] - slopes[1]
    meets = np.divide(series[after] - series[before] - slopes[1] * span, turn, out=np.zeros(at.size), where=turn != 0.0)
    tip = series[before] + slopes[0] * meets
    inside = (meets > 0.0) & (meets < span)
    top, bottom = np.where(inside, np.maximum(tip, high), high), np.where(inside, np.minimum(tip, low), low)
    return Gaps(
        before=before.astype(np.int64),
        after=after.astype(np.int64),
        before_slope=slopes[0],
        after_slope=slopes[1],
        highest=0.5 * (high + top),
        lowest=0.5 * (low + bottom),
        highest_tip=top,
        lowest_tip=bottom,
    )


def hidden_stretches(series: Float, time: Float, least_swing: float, cycles_s: Float) -> Float:
    """Stretches without a value in which a series may turn back unseen: begin and end, shape (H, 2), seconds.

    That is a gap of over a tenth of a second in which it would go on by a swing that counts if it were slowed down
    evenly, or that lasts about as long as a cycle; and a begin or end of the series that is lost while it moves.

    Parameters
    ----------
    series, time : ndarray, shape (N,)
    least_swing : float
        Swing that counts, in the unit of the series.
    cycles_s : ndarray, shape (C, 2)
        Starts and ends of the cycles that were found, in the time of the series.
    """
    gaps = gaps_of(series, time, LONGEST_GAP_S)
    begin, end = time[gaps.before], time[gaps.after]
    low, high = np.sort([series[gaps.before], series[gaps.after]], axis=0)
    goes_on = np.maximum(gaps.highest - high, low - gaps.lowest) >= least_swing
    apart = ~((begin[:, None] < cycles_s[:, 1]) & (end[:, None] > cycles_s[:, 0])).any(axis=0)
    lengths = np.diff(cycles_s[apart] if apart.any() else cycles_s, axis=1)
    as_cycle = _CYCLE_SHARE * float(np.median(lengths)) if lengths.size else np.inf
    hidden = goes_on | (end - begin >= as_cycle)
    found = [np.column_stack([begin, end])[hidden]]
    known = np.flatnonzero(np.isfinite(series))
    for edge, place, way in ((0, 0, 1), (series.size - 1, known.size - 1, -1)):
        lost_s = abs(float(time[edge] - time[known[place]]))
        moved = abs(_slope(series, time, known, place, way)) * lost_s
        if lost_s > LONGEST_GAP_S and (moved >= least_swing or lost_s >= as_cycle):
            found.append(np.sort([[time[edge], time[known[place]]]], axis=1))
    return np.concatenate(found)


def _slope(series: Float, time: Float, known: Index, place: int, way: int) -> float:
    """Slope by least squares of the known values from one on, five of them and a twentieth of a second, gaps apart."""
    rows = known[place : place + 64] if way > 0 else known[max(place - 63, 0) : place + 1][::-1]
    run = int(np.argmax(np.abs(np.diff(rows)) > 1)) + 1 if (np.abs(np.diff(rows)) > 1).any() else rows.size
    rows = rows[:run]
    near = np.abs(time[rows] - time[rows[0]]) <= _SLOPE_S
    rows = rows[: max(int(near.sum()), _SLOPE_FRAMES)]
    if rows.size < 2:
        return 0.0
    centered = time[rows] - time[rows].mean()
    return float(centered @ series[rows] / (centered @ centered))
