"""Matrices of dual numbers, as pairs of real arrays (..., m, n): product, inverse, pseudoinverse and QR."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry._small_angle import divide, length

Float = NDArray[np.float64]


class DualMatrix(NamedTuple):
    """A matrix of dual numbers ``real + eps dual``; both parts have the same shape (..., m, n)."""

    real: Float
    dual: Float


def multiply(left: DualMatrix, right: DualMatrix) -> DualMatrix:
    """Matrix product: ``(A + eps B)(C + eps D) = A C + eps (A D + B C)``."""
    return DualMatrix(left.real @ right.real, left.real @ right.dual + left.dual @ right.real)


def transpose(matrix: DualMatrix) -> DualMatrix:
    """Transpose both parts."""
    return DualMatrix(np.swapaxes(matrix.real, -1, -2), np.swapaxes(matrix.dual, -1, -2))


def inverse(matrix: DualMatrix) -> DualMatrix:
    """Inverse of square matrices: ``A^-1 - eps A^-1 B A^-1``.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a real part is singular: such a dual matrix has no inverse, whatever its dual part.
    """
    real: Float = np.asarray(np.linalg.inv(matrix.real), dtype=np.float64)
    return DualMatrix(real, -real @ matrix.dual @ real)


def pseudoinverse(matrix: DualMatrix) -> DualMatrix:
    """Pseudoinverse of matrices whose real part has full rank.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., m, n)

    Returns
    -------
    DualMatrix, shape (..., n, m)
        ``A^T (A A^T)^-1``, a right inverse, of wide matrices; ``(A^T A)^-1 A^T``, a left inverse, of tall ones.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a real part is rank-deficient: a dual pseudoinverse does not exist then in general.

    References
    ----------
    P 27; Pennestrì and Stefanelli 2007.
    """
    rows, columns = matrix.real.shape[-2:]
    if matrix.real.size and (np.linalg.matrix_rank(matrix.real) < min(rows, columns)).any():
        msg = f"a dual pseudoinverse needs a real part of full rank ({min(rows, columns)})"
        raise np.linalg.LinAlgError(msg)
    turned = transpose(matrix)
    if rows <= columns:
        return multiply(turned, inverse(multiply(matrix, turned)))
    return multiply(inverse(multiply(turned, matrix)), turned)


def qr(matrix: DualMatrix) -> tuple[DualMatrix, DualMatrix]:
    """QR decomposition of square matrices by Gram and Schmidt over the dual numbers.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., n, n)
        Real part of full rank.

    Returns
    -------
    Q, R : DualMatrix, shape (..., n, n)
        ``Q^T Q = I``, and R upper triangular with a positive real diagonal; NaN where the rank is less than n.

    References
    ----------
    P 28; Pennestrì and Stefanelli 2007.
    """
    size = matrix.real.shape[-1]
    Q = DualMatrix(np.array(matrix.real, dtype=np.float64), np.array(matrix.dual, dtype=np.float64))
    R = DualMatrix(np.zeros(matrix.real.shape), np.zeros(matrix.real.shape))
    for j in range(size):
        for k in range(j):
            real = np.sum(Q.real[..., k] * Q.real[..., j], axis=-1)
            dual = np.sum(Q.real[..., k] * Q.dual[..., j] + Q.dual[..., k] * Q.real[..., j], axis=-1)
            R.real[..., k, j], R.dual[..., k, j] = real, dual
            Q.dual[..., j] -= real[..., None] * Q.dual[..., k] + dual[..., None] * Q.real[..., k]
            Q.real[..., j] -= real[..., None] * Q.real[..., k]
        norm = length(Q.real[..., j])
        slope = divide(np.sum(Q.real[..., j] * Q.dual[..., j], axis=-1), norm)
        R.real[..., j, j], R.dual[..., j, j] = norm, slope
        Q.real[..., j] = divide(Q.real[..., j], norm[..., None])
        Q.dual[..., j] = divide(Q.dual[..., j] - slope[..., None] * Q.real[..., j], norm[..., None])
    return Q, R
