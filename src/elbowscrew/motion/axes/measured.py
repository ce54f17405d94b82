"""Axes of a measured motion: mean, of the moment and from step to step."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry import quaternion, sclerp
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, multiply, pose_from_dual_quat
from elbowscrew.geometry.lines import angle_of_lines
from elbowscrew.model import HelicalSteps, InstantaneousMotion, MeanAxis, QualityWarning, RigidBody
from elbowscrew.motion.axes.helical_steps import helical_steps
from elbowscrew.motion.axes.instantaneous import instantaneous_motion, twists
from elbowscrew.motion.axes.mean_axis import MOST_ACROSS, mean_axis_of
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.motion.screws.relative import IDENTITY, expressed
from elbowscrew.motion.screws.sense import rotation_noise
from elbowscrew.motion.smoothing.resampling import linear_at
from elbowscrew.motion.smoothing.smoothing import Smoothing, inside
from elbowscrew.motion.tracking.clock import other_rate
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings

# What the field filters at: the cut-off of recordings too short for residual analysis, lower where the rate asks it.
_TWIST_HZ: Final = 6.0
# A filter leaves motion out if it takes away so many times the noise, and so much (rad).
_LEFT_OUT_NOISE: Final = 2.0
_LEAST_LEFT_OUT: Final = float(np.radians(0.1))
_POSSIBLE_SHARES: Final = (1e-3, 0.4)


def lines_one_way(measured: Measurement) -> Float:
    """Axes (N, 6) of the frames as lines, each the way round that is nearer the dominant, or the leading, direction.

    For means and spreads of lines: beside the reference, or without a sense, an axis may point the other way.
    """
    against = measured.line[:, :3] @ measured.sense.direction < 0.0
    return np.where(against[:, None], -measured.line, measured.line)


def without_sense(motion: InstantaneousMotion) -> InstantaneousMotion:
    """Turn every axis so that the angular velocity about it is positive: what it is where theta has no sense."""
    way = np.where(motion.angular_velocity < 0.0, -1.0, 1.0)
    return replace(
        motion,
        angular_velocity=way * motion.angular_velocity,
        slide_velocity=way * motion.slide_velocity,
        axis_direction=way[:, None] * motion.axis_direction,
    )


def measured_mean_axis(measured: Measurement) -> MeanAxis:
    """Take the mean over measured frames: a pose filled in says nothing that its neighbors do not."""
    lines = np.where(measured.joint.measured[:, None], lines_one_way(measured), np.nan)
    return mean_axis_of(measured.screw.angle, lines, pose_from_dual_quat(measured.change)[1])


def mean_axis_warnings(mean: MeanAxis, measured: Measurement) -> tuple[QualityWarning, ...]:
    """Say why the axes have no distances from their mean, where they have none."""
    if np.isfinite(mean.distance).any():
        return ()
    lines = measured.line[measured.joint.measured]
    off = angle_of_lines(lines[np.isfinite(lines).all(axis=1)], mean.direction)
    message = (
        f"{100.0 * np.mean(off > MOST_ACROSS):.0f} % of the axes are over {np.degrees(MOST_ACROSS):.0f} deg from their "
        "mean, and nearly in the plane across it, which they pierce anywhere or nowhere: how far apart the axes lie "
        "is left empty"
    )
    return (QualityWarning(code="axis-positions-undefined", message=message, severity="note"),)


def measured_instantaneous_motion(
    measured: Measurement, settings: Settings
) -> tuple[InstantaneousMotion, tuple[QualityWarning, ...]]:
    """Take the twist of filtered poses: of those at hand if they are, else of poses filtered for this alone.

    Its sense is that of the dominant axis or, where theta has none, of the leading direction; `without_sense` takes
    that away from what is told. Warnings say what the filter left out beside the noise, and why no frame has an axis
    where none has.
    """
    proximal, distal, smoothing = _as_recorded(measured)
    D, known = measured.displacement, measured.joint.measured
    warnings: tuple[QualityWarning, ...] = ()
    other = other_rate(smoothing.elapsed, smoothing.rate_hz)
    if other is not None:
        smoothing = smoothing._replace(cutoff_hz=None)
        D = np.full_like(D, np.nan)
    elif distal is not measured.distal or smoothing.cutoff_hz is None:
        raw = _since_reference(proximal, distal, measured)
        known = np.isfinite(raw[:, 0])
        chosen = smoothing._replace(cutoff_hz=smoothing.cutoff_hz or twist_cutoff(measured, settings))
        D = _since_reference(*chosen.apply(proximal, distal), measured)
        noise = rotation_noise(raw[known, :4])
        warnings = _left_out(raw[known, :4], D[known, :4], smoothing.elapsed[known], noise, chosen, settings)
        smoothing = chosen
    else:
        recorded = measured.unfiltered.relative
        raw = _poses_at(smoothing.elapsed, recorded, measured.unfiltered.elapsed)[known, :4]
        noise = rotation_noise(recorded[np.isfinite(recorded[:, 0]), :4])
        filtered = measured.joint.dual_quat_proximal_distal[known, :4]
        warnings = _left_out(raw, filtered, smoothing.elapsed[known], noise, smoothing, settings)
    twist = twists(
        expressed(D, measured.joint, measured.express_in), known, smoothing.elapsed, smoothing.rate_hz, smoothing.margin
    )
    if smoothing.elapsed is not measured.elapsed:
        twist = linear_at(twist, smoothing.elapsed, measured.elapsed, smoothing.rate_hz)
    motion = instantaneous_motion(
        twist,
        measured.screw.frame,
        measured.screw.time_s,
        settings.min_rate_rad_s,
        measured.sense.direction,
        lowpass_hz=smoothing.cutoff_hz,
    )
    return motion, warnings + _without_axes(motion, settings.min_rate_rad_s, smoothing.rate_hz, other)


def _poses_at(wanted: Float, poses: Float, elapsed: Float) -> Float:
    """Poses (N, 8) at the times of another clock; those of the same one as they are."""
    if wanted is elapsed:
        return poses
    before = np.clip(np.searchsorted(elapsed, wanted, side="right") - 1, 0, elapsed.size - 2)
    fraction = (wanted - elapsed[before]) / (elapsed[before + 1] - elapsed[before])
    return sclerp(poses[before], poses[before + 1], np.clip(fraction, 0.0, 1.0))


def _left_out(
    raw: Float, filtered: Float, elapsed: Float, noise: float, filter_: Smoothing, settings: Settings
) -> tuple[QualityWarning, ...]:
    """Warn where the filter took more out of the rotations (N, 4) than their noise, in the mean over the movement.

    Every frame counts by the square of its speed, so that no rest, however long, hides what the movement loses.
    """
    off = quaternion.multiply(quaternion.conjugate(filtered), raw)
    square = 4.0 * np.sum(off[:, 1:] ** 2, axis=1)  # a small rotation
    known = np.isfinite(square)
    if known.sum() < 2 or filter_.cutoff_hz is None:
        return ()
    square, filtered, elapsed = square[known], filtered[known], elapsed[known]
    apart = quaternion.multiply(quaternion.conjugate(filtered[:-1]), filtered[1:])[:, 1:]
    speed_square = np.sum(apart**2, axis=1) / np.diff(elapsed) ** 2
    weight = np.append(speed_square, 0.0) + np.append(0.0, speed_square)
    if not weight.any():
        return ()
    rms, noise = float(np.sqrt(np.average(square, weights=weight))), np.sqrt(3.0) * noise
    if rms <= max(_LEFT_OUT_NOISE * noise, _LEAST_LEFT_OUT):
        return ()
    if settings.lowpass_hz is None:
        which = "speeds and instantaneous axes", "which residual analysis finds"
    else:
        which = "theta, axes and speeds", "by --lowpass"
    largest = float(np.sqrt(square.max()))
    message = (
        f"{which[0]} are of motion up to {in_digits(filter_.cutoff_hz, 3)} Hz, {which[1]}; that leaves out "
        f"{in_digits(np.degrees(rms))} deg RMS of rotation while the joint moves, {in_digits(np.degrees(largest))} deg "
        f"at worst, where the noise is {in_digits(np.degrees(noise))} deg: what is faster is not in them (--lowpass HZ "
        "sets the cut-off)"
    )
    return (QualityWarning(code="fast-motion-left-out", message=message),)


def _without_axes(
    motion: InstantaneousMotion, least: float, rate_hz: float, other: tuple[float, float] | None
) -> tuple[QualityWarning, ...]:
    """Say why no frame has an instantaneous axis, where none has; `other`: another rate of the clock, and its start."""
    if np.isfinite(motion.axis_direction).any():
        return ()
    speed = np.abs(motion.angular_velocity[np.isfinite(motion.angular_velocity)])
    if other is not None:
        reason = (
            f"the clock keeps no one rate ({other[0]:.4g} frames per second from {other[1]:.4g} s on, {rate_hz:.4g} "
            "in the mean), and no filter for speeds is right on it; --resample HZ makes it even"
        )
    elif speed.size:
        reason = (
            f"the distal body turns at {in_digits(speed.max(), 3)} rad/s at most, and an axis needs "
            f"{in_digits(least, 3)} rad/s (--min-rate)"
        )
    else:
        reason = "no stretch of poses is long enough beside the filter's half a period at its two ends"
    return (QualityWarning(code="no-instantaneous-axis", message=f"no frame has an instantaneous axis: {reason}"),)


def _as_recorded(measured: Measurement) -> tuple[RigidBody | None, RigidBody, Smoothing]:
    """Give the bodies on the clock they were recorded on, where a filter can work there, and the filter.

    What was put on another clock has nothing more to say between the frames, less noise there, and less of what is
    fast: neither a cut-off nor a speed may be taken from that. Filtered already are only those of the same clock.
    """
    was = measured.unfiltered
    known = was.distal.tracked if was.proximal is None else was.distal.tracked & was.proximal.tracked
    if (
        was.elapsed is measured.elapsed
        or other_rate(was.elapsed, was.rate_hz) is not None
        or not inside(known, was.elapsed, was.rate_hz, 1).any()
    ):
        return measured.proximal, measured.distal, measured.smoothing
    smoothing = measured.smoothing._replace(elapsed=was.elapsed, rate_hz=was.rate_hz, broken_rows=was.broken_rows)
    return was.proximal, was.distal, smoothing


def twist_cutoff(measured: Measurement, settings: Settings) -> float:
    """Cut-off (Hz) that a twist needs: that of residual analysis, without a ceiling, so that speeds are kept."""
    proximal, distal, smoothing = _as_recorded(measured)
    try:
        found = smoothing.automatic(proximal, distal, settings).cutoff_hz or _TWIST_HZ
    except SettingError:  # too few frames to tell motion from noise
        found = _TWIST_HZ
    low, high = (share * smoothing.rate_hz for share in _POSSIBLE_SHARES)
    return float(np.clip(found, low, high))


def smoothed_displacement(measured: Measurement, cutoff_hz: float) -> Float:
    """Displacements (N, 8) since the reference, of the bodies as a filter leaves them on the clock of the analysis."""
    smoothing = measured.smoothing
    low, high = (share * smoothing.rate_hz for share in _POSSIBLE_SHARES)
    smoothing = smoothing._replace(cutoff_hz=float(np.clip(cutoff_hz, low, high)))
    return _since_reference(*smoothing.apply(measured.proximal, measured.distal), measured)


def _since_reference(proximal: RigidBody | None, distal: RigidBody, measured: Measurement) -> Float:
    proximal_pose = IDENTITY if proximal is None else proximal.dual_quat_lab_body
    return multiply(conjugate(measured.joint.reference), multiply(conjugate(proximal_pose), distal.dual_quat_lab_body))


def measured_steps(measured: Measurement, settings: Settings) -> HelicalSteps | None:
    """Take the axes from step to step; None where none are asked for."""
    if settings.step_deg is None:
        return None
    return helical_steps(
        measured.displacement,
        measured.course,
        measured.joint,
        measured.screw.frame,
        measured.screw.time_s,
        measured.change,
        step=float(np.radians(settings.step_deg)),
        sense=measured.sense.direction,
        noise=measured.noise.known,
        noise_gain=measured.noise_gain,
    )
