"""Keyframes, phases and knots of the model."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import Keyframes
from elbowscrew.motion.difference import angle_between
from elbowscrew.motion.laws import Law

Float = NDArray[np.float64]
Index = NDArray[np.int64]
KnotChoice = Literal["law", "chord", "uniform", "angle"]


def row_of_frame(frame: Index, wanted: int, option: str) -> int:
    """Row of a frame number.

    Raises
    ------
    SettingError
        If the number is not in the recording or stands there twice.
    """
    rows = np.flatnonzero(frame == wanted)
    if rows.size == 1:
        return int(rows[0])
    if rows.size:
        msg = f"--{option} {wanted}: the frame number stands {rows.size} times in the file; choose another frame"
    else:
        msg = f"--{option} {wanted}: no such frame; the file has frames {frame.min()} to {frame.max()}"
    raise SettingError(msg)


def choose_rows(
    angle: Float, frame: Index, wanted: tuple[int, ...] | None, inversion: int | None
) -> tuple[Index, int | None]:
    """Rows of the keyframes, and the row where the motion turns back.

    Without a wish: the first and the last known pose and, between them, the one with the largest angle. Among
    keyframes asked for, the inversion is the one given or else the one with the largest angle.

    Parameters
    ----------
    angle : ndarray, shape (N,)
        Screw angle of the measured motion; NaN where there is no pose.
    frame : ndarray, shape (N,)
    wanted : tuple of int or None
        Frame numbers.
    inversion : int or None
        Frame number.

    Returns
    -------
    rows : ndarray of int, shape (K,)
    inversion_row : int or None
        None if the largest angle is at an end: the motion does not turn back.
    """
    known = np.flatnonzero(np.isfinite(angle))
    if wanted is not None:
        rows = np.array([row_of_frame(frame, number, "keyframes") for number in wanted], dtype=np.int64)
        _check_known(angle, rows, frame, "keyframes")
        if (np.diff(rows) <= 0).any():
            msg = f"--keyframes {','.join(map(str, wanted))}: the file does not have these frames in this order"
            raise SettingError(msg)
        turn = (
            int(rows[np.argmax(np.abs(angle[rows]))])
            if inversion is None
            else row_of_frame(frame, inversion, "inversion")
        )
    else:
        turn = (
            int(known[np.argmax(np.abs(angle[known]))])
            if inversion is None
            else row_of_frame(frame, inversion, "inversion")
        )
        _check_known(angle, np.array([turn]), frame, "inversion")
        if inversion is not None and not known[0] < turn < known[-1]:
            msg = (
                f"--inversion {inversion}: not between the first and the last known pose "
                f"(frames {frame[known[0]]} and {frame[known[-1]]})"
            )
            raise SettingError(msg)
        rows = np.unique([known[0], turn, known[-1]]).astype(np.int64)
    if rows.size < 2:
        msg = "the recording has one single frame with a pose: there is no motion to model"
        raise AnalysisError(msg)
    return rows, None if turn in (rows[0], rows[-1]) else turn


def _check_known(angle: Float, rows: Index, frame: Index, option: str) -> None:
    lost = rows[~np.isfinite(angle[rows])]
    if lost.size:
        msg = f"--{option} {frame[lost[0]]}: no pose is known in that frame (tracking lost); choose another"
        raise SettingError(msg)


def keyframes_at(
    rows: Index,
    inversion_row: int | None,
    frame: Index,
    elapsed: Float,
    pose: Float,
    *,
    choice: KnotChoice,
    law: Law,
    piecewise: bool,
) -> Keyframes:
    """Keyframes with their phases and knots.

    Parameters
    ----------
    rows : ndarray of int, shape (K,)
    inversion_row : int or None
        One of the rows, where the first phase ends and the second begins.
    frame, elapsed : ndarray, shape (N,)
        Frame numbers and seconds.
    pose : ndarray, shape (N, 8)
    choice : {"law", "chord", "uniform", "angle"}
    law : callable
        Law of motion of each phase.
    piecewise : bool
        Knots from 0 to 1 in each phase, or from 0 to 1 over all phases.

    Raises
    ------
    SettingError
        If two neighboring knots fall together.
    """
    ends = [0, rows.size - 1]
    if inversion_row is not None:
        ends.insert(1, int(np.flatnonzero(rows == inversion_row)[0]))
    bounds = np.array(ends, dtype=np.int64)
    phases = list(itertools.pairwise(bounds))
    if choice == "law":
        in_phase = [law(_scaled(elapsed[rows[start : stop + 1]])) for start, stop in phases]
        if not piecewise:
            count = len(in_phase)
            joined = [(p + knots[: None if p == count - 1 else -1]) / count for p, knots in enumerate(in_phase)]
            in_phase = [np.concatenate(joined)]
    else:
        parts = phases if piecewise else [(0, rows.size - 1)]
        step_of = _STEPS[choice]
        in_phase = [
            _scaled(_accumulated(step_of(pose[rows[start : stop + 1]]), rows[start : stop + 1], frame, choice))
            for start, stop in parts
        ]
    return Keyframes(row=rows, frame=frame[rows], phase_bounds=bounds, knots=tuple(in_phase))


def _scaled(values: Float) -> Float:
    """Bring increasing values to 0..1, both ends exactly."""
    scaled: Float = (values - values[0]) / (values[-1] - values[0])
    scaled[-1] = 1.0
    return scaled


def _accumulated(steps: Float, rows: Index, frame: Index, choice: str) -> Float:
    least = _LEAST_STEPS[choice]
    if (steps < least).any():
        k = int(np.flatnonzero(steps < least)[0])
        what = "origin does not move" if choice == "chord" else "orientation does not change"
        others = ", ".join(name for name in ("law", *_STEPS) if name != choice)
        msg = (
            f"--knots {choice}: the forearm's {what} between keyframes {frame[rows[k]]} and {frame[rows[k + 1]]}, so "
            f"their knots fall together; choose other keyframes or another of --knots {others}"
        )
        raise SettingError(msg)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _chords(pose: Float) -> Float:
    origin = pose_from_dual_quat(pose)[1]
    return length(np.diff(origin, axis=0))


# Below these a step is round-off or noise of the cameras: 10 micrometers, 10 microradians.
_LEAST_STEPS: Final = {"chord": 1e-5, "uniform": 0.0, "angle": 1e-5}

_STEPS: Final[dict[str, Callable[[Float], Float]]] = {
    "chord": _chords,
    "uniform": lambda pose: np.ones(len(pose) - 1),
    "angle": lambda pose: angle_between(pose[:-1], pose[1:]),
}
