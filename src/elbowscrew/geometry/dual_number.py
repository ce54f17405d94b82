"""Dual numbers ``a + eps b`` with ``eps^2 = 0``, as pairs of real arrays of one shape (...).

A function of a dual number is ``f(a + eps b) = f(a) + eps b f'(a)`` (K 22-23). Where f or its derivative is not defined
the parts are NaN or infinite as NumPy's own functions give them, without a warning.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry._small_angle import divide as _divide

Float = NDArray[np.float64]


class DualNumber(NamedTuple):
    """A dual number ``real + eps dual``; both parts have the same shape (...).

    A tuple of arrays: ``+`` and ``*`` are the tuple's own, so use the functions of this module.
    """

    real: Float
    dual: Float


def dual_number(real: ArrayLike, dual: ArrayLike = 0.0) -> DualNumber:
    """Build a dual number from its two parts, which are broadcast to one shape.

    Examples
    --------
    >>> sin(dual_number(0.0, 2.0)).dual
    array(2.)
    """
    a, b = np.broadcast_arrays(np.asarray(real, dtype=np.float64), np.asarray(dual, dtype=np.float64))
    return DualNumber(np.array(a), np.array(b))


def add(left: DualNumber, right: DualNumber) -> DualNumber:
    """Sum (K 19)."""
    return dual_number(left.real + right.real, left.dual + right.dual)


def subtract(left: DualNumber, right: DualNumber) -> DualNumber:
    """Difference."""
    return dual_number(left.real - right.real, left.dual - right.dual)


def multiply(left: DualNumber, right: DualNumber) -> DualNumber:
    """Product ``a c + eps (a d + b c)`` (K 20)."""
    return dual_number(left.real * right.real, left.real * right.dual + left.dual * right.real)


def divide(left: DualNumber, right: DualNumber) -> DualNumber:
    """Quotient ``a/c + eps (b c - a d)/c^2`` (K 21); NaN where c = 0."""
    real = _divide(left.real, right.real)
    return dual_number(real, _divide(left.dual - real * right.dual, right.real))


def sin(x: DualNumber) -> DualNumber:
    """Sine."""
    return dual_number(np.sin(x.real), x.dual * np.cos(x.real))


def cos(x: DualNumber) -> DualNumber:
    """Cosine."""
    return dual_number(np.cos(x.real), -x.dual * np.sin(x.real))


def tan(x: DualNumber) -> DualNumber:
    """Tangent."""
    tangent = np.tan(x.real)
    return dual_number(tangent, x.dual * (1.0 + tangent**2))


def asin(x: DualNumber) -> DualNumber:
    """Arcsine; the dual part is not defined at real parts 1 and -1."""
    with np.errstate(invalid="ignore"):
        return dual_number(np.arcsin(x.real), _divide(x.dual, np.sqrt((1.0 - x.real) * (1.0 + x.real))))


def acos(x: DualNumber) -> DualNumber:
    """Arccosine; the dual part is not defined at real parts 1 and -1, near which `atan2` keeps its digits."""
    with np.errstate(invalid="ignore"):
        return dual_number(np.arccos(x.real), _divide(-x.dual, np.sqrt((1.0 - x.real) * (1.0 + x.real))))


def atan2(y: DualNumber, x: DualNumber) -> DualNumber:
    """Angle of the point (x, y): ``atan2(a, c) + eps (b c - a d)/(a^2 + c^2)``; NaN dual part at the origin."""
    square = y.real**2 + x.real**2
    return dual_number(np.arctan2(y.real, x.real), _divide(y.dual * x.real - y.real * x.dual, square))


def sqrt(x: DualNumber) -> DualNumber:
    """Square root; NaN for a negative real part, NaN dual part at 0."""
    with np.errstate(invalid="ignore"):
        root = np.sqrt(x.real)
    return dual_number(root, _divide(x.dual, 2.0 * root))


def exp(x: DualNumber) -> DualNumber:
    """Exponential."""
    value = np.exp(x.real)
    return dual_number(value, x.dual * value)


def log(x: DualNumber) -> DualNumber:
    """Natural logarithm; NaN for a real part that is not positive."""
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.log(x.real)
    return dual_number(np.where(x.real > 0.0, value, np.nan), _divide(x.dual, x.real))


def power(x: DualNumber, exponent: ArrayLike) -> DualNumber:
    """Real power ``a^t + eps t b a^(t-1)``."""
    t = np.asarray(exponent, dtype=np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        return dual_number(x.real**t, t * x.dual * x.real ** (t - 1.0))
