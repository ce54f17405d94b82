"""Bridging short gaps by screw interpolation, never unmarked, and how far that may be off."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import sclerp
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.geometry.dual_quaternion import align_signs, conjugate, log, multiply

_ROUNDING_FRAMES: Final = 0.25

# The speed beside a gap is that of so many poses, or of so much time, or of such a share of the gap's.
_SPEED_FRAMES: Final = 5
_SPEED_S: Final = 0.05
_SPEED_SHARE: Final = 0.25
_MOST_SPEED_FRAMES: Final = 64
# A speed that differs at one end only, and changes half-way, leaves the straight line by so much of a gap's duration.
_ONE_SIDED: Final = 0.25


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


class Filled(NamedTuple):
    """Gaps that were filled, shape (G,) each.

    Attributes
    ----------
    before, after : ndarray of int64
        Rows of the poses beside the gap.
    off : ndarray
        How far the rotation that was filled in may be off, radians; NaN where no speed is known at an end.
    noise : ndarray
        Standard deviation of that by the speeds' noise, for noise 1 of a component of the rotation.
    """

    before: Index
    after: Index
    off: Float
    noise: Float


def filled_gaps(pose: Float, filled: Bool, elapsed: Float, rate_hz: float) -> Filled:
    """How far what was filled in may be off, by the angular velocities at the two ends of each gap.

    With ``a`` and ``b`` what these differ by from the velocity of the screw between the ends, and h the gap's duration,
    the motion may leave that screw by ``h |a| |b| / (|a| + |b|)``, where the two tangents meet; it comes less far if it
    slows down evenly. Where only one of the two differs, the speed may change half-way, which leaves the screw by
    ``h max(|a|, |b|) / 4``.

    Parameters
    ----------
    pose : ndarray, shape (N, 8)
        As recorded: NaN where there was no pose.
    filled : ndarray of bool, shape (N,)
    elapsed : ndarray, shape (N,)
        Seconds.
    rate_hz : float
    """
    rows = np.flatnonzero(np.isfinite(pose).all(axis=1))
    place = np.flatnonzero(np.diff(rows) > 1)
    place = place[filled[rows[place] + 1]]
    before, after = rows[place], rows[place + 1]
    span = elapsed[after] - elapsed[before]
    straight = _turned(pose[before], pose[after]) / span[:, None]
    # Seen from the pose before the gap: a screw has the same angular velocity all along it.
    first, first_noise = _speeds(pose, elapsed, rows, place, -span, rate_hz)
    last, last_noise = _speeds(pose, elapsed, rows, place + 1, span, rate_hz)
    one, other = length(first - straight), length(last - straight)
    total = one + other
    tip = np.divide(one * other, total, out=np.zeros(total.size), where=total > 0.0)
    off = span * np.maximum(tip, _ONE_SIDED * np.maximum(one, other))
    off[np.isnan(total)] = np.nan
    return Filled(before.astype(np.int64), after.astype(np.int64), off, 0.5 * span * np.hypot(first_noise, last_noise))


def _speeds(pose: Float, elapsed: Float, rows: Index, place: Index, span: Float, rate_hz: float) -> tuple[Float, Float]:
    """Angular velocities (G, 3) of known poses from one on, in its own frame, and their noise for noise 1.

    Gaps of a negative span have these poses before them.
    """
    reach = np.maximum(_SPEED_S, _SPEED_SHARE * np.abs(span)) + 0.5 / rate_hz
    most = min(max(int(reach.max(initial=0.0) * rate_hz) + 1, _SPEED_FRAMES), _MOST_SPEED_FRAMES)
    number = np.arange(most)
    near = place[:, None] + np.sign(span).astype(np.int64)[:, None] * number
    inside = (near >= 0) & (near < rows.size)
    near = rows[near.clip(0, rows.size - 1)]
    time = elapsed[near] - elapsed[near[:, :1]]
    away = np.abs(time)
    few = (number < _SPEED_FRAMES) & (away <= 2.0 * _SPEED_FRAMES / rate_hz)
    inside &= few | (away <= reach[:, None])
    turn = _turned(pose[near[:, :1]], pose[near])
    members = np.maximum(inside.sum(axis=1), 1)[:, None]
    centered = np.where(inside, time - np.where(inside, time, 0.0).sum(axis=1, keepdims=True) / members, 0.0)
    square = np.einsum("gk,gk->g", centered, centered)
    square[square == 0.0] = np.nan
    return np.einsum("gk,gkc->gc", centered, turn) / square[:, None], 1.0 / np.sqrt(square)


def _turned(start: Float, end: Float) -> Float:
    """Rotation vectors from one pose to another, the shorter way, in the frame of the first."""
    step = align_signs(multiply(conjugate(start), end), np.eye(8)[0])
    return 2.0 * log(step)[..., :3]
