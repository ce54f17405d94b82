"""The screw axes in space, and their spread about the mean axis."""

from __future__ import annotations

from typing import Any, Final, NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

from elbowscrew.choices import LengthUnit
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Analysis
from elbowscrew.motion.axes.mean_axis import MOST_ACROSS
from elbowscrew.motion.difference import piercing
from elbowscrew.plots import style
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.decimation import drawn_rows
from elbowscrew.view.scene import Bodies, axis_segments, bodies_in_space, directions_across, half_length
from elbowscrew.view.trial_view import TrialView

_MOST_POINTS: Final = 4000


class _MeanFrame(NamedTuple):
    """The mean axis with two directions perpendicular to it, and its point nearest the distal body's path."""

    direction: Float
    across: tuple[Float, Float]
    names: tuple[str, str]
    center: Float


def color_scale(view: TrialView) -> ScalarMappable:
    """Return the color scale of the angle, for axes and a color bar."""
    angle = angle_in(view.angle[view.axis_known], view.settings.angle_unit)
    return ScalarMappable(Normalize(float(angle.min()), float(angle.max())), style.COLORMAP)


def plot_axes_in_space(ax: Axes3D, analysis: Analysis | TrialView) -> Axes3D:
    """Draw the axes with the mean axis and the bodies, the distal one by its path, in the frame of the axes."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    bodies = bodies_in_space(view)
    proximal = bodies.proximal
    clusters = [markers for markers in (bodies.proximal_markers, bodies.distal_markers) if markers is not None]
    mean = _mean_frame(view, bodies)
    half = half_length(bodies, mean.center)
    rows, segments = axis_segments(view, mean.center, half)
    segments = length_in(segments, unit)
    colors = color_scale(view).to_rgba(angle_in(view.angle[rows], view.settings.angle_unit))
    ax.add_collection3d(Line3DCollection(list(segments), colors=colors, linewidths=0.7, alpha=0.8))
    ends = length_in(mean.center + 1.3 * half * np.outer([-1.0, 1.0], mean.direction), unit)
    ax.plot(*ends.T, color="black", linewidth=1.6, label="mean axis")
    words = view.named_joint
    plot_path(ax, bodies.path, unit, f"{words.distal.name} path")
    shown = [segments.reshape(-1, 3), ends, length_in(bodies.corners, unit)]
    if proximal is not None:
        ax.plot(*length_in(proximal[None], unit).T, "^", color="#0072B2", markersize=5, label=words.proximal.name)
        shown.append(length_in(proximal[None], unit))
    for k, cluster in enumerate(clusters):
        label = "markers" if k == 0 else None
        ax.plot(*length_in(cluster, unit).T, ".", color="#666666", markersize=3, label=label)
        shown.append(length_in(cluster, unit))
    equal_aspect(ax, np.concatenate(shown))
    for name, label in (("x", ax.set_xlabel), ("y", ax.set_ylabel), ("z", ax.set_zlabel)):
        label(f"{name} ({unit})", labelpad=-2)
    return ax


def plot_path(ax: Axes3D, path: Float, unit: LengthUnit, label: str) -> None:
    """Draw the path (N, 3) of the distal body's origin, meters."""
    rows = drawn_rows(*path.T)
    ax.plot(*length_in(path[rows], unit).T, color="#D55E00", linewidth=1.2, label=label)


def plot_axis_directions(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw how far each axis, a line without direction, is tilted from the mean axis, in two directions across it."""
    view = view_of(analysis)
    unit = view.settings.angle_unit
    mean = _mean_frame(view, bodies_in_space(view))
    rows = evenly_thinned(np.flatnonzero(view.axis_known), _MOST_POINTS)
    direction = view.axis_direction[rows]
    along = direction @ mean.direction
    way = np.where(along < 0.0, -1.0, 1.0)
    tilts = [angle_in(np.arctan2(way * (direction @ across), way * along), unit) for across in mean.across]
    _scatter(ax, view, rows, tilts)
    ax.set_xlabel(f"Tilt toward {mean.names[0]} ({unit})")
    ax.set_ylabel(f"Tilt toward {mean.names[1]} ({unit})")
    return ax


def plot_axis_positions(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw where each axis pierces the plane across the mean axis nearest the distal body, from the mean axis."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    mean = _mean_frame(view, bodies_in_space(view))
    rows = evenly_thinned(np.flatnonzero(view.axis_known), _MOST_POINTS)
    direction, point = view.axis_direction[rows], view.axis_point[rows]
    along = direction @ mean.direction
    crossing = np.abs(along) >= np.cos(MOST_ACROSS)  # an axis nearly in the plane pierces it far away or nowhere
    rows, direction, point = rows[crossing], direction[crossing], point[crossing]
    offset = length_in(piercing(direction, point, mean.direction, mean.center) - mean.center, unit)
    _scatter(ax, view, rows, [offset @ across for across in mean.across])
    ax.set_xlabel(f"Position toward {mean.names[0]} ({unit})")
    ax.set_ylabel(f"Position toward {mean.names[1]} ({unit})")
    return ax


def _scatter(ax: Axes, view: TrialView, rows: NDArray[np.int64], values: list[Float]) -> None:
    scale = color_scale(view)
    angle = angle_in(view.angle[rows], view.settings.angle_unit)
    ax.axhline(0.0, **style.LEVEL)
    ax.axvline(0.0, **style.LEVEL)
    ax.scatter(
        values[0], values[1], c=angle, cmap=scale.cmap, norm=cast(Normalize, scale.norm), s=7, linewidths=0, zorder=3
    )
    ax.plot(0.0, 0.0, "+", color="black", markersize=9, markeredgewidth=1.2, zorder=4)
    reach = 1.1 * max(float(np.max(np.abs(values), initial=0.0)), 1e-9)
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    ax.set_box_aspect(1.0)


def _mean_frame(view: TrialView, bodies: Bodies) -> _MeanFrame:
    n, point = view.mean_direction, view.mean_point
    across, names = directions_across(n)
    center = point + ((bodies.middle - point) @ n) * n
    return _MeanFrame(n, across, names, center)


def equal_aspect(ax: Axes3D, points: Float) -> None:
    """Show all the points (M, 3), each coordinate at the same scale."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * float(np.max(high - low)) or 1.0
    bounds: Any = np.stack([middle - half, middle + half], axis=1)
    ax.set_xlim(*bounds[0])
    ax.set_ylim(*bounds[1])
    ax.set_zlim(*bounds[2])
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=0.92)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_major_locator(MaxNLocator(4))
        axis.set_tick_params(pad=-1)
