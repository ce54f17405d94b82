"""The smallest set of measured poses between which a model stays within a tolerance."""

from __future__ import annotations

import itertools
from collections import deque
from typing import Final, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.model import BodyPoints, Selection
from elbowscrew.motion.difference import displacement_of_error, told_error
from elbowscrew.motion.interpolation.segment_cone import Cone
from elbowscrew.motion.interpolation.segment_errors import JointSeries, PoseTrack
from elbowscrew.quantities import in_digits

# Up to so many frames every pair of them is looked at, and so the best set of each size is known.
MOST_FRAMES_COMPLETE: Final = 600
_BLOCK: Final = 64
# Where along a segment it is probed before all of it is: most segments that fail do so in the middle.
_PROBES: Final = (0.5, 0.25, 0.75)
# Then where those from the rows beside it did: so many rows are kept.
_FAILED: Final = 4
_ROUND_OFF: Final = 1e-9
# To this (m) the sums of squares over all pairs are exact.
_NANOMETERS: Final = 2e-8
# Sets of which one has an error that all larger ones mostly keep to.
_TRIED: Final = 32
# Frames among which the smaller sets of a long recording are looked for.
_THINNED: Final = 400


def select_keyframes(
    pose: Float,
    parameter: Float,
    points: BodyPoints,
    tolerance: float,
    *,
    method: str = "sclerp",
    series: JointSeries | None = None,
    required: Index | None = None,
) -> Selection:
    """Fewest poses between which the RMS displacement stays within a tolerance in every frame.

    The set is optimal: no smaller one stays within the tolerance (dynamic programming over all pairs of poses). Up to
    600 frames it is also, among the sets of its size, one with the least largest error, and among those the one with
    the least RMS error; and the best set of each smaller size is known. Beyond, the smaller sets are the best that 400
    frames, evenly spread, have; their errors are those over all frames.

    Parameters
    ----------
    pose : ndarray, shape (N, 8)
        Sign-continuous unit dual quaternions, all known. The first and the last are keyframes in any case.
    parameter : ndarray, shape (N,)
        Not decreasing: between two keyframes the model is where the parameter is between theirs. Where it stands still
        the model rests, and there is one keyframe at most.
    points : BodyPoints
        What the displacement is averaged over.
    tolerance : float
        Meters; radians where the points stand for orientations alone.
    method : {"sclerp", "sdlb", "joint"}
        How the model goes from one keyframe to the next.
    series : JointSeries, optional
        The joint whose angles ``joint`` interpolates, with these in each row. A pose of which the joint leaves more
        than the tolerance is no keyframe.
    required : ndarray of int, optional
        Rows that must be keyframes.

    Returns
    -------
    Selection
        Rows of `pose`.

    Raises
    ------
    SettingError
        If no set stays within the tolerance: the motion does not rest where the parameter does, or the joint leaves
        more of it.

    References
    ----------
    Bellman 1961 (best approximation by segments); Imai and Iri 1988 (fewest vertices of a polygonal line).

    Examples
    --------
    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> from elbowscrew.motion.difference import points_from_radius
    >>> time = np.linspace(0.0, 1.0, 101)
    >>> there_and_back = dual_quat_from_screw(1.0 - np.abs(2.0 * time - 1.0), 0.0, [0, 0, 1], [0, 0, 0])
    >>> select_keyframes(there_and_back, time, points_from_radius(0.05), 1e-4).row.tolist()
    [0, 50, 100]
    """
    stops = np.unique(np.concatenate([[0, len(pose) - 1], [] if required is None else required])).astype(np.int64)
    track = _Track(PoseTrack.of(pose, points, method, series), parameter, points, method, stops)
    wanted, tolerance = tolerance, displacement_of_error(tolerance, points)
    limit = tolerance * (1.0 + _ROUND_OFF) + _NANOMETERS
    if track.left[stops].max() > limit:
        raise _no_set(track, tolerance)
    complete = len(pose) <= MOST_FRAMES_COMPLETE
    found = _best_of_each_size(track, tolerance, len(pose)) if complete else _thinned_and_fewest(track, tolerance)
    known: dict[tuple[int, int], Float] = {}  # sets of many sizes share most of their segments
    if not found or _errors(track, found[-1], known).max() > limit:
        raise _no_set(track, tolerance)
    errors = [told_error(_errors(track, row, known), points) for row in found]
    return Selection(
        row=found[-1],
        tolerance=wanted,
        frames=len(pose),
        count=np.array([row.size for row in found], dtype=np.int64),
        largest=np.array([error.max() for error in errors]),
        rms=np.array([np.sqrt(np.mean(error**2)) for error in errors]),
        complete=complete,
        as_angle=not points.located,
    )


class _Track(NamedTuple):
    poses: PoseTrack
    parameter: Float
    points: BodyPoints
    method: str
    stops: Index

    @property
    def left(self) -> Float:
        """What the model leaves of each row as a keyframe, m."""
        return self.poses.left

    def fraction(self, first: int, last: Index | int, rows: Index | int) -> Float:
        """How far rows are from one keyframe to the next; at the first where the parameter stands still."""
        span = np.asarray(self.parameter[last] - self.parameter[first])
        moves = span > 0.0
        return np.where(moves, (self.parameter[rows] - self.parameter[first]) / np.where(moves, span, 1.0), 0.0)

    def moved_on(self, first: int) -> int:
        """Give the first row where the parameter is beyond that of a row."""
        return int(np.searchsorted(self.parameter, self.parameter[first], side="right"))

    def reach(self, first: int) -> int:
        """Give the last row that a segment from a row may end at: the next one that must be a keyframe."""
        return int(self.stops[np.searchsorted(self.stops, first, side="right")])


def _errors(track: _Track, keyframes: Index, known: dict[tuple[int, int], Float]) -> Float:
    """RMS displacement of every frame, shape (N,); what segments leave between their ends is kept."""
    error = np.zeros(track.parameter.size)
    error[keyframes] = track.left[keyframes]
    for first, last in itertools.pairwise(keyframes.tolist()):
        rows = np.arange(first + 1, last)
        if rows.size and (first, last) not in known:
            segment = track.poses.segments_from(first, [last])
            seen = track.poses.seen_from(first, rows)
            known[first, last] = segment.displacement(seen, track.fraction(first, last, rows))
        if rows.size:
            error[rows] = known[first, last]
    return error


# Every pair of frames: the best set of each size.


def _best_of_each_size(track: _Track, tolerance: float, most: int) -> list[Index]:
    """Best sets of up to so many rows, from the smallest on, until one is within the tolerance: it may be that none is.

    Each size costs what its longest segment spans, so that all of them together cost little more than the pairs do.
    """
    limit = _easily_kept(track)
    largest, total = _all_pairs(track, limit)
    reached = _least_largest(largest, tolerance, most)
    if any(errors[-1] > limit for errors in reached[track.stops.size - 1 :]):
        largest, total = _all_pairs(track, np.inf)
        reached = _least_largest(largest, tolerance, most)
    found = []
    for segments, errors in enumerate(reached, start=1):
        if np.isfinite(errors[-1]):
            bound = errors[-1] * (1.0 + _ROUND_OFF) + _ROUND_OFF**2
            found.append(_least_total(np.where(largest <= bound, total, np.inf), segments))
    return found


def _least_largest(largest: Float, tolerance: float, most: int) -> list[Float]:
    """Least largest error of a way to each row in one segment, in two, and so on, until it is within the tolerance."""
    reached = [largest[0]]
    while reached[-1][-1] > tolerance and len(reached) < most - 1:
        reached.append(np.maximum(reached[-1][:, None], largest).min(axis=0))
    return reached


def _easily_kept(track: _Track) -> float:
    """Largest error, of some sets with one row more than those that must be keyframes the least."""
    some = np.linspace(0, track.parameter.size - 1, _TRIED).round().astype(np.int64)
    known: dict[tuple[int, int], Float] = {}
    errors = [_errors(track, np.union1d(track.stops, row), known).max() for row in np.setdiff1d(some, track.stops)]
    return min(errors, default=np.inf) * (1.0 + _ROUND_OFF) + _NANOMETERS


def _all_pairs(track: _Track, limit: float) -> tuple[Float, Float]:
    """Largest error and sum of squared errors of the frames between every two rows, shape (N, N); inf backward.

    Also inf where the largest error is over the limit; but to the next row that must be a keyframe it is told.
    """
    count = track.parameter.size
    largest, total = np.full((count, count), np.inf), np.full((count, count), np.inf)
    left = track.left
    for first in range(count - 1):
        every = np.arange(first, track.reach(first) + 1)
        seen, segments = track.poses.seen_from(first, every), track.poses.segments_from(first, every)
        middle = _row_at(track, first, every, 0.5)
        within = segments.displacement(seen[middle - first], track.fraction(first, every, middle)) <= limit
        within[[0, -1]] = False, True
        possible = np.flatnonzero(within) + first
        for start in range(0, possible.size, _BLOCK):
            ends = possible[start : start + _BLOCK]
            rows = np.arange(first + 1, ends[-1])
            largest[first, ends], total[first, ends] = np.maximum(left[first], left[ends]), left[first] ** 2
            if not rows.size:
                continue
            square = segments.at(ends - first).squares(seen[rows - first], track.fraction(first, ends, rows[:, None]))
            square[rows[:, None] >= ends] = 0.0
            largest[first, ends] = np.maximum(largest[first, ends], np.sqrt(square.max(axis=0)))
            total[first, ends] += square.sum(axis=0)
    stands = track.parameter[None, :] <= track.parameter[:, None]
    largest[stands], total[stands] = np.inf, np.inf
    return largest, total


def _least_total(cost: Float, segments: int) -> Index:
    """Rows from the first to the last in so many segments whose costs (N, N) add up to the least; inf where none is."""
    count = len(cost)
    starts, ends = np.nonzero(np.isfinite(cost))
    width = int((ends - starts).max())
    # Column k of a row is the row from which a segment of length width - k ends there.
    rows = np.arange(count)
    origin = rows[:, None] - width + np.arange(width)
    band = np.where(origin >= 0, cost[np.maximum(origin, 0), rows[:, None]], np.inf)
    sums = cost[0].copy()
    before = []
    for _ in range(segments - 1):
        ways = sliding_window_view(np.concatenate([np.full(width, np.inf), sums[:-1]]), width) + band
        best = ways.argmin(axis=1)
        before.append(origin[rows, best])
        sums = ways[rows, best]
    found = [count - 1]
    for step in reversed(before):
        found.append(int(step[found[-1]]))
    return np.array([0, *found[::-1]], dtype=np.int64)


def _thinned_and_fewest(track: _Track, tolerance: float) -> list[Index]:
    """Smaller sets from some of the frames, and the fewest of all of them."""
    fewest = _fewest(track, tolerance)
    kept = np.unique(
        np.concatenate([track.stops, np.linspace(0, track.parameter.size - 1, _THINNED).round().astype(np.int64)])
    )
    thinned = track._replace(
        poses=track.poses.at(kept),
        parameter=track.parameter[kept],
        stops=np.searchsorted(kept, track.stops),
    )
    most = min(fewest.size - 1, kept.size)
    smaller = _best_of_each_size(thinned, tolerance, most) if most > 1 else []
    return [*(kept[rows] for rows in smaller), fewest]


# Long recordings: whom the first row reaches within the tolerance in one segment, in two, and so on.


def _fewest(track: _Track, tolerance: float) -> Index:
    """Fewest rows within a tolerance, by breadth-first search: each row is reached in as few segments as can be."""
    count = track.parameter.size
    before = np.full(count, -1, dtype=np.int64)
    before[0] = 0
    frontier: Index = np.zeros(1, dtype=np.int64)
    screen, cone = _Screen.of(track, tolerance), _cone(track, tolerance)
    failed: deque[int] = deque(maxlen=_FAILED)
    while before[-1] < 0:
        reached = []
        for first in frontier[::-1].tolist():  # the farthest first: it reaches most of what there is to reach
            later = track.moved_on(first)
            open_rows = np.flatnonzero(before[later : track.reach(first) + 1] < 0) + later
            if cone is not None and open_rows.size:
                open_rows = cone.leaves(first, open_rows)
            if not open_rows.size:
                continue
            new = _reached_from(track, screen, first, open_rows, tolerance, failed)
            before[new] = first
            reached.append(new)
            if before[-1] >= 0:
                break
        frontier = np.sort(np.concatenate([np.zeros(0, dtype=np.int64), *reached]))
        if not frontier.size:
            raise _no_set(track, tolerance)
    rows = [count - 1]
    while rows[-1]:
        rows.append(int(before[rows[-1]]))
    return np.array(rows[::-1], dtype=np.int64)


def _cone(track: _Track, tolerance: float) -> Cone | None:
    """What tells most segments apart that cannot hold; None where a joint's own angles lead from pose to pose."""
    if track.poses.series is not None:
        return None
    placed = np.ascontiguousarray(track.poses.placed.reshape(-1, 12))
    quat = np.ascontiguousarray(track.poses.pose[:, :4])
    return Cone(placed, quat, track.parameter, tolerance, track.method == "sclerp")


def _reached_from(
    track: _Track, screen: _Screen, first: int, ends: Index, tolerance: float, failed: deque[int]
) -> Index:
    """Those of the rows (increasing) to which a segment from a row stays within the tolerance.

    `failed` has the rows where segments from other rows failed last, and is given those where segments from this do.
    """
    ends = ends[track.left[ends] <= tolerance]
    ends = ends[screen.may_hold(track, first, ends)]
    if not ends.size:
        return ends
    poses = track.poses
    segments = poses.segments_from(first, ends)

    def keep(good: Bool) -> None:
        nonlocal ends, segments
        ends = ends[good]
        segments = segments.at(good)

    for share in _PROBES:
        rows = _row_at(track, first, ends, share)
        seen = poses.seen_from(first, rows)
        keep(segments.displacement(seen, track.fraction(first, ends, rows)) <= tolerance)
        if not ends.size:
            return ends
    for row in reversed(failed):
        past = np.flatnonzero(ends > row) if row > first else ends[:0]
        if past.size:
            seen = poses.seen_from(first, slice(row, row + 1))
            good = np.ones(ends.size, dtype=np.bool_)
            good[past] = segments.at(past).displacement(seen, track.fraction(first, ends[past], row)) <= tolerance
            keep(good)
            if not ends.size:
                return ends
    seen = poses.seen_from(first, slice(first, ends[-1] + 1))
    holds = np.ones(ends.size, dtype=np.bool_)
    for k in range(ends.size - 1, -1, -1):
        if not holds[k]:
            continue
        rows = np.arange(first + 1, ends[k])
        one = segments.at(slice(k, k + 1))
        error = one.displacement(seen[1 : rows.size + 1], track.fraction(first, ends[k], rows))
        if error.max(initial=0.0) <= tolerance:
            continue
        # What fails in one row mostly fails there for the nearer ends, too.
        row = first + 1 + int(error.argmax())
        if row not in failed:
            failed.append(row)
        rest = np.flatnonzero(holds[: k + 1] & (ends[: k + 1] > row))
        at_row = segments.at(rest).displacement(seen[row - first], track.fraction(first, ends[rest], row))
        holds[rest] = at_row <= tolerance
        holds[k] = False
    return ends[holds]


def _row_at(track: _Track, first: int, ends: Index, share: float) -> Index:
    """Rows between a row and others where about so much of the parameter has passed."""
    wanted = (1.0 - share) * track.parameter[first] + share * track.parameter[ends]
    rows: Index = np.searchsorted(track.parameter, wanted).clip(first, ends)
    return rows


def _no_set(track: _Track, tolerance: float) -> SettingError:
    scale, unit = (1000.0, "mm") if track.points.located else (float(np.degrees(1.0)), "deg")
    limit, left = (scale * float(told_error(np.asarray(e), track.points)) for e in (tolerance, track.left.max()))
    if track.poses.series is not None:
        return SettingError(
            f"--tolerance {limit:g}{unit}: the joint itself leaves up to {in_digits(left)} {unit} of the measured "
            "poses, so that no keyframes keep to it; give a larger tolerance, or --method sclerp"
        )
    return SettingError(
        f"--tolerance {limit:g}{unit}: where the law rests the motion itself moves by more than that, so that "
        "no keyframes keep to it; give a larger tolerance, or leave --law out"
    )


class _Screen(NamedTuple):
    """What no segment can hold, told without making it.

    About half way, at a fraction u, sDLB turns the body as the quaternions' sum ``(1 - u) q1 + u q2`` does. ScLERP is
    there to the angle: both turn about one axis, are at one place half way, and go at most ``2 tan(theta/4)`` and
    exactly ``theta/2`` in half-angle per u. The pose that is measured there may be turned from it by no more than the
    tolerance allows the points.

    Attributes
    ----------
    quat : ndarray, shape (N, 4)
    half_turn : float
        Half the largest turn (rad) that the tolerance allows the points about whatever axis.
    lags : bool
        Whether the method is not the quaternions' sum.
    """

    quat: Float
    half_turn: float
    lags: bool

    @classmethod
    def of(cls, track: _Track, tolerance: float) -> _Screen:
        spread = np.linalg.eigvalsh(track.points.covariance)
        # E^2 >= 4 sin^2(delta/2) a^2, a the least RMS distance of the points from an axis through their centroid.
        proximal = float(np.sqrt(max(spread[0] + spread[1], 0.0)))
        sine = (tolerance + _ROUND_OFF) / max(2.0 * proximal, _ROUND_OFF)
        half_turn = float(np.arcsin(sine)) if sine < 1.0 and track.poses.series is None else np.pi
        return cls(np.ascontiguousarray(track.poses.pose[:, :4]), half_turn, track.method == "sclerp")

    def may_hold(self, track: _Track, first: int, ends: Index) -> Bool:
        """Whether the middle allows a segment to each of the rows, shape (J,); never False where one holds."""
        if self.half_turn >= 0.5 * np.pi:
            return np.ones(ends.size, dtype=np.bool_)
        middle = _row_at(track, first, ends, 0.5)
        u = track.fraction(first, ends, middle)
        along = self.quat @ self.quat[first]
        c = along[ends]
        across = np.einsum("ij,ij->i", self.quat[middle], self.quat[ends])
        mixed = (1.0 - u) * along[middle] + u * across
        square = (1.0 - u) ** 2 + u**2 + 2.0 * u * (1.0 - u) * c
        allowed = np.full(ends.size, self.half_turn)
        if self.lags:
            half_angle = np.arccos(c.clip(-1.0, 1.0))
            speed = 2.0 * np.sqrt((1.0 - c).clip(0.0) / (1.0 + c).clip(_ROUND_OFF))
            allowed += np.abs(u - 0.5) * (speed - half_angle).clip(0.0)
        bound = np.cos(np.minimum(allowed, 0.5 * np.pi))
        holds: Bool = mixed**2 >= bound**2 * square - _ROUND_OFF
        holds |= c < _ROUND_OFF - 1.0
        return holds
