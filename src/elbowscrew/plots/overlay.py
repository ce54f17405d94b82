"""Several trials in one picture: the angle over the time of the movement, normalized, with mean and deviation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.choices import AngleUnit
from elbowscrew.geometry.arrays import Float
from elbowscrew.plots import style
from elbowscrew.plots.figures import WIDTH_MM
from elbowscrew.quantities import angle_in
from elbowscrew.view.trial_view import TrialView

PERCENT: Final[Float] = np.linspace(0.0, 100.0, 101)
LEAST_TRIALS: Final = 2


class MeanCurve(NamedTuple):
    """Mean angle of one trial over its flexion-extension cycles, radians, shape (101,); and how many they are."""

    angle: Float
    cycles: int


def mean_curve(view: TrialView) -> MeanCurve | None:
    """Take the mean of a trial's angle over its cycles, the time of each normalized from its start to its end.

    Parameters
    ----------
    view : TrialView

    Returns
    -------
    MeanCurve or None
        None if the trial has no cycle; NaN where no cycle's angle is known.
    """
    time_s, found = view.time_s, view.repetitions
    curves = []
    for start, end in zip(found.start_time_s, found.end_time_s, strict=True):
        inside = (time_s >= start) & (time_s <= end)
        if inside.sum() < 2 or not end > start:
            continue
        share = 100.0 * (time_s[inside] - start) / (end - start)
        # A NaN on either side makes what lies between unknown.
        curves.append(np.interp(PERCENT, share, view.angle[inside]))
    if not curves:
        return None
    stack = np.stack(curves)
    known = np.isfinite(stack)
    count = known.sum(axis=0)
    total = np.where(known, stack, 0.0).sum(axis=0)
    mean = np.divide(total, count, out=np.full(PERCENT.size, np.nan), where=count > 0)
    return MeanCurve(mean, len(curves))


def plot_overlay(ax: Axes, curves: Sequence[MeanCurve], unit: AngleUnit = "deg") -> Axes:
    """Draw the curves of trials, their mean, and one standard deviation between trials on either side."""
    stack = angle_in(np.stack([curve.angle for curve in curves]), unit)
    for k, curve in enumerate(stack):
        label = f"{len(stack)} trials" if k == 0 else None
        ax.plot(PERCENT, curve, color="#8C8C8C", linewidth=0.5, zorder=2, label=label)
    whole = np.isfinite(stack).all(axis=0)  # a mean of some trials only would jump where the others leave off
    mean = np.where(whole, stack.mean(axis=0), np.nan)
    sd = np.where(whole, stack.std(axis=0, ddof=1), np.nan)
    ax.fill_between(
        PERCENT,
        mean - sd,
        mean + sd,
        label="± standard deviation",
        **style.SPREAD,
    )
    ax.plot(PERCENT, mean, color=style.BLACK, linewidth=1.6, label="mean", zorder=3)
    ax.set_xlim(0.0, 100.0)
    ax.set_xlabel("Time of the movement (%)")
    ax.set_ylabel(f"Angle θ ({unit})")
    return ax


def overlay_figure(curves: Sequence[MeanCurve], *, width_mm: float = WIDTH_MM, unit: AngleUnit = "deg") -> Figure:
    """Make the figure of several trials over the normalized time of the movement."""
    figure = style.new_figure(width_mm, 0.32 * width_mm + 26.0)
    ax = plot_overlay(figure.add_subplot(), curves, unit)
    style.legend(figure, ax)
    return figure
