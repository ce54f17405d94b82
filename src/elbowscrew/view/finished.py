"""A finished result as far as figures and pages show it; frozen, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.joints import Joint
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.modeled import InterpolatedMotion, Keyframes
from elbowscrew.model.repetitions import MovementPhases, Repetitions
from elbowscrew.model.results import ScrewMotion
from elbowscrew.model.summary_types import AnalysisSummary

if TYPE_CHECKING:
    from elbowscrew.settings import Settings


@dataclass(frozen=True, slots=True, kw_only=True)
class FinishedClock:
    """Frames per second."""

    rate_hz: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedBody(ArrayRecord):
    """A body's name, and its markers (M, 3) in its own frame, meters, if it has any."""

    name: str
    marker_offsets: Float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedJoint(ArrayRecord):
    """Poses at the reference, unit dual quaternions (8,): the forearm in the arm, and the arm in the laboratory."""

    reference: Float
    dual_quat_lab_proximal: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedLine(ArrayRecord):
    """A line: unit direction and the point nearest the origin, meters; shape (3,)."""

    direction: Float
    point: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedMean(ArrayRecord):
    """The mean axis, and the deviation (rad) and distance (m) that 95 % of the frames' axes keep within."""

    direction: Float
    point: Float
    spread95: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedFit(ArrayRecord):
    """A fitted joint with the half-angle (rad) and the radius (m) that hold 95 %; NaN where not known."""

    line: FinishedLine
    axis_cone: float
    point_radius: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedJointAxis(ArrayRecord):
    """The fit to believe, if there is one, and the weighted mean."""

    preferred: Literal["hinge", "screw_hinge"] | None
    best: FinishedFit | None
    weighted_mean: FinishedLine


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedTrial(ArrayRecord):
    """A result as it stands in its folder; what figures show (`elbowscrew.view.shown.Shown`) and the JSON itself.

    Attributes
    ----------
    folder : Path
    summary : AnalysisSummary
        ``summary.json``.
    joint_summary : JointSummary
        ``joint.json``.
    settings : Settings
    recording : FinishedClock
    proximal : FinishedBody or None
    distal : FinishedBody
    named_joint : Joint
        What the joint and its segments are called.
    joint : FinishedJoint
    screw : ScrewMotion
    mean_axis : FinishedMean
    joint_axis : FinishedJointAxis
    phases : MovementPhases
        `moving` is true between onset and offset; the threshold, which is not kept, is NaN.
    repetitions : Repetitions
    repetition_curve : mapping of str to ndarray, or None
        Columns of ``repetition_curve.csv``, radians.
    keyframes : Keyframes
        The knots, which are not kept, are empty.
    interpolated : InterpolatedMotion
    """

    folder: Path
    summary: AnalysisSummary
    joint_summary: JointSummary
    settings: Settings
    recording: FinishedClock
    proximal: FinishedBody | None
    distal: FinishedBody
    named_joint: Joint
    joint: FinishedJoint
    screw: ScrewMotion
    mean_axis: FinishedMean
    joint_axis: FinishedJointAxis
    phases: MovementPhases
    repetitions: Repetitions
    repetition_curve: Mapping[str, NDArray[Any]] | None
    keyframes: Keyframes
    interpolated: InterpolatedMotion
