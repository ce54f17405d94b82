"""Screw parameters of a displacement: dual angle and line."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import _rows, dual_number, dual_quaternion, dual_vector, quaternion
from elbowscrew.geometry._blocks import in_blocks
from elbowscrew.geometry._small_angle import cosine_and_sine, divide, divide_rows, length, row_length
from elbowscrew.geometry.dual_matrix import DualMatrix
from elbowscrew.geometry.dual_number import DualNumber


class Screw(NamedTuple):
    """A screw displacement: turn by ``angle`` about a line and slide along it.

    Attributes
    ----------
    angle : ndarray, shape (...)
        Rotation theta, radians.
    slide : ndarray, shape (...)
        Translation s along the axis, in the unit of length of the pose.
    direction : ndarray, shape (..., 3)
        Unit vector h of the axis.
    moment : ndarray, shape (..., 3)
        Moment ``m = p x h`` of the axis about the origin, p any point of it.
    """

    angle: NDArray[np.float64]
    slide: NDArray[np.float64]
    direction: NDArray[np.float64]
    moment: NDArray[np.float64]

    @property
    def point(self) -> NDArray[np.float64]:
        """The point of the axis nearest the origin, ``h x m``, shape (..., 3)."""
        return np.cross(self.direction, self.moment)


def screw_from_dual_quat(dual_quat: ArrayLike) -> Screw:
    """Screw parameters of unit dual quaternions.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    Screw, shape (...)
        The angle is ``2 atan2(|v|, w)`` in [0, 2 pi], never an arccosine or arcsine; ``-Q`` gives ``2 pi - angle``
        about the opposite axis. Without rotation (``|v| = 0``) the motion is a translation: angle 0 (or 2 pi), slide
        ``|d|``, direction ``d/|d|``, and the *position* of the axis is not defined: NaN. For the identity the direction
        is NaN too. The moment loses digits as ``|d|/theta``, which is the conditioning of the axis itself.

    References
    ----------
    P 7, 8, 14, 15; K 37.

    Examples
    --------
    The numerical example of P section 2: a quarter turn about z after a shift by (2, 2, 1).

    >>> from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
    >>> screw = screw_from_dual_quat(dual_quat_from_pose([0.5**0.5, 0, 0, 0.5**0.5], [2, 2, 1]))
    >>> round(float(screw.angle), 6), round(float(screw.slide), 6), screw.point.round(6) + 0.0
    (1.570796, 1.0, array([0., 2., 0.]))
    """
    screw = in_blocks(_screw, dual_quat, width=8)
    return Screw(screw[..., 0], screw[..., 1], screw[..., 2:5], screw[..., 5:])


def _screw(Q: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    w, v, w0, v0 = Q[0], Q[1:4], Q[4], Q[5:]
    sine = row_length(v)
    *direction, half_slide = divide_rows([*v, -w0], sine)
    across = half_slide * w
    moment = divide_rows([y - across * x for x, y in zip(direction, v0, strict=True)], sine)
    still = sine == 0.0
    half_angle = np.arctan2(sine, w)
    screw = [half_angle + half_angle, half_slide + half_slide, *direction, *moment]
    if still.any():
        position = _rows.position(Q[:, still])
        distance = row_length(position)
        for row, found in zip(screw[1:5], (distance, *divide_rows(position, distance)), strict=True):
            row[still] = found
    return screw


def dual_quat_from_screw(
    angle: ArrayLike, slide: ArrayLike, direction: ArrayLike, moment: ArrayLike
) -> NDArray[np.float64]:
    """Unit dual quaternions of screw displacements, ``cos(th/2) + sin(th/2) h`` with a dual angle and a dual line.

    Parameters
    ----------
    angle, slide : array_like, shape (...)
        Rotation in radians, translation along the axis.
    direction, moment : array_like, shape (..., 3)
        Unit direction h and moment p x h of the axis.

    Returns
    -------
    ndarray, shape (..., 8)

    References
    ----------
    P 2, 45; K 38.

    Examples
    --------
    The numerical example of P section 2, with the norm that is printed there:

    >>> (2 * dual_quat_from_screw(np.pi / 2, 1, [0, 0, 1], [2, 0, 0])).round(4) + 0.0
    array([ 1.4142,  0.    ,  0.    ,  1.4142, -0.7071,  2.8284,  0.    ,
            0.7071])
    """
    scalars = (np.asarray(value, dtype=np.float64)[..., None] for value in (angle, slide))
    return in_blocks(_from_screw, *scalars, direction, moment, width=8)


def _from_screw(
    angle: _rows.Rows, slide: _rows.Rows, direction: _rows.Rows, moment: _rows.Rows
) -> list[NDArray[np.float64]]:
    cosine, sine = cosine_and_sine(0.5 * angle[0])
    half_slide = 0.5 * slide[0]
    along = half_slide * cosine
    return [
        cosine,
        *(sine * x for x in direction),
        -half_slide * sine,
        *(sine * y + along * x for x, y in zip(direction, moment, strict=True)),
    ]


def line_through(point: ArrayLike, direction: ArrayLike) -> NDArray[np.float64]:
    """Plücker vector of the line through a point along a direction: h, then ``p x h``.

    Parameters
    ----------
    point : array_like, shape (..., 3)
        Any point p of the line.
    direction : array_like, shape (..., 3)
        Of any length; it is normalized. Shapes broadcast.

    Returns
    -------
    ndarray, shape (..., 6)
        NaN for a direction of length 0.

    References
    ----------
    P 19.

    Examples
    --------
    >>> line_through([0, 2, 0], [0, 0, 5])
    array([0., 0., 1., 2., 0., 0.])
    """
    p = np.asarray(point, dtype=np.float64)
    h = np.asarray(direction, dtype=np.float64)
    h = divide(h, length(h)[..., None])
    moment = np.cross(p, h)
    return np.concatenate([np.broadcast_to(h, moment.shape), moment], axis=-1)


def point_nearest_origin(line: ArrayLike) -> NDArray[np.float64]:
    """The point ``h x m`` of lines that is nearest the origin.

    Parameters
    ----------
    line : array_like, shape (..., 6)
        Unit direction h, then moment m about the origin.

    Returns
    -------
    ndarray, shape (..., 3)

    References
    ----------
    P 14.

    Examples
    --------
    >>> point_nearest_origin([0, 0, 1, 2, 0, 0])
    array([0., 2., 0.])
    """
    plucker = np.asarray(line, dtype=np.float64)
    return np.cross(plucker[..., :3], plucker[..., 3:])


def compose_screws(first: Screw, second: Screw) -> Screw:
    """Screw of the motion ``second`` after ``first``, by Rodrigues' formula with dual numbers.

    ``tan(c/2) C = (tan(b/2) B + tan(a/2) A + tan(b/2) tan(a/2) B x A) / (1 - tan(b/2) tan(a/2) B.A)``: a check on the
    product of dual quaternions, which has no poles. Half turns have none of it: NaN or garbage at angles of pi.

    Parameters
    ----------
    first, second : Screw, shape (...)
        Of angles off pi.

    Returns
    -------
    Screw, shape (...)
        Its angle in [0, 2 pi]; NaN in parts where one of the two has no rotation and so no position of its axis.

    References
    ----------
    W; Rodrigues 1840.

    Examples
    --------
    A quarter turn about x, then one about z, is a third of a turn.

    >>> x, z = (screw_from_dual_quat(dual_quat_from_screw(np.pi / 2, 0, h, [0, 0, 0])) for h in ([1, 0, 0], [0, 0, 1]))
    >>> round(float(np.degrees(compose_screws(x, z).angle)), 6)
    120.0
    """
    a, b = (_half_tangent(screw) for screw in (first, second))
    A, B = (np.concatenate([screw.direction, screw.moment], axis=-1) for screw in (first, second))
    both = dual_number.multiply(a, b)
    vector = _scaled(B, b) + _scaled(A, a) + _scaled(dual_vector.cross(B, A), both)
    denominator = dual_number.subtract(
        dual_number.dual_number(np.ones_like(both.real)), dual_number.multiply(both, dual_vector.dot(B, A))
    )
    tangent = dual_vector.norm(vector)
    half = dual_number.atan2(tangent, denominator)
    line = dual_vector.normalize(vector)
    return Screw(2.0 * half.real, 2.0 * half.dual, line[..., :3], line[..., 3:])


def _half_tangent(screw: Screw) -> DualNumber:
    return dual_number.tan(dual_number.dual_number(0.5 * screw.angle, 0.5 * screw.slide))


def _scaled(vector: NDArray[np.float64], factor: DualNumber) -> NDArray[np.float64]:
    real, dual = factor.real[..., None], factor.dual[..., None]
    return np.concatenate([real * vector[..., :3], real * vector[..., 3:] + dual * vector[..., :3]], axis=-1)


def dual_matrix_from_dual_quat(dual_quat: ArrayLike) -> DualMatrix:
    """Dual rotation matrices ``R + eps [d]x R`` that move lines.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    DualMatrix, shape (..., 3, 3)

    References
    ----------
    P 20-21.

    Examples
    --------
    The dual part of the matrix printed in P section 4.

    >>> dual_matrix_from_dual_quat(dual_quat_from_screw(np.pi / 2, 1, [0, 0, 1], [2, 0, 0])).dual.round(6) + 0.0
    array([[-1.,  0.,  2.],
           [ 0., -1., -2.],
           [ 2.,  2.,  0.]])
    """
    quat, position = dual_quaternion.pose_from_dual_quat(dual_quat)
    R = quaternion.rotation_matrix_from_quat(quat)
    moved = np.swapaxes(np.cross(position[..., None, :], np.swapaxes(R, -1, -2)), -1, -2)
    return DualMatrix(R, moved)


def dual_quat_from_dual_matrix(matrix: DualMatrix) -> NDArray[np.float64]:
    """Unit dual quaternions of orthogonal dual matrices: d stands in ``dual real^T``.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., 3, 3)
        Orthogonal, with real parts that are rotations.

    Returns
    -------
    ndarray, shape (..., 8)
        The scalar part is not negative.

    References
    ----------
    P 21, section 4.

    Examples
    --------
    >>> matrix = DualMatrix(np.eye(3), np.array([[0.0, -4.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    >>> dual_quat_from_dual_matrix(matrix) + 0.0
    array([1., 0., 0., 0., 0., 0., 0., 2.])
    """
    turn = matrix.dual @ np.swapaxes(matrix.real, -1, -2)
    position = 0.5 * np.stack(
        [turn[..., 2, 1] - turn[..., 1, 2], turn[..., 0, 2] - turn[..., 2, 0], turn[..., 1, 0] - turn[..., 0, 1]],
        axis=-1,
    )
    return dual_quaternion.dual_quat_from_pose(quaternion.quat_from_rotation_matrix(matrix.real), position)


def screw_from_dual_matrix(matrix: DualMatrix) -> Screw:
    """Screw parameters of orthogonal dual matrices, the second step of P section 4.

    Parameters
    ----------
    matrix : DualMatrix, shape (..., 3, 3)
        Orthogonal, with real parts that are rotations.

    Returns
    -------
    Screw, shape (...)
        As of `screw_from_dual_quat`; the angle is in [0, pi].

    References
    ----------
    P 7, 14, 15, section 4.

    Examples
    --------
    The matrix printed in P section 4.

    >>> real, dual = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([[-1, 0, 2], [0, -1, -2], [2, 2, 0]])
    >>> screw = screw_from_dual_matrix(DualMatrix(real, dual))
    >>> round(float(screw.angle), 6), round(float(screw.slide), 6), screw.point.round(6) + 0.0
    (1.570796, 1.0, array([0., 2., 0.]))
    """
    return screw_from_dual_quat(dual_quat_from_dual_matrix(matrix))
