"""Which joint it is: rigid, one axis, two axes, a ball, none of them, or not to be told.

Real joints are no exact mechanisms, so that chi-square and BIC call each of them free, and held-out frames alone prefer
the richest type. A richer type must therefore leave several times less of the *held-out* frames than the simpler one
does: twice where what the simpler one misses is large (10 deg), ten times where it is small enough to be skin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.joint_type import JointTypeName, TypeCandidate
from elbowscrew.motion.joint.fitting import Fitted, fit_type, shared_covariance
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, Poses, fit_mechanism, settled
from elbowscrew.motion.joint.simple_types import OneAxis
from elbowscrew.motion.joint.two_axes import angle_sd, is_phantom

_FRAMES: Final = 200
_FOLDS: Final = 5
_BLOCKS: Final = 4
_FOLD_ITERATIONS: Final = 2
_EXPLAINED: Final = 1.15
_TIMES_BETTER: Final = 1.5
_LARGE: Final = np.radians(10.0)
_NEED_LARGE: Final = 2.0
_NEED_SMALL: Final = 10.0
_RMS_TO_RANGE: Final = 3.3
_LARGEST_LEFT: Final = 0.012
_LARGEST_CENTER_SD: Final = 0.05
_LARGEST_ANGLE_SD: Final = np.radians(8.0)
_LARGEST_AXIS_SD: Final = np.radians(15.0)
_LEAST_RANGE: Final = np.radians(1.5)
_SURE: Final = 3.0

NAMES: Final[dict[str, str]] = {
    "rigid": "a rigid joint",
    "hinge": "a hinge",
    "screw_hinge": "a screw-hinge",
    "two_axes": "two axes",
    "ball": "a ball joint",
}


_ORDER: Final[tuple[Fitted, ...]] = ("rigid", "hinge", "screw_hinge", "two_axes", "ball")


class Choice(NamedTuple):
    """The type, how sure it is, why, and what all types that were tried leave."""

    type: JointTypeName
    status: Literal["determined", "approximate", "forced"] | None
    reason: str
    candidates: tuple[TypeCandidate, ...]
    fits: dict[str, Fit[Mechanism]]


@dataclass(slots=True, frozen=True)
class _Tried:
    """A type fitted to the frames that decide."""

    fit: Fit[Mechanism]
    valid: bool
    shared_sd: Float

    @property
    def range_left(self) -> float:
        """Range (rad) of the rotation that the type leaves, from its RMS."""
        return _RMS_TO_RANGE * self.fit.residual_rotation

    @property
    def need(self) -> float:
        """How many times less a richer type must leave."""
        return _NEED_LARGE if self.range_left >= _LARGE else _NEED_SMALL

    @property
    def too_far(self) -> bool:
        return self.fit.residual_translation > _LARGEST_LEFT


class _Contest:
    """The types on the same frames, each fitted when it is first asked for."""

    def __init__(self, poses: Poses, *, noise_known: bool, robust: bool) -> None:
        self.poses, _ = poses.thinned(_FRAMES)
        self.noise_known = noise_known
        self.robust = robust
        self.tried: dict[Fitted, _Tried] = {}
        self.known_heldout: dict[Fitted, float] = {}

    def __getitem__(self, name: Fitted) -> _Tried:
        if name not in self.tried:
            fit = fit_type(name, self.poses, robust=self.robust)
            deviation = np.sqrt(np.diag(shared_covariance(fit, noise_known=self.noise_known)))
            self.tried[name] = _Tried(fit, _is_valid(name, fit, deviation), deviation)
        return self.tried[name]

    def heldout(self, name: Fitted) -> float:
        """Held-out variance of a type, found when it is first asked for."""
        if name not in self.known_heldout:
            self.known_heldout[name] = self._heldout(self[name].fit)
        return self.known_heldout[name]

    def _heldout(self, fit: Fit[Mechanism]) -> float:
        """Whitened variance for each degree of freedom of frames that the shared numbers were not fitted to.

        Five folds of four interleaved blocks, so that neither neighbors nor one end of the motion decide.
        """
        count = len(self.poses.joint)
        fold = (np.arange(count) * _FOLDS * _BLOCKS // count) % _FOLDS
        total, weights = 0.0, 0.0
        for k in range(_FOLDS):
            kept, left = np.flatnonzero(fold != k), np.flatnonzero(fold == k)
            refit = fit_mechanism(
                fit.mechanism.on(kept),
                self.poses.at(kept),
                iterations=_FOLD_ITERATIONS,
                tolerance=1e-4,
                weight=fit.weight[kept],
            )
            held = settled(refit.mechanism, self.poses.at(left))
            total += float(fit.weight[left] @ held.square)
            weights += float(fit.weight[left].sum())
        return total / max(weights * (6 - fit.own_count), np.finfo(np.float64).tiny)

    @property
    def one(self) -> Fitted:
        """Hinge or screw-hinge: by the pitch's own interval."""
        screw = self["screw_hinge"]
        mechanism = screw.fit.mechanism
        pitch = mechanism.pitch if isinstance(mechanism, OneAxis) else 0.0
        return "screw_hinge" if abs(pitch) > _SURE * screw.shared_sd[9] else "hinge"

    def sure_axes(self) -> bool:
        """Whether both directions of two axes are known to 15 deg."""
        return bool(self["two_axes"].shared_sd[[0, 1, 8, 9]].max() <= _LARGEST_AXIS_SD)


def choose_type(poses: Poses, *, noise_known: bool, robust: bool = False, forced: Fitted | None = None) -> Choice:
    """Tell which type of joint moved so.

    Parameters
    ----------
    poses : Poses
        In order of time; at most 200 of them, evenly spread, decide.
    noise_known : bool
        Whether the covariances are stated ones; then the simplest type that they explain is taken.
    robust : bool
        Weigh outliers down.
    forced : {"rigid", "hinge", "screw_hinge", "two_axes", "ball"}, optional
        Take this one; nothing is chosen.
    """
    contest = _Contest(poses, noise_known=noise_known, robust=robust)
    if forced is not None:
        contest[forced]
        return _chosen(contest, forced, "forced", f"{NAMES[forced]}, as stated")
    return (_explained(contest) if noise_known else None) or _best(contest)


def _explained(contest: _Contest) -> Choice | None:
    """Take the simplest type that the stated noise explains; None if it explains none."""
    simpler: dict[Fitted, Fitted] = {"two_axes": "hinge", "ball": "two_axes"}
    for name in _ORDER:
        tried = contest[name]
        # What leaves more of the frames it was fitted to leaves no less of others.
        if not tried.valid or tried.fit.variance > _EXPLAINED or contest.heldout(name) > _EXPLAINED:
            continue
        if name in simpler:
            less = contest.one if name == "two_axes" else simpler[name]
            if contest.heldout(less) < _TIMES_BETTER * contest.heldout(name):
                continue
        found = contest.one if name == "hinge" else name
        approximate = name == "two_axes" and not contest.sure_axes()
        reason = f"{NAMES[found]}: the stated noise explains what it leaves"
        return _chosen(contest, found, "approximate" if approximate else "determined", reason)
    return None


def _best(contest: _Contest) -> Choice:
    """Take the simplest type that no richer one beats by enough."""
    one = contest.one
    rigid, single, two, ball = contest["rigid"], contest[one], contest["two_axes"], contest["ball"]
    names: tuple[Fitted, ...] = ("rigid", one, "two_axes", "ball")
    left_rigid, left_single, left_two, left_ball = (contest.heldout(name) for name in names)
    center = left_ball if ball.valid else np.inf
    gain = _over(left_rigid, min(left_single, left_two, left_ball))
    if gain < rigid.need:
        return _unless_too_far(contest, "rigid", gain, sure=True)
    gain = _over(left_single, min(left_two, center))
    if gain < single.need:
        return _unless_too_far(contest, one, gain, sure=True)
    gain = _over(left_two, left_ball)
    if ball.valid and gain >= two.need:
        return _unless_too_far(contest, "ball", 0.0, sure=True)
    if two.valid:
        return _unless_too_far(contest, "two_axes", gain, sure=contest.sure_axes())
    return _none_fits(contest, "more than one axis moves, but too little or too noisily to tell the second")


def _unless_too_far(contest: _Contest, name: Fitted, gain: float, *, sure: bool) -> Choice:
    tried = contest[name]
    if tried.too_far:
        return _none_fits(
            contest, f"{NAMES[name]} would be preferred, but leaves {1000.0 * tried.fit.residual_translation:.0f} mm"
        )
    left = f"leaves {np.degrees(tried.fit.residual_rotation):.2g} deg and " + (
        f"{1000.0 * tried.fit.residual_translation:.2g} mm RMS"
    )
    if gain >= _NEED_LARGE:
        reason = (
            f"{NAMES[name]} {left}; a richer type leaves {gain:.1f} times less variance, which is within what skin "
            "and imperfect joints do"
        )
        return _chosen(contest, name, "approximate", reason)
    if not sure:
        reason = f"{NAMES[name]} {left}; a direction is not known to {np.degrees(_LARGEST_AXIS_SD):.0f} deg"
        return _chosen(contest, name, "approximate", reason)
    return _chosen(contest, name, "determined", f"{NAMES[name]} {left}; no richer type explains much more")


def _none_fits(contest: _Contest, reason: str) -> Choice:
    """Free if no valid type comes within 12 mm, else undetermined."""
    if all(tried.too_far for tried in contest.tried.values() if tried.valid):
        least = min(tried.fit.residual_translation for tried in contest.tried.values() if tried.valid)
        free = f"no joint explains the motion: every type leaves {1000.0 * least:.0f} mm or more"
        return _chosen(contest, "free", "determined", free)
    return _chosen(contest, "undetermined", None, reason)


def _chosen(
    contest: _Contest,
    name: JointTypeName,
    status: Literal["determined", "approximate", "forced"] | None,
    reason: str,
) -> Choice:
    candidates = tuple(
        TypeCandidate(
            type=tried_name,
            residual_rotation=tried.fit.residual_rotation,
            residual_translation=tried.fit.residual_translation,
            heldout_variance=contest.known_heldout.get(tried_name, float("nan")),
            shared=len(tried.fit.information),
            per_frame=tried.fit.own_count,
            valid=tried.valid,
        )
        for tried_name, tried in ((k, contest.tried[k]) for k in _ORDER if k in contest.tried)
    )
    return Choice(name, status, reason, candidates, {key: tried.fit for key, tried in contest.tried.items()})


def middle_range(values: Float) -> float:
    """From the 5 % to the 95 % quantile."""
    low, high = np.quantile(values, [0.05, 0.95])
    return float(high - low)


def _is_valid(name: Fitted, fit: Fit[Mechanism], deviation: Float) -> bool:
    if name == "ball":
        return bool(np.nan_to_num(deviation, nan=np.inf).max() < _LARGEST_CENTER_SD)
    if name != "two_axes":
        return True
    ranges = min(middle_range(fit.mechanism.frames[:, k]) for k in range(2))
    return bool(not is_phantom(fit) and angle_sd(fit).max() < _LARGEST_ANGLE_SD and ranges > _LEAST_RANGE)


def _over(simpler: float, richer: float) -> float:
    return simpler / max(richer, float(np.finfo(np.float64).tiny))
