"""Which joint it is: rigid, one axis, two axes, a ball, none of them, or undetermined.

Real joints are no exact mechanisms, so that chi-square and BIC call each of them free, and held-out frames alone prefer
the richest type. A richer type must therefore leave several times less of the *held-out* frames than the simpler one
does: twice where what the simpler one misses is large (10 deg), ten times where it is small enough to be skin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.joint_type import JointTypeName, TypeCandidate
from elbowscrew.motion.joint.deciding_frames import deciding_frames
from elbowscrew.motion.joint.fitting import Fitted, fit_type, shared_covariance
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, Poses, settled
from elbowscrew.motion.joint.pieces import influence_pieces
from elbowscrew.motion.joint.simple_types import OneAxis
from elbowscrew.motion.joint.two_axes import angle_sd, is_phantom

_FRAMES: Final = 200
_CONSECUTIVE: Final = 2000
_FOLDS: Final = 5
_BLOCKS: Final = 4
_RANK: Final = 1e-10
_TINY: Final = float(np.finfo(np.float64).tiny)
_WAVES: Final = 8
_EXPLAINED: Final = 1.15
_TIMES_BETTER: Final = 1.5
_LARGE: Final = np.radians(10.0)
_NEED_LARGE: Final = 2.0
_NEED_SMALL: Final = 10.0
_LITTLE_ROTATION: Final = np.radians(2.5)
_LITTLE_SHIFT: Final = 0.0015
_LEAST_MOTION: Final = np.radians(1.5)
_LARGEST_LEFT: Final = 0.012
_LARGEST_CENTER_SD: Final = 0.05
_LARGEST_ANGLE_SD: Final = np.radians(8.0)
_LEAST_RANGE: Final = np.radians(1.5)
_SURE: Final = 3.0
_THIRD_DIFFERENCES: Final = 20.0  # variance of those of white noise
# Share of what a richer type explains that one axis, free to move with the angle, explains as well.
_ALL_RETRACED: Final = 0.9
_MUCH_RETRACED: Final = 0.5
_LARGEST_WANDER: Final = np.radians(15.0)
_WANDERS: Final = "an axis that wanders with the angle explains as much as two axes do"
_HARDLY: Final = "so little motion tells no axis"
_NO_CENTER: Final = "whether it turns about one center, orientations alone do not tell"
_LITTLE: Final = "a second rotation is seen, but is too small to tell its axis"

LARGEST_AXIS_SD: Final = np.radians(10.0)
"""Standard deviation of a direction from which on the fit is not linear in its errors, so that no cone would hold."""

LEAST_RANGE_IN_SD: Final = 12.0
"""Times the standard deviation of a frame's angle that a range takes to tell an axis."""

RMS_TO_RANGE: Final = 3.3
"""Range of a rotation that goes to and fro, over its RMS."""

_ORDER: Final[tuple[Fitted, ...]] = ("rigid", "hinge", "screw_hinge", "two_axes", "ball")
# What orientations alone can refuse: they see no slide, and a ball has any of them.
_ORDER_BY_TURNING: Final[tuple[Fitted, ...]] = ("rigid", "hinge", "two_axes")


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
        return RMS_TO_RANGE * self.fit.residual_rotation

    @property
    def need(self) -> float:
        """How many times less a richer type must leave."""
        return _NEED_LARGE if self.range_left >= _LARGE else _NEED_SMALL

    @property
    def leaves_little(self) -> bool:
        """Whether what it leaves is small, however far beyond the noise: an imperfect hinge has as much."""
        return self.range_left < _LITTLE_ROTATION and self.fit.residual_translation < _LITTLE_SHIFT

    @property
    def hardly_moves(self) -> bool:
        """Whether a rigid joint leaves less than tells an axis, whatever the noise: play, drift, a shaken camera."""
        return self.range_left < _LEAST_MOTION and self.fit.residual_translation < _LITTLE_SHIFT

    @property
    def too_far(self) -> bool:
        return self.fit.residual_translation > _LARGEST_LEFT


class Contest:
    """The types on the same frames, each fitted when it is first asked for."""

    def __init__(
        self, poses: Poses, *, noise_known: bool, robust: bool, one: Literal["hinge", "screw_hinge"] | None = None
    ) -> None:
        self.poses = poses.at(deciding_frames(poses.joint, _FRAMES))
        self.consecutive = poses.at(slice(_CONSECUTIVE))
        self.noise_known = noise_known
        self.robust = robust
        self.stated_one = one
        self.tried: dict[Fitted, _Tried] = {}
        self.known_heldout: dict[Fitted, float] = {}

    @property
    def order(self) -> tuple[Fitted, ...]:
        """The types that can be told from one another, the simplest first."""
        return _ORDER if self.poses.located else _ORDER_BY_TURNING

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
        tried = self[name].fit
        on_all = settled(tried.mechanism, self.consecutive)
        change = np.diff(on_all.whitened, 3, axis=0)
        if not len(change):
            return 0.0
        return float(np.median(np.sum(change**2, axis=1))) / (_THIRD_DIFFERENCES * tried.frame_freedom)

    def try_all(self) -> None:
        """Fit every type."""
        for name in self.order:
            self[name]

    def hardly_turns(self) -> bool:
        """Whether an angle of two axes covers too little, for how well a frame tells it, to tell its axis."""
        fit = self["two_axes"].fit
        reach = np.array([middle_range(fit.mechanism.frames[:, k]) for k in range(2)])
        return bool((reach < LEAST_RANGE_IN_SD * angle_sd(fit)).any())

    def sure_axes(self) -> bool:
        """Whether both directions of two axes are known well enough to be told."""
        return bool(self["two_axes"].shared_sd[[0, 1, 8, 9]].max() <= LARGEST_AXIS_SD)


def choose_type(
    poses: Poses,
    *,
    noise_known: bool,
    robust: bool = False,
    forced: Fitted | None = None,
    one: Literal["hinge", "screw_hinge"] | None = None,
) -> Choice:
    """Tell which type of joint moved so.

    Parameters
    ----------
    poses : Poses
        In order of time; at most 200 of them, spread over the motion, decide.
    noise_known : bool
        Whether the covariances are stated ones; then the simplest type that they explain is taken.
    robust : bool
        Weigh outliers down.
    forced : {"rigid", "hinge", "screw_hinge", "two_axes", "ball"}, optional
        Take this one; nothing is chosen.
    one : {"hinge", "screw_hinge"}, optional
        Which of both a single axis is, where that is known already.
    """
    contest = Contest(poses, noise_known=noise_known, robust=robust, one=one)
    if forced is not None:
        contest[forced]
        return _chosen(contest, forced, "forced", f"{JOINT_TYPE_WORDS[forced]}, as stated")
    if contest["rigid"].hardly_moves:
        limit = _EXPLAINED if noise_known else _NEED_LARGE * contest.floor("rigid")
        return _unless_too_far(contest, "rigid", 0.0, doubt=None if contest.heldout("rigid") <= limit else _HARDLY)
    return (_explained(contest) if noise_known else None) or _best(contest)


def _explained(contest: Contest) -> Choice | None:
    """Take the simplest type that the stated noise explains; None if it explains none."""
    simpler: dict[Fitted, Fitted] = {"two_axes": "hinge", "ball": "two_axes"}
    for name in contest.order:
        tried = contest[name]
        # What leaves more of the frames it was fitted to leaves no less of others.
        if not tried.valid or tried.fit.variance > _EXPLAINED or contest.heldout(name) > _EXPLAINED:
            continue
        if name == "screw_hinge" and contest.one == "hinge":
            continue
        if name in simpler:
            less = contest.one if name == "two_axes" else simpler[name]
            if contest.heldout(less) < _TIMES_BETTER * contest.heldout(name):
                continue
            if contest[contest.one].leaves_little or (name == "two_axes" and _doubtful(contest)):
                return None
        found = contest.one if name == "hinge" else name
        return _chosen(contest, found, "determined", "the noise of the poses explains what it leaves")
    return None


def _doubtful(contest: Contest) -> bool:
    """Whether one axis that wanders, or with a second rotation too small to tell, could have moved so."""
    single, two = contest.heldout(contest.one), contest.heldout("two_axes")
    retraced = _over(single - contest.heldout_wandering(contest.one), single - two)
    return contest.hardly_turns() or not contest.sure_axes() or retraced > _MUCH_RETRACED


def _best(contest: Contest) -> Choice:
    """Take the simplest type that no richer one beats by enough."""
    if _over(contest.heldout("rigid"), contest.floor("rigid")) < contest["rigid"].need:
        return _unless_too_far(contest, "rigid", 0.0)
    one = contest.one
    if _over(contest.heldout(one), contest.floor(one)) < _NEED_LARGE:
        return _unless_too_far(contest, one, 0.0)
    rigid, single, two = contest["rigid"], contest[one], contest["two_axes"]
    names: tuple[Fitted, ...] = ("rigid", one, "two_axes")
    left_rigid, left_single, left_two = (contest.heldout(name) for name in names)
    left_ball = contest.heldout("ball") if contest.poses.located else np.inf
    ball_valid = contest.poses.located and contest["ball"].valid
    gain = _over(left_rigid, min(left_single, left_two, left_ball))
    if gain < rigid.need:
        return _unless_too_far(contest, "rigid", gain)
    least = min(left_two, left_ball if ball_valid else np.inf)
    gain = _over(left_single, least)
    if gain < single.need or single.leaves_little:
        return _unless_too_far(contest, one, gain)
    retraced = _over(left_single - contest.heldout_wandering(one), left_single - least)
    if retraced > _ALL_RETRACED and single.range_left < _LARGEST_WANDER:
        return _unless_too_far(contest, one, gain, doubt=_WANDERS)
    gain = _over(left_two, left_ball)
    if ball_valid and gain >= two.need:
        return _unless_too_far(contest, "ball", 0.0)
    if not contest.poses.located and two.range_left >= _LARGE:
        left = f"two axes leave {np.degrees(two.fit.residual_rotation):.2g} deg RMS of rotation; {_NO_CENTER}"
        return _chosen(contest, "ball", "approximate", left)
    if not two.valid:
        return _none_fits(contest, "more than one axis moves, but too little or too noisily to tell the second")
    if contest.hardly_turns():
        return _unless_too_far(contest, one, 0.0, doubt=_LITTLE)
    doubt = None
    if not contest.sure_axes():
        doubt = f"a direction is not known to {np.degrees(LARGEST_AXIS_SD):.0f} deg"
    elif retraced > _MUCH_RETRACED:
        doubt = "their angles go together, as those of one axis that wanders would"
    elif _over(left_single, left_two) < _NEED_SMALL:
        doubt = "one axis does not leave much more"
    elif not contest.poses.located and not two.leaves_little:
        doubt = "of so much only positions tell whether it is a third rotation"
    return _unless_too_far(contest, "two_axes", gain, doubt=doubt)


def _unless_too_far(contest: Contest, name: Fitted, gain: float, *, doubt: str | None = None) -> Choice:
    """Take a type, approximate where something speaks against it, unless it leaves more than a joint may."""
    tried = contest[name]
    words, leave = JOINT_TYPE_WORDS[name], "leave" if name == "two_axes" else "leaves"
    left_mm = 1000.0 * tried.fit.residual_translation
    if tried.too_far:
        contest.try_all()
        return _none_fits(contest, f"{words} would be preferred, but {leave} {left_mm:.0f} mm")
    left = f"{words} {leave} {np.degrees(tried.fit.residual_rotation):.2g} deg"
    left += f" and {left_mm:.2g} mm RMS" if contest.poses.located else " RMS of rotation"
    if doubt is None and gain >= _NEED_LARGE:
        doubt = (
            f"a richer type leaves {gain:.1f} times less variance, which is within what skin and imperfect joints do"
        )
    if doubt is not None:
        return _chosen(contest, name, "approximate", f"{left}; {doubt}")
    return _chosen(contest, name, "determined", f"{left}; no richer type explains much more")


def _none_fits(contest: Contest, reason: str) -> Choice:
    """Free if no valid type comes within 12 mm, else undetermined."""
    if all(tried.too_far for tried in contest.tried.values() if tried.valid):
        least = min(tried.fit.residual_translation for tried in contest.tried.values() if tried.valid)
        free = f"no joint explains the motion: every type leaves {1000.0 * least:.0f} mm or more"
        return _chosen(contest, "free", "determined", free)
    return _chosen(contest, "undetermined", None, reason)


def _chosen(
    contest: Contest,
    name: JointTypeName,
    status: Literal["determined", "approximate", "forced"] | None,
    reason: str,
) -> Choice:
    for known in _ORDER:
        if known == name:
            contest[known]  # a type that another one stood for is fitted too
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
    if name == "ball" and fit.told is not None:  # its rotations are the measured ones
        return True
    if name == "ball":
        return bool(np.nan_to_num(deviation, nan=np.inf).max() < _LARGEST_CENTER_SD)
    if name != "two_axes":
        return True
    ranges = min(middle_range(fit.mechanism.frames[:, k]) for k in range(2))
    return bool(not is_phantom(fit) and angle_sd(fit).max() < _LARGEST_ANGLE_SD and ranges > _LEAST_RANGE)


def _over(simpler: float, richer: float) -> float:
    return simpler / max(richer, _TINY)


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
