"""The page over all trials of a study."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple, TypedDict
from urllib.parse import quote

import numpy as np
from markupsafe import Markup

from elbowscrew.geometry.arrays import Float
from elbowscrew.model.summary_types import MotionSummary, Summary
from elbowscrew.report.charts import path_of
from elbowscrew.report.distributions import LEAST, LIMIT, modified_z, strip_chart
from elbowscrew.report.pages import MARK, UNSHOWABLE, render, unshowable
from elbowscrew.report.study import CONDITION, Failure, Study, StudyTrial, read_study
from elbowscrew.results.staging import write_files
from elbowscrew.view.decimation import drawn_rows

_INDEX: Final = "index.html"
_THUMB: Final = (132.0, 34.0)
_THUMB_BUCKETS: Final = 40
_MOST_STRIPS: Final = 24
_ALL: Final = "all trials"
_JOINT: Final = "joint"


class Measure(NamedTuple):
    """A number of each trial, and how it is read from ``summary.json``."""

    key: str
    title: str
    unit: str
    read: Callable[[Summary], float | None]
    decimals: int


def _second_range(motion: MotionSummary) -> float | None:
    """Range about the second of two axes; None of other joints."""
    two = motion["joint_numbers"]["two_axes"]
    return None if two is None else two["axis2"]["range_deg"]


def _cone(motion: MotionSummary) -> float | None:
    joint = motion["joint_axis"]
    return None if joint is None else joint["axis_cone95_deg"]


MEASURES: Final = (
    Measure("top", "Largest angle", "deg", lambda one: one["motion"]["theta_max_deg"], 1),
    Measure("dispersion", "Dispersion of the axes", "deg", lambda one: one["motion"]["axis_dispersion_deg"], 2),
    Measure("second", "Range about the second axis", "deg", lambda one: _second_range(one["motion"]), 1),
    Measure("error", "Model error, RMS rotation", "deg", lambda one: one["interpolation"]["rms_angle_error_deg"], 2),
)
"""Those that are compared over the trials."""
COLUMNS: Final = (
    Measure("frames", "Frames", "", lambda one: one["trial"]["frames"], 0),
    Measure("tracked", "Tracked", "%", lambda one: 100.0 * (1.0 - one["trial"]["missing_share"]), 1),
    *MEASURES,
    Measure("cone", "Axis 95 % cone", "deg", lambda one: _cone(one["motion"]), 3),
    Measure("displacement", "RMS displacement", "mm", lambda one: one["interpolation"]["rms_displacement_mm"], 2),
    Measure("repetitions", "Repetitions", "", lambda one: one["motion"]["repetitions"], 0),
)
"""Those that stand in the table of the trials, in order."""


class TrialRow(TypedDict):
    """What the table shows of a trial: the numbers of `COLUMNS` by their keys, NaN where not known."""

    folder: str
    link: str | None
    thumb: Markup
    factors: list[tuple[str, str]]
    values: dict[str, float]
    warnings: list[str]
    outlier: list[str]


class StudyPage(NamedTuple):
    """One HTML file, and the trials whose results it could not show."""

    html: str
    unread: tuple[Failure, ...]


class GroupRow(TypedDict):
    """Trials alike in a factor: of each measure its decimals, and its median and quartiles."""

    name: str
    count: int
    cells: list[tuple[int, list[float | None]]]


class Factor(TypedDict):
    """A column of the manifest, and what it says."""

    name: str
    levels: list[str]


def write_study_page(folder: Path, factors: Sequence[str] | None = None) -> tuple[Path, tuple[Failure, ...]]:
    """Write ``index.html`` over the results in a folder, and give it and the trials that it could not show."""
    page = study_page(read_study(folder, factors))
    write_files(folder, {_INDEX: page.html.encode("utf-8", "replace")}, replaceable=(MARK,))
    return folder / _INDEX, page.unread


def not_shown(page: Path, trial: Failure) -> str:
    """Say that the page shows as failed a trial that has a result."""
    return f"{page}: shows a trial as failed: {trial.message}"


def study_page(study: Study) -> StudyPage:
    """Make the page of a study.

    Parameters
    ----------
    study : Study
        From `elbowscrew.report.study.read_study`.

    Returns
    -------
    StudyPage
        It needs no other file but the trials' pages it links to. The same results give the same bytes.
    """
    trials, unread = [], list(study.unread)
    rows: list[TrialRow] = []
    scale = _scale(study.trials)
    for trial in study.trials:
        try:
            rows.append(_row(trial, scale))
            trials.append(trial)
        except UNSHOWABLE as error:
            unread.append(Failure(path=trial.folder, kind="ResultError", message=str(unshowable(Path(), error))))
    groups = _groups(trials, _group_factor(study))
    _mark_outliers(rows, groups)
    content = {
        "name": study.name,
        "rows": rows,
        "factors": [Factor(name=name, levels=_levels(trials, name)) for name in study.factors],
        "group_name": _group_name(study, trials),
        "groups": _table_of_groups(rows, groups),
        "measures": MEASURES,
        "columns": COLUMNS,
        "charts": _charts(rows, groups if len(groups) <= _MOST_STRIPS else _groups(trials, None)),
        "failures": [*study.failures, *unread],
        "others": study.others,
        "outliers": sum(bool(row["outlier"]) for row in rows),
        "warned": sum(bool(row["warnings"]) for row in rows),
        "limit": LIMIT,
        "least": LEAST,
    }
    html = render("study.html", styles=("page.css", "study.css"), script="study.js", data={}, content=content)
    return StudyPage(html, tuple(unread))


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
    summary = trial.summary
    if not trial.theta.size:
        msg = "screw.csv has no rows"
        raise ValueError(msg)
    warnings = [one["code"] for one in summary["warnings"] if one["severity"] == "warning"]
    values = {one.key: one.read(summary) for one in COLUMNS}
    return {
        "folder": trial.folder,
        "link": quote(f"{trial.folder}/report.html", safe="/") if trial.page else None,
        "thumb": thumbnail(trial.time_s, trial.theta, scale),
        "factors": list(trial.factors.items()),
        "values": {key: np.nan if value is None else value for key, value in values.items()},
        "warnings": list(dict.fromkeys(warnings)),
        "outlier": [],
    }


def _group_name(study: Study, trials: Sequence[StudyTrial]) -> str | None:
    """Name what groups the distributions: the joint where there are several, and the manifest's factor."""
    return " and ".join(name for name in (_JOINT * _several_joints(trials), _group_factor(study)) if name) or None


def _group_factor(study: Study) -> str | None:
    """Name the factor that groups the distributions: the condition, else the manifest's first column."""
    named = [name for name in study.factors if name.strip().casefold() == CONDITION]
    return next(iter([*named, *study.factors]), None)


def _groups(trials: Sequence[StudyTrial], factor: str | None) -> dict[str, list[int]]:
    """Trials by joint and factor: numbers of two joints have no common median."""
    several = _several_joints(trials)
    groups: dict[str, list[int]] = {}
    for k, trial in enumerate(trials):
        words = [_joint_of(trial)] if several else []
        words += [] if factor is None else [trial.factors.get(factor, "") or "–"]
        groups.setdefault(", ".join(words) or _ALL, []).append(k)
    return dict(sorted(groups.items()))


def _joint_of(trial: StudyTrial) -> str:
    return trial.summary["trial"]["joint"]["name"]


def _several_joints(trials: Sequence[StudyTrial]) -> bool:
    return len({_joint_of(trial) for trial in trials}) > 1


def _mark_outliers(rows: list[TrialRow], groups: Mapping[str, list[int]]) -> None:
    for measure in MEASURES:
        for members in groups.values():
            values = np.array([rows[k]["values"][measure.key] for k in members], dtype=np.float64)
            for k, z in zip(members, modified_z(values).tolist(), strict=True):
                if abs(z) > LIMIT:
                    rows[k]["outlier"].append(f"{measure.title} {'high' if z > 0.0 else 'low'}")


def _table_of_groups(rows: list[TrialRow], groups: Mapping[str, list[int]]) -> list[GroupRow]:
    """Count, median and quartiles of each measure in each group."""
    table: list[GroupRow] = []
    for name, members in groups.items():
        cells: list[tuple[int, list[float | None]]] = []
        for measure in MEASURES:
            values = np.array([rows[k]["values"][measure.key] for k in members], dtype=np.float64)
            known = values[np.isfinite(values)]
            quartiles = np.percentile(known, [50, 25, 75]).tolist() if known.size else [None] * 3
            cells.append((measure.decimals, quartiles))
        table.append({"name": name, "count": len(members), "cells": cells})
    return table


def _charts(rows: list[TrialRow], groups: Mapping[str, list[int]]) -> list[tuple[str, Markup]]:
    charts = []
    for measure in MEASURES:
        strips = {
            name: (
                np.array([rows[k]["values"][measure.key] for k in members], dtype=np.float64),
                [rows[k]["folder"] for k in members],
            )
            for name, members in groups.items()
        }
        if any(np.isfinite(values).any() for values, _ in strips.values()):
            charts.append((measure.title, strip_chart(measure.key, measure.title, measure.unit, strips)))
    return charts


def _levels(trials: Sequence[StudyTrial], factor: str) -> list[str]:
    return sorted({trial.factors.get(factor, "") for trial in trials} - {""})
