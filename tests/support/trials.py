"""Many noisy poses of one synthetic joint at once: markers seen with noise, poses fitted to them."""

from __future__ import annotations

import numpy as np

from elbowscrew.geometry import dual_quat_from_screw, line_through, pose_from_points
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.screws.pose_noise import covariance_from_markers

SIGMA = 2e-4
LINE = line_through([0.004, -0.132, 0.011], [0.986, 0.104, -0.131])
START = dq.dual_quat_from_pose(qn.quat_from_rotation_vector([0.09, 0.21, -0.06]), [0.018, -0.251, 0.037])
ARM = np.array([[38, 12, 31], [-41, 27, 8], [9, -44, -28], [-6, 5, -47]]) * 1e-3
FOREARM = np.array([[35, 33, -9], [-37, 14, 25], [-11, -45, 19], [28, -21, -38]]) * 1e-3


def joint_poses(angle: Float, slide: Float) -> Float:
    """Forearm in the arm, without noise, turned about `LINE`."""
    return dq.multiply(dual_quat_from_screw(angle, slide, LINE[:3], LINE[3:]), START)


def noisy_joint(poses: Float, rng: np.random.Generator, *, proximal_moves: bool = True) -> Float:
    """Forearm in the arm as both bodies' markers tell it, each coordinate with `SIGMA`."""
    distal = _seen(FOREARM, poses, rng)
    if not proximal_moves:
        return distal
    identity = np.zeros(poses.shape)
    identity[..., 0] = 1.0
    return dq.multiply(dq.conjugate(_seen(ARM, identity, rng)), distal)


def pose_covariance(offsets: Float) -> Float:
    return covariance_from_markers(offsets - offsets.mean(axis=0), SIGMA)


def _seen(offsets: Float, poses: Float, rng: np.random.Generator) -> Float:
    centered = offsets - offsets.mean(axis=0)
    markers = dq.transform_points(poses[..., None, :], centered)
    return pose_from_points(centered, markers + rng.normal(scale=SIGMA, size=markers.shape))


# Of a right arm, as a file of landmarks has them.
LANDMARKS = """
side = "right"
[landmarks]
EL = { body = "lab", mm = [352, 1105, -190] }
EM = { body = "lab", mm = [268, 1110, -140] }
GH = { body = "lab", mm = [300, 1380, -190] }
US = { body = "forearm", mm = [-20, -150, -10] }
RS = { body = "forearm", mm = [25, -148, 8] }
"""
