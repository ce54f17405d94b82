"""Quaternions and Euler parameters, shape (..., 4), scalar first: ``e0, e1, e2, e3``."""

from __future__ import annotations

from itertools import permutations
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import _rows
from elbowscrew.geometry._blocks import in_blocks
from elbowscrew.geometry._small_angle import cosine_and_sine, divide_rows, length, ratio_of_equals, row_length

EULER_ORDERS: Final = tuple("".join(order) for order in permutations("XYZ"))
"""Those of three different axes."""

_CONJUGATE: Final = np.array([1.0, -1.0, -1.0, -1.0])


def multiply(left: ArrayLike, right: ArrayLike) -> NDArray[np.float64]:
    """Hamilton product; as rotations, ``right`` is applied first.

    Parameters
    ----------
    left, right : array_like, shape (..., 4)
        Quaternions, scalar first; leading shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 4)

    References
    ----------
    P 1, K 9.

    Examples
    --------
    >>> multiply([0, 1, 0, 0], [0, 0, 1, 0])
    array([0., 0., 0., 1.])
    """
    return in_blocks(_rows.product, left, right, width=4)


def conjugate(quat: ArrayLike) -> NDArray[np.float64]:
    """Conjugate: the vector part changes its sign. For a unit quaternion it is the inverse.

    Parameters
    ----------
    quat : array_like, shape (..., 4)
        Quaternions, scalar first.

    Returns
    -------
    ndarray, shape (..., 4)

    References
    ----------
    K 6.

    Examples
    --------
    >>> conjugate([1, 2, 3, 4])
    array([ 1., -2., -3., -4.])
    """
    conjugated: NDArray[np.float64] = np.multiply(np.asarray(quat, dtype=np.float64), _CONJUGATE)
    return conjugated


def norm(quat: ArrayLike) -> NDArray[np.float64]:
    """Euclidean norm.

    Parameters
    ----------
    quat : array_like, shape (..., 4)
        Quaternions, scalar first.

    Returns
    -------
    ndarray, shape (...)

    References
    ----------
    K 45.

    Examples
    --------
    >>> norm([[3, 0, 0, 4], [0, 0, 0, 0]])
    array([5., 0.])
    """
    return length(np.asarray(quat, dtype=np.float64))


def normalize(quat: ArrayLike) -> NDArray[np.float64]:
    """Unit quaternion of the same direction.

    Parameters
    ----------
    quat : array_like, shape (..., 4)
        Quaternions, scalar first.

    Returns
    -------
    ndarray, shape (..., 4)
        NaN for the zero quaternion.

    References
    ----------
    K 45.

    Examples
    --------
    >>> normalize([3, 0, 0, 4])
    array([0.6, 0. , 0. , 0.8])
    """
    return in_blocks(lambda q: divide_rows(q, row_length(q)), quat, width=4)


def rotate(quat: ArrayLike, vector: ArrayLike) -> NDArray[np.float64]:
    """Rotate vectors by unit quaternions: ``q v q*``.

    Parameters
    ----------
    quat : array_like, shape (..., 4)
        Unit quaternions.
    vector : array_like, shape (..., 3)
        Vectors in any unit; leading shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 3)

    References
    ----------
    K 5.

    Examples
    --------
    >>> rotate([0.5**0.5, 0, 0, 0.5**0.5], [1, 0, 0]).round(12) + 0.0
    array([0., 1., 0.])
    """
    return in_blocks(_rows.rotated, quat, vector, width=3)


def rotation_matrix_from_quat(quat: ArrayLike) -> NDArray[np.float64]:
    """Rotation matrices of unit quaternions.

    Parameters
    ----------
    quat : array_like, shape (..., 4)
        Unit quaternions, scalar first.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    References
    ----------
    P 17, rotation block. (Kenwright's equation 7 has misprinted signs.)

    Examples
    --------
    >>> rotation_matrix_from_quat([0.5, 0.5, 0.5, 0.5])
    array([[0., 0., 1.],
           [1., 0., 0.],
           [0., 1., 0.]])
    """
    return in_blocks(_rows.rotation_matrix, quat, width=9).reshape(*np.shape(quat)[:-1], 3, 3)


def quat_from_rotation_matrix(matrix: ArrayLike) -> NDArray[np.float64]:
    """Unit quaternions of rotation matrices.

    The largest of the four components is taken from the diagonal and the others follow from it, so no digit is lost
    at any angle, pi included.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Rotation matrices.

    Returns
    -------
    ndarray, shape (..., 4)
        The scalar part is not negative.

    References
    ----------
    Shepperd 1978.

    Examples
    --------
    >>> quat_from_rotation_matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    array([0.5, 0.5, 0.5, 0.5])
    """
    m = np.asarray(matrix, dtype=np.float64)
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    wx, wy, wz = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    xy, xz, yz = m[..., 0, 1] + m[..., 1, 0], m[..., 0, 2] + m[..., 2, 0], m[..., 1, 2] + m[..., 2, 1]
    # Row k is 4 q_k q: whichever row has the largest q_k^2 on its diagonal is normalized.
    rows = np.stack(
        [
            np.stack([1.0 + xx + yy + zz, wx, wy, wz], axis=-1),
            np.stack([wx, 1.0 + xx - yy - zz, xy, xz], axis=-1),
            np.stack([wy, xy, 1.0 - xx + yy - zz, yz], axis=-1),
            np.stack([wz, xz, yz, 1.0 - xx - yy + zz], axis=-1),
        ],
        axis=-2,
    )
    largest = np.argmax(np.nan_to_num(np.diagonal(rows, axis1=-2, axis2=-1), nan=-np.inf), axis=-1)
    quat = normalize(np.take_along_axis(rows, largest[..., None, None], axis=-2)[..., 0, :])
    return np.where(quat[..., :1] < 0.0, -quat, quat)


def quat_from_rotation_vector(vector: ArrayLike) -> NDArray[np.float64]:
    """Unit quaternions of rotation vectors: angle times unit axis.

    Parameters
    ----------
    vector : array_like, shape (..., 3)
        Rotation vectors, radians.

    Returns
    -------
    ndarray, shape (..., 4)

    References
    ----------
    P 2, K 3.

    Examples
    --------
    >>> quat_from_rotation_vector([0.0, 0.0, np.pi]).round(12)
    array([0., 0., 0., 1.])
    """
    return in_blocks(_from_rotation_vector, vector, width=4)


def _from_rotation_vector(vector: _rows.Rows) -> list[NDArray[np.float64]]:
    half = [0.5 * row for row in vector]
    half_angle = row_length(half)
    cosine, sine = cosine_and_sine(half_angle)
    ratio = ratio_of_equals(sine, half_angle)
    return [cosine, *(ratio * row for row in half)]


def quat_from_euler_angles(angles: ArrayLike, order: str) -> NDArray[np.float64]:
    """Unit quaternions of intrinsic Euler angles.

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        Radians, in the order of the name: for "YXZ" the first is about Y.
    order : str
        Of three different axes, or the last as the first (proper Euler angles), in capitals: "XYZ" means R = Rx Ry Rz.

    Returns
    -------
    ndarray, shape (..., 4)

    Raises
    ------
    ValueError
        If the order is none of these twelve.

    References
    ----------
    K 3 and 9: the product of the three rotations.

    Examples
    --------
    >>> quat_from_euler_angles([np.pi / 2, np.pi / 2, 0], "XYZ").round(6)
    array([0.5, 0.5, 0.5, 0.5])
    """
    if len(order) != 3 or not set(order) <= set("XYZ") or order[1] in (order[0], order[2]):
        msg = f"Euler order {order!r} is not XYZ or another one in which no axis follows itself"
        raise ValueError(msg)
    a = np.asarray(angles, dtype=np.float64)
    axes = np.eye(3)
    first, second, third = (
        quat_from_rotation_vector(a[..., k : k + 1] * axes["XYZ".index(letter)]) for k, letter in enumerate(order)
    )
    return multiply(multiply(first, second), third)
