"""Twists: velocities of rigid bodies, shape (..., 6), the angular part first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry import _rows, dual_quaternion
from elbowscrew.geometry._blocks import in_blocks
from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float


class InstantaneousScrew(NamedTuple):
    """Instantaneous helical axis.

    Attributes
    ----------
    rate : ndarray, shape (...)
        Angular velocity, rad/s.
    pitch : ndarray, shape (...)
        Slide for each radian; NaN where there is no rotation, as the line.
    line : ndarray, shape (..., 6)
        Plücker vector of the axis: unit direction, then moment about the origin.
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
        Angular velocity (rad/s), then velocity (length/s).

    References
    ----------
    Lynch and Park 2017, as the spatial twist.

    Examples
    --------
    A body at x = 1 that turns about its own z axis at 3 rad/s.

    >>> twist_in_fixed_frame([1, 0, 0, 0, 0, 0.5, 0, 0], [0, 0, 0, 1.5, 0, 0, -0.75, 0]) + 0.0
    array([ 0.,  0.,  3.,  0., -3.,  0.])
    """
    product = 2.0 * dual_quaternion.multiply(derivative, dual_quaternion.conjugate(dual_quat))
    return product[..., [1, 2, 3, 5, 6, 7]]


def twist_in_body_frame(dual_quat: ArrayLike, derivative: ArrayLike) -> Float:
    """Twist ``2 Q* Q'`` in the body's frame: angular velocity, then velocity of the body's origin.

    Parameters
    ----------
    dual_quat, derivative : array_like, shape (..., 8)
        Unit dual quaternions and their derivatives by time.

    Returns
    -------
    ndarray, shape (..., 6)
        Angular velocity (rad/s), then velocity (length/s), both along the body's axes.

    References
    ----------
    Lynch and Park 2017, as the body twist.

    Examples
    --------
    A body at x = 1 that turns about its own z axis at 3 rad/s.

    >>> twist_in_body_frame([1, 0, 0, 0, 0, 0.5, 0, 0], [0, 0, 0, 1.5, 0, 0, -0.75, 0]) + 0.0
    array([0., 0., 3., 0., 0., 0.])
    """
    product = 2.0 * dual_quaternion.multiply(dual_quaternion.conjugate(dual_quat), derivative)
    return product[..., [1, 2, 3, 5, 6, 7]]


def adjoint(dual_quat: ArrayLike) -> Float:
    """Matrices that write a body's twist in the fixed frame: ``[[R, 0], [[d]x R, R]]``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions, body to fixed frame.

    Returns
    -------
    ndarray, shape (..., 6, 6)

    References
    ----------
    Lynch and Park 2017.

    Examples
    --------
    >>> adjoint([1, 0, 0, 0, 0, 0.5, 0, 0]) @ [0, 0, 3, 0, 0, 0] + 0.0
    array([ 0.,  0.,  3.,  0., -3.,  0.])
    """
    shape = np.shape(dual_quat)[:-1]
    blocks = in_blocks(_rows.adjoint_blocks, dual_quat, width=18).reshape(*shape, 2, 3, 3)
    matrix = np.zeros((*shape, 6, 6))
    matrix[..., :3, :3] = matrix[..., 3:, 3:] = blocks[..., 0, :, :]
    matrix[..., 3:, :3] = blocks[..., 1, :, :]
    return matrix


def inverse_left_jacobian(twist: ArrayLike) -> Float:
    """How the logarithm of a displacement changes with a small one before it: ``log(exp(c) exp(r)) = r + J c``.

    Parameters
    ----------
    twist : array_like, shape (..., 6)
        The logarithm r: rotation (rad), then translation.

    Returns
    -------
    ndarray, shape (..., 6, 6)
        To 1e-8 for rotations up to 0.3 rad, to 1e-5 up to 1 rad, to 1 % up to half a turn (and lengths of 1).

    References
    ----------
    Solà, Deray and Atchuthan 2018, A micro Lie theory for state estimation in robotics. The series
    ``x/(1 - exp(-x)) = 1 + x/2 + x^2/12 - x^4/720 + x^6/30240``, x the matrix ``-[[w]x 0; [v]x [w]x]``.

    Examples
    --------
    >>> inverse_left_jacobian([0, 0, 0.1, 0, 0, 0]) @ [1e-6, 0, 0, 0, 0, 0] * 1e6 + 0.0
    array([ 0.99916653, -0.05      ,  0.        ,  0.        ,  0.        ,
            0.        ])
    """
    r = np.asarray(twist, dtype=np.float64)
    x = np.zeros((*r.shape, 6))
    for first in (0, 3):
        a, b, c = np.moveaxis(r[..., first : first + 3], -1, 0)
        x[..., first, 1], x[..., first, 2] = c, -b
        x[..., first + 1, 0], x[..., first + 1, 2] = -c, a
        x[..., first + 2, 0], x[..., first + 2, 1] = b, -a
    x[..., 3:, 3:] = x[..., :3, :3]
    second = x @ x
    fourth = second @ second
    sixth = fourth @ second
    x /= 2.0
    x += np.eye(6)
    for power, divisor in ((second, 12.0), (fourth, -720.0), (sixth, 30_240.0)):
        power /= divisor
        x += power
    return x


def integrate_twist(start: ArrayLike, twist: ArrayLike, time_step: ArrayLike) -> Float:
    """Pose after moving with a constant body twist for a time: ``Q exp(twist time / 2)``.

    Parameters
    ----------
    start : array_like, shape (..., 8)
        Unit dual quaternions.
    twist : array_like, shape (..., 6)
        Twist in the body's frame: angular velocity (rad/s), then velocity (length/s).
    time_step : array_like, shape (...)
        Seconds. Shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 45.

    Examples
    --------
    Half a turn about z in two seconds, rising at 1/s.

    >>> integrate_twist([1, 0, 0, 0, 0, 0, 0, 0], [0, 0, np.pi / 2, 0, 0, 1], 2).round(12) + 0.0
    array([ 0.,  0.,  0.,  1., -1.,  0.,  0.,  0.])
    """
    half = 0.5 * np.asarray(twist, dtype=np.float64) * np.asarray(time_step, dtype=np.float64)[..., None]
    return dual_quaternion.multiply(start, dual_quaternion.exp(half))


def instantaneous_screw(twist: ArrayLike) -> InstantaneousScrew:
    """Instantaneous helical axis: direction ``w/|w|``, moment ``(v - (v.n) n)/|w|``, pitch ``v.w/|w|^2``.

    Parameters
    ----------
    twist : array_like, shape (..., 6)
        In the frame the axis is wanted in: angular velocity w (rad/s), then velocity v (length/s).

    Returns
    -------
    InstantaneousScrew
        Pitch and line are NaN where there is no rotation.

    References
    ----------
    Bottema and Roth 1979.

    Examples
    --------
    >>> screw = instantaneous_screw([0, 0, 3, 0, -3, 6])
    >>> float(screw.rate), float(screw.pitch), screw.line + 0.0
    (3.0, 2.0, array([ 0.,  0.,  1.,  0., -1.,  0.]))
    """
    t = np.asarray(twist, dtype=np.float64)
    w, v = t[..., :3], t[..., 3:]
    rate = length(w)
    direction = divide(w, rate[..., None])
    along = np.sum(v * direction, axis=-1)
    moment = divide(v - along[..., None] * direction, rate[..., None])
    return InstantaneousScrew(rate, divide(along, rate), np.concatenate([direction, moment], axis=-1))
