"""The joint by its type: its axes or its center in both bodies, with what they are known to."""

from __future__ import annotations

from typing import Final, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Analysis
from elbowscrew.plots import style
from elbowscrew.plots.axis import IN_FRONT, equal_aspect, label_space, plot_body, plot_cone
from elbowscrew.plots.figures import NARROW_MM, WIDTH_MM
from elbowscrew.quantities import angle_in, length_in, rounded
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.joint_space import AxisInBody, JointInBody, joint_in_body
from elbowscrew.view.trial_view import TrialView

_KNOWN: Final = "95 % confidence"
_ALONG: Final = 41


def joint_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the joint's axes or center in both bodies, with what 95 % of their errors keep within."""
    view = view_of(analysis)
    seen = joint_in_body(view, "proximal"), joint_in_body(view, "distal")
    lower = 0 if not seen[0].axes and seen[0].center is None else 1 if len(seen[0].axes) == 1 else 2
    if width_mm < NARROW_MM:
        square = seen[0].center is not None
        each = 0.75 * width_mm if square else 42.0
        figure = style.new_figure(width_mm, 1.9 * width_mm + each * lower)
        grid = figure.add_gridspec(2 + lower, 1, height_ratios=[0.95 * width_mm] * 2 + [each] * lower)
        cells = [grid[k, 0] for k in range(2 + lower)]
    else:
        figure = style.new_figure(width_mm, 120.0 if lower else 80.0)
        grid = figure.add_gridspec(1 + (lower > 0), 2, height_ratios=[1.5, 1.0][: 1 + (lower > 0)])
        cells = [grid[0, 0], grid[0, 1], *([grid[1, :]] if lower == 1 else [grid[1, 0], grid[1, 1]] if lower else [])]
    spaces = [cast(Axes3D, figure.add_subplot(cell, projection="3d")) for cell in cells[:2]]
    for ax, body in zip(spaces, seen, strict=True):
        plot_joint_in_body(ax, view, body)
    panels = [figure.add_subplot(cell) for cell in cells[2:]]
    for k, ax in enumerate(panels):
        if seen[0].center is not None:
            plot_center(ax, view, seen[0], k)
        else:
            plot_axis_known(ax, view, seen[k], k)
    style.letter(*spaces, *panels)
    style.legend(figure, *panels, *spaces, below=True)
    return figure


def joint_text(analysis: Analysis | TrialView) -> str:
    """Say in a line which joint it is."""
    view = view_of(analysis)
    found, two = view.joint_summary["joint_type"], view.joint_summary["two_axes"]
    status = "" if found["status"] is None else f" ({'as stated' if found['status'] == 'forced' else found['status']})"
    told = f"Joint: {JOINT_TYPE_WORDS[found['type']]}{status}"
    if two is None or two["angle_between_deg"] is None:
        return told
    unit, length = view.settings.angle_unit, view.settings.length_unit
    if two["distance_mm"] is None:
        far = 0.001 * (two["parallel_offset_mm"] or 0.0)
        return f"{told}, parallel, {rounded(float(length_in(np.array(far), length)), 3)} {length} apart"
    angle = float(angle_in(np.radians(two["angle_between_deg"]), unit))
    distance = float(length_in(np.array(0.001 * abs(two["distance_mm"])), length))
    return f"{told}, {rounded(angle, 3)} {unit} and {rounded(distance, 3)} {length} apart"


def plot_joint_in_body(ax: Axes3D, analysis: Analysis | TrialView, body: JointInBody) -> Axes3D:
    """Draw the axes or the center as a body sees them at the reference, with both bodies' markers."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    half = body.half
    shown = []
    for k, axis in enumerate(body.axes):
        ends = length_in(axis.ends(half), unit)
        ax.plot(*ends.T, linewidth=1.5, zorder=IN_FRONT, label=_called(axis), **style.AXES[k])
        shown.append(ends)
        if axis.lines.size:
            pieces = [
                length_in(point + half * np.outer([-0.8, 0.8], direction), unit) for direction, point in axis.lines
            ]
            ax.add_collection3d(Line3DCollection(pieces, colors=style.AXES[k]["color"], linewidths=0.4))
            shown += pieces
        if axis.known is not None:
            along = np.linspace(-half, half, 9)
            reach = length_in(axis.known.reach(along), unit)
            where = length_in(axis.point, unit), axis.direction, length_in(along, unit)
            plot_cone(ax, *where, reach, style.BAND["edgecolor"], _KNOWN)
    if body.center is not None and body.semi_axes is not None:
        _plot_ellipsoid(ax, length_in(body.center, unit), length_in(body.semi_axes, unit))
        shown.append(length_in(body.center[None], unit))
    words = view.named_joint
    origins = np.zeros(3), body.other_origin
    clusters = body.markers, body.other_markers
    bodies = ((style.PROXIMAL, words.proximal.name), (style.DISTAL, words.distal.name))
    order = bodies if body.end == "proximal" else bodies[::-1]
    for (look, word), origin, markers in zip(order, origins, clusters, strict=True):
        shown += plot_body(ax, origin, markers, unit, look, word)
    equal_aspect(ax, np.concatenate(shown))
    label_space(ax, unit)
    ax.set_title(f"{body.word}'s frame", fontweight="normal", loc="center", y=1.06)  # clear of the box's corner
    return ax


def _plot_ellipsoid(ax: Axes3D, center: Float, semi_axes: Float) -> None:
    """Draw a center and the three ellipses along the semi-axes of what holds 95 % of it."""
    ax.plot(*center[None].T, "+", color=style.AXES[0]["color"], markersize=9, markeredgewidth=1.3, label="center")
    if np.isfinite(semi_axes).all():
        turn = np.linspace(0.0, 2.0 * np.pi, 49)[:, None]
        rings = [
            center + np.cos(turn) * semi_axes[k] + np.sin(turn) * semi_axes[j] for k, j in ((0, 1), (0, 2), (1, 2))
        ]
        ax.add_collection3d(Line3DCollection(rings, colors=style.BAND["edgecolor"], linewidths=0.6, label=_KNOWN))


def plot_axis_known(ax: Axes, analysis: Analysis | TrialView, body: JointInBody, number: int) -> Axes:
    """Draw along an axis what holds 95 % of it, enlarged across; of two axes each in the body it is fixed in."""
    view = view_of(analysis)
    unit, angle_unit = view.settings.length_unit, view.settings.angle_unit
    axis, half = body.axes[number], body.half
    along = np.linspace(-half, half, _ALONG)
    ax.plot(length_in(along[[0, -1]], unit), [0.0, 0.0], linewidth=1.3, **style.AXES[number])
    ax.set_xlabel(f"Along {'the ' if axis.name == 'axis' else ''}{_called(axis)},\n{body.word}'s frame ({unit})")
    ax.set_ylabel(f"Across ({unit})")
    if axis.known is None:
        text = "not determined"
        ax.set_ylim(-1.0, 1.0)
    else:
        reach = length_in(axis.known.reach(along), unit)
        ax.fill_between(length_in(along, unit), -reach, reach, label=_KNOWN, **style.BAND)
        ax.set_ylim(*(2.2 * float(reach.max()) * np.array([-1.0, 1.0])))
        text = (  # a line each, as small numbers are long
            f"95 %: {rounded(float(angle_in(np.array(axis.known.angle), angle_unit)), 2)} {angle_unit}\n"
            f"{rounded(float(length_in(np.array(axis.known.radius), unit)), 2)} {unit}"
        )
    ax.text(0.5, 0.97, text, transform=ax.transAxes, ha="center", va="top")
    ax.set_xlim(*length_in(along[[0, -1]], unit))
    return ax


def _called(axis: AxisInBody) -> str:
    return "joint axis" if axis.name == "axis" else axis.name


def plot_center(ax: Axes, analysis: Analysis | TrialView, body: JointInBody, side: int) -> Axes:
    """Draw the shadow of the center's 95 % ellipsoid, on the xy or the xz plane of the body."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    first, second = ((0, 1), (0, 2))[side]
    ax.plot(0.0, 0.0, "+", color=style.AXES[0]["color"], markersize=8, markeredgewidth=1.2, zorder=3)
    if body.semi_axes is not None and np.isfinite(body.semi_axes).all():
        shape = body.semi_axes.T @ body.semi_axes
        values, vectors = np.linalg.eigh(shape[np.ix_((first, second), (first, second))])
        turn = np.linspace(0.0, 2.0 * np.pi, 73)
        outline = length_in((vectors * np.sqrt(np.maximum(values, 0.0))) @ np.stack([np.cos(turn), np.sin(turn)]), unit)
        ax.fill(*outline, label=_KNOWN, **style.BAND)
        reach = 1.3 * float(np.abs(outline).max())
        ax.set_xlim(-reach, reach)
        ax.set_ylim(-reach, reach)
    ax.set_box_aspect(1.0)
    ax.xaxis.set_major_locator(MaxNLocator(3))
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.set_xlabel(f"{'xyz'[first]} from the center,\n{body.word}'s frame ({unit})")
    ax.set_ylabel(f"{'xyz'[second]} from the center ({unit})")
    return ax
