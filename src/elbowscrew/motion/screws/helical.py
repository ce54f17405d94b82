"""Finite helical axis of every frame: angle, slide and line, continuous in time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import point_nearest_origin, screw_from_dual_quat
from elbowscrew.geometry._small_angle import length

Float = NDArray[np.float64]


class HelicalSeries(NamedTuple):
    """Screws of a series of displacements with one orientation of the axis throughout.

    Attributes
    ----------
    angle : ndarray, shape (N,)
        Radians; NaN where there is no pose.
    slide : ndarray, shape (N,)
    line : ndarray, shape (N, 6)
        Plücker vector of the axis; as the slide, NaN where the rotation is too small for an axis.
    """

    angle: Float
    slide: Float
    line: Float

    def reversed(self) -> HelicalSeries:
        """Describe the same screws about the axis pointing the other way."""
        return HelicalSeries(-self.angle, -self.slide, -self.line)

    @property
    def direction(self) -> Float:
        """Unit direction of each axis, shape (N, 3)."""
        return self.line[:, :3]

    @property
    def point(self) -> Float:
        """Point of each axis nearest the origin, shape (N, 3)."""
        return point_nearest_origin(self.line)


def helical_series(displacement: Float, min_angle: float, anchor_row: int, anchor_angle: float = 0.0) -> HelicalSeries:
    """Screw of every displacement, the axis keeping its direction from frame to frame.

    Where the rotation is large enough for an axis, its direction is taken the way round that is nearer the last such
    frame's; where it is not, the sense of rotation is judged by that axis. So the angle goes on growing through pi
    and goes negative, instead of bouncing, where the motion passes the reference.

    Parameters
    ----------
    displacement : ndarray, shape (N, 8)
        Sign-continuous unit dual quaternions; NaN where there is none.
    min_angle : float
        Radians; no axis is given where the rotation is less than this (or nearer than this to a full turn).
    anchor_row : int
        Row whose angle is known ...
    anchor_angle : float
        ... and its value in radians, sense and full turns included; 0 leaves the sense open.
    """
    screw = screw_from_dual_quat(displacement)
    sine = length(displacement[:, 1:4])
    known = np.flatnonzero(np.isfinite(sine))
    reliable = np.flatnonzero(np.nan_to_num(sine, nan=0.0) >= np.sin(0.5 * min_angle))
    sense = np.ones(sine.size)
    if reliable.size:
        turns = np.sum(screw.direction[reliable[1:]] * screw.direction[reliable[:-1]], axis=1) < 0.0
        sense[reliable] = np.cumprod(np.concatenate([[1.0], np.where(turns, -1.0, 1.0)]))
        oriented = screw.direction * sense[:, None]
        nearest = reliable[np.clip(np.searchsorted(reliable, known, side="right") - 1, 0, None)]
        judged = np.sum(displacement[known, 1:4] * oriented[nearest], axis=1)
        sense[known] = np.where(judged < 0.0, -1.0, 1.0)
    if sense[anchor_row] * np.sin(0.5 * anchor_angle) < 0.0:
        sense = -sense
    half = np.arctan2(sense * sine, displacement[:, 0])
    half[known] = np.unwrap(half[known])
    half -= 2.0 * np.pi * np.round((half[anchor_row] - 0.5 * anchor_angle) / (2.0 * np.pi))
    axis = np.full(sine.size, np.nan)
    axis[reliable] = sense[reliable]
    line = np.concatenate([screw.direction, screw.moment], axis=1)
    line *= axis[:, None]
    return HelicalSeries(2.0 * half, screw.slide * axis, line)
