"""Pose of a body from the positions of its markers: by least squares, or the paper's way."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry import dual_matrix
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_matrix import DualMatrix
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose, transform_points
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix
from elbowscrew.geometry.screw import dual_quat_from_dual_matrix

# Markers this much closer to a line (or to a plane) than long give no pose: their spread across it is noise.
_FLATNESS: Final = 0.02
_FEWEST_DUAL_QR: Final = 4


class FittedPose(NamedTuple):
    """Poses fitted to markers.

    Attributes
    ----------
    dual_quat : ndarray, shape (..., 8)
        NaN where the markers seen do not fix a pose.
    deviation : ndarray, shape (...)
        How far the markers are from rigid: `fit_poses` gives the RMS distance, in the unit of length,
        `fit_poses_dual_qr` the distance of the triangular factor from the identity, a pure number.
    """

    dual_quat: Float
    deviation: Float


def pose_from_points(body_points: ArrayLike, points: ArrayLike) -> Float:
    """Least-squares poses of the same markers in the body and as seen; see `fit_poses`.

    Parameters
    ----------
    body_points : array_like, shape (M, 3)
        The markers in the body's own frame.
    points : array_like, shape (..., M, 3)
        The same markers as seen; NaN for those not seen.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the markers seen do not fix a pose.

    References
    ----------
    Arun, Huang and Blostein 1987; Söderkvist and Wedin 1993.

    Examples
    --------
    The numerical example of P section 4.

    >>> before, after = [[1, 0, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]], [[2, 3, 1], [0, 3, 1], [0, 3, 2], [0, 2, 2]]
    >>> (2 * pose_from_points(before, after)).round(4) + 0.0
    array([ 1.4142,  0.    ,  0.    ,  1.4142, -0.7071,  2.8284,  0.    ,
            0.7071])
    """
    return fit_poses(body_points, points).dual_quat


def fit_poses(body_points: ArrayLike, points: ArrayLike) -> FittedPose:
    """Least-squares poses of rigid point sets, by singular value decomposition with the reflection guard.

    Parameters
    ----------
    body_points : array_like, shape (M, 3)
        The markers in the body's own frame.
    points : array_like, shape (..., M, 3)
        The same markers as seen; NaN for those not seen. At least three, not on one line, must be seen.

    Returns
    -------
    FittedPose
        NaN where the markers seen do not fix a pose.

    References
    ----------
    Arun, Huang and Blostein 1987; Söderkvist and Wedin 1993.

    Examples
    --------
    A cross of markers, each seen farther out by 0.1.

    >>> body = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    >>> round(float(fit_poses(body, 1.1 * body + [0, 0, 5]).deviation), 6)
    0.1
    """
    seen = np.asarray(points, dtype=np.float64)
    body, target, weight, centers = _centered(body_points, seen)
    U, _, Vt = np.linalg.svd(np.swapaxes(target, -1, -2) @ body)
    guard = np.ones(U.shape[:-1])
    guard[..., 2] = np.sign(np.linalg.det(U @ Vt))
    rotation = (U * guard[..., None, :]) @ Vt
    spread = _spread(body)
    fixed = (weight.sum(axis=-1) >= 3) & (spread[..., 1] > _FLATNESS * spread[..., 0])
    position = centers[1] - (rotation @ centers[0][..., None])[..., 0]
    pose = dual_quat_from_pose(quat_from_rotation_matrix(rotation), position)
    pose = np.where(fixed[..., None], pose, np.nan)
    square = np.sum((seen - transform_points(pose[..., None, :], body_points)) ** 2, axis=-1)
    counted = np.isfinite(square)
    mean = np.where(counted, square, 0.0).sum(axis=-1) / np.maximum(counted.sum(axis=-1), 1)
    return FittedPose(pose, np.where(fixed, np.sqrt(mean), np.nan))


def fit_poses_dual_qr(body_points: ArrayLike, points: ArrayLike) -> FittedPose:
    """Poses by the dual pseudoinverse and dual QR decomposition of line vectors through the centroid.

    It favors the body's first axis, and needs at least four markers that are not in one plane.

    Parameters
    ----------
    body_points : array_like, shape (M, 3)
        The markers in the body's own frame.
    points : array_like, shape (..., M, 3)
        The same markers as seen; NaN for those not seen.

    Returns
    -------
    FittedPose
        As of `fit_poses`, but for the deviation: Frobenius norm of ``R - I``, a pure number.

    References
    ----------
    P 22-29.

    Examples
    --------
    The numerical example of P section 4.

    >>> before, after = [[1, 0, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]], [[2, 3, 1], [0, 3, 1], [0, 3, 2], [0, 2, 2]]
    >>> (2 * fit_poses_dual_qr(before, after).dual_quat).round(4) + 0.0
    array([ 1.4142,  0.    ,  0.    ,  1.4142, -0.7071,  2.8284,  0.    ,
            0.7071])
    """
    seen = np.asarray(points, dtype=np.float64)
    if seen.shape[-2] < _FEWEST_DUAL_QR:
        return FittedPose(np.full((*seen.shape[:-2], 8), np.nan), np.full(seen.shape[:-2], np.nan))
    body, target, weight, (body_center, center) = _centered(body_points, seen)
    spread = _spread(body)
    fixed = (weight.sum(axis=-1) >= _FEWEST_DUAL_QR) & (spread[..., 2] > _FLATNESS * spread[..., 0])
    # Where the markers do not fix a pose, any regular set stands in, and the result is taken out again.
    stand_in = np.zeros_like(body)
    stand_in[..., :3, :] = np.eye(3)
    body = np.where(fixed[..., None, None], body, stand_in)
    before = _line_vectors(body, body_center)
    after = _line_vectors(target, center)
    Q, R = dual_matrix.qr(dual_matrix.multiply(after, dual_matrix.pseudoinverse(before)))
    deviation = np.sqrt(np.sum((R.real - np.eye(3)) ** 2, axis=(-1, -2)))
    rotation = np.where(fixed[..., None, None], Q.real, np.eye(3))
    pose = dual_quat_from_dual_matrix(DualMatrix(rotation, np.where(fixed[..., None, None], Q.dual, 0.0)))
    mirrored = np.linalg.det(np.where(np.isfinite(rotation), rotation, np.eye(3))) < 0.0
    # Seen as if flattened: the triangular factor is far from the identity, and the pose from being one.
    fixed &= ~mirrored & (np.min(np.diagonal(R.real, axis1=-2, axis2=-1), axis=-1) > _FLATNESS)
    return FittedPose(np.where(fixed[..., None], pose, np.nan), np.where(fixed, deviation, np.nan))


def nonrigid_coordinates(seen: Float, shape: Float) -> Float:
    """What no motion of the whole cluster explains, in coordinates that are all of the markers' own noise.

    Parameters
    ----------
    seen : ndarray, shape (F, M, 3)
        The markers in the body's frame, as its measured pose gives them.
    shape : ndarray, shape (M, 3)
        The markers of the rigid body in the same frame, not on one line.

    Returns
    -------
    ndarray, shape (F, 3 M - 6)
        NaN in frames where a marker is not seen.

    References
    ----------
    ``Q^T vec(seen - shape)``, Q the orthonormal columns across all ``[-[x_k]x, 1]``, the markers' motions by a twist.

    Examples
    --------
    >>> shape = np.array([[0.05, 0.0, 0.0], [-0.05, 0.03, 0.0], [0.0, -0.03, 0.04]])
    >>> shifted, stretched = shape + [0.001, 0.0, 0.0], 1.02 * shape
    >>> np.linalg.norm(nonrigid_coordinates(np.stack([shifted, stretched]), shape), axis=1).round(5).tolist()
    [0.0, 0.00177]
    """
    across = np.linalg.qr(_rigid_motions(shape), mode="complete")[0][:, 6:]
    return np.asarray((seen - shape).reshape(len(seen), -1) @ across, dtype=np.float64)


def _centered(body_points: ArrayLike, seen: Float) -> tuple[Float, Float, Float, tuple[Float, Float]]:
    """Markers about their centroids, those not seen at zero: body, seen, weights (..., M) and the two centroids."""
    weight: Float = np.min(np.isfinite(seen).astype(np.float64), axis=-1)
    body = np.broadcast_to(np.asarray(body_points, dtype=np.float64), seen.shape)
    target = np.where(weight[..., None] > 0.0, seen, 0.0)
    count = np.maximum(weight.sum(axis=-1), 1.0)[..., None]
    centers = (np.sum(weight[..., None] * body, axis=-2) / count, np.sum(target, axis=-2) / count)
    return (
        weight[..., None] * (body - centers[0][..., None, :]),
        weight[..., None] * (target - centers[1][..., None, :]),
        weight,
        centers,
    )


def _rigid_motions(shape: Float) -> Float:
    """Motions (3 M, 6) of a cluster's markers by a small twist: ``[-[x_k]x, 1]``."""
    turned = np.swapaxes(np.cross(np.eye(3)[None], shape[:, None, :]), 1, 2)  # column a: e_a cross x_k
    shifted = np.broadcast_to(np.eye(3), turned.shape)
    return np.concatenate([turned, shifted], axis=2).reshape(-1, 6)


def _spread(centered: Float) -> Float:
    """Singular values of points (..., M, 3), shape (..., 3); 0 for those that too few points do not have."""
    sizes = np.linalg.svd(centered, compute_uv=False)
    spread = np.zeros((*centered.shape[:-2], 3))
    spread[..., : sizes.shape[-1]] = sizes
    return spread


def _line_vectors(centered: Float, center: Float) -> DualMatrix:
    """Line vectors from the centroid to the markers, as columns (P 23, 26)."""
    moments = np.cross(center[..., None, :], centered)
    return dual_matrix.transpose(DualMatrix(centered, moments))
