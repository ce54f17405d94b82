"""Unit dual quaternions as poses and displacements, shape (..., 8): real part (4), then dual part (4).

A pose is ``Q = q + eps 1/2 d q`` and maps body coordinates to the frame's, ``x = R(q) X + d``. `Q` and `-Q` are the
same pose. Lines are Plücker vectors, shape (..., 6): unit direction ``h``, then moment ``m = p x h``.
The conventions are stated in ``docs/reference/conventions.md``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import _rows, quaternion
from elbowscrew.geometry._blocks import in_blocks, is_single
from elbowscrew.geometry._small_angle import divide_rows, row_length
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
    if is_single(a):
        return _linear(_rows.left_maps(a.ravel()), a, b)
    if is_single(b):
        return _linear(_rows.right_maps(b.ravel()), b, a)
    return in_blocks(_rows.dual_product, a, b, width=8)


def _linear(
    maps: tuple[NDArray[np.float64], NDArray[np.float64]], factor: NDArray[np.float64], other: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Multiply by one dual quaternion, whose maps these are."""
    shape = np.broadcast_shapes(factor.shape, other.shape)
    return in_blocks(lambda Q: _rows.mapped(maps, Q), other, width=8, contiguous=False).reshape(shape)


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
    parts = in_blocks(_norm, dual_quat, width=2)
    return DualNumber(parts[..., 0], parts[..., 1])


def _norm(Q: _rows.Rows) -> list[NDArray[np.float64]]:
    real = row_length(Q[:4])
    return [real, *divide_rows([_rows.dot(Q[:4], Q[4:])], real)]


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
    return in_blocks(_rows.normalized, dual_quat, width=8)


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
    return in_blocks(_inverse, dual_quat, width=8)


def _inverse(Q: _rows.Rows) -> list[NDArray[np.float64]]:
    size, dual_size = _norm(Q)
    inverted = divide_rows(divide_rows(_rows.conjugate(Q), size), size)
    slope = 2.0 * divide_rows([dual_size], size)[0]
    return [*inverted[:4], *(dual - slope * real for real, dual in zip(inverted[:4], inverted[4:], strict=True))]


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
    return in_blocks(_from_pose, quat, position, width=8)


def _from_pose(quat: _rows.Rows, position: _rows.Rows) -> list[NDArray[np.float64]]:
    w, x, y, z = quat
    a, b, c = (0.5 * row for row in position)
    return [*quat, 0.0 - (a * x + b * y + c * z), a * w + b * z - c * y, b * w + c * x - a * z, c * w + a * y - b * x]


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
    return Q[..., :4].copy("K"), in_blocks(_rows.position, Q, width=3)


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
    return in_blocks(_rows.exponential, half_twist, width=8)


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
    return in_blocks(lambda Q: _rows.logarithm(Q)[0], dual_quat, width=6)


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
    t = np.asarray(exponent, dtype=np.float64)[..., None]
    return in_blocks(lambda Q, t: _rows.power(Q, t[0]), dual_quat, t, width=8)


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
    return in_blocks(lambda Q: np.where(Q[0] < 0.0, -1.0, 1.0) * Q, dual_quat, width=8)


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
    return in_blocks(lambda Q, R: _rows.sign_towards(Q, R) * Q, dual_quat, reference, width=8)


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
    last = np.empty((8, 0))  # the last row of the blocks before that is no gap, with its new sign

    def kernel(block: NDArray[np.float64]) -> NDArray[np.float64]:
        nonlocal last
        known = np.isfinite(block).all(axis=0)
        whole = bool(known.all())
        Q = np.concatenate([last, block if whole else block[:, known]], axis=1)
        if Q.shape[1] == 0:
            return block
        Q[:, 1:] *= np.cumprod(_rows.sign_towards(Q[:, 1:], Q[:, :-1]))
        found = Q[:, last.shape[1] :]
        last = Q[:, -1:]
        if whole:
            return found
        signed = block.copy()
        signed[:, known] = found
        return signed

    return in_blocks(kernel, series, width=8)


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
    return in_blocks(_moved_points, dual_quat, points, width=3)


def _moved_points(Q: _rows.Rows, points: _rows.Rows) -> list[NDArray[np.float64]]:
    return [x + d for x, d in zip(_rows.rotated(Q[:4], points), _rows.position(Q), strict=True)]


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
    return in_blocks(_moved_lines, dual_quat, lines, width=6)


def _moved_lines(Q: _rows.Rows, lines: _rows.Rows) -> list[NDArray[np.float64]]:
    direction, moment = _rows.rotated(Q[:4], lines[:3]), _rows.rotated(Q[:4], lines[3:])
    return [*direction, *(m + u for m, u in zip(moment, _rows.cross(_rows.position(Q), direction), strict=True))]
