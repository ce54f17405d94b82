"""The one use case: a recording and settings in, an analysis out."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import (
    Analysis,
    BodyPoints,
    BodyQuality,
    InterpolatedMotion,
    JointMotion,
    Keyframes,
    MeanAxis,
    QualityWarning,
    Recording,
    RigidBody,
    ScrewMotion,
    marker_matches,
)
from elbowscrew.motion.clock import elapsed_time
from elbowscrew.motion.difference import (
    angle_between,
    origin_distance,
    points_from_markers,
    points_from_radius,
    rms_displacement,
)
from elbowscrew.motion.helical import HelicalSeries, helical_series
from elbowscrew.motion.keyframes import choose_rows, keyframes_at, row_of_frame
from elbowscrew.motion.laws import LAWS
from elbowscrew.motion.marker_poses import body_from_markers
from elbowscrew.motion.mean_axis import mean_axis_of
from elbowscrew.motion.modeling import METHODS, ModeledPoses, model_motion
from elbowscrew.motion.quality import body_quality, check_bodies
from elbowscrew.motion.relative import displacement, expressed, frame_change, joint_from_bodies
from elbowscrew.motion.selection import choose_bodies
from elbowscrew.settings import Settings

Float = NDArray[np.float64]

DEFAULT_RADIUS: Final = 0.05
"""Radius of gyration (m) of the points of a forearm whose markers are not known."""


def analyze(recording: Recording, settings: Settings | None = None) -> Analysis:
    """Analyze one recording: screw motion, model from keyframes, and their difference.

    Parameters
    ----------
    recording : Recording
        From `elbowscrew.read_recording`, or built from bodies.
    settings : Settings, optional
        The paper's choices by default.

    Returns
    -------
    Analysis

    Raises
    ------
    SettingError
        If a setting does not fit the recording.
    AnalysisError
        If there is too little tracking or rotation.
    RecordingError
        If the recording has no usable clock.

    References
    ----------
    P 33-36.

    Examples
    --------
    >>> import elbowscrew
    >>> analysis = elbowscrew.analyze(elbowscrew.simulate_trial(marker_noise_mm=0).recording)
    >>> int(analysis.keyframes.frame[1])
    211
    """
    wanted = settings or Settings()
    arm, forearm, broken_rows, quality, warnings = _tracked_bodies(recording, wanted)
    elapsed = elapsed_time(recording)
    joint = joint_from_bodies(
        arm,
        forearm,
        recording.frame,
        elapsed,
        recording.rate_hz,
        reference_row=None
        if wanted.reference is None
        else row_of_frame(recording.frame, wanted.reference, "reference"),
        reference_window=wanted.reference_window,
        max_gap_s=wanted.max_gap_s,
        broken_rows=broken_rows,
    )
    D = displacement(joint)
    D_expressed = expressed(D, joint, wanted.express_in)
    series = _measured_series(D_expressed, joint, wanted)
    screw = ScrewMotion(
        frame=recording.frame,
        time_s=recording.time_s,
        valid=joint.measured,
        filled=joint.filled,
        arm_loss=np.zeros(recording.frame.size, dtype="U1") if arm is None else arm.loss_labels(),
        forearm_loss=forearm.loss_labels(),
        angle=series.angle,
        slide=series.slide,
        axis_direction=series.direction,
        axis_point=series.point,
        euler_parameters=D_expressed[:, :4],
        translation=pose_from_dual_quat(D_expressed)[1],
    )
    rows, inversion_row = choose_rows(series.angle, recording.frame, wanted.keyframes, wanted.inversion)
    keyframes = keyframes_at(
        rows,
        inversion_row,
        recording.frame,
        elapsed,
        D,
        choice=wanted.knots,
        law=LAWS[wanted.law],
        piecewise=wanted.blend == "piecewise",
    )
    modeled = model_motion(D, elapsed, keyframes, METHODS[wanted.method], LAWS[wanted.law])
    points = _body_points(forearm, wanted)
    warnings += _keyframe_warnings(keyframes, inversion_row, joint, modeled)
    return Analysis(
        recording=recording,
        settings=wanted,
        arm=arm,
        forearm=forearm,
        joint=joint,
        screw=screw,
        mean_axis=_mean_axis(series, joint, wanted),
        keyframes=keyframes,
        interpolated=_compared(modeled, D, series, joint, keyframes, points, screw, wanted),
        points=points,
        quality=quality,
        warnings=warnings,
    )


def _chosen_bodies(recording: Recording, settings: Settings) -> tuple[RigidBody | None, RigidBody]:
    """Choose arm and forearm among the bodies of the file and those built from markers."""
    patterns = {"arm": settings.arm_markers, "forearm": settings.forearm_markers}
    built = {
        role: body_from_markers(recording, f"{role} markers", wanted, settings.pose_method)
        for role, wanted in patterns.items()
        if wanted is not None
    }
    shared = [m.name for m in recording.markers if all(marker_matches(m.name, p or ()) for p in patterns.values())]
    if len(built) == 2 and shared:
        msg = f"markers {', '.join(shared)} are chosen for both bodies; give each marker to one of them"
        raise SettingError(msg)
    for role, body in built.items():
        if getattr(settings, role) is not None:
            msg = f"--{role} and --{role}-markers both say what the {role} is; give one of them (for {body.name!r})"
            raise SettingError(msg)
    names = {role: built[role].name if role in built else getattr(settings, role) for role in ("arm", "forearm")}
    bodies = (*recording.bodies, *built.values())
    if not bodies:
        msg = "the recording has no rigid bodies and no markers were chosen: give --arm-markers and --forearm-markers"
        raise SettingError(msg)
    return choose_bodies(replace(recording, bodies=bodies), names["arm"], names["forearm"])


class _Bodies(NamedTuple):
    arm: RigidBody | None
    forearm: RigidBody
    broken_rows: NDArray[np.intp]
    quality: tuple[BodyQuality, ...]
    warnings: tuple[QualityWarning, ...]


def _tracked_bodies(recording: Recording, settings: Settings) -> _Bodies:
    arm, forearm = _chosen_bodies(recording, settings)
    chosen = (forearm,) if arm is None else (arm, forearm)
    checked, warnings = check_bodies(recording, chosen, settings)
    for found in checked:
        body = found.body
        share = 100.0 * float(body.tracked.mean()) if body.loss.size else 0.0
        if share < settings.min_tracked_percent or not body.tracked.any():
            reasons = ", ".join(f"{count} {reason}" for reason, count in body.loss_counts().items())
            msg = (
                f"body {body.name!r} is tracked in {share:.1f} % of {body.loss.size} frames ({reasons}); at least "
                f"{settings.min_tracked_percent:g} % are needed (--min-tracked; "
                "for leaps see --max-turn and --max-speed, for frozen poses --frozen)"
            )
            raise AnalysisError(msg)
    quality = tuple(body_quality(raw, found, recording) for raw, found in zip(chosen, checked, strict=True))
    proximal = None if arm is None else checked[0].body
    broken_rows = np.unique(np.concatenate([found.broken_rows for found in checked]))
    return _Bodies(proximal, checked[-1].body, broken_rows, quality, (*recording.warnings, *warnings))


def _measured_series(D: Float, joint: JointMotion, settings: Settings) -> HelicalSeries:
    series = helical_series(D, np.radians(settings.min_angle_deg), joint.reference_row)
    peak = int(np.nanargmax(np.abs(series.angle)))
    if not np.isfinite(series.line[joint.measured]).any():
        msg = (
            f"the largest rotation since the reference is {np.degrees(abs(series.angle[peak])):.3g} deg, less than the "
            f"{settings.min_angle_deg:g} deg an axis needs: no rotation to analyze (--min-angle sets the limit)"
        )
        raise AnalysisError(msg)
    return series.reversed() if series.angle[peak] < 0.0 else series


def _mean_axis(series: HelicalSeries, joint: JointMotion, settings: Settings) -> MeanAxis:
    """Take the mean over measured frames: a pose filled in says nothing that its neighbors do not."""
    lines = np.where(joint.measured[:, None], series.line, np.nan)
    forearm = pose_from_dual_quat(frame_change(joint, settings.express_in))[1]
    return mean_axis_of(series.angle, lines, forearm)


def _body_points(forearm: RigidBody, settings: Settings) -> BodyPoints:
    if settings.radius_mm is not None:
        return points_from_radius(settings.radius_mm / 1000.0)
    if forearm.marker_offsets is not None:
        return points_from_markers(forearm.marker_offsets)
    return points_from_radius(DEFAULT_RADIUS)


def _keyframe_warnings(
    keyframes: Keyframes, inversion_row: int | None, joint: JointMotion, modeled: ModeledPoses
) -> tuple[QualityWarning, ...]:
    warnings = []
    if inversion_row is None:
        message = "the angle is largest at an end of the motion, so it has no inversion: modeled in one phase"
        warnings.append(QualityWarning(code="no-inversion", message=message))
    filled = keyframes.frame[joint.filled[keyframes.row]]
    if filled.size:
        message = f"keyframes {', '.join(map(str, filled))} are not measured but filled in from their neighbors"
        warnings.append(QualityWarning(code="filled-keyframe", message=message))
    vanished = int((~modeled.phase.mask & ~np.isfinite(modeled.dual_quat[:, 0])).sum())
    if vanished:
        message = (
            f"in {vanished} frames the blended poses cancel, so there is no model pose; "
            "choose keyframes closer together, or --method sclerp"
        )
        warnings.append(QualityWarning(code="blend-vanishes", message=message))
    return tuple(warnings)


def _compared(
    modeled: ModeledPoses,
    D: Float,
    measured: HelicalSeries,
    joint: JointMotion,
    keyframes: Keyframes,
    points: BodyPoints,
    screw: ScrewMotion,
    settings: Settings,
) -> InterpolatedMotion:
    D_model = expressed(modeled.dual_quat, joint, settings.express_in)
    # The model shares its poses with the measurement at the phases' ends: there the angle and its sense are known.
    shared = keyframes.row[keyframes.phase_bounds]
    anchor = int(shared[np.argmax(np.abs(measured.angle[shared]))])
    series = helical_series(D_model, np.radians(settings.min_angle_deg), anchor, measured.angle[anchor])
    unmeasured = ~joint.measured
    angle_error = angle_between(D, modeled.dual_quat)
    translation_error = origin_distance(D, modeled.dual_quat)
    rms = rms_displacement(D, modeled.dual_quat, points)
    for error in (angle_error, translation_error, rms):
        error[unmeasured] = np.nan
    return InterpolatedMotion(
        frame=screw.frame,
        time_s=screw.time_s,
        phase=modeled.phase,
        fraction=modeled.fraction,
        angle=series.angle,
        slide=series.slide,
        euler_parameters=D_model[:, :4],
        translation=pose_from_dual_quat(D_model)[1],
        angle_error=angle_error,
        translation_error=translation_error,
        rms_displacement=rms,
    )
