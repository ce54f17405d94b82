"""Dual vectors, shape (..., 6): real part (3), then dual part (3). Unit ones are lines, ``h + eps p x h``."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_number import DualNumber, dual_number


def dot(left: ArrayLike, right: ArrayLike) -> DualNumber:
    """Dot product, a dual number: of two lines, the cosine of their dual angle.

    Parameters
    ----------
    left, right : array_like, shape (..., 6)
        Dual vectors, real part first; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    P 40.

    Examples
    --------
    The x axis and a line along y at the height 3.

    >>> dot([1, 0, 0, 0, 0, 0], [0, 1, 0, -3, 0, 0])
    DualNumber(real=array(0.), dual=array(-3.))
    """
    a, b = np.asarray(left, dtype=np.float64), np.asarray(right, dtype=np.float64)
    real = np.sum(a[..., :3] * b[..., :3], axis=-1)
    return dual_number(real, np.sum(a[..., :3] * b[..., 3:] + a[..., 3:] * b[..., :3], axis=-1))


def cross(left: ArrayLike, right: ArrayLike) -> Float:
    """Cross product: of two lines, their common normal times the sine of their dual angle.

    Parameters
    ----------
    left, right : array_like, shape (..., 6)
        Dual vectors, real part first; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 6)

    References
    ----------
    P 40.

    Examples
    --------
    >>> cross([1, 0, 0, 0, 0, 0], [0, 1, 0, -3, 0, 0]) + 0.0
    array([0., 0., 1., 0., 0., 0.])
    """
    a, b = np.asarray(left, dtype=np.float64), np.asarray(right, dtype=np.float64)
    real = np.cross(a[..., :3], b[..., :3])
    return np.concatenate([real, np.cross(a[..., :3], b[..., 3:]) + np.cross(a[..., 3:], b[..., :3])], axis=-1)


def norm(vector: ArrayLike) -> DualNumber:
    """Norm, a dual number ``|a| + eps <a, b>/|a|``; its dual part is the pitch times ``|a|``.

    Parameters
    ----------
    vector : array_like, shape (..., 6)
        Dual vectors, real part first.

    Returns
    -------
    DualNumber, shape (...)
        The dual part is NaN where a = 0.

    References
    ----------
    P 42, of a dual quaternion without scalar part.

    Examples
    --------
    >>> norm([3, 4, 0, 5, 0, 0])
    DualNumber(real=array(5.), dual=array(3.))
    """
    v = np.asarray(vector, dtype=np.float64)
    real = length(v[..., :3])
    return dual_number(real, divide(np.sum(v[..., :3] * v[..., 3:], axis=-1), real))


def normalize(vector: ArrayLike) -> Float:
    """Line of a dual vector: divided by its dual norm.

    Parameters
    ----------
    vector : array_like, shape (..., 6)
        Dual vectors, real part first.

    Returns
    -------
    ndarray, shape (..., 6)
        Unit direction h, then moment m, with ``<h, m> = 0``; NaN where the real part is 0.

    References
    ----------
    P 14.

    Examples
    --------
    >>> normalize([0, 0, 2, 4, 0, 6])
    array([0., 0., 1., 2., 0., 0.])
    """
    v = np.asarray(vector, dtype=np.float64)
    size = length(v[..., :3])[..., None]
    direction = divide(v[..., :3], size)
    moment = divide(v[..., 3:], size)
    return np.concatenate([direction, moment - np.sum(direction * moment, axis=-1, keepdims=True) * direction], axis=-1)


def angle_between_lines(first: ArrayLike, second: ArrayLike) -> DualNumber:
    """Dual angle between two lines: the angle in [0, pi] and the distance along their common normal.

    Parameters
    ----------
    first, second : array_like, shape (..., 6)
        Unit lines; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)
        Angle (rad) and distance. The distance has the sign that makes ``cos(angle)`` the dot product: positive if the
        second line lies from the first in the sense of ``cross(first, second)``. For parallel lines that sense is
        not defined and the distance is not negative.

    References
    ----------
    W.

    Examples
    --------
    The x axis and a line along y at the height 3.

    >>> angle = angle_between_lines([1, 0, 0, 0, 0, 0], [0, 1, 0, -3, 0, 0])
    >>> round(float(np.degrees(angle.real)), 6), round(float(angle.dual), 6)
    (90.0, 3.0)
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    cosine, normal = dot(a, b), cross(a, b)
    sine = length(normal[..., :3])
    parallel = sine == 0.0
    skew = divide(-cosine.dual, sine)
    return dual_number(np.arctan2(sine, cosine.real), np.where(parallel, length(normal[..., 3:]), skew))


def common_normal(first: ArrayLike, second: ArrayLike) -> Float:
    """Line that meets two lines at right angles, directed as the cross product.

    Parameters
    ----------
    first, second : array_like, shape (..., 6)
        Unit lines; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 6)
        For parallel lines its position is not defined: the moment is NaN; nor is the direction where they are one line.

    References
    ----------
    W.

    Examples
    --------
    The x axis and a line along y that passes (2, 0, 3): their normal is upright at x = 2.

    >>> common_normal([1, 0, 0, 0, 0, 0], [0, 1, 0, -3, 0, 2]) + 0.0
    array([ 0.,  0.,  1.,  0., -2.,  0.])
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    product = cross(a, b)
    line = normalize(product)
    across = product[..., 3:]
    fallback = np.concatenate([divide(across, length(across)[..., None]), np.full_like(across, np.nan)], axis=-1)
    parallel = (product[..., :3] == 0.0).all(axis=-1)
    return np.where(parallel[..., None], fallback, line)
