"""Twists: velocities of rigid bodies, shape (..., 6), the angular part first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import dual_quaternion, quaternion
from elbowscrew.geometry._small_angle import divide, length

Float = NDArray[np.float64]


class InstantaneousScrew(NamedTuple):
    """Instantaneous helical axis.

    Attributes
    ----------
    rate : ndarray, shape (...)
        Angular velocity, rad/s.
    pitch : ndarray, shape (...)
        Slide for each radian; NaN where there is no rotation, as the line.
    line : ndarray, shape (..., 6)
        Plücker vector of the axis.
    """

    rate: Float
    pitch: Float
    line: Float


def twist_in_fixed_frame(dual_quat: ArrayLike, derivative: ArrayLike) -> Float:
    """Twist ``2 Q' Q*`` in the fixed frame: angular velocity, then velocity of the body's point at the frame's origin.

    Parameters
    ----------
    dual_quat, derivative : array_like, shape (..., 8)
        Unit dual quaternions and their derivatives by time.

    Returns
    -------
    ndarray, shape (..., 6)
    """
    product = 2.0 * dual_quaternion.multiply(derivative, dual_quaternion.conjugate(dual_quat))
    return product[..., [1, 2, 3, 5, 6, 7]]


def twist_in_body_frame(dual_quat: ArrayLike, derivative: ArrayLike) -> Float:
    """Twist ``2 Q* Q'`` in the body's frame, shape (..., 6); see `twist_in_fixed_frame`."""
    product = 2.0 * dual_quaternion.multiply(dual_quaternion.conjugate(dual_quat), derivative)
    return product[..., [1, 2, 3, 5, 6, 7]]


def adjoint(dual_quat: ArrayLike) -> Float:
    """Matrices (..., 6, 6) that write a body's twist in the fixed frame: ``[[R, 0], [[d]x R, R]]``."""
    quat, position = dual_quaternion.pose_from_dual_quat(dual_quat)
    R = quaternion.rotation_matrix_from_quat(quat)
    matrix = np.zeros((*R.shape[:-2], 6, 6))
    matrix[..., :3, :3] = R
    matrix[..., 3:, 3:] = R
    matrix[..., 3:, :3] = np.swapaxes(np.cross(position[..., None, :], np.swapaxes(R, -1, -2)), -1, -2)
    return matrix


def integrate_twist(start: ArrayLike, twist: ArrayLike, time_step: ArrayLike) -> Float:
    """Pose after moving with a constant body twist for a time: ``Q exp(twist time / 2)``, shape (..., 8)."""
    half = 0.5 * np.asarray(twist, dtype=np.float64) * np.asarray(time_step, dtype=np.float64)[..., None]
    return dual_quaternion.multiply(start, dual_quaternion.exp(half))


def instantaneous_screw(twist: ArrayLike) -> InstantaneousScrew:
    """Instantaneous helical axis: direction ``w/|w|``, moment ``(v - (v.n) n)/|w|``, pitch ``v.w/|w|^2``.

    Parameters
    ----------
    twist : array_like, shape (..., 6)
        In the frame the axis is wanted in.
    """
    t = np.asarray(twist, dtype=np.float64)
    w, v = t[..., :3], t[..., 3:]
    rate = length(w)
    direction = divide(w, rate[..., None])
    along = np.sum(v * direction, axis=-1)
    moment = divide(v - along[..., None] * direction, rate[..., None])
    return InstantaneousScrew(rate, divide(along, rate), np.concatenate([direction, moment], axis=-1))
