"""What is doubtful about the sense of a rotation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from elbowscrew.model import QualityWarning, Sense
from elbowscrew.motion.screws.sense import DOMINANT_RATIO, LARGE_JUMP, SignedChoice


def sense_warnings(sense: Sense, frame: NDArray[np.int64], chosen: SignedChoice) -> tuple[QualityWarning, ...]:
    """Say where the angle has no sense, where its sense depends on little, and where it leaps.

    Parameters
    ----------
    sense : Sense
    frame : ndarray of int64, shape (N,)
    chosen : {"auto", "yes", "no"}
        The setting: what somebody has decided is not doubted, but told where the motion does not support it.
    """
    found = []
    ratio = f"the ratio of the second direction to the first is {sense.ratio:.3f}"
    if chosen == "auto" and not sense.signed:
        message = (
            f"no axis dominates the motion ({ratio}; one axis leaves {DOMINANT_RATIO:.2f} at most): theta is the "
            "rotation since the reference without a sense, and everything that needs a sense is empty; --signed yes "
            "takes the leading direction as the axis"
        )
        found.append(QualityWarning(code="unsigned", message=message))
    if chosen == "yes" and sense.ratio > DOMINANT_RATIO:
        message = (
            f"no axis dominates the motion ({ratio}; one axis leaves {DOMINANT_RATIO:.2f} at most), and theta has a "
            "sense only because --signed yes asks for it: its sign is that about the leading direction, and may change "
            "where the axis passes across that"
        )
        found.append(QualityWarning(code="sense-forced", message=message))
    if chosen == "auto" and sense.doubtful:
        answer = "has a sense" if sense.signed else "has none"
        message = (
            f"whether theta has a sense depends on the reference pose here ({ratio}, close to {DOMINANT_RATIO:.2f}): "
            f"it {answer}; --signed yes or no decides, or choose another --reference"
        )
        found.append(QualityWarning(code="sense-doubtful", message=message))
    if sense.tied:
        message = (
            "the rotation goes as far to one side of the reference as to the other: the side it went to first is the "
            "positive one; another --reference makes them differ"
        )
        found.append(QualityWarning(code="sense-tied", message=message))
    if sense.jump_row is not None and sense.largest_jump > LARGE_JUMP:
        steps = "1 step" if sense.jumps == 1 else f"{sense.jumps} steps"
        message = (
            f"in {steps} theta moves by more than {np.degrees(LARGE_JUMP):.0f} deg beyond the joint's own rotation, by "
            f"{np.degrees(sense.largest_jump):.0f} deg after frame {frame[sense.jump_row]}: there the axis changes its "
            "side; the rotation error of the model does not know of it"
        )
        found.append(QualityWarning(code="theta-jumps", message=message))
    if sense.bridged_rows:
        first = frame[sense.bridged_rows[0]]
        gaps = "a gap" if len(sense.bridged_rows) == 1 else f"{len(sense.bridged_rows)} gaps"
        told = "counted by that speed" if sense.counted else "told as if it did not"
        message = (
            f"by the speed beside it the joint turns by more than half a turn in {gaps} (the first after frame "
            f"{first}): which way round, and how often, is not seen; theta after it is {told}, and depends on that"
        )
        found.append(QualityWarning(code="turns-over-gap", message=message))
    return tuple(found)
