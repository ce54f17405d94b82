"""How far two poses of a body are apart."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry import _rows, dual_quaternion, quaternion
from elbowscrew.geometry._blocks import in_blocks
from elbowscrew.geometry._small_angle import row_length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.model import BodyPoints

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


def turn_and_distance(pose_a: Float, pose_b: Float) -> tuple[Float, Float]:
    """Give `angle_between` and `origin_distance` in one pass over the poses."""
    found = in_blocks(lambda a, b: [*_angle_between(a, b), row_length(_shift(a, b))], pose_a, pose_b, width=2)
    return found[..., 0], found[..., 1]


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
    # Its coordinates' distance, without the coordinates.
    c, L = points.centroid.tolist(), spokes(points).T.tolist()

    def kernel(a: _rows.Rows, b: _rows.Rows) -> list[Float]:
        rotations = zip(_rows.rotation_matrix(a[:4]), _rows.rotation_matrix(b[:4]), strict=True)
        dR = [one - other for one, other in rotations]
        square = 0.0
        for k, shift in enumerate(_shift(a, b)):
            x, y, z = dR[3 * k : 3 * k + 3]
            square = square + (x * c[0] + y * c[1] + z * c[2] + shift) ** 2
            for spoke in L:
                square += (x * spoke[0] + y * spoke[1] + z * spoke[2]) ** 2
        return [np.sqrt(square)]

    return in_blocks(kernel, pose_a, pose_b, width=1)[..., 0]


def point_coordinates(pose: Float, points: BodyPoints) -> Float:
    """Twelve coordinates of a pose between which the Euclidean distance is the RMS displacement of the points.

    ``[R L, R c + d]`` with ``S = L L^T``: positions of the centroid and of three spokes that spread as the points do.

    Parameters
    ----------
    pose : ndarray, shape (..., 8)
        Unit dual quaternions.
    points : BodyPoints

    Returns
    -------
    ndarray, shape (..., 12)
        Meters: three for each spoke, as seen from the centroid, and the centroid.
    """
    quat, position = pose_from_dual_quat(pose)
    # One 3x4 product for spokes and centroid.
    frame = np.concatenate([spokes(points), points.centroid[:, None]], axis=1)
    placed = rotation_matrix_from_quat(quat) @ frame
    placed[..., 3] += position
    coordinates: Float = np.swapaxes(placed, -1, -2).reshape(*placed.shape[:-2], 12)
    return coordinates


def spokes(points: BodyPoints) -> Float:
    """Three vectors whose outer products add up to the points' covariance, as columns, shape (3, 3), meters."""
    spread, directions = np.linalg.eigh(points.covariance)
    return np.asarray(directions * np.sqrt(np.maximum(spread, 0.0)))


def points_from_markers(offsets: Float) -> BodyPoints:
    """Centroid and covariance of a body's own markers, shape (M, 3), in its frame."""
    centroid = offsets.mean(axis=0)
    centered = offsets - centroid
    return BodyPoints(centroid=centroid, covariance=centered.T @ centered / len(offsets), origin="markers")


def points_from_radius(radius: float) -> BodyPoints:
    """Points spread alike in all directions about the body's origin, with that radius of gyration."""
    return BodyPoints(centroid=np.zeros(3), covariance=np.eye(3) * radius**2 / 3.0, origin="radius")


def summed_rotation(quat: Float) -> Float:
    """Rotation vectors from pose to pose, summed, shape (N, 3); its derivative is the angular velocity.

    Parameters
    ----------
    quat : ndarray, shape (N, 4)
        NaN where there is no pose: after a gap the sum begins anew.
    """
    step = quaternion.multiply(quat[1:], quaternion.conjugate(quat[:-1]))
    padded = np.zeros((len(step), 8))
    padded[:, :4] = step
    turn = 2.0 * dual_quaternion.log(dual_quaternion.canonical(padded))[:, :3]
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(np.nan_to_num(turn), axis=0)])
    return np.where(np.isfinite(quat[:, :1]), total, np.nan)


def points_of_orientation() -> BodyPoints:
    """What stands for a body's points where only its orientation is known: unit vectors of all directions.

    Their RMS displacement is the chord of the angle between two orientations, ``2 sin(delta/2)``: what is least or
    within a limit by the one is so by the other.
    """
    return BodyPoints(centroid=np.zeros(3), covariance=0.5 * np.eye(3), origin="orientation")


def told_error(displacement: Float, points: BodyPoints) -> Float:
    """What is told of RMS displacements: themselves (m), or of orientations the angles (rad) whose chords they are."""
    return displacement if points.located else 2.0 * np.arcsin(np.minimum(0.5 * displacement, 1.0))


def displacement_of_error(error: float, points: BodyPoints) -> float:
    """RMS displacement of an error as `told_error` tells it."""
    return error if points.located else 2.0 * float(np.sin(0.5 * min(error, np.pi)))
