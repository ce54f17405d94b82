"""What ``summary.json`` and ``info`` say as types, so that a misspelled key is an error of the type checker.

A text below a key says what it is where name and unit do not; `docs/schemas` is made from it. Angles are degrees and
lengths millimeters; None is what is not known or not defined.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, NotRequired

from pydantic import Field
from typing_extensions import TypedDict

from elbowscrew.choices import BlendName, ExpressIn, KnotName, LawName, MethodName
from elbowscrew.model.anatomy import LandmarkFrame, Side
from elbowscrew.model.joint_summary_types import (
    AxisAgainstBones,
    FitName,
    JointTypeSummary,
    LineSummary,
    NumbersOfType,
    Vector,
)


class OtherFileSummary(TypedDict):
    """A file beside the recording's own."""

    name: str
    sha256: str


class SourceSummary(TypedDict):
    """Where the recording came from; all None where it is not from a file."""

    name: str | None
    sha256: str | None
    layout: str | None
    """Format of the file."""
    take: str | None
    length_unit: str | None
    rotation: str | None
    """Quaternion, or the order of the Euler angles; empty where the file has no rotations."""
    distal_file: OtherFileSummary | None
    """The distal body's file; None where both bodies stand in one file."""
    columns_file: OtherFileSummary | None
    """The file of --columns, by which a table was read; what it says is in the settings."""


class WarningSummary(TypedDict):
    """Something that the reader of a result must know; those that matter come first."""

    code: str
    message: str
    severity: Literal["warning", "note"]
    """A note tells of what is harmless or has been put right without loss."""
    frames: list[int]
    """The first frames concerned, ten at most."""
    count: int
    """How many frames are concerned; 0 where it is not a matter of frames."""


class ClockSummary(TypedDict):
    """How even the clock is."""

    missing_frames: int
    frame_gaps: int
    """In how many places frame numbers are left out."""
    repeated_frames: int
    """Places where the frame number does not increase."""
    largest_offset_s: float
    """How far the times stray from an even clock."""


class SpreadSummary(TypedDict):
    """Median, 95th percentile and largest."""

    median: float
    percentile_95: float
    largest: float


class BodySummary(TypedDict):
    """A body of the file."""

    name: str
    id: str


class QualitySummary(BodySummary):
    """How far a body's poses can be trusted."""

    tracked_share: float
    """Share of the frames with a measured pose."""
    lost_frames: dict[str, int]
    """Lost frames by reason."""
    sign_flips: int
    """How often the quaternion, as it is in the file, changes its sign."""
    leaps: int
    fastest_turn_deg_s: float | None
    """None where the file does not state what its angles or its clock are."""
    fastest_speed_m_s: float | None
    """None of a body without positions."""
    marker_residual_mm: SpreadSummary | None
    """RMS distance of the markers seen from the body's own."""
    reported_error_mm: SpreadSummary | None
    """The error column of the file."""
    pivot_offset_mm: float | None
    """Distance of the body's origin from the centroid of its markers."""
    shape_deviation: float | None
    """Largest distance of the triangular factor from the identity, where poses come of the dual QR decomposition."""
    markers: int


class RecordingSummary(TypedDict):
    """Frames, rate and clock of a recording."""

    frames: int
    first_frame: int
    last_frame: int
    rate_hz: Annotated[float, Field(gt=0)]
    """Frames per second."""
    duration_s: float
    clock: ClockSummary


class JointWords(TypedDict):
    """What the joint and its segments are called."""

    name: str
    proximal: str
    distal: str
    side: str | None
    """Left or right, where the bodies' names say it."""


class TrialSummary(RecordingSummary):
    """The recording, its bodies and their tracking."""

    joint: JointWords
    bodies: list[BodySummary]
    """All bodies of the file."""
    proximal: QualitySummary | None
    """None where the file has no such body and it is taken to stand still."""
    distal: QualitySummary
    measured_frames: int
    """Frames in which both bodies were tracked."""
    filled_frames: int
    """Frames of short gaps that were filled in."""
    missing_share: float
    """Share of the frames without a measured pose."""
    positions: bool
    """Whether positions were measured; else there are orientations alone, and all that needs a place is None."""
    reference_frame: int
    """The frame that displacements count from."""
    lowpass_hz: float | None
    """Cut-off of the filter that the poses went through; None if they went through none."""
    instantaneous_lowpass_hz: float | None
    """Cut-off of the filter that the instantaneous axes come of; None of a clock of several rates."""


class DominantAxis(TypedDict):
    """What gives the angle its sense."""

    direction: Vector
    ratio: float
    """Second eigenvalue of the second moments over the first: 0 for one axis, 1 for two that are alike."""


class MovementSummary(TypedDict):
    """A movement, from onset to offset."""

    onset_frame: int
    offset_frame: int


class JointAxisSummary(LineSummary):
    """The joint's axis, of one that wanders its mean; all of it stands in ``joint.json``."""

    model: FitName
    is_mean: bool
    """Whether the axis wanders, so that this is its mean over the range."""
    axis_cone95_deg: float | None
    """Half-angle of the cone that holds the direction with 95 %."""
    point_radius95_mm: float | None
    """Radius of the circle across the axis that holds its position with 95 %."""
    pitch_mm_per_rad: float | None
    """Slide for each radian; 0 for a hinge; None where positions were not measured."""
    interval_method: str | None
    """What the interval stands on."""
    sensitivity_deg_per_deg: float | None
    """Degrees that the axis turns for each degree that a cluster turns on its bone with the motion."""


class AngleRange(TypedDict):
    """An angle over the measured frames."""

    start_deg: float | None
    """In the first frame that has it."""
    min_deg: float | None
    max_deg: float | None
    range_deg: float | None


class AnglesOfBones(AxisAgainstBones):
    """The joint's angles by the landmarks, and the axis that it flexes about against the bones."""

    flexion: AngleRange
    carrying_angle: AngleRange | None
    """Of an elbow; varus positive, so that a valgus elbow's is negative."""
    pronation: AngleRange | None
    """Of an elbow."""
    adduction: AngleRange | None
    """Of a knee; varus positive."""
    internal_rotation: AngleRange | None
    """Of a knee."""


class MotionSummary(TypedDict):
    """The measured motion."""

    theta_max_deg: float
    theta_min_deg: float
    theta_max_frame: int
    signed: bool
    """Whether theta has a sense, that of the dominant axis; else it is the size of the rotation."""
    dominant_axis: DominantAxis
    largest_jump_deg: float
    """How far theta moves beyond the joint's own rotation from one frame to the next."""
    inversion_frames: list[int]
    """Where the motion turns back."""
    slide_median_mm: float | None
    slide_min_mm: float | None
    slide_max_mm: float | None
    repetitions: int
    movements: list[MovementSummary]
    expressed_in: ExpressIn
    """The frame of axes and points."""
    axis_frames: int
    """Measured frames whose rotation is large enough for an axis."""
    mean_axis: LineSummary
    """Mean of the axes, weighted by sin^2(theta/2)."""
    axis_dispersion_deg: float | None
    """Median angle of the axes from their mean direction, both over equal steps of the angle."""
    axis_dispersion_all_frames_deg: float | None
    """Median angle over all frames with an axis."""
    axis_dispersion_weighted_deg: float | None
    """RMS angle from the mean axis, with its weights."""
    axis_dispersion_rms_deg: float | None
    axis_dispersion_max_deg: float | None
    axis_distance_rms_mm: float | None
    """RMS distance of the axes from the mean axis; None where over 5 % of them are over 75 deg from it."""
    single_axis: bool
    """Whether the motion has one axis at all."""
    joint_type: JointTypeSummary
    joint_numbers: NumbersOfType
    """Those of `joint_type`."""
    joint_axis: JointAxisSummary | None
    """None where the motion has no single axis."""
    anatomy: AnglesOfBones | None
    """None without landmarks."""


class LawErrorSummary(TypedDict):
    """How far a law of motion is off the measured motion."""

    rms_displacement_mm: float | None
    """RMS displacement from a screw motion under the law."""
    rms_angle_deg: float | None
    """Where positions were not measured, the RMS angle from a rotation under the law."""


class PhaseLawSummary(LawErrorSummary):
    """The law of motion of one phase of the model."""

    law: str
    peak: float | None
    """Share of the phase at which the velocity is highest; None for the law's own."""
    peak_sd: float | None
    """Its standard deviation where it was fitted; None where it was not, or is not known."""
    start_frame: int
    end_frame: int


class SelectionPoint(TypedDict):
    """The least error with so many keyframes: RMS displacements, or where positions were not measured angles."""

    keyframes: int
    max_rms_displacement_mm: float | None
    rms_displacement_mm: float | None
    max_angle_deg: float | None
    rms_angle_deg: float | None


class SelectionSummary(TypedDict):
    """The fewest keyframes within a tolerance: a length, or where positions were not measured an angle."""

    tolerance_mm: float | None
    tolerance_deg: float | None
    frames: int
    """Frames that could be keyframes."""
    keyframes: int
    keyframe_frames: list[int]
    compression_ratio: float
    """Frames for each keyframe."""
    complete: bool
    """Whether the search looked at all pieces."""
    curve: list[SelectionPoint]


PointsSummary = TypedDict(
    "PointsSummary",
    {"from": str, "centroid_mm": Vector | None, "radius_of_gyration_mm": float | None},
)
"""The points over which the RMS displacement is averaged, and where they are from; None of orientations alone."""


class ModelSummary(TypedDict):
    """The model of the motion and its error at measured frames."""

    method: MethodName
    blend: BlendName
    law: LawName | str
    knots: KnotName
    keyframes: list[int]
    """Frames of the keyframes."""
    phases: int
    phase_laws: list[PhaseLawSummary]
    selection: SelectionSummary | None
    """How the keyframes were chosen, if a tolerance was given."""
    covered_share: float
    """Share of the recording's frames that the model covers."""
    rmse_theta_deg: float | None
    max_theta_error_deg: float | None
    max_theta_error_frame: int | None
    rms_angle_error_deg: float | None
    """Of the angle between modeled and measured orientation."""
    max_angle_error_deg: float | None
    max_angle_error_frame: int | None
    rms_translation_error_mm: float | None
    """Of the distance between modeled and measured origin of the distal body."""
    max_translation_error_mm: float | None
    max_translation_error_frame: int | None
    rms_displacement_mm: float | None
    """RMS over the frames of the RMS displacement of the points."""
    max_rms_displacement_mm: float | None
    max_rms_displacement_frame: int | None
    rms_axis_error_deg: float | None
    """Of the angle between modeled and measured screw axis."""
    max_axis_error_deg: float | None
    max_axis_error_frame: int | None
    rms_axis_distance_mm: float | None
    """Of the distance between them."""
    max_axis_distance_mm: float | None
    max_axis_distance_frame: int | None
    points: PointsSummary


class LandmarkSummary(TypedDict):
    """A landmark as it was asked for: by markers, or by its position in the frame of a body."""

    markers: NotRequired[list[str]]
    body: NotRequired[LandmarkFrame]
    mm: NotRequired[Vector]


class LandmarksSummary(TypedDict):
    """The landmarks as they were asked for: all of one joint."""

    side: Side
    EL: NotRequired[LandmarkSummary]
    """Lateral epicondyle."""
    EM: NotRequired[LandmarkSummary]
    """Medial epicondyle."""
    US: NotRequired[LandmarkSummary]
    """Ulnar styloid."""
    RS: NotRequired[LandmarkSummary]
    """Radial styloid."""
    GH: NotRequired[LandmarkSummary]
    """Center of the glenohumeral joint."""
    FLE: NotRequired[LandmarkSummary]
    """Lateral femoral epicondyle."""
    FME: NotRequired[LandmarkSummary]
    """Medial femoral epicondyle."""
    HC: NotRequired[LandmarkSummary]
    """Center of the hip."""
    LC: NotRequired[LandmarkSummary]
    """Lateral tibial condyle."""
    MC: NotRequired[LandmarkSummary]
    """Medial tibial condyle."""
    LM: NotRequired[LandmarkSummary]
    """Lateral malleolus."""
    MM: NotRequired[LandmarkSummary]
    """Medial malleolus."""


class Summary(TypedDict):
    """What ``summary.json`` holds: results, quality, every setting, and where they come from."""

    elbowscrew: str
    """Version of the program."""
    source: SourceSummary
    settings: dict[str, Any]
    """Every setting by the name of its option."""
    landmarks: LandmarksSummary | None
    trial: TrialSummary
    motion: MotionSummary
    interpolation: ModelSummary
    warnings: list[WarningSummary]
    versions: dict[str, str]
    """Versions of Python, of the libraries that the results depend on, and of plug-ins that were asked for."""


class FileClock(TypedDict):
    """Frames and clock of a file; rate and clock are None where it does not state a rate that it needs."""

    frames: int
    first_frame: int
    last_frame: int
    rate_hz: float | None
    """Frames per second."""
    duration_s: float | None
    clock: ClockSummary | None


class FileTrial(FileClock):
    """Frames, clock and bodies of a file."""

    bodies: list[QualitySummary]
    """Rigid bodies in the order of their numbers, then the bones that were asked for."""


class MarkerSummary(TypedDict):
    """A marker of the file."""

    name: str
    seen_share: float | None
    """Share of the frames in which it was seen; None if it was not asked for."""


class MissingSummary(TypedDict):
    """What the file does not say, and an analysis must be told."""

    option: str
    lacks: str
    give: str


class RolesSummary(TypedDict):
    """Which body would be which segment."""

    proximal: str | None
    distal: str | None
    joint: str | None
    text: str


class FileSummary(TypedDict):
    """What ``info --json`` prints: what a file holds."""

    elbowscrew: str
    """Version of the program."""
    source: SourceSummary
    trial: FileTrial
    markers: list[MarkerSummary]
    bones: list[str]
    """Bones of skeletons, which are analyzed where they are named."""
    roles: RolesSummary
    missing: list[MissingSummary]
    next: NotRequired[str]
    """The line that analyzes the file, for a shell; words in capitals stand for what is not known."""
    warnings: list[WarningSummary]
