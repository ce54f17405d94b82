"""What turns back where the motion does: the rotation that is cut into movements and cycles."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry import quaternion
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.geometry.dual_quaternion import conjugate, continuous_signs, multiply
from elbowscrew.geometry.quaternion import rotate
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.joint.coordinates import joint_angles_of
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.motion.screws.sense import DOMINANT_RATIO, sense_of
from elbowscrew.motion.screws.uncertainty import joint_covariance
from elbowscrew.settings import Settings

# Rotations about two axes that are less apart add up to a twist about the direction between them.
_APART: Final = float(np.radians(30.0))


def two_axes_of(joint_type: JointType | None) -> JointCoordinates | None:
    """Give the joint on whose angle 1 the cuts are: it has two axes for sure, or as stated, that are well apart."""
    if not mixes_two_axes(joint_type) or joint_type is None or not joint_type.has_angles:
        return None
    wanders = joint_type.two_axes is not None and joint_type.two_axes.only_wander_doubted
    return joint_type.coordinates if wanders or joint_type.status in ("determined", "forced") else None


def mixes_two_axes(joint_type: JointType | None) -> bool:
    """Whether the joint has two axes so far apart that a twist about one direction is of neither of them."""
    found = None if joint_type is None else joint_type.two_axes
    return found is not None and found.angle_between.value > _APART


def measured_course(measured: Measurement, settings: Settings, joint_type: JointType | None = None) -> Float:
    """Rotation of the unfiltered poses that turns back where the motion does, radians, shape (M,); NaN without a pose.

    Of a joint that surely has two axes it is the angle about the first, else the twist ``2 atan2(v.u, w)`` since the
    reference about the dominant or leading direction u (`Sense.twist`), positive as theta is. It is on the poses' own
    clock.
    """
    bodies, relative = measured.unfiltered, measured.unfiltered.relative
    known: Bool = np.asarray(np.isfinite(relative).all(axis=1))
    if not known.any():
        return np.full(len(relative), np.nan)
    wanted = measured.elapsed[measured.joint.reference_row]
    rows = np.flatnonzero(known)
    reference = int(rows[np.argmin(np.abs(bodies.elapsed[rows] - wanted))])
    joint = two_axes_of(joint_type)
    if joint is not None and joint_type is not None:
        filtered = measured.smoothing.cutoff_hz is not None or len(relative) != measured.elapsed.size
        wanders = joint_type.two_axes is not None and joint_type.two_axes.wanders
        # Else they are the very poses that the very axes were put on.
        again = filtered or wanders
        angle = _first_angle(measured, relative, reference, joint) if again else joint_type.angle[:, 0]
        return np.where(known, _way_of_theta(measured, joint_type) * angle, np.nan)
    turned = quaternion.multiply(quaternion.conjugate(relative[reference, :4]), relative[:, :4])
    own = sense_of(turned, bodies.elapsed, reference, signed=settings.signed)
    # A filter, or a mean over the reference window, may make the other one of two like excursions the larger.
    along = rotate(quaternion.conjugate(measured.change[:4]), measured.sense.direction)
    return own.twist if own.direction @ along >= 0.0 else -own.twist


def course_of_frames(measured: Measurement, joint_type: JointType | None) -> Float:
    """Give the like rotation of the frames that are analyzed, theta in place of the twist, shape (N,), radians."""
    if joint_type is None or two_axes_of(joint_type) is None:
        return measured.course
    return _way_of_theta(measured, joint_type) * joint_type.angle[:, 0]


def _way_of_theta(measured: Measurement, joint_type: JointType) -> float:
    """Sign that makes angle 1 increase where theta does, if one axis dominates: each may be larger on another side."""
    angle, twist = joint_type.angle[:, 0], measured.sense.twist
    known = np.isfinite(angle) & np.isfinite(twist)
    opposed = np.cov(angle[known], twist[known])[0, 1] < 0.0
    return -1.0 if opposed and measured.sense.ratio <= DOMINANT_RATIO else 1.0


def _first_angle(measured: Measurement, relative: Float, reference: int, joint: JointCoordinates) -> Float:
    def covariance(rows: Index) -> Float:
        return joint_covariance(relative[rows], *measured.noise.assumed)

    pose = continuous_signs(multiply(conjugate(measured.joint.reference), relative))
    return joint_angles_of(joint, pose, covariance, reference)[:, 0]
