"""Results: what an analysis finds, frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.joints import Joint
from elbowscrew.model.anatomy import AnatomicalMotion
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.axes import HelicalSteps, InstantaneousMotion
from elbowscrew.model.joint_axis import JointAxis
from elbowscrew.model.joint_type import JointAngles, JointType
from elbowscrew.model.modeled import BodyPoints, InterpolatedMotion, Keyframes, PhaseLaw, Selection
from elbowscrew.model.quality import BodyQuality
from elbowscrew.model.recording import QualityWarning, Recording, RigidBody
from elbowscrew.model.repetitions import CycleCurves, MovementPhases, Repeatability, Repetitions
from elbowscrew.model.sense import Sense
from elbowscrew.model.table_record import TableRecord

if TYPE_CHECKING:
    from elbowscrew.settings import Settings


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointMotion(ArrayRecord):
    """The distal body seen from the proximal one, frame by frame.

    Attributes
    ----------
    dual_quat_proximal_distal : ndarray, shape (N, 8)
        ``J_i = A_i^-1 F_i``, sign-continuous; NaN where there is neither a measured nor a filled pose.
    measured, filled : ndarray of bool, shape (N,)
        Where both bodies were tracked; where a short gap was bridged.
    reference : ndarray, shape (8,)
        ``J_0``, the pose every displacement is counted from.
    reference_row : int
    lowpass_hz : float or None
        Cut-off of the filter that both bodies went through; None if they went through none.
    dual_quat_lab_proximal : ndarray, shape (8,)
        ``A_0``, the proximal body at the reference; the identity if the file has no proximal body.
    located : bool
        Whether positions were measured; else all of these are rotations alone, and their dual parts 0.
    """

    dual_quat_proximal_distal: Float
    measured: Bool
    filled: Bool
    reference: Float
    reference_row: int
    lowpass_hz: float | None
    dual_quat_lab_proximal: Float
    located: bool = True


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ScrewMotion(TableRecord):
    """The displacement since the reference (P 35) and its screw, frame by frame; NaN where not defined or not known.

    Attributes
    ----------
    frame, time_s : ndarray, shape (N,)
    valid, filled : ndarray of bool, shape (N,)
        Pose measured; pose of a short gap filled in.
    proximal_loss, distal_loss : ndarray of str, shape (N,)
        Why the body has no measured pose; empty where it has.
    angle : ndarray, shape (N,)
        Rotation theta, radians: about the dominant axis where there is one, positive where it is largest; else without
        a sense, from 0 to pi.
    slide : ndarray, shape (N,)
        Translation along the axis, meters.
    axis_direction, axis_point : ndarray, shape (N, 3)
        Unit direction, and the point (m) of the axis nearest the origin, in the frame the screw is expressed in.
    euler_parameters, translation : ndarray, shape (N, 4) and (N, 3)
        The displacement itself: sign-continuous e0..e3, and d in meters.
    angle_sd, slide_sd : ndarray, shape (N,)
        Standard deviations (rad, m) from the noise of both bodies' poses; NaN where it is not known.
    axis_sd, point_sd : ndarray, shape (N,)
        Of the direction (rad) and of the position across the axis at `axis_point` (m), both components together.
    axis_cone, point_radius : ndarray, shape (N,)
        Half-angle (rad) of the cone, and radius (m) of the circle, that hold 95 %.
    """

    table: ClassVar = tables.SCREW_COLUMNS

    frame: NDArray[np.int64]
    time_s: Float
    valid: Bool
    filled: Bool
    proximal_loss: NDArray[np.str_]
    distal_loss: NDArray[np.str_]
    angle: Float
    slide: Float
    axis_direction: Float
    axis_point: Float
    euler_parameters: Float
    translation: Float
    angle_sd: Float
    slide_sd: Float
    axis_sd: Float
    point_sd: Float
    axis_cone: Float
    point_radius: Float

    @property
    def axis_known(self) -> Bool:
        """Frames whose rotation is large enough for an axis, shape (N,)."""
        known: Bool = np.logical_and.reduce(np.isfinite(self.axis_direction), axis=1)
        return known


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeanAxis(ArrayRecord):
    """The mean of the axes and their spread about it, in the frame the screw is expressed in.

    Attributes
    ----------
    direction, point : ndarray, shape (3,)
        Unit vector, and the point (m) nearest the origin; mean weighted by ``sin^2(theta/2)``.
    deviation : ndarray, shape (N,)
        Angle between each frame's axis and the plain mean direction, radians; NaN where there is no axis, or no other.
    distance : ndarray, shape (N,)
        Distance between each frame's axis and the mean axis, across the latter where it passes the distal body at the
        reference, meters; NaN where there is no axis, or no other.
    dispersion : float
        Median angle of the axes from their mean direction, both over equal steps (1 deg) of the rotation, radians: a
        rest counts no more than the angle it is at.
    weighted_dispersion : float
        RMS angle of the axes from the mean axis, with its weights, radians.
    excursion, position_excursion : float
        Largest angle (rad) between two of the axes, and largest distance (m) between their positions in that plane.
    """

    direction: Float
    point: Float
    deviation: Float
    distance: Float
    dispersion: float
    weighted_dispersion: float
    excursion: float
    position_excursion: float

    @property
    def spread95(self) -> tuple[float, float]:
        """Deviation (rad) and distance (m) that 95 % of the frames' axes keep within; NaN where no axis has one."""
        each = (self.deviation, self.distance)
        angle, shift = (np.nanpercentile(one, 95.0) if np.isfinite(one).any() else np.nan for one in each)
        return float(angle), float(shift)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Analysis(ArrayRecord):
    """Everything `elbowscrew.analyze` found in one recording.

    Attributes
    ----------
    recording : Recording
    settings : Settings
    proximal : RigidBody or None
        None where the file has no proximal body and it is taken to stand still.
    distal : RigidBody
    named_joint : Joint
        What the joint and its segments are called.
    joint : JointMotion
    elapsed : ndarray, shape (N,)
        Even clock, seconds since the first frame.
    displacement : ndarray, shape (N, 8)
        Since the reference, in the distal body's frame there (P 35), sign-continuous.
    screw : ScrewMotion
    sense : Sense
        What gives its angle a sense.
    mean_axis : MeanAxis
    joint_axis : JointAxis
    joint_type : JointType or None
        Which joint it is; None where positions tell nothing.
    joint_angles : JointAngles or None
        None of a joint that has none, or is not determined.
    instantaneous : InstantaneousMotion
    steps : HelicalSteps or None
        None if none were asked for.
    phases : MovementPhases
    repetitions : Repetitions
    cycle_curves : CycleCurves
    repeatability : Repeatability
    anatomy : AnatomicalMotion or None
        None without landmarks.
    keyframes : Keyframes
    inversion_rows : ndarray of int, shape (I,)
        Where the motion turns back.
    laws : tuple of PhaseLaw
        Law of motion of each phase of the model.
    selection : Selection or None
        How the keyframes were chosen, if a tolerance was given.
    interpolated : InterpolatedMotion
    points : BodyPoints
        What the RMS displacement is averaged over.
    quality : tuple of BodyQuality
        Of the proximal body, if there is one, and of the distal body.
    warnings : tuple of QualityWarning
        Those of the recording and those of the analysis.
    """

    recording: Recording
    settings: Settings
    proximal: RigidBody | None
    distal: RigidBody
    named_joint: Joint
    joint: JointMotion
    elapsed: Float
    displacement: Float
    screw: ScrewMotion
    sense: Sense
    mean_axis: MeanAxis
    joint_axis: JointAxis
    joint_type: JointType | None
    joint_angles: JointAngles | None
    instantaneous: InstantaneousMotion
    steps: HelicalSteps | None
    phases: MovementPhases
    repetitions: Repetitions
    cycle_curves: CycleCurves
    repeatability: Repeatability
    anatomy: AnatomicalMotion | None
    keyframes: Keyframes
    inversion_rows: NDArray[np.int64]
    laws: tuple[PhaseLaw, ...]
    selection: Selection | None
    interpolated: InterpolatedMotion
    points: BodyPoints
    quality: tuple[BodyQuality, ...]
    warnings: tuple[QualityWarning, ...]
