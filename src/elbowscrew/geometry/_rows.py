"""The formulas of quaternions and dual quaternions, on rows of components: arrays (n,), one for each component.

Here alone they are written down; the public functions put them over arrays of any leading shape, block by block
(`elbowscrew.geometry._blocks`). NumPy's warnings must be off.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from elbowscrew.geometry._small_angle import (
    cosine_and_sine,
    divide_rows,
    ratio_of_equals,
    row_length,
    sinc_slope,
)
from elbowscrew.geometry.arrays import Float

Rows = Sequence[Float] | Float


def product(a: Rows, b: Rows) -> list[Float]:
    """Hamilton product."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]


def dual_product(a: Rows, b: Rows) -> list[Float]:
    """Product of dual quaternions."""
    dual = product(a[:4], b[4:])
    for total, term in zip(dual, product(a[4:], b[:4]), strict=True):
        total += term
    return [*product(a[:4], b[:4]), *dual]


# Component of a factor, and its sign, at each place of the matrix that it multiplies another quaternion by.
_PLACE: Final = np.array([[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]])
_LEFT_SIGN: Final = np.array([[1.0, -1, -1, -1], [1, 1, -1, 1], [1, 1, 1, -1], [1, -1, 1, 1]])
_RIGHT_SIGN: Final = np.array([[1.0, -1, -1, -1], [1, 1, 1, -1], [1, -1, 1, 1], [1, 1, -1, 1]])


def left_maps(factor: Float) -> tuple[Float, Float]:
    """Product by a left factor (8,) as linear maps: (4, 4) for the real part, (4, 8) for the dual one.

    The two parts have their own maps, so that what is not finite in the dual part stays there.
    """
    return _maps(factor, _LEFT_SIGN)


def right_maps(factor: Float) -> tuple[Float, Float]:
    """Product by a right factor, as `left_maps`."""
    return _maps(factor, _RIGHT_SIGN)


def _maps(factor: Float, sign: Float) -> tuple[Float, Float]:
    real, dual = sign * factor[:4][_PLACE], sign * factor[4:][_PLACE]
    return real, np.concatenate([dual, real], axis=1)


def mapped(maps: tuple[Float, Float], Q: Float) -> list[Float]:
    """Apply the maps of a constant factor."""
    real, dual = maps
    return [*(real @ Q[:4]), *(dual @ Q)]


def conjugate(a: Rows) -> list[Float]:
    """Quaternion conjugate, of both parts if there are two."""
    return [row if k % 4 == 0 else -row for k, row in enumerate(a)]


def dot(a: Rows, b: Rows) -> Float:
    """Dot product."""
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total += x * y
    return total


def cross(a: Rows, b: Rows) -> list[Float]:
    """Cross product."""
    ax, ay, az = a
    bx, by, bz = b
    return [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]


def imaginary_product(a: Rows, b: Rows) -> list[Float]:
    """Vector part of the Hamilton product."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]


def position(Q: Rows) -> list[Float]:
    """Origin of a pose: ``2 q0 q*``."""
    return [2.0 * row for row in imaginary_product(Q[4:], conjugate(Q[:4]))]


def rotated(quat: Rows, vector: Rows) -> list[Float]:
    """Rotate a vector: ``v + w t + u x t`` with ``t = 2 u x v``."""
    twice = [row + row for row in cross(quat[1:], vector)]
    rotated = cross(quat[1:], twice)
    return [v + quat[0] * t + u for v, t, u in zip(vector, twice, rotated, strict=True)]


def rotation_matrix(quat: Rows) -> list[Float]:
    """Rotation matrix, row after row."""
    w, x, y, z = quat
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    xy, xz, yz, wx, wy, wz = x * y, x * z, y * z, w * x, w * y, w * z
    return [
        ww + xx - yy - zz,
        2.0 * (xy - wz),
        2.0 * (xz + wy),
        2.0 * (xy + wz),
        ww - xx + yy - zz,
        2.0 * (yz - wx),
        2.0 * (xz - wy),
        2.0 * (yz + wx),
        ww - xx - yy + zz,
    ]


def adjoint_blocks(Q: Rows) -> list[Float]:
    """Rotation R of a pose and ``[d]x R`` of its origin d, both row after row."""
    R, (x, y, z) = rotation_matrix(Q[:4]), position(Q)
    first, second, third = R[:3], R[3:6], R[6:]
    return [
        *R,
        *(y * b - z * a for a, b in zip(second, third, strict=True)),
        *(z * b - x * a for a, b in zip(third, first, strict=True)),
        *(x * b - y * a for a, b in zip(first, second, strict=True)),
    ]


def normalized(Q: Rows, least: float = 0.0) -> list[Float]:
    """Divide by the dual norm; NaN where the real part's is not more than `least`."""
    quotients = divide_rows(Q, row_length(Q[:4]), least)
    real, dual = quotients[:4], quotients[4:]
    along = dot(real, dual)
    return [*real, *(y - along * x for x, y in zip(real, dual, strict=True))]


def sign_towards(Q: Rows, reference: Rows) -> Float:
    """-1 where the real parts have a negative dot product, else 1."""
    return np.where(dot(Q[:4], reference[:4]) < 0.0, -1.0, 1.0)


def weighted(weights: Rows, keys: Sequence[Rows]) -> list[Float]:
    """Weighted sum of quaternions or dual quaternions."""
    total = [weights[0] * row for row in keys[0]]
    for weight, key in zip(weights[1:], keys[1:], strict=True):
        for k, row in enumerate(key):
            total[k] = total[k] + weight * row
    return total


def exponential(half_twist: Rows, half_angle: Float | None = None) -> list[Float]:
    """Exponential of pure dual quaternions, of a known length of the real part if there is one."""
    a, b = half_twist[:3], half_twist[3:]
    half = row_length(a) if half_angle is None else half_angle
    cosine, sine = cosine_and_sine(half)
    ratio = ratio_of_equals(sine, half)
    projection = dot(a, b)
    slope = sinc_slope(half, cosine, ratio) * projection
    return [
        cosine,
        *(ratio * x for x in a),
        -ratio * projection,
        *(ratio * y + slope * x for x, y in zip(a, b, strict=True)),
    ]


def logarithm(Q: Rows) -> tuple[list[Float], Float]:
    """Half the dual rotation vector, six rows, and half the angle; NaN at ``w = -1``, where there is no axis."""
    w, v, w0, v0 = Q[0], Q[1:4], Q[4], Q[5:]
    sine = row_length(v)
    half = np.arctan2(sine, w)
    ratio = ratio_of_equals(half, sine)
    if not np.fmin.reduce(sine, axis=None) > 0.0:
        undefined = (sine == 0.0) & (w < 0.0)
        ratio[undefined] = half[undefined] = np.nan
    # d(half/sine) = w0 sinc_slope(half) ratio^3 for a unit Q, where <v, v0> = -w w0.
    slope = w0 * sinc_slope(half, w, 1.0 / ratio) * (ratio * ratio * ratio)
    return [*(ratio * x for x in v), *(ratio * y + slope * x for x, y in zip(v, v0, strict=True))], half


def power(Q: Rows, exponent: Float) -> list[Float]:
    """``exp(t log Q)``."""
    half_twist, half = logarithm(Q)
    return exponential([exponent * row for row in half_twist], np.abs(exponent) * half)
