"""The cycles of all trials of a study in two long tables, written trial by trial, however many there are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from elbowscrew import tables
from elbowscrew.errors import ResultError
from elbowscrew.quantities import in_units, unit_suffixes
from elbowscrew.report.study import CONDITION, SUBJECT, Study, StudyTrial
from elbowscrew.results.proof import ProvedFile, proof_of
from elbowscrew.results.table_reading import read_columns
from elbowscrew.results.table_text import safe_cell
from elbowscrew.results.writing import lines_of, quoted

_TRIAL: Final = "trial"
_KEYS: Final = (_TRIAL, SUBJECT, CONDITION)
TABLE_MARK: Final = ",".join(_KEYS)
"""What a table of ours begins with, so that it may be replaced."""
STUDY_TABLES: Final = {"repetitions.csv": tables.REPETITION_COLUMNS, "cycles.csv": tables.CYCLE_COLUMNS}
"""A row a cycle, and a row a percent of each cycle: as in the results, behind trial, subject and condition."""


def study_tables(folder: Path, study: Study) -> dict[str, Iterator[str]]:
    """Give the tables of a study by their names, as lines that are read from the results when they are asked for.

    Parameters
    ----------
    folder : Path
        The study's.
    study : Study
        From `elbowscrew.report.study.read_study`.

    Raises
    ------
    ResultError
        While the lines are taken, if a table of a result is not as it was written.
    """
    return {name: _lines(folder, study, name, table) for name, table in STUDY_TABLES.items()}


def _lines(folder: Path, study: Study, name: str, table: tuple[tables.Column, ...]) -> Iterator[str]:
    yield ",".join([*_KEYS, *_header(table, study)])
    for trial in study.trials:
        proof = proof_of(folder / trial.folder)
        if proof.has(name):
            said = ",".join(quoted(safe_cell(cell)) for cell in (trial.folder, trial.subject, trial.condition))
            for line in _rows(proof.file(name), table, trial, study):
                yield f"{said},{line}"


def _rows(source: ProvedFile, table: tuple[tables.Column, ...], trial: StudyTrial, study: Study) -> list[str]:
    """Rows of a trial's table: letter by letter, or anew where the study has other units."""
    if trial.units != study.units:
        read = read_columns(source, table, *trial.units)
        return lines_of([in_units(read[column.name], column.quantity, *study.units) for column in table])
    try:
        with source.opened() as stream:
            lines = stream.read().decode("utf-8").splitlines()
    except OSError as error:
        msg = f"{source.path}: cannot be read: {error.strerror or error}; analyze the trial again"
        raise ResultError(msg) from error
    if lines[:1] != [",".join(_header(table, study))]:
        msg = f"{source.path}: not a table of this version of the program; analyze the trial again"
        raise ResultError(msg)
    return lines[1:]


def _header(table: tuple[tables.Column, ...], study: Study) -> list[str]:
    suffixes = unit_suffixes(*study.units)
    return [column.name + suffixes.get(column.quantity, "") for column in table]
