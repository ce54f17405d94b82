"""How the joint slides and how fast it moves: slide against angle, velocities over time."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis
from elbowscrew.plots import style
from elbowscrew.plots.figures import NARROW_MM, WIDTH_MM
from elbowscrew.plots.series import line, mark_tracking, over_time, overview_grid
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.bands import is_seen
from elbowscrew.view.decimation import drawn_rows
from elbowscrew.view.long_trials import shown_part, stretch_of
from elbowscrew.view.trial_view import TrialView, fitted_pitch_mm

_DOT_DASH: Final = (0, (6, 2, 1, 2))
_BINS: Final = 60
_LEAST_IN_BIN: Final = 10
_STEPS_IN_BIN: Final = 2.0


def slide_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the slide along the axis against the angle about it."""
    view = view_of(analysis)
    figure = style.new_figure(width_mm, 62.0 if width_mm < NARROW_MM else 76.0)
    ax = figure.add_subplot()
    if stretch_of(view) is None:
        plot_slide(ax, view)
    else:
        plot_slide_span(ax, view)
    style.legend(figure, ax)
    return figure


def plot_slide(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the slide along each frame's axis against the angle, with its 95 % interval."""
    view = view_of(analysis)
    angle = angle_in(view.angle, view.settings.angle_unit)
    slide = length_in(view.slide, view.settings.length_unit)
    reach = length_in(NORMAL_95 * view.slide_sd, view.settings.length_unit)
    rows = drawn_rows(angle, slide, keep_gaps=True)
    if is_seen(slide, reach):
        ax.add_collection(_ribbon(angle[rows], slide[rows], reach[rows]))
    ax.plot(angle[rows], slide[rows], label="measured", **{**style.MEASURED, "linewidth": 0.7})
    return _with_slope(ax, view)


def _with_slope(ax: Axes, view: TrialView) -> Axes:
    pitch_mm = fitted_pitch_mm(view)
    if pitch_mm is not None and np.isfinite(view.slide).any():
        ends = np.array([np.nanmin(view.angle), np.nanmax(view.angle)])
        # The noise of the reference shifts all slides alike.
        shift = float(np.nanmedian(view.slide - 1e-3 * pitch_mm * view.angle))
        along = length_in(1e-3 * pitch_mm * ends + shift, view.settings.length_unit)
        angle = angle_in(ends, view.settings.angle_unit)
        ax.plot(angle, along, color="white", linewidth=2.8)  # which parts it from a black cloud of noise
        ax.plot(
            angle,
            along,
            label="slope of the screw-hinge",
            **{**style.AXES[0], "linewidth": 1.2, "linestyle": _DOT_DASH},  # told from the curve in grey, too
        )
    ax.set_xlabel(f"Angle θ ({view.settings.angle_unit})")
    ax.set_ylabel(f"Slide along the axis ({view.settings.length_unit})")
    return ax


def _ribbon(x: Float, y: Float, reach: Float) -> PolyCollection:
    """A band about a curve that may turn back: a piece for each part on which it does not, for one would cut itself."""
    low, high = np.column_stack([x, y - reach]), np.column_stack([x, y + reach])
    known = np.isfinite(x + y + reach)
    way = np.where(known[:-1] & known[1:], np.sign(np.diff(x)), np.nan)
    turns = np.flatnonzero(np.diff(way) != 0.0) + 1  # a gap, which is NaN, is a part of its own
    ends = pairwise([0, *turns.tolist(), way.size])
    parts = [slice(first, last + 1) for first, last in ends if np.isfinite(way[first:last]).all()]
    look = {**style.BAND, "edgecolor": style.ORANGE}
    return PolyCollection([np.concatenate([low[k], high[k][::-1]]) for k in parts], label="95 % interval", **look)


def plot_slide_span(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw of a long trial what 90 % of the frames keep within at each angle, and the medians out and back."""
    view = view_of(analysis)
    angle_unit, unit = view.settings.angle_unit, view.settings.length_unit
    with np.errstate(invalid="ignore"):
        way = np.sign(np.gradient(view.angle))
    edges = _edges(view)
    angle = angle_in(0.5 * (edges[:-1] + edges[1:]), angle_unit)
    both, _ = _spans(view, np.ones(way.size, dtype=bool), edges)
    rising, risen = _spans(view, way > 0.0, edges)
    falling, fallen = _spans(view, way < 0.0, edges)
    seen = (risen | ~risen.any()) & (fallen | ~fallen.any())  # of a motion that goes one way alone, that way
    low, _, high = length_in(np.where(seen[:, None], both, np.nan), unit).T
    ax.fill_between(angle, low, high, label="90 % of the frames", **style.SPREAD)
    dashes = {"linestyle": (0, (5, 2))}
    for spans, label, look in ((rising, "rising", {}), (falling, "falling", dashes)):
        ax.plot(angle, length_in(spans[:, 1], unit), label=f"median, angle {label}", **{**style.MEASURED, **look})
    return _with_slope(ax, view)


def _edges(view: TrialView) -> Float:
    """Angles that part the frames: no closer than fast frames are to each other, which would leave parts empty."""
    known = view.angle[np.isfinite(view.slide) & np.isfinite(view.angle)]
    low, high = np.percentile(known, [0.0, 100.0]) if known.size else (0.0, 1.0)
    step = np.abs(np.diff(view.angle))
    step = step[np.isfinite(step)]
    narrowest = _STEPS_IN_BIN * float(np.percentile(step, 95.0)) if step.size else 0.0
    count = _BINS if narrowest * _BINS <= high - low else max(int((high - low) / narrowest), 1)
    return np.linspace(low, high, count + 1)


def _spans(view: TrialView, mask: Bool, edges: Float) -> tuple[Float, Bool]:
    """Of the slides of frames between two angles 5 %, 50 % and 95 %, shape (K, 3), NaN and false where they are few."""
    known = np.isfinite(view.slide) & np.isfinite(view.angle) & mask
    angle, slide = view.angle[known], view.slide[known]
    of_bin = np.clip(np.digitize(angle, edges) - 1, 0, edges.size - 2)
    parts = [slide[of_bin == k] for k in range(edges.size - 1)]
    enough = np.array([part.size >= _LEAST_IN_BIN for part in parts])
    spans = np.full((edges.size - 1, 3), np.nan)
    for k in np.flatnonzero(enough):
        spans[k] = np.percentile(parts[k], [5.0, 50.0, 95.0])
    return spans, enough


def velocity_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of angular velocity and slide velocity over time; of orientations alone there is no slide."""
    view = view_of(analysis)
    shown, stretch = shown_part(view)
    figure = style.new_figure(width_mm, 92.0 if view.located else 60.0)
    count = 2 if view.located else 1
    panels = overview_grid(figure, view, stretch, count)
    plot_angular_velocity(panels[-count], shown)
    if view.located:
        panels[-count].set_xlabel("")
        plot_slide_velocity(panels[-1], shown)
    style.letter(*panels)
    style.legend(figure, *panels)
    return figure


def plot_angular_velocity(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the angular velocity about the instantaneous axis over time."""
    view = view_of(analysis)
    unit = view.settings.angle_unit
    return _plot_velocity(ax, view, angle_in(_of(view, "angular_velocity"), unit), f"Angular velocity ({unit}/s)")


def plot_slide_velocity(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the velocity along the instantaneous axis over time."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    return _plot_velocity(ax, view, length_in(_of(view, "slide_velocity"), unit), f"Slide velocity ({unit}/s)")


def _of(view: TrialView, name: str) -> Float:
    found: Float = view.extra["instantaneous"][name]
    return found


def _plot_velocity(ax: Axes, view: TrialView, values: Float, name: str) -> Axes:
    line(ax, view.time_s, values, label="measured, filtered", **style.MEASURED)
    ax.axhline(0.0, **style.LEVEL)
    mark_tracking(ax, view)
    ax.set_ylabel(name)
    return over_time(ax, view.time_s)
