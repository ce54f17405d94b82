"""Which joint it is, ready for ``joint.json``; units in the names, None where nothing is known."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis
from elbowscrew.model.joint_summary_types import (
    BallSummary,
    CandidateSummary,
    JointLineSummary,
    JointTypeSummary,
    SecondRotationSummary,
    TwoAxesSummary,
)
from elbowscrew.model.joint_type import BallJoint, JointLine, JointTypeName, Measure, SecondRotation, TwoAxes
from elbowscrew.results.statistics import known

_MILLIMETERS: Final = 1000.0
_DEGREES: Final = float(np.degrees(1.0))
INTERVAL_METHODS: Final = {
    "A": "from the markers' motion among themselves",
    "B": "from the residuals of the joint's model and how they go together in time",
    "J": "from blocks of the motion",
}
"""What an interval stands on."""


def joint_type_summary(analysis: Analysis) -> JointTypeSummary:
    """Type, status and reason; of two axes and of a center their numbers."""
    found, axis = analysis.joint_type, analysis.joint_axis
    if found is None:
        kind: JointTypeName = axis.preferred or "undetermined"
        reason = f"one axis leaves {100.0 * axis.unexplained:.2g} % of the rotation; richer types were not tried"
        if axis.preferred is None:
            reason = "the positions tell nothing of where the joint is"
        return {
            "type": kind,
            "status": None if axis.preferred is None else "approximate",
            "reason": reason,
            "candidates": [],
            "two_axes": None,
            "ball": None,
            "second_rotation": None,
            "decided_by": None,
            "interval_method": None,
        }
    candidates: list[CandidateSummary] = [
        {
            "type": one.type,
            "residual_deg": known(_DEGREES * one.residual_rotation),
            "residual_mm": known(_MILLIMETERS * one.residual_translation),
            "heldout_variance": known(one.heldout_variance),
            "shared": one.shared,
            "per_frame": one.per_frame,
            "valid": one.valid,
        }
        for one in found.candidates
    ]
    return {
        "type": found.type,
        "status": found.status,
        "reason": found.reason,
        "candidates": candidates,
        "two_axes": None if found.two_axes is None else _two_axes(found.two_axes),
        "ball": None if found.ball is None else _ball(found.ball),
        "second_rotation": None if found.second_rotation is None else _second_rotation(found.second_rotation),
        "decided_by": found.decided_by,
        "interval_method": None if found.decided_by is None else INTERVAL_METHODS[found.decided_by],
    }


def _ball(found: BallJoint) -> BallSummary:
    return {
        "center_in_proximal_mm": (_MILLIMETERS * found.center_proximal).tolist(),
        "center_in_distal_mm": (_MILLIMETERS * found.center_distal).tolist(),
        "radius95_mm": known(_MILLIMETERS * found.radius),
    }


def _second_rotation(found: SecondRotation) -> SecondRotationSummary:
    return {"range_deg": known(_DEGREES * found.range), "axis": None if found.axis is None else _line(found.axis)}


def _two_axes(found: TwoAxes) -> TwoAxesSummary:
    angle, distance = _measure(found.angle_between, _DEGREES), _measure(found.distance, _MILLIMETERS)
    offset = _measure(found.offset, _MILLIMETERS)
    foot1, foot2 = _measure(found.foot1, _MILLIMETERS), _measure(found.foot2, _MILLIMETERS)
    return {
        "axis1": _line(found.axis1),
        "axis2": _line(found.axis2),
        "angle_between_deg": angle.value,
        "angle_between_deg_low": angle.low,
        "angle_between_deg_high": angle.high,
        "distance_mm": distance.value,
        "distance_mm_low": distance.low,
        "distance_mm_high": distance.high,
        "parallel_offset_mm": offset.value,
        "parallel_offset_mm_low": offset.low,
        "parallel_offset_mm_high": offset.high,
        "foot1_mm": foot1.value,
        "foot1_mm_low": foot1.low,
        "foot1_mm_high": foot1.high,
        "foot2_mm": foot2.value,
        "foot2_mm_low": foot2.low,
        "foot2_mm_high": foot2.high,
    }


def _line(line: JointLine) -> JointLineSummary:
    determined = line.determined and line.axis_cone < 0.5 * np.pi
    return {
        "direction_in_proximal": line.direction_proximal.tolist(),
        "point_in_proximal_mm": (_MILLIMETERS * line.point_proximal).tolist(),
        "direction_in_distal": line.direction_distal.tolist(),
        "point_in_distal_mm": (_MILLIMETERS * line.point_distal).tolist(),
        "cone95_deg": known(_DEGREES * line.axis_cone) if determined else None,
        "radius95_mm": known(_MILLIMETERS * line.point_radius) if determined else None,
        "range_deg": known(_DEGREES * line.range),
        "angle_sd_deg": known(_DEGREES * line.angle_sd),
        "determined": determined,
    }


class _Interval(NamedTuple):
    """A number with its 95 % limits; None where not known."""

    value: float | None = None
    low: float | None = None
    high: float | None = None


def _measure(found: Measure | None, scale: float) -> _Interval:
    if found is None:
        return _Interval()
    value, reach = scale * found.value, scale * NORMAL_95 * found.sd
    if not np.isfinite(reach):
        return _Interval(known(value))
    return _Interval(known(value), value - reach, value + reach)
