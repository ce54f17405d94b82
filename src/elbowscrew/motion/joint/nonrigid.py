"""Covariance of a fit from the markers' motion within their cluster (method A).

Six of a cluster's 3 M coordinates are its pose; the other ``nu = 3 M - 6`` no pose can follow. What they do is seen,
and each coordinate of the pose is taken to err by as much and with the same pattern in time and angle. The covariance
that follows is unbiased for any correlation, skin that goes with the flexion included, without a bandwidth or a kernel.
"""

from __future__ import annotations

from typing import Final, Literal

import numpy as np
from scipy.special import gammaln

from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.motion.joint.influence import Influence
from elbowscrew.motion.joint.spectrum import band_starts, band_sums, cosine_transform
from elbowscrew.motion.joint.tails import Mixture
from elbowscrew.motion.screws.pose_noise import covariance_from_markers

Segment = Literal["proximal", "distal"]

# Degrees of freedom that the stationary model may be worth beside the nu that are measured: nearly none where the
# noise goes with the angle, which the evidence tells, and where it is not white and may go with the angle unseen.
_WORTH: Final = np.array([0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 1e3, 1e4, 1e5])
_WORTH_IF_COLORED: Final = 0.5
_LEAST_KNOWN: Final = 0.5
_ANGLE_BINS: Final = 15
_PAIR_BINS: Final = 5  # of each of two angles
_ALIKE: Final = 3.0
_RANK: Final = 1e-6
_LEAST_POWER: Final = 1e-12
# Mean square of the markers' distances over the variance of each coordinate of the pose: 3 M - 6, so 3 or 6 and more.
_OF_THREE_OR_FOUR: Final = 4.5
_UNLIKELY: Final = 1e-9  # beside the likeliest


def nonrigid_covariance(
    influence: Influence, shape: Float, nonrigid: Float, *, segment: Segment, own_shape: bool = False
) -> Mixture | None:
    """Covariance of the shared numbers by one body's markers.

    Parameters
    ----------
    influence : Influence
    shape : ndarray, shape (M, 3)
        The markers in the body's frame.
    nonrigid : ndarray, shape (F, nu)
        `nonrigid_coordinates` of the frames fitted.
    segment : {"proximal", "distal"}
        Which of the two bodies it is.
    own_shape : bool
        Whether the cluster's shape is the trial's own mean, so that a constant misfit is not seen.

    Returns
    -------
    Mixture or None
        None if in most frames the markers are not all seen.

    References
    ----------
    ``(nu0 S_model + nu S_emp) / (nu0 + nu)``: ``S_emp = (1/nu) sum_j sum_a d_ja d_ja^T`` with ``d_ja = sum_t Psi_t
    L[:, a] z_j(t)``; S_model is that of stationary noise of z's spectrum, and nu0 is averaged by its evidence.
    """
    z = _without_holes(nonrigid)
    if z is None or not influence.determined:
        return None
    if own_shape:
        z = z - z.mean(axis=0)
    nu = z.shape[1]
    psi = _of_rigid_coordinates(influence, shape, segment)
    moved = np.tensordot(z, psi, axes=(0, 0))  # (nu, P, 6)
    measured = np.einsum("jpa,jqa->pq", moved, moved) / nu
    model = _Stationary(z, influence.angles, own_shape=own_shape)
    expected = model.covariance(psi)
    worth, weight = _worth_of_model(z, influence.angles, model, own_shape=own_shape)
    covariance = (worth[:, None, None] * expected + nu * measured) / (worth + nu)[:, None, None]
    # A spectrum that is not flat adds no degrees of freedom: it is estimated itself, from noise that may be no such.
    return Mixture(covariance, nu + (worth if model.flat >= 0.5 else np.zeros_like(worth)), weight)


def residual_covariance(
    influence: Influence, shape: Float, rms: Float, *, segment: Segment, pose_variance: float | None = None
) -> Mixture | None:
    """As `nonrigid_covariance`, where nothing is kept of a frame but the RMS distance of its markers.

    Parameters
    ----------
    influence : Influence
    shape : ndarray, shape (M, 3)
    rms : ndarray, shape (F,)
        Of the markers about the rigid body.
    segment : {"proximal", "distal"}
    pose_variance : float, optional
        Of each coordinate of the body's position as it jitters, square meters, where the markers' number is not known
        (`cluster_like`): three, if their distances are no larger beside it, else four, which is the less certain.

    References
    ----------
    The mean square in bins of the angle: its lowest is white noise, and the root of what a bin has more is one series
    that goes with the angle, with another sign on each side of the lowest. Bins that differ by no more than chance are
    all white.
    """
    nu = 3 * len(shape) - 6
    known = np.isfinite(rms)
    if nu < 1 or not influence.determined or np.mean(known) < _LEAST_KNOWN:
        return None
    bins, count = _bins_of(influence.angles)
    number = np.bincount(bins[known], minlength=count)
    used = number > 0
    mean = np.bincount(bins[known], rms[known] ** 2, count) / np.maximum(number, 1)
    if pose_variance is not None and mean[used].min() < _OF_THREE_OR_FOUR * pose_variance:
        nu = 3
    mean = len(shape) / nu * mean
    whole = float(number @ mean / number.sum())
    chance = whole * np.sqrt(2.0 / (nu * np.maximum(number, 1)))
    alike = bool((np.abs(mean - whole) <= _ALIKE * chance)[used].all())
    lowest = whole if alike else float(mean[used].min())
    psi = _of_rigid_coordinates(influence, shape, segment)
    covariance = lowest * np.tensordot(psi, psi, axes=((0, 2), (0, 2)))
    if alike:
        return Mixture.of_one(covariance, float(nu * known.sum()))
    # A least inside the range is where a motion that goes on and on passes the shape that distances are from.
    first = np.arange(count) if influence.second is None else np.arange(count) // _PAIR_BINS
    away = np.where(first < first[int(np.argmin(np.where(used, mean, np.inf)))], -1.0, 1.0)
    moved = np.tensordot((away * np.sqrt(np.maximum(mean - lowest, 0.0)))[bins], psi, axes=(0, 0))
    return Mixture.of_one(covariance + moved @ moved.T, float(nu))


def cluster_like(covariance: Float) -> Float:
    """Four markers (4, 3) that make of errors such turns and shifts as the covariance (6, 6) of a pose has.

    Corners of a box along the principal axes of the turns; where no markers make such turns, the nearest that can.
    """
    values, axes = np.linalg.eigh(covariance[:3, :3])
    inertia = 4.0 / 3.0 * float(np.trace(covariance[3:, 3:])) / values
    half = np.sqrt(np.maximum(0.5 * inertia.sum() - inertia, 0.0) / 4.0)
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    return np.asarray((corners * half) @ axes.T, dtype=np.float64)


class _Stationary:
    """Spectrum of the non-rigid coordinates, in bands or flat, each weighed by its BIC."""

    def __init__(self, z: Float, angle: Float, *, own_shape: bool) -> None:
        count, nu = z.shape
        square = np.sum(cosine_transform(z) ** 2, axis=1)
        starts = band_starts(angle)
        width = np.diff(np.append(starts, count))
        number = nu * width.astype(np.float64)
        if own_shape:  # the mean is not there
            number[0] = max(number[0] - nu, 1.0)
        power = np.maximum(band_sums(square, starts) / number, np.finfo(np.float64).tiny)
        total = number.sum()
        mean = float(number @ power / total)
        gain = 0.5 * (total * np.log(mean) - number @ np.log(power))
        cost = 0.5 * (len(number) - 1) * np.log(total)
        self.flat = float(1.0 / (1.0 + np.exp(np.clip(gain - cost, -700.0, 700.0))))
        self.power = self.flat * mean + (1.0 - self.flat) * np.repeat(power, width)

    def covariance(self, psi: Float) -> Float:
        """Covariance (P, P) under noise of this spectrum."""
        series = cosine_transform(psi)
        weighted = self.power[:, None, None] * series
        return np.asarray(np.tensordot(weighted, series, axes=((0, 2), (0, 2))))


def _worth_of_model(z: Float, angle: Float, model: _Stationary, *, own_shape: bool) -> tuple[Float, Float]:
    """Degrees of freedom that the stationary model may be worth, and the probability of each.

    Noise that goes with the angle has more on the angle's own functions than a stationary noise could: their covariance
    is drawn from an inverse Wishart distribution about the model's, the tighter the more the model is worth.
    """
    nu = z.shape[1]
    about = angle - angle.mean(axis=0)
    waves = np.concatenate([np.ones((len(angle), 1)), np.cos(about), np.sin(about), about], axis=1)
    if own_shape:
        waves = waves[:, 1:] - waves[:, 1:].mean(axis=0)
    basis, size, _ = np.linalg.svd(waves, full_matrices=False)
    basis = basis[:, size > _RANK * size[0]][:, :3]
    rank = basis.shape[1]
    series = cosine_transform(basis)
    # Of a cluster at rest to the last digit there is no spectrum, and of a filtered one nothing at high frequencies.
    scale = float(model.power.max())
    power = np.maximum(model.power / scale, _LEAST_POWER)
    expected = series.T @ (power[:, None] * series)
    relative = np.linalg.solve(np.linalg.cholesky(expected), basis.T @ (z / np.sqrt(scale)))
    square = relative @ relative.T
    worth = _WORTH if model.flat >= 0.5 else _WORTH[_WORTH <= _WORTH_IF_COLORED]
    prior = 0.5 * (worth + rank + 1.0)
    less = 0.5 * np.arange(rank)[:, None]
    evidence = (
        np.sum(gammaln(prior + 0.5 * nu - less) - gammaln(prior - less), axis=0)
        + prior * rank * np.log(worth)
        - (prior + 0.5 * nu) * np.sum(np.log(worth + np.linalg.eigvalsh(square)[:, None]), axis=0)
    )
    weight = np.exp(evidence - evidence.max())
    likely = weight > _UNLIKELY
    return worth[likely], weight[likely] / weight[likely].sum()


def _bins_of(angles: Float) -> tuple[Index, int]:
    """Bin of each frame by its angles (F, A), and how many bins there are."""
    parts = _ANGLE_BINS if angles.shape[1] == 1 else _PAIR_BINS
    bins = np.zeros(len(angles), dtype=np.int64)
    for angle in angles.T:
        span = float(np.ptp(angle))
        share = (angle - angle.min()) / (span if span > 0.0 else 1.0)
        bins = parts * bins + np.minimum((parts * share).astype(np.int64), parts - 1)
    return bins, parts ** angles.shape[1]


def _of_rigid_coordinates(influence: Influence, shape: Float, segment: Segment) -> Float:
    """Influence (F, P, 6) of a cluster's six rigid coordinates, each as large as a coordinate of a marker."""
    root = np.linalg.cholesky(covariance_from_markers(shape, 1.0))
    return (influence.of_distal if segment == "distal" else influence.of_proximal) @ root


def _without_holes(nonrigid: Float) -> Float | None:
    """Frames whose markers are not all seen, from their neighbors in time."""
    known = np.isfinite(nonrigid).all(axis=1)
    if nonrigid.shape[1] < 1 or np.mean(known) < _LEAST_KNOWN:
        return None
    if known.all():
        return nonrigid
    rows = np.arange(len(nonrigid))
    seen = np.flatnonzero(known)
    return np.stack([np.interp(rows, seen, column) for column in nonrigid[seen].T], axis=1)
