"""Finite helical axis of every frame: angle, slide and line."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry import point_nearest_origin, screw_from_dual_quat
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float


class HelicalSeries(NamedTuple):
    """Screws of a series of displacements with one sense of the axis throughout.

    Attributes
    ----------
    angle : ndarray, shape (..., N)
        Radians; NaN where there is no pose.
    slide : ndarray, shape (..., N)
    line : ndarray, shape (..., N, 6)
        Plücker vector of the axis; as the slide, NaN where the rotation is too small for an axis.
    """

    angle: Float
    slide: Float
    line: Float

    @property
    def direction(self) -> Float:
        """Unit direction of each axis, shape (..., N, 3)."""
        return self.line[..., :3]

    @property
    def point(self) -> Float:
        """Point of each axis nearest the origin, shape (..., N, 3)."""
        return point_nearest_origin(self.line)


def helical_series(displacement: Float, min_angle: float, angle: Float, sign: Float) -> HelicalSeries:
    """Screw of every displacement, about an axis whose sense is given.

    Parameters
    ----------
    displacement : ndarray, shape (..., N, 8)
        Unit dual quaternions, each of any sign; NaN where there is none.
    min_angle : float
        Radians; no axis is given where the rotation is less than this (or nearer than this to a full turn).
    angle : ndarray, shape (..., N)
        Theta, radians, sense and whole turns included (`elbowscrew.motion.screws.sense`).
    sign : ndarray, shape (..., N)
        1 or -1: the axis of theta is that of the quaternion with a positive scalar part times this.
    """
    positive = np.where(displacement[..., :1] < 0.0, -displacement, displacement)
    screw = screw_from_dual_quat(positive)
    axis = np.where(length(positive[..., 1:4]) >= np.sin(0.5 * min_angle), sign, np.nan)
    line = np.concatenate([screw.direction, screw.moment], axis=-1)
    line *= axis[..., None]
    return HelicalSeries(angle, screw.slide * axis, line)
