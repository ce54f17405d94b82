"""The joint's type in sentences: what was found, what its intervals include, and what they do not."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elbowscrew.model.joint_summary_types import JointSummary, TwoAxesSummary, order_is_open
from elbowscrew.report.pages import number, vector
from elbowscrew.view.trial_view import TrialView


def joint_sentences(view: TrialView) -> tuple[str, ...]:
    """Say what the joint is, in sentences for the page."""
    return tuple(_sentences(view))


_TWO_AXES: Final = "Seen in the other segment an axis has the reference pose’s error."

HOLDS_IF: Final = {
    "motion": "the clusters move on the bone no more as a whole than their markers among themselves",
    "errors": "the clusters move on the bone no more as a whole than the stated errors show their markers to move "
    "among themselves",
    None: "the clusters do not move on the bone with the motion, of which nothing here tells",
}
"""What the intervals of clusters leave out, by what the file tells of markers."""


def _sentences(view: TrialView) -> Iterator[str]:
    joint = view.joint_summary
    two, ball = joint["two_axes"], joint["ball"]
    if two is not None:
        if order_is_open(two):
            proximal = view.named_joint.proximal.name
            yield f"Which axis is that of the {proximal} is open: the motion hardly turns about both at once."
        yield _apart(two)
    if ball is not None:
        proximal, distal = view.named_joint.proximal.name, view.named_joint.distal.name
        within = "" if ball["radius95_mm"] is None else f", within {number(ball['radius95_mm'])} mm"
        yield (
            f"The center is at ({vector(ball['center_in_proximal_mm'], 1)}) mm in the {proximal}{within}, and at "
            f"({vector(ball['center_in_distal_mm'], 1)}) mm in the {distal}; by SCoRE, beside it, at "
            f"({vector(ball['score']['center_in_proximal_mm'], 1)}) and "
            f"({vector(ball['score']['center_in_distal_mm'], 1)}) mm."
        )
    yield from _beside_a_hinge(joint)
    yield from _intervals(joint, located=view.located)
    if two is not None or ball is not None:
        mixed = "both axes" if two is not None else "all directions"
        beside = () if two is None else (_TWO_AXES, *_wander_of_each(two))
        yield (
            f"The angle θ mixes rotations about {mixed}; the joint’s own angles stand in joint_angles.csv and the "
            f"{' '.join(('figure joint_angles.', *beside))}"
        )
    side = view.summary["trial"]["joint"]["side"]
    if two is not None and side is not None and view.named_joint.name == "elbow":
        yield f"On this {side} side a positive second angle is pronation, as far as the second axis is the forearm’s."


def _apart(two: TwoAxesSummary) -> str:
    if two["angle_between_deg"] is None:
        return "How the axes stand to each other is undetermined."
    limits = f"({number(two['angle_between_deg_low'], 1)} to {number(two['angle_between_deg_high'], 1)})"
    if two["distance_mm"] is None and two["parallel_offset_mm"] is None:
        return f"The axes are {number(two['angle_between_deg'], 1)} deg {limits} apart in direction."
    if two["distance_mm"] is None:
        off = f"({number(two['parallel_offset_mm_low'], 1)} to {number(two['parallel_offset_mm_high'], 1)})"
        return f"The axes are parallel, {number(two['parallel_offset_mm'], 1)} mm {off} apart."
    far = f"({number(two['distance_mm_low'], 1)} to {number(two['distance_mm_high'], 1)})"
    return (
        f"The axes are {number(two['angle_between_deg'], 1)} deg {limits} apart in direction, and "
        f"{number(two['distance_mm'], 1)} mm {far} along their common normal."
    )


def _wander_of_each(two: TwoAxesSummary) -> Iterator[str]:
    """Say of each axis that is told how far it wanders, or what would not be seen."""
    axes = (("axis 1", two["axis1"]), ("axis 2", two["axis2"]))
    told = [(name, axis["wander"]) for name, axis in axes if axis["determined"]]
    for name, wander in told:
        if wander is not None and wander["significant"]:
            yield (
                f"{name.capitalize()} wanders by {number(wander['size_deg'])} deg{_and_mm(wander['size_mm'])} over its "
                "range: both axes are given as they are on the mean."
            )
    unseen = [
        f"{number(wander['unseen_deg'])} deg of {name}"
        for name, wander in told
        if wander is not None and not wander["significant"]
    ]
    if unseen:
        yield f"A wander below {' or '.join(unseen)} may exceed the intervals unseen."
    unknown = [name for name, wander in told if wander is None]
    if unknown:
        yield f"Whether {' or '.join(unknown)} wanders with its angle the motion does not tell."


def _beside_a_hinge(joint: JointSummary) -> Iterator[str]:
    second, wander = joint["second_rotation"], joint["wander"]
    if second is not None:
        axis = second["axis"]
        which = (
            "its axis is undetermined"
            if axis is None
            else f"its axis in the distal body is ({vector(axis['direction_in_distal'], 4)})"
        )
        yield f"Beside the hinge there is a second rotation of {number(second['range_deg'])} deg; {which}."
    if wander is not None and wander["significant"]:
        yield (
            f"The axis wanders by {number(wander['size_deg'])} deg{_and_mm(wander['size_mm'])} over the range "
            "of the angle: the axis given first is its mean, and axis_path.csv has the axis against the angle."
        )
    elif wander is not None:
        yield (
            f"The axis is not seen to wander; less than {number(wander['unseen_deg'])} deg"
            f"{_and_mm(wander['unseen_mm'])} over the range would not be seen."
        )


def _and_mm(value: float | None) -> str:
    return "" if value is None else f" and {number(value)} mm"


def _intervals(joint: JointSummary, *, located: bool) -> Iterator[str]:
    method, told = joint["joint_type"]["interval_method"], joint["joint_type"]["markers_told"]
    skin, kappa = joint["skin_motion"], joint["sensitivity_deg_per_deg"]
    if method is None:
        return
    if not located:
        yield (
            f"The 95 % intervals are those of the sensors’ frames, {method}. They hold if no sensor turns on its bone "
            "with the motion, which nothing here would show; skin often does so: --skin-motion 0,DEG states it."
        )
    else:
        yield (
            f"The 95 % intervals are those of the clusters’ frames, {method}. They hold if {HOLDS_IF[told]}; skin "
            "often moves more: --skin-motion states it."
        )
    one = "cluster" if located else "sensor"
    if kappa is not None:
        yield f"Each degree that a {one} turns on its bone with the motion turns it by up to {number(kappa)} deg."
    if skin is not None and located:
        yield (
            f"Stated and included is motion of each cluster as a whole of {number(skin['mm'])} mm and "
            f"{number(skin['deg'])} deg: its part is {number(skin['part_deg'])} deg and {number(skin['part_mm'])} mm."
        )
    elif skin is not None and skin["deg"] > 0.0:
        yield (
            f"Stated and included is a turn of each sensor on its bone of {number(skin['deg'])} deg: its part is "
            f"{number(skin['part_deg'])} deg."
        )
    elif skin is not None:
        yield (
            "The millimeters of motion that --skin-motion states have no effect on orientations without positions: "
            "--skin-motion 0,DEG states a turn."
        )
