"""Pose of a body from the positions of its markers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix


def pose_from_points(body_points: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    """Least-squares pose of rigid point sets, by singular value decomposition with the reflection guard.

    Parameters
    ----------
    body_points : array_like, shape (M, 3)
        The markers in the body's own frame; at least three, not on one line.
    points : array_like, shape (..., M, 3)
        The same markers as seen, all of them.

    Returns
    -------
    ndarray, shape (..., 8)
        Unit dual quaternions that map body coordinates to the seen ones with the least sum of squared distances.

    References
    ----------
    Arun, Huang and Blostein 1987; Söderkvist and Wedin 1993.
    """
    body = np.asarray(body_points, dtype=np.float64)
    seen = np.asarray(points, dtype=np.float64)
    body_mean, seen_mean = body.mean(axis=-2), seen.mean(axis=-2)
    covariance = np.swapaxes(seen - seen_mean[..., None, :], -1, -2) @ (body - body_mean)
    U, _, Vt = np.linalg.svd(covariance)
    guard = np.ones(U.shape[:-1])
    guard[..., 2] = np.sign(np.linalg.det(U @ Vt))
    rotation = (U * guard[..., None, :]) @ Vt
    position = seen_mean - (rotation @ body_mean[:, None])[..., 0]
    return dual_quat_from_pose(quat_from_rotation_matrix(rotation), position)
