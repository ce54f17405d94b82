"""Which type of joint moved, and where its axes or its center are; frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.choices import StatedJoint
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.joint_axis import AxisWander
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.model.table_record import TableRecord

BALL_95: Final = 2.795483
"""Radius that holds 95 % of three normal errors alike: root of the quantile of chi-square with 3 degrees of freedom."""

JointTypeName = Literal[StatedJoint, "undetermined"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TypeCandidate:
    """A type that was tried.

    Attributes
    ----------
    type : str
    residual_rotation, residual_translation : float
        RMS that it leaves, rad and m.
    heldout_variance : float
        Whitened variance that it leaves of frames it was not fitted to, for each degree of freedom;
        NaN where it did not matter.
    shared, per_frame : int
        Numbers that all frames share, and that each has of its own.
    valid : bool
        Whether the frames determine it: no phantom, no center beyond 50 mm.
    """

    type: JointTypeName
    residual_rotation: float
    residual_translation: float
    heldout_variance: float
    shared: int
    per_frame: int
    valid: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointLine(ArrayRecord):
    """One of two axes.

    Attributes
    ----------
    direction_proximal, point_proximal, direction_distal, point_distal : ndarray, shape (3,)
        In the frames of the bodies, with the joint in its reference pose; the point is where `point_radius` holds.
    axis_cone, point_radius : float
        Half-angle (rad) and radius (m) that hold 95 %, in the body the axis is fixed in: the first in the proximal one.
    other_cone, other_radius : float
        The same in the other body, with the error of the reference pose, through which it is seen there.
    axis_sd : float
        Larger of the two tilts' standard deviations, rad.
    range : float
        From the 5 % to the 95 % quantile of the angle, rad.
    angle_sd : float
        Median standard deviation of the angle of a frame, rad.
    determined : bool
        Whether the range is 12 times that, times the root of how many frames count as one, the direction known to
        10 deg, and the two axes not drawn together by errors.
    wander : AxisWander or None
        How far it moves with its own angle in the body it is fixed in; where it does, the line is its mean. None where
        it is not tested, as where one of two axes is not determined, or where 45 deg would not be seen.
    """

    direction_proximal: Float
    point_proximal: Float
    direction_distal: Float
    point_distal: Float
    axis_cone: float
    point_radius: float
    other_cone: float
    other_radius: float
    axis_sd: float
    range: float
    angle_sd: float
    determined: bool
    wander: AxisWander | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """A number with its standard deviation; NaN where that is not known."""

    value: float
    sd: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TwoAxes(ArrayRecord):
    """Two axes, the first fixed in the proximal body, the second in the distal one.

    Attributes
    ----------
    axis1, axis2 : JointLine
    covariance : ndarray, shape (12, 12)
        Of tilts and shifts of axis 1, four numbers between the axes, and tilts and shifts of axis 2, under noise of the
        residuals' size and autocorrelation; cones, radii and deviations have all that tells of errors in them. The four
        between are along any basis of the twists across both axes, which only this joint has: they compare with no
        other joint's.
    angle_between : Measure
        Folded to 90 deg at most, rad.
    distance, foot1, foot2 : Measure or None
        Along the common normal (m, positive on the side of ``axis 1 x axis 2``), and of its feet along each axis (m)
        from the point nearest the body's origin; None for parallel axes.
    offset : Measure or None
        Distance of parallel axes, m; None where they are not parallel.
    order_determined : bool
        Whether the motion tells which of both is the one in the proximal body: a motion about one at a time, from one
        and the same pose, does not.
    only_wander_doubted : bool
        Whether the type is approximate for no other reason than that an axis wanders: it has two axes all the same.
    """

    axis1: JointLine
    axis2: JointLine
    covariance: Float
    angle_between: Measure
    distance: Measure | None
    foot1: Measure | None
    foot2: Measure | None
    offset: Measure | None
    order_determined: bool = True
    only_wander_doubted: bool = False

    @property
    def lines(self) -> tuple[JointLine, JointLine]:
        """Both axes."""
        return self.axis1, self.axis2

    @property
    def wanders(self) -> bool:
        """Whether one of both wanders."""
        return any(line.wander is not None and line.wander.significant for line in self.lines)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BallJoint(ArrayRecord):
    """A center.

    Attributes
    ----------
    center_proximal, center_distal : ndarray, shape (3,)
        In the frames of both bodies, m.
    covariance : ndarray, shape (6, 6)
        Of both, in that order, along the axes of the bodies, as that of `TwoAxes`.
    radius : float
        That holds 95 % of the center in the proximal body, m.
    score_proximal, score_distal : ndarray, shape (3,)
        Center by SCoRE, beside it: in the frames of both bodies, m.
    """

    center_proximal: Float
    center_distal: Float
    covariance: Float
    radius: float
    score_proximal: Float
    score_distal: Float

    @property
    def semi_axes(self) -> Float:
        """Semi-axes (3, 3), a row each, m, of the ellipsoid that holds 95 % of the center in the proximal body.

        The covariance gives its shape, the radius its size.
        """
        block = self.covariance[:3, :3]
        if not (np.isfinite(block).all() and np.trace(block) > 0.0):
            return np.full((3, 3), np.nan)
        values, vectors = np.linalg.eigh(block / np.trace(block))
        # A radius holds 95 % at 1.96 standard deviations of one direction alone, at 2.795/sqrt(3) of three alike.
        roundness = (1.0 / values[-1] - 1.0) / 2.0
        factor = NORMAL_95 + (BALL_95 / np.sqrt(3.0) - NORMAL_95) * roundness
        found: Float = BALL_95 * self.radius / factor * np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T
        return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SecondRotation(ArrayRecord):
    """What rotates beside a hinge.

    Attributes
    ----------
    range : float
        rad.
    axis : JointLine or None
        None where its direction is not determined.
    """

    range: float
    axis: JointLine | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointType(ArrayRecord):
    """Which joint it is, and its numbers.

    Attributes
    ----------
    type : str
    status : {"determined", "approximate", "forced"} or None
    reason : str
    candidates : tuple of TypeCandidate
        The types that were tried, simplest first.
    two_axes : TwoAxes or None
    ball : BallJoint or None
    second_rotation : SecondRotation or None
        Beside a hinge.
    decided_by : {"A", "B", "J"} or None
        What the cone of axis 1, or the radius of the center, stands on: the markers' own motion, the residuals'
        spectrum, or blocks of the motion; None of other types.
    coordinates : JointCoordinates or None
        The motion that the joint allows; None of a joint without angles. Its axes are those that leave least, and not
        the means of axes that wander.
    angle, angle_sd : ndarray, shape (N, k)
        Of each frame, rad, from the reference pose: one of a hinge, two of two axes, the rotation vector of a ball in
        the proximal body's axes, none of a rigid joint. NaN where there is no pose.
    residual_rotation, residual_translation : ndarray, shape (N,)
        That the joint leaves in each frame, rad and m.
    """

    type: JointTypeName
    status: Literal["determined", "approximate", "forced"] | None
    reason: str
    candidates: tuple[TypeCandidate, ...]
    two_axes: TwoAxes | None
    ball: BallJoint | None
    second_rotation: SecondRotation | None
    decided_by: Literal["A", "B", "J"] | None
    coordinates: JointCoordinates | None
    angle: Float
    angle_sd: Float
    residual_rotation: Float
    residual_translation: Float

    @property
    def has_angles(self) -> bool:
        """Whether it is a joint that has angles, and the motion tells them."""
        tried = [candidate.valid for candidate in self.candidates if candidate.type == self.type]
        return bool(self.angle.shape[1] and all(tried))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointAngles(TableRecord):
    """The joint's own angles in every frame, zero at the reference pose; NaN where they are not known.

    Attributes
    ----------
    frame, time_s : ndarray, shape (N,)
    angle, angle_sd : ndarray, shape (N, k)
        rad: about the axis of a hinge, about both axes, or the rotation vector of a ball in the proximal body's axes.
        The standard deviation is that by the noise of the frame and of the reference, scaled by the residuals where
        these are larger, and of two axes by the errors of the axes, too; NaN in frames that were filled.
    residual_rotation, residual_translation : ndarray, shape (N,)
        That the joint leaves of each measured pose, rad and m.
    """

    frame: NDArray[np.int64]
    time_s: Float
    angle: Float
    angle_sd: Float
    residual_rotation: Float
    residual_translation: Float

    @property
    def table(self) -> tuple[tables.Column, ...]:
        """Columns of ``joint_angles.csv`` for this joint."""
        return tables.JOINT_ANGLE_COLUMNS[self.angle.shape[1]]
