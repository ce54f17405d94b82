"""Which poses of a body are measurements: sentinels, frozen poses and leaps are not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import sclerp
from elbowscrew.geometry.dual_quaternion import align_signs
from elbowscrew.model import QualityWarning, Recording, RigidBody, TrackingLoss
from elbowscrew.motion.difference import angle_between, origin_distance
from elbowscrew.settings import Settings

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Index = NDArray[np.intp]

# An exact identity this far from where its neighbors put the body is what is written for a body that is not solved.
_SENTINEL_TURN: Final = np.radians(2.0)
_SENTINEL_DISTANCE_M: Final = 0.02

# Over a longer step than this a body may be anywhere; an excursion longer than this is not taken for one.
_LONGEST_STEP_S: Final = 0.1
_LONGEST_STEP_FRAMES: Final = 1.5
_LONGEST_EXCURSION_S: Final = 1.0
_LARGEST_TURN: Final = np.radians(120.0)
_LARGEST_DISTANCE_M: Final = 0.5

# Two bodies are swapped if each comes to lie where the other was, much nearer than to where it was itself.
_CROSSED_SHARE: Final = 0.25
_LEAST_SWAP_M: Final = 0.05

_FRAMES_TOLD: Final = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedBody:
    """A body without the poses that are no measurements.

    Attributes
    ----------
    body : RigidBody
    warnings : tuple of QualityWarning
    leap_rows : ndarray of int, shape (L,)
        Rows at which the body arrives by a leap.
    """

    body: RigidBody
    warnings: tuple[QualityWarning, ...]
    leap_rows: Index


def check_tracking(body: RigidBody, recording: Recording, elapsed: Float, settings: Settings) -> CheckedBody:
    """Mark the frames in which the body's pose is no measurement, and say why.

    Parameters
    ----------
    body : RigidBody
    recording : Recording
        Gives the frame numbers.
    elapsed : ndarray, shape (N,)
        Seconds.
    settings : Settings
        What is done with frozen poses, and the limits of a step.
    """
    warnings: list[QualityWarning] = []
    body = _without_sentinels(body, recording, elapsed, warnings)
    if settings.frozen == "lost":
        body = _without_frozen(body, recording, warnings)
    body, leap_rows = _without_leaps(body, recording, elapsed, settings, warnings)
    return CheckedBody(body=body, warnings=tuple(warnings), leap_rows=leap_rows)


def _without_sentinels(
    body: RigidBody, recording: Recording, elapsed: Float, warnings: list[QualityWarning]
) -> RigidBody:
    """Take out single frames of no rotation at all that do not fit the frames around them."""
    pose = body.dual_quat_lab_body
    known = np.flatnonzero(body.tracked)
    identity = known[(pose[known, 1:4] == 0.0).all(axis=1)]
    others = np.setdiff1d(known, identity)
    if not identity.size or others.size < 2:
        return body
    # Between two neighbors, or beyond the first two or the last two.
    after = np.clip(np.searchsorted(others, identity), 1, others.size - 1)
    start, end = others[after - 1], others[after]
    fraction = (elapsed[identity] - elapsed[start]) / (elapsed[end] - elapsed[start])
    expected = sclerp(pose[start], pose[end], fraction)
    off = (angle_between(pose[identity], expected) > _SENTINEL_TURN) | (
        origin_distance(pose[identity], expected) > _SENTINEL_DISTANCE_M
    )
    rows = identity[off]
    if not rows.size:
        return body
    message = (
        f"body {body.name!r} has no rotation at all, out of its motion, in {_frames(rows, recording)}: taken as lost"
    )
    warnings.append(frames_warning("identity-pose", message, rows, recording))
    return _lost(body, rows, TrackingLoss.ZERO)


def _without_frozen(body: RigidBody, recording: Recording, warnings: list[QualityWarning]) -> RigidBody:
    """Take out poses that repeat the one before.

    A tracked body does not repeat a pose to the last digit, not even at rest: a pose that repeats the one before (up
    to the sign of its quaternion) is lost tracking, and the first of such a run is its last measurement. A body with
    one and the same pose in every frame is a fixed reference and kept, unless that pose is no rotation at the very
    origin, which is what is written for a body that was never solved.
    """
    pose = body.dual_quat_lab_body
    known = np.flatnonzero(body.tracked)
    if known.size < 2:
        return body
    if (align_signs(pose[known], pose[known[0]]) == pose[known[0]]).all():
        if (pose[known[0], 1:] == 0.0).all():
            message = (
                f"body {body.name!r} stands at the very origin without rotation in every frame, as a body does that "
                "was never solved: taken as not tracked (--frozen keep takes it as it is)"
            )
            warnings.append(QualityWarning(code="never-solved", message=message))
            return _lost(body, known, TrackingLoss.ZERO)
        message = f"body {body.name!r} has the same pose in every frame: taken as a fixed reference"
        warnings.append(QualityWarning(code="fixed-body", message=message))
        return body
    repeats = (align_signs(pose[known[1:]], pose[known[:-1]]) == pose[known[:-1]]).all(axis=1) & (np.diff(known) == 1)
    rows = known[1:][repeats]
    if not rows.size:
        return body
    message = (
        f"body {body.name!r} repeats its pose to the last digit in {_frames(rows, recording)}: taken as lost tracking "
        "(--frozen keep turns this off)"
    )
    warnings.append(frames_warning("frozen", message, rows, recording))
    return _lost(body, rows, TrackingLoss.FROZEN)


def _without_leaps(
    body: RigidBody, recording: Recording, elapsed: Float, settings: Settings, warnings: list[QualityWarning]
) -> tuple[RigidBody, Index]:
    """Take out short excursions from the motion; tell of leaps that lead to where no way leads back."""
    known = np.flatnonzero(body.tracked)
    if known.size < 2:
        return body, known[:0]
    steps = _Steps(body.dual_quat_lab_body, elapsed, settings)
    longest_s = max(_LONGEST_STEP_S, _LONGEST_STEP_FRAMES / recording.rate_hz)
    leaps = np.flatnonzero(~steps.possible(known[:-1], known[1:], longest_s))
    if not leaps.size:
        return body, known[:0]
    segments = np.split(known, leaps + 1)
    outside, unresolved = _excursions(segments, steps, elapsed)
    arrivals = known[leaps + 1]
    limits = f"limits {settings.max_turn_deg_s:g} deg/s and {settings.max_speed_m_s:g} m/s: --max-turn, --max-speed"
    if outside.size:
        message = (
            f"body {body.name!r} leaps out of its motion and back, {steps.told(known, leaps)}: "
            f"{_frames(outside, recording)} taken as lost ({limits})"
        )
        warnings.append(frames_warning("leap", message, outside, recording))
    if unresolved.size:
        message = (
            f"body {body.name!r} leaps at {_frames(unresolved, recording)} and does not come back within "
            f"{_LONGEST_EXCURSION_S:g} s, {steps.told(known, leaps)}: flipped, swapped or another body from there on; "
            f"look at the recording ({limits})"
        )
        warnings.append(frames_warning("leap-unresolved", message, unresolved, recording))
    return _lost(body, outside, TrackingLoss.LEAP), arrivals


class _Steps:
    """How far a body goes from one row to another, and whether it can."""

    def __init__(self, pose: Float, elapsed: Float, settings: Settings) -> None:
        self._pose, self._elapsed = pose, elapsed
        self._turn_limit, self._speed_limit = np.radians(settings.max_turn_deg_s), settings.max_speed_m_s

    def possible(self, start: Index, end: Index, longest_s: float) -> Bool:
        """Whether a body goes from one pose to the other in the time between; true where that time is long."""
        time_s = np.abs(self._elapsed[end] - self._elapsed[start])
        turn = angle_between(self._pose[start], self._pose[end])
        distance = origin_distance(self._pose[start], self._pose[end])
        near = (turn <= np.minimum(self._turn_limit * time_s, _LARGEST_TURN)) & (
            distance <= np.minimum(self._speed_limit * time_s, _LARGEST_DISTANCE_M)
        )
        possible: Bool = near | (time_s > longest_s)
        return possible

    def told(self, known: Index, leaps: Index) -> str:
        """Tell of the largest leap."""
        turn = np.degrees(angle_between(self._pose[known[leaps]], self._pose[known[leaps + 1]]))
        distance = origin_distance(self._pose[known[leaps]], self._pose[known[leaps + 1]])
        return f"by up to {turn.max():.0f} deg and {1000 * distance.max():.0f} mm in one step"


def _excursions(segments: Sequence[Index], steps: _Steps, elapsed: Float) -> tuple[Index, Index]:
    """Rows of segments that do not join the motion, and rows where the motion itself cannot be joined.

    From the longest segment on, forward and backward, a segment belongs to the motion if its near end can be reached
    from the last one that does. One that cannot is an excursion if it is short, and else a new beginning.
    """
    longest = max(range(len(segments)), key=lambda k: segments[k].size)
    outside: list[Index] = []
    unresolved: list[int] = []
    for order, near, far in ((range(longest + 1, len(segments)), 0, -1), (range(longest - 1, -1, -1), -1, 0)):
        good = segments[longest][far]
        for k in order:
            segment = segments[k]
            if steps.possible(np.array([good]), segment[[near]], _LONGEST_EXCURSION_S)[0]:
                good = segment[far]
            elif abs(elapsed[segment[-1]] - elapsed[segment[0]]) <= _LONGEST_EXCURSION_S:
                outside.append(segment)
            else:
                unresolved.append(int(segment[0] if near == 0 else segments[k + 1][0]))
                good = segment[far]
    rows = np.sort(np.concatenate(outside)) if outside else segments[0][:0]
    return rows, np.array(sorted(unresolved), dtype=np.intp)


def check_swaps(one: RigidBody, other: RigidBody, recording: Recording, elapsed: Float) -> tuple[QualityWarning, ...]:
    """Tell of frames at which two bodies, as they are in the file, take each other's place, be it behind a short gap.

    Parameters
    ----------
    one, other : RigidBody
        Unchecked.
    recording : Recording
        Gives the frame numbers.
    elapsed : ndarray, shape (N,)
        Seconds.
    """
    rows = np.flatnonzero(one.tracked & other.tracked)
    before, after = rows[:-1], rows[1:]
    a, b = one.dual_quat_lab_body, other.dual_quat_lab_body
    moved = (origin_distance(a[after], a[before]), origin_distance(b[after], b[before]))
    crossed = origin_distance(a[after], b[before]) + origin_distance(b[after], a[before])
    swapped = after[
        (crossed < _CROSSED_SHARE * (moved[0] + moved[1]))
        & (np.minimum(*moved) > _LEAST_SWAP_M)
        & (elapsed[after] - elapsed[before] <= _LONGEST_EXCURSION_S)
    ]
    if not swapped.size:
        return ()
    message = (
        f"bodies {one.name!r} and {other.name!r} exchange their places at {_frames(swapped, recording)}: their poses "
        "are swapped from there on or until then; relabel them in Motive"
    )
    return (frames_warning("swapped-bodies", message, swapped, recording),)


def _lost(body: RigidBody, rows: Index, reason: TrackingLoss) -> RigidBody:
    loss = body.loss.copy()
    loss[rows] = reason
    lost = (loss != TrackingLoss.NONE)[:, None]
    return replace(body, loss=loss, dual_quat_lab_body=np.where(lost, np.nan, body.dual_quat_lab_body))


def frames_warning(
    code: str, message: str, rows: Index, recording: Recording, severity: Literal["warning", "note"] = "warning"
) -> QualityWarning:
    """Build a warning about some rows of a recording."""
    told = tuple(recording.frame[rows[:_FRAMES_TOLD]].tolist())
    return QualityWarning(code=code, message=message, severity=severity, frames=told, count=int(rows.size))


def _frames(rows: Index, recording: Recording) -> str:
    first = recording.frame[rows[0]]
    return f"frame {first}" if rows.size == 1 else f"{rows.size} of {recording.frame.size} frames (first {first})"
