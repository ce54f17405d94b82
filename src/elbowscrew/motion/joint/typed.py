"""The joint by its type: chosen on few frames, refined on many, its angles in all of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, Literal

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.model.joint_type import BallJoint, JointLine, JointType, Measure, SecondRotation, TwoAxes
from elbowscrew.motion.joint.choice import Choice, choose_type
from elbowscrew.motion.joint.contest import LARGEST_AXIS_SD, LEAST_RANGE_IN_SD, RMS_TO_RANGE, middle_range
from elbowscrew.motion.joint.coordinates import coordinates_of
from elbowscrew.motion.joint.every_frame import Everywhere, FrameNumbers, numbers_everywhere, reference_numbers
from elbowscrew.motion.joint.fitting import Fitted, frames_that_count_as_one, shared_covariance
from elbowscrew.motion.joint.interval import ClusterMotion, JointInterval, Method, SkinMotion, pose_radii
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, fit_mechanism, refined
from elbowscrew.motion.joint.lines import Z_LINE, nearest_points
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.robust_fit import fit_robustly, refined_robustly
from elbowscrew.motion.joint.simple_types import Ball, OneAxis
from elbowscrew.motion.joint.two_axes import (
    LARGEST_UNDONE,
    SHIFTS,
    TILTS,
    TwoAxesMechanism,
    angle_sd,
    axes_geometry,
    geometry_slopes,
    undone_share,
)
from elbowscrew.motion.joint.type_interval import Evidence, interval_of_type, largest_tilt_sd

_MOST_FRAMES: Final = 5000
_PARALLEL: Final = np.radians(5.0)
_SURE: Final = 3.0
_SHARES_THE_HINGE: Final = 1.5
_LEAST_BESIDE: Final = np.radians(45.0)
_LARGEST_SD_AT_ENDS: Final = np.radians(15.0)


def identify_joint(
    joint: Float,
    covariance: Float,
    reference: Float,
    *,
    noise_known: bool,
    robust: bool = False,
    forced: Fitted | None = None,
    one: Literal["hinge", "screw_hinge"] | None = None,
    left: bool = False,
    everywhere: Everywhere | None = None,
    clusters: tuple[ClusterMotion, ...] = (),
    skin: tuple[SkinMotion, ...] = (),
) -> JointType:
    """Tell which joint moved so, and where its axes or its center are.

    Parameters
    ----------
    joint : ndarray, shape (F, 8)
        Measured poses of the distal body in the proximal one, any signs, in order of time.
    covariance : ndarray, shape (F, 6, 6) or (6, 6)
        Of each pose's error in the distal body's frame (`joint_covariance`).
    reference : ndarray, shape (8,)
        Pose that angles count from.
    noise_known : bool
        Whether the covariance is stated; else only its shape counts.
    robust : bool
        Weigh outliers down.
    forced : str, optional
        Take this type.
    one : {"hinge", "screw_hinge"}, optional
        Which of both a single axis is, where that is known already.
    left : bool
        Of a left side the second axis points away from the joint, so that pronation is positive.
    everywhere : Everywhere, optional
        The frames whose angles are wanted; those that the joint is fitted to by default.
    clusters : tuple of ClusterMotion
        Of every body that moves, in the F frames; empty if one of them has no markers.
    skin : tuple of SkinMotion
        How the clusters are stated to move as a whole on their bones.

    Returns
    -------
    JointType
        Chosen on 200 frames and refined on 5,000 at most, both evenly spread; angles are those of all frames, so that
        time and memory grow with the frames as the result does.
    """
    poses = Poses.of(joint, covariance)
    choice = choose_type(poses, noise_known=noise_known, robust=robust, forced=forced, one=one)
    if choice.type in ("free", "undetermined"):
        return _result(choice, None)
    found = choice.fits[choice.type]
    most, rows = poses.thinned(_MOST_FRAMES)
    evidence = Evidence(noise_known=noise_known, clusters=clusters, skin=skin)
    fit = fit_mechanism(found.mechanism.placed(most.joint), most)
    fit = refined_robustly(fit_robustly(fit, most), most) if robust else refined(fit, most)
    if everywhere is None:
        of_each = np.broadcast_to(covariance, (len(joint), 6, 6))
        everywhere = Everywhere(joint, lambda rows: of_each[rows], np.ones(len(joint)))
    mechanism = fit.mechanism
    scale = max(fit.variance, 1.0 if noise_known else 0.0)
    if not fit.frame_freedom:  # nothing is left that could tell of the noise
        scale = 1.0 if noise_known else np.nan
    if isinstance(mechanism, TwoAxesMechanism):
        start = reference_numbers(mechanism, everywhere, reference)
        at = _oriented(mechanism.zeroed(start.own[0]), left=left, located=poses.located)
        written = fit_mechanism(at, most, iterations=0, weight=fit.weight)
        interval = interval_of_type(written, most, evidence.at(rows), np.zeros(2))
        every = numbers_everywhere(at, everywhere, reference, interval)
        every = every._replace(angle=_near_zero(every.angle))
        allowed = coordinates_of(replace(at, frames=np.zeros((1, 2))), reference)
        carried = everywhere.reference_covariance
        two = _two_axes(
            written,
            reference,
            interval,
            None if carried is None else scale * carried,
            noise_known=noise_known,
            order_determined=choice.order_told,
        )
        method = interval.decided_by(TILTS[0])
        if choice.status == "determined" and not all(line.determined for line in two.lines):
            reason = f"{choice.reason}; errors that go together are too large to tell both directions"
            choice = choice._replace(status="approximate", reason=reason)
        return _result(choice, every, scale, coordinates=allowed, two_axes=two, decided_by=method)
    start = reference_numbers(mechanism, everywhere, reference)
    allowed = coordinates_of(replace(mechanism, frames=start.own), reference)
    every = numbers_everywhere(mechanism, everywhere, reference)
    if isinstance(mechanism, Ball) and not poses.located:
        return _result(choice, every, scale, coordinates=allowed)
    if isinstance(mechanism, Ball):
        interval = interval_of_type(fit, most, evidence.at(rows))
        center = _ball(fit, mechanism, interval, most.joint, noise_known=noise_known)
        if not choice.center_told:
            center = replace(center, radius=np.nan, covariance=np.full_like(center.covariance, np.nan))
        method = interval.decided_by(np.eye(6)[:3])
        return _result(choice, every, scale, coordinates=allowed, ball=center, decided_by=method)
    if isinstance(mechanism, OneAxis):
        angle = _near_zero(every.angle)
        sense = 1.0 if np.nanmax(angle) >= -np.nanmin(angle) else -1.0
        second = _second_rotation(choice, poses, reference, evidence)
        allowed = None if allowed is None else replace(allowed, axis=sense * allowed.axis)
        return _result(choice, every._replace(angle=sense * angle), scale, coordinates=allowed, second=second)
    return _result(choice, every, scale)


def _result(
    choice: Choice,
    every: FrameNumbers | None,
    scale: float = 1.0,
    *,
    coordinates: JointCoordinates | None = None,
    two_axes: TwoAxes | None = None,
    ball: BallJoint | None = None,
    second: SecondRotation | None = None,
    decided_by: Method | None = None,
) -> JointType:
    """Put a result together; `scale` is how many times the stated variance the residuals have."""
    if every is None:
        every = FrameNumbers(*[np.zeros((0, 0))] * 3, *[np.zeros(0)] * 2)
    return JointType(
        type=choice.type,
        status=choice.status,
        reason=choice.reason,
        candidates=choice.candidates,
        two_axes=two_axes,
        ball=ball,
        second_rotation=second,
        decided_by=decided_by,
        coordinates=coordinates,
        angle=every.angle,
        angle_sd=np.hypot(np.sqrt(scale) * every.angle_sd, every.axes_sd),
        residual_rotation=every.residual_rotation,
        residual_translation=every.residual_translation,
    )


def _near_zero(angle: Float) -> Float:
    """Take off the whole turns that the frame nearest the reference pose has."""
    known = angle[np.isfinite(angle).all(axis=1)]
    if not known.size:
        return angle
    turns = np.round(known / (2.0 * np.pi))
    nearest = np.argmin(np.sum(np.abs(known - 2.0 * np.pi * turns), axis=1))
    return np.asarray(angle - 2.0 * np.pi * turns[nearest])


def _oriented(at: TwoAxesMechanism, *, left: bool, located: bool) -> TwoAxesMechanism:
    """Axis 1 with its largest excursion positive; axis 2 toward the joint from the distal body, of a left side away.

    The origins are put on the feet of the common normal, where the positions of both axes are of interest; of parallel
    axes, which have none, and whose second is given the sense of its excursion, nearest the bodies' origins. Where no
    positions were measured the second has that sense, too.
    """
    angle = _near_zero(at.frames)
    senses = np.where(angle.max(axis=0) >= -angle.min(axis=0), 1.0, -1.0)
    geometry = axes_geometry(at)
    parallel = min(geometry.angle, np.pi - geometry.angle) < _PARALLEL
    if located and not parallel:
        senses[1] = (1.0 if geometry.foot2 >= 0.0 else -1.0) * (-1.0 if left else 1.0)
    at = at.turned(float(senses[0]), float(senses[1]))
    first, second = _to_origin(at.proximal), _to_origin(at.distal)
    if parallel or not located:
        return at.slid(first, second)
    geometry = axes_geometry(at)
    return at.slid(first + geometry.foot1, second + geometry.foot2)


def _to_origin(pose: Float) -> float:
    """How far along the z axis of a pose the point nearest the body's origin is."""
    return -float(dq.pose_from_dual_quat(pose)[1] @ dq.transform_lines(pose, Z_LINE)[:3])


def _two_axes(
    fit: Fit[TwoAxesMechanism],
    reference: Float,
    interval: JointInterval,
    carried: Float | None,
    *,
    noise_known: bool,
    order_determined: bool,
) -> TwoAxes:
    at = fit.mechanism
    geometry = axes_geometry(at)
    lines = _lines(at, fit, reference, interval, carried)
    between, parallel = _between(at, interval)
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


def _between(at: TwoAxesMechanism, interval: JointInterval) -> tuple[float, bool]:
    """Angle (rad) between the axes, 90 deg at most, and whether they count as parallel.

    An angle that is hardly known makes no axes parallel, so that the interval's own ends have no say here.
    """
    angle = axes_geometry(at).angle
    folded = min(angle, np.pi - angle)
    sd = replace(interval, nearby=()).radius(geometry_slopes(at)[:1]) / NORMAL_95
    return folded, folded < max(_PARALLEL, _SURE * sd)


def _lines(
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
    apart = undone_share(at) <= LARGEST_UNDONE or _between(at, interval)[1]
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
                determined=bool(apart and reach >= least * deviation[k] and known),
            )
        )
    return lines[0], lines[1]


def _carried_radii(covariance: Float, direction: Float, point: Float) -> tuple[float, float]:
    """As `pose_radii`; of a pose without a place the direction's alone."""
    if np.isfinite(covariance).all() and np.isfinite(point).all():
        return pose_radii(covariance, direction, point)
    rotation = np.zeros((6, 6))
    rotation[:3, :3] = covariance[:3, :3]
    return pose_radii(rotation, direction, np.zeros(3))[0], float("nan")


def _second_rotation(choice: Choice, poses: Poses, reference: Float, evidence: Evidence) -> SecondRotation | None:
    """What turns beside a hinge; None where it was not looked for, or is white in time, as noise is."""
    if "two_axes" not in choice.fits:
        return None
    two = choice.fits["two_axes"]
    if not isinstance(two.mechanism, TwoAxesMechanism):
        return None
    interval = interval_of_type(two, poses.at(choice.rows), evidence.at(choice.rows))
    lines = _lines(two.mechanism, two, reference, interval)
    smaller = min(lines, key=lambda line: line.range)
    left = RMS_TO_RANGE * next(c for c in choice.candidates if c.type == choice.type).residual_rotation
    valid = any(candidate.valid for candidate in choice.candidates if candidate.type == "two_axes")
    # Two axes that share the hinge's own rotation among them are not the hinge's and another; and of a small rotation
    # the part across the hinge alone is seen at once, which any axis between there and the hinge has.
    apart = _between(two.mechanism, interval)[0] >= _LEAST_BESIDE
    beside = apart and smaller.range < _SHARES_THE_HINGE * left
    if valid and beside and all(line.determined for line in lines):
        return SecondRotation(range=smaller.range, axis=smaller)
    return SecondRotation(range=RMS_TO_RANGE * choice.rotation_left, axis=None) if choice.rotation_left else None


def _ball(fit: Fit[Mechanism], at: Ball, interval: JointInterval, joint: Float, *, noise_known: bool) -> BallJoint:
    score_distal, score_proximal = nearest_points(joint, undetermined=0)
    return BallJoint(
        center_proximal=at.proximal,
        center_distal=at.distal,
        covariance=shared_covariance(fit, noise_known=noise_known),
        radius=interval.radius(np.eye(6)[:3]),
        score_proximal=score_proximal,
        score_distal=score_distal,
    )
