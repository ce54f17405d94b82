"""The joint's axis with what it is known to, among the axes of the frames: in space and in three projections."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Analysis
from elbowscrew.plots import style
from elbowscrew.plots.axis import IN_FRONT, color_scale, equal_aspect, label_space, plot_cone, plot_path
from elbowscrew.quantities import angle_in, length_in, rounded
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.scene import Bundle, Region, bodies_in_space, directions_across, joint_bundle
from elbowscrew.view.trial_view import TrialView

_ALONG_IN_SPACE: Final = 13
_ALONG: Final = 41


def plot_joint_axis_in_space(ax: Axes3D, analysis: Analysis | TrialView) -> Axes3D:
    """Draw the axes of the frames, the joint's axis, and the cones that hold 95 %."""
    view = view_of(analysis)
    bundle = _bundle(view)
    unit = view.settings.length_unit
    colors = color_scale(view).to_rgba(angle_in(view.angle[bundle.rows], view.settings.angle_unit))
    ax.add_collection3d(Line3DCollection(list(bundle.segments), colors=colors, linewidths=0.6))
    ends = _ends(bundle)
    ax.plot(*ends.T, linewidth=1.6, zorder=IN_FRONT, label=bundle.name, **style.AXES[0])
    along = np.linspace(-bundle.half, bundle.half, _ALONG_IN_SPACE)
    for region, label, look in _regions(bundle, bundle.half):
        plot_cone(ax, bundle.center, bundle.direction, along, region.reach(along), look["edgecolor"], label)
    bodies = bodies_in_space(view)
    plot_path(ax, bodies.path, unit, f"{view.named_joint.distal.name} path")
    equal_aspect(ax, np.concatenate([ends, bundle.segments.reshape(-1, 3), length_in(bodies.corners, unit)]))
    label_space(ax, unit)
    return ax


def plot_axis_from_the_side(ax: Axes, analysis: Analysis | TrialView, side: int) -> Axes:
    """Draw the axes and the bands that hold 95 % along the joint's axis, what lies across it enlarged.

    `side` is 0 or 1: across to which of the two directions.
    """
    view = view_of(analysis)
    bundle = _bundle(view)
    unit = view.settings.length_unit
    directions, names = directions_across(bundle.direction)
    offset = bundle.segments - bundle.center
    _add_segments(ax, view, bundle, np.stack([offset @ bundle.direction, offset @ directions[side]], axis=2))
    along = np.linspace(-bundle.half, bundle.half, _ALONG)
    for region, label, look in _regions(bundle, bundle.half):
        reach = region.reach(along)
        ax.fill_between(along, -reach, reach, label=label, **look)
    ax.plot([-bundle.half, bundle.half], [0.0, 0.0], linewidth=1.3, zorder=4, label=bundle.name, **style.AXES[0])
    ax.set_xlim(-bundle.half, bundle.half)
    reach_of_view = 1.25 * bundle.reach_across(np.inf)
    ax.set_ylim(-reach_of_view, reach_of_view)
    ax.set_xlabel(f"Along the {bundle.name} ({unit})")
    ax.set_ylabel(f"Across, toward {names[side]} ({unit})")
    return ax


def plot_axis_end_on(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the axes as seen along the joint's axis, with the circles that hold 95 % at the distal body."""
    view = view_of(analysis)
    bundle = _bundle(view)
    unit = view.settings.length_unit
    directions, names = directions_across(bundle.direction)
    offset = bundle.segments - bundle.center
    _add_segments(ax, view, bundle, np.stack([offset @ direction for direction in directions], axis=2))
    for region, _, look in _regions(bundle, 0.0):
        ax.add_patch(Circle((0.0, 0.0), region.radius, **look))
    ax.plot(0.0, 0.0, "+", color=style.AXES[0]["color"], markersize=8, markeredgewidth=1.2, zorder=4)
    reach = 1.25 * bundle.reach_across(np.inf)
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    ax.set_box_aspect(1.0)
    ax.set_xlabel(f"Across, toward {names[0]} ({unit})")
    ax.set_ylabel(f"Across, toward {names[1]} ({unit})")
    return ax


def _add_segments(ax: Axes, view: TrialView, bundle: Bundle, segments: Float) -> None:
    angle = angle_in(view.angle[bundle.rows], view.settings.angle_unit)
    colors = color_scale(view).to_rgba(angle)
    ax.add_collection(LineCollection(list(segments), colors=colors, linewidths=0.7, zorder=2))


def confidence_text(view: TrialView) -> str:
    """Say in a line what the joint's axis is known to."""
    if view.confidence95 is None:
        return "the motion has no single axis: weighted mean of the frames' axes"
    model = str(view.joint_summary["preferred"]).replace("_", "-")
    cone, circle = view.confidence95
    if not np.isfinite(cone):
        return f"{model}; its confidence is not known"
    angle = angle_in(np.array(cone), view.settings.angle_unit)
    radius = length_in(np.array(circle), view.settings.length_unit)
    units = view.settings.angle_unit, view.settings.length_unit
    known = [f"{rounded(float(value))} {unit}" for value, unit in zip((angle, radius), units, strict=True)]
    return f"{model}; 95 % confidence: {', '.join(known)}"


def _bundle(view: TrialView) -> Bundle:
    """Gather what is drawn, in the figures' unit of length."""
    return joint_bundle(view).scaled(float(length_in(np.array(1.0), view.settings.length_unit)))


def _regions(bundle: Bundle, along: float) -> list[tuple[Region, str, dict[str, Any]]]:
    """What is drawn about the axis, the one that is wider so far along it behind the other."""
    told = {
        "spread": ("95 % of the frames' axes", style.SPREAD),
        "confidence": ("95 % confidence of the joint axis", style.BAND),
    }
    widest_first = sorted(bundle.regions.items(), key=lambda item: -float(item[1].reach(np.array(along))))
    return [
        (region, told[name][0], {**told[name][1], "zorder": 1.0 + 0.5 * k})
        for k, (name, region) in enumerate(widest_first)
    ]


def _ends(bundle: Bundle) -> Float:
    return bundle.center + bundle.half * np.outer([-1.0, 1.0], bundle.direction)
