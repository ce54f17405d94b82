"""Interpolation and blending of poses: ScLERP, sDLB, DLB.

`Q` and `-Q` are one pose, but the blends of `Q1` with the one and with the other go round different ways. By default
it is the shorter way (``way="shortest"``); ``"longest"`` is the other one. A caller that knows which of the two signs
belongs to the motion, as in a measured series made continuous, says ``"as given"``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import dual_quaternion, quaternion
from elbowscrew.geometry._small_angle import VANISHING_NORM, length
from elbowscrew.geometry._ways import WayRound, check_way


def _choose_signs(quats: NDArray[np.float64], reference: NDArray[np.float64], way: WayRound) -> NDArray[np.float64]:
    """Quaternions or dual quaternions (..., k) with the sign that goes that way round from the reference."""
    check_way(way)
    if way == "as given":
        return quats
    near = np.sum(quats[..., :4] * reference[..., :4], axis=-1, keepdims=True) >= 0.0
    return np.where(near == (way == "shortest"), quats, -quats)


def sclerp(start: ArrayLike, end: ArrayLike, fraction: ArrayLike, *, way: WayRound = "shortest") -> NDArray[np.float64]:
    """Screw linear interpolation ``Q1 (Q1* Q2)^t``: constant speed along and about one screw.

    Parameters
    ----------
    start, end : array_like, shape (..., 8)
        Unit dual quaternions.
    fraction : array_like, shape (...)
        t; 0 gives the start, 1 the end. Shapes broadcast.
    way : {"shortest", "longest", "as given"}
        Which way round: with the end's sign nearer the start, farther from it, or as it stands.

    Returns
    -------
    ndarray, shape (..., 8)
        Towards a full turn from start to end, where the way is ill-conditioned, the rotation loses 1/sin(theta/2) and
        the dual part its square.

    Raises
    ------
    ValueError
        If `way` is none of the three.

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
    last = _choose_signs(np.asarray(end, dtype=np.float64), first, way)
    step = dual_quaternion.multiply(dual_quaternion.conjugate(first), last)
    return dual_quaternion.multiply(first, dual_quaternion.power(step, fraction))


def sdlb(start: ArrayLike, end: ArrayLike, fraction: ArrayLike, *, way: WayRound = "shortest") -> NDArray[np.float64]:
    """Blend linearly between two poses, ``(1-t) Q1 + t Q2``, and normalize by the dual norm.

    Parameters
    ----------
    start, end : array_like, shape (..., 8)
        Unit dual quaternions.
    fraction : array_like, shape (...)
        t; 0 gives the start, 1 the end. Shapes broadcast.
    way : {"shortest", "longest", "as given"}
        Which way round: with the end's sign nearer the start, farther from it, or as it stands.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the blend vanishes.

    Raises
    ------
    ValueError
        If `way` is none of the three.

    References
    ----------
    P 32, algorithm 1.

    Examples
    --------
    A number of P table 1.

    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> start, end = dual_quat_from_screw([0, np.pi / 4], [0, 10], [0, 0, 1], [0, 0, 0])
    >>> dual_quaternion.pose_from_dual_quat(sdlb(start, end, 0.2))[1].round(6) + 0.0
    array([0.    , 0.    , 1.9251])
    """
    t = np.asarray(fraction, dtype=np.float64)
    poses = np.stack(np.broadcast_arrays(start, end), axis=-2)
    return dlb(poses, np.stack([1.0 - t, t], axis=-1), way=way)


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

    Raises
    ------
    ValueError
        If two knots are the same.

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


def dlb(poses: ArrayLike, weights: ArrayLike, *, way: WayRound = "shortest") -> NDArray[np.float64]:
    """Blend poses: weighted sum, normalized by the dual norm.

    Parameters
    ----------
    poses : array_like, shape (..., n, 8)
        Unit dual quaternions.
    weights : array_like, shape (..., n)
        One for each pose, adding up to 1; they may be negative (`lagrange_weights`).
    way : {"shortest", "longest", "as given"}
        Signs of all poses nearer the first one's, farther from it, or as they stand.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the weighted sum vanishes, so that its direction would be noise.

    Raises
    ------
    ValueError
        If `way` is none of the three.

    References
    ----------
    P 33, algorithm 2.

    Examples
    --------
    A number of P table 1.

    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> poses = dual_quat_from_screw([0, np.pi / 8, np.pi / 4], [0, 5, 10], [0, 0, 1], [0, 0, 0])
    >>> blend = dlb(poses, lagrange_weights(0.2, [0, 0.5, 1]))
    >>> dual_quaternion.pose_from_dual_quat(blend)[1].round(6) + 0.0
    array([0.     , 0.     , 2.03664])
    """
    Q = _signs_from_first(poses, way)
    w = np.asarray(weights, dtype=np.float64)
    blend = (w[..., None, :] @ Q)[..., 0, :]
    vanishing = length(blend[..., :4]) < VANISHING_NORM
    return np.where(vanishing[..., None], np.nan, dual_quaternion.normalize(blend))


def _signs_from_first(poses: ArrayLike, way: WayRound) -> NDArray[np.float64]:
    Q = np.asarray(poses, dtype=np.float64)
    chosen = _choose_signs(Q, Q[..., :1, :], way)
    return np.concatenate([Q[..., :1, :], chosen[..., 1:, :]], axis=-2)


class IterativeBlend(NamedTuple):
    """Result of `dib`.

    Attributes
    ----------
    dual_quat : ndarray, shape (..., 8)
        The blended poses, unit dual quaternions.
    iterations : int
        Steps taken, for all poses together.
    residual : ndarray, shape (...)
        Length of the last step: of its rotation (rad) and of its translation relative to the size of the poses.
    """

    dual_quat: NDArray[np.float64]
    iterations: int
    residual: NDArray[np.float64]


def dib(
    poses: ArrayLike,
    weights: ArrayLike,
    *,
    tolerance: float = 1e-12,
    max_iterations: int = 100,
    way: WayRound = "shortest",
) -> IterativeBlend:
    """Dual quaternion iterative blending: from DLB on, ``B <- B exp(sum_i w_i log(B* Q_i))`` until the step is small.

    The result is the weighted mean on the group itself: it does not depend on the frame, and between two poses it is
    ScLERP.

    Parameters
    ----------
    poses : array_like, shape (..., n, 8)
        Unit dual quaternions.
    weights : array_like, shape (..., n)
        One for each pose, adding up to 1; as in `dlb`.
    tolerance : float
        Largest step at which to stop.
    max_iterations : int
        Stop here in any case; look at the residual then.
    way : {"shortest", "longest", "as given"}
        As in `dlb`.

    Returns
    -------
    IterativeBlend
        NaN where the first blend vanishes.

    Raises
    ------
    ValueError
        If `way` is none of the three.

    References
    ----------
    P algorithm 3.

    Examples
    --------
    A number of P table 1.

    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> poses = dual_quat_from_screw([0, np.pi / 8, np.pi / 4], [0, 5, 10], [0, 0, 1], [0, 0, 0])
    >>> blend = dib(poses, lagrange_weights(0.2, [0, 0.5, 1]))
    >>> dual_quaternion.pose_from_dual_quat(blend.dual_quat)[1].round(6) + 0.0
    array([0., 0., 2.])
    """
    Q = _signs_from_first(poses, way)
    w = np.asarray(weights, dtype=np.float64)
    blend = dlb(Q, w, way="as given")
    scale = 1.0 + np.max(length(dual_quaternion.pose_from_dual_quat(Q)[1]), axis=-1, initial=0.0)
    residual = np.full(blend.shape[:-1], np.inf)
    done = 0
    while done < max_iterations and np.any(residual > tolerance):
        steps = dual_quaternion.multiply(dual_quaternion.conjugate(blend)[..., None, :], Q)
        step = (w[..., None, :] @ dual_quaternion.log(steps))[..., 0, :]
        blend = dual_quaternion.normalize(dual_quaternion.multiply(blend, dual_quaternion.exp(step)))
        residual = np.maximum(length(step[..., :3]), length(step[..., 3:]) / scale)
        done += 1
    return IterativeBlend(blend, done, residual)


def nlerp(start: ArrayLike, end: ArrayLike, fraction: ArrayLike, *, way: WayRound = "shortest") -> NDArray[np.float64]:
    """Blend linearly between two rotations and normalize: the path of slerp at another speed.

    Parameters
    ----------
    start, end : array_like, shape (..., 4)
        Unit quaternions.
    fraction : array_like, shape (...)
        t; 0 gives the start, 1 the end. Shapes broadcast.
    way : {"shortest", "longest", "as given"}
        Which way round: with the end's sign nearer the start, farther from it, or as it stands.

    Returns
    -------
    ndarray, shape (..., 4)
        NaN where the blend vanishes.

    Raises
    ------
    ValueError
        If `way` is none of the three.

    References
    ----------
    K 44. For poses it is `sdlb`.

    Examples
    --------
    >>> nlerp([1, 0, 0, 0], [0, 0, 0, 1], 0.5).round(6)
    array([0.707107, 0.      , 0.      , 0.707107])
    """
    first, last = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    last = _choose_signs(last, first, way)
    t = np.asarray(fraction, dtype=np.float64)[..., None]
    blend = (1.0 - t) * first + t * last
    vanishing = length(blend)[..., None] < VANISHING_NORM
    return np.where(vanishing, np.nan, quaternion.normalize(blend))


def chain(poses: ArrayLike) -> NDArray[np.float64]:
    """Poses of the links of a chain in its root: products ``Q_1``, ``Q_1 Q_2``, ...

    Parameters
    ----------
    poses : array_like, shape (..., n, 8)
        Each link in the one before it.

    Returns
    -------
    ndarray, shape (..., n, 8)

    References
    ----------
    K, section on hierarchies.

    Examples
    --------
    >>> shift = [1, 0, 0, 0, 0, 0, 0, 1]
    >>> dual_quaternion.pose_from_dual_quat(chain([shift, shift, shift]))[1][:, 2]
    array([2., 4., 6.])
    """
    Q = np.array(poses, dtype=np.float64)
    for k in range(1, Q.shape[-2]):
        Q[..., k, :] = dual_quaternion.multiply(Q[..., k - 1, :], Q[..., k, :])
    return Q
