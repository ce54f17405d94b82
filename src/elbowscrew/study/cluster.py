"""Dask's clusters as executors: reached or started here, their workers asked who they are, and watched."""

from __future__ import annotations

import gc
import logging
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager, suppress
from importlib import import_module
from threading import Event, Lock, Thread
from typing import Any, Final

from elbowscrew._search_path import CurrentFolderLeftOut
from elbowscrew.errors import UsageError
from elbowscrew.study.task import told_apart, versions_here

LOCAL_CLUSTER: Final = "local-cluster"

_LOOPBACK: Final = "127.0.0.1"
_LONGEST_CLOSE_S: Final = 5.0
_LONGEST_WAIT: Final = "15s"
_LOOK_S: Final = 0.5

_REVIVAL_S: Final = 60.0
"""Seconds in which a cluster of this machine brings a worker back, at least: it may be busy with other work."""


@contextmanager
def open_cluster(scheduler: str, workers: int, wait_s: float) -> Iterator[Executor]:
    """Give the executor of a cluster: of the one at an address, or of a new one on this machine.

    It breaks, as one of processes does, once the cluster has had no worker for so long that none is to be expected.
    """
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
            with _Watched(executor, client, wait_s if cluster is None else max(wait_s, _REVIVAL_S)) as watched:
                yield watched
        except BaseException:
            executor.shutdown(wait=False)
            raise
        finally:
            # A worker that is just coming to life may keep a cluster from ever closing; it dies with this process.
            with suppress(TimeoutError):
                client.close()
                if cluster is not None:
                    cluster.close(timeout=_LONGEST_CLOSE_S)


class _Watched(Executor):
    """A cluster's executor that breaks where all workers are gone: Dask itself waits for new ones without end."""

    def __init__(self, executor: Executor, client: Any, wait_s: float) -> None:
        self._executor, self._client, self._wait_s = executor, client, wait_s
        self._pending: set[Future[Any]] = set()
        self._lock, self._closed = Lock(), Event()
        self._watch = Thread(target=self._look, daemon=True)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        outer: Future[Any] = Future()
        with self._lock:
            self._pending.add(outer)
        self._executor.submit(fn, *args, **kwargs).add_done_callback(lambda inner: self._hand_on(inner, outer))
        return outer

    def _hand_on(self, inner: Future[Any], outer: Future[Any]) -> None:
        with self._lock:
            if outer not in self._pending:
                return  # told already that it is lost
            self._pending.remove(outer)
        if inner.cancelled():
            outer.cancel()
            outer.set_running_or_notify_cancel()
        elif (error := inner.exception()) is not None:
            outer.set_exception(error)
        else:
            outer.set_result(inner.result())

    def _look(self) -> None:
        last = time.monotonic()
        while not self._closed.wait(_LOOK_S):
            try:
                there = self._client.nthreads()
            except Exception:
                return  # the scheduler is gone: Dask cancels what was given to it
            if there:
                last = time.monotonic()
            elif time.monotonic() - last > self._wait_s:
                with self._lock:
                    lost, self._pending = self._pending, set()
                for future in lost:
                    future.set_exception(BrokenExecutor("no worker is left"))

    def __enter__(self) -> _Watched:
        self._watch.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closed.set()
        self._watch.join(_LONGEST_CLOSE_S)


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
