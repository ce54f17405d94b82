"""Interpolation and blending of poses: ScLERP, sDLB, DLB.

By default the poses are first brought to the same sign of the double cover (shortest path). A caller that already
knows which of ``Q`` and ``-Q`` belongs to the motion, as in a measured series made continuous, passes
``shortest_path=False`` and the signs are used as they are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import dual_quaternion
from elbowscrew.geometry._small_angle import VANISHING_NORM, length


def sclerp(start: ArrayLike, end: ArrayLike, fraction: ArrayLike, *, shortest_path: bool = True) -> NDArray[np.float64]:
    """Screw linear interpolation ``Q1 (Q1* Q2)^t``: constant speed along and about one screw.

    Parameters
    ----------
    start, end : array_like, shape (..., 8)
        Unit dual quaternions.
    fraction : array_like, shape (...)
        t; 0 gives the start, 1 the end. Shapes broadcast.
    shortest_path : bool
        Take the end's sign nearer the start.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 30-31, K 41.

    Examples
    --------
    >>> from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose, pose_from_dual_quat
    >>> start = dual_quat_from_pose([1, 0, 0, 0], [0, 0, 0])
    >>> end = dual_quat_from_pose([np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)], [0, 0, 10])
    >>> pose_from_dual_quat(sclerp(start, end, 0.2))[1].round(6) + 0.0
    array([0., 0., 2.])
    """
    first = np.asarray(start, dtype=np.float64)
    last = np.asarray(end, dtype=np.float64)
    if shortest_path:
        last = dual_quaternion.align_signs(last, first)
    step = dual_quaternion.multiply(dual_quaternion.conjugate(first), last)
    return dual_quaternion.multiply(first, dual_quaternion.power(step, fraction))


def sdlb(start: ArrayLike, end: ArrayLike, fraction: ArrayLike, *, shortest_path: bool = True) -> NDArray[np.float64]:
    """Blend linearly between two poses, ``(1-t) Q1 + t Q2``, and normalize by the dual norm.

    Parameters and result as in `sclerp`; NaN where the blend vanishes.

    References
    ----------
    P 32, algorithm 1.
    """
    t = np.asarray(fraction, dtype=np.float64)
    poses = np.stack(np.broadcast_arrays(start, end), axis=-2)
    return dlb(poses, np.stack([1.0 - t, t], axis=-1), shortest_path=shortest_path)


def lagrange_weights(fraction: ArrayLike, knots: ArrayLike) -> NDArray[np.float64]:
    """Lagrange polynomials on the knots: weight j is 1 at knot j, 0 at the others, and the weights add up to 1.

    Parameters
    ----------
    fraction : array_like, shape (...)
        Where to evaluate.
    knots : array_like, shape (n,)
        Different from each other.

    Returns
    -------
    ndarray, shape (..., n)

    References
    ----------
    P 34.

    Examples
    --------
    >>> lagrange_weights(0.25, [0.0, 0.5, 1.0])
    array([ 0.375,  0.75 , -0.125])
    """
    t = np.asarray(fraction, dtype=np.float64)[..., None]
    knot = np.asarray(knots, dtype=np.float64)
    if np.unique(knot).size != knot.size:
        msg = f"knots must differ from each other, found {knot.tolist()}"
        raise ValueError(msg)
    weights = np.ones(np.broadcast_shapes(t.shape, knot.shape))
    for j in range(knot.size):
        for k in range(knot.size):
            if k != j:
                weights[..., j] *= (t[..., 0] - knot[k]) / (knot[j] - knot[k])
    return weights


def dlb(poses: ArrayLike, weights: ArrayLike, *, shortest_path: bool = True) -> NDArray[np.float64]:
    """Blend poses: weighted sum, normalized by the dual norm.

    Parameters
    ----------
    poses : array_like, shape (..., n, 8)
        Unit dual quaternions.
    weights : array_like, shape (..., n)
        One for each pose, adding up to 1; they may be negative (`lagrange_weights`).
    shortest_path : bool
        Take each pose's sign nearer the first one.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the weighted sum vanishes, so that its direction would be noise.

    References
    ----------
    P 33, algorithm 2.
    """
    Q = np.asarray(poses, dtype=np.float64)
    if shortest_path:
        Q = dual_quaternion.align_signs(Q, Q[..., :1, :])
    w = np.asarray(weights, dtype=np.float64)
    blend = (w[..., None, :] @ Q)[..., 0, :]
    vanishing = length(blend[..., :4]) < VANISHING_NORM
    return np.where(vanishing[..., None], np.nan, dual_quaternion.normalize(blend))
