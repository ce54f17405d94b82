"""How screw parameters follow small errors of the displacement they are taken from."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry._small_angle import divide
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.screw import screw_from_dual_quat

_RATIOS: Final = 129
_SECTORS: Final = 720
_BISECTIONS: Final = 60


NORMAL_95: Final = 1.959964
"""Standard deviations of a normal distribution within which 95 % lie."""


class ScrewSensitivity(NamedTuple):
    """Derivatives of screw parameters by a small twist ``rho + eps tau`` applied after the displacement.

    Attributes
    ----------
    angle, slide : ndarray, shape (..., 6)
        Of the rotation (rad) and of the slide (length).
    direction : ndarray, shape (..., 3, 6)
        Of the axis' unit vector.
    point : ndarray, shape (..., 3, 6)
        Of the axis' position: how far it moves across itself at the point nearest the origin.
    """

    angle: Float
    slide: Float
    direction: Float
    point: Float


def screw_sensitivity(dual_quat: ArrayLike) -> ScrewSensitivity:
    """Differentiate the screw of a displacement ``exp((rho + eps tau) / 2) Q`` at zero twist.

    By the principle of transference the dual angle changes by ``N . eta`` and the line by
    ``(cot(Theta/2) (eta - N (N . eta)) + eta x N) / 2``, the formulas of a rotation with dual numbers in them.

    Parameters
    ----------
    dual_quat : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ScrewSensitivity
        NaN without rotation, where there is no axis.

    References
    ----------
    P 45; Woltring, Huiskes, de Lange and Veldpaus 1985, Journal of Biomechanics 18, for the rotation's part.

    Examples
    --------
    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> quarter = dual_quat_from_screw(np.pi / 2, 0.0, [0, 0, 1], [0, 0, 0])
    >>> screw_sensitivity(quarter).angle
    array([0., 0., 1., 0., 0., 0.])
    """
    screw = screw_from_dual_quat(dual_quat)
    n, m = screw.direction, screw.moment
    half_sine, half_cosine = np.sin(0.5 * screw.angle), np.cos(0.5 * screw.angle)
    cotangent = divide(half_cosine, half_sine)[..., None, None]
    slope = divide(-0.5 * screw.slide, half_sine**2)[..., None, None]
    zero = np.zeros(n.shape)
    angle = np.concatenate([n, zero], axis=-1)
    slide = np.concatenate([m, n], axis=-1)
    rho = np.concatenate([np.eye(3), np.zeros((3, 3))], axis=1)
    tau = np.concatenate([np.zeros((3, 3)), np.eye(3)], axis=1)
    across = rho - n[..., :, None] * angle[..., None, :]
    across_dual = tau - n[..., :, None] * slide[..., None, :] - m[..., :, None] * angle[..., None, :]
    cross_n, cross_m = cross_matrix(n), cross_matrix(m)  # eta x N = -N x eta
    direction = 0.5 * (cotangent * across - cross_n @ rho)
    moment = 0.5 * (cotangent * across_dual + slope * across - cross_m @ rho - cross_n @ tau)
    point = cross_n @ moment - cross_m @ direction
    point = point - n[..., :, None] * (n[..., None, :] @ point)
    return ScrewSensitivity(angle, slide, direction, point)


def confidence_radius(covariance: ArrayLike) -> Float:
    """Radius of the circle about the mean that holds 95 % of a normal vector in a plane.

    Parameters
    ----------
    covariance : array_like, shape (..., k, k)
        Of rank 2 at most: of a unit vector's error, or of a position across a line.

    Returns
    -------
    ndarray, shape (...)
        ``1.731 sqrt(trace)`` for equal variances, ``1.960 sqrt(trace)`` if there is but one.

    References
    ----------
    The probability of a circle is integrated over the polar angle of the standardized vector.

    Examples
    --------
    >>> confidence_radius([np.eye(2), np.diag([1.0, 0.0])]).round(3)
    array([2.448, 1.96 ])
    """
    C = np.asarray(covariance, dtype=np.float64)
    trace = np.trace(C, axis1=-2, axis2=-1)
    # The two eigenvalues of a matrix of rank 2 add up to the trace and their squares to that of the square.
    product = np.maximum(0.5 * (trace**2 - np.sum(C * np.swapaxes(C, -1, -2), axis=(-1, -2))), 0.0)
    spread = np.sqrt(np.maximum(trace**2 - 4.0 * product, 0.0))
    ratio = divide(trace - spread, trace + spread)
    shares, factors = _circle_factors()
    known = np.isfinite(ratio)
    factor = np.where(known, np.interp(np.where(known, ratio, 0.0), shares, factors), np.nan)
    return np.where(trace == 0.0, 0.0, factor * np.sqrt(np.maximum(trace, 0.0)))


@lru_cache(maxsize=1)
def _circle_factors() -> tuple[Float, Float]:
    """Ratios of two variances, and the radius of 95 % in units of the root of their sum."""
    ratio = np.linspace(0.0, 1.0, _RATIOS) ** 2
    middle = (np.arange(_SECTORS) + 0.5) * (0.5 * np.pi / _SECTORS)
    variance = (np.cos(middle) ** 2 + ratio[:, None] * np.sin(middle) ** 2) / (1.0 + ratio[:, None])
    low, high = np.full(_RATIOS, 1.0), np.full(_RATIOS, 3.0)
    for _ in range(_BISECTIONS):
        radius = 0.5 * (low + high)
        inside = 1.0 - np.exp(-0.5 * radius[:, None] ** 2 / variance).mean(axis=1)
        low, high = np.where(inside < 0.95, radius, low), np.where(inside < 0.95, high, radius)
    return ratio, 0.5 * (low + high)


def cross_matrix(vector: Float) -> Float:
    """Give the matrices of cross products.

    Parameters
    ----------
    vector : ndarray, shape (..., 3)

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Skew-symmetric; ``cross_matrix(v) @ w`` is ``v x w``, in the units of `vector`.

    References
    ----------
    The mapping from a vector to its skew-symmetric matrix, as in any textbook of kinematics.

    Examples
    --------
    >>> cross_matrix(np.array([1.0, 2.0, 3.0])) @ [0.0, 0.0, 1.0]
    array([ 2., -1.,  0.])
    """
    x, y, z = (vector[..., k] for k in range(3))
    zero = np.zeros(x.shape)
    rows = [np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)]
    return np.stack(rows, axis=-2)
