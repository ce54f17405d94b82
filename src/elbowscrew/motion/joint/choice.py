"""Which joint it is: rigid, one axis, two axes, a ball, none of them, or undetermined.

Real joints are no exact mechanisms, so that chi-square and BIC call each of them free, and held-out frames alone prefer
the richest type. A richer type must therefore leave several times less of the *held-out* frames than the simpler one
does: twice where what the simpler one misses is large (10 deg), ten times where it is small enough to be skin.
"""

from __future__ import annotations

from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.geometry.arrays import Index
from elbowscrew.model.joint_type import JointTypeName, TypeCandidate
from elbowscrew.motion.joint.contest import LARGEST_AXIS_SD, NEED_LARGE, NEED_SMALL, ORDER, Contest, over
from elbowscrew.motion.joint.fitting import Fitted
from elbowscrew.motion.joint.likelihood import Fit, Mechanism
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.quantities import in_digits

_EXPLAINED: Final = 1.15
_TIMES_BETTER: Final = 1.5
# Share of what a richer type explains that one axis, free to move with the angle, explains as well.
_ALL_RETRACED: Final = 0.9
_MUCH_RETRACED: Final = 0.5
_LARGEST_WANDER: Final = np.radians(15.0)
_WANDERS: Final = "an axis that wanders with the angle explains as much as two axes do"
_MANY_TIMES: Final = 1000.0
_HARDLY: Final = "so little motion tells no axis"
_NO_CENTER: Final = "whether it turns about one center, orientations alone do not tell"
_NO_ORDER: Final = "it hardly turns about both at once, which would tell which of them goes with which body"
_OUTLIERS: Final = "as outliers have it, which a robust fit would weigh down"
_SOFT: Final = "as skin on a long lever leaves it"
_LITTLE: Final = "a second rotation is seen, but is too small to tell its axis"


class Choice(NamedTuple):
    """The type, how sure it is, why, what all types that were tried leave, and which of two axes goes with which body.

    The last is told where axes in the other order leave much more. Beside one axis, where two were tried, there is the
    RMS rotation (rad) that it leaves beyond the noise. All are of those rows of the poses. The center of a stated ball
    is not told where one axis explains the motion.
    """

    type: JointTypeName
    status: Literal["determined", "approximate", "forced"] | None
    reason: str
    candidates: tuple[TypeCandidate, ...]
    fits: dict[str, Fit[Mechanism]]
    order_told: bool
    rotation_left: float
    rows: Index
    center_told: bool = True


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
        chosen = _chosen(contest, forced, "forced", f"{JOINT_TYPE_WORDS[forced]}, as stated")
        return chosen._replace(center_told=forced != "ball" or not contest.turns_about_one_axis())
    if contest["rigid"].hardly_moves:
        limit = _EXPLAINED if noise_known else NEED_LARGE * contest.floor("rigid")
        return _unless_too_far(contest, "rigid", 0.0, doubt=None if contest.heldout("rigid") <= limit else _HARDLY)
    return (_explained(contest) if noise_known else None) or _best(contest)


def _explained(contest: Contest) -> Choice | None:
    """Take the simplest type that the stated noise explains; None if it explains none."""
    for name in contest.order:
        tried = contest[name]
        # What leaves more of the frames it was fitted to leaves no less of others.
        if not tried.valid or tried.fit.variance > _EXPLAINED or contest.heldout(name) > _EXPLAINED:
            continue
        if name == "screw_hinge" and contest.one == "hinge":
            continue
        if name in ("two_axes", "ball"):
            less = contest.one if name == "two_axes" else contest.rival_of_ball
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
    retraced = over(single - contest.heldout_wandering(contest.one), single - two)
    return contest.hardly_turns() or not contest.sure_axes() or retraced > _MUCH_RETRACED


def _best(contest: Contest) -> Choice:
    """Take the simplest type that no richer one beats by enough."""
    if over(contest.heldout("rigid"), contest.floor("rigid")) < contest["rigid"].need:
        return _unless_too_far(contest, "rigid", 0.0)
    one = contest.one
    if over(contest.heldout(one), contest.floor(one)) < NEED_LARGE:
        return _unless_too_far(contest, one, 0.0)
    rigid, single, two = contest["rigid"], contest[one], contest["two_axes"]
    names: tuple[Fitted, ...] = ("rigid", one, "two_axes")
    left_rigid, left_single, left_two = (contest.heldout(name) for name in names)
    left_ball = contest.heldout("ball") if contest.poses.located else np.inf
    ball_valid = contest.poses.located and contest["ball"].valid
    gain = over(left_rigid, min(left_single, left_two, left_ball))
    if gain < rigid.need:
        return _unless_too_far(contest, "rigid", gain)
    least = min(left_two, left_ball if ball_valid else np.inf)
    gain = over(left_single, least)
    if gain < single.need or single.leaves_little:
        return _unless_too_far(contest, one, gain)
    retraced = over(left_single - contest.heldout_wandering(one), left_single - least)
    if retraced > _ALL_RETRACED and single.range_left < _LARGEST_WANDER:
        return _unless_too_far(contest, one, gain, doubt=_WANDERS)
    rival = contest.rival_of_ball
    gain = over(contest.heldout(rival), left_ball)
    if ball_valid and gain >= contest[rival].need:
        return _unless_too_far(contest, "ball", 0.0)
    if not contest.poses.located and two.leaves_much:
        left = f"two axes leave {in_digits(np.degrees(two.fit.residual_rotation))} deg RMS of rotation; {_NO_CENTER}"
        return _chosen(contest, "ball", "approximate", left)
    if not two.valid:
        return _none_fits(contest, "more than one axis moves, but too little or too noisily to tell the second")
    if contest.hardly_turns():
        return _unless_too_far(contest, one, 0.0, doubt=_LITTLE)
    doubt = None
    if not contest.sure_axes():
        doubt = f"a direction is not known to {np.degrees(LARGEST_AXIS_SD):.0f} deg"
    elif retraced > _MUCH_RETRACED:
        doubt = "what one axis leaves goes with its angle, as where that axis wanders"
    elif over(left_single, left_two) < NEED_SMALL:
        doubt = "one axis does not leave much more"
    elif not contest.poses.located and not two.leaves_little:
        doubt = "of so much only positions tell whether it is a third rotation"
    return _unless_too_far(contest, "two_axes", gain, doubt=doubt)


def _unless_too_far(contest: Contest, name: Fitted, gain: float, *, doubt: str | None = None) -> Choice:
    """Take a type, approximate where something speaks against it, unless it leaves more than a joint may."""
    tried = contest[name]
    words, leave = JOINT_TYPE_WORDS[name], "leave" if name == "two_axes" else "leaves"
    left_mm = 1000.0 * tried.fit.residual_translation
    if contest.too_far(name):
        contest.try_all()
        return _none_fits(contest, f"{words} would be preferred, but {leave} {left_mm:.0f} mm")
    left = f"{words} {leave} {in_digits(np.degrees(tried.fit.residual_rotation))} deg"
    left += f" and {in_digits(left_mm)} mm RMS" if contest.poses.located else " RMS of rotation"
    if doubt is None and gain >= NEED_LARGE:
        times = "over 1000" if gain > _MANY_TIMES else f"{gain:.1f}"
        doubt = f"a richer type leaves {times} times less variance, which is within what skin and imperfect joints do"
    if doubt is not None:
        return _chosen(contest, name, "approximate", f"{left}; {doubt}")
    return _chosen(contest, name, "determined", f"{left}; no richer type explains much more")


def _none_fits(contest: Contest, reason: str) -> Choice:
    """Free if no valid type comes within 12 mm, and not for outliers, else undetermined."""
    valid = [name for name, tried in contest.tried.items() if tried.valid]
    if all(contest.too_far(name) for name in valid):
        least = min(valid, key=lambda name: contest[name].fit.residual_translation)
        left = f"every type leaves {1000.0 * contest[least].fit.residual_translation:.0f} mm or more"
        if contest.left_by_few_frames(least):
            return _chosen(contest, "undetermined", None, f"{left}, but most of it in few frames, {_OUTLIERS}")
        if not contest.leaves_more_than_skin(least):
            return _chosen(contest, "undetermined", None, f"{left}, a small part of what moves, {_SOFT}")
        return _chosen(contest, "free", "determined", f"no joint explains the motion: {left}")
    return _chosen(contest, "undetermined", None, reason)


def _chosen(
    contest: Contest,
    name: JointTypeName,
    status: Literal["determined", "approximate", "forced"] | None,
    reason: str,
) -> Choice:
    for known in ORDER:
        if known == name:
            contest[known]  # a type that another one stood for is fitted too
    order_told = name != "two_axes" or contest.tells_order()
    if not order_told and status == "determined":
        status, reason = "approximate", f"{reason}; {_NO_ORDER}"
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
        for tried_name, tried in ((k, contest.tried[k]) for k in ORDER if k in contest.tried)
    )
    tried = contest.tried
    left = 0.0
    if "two_axes" in tried and (name == "hinge" or name == "screw_hinge"):
        left = contest.rotation_beyond_noise(name)
    return Choice(
        type=name,
        status=status,
        reason=reason,
        candidates=candidates,
        fits={key: one.fit for key, one in tried.items()},
        order_told=order_told,
        rotation_left=left,
        rows=contest.rows,
    )
