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
from elbowscrew.plots.axis import color_scale, equal_aspect, plot_path
from elbowscrew.plots.style import CONFIDENCE, SPREAD
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.scene import Bundle, Region, bodies_in_space, directions_across, joint_bundle
from elbowscrew.view.trial_view import TrialView

_AROUND: Final = 24
_ALONG_IN_SPACE: Final = 13
_ALONG: Final = 41


def plot_joint_axis_in_space(ax: Axes3D, analysis: Analysis | TrialView) -> Axes3D:
    """Draw the axes of the frames, the joint's axis, and the cones that hold 95 %."""
    view = view_of(analysis)
    bundle = _bundle(view)
    unit = view.settings.length_unit
    colors = color_scale(view).to_rgba(angle_in(view.angle[bundle.rows], view.settings.angle_unit))
    ax.add_collection3d(Line3DCollection(list(bundle.segments), colors=colors, linewidths=0.6, alpha=0.8))
    ends = _ends(bundle)
    ax.plot(*ends.T, color="black", linewidth=1.6, label=bundle.name)
    u, v = directions_across(bundle.direction)[0]
    along = np.linspace(-bundle.half, bundle.half, _ALONG_IN_SPACE)
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND)
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    for region, look in _regions(bundle):
        surface = bundle.center + along[:, None, None] * bundle.direction + region.reach(along)[:, None, None] * ring
        ax.plot_surface(
            *np.moveaxis(surface, 2, 0), color=look.get("color", look.get("facecolor")), alpha=0.25, linewidth=0.0
        )
    bodies = bodies_in_space(view)
    plot_path(ax, bodies.path, unit, f"{view.named_joint.distal.name} path")
    equal_aspect(ax, np.concatenate([ends, length_in(bodies.corners, unit)]))
    for name, label in (("x", ax.set_xlabel), ("y", ax.set_ylabel), ("z", ax.set_zlabel)):
        label(f"{name} ({unit})", labelpad=-2)
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
    for region, look in _regions(bundle):
        reach = region.reach(along)
        ax.fill_between(along, -reach, reach, **look)
    ax.plot([-bundle.half, bundle.half], [0.0, 0.0], color="black", linewidth=1.3, zorder=4, label=bundle.name)
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
    for region, look in _regions(bundle):
        ax.add_patch(Circle((0.0, 0.0), region.radius, **look))
    ax.plot(0.0, 0.0, "+", color="black", markersize=8, markeredgewidth=1.2, zorder=4)
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
    return f"{model}; 95 % confidence: {angle:.2g} {view.settings.angle_unit}, {radius:.2g} {view.settings.length_unit}"


def _bundle(view: TrialView) -> Bundle:
    """Gather what is drawn, in the figures' unit of length."""
    return joint_bundle(view).scaled(float(length_in(np.array(1.0), view.settings.length_unit)))


def _regions(bundle: Bundle) -> list[tuple[Region, dict[str, Any]]]:
    looks: dict[str, dict[str, Any]] = {"spread": SPREAD, "confidence": CONFIDENCE}
    return [(region, looks[name]) for name, region in bundle.regions.items()]


def _ends(bundle: Bundle) -> Float:
    return bundle.center + bundle.half * np.outer([-1.0, 1.0], bundle.direction)
