"""Where the work is done: this machine's cores or a Dask cluster, both by the interface of `concurrent.futures`."""

from __future__ import annotations

import multiprocessing
import os
import re
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from importlib.util import find_spec
from typing import Final

from elbowscrew._search_path import CurrentFolderLeftOut
from elbowscrew.errors import UsageError
from elbowscrew.study.cluster import LOCAL_CLUSTER, open_cluster
from elbowscrew.study.worker import prepare_worker

OpenExecutor = Callable[[], AbstractContextManager[Executor]]
"""Gives a new executor; leaving its context by an error ends the work in hand."""

_ADDRESS: Final = re.compile(r"((tcp|tls|ws|wss)://)?[^\s/:]+:\d{1,5}|((tcp|tls|ws|wss)://)?\[[\da-fA-F:]+\]:\d{1,5}")

WAIT_S: Final = 10.0
"""Seconds that a cluster may be without any worker, at first or later: else it would be waited for without end."""


def open_executor(scheduler: str | None, workers: int, wait_s: float = WAIT_S) -> OpenExecutor:
    """Choose the executor: of this machine if there is no scheduler.

    Parameters
    ----------
    scheduler : str or None
        Address of a Dask scheduler (``tcp://host:port``, or ``tls://host:port`` with the certificates that Dask's
        configuration names), or ``local-cluster`` for one started here.
    workers : int
        Processes on this machine.
    wait_s : float
        Seconds to wait while a cluster has no worker.

    Raises
    ------
    UsageError
        If a scheduler is asked for and Dask is not installed, or the address cannot be one.
    """
    if scheduler is None:
        return partial(_local_pool, workers)
    if scheduler != LOCAL_CLUSTER and not _ADDRESS.fullmatch(scheduler):
        msg = f"--scheduler {scheduler}: expected tcp://host:port, tls://host:port or {LOCAL_CLUSTER}"
        raise UsageError(msg)
    if find_spec("distributed") is None:
        msg = "--scheduler needs dask.distributed; install it with: pip install distributed"
        raise UsageError(msg)
    return partial(open_cluster, scheduler, workers, wait_s)


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def _local_pool(workers: int) -> Iterator[Executor]:
    # Fresh processes: a fork of a process with threads, and matplotlib and BLAS have some, may never come to life.
    context = multiprocessing.get_context("spawn")
    watched, held = context.Pipe(duplex=False)
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=prepare_worker, initargs=(watched,))
    try:
        with CurrentFolderLeftOut():
            yield executor
    except BaseException:
        held.close()  # the workers end at once, whatever they are at
        executor.shutdown(wait=True, cancel_futures=True)
        raise
    else:
        executor.shutdown(wait=True)
    finally:
        held.close()
        watched.close()
