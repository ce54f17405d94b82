"""Tasks through an executor, whichever: one code path, and a worker that dies takes no other trial with it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from contextlib import ExitStack
from pathlib import Path
from traceback import extract_tb
from typing import Final, TypeVar

from elbowscrew.errors import OutputError, UsageError
from elbowscrew.study.executors import OpenExecutor
from elbowscrew.study.outcome import LOST, Failure

Task = TypeVar("Task")
Report = Callable[[int, Failure | None], None]

_SPARE: Final = 2
_TRIES_ALONE: Final = 2
_OF_FUTURES: Final = "cfexecutor.py"  # Dask's, in which it makes its results into futures


def run_tasks(
    tasks: Sequence[Task],
    work: Callable[[Task], Failure | None],
    open_executor: OpenExecutor,
    workers: int,
    report: Report = lambda _index, _failure: None,
) -> list[Failure | None]:
    """Do all tasks, and say of each how it failed, if it did.

    When a worker dies, which of the trials in hand killed it is not known, nor which of them had been begun: each is
    tried at the end and alone. Who kills its worker then, and kills it again, has failed; the others come out as if
    nothing had been.

    Parameters
    ----------
    tasks : sequence
    work : callable
        Importable by the workers; raises nothing.
    open_executor : callable
        Gives an executor as a context manager.
    workers : int
        How many tasks are done at a time; a few more are handed out, so that no worker waits.
    report : callable
        Told the index of each task that is done, and its failure.

    Returns
    -------
    list
        A failure or None for each task, in their order.

    Raises
    ------
    OutputError
        If the disk does not take the results, or the scheduler is gone.
    UsageError
        If the workers cannot do such work at all.
    """
    found: list[Failure | None] = [None] * len(tasks)
    waiting, suspects = deque(range(len(tasks))), deque[int]()
    executor = _Renewed(open_executor)
    with executor:
        flying: dict[Future[Failure | None], int] = {}

        def hand_out(queue: deque[int], most: int) -> None:
            while queue and len(flying) < most:
                index = queue.popleft()
                try:
                    flying[executor.current().submit(work, tasks[index])] = index
                except (BrokenExecutor, OSError) as error:
                    # A worker died since the last look; this task has not been in anybody's hands. A pool that is
                    # just coming down may have closed its pipe already.
                    if isinstance(error, OSError) and "handle is closed" not in str(error):
                        raise
                    queue.appendleft(index)
                    if flying:
                        return
                    executor.drop()

        def settle(index: int, failure: Failure | None) -> None:
            if failure is not None and failure.stops_all:
                raise (UsageError if failure.exit_code == UsageError.exit_code else OutputError)(failure.message)
            found[index] = failure
            report(index, failure)

        while waiting or flying:
            hand_out(waiting, workers + _SPARE)
            broken = _collect(flying, settle, suspects.append)
            if broken:
                executor.drop()
        for index in sorted(suspects):
            for _ in range(_TRIES_ALONE):
                died: list[int] = []
                hand_out(deque([index]), 1)
                if _collect(flying, settle, died.append):
                    executor.drop()
                if not died:
                    break
            else:
                settle(index, _lost(tasks[index]))
    return found


def _collect(
    flying: dict[Future[Failure | None], int],
    settle: Callable[[int, Failure | None], None],
    suspect: Callable[[int], None],
) -> bool:
    """Wait for the next results; say whether the executor is broken, and then all in flight have come down."""
    done, _ = wait(flying, return_when=FIRST_COMPLETED)
    if any(isinstance(future.exception(), BrokenExecutor) for future in done if not future.cancelled()):
        done, _ = wait(flying)
    broken = False
    for future in sorted(done, key=flying.__getitem__):
        index = flying.pop(future)
        try:
            failure = future.result()
        except BrokenExecutor:
            broken = True
            suspect(index)
        except CancelledError as error:
            msg = "the cluster is gone; start the batch again when it is there: what is finished is kept"
            raise OutputError(msg) from error
        except Exception as error:
            if not _lost_by_cluster(error):
                msg = f"the workers cannot do the work: {type(error).__name__}: {error}; install the same program there"
                raise UsageError(msg) from error
            suspect(index)
        else:
            settle(index, failure)
    return broken


def _lost_by_cluster(error: Exception) -> bool:
    """Whether Dask, which may not be installed, has lost a task: it says so, or fails to tell what became of it."""
    innermost = extract_tb(error.__traceback__)[-1:]
    return type(error).__name__ == "KilledWorker" or any(Path(one.filename).name == _OF_FUTURES for one in innermost)


def _lost(task: object) -> Failure:
    label = getattr(task, "label", "")
    message = f"{label}: the worker died twice on it: out of memory, or a crash in a library; look at the recording"
    return Failure(error_class=LOST, message=message, exit_code=1)


class _Renewed:
    """An executor, and a new one after one is broken."""

    def __init__(self, open_executor: OpenExecutor) -> None:
        self._open = open_executor
        self._stack = ExitStack()
        self._executor: Executor | None = None

    def current(self) -> Executor:
        if self._executor is None:
            self._executor = self._stack.enter_context(self._open())
        return self._executor

    def drop(self) -> None:
        self._stack.close()
        self._executor = None

    def __enter__(self) -> _Renewed:
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.__exit__(*error)  # type: ignore[arg-type]
