"""Sentences that captions of several figures share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.quantities import angle_in, length_in, rounded
from elbowscrew.view.bands import is_seen, span_of
from elbowscrew.view.joint_space import ANGLE_NAMES
from elbowscrew.view.long_trials import Stretch
from elbowscrew.view.trial_view import TrialView, model_label
from elbowscrew.view.wander import off_mean

KEYFRAMES: Final = "Circles: the poses that the model passes through."
PARTS: Final = "Black: median, and grey: range of each part of the recording."


def letters_of_panels(stretch: Stretch | None, panels: int) -> list[str]:
    """What stands before the names of a figure's panels, as in ``(b) ``; of one panel alone nothing.

    Parameters
    ----------
    stretch : Stretch or None
        Of a figure with an overview, which is (a).
    panels : int
        Beside the overview.
    """
    above = int(stretch is not None)
    return [f"({letter}) " for letter in "abcdefgh"[above : above + panels]] if above + panels > 1 else [""]


def overview(stretch: Stretch | None) -> Iterator[str]:
    """Tell of the panel above those of a long trial's stretch."""
    if stretch is not None:
        yield (
            "(a) Overview: the range of θ in each part of the recording; the others show the stretch marked there, "
            f"{stretch.told}."
        )


def measured_and_model(view: TrialView) -> str:
    """Tell the two curves apart."""
    return f"Black: measured; blue, dashed: {model_label(view)} (circles)."


def interval(view: TrialView, name: str, values: Float, sd: Float, *, is_angle: bool) -> str:
    """Tell the 95 % interval of a curve (N,), and whether it is drawn."""
    reach = NORMAL_95 * sd
    if not np.isfinite(reach).any():
        return f"The uncertainty of {name} is not known."
    middle = float(np.nanmedian(reach))
    told = angle(view, middle) if is_angle else length(view, middle)
    return f"95 % interval of {name} by the noise of the poses: ±{told} (median; {_how(values, reach)})."


def intervals_of_angles(view: TrialView) -> Iterator[str]:
    """Tell the 95 % interval of each of the joint's own angles, and whether it is drawn."""
    angles = view.joint_angles
    if angles is None:
        return
    if not np.isfinite(angles.angle_sd).any():
        yield "The uncertainty of the angles is not known."
        return
    span = span_of(angles.angle)
    told = []
    for name, values, sd in zip(ANGLE_NAMES[angles.angle.shape[1]], angles.angle.T, angles.angle_sd.T, strict=True):
        reach = NORMAL_95 * sd
        if np.isfinite(reach).any():
            told.append(f"{name} ±{angle(view, float(np.nanmedian(reach)))} ({_how(values, reach, span)})")
        else:
            told.append(f"{name} not known")
    yield f"95 % intervals (median): {', '.join(told)}."


def intervals_of_path(view: TrialView) -> Iterator[str]:
    """Tell what 95 % keeps within of an axis that wanders, and whether it is drawn."""
    if view.axis_path is None:
        return
    found = off_mean(view, view.axis_path)
    told = []
    for what, parts, reach, write in (
        ("tilt", found.tilt, found.tilt_reach, angle),
        ("shift", found.shift, found.shift_reach, length),
    ):
        if np.isfinite(reach).any():
            drawn = _how(parts[0], reach, span_of(parts))
            told.append(f"{what} ±{write(view, float(np.nanmedian(reach)))} ({drawn})")
        else:
            told.append(f"{what} not known")
    yield f"95 % of each (median): {', '.join(told)}."


def _how(values: Float, reach: Float, span: float | None = None) -> str:
    return "orange band" if is_seen(values, reach, span) else "too narrow to be drawn"


def angle(view: TrialView, value: float) -> str:
    """Write an angle (rad) in the trial's unit."""
    return f"{rounded(float(angle_in(np.array(value), view.settings.angle_unit)), 2)} {view.settings.angle_unit}"


def length(view: TrialView, value: float) -> str:
    """Write a length (m) in the trial's unit."""
    return f"{rounded(float(length_in(np.array(value), view.settings.length_unit)), 2)} {view.settings.length_unit}"


def shading(view: TrialView, *, moving: bool = False) -> Iterator[str]:
    """Tell what is shaded of the part that is drawn."""
    lost, filled = int((~view.valid & ~view.filled).sum()), int(view.filled.sum())
    parts = ["light blue: moving"] if moving and view.phases.onset_rows.size else []
    parts += [f"light red: not tracked ({_frames(lost)})"] if lost else []
    parts += [f"hatched: filled in ({_frames(filled)})"] if filled else []
    if parts:
        yield f"Shaded {', '.join(parts)}."


def _frames(count: int) -> str:
    return f"{count} frame{'' if count == 1 else 's'}"


def frame_name(view: TrialView) -> str:
    """Name the frame that screws are expressed in by the joint's own segments."""
    words = view.named_joint
    return {
        "distal": f"{words.distal.name}'s frame at the reference",
        "proximal": f"{words.proximal.name}'s frame",
        "lab": f"laboratory frame, {words.proximal.name} as at the reference",
    }[view.settings.express_in]


def filtered(view: TrialView) -> str:
    """Tell the filter of the velocities, if any."""
    cutoff = view.summary["trial"]["instantaneous_lowpass_hz"]
    return "" if cutoff is None else f"From poses low-pass filtered at {rounded(cutoff, 3)} Hz."


def trial(view: TrialView) -> Iterator[str]:
    """Name the recording."""
    name = " ".join(str(view.summary["source"]["name"] or "").split())
    yield f"{name + ', ' if name else ''}{view.frame.size} frames at {view.rate_hz:.6g} Hz."
