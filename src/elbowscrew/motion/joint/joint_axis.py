"""The joint's axis by all estimators, side by side and in every frame, and whether there is one at all."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, Literal, NamedTuple

import numpy as np

from elbowscrew.choices import ExpressIn, MarkersTold
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.dual_quaternion import conjugate, pose_from_dual_quat, transform_lines
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model import FittedJoint, JointAxis, JointMotion, MarkerMotion
from elbowscrew.motion.joint.direction_fit import fit_direction
from elbowscrew.motion.joint.estimates import ProximalErrors, line_errors, line_estimate
from elbowscrew.motion.joint.influence import influence_of_fit
from elbowscrew.motion.joint.interval import (
    SURE,
    ClusterMotion,
    JointInterval,
    SkinMotion,
    joint_interval,
    skin_sensitivity,
)
from elbowscrew.motion.joint.joint_fit import LineFit, fit_joint, sara_lines
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.joint.nonrigid import Segment
from elbowscrew.motion.joint.wander import wander_of_axis
from elbowscrew.motion.joint.wander_result import told_wander
from elbowscrew.motion.screws.pose_noise import JointNoise
from elbowscrew.motion.screws.uncertainty import fitted_covariance

_MOST_FRAMES: Final = 20_000
LARGEST_UNEXPLAINED: Final = 0.25
"""Share of its rotation that a joint with a single axis may leave, RMS over RMS."""


class EstimatedAxis(NamedTuple):
    """The joint's axis by all estimators, and the errors of the headline; None where there is no single axis."""

    axis: JointAxis
    errors: ProximalErrors | None


def estimate_joint_axis(
    joint: JointMotion,
    angle: Float,
    mean_line: Float,
    noise: JointNoise,
    noise_gain: Float,
    *,
    express_in: ExpressIn,
    robust: bool,
    markers: tuple[BodyMarkers, ...] = (),
    skin: tuple[SkinMotion, ...] = (),
    stated: Literal["hinge", "screw_hinge"] | None = None,
) -> EstimatedAxis:
    """Estimate the joint's axis from all measured frames.

    Parameters
    ----------
    joint : JointMotion
    angle : ndarray, shape (N,)
        Rotation since the reference, radians, for the sense of the axis.
    mean_line : ndarray, shape (6,)
        Weighted mean of the finite axes in the distal body's frame at the reference.
    noise : JointNoise
    noise_gain : ndarray, shape (N,)
        Share of the noise's variance that a filter has left in each frame.
    express_in : {"distal", "proximal", "lab"}
    robust : bool
        Weigh outliers down in the fits.
    markers : tuple of BodyMarkers
        Of every body that moves; empty if one of them has none.
    skin : tuple of SkinMotion
        How the clusters are stated to move as a whole on their bones.
    stated : {"hinge", "screw_hinge"}, optional
        That the joint is stated to be, whatever it leaves.
    """
    rows, poses, covariance = fitted_frames(joint, noise, noise_gain)
    start = transform_lines(joint.reference, mean_line)
    near = pose_from_dual_quat(joint.reference)[1]
    if joint.located:
        hinge = fit_joint(poses, covariance, start, near, robust=robust)
        screw_hinge = fit_joint(poses, covariance, start, near, screw=True, robust=robust, start=hinge)
        fits = {False: hinge, True: screw_hinge}
    else:  # nothing tells of a slide
        hinge = fit_direction(poses, covariance, robust=robust)
        fits = {False: hinge}
    about_mean = hinge.angle - np.average(hinge.angle, weights=hinge.weight)
    spread = _rms(about_mean[:, None], hinge.weight)
    unexplained = _rms(hinge.residual[:, :2], hinge.weight) / spread if spread > 0.0 else np.inf
    single = bool(stated is not None or unexplained <= LARGEST_UNEXPLAINED)
    told = noise.known is not None
    clusters = clusters_of(markers, rows)
    influences = {screw: influence_of_fit(fit, poses, covariance) for screw, fit in fits.items()}
    reference = {screw: _reference_angle(fit, rows, joint) for screw, fit in fits.items()}
    fitted: dict[bool, FittedJoint] = {}
    errors: dict[bool, ProximalErrors] = {}
    for screw, influence in influences.items():
        fit = fits[screw]
        interval = joint_interval(influence, clusters, skin=skin, reference_angle=reference[screw], noise_known=told)
        fitted[screw] = _fitted_joint(fit, interval, joint, rows, express_in, start, noise, noise_known=told)
        shared, known = np.eye(len(fitted[screw].covariance)), bool(np.isfinite(fitted[screw].covariance).all())
        errors[screw] = ProximalErrors(interval, shared[:2], shared[2:4], fit.proximal, known)
    proximal_line, distal_line = sara_lines(poses, angle[rows])
    found = JointAxis(
        single=single,
        hinge=fitted.get(False),
        screw_hinge=fitted.get(True),
        weighted_mean=line_estimate(start, mean_line, joint, express_in),
        sara=line_estimate(proximal_line, distal_line, joint, express_in),
        unexplained=unexplained,
        noise={"proximal": noise.proximal, "distal": noise.distal},
        stated=stated,
        markers_told=told_by(markers),
    )
    if found.best is None:
        return EstimatedAxis(found, None)
    screw = found.preferred == "screw_hinge"
    wander = wander_of_axis(
        fits[screw], influences[screw], clusters, skin=skin, reference_angle=reference[screw], noise_known=told
    )
    if wander is None or not np.isfinite(found.best.covariance).all():
        return EstimatedAxis(found, errors[screw])
    away = told_wander(wander, fits[screw], reference[screw], joint, noise, start, express_in=express_in)
    found = replace(found, wander=away.wander, mean_axis=away.mean_axis, path=away.path)
    return EstimatedAxis(found, away.errors or errors[screw])


def fitted_frames(joint: JointMotion, noise: JointNoise, noise_gain: Float) -> tuple[Index, Float, Float]:
    """Rows (F,) of the frames that a joint is fitted to, their poses (F, 8) and the covariances (F, 6, 6) of these."""
    rows = np.flatnonzero(joint.measured)
    rows = evenly_thinned(rows, _MOST_FRAMES)
    poses = joint.dual_quat_proximal_distal[rows]
    return rows, poses, fitted_covariance(joint, poses, *noise.assumed, gain=noise_gain[rows])


class BodyMarkers(NamedTuple):
    """What a body's markers tell of their own motion.

    Attributes
    ----------
    segment : {"proximal", "distal"}
    shape : ndarray, shape (M, 3)
        Their positions in the body.
    motion : MarkerMotion or None
        How they move among themselves.
    rms : ndarray, shape (N,), or None
        Their RMS in each frame, which tells less, but also where some are hidden.
    unseen : bool
        Whether the file does not have them, and tells only how large their errors are.
    pose_variance : float, optional
        Of unseen markers: the jitter of the body's position, square meters, a coordinate.
    """

    segment: Segment
    shape: Float
    motion: MarkerMotion | None
    rms: Float | None
    unseen: bool = False
    pose_variance: float | None = None

    def at(self, rows: Index) -> ClusterMotion:
        """Of the frames that a joint is fitted to."""
        motion = self.motion
        return ClusterMotion(
            segment=self.segment,
            shape=self.shape,
            nonrigid=None if motion is None else motion.at(rows),
            rms=None if self.rms is None else self.rms[rows],
            own_shape=motion is not None and motion.own_shape,
            pose_variance=self.pose_variance,
        )


def told_by(markers: tuple[BodyMarkers, ...]) -> MarkersTold | None:
    """What the file tells of the markers' motion."""
    return None if not markers else "errors" if any(one.unseen for one in markers) else "motion"


def clusters_of(markers: tuple[BodyMarkers, ...], rows: Index) -> tuple[ClusterMotion, ...]:
    """What the markers tell of the frames that a joint is fitted to."""
    return tuple(one.at(rows) for one in markers)


def _reference_angle(fit: LineFit, rows: Index, joint: JointMotion) -> float:
    return float(fit.angle[int(np.argmin(np.abs(rows - joint.reference_row)))])


def _fitted_joint(
    fit: LineFit,
    interval: JointInterval,
    joint: JointMotion,
    rows: Index,
    express_in: ExpressIn,
    start: Float,
    noise: JointNoise,
    *,
    noise_known: bool,
) -> FittedJoint:
    proximal, distal = transform_lines(fit.proximal, Z_LINE), transform_lines(fit.distal, Z_LINE)
    if proximal[:3] @ start[:3] < 0.0:
        proximal, distal = -proximal, -distal
    covariance = fit.covariance(noise_known=noise_known)
    first = 4 if express_in == "distal" else 0
    line = line_estimate(proximal, distal, joint, express_in)
    shared = np.eye(len(covariance))
    tilt, shift = shared[first : first + 2], shared[first + 2 : first + 4]
    pose = fit.distal if express_in == "distal" else fit.proximal
    errors = line_errors(interval, covariance, tilt, shift, pose, line, joint, noise, express_in=express_in)
    known = bool(np.isfinite(covariance).all())
    pitched = len(covariance) > 9
    pitch = shared[9:]
    return FittedJoint(
        line=line,
        covariance=covariance,
        **errors._asdict(),
        pitch=fit.pitch,
        pitch_sd=interval.radius(pitch) / NORMAL_95 if pitched and known else 0.0 if not pitched else float("nan"),
        pitch_sure=interval.radius(pitch, SURE) if pitched and known else 0.0 if not pitched else float("nan"),
        sensitivity=skin_sensitivity(fit.angle, fit.weight),
        residual_rotation=_rms(fit.residual[:, :2], fit.weight),
        residual_translation=_rms(fit.residual[:, 3:], fit.weight),
        noise_ratio=fit.noise_ratio if noise_known else float("nan"),
        correlation=fit.correlation,
        used=rows,
        weight=fit.weight,
    )


def distal_line(line: Float, change: Float) -> Float:
    """Write a line (6,) of the frame the screws are expressed in, in the distal body's at the reference."""
    return transform_lines(conjugate(change), line)


def _rms(residual: Float, weight: Float) -> float:
    return float(np.sqrt(np.average(np.sum(residual**2, axis=1), weights=weight)))
