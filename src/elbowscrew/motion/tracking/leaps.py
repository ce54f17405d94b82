"""Where a body goes farther from one pose to the next than a body can."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np

from elbowscrew.geometry import quaternion
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.model import QualityWarning, Recording, RigidBody, TrackingLoss
from elbowscrew.motion.difference import angle_between, turn_and_distance
from elbowscrew.motion.tracking.losses import as_lost, frames_of, frames_warning, poses_at
from elbowscrew.settings import Settings

# What a body may do between two poses: its speed limits, with a floor for noise and a cap that a flip or a swap breaks
# however long the time between them is, up to where it may be anywhere. Over a gap it may turn as far as it would at
# the speed of the frames beside it, and a share more: a crank goes on turning.
_TURN_FLOOR: Final = np.radians(5.0)
_DISTANCE_FLOOR_M: Final = 0.02
_SHORT_STEP_S: Final = 0.1
_LARGEST_TURN: Final = (np.radians(120.0), np.radians(150.0))
_LARGEST_DISTANCE_M: Final = (0.5, 1.0)
_LONGEST_STEP_S: Final = 2.0
_ROOM_OVER_GAP: Final = 1.25
_STEPS_BESIDE: Final = 5

# A single pose this far out, whose neighbors are near each other, is a spike below any limit of speed.
_SPIKE_TURN: Final = np.radians(15.0)
_SPIKE_DISTANCE_M: Final = 0.06
_SPIKE_SHARE: Final = 0.25

LONGEST_EXCURSION_S: Final = 1.0
"""What leaves a motion for longer is a motion of its own."""

# So many steps beyond the limits, each like the one before it to this share, are a fast body and no flips.
_STEADY_STEPS: Final = 3
_STEADY_SHARE: Final = 0.25
_ROOM_ABOVE: Final = 1.2


def without_leaps(
    body: RigidBody, recording: Recording, elapsed: Float, settings: Settings, warnings: list[QualityWarning]
) -> tuple[RigidBody, Index, Index]:
    """Take out spikes and short excursions; tell of leaps behind which the motion goes on elsewhere.

    Returns
    -------
    body : RigidBody
    arrivals, unresolved : ndarray of int
        Rows at which the body arrives by a leap; those of them that no excursion explains.
    """
    known = np.flatnonzero(body.tracked)
    nothing = known[:0]
    if known.size < 2:
        return body, nothing, nothing
    steps = _Steps(body.dual_quat_lab_body, elapsed, 1.0 / recording.rate_hz, settings)
    spikes = steps.spikes(known)
    steady = np.setdiff1d(known, spikes, assume_unique=True)
    leaps = np.flatnonzero(~steps.possible(steady[:-1], steady[1:]))
    outside, unresolved = _excursions(np.split(steady, leaps + 1), steps, elapsed)
    lost = np.sort(np.concatenate([spikes, outside]))
    fast = steps.steady_turn(steady, leaps)
    arrivals = steady[leaps + 1]
    limits = steps.limits(settings)
    if lost.size:
        beyond = np.sort(np.concatenate([arrivals, spikes]))  # where an excursion begins or ends
        before = known[np.searchsorted(known, beyond) - 1]
        message = (
            f"body {body.name!r} leaps out of its motion{steps.told(before, beyond)}: {frames_of(lost, recording)} "
            f"taken as lost ({limits}){_if_it_is_real(fast)}"
        )
        warnings.append(frames_warning("leap", message, lost, recording))
    if unresolved.size:
        before = known[np.searchsorted(known, unresolved) - 1]
        message = (
            f"body {body.name!r} leaps{steps.told(before, unresolved)} at {frames_of(unresolved, recording)} and goes "
            f"on there: flipped, swapped or another body from there on, or up to there; look at the recording "
            f"({limits}){_if_it_is_real(fast)}"
        )
        warnings.append(frames_warning("leap-unresolved", message, unresolved, recording))
    return as_lost(body, lost, TrackingLoss.LEAP), np.union1d(arrivals, spikes), unresolved


class _Steps:
    """How far a body goes from one row to another, and whether it can."""

    def __init__(self, pose: Float, elapsed: Float, period_s: float, settings: Settings) -> None:
        self._pose, self._elapsed, self._period_s = pose, elapsed, period_s
        self._turn_limit, self._speed_limit = np.radians(settings.max_turn_deg_s), settings.max_speed_m_s

    def possible(self, start: Index, end: Index) -> Bool:
        """Whether a body goes from one pose to the other in the time between.

        Frames are a period apart at the least, whatever a jittering clock says.
        """
        time_s = np.maximum(np.abs(self._elapsed[end] - self._elapsed[start]), self._period_s)
        turn, distance = self._between(start, end)
        short = time_s <= _SHORT_STEP_S
        largest_turn: Float = np.asarray(_LARGEST_TURN)[np.where(short, 0, 1)]
        over_gap = np.flatnonzero(~short & (turn > largest_turn))
        largest_turn[over_gap] = np.maximum(
            largest_turn[over_gap], _ROOM_OVER_GAP * self._turn_beside(start[over_gap], end[over_gap], time_s[over_gap])
        )
        largest_distance = np.where(short, *_LARGEST_DISTANCE_M)
        near: Bool = (turn <= np.minimum(self._turn_limit * time_s + _TURN_FLOOR, largest_turn)) & (
            distance <= np.minimum(self._speed_limit * time_s + _DISTANCE_FLOOR_M, largest_distance)
        )
        possible: Bool = near | (time_s > _LONGEST_STEP_S)
        return possible

    @cached_property
    def _known(self) -> Index:
        return np.flatnonzero(np.isfinite(self._pose).all(axis=1))

    def limits(self, settings: Settings) -> str:
        """Say what a step may be at most."""
        turns, distances = np.degrees(_LARGEST_TURN), _LARGEST_DISTANCE_M
        return (
            f"limits {settings.max_turn_deg_s:g} deg/s (--max-turn) and {settings.max_speed_m_s:g} m/s (--max-speed), "
            f"and {turns[0]:.0f} deg and {distances[0]:g} m within {_SHORT_STEP_S:g} s, {turns[1]:.0f} deg, or what "
            f"the speed beside a gap makes of it, and {distances[1]:g} m within {_LONGEST_STEP_S:g} s"
        )

    def _turn_beside(self, start: Index, end: Index, time_s: Float) -> Float:
        """Turn (rad) over a gap at the mean speed of the frames before and after it."""
        speed = np.zeros(start.size)
        if not start.size:
            return speed
        for row, away in ((start, -_STEPS_BESIDE), (end, _STEPS_BESIDE)):
            other = self._known[np.clip(np.searchsorted(self._known, row) + away, 0, self._known.size - 1)]
            apart = np.maximum(np.abs(self._elapsed[row] - self._elapsed[other]), self._period_s)
            speed += 0.5 * angle_between(self._pose[row], self._pose[other]) / apart
        return speed * time_s

    def spikes(self, known: Index) -> Index:
        """Rows of single poses far out of two neighbors that are near each other."""
        before, here, after = known[:-2], known[1:-1], known[2:]
        soon = self._elapsed[after] - self._elapsed[before] <= LONGEST_EXCURSION_S
        steps, across = self._between(known[:-1], known[1:]), self._between(before, after)
        spike = np.zeros(here.size, dtype=np.bool_)
        for step, past, least in zip(steps, across, (_SPIKE_TURN, _SPIKE_DISTANCE_M), strict=True):
            nearer = np.minimum(step[:-1], step[1:])
            spike |= (nearer > least) & (past < _SPIKE_SHARE * nearer)
        rows: Index = here[spike & soon]
        # Of two in a row neither is single: they are left to the limits of a step.
        return rows[~(np.isin(rows - 1, rows) | np.isin(rows + 1, rows))]

    def steady_turn(self, rows: Index, leaps: Index) -> float | None:
        """Fastest turn (deg/s) in a run of leaps that are alike; None where leaps are single or differ.

        Parameters
        ----------
        rows : ndarray of int
            Rows of the poses that are no spikes.
        leaps : ndarray of int
            Steps between them that are not possible.
        """
        if leaps.size < _STEADY_STEPS:
            return None
        start, end = self._pose[rows[leaps], :4], self._pose[rows[leaps + 1], :4]
        step = quaternion.multiply(quaternion.conjugate(start), end)
        step = np.where(step[:, :1] < 0.0, -step, step)
        half_sine = length(step[:, 1:])
        angle = 2.0 * np.arctan2(half_sine, step[:, 0])
        turn = step[:, 1:] * (angle / np.maximum(half_sine, np.finfo(float).tiny))[:, None]
        time_s = np.maximum(self._elapsed[rows[leaps + 1]] - self._elapsed[rows[leaps]], self._period_s)
        rate = turn / time_s[:, None]
        size = length(rate)
        alike = (np.diff(leaps) == 1) & (length(np.diff(rate, axis=0)) <= _STEADY_SHARE * size[1:])
        # Ends of runs: the sum of the last so many comparisons is full.
        full = np.convolve(alike, np.ones(_STEADY_STEPS - 1), mode="valid") == _STEADY_STEPS - 1
        return float(np.degrees(size[_STEADY_STEPS - 1 :][full].max())) if full.any() else None

    def told(self, start: Index, end: Index) -> str:
        """Tell of the largest step."""
        turn, distance = self._between(start, end)
        return f" by up to {np.degrees(turn.max(initial=0.0)):.0f} deg and {1000 * distance.max(initial=0.0):.0f} mm"

    def _between(self, start: Index, end: Index) -> tuple[Float, Float]:
        return turn_and_distance(poses_at(self._pose, start), poses_at(self._pose, end))


def _if_it_is_real(turn_deg_s: float | None) -> str:
    """Tell of a body that turns faster than the limit but evenly, and of the option that keeps it."""
    if turn_deg_s is None:
        return ""
    enough = 100.0 * np.ceil(_ROOM_ABOVE * turn_deg_s / 100.0 - 1e-6)
    return (
        f"; it turns evenly there, at up to {turn_deg_s:.0f} deg/s, as a fast body does and a flip does not: if that "
        f"is real, --max-turn {enough:.0f} keeps it"
    )


def _excursions(segments: Sequence[Index], steps: _Steps, elapsed: Float) -> tuple[Index, Index]:
    """Rows of segments that do not join the motion, and rows where the motion itself goes on elsewhere.

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
            if steps.possible(np.array([good]), segment[[near]])[0]:
                good = segment[far]
            elif abs(elapsed[segment[-1]] - elapsed[segment[0]]) <= LONGEST_EXCURSION_S:
                outside.append(segment)
            else:
                unresolved.append(int(segment[0] if near == 0 else segments[k + 1][0]))
                good = segment[far]
    rows = np.sort(np.concatenate(outside)) if outside else segments[0][:0]
    return rows, np.array(sorted(unresolved), dtype=np.intp)
