"""The model of a motion: keyframes, phases, laws and the motion between; frozen, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.model.table_record import TableRecord


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ModelPhases(ArrayRecord):
    """The phases of the model, from one turn of the motion to the next.

    Attributes
    ----------
    bound_rows : ndarray of int, shape (P + 1,)
        Rows where the phases begin and end: start, inversions, end.
    law_rows : ndarray of int, shape (P, 2)
        Rows between which the law of motion runs in each phase; before and after it, within the phase, the model rests.
    law_sd_s : ndarray, shape (P, 2), optional
        Standard deviations of the times where it begins and ends; None where they are not known.
    """

    bound_rows: NDArray[np.int64]
    law_rows: NDArray[np.int64]
    law_sd_s: Float | None = None

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.law_rows)


class PhaseLaw(NamedTuple):
    """The law of motion of a phase.

    Attributes
    ----------
    name : str
    peak : float or None
        Time of the highest velocity as a share of the phase; None where the law has no such parameter.
    rms : float
        RMS displacement (m), or of orientations alone RMS angle (rad), between the measured motion and the ScLERP from
        the phase's first pose to its last under this law.
    peak_sd : float
        Standard deviation of a peak that was fitted, as a share of the phase; NaN of others, and where it is not known.
    """

    name: str
    peak: float | None
    rms: float
    peak_sd: float = float("nan")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Keyframes(ArrayRecord):
    """The poses the model passes through.

    Attributes
    ----------
    row, frame : ndarray of int, shape (K,)
        Row in the recording and frame number of each keyframe.
    phases : ModelPhases
        Their bounds are among the keyframes.
    knots : tuple of ndarray
        For each phase (one for a global blend) the parameter at its keyframes.
    joint : JointCoordinates or None
        The joint whose angles are interpolated, in the distal body's frame at the reference; None for poses.
    joint_angle : ndarray, shape (K, k), or None
        These angles, rad.
    """

    row: NDArray[np.int64]
    frame: NDArray[np.int64]
    phases: ModelPhases
    knots: tuple[Float, ...]
    joint: JointCoordinates | None = None
    joint_angle: Float | None = None

    @property
    def phase_bounds(self) -> NDArray[np.int64]:
        """Indices into the keyframes where the phases begin and end, shape (P + 1,)."""
        return np.searchsorted(self.row, self.phases.bound_rows).astype(np.int64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class KeyframeSet(TableRecord):
    """Keyframes with all that rebuilds the motion from them.

    Attributes
    ----------
    frame : ndarray of int, shape (K,)
        Frame numbers in the recording they are from.
    time_s : ndarray, shape (K,)
        On the even clock of the model, increasing.
    phase : ndarray of int, shape (K,)
        1, 2, ...; that which a keyframe begins, or at the end the last.
    knot : ndarray, shape (K,)
        Phases that are over, and the law's t in the phase: from 0 to the number of phases.
    angle : ndarray, shape (K,)
        Screw angle, radians.
    dual_quat : ndarray, shape (K, 8)
        Displacements since the reference, in the frame they are expressed in; signs as the motion goes.
    method : str
    blend : {"piecewise", "global"}
    law : tuple of PhaseLaw
    law_start_s, law_end_s : ndarray, shape (P,)
        When the law of each phase runs.
    joint : JointCoordinates or None
        The joint whose angles are interpolated in place of the poses, in the frame they are expressed in.
    joint_angle : ndarray, shape (K, k), or None
        These angles, rad; of a ball the rotation vector.
    located : bool
        Whether positions were measured; else displacements and joint are rotations alone, and their dual parts and
        points 0.
    """

    frame: NDArray[np.int64]
    time_s: Float
    phase: NDArray[np.int64]
    knot: Float
    angle: Float
    dual_quat: Float
    method: str
    blend: Literal["piecewise", "global"]
    law: tuple[PhaseLaw, ...]
    law_start_s: Float
    law_end_s: Float
    joint: JointCoordinates | None = None
    joint_angle: Float | None = None
    located: bool = True

    @property
    def table(self) -> tuple[tables.Column, ...]:
        """Columns of ``keyframes.csv`` for these keyframes."""
        return tables.KEYFRAME_COLUMNS + (() if self.joint is None else tables.KEYFRAME_JOINT_COLUMNS[self.joint.type])

    @property
    def euler_parameters(self) -> Float:
        """Shape (K, 4)."""
        return self.dual_quat[:, :4]

    @property
    def translation(self) -> Float:
        """Shape (K, 3), meters; NaN where positions were not measured."""
        return pose_from_dual_quat(self.dual_quat)[1] if self.located else np.full((self.frame.size, 3), np.nan)

    @property
    def method_of_each(self) -> NDArray[np.str_]:
        """The method, as a column."""
        return np.full(self.frame.size, self.method)

    @property
    def blend_of_each(self) -> NDArray[np.str_]:
        """The blend, as a column."""
        return np.full(self.frame.size, self.blend)

    @property
    def law_of_each(self) -> NDArray[np.str_]:
        """Law of the phase of each keyframe."""
        return np.array([law.name for law in self.law])[self.phase - 1]

    @property
    def peak_of_each(self) -> Float:
        """Time of the highest velocity in that phase; NaN for the middle."""
        peaks = np.array([np.nan if law.peak is None else law.peak for law in self.law])
        return peaks[self.phase - 1]

    @property
    def law_start_of_each(self) -> Float:
        """When the law of the phase begins to run, seconds."""
        return self.law_start_s[self.phase - 1]

    @property
    def law_end_of_each(self) -> Float:
        """When it ends, seconds."""
        return self.law_end_s[self.phase - 1]

    @property
    def joint_of_each(self) -> NDArray[np.str_]:
        """The joint's type, as a column."""
        return np.full(self.frame.size, "" if self.joint is None else self.joint.type)

    @property
    def shared_of_each(self) -> Float:
        """What all poses of the joint share, as columns (K, 20): axis and point of each axis, slide a radian, end pose.

        Unit vectors and Euler parameters as they are, the rest in meters.
        """
        if self.joint is None:
            return np.full((self.frame.size, 20), np.nan)
        axis, point = np.full((2, 3), np.nan), np.full((2, 3), np.nan)
        axis[: len(self.joint.axis)], point[: len(self.joint.point)] = self.joint.axis, self.joint.point
        quat, position = pose_from_dual_quat(self.joint.end)
        if not self.located:
            point, position = np.full((2, 3), np.nan), np.full(3, np.nan)
        row = np.concatenate([axis[0], point[0], axis[1], point[1], [self.joint.pitch], quat, position])
        return np.tile(row, (self.frame.size, 1))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RebuiltMotion(TableRecord):
    """The motion that keyframes tell of, frame by frame.

    Attributes
    ----------
    frame : ndarray of int, shape (N,)
        0, 1, ...
    time_s : ndarray, shape (N,)
    phase : masked ndarray of int, shape (N,)
    fraction, angle, slide, euler_parameters, translation : ndarray
        As in `InterpolatedMotion`.
    """

    table: ClassVar = tables.MOTION_COLUMNS

    frame: NDArray[np.int64]
    time_s: Float
    phase: np.ma.MaskedArray[Any, np.dtype[np.int64]]
    fraction: Float
    angle: Float
    slide: Float
    euler_parameters: Float
    translation: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Selection(ArrayRecord):
    """The smallest set of measured poses between which a model stays within a tolerance, and what others reach.

    Errors are RMS displacements of the body's points, m; of orientations alone they are angles, rad (`as_angle`).

    Attributes
    ----------
    row : ndarray of int, shape (K,)
        The chosen poses.
    tolerance : float
        Largest error allowed.
    frames : int
        Measured frames from the first to the last.
    count : ndarray of int, shape (C,)
        Numbers of keyframes, increasing.
    largest, rms : ndarray, shape (C,)
        Largest error over the frames that the best set of so many keyframes has, and its RMS.
    complete : bool
        Whether all of them are the best there are; of a long recording only the last one is proved.
    as_angle : bool
        Whether tolerance and errors are angles.
    """

    row: NDArray[np.int64]
    tolerance: float
    frames: int
    count: NDArray[np.int64]
    largest: Float
    rms: Float
    complete: bool
    as_angle: bool = False

    @property
    def compression(self) -> float:
        """Frames for each keyframe."""
        return self.frames / self.row.size

    def of_rows(self, rows: NDArray[np.int64]) -> Selection:
        """Give the same selection by rows of the recording that it was made from."""
        return replace(self, row=rows[self.row])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class InterpolatedMotion(TableRecord):
    """The motion modeled from the keyframes, and its difference from the measured one; NaN outside the keyframes.

    Attributes
    ----------
    frame, time_s : ndarray, shape (N,)
    phase : masked ndarray of int, shape (N,)
        1, 2, ...; masked outside the keyframes.
    fraction : ndarray, shape (N,)
        The time law's t in the phase.
    angle, slide, euler_parameters, translation : ndarray
        As in `ScrewMotion`.
    angle_error : ndarray, shape (N,)
        Angle of the rotation between modeled and measured orientation, radians.
    translation_error : ndarray, shape (N,)
        Distance between modeled and measured origin of the distal body, meters.
    rms_displacement : ndarray, shape (N,)
        RMS distance between modeled and measured points of the distal body, meters.
    axis_error, axis_distance : ndarray, shape (N,)
        Angle (rad) between modeled and measured screw axis, and distance (m) between them, across the measured one
        where it passes the distal body at the reference; NaN where one of the two is not known.
    """

    table: ClassVar = tables.INTERPOLATION_COLUMNS

    frame: NDArray[np.int64]
    time_s: Float
    phase: np.ma.MaskedArray[Any, np.dtype[np.int64]]
    fraction: Float
    angle: Float
    slide: Float
    euler_parameters: Float
    translation: Float
    angle_error: Float
    translation_error: Float
    rms_displacement: Float
    axis_error: Float
    axis_distance: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodyPoints(ArrayRecord):
    """The points of a body that a displacement is averaged over, in the body's frame.

    Of orientations alone (`located` is False) unit vectors stand for them, whose RMS displacement is a chord.

    Attributes
    ----------
    centroid : ndarray, shape (3,)
        Meters.
    covariance : ndarray, shape (3, 3)
        Mean of ``(x - c)(x - c)^T``, square meters.
    origin : str
        "markers", "radius" or "orientation".
    """

    centroid: Float
    covariance: Float
    origin: Literal["markers", "radius", "orientation"]

    @property
    def located(self) -> bool:
        """Whether they are points at all."""
        return self.origin != "orientation"

    @property
    def radius_of_gyration(self) -> float:
        """RMS distance of the points from their centroid, meters."""
        return float(np.sqrt(np.trace(self.covariance)))
