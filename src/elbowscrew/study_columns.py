"""The columns of a study's tables: ``summary.csv``, made from each trial's ``summary.json``, and ``failures.csv``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.quantities import METERS, Quantity


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyColumn:
    """One column of ``summary.csv``: its name without unit, where ``summary.json`` has its value, and its kind."""

    name: str
    keys: tuple[str | int, ...]
    quantity: Quantity
    suffix: str = ""


def _study(quantity: Quantity, *keys: str | int, name: str = "", suffix: str = "") -> StudyColumn:
    if not name:
        name = str(keys[-1]).removesuffix("_deg").removesuffix("_mm")
    return StudyColumn(name=name, keys=keys, quantity=quantity, suffix=suffix)


def _study_vector(stem: str, quantity: Quantity, *keys: str) -> tuple[StudyColumn, ...]:
    return tuple(_study(quantity, *keys, k, name=f"{stem}_{letter}") for k, letter in enumerate("xyz"))


_MEAN: Final = ("motion", "mean_axis")
_JOINT: Final = ("motion", "joint_axis")
_TWO: Final = ("motion", "joint_numbers", "two_axes")
_BALL: Final = ("motion", "joint_numbers", "ball")
_BONES: Final = ("motion", "anatomy")
_MODEL: Final = "interpolation"


def _study_range(name: str) -> tuple[StudyColumn, ...]:
    """Range of an anatomical angle."""
    kinds = ("start", "min", "max", "range")
    return tuple(_study(Quantity.ANGLE, *_BONES, name, f"{kind}_deg", name=f"{name}_{kind}") for kind in kinds)


def _study_line(axis: str, body: str) -> tuple[StudyColumn, ...]:
    """One of two axes, in the body that it is fixed in and that its cone and radius are of."""
    return (
        *_study_vector(axis, Quantity.NUMBER, *_TWO, axis, f"direction_in_{body}"),
        *_study_vector(f"{axis}_point", Quantity.LENGTH, *_TWO, axis, f"point_in_{body}_mm"),
        _study(Quantity.ANGLE, *_TWO, axis, "range_deg", name=f"{axis}_range"),
        _study(Quantity.ANGLE, *_TWO, axis, "cone95_deg", name=f"{axis}_cone95"),
        _study(Quantity.LENGTH, *_TWO, axis, "radius95_mm", name=f"{axis}_radius95"),
        _study(Quantity.INTEGER, *_TWO, axis, "determined", name=f"{axis}_determined"),
    )


def _study_limits(quantity: Quantity, name: str, key: str) -> tuple[StudyColumn, ...]:
    """Put a number of the axis against the bones beside its 95 % limits."""
    ends = ("", "_low", "_high")
    return tuple(_study(quantity, *_BONES, f"{key}{end}", name=f"{name}{end}") for end in ends)


STUDY_COLUMNS: Final = (
    _study(Quantity.INTEGER, "trial", "frames"),
    _study(Quantity.NUMBER, "trial", "rate_hz"),
    _study(Quantity.NUMBER, "trial", "duration_s"),
    _study(Quantity.LABEL, "trial", "proximal", "name", name="proximal_body"),
    _study(Quantity.LABEL, "trial", "distal", "name", name="distal_body"),
    _study(Quantity.LABEL, "trial", "joint", "name", name="joint_name"),
    _study(Quantity.LABEL, "trial", "joint", "side", name="joint_side"),
    _study(Quantity.NUMBER, "trial", "proximal", "tracked_share", name="proximal_tracked_share"),
    _study(Quantity.NUMBER, "trial", "distal", "tracked_share", name="distal_tracked_share"),
    _study(Quantity.INTEGER, "trial", "measured_frames"),
    _study(Quantity.INTEGER, "trial", "filled_frames"),
    _study(Quantity.NUMBER, "trial", "missing_share"),
    _study(Quantity.INTEGER, "trial", "reference_frame"),
    _study(Quantity.ANGLE, "motion", "theta_max_deg"),
    _study(Quantity.ANGLE, "motion", "theta_min_deg"),
    _study(Quantity.INTEGER, "motion", "theta_max_frame"),
    _study(Quantity.INTEGER, "motion", "signed"),
    _study(Quantity.NUMBER, "motion", "dominant_axis", "ratio", name="dominant_axis_ratio"),
    _study(Quantity.ANGLE, "motion", "largest_jump_deg"),
    _study(Quantity.LABEL, "motion", "inversion_frames"),
    _study(Quantity.LENGTH, "motion", "slide_median_mm"),
    _study(Quantity.LENGTH, "motion", "slide_min_mm"),
    _study(Quantity.LENGTH, "motion", "slide_max_mm"),
    _study(Quantity.INTEGER, "motion", "repetitions"),
    _study(Quantity.LABEL, "motion", "expressed_in"),
    _study(Quantity.INTEGER, "motion", "axis_frames"),
    *_study_vector("axis", Quantity.NUMBER, *_MEAN, "direction"),
    *_study_vector("point", Quantity.LENGTH, *_MEAN, "point_mm"),
    _study(Quantity.ANGLE, "motion", "axis_dispersion_deg"),
    _study(Quantity.ANGLE, "motion", "axis_dispersion_all_frames_deg"),
    _study(Quantity.ANGLE, "motion", "axis_dispersion_weighted_deg"),
    _study(Quantity.ANGLE, "motion", "axis_dispersion_rms_deg"),
    _study(Quantity.ANGLE, "motion", "axis_dispersion_max_deg"),
    _study(Quantity.LENGTH, "motion", "axis_distance_rms_mm"),
    _study(Quantity.LABEL, "motion", "joint_type", "type", name="joint_type"),
    _study(Quantity.LABEL, "motion", "joint_type", "status", name="joint_type_status"),
    _study(Quantity.ANGLE, *_TWO, "angle_between_deg", name="axes_angle"),
    _study(Quantity.LENGTH, *_TWO, "distance_mm", name="axes_distance"),
    *_study_line("axis1", "proximal"),
    *_study_line("axis2", "distal"),
    *_study_vector("center", Quantity.LENGTH, *_BALL, "center_in_proximal_mm"),
    *_study_vector("center_in_distal", Quantity.LENGTH, *_BALL, "center_in_distal_mm"),
    _study(Quantity.LENGTH, *_BALL, "radius95_mm", name="center_radius95"),
    _study(Quantity.ANGLE, "motion", "joint_numbers", "wander", "size_deg", name="axis_wander"),
    _study(Quantity.INTEGER, "motion", "single_axis"),
    _study(Quantity.LABEL, *_JOINT, "model", name="joint_model"),
    *_study_vector("joint_axis", Quantity.NUMBER, *_JOINT, "direction"),
    *_study_vector("joint_point", Quantity.LENGTH, *_JOINT, "point_mm"),
    _study(Quantity.ANGLE, *_JOINT, "axis_cone95_deg", name="joint_axis_cone95"),
    _study(Quantity.LENGTH, *_JOINT, "point_radius95_mm", name="joint_point_radius95"),
    _study(Quantity.LENGTH, *_JOINT, "pitch_mm_per_rad", name="joint_pitch", suffix="_per_rad"),
    _study(Quantity.LABEL, *_BONES, "side", name="landmarks_side"),
    *_study_range("flexion"),
    *_study_range("carrying_angle"),
    *_study_range("pronation"),
    *_study_range("adduction"),
    *_study_range("internal_rotation"),
    _study(Quantity.LABEL, *_BONES, "axis", name="epicondyle_axis"),
    *_study_limits(Quantity.ANGLE, "epicondyle_angle", "axis_angle_deg"),
    *_study_limits(Quantity.LENGTH, "epicondyle_distance", "axis_distance_mm"),
    *_study_vector("joint_center", Quantity.LENGTH, *_BONES, "joint_center_in_proximal_mm"),
    _study(Quantity.NUMBER, _MODEL, "covered_share"),
    _study(Quantity.ANGLE, _MODEL, "rmse_theta_deg"),
    _study(Quantity.ANGLE, _MODEL, "max_theta_error_deg"),
    _study(Quantity.INTEGER, _MODEL, "max_theta_error_frame"),
    _study(Quantity.ANGLE, _MODEL, "rms_angle_error_deg"),
    _study(Quantity.ANGLE, _MODEL, "max_angle_error_deg"),
    _study(Quantity.LENGTH, _MODEL, "rms_translation_error_mm"),
    _study(Quantity.LENGTH, _MODEL, "max_translation_error_mm"),
    _study(Quantity.LENGTH, _MODEL, "rms_displacement_mm"),
    _study(Quantity.LENGTH, _MODEL, "max_rms_displacement_mm"),
    _study(Quantity.LENGTH, _MODEL, "points", "radius_of_gyration_mm"),
    _study(Quantity.LABEL, _MODEL, "points", "from", name="radius_from"),
    _study(Quantity.LABEL, "warnings", "warning", name="warnings"),
    _study(Quantity.LABEL, "warnings", "note", name="notes"),
    _study(Quantity.LABEL, "source", "sha256", name="source_sha256"),
    _study(Quantity.LABEL, "elbowscrew"),
)
"""What ``summary.csv`` has of each trial, after its name, its path and what a manifest says of it."""

FAILURE_COLUMNS: Final = ("path", "error_class", "message", "exit_code")
"""The columns of ``failures.csv``."""


def study_header(angle_unit: AngleUnit, length_unit: LengthUnit) -> list[str]:
    """Names of `STUDY_COLUMNS` in the units asked for."""
    units: dict[Quantity, str] = {Quantity.ANGLE: f"_{angle_unit}", Quantity.LENGTH: f"_{length_unit}"}
    return [f"{column.name}{units.get(column.quantity, '')}{column.suffix}" for column in STUDY_COLUMNS]


def study_values(summary: Any, angle_unit: AngleUnit, length_unit: LengthUnit) -> list[Any]:
    """Values of `STUDY_COLUMNS` out of a ``summary.json``, which has degrees and millimeters; None if not known."""
    scales = {
        Quantity.ANGLE: float(np.radians(1.0)) if angle_unit == "rad" else 1.0,
        Quantity.LENGTH: METERS["mm"] / METERS[length_unit],
    }
    values = []
    for column in STUDY_COLUMNS:
        value = summary
        for key in column.keys:
            if isinstance(value, list) and isinstance(key, str):
                value = [one["code"] for one in value if one["severity"] == key]
            else:
                value = None if value is None else value[key]
        scale = scales.get(column.quantity, 1.0)
        values.append(value if value is None or scale == 1.0 else value * scale)
    return values
