"""The phases of the model: from rest or turn to turn or rest, and when the law of motion runs in each."""

from __future__ import annotations

from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.model import ModelPhases
from elbowscrew.motion.movements.boundaries import Movements
from elbowscrew.motion.movements.phases import nearest_rows
from elbowscrew.motion.tracking.clock import row_of_frame

# A rest beside a movement lasts this long, and this share of the movement; a shorter one is the movement's own ease.
_SHORTEST_REST_S: Final = 0.1
_REST_SHARE: Final = 0.05


def model_phases(
    angle: Float,
    frame: Index,
    elapsed: Float,
    movements: Movements,
    *,
    choice: Literal["movement", "whole"],
    inversion: int | None,
) -> ModelPhases:
    """Phases of the model, from the motion itself or over the whole recording.

    With "movement" a phase leads from one turn or stop of the joint to the next, and its law runs from foot to foot of
    the stroke between them; a turn lies in the middle of the time that the joint stays there. With "whole" there is
    one turn, the one at the largest angle, and laws run from bound to bound (P 36).

    Parameters
    ----------
    angle : ndarray, shape (N,)
        Screw angle, continuous, radians; NaN where there is no pose.
    frame, elapsed : ndarray, shape (N,)
        Frame numbers, seconds.
    movements : Movements
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
        msg = "only one frame of the recording has a pose: there is no motion to model"
        raise AnalysisError(msg)
    begin, middle, end = movements.stroke_begin_s, movements.turn_s, movements.stroke_end_s
    given = None if inversion is None else _inversion_row(angle, frame, known, inversion)
    if choice == "whole" or not begin.size:
        turns = _known_rows(middle[movements.reverses], elapsed, known)
        if given is not None:
            turn = np.array([given])
        elif turns.size:
            turn = turns[[int(np.argmax(np.abs(angle[turns])))]]
        else:  # a motion that does not turn back
            turn = known[[int(np.argmax(np.abs(angle[known])))]]
        turn = turn[(turn > known[0]) & (turn < known[-1])]
        bounds = np.concatenate([known[:1], turn, known[-1:]]).astype(np.int64)
        return ModelPhases(bound_rows=bounds, law_rows=np.column_stack([bounds[:-1], bounds[1:]]))
    if given is not None:
        turn_s = float(elapsed[given] - elapsed[0])
        before, after = begin < turn_s, end > turn_s
        middle = np.array([turn_s])
        first = begin[before].min() if before.any() else 0.0, max(begin[after].min(), turn_s) if after.any() else turn_s
        last = min(end[before].max(), turn_s) if before.any() else turn_s, end[after].max() if after.any() else np.inf
        begin, end = np.array(first), np.array(last)
    sd = None if given is not None else (movements.stroke_begin_sd_s, movements.stroke_end_sd_s)
    return _phases_between(begin, middle, end, sd, elapsed, known)


def _phases_between(
    begin: Float,
    middle: Float,
    end: Float,
    sd: tuple[Float, Float] | None,
    elapsed: Float,
    known: NDArray[np.intp],
) -> ModelPhases:
    """Phases of strokes (K,) with the times between them (K - 1,): laws run while the joint moves.

    The model begins and ends with the movement, at a pose that is known.
    """
    seconds = np.concatenate([begin[:1], middle, end[-1:].clip(max=elapsed[-1] - elapsed[0])])
    bounds = _known_rows(seconds, elapsed, known)
    kept = np.append(True, np.diff(np.maximum.accumulate(bounds)) > 0)
    kept[-1] = True
    if bounds[kept].size > 2 and bounds[kept][-1] == bounds[kept][-2]:
        kept[np.flatnonzero(kept)[-2]] = False
    bounds = bounds[kept]
    if bounds.size < 2 or bounds[0] >= bounds[-1]:
        bounds = known[[0, -1]].astype(np.int64)
        return ModelPhases(bound_rows=bounds, law_rows=bounds[None])
    parts = np.flatnonzero(kept)
    starts, stops = begin[parts[:-1]], end[parts[1:] - 1]
    rest = np.maximum(_SHORTEST_REST_S, _REST_SHARE * (stops - starts))
    time = elapsed - elapsed[0]
    eases = np.column_stack([starts - time[bounds[:-1]] >= rest, time[bounds[1:]] - stops >= rest])
    laws = np.column_stack([bounds[:-1], bounds[1:]])
    rows = np.column_stack([nearest_rows(elapsed, starts), nearest_rows(elapsed, stops)])
    laws = np.where(eases, rows.clip(laws[:, :1], laws[:, 1:]), laws)
    empty = laws[:, 0] >= laws[:, 1]
    laws[empty] = np.column_stack([bounds[:-1], bounds[1:]])[empty]
    law_sd = None if sd is None else np.column_stack([sd[0][parts[:-1]], sd[1][parts[1:] - 1]])
    return ModelPhases(bound_rows=bounds.astype(np.int64), law_rows=laws.astype(np.int64), law_sd_s=law_sd)


def _known_rows(seconds: Float, elapsed: Float, known: NDArray[np.intp]) -> Index:
    """Rows with a pose nearest to times from the first frame on."""
    first = elapsed[known[0]] - elapsed[0]
    return known[nearest_rows(elapsed[known], seconds - first)].astype(np.int64)


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
