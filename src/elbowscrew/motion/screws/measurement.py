"""From a recording to the measured motion of the joint: poses, displacement, and the screw of every frame."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import ExpressIn
from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, multiply, pose_from_dual_quat
from elbowscrew.joints import Joint
from elbowscrew.model import BodyQuality, JointMotion, QualityWarning, Recording, RigidBody, ScrewMotion, Sense
from elbowscrew.motion.screws.frames import frame_called
from elbowscrew.motion.screws.helical import HelicalSeries, helical_series
from elbowscrew.motion.screws.pose_noise import JointNoise
from elbowscrew.motion.screws.relative import displacement, expressed, fill_doubts, frame_change, joint_from_bodies
from elbowscrew.motion.screws.sense import rotation_noise, sense_of
from elbowscrew.motion.screws.sense_doubts import sense_warnings
from elbowscrew.motion.screws.uncertainty import (
    ScrewErrors,
    joint_covariance,
    known_errors,
    least_angle,
    no_errors,
    screw_errors,
)
from elbowscrew.motion.smoothing.resampling import resample_recording, resampling_warnings
from elbowscrew.motion.smoothing.smoothing import Smoothing
from elbowscrew.motion.tracking.bodies import tracked_bodies
from elbowscrew.motion.tracking.clock import elapsed_time, fastest_rate, other_rate, row_of_frame
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings


class Unfiltered(NamedTuple):
    """The two bodies as they were tracked, before a filter and a change of rate.

    Attributes
    ----------
    proximal : RigidBody or None
    distal : RigidBody
    elapsed : ndarray, shape (M,)
        Their own clock, seconds.
    rate_hz : float
    broken_rows : ndarray of int
        Rows that a body reaches by a leap.
    """

    proximal: RigidBody | None
    distal: RigidBody
    elapsed: Float
    rate_hz: float
    broken_rows: NDArray[np.intp]

    @property
    def relative(self) -> Float:
        """Pose of the distal body in the proximal one, shape (M, 8); NaN where either has none."""
        distal = self.distal.dual_quat_lab_body
        return distal if self.proximal is None else multiply(conjugate(self.proximal.dual_quat_lab_body), distal)

    def fill_doubts(self, max_gap_s: float, frame: NDArray[np.int64]) -> tuple[QualityWarning, ...]:
        """Say where gaps that are filled may be far off; see `relative.fill_doubts`."""
        series = self.relative
        if np.isfinite(series[:, 0]).all():
            return ()
        noise = rotation_noise(series[:, :4])
        return fill_doubts(series, self.elapsed, self.rate_hz, max_gap_s, self.broken_rows, frame, noise)


class Measurement(NamedTuple):
    """What was measured, before anything is modeled.

    Attributes
    ----------
    recording : Recording
        As it is analyzed: resampled if that was asked for.
    proximal : RigidBody or None
    distal : RigidBody
    elapsed : ndarray, shape (N,)
        Even clock, seconds.
    joint : JointMotion
    displacement : ndarray, shape (N, 8)
        Since the reference, in the distal body's frame there (P 35).
    change : ndarray, shape (8,)
        Pose of that frame in the one the screws are expressed in.
    noise : JointNoise
    unfiltered : Unfiltered
        The bodies before the filter.
    smoothing : Smoothing
        The filter that the bodies have gone through.
    noise_gain : ndarray, shape (N,)
        Share of the noise's variance that it has left.
    line : ndarray, shape (N, 6)
        Axes as Plücker vectors, as expressed.
    screw : ScrewMotion
    sense : Sense
        Of the rotation since the reference, its direction as expressed.
    quality : tuple of BodyQuality
    named_joint : Joint
    express_in : {"distal", "proximal", "lab"}
        Frame the screws are written in, a segment's word resolved.
    warnings : tuple of QualityWarning
    """

    recording: Recording
    proximal: RigidBody | None
    distal: RigidBody
    elapsed: Float
    joint: JointMotion
    displacement: Float
    change: Float
    noise: JointNoise
    unfiltered: Unfiltered
    smoothing: Smoothing
    noise_gain: Float
    line: Float
    screw: ScrewMotion
    sense: Sense
    quality: tuple[BodyQuality, ...]
    named_joint: Joint
    express_in: ExpressIn
    warnings: tuple[QualityWarning, ...]

    @property
    def course(self) -> Float:
        """What turns back where the motion does, shape (N,), radians: theta, or without a sense the leading twist."""
        return self.sense.angle if self.sense.signed else self.sense.twist


def measure(recording: Recording, settings: Settings) -> Measurement:
    """Measure the motion of the joint (P 35) and the screw of every frame.

    Raises
    ------
    SettingError, AnalysisError, RecordingError
        As `elbowscrew.analyze`.
    """
    tracked = tracked_bodies(recording, settings)
    proximal, distal, broken_rows, warnings = tracked.proximal, tracked.distal, tracked.broken_rows, tracked.warnings
    express_in, doubts = frame_called(settings.express_in, tracked.joint)
    warnings += doubts
    elapsed = tracked.elapsed
    noise = JointNoise.of(proximal, distal, recording.rate_hz, settings)
    unfiltered = Unfiltered(proximal, distal, elapsed, recording.rate_hz, broken_rows)
    warnings += unfiltered.fill_doubts(settings.max_gap_s, recording.frame)
    own_hz, wanted_hz, none_broken = recording.rate_hz, settings.resample_hz, np.empty(0, dtype=np.intp)
    if wanted_hz is not None and settings.lowpass_hz is not None and other_rate(elapsed, own_hz) is not None:
        # A filter needs an even clock: here as fast as the recording ever is, so that nothing folds before the filter.
        even_hz = max(wanted_hz, fastest_rate(elapsed, own_hz))
        recording, proximal, distal = _resampled(recording, proximal, distal, elapsed, broken_rows, even_hz)
        elapsed, broken_rows = elapsed_time(recording), none_broken
    smoothing = Smoothing.of(proximal, distal, elapsed, recording.rate_hz, broken_rows, settings)
    proximal, distal = smoothing.apply(proximal, distal)
    if wanted_hz is not None:
        recording, proximal, distal = _resampled(recording, proximal, distal, elapsed, broken_rows, wanted_hz)
        folding = smoothing.cutoff_hz is None or smoothing.cutoff_hz > 0.5 * wanted_hz
        frames = {
            "--reference": settings.reference,
            "--keyframes": settings.keyframes,
            "--inversion": settings.inversion,
        }
        more = resampling_warnings(own_hz, wanted_hz, [name for name, given in frames.items() if given is not None])
        warnings += tuple(warning for warning in more if folding or warning.code != "aliasing")
        elapsed, broken_rows = elapsed_time(recording), none_broken
        smoothing = smoothing._replace(elapsed=elapsed, rate_hz=recording.rate_hz, broken_rows=broken_rows)
    joint = joint_from_bodies(
        proximal,
        distal,
        recording.frame,
        elapsed,
        recording.rate_hz,
        reference_row=None
        if settings.reference is None
        else row_of_frame(recording.frame, settings.reference, "reference"),
        reference_window=settings.reference_window,
        max_gap_s=settings.max_gap_s,
        broken_rows=broken_rows,
        lowpass_hz=smoothing.cutoff_hz,
    )
    D = displacement(joint)
    change = frame_change(joint, express_in)
    D_expressed = expressed(D, joint, express_in)
    gain = smoothing.noise_gain(joint.measured)
    sense = sense_of(
        D_expressed[:, :4],
        elapsed,
        joint.reference_row,
        sigma=_rotation_sigma(joint, noise, gain),
        signed=settings.signed,
    )
    series, errors = _measured_series(D, D_expressed, sense, joint, change, noise, gain, settings)
    screw = ScrewMotion(
        frame=recording.frame,
        time_s=recording.time_s,
        valid=joint.measured,
        filled=joint.filled,
        proximal_loss=np.zeros(recording.frame.size, dtype="U1") if proximal is None else proximal.loss_labels(),
        distal_loss=distal.loss_labels(),
        angle=series.angle,
        slide=series.slide,
        axis_direction=series.direction,
        axis_point=series.point,
        euler_parameters=D_expressed[:, :4],
        translation=pose_from_dual_quat(D_expressed)[1],
        angle_sd=errors.angle,
        slide_sd=errors.slide,
        axis_sd=errors.axis,
        point_sd=errors.point,
        axis_cone=errors.axis_cone,
        point_radius=errors.point_radius,
    )
    return Measurement(
        recording=recording,
        proximal=proximal,
        distal=distal,
        elapsed=elapsed,
        joint=joint,
        displacement=D,
        change=change,
        noise=noise,
        unfiltered=unfiltered,
        smoothing=smoothing,
        noise_gain=gain,
        line=series.line,
        screw=screw,
        sense=sense,
        quality=tracked.quality,
        named_joint=tracked.joint,
        express_in=express_in,
        warnings=warnings + sense_warnings(sense, recording.frame, settings.signed),
    )


def _resampled(
    recording: Recording,
    proximal: RigidBody | None,
    distal: RigidBody,
    elapsed: Float,
    broken_rows: NDArray[np.intp],
    rate_hz: float,
) -> tuple[Recording, RigidBody | None, RigidBody]:
    """Put the two bodies, as they are now, and the markers on another clock."""
    chosen = (distal,) if proximal is None else (proximal, distal)
    resampled = resample_recording(replace(recording, bodies=chosen, warnings=()), rate_hz, broken_rows, elapsed)
    proximal = None if proximal is None else resampled.bodies[0]
    return replace(resampled, warnings=recording.warnings), proximal, resampled.bodies[-1]


def _rotation_sigma(joint: JointMotion, noise: JointNoise, gain: Float) -> float | None:
    """Noise of a component of the rotation, radians, as the filter leaves it; None where it is not known."""
    unfiltered = rotation_noise_of(joint, noise)
    return None if unfiltered is None else float(unfiltered * np.sqrt(np.nanmedian(gain[joint.measured])))


def rotation_noise_of(joint: JointMotion, noise: JointNoise) -> float | None:
    """Noise of a component of the rotation, radians, before any filter; None where it is not known."""
    if noise.known is None:
        return None
    return float(np.sqrt(np.trace(joint_covariance(joint.reference, *noise.known)[:3, :3]) / 3.0))


def _measured_series(
    D: Float,
    D_expressed: Float,
    sense: Sense,
    joint: JointMotion,
    change: Float,
    noise: JointNoise,
    gain: Float,
    settings: Settings,
) -> tuple[HelicalSeries, ScrewErrors]:
    """Screws of all frames, with their errors, each axis known as well as the settings want it."""
    limit, least = np.inf, np.radians(settings.min_angle_deg)
    errors = no_errors(len(D))
    if noise.known is not None:
        errors = screw_errors(D, joint, *noise.known, change, settings.reference_window, gain)
        if settings.axis_sd_deg is not None:
            limit = np.radians(settings.axis_sd_deg)
            least = least_angle(limit, joint, *noise.known)
    elif settings.axis_sd_deg is not None:
        msg = "--axis-sd: the noise of the poses is not known here; give --marker-noise MM, or --min-angle in its place"
        raise SettingError(msg)
    series = helical_series(D_expressed, least, sense.angle, sense.sign)
    unsure = errors.axis > limit
    series.line[unsure], series.slide[unsure] = np.nan, np.nan
    peak = int(np.nanargmax(np.abs(series.angle)))
    if not np.isfinite(series.line[joint.measured]).any():
        found = f"the largest rotation since the reference is {in_digits(np.degrees(abs(series.angle[peak])), 3)} deg"
        if settings.axis_sd_deg is None:
            msg = (
                f"{found}, less than the {settings.min_angle_deg:g} deg an axis needs: no rotation to analyze "
                "(--min-angle sets the limit)"
            )
        else:
            best = np.degrees(np.nanmin(errors.axis, initial=np.inf))
            msg = (
                f"{found}, and no axis is known to the {settings.axis_sd_deg:g} deg of --axis-sd: the best is known "
                f"to {in_digits(best, 3)} deg; give a larger limit, or --min-angle"
            )
        raise AnalysisError(msg)
    return series, known_errors(errors, series.angle, np.isfinite(series.slide))
