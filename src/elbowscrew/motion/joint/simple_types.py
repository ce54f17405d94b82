"""Joints without an axis or with one: rigid, hinge and screw-hinge, and ball, as mechanisms of one likelihood."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.likelihood import Linear, Mechanism, residual_twist
from elbowscrew.motion.joint.lines import (
    LINE_STEPS,
    about_z,
    angle_about_z,
    line_pose,
    line_twist,
    mean_rotation_pair,
    nearest_points,
)

_IDENTITY: Final = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rigid(Mechanism):
    """No motion at all: one pose (8,)."""

    turning: ClassVar = (0, 1, 2)

    pose: Float

    @classmethod
    def start(cls, joint: Float) -> Rigid:
        """At the mean of poses (F, 8)."""
        signed = dq.align_signs(joint, joint[len(joint) // 2])
        return cls(pose=dq.normalize(signed.mean(axis=0)), frames=np.zeros((len(joint), 0)))

    @property
    def shared_count(self) -> int:
        """A twist of the pose."""
        return 6

    @property
    def residual_frame(self) -> Float:
        """The distal body's own."""
        return _IDENTITY

    def linear(self, joint: Float) -> Linear:
        """Six shared numbers, none of a frame's own."""
        count = len(joint)
        shared = np.broadcast_to(np.eye(6), (count, 6, 6))
        return Linear(residual_twist(self.pose, joint), np.zeros((count, 6, 0)), shared)

    def moved(self, shared: Float, own: Float) -> Self:
        """Move the pose by a twist in its own frame."""
        return replace(self, pose=dq.normalize(dq.multiply(self.pose, dq.exp(0.5 * shared))))

    def placed(self, joint: Float) -> Self:
        """Frames have nothing of their own."""
        return replace(self, frames=np.zeros((len(joint), 0)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OneAxis(Mechanism):
    """A hinge or screw-hinge ``A Z(theta, p theta) F^-1``; `joint_fit` tells the rest. ``frames``: angle (F, 1)."""

    turning: ClassVar = (0, 1, 4, 5)

    proximal: Float
    distal: Float
    pitch: float
    screw: bool

    @classmethod
    def start(cls, joint: Float, *, screw: bool = False) -> OneAxis:
        """From the direction and the point that move least."""
        in_distal, in_proximal = nearest_points(joint, undetermined=1)
        h, g = mean_rotation_pair(joint)
        A, F = line_pose(h, in_proximal), line_pose(g, in_distal)
        slide = dq.pose_from_dual_quat(dq.multiply(dq.multiply(dq.conjugate(A), joint), F))[1][:, 2].mean()
        F = dq.multiply(F, about_z(np.zeros(()), -slide))
        found = cls(proximal=A, distal=F, pitch=0.0, screw=screw, frames=np.zeros((0, 1)))
        return found.placed(joint)

    @property
    def shared_count(self) -> int:
        """Tilts and shifts of both lines, the slide, and a pitch."""
        return 10 if self.screw else 9

    @property
    def residual_frame(self) -> Float:
        """That of the line in the distal body."""
        return self.distal

    def linear(self, joint: Float) -> Linear:
        """9 shared numbers (tilts and shifts of both lines, slide), with a pitch 10; 1 of a frame's own."""
        angle = self.frames[:, 0]
        screw = about_z(angle, self.pitch * angle)
        residual = residual_twist(dq.multiply(self.proximal, screw), dq.multiply(joint, self.distal))
        back = adjoint(dq.conjugate(screw))
        slide = np.broadcast_to(np.eye(6)[:, 5:], (angle.size, 6, 1))
        distal = np.broadcast_to(-np.eye(6)[:, list(LINE_STEPS)], (angle.size, 6, 4))
        columns = [back[:, :, list(LINE_STEPS)], distal, slide]
        if self.screw:
            columns.append(slide * angle[:, None, None])
        own = np.array([0.0, 0.0, 1.0, 0.0, 0.0, self.pitch])
        return Linear(residual, np.broadcast_to(own[:, None], (angle.size, 6, 1)), np.concatenate(columns, axis=2))

    def moved(self, shared: Float, own: Float) -> Self:
        """Move both lines, the slide at angle 0 (a shift of the distal line's frame) and the pitch."""
        distal = line_twist(shared[4:8])
        distal[5] = -0.5 * shared[8]
        by_line = dq.exp([line_twist(shared[:4]), distal])
        lines = dq.normalize([dq.multiply(self.proximal, by_line[0]), dq.multiply(self.distal, by_line[1])])
        return replace(
            self,
            proximal=lines[0],
            distal=lines[1],
            pitch=self.pitch + (float(shared[9]) if self.screw else 0.0),
            frames=self.frames + own,
        )

    def placed(self, joint: Float) -> Self:
        """Angles about the line, continuous over the rows."""
        between = dq.multiply(dq.multiply(dq.conjugate(self.proximal), joint), self.distal)
        return replace(self, frames=angle_about_z(between)[:, None])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ball(Mechanism):
    """A point of each body that stays one: ``J = T(c_A) Q T(-c_F)``. ``frames``: rotations (F, 8).

    The rotation is each frame's own number. To take the measured one for it is the bias of SCoRE (Ehrig, Taylor, Duda
    and Heller 2006), millimeters at a small range.
    """

    turning: ClassVar = ()

    proximal: Float
    distal: Float

    @classmethod
    def start(cls, joint: Float) -> Ball:
        """From the points that stay nearest each other, which is SCoRE."""
        in_distal, in_proximal = nearest_points(joint, undetermined=0)
        return cls(proximal=in_proximal, distal=in_distal, frames=np.zeros((0, 8))).placed(joint)

    @property
    def shared_count(self) -> int:
        """Both centers."""
        return 6

    @property
    def residual_frame(self) -> Float:
        """The distal body's, at the center."""
        return _shift(self.distal)

    def linear(self, joint: Float) -> Linear:
        """Both centers are shared (6); each frame has its rotation (3)."""
        count = len(joint)
        model = dq.multiply(_shift(self.proximal), self.frames)
        residual = residual_twist(model, dq.multiply(joint, _shift(self.distal)))
        own = np.broadcast_to(np.eye(6)[:, :3], (count, 6, 3))
        shared = np.zeros((count, 6, 6))
        shared[:, 3:, :3] = np.swapaxes(rotation_matrix_from_quat(self.frames[:, :4]), -1, -2)
        shared[:, 3:, 3:] = -np.eye(3)
        return Linear(residual, own, shared)

    def moved(self, shared: Float, own: Float) -> Self:
        """Move both centers, and turn each frame by a rotation vector in the distal body."""
        turn = dq.exp(0.5 * np.concatenate([own, np.zeros(own.shape)], axis=1))
        return replace(
            self,
            proximal=self.proximal + shared[:3],
            distal=self.distal + shared[3:],
            frames=dq.normalize(dq.multiply(self.frames, turn)),
        )

    def placed(self, joint: Float) -> Self:
        """Rotations as measured."""
        return replace(self, frames=np.concatenate([joint[:, :4], np.zeros((len(joint), 4))], axis=1))


def _shift(point: Float) -> Float:
    return np.concatenate([_IDENTITY[:4], [0.0], 0.5 * point])
