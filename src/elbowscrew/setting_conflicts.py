"""Settings that contradict each other: what is wrong with them together, in the names of the options, or None."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from elbowscrew.choices import FRAMES, BlendName, JointName, KnotName, MethodName


def of_frame(express_in: str, joint: JointName | None) -> str | None:
    """Tell a frame that is no segment of the joint that is stated."""
    from elbowscrew.joints import ends_called, joints_of

    joints = joints_of(joint)
    if joint is None or express_in in FRAMES or ends_called(express_in, joints):
        return None
    words = ", ".join(dict.fromkeys(end.short for one in joints for end in (one.proximal, one.distal)))
    known = f"{', '.join(FRAMES)}, {words}"
    return f"--express-in {express_in}: no segment of --joint {joint}; expected one of {known}"


def of_cycles(cycles: object, *, no_cycles: bool) -> str | None:
    """Tell cycles that are given and refused."""
    if no_cycles and cycles is not None:
        return "--no-cycles and --cycles contradict each other; give one of them"
    return None


def of_law(law: str, peak: float | None) -> str | None:
    """Tell a peak of a law whose highest velocity cannot be placed."""
    why = {"linear": "has no highest velocity", "empirical": "is the recording's own", "best": "finds its own"}
    if peak is None or law not in why:
        return None
    return f"--law-peak: the law '{law}' {why[law]}; leave --law-peak out"


def of_tolerance(
    method: MethodName | None,
    law: str | None,
    keyframes: Sequence[int] | None,
    knots: KnotName,
    blend: BlendName,
) -> str | None:
    """Tell a model whose fewest keyframes cannot be found."""
    if keyframes is not None:
        return "--tolerance chooses the keyframes itself; give either --tolerance or --keyframes"
    if method not in (None, "sclerp", "sdlb", "joint"):
        return (
            f"--tolerance: with --method {method} a piece depends on more than its two keyframes, and no best set can "
            "be told; expected sclerp, sdlb or joint"
        )
    if law == "empirical":
        return (
            "--tolerance: the recording's own law need not go forward all the time; expected another --law than "
            "empirical"
        )
    if knots != "law" or blend != "piecewise":
        return (
            "--tolerance: the model must pass each keyframe at its own time, piece by piece; leave --knots and --blend "
            "out"
        )
    return None


def of_keyframes(frames: Sequence[int], inversion: int | None) -> str | None:
    """Tell keyframes out of order, and an inversion that is none of them."""
    if any(later <= earlier for earlier, later in itertools.pairwise(frames)):
        return f"keyframes must increase, each of them once, found {','.join(map(str, frames))}"
    if frames and inversion is not None and inversion not in frames[1:-1]:
        return (
            f"the inversion ({inversion}) must be one of the keyframes between the first and the last: add it to "
            "--keyframes or leave --inversion out"
        )
    return None
