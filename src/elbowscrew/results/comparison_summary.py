"""The summary of a comparison: what stands in ``compare.json`` and on the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from elbowscrew._version import __version__
from elbowscrew.model import Comparison, TrialsComparison
from elbowscrew.model.comparison_summary_types import (
    ComparedModel,
    ComparisonSummary,
    ModelChoice,
    ModelOverTrials,
    TrialsSummary,
)
from elbowscrew.results.recording_summary import recording_summary, source_summary, warnings_summary
from elbowscrew.results.statistics import known
from elbowscrew.results.summary import law_error, selection_summary, settings_summary

_BEST_TOLD: Final = 20
_BEST_OF_EACH_TOLD: Final = 4

Model = TypeVar("Model", bound=ModelChoice)


def comparison_summary(comparison: Comparison) -> ComparisonSummary:
    """Say phases, laws, the best models and the selections of one recording; degrees and millimeters."""
    frame, phases = comparison.frame, comparison.phases
    models = _models(comparison.models.columns(), ComparedModel)
    return {
        "elbowscrew": __version__,
        "source": source_summary(comparison.recording),
        "settings": settings_summary(comparison.settings),
        "trial": recording_summary(comparison.recording),
        "phases": [
            {"start_frame": int(frame[first]), "end_frame": int(frame[last])} for first, last in phases.law_rows
        ],
        "laws": {
            name: [
                {"law": law.name, "peak": law.peak, **law_error(law, as_angle=not comparison.points.located)}
                for law in laws
            ]
            for name, laws in comparison.laws.items()
        },
        "models": int(comparison.models.rank.size),
        "refused": int((comparison.models.note != "").sum()),
        "best": models[:_BEST_TOLD],
        "best_by_keyframes": _best_of_each(models),
        "selections": {
            method: selection_summary(selection, frame) for method, selection in comparison.selections.items()
        },
        "warnings": warnings_summary(comparison.warnings),
    }


def trials_summary(found: TrialsComparison) -> TrialsSummary:
    """Say the best models over several recordings, and what each recording's selection needs."""
    models = _models(found.models.columns(), ModelOverTrials)
    return {
        "elbowscrew": __version__,
        "settings": settings_summary(found.settings),
        "trials": [
            {
                "source": source_summary(one.recording),
                "selections": {
                    method: selection_summary(selection, one.frame) for method, selection in one.selections.items()
                },
            }
            for one in found.trials
        ],
        "failures": [
            {"path": path, "error": type(error).__name__, "message": str(error)} for path, error in found.failures
        ],
        "models": int(found.models.rank.size),
        "best": models[:_BEST_TOLD],
        "best_by_keyframes": _best_of_each(models),
    }


def _models(columns: Mapping[str, NDArray[Any]], _kind: type[Model]) -> list[Model]:
    """Turn the columns of a table of models into rows, the best first; those that were refused are left out."""
    rows = [k for k in range(len(columns["rank"])) if "note" not in columns or not columns["note"][k]]
    return [cast(Model, _model(columns, k)) for k in rows]  # a test holds its keys and the columns together


def _best_of_each(models: Sequence[Model]) -> list[Model]:
    """Take the best models of each number of keyframes."""
    by_count: dict[int, list[Model]] = {}
    for model in models:
        by_count.setdefault(model["keyframes_per_phase"], []).append(model)
    return [model for count in sorted(by_count) for model in by_count[count][:_BEST_OF_EACH_TOLD]]


def _model(columns: Mapping[str, NDArray[Any]], row: int) -> dict[str, str | int | float | None]:
    return {
        name: _plain(values[row])
        for name, values in columns.items()
        if name != "note" and not np.ma.is_masked(values[row])
    }


def _plain(value: Any) -> str | int | float | None:
    if isinstance(value, str):
        return str(value)
    return int(value) if isinstance(value, int | np.integer) else known(value)
