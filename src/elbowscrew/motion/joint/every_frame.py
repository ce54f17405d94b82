"""A fitted joint's own numbers in every frame of a trial: angles, their standard deviations, and what is left over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry._small_angle import half_cotangent_share, length
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.geometry.sensitivity import cross_matrix
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.interval import JointInterval
from elbowscrew.motion.joint.likelihood import Mechanism, settled
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import Ball

_MOST_SETTLED: Final = 20_000
_FRAMES_ASKED: Final = 8  # for the factors between variances and radii, which are all but alike in all frames
_BLOCK: Final = 2048
_DUAL_QUAT: Final = 8
_TURN: Final = 2.0 * np.pi


class Everywhere(NamedTuple):
    """Poses of all frames of a trial, and the covariances of their errors.

    Attributes
    ----------
    joint : ndarray, shape (N, 8)
        NaN where there is no pose.
    covariance : callable
        From rows (F,) to covariances (F, 6, 6) in the distal body's frame, before a filter.
    noise_gain : ndarray, shape (N,)
        Share of them that a filter has left.
    reference_covariance : ndarray, shape (6, 6), optional
        Of the pose that angles count from; without it that pose is exact.
    """

    joint: Float
    covariance: Callable[[Index], Float]
    noise_gain: Float
    reference_covariance: Float | None = None

    def poses(self, rows: Index) -> Poses:
        """Poses of some frames, whitened as before a filter: its share is the same for all that a frame has."""
        return Poses.of(self.joint[rows], self.covariance(rows))


class FrameNumbers(NamedTuple):
    """What a joint's type says of each frame; NaN where there is no pose.

    Attributes
    ----------
    angle, angle_sd : ndarray, shape (N, k)
        rad, from the reference pose; the standard deviations are those of the stated noise of the frame and of the
        reference, for given axes.
    axes_sd : ndarray, shape (N, k)
        What the errors of the axes add to them; 0 where they are not told.
    residual_rotation, residual_translation : ndarray, shape (N,)
        rad and m, the latter at the origin of `Mechanism.residual_frame`.
    at_reference : ndarray, shape (1, k)
        The mechanism's own numbers at the reference pose.
    """

    angle: Float
    angle_sd: Float
    axes_sd: Float
    residual_rotation: Float
    residual_translation: Float
    at_reference: Float


def numbers_everywhere(
    mechanism: Mechanism, frames: Everywhere, reference: Float, errors: JointInterval | None = None
) -> FrameNumbers:
    """Put a joint on all frames, block by block, so that a long trial needs no more memory than its result.

    Parameters
    ----------
    mechanism : Mechanism
        Its shared numbers stay as they are.
    frames : Everywhere
    reference : ndarray, shape (8,)
        Pose that angles count from.
    errors : JointInterval, optional
        Of the shared numbers of a joint with axes, which the angles follow.

    Returns
    -------
    FrameNumbers
        Angles go on from frame to frame, over gaps by the shorter way. Of a ball they are the rotation vector in the
        proximal body's axes. Of more than 20,000 frames each takes one step from its closed form, weighed as at the
        nearest of 20,000 frames.
    """
    rows = np.flatnonzero(np.isfinite(frames.joint[:, 0]))
    start = reference_numbers(mechanism, frames, reference)
    own = start.covariance.shape[1]
    every = rows.size <= _MOST_SETTLED or own == 0  # a rigid joint's frames have no numbers to step
    settle = _settled_block if every else _NearestWeights.of(mechanism, frames, rows).stepped
    count = len(frames.joint)
    angle, deviation = np.full((count, own), np.nan), np.full((count, own), np.nan)
    by_axes = np.where(np.isfinite(frames.joint[:, :1]), np.zeros((count, own)), np.nan)
    rotation, translation = np.full(count, np.nan), np.full(count, np.nan)
    spread = None
    if errors is not None and rows.size:
        some = _settled_block(mechanism, frames, evenly_thinned(rows, _FRAMES_ASKED)).by_shared - start.by_shared
        spread = errors.spread(mechanism.whole(some.reshape(-1, some.shape[2])))
    last: Float | None = None
    for first in range(0, rows.size, _BLOCK):
        block = rows[first : first + _BLOCK]
        at = settle(mechanism, frames, block)
        at = at._replace(covariance=frames.noise_gain[block, None, None] * at.covariance)
        if isinstance(mechanism, Ball):
            angle[block], covariance = _rotation_vectors(at, start)
        else:
            found, covariance = at.own - start.own, at.covariance + start.covariance
            if last is not None and own:
                found = found - _TURN * np.round((found[0] - last) / _TURN)
            angle[block] = found
            last = angle[block[-1]]
            if spread is not None:
                by_axes[block] = spread.deviations(mechanism.whole(at.by_shared - start.by_shared))
        deviation[block] = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        rotation[block] = length(at.residual[:, :3])
        translation[block] = length(at.residual[:, 3:])
    return FrameNumbers(angle, deviation, by_axes, rotation, translation, start.own)


class OwnNumbers(NamedTuple):
    """Own numbers (F, ...) of some frames, their covariances (F, k, k), and the residuals (F, 6).

    `by_shared` (F, k, P) is how they follow the shared numbers that are told.
    """

    own: Float
    covariance: Float
    by_shared: Float
    residual: Float


def reference_numbers(mechanism: Mechanism, frames: Everywhere, reference: Float) -> OwnNumbers:
    """Own numbers of the reference pose (8,), as of one frame."""
    known = frames.reference_covariance
    covariance = frames.covariance(np.arange(1)) if known is None else known[None]
    fit = settled(mechanism, Poses.of(reference[None], covariance), rounds=5)
    share = 0.0 if known is None else 1.0
    return OwnNumbers(fit.mechanism.frames, share * fit.own_covariance, fit.own_by_shared, fit.residual)


def near_zero(angle: Float) -> Float:
    """Take off the whole turns that the frame nearest the reference pose has."""
    known = angle[np.isfinite(angle).all(axis=1)]
    if not known.size:
        return angle
    turns = np.round(known / (_TURN))
    nearest = np.argmin(np.sum(np.abs(known - _TURN * turns), axis=1))
    return np.asarray(angle - _TURN * turns[nearest])


def _settled_block(mechanism: Mechanism, frames: Everywhere, rows: Index) -> OwnNumbers:
    fit = settled(mechanism, frames.poses(rows))
    return OwnNumbers(fit.mechanism.frames, fit.own_covariance, fit.own_by_shared, fit.residual)


@dataclass(frozen=True, slots=True, eq=False)
class _NearestWeights:
    """How residuals (6) move a frame's own numbers (k), at some frames: elsewhere those of the nearest one count.

    The weights change with the pose as slowly as levers do, and so does the covariance.
    """

    tree: Any
    weight: Float
    covariance: Float
    by_shared: Float

    @classmethod
    def of(cls, mechanism: Mechanism, frames: Everywhere, rows: Index) -> _NearestWeights:
        from scipy.spatial import cKDTree

        chosen = evenly_thinned(rows, _MOST_SETTLED)
        fit = settled(mechanism, frames.poses(chosen))
        parts = []
        for first in range(0, chosen.size, _BLOCK):
            part = np.arange(first, min(first + _BLOCK, chosen.size))
            poses = frames.poses(chosen[part])
            whitener = poses.whitener @ adjoint(mechanism.residual_frame)
            own = whitener @ fit.mechanism.on(part).linear(poses.joint).own
            parts.append(fit.own_covariance[part] @ np.swapaxes(own, -1, -2) @ whitener)
        return cls(
            cKDTree(_neighborhood(fit.mechanism.frames)), np.concatenate(parts), fit.own_covariance, fit.own_by_shared
        )

    def stepped(self, mechanism: Mechanism, frames: Everywhere, rows: Index) -> OwnNumbers:
        """One step from the closed form."""
        at = mechanism.placed(frames.joint[rows])
        linear = at.linear(frames.joint[rows])
        nearest = self.tree.query(_neighborhood(at.frames))[1]
        step = np.einsum("fki,fi->fk", self.weight[nearest], linear.residual)
        moved = at.moved(np.zeros(linear.shared.shape[2]), step)
        residual = linear.residual - np.einsum("fik,fk->fi", linear.own, step)
        return OwnNumbers(moved.frames, self.covariance[nearest], self.by_shared[nearest], residual)


def _neighborhood(own: Float) -> Float:
    """Where frames are, by their angles (F, k) or rotations (F, 8), so that a whole turn is no distance."""
    if own.shape[1] == _DUAL_QUAT:
        return rotation_matrix_from_quat(own[:, :4]).reshape(-1, 9)
    return np.concatenate([np.cos(own), np.sin(own)], axis=1)


def _rotation_vectors(at: OwnNumbers, start: OwnNumbers) -> tuple[Float, Float]:
    """Rotation vectors (F, 3) from a start, and their covariances (F, 3, 3), in the proximal body's axes."""
    counted = dq.canonical(dq.multiply(at.own, dq.conjugate(start.own)))
    vector = 2.0 * dq.log(counted)[:, :3]
    after = rotation_matrix_from_quat(at.own[:, :4])
    before = rotation_matrix_from_quat(counted[:, :4]) @ rotation_matrix_from_quat(start.own[:, :4])
    turns = after @ at.covariance @ np.swapaxes(after, -1, -2) + before @ start.covariance @ np.swapaxes(before, -1, -2)
    by_turn = inverse_jacobian(vector)
    return vector, by_turn @ turns @ np.swapaxes(by_turn, -1, -2)


def inverse_jacobian(vector: Float) -> Float:
    """How a rotation vector (F, 3) changes with a small rotation that comes after it, shape (F, 3, 3).

    ``log(exp(e) exp(v)) = v + J e``, ``J = 1 - [v]x/2 + (1 - (t/2) cot(t/2)) [v]x^2/t^2`` with the angle t.
    """
    angle = length(vector)
    cross = cross_matrix(vector)
    found: Float = np.eye(3) - 0.5 * cross + half_cotangent_share(angle)[..., None, None] * (cross @ cross)
    return found
