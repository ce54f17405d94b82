"""How far a fitted joint may be from the truth: markers, residuals and blocks together, and what the user states.

No method sees everything. The markers' own motion (A) sees skin that goes with the flexion, the residuals' spectrum (B)
a cluster that moves as a whole at random, blocks (J) what is neither: the radius is the largest of them. A cluster that
moves as a whole with the flexion no single trial shows; the user states it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.sensitivity import NORMAL_95, confidence_radius
from elbowscrew.motion.joint.blocks import block_jackknife
from elbowscrew.motion.joint.influence import Influence
from elbowscrew.motion.joint.nonrigid import Segment, nonrigid_covariance, residual_covariance
from elbowscrew.motion.joint.spectrum import ResidualSpectrum, residual_spectrum
from elbowscrew.motion.joint.tails import Mixture

Method = Literal["A", "B", "J"]

LEVEL: Final = 0.95
SURE: Final = 0.9973
"""Probability of three standard deviations: beyond its radius an effect is reported."""

_BEYOND_NOISE: Final = 2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClusterMotion:
    """What is known of a cluster's markers in the frames fitted.

    Attributes
    ----------
    segment : {"proximal", "distal"}
    shape : ndarray, shape (M, 3)
        The markers in the body's frame.
    nonrigid : ndarray, shape (F, 3 M - 6), optional
        `nonrigid_coordinates`.
    rms : ndarray, shape (F,), optional
        RMS distance of the markers, where no more is kept.
    own_shape : bool
        Whether the shape is the trial's own mean.
    pose_variance : float, optional
        As `residual_covariance` wants it, where the shape stands for markers that are not known.
    """

    segment: Segment
    shape: Float
    nonrigid: Float | None = None
    rms: Float | None = None
    own_shape: bool = False
    pose_variance: float | None = None

    def at(self, rows: Index) -> ClusterMotion:
        """Of some of the frames."""
        nonrigid, rms = (None if part is None else part[rows] for part in (self.nonrigid, self.rms))
        return replace(self, nonrigid=nonrigid, rms=rms)

    def covariance(self, influence: Influence) -> Mixture | None:
        """Covariance of the shared numbers by these markers; None where they do not tell."""
        if self.nonrigid is not None:
            found = nonrigid_covariance(
                influence, self.shape, self.nonrigid, segment=self.segment, own_shape=self.own_shape
            )
            if found is not None:
                return found
        if self.rms is None:
            return None
        return residual_covariance(
            influence, self.shape, self.rms, segment=self.segment, pose_variance=self.pose_variance
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SkinMotion:
    """How a cluster is stated to move as a whole on its bone, at the largest angle, RMS in space.

    Attributes
    ----------
    segment : {"proximal", "distal"}
    shift : float
        Meters.
    turn : float
        Radians.
    """

    segment: Segment
    shift: float
    turn: float = 0.0


class Spread(NamedTuple):
    """Covariances (M, P, P) by each method, in which its radii are 1.96 standard deviations, and that of the skin.

    Of the fit first, then of each place nearby.
    """

    each: tuple[Float, ...]
    skin: Float

    def deviations(self, rows: Float) -> Float:
        """Standard deviation of each number ``rows @ x``, rows (..., P); 1.96 of them hold 95 % of its errors."""
        squares = [np.max([np.sum((rows @ one) * rows, axis=-1) for one in methods], axis=0) for methods in self.each]
        return np.asarray(np.sqrt(np.mean(squares, axis=0) + np.sum((rows @ self.skin) * rows, axis=-1)))


class Nearby(NamedTuple):
    """The interval that a joint would have if its shared numbers were others, as near as the fit's own errors.

    Attributes
    ----------
    interval : JointInterval
    back : ndarray, shape (P, P)
        Small changes of the fit's numbers by small changes of those.
    """

    interval: JointInterval
    back: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JointInterval:
    """Radii that hold the errors of a fitted joint's shared numbers.

    Attributes
    ----------
    markers : Mixture or None
        Of all bodies that have markers (A); None if one that moves has none.
    residuals : ResidualSpectrum or None
        B; None where the frames do not determine the joint.
    blocks : Mixture or None
        J, where the residuals ask for it.
    skin : ndarray, shape (P, P), or None
        Covariance by the stated skin motion.
    told : tuple of int or None
        Which of the joint's numbers these P are; of the others nothing is known, and they have no part in a radius.
    nearby : tuple of Nearby
        What it would be at its own ends, where a fit that is linear in its errors does not reach that far: a radius is
        the root mean square of the one here and those there.
    """

    markers: Mixture | None
    residuals: ResidualSpectrum | None
    blocks: Mixture | None
    skin: Float | None
    told: tuple[int, ...] | None = None
    nearby: tuple[Nearby, ...] = ()

    def of_first(self, count: int) -> JointInterval:
        """Of the first numbers alone, whatever the others are, where all are told."""
        if self.residuals is None:
            return self
        kept = np.eye(self.residuals.part.shape[-1])[:count]
        return JointInterval(
            markers=None if self.markers is None else self.markers.of(kept),
            residuals=self.residuals.of(kept),
            blocks=None if self.blocks is None else self.blocks.of(kept),
            skin=None if self.skin is None else kept @ self.skin @ kept.T,
        )

    def _of_told(self, rows: Float) -> Float:
        return rows if self.told is None else rows[..., list(self.told)]

    def radii(self, rows: Float, level: float = LEVEL) -> dict[Method, float]:
        """Radius of ``rows @ x``, rows of all numbers, by each method that is used; skin comes on top."""
        here = self._radii_here(rows, level)
        largest = max(here.values(), default=0.0)
        if not self.nearby or not largest > 0.0:
            return here
        there = [max(one.interval.radii(rows @ one.back, level).values(), default=np.nan) for one in self.nearby]
        wider = float(np.sqrt(np.mean(np.square([largest, *there])))) / largest
        return {method: wider * radius for method, radius in here.items()}

    def _radii_here(self, rows: Float, level: float) -> dict[Method, float]:
        if self.residuals is None:
            return {}
        rows = self._of_told(rows)
        found: dict[Method, float] = {"B": self.residuals.radius(rows, level)}
        if self.markers is not None:
            found["A"] = self.markers.of(rows).radius(level)
        if self.blocks is not None:
            found["J"] = self.blocks.of(rows).radius(level)
        return found

    def skin_radius(self, rows: Float, level: float = LEVEL) -> float:
        """Part of the stated skin motion in the radius."""
        rows = self._of_told(rows)
        return 0.0 if self.skin is None else Mixture.of_one(rows @ self.skin @ rows.T).radius(level)

    def radius(self, rows: Float, level: float = LEVEL) -> float:
        """Radius that holds the error of ``rows @ x``; NaN where the frames do not determine the joint."""
        return self.radius_by(rows, level)[0]

    def radius_by(self, rows: Float, level: float = LEVEL) -> tuple[float, Method | None]:
        """Radius, and which method gave it."""
        found = self.radii(rows, level)
        if not found:
            return float("nan"), None
        method, largest = max(found.items(), key=lambda item: item[1])
        return float(np.hypot(largest, self.skin_radius(rows, level))), method

    def spread(self, rows: Float) -> Spread:
        """What gives the deviations of many numbers at once, its factors being those of some rows (N, P) of them."""
        size = rows.shape[1]
        skin = np.zeros((size, size)) if self.skin is None else self._of_all(self.skin, size)
        there = [one.back @ one.interval._spread_here(rows @ one.back) @ one.back.T for one in self.nearby]
        return Spread((self._spread_here(rows), *there), skin)

    def _spread_here(self, rows: Float) -> Float:
        size = rows.shape[1]
        if self.residuals is None:
            return np.full((1, size, size), np.nan)
        parts: list[tuple[Method, Mixture | None]] = [
            ("A", self.markers),
            ("B", self.residuals.white),
            ("B", self.residuals.colored),
            ("J", self.blocks),
        ]
        radii = [self._radii_here(row[None], LEVEL) for row in rows]
        scaled = []
        for name, mixture in parts:
            if mixture is None:
                continue
            covariance = self._of_all(mixture.mean, size)
            square = np.einsum("np,pq,nq->n", rows, covariance, rows)
            factors = [one[name] ** 2 / part for one, part in zip(radii, square, strict=True) if part > 0.0]
            scaled.append(max(factors, default=0.0) / NORMAL_95**2 * covariance)
        return np.stack(scaled)

    def _of_all(self, covariance: Float, count: int) -> Float:
        if self.told is None:
            return covariance
        found = np.zeros((count, count))
        found[np.ix_(self.told, self.told)] = covariance
        return found

    def decided_by(self, rows: Float) -> Method | None:
        """Which method gave the radius."""
        return self.radius_by(rows)[1]


def joint_interval(
    influence: Influence,
    clusters: tuple[ClusterMotion, ...],
    *,
    skin: tuple[SkinMotion, ...] = (),
    reference_angle: float | None = None,
    reference_second: float | None = None,
    noise_known: bool = True,
) -> JointInterval:
    """Find how far a fitted joint may be from the truth.

    Parameters
    ----------
    influence : Influence
    clusters : tuple of ClusterMotion
        Of the bodies that move; those without markers are left out.
    skin : tuple of SkinMotion
        Each body's, as the user states it.
    reference_angle, reference_second : float, optional
        Where the clusters are taken to sit right, radians; the first frame's if not told.
    noise_known : bool
        Whether the poses' noise is stated; else the residuals alone tell of it.
    """
    if not influence.determined:
        return JointInterval(markers=None, residuals=None, blocks=None, skin=None, told=influence.told)
    markers: Mixture | None = None
    for cluster in clusters:
        found = cluster.covariance(influence)
        if found is not None:
            markers = found if markers is None else markers.plus(found)
    residuals = residual_spectrum(influence, noise_known=noise_known)
    # Twice the markers' noise, or less than half of it: then it is not theirs that the residuals are made of.
    of_markers = markers is not None and 1.0 / _BEYOND_NOISE <= residuals.variance <= _BEYOND_NOISE
    asked = not residuals.flat and not of_markers
    return JointInterval(
        markers=markers,
        residuals=residuals,
        blocks=block_jackknife(influence) if asked else None,
        skin=skin_covariance(influence, skin, reference_angle, reference_second) if skin else None,
        told=influence.told,
    )


def skin_covariance(
    influence: Influence,
    skin: tuple[SkinMotion, ...],
    reference_angle: float | None = None,
    reference_second: float | None = None,
) -> Float:
    """Covariance (P, P) by clusters that move as a whole with the angle, at the worst of some courses.

    References
    ----------
    ``D diag(r^2/3, s^2/3) D^T`` with ``D = sum_t f_t Psi_t``; the worst is the largest in units of the noise's own.
    """
    courses: list[Float] = []
    for angle, start in zip(influence.angles.T, (reference_angle, reference_second), strict=False):
        off = angle - (float(angle[0]) if start is None else start)
        largest = float(np.abs(off).max())
        signed = off / (largest if largest > 0.0 else 1.0)
        u = np.abs(signed)
        courses += [u, np.sin(0.5 * np.pi * u), u**2, np.sin(np.pi * u), signed]
    worst = np.zeros_like(influence.inverse)
    for course in courses:
        total = np.zeros_like(worst)
        for part in skin:
            psi = influence.of_distal if part.segment == "distal" else influence.of_proximal
            moved = np.tensordot(course, psi, axes=1)
            total += moved @ np.diag([part.turn**2 / 3.0] * 3 + [part.shift**2 / 3.0] * 3) @ moved.T
        if influence.size(total) > influence.size(worst):
            worst = total
    return worst


def skin_sensitivity(angle: Float, weight: Float | None = None) -> float:
    """Degrees that a hinge's axis turns for each degree that a cluster turns on its bone with the flexion.

    Parameters
    ----------
    angle : ndarray, shape (F,)
        Of the frames, radians.
    weight : ndarray, shape (F,), optional

    Returns
    -------
    float
        About 1 over the range in radians, however many cycles there are; NaN without motion.

    References
    ----------
    ``|cov(f, exp(i theta))| / (1 - |mean exp(i theta)|^2)`` of ``f = sin(theta/2)`` from 0 to 1.
    """
    share = np.full(len(angle), 1.0 / len(angle)) if weight is None else weight / weight.sum()
    off = angle - angle.min()
    course = np.sin(0.5 * np.minimum(off, np.pi))
    if not course.max() > 0.0:
        return float("nan")
    course = course / course.max()
    turned = np.exp(1j * angle)
    spread = 1.0 - abs(share @ turned) ** 2
    return float(abs(share @ ((course - share @ course) * turned)) / spread)


def pose_radii(covariance: Float, direction: Float, point: Float) -> tuple[float, float]:
    """Radii by which the pose of a body carries a line that is fixed in it, added in quadrature for another frame.

    Parameters
    ----------
    covariance : ndarray, shape (6, 6)
        Of the body's pose, in its own frame.
    direction, point : ndarray, shape (3,)
        The line in the body.

    Returns
    -------
    tuple of float
        Of the direction (rad) and of the position across it (m), 95 %.
    """
    across = np.linalg.svd(direction[None])[2][1:]
    turn, shift = _cross(direction), np.concatenate([_cross(point), np.eye(3)], axis=1)
    tilted = across @ turn
    moved = across @ shift
    return (
        float(confidence_radius(tilted @ covariance[:3, :3] @ tilted.T)),
        float(confidence_radius(moved @ covariance @ moved.T)),
    )


def _cross(vector: Float) -> Float:
    """Matrix of ``rho -> rho x vector``."""
    return np.cross(np.eye(3), vector).T
