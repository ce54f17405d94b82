"""Captions of the figures, with the numbers of this very result, as they can be printed beneath them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np

from elbowscrew.choices import JOINT_TYPE_WORDS, METHOD_LABELS, AngleUnit
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Comparison, TrialsComparison
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.view.bands import is_seen
from elbowscrew.view.long_trials import Stretch, stretch_of
from elbowscrew.view.trial_view import TrialView, fitted_pitch_mm

_MANY_CYCLES: Final = 20


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
    return " ".join(" ".join([*_CAPTIONS[name](view), *_trial(view)]).split())


def overlay_caption(trials: int, cycles: int, unit: AngleUnit) -> str:
    """Describe the figure of several trials."""
    return (
        f"Angle θ ({unit}) of {trials} trials over the time of the movement, each cycle from 0 to 100 % of its own "
        "time: "
        f"the mean of each trial's cycles ({cycles} in all; thin grey), the mean of the trials (black) and one "
        "standard "
        "deviation between trials to either side (grey band), where all trials are known.\n"
    )


_DISPLACEMENT: Final = {True: "rms_displacement", False: "rms_displacement_mean"}


def comparison_caption(found: Comparison | TrialsComparison) -> str:
    """Describe the figure of a comparison of models."""
    of = (
        "this trial"
        if isinstance(found, Comparison)
        else f"{len(found.trials)} trials (mean, bars: standard deviation)"
    )
    located = bool(np.isfinite(getattr(found.models, _DISPLACEMENT[isinstance(found, Comparison)])).any())
    settings = found.settings
    error = (
        f"RMS displacement of the distal body's points, {settings.length_unit}"
        if located
        else f"angle between modeled and measured orientation, {settings.angle_unit}"
    )
    return (
        f"Error of models of {of}: {error}. (a) "
        "Each "
        "interpolation method under its best law of motion, over the number of keyframes in each phase. (b) Each law "
        "under "
        "its best method. (c) Keyframes from the recording as it is, filtered and thinned. (d) Largest error "
        "over the number of keyframes where these are chosen best.\n"
    )


def _theta(view: TrialView) -> Iterator[str]:
    yield (
        f"Rotation angle θ of the {view.named_joint.distal.name} against the {view.named_joint.proximal.name} over "
        "time."
    )
    yield from _long(view, "the range of θ in each part of the recording")
    yield _model(view)
    yield _interval(view, "θ", view.angle, view.angle_sd, is_angle=True)
    yield from _shading(view, moving=True)


def _euler_parameters(view: TrialView) -> Iterator[str]:
    yield "Euler parameters e0 to e3 of the displacement since the reference over time."
    yield from _long(view, "the range of θ in each part of the recording")
    yield _model(view)
    yield from _shading(view)


def _joint(view: TrialView) -> Iterator[str]:
    words, found = view.named_joint, view.joint_summary["joint_type"]
    two = view.joint_summary["two_axes"] is not None
    ball = view.joint_summary["ball"] is not None
    yield f"The joint: {JOINT_TYPE_WORDS[found['type']]}."
    what = "Its two axes" if two else "Its center" if ball else "Its axis"
    yield (
        f"{what} at the reference, in the frame of (a) the {words.proximal.name} and (b) the {words.distal.name}, "
        "with the "
        f"origins and markers of the {words.proximal.name} (filled squares) and of the {words.distal.name} (open "
        "circles)."
    )
    if two:
        yield "Thin lines: where the angle about the other axis carries an axis."
        yield "(c, d) What holds 95 % of each axis (orange), enlarged across it."
    elif ball:
        yield "(c, d) What holds 95 % of the center (orange), from two sides."
    elif view.joint_summary["preferred"] is not None or view.joint_summary["mean_axis"] is not None:
        yield "(c) What holds 95 % of the axis (orange), enlarged across it."


def _slide(view: TrialView) -> Iterator[str]:
    yield "Slide along each frame's screw axis against the rotation about it."
    if stretch_of(view) is None:
        yield _interval(view, "the slide", view.slide, view.slide_sd, is_angle=False)
    else:
        yield "Grey band: 90 % of the frames at each angle; black: their median as θ rises, and dashed as it falls."
        if np.isfinite(view.slide_sd).any():
            half = _length(view, NORMAL_95 * float(np.nanmedian(view.slide_sd)))
            yield f"95 % interval of one frame by the noise of the poses: ±{half} (median)."
    pitch_mm = fitted_pitch_mm(view)
    if pitch_mm is not None:
        yield f"Straight line: the slope of the screw-hinge that is fitted to all frames, {pitch_mm:.3g} mm per radian."
    if view.settings.axis_sd_deg is None:
        yield f"No slide is given below {view.settings.min_angle_deg:g} deg of rotation, where the axis is not known."


def _error(view: TrialView) -> Iterator[str]:
    named, body = _named_model(view), view.named_joint.distal.name
    if view.located:
        yield (
            f"Error of the model ({named}) over time: (a) angle between modeled and measured orientation, (b) RMS "
            f"displacement of the {body}'s points; dotted: its RMS over time."
        )
    else:
        yield f"Error of the model ({named}) over time: angle of modeled to measured orientation; dotted: its RMS."
    yield "Circles: the poses that the model passes through." if stretch_of(view) is None else _PARTS
    yield from _shading(view)


def _anatomy(view: TrialView) -> Iterator[str]:
    side = "" if view.summary["landmarks"] is None else f" ({view.summary['landmarks']['side']} side)"
    yield (
        f"Flexion, carrying angle (varus positive) and pronation by the ISB's sequence Z-X-Y{side}, over time and, "
        "of the "
        "latter two, against flexion (diamond: start)."
    )
    yield from _long(view, "the range of θ in each part of the recording")
    yield from _shading(view)


def _velocity(view: TrialView) -> Iterator[str]:
    along = ", and velocity along it," if view.located else ""
    yield f"Angular velocity about the instantaneous axis, positive as θ grows{along} over time."
    yield from _filter(view)
    yield from _long(view, "the range of θ in each part of the recording")
    yield from _shading(view)


def _instantaneous_axes(view: TrialView) -> Iterator[str]:
    yield (
        f"Instantaneous axes in the {view.settings.express_in} frame: (a) in space; (b) tilt and (c) position across "
        "their "
        "mean, which weights each by the square of its angular velocity; color: θ."
    )
    yield from _filter(view)


def _cycles(view: TrialView) -> Iterator[str]:
    count = view.repetitions.number.size
    each = "range of all (light grey)" if count > _MANY_CYCLES else "each (thin grey)"
    if count == 1:
        yield "Angle θ of the one cycle over its time."
    else:
        yield f"Angle θ of {count} cycles, each from 0 to 100 % of its own time: {each}, mean (black)"
        yield "and one standard deviation to either side (grey band)."


def _quality(view: TrialView) -> Iterator[str]:
    yield "Quality over time: frames without a measured pose, by body and reason;"
    yield "standard deviation of θ by the noise of the poses"
    yield "" if view.joint_angles is None else "and what the joint leaves of each pose, rotation and position"
    yield "(none where it is not known)."
    if stretch_of(view) is not None:
        yield _PARTS


def _axis(view: TrialView) -> Iterator[str]:
    yield (
        f"Finite screw axes in the {view.settings.express_in} frame: (a) in space, with their weighted mean; (b) "
        "tilt and "
        "(c) position across the mean; color: θ."
    )


def _joint_axis(view: TrialView) -> Iterator[str]:
    yield (
        f"The joint's axis among the axes of the frames, in the {view.settings.express_in} frame: (a) in space, (b) "
        "end-on, "
        "(c, d) from two sides, enlarged across; color: θ; grey: 95 % of the frames' axes."
    )
    if view.confidence95 is None:
        yield "The motion has no single axis: the weighted mean of the frames' axes is shown."
        return
    model = str(view.joint_summary["preferred"]).replace("_", "-")
    angle, radius = view.confidence95
    if not np.isfinite(angle):
        yield f"Fit: {model}; its confidence is not known."
        return
    yield f"Fit: {model}; orange: 95 % confidence, {_angle(view, angle)} and {_length(view, radius)}."


def _joint_angles(view: TrialView) -> Iterator[str]:
    yield f"The joint's own angles ({JOINT_TYPE_WORDS[view.joint_summary['joint_type']['type']]}) over time"
    yield "and what it leaves of each pose, rotation and position." if view.located else "and the rotation it leaves."
    yield from _long(view, "the range of θ in each part of the recording")
    if view.joint_angles is not None:
        reach = NORMAL_95 * view.joint_angles.angle_sd
        if np.isfinite(reach).any():
            yield f"95 % intervals: ±{_angle(view, float(np.nanmedian(reach)))} (median)."
    yield from _shading(view)


def _axis_path(view: TrialView) -> Iterator[str]:
    yield (
        f"The joint's axis against its angle, in the {view.settings.express_in} frame: (a) tilt and (b) shift from "
        "the mean "
        "axis in two directions across it; bands: 95 % of each."
    )


def _paper(what: str, modeled: bool) -> Callable[[TrialView], Iterator[str]]:
    def told(view: TrialView) -> Iterator[str]:
        yield f"{what} over time, {'modeled by ' + _named_model(view) if modeled else 'measured'}"
        yield (
            "(as figures 7 to 10 of Pennestrì and Valentini 2010; one scale with the "
            f"{'measured' if modeled else 'modeled'})."
        )
        yield from _long(view, "the range of θ in each part of the recording")

    return told


_PARTS: Final = "Black: median, and grey: range of each part of the recording."
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


def _model(view: TrialView) -> str:
    return f"Black: measured; blue, dashed: {_named_model(view)} (circles)."


def _named_model(view: TrialView) -> str:
    method = METHOD_LABELS.get(view.settings.model_method, view.settings.model_method)
    return f"{method} through {len(view.summary['interpolation']['keyframes'])} poses"


def _long(view: TrialView, overview: str) -> Iterator[str]:
    stretch: Stretch | None = stretch_of(view)
    if stretch is not None:
        yield f"(a) Overview: {overview}; the others show the stretch marked there, {stretch.told}."


def _interval(view: TrialView, name: str, values: Float, sd: Float, *, is_angle: bool) -> str:
    reach = NORMAL_95 * sd
    if not np.isfinite(reach).any():
        return f"The uncertainty of {name} is not known."
    middle = float(np.nanmedian(reach))
    told = _angle(view, middle) if is_angle else _length(view, middle)
    how = "orange band" if is_seen(values, reach) else "too narrow to be drawn"
    return f"95 % interval of {name} by the noise of the poses: ±{told} (median; {how})."


def _angle(view: TrialView, value: float) -> str:
    return f"{float(angle_in(np.array(value), view.settings.angle_unit)):.2g} {view.settings.angle_unit}"


def _length(view: TrialView, value: float) -> str:
    return f"{float(length_in(np.array(value), view.settings.length_unit)):.2g} {view.settings.length_unit}"


def _shading(view: TrialView, *, moving: bool = False) -> Iterator[str]:
    lost, filled = int((~view.valid & ~view.filled).sum()), int(view.filled.sum())
    parts = ["light blue: moving"] if moving and view.phases.onset_rows.size else []
    parts += [f"light red: not tracked ({_frames(lost)})"] if lost else []
    parts += [f"hatched: filled in ({_frames(filled)})"] if filled else []
    if parts:
        yield f"Shaded {', '.join(parts)}."


def _frames(count: int) -> str:
    return f"{count} frame{'' if count == 1 else 's'}"


def _filter(view: TrialView) -> Iterator[str]:
    cutoff = view.summary["trial"]["instantaneous_lowpass_hz"]
    if cutoff is not None:
        yield f"From poses low-pass filtered at {cutoff:.3g} Hz; none below {view.settings.min_rate_rad_s:g} rad/s."


def _trial(view: TrialView) -> Iterator[str]:
    name = " ".join(str(view.summary["source"]["name"] or "").split())
    yield f"{name + ', ' if name else ''}{view.frame.size} frames at {view.rate_hz:.6g} Hz."
