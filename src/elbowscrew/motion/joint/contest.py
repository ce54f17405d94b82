"""The types of joint on the same frames: what each of them leaves of those it was fitted to, and of others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.deciding_frames import deciding_frames
from elbowscrew.motion.joint.fitting import Fitted, fit_again, fit_type, least_hinge, shared_covariance
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, settled
from elbowscrew.motion.joint.pieces import influence_pieces
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import OneAxis
from elbowscrew.motion.joint.two_axes import TwoAxesMechanism, angle_sd, is_phantom

_FRAMES: Final = 200
_CONSECUTIVE: Final = 2000
_FOLDS: Final = 5
_BLOCKS: Final = 4
_RANK: Final = 1e-10
_EXACT: Final = 1e-12  # variance, in units of the assumed noise's, of poses without any
_TINY: Final = float(np.finfo(np.float64).tiny)
_WAVES: Final = 8
_LARGE: Final = np.radians(10.0)
_LITTLE_ROTATION: Final = np.radians(2.5)
_LITTLE_SHIFT: Final = 0.0015
_LEAST_MOTION: Final = np.radians(1.5)
_LARGEST_LEFT: Final = 0.012
_LARGEST_PART: Final = 0.15
_LARGEST_SKIN: Final = 0.05
_LEAST_OF_MOST: Final = 0.1  # share of the squares that the better three quarters of the frames have
_LARGEST_CENTER_SD: Final = 0.05
_LARGEST_ANGLE_SD: Final = np.radians(8.0)
_LEAST_RANGE: Final = np.radians(1.5)
_SURE: Final = 3.0
# Of a square, over its mean: noise of a rotation shifts the end of a lever along two directions.
_MEDIAN_ACROSS_A_LEVER: Final = float(np.log(2.0))
_THIRD_DIFFERENCES: Final = 20.0  # variance of those of white noise
# What orientations alone can refuse: they see no slide, and a ball has any of them.
_ORDER_BY_TURNING: Final[tuple[Fitted, ...]] = ("rigid", "hinge", "two_axes")

ORDER: Final[tuple[Fitted, ...]] = ("rigid", "hinge", "screw_hinge", "two_axes", "ball")
"""All types, the simplest first."""

NEED_LARGE: Final = 2.0
"""How many times less a richer type must leave where the simpler one leaves much."""

NEED_SMALL: Final = 10.0
"""The same where it leaves so little that skin and imperfect joints may be the reason."""

LARGEST_AXIS_SD: Final = np.radians(10.0)
"""Standard deviation of a direction from which on the fit is not linear in its errors, so that no cone would hold."""

LEAST_RANGE_IN_SD: Final = 12.0
"""Times the standard deviation of a frame's angle that a range takes to tell an axis."""

RMS_TO_RANGE: Final = 3.3
"""Range of a rotation that goes to and fro, over its RMS."""


@dataclass(slots=True, frozen=True)
class Tried:
    """A type fitted to the frames that decide."""

    fit: Fit[Mechanism]
    valid: bool
    shared_sd: Float

    @property
    def range_left(self) -> float:
        """Range (rad) of the rotation that the type leaves, from its RMS."""
        return RMS_TO_RANGE * self.fit.residual_rotation

    @property
    def need(self) -> float:
        """How many times less a richer type must leave."""
        return NEED_LARGE if self.leaves_much else NEED_SMALL

    @property
    def leaves_much(self) -> bool:
        """Whether what it leaves is more than skin and imperfect joints make."""
        return bool(self.range_left >= _LARGE)

    @property
    def leaves_little(self) -> bool:
        """Whether what it leaves is small, however far beyond the noise: an imperfect hinge has as much."""
        return self.range_left < _LITTLE_ROTATION and self.fit.residual_translation < _LITTLE_SHIFT

    @property
    def hardly_moves(self) -> bool:
        """Whether a rigid joint leaves less than tells an axis, whatever the noise: play, drift, a shaken camera."""
        return self.range_left < _LEAST_MOTION and self.fit.residual_translation < _LITTLE_SHIFT


class Contest:
    """The types on the same frames, each fitted when it is first asked for."""

    def __init__(
        self, poses: Poses, *, noise_known: bool, robust: bool, one: Literal["hinge", "screw_hinge"] | None = None
    ) -> None:
        self.rows = deciding_frames(poses.joint, _FRAMES)
        self.poses = poses.at(self.rows)
        self.consecutive = poses.at(slice(_CONSECUTIVE))
        self.noise_known = noise_known
        self.robust = robust
        self.stated_one = one
        self.tried: dict[Fitted, Tried] = {}
        self.known_heldout: dict[Fitted, float] = {}
        self.successive: dict[Fitted, Fit[Mechanism]] = {}

    @property
    def order(self) -> tuple[Fitted, ...]:
        """The types that can be told from one another, the simplest first."""
        return ORDER if self.poses.located else _ORDER_BY_TURNING

    def __getitem__(self, name: Fitted) -> Tried:
        if name not in self.tried:
            hinge = self._hinge if name in ("hinge", "screw_hinge") else None
            self._take(name, fit_type(name, self.poses, robust=self.robust, hinge=hinge))
        return self.tried[name]

    @cached_property
    def _hinge(self) -> Fit[OneAxis]:
        """The hinge of least squares, from which a screw-hinge goes on."""
        return least_hinge(self.poses)

    def _take(self, name: Fitted, fit: Fit[Mechanism]) -> None:
        deviation = np.sqrt(np.diag(shared_covariance(fit, noise_known=self.noise_known)))
        self.tried[name] = Tried(fit, _is_valid(name, fit, deviation), deviation)
        self.known_heldout.pop(name, None)
        self.successive.pop(name, None)

    def _on_successive_frames(self, name: Fitted) -> Fit[Mechanism]:
        """A type as it was fitted, put on the frames that stand side by side."""
        fit = self[name].fit
        if name not in self.successive:
            self.successive[name] = settled(fit.mechanism, self.consecutive)
        return self.successive[name]

    def heldout(self, name: Fitted) -> float:
        """Held-out variance of a type, found when it is first asked for."""
        if name not in self.known_heldout:
            self.known_heldout[name] = self._heldout(self[name].fit)
        return self.known_heldout[name]

    def _heldout(self, fit: Fit[Mechanism]) -> float:
        """Whitened variance for each degree of freedom of frames that the shared numbers were not fitted to."""
        pieces = influence_pieces(fit, self.poses)
        return _heldout_variance(pieces.design, pieces.whitened, float(fit.weight.sum()))

    def heldout_wandering(self, name: Fitted) -> float:
        """Held-out variance of one axis that may move as it likes with the angle, retraced on each way."""
        fit = self[name].fit
        pieces = influence_pieces(fit, self.poses)
        angle = fit.mechanism.frames[:, 0]
        share = (angle - angle.min()) / max(float(np.ptp(angle)), _TINY)
        waves = np.cos(np.pi * np.arange(_WAVES) * share[:, None])
        whitener = pieces.whitener if self.poses.located else pieces.whitener[:, :, :3]
        columns = (whitener[:, :, :, None] * waves[:, None, None, :]).reshape(*pieces.whitened.shape, -1)
        design = np.concatenate([pieces.design, columns], axis=2)
        return _heldout_variance(design, pieces.whitened, float(fit.weight.sum()))

    @property
    def rival_of_ball(self) -> Fitted:
        """What a ball must beat: two axes, but not those that wind, as which any circumduction can be written."""
        return self.one if is_phantom(self["two_axes"].fit) else "two_axes"

    @property
    def one(self) -> Fitted:
        """Hinge or screw-hinge: as the joint's axis was found to be, else by the pitch's own interval."""
        if self.stated_one is not None:
            return self.stated_one
        if not self.poses.located:
            return "hinge"
        screw = self["screw_hinge"]
        mechanism = screw.fit.mechanism
        pitch = mechanism.pitch if isinstance(mechanism, OneAxis) else 0.0
        return "screw_hinge" if abs(pitch) > _SURE * screw.shared_sd[9] else "hinge"

    def floor(self, name: Fitted) -> float:
        """Variance for each degree of freedom that no joint explains: what of a type's residual is white in time.

        From third differences of successive frames, so that the motion, which is smooth, has no share; by the median,
        which is less than the mean, so that outliers and gaps do not raise it.
        """
        return _white_square(self._on_successive_frames(name).whitened) / self[name].fit.frame_freedom

    def too_far(self, name: Fitted) -> bool:
        """Whether a type leaves more than a joint may, noise that is white in time or that explains it aside."""
        fit = self[name].fit
        if fit.residual_translation <= _LARGEST_LEFT or (self.noise_known and self.heldout(name) < NEED_LARGE):
            return False
        white = _white_square(self._on_successive_frames(name).residual[:, 3:]) / _MEDIAN_ACROSS_A_LEVER
        return bool(fit.residual_translation**2 - white > _LARGEST_LEFT**2)

    def leaves_more_than_skin(self, name: Fitted) -> bool:
        """Whether a type leaves more translation than skin on a long lever: 50 mm, or much of what there is."""
        left = self[name].fit.residual_translation
        return left >= min(_LARGEST_SKIN, _LARGEST_PART * self["rigid"].fit.residual_translation)

    def left_by_few_frames(self, name: Fitted) -> bool:
        """Whether most of the translation that a type leaves is that of a few frames, as outliers make it."""
        fit = self[name].fit
        square = np.sort(fit.weight * np.sum(fit.residual[:, 3:] ** 2, axis=1))
        return bool(square[: 3 * len(square) // 4].sum() < _LEAST_OF_MOST * square.sum())

    def rotation_beyond_noise(self, name: Fitted) -> float:
        """RMS rotation (rad) that a type leaves and that is not white in time; 0 where that is not half of it."""
        fit = self[name].fit
        left, white = fit.residual_rotation**2, _white_square(self._on_successive_frames(name).residual[:, :3])
        return float(np.sqrt(left - white)) if left >= NEED_LARGE * white else 0.0

    def tells_order(self) -> bool:
        """Whether two axes in the other order leave much more than as they are; the order that leaves less is taken."""
        fit = self["two_axes"].fit
        if not isinstance(fit.mechanism, TwoAxesMechanism):
            return True
        exchanged = fit.mechanism.exchanged()
        other = fit_again(exchanged, self.poses, fit.weight)
        if other.mechanism.has_first_axis_of(fit.mechanism, exchanged):  # no other order is left from there
            return True
        if other.cost < fit.cost:
            self._take("two_axes", other)
        less, more = sorted((fit.variance, other.variance))
        return over(more, less) >= NEED_LARGE

    def try_all(self) -> None:
        """Fit every type."""
        for name in self.order:
            self[name]

    def turns_about_one_axis(self) -> bool:
        """Whether a hinge leaves little: then the center of a ball may be anywhere on its axis."""
        fit = fit_type("hinge", self.poses, robust=self.robust, hinge=self._hinge)
        return Tried(fit, valid=True, shared_sd=np.zeros(0)).leaves_little

    def hardly_turns(self) -> bool:
        """Whether an angle of two axes covers too little, for how well a frame tells it, to tell its axis."""
        fit = self["two_axes"].fit
        reach = np.array([middle_range(fit.mechanism.frames[:, k]) for k in range(2)])
        return bool((reach < LEAST_RANGE_IN_SD * angle_sd(fit)).any())

    def sure_axes(self) -> bool:
        """Whether both directions of two axes are known well enough to be told."""
        return bool(self["two_axes"].shared_sd[[0, 1, 8, 9]].max() <= LARGEST_AXIS_SD)


def middle_range(values: Float) -> float:
    """From the 5 % to the 95 % quantile."""
    low, high = np.quantile(values, [0.05, 0.95])
    return float(high - low)


def _is_valid(name: Fitted, fit: Fit[Mechanism], deviation: Float) -> bool:
    if name == "ball" and fit.told is not None:  # its rotations are the measured ones
        return True
    if name == "ball":
        return bool(np.nan_to_num(deviation, nan=np.inf).max() < _LARGEST_CENTER_SD)
    if name != "two_axes":
        return True
    ranges = min(middle_range(fit.mechanism.frames[:, k]) for k in range(2))
    return bool(not is_phantom(fit) and angle_sd(fit).max() < _LARGEST_ANGLE_SD and ranges > _LEAST_RANGE)


def _white_square(residual: Float) -> float:
    """Squared length that white noise has in the residuals (F, k) of successive frames; 0 of too few."""
    change = np.diff(residual, 3, axis=0)
    if not len(change):
        return 0.0
    return float(np.median(np.sum(change**2, axis=1))) / _THIRD_DIFFERENCES


def over(simpler: float, richer: float) -> float:
    """How many times less variance the richer of two types leaves; of poses that both meet exactly, no less."""
    return (simpler + _EXACT) / (richer + _EXACT)


def _heldout_variance(design: Float, whitened: Float, frames: float) -> float:
    """Mean square for each degree of freedom of residuals (F, k) that a linear model (F, k, P) was not fitted to.

    Five folds of four interleaved blocks, so that neither neighbors nor one end of the motion decide. The numbers
    without a fold are one linear step from those with it.
    """
    count, freedom = whitened.shape
    fold = (np.arange(count) * _FOLDS * _BLOCKS // count) % _FOLDS
    parts = [design[fold == k].reshape(-1, design.shape[2]) for k in range(_FOLDS)]
    squares = [part.T @ part for part in parts]
    pulls = [part.T @ whitened[fold == k].reshape(-1) for k, part in enumerate(parts)]
    information, pull = np.sum(squares, axis=0), np.sum(pulls, axis=0)
    scale = np.sqrt(np.maximum(np.diag(information), _TINY))
    total = 0.0
    for k in range(_FOLDS):
        rest = (information - squares[k]) / np.outer(scale, scale)
        step = np.linalg.lstsq(rest, (pull - pulls[k]) / scale, rcond=_RANK)[0] / scale
        total += float(np.sum((whitened[fold == k].reshape(-1) - parts[k] @ step) ** 2))
    return total / max(float(frames * freedom), _TINY)
