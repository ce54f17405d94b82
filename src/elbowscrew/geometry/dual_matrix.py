"""Matrices of dual numbers, as pairs of real arrays (..., m, n): product, inverse, pseudoinverse, QR and polar form."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry._small_angle import VANISHING_NORM, divide, length
from elbowscrew.geometry.arrays import Float


class DualMatrix(NamedTuple):
    """A matrix of dual numbers ``real + eps dual``.

    Attributes
    ----------
    real, dual : ndarray, shape (..., m, n)
        The two parts, of one shape.
    """

    real: Float
    dual: Float


def multiply(left: DualMatrix, right: DualMatrix) -> DualMatrix:
    """Matrix product: ``(A + eps B)(C + eps D) = A C + eps (A D + B C)``.

    Parameters
    ----------
    left : DualMatrix, shape (..., m, k)
        First factor.
    right : DualMatrix, shape (..., k, n)
        Second factor.

    Returns
    -------
    DualMatrix, shape (..., m, n)

    References
    ----------
    K 20, element by element; Pennestrì and Stefanelli 2007.

    Examples
    --------
    >>> A = DualMatrix(np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]]))
    >>> multiply(A, transpose(A)).dual
    array([[0., 0.],
           [0., 0.]])
    """
    return DualMatrix(left.real @ right.real, left.real @ right.dual + left.dual @ right.real)


def transpose(matrix: DualMatrix) -> DualMatrix:
    """Transpose of both parts.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., m, n)
        Any dual matrices.

    Returns
    -------
    DualMatrix, shape (..., n, m)

    References
    ----------
    Pennestrì and Stefanelli 2007.

    Examples
    --------
    >>> transpose(DualMatrix(np.array([[1.0, 2.0]]), np.array([[3.0, 4.0]]))).dual
    array([[3.],
           [4.]])
    """
    return DualMatrix(np.swapaxes(matrix.real, -1, -2), np.swapaxes(matrix.dual, -1, -2))


def inverse(matrix: DualMatrix) -> DualMatrix:
    """Inverse of square matrices: ``A^-1 - eps A^-1 B A^-1``.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., n, n)
        With regular real parts.

    Returns
    -------
    DualMatrix, shape (..., n, n)

    Raises
    ------
    numpy.linalg.LinAlgError
        If a real part is singular: such a dual matrix has no inverse, whatever its dual part.

    References
    ----------
    Pennestrì and Stefanelli 2007.

    Examples
    --------
    >>> inverse(DualMatrix(2.0 * np.eye(2), np.ones((2, 2)))).dual
    array([[-0.25, -0.25],
           [-0.25, -0.25]])
    """
    real: Float = np.asarray(np.linalg.inv(matrix.real), dtype=np.float64)
    return DualMatrix(real, -real @ matrix.dual @ real)


def pseudoinverse(matrix: DualMatrix) -> DualMatrix:
    """Pseudoinverse (Moore and Penrose) of matrices whose real part has full rank.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., m, n)
        With real parts of rank min(m, n).

    Returns
    -------
    DualMatrix, shape (..., n, m)
        A right inverse, ``A^T (A A^T)^-1``, of wide matrices; a left inverse, ``(A^T A)^-1 A^T``, of tall ones. It is
        found from the real pseudoinverse and its derivative, so that no condition number is squared.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a real part is rank-deficient: a dual pseudoinverse does not exist then in general.

    References
    ----------
    P 27; Pennestrì and Stefanelli 2007; the derivative: Golub and Pereyra 1973.

    Examples
    --------
    >>> A = DualMatrix(np.array([[2.0, 0.0, 0.0], [0.0, 4.0, 0.0]]), np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]))
    >>> multiply(A, pseudoinverse(A)).dual
    array([[0., 0.],
           [0., 0.]])
    """
    A, B = matrix
    rows, columns = A.shape[-2:]
    if A.size and (np.linalg.matrix_rank(A) < min(rows, columns)).any():
        msg = f"a dual pseudoinverse needs a real part of full rank ({min(rows, columns)})"
        raise np.linalg.LinAlgError(msg)
    P: Float = np.asarray(np.linalg.pinv(A) if A.size else np.swapaxes(A, -1, -2), dtype=np.float64)
    Pt, Bt = np.swapaxes(P, -1, -2), np.swapaxes(B, -1, -2)
    if rows <= columns:
        return DualMatrix(P, (np.eye(columns) - P @ A) @ Bt @ Pt @ P - P @ B @ P)
    return DualMatrix(P, P @ Pt @ Bt @ (np.eye(rows) - A @ P) - P @ B @ P)


def qr(matrix: DualMatrix) -> tuple[DualMatrix, DualMatrix]:
    """QR decomposition by Gram and Schmidt over the dual numbers, of matrices of any shape and rank.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., m, n)
        Any dual matrices; k = min(m, n).

    Returns
    -------
    Q : DualMatrix, shape (..., m, k)
        With ``Q^T Q = I``.
    R : DualMatrix, shape (..., k, n)
        Upper triangular, with ``Q R`` the matrix. Its real diagonal is positive where the column's real part does not
        depend on the columns before it (to 1e-12 of its size); where it does, the real part is 0 and the column of Q
        goes along what the *dual* part has left, or along any free direction if nothing is left.

    References
    ----------
    P 28; Pennestrì and Stefanelli 2007.

    Examples
    --------
    >>> Q, R = qr(DualMatrix(np.diag([2.0, 3.0]), np.array([[0.0, 0.0], [4.0, 0.0]])))
    >>> Q.dual
    array([[ 0., -2.],
           [ 2.,  0.]])
    """
    A = DualMatrix(np.array(matrix.real, dtype=np.float64), np.array(matrix.dual, dtype=np.float64))
    rows, columns = A.real.shape[-2:]
    rank, batch = min(rows, columns), A.real.shape[:-2]
    Q = DualMatrix(np.zeros((*batch, rows, rank)), np.zeros((*batch, rows, rank)))
    R = DualMatrix(np.zeros((*batch, rank, columns)), np.zeros((*batch, rank, columns)))
    for j in range(columns):
        real, dual = A.real[..., j], A.dual[..., j]
        before = DualMatrix(Q.real[..., : min(j, rank)], Q.dual[..., : min(j, rank)])
        for _ in range(2):  # once more: what round-off leaves of the first pass would not be orthogonal
            part = multiply(transpose(before), DualMatrix(real[..., None], dual[..., None]))
            taken = multiply(before, part)
            R.real[..., : min(j, rank), j] += part.real[..., 0]
            R.dual[..., : min(j, rank), j] += part.dual[..., 0]
            real, dual = real - taken.real[..., 0], dual - taken.dual[..., 0]
        if j < rank:
            _next_column(Q, R, j, DualMatrix(real, dual), DualMatrix(A.real[..., j], A.dual[..., j]))
    return Q, R


def _next_column(Q: DualMatrix, R: DualMatrix, j: int, left: DualMatrix, column: DualMatrix) -> None:
    """Write column j of Q and the diagonal of R from what is left of column j of the matrix."""
    norm, size = length(left.real), length(column.real)
    regular = norm > VANISHING_NORM * size
    along = divide(left.real, norm[..., None])
    slope = np.sum(along * left.dual, axis=-1)
    turning = divide(left.dual - slope[..., None] * along, norm[..., None])
    # A dependent column goes along its dual part, or where it likes; either way normal to the columns before.
    before, rates = Q.real[..., :j], Q.dual[..., :j]
    rest = _without(before, left.dual)
    dual_norm = length(rest)
    scale = length(column.dual) + size * np.max(np.abs(rates), axis=(-1, -2), initial=0.0)
    free = dual_norm > VANISHING_NORM * scale
    instead = _without(before, np.where(free[..., None], divide(rest, dual_norm[..., None]), _uncovered_axis(before)))
    instead = divide(instead, length(instead)[..., None])
    correction = -(before @ (np.swapaxes(rates, -1, -2) @ instead[..., None]))[..., 0]
    Q.real[..., j] = np.where(regular[..., None], along, instead)
    Q.dual[..., j] = np.where(regular[..., None], turning, correction)
    R.real[..., j, j] = np.where(regular, norm, 0.0)
    R.dual[..., j, j] = np.where(regular, slope, np.where(free, dual_norm, 0.0))


def _without(columns: Float, vector: Float) -> Float:
    """Vectors (..., m) without their parts along orthonormal columns (..., m, j)."""
    for _ in range(2):
        vector = vector - (columns @ (np.swapaxes(columns, -1, -2) @ vector[..., None]))[..., 0]
    return vector


def _uncovered_axis(columns: Float) -> Float:
    """The unit axis (..., m) that orthonormal columns (..., m, j) cover least."""
    covered = np.sum(columns**2, axis=-1)
    return np.eye(columns.shape[-2])[np.argmin(covered, axis=-1)] if covered.size else np.zeros(covered.shape)


def polar(matrix: DualMatrix) -> tuple[DualMatrix, DualMatrix]:
    """Polar form ``A = Q S``: the orthogonal dual matrix nearest to A, and a symmetric one.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., m, n)
        With m >= n and real parts of rank n.

    Returns
    -------
    Q : DualMatrix, shape (..., m, n)
        With ``Q^T Q = I``. Unlike the factor of `qr` it favors no column. Its real part is a reflection where the
        determinant of a square real part is negative.
    S : DualMatrix, shape (..., n, n)
        Symmetric, real part positive definite: how far A is from orthogonal.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a matrix is wide, or a real part is rank-deficient: the dual part of Q is not determined then.

    References
    ----------
    Higham 1986 for real matrices; the dual part solves ``W S + S W = M - M^T``, its derivative.

    Examples
    --------
    >>> Q, S = polar(DualMatrix(np.diag([2.0, 3.0]), np.array([[0.0, -1.0], [4.0, 0.0]])))
    >>> Q.dual, S.dual
    (array([[ 0., -1.],
           [ 1.,  0.]]), array([[0., 2.],
           [2., 0.]]))
    """
    A, B = matrix
    rows, columns = A.shape[-2:]
    if rows < columns or (A.size and (np.linalg.matrix_rank(A) < columns).any()):
        msg = f"a dual polar form needs a real part of full column rank ({columns})"
        raise np.linalg.LinAlgError(msg)
    U, sizes, Vt = np.linalg.svd(A, full_matrices=False)
    V = np.swapaxes(Vt, -1, -2)
    Q, S = U @ Vt, (V * sizes[..., None, :]) @ Vt
    M = np.swapaxes(Q, -1, -2) @ B
    skew = Vt @ (M - np.swapaxes(M, -1, -2)) @ V
    W = V @ (skew / (sizes[..., :, None] + sizes[..., None, :])) @ Vt
    outside = ((B - Q @ M) @ V / sizes[..., None, :]) @ Vt
    symmetric = M - W @ S
    return DualMatrix(Q, Q @ W + outside), DualMatrix(S, 0.5 * (symmetric + np.swapaxes(symmetric, -1, -2)))
