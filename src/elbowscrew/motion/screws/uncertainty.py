"""First-order errors of the screw of every frame, from the noise of both bodies' poses."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, multiply
from elbowscrew.geometry.sensitivity import confidence_radius, screw_sensitivity
from elbowscrew.geometry.twist import adjoint
from elbowscrew.model import JointMotion, PoseNoise
from elbowscrew.motion.screws.relative import IDENTITY

_BLOCK: Final = 1024  # a block of covariances fits the cache, and no product in it is large enough for threads
# Below so many standard deviations an angle is that of the noise's own rotation, whose sense nobody knows.
_LEAST_SIGNIFICANCE: Final = 5.0


class ScrewErrors(NamedTuple):
    """Standard deviations (N,) of the screw's parameters, and the radii that hold 95 %; NaN where not known.

    Attributes
    ----------
    angle, slide : ndarray, shape (N,)
        Radians and meters.
    axis, point : ndarray, shape (N,)
        Of the direction (rad) and of the axis' position across itself (m), both components together.
    axis_cone, point_radius : ndarray, shape (N,)
        Half-angle (rad) of the cone, and radius (m) of the circle, that hold 95 %.
    """

    angle: Float
    slide: Float
    axis: Float
    point: Float
    axis_cone: Float
    point_radius: Float


def joint_covariance(joint: Float, proximal: PoseNoise | None, distal: PoseNoise) -> Float:
    """Covariance of the relative pose's error ``J exp(e)``: ``e = e_F - Ad(J^-1) e_A``.

    Parameters
    ----------
    joint : ndarray, shape (..., 8)
        Poses of the distal body in the proximal body.
    proximal, distal : PoseNoise
        Of the proximal body, None if it stands still, and of the distal body.

    Returns
    -------
    ndarray, shape (..., 6, 6)
        In the distal body's frame. The proximal body's rotation enters with the distal body's position as its lever.
    """
    if proximal is None:
        return np.broadcast_to(distal.covariance, (*joint.shape[:-1], 6, 6))
    lever = adjoint(conjugate(joint))
    levered = (lever.reshape(-1, 6) @ proximal.covariance).reshape(lever.shape)
    return distal.covariance + levered @ np.swapaxes(lever, -1, -2)


def fitted_covariance(
    joint: JointMotion,
    poses: Float,
    proximal: PoseNoise | None,
    distal: PoseNoise,
    *,
    gain: Float | float = 1.0,
) -> Float:
    """What a joint is fitted with: `joint_covariance` of poses (F, 8), the variance of unmeasured positions infinite.

    Parameters
    ----------
    joint : JointMotion
        That the poses are of.
    poses : ndarray, shape (..., 8)
    proximal, distal : PoseNoise
    gain : ndarray, shape (...), or float
        Share of the noise's variance that a filter has left.
    """
    covariance = np.asarray(gain)[..., None, None] * joint_covariance(poses, proximal, distal)
    if not joint.located:
        covariance = covariance.copy()
        covariance[..., :3, 3:], covariance[..., 3:, :] = 0.0, 0.0
        covariance[..., range(3, 6), range(3, 6)] = np.inf
    return covariance


def screw_errors(
    displacement: Float,
    joint: JointMotion,
    proximal: PoseNoise | None,
    distal: PoseNoise,
    change: Float,
    reference_frames: int,
    noise_gain: Float,
) -> ScrewErrors:
    """Propagate the noise of both bodies, and that of the reference, to the screw of every measured frame.

    ``D = J_0^-1 J`` with ``J exp(e)`` and ``J_0 exp(e_0)`` is ``exp(Ad(D) e - e_0) D``, so that the covariance of the
    small twist is ``Ad(D) S Ad(D)^T + S_0``; the sensitivity of the screw does the rest.

    Parameters
    ----------
    displacement : ndarray, shape (N, 8)
        ``D``, in the distal body's frame at the reference.
    joint : JointMotion
    proximal, distal : PoseNoise
        As in `joint_covariance`.
    change : ndarray, shape (8,)
        Pose of that frame in the one the screws are expressed in.
    reference_frames : int
        How many poses the reference is the mean of.
    noise_gain : ndarray, shape (N,)
        Share of the noise's variance that a filter has left in each frame. The reference counts with all of it: a
        filter leaves the first pose of a run as it is.

    References
    ----------
    Woltring 1985 for one body that moves; the proximal body's noise and the reference's are added here.
    """
    errors = no_errors(len(displacement))
    reference = joint_covariance(joint.reference, proximal, distal) / reference_frames
    rows = np.flatnonzero(joint.measured & (np.linalg.norm(displacement[:, 1:4], axis=1) > 0.0))
    for start in range(0, rows.size, _BLOCK):
        block = rows[start : start + _BLOCK]
        frame = joint_covariance(joint.dual_quat_proximal_distal[block], proximal, distal)
        frame = noise_gain[block, None, None] * frame
        found = errors_from_covariance(displacement[block], frame, reference, change)
        for error, values in zip(errors, found, strict=True):
            error[block] = values
    return errors


def errors_from_covariance(displacement: Float, frame: Float, reference: Float, change: Float) -> ScrewErrors:
    """Errors of screws from the covariances of the two relative poses they lie between.

    Parameters
    ----------
    displacement : ndarray, shape (F, 8)
        ``D``, with some rotation.
    frame, reference : ndarray, shape (F, 6, 6) or (6, 6)
        `joint_covariance` of the frame's pose and of the reference's.
    change : ndarray, shape (8,)
        As in `screw_errors`.
    """
    lever = adjoint(displacement)
    covariance = lever @ frame @ np.swapaxes(lever, -1, -2) + reference
    if (change != IDENTITY).any():
        transform = adjoint(change)
        covariance = transform @ covariance @ transform.T
        displacement = multiply(multiply(change, displacement), conjugate(change))
    screw = screw_sensitivity(displacement)
    turning = screw.direction[..., :3]  # a shift does not move a direction
    direction = turning @ covariance[..., :3, :3] @ np.swapaxes(turning, -1, -2)
    point = screw.point @ covariance @ np.swapaxes(screw.point, -1, -2)
    return ScrewErrors(
        angle=np.sqrt(np.einsum("ni,nij,nj->n", screw.angle, covariance, screw.angle)),
        slide=np.sqrt(np.einsum("ni,nij,nj->n", screw.slide, covariance, screw.slide)),
        axis=np.sqrt(np.trace(direction, axis1=1, axis2=2)),
        point=np.sqrt(np.trace(point, axis1=1, axis2=2)),
        axis_cone=confidence_radius(direction),
        point_radius=confidence_radius(point),
    )


def no_errors(count: int) -> ScrewErrors:
    """Errors of so many frames, none known."""
    return ScrewErrors(*(np.full(count, np.nan) for _ in ScrewErrors._fields))


def known_errors(errors: ScrewErrors, angle: Float, axis_known: NDArray[np.bool_]) -> ScrewErrors:
    """Keep the errors of what is given: of the axis where there is one, of the angle where it is one."""
    significant = np.abs(angle) >= _LEAST_SIGNIFICANCE * errors.angle
    masked = [np.where(axis_known, error, np.nan) for error in errors]
    return ScrewErrors(*masked)._replace(angle=np.where(significant, errors.angle, np.nan))


def least_angle(axis_sd: float, joint: JointMotion, proximal: PoseNoise | None, distal: PoseNoise) -> float:
    """Rotation (rad) from which on an axis' direction is known to `axis_sd` (rad), at the reference.

    The two components have ``(trace(S) - n.S n) / (2 sin^2(theta/2))`` together; the axis is not known yet, so that the
    mean over all directions stands for it.
    """
    rotation = joint_covariance(joint.reference, proximal, distal)[:3, :3]
    sine = np.sqrt(np.trace(rotation) / 3.0) / axis_sd
    return float(2.0 * np.arcsin(min(sine, 1.0)))
