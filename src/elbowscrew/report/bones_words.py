"""The axis against the bones in sentences: for the page, and for a paper's methods section."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from elbowscrew.choices import FUNCTIONAL_AXIS_WORDS
from elbowscrew.joints import Joint
from elbowscrew.model.anatomy import LANDMARKS, LANDMARKS_OF, BonyJoint
from elbowscrew.model.joint_summary_types import AnatomySummary, AxisAgainstBones
from elbowscrew.model.summary_types import AngleRange, LandmarksSummary
from elbowscrew.report.facts import Facts
from elbowscrew.report.pages import number, vector
from elbowscrew.view.trial_view import TrialView


class BoneWords(NamedTuple):
    """How a joint's bones and angles are told of.

    Attributes
    ----------
    limb, distal, proximal : str
        As in "Angles of the distal bone against the proximal one of a right limb".
    sequence : str
        Whose the frames and the sequence are.
    senses : tuple of str
        What is positive of each angle, for a table.
    listed : str
        The angles in a sentence, with what needs to be said of their signs.
    """

    limb: str
    distal: str
    proximal: str
    sequence: str
    senses: tuple[str, str, str]
    listed: str


BONE_WORDS: Final[Mapping[BonyJoint, BoneWords]] = {
    "elbow": BoneWords(
        "arm",
        "forearm",
        "humerus",
        "the sequence Z-X-Y of the International Society of Biomechanics (Wu and others 2005)",
        ("flexion", "varus, so that a valgus elbow’s is negative", "pronation, from supination on"),
        "flexion, carrying angle (varus positive) and pronation (0 in supination)",
    ),
    "knee": BoneWords(
        "leg",
        "tibia",
        "femur",
        "the joint coordinate system of Grood and Suntay (1983)",
        ("flexion", "adduction (varus)", "internal rotation"),
        "flexion, adduction (varus positive) and internal rotation",
    ),
}


def bone_words(view: Facts) -> BoneWords | None:
    """How the bones are told of; None without landmarks."""
    marks = view.summary["landmarks"]
    return next((BONE_WORDS[joint] for joint, names in LANDMARKS_OF.items() if marks and names[0] in marks), None)


def bone_angles(view: TrialView) -> tuple[tuple[str, str, AngleRange], ...]:
    """Name, positive sense and range of each angle of the bones; nothing without landmarks."""
    words, found = bone_words(view), view.summary["motion"]["anatomy"]
    if words is None or found is None:
        return ()
    joint = view.named_joint
    ranges = [found[key] for key in joint.angle_keys]  # type: ignore[literal-required]
    return tuple(zip(joint.angles, words.senses, ranges, strict=True))


def bones_sentences(view: TrialView) -> tuple[str, ...]:
    """Say how the axis stands to the epicondyles, and where the joint's center is; nothing without landmarks."""
    found = view.joint_summary["anatomy"]
    return () if found is None else tuple(_sentences(found, view.named_joint, _method(view)))


def _sentences(found: AnatomySummary, joint: Joint, method: str) -> Iterator[str]:
    if found["axis"] is None:
        yield "The motion shows no axis to hold against the line of the epicondyles."
    else:
        angle = _limits(found["axis_angle_deg_low"], found["axis_angle_deg_high"])
        distance = _limits(found["axis_distance_mm_low"], found["axis_distance_mm_high"])
        yield (
            f"The {FUNCTIONAL_AXIS_WORDS[found['axis']]} lies {number(found['axis_angle_deg'])} deg{angle} off the "
            f"line of the epicondyles and passes {number(found['axis_distance_mm'])} mm{distance} from the joint’s "
            "center."
        )
        yield (
            f"{_standing(angle, method)} the error of the landmarks themselves is not included: each millimeter by "
            "which one epicondyle is off turns their line by up to "
            f"{number(found['landmark_sensitivity_deg_per_mm'])} deg."
        )
    yield (
        "The joint’s center is the point midway between the epicondyles: "
        f"({vector(found['joint_center_in_proximal_mm'])}) mm in the frame of the {joint.proximal.name}, and "
        f"({vector(found['joint_center_in_distal_mm'])}) mm in that of the {joint.distal.name} at the reference."
    )


def _standing(limits: str, method: str) -> str:
    if not limits:
        return "No interval can be given;"
    return f"In brackets stand 95 % limits for the clusters’ frames, {method};"


def _limits(low: float | None, high: float | None) -> str:
    return "" if low is None or high is None else f" ({number(low)} to {number(high)})"


def _method(view: TrialView) -> str:
    return view.joint_summary["joint_type"]["interval_method"] or ""


def bones_methods(view: TrialView) -> Iterator[str]:
    """Describe how the bones' angles were found, and what the axis is against them."""
    found, marks = view.joint_summary["anatomy"], view.summary["landmarks"]
    if found is None or marks is None:
        return
    words = BONE_WORDS[found["joint"]]
    yield (
        f"{words.listed[0].upper()}{words.listed[1:]} were computed by {words.sequence} from landmarks of the "
        f"{found['side']} {words.limb} ({landmark_sources(marks)}); signs mean the same on both sides."
    )
    if found["axis"] is None:
        return
    without = ", without the error of the landmarks" if found["axis_angle_deg_low"] is not None else ""
    yield f"The {FUNCTIONAL_AXIS_WORDS[found['axis']]} lies {axis_against_epicondyles(found)}{without}."


def axis_against_epicondyles(found: AxisAgainstBones) -> str:
    """How the axis stands to the epicondyles, with its interval."""
    angle, distance = (
        _interval(found["axis_angle_deg_low"], found["axis_angle_deg_high"], "°"),
        _interval(found["axis_distance_mm_low"], found["axis_distance_mm_high"], " mm"),
    )
    return (
        f"{found['axis_angle_deg']:.2f}°{angle} off the line of the epicondyles and passes "
        f"{found['axis_distance_mm']:.2f} mm{distance} from the point midway between them"
    )


def landmark_sources(marks: LandmarksSummary) -> str:
    """Which landmarks are of markers, and which were given as coordinates."""
    of_joint = [name for name in LANDMARKS if name in marks]
    by_markers = [name for name in of_joint if "markers" in marks[name]]  # type: ignore[literal-required]
    given = [name for name in of_joint if name not in by_markers]
    told = [f"{', '.join(by_markers)} from markers"] if by_markers else []
    return "; ".join([*told, *([f"{', '.join(given)} by coordinates"] if given else [])])


def _interval(low: float | None, high: float | None, unit: str) -> str:
    return "" if low is None or high is None else f" (95 % interval {low:.2f} to {high:.2f}{unit})"
