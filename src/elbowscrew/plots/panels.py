"""The panels that each figure of a trial is made of, to be drawn on anybody's Axes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from elbowscrew.choices import FigureName
from elbowscrew.plots.anatomy import plot_against_flexion, plot_anatomical_angle
from elbowscrew.plots.axis import (
    plot_axes_in_space,
    plot_axis_directions,
    plot_axis_positions,
    with_instantaneous_axes,
)
from elbowscrew.plots.cycles import plot_cycles
from elbowscrew.plots.joint import plot_axis_end_on, plot_axis_from_the_side, plot_joint_axis_in_space
from elbowscrew.plots.joint_angles import (
    plot_angles_together,
    plot_axis_path,
    plot_joint_angles,
    plot_residual_rotation,
    plot_residual_translation,
)
from elbowscrew.plots.joint_type import plot_axis_known, plot_center, plot_joint_in_body
from elbowscrew.plots.kinematics import plot_angular_velocity, plot_slide, plot_slide_velocity
from elbowscrew.plots.paper_figures import plot_all_euler_parameters, plot_one_angle
from elbowscrew.plots.quality import plot_angle_sd, plot_losses
from elbowscrew.plots.series import plot_angle_error, plot_euler_parameter, plot_rms_displacement, plot_theta
from elbowscrew.view.joint_space import joint_in_body
from elbowscrew.view.trial_view import TrialView


class Panel(NamedTuple):
    """What is drawn on one Axes, and whether that must be one in space (``projection="3d"``)."""

    draw: Callable[[Any, TrialView], Axes]
    in_space: bool = False


def panels_of(name: FigureName, view: TrialView) -> tuple[Panel, ...]:
    """Give the panels of a figure of this trial, in its order."""
    found: tuple[Panel, ...] = _PANELS[name](view)
    return found


def _over(draw: Callable[..., Axes], parameter: str, *values: object) -> tuple[Panel, ...]:
    """The same panel for each value of a parameter."""
    return tuple(Panel(partial(draw, **{parameter: value})) for value in values)


def _joint(view: TrialView) -> tuple[Panel, ...]:
    seen = joint_in_body(view, "proximal"), joint_in_body(view, "distal")
    spaces = tuple(Panel(partial(plot_joint_in_body, body=body), in_space=True) for body in seen)
    if seen[0].center is not None:
        return spaces + tuple(Panel(partial(plot_center, body=seen[0], side=side)) for side in (0, 1))
    count = min(len(seen[0].axes), 2)
    return spaces + tuple(Panel(partial(plot_axis_known, body=seen[k], number=k)) for k in range(count))


def _joint_angles(view: TrialView) -> tuple[Panel, ...]:
    both = view.joint_angles is not None and view.joint_angles.angle.shape[1] == 2
    left = (Panel(plot_residual_rotation), *([Panel(plot_residual_translation)] if view.located else []))
    return (Panel(plot_joint_angles), *left, *([Panel(plot_angles_together)] if both else []))


def _quality(view: TrialView) -> tuple[Panel, ...]:
    known = (Panel(plot_angle_sd),) if np.isfinite(view.angle_sd).any() else ()
    left = [] if view.joint_angles is None else [plot_residual_rotation]
    left += [plot_residual_translation] if left and view.located else []
    return (Panel(plot_losses), *known, *map(Panel, left))


def _of_instantaneous_axes(draw: Callable[[Any, TrialView], Axes]) -> Callable[[Any, TrialView], Axes]:
    return lambda ax, view: draw(ax, with_instantaneous_axes(view))


_IN_SPACE: Final = (
    Panel(plot_axes_in_space, in_space=True), Panel(plot_axis_directions), Panel(plot_axis_positions)
)  # fmt: skip
_PANELS: Final[dict[FigureName, Callable[[TrialView], tuple[Panel, ...]]]] = {
    "theta": lambda _view: (Panel(plot_theta),),
    "euler_parameters": lambda _view: _over(plot_euler_parameter, "component", 0, 1, 2, 3),
    "joint": _joint,
    "slide": lambda _view: (Panel(plot_slide),),
    "error": lambda view: (Panel(plot_angle_error), *([Panel(plot_rms_displacement)] if view.located else [])),
    "anatomy": lambda view: (
        *_over(plot_anatomical_angle, "name", *view.named_joint.angle_keys),
        *_over(plot_against_flexion, "name", *view.named_joint.angle_keys[1:]),
    ),
    "velocity": lambda view: (Panel(plot_angular_velocity), *([Panel(plot_slide_velocity)] if view.located else [])),
    "instantaneous_axes": lambda _view: tuple(
        Panel(_of_instantaneous_axes(panel.draw), panel.in_space) for panel in _IN_SPACE
    ),
    "cycles": lambda _view: (Panel(plot_cycles),),
    "quality": _quality,
    "axis": lambda _view: _IN_SPACE,
    "joint_axis": lambda _view: (
        Panel(plot_joint_axis_in_space, in_space=True),
        Panel(plot_axis_end_on),
        *_over(plot_axis_from_the_side, "side", 0, 1),
    ),
    "joint_angles": _joint_angles,
    "axis_path": lambda _view: _over(plot_axis_path, "shifted", False, True),
    "fig7": lambda _view: _over(plot_one_angle, "modeled", False),
    "fig8": lambda _view: _over(plot_one_angle, "modeled", True),
    "fig9": lambda _view: _over(plot_all_euler_parameters, "modeled", False),
    "fig10": lambda _view: _over(plot_all_euler_parameters, "modeled", True),
}
"""A new figure of a trial has its panels here."""
