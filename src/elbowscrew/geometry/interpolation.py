"""Interpolation between two poses: ScLERP, sDLB, and NLERP of rotations; chains of poses.

`Q` and `-Q` are one pose, but the blends of `Q1` with the one and with the other go round different ways. By default
it is the shorter way (``way="shortest"``); ``"longest"`` is the other one. A caller that knows which of the two signs
belongs to the motion, as in a measured series made continuous, says ``"as given"``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import _rows, dual_quaternion
from elbowscrew.geometry._blocks import in_blocks, is_single
from elbowscrew.geometry._small_angle import (
    NEGLIGIBLE_ANGLE,
    VANISHING_NORM,
    cosine_and_sine,
    divide_rows,
    row_length,
)
from elbowscrew.geometry._ways import WayRound, check_way, choose_signs
from elbowscrew.geometry.arrays import Float


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
    check_way(way)
    first, last = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    t = np.asarray(fraction, dtype=np.float64)[..., None]
    if is_single(first) and is_single(last):
        half_angle, path = _screw_path(first.ravel(), last.ravel(), way)
        shape = np.broadcast_shapes(first.shape, last.shape, (*t.shape[:-1], 8))
        return in_blocks(lambda t: _along(path, half_angle, t[0]), t, width=8).reshape(shape)

    def kernel(first: _rows.Rows, last: _rows.Rows, t: _rows.Rows) -> list[Float]:
        step = _rows.dual_product(_rows.conjugate(first), choose_signs(last, first, way))
        return _rows.dual_product(first, _rows.power(step, t[0]))

    return in_blocks(kernel, first, last, t, width=8)


def _screw_path(start: Float, end: Float, way: WayRound) -> tuple[float, Float]:
    """Half the angle between two poses, and the map from `_along`'s base to the poses on the screw between them."""
    step = dual_quaternion.multiply(dual_quaternion.conjugate(start), end)
    if way != "as given" and (step[0] < 0.0) == (way == "shortest"):
        step = -step
    logarithm = dual_quaternion.log(step).tolist()
    a, b = logarithm[:3], logarithm[3:]
    half = math.hypot(*a)
    h = [value / half for value in a] if half > 0.0 else a
    slide = sum(one * other for one, other in zip(h, b, strict=True))
    with_t = [slide * value for value in h]
    if half < NEGLIGIBLE_ANGLE:  # there the sine is the angle, and what goes across the axis goes with t, too
        with_t, with_sine = b, [0.0, 0.0, 0.0]
    else:
        with_sine = [(one - other) / half for one, other in zip(b, with_t, strict=True)]
    base = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, *h, 0.0, *with_sine],
        [0.0, 0.0, 0.0, 0.0, -slide, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, *with_t],
    ]
    return half, dual_quaternion.multiply(start, base).T


def _along(path: Float, half_angle: float, t: Float) -> Float:
    """Poses at t, linear in cos, sin, t sin and t cos of t theta/2."""
    cosine, sine = cosine_and_sine(half_angle * t)
    base = np.empty((4, t.size))
    base[0], base[1] = cosine, sine
    np.multiply(t, sine, out=base[2])
    np.multiply(t, cosine, out=base[3])
    moved: Float = path @ base
    return moved


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
    check_way(way)

    def kernel(first: _rows.Rows, last: _rows.Rows, t: _rows.Rows) -> list[Float]:
        blend = _rows.weighted([1.0 - t[0], t[0]], [first, choose_signs(last, first, way)])
        return _rows.normalized(blend, VANISHING_NORM)

    return in_blocks(kernel, start, end, np.asarray(fraction, dtype=np.float64)[..., None], width=8)


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
    check_way(way)

    def kernel(first: _rows.Rows, last: _rows.Rows, t: _rows.Rows) -> list[Float]:
        blend = _rows.weighted([1.0 - t[0], t[0]], [first, choose_signs(last, first, way)])
        return divide_rows(blend, row_length(blend), VANISHING_NORM)

    return in_blocks(kernel, start, end, np.asarray(fraction, dtype=np.float64)[..., None], width=4)


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
