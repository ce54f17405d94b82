"""The one use case: a recording and settings in, an analysis out."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import (
    Analysis,
    BodyPoints,
    InterpolatedMotion,
    JointAxis,
    JointMotion,
    Keyframes,
    MeanAxis,
    PoseNoise,
    QualityWarning,
    Recording,
    RigidBody,
    ScrewMotion,
)
from elbowscrew.motion.bodies import tracked_bodies
from elbowscrew.motion.clock import elapsed_time
from elbowscrew.motion.difference import (
    DEFAULT_RADIUS,
    angle_between,
    origin_distance,
    points_from_markers,
    points_from_radius,
    rms_displacement,
)
from elbowscrew.motion.helical import HelicalSeries, helical_series
from elbowscrew.motion.joint_axis import estimate_joint_axis, forearm_line
from elbowscrew.motion.keyframes import choose_rows, keyframes_at, row_of_frame
from elbowscrew.motion.laws import LAWS
from elbowscrew.motion.mean_axis import mean_axis_of
from elbowscrew.motion.modeling import METHODS, ModeledPoses, model_motion
from elbowscrew.motion.pose_noise import pose_noise
from elbowscrew.motion.relative import displacement, expressed, frame_change, joint_from_bodies
from elbowscrew.motion.uncertainty import ScrewErrors, known_errors, least_angle, no_errors, screw_errors
from elbowscrew.settings import Settings

Float = NDArray[np.float64]

_LARGE_NOISE_RATIO: Final = 2.0


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
    arm, forearm, broken_rows, quality, warnings = tracked_bodies(recording, wanted)
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
    noise = _Noise.of(arm, forearm, recording.rate_hz, wanted)
    series, errors = _measured_series(D, D_expressed, joint, noise, wanted)
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
        angle_sd=errors.angle,
        slide_sd=errors.slide,
        axis_sd=errors.axis,
        point_sd=errors.point,
        axis_cone=errors.axis_cone,
        point_radius=errors.point_radius,
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
    mean_axis = _mean_axis(series, joint, wanted)
    joint_axis = _joint_axis(series, joint, mean_axis, noise, wanted)
    warnings += _keyframe_warnings(keyframes, inversion_row, joint, modeled)
    warnings += _axis_warnings(joint_axis, noise)
    return Analysis(
        recording=recording,
        settings=wanted,
        arm=arm,
        forearm=forearm,
        joint=joint,
        screw=screw,
        mean_axis=mean_axis,
        joint_axis=joint_axis,
        keyframes=keyframes,
        interpolated=_compared(modeled, D, series, joint, keyframes, points, screw, wanted),
        points=points,
        quality=quality,
        warnings=warnings,
    )


class _Noise(NamedTuple):
    """Noise of the two bodies' poses, None where it is not known."""

    arm: PoseNoise | None
    forearm: PoseNoise | None
    arm_moves: bool

    @classmethod
    def of(cls, arm: RigidBody | None, forearm: RigidBody, rate_hz: float, settings: Settings) -> _Noise:
        found = None if arm is None else pose_noise(arm, rate_hz, settings)
        return cls(found, pose_noise(forearm, rate_hz, settings), arm is not None)

    @property
    def known(self) -> bool:
        return self.forearm is not None and (self.arm is not None or not self.arm_moves)


def _measured_series(
    D: Float, D_expressed: Float, joint: JointMotion, noise: _Noise, settings: Settings
) -> tuple[HelicalSeries, ScrewErrors]:
    """Screws of all frames, with their errors, each axis known as well as the settings want it."""
    limit, least = np.inf, np.radians(settings.min_angle_deg)
    errors = no_errors(len(D))
    if noise.forearm is not None and noise.known:
        change = frame_change(joint, settings.express_in)
        errors = screw_errors(D, joint, noise.arm, noise.forearm, change, settings.reference_window)
        if settings.axis_sd_deg is not None:
            limit = np.radians(settings.axis_sd_deg)
            least = least_angle(limit, joint, noise.arm, noise.forearm)
    elif settings.axis_sd_deg is not None:
        msg = "--axis-sd: the noise of the poses is not known here; give --marker-noise MM, or --min-angle in its place"
        raise SettingError(msg)
    series = helical_series(D_expressed, least, joint.reference_row)
    unsure = errors.axis > limit
    series.line[unsure], series.slide[unsure] = np.nan, np.nan
    peak = int(np.nanargmax(np.abs(series.angle)))
    if not np.isfinite(series.line[joint.measured]).any():
        needed = "the --axis-sd asked for" if settings.axis_sd_deg else f"{settings.min_angle_deg:g} deg"
        msg = (
            f"the largest rotation since the reference is {np.degrees(abs(series.angle[peak])):.3g} deg, less than the "
            f"{needed} an axis needs: no rotation to analyze (--min-angle sets the limit)"
        )
        raise AnalysisError(msg)
    series = series.reversed() if series.angle[peak] < 0.0 else series
    return series, known_errors(errors, series.angle, np.isfinite(series.slide))


def _joint_axis(
    series: HelicalSeries, joint: JointMotion, mean: MeanAxis, noise: _Noise, settings: Settings
) -> JointAxis:
    line = np.concatenate([mean.direction, np.cross(mean.point, mean.direction)])
    return estimate_joint_axis(
        joint,
        series.angle,
        forearm_line(line, frame_change(joint, settings.express_in)),
        {"arm": noise.arm, "forearm": noise.forearm},
        arm_moves=noise.arm_moves,
        express_in=settings.express_in,
        robust=settings.robust,
    )


def _axis_warnings(joint_axis: JointAxis, noise: _Noise) -> tuple[QualityWarning, ...]:
    warnings = []
    if not joint_axis.single:
        message = (
            f"the motion has no single axis: a hinge leaves {100.0 * joint_axis.unexplained:.0f} % of its rotation "
            "unexplained, so that no joint axis is fitted, and the mean axis is but a mean"
        )
        warnings.append(QualityWarning(code="no-single-axis", message=message))
    if not noise.known:
        message = "the noise of the poses is not known, so that axes have no error bars; --marker-noise MM gives them"
        warnings.append(QualityWarning(code="noise-unknown", message=message, severity="note"))
    elif joint_axis.best is not None and joint_axis.best.noise_ratio > _LARGE_NOISE_RATIO:
        message = (
            f"the poses leave a hinge by {joint_axis.best.noise_ratio:.1f} times what their noise explains: the joint "
            "is no perfect hinge, or the markers move on the skin; the joint axis' interval is that of the residuals"
        )
        warnings.append(QualityWarning(code="beyond-noise", message=message, severity="note"))
    return tuple(warnings)


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
