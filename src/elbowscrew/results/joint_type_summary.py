"""Which joint it is, ready for ``joint.json``; units in the names, None where nothing is known."""

from __future__ import annotations

from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.choices import ExpressIn
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat, transform_points
from elbowscrew.geometry.quaternion import rotate
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis, AxisWander
from elbowscrew.model.joint_summary_types import (
    BallSummary,
    CandidateSummary,
    JointLineSummary,
    JointTypeSummary,
    NumbersOfType,
    SecondRotationSummary,
    TwoAxesSummary,
    WanderSummary,
)
from elbowscrew.model.joint_type import BallJoint, JointLine, Measure, SecondRotation, TwoAxes
from elbowscrew.motion.screws.frames import frame_called
from elbowscrew.results.statistics import known, known_vector

_MILLIMETERS: Final = 1000.0
_BEYOND: Final = 0.5 * np.pi
_DEGREES: Final = float(np.degrees(1.0))
_INTERVAL_METHODS: Final = {
    "A": "from the markers' motion among themselves",
    "B": "from the residuals of the joint's model and how they go together in time",
    "J": "from blocks of the motion",
}
_BY_ERRORS: Final = "from the errors that the file states of its markers and how they go with the motion"
_NO_SKIN: Final = ", for bodies that are rigid on their bones, as the file tells nothing of markers"
_NO_REASON: Final = "the positions tell nothing of where the joint is"


def joint_type_summary(analysis: Analysis) -> JointTypeSummary:
    """Type, status, reason, and what the joint's intervals stand on."""
    found, axis = analysis.joint_type, analysis.joint_axis.headline
    decided = axis.decided_by if axis is not None else None if found is None else found.decided_by
    if found is None:
        return {
            "type": "undetermined",
            "status": None,
            "reason": _NO_REASON,
            "candidates": [],
            "decided_by": decided,
            "interval_method": interval_method(decided, analysis),
            "markers_told": analysis.joint_axis.markers_told,
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
        "decided_by": decided,
        "interval_method": interval_method(decided, analysis),
        "markers_told": analysis.joint_axis.markers_told,
    }


def interval_method(decided: Literal["A", "B", "J"] | None, analysis: Analysis) -> str | None:
    """What an interval stands on, and what it leaves out for want of markers."""
    if decided is None:
        return None
    told = analysis.joint_axis.markers_told
    if told is None and analysis.joint.located:
        return _INTERVAL_METHODS[decided] + _NO_SKIN
    return _BY_ERRORS if decided == "A" and told == "errors" else _INTERVAL_METHODS[decided]


def numbers_of_type(analysis: Analysis) -> NumbersOfType:
    """Give the numbers of the joint's type, those that do not apply as None."""
    found, frame = analysis.joint_type, _Frame.of(analysis)
    two, ball, second = (None,) * 3 if found is None else (found.two_axes, found.ball, found.second_rotation)
    return {
        "two_axes": None if two is None else _two_axes(two, frame),
        "ball": None if ball is None else _ball(ball),
        "second_rotation": None if second is None else _second_rotation(second, frame),
        "wander": _wander(analysis.joint_axis.wander),
    }


class _Frame(NamedTuple):
    """The frame that lines are expressed in, and the proximal body's pose in the laboratory."""

    name: ExpressIn
    proximal_in_lab: Float

    @classmethod
    def of(cls, analysis: Analysis) -> _Frame:
        name = frame_called(analysis.settings.express_in, analysis.named_joint)[0]
        return cls(name, analysis.joint.dual_quat_lab_proximal)

    def line(self, line: JointLine) -> tuple[Float, Float]:
        """Direction and point of a line."""
        if self.name == "distal":
            return line.direction_distal, line.point_distal
        if self.name == "proximal":
            return line.direction_proximal, line.point_proximal
        quat = pose_from_dual_quat(self.proximal_in_lab)[0]
        return rotate(quat, line.direction_proximal), transform_points(self.proximal_in_lab, line.point_proximal)


def _wander(wander: AxisWander | None) -> WanderSummary | None:
    if wander is None:
        return None
    return {
        "size_deg": known(_DEGREES * wander.tilt),
        "size_sd_deg": known(_DEGREES * wander.tilt_sd),
        "size_mm": known(_MILLIMETERS * wander.shift),
        "size_sd_mm": known(_MILLIMETERS * wander.shift_sd),
        "unseen_deg": known(_DEGREES * wander.unseen_tilt),
        "unseen_mm": known(_MILLIMETERS * wander.unseen_shift),
        "significant": wander.significant,
    }


def _ball(found: BallJoint) -> BallSummary:
    return {
        "center_in_proximal_mm": (_MILLIMETERS * found.center_proximal).tolist(),
        "center_in_distal_mm": (_MILLIMETERS * found.center_distal).tolist(),
        "radius95_mm": known(_MILLIMETERS * found.radius),
        "semi_axes95_mm": (_MILLIMETERS * found.semi_axes).tolist() if np.isfinite(found.semi_axes).all() else None,
        "score": {
            "center_in_proximal_mm": (_MILLIMETERS * found.score_proximal).tolist(),
            "center_in_distal_mm": (_MILLIMETERS * found.score_distal).tolist(),
        },
    }


def _second_rotation(found: SecondRotation, frame: _Frame) -> SecondRotationSummary:
    return {
        "range_deg": known(_DEGREES * found.range),
        "axis": None if found.axis is None else _line(found.axis, frame),
    }


def _two_axes(found: TwoAxes, frame: _Frame) -> TwoAxesSummary:
    angle, distance = _measure(found.angle_between, _DEGREES), _measure(found.distance, _MILLIMETERS)
    offset = _measure(found.offset, _MILLIMETERS)
    foot1, foot2 = _measure(found.foot1, _MILLIMETERS), _measure(found.foot2, _MILLIMETERS)
    return {
        "axis1": _line(found.axis1, frame),
        "axis2": _line(found.axis2, frame),
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
        "order_determined": found.order_determined,
    }


def _line(line: JointLine, frame: _Frame) -> JointLineSummary:
    direction, point = frame.line(line)
    determined = line.determined and line.axis_cone < _BEYOND
    return {
        "direction": direction.tolist(),
        "point_mm": known_vector(_MILLIMETERS * point),
        "direction_in_proximal": line.direction_proximal.tolist(),
        "point_in_proximal_mm": known_vector(_MILLIMETERS * line.point_proximal),
        "direction_in_distal": line.direction_distal.tolist(),
        "point_in_distal_mm": known_vector(_MILLIMETERS * line.point_distal),
        "cone95_deg": known(_DEGREES * line.axis_cone) if determined else None,
        "radius95_mm": known(_MILLIMETERS * line.point_radius) if determined else None,
        "cone95_other_deg": known(_DEGREES * line.other_cone) if determined and line.other_cone < _BEYOND else None,
        "radius95_other_mm": known(_MILLIMETERS * line.other_radius) if determined else None,
        "range_deg": known(_DEGREES * line.range),
        "angle_sd_deg": known(_DEGREES * line.angle_sd),
        "determined": determined,
        "wander": _wander(line.wander),
    }


class _Interval(NamedTuple):
    """A number with its 95 % limits; None where they are not known, as such a number says nothing."""

    value: float | None = None
    low: float | None = None
    high: float | None = None


def _measure(found: Measure | None, scale: float) -> _Interval:
    if found is None or not np.isfinite(found.sd):
        return _Interval()
    value, reach = scale * found.value, scale * NORMAL_95 * found.sd
    return _Interval(known(value), value - reach, value + reach)
