"""The bones' angles and the axis against the bones, ready for JSON; units in the names, None where nothing is known."""

from __future__ import annotations

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model import AnatomicalMotion
from elbowscrew.model.joint_summary_types import AnatomySummary, AxisAgainstBones
from elbowscrew.model.summary_types import AngleRange, AnglesOfBones
from elbowscrew.results.statistics import known, statistic


def angles_of_bones(motion: AnatomicalMotion | None, measured: Bool) -> AnglesOfBones | None:
    """Give the ranges of the bones' angles over the measured frames, (N,), and the axis against the bones."""
    if motion is None:
        return None
    found = {name: _range(motion.angles[:, k], measured) for k, name in enumerate(motion.names)}
    return {
        **_axis_against_bones(motion),
        "flexion": found["flexion"],
        "carrying_angle": found.get("carrying_angle"),
        "pronation": found.get("pronation"),
        "adduction": found.get("adduction"),
        "internal_rotation": found.get("internal_rotation"),
    }


def anatomy_summary(motion: AnatomicalMotion | None) -> AnatomySummary | None:
    """Give the axis against the bones, and where the landmarks are."""
    if motion is None:
        return None
    return {
        **_axis_against_bones(motion),
        "epicondyle_direction_in_proximal": motion.epicondyle_line[:3].tolist(),
        "landmarks_mm": {name: (1000.0 * point).tolist() for name, point in motion.points.items()},
    }


def _axis_against_bones(motion: AnatomicalMotion) -> AxisAgainstBones:
    angle, distance = motion.functional_axis_angle, motion.functional_axis_distance
    return {
        "joint": motion.landmarks.joint,
        "side": motion.side,
        "axis": motion.functional_axis,
        "axis_angle_deg": known(np.degrees(angle.value)),
        "axis_angle_deg_low": known(np.degrees(angle.low)),
        "axis_angle_deg_high": known(np.degrees(angle.high)),
        "axis_distance_mm": known(1000.0 * distance.value),
        "axis_distance_mm_low": known(1000.0 * distance.low),
        "axis_distance_mm_high": known(1000.0 * distance.high),
        "landmark_sensitivity_deg_per_mm": float(np.degrees(0.001 / motion.epicondyle_width)),
        "joint_center_in_proximal_mm": (1000.0 * motion.joint_center_proximal).tolist(),
        "joint_center_in_distal_mm": (1000.0 * motion.joint_center_distal).tolist(),
    }


def _range(angle: Float, measured: Bool) -> AngleRange:
    shown = np.degrees(np.where(measured, angle, np.nan))
    told = shown[np.isfinite(shown)]
    return {
        "start_deg": float(told[0]) if told.size else None,
        "min_deg": statistic(np.nanmin, shown),
        "max_deg": statistic(np.nanmax, shown),
        "range_deg": float(np.ptp(told)) if told.size else None,
    }
