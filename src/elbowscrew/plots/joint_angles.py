"""The joint's own angles over time, and an axis that wanders with them."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis
from elbowscrew.model.joint_axis import AxisPath
from elbowscrew.model.joint_type import JointAngles
from elbowscrew.plots import style
from elbowscrew.plots.figures import NARROW_MM, WIDTH_MM
from elbowscrew.plots.series import band, line, mark_tracking, over_time, overview_grid, span_line
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.bands import is_seen, span_of
from elbowscrew.view.decimation import drawn_rows
from elbowscrew.view.joint_space import ANGLE_NAMES
from elbowscrew.view.long_trials import is_dense, shown_part
from elbowscrew.view.trial_view import TrialView
from elbowscrew.view.wander import off_mean


def joint_angles_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the joint's own angles over time, of two against each other, and of what is left.

    Of orientations alone there is no position that could be left.
    """
    view, angles = _with_angles(analysis)
    shown, stretch = shown_part(view)
    both, in_time = angles.angle.shape[1] == 2, 3 if view.located else 2
    if width_mm < NARROW_MM:
        figure = style.new_figure(width_mm, 135.0 + 0.8 * width_mm * both)
        grid = figure.add_gridspec(1 + both, 1, height_ratios=[135.0, 0.8 * width_mm][: 1 + both])
        cells = [grid[k, 0] for k in range(1 + both)]
    else:
        figure = style.new_figure(width_mm, 110.0)
        grid = figure.add_gridspec(3, 2, width_ratios=[1.5, 1.0]) if both else figure.add_gridspec(1, 1)
        cells = [grid[:, 0], grid[:2, 1]] if both else [grid[0, 0]]
    panels = overview_grid(figure, view, stretch, in_time, cells[0], first=1.5)
    plot_joint_angles(panels[-in_time], shown).set_xlabel("")
    plot_residual_rotation(panels[1 - in_time], shown)
    if view.located:
        panels[1 - in_time].set_xlabel("")
        plot_residual_translation(panels[-1], shown)
    if both:
        panels.append(plot_angles_together(figure.add_subplot(cells[1]), shown))
    style.letter(*panels)
    style.legend(figure, *panels)
    return figure


def _with_angles(analysis: Analysis | TrialView) -> tuple[TrialView, JointAngles]:
    """Give the view and the joint's own angles; ValueError of a joint without any."""
    view = view_of(analysis)
    if view.joint_angles is None:
        msg = "this joint has no angles of its own to draw"
        raise ValueError(msg)
    return view, view.joint_angles


def plot_joint_angles(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the joint's own angles over time with their 95 % intervals."""
    view, angles = _with_angles(analysis)
    unit = view.settings.angle_unit
    names = ANGLE_NAMES[angles.angle.shape[1]]
    span = span_of(angle_in(angles.angle, unit))
    for k, name in enumerate(names):
        values, reach = angle_in(angles.angle[:, k], unit), angle_in(NORMAL_95 * angles.angle_sd[:, k], unit)
        band(ax, angles.time_s, values, reach, span)
        line(ax, angles.time_s, values, label=name, linewidth=1.2, zorder=2, **style.AXES[k])
    mark_tracking(ax, view)
    ax.set_ylabel(f"{names[0] if len(names) == 1 else 'Angles'} ({unit})")
    return over_time(ax, angles.time_s)


def plot_residual_rotation(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the rotation that the joint leaves of each pose, over time."""
    view, angles = _with_angles(analysis)
    unit = view.settings.angle_unit
    return _plot_residual(ax, view, angle_in(angles.residual_rotation, unit), f"Residual rotation ({unit})")


def plot_residual_translation(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the distance that the joint leaves of each pose, over time."""
    view, angles = _with_angles(analysis)
    unit = view.settings.length_unit
    return _plot_residual(ax, view, length_in(angles.residual_translation, unit), f"Residual position ({unit})")


def _plot_residual(ax: Axes, view: TrialView, values: Float, name: str) -> Axes:
    mark_tracking(span_of_frames(ax, view, values), view)
    ax.set_ylabel(name.replace(" ", "\n", 1))
    return over_time(ax, view.time_s)


def span_of_frames(ax: Axes, view: TrialView, values: Float) -> Axes:
    """Draw a number of each frame that is never negative, from zero on, its largest clear of the panel's edge."""
    found = float(np.nanmax(values, initial=0.0)) if np.isfinite(values).any() else 0.0
    span_line(ax, view, values, label="of each frame", parted=is_dense(view))
    ax.set_ylim(0.0, 1.08 * found or 1.0)
    return ax


def plot_angles_together(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the second angle against the first."""
    view, angles = _with_angles(analysis)
    unit = view.settings.angle_unit
    rows = drawn_rows(*angles.angle.T)
    first, second = angle_in(angles.angle[rows], unit).T
    ax.plot(first, second, color="#000000", linewidth=0.9)
    start = np.flatnonzero(np.isfinite(first) & np.isfinite(second))[:1]
    ax.plot(first[start], second[start], label="start", **style.START)
    names = ANGLE_NAMES[2]
    ax.set_xlabel(f"{names[0]} ({unit})")
    ax.set_ylabel(f"{names[1]} ({unit})")
    return ax


def axis_path_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of an axis that wanders: its tilt and its shift from the mean axis against the angle."""
    view, _ = _with_path(analysis)
    narrow = width_mm < NARROW_MM
    figure = style.new_figure(width_mm, 110.0 if narrow else 68.0)
    panels = [figure.add_subplot(2, 1, k) if narrow else figure.add_subplot(1, 2, k) for k in (1, 2)]
    for ax, shifted in zip(panels, (False, True), strict=True):
        plot_axis_path(ax, view, shifted=shifted)
    style.letter(*panels)
    style.legend(figure, *panels, below=True)
    return figure


def _with_path(analysis: Analysis | TrialView) -> tuple[TrialView, AxisPath]:
    """Give the view and the path of its axis; ValueError of an axis that stays."""
    view = view_of(analysis)
    if view.axis_path is None:
        msg = "no wander of this joint's axis was found"
        raise ValueError(msg)
    return view, view.axis_path


def plot_axis_path(ax: Axes, analysis: Analysis | TrialView, *, shifted: bool) -> Axes:
    """Draw how far an axis that wanders tilts from the mean axis, or shifts, against the angle."""
    view, path = _with_path(analysis)
    settings, found = view.settings, off_mean(view, path)
    angle = angle_in(path.angle, settings.angle_unit)
    if shifted:
        parts, reach = (length_in(values, settings.length_unit) for values in (found.shift, found.shift_reach))
    else:
        parts, reach = (angle_in(values, settings.angle_unit) for values in (found.tilt, found.tilt_reach))
    seen = is_seen(parts[0], reach, span_of(parts))
    for k, (values, name) in enumerate(zip(parts, found.toward, strict=True)):
        if seen:
            ax.fill_between(angle, values - reach, values + reach, label="95 % of each", **style.BAND)
        ax.plot(angle, values, label=f"toward {name}", linewidth=1.3, marker="o", markersize=2.5, **style.AXES[k])
    ax.axhline(0.0, **style.LEVEL)
    ax.set_xlabel(f"Angle ({settings.angle_unit})")
    what, unit = ("Shift", settings.length_unit) if shifted else ("Tilt", settings.angle_unit)
    ax.set_ylabel(f"{what} from the mean axis ({unit})")
    return ax
