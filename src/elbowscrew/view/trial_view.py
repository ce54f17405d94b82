"""What figures and pages need of a trial, whether just analyzed or read back from its result folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from elbowscrew.choices import METHOD_LABELS
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.joints import Joint
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.joint_axis import AxisPath
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.joint_type import JointAngles
from elbowscrew.model.mesh import Mesh
from elbowscrew.model.modeled import Keyframes
from elbowscrew.model.repetitions import MovementPhases, Repetitions
from elbowscrew.model.summary_types import Summary

if TYPE_CHECKING:
    from elbowscrew.settings import Settings

End = Literal["proximal", "distal"]
ENDS: Final[tuple[End, End]] = ("proximal", "distal")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TrialView(ArrayRecord):
    """A trial as far as it is shown; frozen, in SI units and radians.

    Attributes
    ----------
    summary : Summary
        ``summary.json``, degrees and millimeters.
    joint_summary : JointSummary
        ``joint.json``.
    settings : Settings
    named_joint : Joint
        What the joint and its segments are called.
    rate_hz : float
        Frames per second.
    proximal_name : str or None
        None where there is no proximal body and it is taken to stand still.
    distal_name : str
    proximal_markers, distal_markers : ndarray, shape (M, 3), or None
        Of each body in its own frame, if it has any.
    located : bool
        Whether positions were measured; else poses are rotations about the origins, and places NaN.
    reference, proximal_in_lab : ndarray, shape (8,)
        Poses at the reference, unit dual quaternions: the distal body in the proximal one, and the latter in the
        laboratory.
    frame, time_s, valid, filled, angle, angle_sd, slide, slide_sd, axis_direction, axis_point, axis_cone, point_radius,
    euler_parameters, translation : ndarray, shape (N,) and (N, k)
        The measured motion, as in `ScrewMotion`.
    modeled_angle, modeled_euler_parameters, angle_error, rms_displacement : ndarray, shape (N,) and (N, 4)
        The model and its error, as in `InterpolatedMotion`.
    phases : MovementPhases
        `moving` is true between onset and offset.
    keyframes : Keyframes
        The knots, which are not kept, are empty.
    repetitions : Repetitions
    repetition_curve : mapping of str to ndarray, or None
        Columns of ``repetition_curve.csv``, radians.
    mean_direction, mean_point : ndarray, shape (3,)
        The mean axis.
    spread95 : tuple of float
        Deviation (rad) from the mean axis and distance (m) that 95 % of the frames' axes keep within.
    joint_direction, joint_point : ndarray, shape (3,)
        The joint's axis by the preferred fit, of one that wanders its mean; the weighted mean where the motion has no
        single axis.
    joint_angles : JointAngles or None
        The joint's own angles; None of a joint that has none.
    axis_path : AxisPath or None
        The joint's axis against its angle, where it wanders.
    confidence95 : tuple of float, or None
        Half-angle (rad) and radius (m) that hold the joint's axis with 95 %, NaN where they are not known; None where
        the motion has no single axis.
    extra : mapping of str to mapping of str to ndarray
        Attributes of tables that only some figures show, by `elbowscrew.view.figure_names.FigureEntry.table`: those
        that were asked for.
    meshes : mapping of {"proximal", "distal"} to Mesh
        Bones, in the frames of their bodies.
    """

    summary: Summary
    joint_summary: JointSummary
    settings: Settings
    named_joint: Joint
    rate_hz: float
    proximal_name: str | None
    distal_name: str
    proximal_markers: Float | None
    distal_markers: Float | None
    located: bool
    reference: Float
    proximal_in_lab: Float
    frame: NDArray[np.int64]
    time_s: Float
    valid: Bool
    filled: Bool
    angle: Float
    angle_sd: Float
    slide: Float
    slide_sd: Float
    axis_direction: Float
    axis_point: Float
    axis_cone: Float
    point_radius: Float
    euler_parameters: Float
    translation: Float
    modeled_angle: Float
    modeled_euler_parameters: Float
    angle_error: Float
    rms_displacement: Float
    phases: MovementPhases
    keyframes: Keyframes
    repetitions: Repetitions
    repetition_curve: Mapping[str, NDArray[Any]] | None
    mean_direction: Float
    mean_point: Float
    spread95: tuple[float, float]
    joint_direction: Float
    joint_point: Float
    confidence95: tuple[float, float] | None
    joint_angles: JointAngles | None
    axis_path: AxisPath | None
    extra: Mapping[str, Mapping[str, NDArray[Any]]]
    meshes: Mapping[End, Mesh] = field(default_factory=dict)

    @property
    def axis_known(self) -> Bool:
        """Frames whose rotation is large enough for an axis, shape (N,)."""
        known: Bool = np.logical_and.reduce(np.isfinite(self.axis_direction), axis=1)
        return known

    @property
    def has_landmarks(self) -> bool:
        """Whether there are anatomical angles."""
        return self.summary["landmarks"] is not None

    @property
    def has_cycles(self) -> bool:
        """Whether the movement is repeated, or done once out and back."""
        return self.repetitions.number.size > 0

    @property
    def has_velocity(self) -> bool:
        """Whether any frame has an instantaneous axis."""
        return all(warning["code"] != "no-instantaneous-axis" for warning in self.summary["warnings"])


def fitted_pitch_mm(view: TrialView) -> float | None:
    """Millimeters that the joint slides per radian, where it is a screw-hinge; None where it is none."""
    fit = view.joint_summary["screw_hinge"]
    return None if fit is None or view.joint_summary["preferred"] != "screw_hinge" else fit["pitch_mm_per_rad"]


def model_label(view: TrialView) -> str:
    """Name the model by its method and the number of its keyframes."""
    method = METHOD_LABELS.get(view.settings.model_method, view.settings.model_method)
    return f"{method} through {len(view.summary['interpolation']['keyframes'])} poses"
