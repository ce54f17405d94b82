"""The page over all trials of a study."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple, TypedDict
from urllib.parse import quote

import numpy as np
from markupsafe import Markup

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.curves import LEAST_FOR_BAND
from elbowscrew.group.outliers import FALSE_ALARMS, LEAST, Outliers
from elbowscrew.report.charts import path_of
from elbowscrew.report.distributions import strip_chart
from elbowscrew.report.measures import COLUMNS, MEASURES
from elbowscrew.report.pages import INDEX, MARK, render
from elbowscrew.report.study import Failure, Study, StudyTrial, read_study
from elbowscrew.report.study_curves import curve_charts, curves_of, left_out_text
from elbowscrew.report.study_groups import Group, axis_rows, groups_of, number_rows, outlying, values_of
from elbowscrew.report.study_tables import STUDY_TABLES, TABLE_MARK, study_tables
from elbowscrew.results.staging import write_files
from elbowscrew.view.decimation import drawn_rows

_THUMB: Final = (132.0, 34.0)
_THUMB_BUCKETS: Final = 40
_MOST_STRIPS: Final = 24


class TrialRow(TypedDict):
    """What the table shows of a trial: the numbers of `COLUMNS` by their keys, NaN where not known."""

    folder: str
    link: str | None
    thumb: Markup
    factors: list[tuple[str, str]]
    values: Mapping[str, float]
    warnings: Sequence[str]
    outlier: list[str]


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
    study = read_study(folder, factors)
    told = {name for name in ("summary.csv", "failures.csv") if (folder / name).is_file()}
    page = study_page(study, [*sorted(told, reverse=True), *STUDY_TABLES])
    contents: dict[str, Iterable[str] | bytes] = {INDEX: page.encode("utf-8", "replace")}
    contents |= study_tables(folder, study)
    write_files(folder, contents, replaceable=(MARK, TABLE_MARK))
    return WrittenStudy(folder / INDEX, tuple(folder / name for name in STUDY_TABLES), study.unread)


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
    scale = _scale(trials)
    rows = [_row(trial, scale) for trial in trials]
    groups, grouped_by = groups_of(study, trials)
    found = outlying(trials, groups)
    _mark_outliers(rows, trials, found)
    curves = curves_of(trials, groups)
    subjects = {trial.subject for trial in trials} - {""}
    content = {
        "name": study.name,
        "tables": tables,
        "rows": rows,
        "factors": [Factor(name=name, levels=_levels(trials, name)) for name in study.factors],
        "group_name": grouped_by,
        "subjects": len(subjects),
        "numbers": number_rows(trials, groups),
        "curves": curve_charts(curves, groups),
        "left_out": left_out_text(curves.left_out),
        "least_for_band": LEAST_FOR_BAND,
        "axes": axis_rows(trials, groups),
        "columns": COLUMNS,
        "charts": _charts(trials, groups if len(groups) <= _MOST_STRIPS else _one_group(groups), found),
        "failures": [*study.failures, *study.unread],
        "others": study.others,
        "outliers": sum(bool(row["outlier"]) for row in rows),
        "warned": sum(bool(row["warnings"]) for row in rows),
        "false_alarms": FALSE_ALARMS,
        "least": LEAST,
    }
    return render("study.html", styles=("page.css", "study.css"), scripts=("study.js",), data={}, content=content)


def thumbnail(time_s: Float, theta: Float, scale: tuple[float, float]) -> Markup:
    """Draw an angle over time in a few hundred bytes; times are the trial's own, angles to a common scale."""
    width, height = _THUMB
    rows = drawn_rows(theta, keep_gaps=True, parts=_THUMB_BUCKETS)
    span = float(time_s[-1] - time_s[0]) or 1.0
    x = np.round(1.0 + (width - 2.0) * (time_s[rows] - time_s[0]) / span)
    y = np.round(height - 2.0 - (height - 4.0) * (theta[rows] - scale[0]) / ((scale[1] - scale[0]) or 1.0), 1)
    shape = path_of(x, y).replace(".0", "")
    return Markup(  # noqa: S704 - numbers only
        f'<svg class="thumb" width="{width:g}" height="{height:g}" aria-hidden="true" focusable="false">'
        f'<path d="{shape}"/></svg>'
    )


def _scale(trials: Sequence[StudyTrial]) -> tuple[float, float]:
    known = [trial.theta[np.isfinite(trial.theta)] for trial in trials]
    known = [theta for theta in known if theta.size]
    if not known:
        return 0.0, 1.0
    return min(float(theta.min()) for theta in known), max(float(theta.max()) for theta in known)


def _row(trial: StudyTrial, scale: tuple[float, float]) -> TrialRow:
    return {
        "folder": trial.folder,
        "link": quote(f"{trial.folder}/report.html", safe="/") if trial.page else None,
        "thumb": thumbnail(trial.time_s, trial.theta, scale),
        "factors": list(trial.factors.items()),
        "values": trial.values,
        "warnings": trial.warnings,
        "outlier": [],
    }


def _mark_outliers(rows: list[TrialRow], trials: Sequence[StudyTrial], found: Mapping[str, Outliers]) -> None:
    for measure in MEASURES:
        of = found[measure.key]
        for sides, whose in ((of.trial, False), (of.subject, True)):
            for k in np.flatnonzero(sides).tolist():
                text = f"{measure.title} {'high' if sides[k] > 0 else 'low'}"
                rows[k]["outlier"].append(f"{trials[k].subject}: {text}" if whose else text)


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
