"""How far two poses of a body are apart."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import _rows
from elbowscrew.geometry._blocks import in_blocks
from elbowscrew.geometry._small_angle import row_length
from elbowscrew.model import BodyPoints

Float = NDArray[np.float64]

DEFAULT_RADIUS: Final = 0.05
"""Radius of gyration (m) of the points of a body whose markers are not known."""


def angle_between(pose_a: Float, pose_b: Float) -> Float:
    """Angle of the rotation from one orientation to the other, radians in [0, pi], shape (...)."""
    return in_blocks(_angle_between, pose_a, pose_b, width=1)[..., 0]


def _angle_between(a: _rows.Rows, b: _rows.Rows) -> list[Float]:
    step = _rows.product(_rows.conjugate(a[:4]), b[:4])
    return [2.0 * np.arctan2(row_length(step[1:]), np.abs(step[0]))]


def origin_distance(pose_a: Float, pose_b: Float) -> Float:
    """Distance between the body's origins in the two poses, shape (...)."""
    return in_blocks(lambda a, b: [row_length(_shift(a, b))], pose_a, pose_b, width=1)[..., 0]


def _shift(a: _rows.Rows, b: _rows.Rows) -> list[Float]:
    return [one - other for one, other in zip(_rows.position(a), _rows.position(b), strict=True)]


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
    c, S = points.centroid.tolist(), points.covariance.tolist()

    def kernel(a: _rows.Rows, b: _rows.Rows) -> list[Float]:
        rotations = zip(_rows.rotation_matrix(a[:4]), _rows.rotation_matrix(b[:4]), strict=True)
        dR = [one - other for one, other in rotations]
        square = 0.0
        for k, shift in enumerate(_shift(a, b)):
            x, y, z = dR[3 * k : 3 * k + 3]
            square = square + (x * c[0] + y * c[1] + z * c[2] + shift) ** 2
            square += x * (S[0][0] * x + 2.0 * S[0][1] * y + 2.0 * S[0][2] * z)
            square += y * (S[1][1] * y + 2.0 * S[1][2] * z) + S[2][2] * z * z
        return [np.sqrt(np.maximum(square, 0.0))]

    return in_blocks(kernel, pose_a, pose_b, width=1)[..., 0]


def points_from_markers(offsets: Float) -> BodyPoints:
    """Centroid and covariance of a body's own markers, shape (M, 3), in its frame."""
    centroid = offsets.mean(axis=0)
    centered = offsets - centroid
    return BodyPoints(centroid=centroid, covariance=centered.T @ centered / len(offsets), origin="markers")


def points_from_radius(radius: float) -> BodyPoints:
    """Points spread alike in all directions about the body's origin, with that radius of gyration."""
    return BodyPoints(centroid=np.zeros(3), covariance=np.eye(3) * radius**2 / 3.0, origin="radius")
