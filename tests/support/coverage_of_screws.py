"""How often the truth lies within the interval that a noisy trial states of its own screw."""

from __future__ import annotations

import numpy as np
from trials import ARM, FOREARM, LINE, START, joint_poses, noisy_joint, pose_covariance

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import screw_from_dual_quat
from elbowscrew.model import PoseNoise
from elbowscrew.motion.screws.uncertainty import errors_from_covariance, joint_covariance

_NORMAL = 1.959964
IDENTITY = np.array([1.0, 0, 0, 0, 0, 0, 0, 0])


def coverage(angle: float, trials: int, *, proximal_moves: bool, seed: int) -> tuple[float, float, float, float]:
    """Shares of trials in which angle, slide, direction and place lie within their 95 % intervals."""
    rng = np.random.default_rng(seed)
    slide = 0.02 * angle / np.pi
    poses = joint_poses(np.array([[0.0], [angle]]), np.array([[0.0], [slide]]))
    seen = noisy_joint(np.broadcast_to(poses, (2, trials, 8)), rng, proximal_moves=proximal_moves)
    D = dq.multiply(dq.conjugate(seen[0]), seen[1])
    D = np.where(D[:, :1] < 0.0, -D, D)
    noise = [PoseNoise(covariance=pose_covariance(m), source="known", marker_noise=None) for m in (ARM, FOREARM)]
    proximal = noise[0] if proximal_moves else None
    before, after = (joint_covariance(poses, proximal, noise[1]) for poses in seen)
    errors = errors_from_covariance(D, after, before, IDENTITY)
    screw = screw_from_dual_quat(D)
    truth = dq.transform_lines(dq.conjugate(START), LINE)
    h, m = truth[:3], truth[3:]
    tilt = np.arctan2(np.linalg.norm(np.cross(screw.direction, h), axis=1), screw.direction @ h)
    # Where the true line passes the point stated, across it.
    away = np.cross(h, m) - screw.point
    gap = np.linalg.norm(away - (away @ h)[:, None] * h, axis=1)
    inside = (
        np.abs(screw.angle - angle) <= _NORMAL * errors.angle,
        np.abs(screw.slide - slide) <= _NORMAL * errors.slide,
        tilt <= errors.axis_cone,
        gap <= errors.point_radius,
    )
    return tuple(float(share.mean()) for share in inside)  # type: ignore[return-value]
