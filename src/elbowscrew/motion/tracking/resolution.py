"""How coarse a recording's numbers are: in coarse ones a body at rest repeats its pose."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float

# Nothing is printed finer; what is smaller comes from the arithmetic.
_FINEST_M: Final = 1e-8
_OFF_THE_GRID: Final = 0.02
_SMALLEST_MULTIPLE: Final = 10
_LARGEST_TYPICAL_STEP: Final = 50.0
_LEAST_UNCHANGED: Final = 0.25
_FEWEST_STEPS: Final = 5


def coarse_step(coordinates: Float, turned: Float | None = None) -> float | None:
    """Size of the steps of coordinates so coarse that all of them may repeat at rest.

    They are if all steps are whole multiples of one size, typically some of it, and if the steps into rest and out of
    it leave some coordinates as they are, and so the rotation at times; behind lost tracking all of them change.

    Parameters
    ----------
    coordinates : ndarray, shape (N, K)
        Meters, of successive frames; NaN where not known.
    turned : ndarray of bool, shape (N - 1,), optional
        Whether the rotation changes from each frame to the next.

    Returns
    -------
    float or None
        Meters; None if the numbers are not coarse.
    """
    steps: Float = np.abs(np.diff(coordinates, axis=0))
    changes = np.nan_to_num(steps) > _FINEST_M
    moved: Bool = np.any(changes, axis=1)
    known: Bool = np.all(np.isfinite(steps), axis=1)
    if (moved & known).sum() < _FEWEST_STEPS:
        return None
    size = _common_size(steps[changes])
    if size is None or np.median(steps[changes]) > _LARGEST_TYPICAL_STEP * size:
        return None
    rest: Bool = np.logical_and(known, ~moved)
    beside = known & moved & (np.r_[rest[1:], False] | np.r_[False, rest[:-1]])
    if not beside.any() or 1.0 - changes[beside].mean() < _LEAST_UNCHANGED:
        return None
    if turned is not None and 1.0 - turned[beside].mean() < _LEAST_UNCHANGED:
        return None
    return size


def _common_size(steps: Float) -> float | None:
    """Largest size all steps are whole multiples of, the smallest of them one to ten times it."""
    for multiple in range(1, _SMALLEST_MULTIPLE + 1):
        size = float(steps.min()) / multiple
        multiples = steps / size
        if np.abs(multiples - np.round(multiples)).max() <= _OFF_THE_GRID:
            return size
    return None
