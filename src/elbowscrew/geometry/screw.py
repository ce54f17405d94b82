"""Screw parameters of a displacement: dual angle and line."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import quaternion
from elbowscrew.geometry._small_angle import divide, length


class Screw(NamedTuple):
    """A screw displacement: turn by ``angle`` about a line and slide along it.

    Attributes
    ----------
    angle : ndarray, shape (...)
        Rotation theta, radians.
    slide : ndarray, shape (...)
        Translation s along the axis, in the unit of length of the pose.
    direction : ndarray, shape (..., 3)
        Unit vector h of the axis.
    moment : ndarray, shape (..., 3)
        Moment ``m = p x h`` of the axis about the origin, p any point of it.
    """

    angle: NDArray[np.float64]
    slide: NDArray[np.float64]
    direction: NDArray[np.float64]
    moment: NDArray[np.float64]

    @property
    def point(self) -> NDArray[np.float64]:
        """The point of the axis nearest the origin, ``h x m``, shape (..., 3)."""
        return np.cross(self.direction, self.moment)


def screw_from_dual_quat(dual_quat: ArrayLike) -> Screw:
    """Screw parameters of unit dual quaternions.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)

    Returns
    -------
    Screw
        The angle is ``2 atan2(|v|, w)`` in [0, 2 pi], never an arccosine or arcsine; ``-Q`` gives ``2 pi - angle``
        about the opposite axis. Without rotation (|v| = 0) the motion is a translation: angle 0 (or 2 pi), slide |d|,
        direction d/|d|, and the *place* of the axis is not defined: NaN. For the identity the direction is NaN too.
        The moment loses digits as ``|d|/theta``, which is the conditioning of the axis itself.

    References
    ----------
    P 7, 14, 15.

    Examples
    --------
    The numerical example of P section 2: a quarter turn about z after a shift by (2, 2, 1).

    >>> from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
    >>> screw = screw_from_dual_quat(dual_quat_from_pose([0.5**0.5, 0, 0, 0.5**0.5], [2, 2, 1]))
    >>> round(float(screw.angle), 6), round(float(screw.slide), 6), screw.point.round(6) + 0.0
    (1.570796, 1.0, array([0., 2., 0.]))
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    w, v, w0, v0 = Q[..., 0], Q[..., 1:4], Q[..., 4], Q[..., 5:]
    sine = length(v)
    turning = sine > 0.0
    position = 2.0 * quaternion.multiply(Q[..., 4:], quaternion.conjugate(Q[..., :4]))[..., 1:]
    distance = length(position)
    direction = np.where(turning[..., None], divide(v, sine[..., None]), divide(position, distance[..., None]))
    slide = np.where(turning, divide(-2.0 * w0, sine), distance)
    moment = divide(v0 - direction * (0.5 * slide * w)[..., None], sine[..., None])
    return Screw(2.0 * np.arctan2(sine, w), slide, direction, moment)


def dual_quat_from_screw(
    angle: ArrayLike, slide: ArrayLike, direction: ArrayLike, moment: ArrayLike
) -> NDArray[np.float64]:
    """Unit dual quaternions of screw displacements, ``cos(th/2) + sin(th/2) h`` with a dual angle and a dual line.

    Parameters
    ----------
    angle, slide : array_like, shape (...)
        Rotation in radians, translation along the axis.
    direction, moment : array_like, shape (..., 3)
        Unit direction h and moment p x h of the axis.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 2, 45.
    """
    half = 0.5 * np.asarray(angle, dtype=np.float64)[..., None]
    half_slide = 0.5 * np.asarray(slide, dtype=np.float64)[..., None]
    h = np.asarray(direction, dtype=np.float64)
    m = np.asarray(moment, dtype=np.float64)
    cosine, sine = np.cos(half), np.sin(half)
    parts = [cosine, sine * h, -half_slide * sine, sine * m + half_slide * cosine * h]
    shape = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
    return np.concatenate([np.broadcast_to(part, (*shape, part.shape[-1])) for part in parts], axis=-1)


def line_through(point: ArrayLike, direction: ArrayLike) -> NDArray[np.float64]:
    """Plücker vector (..., 6) of the line through a point (..., 3) along a direction (..., 3): h, then ``p x h``.

    The direction is normalized. P 19.
    """
    p = np.asarray(point, dtype=np.float64)
    h = np.asarray(direction, dtype=np.float64)
    h = divide(h, length(h)[..., None])
    moment = np.cross(p, h)
    return np.concatenate([np.broadcast_to(h, moment.shape), moment], axis=-1)


def point_nearest_origin(line: ArrayLike) -> NDArray[np.float64]:
    """The point ``h x m``, shape (..., 3), of lines (..., 6) that is nearest the origin."""
    plucker = np.asarray(line, dtype=np.float64)
    return np.cross(plucker[..., :3], plucker[..., 3:])
