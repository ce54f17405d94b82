"""The paper's figures 7 to 10 one by one: angle and Euler parameters, measured and modeled."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Analysis
from elbowscrew.plots import series, style
from elbowscrew.plots.figures import WIDTH_MM, MakeFigure
from elbowscrew.quantities import angle_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.long_trials import shown_part
from elbowscrew.view.trial_view import TrialView

_DASHES: Final[tuple[Any, ...]] = ("-", (0, (5, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2)))
"""Of e0 to e3."""


def _over_time(
    draw: Callable[..., Axes], analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM, modeled: bool
) -> Figure:
    whole = view_of(analysis)
    view, stretch = shown_part(whole)
    figure = style.new_figure(width_mm, 0.32 * width_mm + 26.0)
    panels = series.overview_grid(figure, whole, stretch, 1)
    draw(panels[-1], view, modeled=modeled)
    style.letter(*panels)
    style.legend(figure, *panels)
    return figure


def plot_one_angle(ax: Axes, analysis: Analysis | TrialView, *, modeled: bool) -> Axes:
    """Draw the measured angle over time, or the modeled one."""
    view = view_of(analysis)
    unit, time_s = view.settings.angle_unit, view.time_s
    angle = angle_in(view.modeled_angle if modeled else view.angle, unit)
    look = style.MODELED if modeled else style.MEASURED
    series.line(ax, time_s, angle, label="modeled" if modeled else "measured", **look)
    series.mark_keyframes(ax, view, angle_in(view.angle, unit))
    if not modeled:
        series.mark_tracking(ax, view)
    ax.set_ylabel(f"Angle θ ({unit})")
    _alike(ax, angle_in(view.angle, unit), angle_in(view.modeled_angle, unit))
    return series.over_time(ax, time_s)


def plot_all_euler_parameters(ax: Axes, analysis: Analysis | TrialView, *, modeled: bool) -> Axes:
    """Draw e0 to e3 over time, those measured or those modeled."""
    view = view_of(analysis)
    time_s = view.time_s
    shown = view.modeled_euler_parameters if modeled else view.euler_parameters
    look = style.MODELED if modeled else style.MEASURED
    for component, dashes in enumerate(_DASHES):
        values = shown[:, component]
        series.line(ax, time_s, values, label=f"$e_{component}$", **{**look, "linestyle": dashes})
    if not modeled:
        series.mark_tracking(ax, view)
    ax.set_ylabel("Modeled $e_k$ (–)" if modeled else "Measured $e_k$ (–)")
    _alike(ax, view.euler_parameters, view.modeled_euler_parameters)
    return series.over_time(ax, time_s)


def _alike(ax: Axes, *both: Float) -> None:
    """Give figures of the measured and of the modeled motion one scale, so that they can be compared."""
    low, high = min(float(np.nanmin(part)) for part in both), max(float(np.nanmax(part)) for part in both)
    air = 0.05 * (high - low) or 0.05
    ax.set_ylim(low - air, high + air)


figure_7: Final[MakeFigure] = partial(_over_time, plot_one_angle, modeled=False)
figure_8: Final[MakeFigure] = partial(_over_time, plot_one_angle, modeled=True)
figure_9: Final[MakeFigure] = partial(_over_time, plot_all_euler_parameters, modeled=False)
figure_10: Final[MakeFigure] = partial(_over_time, plot_all_euler_parameters, modeled=True)
"""Counterparts of the figures of Pennestrì and Valentini 2010, of any trial."""
