"""Two axes as they are told: with a sense, at the feet of their common normal, and with what they may be off."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model.joint_type import JointLine, Measure, TwoAxes
from elbowscrew.motion.joint.contest import LARGEST_AXIS_SD, LEAST_RANGE_IN_SD, middle_range
from elbowscrew.motion.joint.every_frame import near_zero
from elbowscrew.motion.joint.fitting import frames_that_count_as_one, shared_covariance
from elbowscrew.motion.joint.interval import JointInterval, pose_radii
from elbowscrew.motion.joint.likelihood import Fit, Mechanism
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.joint.single_step import single_step
from elbowscrew.motion.joint.two_axes import (
    LARGEST_UNDONE,
    SHIFTS,
    TILTS,
    AxesGeometry,
    TwoAxesMechanism,
    angle_sd,
    angles_go_together,
    axes_geometry,
    geometry_slopes,
    undone_share,
)
from elbowscrew.motion.joint.type_interval import largest_tilt_sd

_PARALLEL: Final = np.radians(5.0)
_SURE: Final = 3.0
_LARGEST_SD_AT_ENDS: Final = np.radians(15.0)


def told_axes(
    at: TwoAxesMechanism,
    fit: Fit[Mechanism],
    reference: Float,
    interval: JointInterval,
    carried: Float | None,
    *,
    noise_known: bool,
    order_determined: bool,
) -> TwoAxes:
    """Both axes, how they stand to each other, and what all of it may be off.

    Parameters
    ----------
    at : TwoAxesMechanism
        The axes.
    fit : Fit
        Whose residuals tell how much a frame errs.
    reference : ndarray, shape (8,)
        Pose in which the bodies stand to each other.
    interval : JointInterval
        Of the shared numbers of `at`.
    carried : ndarray, shape (6, 6), or None
        Covariance of the reference pose in the distal body's frame; None where that pose is exact.
    noise_known : bool
    order_determined : bool
        Whether the motion tells which axis is the proximal body's.
    """
    geometry = axes_geometry(at)
    lines = axes_lines(at, fit, reference, interval, carried)
    between, parallel = between_axes(at, interval)
    sd = [interval.radius(row[None]) / NORMAL_95 for row in geometry_slopes(at)]
    determined = all(line.determined for line in lines)
    if not determined and not order_determined:  # whose axis the one is that seems known is open, and so what it is
        lines = (replace(lines[0], determined=False), replace(lines[1], determined=False))
    if not determined:
        sd = [float("nan")] * len(sd)  # how two axes stand to each other is no better known than they are
    return TwoAxes(
        axis1=lines[0],
        axis2=lines[1],
        covariance=shared_covariance(fit, noise_known=noise_known),
        angle_between=Measure(value=between, sd=sd[0]),
        distance=None if parallel else Measure(value=geometry.distance, sd=sd[1]),
        foot1=None if parallel else Measure(value=geometry.foot1, sd=sd[2]),
        foot2=None if parallel else Measure(value=geometry.foot2, sd=sd[3]),
        offset=Measure(value=geometry.offset, sd=sd[4]) if parallel else None,
        order_determined=order_determined and determined,
    )


def axes_lines(
    at: TwoAxesMechanism,
    fit: Fit[Mechanism],
    reference: Float,
    interval: JointInterval,
    carried: Float | None = None,
) -> tuple[JointLine, JointLine]:
    """Both axes; `carried` (6, 6) is the reference pose's covariance, in the distal body's frame."""
    deviation = angle_sd(fit)
    # Frames whose errors go together tell an axis no better than the few that count.
    least = LEAST_RANGE_IN_SD * np.sqrt(frames_that_count_as_one(fit))
    poses = [
        (at.proximal, dq.multiply(dq.conjugate(reference), at.proximal)),
        (dq.multiply(reference, at.distal), at.distal),
    ]
    apart = between_axes(at, interval)[1] or (undone_share(at) <= LARGEST_UNDONE and not angles_go_together(at))
    linear = replace(interval, nearby=())
    lines = []
    for k, (proximal, distal) in enumerate(poses):
        tilt_sd = largest_tilt_sd(interval, TILTS[k : k + 1])
        known = largest_tilt_sd(linear, TILTS[k : k + 1]) <= LARGEST_AXIS_SD and tilt_sd <= _LARGEST_SD_AT_ENDS
        reach = middle_range(at.frames[:, k])
        direction, point = dq.transform_lines(distal, Z_LINE)[:3], dq.pose_from_dual_quat(distal)[1]
        cone, radius = interval.radius(TILTS[k]), interval.radius(SHIFTS[k])
        by_pose = (0.0, 0.0) if carried is None else _carried_radii(carried, direction, point)
        lines.append(
            JointLine(
                direction_proximal=dq.transform_lines(proximal, Z_LINE)[:3],
                point_proximal=dq.pose_from_dual_quat(proximal)[1],
                direction_distal=direction,
                point_distal=point,
                axis_cone=cone,
                point_radius=radius,
                other_cone=float(np.hypot(cone, by_pose[0])),
                other_radius=float(np.hypot(radius, by_pose[1])),
                axis_sd=tilt_sd,
                range=reach,
                angle_sd=float(deviation[k]),
                determined=bool(
                    apart and reach >= least * deviation[k] and known and single_step(at.frames[:, k]) is None
                ),
            )
        )
    return lines[0], lines[1]


def between_axes(at: TwoAxesMechanism, interval: JointInterval) -> tuple[float, bool]:
    """Angle (rad) between the axes, 90 deg at most, and whether they count as parallel.

    An angle that is hardly known makes no axes parallel, so that the interval's own ends have no say here.
    """
    angle = axes_geometry(at).angle
    folded = min(angle, np.pi - angle)
    sd = replace(interval, nearby=()).radius(geometry_slopes(at)[:1]) / NORMAL_95
    return folded, folded < max(_PARALLEL, _SURE * sd)


def _carried_radii(covariance: Float, direction: Float, point: Float) -> tuple[float, float]:
    """As `pose_radii`; of a pose without a place the direction's alone."""
    if np.isfinite(covariance).all() and np.isfinite(point).all():
        return pose_radii(covariance, direction, point)
    rotation = np.zeros((6, 6))
    rotation[:3, :3] = covariance[:3, :3]
    return pose_radii(rotation, direction, np.zeros(3))[0], float("nan")


def oriented(at: TwoAxesMechanism, *, left: bool, located: bool) -> TwoAxesMechanism:
    """Axis 1 with its largest excursion positive; axis 2 toward the joint from the distal body, of a left side away.

    The origins are put on the feet of the common normal, where the positions of both axes are of interest; of parallel
    axes, which have none, and whose second is given the sense of its excursion, nearest the bodies' origins. Where no
    positions were measured the second has that sense, too.
    """
    angle = near_zero(at.frames)
    senses = np.where(angle.max(axis=0) >= -angle.min(axis=0), 1.0, -1.0)
    geometry = axes_geometry(at)
    if located and not _is_parallel(geometry):
        senses[1] = (1.0 if geometry.foot2 >= 0.0 else -1.0) * (-1.0 if left else 1.0)
    return at_feet(at.turned(float(senses[0]), float(senses[1])), located=located)


def at_feet(at: TwoAxesMechanism, *, located: bool) -> TwoAxesMechanism:
    """The same axes with their origins where `oriented` puts them."""
    first, second = _to_origin(at.proximal), _to_origin(at.distal)
    geometry = axes_geometry(at)
    if _is_parallel(geometry) or not located:
        return at.slid(first, second)
    return at.slid(first + geometry.foot1, second + geometry.foot2)


def _is_parallel(geometry: AxesGeometry) -> bool:
    return bool(min(geometry.angle, np.pi - geometry.angle) < _PARALLEL)


def _to_origin(pose: Float) -> float:
    """How far along the z axis of a pose the point nearest the body's origin is."""
    return -float(dq.pose_from_dual_quat(pose)[1] @ dq.transform_lines(pose, Z_LINE)[:3])
