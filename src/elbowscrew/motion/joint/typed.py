"""The joint by its type: chosen on few frames, refined on many, its angles in all of them."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Final, Literal

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.model.joint_type import BallJoint, JointType, SecondRotation, TwoAxes
from elbowscrew.motion.joint.choice import Choice, choose_type
from elbowscrew.motion.joint.contest import RMS_TO_RANGE
from elbowscrew.motion.joint.coordinates import coordinates_of
from elbowscrew.motion.joint.every_frame import (
    Everywhere,
    FrameNumbers,
    near_zero,
    numbers_everywhere,
    reference_numbers,
)
from elbowscrew.motion.joint.fitting import Fitted, shared_covariance
from elbowscrew.motion.joint.interval import ClusterMotion, JointInterval, Method, SkinMotion
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, fit_mechanism, refined
from elbowscrew.motion.joint.lines import nearest_points
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.robust_fit import fit_robustly, refined_robustly
from elbowscrew.motion.joint.simple_types import Ball, OneAxis
from elbowscrew.motion.joint.single_step import single_step
from elbowscrew.motion.joint.two_axes import TILTS, TwoAxesMechanism, angles_go_together
from elbowscrew.motion.joint.two_axes_told import at_feet, axes_lines, between_axes, oriented, told_axes
from elbowscrew.motion.joint.type_interval import Evidence, interval_of_type
from elbowscrew.motion.joint.wander_of_two import wander_of_two

_MOST_FRAMES: Final = 5000
_SHARES_THE_HINGE: Final = 1.5
_LEAST_BESIDE: Final = np.radians(45.0)


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
        at = oriented(_counted_from(mechanism, everywhere, reference), left=left, located=poses.located)
        told = fit_mechanism(at, most, iterations=0, weight=fit.weight)
        return _with_two_axes(choice, told, most, evidence.at(rows), everywhere, reference, scale)
    every = numbers_everywhere(mechanism, everywhere, reference)
    allowed = coordinates_of(replace(mechanism, frames=every.at_reference), reference)
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
        angle = near_zero(every.angle)
        sense = 1.0 if np.nanmax(angle) >= -np.nanmin(angle) else -1.0
        second = _second_rotation(choice, poses, reference, evidence)
        choice = _doubted_for_steps(choice, angle)
        allowed = None if allowed is None else replace(allowed, axis=sense * allowed.axis)
        return _result(choice, every._replace(angle=sense * angle), scale, coordinates=allowed, second=second)
    return _result(choice, every, scale)


def _with_two_axes(
    choice: Choice,
    fit: Fit[TwoAxesMechanism],
    poses: Poses,
    evidence: Evidence,
    everywhere: Everywhere,
    reference: Float,
    scale: float,
) -> JointType:
    """Tell two axes; where one of them wanders both as they are on the mean, which the fit's are not."""
    at = fit.mechanism
    interval = interval_of_type(fit, poses, evidence, np.zeros(2))
    # Of axes that stay the fit's leave least, where one of them wanders, too: so they are for what is between poses.
    allowed = coordinates_of(replace(at, frames=np.zeros((1, 2))), reference)
    carried = everywhere.reference_covariance
    tell = partial(
        told_axes,
        fit=fit,
        reference=reference,
        carried=None if carried is None else scale * carried,
        noise_known=evidence.noise_known,
        order_determined=choice.order_told,
    )
    two = tell(at, interval=interval)
    if poses.located and all(line.determined for line in two.lines):
        found = wander_of_two(fit, poses, evidence)
        if found.significant:
            mean = at.moved(found.step, fit.own_by_shared @ found.step)
            at = at_feet(_counted_from(mean, everywhere, reference), located=True)
            about = fit_mechanism(at, poses, iterations=0, weight=fit.weight)
            beside = wander_of_two(about, poses, evidence)
            at, interval, scale = about.mechanism, beside.interval, max(scale, about.variance)
            two = replace(
                tell(at, interval=interval),
                covariance=beside.covariance,
                only_wander_doubted=choice.status == "determined",
            )
            status = "approximate" if choice.status == "determined" else choice.status
            choice = choice._replace(status=status, reason=f"{choice.reason}; {found.words}")
        lines = [replace(line, wander=wander) for line, wander in zip(two.lines, found.each, strict=True)]
        two = replace(two, axis1=lines[0], axis2=lines[1])
    choice = _doubted_for_steps(choice, at.frames)
    if choice.status in ("determined", "approximate") and angles_go_together(at) and not two.lines[0].determined:
        reason = f"{choice.reason}; one angle follows from the other, so that other axes explain the motion as well"
        choice = choice._replace(status="approximate", reason=reason)
    if choice.status == "determined" and not all(line.determined for line in two.lines):
        reason = f"{choice.reason}; errors that go together are too large to tell both directions"
        choice = choice._replace(status="approximate", reason=reason)
    every = numbers_everywhere(at, everywhere, reference, interval)
    every = every._replace(angle=near_zero(every.angle))
    decided_by = interval.decided_by(TILTS[0])
    return _result(choice, every, scale, coordinates=allowed, two_axes=two, decided_by=decided_by)


def _doubted_for_steps(choice: Choice, angles: Float) -> Choice:
    """Take a joint for approximate of which an angle, of (F, A), only steps once."""
    if choice.status not in ("determined", "approximate"):
        return choice
    several = angles.shape[1] > 1
    steps = [(f"angle {k}" if several else "its angle", single_step(one)) for k, one in enumerate(angles.T, start=1)]
    words = "; ".join(f"{name} {step.words}" for name, step in steps if step is not None)
    return choice._replace(status="approximate", reason=f"{choice.reason}; {words}") if words else choice


def _counted_from(at: TwoAxesMechanism, everywhere: Everywhere, reference: Float) -> TwoAxesMechanism:
    """With angles from those of the reference pose."""
    return at.zeroed(reference_numbers(at, everywhere, reference).own[0])


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
        none, nothing = np.zeros(0), np.zeros((0, 0))
        every = FrameNumbers(nothing, nothing, nothing, none, none, nothing)
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


def _second_rotation(choice: Choice, poses: Poses, reference: Float, evidence: Evidence) -> SecondRotation | None:
    """What turns beside a hinge; None where it was not looked for, or is white in time, as noise is."""
    if "two_axes" not in choice.fits:
        return None
    two = choice.fits["two_axes"]
    if not isinstance(two.mechanism, TwoAxesMechanism):
        return None
    interval = interval_of_type(two, poses.at(choice.rows), evidence.at(choice.rows))
    lines = axes_lines(two.mechanism, two, reference, interval)
    smaller = min(lines, key=lambda line: line.range)
    left = RMS_TO_RANGE * next(c for c in choice.candidates if c.type == choice.type).residual_rotation
    valid = any(candidate.valid for candidate in choice.candidates if candidate.type == "two_axes")
    # Two axes that share the hinge's own rotation among them are not the hinge's and another; and of a small rotation
    # the part across the hinge alone is seen at once, which any axis between there and the hinge has.
    apart = between_axes(two.mechanism, interval)[0] >= _LEAST_BESIDE
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
