"""Finite helical axes between successive poses, each a given rotation from the one before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import screw_from_dual_quat
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint
from elbowscrew.model import HelicalSteps, JointMotion, PoseNoise
from elbowscrew.motion.screws.uncertainty import errors_from_covariance, joint_covariance, no_errors


def helical_steps(
    displacement: Float,
    angle: Float,
    joint: JointMotion,
    frame: NDArray[np.int64],
    time_s: Float,
    change: Float,
    *,
    step: float,
    sense: Float,
    noise: tuple[PoseNoise | None, PoseNoise] | None,
    noise_gain: Float,
) -> HelicalSteps:
    """Finite helical axes from pose to pose, each at least `step` of rotation from the one before.

    Parameters
    ----------
    displacement : ndarray, shape (N, 8)
        Since the reference, in the distal body's frame there.
    angle : ndarray, shape (N,)
        Rotation since the reference, radians, whose course the steps follow.
    joint : JointMotion
        Its measured frames are stepped through.
    frame : ndarray of int64, shape (N,)
    time_s : ndarray, shape (N,)
    change : ndarray, shape (8,)
        Pose of that frame in the one the axes are expressed in.
    step : float
        Radians.
    sense : ndarray, shape (3,)
        Direction, as expressed, about which a positive angle turns.
    noise : tuple of PoseNoise, optional
        Of the proximal body (None if it stands still) and of the distal body; None where it is not known.
    noise_gain : ndarray, shape (N,)
        Share of its variance that a filter has left in each frame.

    References
    ----------
    Woltring, Huiskes, de Lange and Veldpaus 1985, Journal of Biomechanics 18.
    """
    rows = np.flatnonzero(joint.measured)
    ends = _ends(angle[rows], step)
    first, last = rows[ends[:-1]], rows[ends[1:]]
    forward = dq.multiply(displacement[last], dq.conjugate(displacement[first]))
    move = dq.canonical(dq.multiply(dq.multiply(change, forward), dq.conjugate(change)))
    screw = screw_from_dual_quat(move)
    sign = np.where(screw.direction @ sense < 0.0, -1.0, 1.0)
    errors = no_errors(first.size)
    if noise is not None and first.size:
        poses = joint.dual_quat_proximal_distal
        before, after = (
            _written(displacement[k], noise_gain[k, None, None] * joint_covariance(poses[k], *noise))
            for k in (first, last)
        )
        errors = errors_from_covariance(forward, before, after, change)
    return HelicalSteps(
        start_frame=frame[first],
        end_frame=frame[last],
        start_time_s=time_s[first],
        end_time_s=time_s[last],
        angle=sign * screw.angle,
        slide=sign * screw.slide,
        axis_direction=sign[:, None] * screw.direction,
        axis_point=screw.point,
        angle_sd=errors.angle,
        slide_sd=errors.slide,
        axis_sd=errors.axis,
        point_sd=errors.point,
        axis_cone=errors.axis_cone,
        point_radius=errors.point_radius,
    )


def _ends(angle: Float, step: float) -> NDArray[np.intp]:
    """Indices of the poses stepped to: each depends on the one before, so that they are found one after the other."""
    ends, last = [0], angle[0]
    for k, value in enumerate(angle.tolist()):
        if abs(value - last) >= step:
            ends.append(k)
            last = value
    return np.array(ends, dtype=np.intp)


def _written(displacement: Float, covariance: Float) -> Float:
    """Covariance of the twist in the distal body's frame at the reference, of one in the frame's own."""
    lever = adjoint(displacement)
    return lever @ covariance @ np.swapaxes(lever, -1, -2)
