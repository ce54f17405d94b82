"""Progress on standard error: of a batch a bar on a terminal, a line now and then elsewhere; else a bar if it lasts."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.progress import Progress as Bar
from rich.text import Text

from elbowscrew.cli.text import one_line, tell

if TYPE_CHECKING:
    from elbowscrew.study.study import Progress

_SECONDS_BETWEEN_LINES = 10.0
_SECONDS_WITHOUT_BAR = 2.0


@contextmanager
def shown_progress(*, quiet: bool, verbose: bool) -> Iterator[Callable[[Progress], None]]:
    """Give a function that shows how far a batch has come, as long as the block lasts."""
    if quiet:
        yield lambda _progress: None
        return
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _Lines(verbose)
        return
    with _bar(console) as bar:
        task = bar.add_task("Trials", total=None, told="")
        rate = _Rate()

        def show(progress: Progress) -> None:
            rate.update(progress)
            told = f"{progress.failed} failed, {rate}"
            bar.update(task, total=progress.total, completed=progress.done, told=told)
            if verbose and progress.latest is not None:
                bar.console.print(Text(one_line(f"failed: {progress.latest.failure.message}")))

        yield show


@contextmanager
def shown_steps(what: str, *, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """Give a function that shows how many steps are done and of how many, on a terminal and once they take a while."""
    console = Console(stderr=True)
    bar = _bar(console)
    task = bar.add_task(what, total=None, told="")
    with _shown_late(bar, quiet=quiet):
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def shown_stages(*, quiet: bool) -> Iterator[Callable[[str], None]]:
    """Give a function that shows which stage of the work has begun, on a terminal and once the work takes a while."""
    bar = Bar(
        TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), console=Console(stderr=True), transient=True
    )
    task = bar.add_task("", total=None)
    with _shown_late(bar, quiet=quiet):
        yield lambda stage: bar.update(task, description=one_line(stage))


@contextmanager
def _shown_late(bar: Bar, *, quiet: bool) -> Iterator[None]:
    """Show a bar on a terminal as long as the block lasts, if it lasts a while."""
    if quiet or not bar.console.is_terminal:
        yield
        return
    # By a clock of its own, so that a first step that never seems to end is shown too.
    begin = threading.Timer(_SECONDS_WITHOUT_BAR, bar.start)
    begin.daemon = True
    begin.start()
    try:
        yield
    finally:
        begin.cancel()
        begin.join()
        if bar.live.is_started:
            bar.stop()


def _bar(console: Console) -> Bar:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[told]}"),
        TimeRemainingColumn(),
    )
    return Bar(*columns, console=console, transient=True)


class _Lines:
    """A line at the begin, at the end and every few seconds."""

    def __init__(self, verbose: bool) -> None:
        self._verbose = verbose
        self._rate = _Rate()
        self._last = -_SECONDS_BETWEEN_LINES

    def __call__(self, progress: Progress) -> None:
        self._rate.update(progress)
        if self._verbose and progress.latest is not None:
            _write(f"failed: {progress.latest.failure.message}")
        now = time.monotonic()
        if now - self._last < _SECONDS_BETWEEN_LINES and progress.done < progress.total:
            return
        self._last = now
        kept = f" ({progress.kept} were up to date)" if progress.kept else ""
        left = self._rate.left(progress)
        parts = [f"{progress.done} of {progress.total} trials done{kept}", f"{progress.failed} failed"]
        parts += [str(self._rate)] if self._rate.known else []
        parts += [f"{left:.0f} s left"] if left else []
        _write(", ".join(parts))


class _Rate:
    """Trials a second, of those that this run has analyzed."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._analyzed = 0
        self._elapsed = 0.0

    @property
    def known(self) -> bool:
        return self._analyzed > 0

    def update(self, progress: Progress) -> None:
        self._analyzed = progress.done - progress.kept
        self._elapsed = time.monotonic() - self._start

    def left(self, progress: Progress) -> float:
        return (progress.total - progress.done) * self._elapsed / self._analyzed if self._analyzed else 0.0

    def __str__(self) -> str:
        return f"{self._analyzed / self._elapsed:.1f}/s" if self._analyzed and self._elapsed else ""


def _write(text: str) -> None:
    tell(f"elbowscrew: {one_line(text)}")
