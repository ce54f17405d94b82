"""Plain tables with frame numbers alone, or times alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import known_trial, quaternion_xyzw

from elbowscrew import analyze, read_recording
from elbowscrew.errors import RecordingError, SettingError, UsageError

TRIAL = known_trial(100.0, frames=90, inversion=45, seed=3)


def table(path: Path, clock: dict[str, Any]) -> Path:
    columns: dict[str, Any] = dict(clock)
    for name, R, p in (("arm", TRIAL.proximal_R, TRIAL.proximal_p), ("forearm", TRIAL.distal_R, TRIAL.distal_p)):
        quat = quaternion_xyzw(R)[:, [3, 0, 1, 2]]
        columns |= {f"{name}_e{k}": quat[:, k] for k in range(4)}
        columns |= {f"{name}_{axis}_m": p[:, k] for k, axis in enumerate("xyz")}
    rows = np.stack([*columns.values()], axis=1)
    lines = [",".join(f"{x:.12g}" for x in row) for row in rows]
    path.write_text("\n".join([",".join(columns), *lines]) + "\n")
    return path


def test_times_alone_are_the_clock(tmp_path: Path) -> None:
    time_s = 5.0 + np.arange(90) / 50 + np.random.default_rng(1).uniform(-0.004, 0.004, 90)
    recording = read_recording(table(tmp_path / "t.csv", {"time_s": time_s}))
    assert recording.frame.tolist() == list(range(90))
    assert recording.time_s == pytest.approx(time_s, abs=1e-9)
    assert recording.rate_hz == pytest.approx(50.0, rel=0.005)
    assert [warning.code for warning in recording.warnings] == ["frames-numbered"]
    assert analyze(recording).screw.angle == pytest.approx(TRIAL.angle, abs=1e-9)


def test_a_pause_in_the_times_is_one(tmp_path: Path) -> None:
    time_s = np.arange(90) / 50 + np.where(np.arange(90) > 60, 3.0, 0.0)
    analysis = analyze(read_recording(table(tmp_path / "t.csv", {"time_s": time_s})))
    assert analysis.elapsed == pytest.approx(time_s, abs=1e-9)


def test_frame_numbers_alone_need_the_rate(tmp_path: Path) -> None:
    path = table(tmp_path / "t.csv", {"frame": 7 + np.arange(90)})
    with pytest.raises(SettingError, match="give rate_hz HZ"):
        read_recording(path)
    recording = read_recording(path, rate_hz=240.0)
    assert recording.frame.tolist() == list(range(7, 97))
    assert np.diff(recording.time_s) == pytest.approx(1 / 240.0)
    assert recording.rate_hz == pytest.approx(240.0)


def test_a_rate_beside_times_or_that_is_none_is_refused(tmp_path: Path) -> None:
    both = table(tmp_path / "t.csv", {"frame": np.arange(90), "time_s": np.arange(90) / 50})
    with pytest.raises(SettingError, match="has times itself"):
        read_recording(both, rate_hz=50.0)
    with pytest.raises(UsageError, match="expected a frame rate"):
        read_recording(both, rate_hz=float("nan"))
    path = tmp_path / "t.trc"
    path.write_text("PathFileType\t4\n")
    with pytest.raises(SettingError, match="rate: a file of this format"):
        read_recording(path, rate_hz=50.0)


def test_faults_of_the_clock_have_their_place(tmp_path: Path) -> None:
    time_s = np.arange(90.0)
    time_s[5] = np.nan
    path = table(tmp_path / "t.csv", {"time_s": time_s})
    path.write_text(path.read_text().replace("nan", ""))
    with pytest.raises(RecordingError, match=r"t\.csv:7: expected a whole frame number and a time, found 5 and nan"):
        read_recording(path)
    with pytest.raises(RecordingError, match=r"t\.csv:4: expected a whole frame number"):
        read_recording(table(tmp_path / "t.csv", {"frame": np.r_[0, 1, 2.5, 3:90]}), rate_hz=10.0)


def test_cases(real_data: Path) -> None:
    jitter = read_recording(real_data / "cases" / "ros_jitter.csv")
    numbered = read_recording(real_data / "cases" / "frame_only.csv", rate_hz=100.0)
    for recording in (jitter, numbered):
        assert np.degrees(np.nanmax(analyze(recording).screw.angle)) == pytest.approx(120.0, abs=0.01)
