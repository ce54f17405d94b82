"""What each condition of a study has over another: differences within subjects, in numbers and in curves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Final, NamedTuple

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.curves import LEAST_FOR_BAND
from elbowscrew.group.differences import PairedDifference, difference_curve, paired_difference
from elbowscrew.report.measures import MEASURES, Measure
from elbowscrew.report.study import StudyTrial
from elbowscrew.report.study_curves import CurveChart, difference_chart
from elbowscrew.report.study_groups import Group, by_subject, values_of

MOST_COMPARED: Final = 4
"""Conditions that are all compared with each other; of more, each is compared with the first."""
_MOST_CHARTS: Final = 6


class DifferenceRow(NamedTuple):
    """How one number differs between two conditions, in words, and each subject's difference where they are few."""

    measure: Measure
    words: str
    found: PairedDifference
    each: list[tuple[str, float]]


class Differences(NamedTuple):
    """Numbers and curves of the pairs of conditions that share a subject.

    `few` tells whether there is a row that names each subject's difference, `compared` whether there are two conditions
    at all, `with_first` whether they are so many that each is compared with the first alone, and `left_out` how many
    charts there would be besides.
    """

    rows: list[DifferenceRow]
    charts: list[CurveChart]
    few: bool
    compared: bool
    with_first: bool
    left_out: int


def differences_of(trials: Sequence[StudyTrial], groups: Sequence[Group]) -> Differences:
    """Compare the conditions of each joint by the subjects that have both; trials without a subject are left out.

    Parameters
    ----------
    trials : sequence of StudyTrial
    groups : sequence of Group
        From `elbowscrew.report.study_groups.groups_of`.
    """
    rows = []
    pairs = [(a, b, _words(a, b)) for a, b in _pairs(groups)]
    of = {group.name: by_subject([trials[k] for k in group.rows]) for group in groups}
    for measure in MEASURES:
        for a, b, words in pairs:
            values = [{who: values_of(one, measure) for who, one in of[group.name].items()} for group in (a, b)]
            found = paired_difference(*values)
            if found.subjects:
                few = len(found.subjects) < LEAST_FOR_BAND
                each = list(zip(found.subjects, found.of_subjects.tolist(), strict=True)) if few else []
                rows.append(DifferenceRow(measure, words, found, each))
    known = {name: {who: curves for who, one in by.items() if (curves := _curves(one))} for name, by in of.items()}
    found_curves = [(words, difference_curve(known[a.name], known[b.name])) for a, b, words in pairs]
    drawn = [(words, curve) for words, curve in found_curves if curve is not None]
    charts = [difference_chart(f"difference{k}", *one) for k, one in enumerate(drawn[:_MOST_CHARTS])]
    with_first = any(len(known) > MOST_COMPARED for known in _known(groups))
    few = any(row.each for row in rows)
    return Differences(rows, charts, few, bool(pairs), with_first, len(drawn) - len(charts))


def _known(groups: Sequence[Group]) -> list[list[Group]]:
    """Conditions of each joint; what is under no condition is none."""
    joints = dict.fromkeys(group.joint for group in groups)
    return [[group for group in groups if group.joint == joint and group.level] for joint in joints]


def _pairs(groups: Sequence[Group]) -> Iterator[tuple[Group, Group]]:
    """Pairs of conditions of the same joint."""
    for known in _known(groups):
        if len(known) <= MOST_COMPARED:
            yield from combinations(known, 2)
        else:
            yield from ((known[0], other) for other in known[1:])


def _words(first: Group, second: Group) -> str:
    joint = f"{first.joint}, " if first.name != first.level else ""
    return f"{joint}{second.level} − {first.level}"


def _curves(trials: Sequence[StudyTrial]) -> list[Float]:
    return [one.curve for one in trials if one.curve is not None]
