"""The one use case: a recording and settings in, an analysis out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import (
    Analysis,
    BodyPoints,
    InterpolatedMotion,
    JointMotion,
    Keyframes,
    Landmarks,
    QualityWarning,
    Recording,
    RigidBody,
)
from elbowscrew.motion.anatomy import anatomical_motion, arm_lines
from elbowscrew.motion.axes import find_axes
from elbowscrew.motion.difference import (
    DEFAULT_RADIUS,
    angle_between,
    origin_distance,
    points_from_markers,
    points_from_radius,
    rms_displacement,
)
from elbowscrew.motion.helical import helical_series
from elbowscrew.motion.keyframes import choose_rows, keyframes_at
from elbowscrew.motion.laws import LAWS
from elbowscrew.motion.measurement import Measurement, measure
from elbowscrew.motion.modeling import METHODS, ModeledPoses, model_motion
from elbowscrew.motion.phases import find_cycles, movement_phases
from elbowscrew.motion.relative import expressed
from elbowscrew.motion.repetitions import repeatability_of, repetitions_of
from elbowscrew.settings import Settings

Float = NDArray[np.float64]


def analyze(recording: Recording, settings: Settings | None = None, *, landmarks: Landmarks | None = None) -> Analysis:
    """Analyze one recording: screw motion, model from keyframes, and their difference.

    Parameters
    ----------
    recording : Recording
        From `elbowscrew.read_recording`, or built from bodies.
    settings : Settings, optional
        The paper's choices by default.
    landmarks : Landmarks, optional
        For the anatomical angles; read the recording with their markers.

    Returns
    -------
    Analysis
        In SI units and radians; NaN where something is not defined or not known.

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
    measured = measure(recording, wanted)
    recording, joint, screw = measured.recording, measured.joint, measured.screw
    D, elapsed = measured.displacement, measured.elapsed
    rows, inversion_row = choose_rows(screw.angle, recording.frame, wanted.keyframes, wanted.inversion)
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
    points = _body_points(measured.forearm, wanted)
    axes = find_axes(measured, wanted)
    warnings = measured.warnings + _keyframe_warnings(keyframes, inversion_row, joint, modeled) + axes.warnings
    velocity, near = axes.instantaneous.angular_velocity, pose_from_dual_quat(measured.change)[1]
    phases = movement_phases(velocity, elapsed)
    cycles = find_cycles(screw.angle, phases)
    repetitions = repetitions_of(cycles, screw, measured.line, velocity, elapsed, near)
    if len(cycles) > 1 and wanted.keyframes is None:
        message = (
            f"the motion repeats {len(cycles)} times, and one model through start, inversion and end describes none of "
            "them; give --keyframes of one repetition (repetitions.csv has their frames)"
        )
        warnings += (QualityWarning(code="several-repetitions", message=message),)
    anatomy = None
    if landmarks is not None:
        anatomy, doubts = anatomical_motion(
            landmarks,
            recording,
            measured.arm,
            measured.forearm,
            joint,
            axis_lines=arm_lines(measured.line, joint, wanted.express_in),
            joint_line=None if axes.joint.best is None else axes.joint.best.line,
        )
        warnings += doubts
    return Analysis(
        recording=recording,
        settings=wanted,
        arm=measured.arm,
        forearm=measured.forearm,
        joint=joint,
        screw=screw,
        mean_axis=axes.mean,
        joint_axis=axes.joint,
        instantaneous=axes.instantaneous,
        steps=axes.steps,
        phases=phases,
        repetitions=repetitions,
        repeatability=repeatability_of(cycles, repetitions, screw.angle, elapsed, near),
        anatomy=anatomy,
        keyframes=keyframes,
        interpolated=_compared(modeled, measured, keyframes, points, wanted),
        points=points,
        quality=measured.quality,
        warnings=warnings,
    )


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
    modeled: ModeledPoses, measured: Measurement, keyframes: Keyframes, points: BodyPoints, settings: Settings
) -> InterpolatedMotion:
    D, screw = measured.displacement, measured.screw
    D_model = expressed(modeled.dual_quat, measured.joint, settings.express_in)
    # The model shares its poses with the measurement at the phases' ends: there the angle and its sense are known.
    shared = keyframes.row[keyframes.phase_bounds]
    anchor = int(shared[np.argmax(np.abs(screw.angle[shared]))])
    series = helical_series(D_model, np.radians(settings.min_angle_deg), anchor, screw.angle[anchor])
    unmeasured = ~measured.joint.measured
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
