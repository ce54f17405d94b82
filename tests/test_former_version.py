"""What version 0.1 wrote: settings and keyframes are read, results are told to be of another version, or made anew."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from elbowscrew import (
    analyze,
    interpolate,
    keyframes_of,
    read_keyframes,
    save_analysis,
    save_simulation,
    simulate_trial,
)
from elbowscrew.cli import main

# The header line that version 0.1 wrote; its words for the segments are not among these columns.
KEYFRAMES = (
    "frame,time_s,phase,knot,theta_deg,e0,e1,e2,e3,d_x_mm,d_y_mm,d_z_mm,method,blend,law,law_peak,law_start_s,law_end_s"
)
SETTINGS = """
arm = "Upper Arm"
forearm = "Forearm"
express-in = "forearm"
inversion = 30
figure-format = ["none"]
"""


def older(summary: Path) -> None:
    """Write the summary of a result as 0.1 did."""
    found = json.loads(summary.read_text(encoding="utf-8"))
    trial = found["trial"]
    del trial["joint"]
    trial["arm"], trial["forearm"] = trial.pop("proximal"), trial.pop("distal")
    summary.write_text(json.dumps({**found, "elbowscrew": "0.1.0"}), encoding="utf-8")
    summary.with_name("SHA256SUMS").unlink(missing_ok=True)


def test_keyframes_are_read(tmp_path: Path) -> None:
    analysis = analyze(simulate_trial(frames=60, inversion=30, seed=1).recording)
    save_analysis(analysis, tmp_path / "r", figure_formats=(), report=False)
    lines = (tmp_path / "r" / "keyframes.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == KEYFRAMES
    motion = interpolate(read_keyframes(tmp_path / "r" / "keyframes.csv"), 60)
    again = interpolate(keyframes_of(analysis), 60)
    assert motion.euler_parameters == pytest.approx(again.euler_parameters, abs=1e-12)


def test_settings_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    save_simulation(simulate_trial(frames=60, inversion=30, seed=1), tmp_path / "t.csv")
    (tmp_path / "old.toml").write_text(SETTINGS, encoding="utf-8")
    assert main(["analyze", "t.csv", "--config", "old.toml", "-o", "r"]) == 0
    settings = json.loads((tmp_path / "r" / "summary.json").read_text(encoding="utf-8"))["settings"]
    assert (settings["proximal"], settings["distal"], settings["express-in"]) == ("Upper Arm", "Forearm", "distal")
    assert not {"arm", "forearm"} & set(settings)


def test_a_batch_makes_its_results_anew_and_leaves_those_of_now(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for k in range(3):
        save_simulation(simulate_trial(frames=60, inversion=30, seed=k), tmp_path / "in" / f"t{k}.csv")
    run = ["batch", "in", "-o", "out", "--figure-format", "none", "-q"]
    assert main(run) == 0
    table = (tmp_path / "out" / "summary.csv").read_bytes()
    for name in ("t0", "t2"):
        older(next((tmp_path / "out").glob(f"*{name}*/summary.json")))
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*/summary.json")}
    assert main(run) == 0
    redone = {path.parent.name for path, stamp in before.items() if path.stat().st_mtime_ns != stamp}
    assert {name[:2] for name in redone} == {"t0", "t2"}
    assert (tmp_path / "out" / "summary.csv").read_bytes() == table
    # A whole folder of 0.1 is made anew, and nothing of it is left.
    for path in before:
        older(path)
    assert main(run) == 0
    assert (tmp_path / "out" / "summary.csv").read_bytes() == table
    assert "Traceback" not in capsys.readouterr().err


def test_report_names_both_versions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording = simulate_trial(frames=60, inversion=30, seed=1).recording
    folder = save_analysis(analyze(recording), tmp_path / "r", figure_formats=(), report=False)
    older(folder / "summary.json")
    shutil.copytree(folder, tmp_path / "study" / "a")
    for target in (folder, tmp_path / "study"):
        assert main(["report", str(target)]) != 0
        told = capsys.readouterr().err.strip()
        assert "0.1.0" in told
        assert "Traceback" not in told
    assert np.isfinite(json.loads((folder / "summary.json").read_text())["trial"]["frames"])
