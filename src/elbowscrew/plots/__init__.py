"""Figures of an analysis: functions that draw on Axes and return them, and whole figures made of them."""

from elbowscrew.plots.axis import plot_axes_in_space, plot_axis_directions, plot_axis_positions
from elbowscrew.plots.joint import plot_axis_end_on, plot_axis_from_the_side, plot_joint_axis_in_space
from elbowscrew.plots.registry import FIGURES
from elbowscrew.plots.series import plot_angle_error, plot_euler_parameter, plot_rms_displacement, plot_theta

__all__ = [
    "FIGURES",
    "plot_angle_error",
    "plot_axes_in_space",
    "plot_axis_directions",
    "plot_axis_end_on",
    "plot_axis_from_the_side",
    "plot_axis_positions",
    "plot_euler_parameter",
    "plot_joint_axis_in_space",
    "plot_rms_displacement",
    "plot_theta",
]
