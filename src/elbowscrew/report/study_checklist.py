"""What a paper on a study should state, filled in from its results: design, losses, statistics, and what was alike.

The entries follow what is asked of the reporting of observational studies (STROBE: von Elm and others 2007) and of
basic statistics (SAMPL: Lang and Altman 2015), and the checklist of a trial.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Final, NamedTuple

from elbowscrew.group.curves import LEAST_FOR_BAND, RESAMPLES, SEED
from elbowscrew.group.outliers import FALSE_ALARMS, LEAST
from elbowscrew.report.checklist import Entry
from elbowscrew.report.study import Failure, Study
from elbowscrew.report.study_curves import Curves
from elbowscrew.report.study_differences import Differences
from elbowscrew.report.study_groups import AxisRow, Group, NumberRow, by_subject

_NAMED: Final = 3
_LISTED: Final = 12


class Findings(NamedTuple):
    """A study and what its page shows of it.

    `outliers` is how many trials are flagged, or are of a flagged subject; `tests` by how many tests.
    """

    study: Study
    groups: Sequence[Group]
    grouped_by: str | None
    numbers: Sequence[NumberRow]
    curves: Curves
    differences: Differences
    axes: Sequence[AxisRow]
    outliers: int
    tests: int

    @property
    def failures(self) -> tuple[Failure, ...]:
        """Trials with a result that cannot be read, which stand in no table, and those without one."""
        return *self.study.unread, *self.study.failures


def study_checklist(found: Findings) -> tuple[Entry, ...]:
    """Fill in the checklist of a study.

    Parameters
    ----------
    found : Findings

    Returns
    -------
    tuple of Entry
        The study's own entries, then those of its trials: what is common to all, or how many have what.
    """
    shared: list[Entry] = []
    if found.study.trials:
        titles = found.study.trials[0].reported
        shared = [Entry(title, _alike(trial.reported[title] for trial in found.study.trials)) for title in titles]
        shared.append(Entry("Settings", _settings(found)))
    own = (Entry(title, told(found)) for title, told in _ITEMS.items())
    return *own, *shared


def _unknown(found: Findings) -> None:
    """Nothing in the results tells it."""


def _subjects(found: Findings) -> str | None:
    of = by_subject(found.study.trials)
    if not of:
        return None
    counts = sorted({len(trials) for trials in of.values()})
    span = f"{counts[0]} to {counts[-1]} trials" if len(counts) > 1 else _trials(counts[0])
    unnamed = sum(not trial.subject for trial in found.study.trials)
    without = f"; {_trials(unnamed)} without a subject" if unnamed else ""
    return f"{len(of)}, with {span}{' each' if len(of) > 1 else ''}{without}"


def _analyzed(found: Findings) -> str:
    others = len(found.study.others)
    beside = f"; {others} further in the folder but not in summary.csv are left out" if others else ""
    return f"{len(found.study.trials)} analyzed{beside}"


def _failed(found: Findings) -> str:
    failed = found.failures
    if not failed:
        return "none"
    kinds = _counted(failure.kind or "of unknown kind" for failure in failed)
    return f"{len(failed)} of {len(failed) + len(found.study.trials)} trials failed and are in no number ({kinds})"


def _conditions(found: Findings) -> str | None:
    levels = [group for group in found.groups if group.level]
    if not levels:
        return None
    told = [f"{group.name} ({_trials(len(group.rows))}{_of_subjects(found, group)})" for group in levels[:_LISTED]]
    told += [f"{len(levels) - _LISTED} more"] if len(levels) > _LISTED else []
    without = sum(len(group.rows) for group in found.groups if not group.level)
    return f"{found.grouped_by}: {', '.join(told)}" + (f"; {_trials(without)} under none" if without else "")


def _of_subjects(found: Findings, group: Group) -> str:
    count = len(by_subject([found.study.trials[k] for k in group.rows]))
    return f" of {count} subject{'s' if count > 1 else ''}" if count else ""


def _design(found: Findings) -> str | None:
    under: dict[str, set[str]] = {}
    for group in found.groups:
        for subject in by_subject([found.study.trials[k] for k in group.rows]) if group.level else ():
            under.setdefault(subject, set()).add(group.level)
    levels = set().union(*under.values())
    if len(levels) < 2:
        return None
    several, whole = (sum(len(of) >= least for of in under.values()) for least in (2, len(levels)))
    if not several:
        return "between subjects: none has trials under two conditions"
    told = f"{whole} of {len(under)} subjects have trials under all {len(levels)} conditions"
    if several > whole:
        told += f", {several - whole} under some of them"
    return told + ("" if several == len(under) else f", {len(under) - several} under one alone")


def _curves(found: Findings) -> str:
    if not found.curves.of_groups:
        return "none: no trial has a complete cycle"
    out = len(found.curves.left_out)
    levels = "of cycles, trials and subjects, in this order" if found.curves.by_subject else "of cycles and trials"
    return f"means {levels}, each cycle from 0 to 100 % of its time" + (f"; {_trials(out)} in none" if out else "")


def _bands(found: Findings) -> str:
    curves = found.curves.of_groups.values()
    shown = sum(curve.low is not None for curve in curves)
    if not shown:
        why = f"fewer than {LEAST_FOR_BAND} subjects" if found.curves.by_subject else "no subject is named"
        return f"none: {why if curves else 'no curves'}"
    some = f"; {len(curves) - shown} of fewer than {LEAST_FOR_BAND} subjects without" if shown < len(curves) else ""
    return (
        "95 % for the mean at each percent, not of the whole curve at once, by a studentized bootstrap over the "
        f"subjects ({RESAMPLES} resamples, seed {SEED}){some}"
    )


def _means(found: Findings) -> str:
    if not any(row["found"] is not None for row in found.numbers):
        return "median and quartiles of the trials; no subject is named, so that no mean or interval is given"
    return (
        "mean of the subjects’ means with its 95 % interval by Student’s t over the subjects, and the SD between and "
        "within subjects; median and quartiles of the trials"
    )


def _reliability(found: Findings) -> str:
    icc = [row["found"].icc for row in found.numbers if row["found"] is not None]
    known = sum(map(math.isfinite, icc))
    if not known:
        why = "; ".join(dict.fromkeys(row["note"] for row in found.numbers if row["note"]))
        return f"no ICC: {why or 'no subject is named'}"
    return (
        "ICC(1,1), one-way random effects, absolute agreement, single trial, with its 95 % interval by F "
        f"(Shrout and Fleiss 1979); defined in {known} of {len(icc)} rows of the numbers"
    )


def _compared(found: Findings) -> str:
    rows = found.differences.rows
    if not rows:
        return "none" + (": no subject has trials under two conditions" if found.differences.compared else "")
    counts = [len(row.found.subjects) for row in rows]
    low, high = min(counts), max(counts)
    pairs = f"{low} to {high}" if low < high else f"{low}"
    return (
        f"paired by subject ({pairs} pairs), mean difference with its 95 % interval by Student’s t; no test was done "
        "and no p-value is given"
    )


def _multiple(found: Findings) -> str:
    count = len(found.differences.rows)
    if not count:
        return "no comparisons were made"
    told = f"{count} comparison{'s' if count > 1 else ''} of numbers; no interval was widened for that"
    return told + ("; each condition with the first alone" if found.differences.with_first else "")


def _outliers(found: Findings) -> str:
    rule = (
        "generalized extreme studentized deviate (Grubbs 1950, Rosner 1983), from "
        f"{LEAST} trials or subjects on, at most {100 * FALSE_ALARMS:g} % of clean studies with a false alarm"
    )
    if not found.tests:
        return f"not looked for: too few trials and subjects; rule: {rule}"
    flagged = _trials(found.outliers) if found.outliers else "no trial"
    return f"{flagged} flagged by {found.tests} test{'s' if found.tests > 1 else ''}, none left out; rule: {rule}"


def _mean_axis(found: Findings) -> str:
    if found.axes:
        whose = "subjects" if any(row["subjects"] is not None for row in found.axes) else "trials"
        return f"in the frame of the proximal bone, mean over the {whose} with its spread"
    return "not given: no trial has both landmarks and an axis, and frames of clusters cannot be compared"


def _warned(found: Findings) -> str:
    codes = [code for trial in found.study.trials for code in trial.warnings]
    warned = sum(bool(trial.warnings) for trial in found.study.trials)
    return f"{warned} of {_trials(len(found.study.trials))}: {_counted(codes)}" if warned else "none"


def _settings(found: Findings) -> str:
    every = [json.loads(text) for text in dict.fromkeys(trial.settings for trial in found.study.trials)]
    names = dict.fromkeys(name for settings in every for name in settings)
    differing = [name for name in names if any(one.get(name) != every[0].get(name) for one in every)]
    if not differing:
        return "the same for all trials"
    more = f" and {len(differing) - _LISTED} more" if len(differing) > _LISTED else ""
    return f"differing between trials: {', '.join(differing[:_LISTED])}{more}"


def _alike(texts: Iterable[str | None]) -> str | None:
    """Say what all trials have, or how many have what; None where it is known of none."""
    counts = Counter(texts)
    if len(counts) == 1:
        return next(iter(counts))
    first = counts.most_common(_NAMED)
    told = [f"{'not known' if text is None else text} ({_trials(count)})" for text, count in first]
    if len(counts) > _NAMED:
        told.append(f"{len(counts) - _NAMED} more in {_trials(counts.total() - sum(count for _, count in first))}")
    return f"differs: {'; '.join(told)}"


def _counted(words: Iterable[str]) -> str:
    counts = Counter(words).most_common()
    more = f", {len(counts) - _LISTED} more" if len(counts) > _LISTED else ""
    return ", ".join(f"{word} {count}" for word, count in counts[:_LISTED]) + more


def _trials(count: int) -> str:
    return f"{count} trial{'s' if count != 1 else ''}"


_ITEMS: Final[dict[str, Callable[[Findings], str | None]]] = {
    "Participants (age, sex, health) and ethics approval": _unknown,
    "Subjects": _subjects,
    "How the number of subjects was chosen": _unknown,
    "Criteria of inclusion and exclusion": _unknown,
    "Trials": _analyzed,
    "Failures": _failed,
    "Trials left out, and why": _unknown,
    "Conditions": _conditions,
    "Design": _design,
    "Order of the conditions, randomization and blinding": _unknown,
    "Task, instructions, load and speed": _unknown,
    "Means and intervals": _means,
    "Mean curves": _curves,
    "Bands of the curves": _bands,
    "Comparison of conditions": _compared,
    "Multiple comparisons": _multiple,
    "Reliability": _reliability,
    "Outliers": _outliers,
    "Mean axis": _mean_axis,
    "Warnings": _warned,
    "Measuring system, its calibration and accuracy": _unknown,
    "Where recordings and results can be had": _unknown,
}
"""The study's own entries; a new one is one line here and the function that fills it in."""
