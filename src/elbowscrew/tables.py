"""The only list of column names: what stands in ``screw.csv`` and ``interpolation.csv``, in which order and unit.

The results themselves hold SI units and radians; a column says where its values come from and what kind of quantity
they are; `TableRecord.columns` turns a result into named columns in the units asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew.quantities import Quantity


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column: its name without unit, the attribute that holds its values, and their kind."""

    name: str
    attribute: str
    component: int | None = None
    quantity: Quantity

    def values(self, result: object) -> NDArray[Any]:
        """Values of the column, in SI units and radians."""
        found: NDArray[Any] = getattr(result, self.attribute)
        return found if self.component is None else found[:, self.component]


def _column(name: str, attribute: str, quantity: Quantity) -> Column:
    return Column(name=name, attribute=attribute, quantity=quantity)


def _components(names: tuple[str, ...], attribute: str, quantity: Quantity) -> tuple[Column, ...]:
    return tuple(Column(name=name, attribute=attribute, component=k, quantity=quantity) for k, name in enumerate(names))


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
    _column("valid", "valid", Quantity.FLAG),
    _column("theta", "angle", Quantity.ANGLE),
    _column("slide", "slide", Quantity.LENGTH),
    *_AXIS,
    *_DISPLACEMENT,
    _column("filled", "filled", Quantity.FLAG),
    _column("proximal_loss", "proximal_loss", Quantity.LABEL),
    _column("distal_loss", "distal_loss", Quantity.LABEL),
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
    _column("start_time_sd_s", "start_time_sd_s", Quantity.NUMBER),
    _column("end_time_sd_s", "end_time_sd_s", Quantity.NUMBER),
    _column("incomplete", "incomplete", Quantity.FLAG),
    _column("theta_start", "start_angle", Quantity.ANGLE),
    _column("theta_max", "top_angle", Quantity.ANGLE),
    _column("theta_range", "angle_range", Quantity.ANGLE),
    _column("slide_range", "slide_range", Quantity.LENGTH),
    _column("outward_speed", "outward_speed", Quantity.ANGULAR_VELOCITY),
    _column("back_speed", "back_speed", Quantity.ANGULAR_VELOCITY),
    *_AXIS,
    _column("axis_deviation", "axis_deviation", Quantity.ANGLE),
)

CURVE_COLUMNS: Final = (
    _column("percent", "percent", Quantity.NUMBER),
    _column("theta_mean", "mean", Quantity.ANGLE),
    _column("theta_sd", "sd", Quantity.ANGLE),
    _column("count", "count", Quantity.INTEGER),
)

CYCLE_COLUMNS: Final = (
    _column("cycle", "cycle", Quantity.INTEGER),
    _column("percent", "percent", Quantity.NUMBER),
    _column("theta", "angle", Quantity.ANGLE),
)


def _anatomy(**angles: str) -> tuple[Column, ...]:
    """Columns of a joint whose angles have these names, each of an attribute."""
    return (
        _column("frame", "frame", Quantity.INTEGER),
        _column("time_s", "time_s", Quantity.NUMBER),
        *(_column(name, attribute, Quantity.ANGLE) for name, attribute in angles.items()),
        _column("axis_angle", "axis_angle", Quantity.ANGLE),
        _column("axis_distance", "axis_distance", Quantity.LENGTH),
    )


ANATOMY_COLUMNS: Final[dict[Literal["elbow", "knee"], tuple[Column, ...]]] = {
    "elbow": _anatomy(flexion="flexion", carrying="carrying_angle", pronation="pronation"),
    "knee": _anatomy(flexion="flexion", adduction="adduction", internal_rotation="internal_rotation"),
}
"""By the joint that the landmarks are of."""


def _joint_angles(*names: str) -> tuple[Column, ...]:
    """Columns of a joint with these angles, each with its standard deviation."""
    angles = [
        Column(name=name + ending, attribute=attribute, component=k, quantity=Quantity.ANGLE)
        for k, name in enumerate(names)
        for ending, attribute in (("", "angle"), ("_sd", "angle_sd"))
    ]
    return (
        _column("frame", "frame", Quantity.INTEGER),
        _column("time_s", "time_s", Quantity.NUMBER),
        *angles,
        _column("residual", "residual_rotation", Quantity.ANGLE),
        _column("residual", "residual_translation", Quantity.LENGTH),
    )


JOINT_ANGLE_COLUMNS: Final = {
    1: _joint_angles("angle1"),
    2: _joint_angles("angle1", "angle2"),
    3: _joint_angles("rotation_x", "rotation_y", "rotation_z"),
}
"""Columns of ``joint_angles.csv``, by how many angles the joint has."""

AXIS_PATH_COLUMNS: Final = (
    _column("angle", "angle", Quantity.ANGLE),
    *_components(("axis_x", "axis_y", "axis_z"), "direction", Quantity.NUMBER),
    *_components(("point_x", "point_y", "point_z"), "point", Quantity.LENGTH),
    _column("axis_sd", "axis_sd", Quantity.ANGLE),
    _column("point_sd", "point_sd", Quantity.LENGTH),
    _column("frames", "frames", Quantity.INTEGER),
)

MOTION_COLUMNS: Final = (
    _column("frame", "frame", Quantity.INTEGER),
    _column("time_s", "time_s", Quantity.NUMBER),
    _column("phase", "phase", Quantity.MASKED_INTEGER),
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


def _shared(first: int, stem: str, quantity: Quantity, letters: Sequence[str] = "xyz") -> tuple[Column, ...]:
    """Columns of what all poses of a joint share, from a place on in `KeyframeSet.shared_of_each`."""
    return tuple(
        Column(name=f"{stem}{letter}", attribute="shared_of_each", component=first + k, quantity=quantity)
        for k, letter in enumerate(letters)
    )


_JOINT_TYPE: Final = (_column("joint_type", "joint_of_each", Quantity.LABEL),)
_FIRST: Final = (*_shared(0, "axis1_", Quantity.NUMBER), *_shared(3, "point1_", Quantity.LENGTH))
_SECOND: Final = (*_shared(6, "axis2_", Quantity.NUMBER), *_shared(9, "point2_", Quantity.LENGTH))
_END: Final = (*_shared(13, "end_e", Quantity.NUMBER, "0123"), *_shared(17, "end_", Quantity.LENGTH))


def _joint_angle(*names: str) -> tuple[Column, ...]:
    return tuple(
        Column(name=name, attribute="joint_angle", component=k, quantity=Quantity.ANGLE) for k, name in enumerate(names)
    )


KEYFRAME_JOINT_COLUMNS: Final = {
    "hinge": (*_JOINT_TYPE, *_joint_angle("angle1"), *_FIRST, *_END),
    "screw_hinge": (
        *_JOINT_TYPE,
        *_joint_angle("angle1"),
        *_FIRST,
        *_shared(12, "slide_per_radian", Quantity.LENGTH, ("",)),
        *_END,
    ),
    "two_axes": (*_JOINT_TYPE, *_joint_angle("angle1", "angle2"), *_FIRST, *_SECOND, *_END),
    "ball": (
        *_JOINT_TYPE,
        *_joint_angle("rotation_x", "rotation_y", "rotation_z"),
        *_shared(3, "center_", Quantity.LENGTH),
        *_END,
    ),
}
"""Columns that follow in ``keyframes.csv`` where the joint's own angles are interpolated, by its type."""

_COMPARED: Final = (
    _column("rank", "rank", Quantity.INTEGER),
    *(_column(name, name, Quantity.LABEL) for name in ("data", "method", "blend", "law", "knots")),
    _column("keyframes_per_phase", "keyframes_per_phase", Quantity.INTEGER),
)

COMPARISON_COLUMNS: Final = (
    *_COMPARED,
    _column("keyframes", "keyframes", Quantity.INTEGER),
    _column("rms_displacement", "rms_displacement", Quantity.LENGTH),
    _column("max_displacement", "max_displacement", Quantity.LENGTH),
    _column("max_displacement_frame", "max_displacement_frame", Quantity.MASKED_INTEGER),
    *(_column(f"{kind}_angle_error", f"{kind}_angle_error", Quantity.ANGLE) for kind in ("rms", "max")),
    *(_column(f"{kind}_translation_error", f"{kind}_translation_error", Quantity.LENGTH) for kind in ("rms", "max")),
    *(_column(f"{kind}_axis_error", f"{kind}_axis_error", Quantity.ANGLE) for kind in ("rms", "max")),
    *(_column(f"{kind}_axis_distance", f"{kind}_axis_distance", Quantity.LENGTH) for kind in ("rms", "max")),
    _column("ns_per_frame", "ns_per_frame", Quantity.NUMBER),
    _column("note", "note", Quantity.LABEL),
)

TRIALS_COMPARISON_COLUMNS: Final = (
    *_COMPARED,
    _column("trials", "trials", Quantity.INTEGER),
    *(_column(f"rms_displacement_{kind}", f"rms_displacement_{kind}", Quantity.LENGTH) for kind in ("mean", "sd")),
    *(_column(f"max_displacement_{kind}", f"max_displacement_{kind}", Quantity.LENGTH) for kind in ("mean", "sd")),
    *(_column(f"rms_angle_error_{kind}", f"rms_angle_error_{kind}", Quantity.ANGLE) for kind in ("mean", "sd")),
    *(_column(f"max_angle_error_{kind}", f"max_angle_error_{kind}", Quantity.ANGLE) for kind in ("mean", "sd")),
    *(_column(f"ns_per_frame_{kind}", f"ns_per_frame_{kind}", Quantity.NUMBER) for kind in ("mean", "sd")),
)

TABLES: Final = {
    "screw": SCREW_COLUMNS,
    "interpolation": INTERPOLATION_COLUMNS,
    "keyframes": KEYFRAME_COLUMNS,
    "instantaneous": INSTANTANEOUS_COLUMNS,
    "steps": STEP_COLUMNS,
    "repetitions": REPETITION_COLUMNS,
    "cycles": CYCLE_COLUMNS,
    "repetition_curve": CURVE_COLUMNS,
    "anatomy": ANATOMY_COLUMNS["elbow"],
    "joint_angles": JOINT_ANGLE_COLUMNS[2],
    "axis_path": AXIS_PATH_COLUMNS,
}
"""The tables of a result, each a file of its name, and their columns: of a joint with two axes, and of an elbow."""


def attributes(read: Sequence[NDArray[Any]], table: tuple[Column, ...]) -> dict[str, NDArray[Any]]:
    """Put columns together to the attributes that they were made from; the inverse of `Column.values`.

    Parameters
    ----------
    read : sequence of ndarray, shape (N,)
        One a column; SI units and radians, flags as 0 and 1.
    table : tuple of Column

    Returns
    -------
    dict of str to ndarray
        Shape (N,), or (N, k) of k components, NaN for those that the table does not have; flags as bool.
    """
    parts: dict[str, list[tuple[Column, NDArray[Any]]]] = {}
    for column, values_of in zip(table, read, strict=True):
        parts.setdefault(column.attribute, []).append((column, values_of))
    found = {}
    for attribute, pairs in parts.items():
        columns_of, values = [column for column, _ in pairs], [one for _, one in pairs]
        places = [column.component for column in columns_of if column.component is not None]
        if places:
            found[attribute] = np.full((values[0].size, max(places) + 1), np.nan)
            for place, one in zip(places, values, strict=True):
                found[attribute][:, place] = one
        elif columns_of[0].quantity is Quantity.FLAG:
            found[attribute] = values[0] == 1
        else:
            found[attribute] = values[0]
    return found
