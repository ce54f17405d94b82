"""Bridging short gaps by screw interpolation, never unmarked."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import sclerp

_ROUNDING_FRAMES: Final = 0.25


def fill_gaps(
    pose: NDArray[np.float64],
    elapsed: NDArray[np.float64],
    rate_hz: float,
    max_gap_s: float,
    broken_rows: NDArray[np.intp] | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Fill gaps of at most `max_gap_s` between two known poses by ScLERP.

    Parameters
    ----------
    pose : ndarray, shape (N, 8)
        Sign-continuous; NaN where there is no pose.
    elapsed : ndarray, shape (N,)
        Seconds, increasing.
    rate_hz : float
    max_gap_s : float
        A gap lasts from one frame after the last known pose to the next known one.
    broken_rows : ndarray of int, optional
        Rows that the motion reaches by a leap: a gap that ends there, or has one inside, is not filled.

    Returns
    -------
    pose : ndarray, shape (N, 8)
    filled : ndarray of bool, shape (N,)
    """
    known = np.isfinite(pose).all(axis=1)
    filled = np.zeros(known.size, dtype=np.bool_)
    rows = np.flatnonzero(known)
    if rows.size < 2:
        return pose, filled
    following = np.searchsorted(rows, np.arange(known.size))
    inside = ~known & (following > 0) & (following < rows.size)
    before, after = rows[following[inside] - 1], rows[following[inside]]
    lost_s = elapsed[after] - elapsed[before] - 1.0 / rate_hz
    short = lost_s <= max_gap_s + _ROUNDING_FRAMES / rate_hz
    if broken_rows is not None:
        short &= np.searchsorted(broken_rows, before, side="right") == np.searchsorted(broken_rows, after, side="right")
    target, before, after = np.flatnonzero(inside)[short], before[short], after[short]
    if max_gap_s == 0.0 or target.size == 0:
        return pose, filled
    fraction = (elapsed[target] - elapsed[before]) / (elapsed[after] - elapsed[before])
    bridged = pose.copy()
    bridged[target] = sclerp(pose[before], pose[after], fraction)
    filled[target] = True
    return bridged, filled
