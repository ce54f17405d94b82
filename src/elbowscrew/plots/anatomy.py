"""The bones' angles: over time, and against flexion."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Analysis
from elbowscrew.plots import style
from elbowscrew.plots.figures import NARROW_MM, WIDTH_MM
from elbowscrew.plots.series import line, mark_tracking, over_time, overview_grid
from elbowscrew.quantities import angle_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.decimation import drawn_rows
from elbowscrew.view.long_trials import shown_part
from elbowscrew.view.trial_view import TrialView


def anatomy_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the bones' three angles over time, and of the latter two against flexion."""
    view = view_of(analysis)
    shown, stretch = shown_part(view)
    if width_mm < NARROW_MM:
        figure = style.new_figure(width_mm, 200.0)
        grid = figure.add_gridspec(2, 1, height_ratios=[3.0, 2.4])
    else:
        figure = style.new_figure(width_mm, 110.0)
        grid = figure.add_gridspec(1, 2, width_ratios=[1.5, 1.0])
    panels = overview_grid(figure, view, stretch, 3, grid[0])
    cells = grid[1].subgridspec(2, 1)
    against = [figure.add_subplot(cells[k, 0]) for k in range(2)]
    names = view.named_joint.angle_keys
    for ax, name in zip(panels[-3:], names, strict=True):
        plot_anatomical_angle(ax, shown, name).set_xlabel("")
    panels[-1].set_xlabel("Time (s)")
    for ax, name in zip(against, names[1:], strict=True):
        plot_against_flexion(ax, shown, name)
    style.letter(*panels, *against)
    style.legend(figure, *panels, *against)
    return figure


def plot_anatomical_angle(ax: Axes, analysis: Analysis | TrialView, name: str) -> Axes:
    """Draw an angle of the joint, one of its `angle_keys`, over time."""
    view = view_of(analysis)
    line(ax, view.time_s, _values(view, name), label="measured", **style.MEASURED)
    mark_tracking(ax, view)
    ax.set_ylabel(_label(view, name))
    return over_time(ax, view.time_s)


def plot_against_flexion(ax: Axes, analysis: Analysis | TrialView, name: str) -> Axes:
    """Draw another angle of the joint against flexion."""
    view = view_of(analysis)
    flexion, values = _values(view, "flexion"), _values(view, name)
    rows = drawn_rows(flexion, values, keep_gaps=True)
    ax.plot(flexion[rows], values[rows], label="measured", **{**style.MEASURED, "linewidth": 0.9})
    start = np.flatnonzero(np.isfinite(flexion + values))[:1]
    ax.plot(flexion[start], values[start], label="start", **style.START)
    ax.set_xlabel(_label(view, "flexion"))
    ax.set_ylabel(_label(view, name))
    return ax


def _values(view: TrialView, name: str) -> Float:
    return angle_in(view.extra["anatomy"][name], view.settings.angle_unit)


def _label(view: TrialView, name: str) -> str:
    return f"{name.replace('_', ' ').capitalize()} ({view.settings.angle_unit})"
