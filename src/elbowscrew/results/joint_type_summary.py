"""Which joint it is, ready for ``joint.json``; units in the names, None where nothing is known."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis
from elbowscrew.model.joint_type import JointLine, JointType, Measure, TwoAxes
from elbowscrew.results.statistics import known

_MILLIMETERS: Final = 1000.0
_DEGREES: Final = float(np.degrees(1.0))
INTERVAL_NOTE: Final = (
    "95 %, from the size and the autocorrelation of the residuals; skin that moves with the motion is not included"
)
"""What the intervals of two axes and of a center stand on."""


def joint_type_summary(analysis: Analysis) -> dict[str, Any]:
    """Type, status and reason; of two axes and of a center their numbers."""
    found, axis = analysis.joint_type, analysis.joint_axis
    if found is None:
        kind = axis.preferred or "undetermined"
        status = None if axis.preferred is None else "approximate"
        reason = f"one axis leaves {100.0 * axis.unexplained:.2g} % of the rotation; richer types were not tried"
        if axis.preferred is None:
            reason = "the positions tell nothing of where the joint is"
        return {"type": kind, "status": status, "reason": reason, "candidates": [], **_numbers(None)}
    candidates = [
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
        **_numbers(found),
    }


def _numbers(found: JointType | None) -> dict[str, Any]:
    second = None if found is None else found.second_rotation
    ball = None if found is None else found.ball
    return {
        "two_axes": None if found is None or found.two_axes is None else _two_axes(found.two_axes),
        "ball": None
        if ball is None
        else {
            "center_in_proximal_mm": (_MILLIMETERS * ball.center_proximal).tolist(),
            "center_in_distal_mm": (_MILLIMETERS * ball.center_distal).tolist(),
            "radius95_mm": known(_MILLIMETERS * ball.radius),
        },
        "second_rotation": None
        if second is None
        else {
            "range_deg": known(_DEGREES * second.range),
            "axis": None if second.axis is None else _line(second.axis),
        },
        "interval_note": None if found is None else INTERVAL_NOTE,
    }


def _two_axes(found: TwoAxes) -> dict[str, Any]:
    return {
        "axis1": _line(found.axis1),
        "axis2": _line(found.axis2),
        **_measure("angle_between_deg", found.angle_between, _DEGREES),
        **_measure("distance_mm", found.distance, _MILLIMETERS),
        **_measure("parallel_offset_mm", found.offset, _MILLIMETERS),
        **_measure("foot1_mm", found.foot1, _MILLIMETERS),
        **_measure("foot2_mm", found.foot2, _MILLIMETERS),
    }


def _line(line: JointLine) -> dict[str, Any]:
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


def _measure(name: str, found: Measure | None, scale: float) -> dict[str, float | None]:
    value, sd = (None, None) if found is None else (scale * found.value, scale * NORMAL_95 * found.sd)
    known_sd = value is not None and sd is not None and np.isfinite(sd)
    return {
        name: value if value is None else known(value),
        f"{name}_low": value - sd if known_sd and value is not None and sd is not None else None,
        f"{name}_high": value + sd if known_sd and value is not None and sd is not None else None,
    }
