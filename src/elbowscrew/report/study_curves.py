"""Charts of a study's mean curves: of each condition with its band, and of each subject."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from markupsafe import Markup

from elbowscrew.group.curves import LEAST_FOR_BAND, PERCENT, GroupCurve, group_curve
from elbowscrew.report.charts import Chart, range_of
from elbowscrew.report.study import StudyTrial
from elbowscrew.report.study_groups import Group, subjects_or_trials

_LOOKS: Final = 6
_NAMED: Final = 5
_MOST_LINES: Final = 30
_MIDDLE: Final = (10.0, 90.0)
_SIZE: Final = (640.0, 300.0)


class Curves(NamedTuple):
    """Mean curves of all groups, by their names; whether by subjects; and the trials that are in none."""

    of_groups: dict[str, GroupCurve]
    by_subject: bool
    left_out: list[str]


class CurveChart(NamedTuple):
    """A chart, and what is said below it."""

    title: str
    chart: Markup
    text: str


def curves_of(trials: Sequence[StudyTrial], groups: Sequence[Group]) -> Curves:
    """Average the curves of each group: over its subjects, or over its trials where no subject is known at all."""
    whole = [[trials[k] for k in group.rows if trials[k].curve is not None] for group in groups]
    _, named = subjects_or_trials([trial for members in whole for trial in members])
    found: dict[str, GroupCurve] = {}
    used: set[str] = set()
    for group, members in zip(groups, whole, strict=True):
        of, of_subjects = subjects_or_trials(members)
        if of and of_subjects == named:
            curves = {name: [one.curve for one in several if one.curve is not None] for name, several in of.items()}
            found[group.name] = group_curve(curves, independent=named)
            used |= {one.folder for several in of.values() for one in several}
    return Curves(found, named, [trial.folder for trial in trials if trial.folder not in used])


def curve_charts(found: Curves, groups: Sequence[Group]) -> list[CurveChart]:
    """Draw the means of the conditions of each joint together, and the subjects of each condition."""
    joints: dict[str, dict[str, GroupCurve]] = {}
    for group in groups:
        if group.name in found.of_groups:
            joints.setdefault(group.joint, {})[group.name] = found.of_groups[group.name]
    charts = []
    for k, (joint, curves) in enumerate(joints.items()):
        words = f", {joint}" if len(joints) > 1 else ""
        if 1 < len(curves) <= _LOOKS:
            charts.append(_together(f"means{k}", f"Mean of each group{words}", curves, found.by_subject))
        charts += [
            _alone(f"subjects{k}-{place}", name, curve, found.by_subject, curves)
            for place, (name, curve) in enumerate(curves.items())
        ]
    return charts


def left_out_text(left_out: Sequence[str]) -> str:
    """Say which trials are in no mean curve; empty if none."""
    if not left_out:
        return ""
    names = ", ".join(left_out[:_NAMED]) + (", …" if len(left_out) > _NAMED else "")
    return (
        f"In no mean curve, for want of a subject or of a cycle that is complete and known throughout: {len(left_out)} "
        f"trial{'s' if len(left_out) > 1 else ''} ({names})."
    )


def difference_chart(name: str, words: str, curve: GroupCurve) -> CurveChart:
    """Draw the mean of the subjects' differences of two conditions, with its band, and each subject's."""
    title = f"Difference: {words}"
    chart = _chart(name, title, {words: curve}, "Difference of the angle", "Difference of θ (deg)")
    chart.segment((0.0, 100.0), (0.0, 0.0), "level")
    told = _mean_of(chart, curve, "subject", "mean difference")
    count = len(curve.subjects)
    few = "; too few subjects for a band" if curve.low is None else ""
    text = f"Mean of {count} subject{'s' if count > 1 else ''} with both, {curve.trials} trials{few}{told}"
    return CurveChart(title, chart.svg(), text)


def _together(name: str, title: str, curves: Mapping[str, GroupCurve], by_subject: bool) -> CurveChart:
    chart = _chart(name, title, curves)
    for k, (group, curve) in enumerate(curves.items()):
        if curve.low is not None and curve.high is not None:
            chart.band(PERCENT, np.degrees(curve.low), np.degrees(curve.high), f"band-group{k}", f"{group}: 95 %")
    for k, (group, curve) in enumerate(curves.items()):
        if curve.low is None and len(curve.subjects) <= _MOST_LINES:
            label = f"{group}: {'subjects' if by_subject else 'trials'}"
            for who, one in zip(curve.subjects, curve.of_subjects, strict=True):
                chart.line(PERCENT, np.degrees(one), f"thin group{k}", label, name=f"{group}: {who}")
        chart.line(PERCENT, np.degrees(curve.mean), f"mean group{k}", group)
    return CurveChart(title, chart.svg(), " ".join(_told(group, curve, by_subject) for group, curve in curves.items()))


def _alone(name: str, group: str, curve: GroupCurve, by_subject: bool, curves: Mapping[str, GroupCurve]) -> CurveChart:
    one = "subject" if by_subject else "trial"
    many = len(curve.subjects) > _MOST_LINES
    title = f"{'Spread of the ' + one + 's' if many else 'Each ' + one}: {group}"
    chart = _chart(name, title, curves)
    told = _mean_of(chart, curve, one, "mean")
    return CurveChart(title, chart.svg(), _told(group, curve, by_subject).removesuffix(".") + told)


def _mean_of(chart: Chart, curve: GroupCurve, one: str, mean: str) -> str:
    """Draw a mean over what it is of, and say so where that is too much for lines."""
    told = "."
    if len(curve.subjects) > _MOST_LINES:
        low, high = np.percentile(np.degrees(curve.of_subjects), _MIDDLE, axis=0)
        chart.band(PERCENT, low, high, "band-middle", f"10th to 90th percentile of the {one}s")
        told = "; light: at each percent, between the 10th and the 90th percentile of these."
    if curve.low is not None and curve.high is not None:
        chart.band(PERCENT, np.degrees(curve.low), np.degrees(curve.high), "band-spread", f"{mean}, 95 %")
    if len(curve.subjects) <= _MOST_LINES:
        for who, line in zip(curve.subjects, curve.of_subjects, strict=True):
            chart.line(PERCENT, np.degrees(line), "thin", f"{one}s", name=who)
    chart.line(PERCENT, np.degrees(curve.mean), "mean", mean)
    return told


def _chart(
    name: str, title: str, curves: Mapping[str, GroupCurve], what: str = "Angle", label: str = "θ (deg)"
) -> Chart:
    """Begin a chart whose scale holds all curves of a joint, so that charts can be compared."""
    ends = [
        np.degrees(part)
        for curve in curves.values()
        for part in (curve.of_subjects.ravel(), curve.low, curve.high)
        if part is not None
    ]
    ends += [np.zeros(1)] if what != "Angle" else []
    return Chart(
        name,
        title,
        f"{what} over the time of the cycle, from 0 to 100 %.",
        x_range=(0.0, 100.0),
        y_range=range_of(*ends),
        x_label="Time of the cycle (%)",
        y_label=label,
        size=_SIZE,
    )


def _told(group: str, curve: GroupCurve, by_subject: bool) -> str:
    count = len(curve.subjects)
    if not by_subject:
        return f"{group}: mean of {count} trial{'s' if count > 1 else ''}."
    told = f"{group}: mean of {count} subject{'s' if count > 1 else ''}, {curve.trials} trials"
    return f"{told}; too few subjects for a band." if count < LEAST_FOR_BAND else f"{told}."
