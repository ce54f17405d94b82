"""What a person reads on the terminal of the joint as a whole: which it is, and where its axes or its center are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from elbowscrew.choices import FUNCTIONAL_AXIS_WORDS
from elbowscrew.cli.text import two_decimals, vector_text
from elbowscrew.joints import joints_of
from elbowscrew.quantities import in_digits

if TYPE_CHECKING:
    from elbowscrew.model.joint_summary_types import (
        JointLineSummary,
        JointTypeSummary,
        SecondRotationSummary,
        Vector,
        WanderSummary,
    )
    from elbowscrew.model.summary_types import AngleRange, AnglesOfBones, MotionSummary


def joint_text(found: JointTypeSummary) -> str:
    """Say which joint it is, and why."""
    status = {"forced": " (as stated)", None: ""}.get(found["status"], f" ({found['status']})")
    return f"{found['type'].replace('_', '-' if 'hinge' in found['type'] else ' ')}{status}: {found['reason']}"


def joint_axis_text(motion: MotionSummary, *, located: bool) -> str:
    """Say where the joint's axis is, or its axes or center, and how well that is known."""
    axis, numbers = motion["joint_axis"], motion["joint_numbers"]
    whose, whose_body = names = ("clusters'", "cluster") if located else ("sensors'", "sensor")
    if axis is None:
        return _axes_or_center(motion, names)
    model = axis["model"].replace("_", "-")
    direction = vector_text(axis["direction"], 4)
    beside = _wander(numbers["wander"]) + _second_rotation(numbers["second_rotation"])
    if axis["axis_cone95_deg"] is None:
        place = place_text(axis["point_mm"])
        return f"direction ({direction}){place} ({model}; undetermined: no interval can be given){beside}"
    which = f"mean axis of a {model} whose axis wanders" if axis["is_mean"] else model
    place = "" if axis["point_mm"] is None else f", point ({vector_text(axis['point_mm'], 1)})"
    place += "" if axis["point_radius95_mm"] is None else f" within {in_digits(axis['point_radius95_mm'])} mm"
    return (
        f"direction ({direction}) within {in_digits(axis['axis_cone95_deg'])} deg{place} "
        f"({which}, 95 %, for the {whose} frames, {axis['interval_method']}; "
        f"each degree that a {whose_body} turns on its bone with the motion turns this axis by up to "
        f"{in_digits(axis['sensitivity_deg_per_deg'])} deg){beside}"
    )


def anatomy_rows(found: AnglesOfBones | None) -> Iterator[tuple[str, str]]:
    """Tell the bones' angles, and the axis against the line of the epicondyles."""
    if found is None:
        return
    joint = joints_of(found["joint"])[0]
    ranges = [(name, found[key]) for name, key in zip(joint.angles, joint.angle_keys, strict=True)]  # type: ignore[literal-required]
    angles = ", ".join(_range_text(name, angle) for name, angle in ranges)
    yield "Anatomy", f"{found['side']} side: {angles}"
    if found["axis"] is None:
        yield "Epicondyles", "the motion shows no axis to hold against their line"
        return
    angle, distance = found["axis_angle_deg"], found["axis_distance_mm"]
    known = "no interval can be given" if found["axis_angle_deg_low"] is None else "95 %, for the clusters' frames"
    yield (
        "Epicondyles",
        f"the {FUNCTIONAL_AXIS_WORDS[found['axis']]} is {two_decimals(angle)} deg"
        f"{_limits(found['axis_angle_deg_low'], found['axis_angle_deg_high'])} off their line and passes "
        f"{two_decimals(distance)} mm{_limits(found['axis_distance_mm_low'], found['axis_distance_mm_high'])} from the "
        f"point midway between them ({known}, without the error of the landmarks: each mm that one of them is off "
        f"turns the line by up to {in_digits(found['landmark_sensitivity_deg_per_mm'])} deg)",
    )


def _range_text(word: str, found: AngleRange) -> str:
    if found["start_deg"] is None:
        return f"{word} not known"
    low, high, start = (two_decimals(found[key]) for key in ("min_deg", "max_deg", "start_deg"))
    return f"{word} {low} to {high} deg ({start} at the start)"


def _limits(low: float | None, high: float | None) -> str:
    return "" if low is None or high is None else f" ({two_decimals(low)} to {two_decimals(high)})"


def _wander(found: WanderSummary | None) -> str:
    """How far the axis goes with the angle, or what would not be seen."""
    return _how_far(
        found,
        "; the axis stays: a wander below {} would not be seen",
        "; it wanders by {} over the range (axis_path.csv)",
    )


def _over_which(found: WanderSummary | None) -> str:
    """How far one of two axes goes with its angle, or what would not be seen."""
    return _how_far(found, ", over which a wander below {} would not be seen", ", over which it wanders by {}")


def _how_far(found: WanderSummary | None, unseen: str, seen: str) -> str:
    if found is None or found["size_deg"] is None or found["unseen_deg"] is None:
        return ""
    if not found["significant"]:
        return unseen.format(f"{in_digits(found['unseen_deg'])} deg")
    shift = "" if found["size_mm"] is None else f" and {in_digits(found['size_mm'])} mm"
    return seen.format(f"{in_digits(found['size_deg'])} deg{shift}")


def _second_rotation(found: SecondRotationSummary | None) -> str:
    if found is None or found["range_deg"] is None:
        return ""
    axis = found["axis"]
    which = "its axis undetermined" if axis is None else f"about ({vector_text(axis['direction'], 4)})"
    return f"; second rotation {in_digits(found['range_deg'])} deg, {which}"


def place_text(point_mm: Vector | None) -> str:
    """Say where a line passes, if that is known."""
    return "" if point_mm is None else f", point ({vector_text(point_mm, 1)}) mm"


def _axes_or_center(motion: MotionSummary, whose: tuple[str, str]) -> str:
    from elbowscrew.model.joint_summary_types import order_is_open

    found, axes, ball = motion["joint_type"], motion["joint_numbers"]["two_axes"], motion["joint_numbers"]["ball"]
    if axes is not None:
        told = f"{_one_of_two(axes['axis1'], 'proximal')}; {_one_of_two(axes['axis2'], 'distal')}"
        if order_is_open(axes):
            told += "; which one is the proximal body's is open"
        if axes["angle_between_deg"] is None:
            return f"{told}; how they stand to each other is undetermined ({_stands_on(found, whose)})"
        apart = f"{axes['angle_between_deg']:.1f} deg"
        if axes["distance_mm"] is not None:
            apart += f" and {abs(axes['distance_mm']):.1f} mm"
        elif axes["parallel_offset_mm"] is not None:
            apart = f"parallel, {axes['parallel_offset_mm']:.1f} mm"
        return f"{told}; {apart} apart ({_stands_on(found, whose)})"
    if ball is not None:
        within = "" if ball["radius95_mm"] is None else f" within {in_digits(ball['radius95_mm'])} mm"
        return (
            f"center ({vector_text(ball['center_in_proximal_mm'], 1)}) mm in the proximal body{within} "
            f"({_stands_on(found, whose)})"
        )
    return "none"


def _stands_on(found: JointTypeSummary, whose: tuple[str, str]) -> str:
    return (
        f"95 %, for the {whose[0]} frames, {found['interval_method'] or 'not known'}; "
        f"a {whose[1]} that turns on its bone with the motion is in it only as --skin-motion states"
    )


def _one_of_two(axis: JointLineSummary, body: Literal["proximal", "distal"]) -> str:
    number = 1 if body == "proximal" else 2
    direction = vector_text(axis["direction_in_proximal"] if number == 1 else axis["direction_in_distal"], 4)
    if not axis["determined"]:
        return f"axis {number} undetermined, {axis['range_deg']:.0f} deg about it"
    wander = axis["wander"]
    mean = "mean axis" if wander is not None and wander["significant"] else "axis"
    return (
        f"{mean} {number} ({direction}) in the {body} body within {in_digits(axis['cone95_deg'])} deg, "
        f"{axis['range_deg']:.0f} deg about it{_over_which(wander)}"
    )
