"""The only place where small angles, small lengths and their tolerances are dealt with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float

# Below this angle (rad) the closed form of `sinc_slope` cancels and the series is used; nine terms leave 2e-18 there.
_SERIES_BELOW: Final = 1.0
_SERIES_TERMS: Final = 9

# Five terms of (1 - (x/2) cot(x/2))/x^2 leave 6e-15 of it below this angle (rad), where the closed form leaves 4e-14.
_HALF_COTANGENT: Final = (1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0)
_FEW_TERMS_BELOW: Final = 0.25

# A blend whose real part is shorter than this (the keyframes being unit) has lost all its digits.
VANISHING_NORM: Final = 1e-12

# A rotation smaller than this (rad) turns nothing that a double could tell, but quotients by it overflow.
NEGLIGIBLE_ANGLE: Final = 1e-100

# Sine and angle, or two lengths that differ as they do, are one number below this.
_EQUAL_BELOW: Final = 1e-300

# Within these a sum of squares has lost nothing to underflow or overflow, and no quotient by its root overflows.
_LEAST_SQUARE: Final = 1e-250
_LARGEST_SQUARE: Final = 1e250
_LEAST_DIVISOR: Final = 1e-125


def _sinc_slope_coefficients() -> tuple[float, ...]:
    factorial, coefficients = 1, []
    for k in range(1, _SERIES_TERMS + 1):
        factorial *= (2 * k) * (2 * k + 1)
        coefficients.append((-1) ** k * 2 * k / factorial)
    return tuple(coefficients)


_SINC_SLOPE: Final = _sinc_slope_coefficients()


def cosine_and_sine(angle: Float) -> tuple[Float, Float]:
    """Cosine and sine from the tangent of the half angle, which NumPy has ten times as fast as either.

    The sine keeps all its digits, near multiples of pi as well; the error of the cosine is relative to 1.
    """
    tangent = np.tan(0.5 * angle)
    scale = 1.0 / (1.0 + tangent * tangent)
    return (1.0 - tangent) * (1.0 + tangent) * scale, (tangent + tangent) * scale


def ratio_of_equals(numerator: Float, denominator: Float) -> Float:
    """``numerator / denominator`` of two that vanish together, with 1 where they do; NumPy's warnings must be off.

    They are equal to the last digit long before; among the smallest numbers there is, halves are lost in between.
    """
    ratio: Float = numerator / denominator
    if not np.fmin.reduce(denominator, axis=None) > _EQUAL_BELOW:
        small = (np.abs(numerator) < _EQUAL_BELOW) & (denominator < _EQUAL_BELOW)
        ratio[small | (denominator == 0.0)] = 1.0
    return ratio


def sinc_slope(angle: Float, cosine: Float, sinc: Float) -> Float:
    """(cos x - sin(x)/x) / x^2, the derivative of sinc divided by x, -1/3 at x = 0; of x that are not negative.

    Cosine and sin(x)/x are those of the angle. NumPy's warnings must be off.
    """
    square = angle * angle
    if square.min() >= _SERIES_BELOW**2:
        return (cosine - sinc) / square
    series = _SINC_SLOPE[-1] * square
    for coefficient in reversed(_SINC_SLOPE[1:-1]):
        series += coefficient
        series *= square
    series += _SINC_SLOPE[0]
    if square.max() < _SERIES_BELOW**2:
        return series
    return np.where(square < _SERIES_BELOW**2, series, (cosine - sinc) / square)


def half_cotangent_share(angle: Float) -> Float:
    """``(1 - (x/2) cot(x/2)) / x^2`` of angles from 0 to 2 pi, 1/12 at x = 0."""
    square = angle * angle
    series = np.zeros(np.shape(angle))
    for coefficient in _HALF_COTANGENT[::-1]:
        series = series * square + coefficient
    small = square < _FEW_TERMS_BELOW**2
    x = np.where(small, 1.0, angle)
    return np.where(small, series, (1.0 - 0.5 * x / np.tan(0.5 * x)) / (x * x))


def length(vector: Float) -> Float:
    """Euclidean length over the last axis, without underflow or overflow of the squares.

    Plain squares vanish below 1e-154, and a rotation of 1e-300 rad would have no axis.
    """
    if vector.shape[-1] == 0 or vector.size == 0:
        return np.zeros(vector.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        size = row_length([np.atleast_1d(vector[..., k]) for k in range(vector.shape[-1])])
    return size.reshape(vector.shape[:-1])[()]


def row_length(rows: Sequence[Float] | Float) -> Float:
    """Length of a vector whose components are these arrays; as of `length`, with NumPy's warnings off."""
    square = rows[0] * rows[0]
    for row in rows[1:]:
        square += row * row
    size: Float = np.sqrt(square)
    if not (np.fmin.reduce(square, axis=None) > _LEAST_SQUARE and np.fmax.reduce(square, axis=None) < _LARGEST_SQUARE):
        odd = ~((square > _LEAST_SQUARE) & (square < _LARGEST_SQUARE))
        exact = np.abs(rows[0][odd])
        for row in rows[1:]:
            exact = np.hypot(exact, row[odd])
        size[odd] = exact
    return size


def divide(numerator: Float, denominator: Float) -> Float:
    """``numerator / denominator``, NaN where the denominator is 0 or the quotient beyond all numbers."""
    zero = denominator == 0.0
    with np.errstate(over="ignore"):
        quotient: Float = numerator / np.where(zero, 1.0, denominator)
    return np.where(zero | np.isinf(quotient), np.nan, quotient)


def divide_rows(rows: Sequence[Float] | Float, divisor: Float, least: float = 0.0) -> list[Float]:
    """Divide rows by one that is not negative, as `divide`, and NaN below `least`; NumPy's warnings must be off."""
    if np.fmin.reduce(divisor) >= max(least, _LEAST_DIVISOR):
        return [row / divisor for row in rows]
    divisor = np.where((divisor == 0.0) | (divisor < least), np.nan, divisor)
    quotients = [row / divisor for row in rows]
    for quotient in quotients:
        quotient[np.isinf(quotient)] = np.nan
    return quotients
