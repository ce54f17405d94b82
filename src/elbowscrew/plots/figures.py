"""The figures of a result, each by name."""

from __future__ import annotations

from typing import Final, Protocol, cast

from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D

from elbowscrew.model import Analysis
from elbowscrew.plots import axis, joint, series, style
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.trial_view import TrialView

WIDTH_MM: Final = 170.0
NARROW_MM: Final = 120.0  # below this panels stand one below the other


class MakeFigure(Protocol):
    """A whole figure of a trial at a width on paper."""

    def __call__(self, analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
        """Draw it."""
        ...


def theta_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of measured and modeled angle over time with keyframes."""
    view = view_of(analysis)
    narrow = width_mm < NARROW_MM
    figure = style.new_figure(width_mm, 72.0 if narrow else 80.0)
    ax = series.plot_theta(figure.add_subplot(), view)
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=2 if narrow else 4)
    return figure


def euler_parameters_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of measured and modeled e0..e3 over time."""
    view = view_of(analysis)
    narrow = width_mm < NARROW_MM
    figure = style.new_figure(width_mm, 150.0 if narrow else 105.0)
    panels = figure.subplots(4 if narrow else 2, 1 if narrow else 2, sharex=True).ravel()
    for component, ax in enumerate(panels):
        series.plot_euler_parameter(ax, view, component)
    for ax in panels[: 3 if narrow else 2]:
        ax.set_xlabel("")
    keys = panels[0].get_legend_handles_labels()
    figure.legend(*keys, loc="outside upper center", ncols=2 if narrow else 5)
    return figure


def axis_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the axes in space, of their directions and of their positions."""
    view = view_of(analysis)
    if width_mm < NARROW_MM:
        figure = style.new_figure(width_mm, 160.0)
        # The second row keeps the legend of the space apart from the panels below it: the layout does not see it.
        grid = figure.add_gridspec(4, 2, height_ratios=[1.5, 0.2, 1.0, 0.05])
        cells = grid[0, :], grid[2, 0], grid[2, 1], grid[3, :]
    else:
        figure = style.new_figure(width_mm, 84.0)
        # The second column keeps the labels of the space apart from the next panel's, for the same reason.
        grid = figure.add_gridspec(2, 4, width_ratios=[1.3, 0.12, 1.0, 1.0], height_ratios=[1.0, 0.04])
        cells = grid[:, 0], grid[0, 2], grid[0, 3], grid[1, 2:]
    space = cast(Axes3D, figure.add_subplot(cells[0], projection="3d"))
    axis.plot_axes_in_space(space, view)
    directions = axis.plot_axis_directions(figure.add_subplot(cells[1]), view)
    positions = axis.plot_axis_positions(figure.add_subplot(cells[2]), view)
    bar = figure.colorbar(axis.color_scale(view), cax=figure.add_subplot(cells[3]), orientation="horizontal")
    bar.set_label(f"Angle θ ({view.settings.angle_unit})")
    for ax, letter in ((space, "a"), (directions, "b"), (positions, "c")):
        ax.set_title(letter, loc="left")
    space.set_title(f"axes in the {view.settings.express_in} frame", loc="center", fontweight="normal")
    space.legend(loc="upper center", bbox_to_anchor=(0.5, -0.05), ncols=2)
    return figure


def joint_axis_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the joint's axis with its 95 % cone, in space and in three projections."""
    view = view_of(analysis)
    narrow = width_mm < NARROW_MM
    if narrow:
        figure = style.new_figure(width_mm, 230.0)
        grid = figure.add_gridspec(5, 1, height_ratios=[1.4, 1.2, 0.8, 0.8, 0.06])
        cells = [grid[k, 0] for k in range(5)]
    else:
        figure = style.new_figure(width_mm, 140.0)
        grid = figure.add_gridspec(3, 2, height_ratios=[1.0, 0.75, 0.04])
        cells = [grid[0, 0], grid[0, 1], grid[1, 0], grid[1, 1], grid[2, :]]
    space = cast(Axes3D, figure.add_subplot(cells[0], projection="3d"))
    joint.plot_joint_axis_in_space(space, view)
    panels = [figure.add_subplot(cell) for cell in cells[1:4]]
    joint.plot_axis_end_on(panels[0], view)
    joint.plot_axis_from_the_side(panels[1], view, 0)
    joint.plot_axis_from_the_side(panels[2], view, 1)
    bar = figure.colorbar(axis.color_scale(view), cax=figure.add_subplot(cells[4]), orientation="horizontal")
    bar.set_label(f"Angle θ ({view.settings.angle_unit})")
    for ax, letter in ((space, "a"), *zip(panels, "bcd", strict=True)):
        ax.set_title(letter, loc="left")
    frame = f"{view.settings.express_in} frame"
    split = "\n" if narrow else " "
    figure.suptitle(f"Joint axis in the {frame}{split}({joint.confidence_text(view)})", fontsize=8.0)
    figure.legend(*panels[1].get_legend_handles_labels(), loc="outside lower center", ncols=1 if narrow else 3)
    return figure


def error_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of angle error and RMS displacement over time."""
    view = view_of(analysis)
    narrow = width_mm < NARROW_MM
    figure = style.new_figure(width_mm, 100.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    series.plot_angle_error(upper, view).set_xlabel("")
    series.plot_rms_displacement(lower, view)
    figure.legend(*upper.get_legend_handles_labels(), loc="outside upper center", ncols=2 if narrow else 4)
    return figure
