"""Quality of a recording over time: what was lost and why, how well θ is known, and what the joint leaves."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from elbowscrew.geometry.arrays import Bool
from elbowscrew.model import Analysis
from elbowscrew.motion.movements.phases import runs_of
from elbowscrew.plots import style
from elbowscrew.plots.figures import WIDTH_MM
from elbowscrew.plots.joint_angles import plot_residual_rotation, plot_residual_translation, span_of_frames
from elbowscrew.plots.series import mark_tracking, over_time
from elbowscrew.quantities import angle_in
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.trial_view import TrialView

_ROW_MM: Final = 8.0  # two lines of words
_LOST: Final = "#B5533C"


def quality_figure(analysis: Analysis | TrialView, *, width_mm: float = WIDTH_MM) -> Figure:
    """Make the figure of what was lost, of θ's standard deviation and of what the joint leaves, over time."""
    view = view_of(analysis)
    rows = _losses(view)
    draw = [plot_losses, *([plot_angle_sd] if np.isfinite(view.angle_sd).any() else [])]
    draw += [] if view.joint_angles is None else [plot_residual_rotation]
    draw += [] if view.joint_angles is None or not view.located else [plot_residual_translation]
    heights = [10.0 + _ROW_MM * len(rows), *[36.0] * (len(draw) - 1)]
    figure = style.new_figure(width_mm, sum(heights) + 10.0)
    panels = figure.subplots(len(draw), 1, sharex=True, squeeze=False, height_ratios=heights).ravel()
    for ax, plot in zip(panels, draw, strict=True):
        plot(ax, view)
    for ax in panels[:-1]:
        ax.set_xlabel("")
    style.letter(*panels)
    style.legend(figure, *panels)
    return figure


def plot_losses(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw when each body had no measured pose, a row a reason, and when short gaps were filled in."""
    view = view_of(analysis)
    rows, half = _losses(view), 0.5 / view.rate_hz
    for k, mask in enumerate(rows.values()):
        first, last = runs_of(mask)
        corners = [
            [(a, k - 0.35), (a, k + 0.35), (b, k + 0.35), (b, k - 0.35)]
            for a, b in zip((view.time_s[first] - half).tolist(), (view.time_s[last] + half).tolist(), strict=True)
        ]
        ax.add_collection(PolyCollection(corners, facecolor=_LOST, edgecolor=_LOST, linewidth=0.3), autolim=False)
    ax.set_yticks(range(len(rows)), [name.replace(": ", ":\n") for name in rows])
    ax.set_ylim(len(rows) - 0.4, -0.6)
    return over_time(ax, view.time_s)


def plot_angle_sd(ax: Axes, analysis: Analysis | TrialView) -> Axes:
    """Draw the standard deviation of θ by the noise of the poses, over time."""
    view = view_of(analysis)
    unit = view.settings.angle_unit
    mark_tracking(span_of_frames(ax, view, angle_in(view.angle_sd, unit)), view)
    ax.set_ylabel(f"SD of θ\n({unit})")
    return over_time(ax, view.time_s)


def _losses(view: TrialView) -> dict[str, Bool]:
    """When each body was lost for each reason, and what was filled in; of a body that never was, a row of none."""
    words = view.named_joint
    found: dict[str, Bool] = {}
    bodies = [("distal_loss", words.distal.name)]
    if view.proximal_name is not None:
        bodies.insert(0, ("proximal_loss", words.proximal.name))
    for name, word in bodies:
        reasons = view.extra["losses"][name]
        present = [str(reason) for reason in np.unique(reasons) if reason]
        found |= {f"{word}: {reason}": reasons == reason for reason in present} or {
            f"{word}: none lost": np.zeros(reasons.size, dtype=bool)
        }
    return found | ({"filled in": view.filled} if view.filled.any() else {})
