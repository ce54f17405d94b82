"""When the joint moves and when it rests, and its flexion-extension cycles."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.model import MovementPhases

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

# Movement is what exceeds this share of the highest speed, the one that is exceeded for as long as the shortest
# movement: a spike is no speed, and a rest may be as long as it likes.
_SPEED_SHARE: Final = 0.05
# It turns the joint by this share of what the largest movement does: noise and tremor do not.
_TRAVEL_SHARE: Final = 0.01
_SHORTEST_REST_S: Final = 0.25
_SHORTEST_MOVE_S: Final = 0.1
_SLOPE_REACH_S: Final = 0.1
_CLOCK_ROUNDING_S: Final = 1e-6
# A cycle rises and falls by this share of the whole range, and by so many degrees at least.
_PROMINENCE_SHARE: Final = 0.3
_LEAST_PROMINENCE: Final = float(np.radians(5.0))
# A rest belongs to the foot of a cycle within this share of its rise.
_FOOT_SHARE: Final = 0.1


def movement_phases(angular_velocity: Float, elapsed: Float) -> MovementPhases:
    """Find the movements between rests: where the speed is over 5 % of its highest.

    Parameters
    ----------
    angular_velocity : ndarray, shape (N,)
        Of filtered poses, rad/s; NaN where it is not known. Less than 0.25 s of that count as the next frame where it
        is, more count as movement only where there is some on both sides.
    elapsed : ndarray, shape (N,)
        Seconds.

    Returns
    -------
    MovementPhases
        Rests shorter than 0.25 s, as at an inversion, are no such; nor then are movements shorter than 0.1 s, or of
        less than a hundredth of the largest one's angle.
    """
    count = angular_velocity.size
    known = np.flatnonzero(np.isfinite(angular_velocity))
    if not known.size:
        none = np.empty(0, dtype=np.int64)
        return MovementPhases(onset_rows=none, offset_rows=none, moving=np.zeros(count, dtype=np.bool_), threshold=0.0)
    speed = np.abs(angular_velocity[known])
    brief = int(np.clip(np.rint(_SHORTEST_MOVE_S / _frame_time(elapsed)), 1, speed.size))
    threshold = _SPEED_SHARE * float(np.partition(speed, -brief)[-brief])
    moving = _bridged(speed > threshold, known, elapsed)
    moving = ~_without_short(~moving, elapsed, _SHORTEST_REST_S)
    moving = _without_short(moving, elapsed, _SHORTEST_MOVE_S)
    first, last = runs_of(moving)
    travel = _travel(angular_velocity, elapsed, first, last)
    real = travel >= _TRAVEL_SHARE * travel.max(initial=0.0)
    for begin, end in zip(first[~real], last[~real], strict=True):
        moving[begin : end + 1] = False
    return MovementPhases(onset_rows=first[real], offset_rows=last[real], moving=moving, threshold=threshold)


def velocity_everywhere(angular_velocity: Float, angle: Float, elapsed: Float) -> Float:
    """Angular velocity, where that of the filtered poses is not known by the angle's slope over a fifth of a second.

    Near gaps and ends, where a filter leaves most of the noise, the joint need not rest.

    Parameters
    ----------
    angular_velocity : ndarray, shape (N,)
        Of filtered poses, rad/s; NaN where it is not known.
    angle : ndarray, shape (N,)
        Screw angle, continuous, radians; NaN where there is no pose.
    elapsed : ndarray, shape (N,)
        Seconds.

    Returns
    -------
    ndarray, shape (N,)
        NaN where the angle is not known, or not for long enough.
    """
    known = np.flatnonzero(np.isfinite(angle))
    wanted = known[~np.isfinite(angular_velocity[known])]
    if not wanted.size:
        return angular_velocity
    # A window's ends may lie a little beside a frame's own time.
    early = np.searchsorted(elapsed[known], elapsed[wanted] - _SLOPE_REACH_S - _CLOCK_ROUNDING_S)
    late = np.searchsorted(elapsed[known], elapsed[wanted] + _SLOPE_REACH_S + _CLOCK_ROUNDING_S, side="right") - 1
    early, late = known[early], known[late]
    span = elapsed[late] - elapsed[early]
    enough = span >= 0.5 * _SLOPE_REACH_S
    velocity = angular_velocity.copy()
    velocity[wanted[enough]] = (angle[late] - angle[early])[enough] / span[enough]
    return velocity


def find_cycles(angle: Float, phases: MovementPhases) -> NDArray[np.int64]:
    """Find the flexion-extension cycles: peaks that rise and fall by 30 % of the whole range, and 5 deg at least.

    Parameters
    ----------
    angle : ndarray, shape (N,)
        Continuous, radians; NaN in gaps.
    phases : MovementPhases
        Where a rest lies at the foot of a cycle, the cycle begins when it ends, and ends when it begins.

    Returns
    -------
    ndarray of int64, shape (R, 3)
        Rows of start, inversion (the largest angle) and end. A movement that does not return is no cycle.
    """
    known = np.flatnonzero(np.isfinite(angle))
    if known.size < 3:
        return np.empty((0, 3), dtype=np.int64)
    series = angle[known]
    prominence = max(_PROMINENCE_SHARE * float(np.ptp(series)), _LEAST_PROMINENCE)
    turns = turning_points(series, prominence)
    tops = turns[1:-1][series[turns[1:-1]] > series[turns[:-2]]] if turns.size > 2 else np.empty(0, dtype=np.int64)
    resting = ~phases.moving[known]
    cycles = []
    for top in tops.tolist():
        place = int(np.searchsorted(turns, top))
        start = _foot(series, resting, int(turns[place - 1]), top)
        end = _foot(series, resting, int(turns[place + 1]), top)
        cycles.append((known[start], known[top], known[end]))
    return np.array(cycles, dtype=np.int64).reshape(-1, 3)


def turning_points(series: Float, swing: float) -> NDArray[np.int64]:
    """Extrema between which a series (N,) swings by at least so much, lows and highs in turn, its ends among them.

    Every high found is a peak of at least that prominence, and every low one of the series upside down.
    """
    bends = np.flatnonzero(np.diff(np.sign(np.diff(series)))) + 1
    candidates = np.concatenate([[0], bends, [series.size - 1]])
    values = series[candidates]
    low = high = 0
    sense = 0
    found: list[int] = []
    for k, value in enumerate(values.tolist()):  # over the extrema, not over the frames
        low, high = (k if value < values[low] else low), (k if value > values[high] else high)
        if sense >= 0 and value <= values[high] - swing:
            found.append(high)
            low = high = k
            sense = -1
        elif sense <= 0 and value >= values[low] + swing:
            found.append(low)
            low = high = k
            sense = 1
    last = high if sense > 0 else low
    if found and last not in found:
        found.append(last)
    return np.asarray(candidates[found], dtype=np.int64)


def _foot(series: Float, resting: Bool, low: int, top: int) -> int:
    """Row between a low and a top at which the joint last rests near the low; the low itself if it does not."""
    rows = np.arange(low, top) if low < top else np.arange(low, top, -1)
    near = series[rows] <= series[low] + _FOOT_SHARE * (series[top] - series[low])
    rests = np.flatnonzero(resting[rows] & near)
    return int(rows[rests[-1]]) if rests.size else low


def _frame_time(elapsed: Float) -> float:
    return float(np.median(np.diff(elapsed))) if elapsed.size > 1 else 1.0


def _bridged(moving: Bool, known: NDArray[np.intp], elapsed: Float) -> Bool:
    """Movement in all rows, of that in the known ones."""
    rows = np.arange(elapsed.size)
    before, after = np.searchsorted(known, rows, side="right") - 1, np.searchsorted(known, rows)
    inner = (before >= 0) & (after < known.size)
    before, after = before.clip(0), after.clip(max=known.size - 1)
    begin = np.where(rows < known[0], elapsed[0], elapsed[known[before]])
    end = np.where(rows > known[-1], elapsed[-1], elapsed[known[after]])
    return np.where(end - begin < _SHORTEST_REST_S, moving[after], inner & moving[before] & moving[after])


def _travel(angular_velocity: Float, elapsed: Float, first: NDArray[np.int64], last: NDArray[np.int64]) -> Float:
    """Angle between the extremes of each movement, shape (M,), of its velocity alone."""
    turned = np.cumsum(np.nan_to_num(angular_velocity) * np.gradient(elapsed)) if elapsed.size > 1 else np.zeros(1)
    return np.array([np.ptp(turned[begin : end + 1]) for begin, end in zip(first, last, strict=True)])


def runs_of(mask: Bool) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First and last row of every run of True, shape (R,) each."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return edges[::2].astype(np.int64), edges[1::2].astype(np.int64) - 1


def _without_short(mask: Bool, elapsed: Float, shortest: float) -> Bool:
    """Take out runs of True that last less than `shortest` seconds, but for those at the ends of the recording."""
    first, last = runs_of(mask)
    inner = (first > 0) & (last < mask.size - 1)
    short = inner & (elapsed[last] - elapsed[first] < shortest)
    kept = mask.copy()
    for begin, end in zip(first[short], last[short], strict=True):
        kept[begin : end + 1] = False
    return kept
