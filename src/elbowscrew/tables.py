"""The only list of column names: what stands in ``screw.csv`` and ``interpolation.csv``, in which order and unit.

The results themselves hold SI units and radians; a column says where its values come from and what kind of quantity
they are, and `columns` turns a result into named columns in the units asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd

AngleUnit = Literal["deg", "rad"]
LengthUnit = Literal["mm", "m"]

METERS: Final[dict[str, float]] = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""Meters in one unit of length."""


class Quantity(Enum):
    """What a column holds, and so how it is scaled, named and written."""

    INTEGER = "integer"
    NUMBER = "number"
    ANGLE = "angle"
    LENGTH = "length"
    ANGULAR_VELOCITY = "angular velocity"
    VELOCITY = "velocity"
    LABEL = "label"


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column: its name without unit, where its values are found, and their kind."""

    name: str
    values: Callable[[Any], NDArray[Any]]
    quantity: Quantity


def _column(name: str, attribute: str, quantity: Quantity) -> Column:
    return Column(name=name, values=attrgetter(attribute), quantity=quantity)


def _components(names: tuple[str, ...], attribute: str, quantity: Quantity) -> tuple[Column, ...]:
    def component(k: int) -> Callable[[Any], NDArray[Any]]:
        return lambda result: attrgetter(attribute)(result)[:, k]

    return tuple(Column(name=name, values=component(k), quantity=quantity) for k, name in enumerate(names))


_DISPLACEMENT: Final = (
    *_components(("e0", "e1", "e2", "e3"), "euler_parameters", Quantity.NUMBER),
    *_components(("d_x", "d_y", "d_z"), "translation", Quantity.LENGTH),
)

_AXIS: Final = (
    *_components(("axis_x", "axis_y", "axis_z"), "axis_direction", Quantity.NUMBER),
    *_components(("point_x", "point_y", "point_z"), "axis_point", Quantity.LENGTH),
)
_ERRORS: Final = (
    _column("theta_sd", "angle_sd", Quantity.ANGLE),
    _column("slide_sd", "slide_sd", Quantity.LENGTH),
    _column("axis_sd", "axis_sd", Quantity.ANGLE),
    _column("point_sd", "point_sd", Quantity.LENGTH),
    _column("axis_cone95", "axis_cone", Quantity.ANGLE),
    _column("point_radius95", "point_radius", Quantity.LENGTH),
)

SCREW_COLUMNS: Final = (
    _column("frame", "frame", Quantity.INTEGER),
    _column("time_s", "time_s", Quantity.NUMBER),
    _column("valid", "valid", Quantity.INTEGER),
    _column("theta", "angle", Quantity.ANGLE),
    _column("slide", "slide", Quantity.LENGTH),
    *_AXIS,
    *_DISPLACEMENT,
    _column("filled", "filled", Quantity.INTEGER),
    _column("arm_loss", "arm_loss", Quantity.LABEL),
    _column("forearm_loss", "forearm_loss", Quantity.LABEL),
    *_ERRORS,
)

INSTANTANEOUS_COLUMNS: Final = (
    _column("frame", "frame", Quantity.INTEGER),
    _column("time_s", "time_s", Quantity.NUMBER),
    _column("angular_velocity", "angular_velocity", Quantity.ANGULAR_VELOCITY),
    _column("slide_velocity", "slide_velocity", Quantity.VELOCITY),
    *_AXIS,
)

STEP_COLUMNS: Final = (
    _column("start_frame", "start_frame", Quantity.INTEGER),
    _column("end_frame", "end_frame", Quantity.INTEGER),
    _column("start_time_s", "start_time_s", Quantity.NUMBER),
    _column("end_time_s", "end_time_s", Quantity.NUMBER),
    _column("theta", "angle", Quantity.ANGLE),
    _column("slide", "slide", Quantity.LENGTH),
    *_AXIS,
    *_ERRORS,
)

REPETITION_COLUMNS: Final = (
    *(_column(name, name, Quantity.INTEGER) for name in ("number", "start_frame", "inversion_frame", "end_frame")),
    *(_column(name, name, Quantity.NUMBER) for name in ("start_time_s", "end_time_s", "duration_s")),
    _column("theta_start", "start_angle", Quantity.ANGLE),
    _column("theta_max", "top_angle", Quantity.ANGLE),
    _column("theta_range", "angle_range", Quantity.ANGLE),
    _column("slide_range", "slide_range", Quantity.LENGTH),
    _column("flexion_speed", "flexion_speed", Quantity.ANGULAR_VELOCITY),
    _column("extension_speed", "extension_speed", Quantity.ANGULAR_VELOCITY),
    *_AXIS,
    _column("axis_deviation", "axis_deviation", Quantity.ANGLE),
)

CURVE_COLUMNS: Final = (
    _column("percent", "percent", Quantity.NUMBER),
    _column("theta_mean", "mean", Quantity.ANGLE),
    _column("theta_sd", "sd", Quantity.ANGLE),
    _column("count", "count", Quantity.INTEGER),
)

ANATOMY_COLUMNS: Final = (
    _column("frame", "frame", Quantity.INTEGER),
    _column("time_s", "time_s", Quantity.NUMBER),
    _column("flexion", "flexion", Quantity.ANGLE),
    _column("carrying", "carrying", Quantity.ANGLE),
    _column("pronation", "pronation", Quantity.ANGLE),
    _column("axis_angle", "axis_angle", Quantity.ANGLE),
    _column("axis_distance", "axis_distance", Quantity.LENGTH),
)

MOTION_COLUMNS: Final = (
    _column("frame", "frame", Quantity.INTEGER),
    _column("time_s", "time_s", Quantity.NUMBER),
    _column("phase", "phase", Quantity.INTEGER),
    _column("t", "fraction", Quantity.NUMBER),
    _column("theta", "angle", Quantity.ANGLE),
    _column("slide", "slide", Quantity.LENGTH),
    *_DISPLACEMENT,
)

INTERPOLATION_COLUMNS: Final = (
    *MOTION_COLUMNS,
    _column("angle_error", "angle_error", Quantity.ANGLE),
    _column("translation_error", "translation_error", Quantity.LENGTH),
    _column("rms_displacement", "rms_displacement", Quantity.LENGTH),
    _column("axis_error", "axis_error", Quantity.ANGLE),
    _column("axis_distance", "axis_distance", Quantity.LENGTH),
)

KEYFRAME_COLUMNS: Final = (
    _column("frame", "frame", Quantity.INTEGER),
    _column("time_s", "time_s", Quantity.NUMBER),
    _column("phase", "phase", Quantity.INTEGER),
    _column("knot", "knot", Quantity.NUMBER),
    _column("theta", "angle", Quantity.ANGLE),
    *_DISPLACEMENT,
    _column("method", "method_of_each", Quantity.LABEL),
    _column("blend", "blend_of_each", Quantity.LABEL),
    _column("law", "law_of_each", Quantity.LABEL),
    _column("law_peak", "peak_of_each", Quantity.NUMBER),
    _column("law_start_s", "law_start_of_each", Quantity.NUMBER),
    _column("law_end_s", "law_end_of_each", Quantity.NUMBER),
)

_MODEL: Final = (
    _column("rank", "rank", Quantity.INTEGER),
    *(_column(name, name, Quantity.LABEL) for name in ("data", "method", "blend", "law", "knots")),
    _column("keyframes_per_phase", "keyframes_per_phase", Quantity.INTEGER),
)

COMPARISON_COLUMNS: Final = (
    *_MODEL,
    _column("keyframes", "keyframes", Quantity.INTEGER),
    _column("rms_displacement", "rms_displacement", Quantity.LENGTH),
    _column("max_displacement", "max_displacement", Quantity.LENGTH),
    _column("max_displacement_frame", "max_displacement_frame", Quantity.INTEGER),
    *(_column(f"{kind}_angle_error", f"{kind}_angle_error", Quantity.ANGLE) for kind in ("rms", "max")),
    *(_column(f"{kind}_translation_error", f"{kind}_translation_error", Quantity.LENGTH) for kind in ("rms", "max")),
    *(_column(f"{kind}_axis_error", f"{kind}_axis_error", Quantity.ANGLE) for kind in ("rms", "max")),
    *(_column(f"{kind}_axis_distance", f"{kind}_axis_distance", Quantity.LENGTH) for kind in ("rms", "max")),
    _column("ns_per_frame", "ns_per_frame", Quantity.NUMBER),
    _column("note", "note", Quantity.LABEL),
)

TRIALS_COMPARISON_COLUMNS: Final = (
    *_MODEL,
    _column("trials", "trials", Quantity.INTEGER),
    *(_column(f"rms_displacement_{kind}", f"rms_displacement_{kind}", Quantity.LENGTH) for kind in ("mean", "sd")),
    *(_column(f"max_displacement_{kind}", f"max_displacement_{kind}", Quantity.LENGTH) for kind in ("mean", "sd")),
    *(_column(f"rms_angle_error_{kind}", f"rms_angle_error_{kind}", Quantity.ANGLE) for kind in ("mean", "sd")),
    *(_column(f"max_angle_error_{kind}", f"max_angle_error_{kind}", Quantity.ANGLE) for kind in ("mean", "sd")),
    *(_column(f"ns_per_frame_{kind}", f"ns_per_frame_{kind}", Quantity.NUMBER) for kind in ("mean", "sd")),
)


def angle_in(radians: NDArray[np.float64], unit: AngleUnit) -> NDArray[np.float64]:
    """Angles in the unit asked for."""
    return np.degrees(radians) if unit == "deg" else radians


def length_in(meters: NDArray[np.float64], unit: LengthUnit) -> NDArray[np.float64]:
    """Lengths in the unit asked for."""
    return meters * 1000.0 if unit == "mm" else meters


def columns(
    result: object, table: tuple[Column, ...], angle_unit: AngleUnit, length_unit: LengthUnit
) -> dict[str, NDArray[Any]]:
    """Named columns of a result, in order; floats are NaN and masked integers masked where nothing is known."""
    named: dict[str, NDArray[Any]] = {}
    for column in table:
        values = column.values(result)
        match column.quantity:
            case Quantity.ANGLE:
                named[f"{column.name}_{angle_unit}"] = angle_in(values, angle_unit)
            case Quantity.LENGTH:
                named[f"{column.name}_{length_unit}"] = length_in(values, length_unit)
            case Quantity.ANGULAR_VELOCITY:
                named[f"{column.name}_{angle_unit}_s"] = angle_in(values, angle_unit)
            case Quantity.VELOCITY:
                named[f"{column.name}_{length_unit}_s"] = length_in(values, length_unit)
            case Quantity.INTEGER:
                named[column.name] = values.astype(np.int64)
            case Quantity.NUMBER | Quantity.LABEL:
                named[column.name] = values
    return named


def data_frame(
    result: object, table: tuple[Column, ...], angle_unit: AngleUnit, length_unit: LengthUnit
) -> pd.DataFrame:
    """Return the columns as a pandas data frame, the same names and values as in the CSV."""
    import pandas as pd

    named = columns(result, table, angle_unit, length_unit)
    return pd.DataFrame(
        {
            name: pd.Series(values.filled(0), dtype="Int64").mask(np.ma.getmaskarray(values))
            if isinstance(values, np.ma.MaskedArray)
            else values
            for name, values in named.items()
        }
    )
