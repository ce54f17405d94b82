"""The screw axes in space, and their spread about the mean axis."""

from __future__ import annotations

from dataclasses import replace
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
from elbowscrew.geometry.lines import piercing
from elbowscrew.model import Analysis
from elbowscrew.motion.axes.mean_axis import MOST_ACROSS
from elbowscrew.plots import style
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.decimation import drawn_rows
from elbowscrew.view.scene import Bodies, axis_segments, bodies_in_space, directions_across, half_length
from elbowscrew.view.trial_view import TrialView

_MOST_POINTS: Final = 4000
_AROUND: Final = 32
_LEAST_SEEN: Final = 0.025  # of the axis' length: a narrower cone's lines run into one bar at a column's width
_MOST_SEEN: Final = 0.5  # a wider one runs out of the space
IN_FRONT: Final = 50.0
"""Where the axes of joints are drawn: matplotlib would put all collections in a space before its lines."""


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


def with_instantaneous_axes(view: TrialView) -> TrialView:
    """Give the view with the instantaneous axes in place of the finite ones, and with the mean of theirs.

    The mean line is the one from which they are tilted, and which they pass, the least by the sum of squares; an axis
    counts by the square of its angular velocity, as it is known the better the faster the joint turns.
    """
    table = view.extra["instantaneous"]
    direction, point = table["axis_direction"], table["axis_point"]
    known = np.isfinite(direction).all(axis=1)
    n, p = direction[known], point[known]
    weight = table["angular_velocity"][known] ** 2
    mean = np.linalg.eigh((weight * n.T) @ n)[1][:, 2]
    mean = mean if float(mean @ view.mean_direction) >= 0.0 else -mean
    across = np.eye(3) - n[:, :, None] * n[:, None, :]
    normal = np.einsum("k,kij->ij", weight, across)
    # Along the mean nothing tells where: the point nearest the origin.
    center = np.linalg.lstsq(normal, np.einsum("k,kij,kj->i", weight, across, p), rcond=1e-9)[0]
    return replace(
        view,
        axis_direction=direction,
        axis_point=point,
        mean_direction=mean,
        mean_point=center - (center @ mean) * mean,
    )


def plot_axes_in_space(ax: Axes3D, analysis: Analysis | TrialView) -> Axes3D:
    """Draw the axes with the mean axis and the bodies, the distal one by its path, in the frame of the axes."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    bodies = bodies_in_space(view)
    mean = _mean_frame(view, bodies)
    half = half_length(bodies, mean.center)
    rows, segments = axis_segments(view, mean.center, half)
    segments = length_in(segments, unit)
    colors = color_scale(view).to_rgba(angle_in(view.angle[rows], view.settings.angle_unit))
    ax.add_collection3d(Line3DCollection(list(segments), colors=colors, linewidths=0.7))
    ends = length_in(mean.center + 1.3 * half * np.outer([-1.0, 1.0], mean.direction), unit)
    ax.plot(*ends.T, linewidth=1.6, zorder=IN_FRONT, label="mean axis", **style.AXES[0])
    words = view.named_joint
    plot_path(ax, bodies.path, unit, f"{words.distal.name} path")
    shown = [segments.reshape(-1, 3), ends, length_in(bodies.corners, unit)]
    for origin, markers, look, word in (
        (bodies.proximal, bodies.proximal_markers, style.PROXIMAL, words.proximal.name),
        (bodies.start, bodies.distal_markers, style.DISTAL, words.distal.name),
    ):
        shown += plot_body(ax, origin, markers, unit, look, word)
    equal_aspect(ax, np.concatenate(shown))
    label_space(ax, unit)
    return ax


def plot_path(ax: Axes3D, path: Float, unit: LengthUnit, label: str) -> None:
    """Draw the path (N, 3) of the distal body's origin, meters."""
    rows = drawn_rows(*path.T)
    ax.plot(*length_in(path[rows], unit).T, label=label, **style.PATH)


def plot_body(
    ax: Axes3D, origin: Float | None, markers: Float | None, unit: LengthUnit, look: dict[str, Any], word: str
) -> list[Float]:
    """Draw a body's origin (3,) and markers (M, 3), meters, and give the points (K, 3) as they stand in the figure."""
    shown = []
    if origin is not None:
        shown.append(length_in(origin[None], unit))
        ax.plot(*shown[-1].T, label=f"{word}: origin", **{**look, "markersize": 2.0 * look["markersize"]})
    if markers is not None:
        shown.append(length_in(markers, unit))
        ax.plot(*shown[-1].T, label=f"{word}: markers", **look)
    return shown


def plot_cone(ax: Axes3D, center: Float, direction: Float, along: Float, reach: Float, color: str, label: str) -> None:
    """Draw what surrounds an axis, `reach` (K,) from it at `along` (K,), by its rings and by lines from end to end.

    Where it would be hardly wider than the axis itself, or wider than the space, it is left to the panels that show it
    at a scale of its own.
    """
    if not _LEAST_SEEN <= reach.max() / np.ptp(along) <= _MOST_SEEN:
        return
    u, v = directions_across(direction)[0]
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND + 1)
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    surface = center + along[:, None, None] * direction + reach[:, None, None] * ring
    rings = [surface[0], surface[along.size // 2], surface[-1]]
    lines = list(surface[:, ::4].swapaxes(0, 1))
    for segments, name in ((rings, label), (lines, None)):  # each of one length, which older matplotlib wants
        ax.add_collection3d(Line3DCollection(segments, colors=color, linewidths=0.6, label=name))


def label_space(ax: Axes3D, unit: LengthUnit) -> None:
    """Write at the coordinates of a space what they are."""
    for name, label in (("x", ax.set_xlabel), ("y", ax.set_ylabel), ("z", ax.set_zlabel)):
        label(f"{name} ({unit})", labelpad=-2)


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
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=0.86)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_major_locator(MaxNLocator(4))
        axis.set_tick_params(pad=-1)
