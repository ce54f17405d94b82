"""The phases of the model: from rest or turn to turn or rest, and when the law of motion runs in each."""

from __future__ import annotations

import itertools
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.model import ModelPhases, MovementPhases
from elbowscrew.motion.movements.phases import turning_points
from elbowscrew.motion.tracking.clock import row_of_frame

Float = NDArray[np.float64]
Index = NDArray[np.int64]

# The motion turns where it swings by this share of its range, and a degree at least.
_SWING_SHARE: Final = 0.1
_LEAST_SWING: Final = float(np.radians(1.0))
# A rest beside a movement lasts this long, and this share of the movement; a shorter one is the movement's own ease.
_SHORTEST_REST_S: Final = 0.1
_REST_SHARE: Final = 0.05


def model_phases(
    angle: Float,
    frame: Index,
    elapsed: Float,
    movements: MovementPhases,
    velocity: Float,
    *,
    choice: Literal["movement", "whole"],
    inversion: int | None,
) -> ModelPhases:
    """Phases of the model, from the motion itself or over the whole recording.

    With "movement" a phase leads from one turn or rest of the joint to the next, and its law runs from onset to offset
    of the movement in it. Onset and offset are put where the speed begins to rise and has fallen, not where it passes
    the threshold: a minimum-jerk movement passes the share r of its highest speed at
    ``tau = (1 - sqrt(1 - sqrt(r)))/2``. So is a turn put amid the time in which the joint rests there. With "whole"
    there is one turn, at the largest angle, and laws run from bound to bound (P 36).

    Parameters
    ----------
    angle : ndarray, shape (N,)
        Screw angle, continuous, radians; NaN where there is no pose.
    frame, elapsed : ndarray, shape (N,)
        Frame numbers, seconds.
    movements : MovementPhases
    velocity : ndarray, shape (N,)
        Angular velocity that the movements were found from, rad/s.
    choice : {"movement", "whole"}
    inversion : int or None
        Frame number of the one turn there is to be.

    Raises
    ------
    SettingError
        If the inversion is no frame with a pose between the first and the last.
    AnalysisError
        If there is a pose in one frame only.
    """
    known = np.flatnonzero(np.isfinite(angle))
    if known.size < 2:
        msg = "the recording has one single frame with a pose: there is no motion to model"
        raise AnalysisError(msg)
    whole = choice == "whole" or not movements.onset_rows.size
    if inversion is not None:
        turns = np.array([_inversion_row(angle, frame, known, inversion)])
    elif whole:
        turns = known[[int(np.argmax(np.abs(angle[known])))]]
        turns = turns[(turns > known[0]) & (turns < known[-1])]
    else:
        turns = _turns(angle, known)
    bounds = np.concatenate([known[:1], turns, known[-1:]]).astype(np.int64)
    if whole:
        return ModelPhases(bound_rows=bounds, law_rows=np.column_stack([bounds[:-1], bounds[1:]]))
    speed = np.abs(velocity)
    slow = ~(speed > movements.threshold)  # so is what is not known
    motion = _Motion(angle, elapsed, known, movements, speed, slow, _least_swing(angle[known]))
    return _moving(bounds if inversion is not None else _parted(bounds, motion), motion)


def phases_of_keyframes(rows: Index, angle: Float, inversion_row: int | None) -> ModelPhases:
    """Phases of keyframes that were asked for: up to the inversion among them, and from there on.

    Parameters
    ----------
    rows : ndarray of int, shape (K,)
    angle : ndarray, shape (N,)
    inversion_row : int or None
        None for the keyframe with the largest angle.
    """
    turn = int(rows[np.argmax(np.abs(angle[rows]))]) if inversion_row is None else inversion_row
    bounds = np.unique([rows[0], turn, rows[-1]]).astype(np.int64)
    return ModelPhases(bound_rows=bounds, law_rows=np.column_stack([bounds[:-1], bounds[1:]]))


def one_phase(rows: Index) -> ModelPhases:
    """Give a single phase from the first of the rows to the last."""
    bounds = np.array([rows[0], rows[-1]], dtype=np.int64)
    return ModelPhases(bound_rows=bounds, law_rows=bounds[None])


def _inversion_row(angle: Float, frame: Index, known: NDArray[np.intp], inversion: int) -> int:
    row = row_of_frame(frame, inversion, "inversion")
    if not np.isfinite(angle[row]):
        msg = f"--inversion {inversion}: no pose is known in that frame (tracking lost); choose another"
        raise SettingError(msg)
    if not known[0] < row < known[-1]:
        msg = (
            f"--inversion {inversion}: not between the first and the last known pose "
            f"(frames {frame[known[0]]} and {frame[known[-1]]})"
        )
        raise SettingError(msg)
    return row


def _turns(angle: Float, known: NDArray[np.intp]) -> NDArray[np.intp]:
    series = angle[known]
    return known[turning_points(series, _least_swing(series))[1:-1]]


def _least_swing(series: Float) -> float:
    return max(_SWING_SHARE * float(np.ptp(series)), _LEAST_SWING)


class _Motion(NamedTuple):
    angle: Float
    elapsed: Float
    known: NDArray[np.intp]
    movements: MovementPhases
    speed: Float
    slow: NDArray[np.bool_]
    least_swing: float

    def runs(self, first: int, last: int) -> list[tuple[int, int]]:
        """Movements between two rows, cut there, that turn the joint by more than a tremor does."""
        onset, offset = self.movements.onset_rows, self.movements.offset_rows
        inside = slice(int(np.searchsorted(offset, first, side="right")), int(np.searchsorted(onset, last)))
        runs = list(zip(onset[inside].clip(min=first).tolist(), offset[inside].clip(max=last).tolist(), strict=True))
        travel = [abs(float(self.angle[self.nearest(b)] - self.angle[self.nearest(a)])) for a, b in runs]
        least = min(self.least_swing, max(travel, default=0.0))
        return [run for run, angle in zip(runs, travel, strict=True) if angle >= least]

    def nearest(self, row: int, low: int = 0, high: int | None = None) -> int:
        """Known row nearest to a row, not beyond the limits."""
        first = int(np.searchsorted(self.known, low))
        last = self.known.size if high is None else int(np.searchsorted(self.known, high, side="right"))
        return int(self.known[first + _nearest(self.known[first:last], row)])

    def row_at(self, time: float) -> int:
        return _nearest(self.elapsed, time)

    def foot(self, onset: int, offset: int) -> float:
        """Share of a movement that passes before its speed is over the threshold."""
        speed = self.speed[onset : offset + 1]
        if not np.isfinite(speed).any():
            return 0.0
        ratio = min(self.movements.threshold / float(np.nanmax(speed)), 1.0)
        return float(0.5 * (1.0 - np.sqrt(1.0 - np.sqrt(ratio))))


def _nearest(increasing: NDArray[Any], value: float) -> int:
    """Place of the nearest of increasing numbers, the earlier of two."""
    after = min(int(np.searchsorted(increasing, value)), increasing.size - 1)
    before = max(after - 1, 0)
    return before if value - increasing[before] <= increasing[after] - value else after


def _parted(bounds: Index, motion: _Motion) -> Index:
    """Part the phases at the rests in them, and put the turns amid theirs."""
    parted = [int(bounds[0])]
    for first, last in itertools.pairwise(bounds.tolist()):
        for (_, stop), (start, _) in itertools.pairwise(motion.runs(first, last)):
            parted.append(motion.nearest((stop + start) // 2, first + 1, last - 1))
        parted.append(last)
    for k in range(1, len(parted) - 1):
        parted[k] = _middle_of_rest(parted[k - 1], parted[k], parted[k + 1], motion)
    return np.array(parted, dtype=np.int64)


def _moving(bounds: Index, motion: _Motion) -> ModelPhases:
    """Let the laws run while the joint moves."""
    laws = np.array([_law_rows(first, last, motion) for first, last in itertools.pairwise(bounds.tolist())])
    # The model begins and ends with the movement, at a pose that is known.
    bounds[0] = laws[0, 0] = motion.nearest(laws[0, 0], bounds[0], bounds[1] - 1)
    bounds[-1] = laws[-1, 1] = motion.nearest(laws[-1, 1], bounds[-2] + 1, bounds[-1])
    return ModelPhases(bound_rows=bounds, law_rows=laws.astype(np.int64))


def _middle_of_rest(before: int, turn: int, after: int, motion: _Motion) -> int:
    """Row of a turn: amid the rest about it, as the noise chooses the largest angle of a flat top."""
    speed, slow, threshold = motion.speed, motion.slow, motion.movements.threshold
    first = last = turn
    while first > before and slow[first]:
        first -= 1
    while last < after and slow[last]:
        last += 1
    elapsed = motion.elapsed
    if elapsed[last] - elapsed[first] < _SHORTEST_REST_S or not before < first < last < after:
        return turn
    left = _crossing(elapsed, speed, first, first + 1, threshold)
    right = _crossing(elapsed, speed, last, last - 1, threshold)
    # The speed is there again a foot later than the rest ends, and falls below a foot before it begins.
    begin = (motion.runs(before, turn) or [(before, turn)])[-1][0]
    end = (motion.runs(turn, after) or [(turn, after)])[0][1]
    left += motion.foot(begin, first) * (elapsed[turn] - elapsed[begin])
    right -= motion.foot(last, end) * (elapsed[end] - elapsed[turn])
    return motion.nearest(motion.row_at(0.5 * (left + right)), before + 1, after - 1)


def _crossing(elapsed: Float, speed: Float, fast: int, slow: int, threshold: float) -> float:
    """Time between two neighboring rows at which the speed is the threshold."""
    if not np.isfinite(speed[slow]):
        return float(elapsed[slow])
    share = (speed[fast] - threshold) / (speed[fast] - speed[slow])
    return float(elapsed[fast] + share * (elapsed[slow] - elapsed[fast]))


def _law_rows(first: int, last: int, motion: _Motion) -> tuple[int, int]:
    """Rows between which the movement of a phase runs, from its first onset to its last offset."""
    runs = motion.runs(first, last)
    if not runs:
        return first, last
    onset, offset = runs[0][0], runs[-1][1]
    begins, ends = onset > first, offset < last
    foot = motion.foot(onset, offset)
    sides = foot * (int(begins) + int(ends))
    if sides >= 1.0:  # the whole phase is at the threshold
        return first, last
    elapsed = motion.elapsed
    duration = (elapsed[offset] - elapsed[onset]) / (1.0 - sides)
    start = elapsed[onset] - begins * foot * duration
    stop = elapsed[offset] + ends * foot * duration
    rest = max(_SHORTEST_REST_S, _REST_SHARE * duration)
    from_row = motion.row_at(start) if start - elapsed[first] >= rest else first
    to_row = motion.row_at(stop) if elapsed[last] - stop >= rest else last
    return (from_row, to_row) if from_row < to_row else (first, last)
