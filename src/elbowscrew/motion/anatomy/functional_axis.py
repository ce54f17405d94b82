"""The axis that a joint flexes about, and how far it is known against what rests in the proximal body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.lines import angle_of_lines
from elbowscrew.model import JointAxis
from elbowscrew.model.anatomy import FunctionalAxisName, Limits
from elbowscrew.model.joint_type import JointLine, JointType
from elbowscrew.motion.joint.estimates import UNDETERMINED, ProximalErrors, Reach
from elbowscrew.motion.joint.joint_axis import EstimatedAxis


class FunctionalAxis(NamedTuple):
    """A line in the proximal body, with its errors there.

    Attributes
    ----------
    name : {"joint_axis", "axis1"}
        The axis of the joint as a whole, its mean where it wanders, or the first of two axes.
    line : ndarray, shape (6,)
        Plücker vector in the proximal body's frame.
    errors : ProximalErrors or JointLine
        Of an axis among two the whole cone and radius, whichever way.
    """

    name: FunctionalAxisName
    line: Float
    errors: ProximalErrors | JointLine

    def angle_to(self, direction: Float) -> Limits:
        """Angle (rad, 0 to pi/2) to a direction (3,), either way round, with its 95 % limits."""
        angle = float(angle_of_lines(self.line[:3], direction))
        if isinstance(self.errors, ProximalErrors):
            reach = self.errors.towards_direction(direction)
        else:
            reach = Reach(self.errors.axis_cone, self.errors.axis_cone)
        return _limits(angle, reach if reach.circle < UNDETERMINED else Reach(np.nan, np.nan), 0.5 * np.pi)

    def distance_from(self, point: Float) -> Limits:
        """Distance (m) from a point (3,), with its 95 % limits."""
        direction, moment = self.line[:3], self.line[3:]
        distance = float(length(moment - np.cross(point, direction)))
        if isinstance(self.errors, ProximalErrors):
            return _limits(distance, self.errors.towards_point(point))
        along = abs(float((point - self.errors.point_proximal) @ direction))
        radius = self.errors.point_radius + along * self.errors.axis_cone
        return _limits(distance, Reach(radius, radius))


def functional_axis(
    estimated: EstimatedAxis, joint_axis: JointAxis, joint_type: JointType | None
) -> FunctionalAxis | None:
    """Give the axis to hold against the epicondyles; None where the motion shows none.

    Parameters
    ----------
    estimated : EstimatedAxis
    joint_axis : JointAxis
        The same, once the joint's type is known.
    joint_type : JointType or None
    """
    if joint_axis.headline is not None and estimated.errors is not None:
        line = joint_axis.headline.line
        return FunctionalAxis("joint_axis", _line(line.direction_proximal, line.point_proximal), estimated.errors)
    two = None if joint_type is None else joint_type.two_axes
    if two is None or not two.axis1.determined:
        return None
    return FunctionalAxis("axis1", _line(two.axis1.direction_proximal, two.axis1.point_proximal), two.axis1)


def _line(direction: Float, point: Float) -> Float:
    return np.concatenate([direction, np.cross(point, direction)])


def _limits(value: float, reach: Reach, most: float = np.inf) -> Limits:
    """Limits of a size: where the circle that holds 95 % takes 0 in, it may lie any way, and all the circle counts."""
    if not np.isfinite(reach.circle):
        return Limits(value, np.nan, np.nan)
    if value <= reach.circle:
        return Limits(value, 0.0, min(value + reach.circle, most))
    return Limits(value, max(value - reach.along, 0.0), min(value + reach.along, most))
