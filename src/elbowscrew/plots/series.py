"""Curves over time: angle, Euler parameters and errors."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis
from elbowscrew.motion.movements.phases import runs_of
from elbowscrew.plots import style
from elbowscrew.quantities import angle_in, length_in, rounded
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.bands import is_seen
from elbowscrew.view.decimation import drawn_band, drawn_rows
from elbowscrew.view.long_trials import Stretch, envelope, stretch_of
from elbowscrew.view.trial_view import TrialView, model_label

OVERVIEW_MM: Final = 24.0
_KEYFRAMES: Final = 20  # more are drawn smaller
_PIECE: Final = 500
_LEAST_SHARE: Final = 0.08  # of a trial, that a stretch must be for its curve to be more than a bar in the overview


def plot_theta(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw measured and modeled angle over time with the keyframes (the paper's figures 7 and 8)."""
    view = view_of(analysis)
    unit = view.settings.angle_unit
    angle = angle_in(view.angle, unit)
    reach = angle_in(NORMAL_95 * view.angle_sd, unit)
    time_s = view.time_s
    band(ax, time_s, angle, reach)
    line(ax, time_s, angle, label="measured", **style.MEASURED)
    line(ax, time_s, angle_in(view.modeled_angle, unit), label=model_label(view), **style.MODELED)
    mark_keyframes(ax, view, angle)
    mark_movements(ax, view)
    mark_tracking(ax, view)
    ax.set_ylabel(f"Angle θ ({unit})")
    return over_time(ax, time_s)


def plot_euler_parameter(ax: Axes, analysis: Analysis | TrialView, component: int) -> Axes:
    """Draw one of e0..e3, measured and modeled, over time (the paper's figures 9 and 10)."""
    view = view_of(analysis)
    time_s = view.time_s
    measured = view.euler_parameters[:, component]
    line(ax, time_s, measured, label="measured", **style.MEASURED)
    modeled = view.modeled_euler_parameters[:, component]
    line(ax, time_s, modeled, label=model_label(view), **style.MODELED)
    mark_keyframes(ax, view, measured)
    mark_tracking(ax, view)
    ax.set_ylabel(f"e{'₀₁₂₃'[component]} (–)")
    return over_time(ax, time_s)


def plot_angle_error(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the angle between modeled and measured orientation over time, with its RMS."""
    view = view_of(analysis)
    unit = view.settings.angle_unit
    return _plot_error(ax, view, angle_in(view.angle_error, unit), "Angle error", unit)


def plot_rms_displacement(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the RMS displacement of the distal body's points over time, with its RMS."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    values = length_in(view.rms_displacement, unit)
    return _plot_error(ax, view, values, "RMS displacement", unit)


def overview_grid(
    figure: Figure,
    view: TrialView,
    stretch: Stretch | None,
    rows: int,
    cell: SubplotSpec | None = None,
    *,
    columns: int = 1,
    first: float = 1.0,
) -> list[Axes]:
    """Make panels over time; above those of a long trial's stretch one of the whole trial.

    Parameters
    ----------
    figure : Figure
        It grows where there is one panel more.
    view : TrialView
        The whole trial.
    stretch : Stretch or None
        What the other panels show of it.
    rows, columns : int
        How many they are.
    cell : SubplotSpec, optional
        Where they stand; the whole figure by default.
    first : float
        Height of the first row against the others.

    Returns
    -------
    list of Axes
        The overview, if there is one, and the panels, row by row.
    """  # fmt: skip
    above = stretch is not None
    if above:
        width, height = figure.get_size_inches()
        figure.set_size_inches(width, height + OVERVIEW_MM / style.MM_PER_INCH)
    ratios = [*([0.5] if above else []), first, *[1.0] * (rows - 1)]
    shape: dict[str, Any] = {"nrows": len(ratios), "ncols": columns, "height_ratios": ratios}
    grid = figure.add_gridspec(**shape) if cell is None else cell.subgridspec(**shape)
    panels = [figure.add_subplot(grid[0, :])] if above else []
    panels += [figure.add_subplot(grid[above + row, column]) for row in range(rows) for column in range(columns)]
    if stretch is not None:
        plot_overview(panels[0], view, stretch)
    return panels


def plot_overview(ax: Axes, view: TrialView, stretch: Stretch) -> Axes:
    """Draw what the angle spans all through a long trial, and where the stretch is that is drawn in full."""
    unit = view.settings.angle_unit
    found = envelope(view, angle_in(view.angle, unit))
    ax.fill_between(found.time_s, found.low, found.high, label="range of each part", **style.SPREAD)
    ends = view.time_s[[stretch.first, stretch.end - 1]]
    ax.axvspan(*ends, facecolor="white", edgecolor=style.BLACK, linewidth=0.7, zorder=2, label="part drawn in full")
    if ends[1] - ends[0] > _LEAST_SHARE * (view.time_s[-1] - view.time_s[0]):
        rows = drawn_rows(angle_in(view.angle[stretch.first : stretch.end], unit)) + stretch.first
        ax.plot(view.time_s[rows], angle_in(view.angle[rows], unit), **{**style.MEASURED, "linewidth": 0.6})
    ax.set_ylabel(f"θ ({unit})")
    return over_time(ax, view.time_s)


def span_line(ax: Axes, view: TrialView, values: Float, *, label: str, parted: bool) -> Axes:
    """Draw a series that jumps from frame to frame, or the range and the median of each part of it."""
    if not parted:
        return line(ax, view.time_s, values, label=label, **{**style.MEASURED, "linewidth": 0.6})
    found = envelope(view, values)
    ax.fill_between(found.time_s, found.low, found.high, label="range of each part", **style.SPREAD)
    ax.plot(found.time_s, found.middle, label="median of each part", **style.MEASURED)
    return ax


def mark_keyframes(ax: Axes, view: TrialView, values: Float) -> Axes:
    """Mark the poses that the model goes through on a curve (N,), smaller where they are many."""
    rows = view.keyframes.row
    size = style.KEYFRAME["markersize"] * min(1.0, np.sqrt(_KEYFRAMES / max(rows.size, 1)))
    look = {**style.KEYFRAME, "markersize": size, "markeredgewidth": min(1.2, 0.3 * size)}
    ax.plot(view.time_s[rows], values[rows], label="keyframes", **look)
    return ax


def mark_tracking(ax: Axes, view: TrialView) -> Axes:
    """Shade the frames without a measured pose: plain where they stay empty, hatched where they were filled in."""
    half = 0.5 / view.rate_hz
    for mask, label, look in (
        (~view.valid & ~view.filled, "not tracked", style.LOST),
        (view.filled, "filled in", style.FILLED),
    ):
        first, last = runs_of(mask)
        _shade(ax, view.time_s[first] - half, view.time_s[last] + half, label=label, **look)
    return ax


def mark_movements(ax: Axes, view: TrialView) -> Axes:
    """Shade the movements between rests."""
    time_s, phases = view.time_s, view.phases
    _shade(ax, time_s[phases.onset_rows], time_s[phases.offset_rows], label="moving", **style.MOVING)
    return ax


def _shade(ax: Axes, start: Float, end: Float, **look: Any) -> None:
    """Shade spans of time from bottom to top: one artist, as a long recording has thousands of them."""
    if not start.size:
        return
    corners = [[(a, 0.0), (a, 1.0), (b, 1.0), (b, 0.0)] for a, b in zip(start.tolist(), end.tolist(), strict=True)]
    ax.add_collection(PolyCollection(corners, transform=ax.get_xaxis_transform(), **look), autolim=False)


def _plot_error(ax: Axes, view: TrialView, values: Float, name: str, unit: str) -> Axes:
    time_s = view.time_s
    parted = stretch_of(view) is not None
    span_line(ax, view, values, label="model against measurement", parted=parted)
    if np.isfinite(values).any():
        level = float(np.sqrt(np.nanmean(values**2)))
        ax.axhline(level, **style.LEVEL)
        ax.set_title(f"RMS {rounded(level, 3)} {unit}", loc="right", fontweight="normal")
    if not parted:
        mark_keyframes(ax, view, values)
    mark_tracking(ax, view)
    ax.set_ylabel(f"{name} ({unit})")
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    return over_time(ax, time_s)


def band(ax: Axes, time_s: Float, values: Float, reach: Float, span: float | None = None) -> Axes:
    """Draw the 95 % interval about a curve, where it can be seen on a panel that spans `span`, by default its range."""
    if is_seen(values, reach, span):
        rows, low, high = drawn_band(values - reach, values + reach)
        ax.fill_between(time_s[rows], low, high, label="95 % interval", **style.BAND)
    return ax


def line(ax: Axes, time_s: Float, values: Float, *, label: str, **look: Any) -> Axes:
    """Draw a line, a thinned one in pieces that share their ends.

    Of each piece the renderer remembers every pixel that it crosses, a hundred megabytes of all. Its own way to part a
    line, `agg.path.chunksize`, leaves out what lies between the pieces.
    """
    rows = drawn_rows(values)
    size = max(rows.size - 1, 1) if rows.size == values.size else _PIECE
    for first in range(0, max(rows.size - 1, 1), size):
        piece = rows[first : first + size + 1]
        ax.plot(time_s[piece], values[piece], label=label if first == 0 else None, **look)
    return ax


def over_time(ax: Axes, time_s: Float) -> Axes:
    """Let the axis along be the time of the recording."""
    margin = 0.01 * (time_s[-1] - time_s[0]) or 0.01
    ax.set_xlim(time_s[0] - margin, time_s[-1] + margin)
    ax.set_xlabel("Time (s)")
    return ax
