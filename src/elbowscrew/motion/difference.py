"""How far two poses of a body are apart."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.dual_quaternion import conjugate, multiply, pose_from_dual_quat
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.model import BodyPoints

Float = NDArray[np.float64]

DEFAULT_RADIUS: Final = 0.05
"""Radius of gyration (m) of the points of a body whose markers are not known."""


def angle_between(pose_a: Float, pose_b: Float) -> Float:
    """Angle of the rotation from one orientation to the other, radians in [0, pi], shape (...)."""
    step = multiply(conjugate(pose_a), pose_b)
    return 2.0 * np.arctan2(length(step[..., 1:4]), np.abs(step[..., 0]))


def origin_distance(pose_a: Float, pose_b: Float) -> Float:
    """Distance between the body's origins in the two poses, shape (...)."""
    return length(pose_from_dual_quat(pose_a)[1] - pose_from_dual_quat(pose_b)[1])


def rms_displacement(pose_a: Float, pose_b: Float, points: BodyPoints) -> Float:
    """RMS distance of the body's points between two poses: ``E^2 = |dR c + dd|^2 + tr(dR S dR^T)``.

    Parameters
    ----------
    pose_a, pose_b : ndarray, shape (..., 8)
        Unit dual quaternions.
    points : BodyPoints
        Centroid c and covariance S of the points, in the body's frame.

    Returns
    -------
    ndarray, shape (...)
        Exactly the RMS over the points. It is a metric, and does not change with the laboratory frame.
    """
    (quat_a, d_a), (quat_b, d_b) = pose_from_dual_quat(pose_a), pose_from_dual_quat(pose_b)
    dR = rotation_matrix_from_quat(quat_a) - rotation_matrix_from_quat(quat_b)
    centroid_shift = dR @ points.centroid + (d_a - d_b)
    about_centroid = np.sum((dR @ points.covariance) * dR, axis=(-1, -2))
    square: Float = np.sum(centroid_shift**2, axis=-1) + about_centroid
    return np.sqrt(np.maximum(square, 0.0))


def points_from_markers(offsets: Float) -> BodyPoints:
    """Centroid and covariance of a body's own markers, shape (M, 3), in its frame."""
    centroid = offsets.mean(axis=0)
    centered = offsets - centroid
    return BodyPoints(centroid=centroid, covariance=centered.T @ centered / len(offsets), origin="markers")


def points_from_radius(radius: float) -> BodyPoints:
    """Points spread alike in all directions about the body's origin, with that radius of gyration."""
    return BodyPoints(centroid=np.zeros(3), covariance=np.eye(3) * radius**2 / 3.0, origin="radius")
