"""Axes of the motion from pose to pose and of the moment; frozen, in SI units and radians; NaN where not known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.table_record import TableRecord


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class InstantaneousMotion(TableRecord):
    """Instantaneous helical axis of every frame, in the frame the screws are expressed in.

    Attributes
    ----------
    frame, time_s : ndarray, shape (N,)
    angular_velocity : ndarray, shape (N,)
        About the axis, rad/s, positive as the angle grows.
    slide_velocity : ndarray, shape (N,)
        Along the axis, m/s; as the axis, NaN where the distal body turns too slowly.
    axis_direction, axis_point : ndarray, shape (N, 3)
        Unit direction, and the point (m) nearest the origin.
    lowpass_hz : float or None
        Cut-off of the filter that the poses went through; None of a clock of several rates, on which none is right.
    """

    table: ClassVar = tables.INSTANTANEOUS_COLUMNS

    frame: NDArray[np.int64]
    time_s: Float
    lowpass_hz: float | None
    angular_velocity: Float
    slide_velocity: Float
    axis_direction: Float
    axis_point: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class HelicalSteps(TableRecord):
    """Finite helical axes between successive poses, in the frame the screws are expressed in.

    Attributes
    ----------
    start_frame, end_frame : ndarray of int64, shape (K,)
    start_time_s, end_time_s : ndarray, shape (K,)
    angle, slide : ndarray, shape (K,)
        About and along the axis, rad and m; negative on the way back.
    axis_direction, axis_point : ndarray, shape (K, 3)
        Unit direction, the same way round throughout, and the point (m) nearest the origin.
    angle_sd, slide_sd, axis_sd, point_sd, axis_cone, point_radius : ndarray, shape (K,)
        As in `ScrewMotion`.
    """

    table: ClassVar = tables.STEP_COLUMNS

    start_frame: NDArray[np.int64]
    end_frame: NDArray[np.int64]
    start_time_s: Float
    end_time_s: Float
    angle: Float
    slide: Float
    axis_direction: Float
    axis_point: Float
    angle_sd: Float
    slide_sd: Float
    axis_sd: Float
    point_sd: Float
    axis_cone: Float
    point_radius: Float
