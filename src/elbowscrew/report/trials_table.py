"""The table of a study's trials: its first rows as text, and all of them as data that the page's script draws."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, TypedDict
from urllib.parse import quote

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.outliers import Outliers
from elbowscrew.report.measures import COLUMNS, MEASURES, Measure
from elbowscrew.report.study import StudyTrial

ROWS_AS_TEXT: Final = 100
"""Rows that are there without a script."""
_PARTS: Final = 33
_LEVELS: Final = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_"
_GAP: Final = "."
_THUMB: Final = (100, 34)

Marks = tuple[tuple[str, ...], tuple[str, ...]]
"""What stands out in a trial, and the codes of its warnings."""


class TrialRow(TypedDict):
    """What the table shows of a trial: the numbers of `COLUMNS` by their keys, NaN where not known."""

    folder: str
    link: str | None
    thumb: Markup
    factors: list[tuple[str, str]]
    values: Mapping[str, float]
    warnings: Sequence[str]
    outlier: Sequence[str]


def shown_columns(trials: Sequence[StudyTrial]) -> list[Measure]:
    """Columns of `COLUMNS` in which something is known."""
    return [one for one in COLUMNS if any(math.isfinite(trial.values[one.key]) for trial in trials)]


def marks_of(trials: Sequence[StudyTrial], found: Mapping[str, Outliers]) -> list[Marks]:
    """Say of each trial what is to be looked at."""
    outlying: list[list[str]] = [[] for _ in trials]
    for measure in MEASURES:
        of = found[measure.key]
        for sides, whose in ((of.trial, False), (of.subject, True)):
            for k in np.flatnonzero(sides).tolist():
                text = f"{measure.title} {'high' if sides[k] > 0 else 'low'}"
                outlying[k].append(f"{trials[k].subject}: {text}" if whose else text)
    return [(tuple(texts), trial.warnings) for texts, trial in zip(outlying, trials, strict=True)]


def table_rows(trials: Sequence[StudyTrial], marks: Sequence[Marks]) -> list[TrialRow]:
    """Give the rows that are there without a script, drawn as the script draws them."""
    scale = _scale(trials)
    return [
        {
            "folder": trial.folder,
            "link": quote(f"{_whole(trial.folder)}/report.html", safe="/") if trial.page else None,
            "thumb": thumbnail(thumb_code(trial.time_s, trial.theta, scale)),
            "factors": list(trial.factors.items()),
            "values": trial.values,
            "warnings": warnings,
            "outlier": outlier,
        }
        for trial, (outlier, warnings) in zip(trials[:ROWS_AS_TEXT], marks, strict=False)
    ]


def table_data(trials: Sequence[StudyTrial], factors: Sequence[str], marks: Sequence[Marks]) -> dict[str, Any]:
    """Give all rows, column by column, as JSON: what repeats stands there once, numbers as they are shown."""
    scale = _scale(trials)
    columns = shown_columns(trials)
    kinds: dict[Marks, int] = {}
    of = [kinds.setdefault(mark, len(kinds)) for mark in marks]
    return {
        "folders": [_whole(trial.folder) for trial in trials],
        "without_page": [k for k, trial in enumerate(trials) if not trial.page],
        "thumbs": "".join(thumb_code(trial.time_s, trial.theta, scale) for trial in trials),
        "levels": _LEVELS,
        "factors": [_coded([trial.factors.get(name, "") for trial in trials]) for name in factors],
        "marks": [list(map(list, kind)) for kind in kinds],
        "mark": of,
        "decimals": [column.decimals for column in columns],
        "values": [_rounded([trial.values[column.key] for trial in trials], column.decimals) for column in columns],
    }


def thumb_code(time_s: Float, theta: Float, scale: tuple[float, float]) -> str:
    """Write an angle over time as heights, the extremes of each thirty-third of its time in their order.

    Times are the trial's own, angles to a common scale. A part without any known angle is a gap.
    """
    time = (time_s - time_s[0]) * (_PARTS / ((time_s[-1] - time_s[0]) or 1.0))
    edges = np.arange(1.0, _PARTS)
    time, theta = np.append(time, edges), np.append(theta, np.interp(edges, time, theta))
    known = np.isfinite(theta)
    time, theta = time[known], theta[known]
    part = np.minimum(time.astype(np.intp), _PARTS - 1)
    order = np.lexsort((theta, part))
    begin, end = (np.searchsorted(part[order], np.arange(_PARTS), side) for side in ("left", "right"))
    codes = np.full((_PARTS, 2), len(_LEVELS), dtype=np.intp)
    there = begin < end
    low, high = order[begin[there]], order[end[there] - 1]
    ends = np.where((time[low] <= time[high])[:, None], np.column_stack([low, high]), np.column_stack([high, low]))
    share = (theta[ends] - scale[0]) / ((scale[1] - scale[0]) or 1.0)
    codes[there] = np.clip(np.rint(share * (len(_LEVELS) - 1)), 0, len(_LEVELS) - 1)
    return "".join((_LEVELS + _GAP)[code] for code in codes.ravel().tolist())


def thumbnail(code: str) -> Markup:
    """Draw what `thumb_code` has written; the page's script does the same."""
    width, height = _THUMB
    parts, open_before = [], False
    for k, letter in enumerate(code):
        if letter != _GAP:
            up = height - 2 - (height - 4) * _LEVELS.index(letter) / (len(_LEVELS) - 1)
            parts.append(f"{'L' if open_before else 'M'}{1 + 1.5 * k:g} {up:.1f}")
        open_before = letter != _GAP
    return Markup(  # noqa: S704 - numbers only
        f'<svg class="thumb" width="{width}" height="{height}" aria-hidden="true" focusable="false">'
        f'<path d="{"".join(parts)}"/></svg>'
    )


def _scale(trials: Sequence[StudyTrial]) -> tuple[float, float]:
    known = [trial.theta[np.isfinite(trial.theta)] for trial in trials]
    known = [theta for theta in known if theta.size]
    if not known:
        return 0.0, 1.0
    return min(float(theta.min()) for theta in known), max(float(theta.max()) for theta in known)


def _whole(text: str) -> str:
    """Text whose letters all can be written, as the page's own are."""
    return text.encode("utf-8", "replace").decode("utf-8")


def _coded(words: Sequence[str]) -> dict[str, list[Any]]:
    """Words, each once in order, and which of them stands in each row."""
    names = sorted(set(words))
    place = {name: k for k, name in enumerate(names)}
    return {"words": [_whole(name) for name in names], "of": [place[word] for word in words]}


def _rounded(values: Sequence[float], decimals: int) -> list[float | int | None]:
    """Numbers as they are shown; None where not known."""
    found: NDArray[np.float64] = np.array(values, dtype=np.float64)
    known = np.isfinite(found).tolist()
    if not decimals:
        return [round(value) if is_known else None for value, is_known in zip(values, known, strict=True)]
    return [
        float(f"{value:.{decimals}f}") + 0.0 if is_known else None
        for value, is_known in zip(values, known, strict=True)
    ]
