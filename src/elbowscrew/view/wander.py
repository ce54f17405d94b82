"""An axis that wanders, as its tilt and its shift from the mean axis in two directions across that."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.lines import piercing
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model.joint_axis import AxisPath
from elbowscrew.view.scene import directions_across
from elbowscrew.view.trial_view import TrialView


class OffMean(NamedTuple):
    """Tilt (2, K), rad, and shift (2, K), m, with what holds 95 % of each (K,), and the coordinates these lean to."""

    toward: tuple[str, str]
    tilt: Float
    tilt_reach: Float
    shift: Float
    shift_reach: Float


def off_mean(view: TrialView, path: AxisPath) -> OffMean:
    """Find how far the axis is off the mean axis at each angle of its path."""
    direction = view.joint_direction
    across, toward = directions_across(direction)
    along = path.direction @ direction
    offset = piercing(path.direction, path.point, direction, view.joint_point) - view.joint_point
    return OffMean(
        toward=toward,
        tilt=np.array([np.arctan2(path.direction @ u, along) for u in across]),
        tilt_reach=_of_one(path.axis_sd),
        shift=np.array([offset @ u for u in across]),
        shift_reach=_of_one(path.point_sd),
    )


def _of_one(sd: Float) -> Float:
    """Give what holds 95 % of one component, of which both have the same standard deviation."""
    reach: Float = NORMAL_95 * sd / np.sqrt(2.0)
    return reach
