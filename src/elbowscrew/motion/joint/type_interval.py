"""How far the shared numbers of a joint of any type may be off: markers, residuals and blocks, as of a hinge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.contest import LARGEST_AXIS_SD
from elbowscrew.motion.joint.influence import Influence, influence_of_poses
from elbowscrew.motion.joint.interval import ClusterMotion, JointInterval, Nearby, SkinMotion, joint_interval
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, settled
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import Ball
from elbowscrew.motion.joint.two_axes import TILTS, TwoAxesMechanism

_FARTHEST: Final = np.radians(40.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evidence:
    """What tells of the errors of the poses a joint is fitted to.

    Attributes
    ----------
    noise_known : bool
        Whether the poses' covariance is stated; else only its shape counts.
    clusters : tuple of ClusterMotion
        Of every body that moves, in those frames; empty if one of them has no markers.
    skin : tuple of SkinMotion
        How the clusters are stated to move as a whole on their bones.
    """

    noise_known: bool
    clusters: tuple[ClusterMotion, ...] = ()
    skin: tuple[SkinMotion, ...] = ()

    def at(self, rows: Index) -> Evidence:
        """Of some of the frames."""
        return replace(self, clusters=tuple(cluster.at(rows) for cluster in self.clusters))


def influence_of_type(fit: Fit[Mechanism], poses: Poses) -> Influence:
    """Influence of each pose on the shared numbers of a joint with angles of its own.

    Parameters
    ----------
    fit : Fit
        Of one axis, two axes or a ball.
    poses : Poses
        Those of the fit.
    """
    mechanism = fit.mechanism
    linear = mechanism.linear(poses.joint)
    whitener = poses.whitener @ adjoint(mechanism.residual_frame)
    angles = _angles_of(mechanism)
    found = influence_of_poses(
        linear.residual,
        linear.shared,
        linear.own,
        np.swapaxes(whitener, -1, -2) @ whitener,
        dq.conjugate(mechanism.residual_frame),
        joint=poses.joint,
        angle=angles[:, 0],
        weight=fit.weight,
        told=fit.told,
    )
    return found if angles.shape[1] == 1 else found._replace(second=angles[:, 1])


def interval_of_type(
    fit: Fit[Mechanism], poses: Poses, evidence: Evidence, reference: Float | None = None
) -> JointInterval:
    """Radii that hold the errors of the shared numbers of a joint with angles of its own.

    Parameters
    ----------
    fit : Fit
    poses : Poses
        Those of the fit, in order of time.
    evidence : Evidence
        Of the same frames.
    reference : ndarray, shape (A,), optional
        The joint's angles where the clusters sit right; those of the first frame by default.
    """
    interval = _linear_interval(fit, poses, evidence, reference)
    if not isinstance(fit.mechanism, TwoAxesMechanism):
        return interval
    ends = []
    for step in _ends(interval):
        told = step if fit.told is None else step[list(fit.told)]
        moved = fit.mechanism.moved(step, fit.own_by_shared @ told)
        there = settled(moved, poses)._replace(weight=fit.weight)
        ends.append(Nearby(_linear_interval(there, poses, evidence, reference), fit.mechanism.numbers_by(moved)))
    return replace(interval, nearby=tuple(ends))


def _linear_interval(fit: Fit[Mechanism], poses: Poses, evidence: Evidence, reference: Float | None) -> JointInterval:
    """The interval of a fit that is linear in its errors."""
    start = [None, None] if reference is None else [*(float(angle) for angle in reference[:2]), None]
    return joint_interval(
        influence_of_type(fit, poses),
        evidence.clusters,
        skin=evidence.skin,
        reference_angle=start[0],
        reference_second=start[1],
        noise_known=evidence.noise_known,
    )


def _ends(interval: JointInterval) -> list[Float]:
    """Steps (12,) of two axes to the ends of each direction's interval; none where both are known well enough.

    Where one axis may lie tens of degrees off, how much the frames tell of the other depends on where it is.
    """
    if not largest_tilt_sd(interval) > LARGEST_AXIS_SD:
        return []
    found = []
    for tilt in TILTS:
        each = interval.spread(tilt).each[0]
        covariance = each[np.argmax([np.trace(tilt @ one @ tilt.T) for one in each])]
        values, vectors = np.linalg.eigh(tilt @ covariance @ tilt.T)
        step = NORMAL_95 * covariance @ tilt.T @ vectors[:, -1] / np.sqrt(values[-1])
        farthest = max(float(np.linalg.norm(one @ step)) for one in TILTS)
        step = step * min(1.0, _FARTHEST / farthest)
        found += [step, -step]
    return found


def largest_tilt_sd(interval: JointInterval, axes: Sequence[Float] = TILTS) -> float:
    """Standard deviation (rad) that a direction's interval stands for where it is widest."""
    return max(interval.radius(row[None]) for tilt in axes for row in tilt) / NORMAL_95


def _angles_of(mechanism: Mechanism) -> Float:
    """What a motion is told by, shape (F, 1) or (F, 2): of a ball the two main components of its rotation."""
    if not isinstance(mechanism, Ball):
        return mechanism.frames
    turned = dq.multiply(dq.conjugate(mechanism.frames[len(mechanism.frames) // 2]), mechanism.frames)
    vector = 2.0 * dq.log(dq.canonical(turned))[:, :3]
    about = vector - vector.mean(axis=0)
    main: Float = np.linalg.eigh(about.T @ about)[1][:, :0:-1]
    return np.asarray(about @ main)
