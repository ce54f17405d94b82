"""Long series drawn with few points that look the same: each pixel's lowest and highest."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float

# As many as a figure's full width has dots in print (170 mm at 300 dpi): no peak is lost and no line moves.
_BUCKETS: Final = 2000
_STRETCHES: Final = 64  # looked at at once


def drawn_rows(*curves: Float, parts: int = _BUCKETS, keep_gaps: bool = False) -> NDArray[np.intp]:
    """Rows of series that a line through them needs, increasing.

    Parameters
    ----------
    *curves : ndarray, shape (N,)
        Series that are drawn over the same rows; NaN where there is no value.
    parts : int
        Into how many stretches a long series is parted at most.
    keep_gaps : bool
        Keep of each stretch and curve a row without a value, so that a line is broken at the shortest gap.

    Returns
    -------
    ndarray of int
        All rows of a short series; else, of each stretch of equal length and for each curve, the
        rows of the lowest and the highest value. Of a stretch without any value its first row, so that the line is
        broken there. The first and the last row are always among them.
    """
    count = curves[0].size
    size = -(-count // parts)
    if size <= 2:
        return np.arange(count)
    found = [np.array([0, count - 1])]
    for first in range(0, count, size * _STRETCHES):
        starts = np.arange(first, min(first + size * _STRETCHES, count), size)
        for curve in curves:
            part = curve[first : first + size * _STRETCHES]
            filler = np.full(starts.size * size - part.size, np.nan)
            stretches = np.concatenate([part, filler]).reshape(-1, size)
            found.append(starts + np.argmin(np.nan_to_num(stretches, nan=np.inf), axis=1))
            found.append(starts + np.argmax(np.nan_to_num(stretches, nan=-np.inf), axis=1))
            if keep_gaps:
                missing = np.isnan(stretches)
                gaps = starts + missing.argmax(axis=1)
                found.append(gaps[missing.any(axis=1) & (gaps < count)])
    return np.unique(np.concatenate(found))


def drawn_band(low: Float, high: Float) -> tuple[NDArray[np.intp], Float, Float]:
    """Rows and edges of a band between two series (N,): of a long one, the envelope of each stretch.

    A zigzag between all extremes would be the same picture, but a polygon that covers itself a thousand times.

    Returns
    -------
    rows : ndarray of int, shape (K,)
    low, high : ndarray, shape (K,)
        NaN where a stretch has no value.
    """
    count = low.size
    size = -(-count // _BUCKETS)
    if size <= 2:
        return np.arange(count), low, high
    starts = np.arange(0, count, size)
    lower, upper = np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)
    return np.append(starts, count - 1), np.append(lower, lower[-1]), np.append(upper, upper[-1])
