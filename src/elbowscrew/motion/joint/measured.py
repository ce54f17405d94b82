"""The joint of a measured motion as a whole, and what is doubtful about it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.choices import JOINT_TYPE_WORDS, StatedJoint
from elbowscrew.errors import SettingError
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.joints import side_of
from elbowscrew.model import JointAxis, MeanAxis, QualityWarning, RigidBody
from elbowscrew.model.joint_type import JointAngles, JointType
from elbowscrew.motion.joint.coordinates import with_turns_of
from elbowscrew.motion.joint.every_frame import Everywhere
from elbowscrew.motion.joint.interval import SkinMotion
from elbowscrew.motion.joint.joint_axis import (
    LARGEST_UNEXPLAINED,
    BodyMarkers,
    EstimatedAxis,
    clusters_of,
    distal_line,
    estimate_joint_axis,
    fitted_frames,
)
from elbowscrew.motion.joint.nonrigid import Segment, cluster_like
from elbowscrew.motion.joint.single_step import single_step
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.motion.screws.pose_noise import MARKERS_ASSUMED, STILL_STRETCH, fix_a_pose, stated_rms
from elbowscrew.motion.screws.uncertainty import fitted_covariance
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings

_LARGE_NOISE_RATIO: Final = 2.0
_LEAST_SHIFT: Final = 1e-6
_ONE_AXIS: Final = ("hinge", "screw_hinge")
_OTHERS: Final = ("rigid", "two_axes", "ball", "free")
_NO_CENTER: Final = "three rotations are seen, and whether they have one center orientations do not tell"
_FOUND: Final = {
    "two_axes": "the joint has two axes (joint.json)",
    "ball": "the joint has a center (joint.json)",
    "free": "no joint of rotations alone explains it",
    "rigid": "the two bodies hardly move against each other",
}
_LITTLE_TURN: Final = np.radians(1.0)
_LITTLE_SHIFT: Final = 0.0015


def measured_joint_axis(measured: Measurement, mean: MeanAxis, settings: Settings) -> EstimatedAxis:
    """Estimate the joint's axis, starting from the mean of the finite axes.

    Raises
    ------
    SettingError
        If the joint is stated to slide, and there are no positions.
    """
    if settings.stated_joint == "screw_hinge" and not measured.joint.located:
        msg = (
            "--joint-type screw-hinge: the two bodies have orientations and no positions, which tell of no slide; give "
            "hinge, or leave it out"
        )
        raise SettingError(msg)
    return estimate_joint_axis(
        measured.joint,
        measured.course,
        distal_line(np.concatenate([mean.direction, np.cross(mean.point, mean.direction)]), measured.change),
        measured.noise,
        measured.noise_gain,
        express_in=measured.express_in,
        robust=settings.robust,
        markers=markers_of(measured),
        skin=_skin(measured, settings),
        stated=settings.stated_joint if settings.stated_joint in ("hinge", "screw_hinge") else None,
    )


def measured_joint_type(measured: Measurement, joint_axis: JointAxis, settings: Settings) -> JointType | None:
    """Tell which joint it is, chosen or as stated; None where positions tell nothing."""
    stated = settings.stated_joint
    if stated == "free":
        return _without_numbers(stated, "free, as stated")
    rows, poses, covariance = fitted_frames(measured.joint, measured.noise, measured.noise_gain)
    located = measured.joint.located
    if located and not np.ptp(pose_from_dual_quat(poses)[1], axis=0).max() > _LEAST_SHIFT:
        return None
    return identify_joint(
        poses,
        covariance,
        measured.joint.reference,
        noise_known=measured.noise.known is not None,
        robust=settings.robust,
        forced=stated,
        one=joint_axis.preferred,
        left=side_of(measured.distal.name) == "left",
        everywhere=_everywhere(measured, settings),
        clusters=clusters_of(markers_of(measured), rows),
        skin=_skin(measured, settings),
    )


def _without_numbers(name: StatedJoint, reason: str) -> JointType:
    return JointType(
        type=name,
        status="forced",
        reason=reason,
        candidates=(),
        two_axes=None,
        ball=None,
        second_rotation=None,
        decided_by=None,
        coordinates=None,
        angle=np.zeros((0, 0)),
        angle_sd=np.zeros((0, 0)),
        residual_rotation=np.zeros(0),
        residual_translation=np.zeros(0),
    )


def _everywhere(measured: Measurement, settings: Settings) -> Everywhere:
    """All frames, with the noise that the joint is fitted with."""
    proximal, distal = measured.noise.assumed
    joint = measured.joint
    return Everywhere(
        joint.dual_quat_proximal_distal,
        lambda rows: fitted_covariance(joint, joint.dual_quat_proximal_distal[rows], proximal, distal),
        measured.noise_gain,
        fitted_covariance(joint, joint.reference, proximal, distal) / settings.reference_window,
    )


def measured_joint_angles(
    measured: Measurement, joint_type: JointType | None, settings: Settings
) -> JointAngles | None:
    """Give the joint's own angles in every frame, a hinge's with the sense of theta; None of a joint without any."""
    if joint_type is None or not joint_type.has_angles:
        return None
    valid = measured.screw.valid
    angle, deviation = joint_type.angle.copy(), np.where(valid[:, None], joint_type.angle_sd, np.nan)
    if settings.reference_window == 1:  # the reference is that very frame
        angle[measured.joint.reference_row], deviation[measured.joint.reference_row] = 0.0, 0.0
    if angle.shape[1] == 1:
        angle = -angle if np.nansum(angle[:, 0] * measured.course) < 0.0 else angle
        angle = with_turns_of(angle, measured.sense.twist)
    return JointAngles(
        frame=measured.screw.frame,
        time_s=measured.screw.time_s,
        angle=angle,
        angle_sd=deviation,
        residual_rotation=np.where(valid, joint_type.residual_rotation, np.nan),
        residual_translation=np.where(valid, joint_type.residual_translation, np.nan),
    )


def axis_of_type(joint_axis: JointAxis, joint_type: JointType | None) -> JointAxis:
    """Leave out the fit of one axis where the joint was not found, or is not stated, to have one."""
    kind = None if joint_type is None else joint_type.type
    if kind in _ONE_AXIS or (joint_axis.single and kind not in _OTHERS):
        return replace(joint_axis, single=True)
    return replace(joint_axis, single=False, hinge=None, screw_hinge=None, wander=None, mean_axis=None, path=None)


def markers_of(measured: Measurement) -> tuple[BodyMarkers, ...]:
    """Markers of the bodies that move; none if one of them does not tell of its markers."""
    found = []
    for segment, body in _moving(measured):
        motion, rms = body.marker_motion, body.marker_residual
        shape = body.marker_offsets if motion is None else motion.shape
        if shape is not None and fix_a_pose(shape) and not (motion is None and rms is None):
            found.append(BodyMarkers(segment, shape, motion, rms))
            continue
        unseen = _unseen_markers(segment, body, measured)
        if unseen is None:
            return ()
        found.append(unseen)
    return tuple(found)


def _unseen_markers(segment: Segment, body: RigidBody, measured: Measurement) -> BodyMarkers | None:
    """What an error column tells of markers that the file does not have: four, as the poses jitter."""
    rms = stated_rms(body)
    if not body.located or rms is None or not np.nansum(rms) > 0.0:
        return None
    noise = measured.noise.assumed[1 if segment == "distal" else 0]
    if noise is None:
        return None
    jitter = noise.jitter
    variance = None if jitter is None else float(np.trace(jitter[3:, 3:])) / 3.0
    return BodyMarkers(segment, cluster_like(noise.covariance), None, rms, unseen=True, pose_variance=variance)


def _skin(measured: Measurement, settings: Settings) -> tuple[SkinMotion, ...]:
    """Motion of the clusters as a whole as it is stated, the same for each body that moves."""
    if settings.skin_motion is None:
        return ()
    shift, turn = settings.skin_motion[0], settings.skin_motion[1] if len(settings.skin_motion) > 1 else 0.0
    return tuple(
        SkinMotion(segment=segment, shift=1e-3 * shift, turn=float(np.radians(turn)))
        for segment, _ in _moving(measured)
    )


def _moving(measured: Measurement) -> list[tuple[Segment, RigidBody]]:
    proximal_moves, distal_moves = measured.noise.moving
    found: list[tuple[Segment, RigidBody]] = []
    if measured.proximal is not None and proximal_moves:
        found.append(("proximal", measured.proximal))
    if distal_moves:
        found.append(("distal", measured.distal))
    return found


def joint_axis_warnings(
    joint_axis: JointAxis, joint_type: JointType | None, measured: Measurement, settings: Settings
) -> tuple[QualityWarning, ...]:
    """Say where there is no single axis, and what its error bars rest on."""
    warnings = [*_doubts_of_type(joint_axis, joint_type), *_steps(joint_type, measured)]
    stated = joint_type is not None and joint_type.status == "forced"
    if not joint_axis.single and not (stated and joint_axis.unexplained <= LARGEST_UNEXPLAINED):
        left = joint_axis.unexplained
        share = f"{100.0 * left:.0f} % of its rotation" if left < 1.0 else "more rotation than there is about it"
        found = "" if joint_type is None else f"; {_FOUND.get(joint_type.type, 'what it is, is undetermined')}"
        if joint_type is not None and joint_type.type == "ball" and not measured.joint.located:
            found = f"; {_NO_CENTER}"
        if stated and joint_type is not None and joint_type.type == "rigid":
            found = "; it is stated to be rigid"
        message = (
            f"the motion has no single axis: a hinge leaves {share} unexplained, so that no joint axis is fitted, and "
            f"theta and the mean axis mix rotations{found}"
        )
        warnings.append(QualityWarning(code="no-single-axis", message=message))
    if measured.noise.known is None:
        how = "--marker-noise MM gives them" if measured.joint.located else "only a still stretch would tell of it"
        message = f"the noise of the poses is not known, so that axes have no error bars; {how}"
        warnings.append(QualityWarning(code="noise-unknown", message=message, severity="note"))
    elif joint_axis.best is not None and joint_axis.best.noise_ratio > _LARGE_NOISE_RATIO:
        times = f"{joint_axis.best.noise_ratio:.1f} times"
        message = (
            f"the poses leave a hinge by {times} what their noise explains: the joint "
            "is not a perfect hinge, or the markers move on the skin; the joint axis' interval is that of the residuals"
        )
        warnings.append(QualityWarning(code="beyond-noise", message=message, severity="note"))
    if _told_without_markers(joint_axis, joint_type, measured, settings):
        message = (
            "the file tells nothing of markers, so that the joint's 95 % intervals hold for bodies that are rigid on "
            "their bones: skin that moves with the motion is in none of them, and passes for a slide, a wander or a "
            "second axis; --skin-motion MM,DEG states how far it goes"
        )
        warnings.append(QualityWarning(code="skin-unseen", message=message))
    known = measured.noise.known or ()
    if any(one is not None and one.source.endswith(MARKERS_ASSUMED) for one in known):
        warnings.append(_assumed_markers(joint_axis))
    if any(
        n is not None and n.source == STILL_STRETCH and m for n, m in zip(known, measured.noise.moving, strict=False)
    ):
        message = (
            "error bars rest on the jitter of a still stretch, which a moving body usually exceeds many times over"
            + ("; --marker-noise MM states more" if measured.joint.located else "")
        )
        warnings.append(QualityWarning(code="noise-from-jitter", message=message))
    return tuple(warnings)


def _told_without_markers(
    joint_axis: JointAxis, joint_type: JointType | None, measured: Measurement, settings: Settings
) -> bool:
    """Whether an interval is given that no markers' motion, seen or stated, has a part in."""
    if joint_axis.markers_told is not None or not measured.joint.located or settings.skin_motion is not None:
        return False
    axis = joint_axis.headline
    return (axis is not None and axis.decided_by is not None) or (
        joint_type is not None and joint_type.decided_by is not None
    )


def _assumed_markers(joint_axis: JointAxis) -> QualityWarning:
    """Say what error bars rest on where neither the file nor the poses' jitter tells what markers make of errors."""
    message = (
        "the number and places of the markers are assumed, as the file has none and the jitter of the poses does not "
        "tell what they make of errors: error bars of single frames may be off by a factor"
    )
    ratio = None if joint_axis.best is None else joint_axis.best.noise_ratio
    beyond = ratio is not None and ratio > _LARGE_NOISE_RATIO
    message += f", as a hinge leaves {ratio:.1f} times as much" if beyond else ""
    message += "; --marker-noise MM and --radius MM state more"
    return QualityWarning(code="noise-assumed", message=message, severity="warning" if beyond else "note")


def _doubts_of_type(joint_axis: JointAxis, joint_type: JointType | None) -> list[QualityWarning]:
    """Say where the joint was stated to be what the motion does not show, and where it does not show both axes."""
    if joint_type is None:
        return []
    stated, code = joint_type.status == "forced", "stated-joint"
    two = joint_type.two_axes
    if stated and joint_type.type in ("hinge", "screw_hinge") and joint_axis.unexplained > LARGEST_UNEXPLAINED:
        message = (
            f"the joint is stated to be {JOINT_TYPE_WORDS[joint_type.type]}, but one axis leaves "
            f"{100.0 * joint_axis.unexplained:.0f} % as much rotation as there is about it: no axis of this motion is "
            "that joint's; leave --joint-type out to see which joint it is"
        )
    elif any(candidate.type == joint_type.type and not candidate.valid for candidate in joint_type.candidates):
        what = JOINT_TYPE_WORDS[joint_type.type]
        message = f"the joint is stated to be {what}, but the motion does not determine it: it has no angles here"
    elif stated and joint_type.ball is not None and not np.isfinite(joint_type.ball.radius):
        message = "the joint is stated to be a ball joint, but the motion does not determine its center"
    elif stated and joint_type.type == "rigid" and (moves := _moves(joint_type)):
        message = f"the joint is stated to be rigid, but the bodies move by {moves} RMS against each other"
    elif two is not None and not all(line.determined for line in two.lines):
        told = (
            "the joint is stated to have two axes, but the motion does not determine"
            if stated
            else ("the joint has two axes, but the motion does not determine the directions of")
        )
        message, code = f"{told} both: what each angle is of is as uncertain", code if stated else "axis-undetermined"
    elif two is not None and not two.order_determined:
        code = "axes-order"
        message = (
            "the joint has two axes, but hardly turns about both at once, so that it does not tell which one is that "
            "of the proximal body: axes and angles may be the other way round; turn about each at several angles of "
            "the other"
        )
    else:
        return []
    return [QualityWarning(code=code, message=message)]


def _steps(joint_type: JointType | None, measured: Measurement) -> list[QualityWarning]:
    """Say of which angle a cluster that slipped once may be the reason."""
    if joint_type is None or joint_type.type not in (*_ONE_AXIS, "two_axes"):
        return []
    found = []
    for number, angle in enumerate(joint_type.angle.T, start=1):
        step = single_step(angle)
        if step is None:
            continue
        name = f"angle {number} of the joint" if joint_type.angle.shape[1] > 1 else "the joint's angle"
        message = (
            f"{name} {step.words}; the step is at frame {measured.recording.frame[step.row]}: analyze the parts before "
            "and after it each by itself"
        )
        found.append(QualityWarning(code="steps-once", message=message))
    return found


def _moves(rigid: JointType) -> str:
    """How far two bodies move that are stated not to; nothing where that is little."""
    left = next(candidate for candidate in rigid.candidates if candidate.type == "rigid")
    turn, shift = left.residual_rotation, left.residual_translation
    if turn < _LITTLE_TURN and not shift > _LITTLE_SHIFT:
        return ""
    return f"{in_digits(np.degrees(turn))} deg" + (f" and {in_digits(1000.0 * shift)} mm" if shift > 0.0 else "")
