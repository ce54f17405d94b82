"""Movements between rests, and the repetitions of a movement; frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.table_record import TableRecord

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MovementPhases(ArrayRecord):
    """When the joint moves and when it rests.

    Attributes
    ----------
    onset_rows, offset_rows : ndarray of int, shape (M,)
        First and last row of each movement between rests.
    moving : ndarray of bool, shape (N,)
    """

    onset_rows: NDArray[np.int64]
    offset_rows: NDArray[np.int64]
    moving: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Repetitions(TableRecord):
    """Cycles out and back: a value for each of them.

    Attributes
    ----------
    number : ndarray of int64, shape (R,)
        1, 2, ...
    start_frame, inversion_frame, end_frame : ndarray of int64, shape (R,)
        The frames nearest to the cuts.
    start_time_s, end_time_s, duration_s : ndarray, shape (R,)
        Of the cuts themselves, between frames.
    start_time_sd_s, end_time_sd_s : ndarray, shape (R,)
        Standard deviations of the cuts; NaN where they were given.
    incomplete : ndarray of bool, shape (R,)
        Whether the recording begins or ends on the way.
    start_angle, top_angle, angle_range : ndarray, shape (R,)
        Theta at the start, the largest theta of the cycle's frames, and their range, radians; NaN where they may lie
        among lost frames.
    slide_range : ndarray, shape (R,)
        Largest less smallest slide where there is an axis, meters.
    outward_speed, back_speed : ndarray, shape (R,)
        Largest angular velocity before and after the inversion, rad/s.
    axis_direction, axis_point : ndarray, shape (R, 3)
        Weighted mean of the cycle's finite axes; NaN where it has none.
    axis_deviation : ndarray, shape (R,)
        Angle (rad) of that axis from the mean of all cycles'; NaN where no other cycle has one.
    """

    table: ClassVar = tables.REPETITION_COLUMNS

    number: NDArray[np.int64]
    start_frame: NDArray[np.int64]
    inversion_frame: NDArray[np.int64]
    end_frame: NDArray[np.int64]
    start_time_s: Float
    end_time_s: Float
    start_time_sd_s: Float
    end_time_sd_s: Float
    duration_s: Float
    incomplete: NDArray[np.bool_]
    start_angle: Float
    top_angle: Float
    angle_range: Float
    slide_range: Float
    outward_speed: Float
    back_speed: Float
    axis_direction: Float
    axis_point: Float
    axis_deviation: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Repeatability(TableRecord):
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
        Standard deviations of the cycles' axes about their mean: direction (rad), and position (m) at the distal body.
    top_sd : float
        Of the largest angle, radians.
    """

    table: ClassVar = tables.CURVE_COLUMNS

    percent: Float
    mean: Float
    sd: Float
    count: NDArray[np.int64]
    icc: float
    cmc: float
    axis_sd: float
    point_sd: float
    top_sd: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CycleCurves(TableRecord):
    """Every cycle over its own time, one after the other.

    Attributes
    ----------
    cycle : ndarray of int64, shape (101 R,)
        Number of the cycle.
    percent : ndarray, shape (101 R,)
        Time normalized from its start to its end.
    angle : ndarray, shape (101 R,)
        Radians; NaN where a neighboring frame has none.
    """

    table: ClassVar = tables.CYCLE_COLUMNS

    cycle: NDArray[np.int64]
    percent: Float
    angle: Float

    def to_xarray(self, angle_unit: AngleUnit = "deg", length_unit: LengthUnit = "mm") -> xr.Dataset:
        """Return the curves as an xarray Dataset over ``cycle`` and ``percent``; see `TableRecord.to_xarray`."""
        flat = super(CycleCurves, self).to_xarray(angle_unit, length_unit)  # a class with slots is made twice
        shape = np.unique(self.cycle).size, -1
        curves = flat["theta"].to_numpy().reshape(shape)
        coords = {"cycle": np.unique(self.cycle), "percent": self.percent[: curves.shape[1]]}
        return type(flat)({"theta": (("cycle", "percent"), curves, flat["theta"].attrs)}, coords)
