"""Models compared over several trials: mean and standard deviation of their errors."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import AnalysisError, ElbowscrewError, UsageError, shown
from elbowscrew.model import ComparedModels, ComparedOverTrials, Comparison, TrialsComparison
from elbowscrew.motion.interpolation.comparison import compare
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.reading.registry import read_recording
from elbowscrew.settings import Settings

_MODEL: Final = ("data", "method", "blend", "law", "knots", "keyframes_per_phase")
_VALUES: Final = ("rms_displacement", "max_displacement", "rms_angle_error", "max_angle_error", "ns_per_frame")
_ANGLE: Final = _VALUES.index("rms_angle_error")


def compare_trials(
    paths: Iterable[str | os.PathLike[str]] | str | os.PathLike[str],
    settings: Settings | None = None,
    plan: ComparisonPlan | None = None,
    *,
    report: Callable[[int, int], None] = lambda _done, _total: None,
) -> TrialsComparison:
    """Compare models over several recordings; see `elbowscrew.compare_trials`.

    Raises
    ------
    AnalysisError
        If no recording can be compared; it says why of the first.
    """
    wanted = settings or Settings()
    found: list[Comparison] = []
    failures: list[tuple[str, ElbowscrewError]] = []
    given = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
    strange = next((one for one in given if not isinstance(one, str | os.PathLike)), None)
    if strange is not None:
        msg = f"compare_trials: paths: expected the paths of recordings, found {shown(strange)}"
        raise UsageError(msg)
    for number, path in enumerate(given, start=1):
        try:
            recording = read_recording(path, markers=wanted.markers, **wanted.statements)
            found.append(compare(recording, wanted, plan))
        except ElbowscrewError as error:
            failures.append((str(path), error))
        report(number, len(given))
    if not found:
        why = f"; the first, {Path(failures[0][0]).name}: {failures[0][1]}" if failures else ": there is none"
        msg = f"none of the {len(failures)} recordings can be compared{why}"
        raise AnalysisError(msg)
    return TrialsComparison(
        settings=wanted,
        models=_over_trials([one.models for one in found]),
        trials=tuple(found),
        failures=tuple(failures),
    )


def _over_trials(tables: list[ComparedModels]) -> ComparedOverTrials:
    gathered: dict[tuple[Any, ...], list[list[float]]] = {}
    for table in tables:
        data = np.array(["lowpass" if name.startswith("lowpass") else name for name in table.data.tolist()])
        keys = zip(data.tolist(), *(getattr(table, name).tolist() for name in _MODEL[1:]), strict=True)
        values = zip(*(getattr(table, name).tolist() for name in _VALUES), strict=True)
        for key, value in zip(keys, values, strict=True):
            if np.isfinite(value[_ANGLE]):
                gathered.setdefault(key, []).append(list(value))
    # Of orientations alone there is no displacement; where some trials have one, the angle is what all have.
    located = all(np.isfinite(table.rms_displacement).any() for table in tables)
    error = 0 if located else _ANGLE
    models = sorted(gathered, key=lambda key: (float(np.mean([value[error] for value in gathered[key]])), key))
    columns: dict[str, NDArray[Any]] = {name: np.array([model[k] for model in models]) for k, name in enumerate(_MODEL)}
    for k, name in enumerate(_VALUES):
        series = [np.array([value[k] for value in gathered[model]]) for model in models]
        columns[f"{name}_mean"] = np.array([values.mean() for values in series])
        columns[f"{name}_sd"] = np.array([values.std(ddof=1) if values.size > 1 else np.nan for values in series])
    return ComparedOverTrials(
        rank=np.arange(1, len(models) + 1),
        trials=np.array([len(gathered[model]) for model in models], dtype=np.int64),
        **columns,
    )
