"""The summary of a comparison: what stands in ``compare.json`` and on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from elbowscrew import tables
from elbowscrew._version import __version__
from elbowscrew.model import Comparison, TrialsComparison
from elbowscrew.results.statistics import known
from elbowscrew.results.summary import (
    recording_summary,
    selection_summary,
    settings_summary,
    source_summary,
    warnings_summary,
)

_BEST_TOLD: Final = 20
_BEST_OF_EACH_TOLD: Final = 4


def comparison_summary(comparison: Comparison) -> dict[str, Any]:
    """Say phases, laws, the best models and the selections of one recording; degrees and millimeters."""
    frame, phases = comparison.frame, comparison.phases
    return {
        "elbowscrew": __version__,
        "source": source_summary(comparison.recording),
        "settings": settings_summary(comparison.settings),
        "trial": recording_summary(comparison.recording),
        "phases": [
            {"start_frame": int(frame[first]), "end_frame": int(frame[last])} for first, last in phases.law_rows
        ],
        "laws": {
            name: [{"law": law.name, "peak": law.peak, "rms_displacement_mm": known(1000.0 * law.rms)} for law in laws]
            for name, laws in comparison.laws.items()
        },
        "models": int(comparison.models.rank.size),
        "refused": int((comparison.models.note != "").sum()),
        **_best(tables.columns(comparison.models, tables.COMPARISON_COLUMNS, "deg", "mm")),
        "selections": {
            method: selection_summary(selection, frame) for method, selection in comparison.selections.items()
        },
        "warnings": warnings_summary(comparison.warnings),
    }


def trials_summary(found: TrialsComparison) -> dict[str, Any]:
    """Say the best models over several recordings, and what each recording's selection needs."""
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
        **_best(tables.columns(found.models, tables.TRIALS_COMPARISON_COLUMNS, "deg", "mm")),
    }


def _best(columns: Mapping[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """The best models of all, and those of each number of keyframes."""
    made = [k for k in range(len(columns["rank"])) if "note" not in columns or not columns["note"][k]]
    counts = columns["keyframes_per_phase"]
    of_each = [
        k for count in np.unique(counts[made]) for k in [k for k in made if counts[k] == count][:_BEST_OF_EACH_TOLD]
    ]
    return {
        "best": [_model(columns, k) for k in made[:_BEST_TOLD]],
        "best_by_keyframes": [_model(columns, k) for k in of_each],
    }


def _model(columns: Mapping[str, Any], row: int) -> dict[str, Any]:
    return {
        name: _plain(values[row])
        for name, values in columns.items()
        if name != "note" and not np.ma.is_masked(values[row])
    }


def _plain(value: Any) -> Any:
    if isinstance(value, str):
        return str(value)
    return int(value) if isinstance(value, int | np.integer) else known(value)
