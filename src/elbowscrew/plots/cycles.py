"""The cycles of a trial over their own time, with mean and standard deviation."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.model import Analysis
from elbowscrew.plots import style
from elbowscrew.plots.figures import NARROW_MM, WIDTH_MM
from elbowscrew.quantities import angle_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.bands import is_seen
from elbowscrew.view.cycle_curves import cycle_curves
from elbowscrew.view.long_trials import MOST_CYCLES
from elbowscrew.view.trial_view import TrialView


def cycles_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of all cycles over 0 to 100 % of their time."""
    figure = style.new_figure(width_mm, 62.0 if width_mm < NARROW_MM else 76.0)
    ax = plot_cycles(figure.add_subplot(), analysis)
    style.legend(figure, ax)
    return figure


def plot_cycles(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw each cycle, and the mean of all with one standard deviation to either side; of many the range alone.

    Cycles that the mean would hide are not drawn. As in ``repetition_curve.csv``, mean and deviation are over the
    cycles whose angle is known there.
    """
    view = view_of(analysis)
    unit, found = view.settings.angle_unit, cycle_curves(view)
    percent, curves = found.percent, angle_in(found.curves, unit)
    count = len(curves)
    name = f"{count} cycle{'s' if count > 1 else ''}"
    mean = view.repetition_curve
    shown = mean is None or found.is_seen
    if shown and count > MOST_CYCLES:
        known = np.isfinite(curves).any(axis=0)
        low, high = (angle_in(one, unit) for one in found.span())
        ax.fill_between(percent[known], low[known], high[known], label=f"range of {name}", **_RANGE)
    elif shown:
        look = style.MEASURED if count == 1 else {"color": "#8C8C8C", "linewidth": 0.5, "zorder": 2}
        for k, curve in enumerate(curves):
            ax.plot(percent, curve, label=name if k == 0 else None, **look)
    if mean is not None:
        middle, sd = angle_in(mean["theta_mean"], unit), angle_in(mean["theta_sd"], unit)
        if is_seen(middle, sd):
            ax.fill_between(percent, middle - sd, middle + sd, label="± standard deviation", **style.SPREAD)
        label = "mean" if shown else f"mean of {name}"
        ax.plot(percent, middle, label=label, zorder=3, **{**style.MEASURED, "linewidth": 1.6})
    ax.set_xlim(0.0, 100.0)
    ax.set_xlabel("Time of the cycle (%)")
    ax.set_ylabel(f"Angle θ ({unit})")
    return ax


_RANGE: Final = {**style.SPREAD, "facecolor": "#EBEBEB", "zorder": 0.5}
