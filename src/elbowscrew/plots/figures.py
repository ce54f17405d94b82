"""The figures of a result, each by name."""

from __future__ import annotations

from typing import Final, Protocol, cast

from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from mpl_toolkits.mplot3d.axes3d import Axes3D

from elbowscrew.model import Analysis
from elbowscrew.plots import axis, joint, series, style
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.long_trials import shown_part
from elbowscrew.view.trial_view import TrialView

WIDTH_MM: Final = 170.0
NARROW_MM: Final = 120.0  # below this panels stand one below the other
_LEAST_OF_TWO_MM: Final = 100.0
_LEAST_OF_THREE_MM: Final = 150.0


class MakeFigure(Protocol):
    """A whole figure of a trial at a width on paper."""

    def __call__(self, analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
        """Draw it."""
        ...


def theta_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of measured and modeled angle over time with keyframes."""
    view = view_of(analysis)
    shown, stretch = shown_part(view)
    figure = style.new_figure(width_mm, 62.0 if width_mm < NARROW_MM else 76.0)
    panels = series.overview_grid(figure, view, stretch, 1)
    series.plot_theta(panels[-1], shown)
    style.letter(*panels)
    style.legend(figure, *panels)
    return figure


def euler_parameters_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of measured and modeled e0..e3 over time."""
    view = view_of(analysis)
    shown, stretch = shown_part(view)
    columns = 1 if width_mm < NARROW_MM else 2
    figure = style.new_figure(width_mm, 140.0 if columns == 1 else 100.0)
    panels = series.overview_grid(figure, view, stretch, 4 // columns, columns=columns)
    for component, ax in enumerate(panels[-4:]):
        series.plot_euler_parameter(ax, shown, component)
    for ax in panels[-4:-columns]:
        ax.set_xlabel("")
    if stretch is not None:
        style.letter(*panels)
    style.legend(figure, *panels)
    return figure


def axis_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the axes in space, of their directions and of their positions."""
    view = view_of(analysis)
    if width_mm < _LEAST_OF_TWO_MM:
        figure = style.new_figure(width_mm, 2.65 * width_mm + 10.0)
        grid = figure.add_gridspec(4, 1, height_ratios=[1.1, 0.8, 0.8, 0.05])
        cells = [grid[k, 0] for k in range(4)]
    elif width_mm < _LEAST_OF_THREE_MM:
        figure = style.new_figure(width_mm, 1.3 * width_mm + 10.0)
        grid = figure.add_gridspec(3, 2, height_ratios=[1.3, 1.0, 0.06])
        cells = [grid[0, :], grid[1, 0], grid[1, 1], grid[2, :]]
    else:
        figure = style.new_figure(width_mm, 80.0)
        grid = figure.add_gridspec(2, 3, width_ratios=[1.3, 1.0, 1.0], height_ratios=[1.0, 0.04])
        cells = [grid[:, 0], grid[0, 1], grid[0, 2], grid[1, 1:]]
    space = cast(Axes3D, figure.add_subplot(cells[0], projection="3d"))
    axis.plot_axes_in_space(space, view)
    directions = axis.plot_axis_directions(figure.add_subplot(cells[1]), view)
    positions = axis.plot_axis_positions(figure.add_subplot(cells[2]), view)
    _color_bar(figure, cells[3], view)
    style.letter(space, directions, positions)
    style.legend(figure, space, below=True)
    return figure


def instantaneous_axes_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the instantaneous axes: in space, and their directions and positions about their mean."""
    return axis_figure(axis.with_instantaneous_axes(view_of(analysis)), width_mm=width_mm)


def joint_axis_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the joint's axis with its 95 % cone, in space and in three projections."""
    view = view_of(analysis)
    if width_mm < NARROW_MM:
        figure = style.new_figure(width_mm, 2.2 * width_mm + 80.0)
        grid = figure.add_gridspec(5, 1, height_ratios=[1.1, 0.9, 0.6, 0.6, 0.05])
        cells = [grid[k, 0] for k in range(5)]
    else:
        figure = style.new_figure(width_mm, 135.0)
        grid = figure.add_gridspec(3, 2, height_ratios=[1.0, 0.75, 0.04])
        cells = [grid[0, 0], grid[0, 1], grid[1, 0], grid[1, 1], grid[2, :]]
    space = cast(Axes3D, figure.add_subplot(cells[0], projection="3d"))
    joint.plot_joint_axis_in_space(space, view)
    panels = [figure.add_subplot(cell) for cell in cells[1:4]]
    joint.plot_axis_end_on(panels[0], view)
    joint.plot_axis_from_the_side(panels[1], view, 0)
    joint.plot_axis_from_the_side(panels[2], view, 1)
    _color_bar(figure, cells[4], view)
    style.letter(space, *panels)
    style.legend(figure, panels[1], space, below=True)
    return figure


def error_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of angle error and RMS displacement over time; of orientations alone there is only the former."""
    view = view_of(analysis)
    if not view.located:
        figure = style.new_figure(width_mm, 60.0)
        style.legend(figure, series.plot_angle_error(figure.add_subplot(), view))
        return figure
    figure = style.new_figure(width_mm, 92.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    series.plot_angle_error(upper, view).set_xlabel("")
    series.plot_rms_displacement(lower, view)
    style.letter(upper, lower)
    style.legend(figure, upper)
    return figure


def _color_bar(figure: Figure, cell: SubplotSpec, view: TrialView) -> None:
    bar = figure.colorbar(axis.color_scale(view), cax=figure.add_subplot(cell), orientation="horizontal")
    bar.set_label(f"Angle θ ({view.settings.angle_unit})")
    bar.ax.set_label("<colorbar>")  # as matplotlib calls those that it makes itself
