"""A result read back whole: its tables, and the parts of an analysis that they and the JSON files hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from elbowscrew import tables
from elbowscrew.errors import ResultError
from elbowscrew.model import (
    AxisPath,
    CycleCurves,
    HelicalSteps,
    InstantaneousMotion,
    InterpolatedMotion,
    Keyframes,
    PhaseLaw,
    QualityWarning,
    Repeatability,
    Repetitions,
    ScrewMotion,
    Selection,
)
from elbowscrew.model.joint_coordinates import JOINT_ANGLES
from elbowscrew.model.joint_summary_types import JointSummary
from elbowscrew.model.joint_type import JointAngles
from elbowscrew.model.summary_types import SelectionSummary, Summary
from elbowscrew.model.table_record import TableRecord
from elbowscrew.results.meshes_file import kept_meshes
from elbowscrew.results.proof import proof_of
from elbowscrew.results.summary_reading import read_joint_summary, read_summary, settings_in
from elbowscrew.results.table_reading import Attributes, read_attributes
from elbowscrew.results.trial_views import UNREADABLE, anatomy_table, angle_table, view_of_tables
from elbowscrew.settings import Settings
from elbowscrew.tables import Column
from elbowscrew.view.trial_view import TrialView

_RECORDS: Final[dict[str, type[TableRecord]]] = {
    "screw": ScrewMotion,
    "interpolation": InterpolatedMotion,
    "repetitions": Repetitions,
    "cycles": CycleCurves,
    "steps": HelicalSteps,
    "joint_angles": JointAngles,
    "axis_path": AxisPath,
}
"""Tables that hold all of the result that they were made from."""


class KeptTable(TableRecord):
    """A table whose result holds more than its columns; it has these alone."""

    def __init__(self, columns: tuple[Column, ...], attributes: Attributes) -> None:
        self._table = columns
        vars(self).update(attributes)

    @property
    def table(self) -> tuple[Column, ...]:
        """Its columns."""
        return self._table


class KeptResult(NamedTuple):
    """What the files of a result hold.

    Attributes
    ----------
    summary, joint_summary : dict
    view : TrialView
    tables : mapping of str to TableRecord
    parts : mapping of str to object
        Attributes of `elbowscrew.model.Analysis` by their names.
    """

    summary: Summary
    joint_summary: JointSummary
    view: TrialView
    tables: Mapping[str, TableRecord]
    parts: Mapping[str, object]


def read_kept(folder: Path) -> KeptResult:
    """Read all numbers of a result.

    Raises
    ------
    ResultError
        If the folder holds no finished result, or one that is damaged or was edited.
    """
    proof = proof_of(folder)
    proof.check_numbers()
    summary = read_summary(proof)
    joint = read_joint_summary(proof)
    settings = settings_in(summary, folder)
    units = settings.angle_unit, settings.length_unit
    try:
        columns = _columns(summary, joint)
        read = {
            name: read_attributes(proof.file(f"{name}.csv"), of, {one.attribute for one in of}, *units)
            for name, of in columns.items()
            if proof.has(f"{name}.csv")
        }
        view = replace(view_of_tables(summary, joint, settings, read), meshes=kept_meshes(proof))
        kept = {
            name: _RECORDS[name](**found) if name in _RECORDS else KeptTable(columns[name], found)
            for name, found in read.items()
        }
        kept["instantaneous"] = InstantaneousMotion(
            **read["instantaneous"], lowpass_hz=summary["trial"]["instantaneous_lowpass_hz"]
        )
        if "repetition_curve" in read:
            kept["repetition_curve"] = _repeatability(read["repetition_curve"], joint)
        return KeptResult(summary, joint, view, kept, _parts(summary, settings, view, kept))
    except UNREADABLE as error:
        msg = (
            f"{folder}: not a result of this version of the program: {type(error).__name__} {error}; "
            "analyze the trial again"
        )
        raise ResultError(" ".join(msg.split())) from error


def _columns(summary: Summary, joint: JointSummary) -> dict[str, tuple[Column, ...]]:
    """Columns of all tables that this result may have."""
    model = tables.KEYFRAME_COLUMNS
    if summary["interpolation"]["method"] == "joint":
        model += tables.KEYFRAME_JOINT_COLUMNS[joint["joint_type"]["type"]]
    own = {"joint_angles": angle_table(joint)} if joint["joint_type"]["type"] in JOINT_ANGLES else {}
    own |= {"keyframes": model, "anatomy": anatomy_table(joint)}
    return {name: of for name, of in tables.TABLES.items() if name != "joint_angles"} | own


def _parts(summary: Summary, settings: Settings, view: TrialView, kept: Mapping[str, TableRecord]) -> dict[str, object]:
    model, frame = summary["interpolation"], view.frame
    rows = {int(number): row for row, number in reversed(list(enumerate(frame.tolist())))}
    found: dict[str, object] = {
        "settings": settings,
        "named_joint": view.named_joint,
        "screw": kept["screw"],
        "interpolated": kept["interpolation"],
        "instantaneous": kept["instantaneous"],
        "steps": kept.get("steps"),
        "phases": view.phases,
        "repetitions": kept["repetitions"],
        "joint_angles": view.joint_angles,
        "inversion_rows": np.array([rows[one] for one in summary["motion"]["inversion_frames"]], dtype=np.int64),
        "laws": tuple(
            PhaseLaw(
                name=law["law"],
                peak=law["peak"],
                rms=_number(law["rms_displacement_mm"], 0.001)
                if law["rms_angle_deg"] is None
                else float(np.radians(law["rms_angle_deg"])),
                peak_sd=_number(law["peak_sd"]),
            )
            for law in model["phase_laws"]
        ),
        "selection": None if model["selection"] is None else _selection(model["selection"], rows),
        "warnings": tuple(
            QualityWarning(
                code=one["code"],
                message=one["message"],
                severity=one["severity"],
                frames=tuple(one["frames"]),
                count=one["count"],
            )
            for one in summary["warnings"]
        ),
    }
    if "cycles" in kept:
        found["cycle_curves"] = kept["cycles"]
    if "repetition_curve" in kept:
        found["repeatability"] = kept["repetition_curve"]
    if summary["landmarks"] is None:
        found["anatomy"] = None
    if model["method"] != "joint":
        found["keyframes"] = _keyframes(view.keyframes, kept["keyframes"], settings)
    return found


def _keyframes(keyframes: Keyframes, table: TableRecord, settings: Settings) -> Keyframes:
    knot, bounds, count = table.columns()["knot"], keyframes.phase_bounds, keyframes.phases.count
    if settings.blend == "global":
        return replace(keyframes, knots=(knot / count,))
    return replace(keyframes, knots=tuple(knot[bounds[p] : bounds[p + 1] + 1] - p for p in range(count)))


def _selection(told: SelectionSummary, rows: Mapping[int, int]) -> Selection:
    as_angle = told["tolerance_mm"] is None
    named = ("max_angle_deg", "rms_angle_deg"), ("max_rms_displacement_mm", "rms_displacement_mm")
    largest, rms = named[0] if as_angle else named[1]
    scale = float(np.radians(1.0)) if as_angle else 0.001
    curve: list[Any] = list(told["curve"])
    return Selection(
        row=np.array([rows[one] for one in told["keyframe_frames"]], dtype=np.int64),
        tolerance=_number(told["tolerance_deg"] if as_angle else told["tolerance_mm"], scale),
        frames=told["frames"],
        count=np.array([point["keyframes"] for point in curve], dtype=np.int64),
        largest=np.array([_number(point[largest], scale) for point in curve]),
        rms=np.array([_number(point[rms], scale) for point in curve]),
        complete=told["complete"],
        as_angle=as_angle,
    )


def _repeatability(curve: Attributes, joint: JointSummary) -> Repeatability:
    told = joint["repeatability"]
    degree = float(np.radians(1.0))
    return Repeatability(
        **curve,
        icc=_number(told["icc"]),
        cmc=_number(told["cmc"]),
        axis_sd=_number(told["axis_sd_deg"], degree),
        point_sd=_number(told["point_sd_mm"], 0.001),
        top_sd=_number(told["theta_max_sd_deg"], degree),
    )


def _number(value: float | None, scale: float = 1.0) -> float:
    """Read a number in SI units and radians; NaN where it is not known."""
    return float("nan") if value is None else scale * value
