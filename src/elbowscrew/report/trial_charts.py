"""The charts of a trial's page, in degrees and millimeters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from elbowscrew.choices import METHOD_LABELS
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.motion.movements.phases import runs_of
from elbowscrew.quantities import rounded
from elbowscrew.report.charts import (
    COLORS,
    WIDTH,
    Chart,
    color_of,
    keys_of,
    picture,
    range_of,
    tick_text,
    ticks_between,
)
from elbowscrew.report.scene import WIDEST
from elbowscrew.view.bands import is_seen
from elbowscrew.view.long_trials import Stretch, envelope, shown_part, stretch_of
from elbowscrew.view.scene import directions_across, joint_bundle
from elbowscrew.view.trial_view import TrialView

_TALL: Final = 340.0
_ABOVE, _LOWER = 165.0, 300.0  # of a long trial
_PARTS: Final = "range of each part of the recording"
_ASPECT: Final = (0.5 * WIDTH - 78.0) / (0.42 * WIDTH - 56.0)  # of the inner part of a panel of the axes


def theta_chart(trial: TrialView) -> Markup:
    """Measured and modeled angle over time, with keyframes, movements and what was lost or filled in.

    Of a long trial what the angle spans all through, and below it the stretch that stands for the others.
    """
    shown, stretch = shown_part(trial)
    height = _TALL if stretch is None else _LOWER
    angle = np.degrees(shown.angle)
    motion = trial.summary["motion"]
    chart = over_time(
        shown, "theta", "", "", range_of(angle, np.degrees(shown.modeled_angle)), "Angle θ (deg)", height=height
    )
    time_s, phases = shown.time_s, shown.phases
    chart.spans(zip(time_s[phases.onset_rows], time_s[phases.offset_rows], strict=True), "fill-moving", "moving")
    mark_tracking(chart, shown)
    _mark_interval(chart, shown)
    chart.line(time_s, angle, "measured", "measured")
    chart.line(time_s, np.degrees(shown.modeled_angle), "modeled", model_name(trial))
    rows = shown.keyframes.row
    chart.points(time_s[rows], angle[rows], "keyframe", "keyframes")
    text = (
        f"Measured and modeled rotation angle over {trial.time_s[-1] - trial.time_s[0]:.2f} seconds; it is largest, "
        f"{motion['theta_max_deg']:.1f} degrees, at frame {motion['theta_max_frame']}."
    )
    if stretch is None:
        return chart.keys() + picture("theta", "Angle over time", text, WIDTH, height, [chart.panel()])
    above = _overview(trial, stretch)
    text += f" Above, what it spans all through; below, of {stretch.told}, measured and modeled."
    panels = [above.panel(), chart.panel(0.0, _ABOVE)]
    return above.keys() + chart.keys() + picture("theta", "Angle over time", text, WIDTH, height + _ABOVE, panels)


def _overview(trial: TrialView, stretch: Stretch) -> Chart:
    """What the angle spans all through a long trial, and where the stretch is that is drawn in full."""
    angle, rows = np.degrees(trial.angle), slice(stretch.first, stretch.end)
    chart = over_time(trial, "overview", "", "", range_of(angle), "θ (deg)", height=_ABOVE - 5.0)
    found = envelope(trial, angle)
    chart.band(found.time_s, found.low, found.high, "band-spread", _PARTS)
    first, last = trial.time_s[[stretch.first, stretch.end - 1]].tolist()
    chart.spans([(first, last)], "fill-stretch", "drawn in full below")
    chart.line(trial.time_s[rows], angle[rows], "thin-measured", name="measured")
    return chart


def _span(chart: Chart, trial: TrialView, values: Float) -> None:
    """Draw the range and the median of each part of a long trial."""
    found = envelope(trial, values)
    chart.band(found.time_s, found.low, found.high, "band-spread", _PARTS)
    chart.line(found.time_s, found.middle, "measured", "median of each part")


def error_chart(trial: TrialView) -> Markup:
    """Angle error and RMS displacement of the model over time, one above the other; of a long trial their ranges."""
    panels: list[str] = []
    keys = Markup()
    is_long = stretch_of(trial) is not None
    errors = [(np.degrees(trial.angle_error), "Angle error", "deg")]
    if trial.located:
        errors.append((1000.0 * trial.rms_displacement, "RMS displacement", "mm"))
    for k, (values, label, unit) in enumerate(errors):
        chart = over_time(trial, f"error{k}", "", "", range_of(values, zero=True), f"{label} ({unit})", height=230.0)
        if is_long:
            _span(chart, trial, values)
        else:
            mark_tracking(chart, trial)
            chart.line(trial.time_s, values, "measured", "model against measurement")
        if np.isfinite(values).any():
            level = float(np.sqrt(np.nanmean(values**2)))
            chart.segment((trial.time_s[0], trial.time_s[-1]), (level, level), "level", label="RMS")
        panels.append(chart.panel(0.0, 235.0 * k))
        keys = chart.keys()
    whose = f"the {trial.named_joint.distal.name}'s points"
    displacement = f", and RMS displacement of {whose}" if trial.located else ""
    text = f"Angle between modeled and measured orientation{displacement}, over time."
    return keys + picture("error", "Error of the model over time", text, WIDTH, 235.0 * len(panels) - 5.0, panels)


def euler_chart(trial: TrialView) -> Markup:
    """Measured and modeled e0..e3 over time, four panels; of a long trial in its stretch."""
    shown, stretch = shown_part(trial)
    measured, modeled = shown.euler_parameters, shown.modeled_euler_parameters
    panels = []
    keys = Markup()
    for k in range(4):
        chart = over_time(
            shown,
            f"euler{k}",
            "",
            "",
            range_of(measured[:, k], modeled[:, k]),
            f"e{'₀₁₂₃'[k]} (–)",
            width=0.5 * WIDTH,
            height=230.0,
        )
        mark_tracking(chart, shown)
        chart.line(shown.time_s, measured[:, k], "measured", "measured")
        chart.line(shown.time_s, modeled[:, k], "modeled", "modeled")
        rows = shown.keyframes.row
        chart.points(shown.time_s[rows], measured[rows, k], "keyframe", "keyframes", radius=3.0)
        panels.append(chart.panel(0.5 * WIDTH * (k % 2), 235.0 * (k // 2)))
        keys = chart.keys()
    text = f"e0 to e3, measured and modeled, over time{'' if stretch is None else f', of {stretch.told}'}."
    return keys + picture("euler", "Euler parameters over time", text, WIDTH, 465.0, panels)


def axis_chart(trial: TrialView) -> Markup:
    """Axes of the frames and the joint's axis with what holds 95 %, end-on and from the side."""
    bundle = joint_bundle(trial).scaled(1000.0)
    across, names = directions_across(bundle.direction)
    offset = bundle.segments - bundle.center
    widest = 1.25 * bundle.reach_across(WIDEST)
    angle = np.degrees(trial.angle[bundle.rows])
    colors = [color_of(float(share)) for share in (angle - angle.min()) / (float(np.ptp(angle)) or 1.0)]
    told = [f"Frame {trial.frame[row]}, θ {value:.1f} deg" for row, value in zip(bundle.rows, angle, strict=True)]
    size = (0.5 * WIDTH, 0.42 * WIDTH)
    end_on = Chart(
        "endon",
        "",
        "",
        x_range=(-_ASPECT * widest, _ASPECT * widest),
        y_range=(-widest, widest),
        x_label=f"Across, toward {names[0]} (mm)",
        y_label=f"Across, toward {names[1]} (mm)",
        size=size,
    )
    turn = np.linspace(0.0, 2.0 * np.pi, 73)
    for name, region in bundle.regions.items():
        end_on.band(
            region.radius * np.cos(turn[:37]),
            -region.radius * np.sin(turn[:37]),
            region.radius * np.sin(turn[:37]),
            f"band-{name}",
        )
    for piece, color, note in zip(
        np.stack([offset @ direction for direction in across], axis=2), colors, told, strict=True
    ):
        end_on.segment(piece[:, 0].tolist(), piece[:, 1].tolist(), "thread", color, told=note)
    end_on.points(np.zeros(1), np.zeros(1), "center", radius=3.0)
    side = Chart(
        "side",
        "",
        "",
        x_range=(-bundle.half, bundle.half),
        y_range=(-widest, widest),
        x_label=f"Along the {bundle.name} (mm)",
        y_label=f"Across, toward {names[1]} (mm)",
        size=size,
    )
    along = np.linspace(-bundle.half, bundle.half, 41)
    for name, region in bundle.regions.items():
        side.band(along, -region.reach(along), region.reach(along), f"band-{name}")
    for piece, color, note in zip(
        np.stack([offset @ bundle.direction, offset @ across[1]], axis=2), colors, told, strict=True
    ):
        side.segment(piece[:, 0].tolist(), piece[:, 1].tolist(), "thread", color, told=note)
    side.segment((-bundle.half, bundle.half), (0.0, 0.0), "joint")
    text = (
        f"The {bundle.name} and the axes of {bundle.rows.size} frames about it, seen along it and from the side; "
        "what lies across it is enlarged."
    )
    words = {"spread": "95 % of the frames’ axes", "confidence": "95 % confidence of the joint axis"}
    keys = [*((f"band-{name}", words[name]) for name in bundle.regions), ("joint", bundle.name)]
    panels = [
        end_on.panel(),
        side.panel(0.5 * WIDTH),
        *_color_bar(float(angle.min()), float(angle.max()), size[1] + 8.0),
    ]
    drawn = picture("axes", "Axes of the frames about the joint's axis", text, WIDTH, size[1] + 58.0, panels)
    return keys_of(keys) + drawn


def repetition_chart(curve: Mapping[str, NDArray[Any]], count: int) -> Markup:
    """Mean angle over the cycle's time with its standard deviation."""
    mean, sd = np.degrees(curve["theta_mean"]), np.degrees(curve["theta_sd"])
    chart = Chart(
        "curve",
        "Angle over the repetitions",
        f"Mean and standard deviation of the angle over {count} repetitions, time normalized to the cycle.",
        x_range=(0.0, 100.0),
        y_range=range_of(mean - sd, mean + sd),
        x_label="Time of the cycle (%)",
        y_label="Angle θ (deg)",
        size=(WIDTH, 250.0),
    )
    if is_seen(mean, sd):
        chart.band(curve["percent"], mean - sd, mean + sd, "band-known", "± standard deviation")
    else:
        most = f"{rounded(float(np.nanmax(sd)))} deg" if np.isfinite(sd).any() else "not known"
        chart.remark(f"standard deviation: {most} at most, too narrow to be drawn")
    chart.line(curve["percent"], mean, "measured", f"mean of {count} repetitions")
    return chart.svg()


def model_name(trial: TrialView) -> str:
    """Name the model in a few words."""
    name = trial.settings.model_method
    return f"{METHOD_LABELS.get(name, name)} through {trial.keyframes.row.size} poses"


def over_time(
    trial: TrialView,
    name: str,
    title: str,
    text: str,
    y_range: tuple[float, float],
    label: str,
    *,
    width: float = WIDTH,
    height: float = _TALL,
) -> Chart:
    """Begin a chart over the time of the recording."""
    time_s = trial.time_s
    return Chart(
        name,
        title,
        text,
        x_range=range_of(time_s, air=0.01),
        y_range=y_range,
        x_label="Time (s)",
        y_label=label,
        size=(width, height),
    )


def _mark_interval(chart: Chart, trial: TrialView) -> None:
    reach = NORMAL_95 * np.degrees(trial.angle_sd)
    chart.reach(trial.time_s, np.degrees(trial.angle), reach, "band-known", "95 % interval", "deg")


def mark_tracking(chart: Chart, trial: TrialView) -> None:
    """Shade what was lost or filled in."""
    half = 0.5 / trial.rate_hz
    for mask, look, label in (
        (~trial.valid & ~trial.filled, "fill-lost", "not tracked"),
        (trial.filled, "fill-filled", "filled in"),
    ):
        spans = [(trial.time_s[a] - half, trial.time_s[b] + half) for a, b in zip(*runs_of(mask), strict=True)]
        chart.spans(spans, look, label)


def _color_bar(low: float, high: float, top: float) -> list[str]:
    """Draw the scale of the angle below both panels."""
    left, width = 62.0, WIDTH - 78.0
    pieces = 4 * len(COLORS)
    piece = width / pieces
    parts = [
        f'<rect class="scale" x="{left + k * piece:.1f}" y="{top:g}" width="{piece + 0.4:.1f}" height="9" '
        f'fill="{color_of(k / (pieces - 1))}"/>'
        for k in range(pieces)
    ]
    values, decimals = ticks_between(low, high, 8)
    for value in values:
        place = left + width * (value - low) / ((high - low) or 1.0)
        parts.append(f'<text x="{place:.1f}" y="{top + 25:g}" text-anchor="middle">{tick_text(value, decimals)}</text>')
    parts.append(
        f'<text x="{left + 0.5 * width:g}" y="{top + 45:g}" text-anchor="middle">Angle θ of the frame (deg)</text>'
    )
    return parts
