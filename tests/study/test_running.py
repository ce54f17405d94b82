"""Tasks through an executor: who kills a worker has failed, and nobody else."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import pytest
from hazards import Hazard, work
from hazards import __file__ as hazards_file

from elbowscrew.errors import OutputError, UsageError
from elbowscrew.study.executors import open_executor
from elbowscrew.study.outcome import Failure
from elbowscrew.study.running import run_tasks

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")


def hazards(folder: Path, *kinds: str) -> list[Hazard]:
    return [Hazard(f"t{k}", kind, str(folder)) for k, kind in enumerate(kinds)]


def classes(found: list[Failure | None]) -> list[str]:
    return ["" if failure is None else failure.error_class for failure in found]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_worker_that_dies_is_its_trials_failure_only(tmp_path: Path, workers: int) -> None:
    tasks = hazards(tmp_path, "", "kills", "", "fails", "", "exits", "kills once", "", "", "")
    told: list[int] = []
    found = run_tasks(tasks, work, open_executor(None, workers), workers, lambda index, _: told.append(index))
    assert classes(found) == ["", "WorkerLost", "", "AnalysisError", "", "WorkerLost", "", "", "", ""]
    assert sorted(told) == list(range(10))
    assert found[1] is not None
    assert found[1].message.startswith("t1: the worker died twice on it")
    # Twice alone, and before that perhaps in company.
    assert all(2 <= task.traces <= 3 for task in tasks if task.kind != "" and task.kind != "fails")
    assert all(1 <= task.traces <= 2 for task in tasks if task.kind == "" or task.kind == "fails")


ON_DASK = """
import sys
sys.path.insert(0, sys.argv[2])
from hazards import Hazard, work
from elbowscrew.study.executors import open_executor
from elbowscrew.study.running import run_tasks
if __name__ == "__main__":
    tasks = [Hazard(f"t{k}", kind, sys.argv[1]) for k, kind in enumerate(["", "kills", "", "fails", ""])]
    found = run_tasks(tasks, work, open_executor("local-cluster", 1), 1)
    print([failure and failure.error_class for failure in found])
"""


def test_the_same_holds_for_workers_of_dask(tmp_path: Path) -> None:
    script = tmp_path / "on_dask.py"
    script.write_text(ON_DASK)
    (tmp_path / "traces").mkdir()
    arguments = [script, tmp_path / "traces", Path(hazards_file).parent]
    done = subprocess.run([sys.executable, *map(str, arguments)], capture_output=True, text=True, check=True)
    assert done.stdout == "[None, 'WorkerLost', None, 'AnalysisError', None]\n"


def test_all_tasks_may_kill_their_workers(tmp_path: Path) -> None:
    tasks = hazards(tmp_path, *["kills"] * 3)
    assert classes(run_tasks(tasks, work, open_executor(None, 2), 2)) == ["WorkerLost"] * 3


def test_what_meets_every_trial_stops_all_at_once(tmp_path: Path) -> None:
    tasks = hazards(tmp_path, "", "full", "slow", *[""] * 20)
    with pytest.raises(OutputError, match="the disk is full"):
        run_tasks(tasks, work, open_executor(None, 2), 2)
    assert not (tmp_path / "waited for").exists()
    assert sum(task.traces for task in tasks) < len(tasks)


def test_an_interruption_ends_the_workers(tmp_path: Path) -> None:
    def interrupt(_index: int, _failure: Failure | None) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tasks(hazards(tmp_path, "", "slow", "slow"), work, open_executor(None, 2), 2, interrupt)
    assert not (tmp_path / "waited for").exists()


def test_workers_that_cannot_do_the_work_are_no_failure_of_trials(tmp_path: Path) -> None:
    unpicklable = [threading.Lock()]
    with pytest.raises(UsageError, match="the workers cannot do the work"):
        run_tasks(unpicklable, lambda _: None, open_executor(None, 1), 1)


def test_no_tasks_need_no_workers() -> None:
    assert run_tasks([], work, open_executor(None, 1), 1) == []
