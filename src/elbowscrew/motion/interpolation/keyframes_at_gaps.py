"""Keyframes that would lie where there is no pose, or whose time is told from there: what that costs the model."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import ModelPhases, QualityWarning
from elbowscrew.motion.movements.boundaries import Movements, duration_of
from elbowscrew.motion.movements.feet import GAP_SD
from elbowscrew.motion.movements.phases import nearest_rows
from elbowscrew.motion.movements.unseen import gaps_of
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.quantities import in_digits

# A turn that may go on by less than this share of its swing, or so many radians, is where the keyframe is.
_HIDDEN_SHARE: Final = 0.01
_LEAST_HIDDEN: Final = float(np.radians(0.5))
_MOST_TOLD: Final = 4


def keyframe_doubts(
    phases: ModelPhases, course: Float, measured: Measurement, movements: Movements
) -> tuple[QualityWarning, ...]:
    """Say which bounds of the model's phases are not where the motion turns or stops, as no pose is known there.

    Parameters
    ----------
    phases : ModelPhases
        As found from the motion.
    course : ndarray, shape (N,)
        What they were found on, radians.
    measured : Measurement
    movements : Movements
    """
    found = _times_from_gaps(phases, measured, movements) | _turns_in_gaps(phases, course, measured)
    if not found:
        return ()
    parts = [found[k] for k in sorted(found)]
    more = f"; and {len(parts) - _MOST_TOLD} more" if len(parts) > _MOST_TOLD else ""
    message = (
        f"the model stands on poses that are lost: {'; '.join(parts[:_MOST_TOLD])}{more}. That is part of the model's "
        "error, which there is no measure of how well the model describes the joint (--keyframes names others)"
    )
    return (QualityWarning(code="keyframe-at-gap", message=message, count=len(parts)),)


def _turns_in_gaps(phases: ModelPhases, course: Float, measured: Measurement) -> dict[int, str]:
    """For keyframes at which the motion turns back, beside or in a gap: how far it may go on there."""
    gaps = gaps_of(np.where(measured.joint.measured, course, np.nan), measured.elapsed)
    rows, frame = phases.bound_rows, measured.screw.frame
    known = course[rows]
    found = {}
    for k in range(1, rows.size - 1):
        swing = known[k] - known[[k - 1, k + 1]]
        if not swing[0] * swing[1] > 0.0:
            continue
        at = np.flatnonzero((gaps.before <= rows[k]) & (rows[k] <= gaps.after))
        tip = gaps.highest_tip[at] - known[k] if swing[0] > 0.0 else known[k] - gaps.lowest_tip[at]
        least = max(_HIDDEN_SHARE * float(np.abs(swing).max()), _LEAST_HIDDEN)
        if at.size and tip.max() > least:
            gap = at[np.argmax(tip)]
            lost = f"frames {frame[gaps.before[gap] + 1]} to {frame[gaps.after[gap] - 1]}"
            found[k] = (
                f"keyframe {frame[rows[k]]} stands for a turn in {lost}, where the joint may go farther by about "
                f"{in_digits(np.degrees(0.5 * tip.max()))} deg, and up to {in_digits(np.degrees(tip.max()))}"
            )
    return found


def _times_from_gaps(phases: ModelPhases, measured: Measurement, movements: Movements) -> dict[int, str]:
    """For keyframes where a law begins or ends: how uncertain that time is by a gap that it is told from."""
    if phases.law_sd_s is None:
        return {}
    elapsed, rows, frame = measured.elapsed, phases.bound_rows, measured.screw.frame
    begins, ends = movements.stroke_begin_gap_s, movements.stroke_end_gap_s
    turns_s = np.concatenate([movements.stroke_begin_s[:1], movements.turn_s, movements.stroke_end_s[-1:]])
    sides = np.stack([np.vstack([begins, [[np.nan] * 2]]), np.vstack([[[np.nan] * 2], ends])])
    found = {}
    for k in np.flatnonzero(duration_of(sides).max(axis=0) > 0.0).tolist():
        begin, end = sides[int(np.argmax(duration_of(sides[:, k]))), k]
        bound = int(np.argmin(np.abs(elapsed[rows] - elapsed[0] - turns_s[k])))
        before, after = nearest_rows(elapsed, np.array([begin, end])).tolist()
        found[bound] = (
            f"the time of keyframe {frame[rows[bound]]} is told from frames {frame[before + 1]} to {frame[after - 1]} "
            f"and uncertain by {in_digits(GAP_SD * (end - begin))} s (sd)"
        )
    return found
