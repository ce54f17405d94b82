"""Unit dual quaternions as poses and displacements, shape (..., 8): real part (4), then dual part (4).

A pose is ``Q = q + eps 1/2 d q`` and maps body coordinates to the frame's, ``x = R(q) X + d``. `Q` and `-Q` are the
same pose. Lines are Plücker vectors, shape (..., 6): unit direction ``h``, then moment ``m = p x h``.
The conventions are stated in ``docs/conventions.md``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import quaternion
from elbowscrew.geometry._small_angle import divide, length, sinc, sinc_slope
from elbowscrew.geometry.dual_number import DualNumber

_QUATERNION_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0])
_DUAL_CONJUGATE = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0])


def multiply(left: ArrayLike, right: ArrayLike) -> NDArray[np.float64]:
    """Product of dual quaternions; as motions, ``right`` is applied first.

    Parameters
    ----------
    left, right : array_like, shape (..., 8)
        Leading shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 40.

    Examples
    --------
    >>> shift = dual_quat_from_pose([1, 0, 0, 0], [0, 0, 2])
    >>> pose_from_dual_quat(multiply(shift, shift))[1]
    array([0., 0., 4.])
    """
    a = np.asarray(left, dtype=np.float64)
    b = np.asarray(right, dtype=np.float64)
    product = np.empty((*np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), 8))
    product[..., :4] = quaternion.multiply(a[..., :4], b[..., :4])
    product[..., 4:] = quaternion.multiply(a[..., :4], b[..., 4:]) + quaternion.multiply(a[..., 4:], b[..., :4])
    return product


def conjugate(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Quaternion conjugate ``q* + eps q0*``; for a unit dual quaternion it is the inverse.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 41, K 32; W.

    Examples
    --------
    >>> conjugate([1, 2, 3, 4, 5, 6, 7, 8])
    array([ 1., -2., -3., -4.,  5., -6., -7., -8.])
    """
    conjugated: NDArray[np.float64] = np.multiply(np.asarray(dual_quat, dtype=np.float64), _QUATERNION_CONJUGATE)
    return conjugated


def dual_conjugate(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Conjugate of the dual unit ``q - eps q0``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    Kavan, Collins, Žára and O'Sullivan 2008.

    Examples
    --------
    >>> dual_conjugate([1, 2, 3, 4, 5, 6, 7, 8])
    array([ 1.,  2.,  3.,  4., -5., -6., -7., -8.])
    """
    conjugated: NDArray[np.float64] = np.multiply(np.asarray(dual_quat, dtype=np.float64), _DUAL_CONJUGATE)
    return conjugated


def full_conjugate(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Both conjugates, ``q* - eps q0*``: the one that moves points, ``Q (1 + eps p) Q^``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    Kavan, Collins, Žára and O'Sullivan 2008.

    Examples
    --------
    >>> shift, point = [1, 0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 5, 0, 0]
    >>> multiply(multiply(shift, point), full_conjugate(shift))
    array([1., 0., 0., 0., 0., 5., 0., 2.])
    """
    conjugated: NDArray[np.float64] = np.multiply(
        np.asarray(dual_quat, dtype=np.float64), _QUATERNION_CONJUGATE * _DUAL_CONJUGATE
    )
    return conjugated


def norm(dual_quat: ArrayLike) -> DualNumber:
    """Norm, a dual number: ``|q| + eps <q, q0>/|q|``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    DualNumber, shape (...)
        The dual part is NaN where q = 0.

    References
    ----------
    P 42, with the real part's norm where the dual part's is printed.

    Examples
    --------
    >>> norm([[3, 4, 0, 0, 5, 0, 0, 0]])
    DualNumber(real=array([5.]), dual=array([3.]))
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    real = length(Q[..., :4])
    return DualNumber(real, divide(np.sum(Q[..., :4] * Q[..., 4:], axis=-1), real))


def normalize(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Unit dual quaternion: divided by the dual norm, so that also ``<q, q0> = 0``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where q = 0.

    References
    ----------
    P 12-13; not K's listing, which divides by the squared norm of q.

    Examples
    --------
    >>> normalize([2, 0, 0, 0, 6, 0, 0, 8])
    array([1., 0., 0., 0., 0., 0., 0., 4.])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    real_norm = length(Q[..., :4])[..., None]
    real = divide(Q[..., :4], real_norm)
    dual = divide(Q[..., 4:], real_norm)
    return np.concatenate([real, dual - np.sum(real * dual, axis=-1, keepdims=True) * real], axis=-1)


def inverse(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Inverse ``Q* / |Q|^2`` of any dual quaternion with q != 0.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where q = 0.

    References
    ----------
    P 43; W.

    Examples
    --------
    >>> inverse([2, 0, 0, 0, 0, 0, 0, 4]) + 0.0
    array([ 0.5,  0. ,  0. ,  0. ,  0. ,  0. ,  0. , -1. ])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    real, dual = (part[..., None] for part in norm(Q))
    Qc = conjugate(Q)
    inv_real = divide(divide(Qc[..., :4], real), real)
    inv_dual = divide(divide(Qc[..., 4:], real), real) - 2.0 * inv_real * divide(dual, real)
    return np.concatenate([inv_real, inv_dual], axis=-1)


def dual_quat_from_pose(quat: ArrayLike, position: ArrayLike) -> NDArray[np.float64]:
    """Pose as a unit dual quaternion: ``q + eps 1/2 d q``.

    Parameters
    ----------
    quat : array_like, shape (..., 4)
        Unit quaternions of the orientation, body to frame.
    position : array_like, shape (..., 3)
        Position of the body's origin in the frame.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 9-11, of norm 1 where 2 is printed; K 25; W.

    Examples
    --------
    The numerical example of P section 2, with the norm that is printed there:

    >>> (2 * dual_quat_from_pose([0.5**0.5, 0, 0, 0.5**0.5], [2, 2, 1])).round(4) + 0.0
    array([ 1.4142,  0.    ,  0.    ,  1.4142, -0.7071,  2.8284,  0.    ,
            0.7071])
    """
    q = np.asarray(quat, dtype=np.float64)
    d = np.asarray(position, dtype=np.float64)
    shape = np.broadcast_shapes(q.shape[:-1], d.shape[:-1])
    half = np.zeros((*d.shape[:-1], 4))
    half[..., 1:] = 0.5 * d
    dual_quat = np.empty((*shape, 8))
    dual_quat[..., :4] = q
    dual_quat[..., 4:] = quaternion.multiply(half, q)
    return dual_quat


def pose_from_dual_quat(dual_quat: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Orientation and position of unit dual quaternions: ``d = 2 q0 q*``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    quat : ndarray, shape (..., 4)
        Unit quaternions, body to frame.
    position : ndarray, shape (..., 3)
        Position of the body's origin, in the unit of length of the pose.

    References
    ----------
    P 16, K 29.

    Examples
    --------
    >>> pose_from_dual_quat([0, 0, 0, 1, 0, 1, -1, 0])
    (array([0., 0., 0., 1.]), array([2., 2., 0.]))
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    return Q[..., :4].copy(), 2.0 * quaternion.multiply(Q[..., 4:], quaternion.conjugate(Q[..., :4]))[..., 1:]


def matrix_from_dual_quat(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Homogeneous matrices of unit dual quaternions.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        ``[[R, d], [0, 1]]``.

    References
    ----------
    P 17; W.

    Examples
    --------
    >>> matrix_from_dual_quat(dual_quat_from_pose([0, 0, 0, 1], [1, 2, 3]))
    array([[-1.,  0.,  0.,  1.],
           [ 0., -1.,  0.,  2.],
           [ 0.,  0.,  1.,  3.],
           [ 0.,  0.,  0.,  1.]])
    """
    quat, position = pose_from_dual_quat(dual_quat)
    matrix = np.zeros((*quat.shape[:-1], 4, 4))
    matrix[..., :3, :3] = quaternion.rotation_matrix_from_quat(quat)
    matrix[..., :3, 3] = position
    matrix[..., 3, 3] = 1.0
    return matrix


def dual_quat_from_matrix(matrix: ArrayLike) -> NDArray[np.float64]:
    """Unit dual quaternions of homogeneous matrices.

    Parameters
    ----------
    matrix : array_like, shape (..., 4, 4)
        ``[[R, d], [0, 1]]`` with a rotation matrix R; the last row is not looked at.

    Returns
    -------
    ndarray, shape (..., 8)
        The scalar part is not negative.

    References
    ----------
    P 17; Shepperd 1978 for the quaternion.

    Examples
    --------
    >>> dual_quat_from_matrix([[-1, 0, 0, 2], [0, -1, 0, 2], [0, 0, 1, 0], [0, 0, 0, 1]]) + 0.0
    array([ 0.,  0.,  0.,  1.,  0.,  1., -1.,  0.])
    """
    m = np.asarray(matrix, dtype=np.float64)
    return dual_quat_from_pose(quaternion.quat_from_rotation_matrix(m[..., :3, :3]), m[..., :3, 3])


def exp(half_twist: ArrayLike) -> NDArray[np.float64]:
    """Exponential of pure dual quaternions: the screw motion of a dual rotation vector.

    Parameters
    ----------
    half_twist : array_like, shape (..., 6)
        ``theta/2 h + eps (s/2 h + theta/2 m)``: half the rotation vector (rad), then half its dual part (length).

    Returns
    -------
    ndarray, shape (..., 8)
        Unit dual quaternions, exact to 1e-14 down to the smallest angles; towards a full turn the dual part loses
        1/sin(theta/2), as the sine there loses the angle's digits.

    References
    ----------
    P 45.

    Examples
    --------
    Half a turn about z and a slide by 2 along it.

    >>> exp([0, 0, np.pi / 2, 0, 0, 1]).round(12) + 0.0
    array([ 0.,  0.,  0.,  1., -1.,  0.,  0.,  0.])
    """
    u = np.asarray(half_twist, dtype=np.float64)
    a, b = u[..., :3], u[..., 3:]
    half_angle = length(a)[..., None]
    ratio = sinc(half_angle)
    projection = np.sum(a * b, axis=-1, keepdims=True)
    return np.concatenate(
        [np.cos(half_angle), ratio * a, -ratio * projection, ratio * b + sinc_slope(half_angle) * projection * a],
        axis=-1,
    )


def log(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """Logarithm of unit dual quaternions: the inverse of `exp`, half the dual rotation vector.

    The angle is ``theta/2 = atan2(|v|, w)`` in [0, pi]: the sign of ``Q`` is taken as it stands, so that `-Q` is the
    motion the other way round. For the shorter one use ``canonical(Q)``. At ``w = -1`` the axis of the full turn is
    not defined and the result is NaN; towards it the dual part loses 1/sin(theta/2), as the axis does.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ndarray, shape (..., 6)
        ``theta/2 h + eps (s/2 h + theta/2 m)``: half the rotation vector (rad), then half its dual part (length).

    References
    ----------
    P 47, by atan2 in place of the arccosine.

    Examples
    --------
    >>> log([0, 0, 0, 1, -1, 0, 0, 0]).round(6) + 0.0
    array([0.      , 0.      , 1.570796, 0.      , 0.      , 1.      ])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    w, v, w0, v0 = Q[..., :1], Q[..., 1:4], Q[..., 4:5], Q[..., 5:]
    sine = length(v)[..., None]
    half_angle = np.arctan2(sine, w)
    undefined = (sine == 0.0) & (w < 0.0)
    ratio = np.where(sine == 0.0, 1.0, half_angle / np.where(sine == 0.0, 1.0, sine))
    ratio = np.where(undefined, np.nan, ratio)
    # d(half_angle/sine) = w0 sinc_slope(half_angle) ratio^3 for a unit Q, where <v, v0> = -w w0.
    return np.concatenate([ratio * v, ratio * v0 + w0 * sinc_slope(half_angle) * ratio**3 * v], axis=-1)


def power(dual_quat: ArrayLike, exponent: ArrayLike) -> NDArray[np.float64]:
    """``Q^t = exp(t log Q)`` of unit dual quaternions: the same screw by t times its dual angle.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.
    exponent : array_like, shape (...)
        t; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN at ``w = -1``; the dual part loses 1/sin(theta/2) towards a full turn, as that of `log`.

    References
    ----------
    P 31 and 48.

    Examples
    --------
    >>> power([0, 0, 0, 1, -1, 0, 0, 0], [1, 2]).round(12) + 0.0
    array([[ 0.,  0.,  0.,  1., -1.,  0.,  0.,  0.],
           [-1.,  0.,  0.,  0.,  0.,  0.,  0., -2.]])
    """
    return exp(np.asarray(exponent, dtype=np.float64)[..., None] * log(dual_quat))


def canonical(dual_quat: ArrayLike) -> NDArray[np.float64]:
    """The one of ``Q`` and ``-Q`` whose scalar part is not negative: the rotation of at most pi.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    K, section on the shortest path.

    Examples
    --------
    >>> canonical([[-0.6, 0, 0, 0.8, 1, 1, 1, 1]]) + 0.0
    array([[ 0.6,  0. ,  0. , -0.8, -1. , -1. , -1. , -1. ]])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    return np.where(Q[..., :1] < 0.0, -Q, Q)


def align_signs(dual_quat: ArrayLike, reference: ArrayLike) -> NDArray[np.float64]:
    """Flip the sign of ``Q`` where its real part has a negative dot product with the reference's.

    Parameters
    ----------
    dual_quat, reference : array_like, shape (..., 8)
        Dual quaternions to flip and those they are compared with; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    K, section on the shortest path.

    Examples
    --------
    >>> align_signs([-0.6, 0, 0, 0.8, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0, 0, 0]) + 0.0
    array([ 0.6,  0. ,  0. , -0.8,  0. ,  0. ,  0. ,  0. ])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    R = np.asarray(reference, dtype=np.float64)
    return np.where(np.sum(Q[..., :4] * R[..., :4], axis=-1, keepdims=True) < 0.0, -Q, Q)


def continuous_signs(series: ArrayLike) -> NDArray[np.float64]:
    """Make a series of poses continuous over the double cover.

    Parameters
    ----------
    series : array_like, shape (N, 8)
        Poses in order; rows with NaN are gaps and are passed over.

    Returns
    -------
    ndarray, shape (N, 8)
        Each row flipped, if need be, to a non-negative dot product of its real part with the last row that is no gap.
        The first one keeps its sign.

    References
    ----------
    K, section on the shortest path, from frame to frame.

    Examples
    --------
    >>> series = np.outer([1.0, -1.0, np.nan, -1.0], [0.6, 0, 0, 0.8, 0, 0, 0, 0])
    >>> continuous_signs(series)[:, 3]
    array([0.8, 0.8, nan, 0.8])
    """
    Q = np.array(series, dtype=np.float64)
    known = np.flatnonzero(np.isfinite(Q).all(axis=-1))
    if known.size > 1:
        dots = np.sum(Q[known[1:], :4] * Q[known[:-1], :4], axis=-1)
        Q[known[1:]] *= np.cumprod(np.where(dots < 0.0, -1.0, 1.0))[:, None]
    return Q


def transform_points(dual_quat: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    """Move points: ``R p + d``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.
    points : array_like, shape (..., 3)
        Points in the body's frame, in the unit of length of the pose; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 3)

    References
    ----------
    P 18; in dual quaternions ``Q (1 + eps p) (q* - eps q0*)``, where K 35 and W print an inverse that loses d.

    Examples
    --------
    The numerical example of P section 4.

    >>> pose = dual_quat_from_pose([0.5**0.5, 0, 0, 0.5**0.5], [2, 2, 1])
    >>> transform_points(pose, [[1, 0, 0], [1, 2, 0]]).round(6) + 0.0
    array([[2., 3., 1.],
           [0., 3., 1.]])
    """
    quat, position = pose_from_dual_quat(dual_quat)
    return quaternion.rotate(quat, points) + position


def transform_lines(dual_quat: ArrayLike, lines: ArrayLike) -> NDArray[np.float64]:
    """Move lines: ``Q l Q*``, that is ``h' = R h`` and ``m' = R m + d x h'``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.
    lines : array_like, shape (..., 6)
        Direction, then moment about the origin.

    Returns
    -------
    ndarray, shape (..., 6)

    References
    ----------
    P 20-21; W.

    Examples
    --------
    >>> transform_lines(dual_quat_from_pose([1, 0, 0, 0], [2, 0, 0]), [0, 0, 1, 0, 0, 0])
    array([ 0.,  0.,  1.,  0., -2.,  0.])
    """
    quat, position = pose_from_dual_quat(dual_quat)
    line = np.asarray(lines, dtype=np.float64)
    direction = quaternion.rotate(quat, line[..., :3])
    moment = quaternion.rotate(quat, line[..., 3:]) + np.cross(position, direction)
    return np.concatenate([direction, moment], axis=-1)
