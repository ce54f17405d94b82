"""The page over all trials of a study."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple, TypedDict

import numpy as np
from markupsafe import Markup

from elbowscrew.errors import OutputError
from elbowscrew.group.curves import LEAST_FOR_BAND
from elbowscrew.group.outliers import FALSE_ALARMS, LEAST, Outliers
from elbowscrew.report.checklist import MISSING
from elbowscrew.report.distributions import MOST_POINTS, strip_chart
from elbowscrew.report.measures import MEASURES
from elbowscrew.report.pages import INDEX, MARK, render
from elbowscrew.report.study import Failure, Study, StudyTrial, read_study, result_folders
from elbowscrew.report.study_checklist import Findings, study_checklist
from elbowscrew.report.study_curves import curve_charts, curves_of, left_out_text
from elbowscrew.report.study_differences import MOST_COMPARED, differences_of
from elbowscrew.report.study_groups import Group, axis_rows, groups_of, number_rows, outlying, values_of
from elbowscrew.report.study_tables import STUDY_TABLES, TABLE_MARK, study_tables
from elbowscrew.report.trials_table import marks_of, shown_columns, table_data, table_rows
from elbowscrew.results.staging import moved_aside, settle, write_files

_MOST_STRIPS: Final = 24
_MOST_FAILURES: Final = 200
_SCRIPTS: Final = ("page.js", "study.js")


class WrittenStudy(NamedTuple):
    """The page, the tables beside it, and the trials whose results could not be shown."""

    page: Path
    tables: tuple[Path, ...]
    unread: tuple[Failure, ...]


class Factor(TypedDict):
    """A column of the manifest, and what it says."""

    name: str
    levels: list[str]


def write_study_page(folder: Path, factors: Sequence[str] | None = None) -> WrittenStudy:
    """Write ``index.html``, ``cycles.csv`` and ``repetitions.csv`` over the results in a folder."""
    places = {folder}
    for result in result_folders(folder):  # all of them, before any is read
        places.add(result.parent)
        with suppress(OutputError):  # reading it tells what is wrong with that one
            settle(result)
    study = read_study(folder, factors)
    missing = [_missing(folder, path) for place in sorted(places) for path in moved_aside(place)]
    study = replace(study, unread=(*study.unread, *missing))
    told = {name for name in ("summary.csv", "failures.csv") if (folder / name).is_file()}
    page = study_page(study, [*sorted(told, reverse=True), *STUDY_TABLES])
    contents: dict[str, Iterable[str] | bytes] = {INDEX: page.encode("utf-8", "replace")}
    contents |= study_tables(folder, study)
    write_files(folder, contents, replaceable=(MARK, TABLE_MARK))
    return WrittenStudy(folder / INDEX, tuple(folder / name for name in STUDY_TABLES), study.unread)


def _missing(folder: Path, aside: Path) -> Failure:
    message = f"{aside}: an earlier result that a run which was killed has moved aside; do that run again"
    return Failure(path=aside.relative_to(folder).as_posix(), kind="ResultError", message=message)


def not_shown(page: Path, trial: Failure) -> str:
    """Say that the page shows as failed a trial that has a result."""
    return f"{page}: shows a trial as failed: {trial.message}"


def study_page(study: Study, tables: Sequence[str] = ()) -> str:
    """Make the page of a study.

    Parameters
    ----------
    study : Study
        From `elbowscrew.report.study.read_study`.
    tables : sequence of str
        Files beside the page that it links to.

    Returns
    -------
    str
        HTML that needs no other file but the trials' pages it links to. The same results give the same bytes.
    """
    trials = study.trials
    groups, grouped_by = groups_of(study, trials)
    found = outlying(trials, groups)
    marks = marks_of(trials, found)
    curves = curves_of(trials, groups)
    differences = differences_of(trials, groups)
    subjects = {trial.subject for trial in trials} - {""}
    numbers, axes = number_rows(trials, groups), axis_rows(trials, groups)
    outliers = sum(bool(outlier) for outlier, _ in marks)
    tests = sum(of.tests for of in found.values())
    shown = Findings(study, groups, grouped_by, numbers, curves, differences, axes, outliers, tests)
    content = {
        "name": study.name,
        "tables": tables,
        "count": len(trials),
        "rows": table_rows(trials, marks),
        "factors": [Factor(name=name, levels=_levels(trials, name)) for name in study.factors],
        "group_name": grouped_by,
        "subjects": len(subjects),
        "numbers": numbers,
        "curves": curve_charts(curves, groups),
        "left_out": left_out_text(curves.left_out),
        "least_for_band": LEAST_FOR_BAND,
        "differences": differences,
        "most_compared": MOST_COMPARED,
        "axes": axes,
        "columns": shown_columns(trials),
        "charts": _charts(trials, groups if len(groups) <= _MOST_STRIPS else _one_group(groups), found),
        "failed": len(shown.failures),
        "failures": shown.failures[:_MOST_FAILURES],
        "others": study.others,
        "outliers": outliers,
        "warned": sum(bool(warnings) for _, warnings in marks),
        "false_alarms": FALSE_ALARMS,
        "least": LEAST,
        "most_points": MOST_POINTS,
        "checklist": study_checklist(shown),
        "missing": MISSING,
    }
    data = table_data(trials, study.factors, marks)
    names = {name for trial in trials for name in (trial.folder, trial.subject, *trial.factors.values())}
    return render(
        "study.html",
        styles=("page.css", "study.css"),
        scripts=_SCRIPTS,
        data=data,
        content=content,
        names={study.name, *names},
    )


def _one_group(groups: Sequence[Group]) -> list[Group]:
    return [Group("all trials", "", sorted(k for group in groups for k in group.rows))]


def _charts(
    trials: Sequence[StudyTrial], groups: Sequence[Group], found: Mapping[str, Outliers]
) -> list[tuple[str, Markup]]:
    charts = []
    for measure in MEASURES:
        values, of = values_of(trials, measure), found[measure.key]
        far = (of.trial != 0) | (of.subject != 0)
        strips = {
            group.name: (values[group.rows], [trials[k].folder for k in group.rows], far[group.rows])
            for group in groups
        }
        if np.isfinite(values).any():
            charts.append((measure.title, strip_chart(measure.key, measure.title, measure.unit, strips)))
    return charts


def _levels(trials: Sequence[StudyTrial], factor: str) -> list[str]:
    return sorted({trial.factors.get(factor, "") for trial in trials} - {""})
