"""What stands in ``joint.json`` as types, so that a misspelled key is an error of the type checker.

A text below a key says what it is where name and unit do not; `docs/schemas` is made from it. Angles are degrees and
lengths millimeters; None is what is not known or not defined.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from elbowscrew.choices import ExpressIn, MarkersTold
from elbowscrew.model.anatomy import BonyJoint, FunctionalAxisName, Side
from elbowscrew.model.joint_type import JointTypeName

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[float], Field(min_length=4, max_length=4)]
FitName = Literal["hinge", "screw_hinge"]


class LineSummary(TypedDict):
    """A line: its direction, a unit vector, and its point nearest the origin, None where that is not known."""

    direction: Vector
    point_mm: Vector | None


class EstimateSummary(LineSummary):
    """An estimate of the joint's axis, in the frame the screws are expressed in and in those of the bodies."""

    direction_in_proximal: Vector
    point_in_proximal_mm: Vector | None
    direction_in_distal: Vector
    point_in_distal_mm: Vector | None


class FitSummary(EstimateSummary):
    """A hinge or screw-hinge fitted to all relative poses by maximum likelihood."""

    frames: int
    """Frames that it was fitted to."""
    axis_sd_deg: float | None
    """Standard deviation of the direction, both components together."""
    axis_cone95_deg: float | None
    """Half-angle of the cone that holds the direction with 95 %."""
    point_sd_mm: float | None
    """Standard deviation of the axis' position, both components together."""
    point_radius95_mm: float | None
    """Radius of the circle across the axis that holds its position with 95 %."""
    sensitivity_deg_per_deg: float | None
    """Degrees that the axis turns for each degree that a cluster turns on its bone with the motion."""
    pitch_mm_per_rad: float | None
    """Slide for each radian; 0 for a hinge."""
    pitch_sd_mm_per_rad: float | None
    residual_rotation_deg: float | None
    """RMS rotation across the axis that the fit leaves."""
    residual_translation_mm: float | None
    """RMS translation at the axis that the fit leaves."""
    noise_ratio: float | None
    """RMS of the whitened residuals: 1 where the stated noise explains them."""
    frames_that_count_as_one: float | None
    """Integrated autocorrelation of the residuals: 1 for white noise."""
    outlier_share: float | None
    """Share of the frames that weigh less than half."""
    decided_by: Literal["A", "B", "J"] | None
    """What the interval stands on, in a letter."""
    interval_method: str | None
    """What the interval stands on, in words."""


class WanderSummary(TypedDict):
    """How far an axis moves while its joint goes from one end of its range to the other."""

    size_deg: float | None
    """By how much its direction turns."""
    size_sd_deg: float | None
    size_mm: float | None
    """By how much it moves across itself: one of two axes at its point, one alone nearest the distal body's origin."""
    size_sd_mm: float | None
    unseen_deg: float | None
    """How far an axis may turn without being distinguishable from a fixed one."""
    unseen_mm: float | None
    """How far it may shift without being distinguishable from a fixed one."""
    significant: bool
    """Whether one of both is beyond what an axis that stays shows in 0.27 % of the trials."""


class MeanAxisSummary(EstimateSummary):
    """Mean over the range of an axis that wanders; in each body, the mean of its positions in that body."""

    axis_sd_deg: float | None
    """Standard deviation of the direction, both components together."""
    axis_cone95_deg: float | None
    """Half-angle of the cone that holds the direction with 95 %."""
    point_sd_mm: float | None
    """Standard deviation of the axis' position, both components together."""
    point_radius95_mm: float | None
    """Radius of the circle across the axis that holds its position with 95 %."""
    decided_by: Literal["A", "B", "J"] | None
    """What the interval stands on, in a letter."""
    interval_method: str | None
    """What the interval stands on, in words."""


class CandidateSummary(TypedDict):
    """A type of joint that was tried."""

    type: JointTypeName
    residual_deg: float | None
    """RMS rotation that it leaves."""
    residual_mm: float | None
    """RMS translation that it leaves."""
    heldout_variance: float | None
    """Whitened variance of frames that it was not fitted to, for each degree of freedom."""
    shared: int
    """Numbers that all frames share."""
    per_frame: int
    """Numbers that each frame has of its own."""
    valid: bool
    """Whether the frames determine it."""


class JointLineSummary(EstimateSummary):
    """One of two axes, with the joint in its reference pose; the point is where the radius holds."""

    cone95_deg: float | None
    """Half-angle of the cone that holds the direction with 95 % in the axis' own body: the proximal one for axis 1."""
    radius95_mm: float | None
    """Radius of the circle across the axis that holds its position with 95 %, in the same body."""
    cone95_other_deg: float | None
    """The cone in the other body, with the error of the reference pose, through which the axis is seen there."""
    radius95_other_mm: float | None
    """The radius in the other body."""
    range_deg: float | None
    """Rotation about it, from the 5 % to the 95 % quantile."""
    angle_sd_deg: float | None
    """Median standard deviation of the rotation of a frame."""
    determined: bool
    """Whether the motion shows it well enough to be stated."""
    wander: WanderSummary | None
    """With its own angle, in its own body; where one of two axes wanders both are means. None where not known."""


class TwoAxesSummary(TypedDict):
    """Two axes, the first fixed in the proximal body, the second in the distal one.

    Low and high are 95 % limits. How the axes stand to each other is None where one of them is not determined.
    """

    axis1: JointLineSummary
    axis2: JointLineSummary
    angle_between_deg: float | None
    """Folded to 90 degrees at most."""
    angle_between_deg_low: float | None
    angle_between_deg_high: float | None
    distance_mm: float | None
    """Along the common normal, positive on the side of axis 1 x axis 2; None for parallel axes."""
    distance_mm_low: float | None
    distance_mm_high: float | None
    parallel_offset_mm: float | None
    """Distance of parallel axes; None where they are not parallel."""
    parallel_offset_mm_low: float | None
    parallel_offset_mm_high: float | None
    foot1_mm: float | None
    """Foot of the common normal along axis 1, from its point nearest the body's origin."""
    foot1_mm_low: float | None
    foot1_mm_high: float | None
    foot2_mm: float | None
    """The same along axis 2."""
    foot2_mm_low: float | None
    foot2_mm_high: float | None
    order_determined: bool
    """Whether the motion tells which of both axes is the one in the proximal body."""


def order_is_open(axes: TwoAxesSummary) -> bool:
    """Whether both axes are known, but not which of them is the proximal body's."""
    return axes["axis1"]["determined"] and axes["axis2"]["determined"] and not axes["order_determined"]


class CenterSummary(TypedDict):
    """One estimate of a center."""

    center_in_proximal_mm: Vector
    center_in_distal_mm: Vector


class BallSummary(TypedDict):
    """The center of a ball joint, by maximum likelihood."""

    center_in_proximal_mm: Vector
    center_in_distal_mm: Vector
    radius95_mm: float | None
    """Radius that holds the center in the proximal body with 95 %."""
    semi_axes95_mm: list[Vector] | None
    """Semi-axes of the ellipsoid that holds it with 95 %, in the proximal body."""
    score: CenterSummary
    """The same by SCoRE, which takes the measured rotations for true."""


class SecondRotationSummary(TypedDict):
    """What rotates beside a hinge."""

    range_deg: float | None
    axis: JointLineSummary | None
    """None where its direction is not determined."""


class JointTypeSummary(TypedDict):
    """Which type of joint moved."""

    type: JointTypeName
    status: Literal["determined", "approximate", "forced"] | None
    reason: str
    candidates: list[CandidateSummary]
    """The types that were tried, simplest first."""
    decided_by: Literal["A", "B", "J"] | None
    """What the intervals of the joint stand on, in a letter: markers, residuals or blocks."""
    interval_method: str | None
    """What the intervals of the joint stand on, in words."""
    markers_told: MarkersTold | None
    """What the file tells of the markers: how they move among themselves, how large their errors are, or nothing."""


class SkinMotionSummary(TypedDict):
    """How far each cluster is stated to move as a whole on its bone, and its part in the axis' interval."""

    mm: float
    deg: float
    part_deg: float | None
    """In the cone; it adds in quadrature."""
    part_mm: float | None
    """In the radius."""


class NumbersOfType(TypedDict):
    """The numbers of a joint's type; None where they do not apply."""

    two_axes: TwoAxesSummary | None
    ball: BallSummary | None
    second_rotation: SecondRotationSummary | None
    """What rotates beside a hinge; None also where it was not looked for."""
    wander: WanderSummary | None
    """None where it is not known."""


class DispersionSummary(TypedDict):
    """How far the finite axes of the frames lie from their mean, in direction and in place."""

    direction_median_deg: float | None
    direction_rms_deg: float | None
    direction_95_deg: float | None
    """95th percentile."""
    direction_max_deg: float | None
    direction_excursion_deg: float | None
    """Largest angle between two of the axes."""
    position_median_mm: float | None
    """Positions are None where over 5 % of the axes are over 75 deg from their mean: they pierce the plane anywhere."""
    position_rms_mm: float | None
    position_95_mm: float | None
    """95th percentile."""
    position_max_mm: float | None
    position_excursion_mm: float | None
    """Largest distance between two of the axes."""


class NoiseSummary(TypedDict):
    """Noise of one body's poses, alike in all frames, in the body's frame."""

    source: str
    """Where it is known from."""
    marker_noise_mm: float | None
    """Standard deviation of each coordinate of each marker."""
    rotation_sd_deg: Vector
    position_sd_mm: Vector | None


class NoiseOfBodies(TypedDict):
    """Noise of both bodies."""

    proximal: NoiseSummary | None
    distal: NoiseSummary | None


class RepeatabilitySummary(TypedDict):
    """How alike the cycles are."""

    repetitions: int
    icc: float | None
    """ICC(A,1) of the angle over the cycles' own time."""
    cmc: float | None
    """Coefficient of multiple correlation."""
    axis_sd_deg: float | None
    """Standard deviation of the direction of the axis from cycle to cycle."""
    point_sd_mm: float | None
    """Standard deviation of its position."""
    theta_max_sd_deg: float | None
    """Standard deviation of the largest angle."""


class AxisAgainstBones(TypedDict):
    """The axis that the joint flexes about, against the bones.

    Low and high are 95 % limits for the clusters' frames; the error of the landmarks themselves is not in them.
    """

    joint: BonyJoint
    """The joint that the landmarks are of."""
    side: Side
    axis: FunctionalAxisName | None
    """The joint's axis, its mean where it wanders, or the first of two axes; None where the motion shows none."""
    axis_angle_deg: float | None
    """Between that axis and the line of the epicondyles."""
    axis_angle_deg_low: float | None
    axis_angle_deg_high: float | None
    axis_distance_mm: float | None
    """Of that axis from the joint's center."""
    axis_distance_mm_low: float | None
    axis_distance_mm_high: float | None
    landmark_sensitivity_deg_per_mm: float
    """Degrees that the line of the epicondyles turns for each millimeter by which one of them is off across it."""
    joint_center_in_proximal_mm: Vector
    """The point midway between the epicondyles."""
    joint_center_in_distal_mm: Vector
    """The same point at the reference, in the distal body."""


class AnatomySummary(AxisAgainstBones):
    """The axis against the bones, and where these are."""

    epicondyle_direction_in_proximal: Vector
    """From the medial to the lateral epicondyle."""
    landmarks_mm: dict[str, list[float]]
    """The landmarks by name, each in the frame of its segment."""


class PoseSummary(TypedDict):
    """A pose: unit quaternion, scalar first, and position; the latter None where it was not measured."""

    quaternion: Quaternion
    position_mm: Vector | None


class BodiesSummary(TypedDict):
    """Where the bodies are at the reference, and their markers in their own frames."""

    distal_in_proximal: PoseSummary
    proximal_in_lab: PoseSummary
    proximal_markers_mm: list[Vector] | None
    distal_markers_mm: list[Vector] | None


class JointSummary(NumbersOfType):
    """What ``joint.json`` holds: the joint as a whole, by all estimators."""

    expressed_in: ExpressIn
    """The frame of directions and points that name no other."""
    joint_type: JointTypeSummary
    single_axis: bool
    """Whether the motion has one axis at all."""
    preferred: FitName | None
    """The fit to believe."""
    unexplained_share: float | None
    """RMS rotation that a hinge leaves over the RMS rotation about it."""
    hinge: FitSummary | None
    screw_hinge: FitSummary | None
    mean_axis: MeanAxisSummary | None
    """The headline where the axis wanders; None where it does not."""
    sensitivity_deg_per_deg: float | None
    """Degrees that the preferred fit's axis turns for each degree that a cluster turns on its bone with the motion."""
    skin_motion: SkinMotionSummary | None
    """None where none is stated."""
    weighted_mean: EstimateSummary
    """Mean of the finite helical axes with weights sin^2(theta/2)."""
    sara: EstimateSummary
    """Symmetrical axis of rotation approach."""
    dispersion: DispersionSummary
    noise: NoiseOfBodies
    repeatability: RepeatabilitySummary
    anatomy: AnatomySummary | None
    bodies: BodiesSummary
