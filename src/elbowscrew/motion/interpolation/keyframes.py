"""Keyframes of the model and their knots."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import KNOT_NAMES, functions_named
from elbowscrew.errors import SettingError
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model import Keyframes, ModelPhases
from elbowscrew.motion.difference import angle_between
from elbowscrew.motion.tracking.clock import row_of_frame


def rows_of_frames(
    angle: Float, frame: Index, wanted: tuple[int, ...], inversion: int | None
) -> tuple[Index, int | None]:
    """Rows of keyframes that were asked for, and of the inversion among them, None if it was not.

    Parameters
    ----------
    angle : ndarray, shape (N,)
        NaN where there is no pose.
    frame : ndarray, shape (N,)
    wanted : tuple of int
        Frame numbers.
    inversion : int or None
        Frame number.

    Raises
    ------
    SettingError
        If a frame is not in the recording, has no pose, or they are not in its order.
    """
    rows = np.array([row_of_frame(frame, number, "keyframes") for number in wanted], dtype=np.int64)
    _check_known(angle, rows, frame, "keyframes")
    if (np.diff(rows) <= 0).any():
        msg = f"--keyframes {','.join(map(str, wanted))}: the file does not have these frames in this order"
        raise SettingError(msg)
    return rows, None if inversion is None else row_of_frame(frame, inversion, "inversion")


def spread_rows(phases: ModelPhases, known: NDArray[np.bool_], elapsed: Float, count: int) -> Index:
    """Rows of so many keyframes a phase, evenly in time while its law runs, at the nearest known poses.

    Parameters
    ----------
    phases : ModelPhases
    known : ndarray of bool, shape (N,)
        Frames that may be keyframes.
    elapsed : ndarray, shape (N,)
    count : int
        Two at least: the phase's ends, which are keyframes in any case.

    Returns
    -------
    ndarray of int64
        Increasing; fewer where a phase has no more known poses.
    """
    rows = [phases.bound_rows]
    for first, last in phases.law_rows:
        inner = np.arange(first + 1, last)
        inner = inner[known[inner]]
        if inner.size:
            wanted = np.linspace(elapsed[first], elapsed[last], count)[1:-1]
            rows.append(inner[np.abs(elapsed[inner] - wanted[:, None]).argmin(axis=1)])
    return np.unique(np.concatenate(rows)).astype(np.int64)


def _check_known(angle: Float, rows: Index, frame: Index, option: str) -> None:
    lost = rows[~np.isfinite(angle[rows])]
    if lost.size:
        msg = f"--{option} {frame[lost[0]]}: no pose is known in that frame (tracking lost); choose another"
        raise SettingError(msg)


def keyframes_at(
    rows: Index,
    phases: ModelPhases,
    frame: Index,
    elapsed: Float,
    pose: Float,
    *,
    choice: str,
    laws: Sequence[Callable[[Float], Float]],
    piecewise: bool,
) -> Keyframes:
    """Keyframes with their phases and knots.

    Parameters
    ----------
    rows : ndarray of int, shape (K,)
        The bounds of the phases among them.
    phases : ModelPhases
    frame, elapsed : ndarray, shape (N,)
        Frame numbers and seconds.
    pose : ndarray, shape (N, 8)
    choice : {"law", "chord", "uniform", "angle"}
    laws : sequence of callable
        Law of motion of each phase.
    piecewise : bool
        Knots from 0 to 1 in each phase, or from 0 to 1 over all phases.

    Raises
    ------
    SettingError
        If two neighboring knots fall together, or do not increase.
    """
    bounds = np.searchsorted(rows, phases.bound_rows)
    members = [rows[start : stop + 1] for start, stop in itertools.pairwise(bounds)]
    count = phases.count
    if choice == "law":
        knots = [law(phase_time(phases, p, elapsed, members[p])) for p, law in enumerate(laws)]
        for knot, row in zip(knots, members, strict=True):
            _check_increasing(knot, frame[row])
        if not piecewise:
            joined = [(p + knot[: None if p == count - 1 else -1]) / count for p, knot in enumerate(knots)]
            knots = [np.concatenate(joined)]
    else:
        step_of = _STEPS[choice]
        knots = [
            _scaled(_accumulated(step_of(pose[part]), part, frame, choice))
            for part in (members if piecewise else [rows])
        ]
    return Keyframes(row=rows, frame=frame[rows], phases=phases, knots=tuple(knots))


def phase_time(phases: ModelPhases, p: int, elapsed: Float, rows: Index) -> Float:
    """Time of rows as a share of that in which the law of phase p runs: 0 before, 1 after, shape (n,)."""
    first, last = elapsed[phases.law_rows[p]]
    return phase_time_share(elapsed[rows], first, last)


def phase_time_share(time_s: Float, start_s: float, end_s: float) -> Float:
    """Time (n,) as a share of that between a start and an end: 0 before, 1 after."""
    share: Float = np.clip((time_s - start_s) / (end_s - start_s), 0.0, 1.0)
    return share


def _check_increasing(knots: Float, frame: Index) -> None:
    if (np.diff(knots) <= 0.0).any():
        k = int(np.flatnonzero(np.diff(knots) <= 0.0)[0])
        msg = (
            f"--knots law: under the law the motion does not advance between keyframes {frame[k]} and {frame[k + 1]}; "
            "choose other keyframes, another --law, or another of --knots chord, uniform, angle"
        )
        raise SettingError(msg)


def _scaled(values: Float) -> Float:
    """Bring increasing values to 0..1, both ends exactly."""
    scaled: Float = (values - values[0]) / (values[-1] - values[0])
    scaled[-1] = 1.0
    return scaled


def _accumulated(steps: Float, rows: Index, frame: Index, choice: str) -> Float:
    if (steps < _LEAST_STEP).any():
        k = int(np.flatnonzero(steps < _LEAST_STEP)[0])
        what = {"chord": "origin does not move", "angle": "orientation does not change"}.get(choice, "pose stays")
        others = ", ".join(name for name in KNOT_NAMES if name != choice)
        msg = (
            f"--knots {choice}: the distal body's {what} between keyframes {frame[rows[k]]} and {frame[rows[k + 1]]}, "
            f"so their knots fall together; choose other keyframes or another of --knots {others}"
        )
        raise SettingError(msg)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _chord(pose: Float) -> Float:
    origin = pose_from_dual_quat(pose)[1]
    return length(np.diff(origin, axis=0))


def _uniform(pose: Float) -> Float:
    return np.ones(len(pose) - 1)


def _angle(pose: Float) -> Float:
    return angle_between(pose[:-1], pose[1:])


# Below this a step is round-off or noise of the cameras: 10 micrometers, 10 microradians.
_LEAST_STEP: Final = 1e-5

_STEPS: Final[dict[str, Callable[[Float], Float]]] = functions_named(
    tuple(name for name in KNOT_NAMES if name != "law"), globals()
)
"""Each takes poses (K, 8) and gives the K - 1 steps between them, never negative. A new choice is one function above,
and its name in `elbowscrew.choices.KnotName`."""
