"""A whole study: every trial that is not done yet analyzed, and the tables of all of them written."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from elbowscrew.configuring import settings_from
from elbowscrew.disk.folders import straight
from elbowscrew.errors import OutputError, ResultError, UsageError
from elbowscrew.model import Landmarks
from elbowscrew.model.summary_types import Summary
from elbowscrew.reading.landmarks import read_landmarks
from elbowscrew.report.study_page import not_shown, write_study_page
from elbowscrew.report.study_tables import STUDY_TABLES
from elbowscrew.results.proof import proof_of
from elbowscrew.results.result_files import is_summary
from elbowscrew.results.staging import replace_file
from elbowscrew.results.summary_reading import SUMMARY, read_summary
from elbowscrew.saving import check_output
from elbowscrew.study.executors import OpenExecutor
from elbowscrew.study.folder import batch_folder
from elbowscrew.study.naming import result_names
from elbowscrew.study.outcome import FailedTrial, Failure, StudyRow, failures_table, summary_table
from elbowscrew.study.resume import standing_of
from elbowscrew.study.running import run_tasks
from elbowscrew.study.task import TrialTask, analyze_trial, versions_here
from elbowscrew.study.trial import Trial

SUMMARY_TABLE, FAILURES_TABLE = "summary.csv", "failures.csv"


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far a batch has come.

    Attributes
    ----------
    total, done, failed, kept : int
        Trials in all; those finished, of which some failed, and some were there already.
    latest : FailedTrial or None
        The trial that has just failed, if it did.
    """

    total: int
    done: int
    failed: int
    kept: int
    latest: FailedTrial | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyResult:
    """What a batch has done.

    Attributes
    ----------
    folder : Path
    names : tuple of str
        Result folders of all trials, failed ones included, in the order of the tables.
    kept : int
        Trials whose results were there already.
    warned : int
        Trials with a result that has warnings.
    failed : tuple of FailedTrial
    changed : tuple of str
        Files of earlier results that were not as they had been written, and have been made again.
    others : tuple of str
        Results in the folder that the tables do not tell of: of earlier trials, or of trials that fail now.
    unread : tuple of str
        Why the page shows trials as failed that have a row in ``summary.csv``: their tables could not be read.
    """

    folder: Path
    names: tuple[str, ...]
    kept: int
    warned: int
    failed: tuple[FailedTrial, ...]
    changed: tuple[str, ...]
    others: tuple[str, ...]
    unread: tuple[str, ...]


def run_study(
    trials: Sequence[Trial],
    folder: Path,
    open_executor: OpenExecutor,
    workers: int,
    *,
    config: Path | None = None,
    options: Mapping[str, Any] | None = None,
    landmarks: Path | None = None,
    restart: bool = False,
    report: Callable[[Progress], None] = lambda _progress: None,
) -> StudyResult:
    """Analyze all trials of a study into one folder.

    A trial whose result is there, whole, and made from the same recording with the same settings by the same program is
    not analyzed again. The tables are made from the results on disk, so that they do not depend on who made them when.

    Parameters
    ----------
    trials : sequence of Trial
        From `elbowscrew.study.trials.find_trials`.
    folder : Path
        Output folder: new, empty, or of an earlier batch.
    open_executor : callable
        From `elbowscrew.study.executors.open_executor`.
    workers : int
        Trials analyzed at a time.
    config : Path, optional
        A file of settings for all trials.
    options : mapping, optional
        Settings for all trials, stronger than the file; what a manifest sets for a trial is stronger still.
    landmarks : Path, optional
        Landmarks of trials for which the manifest names none.
    restart : bool
        Analyze all trials again.
    report : callable
        Told how far the batch has come.

    Returns
    -------
    StudyResult

    Raises
    ------
    UsageError
        If settings or landmarks are not possible ones.
    OutputError
        If the output folder is held by another batch, or the disk does not take the results.
    """
    folder = straight(folder)
    common = settings_from(config, options)
    check_output(common)
    tasks = _tasks(trials, folder, config, dict(options or {}), landmarks)
    with batch_folder(folder):
        standings = [standing_of(task) for task in tasks]
        pending = [k for k, standing in enumerate(standings) if restart or not standing.current]

        @contextmanager
        def opened() -> Iterator[Executor]:
            with open_executor() as executor:
                _remove_tables(folder)  # what stands there is of a batch that is finished; this one is not
                yield executor

        failed = _analyze(tasks, pending, opened, workers, report)
        failures = tuple(FailedTrial(path=tasks[k].label, failure=failed[k]) for k in sorted(failed))
        told: dict[str, bool] = {}

        def rows() -> Iterator[StudyRow]:
            """Yield the trials with results, one at a time in memory, and note which of them are warned of."""
            for k, (task, trial) in enumerate(zip(tasks, trials, strict=True)):
                if k not in failed:
                    summary = _summary_of(task)
                    told[task.folder.name] = any(one["severity"] == "warning" for one in summary["warnings"])
                    yield StudyRow(trial=task.folder.name, path=task.label, columns=trial.columns, summary=summary)

        carried = list(dict.fromkeys(name for trial in trials for name in trial.columns))
        replace_file(folder / FAILURES_TABLE, failures_table(failures))
        replace_file(folder / SUMMARY_TABLE, summary_table(rows(), carried, common.angle_unit, common.length_unit))
        page, _, unread = write_study_page(folder, carried)
        return StudyResult(
            folder=folder,
            names=tuple(task.folder.name for task in tasks),
            kept=len(tasks) - len(pending),
            warned=sum(told.values()),
            failed=failures,
            changed=tuple(
                f"{task.folder.name}/{name}"
                for task, standing in zip(tasks, standings, strict=True)
                for name in standing.changed
            ),
            others=_others(folder, told),
            unread=tuple(not_shown(page, one) for one in unread if one.path in told),
        )


def _analyze(
    tasks: Sequence[TrialTask],
    pending: Sequence[int],
    open_executor: OpenExecutor,
    workers: int,
    report: Callable[[Progress], None],
) -> dict[int, Failure]:
    """Analyze the trials that are left, tell of each, and give the failures."""
    failed: dict[int, Failure] = {}
    done = kept = len(tasks) - len(pending)

    def tell(latest: FailedTrial | None = None) -> None:
        report(Progress(total=len(tasks), done=done, failed=len(failed), kept=kept, latest=latest))

    def settled(index: int, failure: Failure | None) -> None:
        nonlocal done
        done += 1
        if failure is None:
            tell()
        else:
            failed[pending[index]] = failure
            tell(FailedTrial(path=tasks[pending[index]].label, failure=failure))

    tell()
    run_tasks([tasks[k] for k in pending], analyze_trial, open_executor, workers, settled)
    return failed


def _others(folder: Path, told: Collection[str]) -> tuple[str, ...]:
    results = (path.parent.name for path in folder.glob(f"*/{SUMMARY}") if is_summary(path))
    return tuple(sorted(name for name in results if name not in told))


def _tasks(
    trials: Sequence[Trial], folder: Path, config: Path | None, options: dict[str, Any], landmarks: Path | None
) -> list[TrialTask]:
    """Give each trial its folder, settings and landmarks; all that does not fit is told before anything is done."""
    out = Path(os.path.abspath(folder))  # noqa: PTH100 - workers may stand elsewhere; links are kept
    read: dict[Path, Landmarks] = {}
    tasks = []
    versions = versions_here()
    for trial, name in zip(trials, _names(trials), strict=True):
        chosen = trial.landmarks or landmarks
        try:
            settings = settings_from(config, {**options, **trial.settings})
            check_output(settings)
            if chosen is not None and chosen not in read:
                read[chosen] = read_landmarks(chosen)
        except UsageError as error:
            if not trial.location:
                raise
            msg = f"{trial.location}: {error}"
            raise UsageError(msg) from error
        tasks.append(
            TrialTask(
                path=trial.path,
                distal_path=trial.distal_path,
                label=trial.label,
                folder=out / name,
                settings=settings,
                landmarks=None if chosen is None else read[chosen],
                versions=versions,
            )
        )
    return tasks


def _names(trials: Sequence[Trial]) -> list[str]:
    called = [trial.name.replace("/", "_") or trial.label for trial in trials]  # a name of a manifest is no path
    seen: dict[str, Trial] = {}
    for name, trial in zip(called, trials, strict=True):
        other = seen.setdefault(name, trial)
        if other is not trial:
            msg = (
                f"{trial.location or trial.path}: two trials are called {name!r}, here and at "
                f"{other.location or other.path}; give them different names in the manifest's column 'name'"
            )
            raise UsageError(msg)
    return result_names(called, [trial.by_file and not trial.name for trial in trials])


def _remove_tables(folder: Path) -> None:
    for name in (SUMMARY_TABLE, FAILURES_TABLE, *STUDY_TABLES):
        try:
            (folder / name).unlink(missing_ok=True)
        except OSError as error:
            msg = f"{folder / name}: cannot be replaced: {error.strerror or error}"
            raise OutputError(msg) from error


def _summary_of(task: TrialTask) -> Summary:
    try:
        return read_summary(proof_of(task.folder))
    except ResultError as error:
        msg = f"{task.folder}: the result is not there; the workers must share this folder, and nobody else write to it"
        raise OutputError(msg) from error
