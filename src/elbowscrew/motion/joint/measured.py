"""The joint of a measured motion as a whole, and what is doubtful about it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.joints import side_of
from elbowscrew.model import JointAxis, MeanAxis, QualityWarning, RigidBody
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.joint.interval import SkinMotion
from elbowscrew.motion.joint.joint_axis import BodyMarkers, distal_line, estimate_joint_axis, fitted_frames
from elbowscrew.motion.joint.nonrigid import Segment
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.motion.screws.pose_noise import STILL_STRETCH
from elbowscrew.settings import Settings

_LARGE_NOISE_RATIO: Final = 2.0
_FEWEST_MARKERS: Final = 3
_LEAST_SHIFT: Final = 1e-6
# One axis leaves much where it is more than this of the rotation, and 10 deg from end to end (3.3 standard deviations).
_MUCH_SHARE: Final = 0.2
_MUCH_ROTATION: Final = float(np.radians(3.0))
_FOUND: Final = {
    "two_axes": "the joint has two axes (joint.json)",
    "ball": "the joint has a center (joint.json)",
    "free": "no joint of rotations alone explains it",
    "rigid": "the two bodies hardly move against each other",
}


def measured_joint_axis(measured: Measurement, mean: MeanAxis, settings: Settings) -> JointAxis:
    """Estimate the joint's axis, starting from the mean of the finite axes."""
    return estimate_joint_axis(
        measured.joint,
        measured.course,
        distal_line(np.concatenate([mean.direction, np.cross(mean.point, mean.direction)]), measured.change),
        measured.noise,
        measured.noise_gain,
        express_in=measured.express_in,
        robust=settings.robust,
        markers=_markers(measured),
        skin=_skin(measured, settings),
    )


def measured_joint_type(measured: Measurement, joint_axis: JointAxis, *, robust: bool) -> JointType | None:
    """Tell which joint it is where one axis leaves much; None where it does not, or positions tell nothing."""
    best = joint_axis.best
    if best is not None and (joint_axis.unexplained <= _MUCH_SHARE or best.residual_rotation <= _MUCH_ROTATION):
        return None
    _, poses, covariance = fitted_frames(measured.joint, measured.noise, measured.noise_gain)
    if not np.ptp(pose_from_dual_quat(poses)[1], axis=0).max() > _LEAST_SHIFT:
        return None
    return identify_joint(
        poses,
        covariance,
        measured.joint.reference,
        noise_known=measured.noise.known is not None,
        robust=robust,
        left=side_of(measured.distal.name) == "left",
    )


def axis_of_type(joint_axis: JointAxis, joint_type: JointType | None) -> JointAxis:
    """Leave out the fit of one axis where the joint was found to have more than one."""
    if joint_type is None or joint_type.type not in ("two_axes", "ball", "free"):
        return joint_axis
    return replace(joint_axis, single=False, hinge=None, screw_hinge=None, wander=None, mean_axis=None, path=None)


def _markers(measured: Measurement) -> tuple[BodyMarkers, ...]:
    """Markers of the bodies that move; none if one of them does not tell of its markers."""
    found = []
    for segment, body in _moving(measured):
        if body.marker_offsets is None or body.marker_residual is None or len(body.marker_offsets) < _FEWEST_MARKERS:
            return ()
        found.append(BodyMarkers(segment, body.marker_offsets, body.marker_residual))
    return tuple(found)


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
    found: list[tuple[Segment, RigidBody]] = [("distal", measured.distal)]
    if measured.proximal is not None and measured.noise.proximal_moves:
        found.insert(0, ("proximal", measured.proximal))
    return found


def joint_axis_warnings(
    joint_axis: JointAxis, joint_type: JointType | None, measured: Measurement
) -> tuple[QualityWarning, ...]:
    """Say where there is no single axis, and what its error bars stand on."""
    warnings = []
    if not joint_axis.single:
        left = joint_axis.unexplained
        share = f"{100.0 * left:.0f} % of its rotation" if left < 1.0 else "more rotation than there is about it"
        found = "" if joint_type is None else f"; {_FOUND.get(joint_type.type, 'what it is, is undetermined')}"
        message = (
            f"the motion has no single axis: a hinge leaves {share} unexplained, so that no joint axis is fitted, and "
            f"theta and the mean axis mix rotations{found}"
        )
        warnings.append(QualityWarning(code="no-single-axis", message=message))
    if measured.noise.known is None:
        message = "the noise of the poses is not known, so that axes have no error bars; --marker-noise MM gives them"
        warnings.append(QualityWarning(code="noise-unknown", message=message, severity="note"))
    elif joint_axis.best is not None and joint_axis.best.noise_ratio > _LARGE_NOISE_RATIO:
        message = (
            f"the poses leave a hinge by {joint_axis.best.noise_ratio:.1f} times what their noise explains: the joint "
            "is no perfect hinge, or the markers move on the skin; the joint axis' interval is that of the residuals"
        )
        warnings.append(QualityWarning(code="beyond-noise", message=message, severity="note"))
    if any(
        noise is not None and noise.source == STILL_STRETCH
        for noise in (measured.noise.proximal, measured.noise.distal)
    ):
        message = (
            "error bars stand on the jitter of a still stretch, which moving bodies mostly exceed many times; "
            "--marker-noise MM states more"
        )
        warnings.append(QualityWarning(code="noise-from-jitter", message=message))
    return tuple(warnings)
