"""The figure of several trials: of all of them, of conditions, or of subjects."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from elbowscrew.choices import AngleUnit, OverlayBy
from elbowscrew.errors import SettingError
from elbowscrew.group.curves import LEAST_FOR_BAND, GroupCurve
from elbowscrew.report.captions import overlay_caption
from elbowscrew.report.figure_files import files_of
from elbowscrew.report.study import trials_of
from elbowscrew.report.study_curves import curves_of
from elbowscrew.report.study_groups import groups_of
from elbowscrew.view.figure_names import OVERLAY, caption_file
from elbowscrew.view.trial_view import TrialView

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from elbowscrew.plots.overlay import MeanCurve


class Drawn(NamedTuple):
    """Files by name, and the results that are not in them."""

    files: dict[str, bytes]
    left_out: tuple[Path, ...]


class OverlayOfTrials:
    """The curves of trials, each kept from a view that need not be."""

    def __init__(self) -> None:
        self._curves: list[MeanCurve] = []
        self._left_out: list[Path] = []
        self._units: set[AngleUnit] = set()

    def add(self, result: Path, trial: TrialView) -> None:
        """Keep the curve of a trial, read with the table of its cycles."""
        from elbowscrew.plots.overlay import mean_curve

        curve = mean_curve(trial)
        if curve is None:
            self._left_out.append(result)
        else:
            self._curves.append(curve)
            self._units.add(trial.settings.angle_unit)

    def drawn(self, formats: Sequence[str], width_mm: float, font: str | None) -> Drawn:
        """Draw all trials and their mean.

        Raises
        ------
        SettingError
            If fewer than two trials have a cycle.
        """
        from elbowscrew.plots.overlay import LEAST_TRIALS, overlay_figure

        _check_count(len(self._curves), LEAST_TRIALS, len(self._curves) + len(self._left_out))
        unit = _common(self._units)
        drawing = partial(overlay_figure, self._curves, width_mm=width_mm, unit=unit)
        caption = overlay_caption(len(self._curves), sum(curve.cycles for curve in self._curves), unit)
        return _drawn(drawing, caption, self._left_out, formats, font)


def overlay_of_groups(
    results: Sequence[Path], by: OverlayBy, formats: Sequence[str], width_mm: float, font: str | None
) -> Drawn:
    """Draw the means of the conditions, or the subjects of each.

    Parameters
    ----------
    results : sequence of Path
    by : {"condition", "subject"}
    formats : sequence of str
    width_mm : float
    font : str, optional

    Raises
    ------
    ResultError
        If a result cannot be read.
    SettingError
        If nothing tells the conditions or subjects, there are several joints, or too many conditions for one panel.
    """
    from elbowscrew.plots.overlay import LEAST_TRIALS, MOST_GROUPS, conditions_figure, subjects_figure

    study = trials_of(results)
    told = [trial for trial in study.trials if trial.factors[by]]
    if not told:
        msg = f"--by {by}: no summary.csv above the results has a {by}; the manifest's column {by!r} puts it there"
        raise SettingError(msg)
    joints = sorted({trial.joint for trial in told})
    if len(joints) > 1:
        msg = f"--by {by}: the results are of several joints ({', '.join(joints)}); give those of one"
        raise SettingError(msg)
    groups, _ = groups_of(study, told)
    found = curves_of(told, groups)
    used = {trial.folder for trial in told} - set(found.left_out)
    _check_count(len(used), LEAST_TRIALS, len(results))
    if by == "condition" and len(found.of_groups) > MOST_GROUPS:
        msg = f"--by condition: expected {MOST_GROUPS} conditions at most in one panel, found {len(found.of_groups)}"
        raise SettingError(msg)
    unit = _common({trial.units[0] for trial in told})
    figure = conditions_figure if by == "condition" else subjects_figure
    drawing = partial(figure, found.of_groups, width_mm=width_mm, unit=unit)
    caption = groups_caption(by, found.of_groups, unit, named=found.by_subject)
    left_out = [result for result in results if str(result) not in used]
    return _drawn(drawing, caption, left_out, formats, font)


def groups_caption(by: OverlayBy, curves: Mapping[str, GroupCurve], unit: AngleUnit, *, named: bool) -> str:
    """Describe the figure of the conditions' means, or of the subjects of each condition.

    Parameters
    ----------
    by : {"condition", "subject"}
    curves : mapping of str to GroupCurve
        By condition.
    unit : {"deg", "rad"}
    named : bool
        Whether the subjects are known.
    """
    of = "subjects" if named else "trials"
    counts = "; ".join(
        f"{name}: {len(curve.subjects)} {of}" + (f", {curve.trials} trials" if named else "")
        for name, curve in curves.items()
    )
    shown = {
        "condition": f"Mean angle θ ({unit}) of each condition",
        "subject": f"Angle θ ({unit}) of each subject (thin grey) and their mean (black), by condition",
    }[by]
    steps = "trials to subjects, subjects to the mean" if named else "trials to the mean, as no subject is named"
    text = (
        f"{shown}, over the time of the movement, each cycle from 0 to 100 % of its own time; cycles are averaged to "
        f"trials, {steps} ({counts})."
    )
    if any(curve.low is not None for curve in curves.values()):
        text += (
            " Bands: 95 % interval of the mean at each percent, not of the whole curve at once, by a studentized "
            "bootstrap over the subjects."
        )
    bare = [name for name, curve in curves.items() if curve.low is None]
    if bare:
        why = f"fewer than {LEAST_FOR_BAND} subjects" if named else "trials of one subject are not independent"
        text += f" No band of {', '.join(bare)}: {why}" + (f"; thin lines are {of}." if by == "condition" else ".")
    return f"{text}\n"


def _check_count(count: int, least: int, of: int) -> None:
    if count < least:
        msg = (
            f"--figures overlay: expected at least {least} results with a movement out and back "
            f"(repetitions.csv), found {count} of {of}; give more results, or leave overlay out"
        )
        raise SettingError(msg)


def _common(units: set[AngleUnit]) -> AngleUnit:
    return next(iter(units)) if len(units) == 1 else "deg"


def _drawn(
    drawing: Callable[[], Figure], caption: str, left_out: Sequence[Path], formats: Sequence[str], font: str | None
) -> Drawn:
    files = files_of({OVERLAY: drawing}, formats, font) | {caption_file(OVERLAY): caption.encode("utf-8", "replace")}
    return Drawn(files, tuple(left_out))
