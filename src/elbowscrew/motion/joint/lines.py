"""Frames whose z axis is a joint's line, and screw motions along it."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix, rotation_matrix_from_quat

_LEAST_EIGENVALUE: Final = 1e-6

Z_LINE: Final = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
"""The z axis as a line, and as the twist of a rotation about it."""

LINE_STEPS: Final = (0, 1, 3, 4)
"""Components of a twist that move the z axis: tilts about x and y, shifts along x and y."""


def line_pose(direction: Float, point: Float) -> Float:
    """A pose (8,) with its z axis along a direction (3,) and its origin at a point (3,)."""
    h = direction / length(direction)
    x = np.eye(3)[int(np.argmin(np.abs(h)))]
    x = x - (x @ h) * h
    x = x / length(x)
    return dq.dual_quat_from_pose(quat_from_rotation_matrix(np.stack([x, np.cross(h, x), h], axis=1)), point)


def about_z(angle: Float, slide: Float | float = 0.0) -> Float:
    """Screw motions (..., 8) about the z axis: angle (rad) and slide (m)."""
    half, s = 0.5 * np.asarray(angle, dtype=np.float64), 0.5 * np.asarray(slide, dtype=np.float64)
    cosine, sine, zero = np.cos(half), np.sin(half), np.zeros(half.shape)
    return np.stack([cosine, zero, zero, sine, -s * sine, zero, zero, s * cosine], axis=-1)


def angle_about_z(dual_quat: Float) -> Float:
    """Rotation about z (F,) nearest to poses (F, 8), rad: continuous from row to row."""
    half: Float = np.unwrap(np.arctan2(dual_quat[:, 3], dual_quat[:, 0]), period=np.pi)
    return 2.0 * half


def line_twist(step: Float) -> Float:
    """Half a twist (..., 6) that tilts and shifts the z axis by a step (..., 4), for `exp`."""
    twist = np.zeros((*step.shape[:-1], 6))
    twist[..., list(LINE_STEPS)] = 0.5 * step
    return twist


def nearest_points(joint: Float, *, undetermined: int) -> tuple[Float, Float]:
    """Points (3,) of the distal and of the proximal body that stay nearest each other: ``R c_F - c_A = -d``.

    Parameters
    ----------
    joint : ndarray, shape (F, 8)
    undetermined : int
        How many directions the motion leaves open: 1 of an axis, along which any point does, 0 of a ball. They are
        taken out, not left to the noise.

    References
    ----------
    SCoRE of a ball: Ehrig, Taylor, Duda and Heller 2006, Journal of Biomechanics 39.
    """
    quat, position = dq.pose_from_dual_quat(joint)
    R = rotation_matrix_from_quat(quat)
    mean_R, mean_d = R.mean(axis=0), position.mean(axis=0)
    square = np.block([[np.eye(3), -mean_R.T], [-mean_R, np.eye(3)]])
    right = np.concatenate([-np.einsum("fji,fj->i", R, position) / len(joint), mean_d])
    solution = least_solution(square, right, undetermined)
    return solution[:3], solution[3:]


def least_solution(square: Float, right: Float, undetermined: int) -> Float:
    """Solution of symmetric equations with the least norm, without so many directions of least eigenvalue."""
    values, vectors = np.linalg.eigh(square)
    kept = values > _LEAST_EIGENVALUE * values[-1]
    kept[:undetermined] = False
    found: Float = vectors[:, kept] @ ((vectors[:, kept].T @ right) / values[kept])
    return found


def mean_rotation_pair(joint: Float) -> tuple[Float, Float]:
    """Directions (3,) in the proximal and the distal body that stay most nearly one: of a hinge, its axis."""
    R = rotation_matrix_from_quat(dq.pose_from_dual_quat(joint)[0]).mean(axis=0)
    left, _, right = np.linalg.svd(R)
    return left[:, 0], right[0]
