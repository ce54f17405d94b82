"""Movements between rests, and the repetitions of a movement; frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.model.brief import Brief

if TYPE_CHECKING:
    import pandas as pd

Float = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MovementPhases(Brief):
    """When the joint moves and when it rests.

    Attributes
    ----------
    onset_rows, offset_rows : ndarray of int, shape (M,)
        First and last row of each movement between rests.
    moving : ndarray of bool, shape (N,)
    threshold : float
        Angular velocity (rad/s) that counts as movement.
    """

    onset_rows: NDArray[np.int64]
    offset_rows: NDArray[np.int64]
    moving: NDArray[np.bool_]
    threshold: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Repetitions(Brief):
    """Flexion-extension cycles: a value for each of them.

    Attributes
    ----------
    number : ndarray of int64, shape (R,)
        1, 2, ...
    start_frame, inversion_frame, end_frame : ndarray of int64, shape (R,)
    start_time_s, end_time_s, duration_s : ndarray, shape (R,)
    start_angle, top_angle, angle_range : ndarray, shape (R,)
        Radians; the range is that of the cycle.
    slide_range : ndarray, shape (R,)
        Largest less smallest slide where there is an axis, meters.
    flexion_speed, extension_speed : ndarray, shape (R,)
        Largest angular velocity before and after the inversion, rad/s.
    axis_direction, axis_point : ndarray, shape (R, 3)
        Weighted mean of the cycle's finite axes; NaN where it has none.
    axis_deviation : ndarray, shape (R,)
        Angle (rad) of that axis from the mean of all cycles'.
    """

    number: NDArray[np.int64]
    start_frame: NDArray[np.int64]
    inversion_frame: NDArray[np.int64]
    end_frame: NDArray[np.int64]
    start_time_s: Float
    end_time_s: Float
    duration_s: Float
    start_angle: Float
    top_angle: Float
    angle_range: Float
    slide_range: Float
    flexion_speed: Float
    extension_speed: Float
    axis_direction: Float
    axis_point: Float
    axis_deviation: Float

    def to_frame(self, angle_unit: tables.AngleUnit = "deg", length_unit: tables.LengthUnit = "mm") -> pd.DataFrame:
        """Return the columns of ``repetitions.csv``."""
        return tables.data_frame(self, tables.REPETITION_COLUMNS, angle_unit, length_unit)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Repeatability(Brief):
    """How alike the repetitions are; NaN where fewer than two do not say.

    Attributes
    ----------
    percent, mean, sd : ndarray, shape (101,)
        Time normalized over the cycle, and the angle's mean and standard deviation (rad) over the cycles there.
    count : ndarray of int64, shape (101,)
        Cycles with a known angle there.
    icc : float
        Intraclass correlation for absolute agreement of single curves, ICC(A,1): points of time by repetitions.
    cmc : float
        Coefficient of multiple correlation within a day.
    axis_sd, point_sd : float
        Standard deviations of the cycles' axes about their mean: direction (rad), and place (m) at the forearm.
    top_sd : float
        Of the largest angle, radians.
    """

    percent: Float
    mean: Float
    sd: Float
    count: NDArray[np.int64]
    icc: float
    cmc: float
    axis_sd: float
    point_sd: float
    top_sd: float

    def to_frame(self, angle_unit: tables.AngleUnit = "deg", length_unit: tables.LengthUnit = "mm") -> pd.DataFrame:
        """Return the columns of ``repetition_curve.csv``."""
        return tables.data_frame(self, tables.CURVE_COLUMNS, angle_unit, length_unit)
