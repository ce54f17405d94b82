"""Radii that hold an error whose covariance is itself estimated."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from scipy.special import fdtrc, fdtri

from elbowscrew.geometry.arrays import Float

_CLOSE: Final = 1e-13
_MANY: Final = 1e6  # degrees of freedom from which on a t is a normal distribution


class Mixture(NamedTuple):
    """Covariances of one error, each with its degrees of freedom and its probability.

    Attributes
    ----------
    covariance : ndarray, shape (H, P, P)
    freedom, weight : ndarray, shape (H,)
        Infinite freedom for a covariance that is known; the weights sum to 1.
    """

    covariance: Float
    freedom: Float
    weight: Float

    @classmethod
    def of_one(cls, covariance: Float, freedom: float = np.inf) -> Mixture:
        """One covariance (P, P), known or estimated."""
        return cls(covariance[None], np.array([freedom]), np.ones(1))

    @property
    def mean(self) -> Float:
        """Mean of the covariances, shape (P, P)."""
        return np.asarray(np.tensordot(self.weight, self.covariance, axes=1))

    def of(self, rows: Float) -> Mixture:
        """The error of ``rows @ x``, rows of shape (k, P)."""
        return self._replace(covariance=rows @ self.covariance @ rows.T)

    def plus(self, other: Mixture) -> Mixture:
        """Error of the sum of two independent errors, the freedom by Welch and Satterthwaite."""
        pairs = (len(self.weight), len(other.weight))
        mine, others = (np.trace(part.covariance, axis1=1, axis2=2) for part in (self, other))
        square = (mine**2 / self.freedom)[:, None] + (others**2 / other.freedom)[None]
        both = (mine[:, None] + others[None]) ** 2
        freedom = np.divide(both, square, out=np.full(pairs, np.inf), where=square > 0.0)
        covariance = self.covariance[:, None] + other.covariance[None]
        return Mixture(
            covariance.reshape(-1, *covariance.shape[2:]),
            freedom.ravel(),
            (self.weight[:, None] * other.weight[None]).ravel(),
        )

    def radius(self, level: float) -> float:
        """Radius about the estimate that holds the error with probability `level`.

        References
        ----------
        ``|x|^2 / tr C`` has the distribution of F with ``(tr C)^2 / tr C^2`` and the estimate's degrees of freedom:
        exact for one direction and for equal variances, within 0.5 % between (Satterthwaite 1946).
        """
        trace = np.trace(self.covariance, axis1=1, axis2=2)
        if not np.isfinite(trace).all():
            return float("nan")
        square = np.sum(self.covariance**2, axis=(1, 2))
        used = (trace > 0.0) & (self.weight > 0.0)
        if not used.any():
            return 0.0
        trace, weight = trace[used], self.weight[used]
        extent = trace**2 / square[used]
        freedom = np.minimum(self.freedom[used], _MANY)
        each = np.sqrt(trace * fdtri(extent, freedom, level))
        return _falls_to_zero(
            lambda radius: float(weight @ fdtrc(extent, freedom, radius**2 / trace)) - (1.0 - level),
            float(each.min()),
            float(each.max()),
        )


def _falls_to_zero(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function that is smooth is zero between two points.

    References
    ----------
    Dowell and Jarratt 1971 (the Illinois method: a secant, whose end that stays is drawn in by half).
    """
    at_low, at_high, kept = function(low), function(high), 0
    if at_low <= 0.0:
        return low
    while at_high < 0.0 and high - low > _CLOSE * high:
        middle = high - at_high * (high - low) / (at_high - at_low)
        value = function(middle)
        if value > 0.0:
            low, at_low = middle, value
            at_high *= 0.5 if kept > 0 else 1.0
            kept = 1
        else:
            high, at_high = middle, value
            at_low *= 0.5 if kept < 0 else 1.0
            kept = -1
    return high
