"""Dual quaternions that need not be unit: exponential, logarithm, power, and multiplication as matrices.

A dual quaternion is a dual scalar and a dual vector (P 38); its functions are those of quaternions with dual numbers
in place of real ones (P 44, 46, 48).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry import dual_number, dual_quaternion
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_number import DualNumber


def scale(dual_quat: ArrayLike, factor: DualNumber) -> Float:
    """Multiply dual quaternions by dual numbers.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.
    factor : DualNumber, shape (...)
        Factors; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 40, of a dual quaternion without vector part.

    Examples
    --------
    >>> scale([1, 0, 0, 2, 0, 0, 0, 0], dual_number.dual_number(2.0, 3.0))
    array([2., 0., 0., 4., 3., 0., 0., 6.])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    real, dual = factor.real[..., None], factor.dual[..., None]
    return np.concatenate([real * Q[..., :4], real * Q[..., 4:] + dual * Q[..., :4]], axis=-1)


def exp(dual_quat: ArrayLike) -> Float:
    """Exponential ``exp(d)(cos|v| + v/|v| sin|v|)`` of any dual quaternion ``d + v``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions; ``|v|`` in radians.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 37, 38, 44.

    Examples
    --------
    >>> exp([0, 0, 0, np.pi / 2, 1, 0, 0, 0]).round(12) + 0.0
    array([0., 0., 0., 1., 0., 0., 0., 1.])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    rotation = dual_quaternion.exp(Q[..., [1, 2, 3, 5, 6, 7]])
    return scale(rotation, dual_number.exp(dual_number.dual_number(Q[..., 0], Q[..., 4])))


def log(dual_quat: ArrayLike) -> Float:
    """Logarithm ``ln|Q| + v/|v| atan2(|v|, d)`` of any dual quaternion ``d + v`` with q != 0.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)
        The angle is taken in [0, pi]; at a real part that is a negative number the axis is not defined: NaN.

    References
    ----------
    P 46, by atan2 in place of the arccosine.

    Examples
    --------
    >>> log([0, 0, 0, 1, 0, 0, 0, 1]).round(6) + 0.0
    array([0.      , 0.      , 0.      , 1.570796, 1.      , 0.      ,
           0.      , 0.      ])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    size = dual_number.log(dual_quaternion.norm(Q))
    axis = dual_quaternion.log(dual_quaternion.normalize(Q))
    result = np.empty(Q.shape)
    result[..., [1, 2, 3, 5, 6, 7]] = axis
    result[..., 0], result[..., 4] = size.real, size.dual
    return result


def power(dual_quat: ArrayLike, exponent: ArrayLike) -> Float:
    """Power ``exp(t ln Q)`` of any dual quaternion with q != 0.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Any dual quaternions.
    exponent : array_like, shape (...)
        Real exponent t; shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where `log` is.

    References
    ----------
    P 48.

    Examples
    --------
    >>> power([2, 0, 0, 0, 0, 0, 0, 1], 2).round(12) + 0.0
    array([4., 0., 0., 0., 0., 0., 0., 4.])
    """
    return exp(np.asarray(exponent, dtype=np.float64)[..., None] * log(dual_quat))


def left_matrix(dual_quat: ArrayLike) -> Float:
    """Matrices of the product as seen from its left factor: ``left_matrix(A) @ B = A B``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Left factors A.

    Returns
    -------
    ndarray, shape (..., 8, 8)

    References
    ----------
    W, which puts the scalars last.

    Examples
    --------
    >>> left_matrix([0, 1, 0, 0, 0, 0, 0, 0]) @ [0, 0, 1, 0, 0, 0, 0, 1] + 0.0
    array([ 0.,  0.,  0.,  1.,  0.,  0., -1.,  0.])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    return np.swapaxes(dual_quaternion.multiply(Q[..., None, :], np.eye(8)), -1, -2)


def right_matrix(dual_quat: ArrayLike) -> Float:
    """Matrices of the product as seen from its right factor: ``right_matrix(B) @ A = A B``.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Right factors B.

    Returns
    -------
    ndarray, shape (..., 8, 8)

    References
    ----------
    W, which puts the scalars last.

    Examples
    --------
    >>> right_matrix([0, 1, 0, 0, 0, 0, 0, 0]) @ [0, 0, 1, 0, 0, 0, 0, 1] + 0.0
    array([ 0.,  0.,  0., -1.,  0.,  0.,  1.,  0.])
    """
    Q = np.asarray(dual_quat, dtype=np.float64)
    return np.swapaxes(dual_quaternion.multiply(np.eye(8), Q[..., None, :]), -1, -2)
