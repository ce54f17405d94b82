"""The model of a measured motion: phases, keyframes, laws, and the poses between."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import (
    BodyPoints,
    Keyframes,
    ModelPhases,
    PhaseLaw,
    QualityWarning,
    RigidBody,
    Selection,
)
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.difference import DEFAULT_RADIUS, points_from_markers, points_from_radius, points_of_orientation
from elbowscrew.motion.interpolation.joint_model import ModelJoint, interpolation_called
from elbowscrew.motion.interpolation.keyframe_selection import select_keyframes
from elbowscrew.motion.interpolation.keyframes import keyframes_at, phase_time, rows_of_frames
from elbowscrew.motion.interpolation.keyframes_at_gaps import keyframe_doubts
from elbowscrew.motion.interpolation.law_fit import FittedLaw, laws_of
from elbowscrew.motion.interpolation.model_phases import model_phases, one_phase, phases_of_keyframes
from elbowscrew.motion.interpolation.modeling import ModeledPoses, model_motion
from elbowscrew.motion.interpolation.segment_errors import JointSeries
from elbowscrew.motion.movements.boundaries import Movements
from elbowscrew.motion.movements.course import course_of_frames
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.settings import Settings

_LINEAR_BLENDS: Final = ("dlb", "sdlb")


class JointModel(NamedTuple):
    """Result of `build_model`; the selection is None if no tolerance was given."""

    keyframes: Keyframes
    inversion_rows: NDArray[np.int64]
    laws: tuple[PhaseLaw, ...]
    selection: Selection | None
    poses: ModeledPoses
    points: BodyPoints
    warnings: tuple[QualityWarning, ...]


def build_model(
    measured: Measurement, movements: Movements, settings: Settings, joint_type: JointType | None = None
) -> JointModel:
    """Model a measured motion as the settings say.

    Parameters
    ----------
    measured : Measurement
    movements : Movements
    settings : Settings
    joint_type : JointType, optional
        The joint whose angles are interpolated, if that is asked for; found by itself if it is not given.

    Raises
    ------
    SettingError
        If the keyframes, knots or laws asked for do not fit the motion, or the joint has no angles to interpolate.
    AnalysisError
        If there is a pose in one frame only.
    """
    frame, elapsed, pose = measured.screw.frame, measured.elapsed, measured.displacement
    course = course_of_frames(measured, joint_type)
    method = settings.model_method
    joint = ModelJoint.of(measured, joint_type) if method == "joint" else None
    coordinates, make, known = interpolation_called(method, pose, joint)
    points = body_points(measured.distal, settings)
    rows = None
    doubts: tuple[QualityWarning, ...] = ()
    if settings.keyframes is not None:
        rows, inversion_row = rows_of_frames(course, frame, settings.keyframes, settings.inversion)
        phases = phases_of_keyframes(rows, course, inversion_row)
    else:
        phases = phases_of(measured, course, movements, settings)
        doubts = keyframe_doubts(phases, course, measured, movements)
    inversions = _inversion_rows(phases, course, settings)
    if settings.tolerance_mm is not None and settings.model_law == "linear":
        phases = one_phase(_measured_rows(measured))  # time itself needs no turns
    laws = model_laws(measured, phases, points, settings.model_law, settings.law_peak)
    selection = None
    if settings.tolerance_mm is not None:
        series = None if known is None else JointSeries(known, coordinates)
        selection = _selected(measured, phases, laws, points, settings, series)
        rows = selection.row
    keyframes = keyframes_at(
        phases.bound_rows if rows is None else rows,
        phases,
        frame,
        elapsed,
        pose,
        choice=settings.knots,
        laws=[law.function for law in laws],
        piecewise=settings.blend == "piecewise",
    )
    if known is not None:
        keyframes = replace(keyframes, joint=known, joint_angle=coordinates[keyframes.row])
    poses = model_motion(coordinates, elapsed, keyframes, make, [law.function for law in laws])
    return JointModel(
        keyframes=keyframes,
        inversion_rows=inversions,
        laws=tuple(law.law for law in laws),
        selection=selection,
        poses=poses,
        points=points,
        warnings=_warnings(keyframes, inversions, measured, poses) + _turns_apart(keyframes, measured, method) + doubts,
    )


def phases_of(measured: Measurement, course: Float, movements: Movements, settings: Settings) -> ModelPhases:
    """Phases of the model, as the settings say; the course is that of the frames (N,)."""
    return model_phases(
        course,
        measured.screw.frame,
        measured.elapsed,
        movements,
        choice=settings.phases,
        inversion=settings.inversion,
    )


def model_laws(
    measured: Measurement, phases: ModelPhases, points: BodyPoints, name: str, peak: float | None = None
) -> tuple[FittedLaw, ...]:
    """Law of motion of every phase; see `laws_of`."""
    return laws_of(
        name,
        peak,
        measured.displacement,
        measured.joint.measured,
        measured.elapsed,
        measured.screw.frame,
        phases,
        points,
    )


def body_points(distal: RigidBody, settings: Settings) -> BodyPoints:
    """Points that the RMS displacement is averaged over: of the radius asked for, the markers, or 50 mm.

    Of a body without positions there are none; what stands for them makes angles of displacements.
    """
    if not distal.located:
        return points_of_orientation()
    if settings.radius_mm is not None:
        return points_from_radius(settings.radius_mm / 1000.0)
    if distal.marker_offsets is not None:
        return points_from_markers(distal.marker_offsets)
    return points_from_radius(DEFAULT_RADIUS)


def _measured_rows(measured: Measurement) -> NDArray[np.int64]:
    rows = np.flatnonzero(measured.joint.measured).astype(np.int64)
    if rows.size < 2:
        msg = "only one frame of the recording has a pose: there is no motion to model"
        raise AnalysisError(msg)
    return rows


def _selected(
    measured: Measurement,
    phases: ModelPhases,
    laws: tuple[FittedLaw, ...],
    points: BodyPoints,
    settings: Settings,
    series: JointSeries | None,
) -> Selection:
    """Choose the keyframes among the measured poses; the phases' bounds are keyframes in any case."""
    bounds = phases.bound_rows
    usable = measured.joint.measured.copy()
    usable[bounds] = True
    rows = np.arange(bounds[0], bounds[-1] + 1)
    rows = rows[usable[rows]]
    parameter = np.empty(rows.size)
    for p, law in enumerate(laws):
        inside = (rows >= bounds[p]) & (rows <= bounds[p + 1])
        parameter[inside] = p + np.maximum.accumulate(
            law.function(phase_time(phases, p, measured.elapsed, rows[inside]))
        )
    found = select_keyframes(
        measured.displacement[rows],
        parameter,
        points,
        settings.tolerance_in_si(located=points.located),
        method=settings.model_method,
        series=None if series is None else series._replace(angle=series.angle[rows]),
        required=np.searchsorted(rows, bounds),
    )
    return found.of_rows(rows)


def _inversion_rows(phases: ModelPhases, angle: Float, settings: Settings) -> NDArray[np.int64]:
    """Rows where the motion turns back; a rest on the way is none, what was asked for is."""
    inner = phases.bound_rows[1:-1]
    if settings.inversion is not None or settings.keyframes is not None:
        return inner
    step = np.diff(angle[phases.bound_rows])
    return inner[step[1:] * step[:-1] < 0.0]


def _turns_apart(keyframes: Keyframes, measured: Measurement, method: str) -> tuple[QualityWarning, ...]:
    """Warn of keyframes so far apart that the way between them is not that of the motion.

    Poses do not know whole turns; and a linear blend of two poses more than half a turn apart, along the motion, leaps
    most of it in the middle.
    """
    rows, blended = keyframes.row, method in _LINEAR_BLENDS
    turns = np.array([_range(measured.course[a : b + 1]) for a, b in itertools.pairwise(rows.tolist())])
    far = np.flatnonzero(turns > (np.pi if blended else 2.0 * np.pi))
    if not far.size:
        return ()
    widest = far[np.argmax(turns[far])]
    first, last = keyframes.frame[[widest, widest + 1]].tolist()
    several = f" ({far.size} pairs of keyframes are so far apart)" if far.size > 1 else ""
    closer = "keyframes less than half a turn apart (--keyframes, or --tolerance MM, which chooses them)"
    if turns[widest] > 2.0 * np.pi:
        why, help_ = "more than a whole turn, which two poses do not tell", closer
    else:
        why = f"more than half a turn, most of which {method} leaps in the middle"
        help_ = f"--method sclerp or joint; or {closer}"
    message = (
        f"from keyframe {first} to {last} the joint turns by {np.degrees(turns[widest]):.0f} deg, {why}{several}: the "
        f"model is wrong between them, and its error says nothing about the joint; what helps is {help_}"
    )
    return (QualityWarning(code="keyframes-too-far-apart", message=message),)


def _range(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if known.size else 0.0


def _warnings(
    keyframes: Keyframes, inversion_rows: NDArray[np.int64], measured: Measurement, modeled: ModeledPoses
) -> tuple[QualityWarning, ...]:
    warnings = []
    if not inversion_rows.size:
        message = "the angle is largest at an end of the motion, so it has no inversion"
        warnings.append(QualityWarning(code="no-inversion", message=message))
    filled = keyframes.frame[measured.joint.filled[keyframes.row]]
    if filled.size:
        message = f"keyframes {', '.join(map(str, filled))} are not measured but filled in from their neighbors"
        warnings.append(QualityWarning(code="filled-keyframe", message=message))
    vanished = int((~modeled.phase.mask & ~np.isfinite(modeled.dual_quat[:, 0])).sum())
    if vanished:
        message = (
            f"in {vanished} frames the blended poses cancel, so there is no model pose; "
            "choose keyframes closer together, or --method sclerp"
        )
        warnings.append(QualityWarning(code="blend-vanishes", message=message))
    return tuple(warnings)
