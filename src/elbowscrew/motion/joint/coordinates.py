"""A joint's own angles: poses from them, and they from poses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np

from elbowscrew.geometry import dual_quat_from_screw, quaternion
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.motion.joint.likelihood import Mechanism, settled
from elbowscrew.motion.joint.lines import Z_LINE, about_z, line_pose
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import Ball, OneAxis
from elbowscrew.motion.joint.two_axes import TwoAxesMechanism

_TURN: Final = 2.0 * np.pi
_BLOCK: Final = 4096
_NO_ROTATION: Final = np.array([1.0, 0.0, 0.0, 0.0])


def coordinates_of(mechanism: Mechanism, reference: Float) -> JointCoordinates | None:
    """Write a fitted joint as a function of its angles, counted from where a reference pose has them.

    Parameters
    ----------
    mechanism : Mechanism
        Of relative poses; its frames hold the angles of the reference alone.
    reference : ndarray, shape (8,)

    Returns
    -------
    JointCoordinates or None
        In the distal body's frame at the reference; None of a rigid joint.
    """
    back = dq.conjugate(reference)
    if isinstance(mechanism, TwoAxesMechanism):
        at = mechanism.zeroed(mechanism.frames[0])
        first = dq.multiply(back, at.proximal)
        second = dq.multiply(first, at.between)
        return _with_axes("two_axes", [first, second], dq.multiply(second, dq.conjugate(at.distal)))
    if isinstance(mechanism, OneAxis):
        first = dq.multiply(back, mechanism.proximal)
        after = dq.conjugate(mechanism.distal)
        # The pose tells the angle but for whole turns; with a pitch only one of them has the reference's slide.
        turns = mechanism.frames[0, 0] + _TURN * np.arange(-2.0, 3.0)
        ends = dq.multiply(dq.multiply(first, about_z(turns, mechanism.pitch * turns)), after)
        end = ends[int(np.argmin(length(dq.pose_from_dual_quat(ends)[1])))]
        kind = "screw_hinge" if mechanism.screw else "hinge"
        return replace(_with_axes(kind, [first], end), pitch=mechanism.pitch)
    if isinstance(mechanism, Ball):
        own = mechanism.frames[0]
        after = _pose(_NO_ROTATION, -mechanism.distal)
        end = dq.multiply(back, dq.multiply(_pose(own[:4], mechanism.proximal), after))
        center = dq.transform_points(back, mechanism.proximal)
        return JointCoordinates(
            type="ball", axis=np.zeros((0, 3)), point=center[None], pitch=0.0, end=_positive(dq.normalize(end))
        )
    return None


def joint_poses(joint: JointCoordinates, angle: Float) -> Float:
    """Displacements (N, 8) of a joint at angles (N, k), signs going on with the angles.

    Parameters
    ----------
    joint : JointCoordinates
    angle : ndarray, shape (N, k)
        Of a ball the rotation vector, up to a whole turn long, in the frame of the center.
    """
    if joint.type == "ball":
        center = joint.point[0]
        turn = quaternion.quat_from_rotation_vector(angle)
        return dq.multiply(dq.dual_quat_from_pose(turn, center - quaternion.rotate(turn, center)), joint.end)
    screws = [
        dual_quat_from_screw(angle[:, k], joint.pitch * angle[:, k], axis, np.cross(point, axis))
        for k, (axis, point) in enumerate(zip(joint.axis, joint.point, strict=True))
    ]
    whole = screws[0] if len(screws) == 1 else dq.multiply(screws[0], screws[1])
    return dq.multiply(whole, joint.end)


def joint_angles_of(
    joint: JointCoordinates, pose: Float, covariance: Callable[[Index], Float], reference_row: int
) -> Float:
    """Give the joint's angles (N, k) that are most likely at displacements (N, 8); NaN where there is none.

    Parameters
    ----------
    joint : JointCoordinates
    pose : ndarray, shape (N, 8)
        Sign-continuous.
    covariance : callable
        Of the errors (F, 6, 6) of rows (F,), in the distal body's frame.
    reference_row : int
        Where the angles are next to none.
    """
    mechanism = _mechanism(joint)
    pose = -pose if pose[reference_row, 0] < 0.0 else pose  # then no whole turn is hidden in the sign
    rows = np.flatnonzero(np.isfinite(pose[:, 0]))
    angle = np.full((len(pose), joint.angles), np.nan)
    start = mechanism.placed(pose[rows])
    for first in range(0, rows.size, _BLOCK):
        part = rows[first : first + _BLOCK]
        own = settled(mechanism, Poses.of(pose[part], covariance(part))).mechanism.frames
        if joint.type == "ball":
            angle[part] = _vectors(dq.multiply(own, dq.conjugate(_rotation(joint.end)))[:, :4])
        else:  # the turn that the motion leads to
            near = start.frames[first : first + _BLOCK]
            angle[part] = own + _TURN * np.round((near - own) / _TURN)
    if joint.type == "ball":
        return angle
    return np.asarray(angle - _TURN * np.round(angle[reference_row] / _TURN))


def with_turns_of(angle: Float, twist: Float) -> Float:
    """Give angles about one axis (N, 1) the whole turns of a rotation (N,) about nearly the same one.

    From frame to frame alone an angle goes the shorter way, over a gap as well.
    """
    turns = np.round((twist[:, None] - angle) / _TURN)
    return np.asarray(angle + _TURN * np.nan_to_num(turns))


def expressed_joint(joint: JointCoordinates, change: Float) -> JointCoordinates:
    """Write a joint in the frame that a pose (8,) of its own frame is given in."""
    return replace(
        joint,
        axis=quaternion.rotate(change[:4], joint.axis) if len(joint.axis) else joint.axis,
        point=dq.transform_points(change, joint.point),
        end=dq.multiply(dq.multiply(change, joint.end), dq.conjugate(change)),
    )


def expressed_angles(joint: JointCoordinates, angle: Float, change: Float) -> Float:
    """Write angles in another frame: those about axes stay, a ball's rotation vector turns."""
    return quaternion.rotate(change[:4], angle) if joint.type == "ball" else angle


def _with_axes(kind: Any, frames: list[Float], end: Float) -> JointCoordinates:
    return JointCoordinates(
        type=kind,
        axis=np.stack([dq.transform_lines(frame, Z_LINE)[:3] for frame in frames]),
        point=np.stack([dq.pose_from_dual_quat(frame)[1] for frame in frames]),
        pitch=0.0,
        end=_positive(dq.normalize(end)),
    )


def _mechanism(joint: JointCoordinates) -> Mechanism:
    """Give the joint as a mechanism of displacements, without frames."""
    back = dq.conjugate(joint.end)
    if joint.type == "ball":
        center = joint.point[0]
        return Ball(proximal=center, distal=dq.transform_points(back, center), frames=np.zeros((0, 8)))
    lines = [line_pose(axis, point) for axis, point in zip(joint.axis, joint.point, strict=True)]
    distal = dq.multiply(back, lines[-1])
    if len(lines) == 1:
        screw = joint.type == "screw_hinge"
        return OneAxis(proximal=lines[0], distal=distal, pitch=joint.pitch, screw=screw, frames=np.zeros((0, 1)))
    between = dq.multiply(dq.conjugate(lines[0]), lines[1])
    return TwoAxesMechanism(proximal=lines[0], between=between, distal=distal, frames=np.zeros((0, 2)))


def _vectors(quat: Float) -> Float:
    """Rotation vectors (N, 3) up to a whole turn long, so that they keep the quaternions' signs."""
    size = length(quat[:, 1:])
    angle = 2.0 * np.arctan2(size, quat[:, 0])
    # angle/sin(angle/2) is 2 at no angle; a whole turn of any direction is left at that of round-off.
    ratio = np.divide(angle, size, out=np.full(size.shape, 2.0), where=size > np.finfo(np.float64).tiny)
    return np.asarray(ratio[:, None] * quat[:, 1:])


def _rotation(pose: Float) -> Float:
    return _pose(pose[:4], np.zeros(3))


def _pose(quat: Float, point: Float) -> Float:
    return dq.dual_quat_from_pose(quat, point)


def _positive(pose: Float) -> Float:
    return -pose if pose[0] < 0.0 else pose
