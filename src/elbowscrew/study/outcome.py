"""What became of each trial, and the two tables that tell it: ``summary.csv`` and ``failures.csv``."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.model.summary_types import Summary
from elbowscrew.results.table_text import safe_cell
from elbowscrew.study_columns import FAILURE_COLUMNS, study_header, study_values

DEFECT, LOST = "Defect", "WorkerLost"
"""Classes of failures that no error of ours stands for: the program's own fault, and a worker that died twice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """Why a trial has no result.

    Attributes
    ----------
    error_class : str
        Name of the error's class, or `DEFECT` or `LOST`.
    message : str
        One line.
    exit_code : int
        What ``elbowscrew analyze`` would have ended with.
    stops_all : bool
        Whether no other trial would fare better: the disk is full, or the workers are not ours.
    """

    error_class: str
    message: str
    exit_code: int
    stops_all: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class FailedTrial:
    """One row of ``failures.csv``."""

    path: str
    failure: Failure


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyRow:
    """What a row of ``summary.csv`` is made from.

    Attributes
    ----------
    trial : str
        Name of the result folder.
    path : str
    columns : mapping
        What the manifest says.
    summary : Summary
        The trial's ``summary.json``.
    """

    trial: str
    path: str
    columns: Mapping[str, str]
    summary: Summary


def summary_table(
    rows: Iterable[StudyRow],
    carried: Sequence[str],
    angle_unit: AngleUnit,
    length_unit: LengthUnit,
) -> bytes:
    """Make ``summary.csv``: a trial's name, its path, what the manifest says of it, and its results.

    Parameters
    ----------
    rows : iterable of StudyRow
    carried : sequence of str
        Columns of the manifest.
    angle_unit : {"deg", "rad"}
    length_unit : {"mm", "m"}

    Returns
    -------
    bytes
        The same for the same results, whoever computed them and when.
    """
    header = ["trial", "path", *carried, *study_header(angle_unit, length_unit)]
    lines = (
        [
            row.trial,
            row.path,
            *(row.columns.get(name, "") for name in carried),
            *study_values(row.summary, angle_unit, length_unit),
        ]
        for row in rows
    )
    return _csv(header, lines)


def failures_table(failed: Iterable[FailedTrial]) -> bytes:
    """Make ``failures.csv``."""
    return _csv(
        FAILURE_COLUMNS,
        ([one.path, one.failure.error_class, one.failure.message, one.failure.exit_code] for one in failed),
    )


def _csv(header: Sequence[str], lines: Iterable[Sequence[Any]]) -> bytes:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([safe_cell(name) for name in header])
    writer.writerows([_cell(value) for value in line] for line in lines)
    return stream.getvalue().encode("utf-8", "replace")  # names of files may be anything


def _cell(value: Any) -> str:
    match value:
        case None:
            return ""
        case bool():
            return str(int(value))
        case float():
            return repr(value + 0.0)
        case list():
            return safe_cell(";".join(map(str, value)))
        case _:
            return safe_cell(str(value))
