"""The trials of a study in groups that are alike but for their subjects, and what each group has in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple, TypedDict

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.axes import GroupAxis, group_axis
from elbowscrew.group.outliers import Outliers, outliers_of_study
from elbowscrew.group.variance import Variation, variation
from elbowscrew.report.measures import MEASURES, Measure
from elbowscrew.report.study import CONDITION, SUBJECT, Study, StudyTrial
from elbowscrew.report.trial_parts import FIRST_AXIS, JOINT_AXIS

_ALL: Final = "all trials"
_JOINT: Final = "joint"


class Group(NamedTuple):
    """Trials of one joint under one condition, `level`, empty where nothing says it: their rows in the study."""

    name: str
    joint: str
    rows: list[int]
    level: str = ""


class NumberRow(TypedDict):
    """One number in one group: median and quartiles of the trials; how it varies, None where no subject is known."""

    measure: Measure
    group: str
    trials: int
    quartiles: list[float | None]
    found: Variation | None
    note: str


class AxisRow(TypedDict):
    """The mean axis of one group, in degrees and millimeters; tilts from the lateral direction, up and forward."""

    group: str
    kind: str
    subjects: int | None
    trials: int
    direction: list[float]
    tilt_up: float
    tilt_forward: float
    direction_sd: float
    point: list[float]
    point_sd: float


def groups_of(study: Study, trials: Sequence[StudyTrial]) -> tuple[list[Group], str | None]:
    """Group trials by joint and factor, and name what they are grouped by: numbers of two joints have no common mean.

    The factor is the condition, else the manifest's first column that is not the subject.
    """
    named = [name for name in study.factors if name.strip().casefold() == CONDITION]
    others = [name for name in study.factors if name.strip().casefold() != SUBJECT]
    factor = next(iter([*named, *others]), None)
    several = len({trial.joint for trial in trials}) > 1
    found: dict[str, Group] = {}
    for k, trial in enumerate(trials):
        words = [trial.joint] if several else []
        level = "" if factor is None else trial.factors.get(factor, "")
        words += [] if factor is None else [level or "–"]
        name = ", ".join(words) or _ALL
        found.setdefault(name, Group(name, trial.joint, [], level)).rows.append(k)
    grouped_by = " and ".join(name for name in (_JOINT * several, factor) if name) or None
    return [found[name] for name in sorted(found)], grouped_by


def outlying(trials: Sequence[StudyTrial], groups: Sequence[Group]) -> dict[str, Outliers]:
    """Flag trials and subjects in each measure."""
    numbers = {}
    for measure in MEASURES:
        values = values_of(trials, measure)
        positive = bool((values[np.isfinite(values)] > 0.0).all())
        numbers[measure.key] = np.log(values) if measure.skewed and positive else values
    return outliers_of_study(numbers, [group.rows for group in groups], [trial.subject for trial in trials])


def values_of(trials: Sequence[StudyTrial], measure: Measure) -> Float:
    """Give one number of all trials, shape (N,); NaN where not known."""
    return np.array([trial.values[measure.key] for trial in trials], dtype=np.float64)


def number_rows(trials: Sequence[StudyTrial], groups: Sequence[Group]) -> list[NumberRow]:
    """Say of each measure in each group how it spreads, where it is known."""
    rows: list[NumberRow] = []
    for measure in MEASURES:
        for group in groups:
            members = [trials[k] for k in group.rows]
            values = values_of(members, measure)
            known = values[np.isfinite(values)]
            if not known.size:
                continue
            of = by_subject(members)
            found = variation([values_of(one, measure) for one in of.values()]) if of else None
            unnamed = sum(not trial.subject for trial in members)
            note = "" if found is None else found.reason
            if of and unnamed:
                note = "; ".join(filter(None, (note, f"{unnamed} without a subject left out")))
            rows.append(
                {
                    "measure": measure,
                    "group": group.name,
                    "trials": int(known.size),
                    "quartiles": np.percentile(known, [50, 25, 75]).tolist(),
                    "found": found,
                    "note": note,
                }
            )
    return rows


def axis_rows(trials: Sequence[StudyTrial], groups: Sequence[Group]) -> list[AxisRow]:
    """Average the axes of each group, those of each kind by themselves."""
    rows: list[AxisRow] = []
    for group in groups:
        for kind in (JOINT_AXIS, FIRST_AXIS):
            of, named = subjects_or_trials(
                [trials[k] for k in group.rows if (axis := trials[k].axis) is not None and axis.kind == kind]
            )
            if of:
                axes = {name: [one.axis[1:] for one in members if one.axis] for name, members in of.items()}
                rows.append(_axis_row(group.name, kind, group_axis(axes), named))
    return rows


def by_subject(trials: Sequence[StudyTrial]) -> dict[str, list[StudyTrial]]:
    """Put the trials of each subject together; those whose subject is not known are left out."""
    found: dict[str, list[StudyTrial]] = {}
    for trial in trials:
        found.setdefault(trial.subject, []).append(trial)
    return {name: found[name] for name in sorted(found) if name}


def subjects_or_trials(trials: Sequence[StudyTrial]) -> tuple[Mapping[str, Sequence[StudyTrial]], bool]:
    """Put the trials of each subject together, and say whether any is known: else each trial stands for itself."""
    of = by_subject(trials)
    return (of, True) if of else ({one.folder: [one] for one in trials}, False)


def _axis_row(group: str, kind: str, found: GroupAxis, named: bool) -> AxisRow:
    forward, up, lateral = found.direction.tolist()
    return {
        "group": group,
        "kind": kind,
        "subjects": found.subjects if named else None,
        "trials": found.trials,
        "direction": [forward, up, lateral],
        "tilt_up": float(np.degrees(np.arctan2(up, lateral))),
        "tilt_forward": float(np.degrees(np.arctan2(forward, lateral))),
        "direction_sd": float(np.degrees(found.direction_sd)),
        "point": (1000.0 * found.point).tolist(),
        "point_sd": 1000.0 * found.point_sd,
    }
