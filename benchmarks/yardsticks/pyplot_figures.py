"""The five figures of a result in pyplot, drawn as one does by hand: all points, constrained layout, 300 dpi."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl

mpl.use("agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.patches import Circle
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float

MM = 1.0 / 25.4
AXES_SHOWN = 60
POINTS_SHOWN = 4000
LOOK: dict[Any, Any] = {
    "font.size": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "savefig.dpi": 300,
}


class Drawn(NamedTuple):
    """What the figures show, in degrees and millimeters: series of N frames, keyframes as rows, a mean line."""

    time_s: Float
    angle: Float
    angle_sd: Float
    model_angle: Float
    euler: Float
    model_euler: Float
    angle_error: Float
    displacement: Float
    direction: Float
    point: Float
    path: Float
    keyframes: NDArray[np.int64]
    mean_direction: Float
    mean_point: Float


def draw_all(drawn: Drawn, folder: Path) -> None:
    """Save the five figures as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    with plt.rc_context(LOOK):
        for name, draw in (
            ("theta", theta),
            ("euler_parameters", euler_parameters),
            ("axis", axis),
            ("joint_axis", joint_axis),
            ("error", error),
        ):
            figure = draw(drawn)
            figure.savefig(folder / f"{name}.png")
            plt.close(figure)


def theta(drawn: Drawn) -> Any:
    figure, ax = plt.subplots(figsize=(170 * MM, 80 * MM), layout="constrained")
    t, reach = drawn.time_s, 1.96 * drawn.angle_sd
    ax.fill_between(t, drawn.angle - reach, drawn.angle + reach, color="0.7", label="95 % interval")
    ax.plot(t, drawn.angle, "k-", label="measured")
    ax.plot(t, drawn.model_angle, "--", color="#D55E00", label="DLB")
    ax.plot(t[drawn.keyframes], drawn.angle[drawn.keyframes], "o", color="#0072B2", label="keyframes")
    for first, last in zip(drawn.keyframes[:-1:2], drawn.keyframes[1::2], strict=False):
        ax.axvspan(t[first], t[last], color="#E6EFF8", zorder=-1)
    ax.set_xlabel("Time (s)")
    ax.set_ylabel("Angle θ (deg)")
    figure.legend(loc="outside upper center", ncols=4)
    return figure


def euler_parameters(drawn: Drawn) -> Any:
    figure, axes = plt.subplots(2, 2, figsize=(170 * MM, 105 * MM), sharex=True, layout="constrained")
    for k, ax in enumerate(axes.ravel()):
        ax.plot(drawn.time_s, drawn.euler[:, k], "k-", label="measured")
        ax.plot(drawn.time_s, drawn.model_euler[:, k], "--", color="#D55E00", label="DLB")
        ax.plot(drawn.time_s[drawn.keyframes], drawn.euler[drawn.keyframes, k], "o", color="#0072B2", label="keyframes")
        ax.set_ylabel(f"e{k} (–)")
    for ax in axes[1]:
        ax.set_xlabel("Time (s)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def axis(drawn: Drawn) -> Any:
    figure = plt.figure(figsize=(170 * MM, 84 * MM), layout="constrained")
    grid = figure.add_gridspec(2, 3, width_ratios=[1.3, 1.0, 1.0], height_ratios=[1.0, 0.04])
    space = figure.add_subplot(grid[:, 0], projection="3d")
    rows, half, center = _shown(drawn)
    across = _across(drawn.mean_direction)
    colors = plt.get_cmap("viridis")(Normalize()(drawn.angle[rows]))
    for row, color in zip(rows, colors, strict=True):
        space.plot(*_piece(drawn, row, center, half).T, color=color, linewidth=0.7)
    space.plot(*_line(drawn.mean_direction, center, 1.3 * half).T, "k-", label="mean axis")
    space.plot(*drawn.path.T, color="#D55E00", label="forearm path")
    _label_space(space)
    space.legend(loc="upper center", bbox_to_anchor=(0.5, -0.05), ncols=2)
    some = np.flatnonzero(np.isfinite(drawn.direction[:, 0]))
    some = some[np.linspace(0, some.size - 1, min(some.size, POINTS_SHOWN)).astype(int)]
    along = drawn.direction[some] @ drawn.mean_direction
    tilts = [np.degrees(np.arctan2(drawn.direction[some] @ one, along)) for one in across]
    reach = ((center - drawn.point[some]) @ drawn.mean_direction) / along
    pierced = drawn.point[some] + reach[:, None] * drawn.direction[some]
    places = [(pierced - center) @ one for one in across]
    for k, (values, name) in enumerate(((tilts, "Tilt ({} deg)"), (places, "Place ({} mm)"))):
        ax = figure.add_subplot(grid[0, 1 + k])
        ax.axhline(0.0, color="0.4", linestyle=":")
        ax.axvline(0.0, color="0.4", linestyle=":")
        points = ax.scatter(values[0], values[1], c=drawn.angle[some], s=7, linewidths=0)
        ax.plot(0.0, 0.0, "k+")
        ax.set_box_aspect(1.0)
        ax.set_xlabel(name.format("y,"))
        ax.set_ylabel(name.format("z,"))
    figure.colorbar(points, cax=figure.add_subplot(grid[1, 1:]), orientation="horizontal", label="Angle θ (deg)")
    return figure


def joint_axis(drawn: Drawn) -> Any:
    figure = plt.figure(figsize=(170 * MM, 140 * MM), layout="constrained")
    grid = figure.add_gridspec(3, 2, height_ratios=[1.0, 0.75, 0.04])
    space = figure.add_subplot(grid[0, 0], projection="3d")
    rows, half, center = _shown(drawn)
    n = drawn.mean_direction
    u, v = _across(n)
    scale = ScalarMappable(Normalize(np.nanmin(drawn.angle), np.nanmax(drawn.angle)), "viridis")
    colors = scale.to_rgba(drawn.angle[rows])
    pieces = np.array([_piece(drawn, row, center, half) for row in rows])
    for piece, color in zip(pieces, colors, strict=True):
        space.plot(*piece.T, color=color, linewidth=0.6)
    space.plot(*_line(n, center, half).T, "k-")
    along, turn = np.linspace(-half, half, 13), np.linspace(0.0, 2.0 * np.pi, 24)
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    for radius in (1.2, 0.1):
        reach = np.hypot(radius, 0.01 * along)
        surface = center + along[:, None, None] * n + reach[:, None, None] * ring
        space.plot_surface(*np.moveaxis(surface, 2, 0), alpha=0.25, linewidth=0.0)
    space.plot(*drawn.path.T, color="#D55E00")
    _label_space(space)
    offset = pieces - center
    views = ((offset @ u, offset @ v), (offset @ n, offset @ u), (offset @ n, offset @ v))
    fine = np.linspace(-half, half, 41)
    for k, ((x, y), cell) in enumerate(zip(views, (grid[0, 1], grid[1, 0], grid[1, 1]), strict=True)):
        ax = figure.add_subplot(cell)
        for a, b, color in zip(x, y, colors, strict=True):
            ax.plot(a, b, color=color, linewidth=0.7)
        if k == 0:
            for radius in (1.2, 0.1):
                ax.add_patch(Circle((0.0, 0.0), radius, alpha=0.3))
            ax.set_box_aspect(1.0)
        else:
            for radius in (1.2, 0.1):
                ax.fill_between(fine, -np.hypot(radius, 0.01 * fine), np.hypot(radius, 0.01 * fine), alpha=0.3)
            ax.plot([-half, half], [0.0, 0.0], "k-", label="joint axis")
        ax.set_xlabel("Across (mm)" if k == 0 else "Along the joint axis (mm)")
        ax.set_ylabel("Across (mm)")
    figure.colorbar(scale, cax=figure.add_subplot(grid[2, :]), orientation="horizontal", label="Angle θ (deg)")
    figure.suptitle("Joint axis")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def error(drawn: Drawn) -> Any:
    figure, axes = plt.subplots(2, 1, figsize=(170 * MM, 100 * MM), sharex=True, layout="constrained")
    for ax, values, name in zip(
        axes, (drawn.angle_error, drawn.displacement), ("Angle error (deg)", "RMS displacement (mm)"), strict=True
    ):
        level = float(np.sqrt(np.nanmean(values**2)))
        ax.plot(drawn.time_s, values, "k-", label="model against measurement")
        ax.plot(drawn.time_s[drawn.keyframes], values[drawn.keyframes], "o", color="#0072B2", label="keyframes")
        ax.axhline(level, color="0.4", linestyle=":")
        ax.annotate(f"RMS {level:.3g}", (1.0, level), xycoords=ax.get_yaxis_transform(), ha="right", va="bottom")
        ax.set_ylabel(name)
    axes[1].set_xlabel("Time (s)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _shown(drawn: Drawn) -> tuple[NDArray[np.int64], float, Float]:
    known = np.flatnonzero(np.isfinite(drawn.direction[:, 0]))
    rows = known[np.linspace(0, known.size - 1, min(known.size, AXES_SHOWN)).astype(int)]
    middle = np.nanmean(drawn.path, axis=0)
    center = drawn.mean_point + ((middle - drawn.mean_point) @ drawn.mean_direction) * drawn.mean_direction
    return rows, 0.55 * float(np.nanmax(np.nanmax(drawn.path, axis=0) - np.nanmin(drawn.path, axis=0))), center


def _piece(drawn: Drawn, row: int, center: Float, half: float) -> Float:
    direction, point = drawn.direction[row], drawn.point[row]
    return _line(direction, point + ((center - point) @ direction) * direction, half)


def _line(direction: Float, center: Float, half: float) -> Float:
    return center + half * np.outer([-1.0, 1.0], direction)


def _across(n: Float) -> tuple[Float, Float]:
    u = np.eye(3)[np.argmin(np.abs(n))] - n[np.argmin(np.abs(n))] * n
    u /= np.linalg.norm(u)
    return u, np.cross(n, u)


def _label_space(ax: Any) -> None:
    ax.set_xlabel("x (mm)")
    ax.set_ylabel("y (mm)")
    ax.set_zlabel("z (mm)")
    ax.set_aspect("equal")
