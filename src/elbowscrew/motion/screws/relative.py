"""The distal body seen from the proximal body, and its displacement since the reference (P 35)."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import ExpressIn
from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry import dlb
from elbowscrew.geometry.dual_quaternion import conjugate, continuous_signs, multiply
from elbowscrew.model import JointMotion, QualityWarning, RigidBody
from elbowscrew.motion.smoothing.gaps import fill_gaps, filled_gaps
from elbowscrew.quantities import in_digits

# What is filled in is told to be doubtful from so many radians on, and so many times what the noise explains.
_DOUBTFUL: Final = float(np.radians(1.0))
_OVER_NOISE: Final = 2.0

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def joint_from_bodies(
    proximal: RigidBody | None,
    distal: RigidBody,
    frame: NDArray[np.int64],
    elapsed: NDArray[np.float64],
    rate_hz: float,
    *,
    reference_row: int | None,
    reference_window: int,
    max_gap_s: float,
    broken_rows: NDArray[np.intp] | None = None,
    lowpass_hz: float | None = None,
) -> JointMotion:
    """Relative motion ``J_i = A_i^-1 F_i`` of two bodies, short gaps filled, with its reference pose.

    Parameters
    ----------
    proximal : RigidBody or None
        The proximal body; None if it stands still.
    distal : RigidBody
        The distal body; with positions if the proximal one has any.
    frame : ndarray of int64, shape (N,)
        Frame numbers, for messages.
    elapsed : ndarray, shape (N,)
        Seconds.
    rate_hz : float
    reference_row : int or None
        None for the first row with both bodies tracked.
    reference_window : int
        The reference is the mean of so many measured poses from that row on.
    max_gap_s : float
    broken_rows : ndarray of int, optional
        Increasing rows that one of the bodies reaches by a leap; no gap is filled across them.
    lowpass_hz : float, optional
        Cut-off of the filter that the bodies went through.

    Raises
    ------
    AnalysisError
        If no frame has both bodies.
    SettingError
        If the reference frame has no measured pose, or fewer follow than the window wants.
    """
    proximal_pose = IDENTITY if proximal is None else proximal.dual_quat_lab_body
    raw = np.broadcast_to(
        multiply(conjugate(proximal_pose), distal.dual_quat_lab_body), distal.dual_quat_lab_body.shape
    )
    measured = distal.tracked if proximal is None else distal.tracked & proximal.tracked
    rows = np.flatnonzero(measured)
    if rows.size == 0:
        who = f"{distal.name!r}" if proximal is None else f"{proximal.name!r} and {distal.name!r} both"
        msg = f"no frame has {who} tracked: nothing to analyze; see `elbowscrew info` for what the file holds"
        raise AnalysisError(msg)
    row = int(rows[0]) if reference_row is None else reference_row
    if not measured[row]:
        msg = (
            f"--reference {frame[row]}: not everything is tracked in that frame; the first frame that has both bodies "
            f"is {frame[rows[0]]}"
        )
        raise SettingError(msg)
    window = rows[rows >= row][:reference_window]
    if window.size < reference_window:
        msg = f"--reference-window {reference_window}: only {window.size} measured frames follow the reference"
        raise SettingError(msg)
    series = continuous_signs(raw)
    pose, filled = fill_gaps(series, elapsed, rate_hz, max_gap_s, broken_rows)
    return JointMotion(
        dual_quat_proximal_distal=pose,
        measured=measured,
        filled=filled,
        reference=_mean_pose(series[window]),
        reference_row=row,
        lowpass_hz=lowpass_hz,
        dual_quat_lab_proximal=IDENTITY if proximal is None else _mean_pose(proximal_pose[window]),
        located=distal.located,
    )


def fill_doubts(
    series: NDArray[np.float64],
    elapsed: NDArray[np.float64],
    rate_hz: float,
    max_gap_s: float,
    broken_rows: NDArray[np.intp],
    frame: NDArray[np.int64],
    noise: float,
) -> tuple[QualityWarning, ...]:
    """Say where what is filled in may be far off, by the motion at the two ends of the gap.

    Parameters
    ----------
    series : ndarray, shape (N, 8)
        Relative motion as it was recorded; NaN where there is no pose.
    elapsed : ndarray, shape (N,)
        Seconds.
    rate_hz, max_gap_s, broken_rows
        As in `fill_gaps`.
    frame : ndarray of int64, shape (N,)
        For messages.
    noise : float
        Standard deviation of a component of the rotation, radians.
    """
    filled = fill_gaps(continuous_signs(series), elapsed, rate_hz, max_gap_s, broken_rows)[1]
    gaps = filled_gaps(series, filled, elapsed, rate_hz)
    unknown = np.isnan(gaps.off)
    off, off_sd = np.nan_to_num(gaps.off), noise * np.nan_to_num(gaps.noise)
    doubtful = off > np.maximum(_DOUBTFUL, _OVER_NOISE * off_sd)
    off += off_sd
    parts = []
    if doubtful.any():
        worst = int(np.argmax(np.where(doubtful, off, 0.0)))
        lost = frame[[gaps.before[worst] + 1, gaps.after[worst] - 1]].tolist()
        where = f"frame {lost[0]}" if lost[0] == lost[1] else f"frames {lost[0]} to {lost[1]}"
        parts.append(
            f"by the speeds at its ends the joint may be up to {in_digits(np.degrees(off[worst]))} deg off the poses "
            f"that are put in for {where}, and by over {np.degrees(_DOUBTFUL):g} deg in {doubtful.sum()} of {off.size} "
            "filled gaps"
        )
    if unknown.any():
        parts.append(f"no speed is known at the ends of {unknown.sum()} of {off.size} filled gaps")
    if not parts:
        return ()
    message = f"what is filled in may be wrong: {'; '.join(parts)} (--max-gap sets the longest gap that is filled)"
    return (QualityWarning(code="fill-doubtful", message=message, count=int((doubtful | unknown).sum())),)


def displacement(joint: JointMotion) -> NDArray[np.float64]:
    """``D_i = J_0^-1 J_i`` (P 35), shape (N, 8), in the distal body's frame at the reference.

    Sign-continuous as the joint's own series, with the reference itself at +1.
    """
    D = multiply(conjugate(joint.reference), joint.dual_quat_proximal_distal)
    return -D if D[joint.reference_row, 0] < 0.0 else D


def expressed(dual_quat: NDArray[np.float64], joint: JointMotion, express_in: ExpressIn) -> NDArray[np.float64]:
    """Write displacements, shape (..., N, 8), given in the distal body's reference frame in another frame.

    The proximal body's is ``J_0 D J_0^-1``, the laboratory's ``A_0 J_0 D J_0^-1 A_0^-1``: same angle, same slide,
    another description of the line.
    """
    if express_in == "distal":
        return dual_quat
    change = frame_change(joint, express_in)
    return multiply(multiply(change, dual_quat), conjugate(change))


def frame_change(joint: JointMotion, express_in: ExpressIn) -> NDArray[np.float64]:
    """Pose of the distal body at the reference, shape (8,), in the frame screws are expressed in."""
    match express_in:
        case "distal":
            return IDENTITY
        case "proximal":
            return joint.reference
        case "lab":
            return multiply(joint.dual_quat_lab_proximal, joint.reference)


def _mean_pose(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    return poses[0] if len(poses) == 1 else dlb(poses, np.full(len(poses), 1.0 / len(poses)))
