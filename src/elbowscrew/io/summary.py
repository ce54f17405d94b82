"""The summary of an analysis: what stands in ``summary.json`` and on the terminal."""

from __future__ import annotations

import platform
from dataclasses import replace
from importlib.metadata import version
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew._version import __version__
from elbowscrew.errors import SettingError
from elbowscrew.model import Analysis, Recording, RigidBody
from elbowscrew.motion.selection import choose_bodies
from elbowscrew.motion.tracking import check_tracking

Float = NDArray[np.float64]

_LIBRARIES: Final = ("numpy", "matplotlib", "pandas", "pydantic")


def summary_from_analysis(analysis: Analysis) -> dict[str, Any]:
    """Results, quality, settings and provenance, ready for JSON; units in the names, None where nothing is known.

    Angles are degrees and lengths millimeters here, whatever the units of the tables.
    """
    return {
        "elbowscrew": __version__,
        "source": source_summary(analysis.recording),
        "settings": analysis.settings.model_dump(mode="json", by_alias=True),
        "trial": {**recording_summary(analysis.recording), **_trial(analysis)},
        "motion": _motion(analysis),
        "interpolation": _interpolation(analysis),
        "warnings": [{"code": warning.code, "message": warning.message} for warning in analysis.warnings],
        "versions": {"python": platform.python_version(), **{name: version(name) for name in _LIBRARIES}},
    }


def summary_from_recording(recording: Recording) -> dict[str, Any]:
    """What a file holds, ready for JSON: source, clock, bodies with their tracking, and who is arm and forearm."""
    checked = [check_tracking(body, keep_frozen=False) for body in recording.bodies]
    tracked = replace(recording, bodies=tuple(body for body, _ in checked))
    warnings = (*recording.warnings, *(warning for _, found in checked for warning in found))
    return {
        "elbowscrew": __version__,
        "source": source_summary(recording),
        "trial": recording_summary(tracked),
        "roles": _roles(recording),
        "warnings": [{"code": warning.code, "message": warning.message} for warning in warnings],
    }


def _roles(recording: Recording) -> dict[str, str | None]:
    try:
        arm, forearm = choose_bodies(recording, None, None)
    except SettingError as error:
        return {"arm": None, "forearm": None, "text": str(error)}
    name = arm.name if arm is not None else None
    text = f"arm {name!r}, forearm {forearm.name!r}" if arm is not None else f"forearm {forearm.name!r}, still arm"
    return {"arm": name, "forearm": forearm.name, "text": text}


def source_summary(recording: Recording) -> dict[str, Any]:
    """Where the recording came from."""
    source = recording.source
    if source is None:
        return {"name": None, "sha256": None, "layout": None, "take": None, "length_unit": None, "rotation": None}
    return {
        "name": _printable(source.path.replace("\\", "/").rsplit("/", 1)[-1]),
        "sha256": source.sha256,
        "layout": source.layout,
        "take": source.take_name,
        "length_unit": source.length_unit,
        "rotation": source.rotation_type,
    }


def recording_summary(recording: Recording) -> dict[str, Any]:
    """Frames, rate and bodies of a recording."""
    return {
        "frames": int(recording.frame.size),
        "first_frame": int(recording.frame[0]),
        "last_frame": int(recording.frame[-1]),
        "rate_hz": recording.rate_hz,
        "duration_s": float(recording.time_s[-1] - recording.time_s[0]),
        "bodies": [body_summary(body) for body in recording.bodies],
    }


def body_summary(body: RigidBody) -> dict[str, Any]:
    """Name, id, share tracked and reasons of loss of one body."""
    return {
        "name": body.name,
        "id": body.identifier,
        "tracked_share": float(body.tracked.mean()),
        "lost_frames": body.loss_counts(),
        "markers": None if body.marker_offsets is None else len(body.marker_offsets),
    }


def _trial(analysis: Analysis) -> dict[str, Any]:
    screw = analysis.screw
    return {
        "arm": None if analysis.arm is None else body_summary(analysis.arm),
        "forearm": body_summary(analysis.forearm),
        "measured_frames": int(screw.valid.sum()),
        "filled_frames": int(screw.filled.sum()),
        "missing_share": float(1.0 - screw.valid.mean()),
        "reference_frame": int(screw.frame[analysis.joint.reference_row]),
    }


def _motion(analysis: Analysis) -> dict[str, Any]:
    screw, axis = analysis.screw, analysis.mean_axis
    angle = np.degrees(np.where(screw.valid, screw.angle, np.nan))
    slide = 1000.0 * np.where(screw.valid, screw.slide, np.nan)
    return {
        "theta_max_deg": _statistic(np.nanmax, angle),
        "theta_min_deg": _statistic(np.nanmin, angle),
        "theta_max_frame": int(screw.frame[int(np.nanargmax(angle))]),
        "inversion_frames": screw.frame[analysis.keyframes.inversion_rows].tolist(),
        "slide_median_mm": _statistic(np.nanmedian, slide),
        "slide_min_mm": _statistic(np.nanmin, slide),
        "slide_max_mm": _statistic(np.nanmax, slide),
        "expressed_in": analysis.settings.express_in,
        "axis_frames": int((screw.axis_known & screw.valid).sum()),
        "mean_axis": {"direction": axis.direction.tolist(), "point_mm": (1000.0 * axis.point).tolist()},
        "axis_dispersion_deg": _statistic(np.nanmedian, np.degrees(axis.deviation)),
        "axis_dispersion_rms_deg": _statistic(_rms, np.degrees(axis.deviation)),
        "axis_dispersion_max_deg": _statistic(np.nanmax, np.degrees(axis.deviation)),
        "axis_distance_rms_mm": _statistic(_rms, 1000.0 * axis.distance),
    }


def _interpolation(analysis: Analysis) -> dict[str, Any]:
    modeled, settings = analysis.interpolated, analysis.settings
    # A theta that was not measured is no measure of the model.
    theta_error = np.degrees(np.where(analysis.screw.valid, modeled.angle - analysis.screw.angle, np.nan))
    return {
        "method": settings.method,
        "blend": settings.blend,
        "law": settings.law,
        "knots": settings.knots,
        "keyframes": analysis.keyframes.frame.tolist(),
        "phases": int(analysis.keyframes.phase_bounds.size - 1),
        "rmse_theta_deg": _statistic(_rms, theta_error),
        "max_theta_error_deg": _statistic(np.nanmax, np.abs(theta_error)),
        "max_theta_error_frame": _frame_of_max(modeled.frame, np.abs(theta_error)),
        "rms_angle_error_deg": _statistic(_rms, np.degrees(modeled.angle_error)),
        "max_angle_error_deg": _statistic(np.nanmax, np.degrees(modeled.angle_error)),
        "rms_translation_error_mm": _statistic(_rms, 1000.0 * modeled.translation_error),
        "max_translation_error_mm": _statistic(np.nanmax, 1000.0 * modeled.translation_error),
        "rms_displacement_mm": _statistic(_rms, 1000.0 * modeled.rms_displacement),
        "max_rms_displacement_mm": _statistic(np.nanmax, 1000.0 * modeled.rms_displacement),
        "points": {
            "from": analysis.points.origin,
            "centroid_mm": (1000.0 * analysis.points.centroid).tolist(),
            "radius_of_gyration_mm": 1000.0 * analysis.points.radius_of_gyration,
        },
    }


def _rms(values: Float) -> Any:
    return np.sqrt(np.nanmean(values**2))


def _statistic(function: Any, values: Float) -> float | None:
    return float(function(values)) if np.isfinite(values).any() else None


def _frame_of_max(frame: NDArray[np.int64], values: Float) -> int | None:
    return int(frame[int(np.nanargmax(values))]) if np.isfinite(values).any() else None


def _printable(text: str) -> str:
    """File names may hold bytes that are no text; JSON may not."""
    return text.encode("utf-8", "replace").decode("utf-8")
