"""The joint's axis by all estimators, ready for ``joint.json``; units in the names, None where nothing is known."""

from __future__ import annotations

from typing import Any

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import (
    Analysis,
    FittedJoint,
    LineEstimate,
    MeanLine,
    PoseNoise,
    RigidBody,
)
from elbowscrew.model.joint_summary_types import (
    BodiesSummary,
    DispersionSummary,
    EstimateSummary,
    FitSummary,
    JointSummary,
    MeanAxisSummary,
    NoiseSummary,
    PoseSummary,
    RepeatabilitySummary,
    SkinMotionSummary,
    Vector,
)
from elbowscrew.motion.screws.frames import frame_called
from elbowscrew.results.anatomy_summary import anatomy_summary
from elbowscrew.results.joint_type_summary import interval_method, joint_type_summary, numbers_of_type
from elbowscrew.results.statistics import known, known_vector, rms, statistic


def joint_summary(analysis: Analysis) -> JointSummary:
    """Estimates of the joint's axis with their intervals, the dispersion about it, and the noise behind them."""
    axis = analysis.joint_axis
    return {
        "expressed_in": frame_called(analysis.settings.express_in, analysis.named_joint)[0],
        "joint_type": joint_type_summary(analysis),
        "single_axis": axis.single,
        "preferred": axis.preferred,
        "unexplained_share": known(axis.unexplained) if axis.unexplained <= 1.0 else None,
        "hinge": _fitted(axis.hinge, analysis),
        "screw_hinge": _fitted(axis.screw_hinge, analysis),
        **numbers_of_type(analysis),
        "mean_axis": _mean_axis(axis.mean_axis, analysis),
        "sensitivity_deg_per_deg": None if axis.best is None else known(axis.best.sensitivity),
        "skin_motion": _skin_motion(analysis),
        "weighted_mean": _line(axis.weighted_mean),
        "sara": _line(axis.sara),
        "dispersion": dispersion_summary(analysis),
        "noise": {"proximal": _noise(axis.noise["proximal"]), "distal": _noise(axis.noise["distal"])},
        "repeatability": _repeatability(analysis),
        "anatomy": anatomy_summary(analysis.anatomy),
        "bodies": _bodies(analysis),
    }


def dispersion_summary(analysis: Analysis) -> DispersionSummary:
    """How far the finite axes of the frames lie from their mean, in direction and in place."""
    mean = analysis.mean_axis
    deviation, distance = np.degrees(mean.deviation), 1000.0 * mean.distance
    return {
        "direction_median_deg": statistic(np.nanmedian, deviation),
        "direction_rms_deg": statistic(rms, deviation),
        "direction_95_deg": statistic(_high, deviation),
        "direction_max_deg": statistic(np.nanmax, deviation),
        "direction_excursion_deg": known(np.degrees(mean.excursion)),
        "position_median_mm": statistic(np.nanmedian, distance),
        "position_rms_mm": statistic(rms, distance),
        "position_95_mm": statistic(_high, distance),
        "position_max_mm": statistic(np.nanmax, distance),
        "position_excursion_mm": statistic(np.max, np.array([1000.0 * mean.position_excursion])),
    }


def preferred_fit(joint: JointSummary) -> FitSummary | None:
    """Give the fit to believe; None where the motion has no single axis."""
    return None if joint["preferred"] is None else joint[joint["preferred"]]


def _fitted(fit: FittedJoint | None, analysis: Analysis) -> FitSummary | None:
    if fit is None:
        return None
    return {
        **_line(fit.line),
        "frames": int(fit.used.size),
        "axis_sd_deg": known(np.degrees(fit.axis_sd)),
        "axis_cone95_deg": known(np.degrees(fit.axis_cone)),
        "point_sd_mm": known(1000.0 * fit.point_sd),
        "point_radius95_mm": known(1000.0 * fit.point_radius),
        "sensitivity_deg_per_deg": known(fit.sensitivity),
        "pitch_mm_per_rad": known(1000.0 * fit.pitch),
        "pitch_sd_mm_per_rad": known(1000.0 * fit.pitch_sd),
        "residual_rotation_deg": known(np.degrees(fit.residual_rotation)),
        "residual_translation_mm": known(1000.0 * fit.residual_translation),
        "noise_ratio": known(fit.noise_ratio),
        "frames_that_count_as_one": known(fit.correlation),
        "outlier_share": known(np.mean(fit.weight < 0.5)),
        "decided_by": fit.decided_by,
        "interval_method": interval_method(fit.decided_by, analysis),
    }


def _skin_motion(analysis: Analysis) -> SkinMotionSummary | None:
    """What is stated of the clusters' motion as a whole, and its part in the interval of the headline's axis."""
    stated, axis = analysis.settings.skin_motion, analysis.joint_axis.headline
    if stated is None:
        return None
    return {
        "mm": stated[0],
        "deg": stated[1] if len(stated) > 1 else 0.0,
        "part_deg": None if axis is None else known(np.degrees(axis.skin_cone)),
        "part_mm": None if axis is None else known(1000.0 * axis.skin_radius),
    }


def _mean_axis(mean: MeanLine | None, analysis: Analysis) -> MeanAxisSummary | None:
    if mean is None:
        return None
    return {
        **_line(mean.line),
        "axis_sd_deg": known(np.degrees(mean.axis_sd)),
        "axis_cone95_deg": known(np.degrees(mean.axis_cone)),
        "point_sd_mm": known(1000.0 * mean.point_sd),
        "point_radius95_mm": known(1000.0 * mean.point_radius),
        "decided_by": mean.decided_by,
        "interval_method": interval_method(mean.decided_by, analysis),
    }


def _line(line: LineEstimate) -> EstimateSummary:
    return {
        "direction": line.direction.tolist(),
        "point_mm": known_vector(1000.0 * line.point),
        "direction_in_proximal": line.direction_proximal.tolist(),
        "point_in_proximal_mm": known_vector(1000.0 * line.point_proximal),
        "direction_in_distal": line.direction_distal.tolist(),
        "point_in_distal_mm": known_vector(1000.0 * line.point_distal),
    }


def _repeatability(analysis: Analysis) -> RepeatabilitySummary:
    found = analysis.repeatability
    return {
        "repetitions": int(analysis.repetitions.number.size),
        "icc": known(found.icc),
        "cmc": known(found.cmc),
        "axis_sd_deg": known(np.degrees(found.axis_sd)),
        "point_sd_mm": known(1000.0 * found.point_sd),
        "theta_max_sd_deg": known(np.degrees(found.top_sd)),
    }


def _bodies(analysis: Analysis) -> BodiesSummary:
    """Say where the bodies are at the reference, and where their markers: with `screw.csv`, all that figures show."""
    joint = analysis.joint
    return {
        "distal_in_proximal": _pose(joint.reference, located=joint.located),
        "proximal_in_lab": _pose(joint.dual_quat_lab_proximal, located=joint.located),
        "proximal_markers_mm": _markers(analysis.proximal),
        "distal_markers_mm": _markers(analysis.distal),
    }


def _pose(dual_quat: Float, *, located: bool) -> PoseSummary:
    quat, position = pose_from_dual_quat(dual_quat)
    return {"quaternion": quat.tolist(), "position_mm": (1000.0 * position).tolist() if located else None}


def _markers(body: RigidBody | None) -> list[Vector] | None:
    if body is None or body.marker_offsets is None:
        return None
    offsets = 1000.0 * body.marker_offsets
    return [offset.tolist() for offset in offsets if np.isfinite(offset).all()]


def _noise(noise: PoseNoise | None) -> NoiseSummary | None:
    if noise is None:
        return None
    deviation = np.sqrt(np.diag(noise.covariance))
    return {
        "source": noise.source,
        "marker_noise_mm": None if noise.marker_noise is None else 1000.0 * noise.marker_noise,
        "rotation_sd_deg": np.degrees(deviation[:3]).tolist(),
        "position_sd_mm": known_vector(1000.0 * deviation[3:]),
    }


def _high(values: Float) -> Any:
    return np.nanpercentile(values, 95)
