"""Dual numbers ``a + eps b`` with ``eps^2 = 0``, as pairs of real arrays of one shape (...).

A function of a dual number is ``f(a + eps b) = f(a) + eps b f'(a)`` (K 22-23). Where f or its derivative is not defined
the parts are NaN or infinite as NumPy's own functions give them, without a warning.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry._small_angle import divide as _divide
from elbowscrew.geometry.arrays import Float


class _Parts(NamedTuple):
    real: Float
    dual: Float


class DualNumber(_Parts):
    """A dual number ``real + eps dual``.

    A tuple of its two parts, with the arithmetic of dual numbers in place of a tuple's own: ``+``, ``-``, ``*`` and
    ``/`` take dual numbers, real numbers and real arrays, whose shapes broadcast; anything else is a TypeError.

    Attributes
    ----------
    real, dual : ndarray, shape (...)
        The two parts, of one shape.
    """

    __slots__ = ()

    # NumPy leaves an array's operators to those below, and would otherwise take the two parts for an array's rows.
    __array_ufunc__ = None

    def __neg__(self) -> DualNumber:
        return dual_number(-self.real, -self.dual)

    def __add__(self, other: Operand) -> DualNumber:  # type: ignore[override]
        return _combined(add, self, other)

    def __radd__(self, other: Operand) -> DualNumber:
        return _combined(add, other, self)

    def __sub__(self, other: Operand) -> DualNumber:
        return _combined(subtract, self, other)

    def __rsub__(self, other: Operand) -> DualNumber:
        return _combined(subtract, other, self)

    def __mul__(self, other: Operand) -> DualNumber:  # type: ignore[override]
        return _combined(multiply, self, other)

    def __rmul__(self, other: Operand) -> DualNumber:  # type: ignore[override]
        return _combined(multiply, other, self)

    def __truediv__(self, other: Operand) -> DualNumber:
        return _combined(divide, self, other)

    def __rtruediv__(self, other: Operand) -> DualNumber:
        return _combined(divide, other, self)


Operand: TypeAlias = DualNumber | float | np.floating[Any] | np.integer[Any] | Float


def dual_number(real: ArrayLike, dual: ArrayLike = 0.0) -> DualNumber:
    """Build a dual number from its two parts, which are broadcast to one shape.

    Parameters
    ----------
    real : array_like, shape (...)
        Real part.
    dual : array_like, shape (...)
        Dual part.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 18.

    Examples
    --------
    >>> sin(dual_number(0.0, 2.0)).dual
    array(2.)
    """
    a, b = np.broadcast_arrays(np.asarray(real, dtype=np.float64), np.asarray(dual, dtype=np.float64))
    return DualNumber(np.array(a), np.array(b))


def _combined(function: Callable[[DualNumber, DualNumber], DualNumber], left: object, right: object) -> DualNumber:
    """Give an operator's result, or NotImplemented for an operand that is neither dual nor real."""
    terms = [_as_dual(left), _as_dual(right)]
    if terms[0] is not None and terms[1] is not None:
        return function(terms[0], terms[1])
    strange = left if terms[0] is None else right
    if isinstance(strange, tuple) or hasattr(strange, "__index__"):
        # After NotImplemented Python would join or repeat the tuples.
        msg = f"a dual number does not combine with {type(strange).__name__}: {strange!r}"
        raise TypeError(msg)
    answer: DualNumber = NotImplemented  # so that another type's own operator is asked
    return answer


def _as_dual(operand: object) -> DualNumber | None:
    if isinstance(operand, DualNumber):
        return operand
    if isinstance(operand, int | float | np.generic | np.ndarray) and np.asarray(operand).dtype.kind in "fiub":
        return dual_number(np.asarray(operand, dtype=np.float64))
    return None


def add(left: DualNumber, right: DualNumber) -> DualNumber:
    """Sum.

    Parameters
    ----------
    left, right : DualNumber, shape (...)
        Terms; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    P 39, K 19.

    Examples
    --------
    >>> add(dual_number(1.0, 2.0), dual_number(3.0, 4.0))
    DualNumber(real=array(4.), dual=array(6.))
    """
    return dual_number(left.real + right.real, left.dual + right.dual)


def subtract(left: DualNumber, right: DualNumber) -> DualNumber:
    """Difference ``left - right``.

    Parameters
    ----------
    left, right : DualNumber, shape (...)
        Minuend and subtrahend; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    P 39, K 19, with the second sign changed.

    Examples
    --------
    >>> subtract(dual_number(3.0, 4.0), dual_number(1.0, 1.0))
    DualNumber(real=array(2.), dual=array(3.))
    """
    return dual_number(left.real - right.real, left.dual - right.dual)


def multiply(left: DualNumber, right: DualNumber) -> DualNumber:
    """Product ``a c + eps (a d + b c)``.

    Parameters
    ----------
    left, right : DualNumber, shape (...)
        Factors ``a + eps b`` and ``c + eps d``; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 20.

    Examples
    --------
    >>> multiply(dual_number(1.0, 2.0), dual_number(3.0, 4.0))
    DualNumber(real=array(3.), dual=array(10.))
    """
    return dual_number(left.real * right.real, left.real * right.dual + left.dual * right.real)


def divide(left: DualNumber, right: DualNumber) -> DualNumber:
    """Quotient ``a/c + eps (b c - a d)/c^2``.

    Parameters
    ----------
    left, right : DualNumber, shape (...)
        Dividend ``a + eps b`` and divisor ``c + eps d``; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)
        NaN where c = 0.

    References
    ----------
    K 21.

    Examples
    --------
    >>> divide(dual_number(3.0, 10.0), dual_number(1.0, 2.0))
    DualNumber(real=array(3.), dual=array(4.))
    """
    real = _divide(left.real, right.real)
    return dual_number(real, _divide(left.dual - real * right.dual, right.real))


def sin(x: DualNumber) -> DualNumber:
    """Sine.

    Parameters
    ----------
    x : DualNumber, shape (...)
        Radians.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> sin(dual_number(0.0, 2.0))
    DualNumber(real=array(0.), dual=array(2.))
    """
    return dual_number(np.sin(x.real), x.dual * np.cos(x.real))


def cos(x: DualNumber) -> DualNumber:
    """Cosine.

    Parameters
    ----------
    x : DualNumber, shape (...)
        Radians.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> cos(dual_number(np.pi / 2, 3.0)).dual
    array(-3.)
    """
    return dual_number(np.cos(x.real), -x.dual * np.sin(x.real))


def tan(x: DualNumber) -> DualNumber:
    """Tangent.

    Parameters
    ----------
    x : DualNumber, shape (...)
        Radians.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> tan(dual_number(0.0, 2.0))
    DualNumber(real=array(0.), dual=array(2.))
    """
    tangent = np.tan(x.real)
    return dual_number(tangent, x.dual * (1.0 + tangent**2))


def asin(x: DualNumber) -> DualNumber:
    """Arcsine.

    Parameters
    ----------
    x : DualNumber, shape (...)
        With real parts in [-1, 1].

    Returns
    -------
    DualNumber, shape (...)
        Radians, real part in [-pi/2, pi/2]; NaN outside of [-1, 1], NaN dual part at real parts 1 and -1.

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> asin(dual_number(0.0, 2.0))
    DualNumber(real=array(0.), dual=array(2.))
    """
    with np.errstate(invalid="ignore"):
        return dual_number(np.arcsin(x.real), _divide(x.dual, np.sqrt((1.0 - x.real) * (1.0 + x.real))))


def acos(x: DualNumber) -> DualNumber:
    """Arccosine; near real parts 1 and -1 `atan2` keeps its digits.

    Parameters
    ----------
    x : DualNumber, shape (...)
        With real parts in [-1, 1].

    Returns
    -------
    DualNumber, shape (...)
        Radians, real part in [0, pi]; NaN outside of [-1, 1], NaN dual part at real parts 1 and -1.

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> acos(dual_number(1.0, 0.0)).dual, acos(dual_number(0.0, 2.0)).dual
    (array(nan), array(-2.))
    """
    with np.errstate(invalid="ignore"):
        return dual_number(np.arccos(x.real), _divide(-x.dual, np.sqrt((1.0 - x.real) * (1.0 + x.real))))


def atan2(y: DualNumber, x: DualNumber) -> DualNumber:
    """Angle of the point (x, y): ``atan2(a, c) + eps (b c - a d)/(a^2 + c^2)``.

    Parameters
    ----------
    y, x : DualNumber, shape (...)
        Ordinate ``a + eps b`` and abscissa ``c + eps d``; shapes broadcast.

    Returns
    -------
    DualNumber, shape (...)
        Radians, real part in [-pi, pi]; NaN dual part at the origin.

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> atan2(dual_number(3.0, 1.0), dual_number(4.0, 0.0)).dual
    array(0.16)
    """
    square = y.real**2 + x.real**2
    return dual_number(np.arctan2(y.real, x.real), _divide(y.dual * x.real - y.real * x.dual, square))


def sqrt(x: DualNumber) -> DualNumber:
    """Square root.

    Parameters
    ----------
    x : DualNumber, shape (...)
        With real parts that are not negative.

    Returns
    -------
    DualNumber, shape (...)
        NaN for a negative real part, NaN dual part at 0.

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> sqrt(dual_number(9.0, 6.0))
    DualNumber(real=array(3.), dual=array(1.))
    """
    with np.errstate(invalid="ignore"):
        root = np.sqrt(x.real)
    return dual_number(root, _divide(x.dual, 2.0 * root))


def exp(x: DualNumber) -> DualNumber:
    """Exponential.

    Parameters
    ----------
    x : DualNumber, shape (...)
        Exponent.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> exp(dual_number(0.0, 2.0))
    DualNumber(real=array(1.), dual=array(2.))
    """
    with np.errstate(over="ignore", invalid="ignore"):
        value = np.exp(x.real)
        return dual_number(value, x.dual * value)


def log(x: DualNumber) -> DualNumber:
    """Natural logarithm.

    Parameters
    ----------
    x : DualNumber, shape (...)
        With positive real parts.

    Returns
    -------
    DualNumber, shape (...)
        NaN real part where that of x is not positive; NaN dual part where it is 0.

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> log(dual_number(1.0, 2.0))
    DualNumber(real=array(0.), dual=array(2.))
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.log(x.real)
    positive = x.real > 0.0
    return dual_number(np.where(positive, value, np.nan), np.where(positive, _divide(x.dual, x.real), np.nan))


def power(x: DualNumber, exponent: ArrayLike) -> DualNumber:
    """Real power ``a^t + eps t b a^(t-1)``.

    Parameters
    ----------
    x : DualNumber, shape (...)
        Base ``a + eps b``.
    exponent : array_like, shape (...)
        Real exponent t.

    Returns
    -------
    DualNumber, shape (...)

    References
    ----------
    K 22-23.

    Examples
    --------
    >>> power(dual_number(3.0, 1.0), 2)
    DualNumber(real=array(9.), dual=array(6.))
    """
    t = np.asarray(exponent, dtype=np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = np.where(t == 0.0, 0.0, t * x.real ** (t - 1.0))
        return dual_number(x.real**t, x.dual * slope)
