"""What figures and pages show of a trial: of an analysis in memory, and of a result read back from its folder.

Both go the same way, from the numbers as the files of a result have them, so that they show the same to the last byte.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.errors import ResultError
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
from elbowscrew.joints import joint_called
from elbowscrew.model import Analysis, Keyframes, ModelPhases, MovementPhases, Repetitions
from elbowscrew.model.joint_axis import AxisPath
from elbowscrew.model.joint_coordinates import JOINT_ANGLES
from elbowscrew.model.joint_summary_types import JointSummary, PoseSummary, Vector
from elbowscrew.model.joint_type import JointAngles
from elbowscrew.model.summary_types import ModelSummary, MovementSummary, Summary
from elbowscrew.results.joint_summary import joint_summary, preferred_fit
from elbowscrew.results.meshes_file import kept_meshes
from elbowscrew.results.proof import Proof, proof_of
from elbowscrew.results.result_files import SUMS
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.results.summary_reading import SUMMARY, read_joint_summary, read_summary, settings_in
from elbowscrew.results.table_reading import Attributes, as_read, read_attributes, read_columns
from elbowscrew.settings import Settings
from elbowscrew.view.figure_names import FIGURE_ENTRIES
from elbowscrew.view.trial_view import TrialView

_SCREW: Final = (
    "frame", "time_s", "valid", "filled", "angle", "angle_sd", "slide", "slide_sd", "axis_direction", "axis_point",
    "axis_cone", "point_radius", "euler_parameters", "translation",
)  # fmt: skip
_MODEL: Final = ("phase", "angle", "euler_parameters", "angle_error", "rms_displacement")
# Long tables that are always read, and proved by that: a second time takes a fifth of all.
_READ_WHOLE: Final = ("screw.csv", "interpolation.csv", "joint_angles.csv")
_ANGLES: Final = tuple(field.name for field in fields(JointAngles))
_PATH: Final = tuple(field.name for field in fields(AxisPath))
_REPETITIONS: Final = tuple(field.name for field in fields(Repetitions))
_EXTRA: Final[dict[str, tuple[str, tuple[tables.Column, ...], tuple[str, ...]]]] = {
    "instantaneous": (
        "instantaneous",
        tables.INSTANTANEOUS_COLUMNS,
        ("angular_velocity", "slide_velocity", "axis_direction", "axis_point"),
    ),
    "cycles": ("cycles", tables.CYCLE_COLUMNS, ("cycle", "percent", "angle")),
    "losses": ("screw", tables.SCREW_COLUMNS, ("proximal_loss", "distal_loss")),
}
"""Table, columns and attributes of what only some figures show, but for the bones' angles."""
UNREADABLE: Final = (KeyError, TypeError, ValueError, IndexError, AttributeError, ArithmeticError)
"""What a result that somebody edited raises where its numbers do not go together."""


def is_result(folder: Path) -> bool:
    """Tell whether a folder holds the result of one trial, or what is left of one, by the digests of its files."""
    if (folder / SUMMARY).is_file() and (folder / "screw.csv").is_file():
        return True
    try:
        return (folder / SUMS).is_file() and proof_of(folder).has(SUMMARY)
    except ResultError:
        return False


class Viewed(ABC):
    """A trial that has what is shown of it at hand."""

    __slots__ = ()

    @abstractmethod
    def trial_view(self) -> TrialView:
        """Give it."""


def view_of(trial: Analysis | TrialView) -> TrialView:
    """Give what is shown of an analysis; a view is given back as it is."""
    if isinstance(trial, TrialView):
        return trial
    if isinstance(trial, Viewed):
        return trial.trial_view()
    return view_of_analysis(trial, summary_from_analysis(trial), joint_summary(trial), tuple(FIGURE_ENTRIES))


def view_of_result(folder: Path, figures: Collection[str] = ()) -> TrialView:
    """Read what is shown of a result, without analyzing anything again.

    Parameters
    ----------
    folder : Path
        As `elbowscrew.save_analysis` wrote it, in whatever units.
    figures : collection of str
        What is to be drawn of it: some figures need more tables than others.

    Returns
    -------
    TrialView

    Raises
    ------
    ResultError
        If the folder holds no finished result, or one that is damaged or was edited.
    """
    return view_of_proved(proof_of(folder), figures)


def view_of_proved(proof: Proof, figures: Collection[str] = ()) -> TrialView:
    """Do what `view_of_result` does, with digests that have been read."""
    try:
        view = _view_read(proof, figures)
    except ResultError:
        proof.check_numbers()  # which names all files that are not as they were written
        raise
    proof.check_numbers(proved=_READ_WHOLE)
    return view


def _view_read(proof: Proof, figures: Collection[str]) -> TrialView:
    folder = proof.folder
    summary = read_summary(proof)
    joint = read_joint_summary(proof)
    settings = settings_in(summary, folder)
    units = settings.angle_unit, settings.length_unit
    curve, angles, path = (
        proof.file(f"{name}.csv") if proof.has(f"{name}.csv") else None
        for name in ("repetition_curve", "joint_angles", "axis_path")
    )
    screw, model, cycles = (proof.file(f"{name}.csv") for name in ("screw", "interpolation", "repetitions"))
    try:
        read = _Tables(
            screw=read_attributes(screw, tables.SCREW_COLUMNS, _SCREW, *units),
            model=read_attributes(model, tables.INTERPOLATION_COLUMNS, _MODEL, *units),
            repetitions=read_attributes(cycles, tables.REPETITION_COLUMNS, _REPETITIONS, *units),
            curve=None if curve is None else read_columns(curve, tables.CURVE_COLUMNS, *units),
            angles=None if angles is None else read_attributes(angles, angle_table(joint), _ANGLES, *units),
            path=None if path is None else read_attributes(path, tables.AXIS_PATH_COLUMNS, _PATH, *units),
            extra={
                name: read_attributes(proof.file(f"{table}.csv"), columns, names, *units)
                for name, (table, columns, names) in _extra_of(figures, joint).items()
                if proof.has(f"{table}.csv")
            },
        )
        return replace(_view(summary, joint, settings, read), meshes=kept_meshes(proof))
    except UNREADABLE as error:
        msg = (
            f"{folder}: not a result of this version of the program: {type(error).__name__} {error}; "
            "analyze the trial again"
        )
        raise ResultError(" ".join(msg.split())) from error


def view_of_tables(
    summary: Summary, joint: JointSummary, settings: Settings, tables_of: Mapping[str, Attributes]
) -> TrialView:
    """Give what `view_of_result` reads, of tables that have been read whole, by their names."""
    curve = tables_of.get("repetition_curve")
    return _view(
        summary,
        joint,
        settings,
        _Tables(
            screw=tables_of["screw"],
            model=tables_of["interpolation"],
            repetitions=tables_of["repetitions"],
            curve=None if curve is None else {one.name: curve[one.attribute] for one in tables.CURVE_COLUMNS},
            angles=tables_of.get("joint_angles"),
            path=tables_of.get("axis_path"),
            extra={name: tables_of[table] for name, (table, _, _) in _extra(joint).items() if table in tables_of},
        ),
    )


def angle_table(joint: JointSummary) -> tuple[tables.Column, ...]:
    """Columns of the joint's own angles, by how many it has."""
    return tables.JOINT_ANGLE_COLUMNS[JOINT_ANGLES[joint["joint_type"]["type"]]]


def anatomy_table(joint: JointSummary) -> tuple[tables.Column, ...]:
    """Columns of the bones' angles, by the joint that the landmarks are of; without any, an elbow's."""
    found = joint["anatomy"]
    return tables.ANATOMY_COLUMNS["elbow" if found is None else found["joint"]]


def _extra_of(
    figures: Collection[str], joint: JointSummary
) -> dict[str, tuple[str, tuple[tables.Column, ...], tuple[str, ...]]]:
    wanted = {entry.table for name, entry in FIGURE_ENTRIES.items() if name in figures}
    return {name: how for name, how in _extra(joint).items() if name in wanted}


def _extra(joint: JointSummary) -> dict[str, tuple[str, tuple[tables.Column, ...], tuple[str, ...]]]:
    bones = anatomy_table(joint)
    return {"anatomy": ("anatomy", bones, tuple(column.attribute for column in bones[2:5])), **_EXTRA}


def view_of_analysis(
    analysis: Analysis, summary: Summary, joint: JointSummary, figures: Collection[str] = ()
) -> TrialView:
    """Give what `view_of_result` reads of the folder that an analysis is written to, to the last digit.

    Parameters
    ----------
    analysis : Analysis
    summary : Summary
    joint : JointSummary
    figures : collection of str
        What is to be drawn of it.
    """
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    angles, path = analysis.joint_angles, analysis.joint_axis.path
    curve = None
    if analysis.repetitions.number.size > 1:
        table = analysis.repeatability.table
        values = as_read(analysis.repeatability, [column.attribute for column in table], *units)
        curve = {column.name: values[column.attribute] for column in table}
    several = {
        "anatomy": analysis.anatomy,
        "instantaneous": analysis.instantaneous,
        "cycles": analysis.cycle_curves if analysis.repetitions.number.size else None,
        "losses": analysis.screw,
    }
    written = _Tables(
        screw=as_read(analysis.screw, _SCREW, *units),
        model=as_read(analysis.interpolated, _MODEL, *units),
        repetitions=as_read(analysis.repetitions, _REPETITIONS, *units),
        curve=curve,
        angles=None if angles is None else as_read(angles, _ANGLES, *units),
        path=None if path is None else as_read(path, _PATH, *units),
        extra={
            name: as_read(found, names, *units)
            for name, (_, _, names) in _extra_of(figures, joint).items()
            if (found := several[name]) is not None
        },
    )
    resolved = {"method": analysis.settings.model_method, "law": analysis.settings.model_law}
    return _view(summary, joint, analysis.settings.model_copy(update=resolved), written)


class _Tables(NamedTuple):
    """Columns of the tables, by attributes; of the curve by names, and None where there is none."""

    screw: Attributes
    model: Attributes
    repetitions: Attributes
    curve: dict[str, NDArray[Any]] | None
    angles: Attributes | None
    path: Attributes | None
    extra: dict[str, Attributes]


def _view(summary: Summary, joint: JointSummary, settings: Settings, read: _Tables) -> TrialView:
    trial, motion, bodies, words = summary["trial"], summary["motion"], joint["bodies"], summary["trial"]["joint"]
    screw, model, dispersion = read.screw, read.model, joint["dispersion"]
    frame, fit = _Frames(screw["frame"]), joint["mean_axis"] or preferred_fit(joint)
    line = joint["weighted_mean"] if fit is None else fit
    return TrialView(
        summary=summary,
        joint_summary=joint,
        settings=settings,
        named_joint=joint_called(words["name"], words["proximal"], words["distal"]),
        rate_hz=trial["rate_hz"],
        proximal_name=None if trial["proximal"] is None else trial["proximal"]["name"],
        distal_name=trial["distal"]["name"],
        proximal_markers=_markers(bodies["proximal_markers_mm"]),
        distal_markers=_markers(bodies["distal_markers_mm"]),
        located=trial["positions"],
        reference=_pose(bodies["distal_in_proximal"]),
        proximal_in_lab=_pose(bodies["proximal_in_lab"]),
        frame=screw["frame"],
        time_s=screw["time_s"],
        valid=screw["valid"],
        filled=screw["filled"],
        angle=screw["angle"],
        angle_sd=screw["angle_sd"],
        slide=screw["slide"],
        slide_sd=screw["slide_sd"],
        axis_direction=screw["axis_direction"],
        axis_point=screw["axis_point"],
        axis_cone=screw["axis_cone"],
        point_radius=screw["point_radius"],
        euler_parameters=screw["euler_parameters"],
        translation=screw["translation"],
        modeled_angle=model["angle"],
        modeled_euler_parameters=model["euler_parameters"],
        angle_error=model["angle_error"],
        rms_displacement=model["rms_displacement"],
        phases=_phases(motion["movements"], frame),
        keyframes=_keyframes(summary["interpolation"], model["phase"], frame),
        repetitions=Repetitions(**read.repetitions),
        repetition_curve=read.curve,
        mean_direction=np.array(motion["mean_axis"]["direction"], dtype=np.float64),
        mean_point=_point(motion["mean_axis"]["point_mm"]),
        spread95=_region(dispersion["direction_95_deg"], dispersion["position_95_mm"]),
        joint_direction=np.array(line["direction"], dtype=np.float64),
        joint_point=_point(line["point_mm"]),
        confidence95=None if fit is None else _region(fit["axis_cone95_deg"], fit["point_radius95_mm"]),
        joint_angles=None if read.angles is None else JointAngles(**read.angles),
        axis_path=None if read.path is None else AxisPath(**read.path),
        extra=read.extra,
    )


def _pose(pose: PoseSummary) -> Float:
    position = np.zeros(3) if pose["position_mm"] is None else _millimeters(pose["position_mm"])
    return dual_quat_from_pose(np.array(pose["quaternion"], dtype=np.float64), position)


def _millimeters(values: Any) -> Float:
    """Read lengths in millimeters as meters."""
    return np.array(values, dtype=np.float64) / 1000.0


def _point(point_mm: Vector | None) -> Float:
    return np.full(3, np.nan) if point_mm is None else _millimeters(point_mm)


def _markers(offsets: list[Vector] | None) -> Float | None:
    return None if offsets is None else _millimeters(offsets).reshape(-1, 3)


def _region(angle_deg: float | None, radius_mm: float | None) -> tuple[float, float]:
    """Read a half-angle and a radius as radians and meters; NaN where not known."""
    angle, radius = (np.nan if value is None else value for value in (angle_deg, radius_mm))
    return float(np.radians(angle)), radius / 1000.0


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


def _keyframes(model: ModelSummary, phase: NDArray[Any], frame: _Frames) -> Keyframes:
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
