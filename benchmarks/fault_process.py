"""One command in a fork of this warm process, with one call that fails or kills.

The numbers of an analysis, and the bytes of figures, are computed once, before the forks: what is disturbed is how they
are written.
"""

from __future__ import annotations

import ctypes
import gc
import hashlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
LIBRARY = "ELBOWSCREW_FAULT_SHIM"
DOUBLE = "python"
"""In the place of the library: where there is no compiler, Python's own functions are disturbed."""
FAIL, KILL, KILL_ON = 1, 2, 3
"""A call fails, the process gets a signal at it, or at it and at every call thereafter."""
NO_EXCHANGE, CLOSED_ABOVE, MOUNTED = 1, 2, 4
"""Of a disk: two things cannot change places in one step, nothing can be made in the folder where the command runs, or
what is in it cannot be moved."""


@dataclass(frozen=True)
class Fault:
    """What happens at one call: an error of the system, or a signal."""

    name: str
    action: int
    number: int


@dataclass(frozen=True)
class Ended:
    """How a command ended: its exit code (negative: killed by a signal), what it said, and how many calls it made."""

    code: int
    said: str
    calls: int


def restart_with_shim(compiler: str | None) -> int:
    """Build the library, and run this program again with it before the C library."""
    if compiler is None:
        environment = {**os.environ, LIBRARY: DOUBLE}
        return subprocess.run([sys.executable, *sys.argv], env=environment, check=False).returncode
    with tempfile.TemporaryDirectory(prefix="elbowscrew-shim-") as folder:
        library = Path(folder) / "shim.so"
        source = HERE / "fault_shim.c"
        subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", str(library), str(source), "-ldl"], check=True)
        environment = {
            **os.environ, LIBRARY: str(library), "LD_PRELOAD": str(library), "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
        }  # fmt: skip
        return subprocess.run([sys.executable, *sys.argv], env=environment, check=False).returncode


def run_forked(
    arguments: tuple[str, ...], folder: Path, fault: Fault | None = None, call: int = -1, *,
    cannot: int = 0, journal: Path | None = None, longest_s: float = 60.0,
) -> Ended:  # fmt: skip
    """Run a command of the program in a folder, on a disk that cannot do some things (`NO_EXCHANGE` and so on)."""
    from elbowscrew.cli import main

    shim = _shim()
    with tempfile.TemporaryFile() as told, tempfile.TemporaryFile() as count:
        child = os.fork()
        if child == 0:
            try:
                os.chdir(folder)
                os.dup2(told.fileno(), 1)
                os.dup2(told.fileno(), 2)
                log = -1 if journal is None else os.open(journal, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
                action, number = (0, 0) if fault is None else (fault.action, fault.number)
                shim.fault_arm(os.fsencode(folder), call, action, number, cannot, log)
                try:
                    code = main(list(arguments))
                    sys.stdout.flush()
                finally:
                    calls = shim.fault_count()
                    shim.fault_arm(b"", -1, 0, 0, 0, -1)
                    os.write(count.fileno(), str(calls).encode())
                os._exit(code)
            except BaseException:
                import traceback

                traceback.print_exc()
                sys.stderr.flush()
                os._exit(1)
        status = _wait(child, longest_s)
        told.seek(0)
        count.seek(0)
        calls = int(count.read() or b"0")
        return Ended(os.waitstatus_to_exitcode(status), told.read().decode("utf-8", "replace"), calls)


@cache
def _shim() -> Any:
    library = os.environ[LIBRARY]
    if library != DOUBLE:
        return ctypes.CDLL(library)
    from fault_double import Double

    return Double()


def _wait(child: int, longest_s: float) -> int:
    deadline = time.monotonic() + longest_s
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status
        if time.monotonic() > deadline:
            os.kill(child, 9)
            os.waitpid(child, 0)
            msg = "a command hangs"
            raise TimeoutError(msg)
        time.sleep(0.002)


class _InProcess(Executor):
    """Does at once, in this process, what it is given."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@contextmanager
def _executor() -> Iterator[Executor]:
    yield _InProcess()


def freeze() -> None:
    """Let forks share what is there: no collection of theirs touches it."""
    gc.collect()
    gc.freeze()


def compute_once() -> None:
    """Let results be computed once in this process, and be at hand in all its forks."""
    import typer.main

    import elbowscrew.cli.app as app
    import elbowscrew.comparing as comparing
    import elbowscrew.motion.interpolation.comparison as comparison
    import elbowscrew.paper as paper
    import elbowscrew.report.figure_files as figure_files
    import elbowscrew.report.publication as publication
    import elbowscrew.saving as saving
    import elbowscrew.simulate as simulate
    import elbowscrew.study.executors as executors
    import elbowscrew.study.task as task

    known: dict[str, Any] = {}

    def once(function: Callable[..., Any], key_of: Callable[..., str | None]) -> Callable[..., Any]:
        def call(*args: Any, **kwargs: Any) -> Any:
            told = key_of(*args, **kwargs)
            if told is None:
                return function(*args, **kwargs)
            key = f"{function.__name__} {told}"
            if key not in known:
                known[key] = function(*args, **kwargs)
            return known[key]

        return call

    def of_file(path: Path, settings: Any, **_: Any) -> str:
        return f"{path.name} {hashlib.sha256(path.read_bytes()).hexdigest()} {settings!r}"

    def of_figures(trial: Any, *args: Any) -> str:
        told = getattr(trial, "summary", None)
        return f"{hashlib.sha256(repr((told or trial.settings, args)).encode()).hexdigest()}"

    def of_comparison(drawings: dict[str, Any], *others: Any) -> str | None:
        told = [cell.cell_contents for cell in getattr(drawings.get("compare"), "__closure__", None) or ()]
        return f"{[id(one) for one in told]} {others!r}" if told else None

    patched: Any
    for patched, name, key in (
        (saving, "analyze_file", of_file),
        (saving, "analyze", lambda recording, settings=None, **more: f"{recording.source!r} {settings!r} {more!r}"),
        (simulate, "simulate_trial", lambda simulation=None, **more: f"{simulation!r} {more!r}"),
        (
            comparison,
            "compare",
            lambda recording, settings=None, plan=None, **_: f"{recording.source!r} {settings!r} {plan!r}",
        ),
        (figure_files, "figure_files", of_figures),
        (figure_files, "files_of", of_comparison),
        (paper, "comparisons", lambda: ""),
    ):
        setattr(patched, name, once(getattr(patched, name), key))
    patched = task
    patched.analyze_file = saving.analyze_file
    patched = comparing
    patched.compare = comparison.compare
    patched = publication
    patched.figure_files = figure_files.figure_files
    patched = typer.main
    patched.get_command = cache(typer.main.get_command)
    commands = app._Commands
    resolved: dict[str, Any] = {}

    def resolve(self: Any, context: Any, arguments: list[str]) -> tuple[Any, Any, list[str]]:
        if arguments[0] not in resolved:
            resolved[arguments[0]] = resolve_command(self, context, arguments)[:2]
        return *resolved[arguments[0]], arguments[1:]

    resolve_command = commands.resolve_command
    patched = commands
    patched.resolve_command = resolve
    patched = executors
    patched.open_executor = lambda *_given: partial(_executor)
