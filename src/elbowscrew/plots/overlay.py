"""Several trials in one picture: the angle over the time of the movement, normalized, of trials or of subjects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.choices import AngleUnit
from elbowscrew.geometry.arrays import Float
from elbowscrew.group.curves import PERCENT, GroupCurve, curve_of_cycles
from elbowscrew.plots import style
from elbowscrew.plots.figures import WIDTH_MM
from elbowscrew.quantities import angle_in
from elbowscrew.view.trial_view import TrialView

LEAST_TRIALS: Final = 2
MOST_GROUPS: Final = len(style.GROUPS)
"""Conditions that are told apart in one panel."""
_WIDE_PANEL_MM: Final = 70.0
_THIN: Final[dict[str, Any]] = {"linewidth": 0.5, "zorder": 2}


class MeanCurve(NamedTuple):
    """Mean angle of one trial over its flexion-extension cycles, radians, shape (101,); and how many they are."""

    angle: Float
    cycles: int


def mean_curve(view: TrialView) -> MeanCurve | None:
    """Take the mean of a trial's angle over its cycles, the time of each normalized from its start to its end.

    Parameters
    ----------
    view : TrialView
        With the table of its cycles.

    Returns
    -------
    MeanCurve or None
        None if no cycle is complete and known throughout.
    """
    if "cycles" not in view.extra:
        return None
    cycles = view.extra["cycles"]["angle"].reshape(-1, PERCENT.size)
    angle, count = curve_of_cycles(cycles, view.repetitions.incomplete)
    return None if angle is None else MeanCurve(angle, count)


def plot_overlay(ax: Axes, curves: Sequence[MeanCurve], unit: AngleUnit = "deg") -> Axes:
    """Draw the curves of trials, their mean, and one standard deviation between trials on either side."""
    stack = angle_in(np.stack([curve.angle for curve in curves]), unit)
    _thin_lines(ax, stack, f"{len(stack)} trials", "#8C8C8C")
    mean, sd = stack.mean(axis=0), stack.std(axis=0, ddof=1)
    ax.fill_between(PERCENT, mean - sd, mean + sd, label="± standard deviation", **style.SPREAD)
    ax.plot(PERCENT, mean, color=style.BLACK, linewidth=1.6, label="mean", zorder=3)
    return _named_axes(ax, unit)


def plot_conditions(ax: Axes, curves: Mapping[str, GroupCurve], unit: AngleUnit = "deg") -> Axes:
    """Draw the mean of each condition with its 95 % band; the subjects of those that have none."""
    for look, (name, curve) in zip(style.GROUPS, curves.items(), strict=False):
        if curve.low is None or curve.high is None:
            _thin_lines(ax, angle_in(curve.of_subjects, unit), "", look["color"])
        else:
            low, high = angle_in(curve.low, unit), angle_in(curve.high, unit)
            ax.fill_between(PERCENT, low, high, facecolor=style.tint(look["color"]), linewidth=0.0, zorder=1)
            for edge in (low, high):  # above the bands of the others
                ax.plot(PERCENT, edge, color=look["color"], linewidth=0.4, zorder=1.5)
        ax.plot(PERCENT, angle_in(curve.mean, unit), linewidth=1.5, label=name, zorder=3, **look)
    return _named_axes(ax, unit)


def plot_subjects(ax: Axes, curve: GroupCurve, unit: AngleUnit = "deg") -> Axes:
    """Draw each subject of one condition, and their mean with its band."""
    if curve.low is not None and curve.high is not None:
        low, high = angle_in(curve.low, unit), angle_in(curve.high, unit)
        ax.fill_between(PERCENT, low, high, label="95 % of the mean", **style.BAND)
    _thin_lines(ax, angle_in(curve.of_subjects, unit), "subjects", "#666666")
    ax.plot(PERCENT, angle_in(curve.mean, unit), color=style.BLACK, linewidth=1.6, label="mean", zorder=3)
    return _named_axes(ax, unit)


def overlay_figure(curves: Sequence[MeanCurve], *, width_mm: float = WIDTH_MM, unit: AngleUnit = "deg") -> Figure:
    """Make the figure of several trials over the normalized time of the movement."""
    figure = style.new_figure(width_mm, 0.32 * width_mm + 26.0)
    ax = plot_overlay(figure.add_subplot(), curves, unit)
    style.legend(figure, ax)
    return figure


def conditions_figure(
    curves: Mapping[str, GroupCurve], *, width_mm: float = WIDTH_MM, unit: AngleUnit = "deg"
) -> Figure:
    """Make the figure of the conditions' means."""
    figure = style.new_figure(width_mm, 0.32 * width_mm + 26.0)
    ax = plot_conditions(figure.add_subplot(), curves, unit)
    style.legend(figure, ax)
    return figure


def subjects_figure(curves: Mapping[str, GroupCurve], *, width_mm: float = WIDTH_MM, unit: AngleUnit = "deg") -> Figure:
    """Make the figure of the subjects, a panel for each condition, all to one scale."""
    columns = min(max(int(width_mm // _WIDE_PANEL_MM), 1), len(curves))
    rows = -(-len(curves) // columns)
    figure = style.new_figure(width_mm, rows * (0.32 * width_mm / columns + 26.0))
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    for ax, (name, curve) in zip(panels, curves.items(), strict=False):
        plot_subjects(ax, curve, unit)
        ax.set_title(name)
    for ax in panels[len(curves) :]:
        ax.remove()
    style.legend(figure, *panels[: len(curves)])
    return figure


def _thin_lines(ax: Axes, stack: Float, label: str, color: str) -> None:
    for k, curve in enumerate(stack):
        ax.plot(PERCENT, curve, color=color, label=label if label and k == 0 else None, **_THIN)


def _named_axes(ax: Axes, unit: AngleUnit) -> Axes:
    ax.set_xlim(0.0, 100.0)
    ax.set_xlabel("Time of the movement (%)")
    ax.set_ylabel(f"Angle θ ({unit})")
    return ax
