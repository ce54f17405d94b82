"""Lines of a joint as they are reported: in both bodies and in the frame asked for, with their errors there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.choices import ExpressIn
from elbowscrew.geometry import point_nearest_origin
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import (
    conjugate,
    multiply,
    pose_from_dual_quat,
    transform_lines,
    transform_points,
)
from elbowscrew.geometry.sensitivity import confidence_radius
from elbowscrew.model import JointMotion, LineEstimate
from elbowscrew.motion.joint.interval import JointInterval, Method, pose_radii
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.screws.pose_noise import JointNoise

UNDETERMINED = 0.5 * np.pi
"""Half-angle of a cone from which on a direction is not determined at all."""


class LineErrors(NamedTuple):
    """How far a line may be off: half-angle (rad) and radius (m) that hold 95 %, and both components' deviations.

    The part of a stated skin motion in cone and radius adds in quadrature. The cone is by that method of
    `JointInterval` which gave the largest.
    """

    axis_cone: float
    point_radius: float
    axis_sd: float
    point_sd: float
    skin_cone: float
    skin_radius: float
    decided_by: Method | None


class Reach(NamedTuple):
    """How far a line may go, 95 %: along one way across it, and any way. Radians of a direction, meters of a place."""

    along: float
    circle: float


class ProximalErrors(NamedTuple):
    """Errors of a line in the proximal body, towards what rests there.

    Attributes
    ----------
    interval : JointInterval
        Of P numbers.
    tilt, shift : ndarray, shape (2, P)
        The line's tilts about x and y of its pose, and its shifts along them at the origin, by these numbers.
    pose : ndarray, shape (8,)
        Whose z axis the line is.
    known : bool
        Whether the errors are known at all; else how far the line may go is NaN.
    """

    interval: JointInterval
    tilt: Float
    shift: Float
    pose: Float
    known: bool = True

    def towards_direction(self, direction: Float) -> Reach:
        """How far the line's direction may go towards, or away from, a direction (3,)."""
        ahead = transform_lines(conjugate(self.pose), np.concatenate([direction, np.zeros(3)]))[:2]
        # A tilt (a, b) moves the z axis by (b, -a).
        return self._reach(np.stack([self.tilt[1], -self.tilt[0]]), ahead)

    def towards_point(self, point: Float) -> Reach:
        """How far the line may go, where it passes a point (3,) nearest, towards or away from it."""
        ahead = transform_points(conjugate(self.pose), point)
        return self._reach(self.shift + ahead[2] * np.stack([self.tilt[1], -self.tilt[0]]), ahead[:2])

    def _reach(self, across: Float, ahead: Float) -> Reach:
        if not self.known:
            return Reach(np.nan, np.nan)
        size, circle = float(np.hypot(*ahead)), self.interval.radius(across)
        return Reach(self.interval.radius((ahead / size @ across)[None]) if size > 0.0 else circle, circle)


def line_estimate(proximal: Float, distal: Float, joint: JointMotion, express_in: ExpressIn) -> LineEstimate:
    """Tell a line, given (6,) in both bodies, in the frame that is asked for too."""
    shown = {
        "distal": distal,
        "proximal": proximal,
        "lab": transform_lines(joint.dual_quat_lab_proximal, proximal),
    }[express_in]
    return LineEstimate(
        direction=shown[:3],
        point=point_nearest_origin(shown),
        direction_proximal=proximal[:3],
        point_proximal=point_nearest_origin(proximal),
        direction_distal=distal[:3],
        point_distal=point_nearest_origin(distal),
    )


def line_errors(
    interval: JointInterval,
    covariance: Float,
    tilt: Float,
    shift: Float,
    pose: Float,
    line: LineEstimate,
    joint: JointMotion,
    noise: JointNoise,
    *,
    express_in: ExpressIn,
) -> LineErrors:
    """Errors of a line in the frame it is expressed in, the position at the line's point there.

    Parameters
    ----------
    interval : JointInterval
        Of the fit's P shared numbers.
    covariance : ndarray, shape (P, P)
        Of the same, as the fit has it: it gives the ratio of a deviation to a radius.
    tilt, shift : ndarray, shape (2, P)
        The line's tilts about x and y, and its shifts along them at its origin, by the shared numbers.
    pose : ndarray, shape (8,)
        Whose z axis the line is, in the distal body where the line is told there, else in the proximal one.
    line : LineEstimate
    joint : JointMotion
    noise : JointNoise
        In the laboratory the proximal body's pose at the reference carries the line with it.
    express_in : {"distal", "proximal", "lab"}
    """
    frame = multiply(joint.dual_quat_lab_proximal, pose) if express_in == "lab" else pose
    # A tilt (a, b) moves the line by (b, -a) d at a distance d along it from the pose's origin.
    along = (line.point - pose_from_dual_quat(frame)[1]) @ transform_lines(frame, Z_LINE)[:3]
    across = shift + along * np.stack([tilt[1], -tilt[0]])
    known = bool(np.isfinite(covariance).all())
    cone, method = interval.radius_by(tilt) if known else (float("nan"), None)
    radius = interval.radius(across) if known else float("nan")
    if express_in == "lab" and noise.proximal is not None:
        carried = pose_radii(noise.proximal.covariance, line.direction_proximal, line.point_proximal)
        cone, radius = float(np.hypot(cone, carried[0])), float(np.hypot(radius, carried[1]))
    if not cone < UNDETERMINED:
        cone, radius, method = float("nan"), float("nan"), None
    return LineErrors(
        axis_cone=cone,
        point_radius=radius,
        axis_sd=cone * _sd_of_radius(tilt @ covariance @ tilt.T),
        point_sd=radius * _sd_of_radius(across @ covariance @ across.T),
        skin_cone=interval.skin_radius(tilt),
        skin_radius=interval.skin_radius(across),
        decided_by=method,
    )


def _sd_of_radius(covariance: Float) -> float:
    """Standard deviation of both components together, for each unit of the radius that holds 95 %."""
    radius = float(confidence_radius(covariance))
    return float(np.sqrt(np.trace(covariance))) / radius if radius > 0.0 else 0.0
