"""How noisy the poses of a body are, and where that is known from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.choices import NOISE_SOURCES, functions_named
from elbowscrew.errors import SettingError
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import align_signs, conjugate, log, multiply, normalize
from elbowscrew.model import PoseNoise, RigidBody
from elbowscrew.motion.difference import DEFAULT_RADIUS
from elbowscrew.motion.screws.jitter import jitter_covariance
from elbowscrew.settings import Settings

# A mean distance in space is this much less than the RMS one, for a normal error.
_MEAN_TO_RMS: Final = float(np.sqrt(8.0 / (3.0 * np.pi)))
STILL_STRETCH: Final = "still stretch"
"""Name of the source that tells of jitter only."""

_ASSUMED_MARKERS: Final = 4
_FEWEST_MARKERS: Final = 3
_STILL_S: Final = 0.5
_FEWEST_STILL_FRAMES: Final = 20
_LARGEST_DRIFT: Final = 3.0
_STILL_NOISE_M: Final = 0.001
_NO_JITTER_M: Final = 1e-9  # what does not change or err at all, but for the rounding of sums
_LARGEST_ERROR_M: Final = 1.0
_MOST_FRAMES: Final = 20_000
_LEAST_SHOWN: Final = 0.01
_IDENTITY: Final = np.eye(8)[0]
# Without a stated noise: a common cluster's, whose rotation and translation only have to be weighed against each other.
_COMMON_NOISE: Final = np.diag([6e-6] * 3 + [1e-8] * 3)
# Exports have six decimals: where some coordinate repeats in all of them its noise is that of the rounding, not none.
_ROUNDING_SD: Final = np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]) * 1e-6 / np.sqrt(12.0)
MARKERS_ASSUMED: Final = ", markers assumed"
"""How the name of a source ends that tells of the markers' errors, not of their number and places."""
BY_JITTER: Final = ", shared out as the poses jitter"
"""How it ends where the poses themselves tell what markers, not known, make of their errors."""

_STANDS_STILL: Final = PoseNoise(covariance=np.zeros((6, 6)), source="stands still", marker_noise=None)


def pose_noise(body: RigidBody, rate_hz: float, settings: Settings) -> PoseNoise | None:
    """Noise of a body's poses, from the source that the settings name, or from the first there is.

    Parameters
    ----------
    body : RigidBody
        Its tracked poses are looked at.
    rate_hz : float
    settings : Settings
        ``marker_noise_mm`` is the user's word and the strongest; else ``noise`` says the source. By itself it is the
        residuals of the markers, then the error column of the file, then a still stretch of the take, which tells of
        jitter only (``docs/explanation/joint-axis.md``).

    Returns
    -------
    PoseNoise or None
        None if there is no source.

    Raises
    ------
    SettingError
        If noise of markers is stated of a body without positions.
    """
    if settings.marker_noise_mm is not None and not body.located:
        msg = (
            f"--marker-noise: body {body.name!r} has orientations and no positions, and so no markers; leave it out: "
            "residuals and stillness tell of the noise"
        )
        raise SettingError(msg)
    if settings.marker_noise_mm is not None:
        return _from_marker_noise(body, settings.marker_noise_mm / 1000.0, "option", settings)
    for name in NOISE_SOURCES:
        found = SOURCES[name](body, rate_hz, settings) if settings.noise in ("auto", name) else None
        if found is not None:
            return found
    return None


class JointNoise(NamedTuple):
    """Noise of the two bodies' poses, and how much of it they show.

    Attributes
    ----------
    proximal, distal : PoseNoise or None
        As far as the body shows it; None where it is not known.
    proximal_share, distal_share : float
        0 of a body that stands still to the last digit, or is none, 1 of one whose poses vary by at least half of the
        noise's variance. What does not change in the trial is no error of the joint.
    proximal_shape, distal_shape : ndarray, shape (6, 6)
        What counts of an unknown noise, only as to its shape: how the poses jitter, or a common cluster's noise.
    """

    proximal: PoseNoise | None
    distal: PoseNoise | None
    proximal_share: float
    distal_share: float
    proximal_shape: Float = _COMMON_NOISE
    distal_shape: Float = _COMMON_NOISE

    @classmethod
    def of(cls, proximal: RigidBody | None, distal: RigidBody, rate_hz: float, settings: Settings) -> JointNoise:
        """Find the noise of both; a proximal body that stands still has none."""
        bodies = (distal,) if proximal is None else (proximal, distal)
        noises = [pose_noise(body, rate_hz, settings) for body in bodies]
        # One that is known has nothing to be weighed against where the other is not.
        known = [noise.covariance for noise in noises if noise is not None]
        all_known = len(known) == len(bodies)
        shapes = [_COMMON_NOISE] * len(bodies) if all_known else _shapes(bodies)
        sizes = known if all_known else shapes
        shares = [_share_shown(body, size) for body, size in zip(bodies, sizes, strict=True)]
        shown = [_as_shown(noise, share) for noise, share in zip(noises, shares, strict=True)]
        if proximal is None:
            shown, shares, shapes = [None, *shown], [0.0, *shares], [_COMMON_NOISE, *shapes]
        return cls(shown[0], shown[1], shares[0], shares[1], shapes[0], shapes[1])

    @property
    def moving(self) -> tuple[bool, bool]:
        """Whether the proximal and the distal body show more than a tenth of the noise's standard deviation."""
        return self.proximal_share > _LEAST_SHOWN, self.distal_share > _LEAST_SHOWN

    @property
    def known(self) -> tuple[PoseNoise | None, PoseNoise] | None:
        """Both, the proximal body's None if it stands still; None if that of a body that moves is not known.

        A body that stands still needs no source: it has no noise, as none has where there is no such body.
        """
        first, second = self.moving
        if (first and self.proximal is None) or (self.distal is None and (second or self.proximal is None)):
            return None
        return self.proximal, _STANDS_STILL if self.distal is None else self.distal

    @property
    def assumed(self) -> tuple[PoseNoise | None, PoseNoise]:
        """Both as known, else as the poses jitter or as a common cluster's, which only the shape counts of."""
        first, second = (
            PoseNoise(covariance=share * shape, source="assumed", marker_noise=None)
            for share, shape in ((self.proximal_share, self.proximal_shape), (self.distal_share, self.distal_shape))
        )
        return self.known or (first if self.proximal_share > 0.0 else None, second)


def covariance_from_markers(offsets: Float, marker_noise: float) -> Float:
    """Covariance of a pose fitted to markers: ``sigma^2 (sum_k J_k^T J_k)^-1`` with ``J_k = [-[x_k]x, 1]``.

    Parameters
    ----------
    offsets : ndarray, shape (M, 3)
        The markers about the body's origin; at least three that are not on one line.
    marker_noise : float
        Standard deviation of each coordinate of each marker.

    Returns
    -------
    ndarray, shape (6, 6)
        Of the rotation vector (rad) and of the origin's position, in the body's frame. For markers about their centroid
        the rotation's part is that of Woltring 1985.
    """
    count = len(offsets)
    square = np.zeros((6, 6))
    cross = np.cross(offsets[:, None, :], np.eye(3))  # row a of marker k: x_k cross e_a
    square[:3, :3] = np.einsum("kai,kbi->ab", cross, cross)
    square[:3, 3:] = cross.sum(axis=0).T
    square[3:, :3] = square[:3, 3:].T
    square[3:, 3:] = count * np.eye(3)
    return np.asarray(marker_noise**2 * np.linalg.inv(square), dtype=np.float64)


def _shapes(bodies: tuple[RigidBody, ...]) -> list[Float]:
    """How the poses of bodies jitter; a common cluster's noise of all where one does not tell and moves."""
    shapes = [jitter_of(body) for body in bodies]
    silent = (
        shape is None and _share_shown(body, _COMMON_NOISE) > _LEAST_SHOWN
        for shape, body in zip(shapes, bodies, strict=True)
    )
    common = any(silent)
    return [_COMMON_NOISE if common or shape is None else shape for shape in shapes]


def _as_shown(noise: PoseNoise | None, share: float) -> PoseNoise | None:
    if noise is None or share == 1.0:
        return noise
    size = None if noise.marker_noise is None else float(np.sqrt(share)) * noise.marker_noise
    return replace(noise, covariance=share * noise.covariance, marker_noise=size)


def _share_shown(body: RigidBody, covariance: Float) -> float:
    """Twice the variance of a body's poses about their mean in units of a covariance (6, 6), 1 at most."""
    rows = evenly_thinned(np.flatnonzero(body.tracked), _MOST_FRAMES)
    poses = body.dual_quat_lab_body[rows]
    if len(rows) < _FEWEST_STILL_FRAMES:
        return 1.0
    off = 2.0 * log(align_signs(multiply(conjugate(poses[0]), poses), _IDENTITY))
    off = off - off.mean(axis=0)
    told = 6 if body.located else 3
    square = np.einsum("ni,ij,nj->n", off[:, :told], np.linalg.inv(covariance[:told, :told]), off[:, :told])
    # Twice, so that a body at rest that is as noisy as it is said to be has all of its noise.
    return min(2.0 * float(square.sum()) / (told * (len(rows) - 1)), 1.0)


def _from_marker_noise(body: RigidBody, marker_noise: float, source: str, settings: Settings) -> PoseNoise:
    offsets = body.marker_offsets
    if offsets is not None and fix_a_pose(offsets):
        return PoseNoise(
            covariance=covariance_from_markers(offsets, marker_noise), source=source, marker_noise=marker_noise
        )
    position = marker_noise**2 / _ASSUMED_MARKERS
    jitter = jitter_of(body)
    if jitter is not None:
        # Never less than what jitters, but for a noise that is stated: three markers make the most of that.
        most = marker_noise**2 / _FEWEST_MARKERS if settings.marker_noise_mm is not None else np.inf
        shown = float(np.trace(jitter[3:, 3:])) / 3.0
        covariance = np.clip(shown, position, most) / shown * jitter
        return PoseNoise(covariance=covariance, source=source + BY_JITTER, marker_noise=marker_noise, jitter=jitter)
    # Of the cluster nothing is known but its size: as many points as a common cluster has, spread alike in space.
    radius = DEFAULT_RADIUS if settings.radius_mm is None else settings.radius_mm / 1000.0
    rotation = position / (2.0 / 3.0 * radius**2)
    covariance = np.diag([rotation] * 3 + [position] * 3)
    return PoseNoise(covariance=covariance, source=source + MARKERS_ASSUMED, marker_noise=marker_noise)


def _residuals(body: RigidBody, rate_hz: float, settings: Settings) -> PoseNoise | None:
    square = None if body.marker_residual is None else body.marker_residual[body.tracked] ** 2
    return _from_square(body, square, "marker residuals", settings)


def stated_rms(body: RigidBody) -> Float | None:
    """RMS distance (N,) of the markers by the file's error column, which has their mean; NaN where it tells nothing."""
    stated = body.reported_error
    if stated is None:
        return None
    # What is negative, or a meter and more, is no error of a marker.
    usable = body.tracked & (stated >= 0.0) & (stated < _LARGEST_ERROR_M)
    return np.asarray(np.where(usable, stated, np.nan) / _MEAN_TO_RMS, dtype=np.float64)


def jitter_of(body: RigidBody) -> Float | None:
    """Covariance (6, 6) of a body's poses by how they jitter; None where that tells nothing."""
    return jitter_covariance(body, _ROUNDING_SD)


def _error_column(body: RigidBody, rate_hz: float, settings: Settings) -> PoseNoise | None:
    rms = stated_rms(body)
    return _from_square(body, None if rms is None else rms**2, "error column", settings)


def _from_square(body: RigidBody, square: Float | None, source: str, settings: Settings) -> PoseNoise | None:
    """Marker noise of mean squared residuals: a pose takes 6 of the 3 M degrees of freedom."""
    known = None if square is None else square[np.isfinite(square)]
    if known is None or not known.size or np.median(known) <= _NO_JITTER_M**2:  # round-off is no noise
        return None
    count = _ASSUMED_MARKERS if body.marker_offsets is None else len(body.marker_offsets)
    if count < _FEWEST_MARKERS:
        return None
    freedom = 3 * count - 6
    # The median of a chi-square over its mean (Wilson and Hilferty): astray markers move it little.
    median = (1.0 - 2.0 / (9.0 * freedom)) ** 3
    return _from_marker_noise(body, float(np.sqrt(count * np.median(known) / (freedom * median))), source, settings)


def _still(body: RigidBody, rate_hz: float, settings: Settings) -> PoseNoise | None:
    """Covariance of the poses in the stillest half second, about a steady drift."""
    frames = max(_FEWEST_STILL_FRAMES, round(_STILL_S * rate_hz))
    count = body.loss.size // frames
    radius = DEFAULT_RADIUS if settings.radius_mm is None else settings.radius_mm / 1000.0
    blocks = body.dual_quat_lab_body[: count * frames].reshape(count, frames, 8)
    blocks = blocks[np.isfinite(blocks).all(axis=(1, 2))]
    if not len(blocks):
        return None
    aligned = align_signs(blocks, blocks[:, :1])
    local = 2.0 * log(multiply(conjugate(normalize(aligned.mean(axis=1))[:, None, :]), aligned))
    ramp = np.linspace(-1.0, 1.0, frames)
    slope = np.einsum("f,bfk->bk", ramp, local) / (ramp @ ramp)
    rest = local - local.mean(axis=1, keepdims=True) - ramp[:, None] * slope[:, None, :]
    scale = np.array([radius] * 3 + [1.0] * 3)
    size = np.sqrt(np.sum((rest * scale) ** 2, axis=(1, 2)) / frames)
    drift = np.sqrt(np.sum((slope * scale) ** 2, axis=1))
    still = (drift <= _LARGEST_DRIFT * size) & (size <= _STILL_NOISE_M) & (size > _NO_JITTER_M)
    if not still.any():
        return None
    # The stillest of many is stiller than the noise: the median of those within its double says what is usual.
    like = still & (size <= 2.0 * size[still].min())
    rest = rest[like].reshape(-1, 6)
    covariance = rest.T @ rest / (len(rest) * (1.0 - 2.0 / frames)) + np.diag(_ROUNDING_SD**2)
    return PoseNoise(covariance=covariance, source=STILL_STRETCH, marker_noise=None)


def fix_a_pose(offsets: Float) -> bool:
    """Whether markers (M, 3) are three and more that are not on one line."""
    if len(offsets) < _FEWEST_MARKERS:
        return False
    spread = np.linalg.svd(offsets - offsets.mean(axis=0), compute_uv=False)
    return bool(spread[1] > 1e-3 * spread[0])


SOURCES: Final[dict[str, Callable[..., PoseNoise | None]]] = functions_named(NOISE_SOURCES, globals())
"""Where noise may be known from: a new one is one function, and its name in `choices.NoiseSource`."""
