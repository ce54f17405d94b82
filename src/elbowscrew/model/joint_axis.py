"""The axis of the joint as a whole, and the noise it is known with; frozen, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.choices import MarkersTold
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.table_record import TableRecord


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PoseNoise(ArrayRecord):
    """Noise of one body's poses, alike in all frames and independent from frame to frame.

    Attributes
    ----------
    covariance : ndarray, shape (6, 6)
        Of the rotation vector (rad) and of the origin's position (m), in the body's frame.
    source : str
        Where it is known from.
    marker_noise : float or None
        Standard deviation of each coordinate of each marker, meters; None if it was found without markers.
    jitter : ndarray, shape (6, 6), or None
        How the poses themselves jitter from frame to frame, where the file tells of no markers.
    """

    covariance: Float
    source: str
    marker_noise: float | None
    jitter: Float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LineEstimate(ArrayRecord):
    """One estimate of a joint's line, in the frame the screws are expressed in.

    Attributes
    ----------
    direction, point : ndarray, shape (3,)
        Unit vector, and the point (m) nearest the origin.
    direction_proximal, point_proximal, direction_distal, point_distal : ndarray, shape (3,)
        The same line in the frames of the two bodies.
    """

    direction: Float
    point: Float
    direction_proximal: Float
    point_proximal: Float
    direction_distal: Float
    point_distal: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FittedJoint(ArrayRecord):
    """A hinge or screw-hinge fitted to all relative poses by maximum likelihood.

    Attributes
    ----------
    line : LineEstimate
    covariance : ndarray, shape (P, P)
        Of tilt and shift (two each) of the line in the proximal body, the same in the distal one, slide at the
        reference, and the pitch of a screw-hinge.
    axis_sd, point_sd : float
        Of the line as expressed: direction (rad) and position nearest the distal body (m), both components.
    axis_cone, point_radius : float
        Half-angle (rad) and radius (m) that hold 95 % for the clusters' frames, the radius about the line's point
        nearest the origin; as the standard deviations, NaN where they are not known: the frames are too few to tell,
        or leave the direction more than a right angle undetermined.
    skin_cone, skin_radius : float
        Part that the stated motion of the clusters as a whole has in cone (rad) and radius (m), in quadrature.
    decided_by : {"A", "B", "J"} or None
        What the cone stands on: the markers' own motion, the residuals' spectrum, or blocks of the motion.
    pitch, pitch_sd : float
        Slide for each radian (m/rad); 0 for a hinge.
    pitch_sure : float
        Limit (m/rad) that a pitch of 0 exceeds in 0.27 % of the trials; 0 for a hinge.
    sensitivity : float
        Degrees that the axis turns for each degree that a cluster turns on its bone with the flexion.
    residual_rotation, residual_translation : float
        RMS over the frames of what the model leaves: rotation across the axis (rad), and translation at the axis (m).
    noise_ratio : float
        RMS of the whitened residuals: 1 where the stated noise explains them.
    correlation : float
        How many frames count as one: integrated autocorrelation of the residuals, 1 for white noise.
    used : ndarray, shape (F,)
        Rows of the frames fitted.
    weight : ndarray, shape (F,)
        Of each of them: 1, or less for outliers of a robust fit.
    """

    line: LineEstimate
    covariance: Float
    axis_sd: float
    point_sd: float
    axis_cone: float
    point_radius: float
    skin_cone: float
    skin_radius: float
    decided_by: Literal["A", "B", "J"] | None
    pitch: float
    pitch_sd: float
    pitch_sure: float
    sensitivity: float
    residual_rotation: float
    residual_translation: float
    noise_ratio: float
    correlation: float
    used: NDArray[np.int64]
    weight: Float


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisWander:
    """How far a joint's axis moves while the joint goes from one end of its range to the other.

    Attributes
    ----------
    tilt, tilt_sd : float
        By how much its direction changes, rad.
    shift, shift_sd : float
        By how much it moves across itself, m, at its point nearest the distal body's origin at the reference.
    significant : bool
        Whether one of both is beyond what an axis that stays shows in 0.27 % of the trials.
    unseen_tilt, unseen_shift : float
        Up to so much (rad, m) an axis may wander without being told from one that stays.
    """

    tilt: float
    tilt_sd: float
    shift: float
    shift_sd: float
    significant: bool
    unseen_tilt: float
    unseen_shift: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeanLine(ArrayRecord):
    """Mean over the range of an axis that wanders.

    Attributes
    ----------
    line : LineEstimate
        As expressed it is the mean of `AxisPath`; in each body, the mean of the axis' positions in that body.
    axis_sd, point_sd, axis_cone, point_radius, skin_cone, skin_radius : float
        As those of `FittedJoint`.
    decided_by : {"A", "B", "J"} or None
    """

    line: LineEstimate
    axis_sd: float
    point_sd: float
    axis_cone: float
    point_radius: float
    skin_cone: float
    skin_radius: float
    decided_by: Literal["A", "B", "J"] | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AxisPath(TableRecord):
    """An axis that wanders, against the angle, in the frame the screws are expressed in.

    Attributes
    ----------
    angle : ndarray, shape (K,)
        Middles of equal parts of the fitted joint's range, rad, from the reference and positive about the axis.
    direction, point : ndarray, shape (K, 3)
        Unit vectors, and points (m) nearest the origin.
    axis_sd, point_sd : ndarray, shape (K,)
        Standard deviations (rad, m) as those of `FittedJoint`.
    frames : ndarray, shape (K,)
        How many of the frames that were fitted are in each part.
    """

    table: ClassVar = tables.AXIS_PATH_COLUMNS

    angle: Float
    direction: Float
    point: Float
    axis_sd: Float
    point_sd: Float
    frames: NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointAxis(ArrayRecord):
    """All estimates of the joint's axis, side by side.

    Attributes
    ----------
    single : bool
        Whether the motion has one axis at all, or is stated to have one; without, no fit is given.
    hinge, screw_hinge : FittedJoint or None
        Maximum likelihood; the screw-hinge slides in proportion to its angle, and is None where positions are not
        measured.
    weighted_mean, sara : LineEstimate
        Mean of the finite helical axes with weights ``sin^2(theta/2)`` (Woltring 1994), and the symmetrical axis of
        rotation approach (Ehrig, Taylor, Duda and Heller 2007).
    unexplained : float
        RMS rotation that a hinge leaves over the RMS rotation about it: 0 for a hinge, 1 and more for a ball joint.
    stated : {"hinge", "screw_hinge"} or None
        Which of both the joint is stated to be.
    markers_told : {"motion", "errors"} or None
        What the file tells of the moving bodies' markers: how they move among themselves, or of one of the bodies no
        more than how large their errors are; None if of one it tells nothing.
    noise : mapping of str to PoseNoise or None
        Of "proximal" and "distal".
    wander : AxisWander or None
        Of the preferred fit; None without one, or where the frames do not tell.
    mean_axis : MeanLine or None
        Where the axis wanders.
    path : AxisPath or None
        Where the axis wanders.
    """

    single: bool
    hinge: FittedJoint | None
    screw_hinge: FittedJoint | None
    weighted_mean: LineEstimate
    sara: LineEstimate
    unexplained: float
    noise: Mapping[str, PoseNoise | None]
    wander: AxisWander | None = None
    mean_axis: MeanLine | None = None
    path: AxisPath | None = None
    stated: Literal["hinge", "screw_hinge"] | None = None
    markers_told: MarkersTold | None = None

    @property
    def preferred(self) -> Literal["hinge", "screw_hinge"] | None:
        """The fit to believe: the screw-hinge where its pitch is beyond what a hinge shows, else the hinge."""
        if self.hinge is None:
            return None
        if self.screw_hinge is None:
            return "hinge"
        if self.stated is not None:
            return self.stated
        pitched = abs(self.screw_hinge.pitch) > self.screw_hinge.pitch_sure
        return "screw_hinge" if pitched else "hinge"

    @property
    def best(self) -> FittedJoint | None:
        """The preferred fit itself; None where the motion has no single axis."""
        return self.screw_hinge if self.preferred == "screw_hinge" else self.hinge

    @property
    def headline(self) -> FittedJoint | MeanLine | None:
        """The line to tell first: the mean axis where the axis wanders, else the preferred fit's."""
        return self.best if self.mean_axis is None else self.mean_axis
