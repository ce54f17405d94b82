"""The bar that shows how far the work has come: on a terminal, once it takes a while, and nowhere else."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from rich.progress import Progress as Bar
from rich.progress import TaskID

from elbowscrew import analyze, save_analysis, save_simulation, simulate_trial
from elbowscrew.cli import main, progress
from elbowscrew.report import remake_pages


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """A terminal in place of standard error, and no time until the bar stands there."""
    screen = io.StringIO()
    monkeypatch.setattr(progress, "Console", lambda stderr: Console(file=screen, force_terminal=stderr, width=80))
    monkeypatch.setattr(progress, "_SECONDS_WITHOUT_BAR", 0.0)
    return screen


@pytest.fixture
def prompt_terminal(terminal: io.StringIO, monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """The same, where what a command tells is drawn at once and not when the clock of the bar comes round."""

    class AtOnce:
        daemon = False

        def __init__(self, _seconds: float, begin: Callable[[], None]) -> None:
            self.start = begin

        def cancel(self) -> None: ...
        def join(self) -> None: ...

    class Prompt(Bar):
        def update(self, task_id: TaskID, **told: Any) -> None:
            super().update(task_id, **told, refresh=self.live.is_started)

    monkeypatch.setattr(threading, "Timer", AtOnce)
    monkeypatch.setattr(progress, "Bar", Prompt)
    return terminal


def awaited(screen: io.StringIO, text: str) -> bool:
    """Whether a text appears on a screen that a thread of its own draws."""
    end = time.monotonic() + 60.0
    while text not in screen.getvalue() and time.monotonic() < end:
        time.sleep(0.01)
    return text in screen.getvalue()


def test_steps_are_counted_before_and_while_the_bar_stands(terminal: io.StringIO) -> None:
    with progress.shown_steps("Steps", quiet=False) as report:
        assert awaited(terminal, "Steps")
        report(3, 7)
        assert awaited(terminal, "3/7")
    gone = terminal.getvalue()
    assert gone.endswith("\x1b[2K")  # the line is empty again
    time.sleep(0.2)
    assert terminal.getvalue() == gone


@pytest.mark.parametrize("case", ["quiet", "no terminal", "soon done"])
def test_there_is_no_bar(case: str, terminal: io.StringIO, monkeypatch: pytest.MonkeyPatch) -> None:
    if case == "soon done":
        monkeypatch.setattr(progress, "_SECONDS_WITHOUT_BAR", 3600.0)
    if case == "no terminal":
        monkeypatch.setattr(progress, "Console", lambda stderr: Console(file=terminal, force_terminal=not stderr))
    with progress.shown_steps("Steps", quiet=case == "quiet") as report:
        for done in range(5):
            report(done, 5)
        time.sleep(0.2)
    assert terminal.getvalue() == ""


@pytest.mark.parametrize(("trial", "steps"), [("take.csv", "16/16"), (".", "1/1")])
def test_compare_shows_its_steps_and_quiet_shows_nothing(
    trial: str,
    steps: str,
    prompt_terminal: io.StringIO,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    save_simulation(simulate_trial(frames=60, inversion=30), Path("take.csv"))
    given = [
        "compare",
        trial,
        "--laws",
        "linear",
        "--counts",
        "2,3",
        "--data",
        "raw",
        "--figure-format",
        "none",
        "--json",
    ]
    assert main([*given, "-o", "quiet", "--quiet"]) == 0
    assert prompt_terminal.getvalue() == ""
    assert main([*given, "-o", "shown"]) == 0
    assert steps in prompt_terminal.getvalue()
    assert capsys.readouterr().err == ""


def test_analyze_report_and_simulate_show_what_they_do(
    prompt_terminal: io.StringIO, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["simulate", "take.csv", "--frames", "60", "--inversion", "30"]) == 0
    assert "Simulating take.csv" in prompt_terminal.getvalue()
    assert "Writing take.csv" in prompt_terminal.getvalue()
    given = ["analyze", "take.csv", "--figure-format", "none", "--no-report"]
    assert main([*given, "-o", "quiet", "--quiet"]) == 0
    assert "Analyzing" not in prompt_terminal.getvalue()
    assert main([*given, "-o", "shown"]) == 0
    assert "Analyzing take.csv" in prompt_terminal.getvalue()
    assert main(["report", "shown", "quiet"]) == 0
    assert "2/2" in prompt_terminal.getvalue()
    capsys.readouterr()


def test_figures_and_pages_count_their_results(tmp_path: Path) -> None:
    folder = save_analysis(
        analyze(simulate_trial(frames=60, inversion=30).recording), tmp_path / "one", figure_formats=()
    )
    steps: list[tuple[int, int]] = []
    remake_pages([tmp_path, folder], lambda done, total: steps.append((done, total)))
    assert steps == [(0, 2), (1, 2), (2, 2)]


def test_quiet_writes_and_prints_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["simulate", "take.csv", "--frames", "60", "--inversion", "30", "-q"]) == 0
    assert main(["analyze", "take.csv", "-q", "--figure-format", "none", "--no-report"]) == 0
    assert main(["interpolate", "take_elbowscrew/keyframes.csv", "--frames", "9", "-q"]) == 0
    assert main(["samples", "--copy", "copies", "-q"]) == 0
    assert capsys.readouterr().out == ""
    assert {"take.csv", "take.truth.json", "keyframes_motion.csv"} <= {file.name for file in tmp_path.iterdir()}
    assert list((tmp_path / "copies").iterdir())
