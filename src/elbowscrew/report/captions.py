"""Captions of the figures, with the numbers of this very result, as they can be printed beneath them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np

from elbowscrew.choices import JOINT_TYPE_WORDS, AngleUnit
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Comparison, TrialsComparison
from elbowscrew.quantities import rounded
from elbowscrew.report.bones_words import bone_words
from elbowscrew.report.caption_words import (
    KEYFRAMES,
    PARTS,
    angle,
    filtered,
    frame_name,
    interval,
    intervals_of_angles,
    intervals_of_path,
    length,
    letters_of_panels,
    measured_and_model,
    overview,
    shading,
    trial,
)
from elbowscrew.view.bands import is_seen
from elbowscrew.view.comparisons import has_displacements
from elbowscrew.view.cycle_curves import cycle_curves
from elbowscrew.view.joint_space import JointInBody, joint_in_body
from elbowscrew.view.long_trials import MOST_CYCLES, is_dense, shown_part, stretch_of
from elbowscrew.view.trial_view import TrialView, fitted_pitch_mm, model_label


def caption_of(name: str, view: TrialView) -> str:
    """Describe a figure of a trial.

    Parameters
    ----------
    name : str
        Of a figure that the trial has.
    view : TrialView

    Returns
    -------
    str
        One line of plain text; names in it are the file's own.
    """
    return " ".join(" ".join([*_CAPTIONS[name](view), *trial(view)]).split())


def overlay_caption(trials: int, cycles: int, unit: AngleUnit) -> str:
    """Describe the figure of several trials."""
    return (
        f"Angle θ ({unit}) of {trials} trials over the time of the movement, each cycle from 0 to 100 % of its own "
        f"time: the mean of each trial's cycles ({cycles} in all; thin grey), the mean of the trials (black) and one "
        "standard deviation between trials to either side (grey band). Cycles that are incomplete or not known "
        "throughout are left out.\n"
    )


def comparison_caption(found: Comparison | TrialsComparison) -> str:
    """Describe the figure of a comparison of models."""
    of = (
        "this trial"
        if isinstance(found, Comparison)
        else f"{len(found.trials)} trials (mean, bars: standard deviation)"
    )
    settings = found.settings
    error = (
        f"RMS displacement of the distal body's points, {settings.length_unit}"
        if has_displacements(found.models)
        else f"angle between modeled and measured orientation, {settings.angle_unit}"
    )
    return (
        f"Error of models of {of}: {error}. (a) "
        "Each interpolation method under its best law of motion, over the number of keyframes in each phase. (b) Each "
        "law under its best method. (c) Keyframes from the recording as it is, filtered and thinned. (d) Largest error "
        "over the number of keyframes where these are chosen best.\n"
    )


def _theta(view: TrialView) -> Iterator[str]:
    shown, stretch = shown_part(view)
    yield (
        f"Rotation angle θ of the {view.named_joint.distal.name} against the {view.named_joint.proximal.name} over "
        "time."
    )
    yield from overview(stretch)
    yield measured_and_model(view)
    yield interval(shown, "θ", shown.angle, shown.angle_sd, is_angle=True)
    yield from shading(shown, moving=True)


def _euler_parameters(view: TrialView) -> Iterator[str]:
    shown, stretch = shown_part(view)
    yield "Euler parameters e0 to e3 of the displacement since the reference over time."
    yield from overview(stretch)
    yield measured_and_model(view)
    yield from shading(shown)


def _joint(view: TrialView) -> Iterator[str]:
    proximal, distal = view.named_joint.proximal.name, view.named_joint.distal.name
    body, other = joint_in_body(view, "proximal"), joint_in_body(view, "distal")
    yield f"The joint: {JOINT_TYPE_WORDS[view.joint_summary['joint_type']['type']]}."
    two, ball = len(body.axes) == 2, body.center is not None
    what = "Its two axes" if two else "Its center" if ball else "Its axis" if body.axes else "Both bodies"
    yield (
        f"{what} at the reference, in the frame of (a) the {proximal} and (b) the {distal}, with "
        f"{_drawn_of_bodies(body, proximal, distal)} of the {proximal} (filled squares) and of the {distal} (open "
        "circles)."
    )
    if two:
        yield "Thin lines: where the angle about the other axis carries an axis."
        yield f"(c) Axis 1 in the {proximal}'s frame and (d) axis 2 in the {distal}'s,"
        yield _held([body.axes[0].known, other.axes[1].known], "enlarged across it")
    elif ball:
        yield f"(c, d) The center in the xy and the xz plane of the {proximal}'s frame,"
        known = body.semi_axes is not None and bool(np.isfinite(body.semi_axes).all())
        yield _held([True if known else None], "from two sides")
    elif body.axes:
        yield f"(c) The axis in the {proximal}'s frame,"
        yield _held([body.axes[0].known], "enlarged across it")


def _drawn_of_bodies(body: JointInBody, proximal: str, distal: str) -> str:
    own, other = body.markers is not None, body.other_markers is not None
    if own == other:
        return "the origins and markers" if own else "the origins"
    return f"the markers of the {proximal if own else distal} and the origins"


def _held(known: list[object | None], seen: str) -> str:
    """Tell what is drawn of an interval: orange where it is known."""
    if all(one is None for one in known):
        return "of which no 95 % interval is known."
    where = " where it is known" if None in known else ""
    return f"with what holds 95 % (orange{where}), {seen}."


def _slide(view: TrialView) -> Iterator[str]:
    yield "Slide along each frame's screw axis against the rotation about it."
    if stretch_of(view) is None:
        yield interval(view, "the slide", view.slide, view.slide_sd, is_angle=False)
    else:
        yield "Grey band: 90 % of the frames at each angle; black: their median as θ rises, and dashed as it falls;"
        yield "none where there are too few."
        if np.isfinite(view.slide_sd).any():
            half = length(view, NORMAL_95 * float(np.nanmedian(view.slide_sd)))
            yield f"95 % interval of one frame by the noise of the poses: ±{half} (median)."
    pitch_mm = fitted_pitch_mm(view)
    if pitch_mm is not None:
        slope = f"{rounded(pitch_mm, 3)} mm per radian"
        yield f"Straight line: the slope of the screw-hinge that is fitted to all frames, {slope}."
    if view.settings.axis_sd_deg is None:
        yield f"No slide is given below {view.settings.min_angle_deg:g} deg of rotation, where the axis is not known."


def _error(view: TrialView) -> Iterator[str]:
    named, body = model_label(view), view.named_joint.distal.name
    if view.located:
        yield (
            f"Error of the model ({named}) over time: (a) angle between modeled and measured orientation, (b) RMS "
            f"displacement of the {body}'s points; dotted: its RMS over time."
        )
    else:
        yield f"Error of the model ({named}) over time: angle of modeled to measured orientation; dotted: its RMS."
    yield KEYFRAMES if stretch_of(view) is None else PARTS
    yield from shading(view)


def _anatomy(view: TrialView) -> Iterator[str]:
    shown, stretch = shown_part(view)
    words, marks = bone_words(view), view.summary["landmarks"]
    by = "" if words is None or marks is None else f" by {words.sequence} ({marks['side']} side)"
    a, b, c, d, e = letters_of_panels(stretch, 5)
    first, second, third = view.named_joint.angles
    yield (
        f"{a}{first.capitalize()}, {b}{second} (varus positive) and {c}{third}{by} over time; "
        f"{d}{second} and {e}{third} against {first} (diamond: start)."
    )
    yield from overview(stretch)
    yield from shading(shown)


def _velocity(view: TrialView) -> Iterator[str]:
    shown, stretch = shown_part(view)
    what = "Angular velocity about the instantaneous axis"
    what += ", positive as θ grows" if view.summary["motion"]["signed"] else ", its size alone"
    a, *others = letters_of_panels(stretch, 1 + view.located)
    yield f"{a}{what}{f', and {others[0]}velocity along it' if others else ''}, over time."
    yield filtered(view)
    if others:
        yield f"No velocity along it is given below {view.settings.min_rate_rad_s:g} rad/s."
    yield from overview(stretch)
    yield from shading(shown)


def _instantaneous_axes(view: TrialView) -> Iterator[str]:
    yield (
        f"Instantaneous axes in the {frame_name(view)}: (a) in space; (b) tilt and (c) position across "
        "their mean, which weights each by the square of its angular velocity; color: θ."
    )
    yield filtered(view)
    yield f"No axis is given below {view.settings.min_rate_rad_s:g} rad/s."


def _cycles(view: TrialView) -> Iterator[str]:
    count, mean, found = view.repetitions.number.size, view.repetition_curve, cycle_curves(view)
    if count == 1:
        yield "Angle θ of the one cycle over its time."
        return
    shown = ["range of all (light grey)" if count > MOST_CYCLES else "each (thin grey)"]
    narrow = []
    if mean is not None:
        if not found.is_seen:
            shown = []
            narrow.append(f"all cycles lie within {angle(view, found.widest)} of each other")
        shown.append("mean (black)")
        if is_seen(mean["theta_mean"], mean["theta_sd"]):
            shown.append("one standard deviation to either side (grey band)")
        else:
            narrow.append(f"the standard deviation is {angle(view, float(np.nanmax(mean['theta_sd'])))} at most")
    yield f"Angle θ of {count} cycles, each from 0 to 100 % of its own time: {', '.join(shown)}."
    if narrow:
        yield f"Too narrow to be drawn: {', and '.join(narrow)}."


def _quality(view: TrialView) -> Iterator[str]:
    names = ["frames without a measured pose, by body and reason"]
    names += ["standard deviation of θ by the noise of the poses"] if np.isfinite(view.angle_sd).any() else []
    names += [] if view.joint_angles is None else ["rotation that the joint leaves of each pose"]
    names += [] if view.joint_angles is None or not view.located else ["distance that it leaves"]
    letters = letters_of_panels(None, len(names))
    yield f"Quality over time: {'; '.join(f'{one}{name}' for one, name in zip(letters, names, strict=True))}."
    if is_dense(view) and len(names) > 1:
        yield PARTS


def _axis(view: TrialView) -> Iterator[str]:
    yield (
        f"Finite screw axes in the {frame_name(view)}: (a) in space, with their weighted mean; (b) "
        "tilt and (c) position across the mean; color: θ."
    )


def _joint_axis(view: TrialView) -> Iterator[str]:
    grey = "; grey: 95 % of the frames' axes" if np.isfinite(view.spread95).all() else ""
    yield (
        f"The joint's axis among the axes of the frames, in the {frame_name(view)}: (a) in space, (b) "
        f"end-on, (c, d) from two sides, enlarged across; color: θ{grey}."
    )
    if view.confidence95 is None:
        yield "The motion has no single axis: the weighted mean of the frames' axes is shown."
        return
    model = str(view.joint_summary["preferred"]).replace("_", "-")
    cone, radius = view.confidence95
    if not np.isfinite([cone, radius]).all():
        yield f"Fit: {model}; its confidence is not known."
        return
    yield f"Fit: {model}; orange: 95 % confidence, {angle(view, cone)} and {length(view, radius)}."


def _joint_angles(view: TrialView) -> Iterator[str]:
    shown, stretch = shown_part(view)
    both = view.joint_angles is not None and view.joint_angles.angle.shape[1] == 2
    a, b, *others = letters_of_panels(stretch, 2 + view.located + both)
    position = f" and {others[0]}position" if view.located else ""
    together = f"; {others[-1]}the second angle against the first (diamond: start)" if both else ""
    yield f"{a}The joint's own angles ({JOINT_TYPE_WORDS[view.joint_summary['joint_type']['type']]}) over time;"
    yield f"what it leaves of each pose: {b}rotation{position}{together}."
    if is_dense(shown):
        yield "Of what it leaves, black: median, and grey: range of each part of the time."
    yield from overview(stretch)
    yield from intervals_of_angles(shown)
    yield from shading(shown)


def _axis_path(view: TrialView) -> Iterator[str]:
    yield (
        f"The joint's axis against its angle, in the {frame_name(view)}: (a) tilt and (b) shift from "
        "the mean axis in two directions across it."
    )
    yield from intervals_of_path(view)


def _paper(what: str, modeled: bool) -> Callable[[TrialView], Iterator[str]]:
    def told(view: TrialView) -> Iterator[str]:
        shown, stretch = shown_part(view)
        yield f"{what} over time, {'modeled by ' + model_label(view) if modeled else 'measured'}"
        yield (
            "(as figures 7 to 10 of Pennestrì and Valentini 2010; one scale with the "
            f"{'measured' if modeled else 'modeled'})."
        )
        yield from overview(stretch)
        yield KEYFRAMES if what is _ANGLE else ""
        yield from () if modeled else shading(shown)

    return told


_ANGLE, _PARAMETERS = "Rotation angle θ", "Euler parameters e0 to e3"
_CAPTIONS: Final[dict[str, Callable[[TrialView], Iterator[str]]]] = {
    "theta": _theta,
    "euler_parameters": _euler_parameters,
    "joint": _joint,
    "slide": _slide,
    "error": _error,
    "anatomy": _anatomy,
    "velocity": _velocity,
    "instantaneous_axes": _instantaneous_axes,
    "cycles": _cycles,
    "quality": _quality,
    "axis": _axis,
    "joint_axis": _joint_axis,
    "joint_angles": _joint_angles,
    "axis_path": _axis_path,
    "fig7": _paper(_ANGLE, modeled=False),
    "fig8": _paper(_ANGLE, modeled=True),
    "fig9": _paper(_PARAMETERS, modeled=False),
    "fig10": _paper(_PARAMETERS, modeled=True),
}
