"""What a folder of results holds: its trials, what the manifest says of them, and what failed."""

from __future__ import annotations

import csv
import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np

from elbowscrew import tables
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.errors import ResultError
from elbowscrew.geometry.arrays import Float
from elbowscrew.opening import open_text
from elbowscrew.reading.source import longest_cell
from elbowscrew.report.checklist import common_of
from elbowscrew.report.facts import SummaryFacts
from elbowscrew.report.measures import COLUMNS
from elbowscrew.report.pages import unshowable
from elbowscrew.report.trial_parts import TrialAxis, axis_of, curve_of_result
from elbowscrew.results.proof import proof_of
from elbowscrew.results.summary_reading import read_joint_summary, read_summary, settings_in
from elbowscrew.results.table_reading import read_columns
from elbowscrew.results.trial_views import UNREADABLE, is_result
from elbowscrew.view.decimation import drawn_rows

SUBJECT, CONDITION = "subject", "condition"
_ALWAYS: Final = (SUBJECT, CONDITION)
_BEFORE, _BEHIND = "path", "frames"  # columns of a batch's summary.csv around those that its manifest brought
_MOST_LEVELS: Final = 12
_MOST_FACTORS: Final = 6
_THETA: Final = tuple(column for column in tables.SCREW_COLUMNS if column.name in ("theta", "time_s"))
_KEPT_BUCKETS: Final = 40
_LONGEST_CELL: Final = 1 << 20

Units = tuple[AngleUnit, LengthUnit]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyTrial:
    """One trial of a study; a few kilobytes, as there may be ten thousand.

    Attributes
    ----------
    folder : str
        The result's folder relative to the study's, with slashes.
    joint : str
        Which joint it is.
    values : mapping of str to float
        Numbers of `elbowscrew.report.measures.COLUMNS` by their keys, NaN where not known.
    warnings : tuple of str
        Their codes, each once.
    time_s, theta : ndarray, shape (M,)
        Seconds and degrees, as many points as a thumbnail needs.
    curve : ndarray, shape (101,), or None
        Mean of its cycles, radians; None if none is complete and known throughout.
    axis : TrialAxis or None
        Its axis in the bones' frame; None without landmarks, or without an axis.
    units : tuple of str
        Angle and length in its tables.
    page : bool
        Whether it has a ``report.html``.
    reported : mapping of str to str or None
        How it was recorded and analyzed, by the entries of the reporting checklist that a study has in common.
    settings : str
        All settings, as JSON.
    factors : mapping of str to str
        What the manifest says of it.
    """

    folder: str
    joint: str
    values: Mapping[str, float]
    warnings: tuple[str, ...]
    time_s: Float
    theta: Float
    curve: Float | None
    axis: TrialAxis | None
    units: Units
    page: bool
    reported: Mapping[str, str | None]
    settings: str
    factors: Mapping[str, str] = field(default_factory=dict)

    @property
    def subject(self) -> str:
        """Whom it is of; empty where nothing says it."""
        return said_of(self.factors, SUBJECT)

    @property
    def condition(self) -> str:
        """Under which condition it was recorded; empty where nothing says it."""
        return said_of(self.factors, CONDITION)


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """A trial without a result: its path, the kind of error, and what it says."""

    path: str
    kind: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """Trials of a folder by their folders, the columns that the manifest brought, and what failed.

    Where there is a ``summary.csv``, trials are those that it names; `others` are results beside them. `unread` are
    trials whose results could not be read just now. `units` are those of the tables over all trials.
    """

    name: str
    trials: tuple[StudyTrial, ...]
    factors: tuple[str, ...]
    failures: tuple[Failure, ...]
    others: tuple[str, ...] = ()
    unread: tuple[Failure, ...] = ()
    units: Units = ("deg", "mm")


def result_folders(folder: Path) -> Iterator[Path]:
    """Find result folders inside a folder, in order of their names; links are not followed."""
    left = [folder]
    while left:
        here = left.pop()
        if here != folder and is_result(here):
            yield here
            continue
        with suppress(OSError), os.scandir(here) as entries:
            names = [one.name for one in entries if one.is_dir(follow_symlinks=False) and not one.name.startswith(".")]
            left += [here / name for name in sorted(names, reverse=True)]


def read_study(folder: Path, factors: Sequence[str] | None = None) -> Study:
    """Read a folder of results.

    Parameters
    ----------
    folder : Path
        With ``summary.csv`` and ``failures.csv`` if there.
    factors : sequence of str, optional
        Columns of ``summary.csv`` that tell trials apart; by default subject, condition, and those with a few words.

    Raises
    ------
    ResultError
        If there are neither results nor failures, or a table is no table. A damaged result is a failure of its trial.
    """
    trials, unread, failures = [], [], _failures(folder / "failures.csv")
    for result in result_folders(folder):
        name = result.relative_to(folder).as_posix()
        try:
            trials.append(_trial(result, name))
        except ResultError as error:
            unread.append(Failure(path=name, kind="ResultError", message=str(error)))
    if not trials and not unread and not failures:
        msg = f"{folder}: holds no finished results; analyze trials into it first"
        raise ResultError(msg)
    table = _rows(folder / "summary.csv")
    said = _said_of(table, {trial.folder for trial in trials})
    chosen = tuple(_factors(said) if factors is None else factors)
    kept = tuple(
        replace(trial, factors={name: said.get(trial.folder, {}).get(name, "") for name in chosen})
        for trial in trials
        if not said or trial.folder in said
    )
    return Study(
        name=folder.resolve().name or "study",
        trials=kept,
        factors=chosen,
        failures=tuple(failures),
        others=tuple(trial.folder for trial in trials if said and trial.folder not in said),
        unread=tuple(unread),
        units=_units(table[0] if table else ()),
    )


def _units(header: Sequence[str]) -> Units:
    """Units of ``summary.csv``, by the names of its columns."""
    return (
        "rad" if any(name.endswith("_rad") for name in header) else "deg",
        "m" if "slide_median_m" in header else "mm",
    )


def trials_of(results: Sequence[Path]) -> Study:
    """Read results that may lie in several folders, with subject and condition; trials are named by their paths.

    Both stand in the nearest ``summary.csv`` above a result.

    Raises
    ------
    ResultError
        If a result cannot be read.
    """
    names: dict[Path, dict[str, Path]] = {}
    for result in results:
        above = result.absolute().parents
        base = next((folder for folder in above if (folder / "summary.csv").is_file()), above[0])
        names.setdefault(base, {})[result.absolute().relative_to(base).as_posix()] = result
    factors: dict[Path, dict[str, str]] = {}
    for base, inside in names.items():
        said = _said_of(_rows(base / "summary.csv"), set(inside))
        for name, result in inside.items():
            factors[result] = {factor: said_of(said.get(name, {}), factor) for factor in _ALWAYS}
    trials = tuple(replace(_trial(result, str(result)), factors=factors[result]) for result in results)
    return Study(name="", trials=trials, factors=_ALWAYS, failures=())


def said_of(factors: Mapping[str, str], name: str) -> str:
    """Look up what a table says of a trial, however it writes the name of the column."""
    return next((value for factor, value in factors.items() if factor.strip().casefold() == name), "")


def _trial(result: Path, name: str) -> StudyTrial:
    proof = proof_of(result)
    summary = read_summary(proof)
    settings = settings_in(summary, result)
    units = settings.angle_unit, settings.length_unit
    columns = read_columns(proof.file("screw.csv"), _THETA, *units)
    theta = np.degrees(columns["theta"])
    rows = drawn_rows(theta, keep_gaps=True, parts=_KEPT_BUCKETS)
    try:
        values = {one.key: one.read(summary) for one in COLUMNS}
        if not theta.size:
            msg = "screw.csv has no rows"
            raise ValueError(msg)
        return StudyTrial(
            folder=name,
            joint=summary["trial"]["joint"]["name"],
            values={key: np.nan if value is None else float(value) for key, value in values.items()},
            warnings=tuple(dict.fromkeys(one["code"] for one in summary["warnings"] if one["severity"] == "warning")),
            time_s=columns["time_s"][rows],
            theta=theta[rows],
            curve=curve_of_result(proof, *units)[0],
            axis=None if summary["landmarks"] is None else axis_of(read_joint_summary(proof)),
            units=units,
            page=(result / "report.html").is_file(),
            reported=_once(common_of(SummaryFacts(summary, settings))),
            settings=sys.intern(json.dumps(summary["settings"], sort_keys=True)),
        )
    except UNREADABLE as error:
        raise unshowable(result, error) from error


def _once(reported: Mapping[str, str | None]) -> dict[str, str | None]:
    """Hold texts that many trials share a single time."""
    return {title: text if text is None else sys.intern(text) for title, text in reported.items()}


def _failures(path: Path) -> list[Failure]:
    return [
        Failure(path=cells[0], kind=cells[1], message=cells[2])
        for cells in ([*row, "", "", ""][:3] for row in _rows(path)[1:])
    ]


def _said_of(rows: list[list[str]], folders: set[str]) -> dict[str, dict[str, str]]:
    """Rows of ``summary.csv`` by the results they are of: one of its columns names their folders."""
    if len(rows) < 2:
        return {}
    header = rows[0]
    matches = [sum(_folder(row, k) in folders for row in rows[1:]) for k in range(len(header))]
    best = int(np.argmax(matches)) if matches else 0
    if not matches or not matches[best]:
        return {}
    return {_folder(row, best): dict(zip(header, row, strict=False)) for row in rows[1:]}


def _folder(row: list[str], column: int) -> str:
    """Read a cell as a folder; an apostrophe is what keeps spreadsheets from taking a name for a formula."""
    return row[column].replace("\\", "/").rstrip("/").removeprefix("'") if column < len(row) else ""


def _factors(said: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Subject and condition, and other columns of a few different words; of a batch those of its manifest."""
    names = list(dict.fromkeys(name for row in said.values() for name in row))
    carried = _BEFORE in names and _BEHIND in names
    if carried:
        names = names[names.index(_BEFORE) + 1 : names.index(_BEHIND)]
    found = [name for name in names if name.strip().casefold() in _ALWAYS]
    for name in names:
        levels = {row.get(name, "") for row in said.values()} - {""}
        if name not in found and 1 < len(levels) <= _MOST_LEVELS and (carried or not any(map(_is_number, levels))):
            found.append(name)
    return found[:_MOST_FACTORS]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _rows(path: Path) -> list[list[str]]:
    if not path.exists():
        return []
    try:
        with longest_cell(_LONGEST_CELL), open_text(path, encoding="utf-8-sig", newline="") as stream:
            return [row for row in csv.reader(stream) if row]
    except OSError as error:
        msg = f"{path}: cannot be read: {error.strerror or error}"
        raise ResultError(msg) from error
    except (csv.Error, UnicodeDecodeError) as error:
        msg = f"{path}: not a table of a batch: {error}; run the batch again"
        raise ResultError(msg) from error
