"""Radii that hold an error whose covariance is itself estimated."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from scipy.special import fdtrc, fdtri

from elbowscrew.geometry.arrays import Float

_BISECTIONS: Final = 40
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
        low, high = float(each.min()), float(each.max())
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if weight @ fdtrc(extent, freedom, middle**2 / trace) > 1.0 - level:
                low = middle
            else:
                high = middle
        return high
