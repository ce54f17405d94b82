"""Where the work is done: this machine's cores or a Dask cluster, both by the interface of `concurrent.futures`."""

from __future__ import annotations

import gc
import logging
import multiprocessing
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final

from elbowscrew._search_path import CurrentFolderLeftOut
from elbowscrew.errors import UsageError
from elbowscrew.study.task import told_apart, versions_here
from elbowscrew.study.worker import prepare_worker

LOCAL_CLUSTER: Final = "local-cluster"

OpenExecutor = Callable[[], AbstractContextManager[Executor]]
"""Gives a new executor; leaving its context by an error ends the work in hand."""

_LOOPBACK: Final = "127.0.0.1"
_LONGEST_CLOSE_S: Final = 5.0
_LONGEST_WAIT: Final = "15s"
_ADDRESS: Final = re.compile(r"((tcp|tls|ws|wss)://)?[^\s/:]+:\d{1,5}|((tcp|tls|ws|wss)://)?\[[\da-fA-F:]+\]:\d{1,5}")

WAIT_S: Final = 10.0
"""Seconds that a cluster has to show its first worker: without any it would be waited for without end."""


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
        Seconds to wait for the first worker of a cluster.

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
    return partial(_cluster, scheduler, workers, wait_s)


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


@contextmanager
def _cluster(scheduler: str, workers: int, wait_s: float) -> Iterator[Executor]:
    dask: Any = import_module("dask")
    distributed: Any = import_module("distributed")
    quiet = {
        "distributed.scheduler.allowed-failures": 0,  # who dies of a trial is told so, and the trial tried again alone
        "distributed.comm.timeouts.connect": _LONGEST_WAIT,
        "distributed.nanny.pre-spawn-environ": {
            "OMP_NUM_THREADS": 1,
            "MKL_NUM_THREADS": 1,
            "OPENBLAS_NUM_THREADS": 1,
            "MPLBACKEND": "agg",
        },
    }
    with dask.config.set(quiet), CurrentFolderLeftOut(), _silence():
        try:
            if scheduler == LOCAL_CLUSTER:
                cluster = distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    host=_LOOPBACK,
                    # Even without a dashboard there is a server of numbers, and nothing asks who wants to see them.
                    scheduler_kwargs={"dashboard": False, "dashboard_address": f"{_LOOPBACK}:0"},
                    dashboard=False,
                    silence_logs=logging.CRITICAL,
                )
            else:
                cluster = None
            client = distributed.Client(cluster or scheduler, timeout=_LONGEST_WAIT)
        except (OSError, ValueError, TimeoutError) as error:
            refused = f"no Dask scheduler answers there ({error}); give tcp://host:port"
        except TypeError as error:
            refused = (
                f"its certificates are missing ({error}); name them in Dask's configuration, "
                "distributed.comm.tls.ca-file and .client.key and .cert"
            )
        else:
            refused = ""
        if refused:
            gc.collect()  # the half-made client: collected inside a later call of Dask, it waits for a lock held there
            msg = f"--scheduler {scheduler}: {refused}"
            raise UsageError(msg)
        try:
            client.wait_for_workers(1, timeout=wait_s)
        except TimeoutError as error:
            client.close()
            msg = f"--scheduler {scheduler}: no worker after {wait_s:g} s; start some, or give --wait SECONDS"
            raise UsageError(msg) from error
        executor = client.get_executor(pure=False, retries=0)
        try:
            _check_workers(client, scheduler)
            yield executor
        except BaseException:
            executor.shutdown(wait=False)
            raise
        finally:
            # A worker that is just coming to life may keep a cluster from ever closing; it dies with this process.
            with suppress(TimeoutError):
                client.close()
                if cluster is not None:
                    cluster.close(timeout=_LONGEST_CLOSE_S)


def _check_workers(client: Any, scheduler: str) -> None:
    """Ask every worker that is there for its versions; of one that comes later its first trial tells."""
    for told in client.run(versions_here, on_error="return").values():
        if isinstance(told, Exception):
            message = f"the workers cannot do the work: {type(told).__name__}: {told}; install the same program there"
        else:
            message = told_apart(told, versions_here())
        if message:
            msg = f"--scheduler {scheduler}: {message}"
            raise UsageError(msg)


@contextmanager
def _silence() -> Iterator[None]:
    """Keep Dask's own words on ports and connections to itself: what matters comes as an error."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    levels = [logger.level for logger in loggers]
    with warnings.catch_warnings():
        if not sys.warnoptions:
            warnings.simplefilter("ignore")
        for logger in loggers:
            logger.setLevel(logging.CRITICAL + 1)
        try:
            yield
        finally:
            for logger, level in zip(loggers, levels, strict=True):
                logger.setLevel(level)
