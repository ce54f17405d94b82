"""The summary of an analysis: what stands in ``summary.json`` and on the terminal."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew import plug_ins
from elbowscrew._version import __version__
from elbowscrew.choices import EXPORT_NAMES, LAW_NAMES
from elbowscrew.configuring import options_from_settings
from elbowscrew.geometry.arrays import Float
from elbowscrew.joints import side_between
from elbowscrew.model import Analysis, Landmarks, PhaseLaw, Selection
from elbowscrew.model.anatomy import Landmark
from elbowscrew.model.summary_types import (
    JointAxisSummary,
    JointWords,
    LandmarksSummary,
    LandmarkSummary,
    LawErrorSummary,
    ModelSummary,
    MotionSummary,
    PhaseLawSummary,
    SelectionSummary,
    Summary,
    TrialSummary,
)
from elbowscrew.motion.screws.frames import frame_called
from elbowscrew.results.anatomy_summary import angles_of_bones
from elbowscrew.results.joint_type_summary import interval_method, joint_type_summary, numbers_of_type
from elbowscrew.results.recording_summary import quality_summary, recording_summary, source_summary, warnings_summary
from elbowscrew.results.statistics import known, known_vector, rms, statistic
from elbowscrew.settings import Settings

_LIBRARIES: Final = ("numpy", "scipy", "matplotlib", "pandas", "pydantic")


def summary_from_analysis(analysis: Analysis) -> Summary:
    """Results, quality, settings and provenance, ready for JSON; units in the names, None where nothing is known.

    Angles are degrees and lengths millimeters here, whatever the units of the tables.

    Parameters
    ----------
    analysis : Analysis
        From `elbowscrew.analyze`.

    Returns
    -------
    Summary
        What stands in ``summary.json``, but for the files beside it.

    Examples
    --------
    >>> import elbowscrew
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial(marker_noise_mm=0).recording)
    >>> summary_from_analysis(analysis)["interpolation"]["keyframes"]
    [0, 211, 449]
    """
    return {
        "elbowscrew": __version__,
        "source": source_summary(analysis.recording),
        "settings": settings_summary(analysis.settings),
        "landmarks": landmarks_summary(None if analysis.anatomy is None else analysis.anatomy.landmarks),
        "trial": _trial(analysis),
        "motion": _motion(analysis),
        "interpolation": _interpolation(analysis),
        "warnings": warnings_summary(analysis.warnings),
        "versions": {**library_versions(), **_plug_in_versions(analysis)},
    }


def settings_summary(settings: Settings) -> dict[str, Any]:
    """Every setting by the name of its option."""
    return {**options_from_settings(settings), "method": settings.model_method, "law": settings.model_law}


def landmarks_summary(landmarks: Landmarks | None) -> LandmarksSummary | None:
    """The landmarks as they were asked for: markers' names, or coordinates."""
    if landmarks is None:
        return None
    found: LandmarksSummary = {"side": landmarks.side}
    for name, asked in landmarks.by_name.items():
        found[name] = _landmark(asked)  # type: ignore[literal-required]
    return found


def _landmark(asked: Landmark) -> LandmarkSummary:
    if asked.point is None or asked.frame is None:
        return {"markers": list(asked.markers)}
    return {"body": asked.frame, "mm": (1000.0 * asked.point).tolist()}


def library_versions() -> dict[str, str]:
    """Versions of Python and of the libraries that the results depend on."""
    return {"python": platform.python_version(), **{name: _version_of(name) for name in _LIBRARIES}}


def are_installed(versions: Mapping[str, str]) -> bool:
    """Whether the versions that a result tells, of plug-ins too, are those that are installed."""
    known = library_versions()
    others = {name: _version_of(name) for name in versions if name not in known}
    return dict(versions) == {**known, **others}


def _plug_in_versions(analysis: Analysis) -> dict[str, str]:
    """Versions of the distributions whose reader, law or exports were asked for."""
    source, settings = analysis.recording.source, analysis.settings
    exports = [name for name in settings.export if name not in EXPORT_NAMES]
    return {
        **(source.plug_in if source is not None else {}),
        **(plug_ins.versions(plug_ins.LAWS, [settings.model_law]) if settings.model_law not in LAW_NAMES else {}),
        **(plug_ins.versions(plug_ins.EXPORTERS, exports) if exports else {}),
    }


@cache
def _version_of(library: str) -> str:
    """Looked up once: a fifth of the time of a short trial would go into it. Empty where it is not installed."""
    try:
        return version(library)
    except PackageNotFoundError:
        return ""


def _trial(analysis: Analysis) -> TrialSummary:
    screw = analysis.screw
    return {
        **recording_summary(analysis.recording),
        "joint": _joint_words(analysis),
        "bodies": [{"name": body.name, "id": body.identifier} for body in analysis.recording.bodies],
        "proximal": None if analysis.proximal is None else quality_summary(analysis.quality[0]),
        "distal": quality_summary(analysis.quality[-1]),
        "measured_frames": int(screw.valid.sum()),
        "filled_frames": int(screw.filled.sum()),
        "missing_share": float(1.0 - screw.valid.mean()),
        "positions": analysis.joint.located,
        "reference_frame": int(screw.frame[analysis.joint.reference_row]),
        "lowpass_hz": analysis.joint.lowpass_hz,
        "instantaneous_lowpass_hz": analysis.instantaneous.lowpass_hz,
    }


def _joint_words(analysis: Analysis) -> JointWords:
    """Say what the joint and its segments are called, for a page made from the result alone."""
    joint, proximal = analysis.named_joint, analysis.proximal
    return {
        "name": joint.name,
        "proximal": joint.proximal.name,
        "distal": joint.distal.name,
        "side": side_between("" if proximal is None else proximal.name, analysis.distal.name),
    }


def _motion(analysis: Analysis) -> MotionSummary:
    screw, axis = analysis.screw, analysis.mean_axis
    angle = np.degrees(np.where(screw.valid, screw.angle, np.nan))
    slide = 1000.0 * np.where(screw.valid, screw.slide, np.nan)
    return {
        "theta_max_deg": float(np.nanmax(angle)),
        "theta_min_deg": float(np.nanmin(angle)),
        "theta_max_frame": int(screw.frame[int(np.nanargmax(angle))]),
        "signed": analysis.sense.signed,
        "dominant_axis": {"direction": analysis.sense.direction.tolist(), "ratio": analysis.sense.ratio},
        "largest_jump_deg": float(np.degrees(analysis.sense.largest_jump)),
        "inversion_frames": screw.frame[analysis.inversion_rows].tolist(),
        "slide_median_mm": statistic(np.nanmedian, slide),
        "slide_min_mm": statistic(np.nanmin, slide),
        "slide_max_mm": statistic(np.nanmax, slide),
        "repetitions": int(analysis.repetitions.number.size),
        "movements": [
            {"onset_frame": int(screw.frame[onset]), "offset_frame": int(screw.frame[offset])}
            for onset, offset in zip(analysis.phases.onset_rows, analysis.phases.offset_rows, strict=True)
        ],
        "expressed_in": frame_called(analysis.settings.express_in, analysis.named_joint)[0],
        "axis_frames": int((screw.axis_known & screw.valid).sum()),
        "mean_axis": {"direction": axis.direction.tolist(), "point_mm": known_vector(1000.0 * axis.point)},
        "axis_dispersion_deg": known(np.degrees(axis.dispersion)),
        "axis_dispersion_all_frames_deg": statistic(np.nanmedian, np.degrees(axis.deviation)),
        "axis_dispersion_weighted_deg": known(np.degrees(axis.weighted_dispersion)),
        "axis_dispersion_rms_deg": statistic(rms, np.degrees(axis.deviation)),
        "axis_dispersion_max_deg": statistic(np.nanmax, np.degrees(axis.deviation)),
        "axis_distance_rms_mm": statistic(rms, 1000.0 * axis.distance),
        "single_axis": analysis.joint_axis.single,
        "joint_type": joint_type_summary(analysis),
        "joint_numbers": numbers_of_type(analysis),
        "joint_axis": _joint_axis(analysis),
        "anatomy": angles_of_bones(analysis.anatomy, screw.valid),
    }


def _joint_axis(analysis: Analysis) -> JointAxisSummary | None:
    """Say the axis with its interval, of one that wanders its mean; the rest stands in ``joint.json``."""
    axis = analysis.joint_axis
    told, best = axis.headline, axis.best
    if told is None or best is None or axis.preferred is None:
        return None
    return {
        "model": axis.preferred,
        "is_mean": axis.mean_axis is not None,
        "direction": told.line.direction.tolist(),
        "point_mm": known_vector(1000.0 * told.line.point),
        "axis_cone95_deg": known(np.degrees(told.axis_cone)),
        "point_radius95_mm": known(1000.0 * told.point_radius),
        "pitch_mm_per_rad": known(1000.0 * best.pitch),
        "interval_method": interval_method(told.decided_by, analysis),
        "sensitivity_deg_per_deg": known(best.sensitivity),
    }


def _interpolation(analysis: Analysis) -> ModelSummary:
    modeled, settings, points = analysis.interpolated, analysis.settings, analysis.points
    # A theta that was not measured is no measure of the model.
    theta_error = np.degrees(np.where(analysis.screw.valid, modeled.angle - analysis.screw.angle, np.nan))
    return {
        "method": settings.model_method,
        "blend": settings.blend,
        "law": settings.model_law,
        "knots": settings.knots,
        "keyframes": analysis.keyframes.frame.tolist(),
        "phases": analysis.keyframes.phases.count,
        "phase_laws": _phase_laws(analysis),
        "selection": None
        if analysis.selection is None
        else selection_summary(analysis.selection, analysis.screw.frame),
        "covered_share": float(np.isfinite(modeled.angle).mean()),
        "rmse_theta_deg": statistic(rms, theta_error),
        "max_theta_error_deg": statistic(np.nanmax, np.abs(theta_error)),
        "max_theta_error_frame": _frame_of_max(modeled.frame, np.abs(theta_error)),
        "rms_angle_error_deg": statistic(rms, np.degrees(modeled.angle_error)),
        "max_angle_error_deg": statistic(np.nanmax, np.degrees(modeled.angle_error)),
        "max_angle_error_frame": _frame_of_max(modeled.frame, modeled.angle_error),
        "rms_translation_error_mm": statistic(rms, 1000.0 * modeled.translation_error),
        "max_translation_error_mm": statistic(np.nanmax, 1000.0 * modeled.translation_error),
        "max_translation_error_frame": _frame_of_max(modeled.frame, modeled.translation_error),
        "rms_displacement_mm": statistic(rms, 1000.0 * modeled.rms_displacement),
        "max_rms_displacement_mm": statistic(np.nanmax, 1000.0 * modeled.rms_displacement),
        "max_rms_displacement_frame": _frame_of_max(modeled.frame, modeled.rms_displacement),
        "rms_axis_error_deg": statistic(rms, np.degrees(modeled.axis_error)),
        "max_axis_error_deg": statistic(np.nanmax, np.degrees(modeled.axis_error)),
        "max_axis_error_frame": _frame_of_max(modeled.frame, modeled.axis_error),
        "rms_axis_distance_mm": statistic(rms, 1000.0 * modeled.axis_distance),
        "max_axis_distance_mm": statistic(np.nanmax, 1000.0 * modeled.axis_distance),
        "max_axis_distance_frame": _frame_of_max(modeled.frame, modeled.axis_distance),
        "points": {
            "from": points.origin,
            "centroid_mm": (1000.0 * points.centroid).tolist() if points.located else None,
            "radius_of_gyration_mm": 1000.0 * points.radius_of_gyration if points.located else None,
        },
    }


def _phase_laws(analysis: Analysis) -> list[PhaseLawSummary]:
    """Law of each phase, and between which frames it runs."""
    frame = analysis.screw.frame
    return [
        {
            "law": law.name,
            "peak": law.peak,
            "peak_sd": known(law.peak_sd),
            "start_frame": int(frame[first]),
            "end_frame": int(frame[last]),
            **law_error(law, as_angle=not analysis.points.located),
        }
        for law, (first, last) in zip(analysis.laws, analysis.keyframes.phases.law_rows, strict=True)
    ]


def law_error(law: PhaseLaw, *, as_angle: bool) -> LawErrorSummary:
    """How far a law is off the measured motion, as the length or the angle that it is."""
    return {
        "rms_displacement_mm": None if as_angle else known(1000.0 * law.rms),
        "rms_angle_deg": known(np.degrees(law.rms)) if as_angle else None,
    }


def selection_summary(found: Selection, frame: NDArray[np.int64]) -> SelectionSummary:
    """Keyframes that were chosen, and the error over the number of keyframes."""

    def told(value: float) -> tuple[float | None, float | None]:
        """In millimeters, or in degrees."""
        return (None, float(np.degrees(value))) if found.as_angle else (1000.0 * value, None)

    mm, deg = told(found.tolerance)
    return {
        "tolerance_mm": mm,
        "tolerance_deg": deg,
        "frames": found.frames,
        "keyframes": int(found.row.size),
        "keyframe_frames": frame[found.row].tolist(),
        "compression_ratio": found.compression,
        "complete": found.complete,
        "curve": [
            {
                "keyframes": int(count),
                "max_rms_displacement_mm": told(largest)[0],
                "rms_displacement_mm": told(mean)[0],
                "max_angle_deg": told(largest)[1],
                "rms_angle_deg": told(mean)[1],
            }
            for count, largest, mean in zip(found.count, found.largest.tolist(), found.rms.tolist(), strict=True)
        ],
    }


def _frame_of_max(frame: NDArray[np.int64], values: Float) -> int | None:
    return int(frame[int(np.nanargmax(values))]) if np.isfinite(values).any() else None
