"""What an expert wants to see of a trial first, as names and short texts: for the console and for a notebook."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elbowscrew.choices import JOINT_TYPE_WORDS, METHOD_LABELS
from elbowscrew.model.joint_summary_types import JointSummary, Vector
from elbowscrew.model.summary_types import Summary
from elbowscrew.report.pages import brief, number, percent, vector

_FITS: Final = {"hinge": "hinge", "screw_hinge": "screw-hinge"}

Fact = tuple[str, str]


def facts(summary: Summary, joint: JointSummary) -> list[Fact]:
    """Say what was recorded, how far the joint turned, which joint it is, where its axis is, and how sure that is."""
    trial, motion = summary["trial"], summary["motion"]
    words, proximal = trial["joint"], trial["proximal"]
    named = f"still {words['proximal']}" if proximal is None else proximal["name"]
    filled = f", {trial['filled_frames']} frames filled in" if trial["filled_frames"] else ""
    sense = "" if motion["signed"] else ", without a sense"
    return [
        ("bodies", f"{named} → {trial['distal']['name']} ({words['name']})"),
        (
            "frames",
            f"{trial['frames']} at {trial['rate_hz']:g} Hz, {number(trial['duration_s'])} s; "
            f"{percent(1.0 - trial['missing_share'])} tracked{filled}",
        ),
        (
            "theta",
            f"{number(motion['theta_min_deg'], 1)} to {number(motion['theta_max_deg'], 1)} deg{sense}, largest at "
            f"frame {motion['theta_max_frame']}; {_counted(motion['repetitions'], 'cycle')}",
        ),
        *_joint(summary, joint),
        ("model", _model(summary)),
    ]


def warned(summary: Summary) -> Fact:
    """Name the warnings, and count the notes."""
    codes = [one["code"] for one in summary["warnings"] if one["severity"] == "warning"]
    notes = len(summary["warnings"]) - len(codes)
    told = ", ".join(codes) or "none"
    return "warnings", told + (f" ({_counted(notes, 'note')})" if notes else "")


def _joint(summary: Summary, joint: JointSummary) -> Iterator[Fact]:
    """Say the joint's type and its axes or center, each with what holds 95 % of its errors."""
    told = joint["joint_type"]
    status = {None: "", "forced": " (as stated)"}.get(told["status"], f" ({told['status']})")
    yield "joint", f"{JOINT_TYPE_WORDS[told['type']]}{status}: {told['reason']}"
    where = f"in the {joint['expressed_in']} frame" + (" at the reference" if joint["expressed_in"] == "distal" else "")
    two, ball, axis = joint["two_axes"], joint["ball"], summary["motion"]["joint_axis"]
    if two is not None:
        # Each in the body it is fixed in, where its cone and radius hold.
        first, second = two["axis1"], two["axis2"]
        for name, line, drawn, body in (
            ("axis 1", first, _line(first["direction_in_proximal"], first["point_in_proximal_mm"]), "proximal"),
            ("axis 2", second, _line(second["direction_in_distal"], second["point_in_distal_mm"]), "distal"),
        ):
            known = _within(line["cone95_deg"], line["radius95_mm"]) if line["determined"] else "not determined"
            wander = line["wander"]
            mean = " (mean of an axis that wanders)" if wander is not None and wander["significant"] else ""
            yield name, f"{drawn} in the {body} frame{mean}; {known}"
    elif ball is not None:
        radius = ball["radius95_mm"]
        known = "not known how surely" if radius is None else f"95 % within {brief(radius)} mm"
        yield "center", f"({vector(ball['center_in_proximal_mm'], 1)}) mm in the proximal frame; {known}"
    elif axis is not None:
        mean = "mean of an axis that wanders" if axis["is_mean"] else _FITS[axis["model"]]
        known = _within(axis["axis_cone95_deg"], axis["point_radius95_mm"])
        yield "axis", f"{_line(axis['direction'], axis['point_mm'])} {where} ({mean}); {known}"
    else:
        yield "axis", "the motion has no single axis"


def _line(direction: Vector, point_mm: Vector | None) -> str:
    through = "" if point_mm is None else f" through ({vector(point_mm, 1)}) mm"
    return f"({vector(direction, 3)}){through}"


def _within(cone_deg: float | None, radius_mm: float | None) -> str:
    parts = [f"{brief(value)} {unit}" for value, unit in ((cone_deg, "deg"), (radius_mm, "mm")) if value is not None]
    return f"95 % within {' and '.join(parts)}" if cone_deg is not None else "not known how surely"


def _model(summary: Summary) -> str:
    model = summary["interpolation"]
    laws = " and ".join(dict.fromkeys(law["law"] for law in model["phase_laws"]))
    errors = [(model["rms_angle_error_deg"], "deg"), (model["rms_displacement_mm"], "mm")]
    told = ", ".join(f"{brief(value, 3)} {unit}" for value, unit in errors if value is not None)
    name = METHOD_LABELS.get(model["method"], model["method"])
    return f"{name} through {len(model['keyframes'])} poses, {laws} law; RMS error {told or 'not known'}"


def _counted(count: int, word: str) -> str:
    return f"{count} {word}{'' if count == 1 else 's'}"
