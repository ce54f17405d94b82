"""What the poses of a body tell of their own noise from frame to frame, where the file tells of no markers."""

from __future__ import annotations

from math import comb
from typing import Final

import numpy as np
from scipy.special import chdtr, gammaincinv

from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import align_signs, conjugate, log, multiply, pose_from_dual_quat
from elbowscrew.model import RigidBody

# Differences of poses at this many steps: a motion at f Hz leaves (2 pi f / rate)^n of itself in them, over
# sqrt(C(2n, n)) times the noise, so that even a throw leaves next to nothing in the sixth.
_ORDER: Final = 6
_LOWER_ORDER: Final = 4
# What falls to less than this of itself at the higher order is no noise of single frames: a motion, or a filter's rest.
_LEAST_KEPT: Final = 0.3
_FEWEST: Final = 100
_LEAST_BESIDE: Final = 1e-10  # of a variance beside the largest: less is a noise that is not in all directions
_MOST_FRAMES: Final = 20_000
# Of the differences: the others may be moments of fast motion, or leaps. In the end only what is far out is left out.
_KEPT: Final = (*(0.75,) * 8, 0.99, 0.99)
_IDENTITY: Final = np.eye(8)[0]


def jitter_covariance(body: RigidBody, least_sd: Float) -> Float | None:
    """Covariance of a body's poses from how they jitter, their motion taken off by differences of successive frames.

    It tells of noise that is new in each frame, and of nothing that stays or that a filter has taken. How it is shared
    out, between turns and shifts and by directions, is as the body's cluster of markers makes it, known or not.

    Parameters
    ----------
    body : RigidBody
        Its runs of tracked frames are looked at.
    least_sd : ndarray, shape (6,)
        Less than three times these is rounding.

    Returns
    -------
    ndarray, shape (6, 6), or None
        Of the rotation vector (rad) and of the position (m), in the body's frame. None where fewer than 100 frames
        begin a run of seven, or what the differences hold is rounding, a motion, or what a filter left of the noise.

    References
    ----------
    For differences as a measure of noise, Gasser, Sroka and Jennen-Steinmetz 1986; for the scatter, the concentration
    steps of Rousseeuw and Van Driessen 1999 from the coordinates' own medians, and their last, reweighted one.
    """
    if not body.located:
        return None
    steps = _steps(body)
    found = [_scatter(_differences(steps, order)) for order in (_LOWER_ORDER, _ORDER)]
    lower, higher = (None if one is None else np.array([np.trace(one[:3, :3]), np.trace(one[3:, 3:])]) for one in found)
    if lower is None or higher is None:
        return None
    rounding = 9.0 * np.array([np.sum(least_sd[:3] ** 2), np.sum(least_sd[3:] ** 2)])
    if (higher < rounding).any() or (higher < _LEAST_KEPT**2 * lower).any():
        return None
    return found[-1]


def _steps(body: RigidBody) -> Float:
    """Turns and shifts (K, 7, 6) from the middle to each of seven successive frames, in the body's frame at the middle.

    Each by itself: in a twist the shift of a fast body would mix them.
    """
    tracked = body.tracked
    starts = max(len(tracked) - _ORDER, 0)
    whole = [tracked[step : starts + step] for step in range(_ORDER + 1)]
    rows = evenly_thinned(np.flatnonzero(np.all(whole, axis=0)), _MOST_FRAMES)[:, None] + np.arange(_ORDER + 1)
    poses = body.dual_quat_lab_body[rows]
    steps = multiply(conjugate(poses[:, _ORDER // 2, None]), poses)
    turn = 2.0 * log(align_signs(steps, _IDENTITY))[..., :3]
    return np.concatenate([turn, pose_from_dual_quat(steps)[1]], axis=-1)


def _differences(steps: Float, order: int) -> Float:
    """Differences (K, 6) of an even order about the middle, of the size of the noise of one frame."""
    weight = np.array([(-1.0) ** step * comb(order, step) for step in range(order + 1)]) / np.sqrt(
        comb(2 * order, order)
    )
    side = (_ORDER - order) // 2
    return np.asarray(np.einsum("s,nsi->ni", weight, steps[:, side : side + order + 1]), dtype=np.float64)


def _scatter(rows: Float) -> Float | None:
    """Covariance (6, 6) of rows (K, 6) about zero that a quarter of them hardly moves; None of too few or of none."""
    if len(rows) < _FEWEST:
        return None
    width = rows.shape[1]
    scatter = np.diag(np.median(rows**2, axis=0))
    for kept in _KEPT:
        sizes = np.linalg.eigvalsh(scatter)
        if not sizes[0] > _LEAST_BESIDE * sizes[-1]:
            return None
        distance = np.einsum("ni,ij,nj->n", rows, np.linalg.inv(scatter), rows)
        # Quantiles of the squared distance, which is chi-square (SciPy's own statistics take half a second to load).
        middle, farthest = 2.0 * gammaincinv(0.5 * width, [0.5, kept])
        near = rows[distance <= np.median(distance) * farthest / middle]
        # What normal rows lose in variance where the farthest of them are left out.
        scatter = near.T @ near / len(near) * kept / chdtr(width + 2, farthest)
    return np.asarray(scatter, dtype=np.float64)
