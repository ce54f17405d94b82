"""Turning points of a series, runs of a mask, and the frames between which the joint moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model import MovementPhases


def movement_phases(onset_s: Float, offset_s: Float, elapsed: Float) -> MovementPhases:
    """Frames of the movements between rests.

    Parameters
    ----------
    onset_s, offset_s : ndarray, shape (M,)
        Seconds from the first frame.
    elapsed : ndarray, shape (N,)
        Seconds, increasing.
    """
    onset, offset = nearest_rows(elapsed, onset_s), nearest_rows(elapsed, offset_s)
    edges = np.zeros(elapsed.size + 1, dtype=np.int64)
    np.add.at(edges, onset, 1)
    np.add.at(edges, offset + 1, -1)
    return MovementPhases(onset_rows=onset, offset_rows=offset, moving=np.cumsum(edges[:-1]) > 0)


def nearest_rows(elapsed: Float, seconds: Float) -> NDArray[np.int64]:
    """Rows (K, ...) nearest to times (K, ...) from the first frame on, the earlier of two."""
    time = elapsed - elapsed[0]
    after = np.searchsorted(time, seconds).clip(0, time.size - 1)
    before = (after - 1).clip(0)
    nearer = seconds - time[before] <= time[after] - seconds
    return np.where(nearer, before, after).astype(np.int64)


def turning_points(series: Float, swing: float) -> NDArray[np.int64]:
    """Extrema between which a series (N,) swings by at least so much, lows and highs in turn, its ends among them.

    Every high found is a peak of at least that prominence, and every low one of the series upside down.
    """
    bends = np.flatnonzero(np.diff(np.sign(np.diff(series)))) + 1
    candidates = np.concatenate([[0], bends, [series.size - 1]])
    values = series[candidates]
    low = high = 0
    sense = 0
    found: list[int] = []
    for k, value in enumerate(values.tolist()):  # over the extrema, not over the frames
        low, high = (k if value < values[low] else low), (k if value > values[high] else high)
        if sense >= 0 and value <= values[high] - swing:
            found.append(high)
            low = high = k
            sense = -1
        elif sense <= 0 and value >= values[low] + swing:
            found.append(low)
            low = high = k
            sense = 1
    last = high if sense > 0 else low
    if found and last not in found:
        found.append(last)
    return np.asarray(candidates[found], dtype=np.int64)


def runs_of(mask: Bool) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First and last row of every run of True, shape (R,) each."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return edges[::2].astype(np.int64), edges[1::2].astype(np.int64) - 1
