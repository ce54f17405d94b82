"""A finished result read back from its folder, without analyzing anything again."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.errors import ResultError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
from elbowscrew.joints import Joint, joint_called
from elbowscrew.model import (
    Analysis,
    InterpolatedMotion,
    Keyframes,
    ModelPhases,
    MovementPhases,
    Repetitions,
    ScrewMotion,
)
from elbowscrew.model.joint_summary_types import DispersionSummary, JointSummary, LineSummary, PoseSummary, Vector
from elbowscrew.model.summary_types import AnalysisSummary, JointWords, ModelSummary, MovementSummary, QualitySummary
from elbowscrew.results.joint_summary import preferred_fit
from elbowscrew.results.summary_reading import read_joint_summary, read_summary, settings_in
from elbowscrew.results.table_reading import AsRead, read_columns, read_result
from elbowscrew.settings import Settings
from elbowscrew.view.finished import (
    FinishedBody,
    FinishedClock,
    FinishedFit,
    FinishedJoint,
    FinishedJointAxis,
    FinishedLine,
    FinishedMean,
    FinishedTrial,
)

Columns = dict[str, NDArray[Any]]

UNREADABLE = (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError)
"""What a result from elsewhere, or one that somebody edited, raises where it is not as it was written."""


def is_result(folder: Path) -> bool:
    """Tell whether a folder holds the result of one trial."""
    return (folder / "summary.json").is_file() and (folder / "screw.csv").is_file()


def read_finished(folder: Path) -> FinishedTrial:
    """Read a result folder back, without analyzing anything again.

    Parameters
    ----------
    folder : Path
        As `elbowscrew.save_analysis` wrote it, in whatever units.

    Returns
    -------
    FinishedTrial

    Raises
    ------
    ResultError
        If the folder holds no finished result, or a damaged one.
    """
    summary = read_summary(folder)
    joint_summary = read_joint_summary(folder)
    settings = settings_in(summary, folder)
    try:
        return _finished(folder, summary, joint_summary, settings, _read_tables(folder, settings))
    except UNREADABLE as error:
        msg = (
            f"{folder}: not a result of this version of the program: {type(error).__name__} {error}; "
            "analyze the trial again"
        )
        raise ResultError(" ".join(msg.split())) from error


def as_finished(
    analysis: Analysis, folder: Path, summary: AnalysisSummary, joint_summary: JointSummary
) -> FinishedTrial:
    """Give what `read_finished` reads of a folder that an analysis was just written to, without reading the tables.

    Parameters
    ----------
    analysis : Analysis
    folder : Path
    summary : AnalysisSummary
    joint_summary : JointSummary
    """
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    curve = None
    if analysis.repetitions.number.size > 1:
        read = AsRead(analysis.repeatability, tables.CURVE_COLUMNS, *units)
        curve = {column.name: column.values(read) for column in tables.CURVE_COLUMNS}
    given = _Tables(
        screw=cast(ScrewMotion, AsRead(analysis.screw, tables.SCREW_COLUMNS, *units)),
        interpolated=cast(InterpolatedMotion, AsRead(analysis.interpolated, tables.INTERPOLATION_COLUMNS, *units)),
        repetitions=cast(Repetitions, AsRead(analysis.repetitions, tables.REPETITION_COLUMNS, *units)),
        curve=curve,
    )
    told = {"method": analysis.settings.model_method, "law": analysis.settings.model_law}
    settings = analysis.settings.model_copy(update=told)
    return _finished(folder, summary, joint_summary, settings, given)


class _Tables(NamedTuple):
    screw: ScrewMotion
    interpolated: InterpolatedMotion
    repetitions: Repetitions
    curve: Columns | None


def _read_tables(folder: Path, settings: Settings) -> _Tables:
    units = settings.angle_unit, settings.length_unit
    curve = folder / "repetition_curve.csv"
    return _Tables(
        screw=read_result(folder / "screw.csv", ScrewMotion, tables.SCREW_COLUMNS, *units),
        interpolated=read_result(
            folder / "interpolation.csv", InterpolatedMotion, tables.INTERPOLATION_COLUMNS, *units
        ),
        repetitions=read_result(folder / "repetitions.csv", Repetitions, tables.REPETITION_COLUMNS, *units),
        curve=read_columns(curve, tables.CURVE_COLUMNS, *units) if curve.exists() else None,
    )


def _finished(
    folder: Path, summary: AnalysisSummary, joint_summary: JointSummary, settings: Settings, read: _Tables
) -> FinishedTrial:
    bodies, trial = joint_summary["bodies"], summary["trial"]
    frame = _Frames(read.screw.frame)
    return FinishedTrial(
        folder=folder,
        summary=summary,
        joint_summary=joint_summary,
        settings=settings,
        recording=FinishedClock(rate_hz=float(trial["rate_hz"])),
        proximal=None if trial["proximal"] is None else _body(trial["proximal"], bodies["proximal_markers_mm"]),
        distal=_body(trial["distal"], bodies["distal_markers_mm"]),
        named_joint=_named_joint(trial["joint"]),
        joint=FinishedJoint(
            reference=_pose(bodies["distal_in_proximal"]), dual_quat_lab_proximal=_pose(bodies["proximal_in_lab"])
        ),
        screw=read.screw,
        mean_axis=_mean(summary["motion"]["mean_axis"], joint_summary["dispersion"]),
        joint_axis=_joint_axis(joint_summary),
        phases=_phases(summary["motion"]["movements"], frame),
        repetitions=read.repetitions,
        repetition_curve=read.curve,
        keyframes=_keyframes(summary["interpolation"], read.interpolated.phase, frame),
        interpolated=read.interpolated,
    )


def _named_joint(joint: JointWords) -> Joint:
    return joint_called(joint["name"], joint["proximal"], joint["distal"])


def _pose(pose: PoseSummary) -> Float:
    return dual_quat_from_pose(np.array(pose["quaternion"], dtype=np.float64), _millimeters(pose["position_mm"]))


def _millimeters(values: Any) -> Float:
    """Read lengths in millimeters as meters."""
    return np.array(values, dtype=np.float64) / 1000.0


def _body(trial: QualitySummary, markers: list[Vector] | None) -> FinishedBody:
    offsets = None if markers is None else _millimeters(markers).reshape(-1, 3)
    return FinishedBody(name=trial["name"], marker_offsets=offsets)


def _line(line: LineSummary) -> FinishedLine:
    return FinishedLine(direction=np.array(line["direction"], dtype=np.float64), point=_millimeters(line["point_mm"]))


def _mean(mean: LineSummary, dispersion: DispersionSummary) -> FinishedMean:
    line = _line(mean)
    spread = float(np.radians(_number(dispersion["direction_95_deg"]))), _number(dispersion["place_95_mm"]) / 1000.0
    return FinishedMean(direction=line.direction, point=line.point, spread95=spread)


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _joint_axis(joint: JointSummary) -> FinishedJointAxis:
    fit = preferred_fit(joint)
    best = None
    if fit is not None:
        best = FinishedFit(
            line=_line(fit),
            axis_cone=float(np.radians(_number(fit["axis_cone95_deg"]))),
            point_radius=_number(fit["point_radius95_mm"]) / 1000.0,
        )
    return FinishedJointAxis(preferred=joint["preferred"], best=best, weighted_mean=_line(joint["weighted_mean"]))


class _Frames:
    """Rows of frame numbers; a number that stands twice is taken where it stands first."""

    def __init__(self, frame: NDArray[np.int64]) -> None:
        self.frame = frame
        increasing = bool((frame[1:] > frame[:-1]).all())
        self._order = None if increasing else np.argsort(frame, kind="stable")

    def rows(self, numbers: Any) -> NDArray[np.int64]:
        wanted = np.array(numbers, dtype=np.int64)
        places = np.searchsorted(self.frame, wanted, sorter=self._order)
        if not (places == self.frame.size).any():
            rows = places if self._order is None else self._order[places]
            if (self.frame[rows] == wanted).all():
                return rows.astype(np.int64)
        msg = "a frame of the summary is not in screw.csv"
        raise ValueError(msg)


def _phases(movements: list[MovementSummary], frame: _Frames) -> MovementPhases:
    onset = frame.rows([movement["onset_frame"] for movement in movements])
    offset = frame.rows([movement["offset_frame"] for movement in movements])
    moving = np.zeros(frame.frame.size, dtype=bool)
    for first, last in zip(onset, offset, strict=True):
        moving[first : last + 1] = True
    return MovementPhases(onset_rows=onset, offset_rows=offset, moving=moving)


def _keyframes(model: ModelSummary, phase: np.ma.MaskedArray[Any, Any], frame: _Frames) -> Keyframes:
    """Read the keyframes; a phase begins where its number first stands, and the last one ends at the last keyframe."""
    row = frame.rows(model["keyframes"])
    known = np.ma.masked_array(phase)
    rows = np.flatnonzero(~np.ma.getmaskarray(known))
    number = known.data[rows]
    begins = np.append(True, number[1:] != number[:-1])
    bounds = np.append(rows[begins], row[-1])
    laws = frame.rows([[law["start_frame"], law["end_frame"]] for law in model["phase_laws"]])
    phases = ModelPhases(bound_rows=bounds.astype(np.int64), law_rows=laws)
    return Keyframes(row=row, frame=frame.frame[row], phases=phases, knots=())
