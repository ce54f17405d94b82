"""The one use case: a recording and settings in, an analysis out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import Analysis, InterpolatedMotion, Landmarks, QualityWarning, Recording
from elbowscrew.model.without_places import without_places
from elbowscrew.motion.anatomy.anatomy import anatomical_motion, joint_of_landmarks, proximal_lines, side_doubts
from elbowscrew.motion.anatomy.functional_axis import functional_axis
from elbowscrew.motion.axes.measured import (
    lines_one_way,
    mean_axis_warnings,
    measured_instantaneous_motion,
    measured_mean_axis,
    measured_steps,
    without_sense,
)
from elbowscrew.motion.interpolation.model_building import JointModel, build_model
from elbowscrew.motion.interpolation.model_errors import model_errors
from elbowscrew.motion.joint.measured import (
    axis_of_type,
    joint_axis_warnings,
    measured_joint_angles,
    measured_joint_axis,
    measured_joint_type,
)
from elbowscrew.motion.movements.measured import cut_warnings, measured_cuts
from elbowscrew.motion.movements.peak_speed import speed_doubts
from elbowscrew.motion.movements.phases import movement_phases
from elbowscrew.motion.movements.repetitions import (
    angle_warnings,
    cycle_curves_of,
    given_warnings,
    repeatability_of,
    repetitions_of,
    speed_warnings,
)
from elbowscrew.motion.screws.measurement import Measurement, measure
from elbowscrew.settings import Settings


def analyze(recording: Recording, settings: Settings | None = None, *, landmarks: Landmarks | None = None) -> Analysis:
    """Analyze a recording; see `elbowscrew.analyze`.

    Raises
    ------
    SettingError, AnalysisError, RecordingError
        If a setting does not fit the recording, there is too little to analyze, or no usable clock.
    """
    wanted = settings or Settings()
    measured = measure(recording, wanted)
    named_joint = measured.named_joint if landmarks is None else joint_of_landmarks(measured.named_joint, landmarks)
    recording, joint, screw, sense = measured.recording, measured.joint, measured.screw, measured.sense
    wanted = wanted.model_copy(update={"express_in": measured.express_in})
    elapsed = measured.elapsed
    mean = measured_mean_axis(measured)
    estimated = measured_joint_axis(measured, mean, wanted)
    joint_type = measured_joint_type(measured, estimated.axis, wanted)
    joint_axis = axis_of_type(estimated.axis, joint_type)
    instantaneous, axes_doubts = measured_instantaneous_motion(measured, wanted)
    velocity, near = instantaneous.angular_velocity, pose_from_dual_quat(measured.change)[1]
    cuts = measured_cuts(measured, wanted, joint_type)
    model = build_model(measured, cuts.movements, wanted, joint_type)
    warnings = (
        measured.warnings
        + mean_axis_warnings(mean, measured)
        + axes_doubts
        + cut_warnings(cuts, wanted)
        + given_warnings(cuts.cycles)
        + model.warnings
        + joint_axis_warnings(joint_axis, joint_type, measured, wanted)
    )
    listed_velocity = velocity if sense.signed else np.full_like(velocity, np.nan)
    repetitions = repetitions_of(
        cuts.cycles, screw, lines_one_way(measured), listed_velocity, elapsed, wanted.min_rate_rad_s
    )
    if sense.signed and np.isfinite(velocity).any():
        warnings += speed_warnings(repetitions, cuts.cycles.sense)
        recorded = measured.unfiltered
        warnings += speed_doubts(recorded.relative[:, :4], recorded.elapsed, cuts.cycles, repetitions)
    warnings += angle_warnings(repetitions)
    curves = cycle_curves_of(cuts.cycles, screw.angle, elapsed)
    cycles = cuts.cycles.start_s
    if (
        cycles.size > 1
        and model.inversion_rows.size < cycles.size
        and wanted.keyframes is None
        and wanted.tolerance_mm is None
    ):
        message = (
            f"the motion repeats {cycles.size} times, and one model through start, inversion and end describes none of "
            "them; leave --phases and --inversion out, or give --keyframes of one repetition (repetitions.csv has them)"
        )
        warnings += (QualityWarning(code="several-repetitions", message=message),)
    anatomy = None
    if landmarks is not None:
        if not joint.located:
            msg = (
                "--landmarks: landmarks are places, and the two bodies have orientations and no positions; leave it out"
            )
            raise SettingError(msg)
        named = wanted.distal is not None and (measured.proximal is None or wanted.proximal is not None)
        warnings += side_doubts(landmarks, measured.proximal, measured.distal, named=named)
        anatomy, doubts = anatomical_motion(
            landmarks,
            recording,
            measured.proximal,
            measured.distal,
            joint,
            axis_lines=proximal_lines(measured.line, joint, measured.express_in),
            functional=functional_axis(estimated, joint_axis, joint_type),
        )
        warnings += doubts
    interpolated = _compared(model, measured, wanted)
    found = Analysis(
        recording=recording,
        settings=wanted,
        proximal=measured.proximal,
        distal=measured.distal,
        named_joint=named_joint,
        joint=joint,
        elapsed=elapsed,
        displacement=measured.displacement,
        screw=replace(screw, axis_direction=screw.axis_direction.copy()),  # a view would keep all of the line
        sense=sense,
        mean_axis=mean,
        joint_axis=joint_axis,
        joint_type=joint_type,
        joint_angles=measured_joint_angles(measured, joint_type, wanted),
        instantaneous=instantaneous if sense.signed else without_sense(instantaneous),
        steps=measured_steps(measured, wanted),
        phases=movement_phases(cuts.movements.onset_s, cuts.movements.offset_s, elapsed),
        repetitions=repetitions,
        cycle_curves=curves,
        repeatability=repeatability_of(curves, repetitions, near),
        anatomy=anatomy,
        keyframes=model.keyframes,
        inversion_rows=model.inversion_rows,
        laws=model.laws,
        selection=model.selection,
        interpolated=interpolated,
        points=model.points,
        quality=measured.quality,
        warnings=warnings,
    )
    return found if joint.located else without_places(found)


def _compared(model: JointModel, measured: Measurement, settings: Settings) -> InterpolatedMotion:
    found = model_errors(model.poses.dual_quat, measured, model.points, settings)
    return InterpolatedMotion(
        frame=measured.screw.frame,
        time_s=measured.screw.time_s,
        phase=model.poses.phase,
        fraction=model.poses.fraction,
        angle=found.series.angle,
        slide=found.series.slide,
        euler_parameters=found.expressed[:, :4].copy(),  # a view would keep all of the poses
        translation=pose_from_dual_quat(found.expressed)[1],
        angle_error=found.angle_error,
        translation_error=found.translation_error,
        rms_displacement=found.rms_displacement,
        axis_error=found.axis_error,
        axis_distance=found.axis_distance,
    )
