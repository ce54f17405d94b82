"""A study from Python: the trials' results as a table, one by one, and what failed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from elbowscrew.errors import UsageError
from elbowscrew.interface.analysis import Analysis
from elbowscrew.interface.python_words import in_python
from elbowscrew.settings import Settings
from elbowscrew.study.executors import available_cores, open_executor
from elbowscrew.study.study import SUMMARY_TABLE, Progress, run_study
from elbowscrew.study.trials import find_trials

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class StudyResult:
    """What a batch has made.

    Attributes
    ----------
    folder : Path
    names : tuple of str
        Result folders of the trials that have a result; ``study[name]`` reads one.
    kept : int
        How many of them were there already.
    failures : mapping of str to str
        Why the other trials have none, by their paths.
    skipped : mapping of str to str
        Why files and folders were passed over.
    """

    folder: Path
    names: tuple[str, ...]
    kept: int
    failures: dict[str, str]
    skipped: dict[str, str]

    def __len__(self) -> int:
        return len(self.names)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __getitem__(self, name: str) -> Analysis:
        """Read the result of a trial."""
        if name not in self.names:
            msg = f"{self.folder}: there is no result {name!r}; there are {', '.join(self.names) or 'none'}"
            raise UsageError(msg)
        return Analysis.read(self.folder / name)

    def to_frame(self) -> pd.DataFrame:
        """Return ``summary.csv``, a row a trial, as a pandas data frame."""
        import pandas as pd

        return pd.read_csv(self.folder / SUMMARY_TABLE)

    def __repr__(self) -> str:
        failed = f"; {len(self.failures)} failed" if self.failures else ""
        return f"StudyResult({len(self)} results in {str(self.folder)!r}{failed})"

    def _repr_html_(self) -> str:
        return f"<div>{self.to_frame().to_html(max_rows=20)}</div>"


def run(
    paths: Sequence[str],
    folder: Path,
    settings: Settings,
    *,
    landmarks: Path | None,
    recursive: bool,
    workers: int | None,
    overwrite: bool,
    report: Callable[[int, int], None],
) -> StudyResult:
    """Find the trials and analyze them; see `elbowscrew.batch`."""

    def told(progress: Progress) -> None:
        report(progress.done, progress.total)

    count = workers or available_cores()
    trials = find_trials(paths, recursive=recursive, exclude=folder, any_table=settings.columns is not None)
    found = run_study(
        trials.trials,
        folder,
        open_executor(None, count),
        count,
        options={name: getattr(settings, name) for name in settings.model_fields_set},
        landmarks=landmarks,
        restart=overwrite,
        report=told,
    )
    failed = {one.path: in_python(one.failure.message) for one in found.failed}
    return StudyResult(
        folder=folder,
        names=tuple(name for name, trial in zip(found.names, trials.trials, strict=True) if trial.label not in failed),
        kept=found.kept,
        failures=failed,
        skipped={one.path: one.reason for one in trials.skipped},
    )
