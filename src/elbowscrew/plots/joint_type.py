"""The joint by its type: its axes or its center in both bodies, its own angles, and an axis that wanders."""

from __future__ import annotations

from typing import Any, Final, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from elbowscrew.choices import JOINT_TYPE_WORDS
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import Analysis
from elbowscrew.model.joint_type import JointAngles
from elbowscrew.motion.difference import piercing
from elbowscrew.plots import style
from elbowscrew.plots.axis import equal_aspect
from elbowscrew.plots.figures import NARROW_MM, WIDTH_MM
from elbowscrew.plots.series import line, mark_tracking, over_time
from elbowscrew.quantities import angle_in, length_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.decimation import drawn_band, drawn_rows
from elbowscrew.view.joint_space import ANGLE_NAMES, AxisInBody, JointInBody, joint_in_body
from elbowscrew.view.scene import Region, directions_across
from elbowscrew.view.trial_view import TrialView

_LOOKS: Final[tuple[dict[str, Any], ...]] = (
    {"color": "#000000", "linestyle": "-"},
    {"color": "#0072B2", "linestyle": (0, (5, 2))},
    {"color": "#D55E00", "linestyle": (0, (1, 1.2))},
)
_BANDS: Final = ("#BBBBBB", "#9CC9E8", "#F3C09B")
_AROUND: Final = 24
_ALONG: Final = 41


def joint_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the joint's axes or center in both bodies, with what 95 % of their errors keep within."""
    view = view_of(analysis)
    narrow = width_mm < NARROW_MM
    seen = joint_in_body(view, "proximal"), joint_in_body(view, "distal")
    lower = 0 if not seen[0].axes and seen[0].center is None else 1 if len(seen[0].axes) == 1 else 2
    if narrow:
        figure = style.new_figure(width_mm, 150.0 + 55.0 * lower)
        grid = figure.add_gridspec(2 + lower, 1, height_ratios=[1.4, 1.4, *[1.0] * lower])
        cells = [grid[k, 0] for k in range(2 + lower)]
    else:
        figure = style.new_figure(width_mm, 125.0 if lower else 85.0)
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
    for ax, letter in zip([*spaces, *panels], "abcd", strict=False):
        ax.set_title(letter, loc="left")
    figure.suptitle(joint_text(view), fontsize=8.0)
    keys: dict[str, Any] = {}
    for ax in (*spaces, *panels):
        keys |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    figure.legend(keys.values(), keys.keys(), loc="outside lower center", ncols=2 if narrow else 4, handlelength=1.8)
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
        return f"{told}, parallel, {float(length_in(np.array(far), length)):.3g} {length} apart"
    angle = float(angle_in(np.radians(two["angle_between_deg"]), unit))
    distance = float(length_in(np.array(0.001 * abs(two["distance_mm"])), length))
    return f"{told}, {angle:.3g} {unit} and {distance:.3g} {length} apart"


def plot_joint_in_body(ax: Axes3D, analysis: Analysis | TrialView, body: JointInBody) -> Axes3D:
    """Draw the axes or the center as a body sees them at the reference, with both bodies' markers."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    shown = [length_in(body.points, unit)]
    half = body.half
    for k, axis in enumerate(body.axes):
        ends = length_in(axis.ends(half), unit)
        ax.plot(*ends.T, linewidth=1.5, label=axis.name, **_LOOKS[k])
        shown.append(ends)
        if axis.lines.size:
            pieces = [
                length_in(point + half * np.outer([-0.8, 0.8], direction), unit) for direction, point in axis.lines
            ]
            ax.add_collection3d(Line3DCollection(pieces, colors=_LOOKS[k]["color"], linewidths=0.5, alpha=0.45))
            shown += pieces
        if axis.known is not None:
            _plot_cone(ax, axis, axis.known, half, unit, _BANDS[k])
    if body.center is not None and body.semi_axes is not None:
        _plot_ellipsoid(ax, length_in(body.center, unit), length_in(body.semi_axes, unit))
    origins = ((np.zeros(3), "^", "#333333"), (body.other_origin, "v", "#999999"))
    for (origin, mark, color), of in zip(origins, ("this body", "other body"), strict=True):
        ax.plot(*length_in(origin[None], unit).T, mark, color=color, markersize=5, label=f"{of}: origin")
    for markers, face, of in ((body.markers, "#333333", "this body"), (body.other_markers, "white", "other body")):
        if markers is not None:
            look = {"color": "#555555", "markerfacecolor": face, "markersize": 3.5, "markeredgewidth": 0.7}
            ax.plot(*length_in(markers, unit).T, "o", label=f"{of}: markers", **look)
    equal_aspect(ax, np.concatenate(shown))
    for name, label in (("x", ax.set_xlabel), ("y", ax.set_ylabel), ("z", ax.set_zlabel)):
        label(f"{name} ({unit})", labelpad=-2)
    ax.text2D(0.5, 1.0, f"seen from the {body.word}", transform=ax.transAxes, ha="center", va="bottom")
    return ax


def _plot_cone(ax: Axes3D, axis: AxisInBody, known: Region, half: float, unit: Any, color: str) -> None:
    u, v = directions_across(axis.direction)[0]
    along = np.linspace(-half, half, 9)
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND)
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    surface = axis.point + along[:, None, None] * axis.direction + known.reach(along)[:, None, None] * ring
    ax.plot_surface(*np.moveaxis(length_in(surface, unit), 2, 0), color=color, alpha=0.45, linewidth=0.0)


def _plot_ellipsoid(ax: Axes3D, center: Float, semi_axes: Float) -> None:
    ax.plot(*center[None].T, "+", color="black", markersize=9, markeredgewidth=1.3, label="center")
    if not np.isfinite(semi_axes).all():
        return
    polar, turn = np.meshgrid(np.linspace(0.0, np.pi, 13), np.linspace(0.0, 2.0 * np.pi, _AROUND), indexing="ij")
    ball = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=2)
    ax.plot_surface(*np.moveaxis(center + ball @ semi_axes, 2, 0), color=_BANDS[2], alpha=0.5, linewidth=0.0)


def plot_axis_known(ax: Axes, analysis: Analysis | TrialView, body: JointInBody, number: int) -> Axes:
    """Draw along an axis what holds 95 % of it, enlarged across; of two axes each in the body it is fixed in."""
    view = view_of(analysis)
    unit, angle_unit = view.settings.length_unit, view.settings.angle_unit
    axis, half = body.axes[number], body.half
    along = np.linspace(-half, half, _ALONG)
    ax.plot(length_in(along[[0, -1]], unit), [0.0, 0.0], linewidth=1.3, **_LOOKS[number])
    ax.set_xlabel(f"Along {_the(axis)} in the {body.word} ({unit})")
    ax.set_ylabel(f"Across ({unit})")
    if axis.known is None:
        text = "not determined"
        ax.set_ylim(-1.0, 1.0)
    else:
        reach = length_in(axis.known.reach(along), unit)
        edge: dict[str, Any] = {"facecolor": _BANDS[number], "edgecolor": "#666666", "linewidth": 0.6}
        ax.fill_between(length_in(along, unit), -reach, reach, label=f"95 % of {_the(axis)}", **edge)
        ax.set_ylim(*(1.7 * float(reach.max()) * np.array([-1.0, 1.0])))
        text = (
            f"95 %: {float(angle_in(np.array(axis.known.angle), angle_unit)):.2g} {angle_unit}, "
            f"{float(length_in(np.array(axis.known.radius), unit)):.2g} {unit}"
        )
    ax.text(0.5, 0.97, text, transform=ax.transAxes, ha="center", va="top")
    ax.set_xlim(*length_in(along[[0, -1]], unit))
    return ax


def _the(axis: AxisInBody) -> str:
    return "the axis" if axis.name == "axis" else axis.name


def plot_center(ax: Axes, analysis: Analysis | TrialView, body: JointInBody, side: int) -> Axes:
    """Draw the shadow of the center's 95 % ellipsoid, on the xy or the xz plane of the body."""
    view = view_of(analysis)
    unit = view.settings.length_unit
    first, second = ((0, 1), (0, 2))[side]
    ax.plot(0.0, 0.0, "+", color="black", markersize=8, markeredgewidth=1.2)
    if body.semi_axes is not None and np.isfinite(body.semi_axes).all():
        shape = body.semi_axes.T @ body.semi_axes
        values, vectors = np.linalg.eigh(shape[np.ix_((first, second), (first, second))])
        turn = np.linspace(0.0, 2.0 * np.pi, 73)
        outline = length_in((vectors * np.sqrt(np.maximum(values, 0.0))) @ np.stack([np.cos(turn), np.sin(turn)]), unit)
        ax.fill(*outline, facecolor=_BANDS[2], edgecolor="#666666", linewidth=0.6, label="95 % of the center")
        reach = 1.3 * float(np.abs(outline).max())
        ax.set_xlim(-reach, reach)
        ax.set_ylim(-reach, reach)
    ax.set_box_aspect(1.0)
    ax.xaxis.set_major_locator(MaxNLocator(3))
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.set_xlabel(f"{'xyz'[first]} from the center, {body.word} ({unit})")
    ax.set_ylabel(f"{'xyz'[second]} ({unit})")
    return ax


def joint_angles_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of the joint's own angles over time, of two against each other, and of what is left."""
    view, angles = _with_angles(analysis)
    narrow, both, three = width_mm < NARROW_MM, angles.angle.shape[1] == 2, angles.angle.shape[1] == 3
    if narrow:
        figure = style.new_figure(width_mm, 190.0 if both else 130.0)
        grid = figure.add_gridspec(3 if both else 2, 1, height_ratios=[1.0, 0.8, 1.2][: 3 if both else 2])
        cells = [grid[k, 0] for k in range(3 if both else 2)]
    else:
        figure = style.new_figure(width_mm, 95.0)
        grid = figure.add_gridspec(2, 2 if both else 1, width_ratios=[1.6, 1.0] if both else None)
        cells = [grid[0, 0], grid[1, 0], *([grid[:, 1]] if both else [])]
    panels = [figure.add_subplot(cell) for cell in cells]
    plot_joint_angles(panels[0], view).set_xlabel("")
    plot_joint_residual(panels[1], view)
    if both:
        plot_angles_together(panels[2], view)
    for ax, letter in zip(panels, "abc", strict=False):
        ax.set_title(letter, loc="left")
    keys: dict[str, Any] = {}
    for ax in panels[:2]:
        keys |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    figure.legend(
        keys.values(),
        keys.keys(),
        loc="outside upper center",
        ncols=(1 if narrow else 3) if three else 2 if narrow else 4,
    )
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
    for k, name in enumerate(names):
        values, reach = angle_in(angles.angle[:, k], unit), angle_in(NORMAL_95 * angles.angle_sd[:, k], unit)
        if np.isfinite(reach).any():
            rows, low, high = drawn_band(values - reach, values + reach)
            ax.fill_between(angles.time_s[rows], low, high, color=_BANDS[k], linewidth=0.0, zorder=1)
        told = f" (95 %: ±{np.nanmedian(reach):.2g} {unit})" if np.isfinite(reach).any() else ""
        line(ax, angles.time_s, values, label=name + told, linewidth=1.2, zorder=2, **_LOOKS[k])
    mark_tracking(ax, view)
    ax.set_ylabel(f"{names[0] if len(names) == 1 else 'Angles'} ({unit})")
    return over_time(ax, angles.time_s)


def plot_joint_residual(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw what the joint leaves of each pose, rotation and position, over time."""
    view, angles = _with_angles(analysis)
    settings = view.settings
    rotation = angle_in(angles.residual_rotation, settings.angle_unit)
    translation = length_in(angles.residual_translation, settings.length_unit)
    line(ax, angles.time_s, rotation, label="residual rotation", color="#000000", linewidth=0.8)
    ax.set_ylabel(f"Residual rotation ({settings.angle_unit})")
    ax.set_ylim(0.0, 1.08 * _largest(rotation))
    beside = ax.twinx()
    beside.spines["right"].set_visible(True)
    line(beside, angles.time_s, translation, label="", color="#D55E00", linewidth=0.8, linestyle=(0, (3, 1)))
    beside.set_ylabel(f"Residual position ({settings.length_unit})")
    beside.set_ylim(0.0, 1.08 * _largest(translation))
    ax.plot([], [], label="residual position", color="#D55E00", linewidth=0.8, linestyle=(0, (3, 1)))
    mark_tracking(ax, view)
    return over_time(ax, angles.time_s)


def _largest(values: Float) -> float:
    found = float(np.nanmax(values, initial=0.0)) if np.isfinite(values).any() else 0.0
    return found if found > 0.0 else 1.0


def plot_angles_together(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the second angle against the first."""
    view, angles = _with_angles(analysis)
    unit = view.settings.angle_unit
    rows = drawn_rows(*angles.angle.T)
    first, second = angle_in(angles.angle[rows], unit).T
    ax.plot(first, second, color="#000000", linewidth=0.9)
    start = np.flatnonzero(np.isfinite(first) & np.isfinite(second))[:1]
    ax.plot(first[start], second[start], **style.KEYFRAME)
    ax.annotate(
        "start", (float(first[start][0]), float(second[start][0])), xytext=(5.0, 5.0), textcoords="offset points"
    )
    names = ANGLE_NAMES[2]
    ax.set_xlabel(f"{names[0]} ({unit})")
    ax.set_ylabel(f"{names[1]} ({unit})")
    return ax


def axis_path_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of an axis that wanders: its tilt and its shift from the mean axis against the angle."""
    view = view_of(analysis)
    path = view.axis_path
    if path is None:
        msg = "no wander of this joint's axis was found"
        raise ValueError(msg)
    narrow = width_mm < NARROW_MM
    figure = style.new_figure(width_mm, 120.0 if narrow else 75.0)
    panels = [figure.add_subplot(2, 1, k) if narrow else figure.add_subplot(1, 2, k) for k in (1, 2)]
    direction = view.joint_direction
    across, toward = directions_across(direction)
    settings, frame = view.settings, view.settings.express_in
    angle = angle_in(path.angle, settings.angle_unit)
    offset = piercing(path.direction, path.point, direction, view.joint_point) - view.joint_point
    for k, (u, name) in enumerate(zip(across, toward, strict=True)):
        tilt = angle_in(np.arctan2(path.direction @ u, path.direction @ direction), settings.angle_unit)
        shift = length_in(offset @ u, settings.length_unit)
        for ax, values, sd in (
            (panels[0], tilt, angle_in(path.axis_sd, settings.angle_unit)),
            (panels[1], shift, length_in(path.point_sd, settings.length_unit)),
        ):
            reach = NORMAL_95 * sd / np.sqrt(2.0)  # of one component
            if np.isfinite(reach).any():
                ax.fill_between(angle, values - reach, values + reach, color=_BANDS[k], linewidth=0.0, alpha=0.7)
            ax.plot(angle, values, label=f"toward {name}", linewidth=1.3, marker="o", markersize=2.5, **_LOOKS[k])
    panels[0].set_ylabel(f"Tilt from the mean axis ({settings.angle_unit})")
    panels[1].set_ylabel(f"Shift from the mean axis ({settings.length_unit})")
    for ax, letter in zip(panels, "ab", strict=True):
        ax.axhline(0.0, **style.LEVEL)
        ax.set_xlabel(f"Angle ({settings.angle_unit})")
        ax.set_title(letter, loc="left")
    split = "\n" if narrow else " "
    figure.suptitle(f"The joint's axis against its angle, {frame} frame{split}(bands: 95 % of each)", fontsize=8.0)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure
