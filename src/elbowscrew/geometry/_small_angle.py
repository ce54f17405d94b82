"""The only place where small angles, small lengths and their tolerances are dealt with."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]

# Below this angle (rad) the closed form of `sinc_slope` cancels and the series is used; nine terms leave 2e-18 there.
_SERIES_BELOW: Final = 1.0
_SERIES_TERMS: Final = 9

# A blend whose real part is shorter than this (the keyframes being unit) has lost all its digits.
VANISHING_NORM: Final = 1e-12


def _sinc_slope_coefficients() -> tuple[float, ...]:
    factorial, coefficients = 1, []
    for k in range(1, _SERIES_TERMS + 1):
        factorial *= (2 * k) * (2 * k + 1)
        coefficients.append((-1) ** k * 2 * k / factorial)
    return tuple(coefficients)


_SINC_SLOPE: Final = _sinc_slope_coefficients()


def sinc(angle: Float) -> Float:
    """sin(x)/x, 1 at x = 0; exact to round-off everywhere, so it needs no series."""
    safe = np.where(angle == 0.0, 1.0, angle)
    return np.where(angle == 0.0, 1.0, np.sin(safe) / safe)


def sinc_slope(angle: Float) -> Float:
    """(cos x - sin(x)/x) / x^2, the derivative of sinc divided by x; -1/3 at x = 0."""
    square = np.minimum(np.abs(angle), _SERIES_BELOW) ** 2
    series = np.full_like(square, _SINC_SLOPE[-1])
    for coefficient in reversed(_SINC_SLOPE[:-1]):
        series = series * square + coefficient
    safe = np.where(np.abs(angle) < _SERIES_BELOW, _SERIES_BELOW, angle)
    closed = (np.cos(safe) - np.sin(safe) / safe) / safe**2
    return np.where(np.abs(angle) < _SERIES_BELOW, series, closed)


def length(vector: Float) -> Float:
    """Euclidean length over the last axis, without underflow or overflow of the squares.

    Plain squares vanish below 1e-154, and a rotation of 1e-300 rad would have no axis.
    """
    total = np.abs(vector[..., 0])
    for k in range(1, vector.shape[-1]):
        total = np.hypot(total, vector[..., k])
    return total


def divide(numerator: Float, denominator: Float) -> Float:
    """``numerator / denominator``, NaN where the denominator is 0 or the quotient beyond all numbers."""
    zero = denominator == 0.0
    with np.errstate(over="ignore"):
        quotient: Float = numerator / np.where(zero, 1.0, denominator)
    return np.where(zero | np.isinf(quotient), np.nan, quotient)
