"""Small studies for the tests of batch: sound trials, trials broken in many ways, and the command to run them with."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from elbowscrew import save_simulation, simulate_trial

FAST = ("--figure-format", "none")


def write_trials(folder: Path, count: int, *, frames: int = 60, stem: str = "trial") -> list[Path]:
    """Write sound trials that all differ, quickly: the poses of a few, under other names and with other noise."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for k in range(count):
        trial = simulate_trial(frames=frames, inversion=frames // 2, top_deg=80.0 + k % 60, seed=k)
        path, truth = save_simulation(trial, folder / f"{stem}{k}.csv")
        truth.unlink()
        written.append(path)
    return written


def _lines(change: Callable[[list[str]], list[str]]) -> Callable[[str], bytes]:
    return lambda text: "\n".join(change(text.split("\n"))).encode()


def _blank_poses(lines: list[str]) -> list[str]:
    return [*lines[:7], *(",".join(line.split(",")[:2] + [""] * (line.count(",") - 1)) for line in lines[7:] if line)]


# What is done to a sound export, the class of the error that tells it, and its exit code.
WAYS: dict[str, tuple[Callable[[str], bytes], str, int]] = {
    "empty": (lambda _text: b"", "RecordingError", 3),
    "binary": (lambda _text: b"\x7fELF\x00\x00" * 50, "RecordingError", 3),
    "headless": (_lines(lambda lines: lines[7:]), "RecordingError", 3),
    "cut header": (_lines(lambda lines: [*lines[:3], lines[3][:40]]), "RecordingError", 3),
    "cut line": (lambda text: text[: len(text) // 2].rsplit(",", 1)[0].encode(), "RecordingError", 3),
    "utf-16": (lambda text: text.encode("utf-16"), "RecordingError", 3),
    "zip": (lambda text: b"PK\x03\x04" + text.encode(), "RecordingError", 3),
    "unit": (
        lambda text: text.replace("Length Units,Meters", "Length Units,Furlongs").encode(),
        "MissingStatementError",
        4,
    ),
    "word for a number": (lambda text: text.replace("\n5,0.05", "\n5,five").encode(), "RecordingError", 3),
    "names": (
        lambda text: text.replace("Upper Arm", "Body A").replace("Forearm", "Body B").encode(),
        "SettingError",
        4,
    ),
    "blank": (_lines(_blank_poses), "AnalysisError", 5),
    "prose": (lambda _text: b"this is not a recording\n", "RecordingError", 3),
}


def break_trial(path: Path, way: str) -> None:
    path.write_bytes(WAYS[way][0](path.read_text(encoding="utf-8")))


def batch(
    *arguments: object, folder: Path, code: int | None = 0, environment: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run ``elbowscrew batch`` in a folder, as a person would, and check how it ends."""
    done = subprocess.run(
        command(*arguments), cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, **(environment or {})}, timeout=300,
    )  # fmt: skip
    assert code is None or done.returncode == code, done.stderr
    return done


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "elbowscrew", "batch", *map(str, arguments)]


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, but the locks, which tell of the run."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".lock"
    }
