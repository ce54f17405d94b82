"""Frames that are no measurements but were put in between by what exported the file: interpolated, or repeated."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import QualityWarning, Recording, RigidBody
from elbowscrew.motion.difference import summed_rotation

_MOST: Final = 10
_FEWEST_OF_A_KIND: Final = 12
# In nearly all rows between them the series bends, or moves, so much less than at the recorded ones.
_STRAIGHT_SHARE: Final = 0.25
_NEARLY_ALL: Final = 95.0
_SOME: Final = 10.0
# At least half of the rows are in between, and at least a tenth is recorded; some are lost.
_HALVES: Final = (40.0, 97.0)
# Recorded rows that far apart show the motion; next to each other they may show the noise alone.
_LAGS: Final = (1, 4)
_MOST_ROWS: Final = 50_000
_ROUNDING: Final = 1e-9


def recorded_rows(series: Float) -> slice:
    """Rows of a series (N, k) that were recorded, where the others lie on straight lines between them or repeat them.

    Only every second to every tenth row being recorded is looked for: of such a series the second differences are next
    to nothing in all other rows, or the first differences after all but one row of each step. Strokes of constant
    speed that turn in every row which is left are no such series: what was recorded goes on more than it turns.

    Parameters
    ----------
    series : ndarray, shape (N, k)
        NaN where nothing is known.

    Returns
    -------
    slice
        Of step 1 where all rows are recorded, or nothing shows.

    Examples
    --------
    >>> taken = np.sin(0.1 * np.arange(60)) + np.random.default_rng(1).normal(0.0, 0.01, 60)
    >>> recorded_rows(taken[:, None])
    slice(0, None, 1)
    >>> recorded_rows(np.interp(np.arange(119) / 2, np.arange(60), taken)[:, None])
    slice(0, None, 2)
    """
    begin = _begin(len(series))
    return _recorded(series[begin : begin + _MOST_ROWS], begin)


def recorded_poses(pose: Float) -> slice:
    """Rows of poses (N, 8), or rotations (N, 4), that were recorded (`recorded_rows`); a screw is a straight line."""
    begin = _begin(len(pose))
    part = pose[begin : begin + _MOST_ROWS]
    turned = summed_rotation(part[:, :4])
    if part.shape[1] == 4:
        return _recorded(turned, begin)
    return _recorded(np.hstack([turned, pose_from_dual_quat(part)[1]]), begin)


def _begin(count: int) -> int:
    """First of the rows that are looked at, in the middle of so many."""
    return max((count - _MOST_ROWS) // 2, 0)


def _recorded(part: Float, begin: int) -> slice:
    # The bend of a row stands one before it, and so does the move to it.
    changes = [change for order in (2, 1) if _has_small(change := length(np.diff(part, order, axis=0)))]
    for step in range(min(_MOST, len(part) // _FEWEST_OF_A_KIND), 1, -1):
        for change in changes:
            row = _only_change(change, step)
            if row is None:
                continue
            if any(_goes_on(part[(row + 1) % step :: lag * step]) for lag in _LAGS):
                return slice((begin + row + 1) % step, None, step)
    return slice(0, None, 1)


def _has_small(change: Float) -> bool:
    """Whether the smaller half of changes (N,) is so much smaller than the largest as rows in between would have it."""
    known = change[np.isfinite(change)]
    if not known.size:
        return False
    small, large = np.percentile(known, _HALVES)
    return bool(small <= _STRAIGHT_SHARE * large)


def _goes_on(series: Float) -> bool:
    """Whether a series (N, k) moves more than it bends."""
    return float(np.nansum(np.diff(series, 2, axis=0) ** 2)) < float(np.nansum(np.diff(series, axis=0) ** 2))


def _only_change(change: Float, step: int) -> int | None:
    """Which of the rows of each step is the only one with changes (N,) that are not small; None if it is not one."""
    whole = change[: change.size // step * step].reshape(-1, step)
    whole = whole[np.isfinite(whole).all(axis=1)]
    if len(whole) < _FEWEST_OF_A_KIND:
        return None
    usual = np.median(whole, axis=0)
    row = int(np.argmax(usual))
    others = float(np.percentile(np.delete(whole, row, axis=1), _NEARLY_ALL))
    least = float(np.percentile(whole[:, row], _SOME))  # of a series of two rates some of them are between others, too
    return row if least > others + _ROUNDING and others <= _STRAIGHT_SHARE * usual[row] else None


def inserted_warnings(body: RigidBody, recording: Recording) -> list[QualityWarning]:
    """Warn of a body most of whose frames were put in between."""
    step = recorded_poses(body.dual_quat_lab_body).step
    if step == 1:
        return []
    own_hz = recording.rate_hz / step
    message = (
        f"only every {step}{'nd' if step == 2 else 'rd' if step == 3 else 'th'} frame of body {body.name!r} was "
        f"recorded, at {own_hz:.4g} frames per second: the others lie on straight lines between them, or repeat them. "
        "Cut-offs and noise are taken from those that were recorded, but all of them count as measured; "
        f"--resample {own_hz:.4g} leaves the others out"
    )
    return [QualityWarning(code="inserted-frames", message=message)]
