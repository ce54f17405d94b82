"""One trial as a worker does it: whatever goes wrong comes back as a value, and as one line."""

from __future__ import annotations

import dataclasses
import errno
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from studies import write_trials

from elbowscrew import Settings
from elbowscrew.errors import OutputError
from elbowscrew.study import study, task
from elbowscrew.study.task import TrialTask, analyze_trial, versions_here
from elbowscrew.study.trials import find_trials


@pytest.fixture
def one(tmp_path: Path) -> TrialTask:
    (path,) = write_trials(tmp_path / "in", 1)
    (tmp_path / "out").mkdir()
    return TrialTask(
        path=path,
        label="trial0.csv",
        folder=tmp_path / "out" / "trial0",
        settings=Settings(figure_format=("none",)),
        landmarks=None,
        versions=versions_here(),
    )


def raising(error: BaseException) -> Any:
    def fail(*_arguments: object, **_options: object) -> None:
        raise error

    return fail


def test_a_good_trial_comes_back_as_none(one: TrialTask) -> None:
    assert analyze_trial(one) is None
    assert (one.folder / "summary.json").exists()


@pytest.mark.parametrize(
    ("error", "kind", "code", "says"),
    [
        (ZeroDivisionError("by\nzero"), "Defect", 1, "a defect of the program: ZeroDivisionError: by zero"),
        (MemoryError(), "MemoryError", 6, "not enough memory"),
    ],
)
def test_a_defect_is_one_trials_failure(
    one: TrialTask, monkeypatch: pytest.MonkeyPatch, error: Exception, kind: str, code: int, says: str
) -> None:
    monkeypatch.setattr(task, "analyze_file", raising(error))
    failure = analyze_trial(one)
    assert failure is not None
    assert (failure.error_class, failure.exit_code, failure.stops_all) == (kind, code, False)
    assert failure.message.startswith("trial0.csv: ")
    assert says in failure.message
    assert not one.folder.exists()


def test_a_full_disk_stops_all(one: TrialTask, monkeypatch: pytest.MonkeyPatch) -> None:
    full = OSError(errno.ENOSPC, "No space left on device")
    monkeypatch.setattr("elbowscrew.saving.write_tables", raising(full))
    failure = analyze_trial(one)
    assert failure is not None
    assert (failure.error_class, failure.exit_code, failure.stops_all) == ("OutputError", 6, True)
    assert "No space left on device" in failure.message
    assert not [path for path in one.folder.parent.iterdir() if path.suffix != ".lock"]


def test_an_output_folder_that_a_worker_does_not_see_stops_all(one: TrialTask) -> None:
    failure = analyze_trial(dataclasses.replace(one, folder=one.folder.parent / "elsewhere" / "trial0"))
    assert failure is not None
    assert failure.stops_all
    assert "cannot be written by the worker" in failure.message


def test_a_worker_with_other_versions_stops_all(one: TrialTask) -> None:
    failure = analyze_trial(dataclasses.replace(one, versions={**one.versions, "numpy": "0.1"}))
    assert failure is not None
    assert (failure.exit_code, failure.stops_all) == (2, True)
    assert f"the worker has numpy {one.versions['numpy']}" in failure.message
    assert not one.folder.exists()


def test_any_executor_will_do(one: TrialTask, tmp_path: Path) -> None:
    trials = find_trials([str(one.path.parent)]).trials
    options = {"figure_format": ["none"]}
    result = study.run_study(trials, tmp_path / "threads", ThreadPoolExecutor, 4, options=options)
    assert (result.names, result.failed) == (("trial0",), ())


def test_results_that_are_not_on_this_machine_are_no_success(
    one: TrialTask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "analyze_trial", lambda _task: None)
    trials = find_trials([str(one.path.parent)]).trials
    with pytest.raises(OutputError, match="the workers must share this folder"):
        study.run_study(trials, tmp_path / "threads", ThreadPoolExecutor, 1)
    assert not (tmp_path / "threads" / "summary.csv").exists()
