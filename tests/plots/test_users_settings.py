"""Figures are the same whatever matplotlib settings the user has, and none of these ends a command."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest

from elbowscrew import analyze, simulate_trial
from elbowscrew.report.figure_files import figure_files

STRANGE: dict[Any, Any] = {
    "text.usetex": True,
    "axes.grid": True,
    "font.family": "monospace",
    "font.size": 20.0,
    "savefig.dpi": 30,
    "savefig.transparent": True,
    "savefig.bbox": "tight",
    "axes.facecolor": "red",
    "lines.linewidth": 9.0,
    "path.sketch": (1.0, 100.0, 2.0),
    "xtick.direction": "in",
    "figure.autolayout": True,
}
SETTINGS = "\n".join(f"{key}: {', '.join(map(str, value)) if isinstance(value, tuple) else value}"
                     for key, value in STRANGE.items())  # fmt: skip


def test_figures_of_the_library_do_not_hang_on_the_users_settings() -> None:
    analysis = analyze(simulate_trial(frames=60, inversion=30).recording)
    plain = figure_files(analysis, ["theta", "axis"], ("png", "svg", "pdf"))
    before = mpl.rcParams.copy()
    with mpl.rc_context(STRANGE):
        assert figure_files(analysis, ["theta", "axis"], ("png", "svg", "pdf")) == plain
        assert mpl.rcParams["text.usetex"]
    assert mpl.rcParams == before


def settings(folder: Path) -> None:
    (folder / "matplotlibrc").write_text(SETTINGS + "\nbackend: module://nowhere\nno such key: 1\n")


def no_text(folder: Path) -> None:
    (folder / "matplotlibrc").write_bytes(b"\xff\xfe\x00" * 100)


def pipe(folder: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("pipes of POSIX")
    os.mkfifo(folder / "matplotlibrc")


def a_folder(folder: Path) -> None:
    (folder / "matplotlibrc").mkdir()


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory, samples: Path) -> dict[str, bytes]:
    return drawn(samples, tmp_path_factory.mktemp("plain"))


def drawn(samples: Path, folder: Path, **environment: str) -> dict[str, bytes]:
    """Figures of the command, started in a folder."""
    result = folder / "result"
    done = subprocess.run(
        [sys.executable, "-m", "elbowscrew", "analyze", str(samples / "elbow_paper.csv"), "-o", str(result), "-q",
         "--figures", "theta"],
        cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert "matplotlib" not in done.stderr
    return {path.name: path.read_bytes() for path in (result / "figures").iterdir()}


@pytest.mark.parametrize("make", [settings, no_text, pipe, a_folder])
def test_nor_do_those_of_the_command(
    plain: dict[str, bytes], samples: Path, tmp_path: Path, make: Callable[[Path], None]
) -> None:
    make(tmp_path)
    assert drawn(samples, tmp_path) == plain


@pytest.mark.parametrize("make", [settings, no_text])
@pytest.mark.parametrize("name", ["MPLCONFIGDIR", "MATPLOTLIBRC"])
def test_nor_on_the_environment(
    plain: dict[str, bytes], samples: Path, tmp_path: Path, make: Callable[[Path], None], name: str
) -> None:
    (tmp_path / "home").mkdir()
    make(tmp_path / "home")
    assert drawn(samples, tmp_path, **{name: str(tmp_path / "home"), "MPLBACKEND": "module://nowhere"}) == plain
