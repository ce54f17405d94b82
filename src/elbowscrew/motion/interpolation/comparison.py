"""Models of one motion beside each other: methods, laws, keyframes, and what the keyframes are taken from."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, SettingError
from elbowscrew.geometry._blocks import BLOCK
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import (
    BodyPoints,
    ComparedModels,
    Comparison,
    ModelPhases,
    PhaseLaw,
    QualityWarning,
    Recording,
    Selection,
)
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.axes.measured import measured_mean_axis
from elbowscrew.motion.interpolation.joint_model import Interpolation, ModelJoint, interpolation_called
from elbowscrew.motion.interpolation.keyframe_selection import select_keyframes
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan, SourcePoses, keyframe_sources_of
from elbowscrew.motion.interpolation.keyframes import keyframes_at, spread_rows
from elbowscrew.motion.interpolation.keyframes_at_gaps import keyframe_doubts
from elbowscrew.motion.interpolation.law_fit import FittedLaw, laws_of
from elbowscrew.motion.interpolation.model_building import body_points, phases_of
from elbowscrew.motion.interpolation.model_errors import model_errors
from elbowscrew.motion.interpolation.modeling import FROM_NEIGHBORS, model_motion
from elbowscrew.motion.interpolation.segment_errors import BASES, JointSeries
from elbowscrew.motion.joint.measured import measured_joint_axis, measured_joint_type
from elbowscrew.motion.movements.course import course_of_frames
from elbowscrew.motion.movements.measured import measured_cuts
from elbowscrew.motion.screws.measurement import Measurement, measure
from elbowscrew.settings import Settings

_DEFAULT_TOLERANCE: Final = {True: 2e-3, False: float(np.radians(2.0))}  # m, or of orientations alone rad


def compare(
    recording: Recording,
    settings: Settings | None = None,
    plan: ComparisonPlan | None = None,
    *,
    report: Callable[[int, int], None] = lambda _done, _total: None,
) -> Comparison:
    """Compare models of one motion; see `elbowscrew.compare`.

    Raises
    ------
    SettingError, AnalysisError, RecordingError
        As `elbowscrew.motion.analysis.analyze`.
    """
    wanted, plan = settings or Settings(), plan or ComparisonPlan()
    raw = wanted.model_copy(update={"lowpass_hz": None, "resample_hz": None, "keyframes": None, "tolerance_mm": None})
    measured = measure(recording, raw)
    joint_type = measured_joint_type(
        measured, measured_joint_axis(measured, measured_mean_axis(measured), raw).axis, raw
    )
    course = course_of_frames(measured, joint_type)
    movements = measured_cuts(measured, raw, joint_type).movements
    phases = phases_of(measured, course, movements, raw)
    points = body_points(measured.distal, raw)
    joint = _joint(measured, joint_type) if "joint" in plan.methods else None
    rows: list[dict[str, Any]] = []
    laws: dict[str, tuple[PhaseLaw, ...]] = {}
    sources, models = list(keyframe_sources_of(measured, phases, plan, wanted)), list(models_of(plan))
    steps = len(sources) * len(models) + 1
    # Of short series: there, each call of NumPy takes longer than its numbers do.
    at_once = max(BLOCK // measured.elapsed.size, 1)
    for source in sources:
        fitted: dict[str, tuple[FittedLaw, ...] | str] = {
            name: _laws_of(name, source, measured, points) for name in plan.laws
        }
        if source.name == "raw" or not laws:
            laws = {
                name: () if isinstance(found, str) else tuple(one.law for one in found)
                for name, found in fitted.items()
            }
        ways = {method: _way(method, source, joint) for method in {model.method for model in models}}
        for first in range(0, len(models), at_once):
            made = []
            for model in models[first : first + at_once]:
                made.append(_made(model, source, fitted[model.law], ways[model.method], measured))
                report(len(rows) + len(made), steps)
            _add_errors(made, measured, points, raw)
            rows += [one.row for one in made]
    located = points.located
    tolerance = _DEFAULT_TOLERANCE[located] if wanted.tolerance_mm is None else wanted.tolerance_in_si(located=located)
    selections, doubts = _selections(measured, phases, points, tolerance, plan.methods, joint)
    report(steps, steps)
    return Comparison(
        recording=measured.recording,
        settings=wanted.model_copy(update={"express_in": measured.express_in}),
        models=_ranked(rows, "rms_displacement" if located else "rms_angle_error"),
        phases=phases,
        frame=measured.screw.frame,
        laws=laws,
        selections=selections,
        points=points,
        warnings=measured.warnings + keyframe_doubts(phases, course, measured, movements) + doubts,
    )


def _joint(measured: Measurement, joint_type: JointType | None) -> ModelJoint | str:
    """Give the joint whose angles are interpolated, or why there is none."""
    try:
        return ModelJoint.of(measured, joint_type)
    except SettingError as error:
        return str(error)


def _way(method: str, source: SourcePoses, joint: ModelJoint | str | None) -> Interpolation | str:
    """Give the method with what it interpolates, or why it cannot."""
    if method == "joint" and isinstance(joint, str):
        return joint
    return interpolation_called(method, source.pose, None if isinstance(joint, str) else joint)


class PlannedModel(NamedTuple):
    """One combination of a plan."""

    method: str
    blend: str
    law: str
    knots: str
    keyframes: int


def models_of(plan: ComparisonPlan) -> Iterator[PlannedModel]:
    """Give every combination once that is a model of its own."""
    seen = set()
    for model in itertools.starmap(
        PlannedModel, itertools.product(plan.methods, plan.blends, plan.laws, plan.knots, plan.counts)
    ):
        method, blend = model.method, model.blend
        if model.keyframes == 2 and blend == "piecewise":
            method = {"dlb": "sdlb", "dib": "sclerp", "catmull-rom": "sclerp"}.get(method, method)
        if method in FROM_NEIGHBORS and model.knots == "law":
            blend = "piecewise"
        # Of knots that are but the phase's ends there is one choice.
        knots = "law" if model.keyframes == 2 and blend == "piecewise" else model.knots
        same = model._replace(method=method, blend=blend, knots=knots)
        if same not in seen:
            seen.add(same)
            yield model


def _laws_of(name: str, source: SourcePoses, measured: Measurement, points: BodyPoints) -> tuple[FittedLaw, ...] | str:
    """Laws of the phases, or why there are none."""
    try:
        return laws_of(
            name,
            None,
            source.pose,
            source.usable,
            measured.elapsed,
            measured.screw.frame,
            source.phases,
            points,
        )
    except SettingError as error:
        return str(error)


class _Made(NamedTuple):
    """A row of the table, and the model's poses (N, 8); None where there are none, as the row's note says."""

    row: dict[str, Any]
    dual_quat: Float | None


def _made(
    model: PlannedModel,
    source: SourcePoses,
    laws: tuple[FittedLaw, ...] | str,
    way: Interpolation | str,
    measured: Measurement,
) -> _Made:
    row: dict[str, Any] = {
        "data": source.name,
        "method": model.method,
        "blend": model.blend,
        "law": model.law,
        "knots": model.knots,
        "keyframes_per_phase": model.keyframes,
        "note": "",
    }
    rows = spread_rows(source.phases, source.usable, measured.elapsed, model.keyframes)
    row["keyframes"] = rows.size
    if isinstance(way, str):
        return _Made({**row, "note": way}, None)
    if isinstance(laws, str):
        return _Made({**row, "note": laws}, None)
    functions = [law.function for law in laws]
    try:
        keyframes = keyframes_at(
            rows,
            source.phases,
            measured.screw.frame,
            measured.elapsed,
            source.pose,
            choice=model.knots,
            laws=functions,
            piecewise=model.blend == "piecewise",
        )
        start = time.perf_counter()
        modeled = model_motion(way.coordinates, measured.elapsed, keyframes, way.method, functions)
        seconds = time.perf_counter() - start
    except SettingError as error:
        return _Made({**row, "note": str(error)}, None)
    modeled_rows = ~modeled.phase.mask
    if not np.isfinite(modeled.dual_quat[modeled_rows]).all():
        return _Made({**row, "note": "the blended poses cancel in some frames"}, None)
    row["ns_per_frame"] = 1e9 * seconds / int(modeled_rows.sum())
    return _Made(row, modeled.dual_quat)


def _add_errors(made: Sequence[_Made], measured: Measurement, points: BodyPoints, settings: Settings) -> None:
    """Put the errors of models into their rows."""
    rows = [row for row, dual_quat in made if dual_quat is not None]
    if not rows:
        return
    poses = np.stack([dual_quat for _, dual_quat in made if dual_quat is not None])
    found = model_errors(poses, measured, points, settings)
    errors = {"angle_error": found.angle_error, "axis_error": found.axis_error}
    if points.located:
        errors |= {
            "displacement": found.rms_displacement,
            "translation_error": found.translation_error,
            "axis_distance": found.axis_distance,
        }
        for row, last in zip(rows, np.nanargmax(found.rms_displacement, axis=-1), strict=True):
            row["max_displacement_frame"] = int(measured.screw.frame[last])
    for name, values in errors.items():
        known = np.isfinite(values).any(axis=-1)
        rms, largest = np.full((2, len(rows)), np.nan)
        rms[known] = np.sqrt(np.nanmean(values[known] ** 2, axis=-1))
        largest[known] = np.nanmax(values[known], axis=-1)
        for k, row in enumerate(rows):
            row[f"rms_{name}"], row[f"max_{name}"] = float(rms[k]), float(largest[k])


def _ranked(rows: list[dict[str, Any]], error: str) -> ComparedModels:
    order = sorted(range(len(rows)), key=lambda k: (rows[k].get(error, np.inf), k))
    arranged = [rows[k] for k in order]

    def column(name: str) -> NDArray[Any]:
        if name == "rank":
            return np.arange(1, len(rows) + 1)
        if name == "max_displacement_frame":
            frames = [row.get(name) for row in arranged]
            return np.ma.array(
                [0 if frame is None else frame for frame in frames],
                mask=[frame is None for frame in frames],
                dtype=np.int64,
            )
        return np.array([row.get(name, np.nan) for row in arranged])

    columns: dict[str, Any] = {field.name: column(field.name) for field in fields(ComparedModels)}
    return ComparedModels(**columns)


def _selections(
    measured: Measurement,
    phases: ModelPhases,
    points: BodyPoints,
    tolerance: float,
    methods: tuple[str, ...],
    joint: ModelJoint | str | None,
) -> tuple[dict[str, Selection], tuple[QualityWarning, ...]]:
    """Fewest keyframes of the movement, in time itself, by each method that takes them; why one has none, in a note."""
    rows = np.arange(phases.bound_rows[0], phases.bound_rows[-1] + 1)
    rows = rows[measured.joint.measured[rows]]
    if rows.size < 2:
        msg = "fewer than two measured poses in the movement: there is nothing to choose keyframes from"
        raise AnalysisError(msg)
    pose = measured.displacement[rows]
    found, doubts = {}, []
    for method in methods:
        series = None
        if method == "joint" and isinstance(joint, ModelJoint):
            series = JointSeries(joint.coordinates, joint.angles_of(measured.displacement)[rows])
        elif method not in BASES:
            continue
        try:
            chosen = select_keyframes(pose, measured.elapsed[rows], points, tolerance, method=method, series=series)
        except SettingError as error:  # the joint leaves more than the tolerance
            doubts.append(QualityWarning(code="no-fewest-keyframes", message=str(error), severity="note"))
        else:
            found[method] = chosen.of_rows(rows)
    return found, tuple(doubts)
