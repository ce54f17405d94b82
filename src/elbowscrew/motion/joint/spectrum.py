"""Covariance of a fit from the spectrum of its residuals (method B): noise that is random in time, of any color.

Bands of the cosine transform stand for the spectrum, so that no rate is needed. The lowest reaches past the motion's
own frequency: noise slower than the motion cannot be told from it, and has the band's power at most.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from scipy.fft import dct
from scipy.special import chdtrc

from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.motion.joint.influence import Influence
from elbowscrew.motion.joint.tails import Mixture

_BAND_RATIO: Final = 1.6
_PAST_THE_MOTION: Final = 1.25
_MOTION_SHARE: Final = 0.9
_SLOWEST_FASTEST: Final = 1.0 / 16.0  # cycles a frame: the lowest band never takes more of the spectrum
_LEAST_FREEDOM: Final = 6.0
_SURELY_NOT_FLAT: Final = 1e-3


def cosine_transform(series: Float) -> Float:
    """Orthonormal cosine transform along the frames: of white noise it is white noise."""
    return np.asarray(dct(series, axis=0, norm="ortho"), dtype=np.float64)


def band_starts(angle: Float) -> Index:
    """First index of each band of a cosine transform of as many frames as there are angles.

    Parameters
    ----------
    angle : ndarray, shape (F,) or (F, A)
        The motion, radians; the fastest of several angles counts.
    """
    count = len(angle)
    own = min(max(1, *(_own_index(one) for one in angle.reshape(count, -1).T)) / (2.0 * count), _SLOWEST_FASTEST)
    edges = [_PAST_THE_MOTION * own]
    while edges[-1] * _BAND_RATIO < 0.5:
        edges.append(edges[-1] * _BAND_RATIO)
    starts = np.ceil(2.0 * count * np.array(edges)).astype(np.int64)
    return np.unique(np.concatenate([[0], starts[starts < count]]))


def _own_index(angle: Float) -> int:
    """Index of a cosine transform below which a motion has nearly all of its energy."""
    motion = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    summed = np.cumsum(np.sum(cosine_transform(motion - motion.mean(axis=0)) ** 2, axis=1))
    return int(np.searchsorted(summed, _MOTION_SHARE * summed[-1])) if summed[-1] > 0.0 else 1


def band_sums(values: Float, starts: Index) -> Float:
    """Sum over the frequencies of each band, along the first axis."""
    return np.add.reduceat(values, starts, axis=0)


class ResidualSpectrum(NamedTuple):
    """What the residuals' own spectrum says of the shared numbers.

    Attributes
    ----------
    flat : bool
        Whether the residuals are white as far as one can tell.
    variance : float
        Of the whitened residuals.
    white : Mixture
        Under white noise of the stated size, or of the residuals' if it is larger.
    colored : Mixture or None
        Under noise of the residuals' spectrum, where that is not flat.
    part : ndarray, shape (B, P, P)
        Share of each band in the colored covariance.
    part_freedom : ndarray, shape (B,)
    """

    flat: bool
    variance: float
    white: Mixture
    colored: Mixture | None
    part: Float
    part_freedom: Float

    def of(self, rows: Float) -> ResidualSpectrum:
        """What it says of ``rows @ x``, rows of shape (k, P)."""
        return self._replace(
            white=self.white.of(rows),
            colored=None if self.colored is None else self.colored.of(rows),
            part=rows @ self.part @ rows.T,
        )

    def radius(self, rows: Float, level: float) -> float:
        """Radius that holds the error of ``rows @ x``: the larger of both, where there are two."""
        white = self.white.of(rows).radius(level)
        if self.colored is None:
            return white
        # How far the power is known depends on the bands that matter for these rows.
        share = np.trace(rows @ self.part @ rows.T, axis1=1, axis2=2)
        freedom = float(share.sum() ** 2 / np.sum(share**2 / self.part_freedom)) if share.any() else np.inf
        colored = self.colored._replace(freedom=np.array([freedom]))
        return max(white, colored.of(rows).radius(level))


def residual_spectrum(influence: Influence, *, noise_known: bool = True) -> ResidualSpectrum:
    """Estimate the spectrum of the residuals by bands, and the covariance under it.

    Parameters
    ----------
    influence : Influence
    noise_known : bool
        Whether the stated noise is a lower bound; else the residuals alone tell of it.

    References
    ----------
    Powers by MINQUE (Rao 1971) kept positive; ``I^-1 (sum P_b M_b) I^-1``, its freedom by Satterthwaite 1946.
    """
    count, dims, shared = influence.design.shape
    square = np.sum(cosine_transform(influence.whitened) ** 2, axis=1)
    design = cosine_transform(influence.design)
    starts = band_starts(influence.angles)
    # One product a band: a product a frequency would need as much memory as all frames' information matrices.
    information = np.stack([np.tensordot(d, d, axes=((0, 1), (0, 1))) for d in np.split(design, starts[1:])])
    power_sum, number = band_sums(square, starts), dims * np.diff(np.append(starts, count)).astype(np.float64)
    information, power_sum, number = _merged(information, power_sum, number, influence.inverse)
    hat = influence.inverse @ information
    leverage = np.trace(hat, axis1=1, axis2=2)
    freedom = np.maximum(number - leverage, 1.0)
    expected = np.diag(number - 2.0 * leverage) + np.einsum("bpr,crp->bc", hat, hat)
    variance = influence.variance
    usual = 1.0 / np.maximum(power_sum, np.finfo(np.float64).tiny)
    power = _not_negative(expected * usual[:, None], power_sum * usual) if power_sum.any() else np.zeros(len(number))
    relative = np.maximum(power / variance, 1e-3) if variance > 0.0 else np.ones(len(number))
    statistic = float(freedom @ (relative - 1.0 - np.log(relative)))
    flat = len(number) < 2 or bool(chdtrc(len(number) - 1, statistic) > _SURELY_NOT_FLAT)
    part = power[:, None, None] * (hat @ influence.inverse)
    least = 1.0 if noise_known else 0.0
    white_freedom = np.inf if noise_known else float(max(count * dims - shared, 1))
    return ResidualSpectrum(
        flat=flat,
        variance=variance,
        white=Mixture.of_one(influence.inverse * max(variance if flat else least, least), white_freedom),
        colored=None if flat else Mixture.of_one(part.sum(axis=0)),
        part=part,
        part_freedom=freedom,
    )


def _merged(information: Float, power: Float, number: Float, inverse: Float) -> tuple[Float, Float, Float]:
    """Join bands, from the lowest on, until each has the degrees of freedom that a power takes."""
    while len(number) > 1:
        left = number - np.einsum("pq,bqp->b", inverse, information)
        few = np.flatnonzero(left < _LEAST_FREEDOM)
        if not few.size:
            break
        keep = np.ones(len(number), dtype=bool)
        keep[min(int(few[0]) + 1, len(number) - 1)] = False
        starts = np.flatnonzero(keep)
        information, power, number = (np.add.reduceat(values, starts) for values in (information, power, number))
    return information, power, number


def _not_negative(matrix: Float, target: Float) -> Float:
    """Least squares with no negative result; the library for it is loaded only where plain least squares gives one."""
    plain, _, rank, _ = np.linalg.lstsq(matrix, target, rcond=None)
    if rank == matrix.shape[1] and (plain >= 0.0).all():
        return np.asarray(plain, dtype=np.float64)
    from scipy.optimize import nnls

    return np.asarray(nnls(matrix, target)[0], dtype=np.float64)
