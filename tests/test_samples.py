"""The samples are what `simulate` makes, and the analysis finds their truth within the noise."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from elbowscrew import Settings, analyze, read_recording, simulate_trial
from elbowscrew.cli.app import app

NAMES = ("elbow_paper", "elbow_moving_arm_mm", "elbow_row_tagged", "knee", "elbow_left")
ALL = (*NAMES, "elbow_natural")


@pytest.mark.parametrize("name", ALL)
def test_the_documented_command_makes_the_sample(
    samples: Path, root: Path, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = re.findall(
        r"^elbowscrew (simulate (\S+)\.csv .*)$", (root / "docs/reference/simulate.md").read_text("utf-8"), re.M
    )
    assert {made for _, made in lines} == set(ALL) == {path.stem for path in samples.glob("*.csv")}
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, shlex.split({made: line for line, made in lines}[name]))
    assert done.exit_code == 0, done.output
    heads = [(folder / f"{name}.csv").read_text("utf-8").splitlines()[0] for folder in (samples, tmp_path)]
    assert heads[0] == heads[1]  # take, unit, layout
    mine, theirs = (json.loads((folder / f"{name}.truth.json").read_text("utf-8")) for folder in (samples, tmp_path))
    assert mine["settings"] == theirs["settings"]
    assert _numbers(mine) == pytest.approx(_numbers(theirs), abs=1e-9)


def _numbers(value: Any) -> list[float]:
    """All numbers of a truth, in its order."""
    if isinstance(value, dict):
        return [number for one in value.values() for number in _numbers(one)]
    if isinstance(value, list):
        return [number for one in value for number in _numbers(one)]
    return [float(value)] if isinstance(value, int | float) else []


@pytest.mark.parametrize("name", ALL)
def test_samples_are_made_by_simulate(samples: Path, name: str) -> None:
    truth = json.loads((samples / f"{name}.truth.json").read_text())
    trial = simulate_trial(**truth["settings"])
    recording = read_recording(samples / f"{name}.csv")
    for ours, theirs in zip(trial.recording.bodies, recording.bodies, strict=True):
        known = ours.tracked
        assert (known == theirs.tracked).all()
        sign = np.sign(np.sum(theirs.dual_quat_lab_body * ours.dual_quat_lab_body, axis=1)[known, None])
        assert sign * theirs.dual_quat_lab_body[known] == pytest.approx(ours.dual_quat_lab_body[known], abs=3e-6)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_the_truth_is_found_within_the_noise(samples: Path, name: str, express_in: Any) -> None:
    truth = json.loads((samples / f"{name}.truth.json").read_text())
    analysis = analyze(read_recording(samples / f"{name}.csv"), Settings(express_in=express_in))
    valid = analysis.screw.valid
    # Angle noise: sqrt(2) sigma / (sqrt(m) rho) for each of two bodies (accuracy of a pose from four markers), 4.5 SD.
    sigma_deg = np.degrees(2.0 * truth["settings"]["marker_noise_mm"] / (2.0 * 35.0))
    error = np.degrees(analysis.screw.angle) - truth["theta_deg"]
    assert np.abs(error[valid]).max() < 4.5 * sigma_deg
    found, known = analysis.mean_axis, truth["axis"][express_in]
    tilt = np.degrees(np.arccos(min(1.0, float(found.direction @ known["direction"]))))
    assert tilt < 3.0 * sigma_deg
    assert truth["lost_frames"] == np.flatnonzero(~valid).tolist()


def test_the_paper_like_trial_is_like_the_papers(samples: Path) -> None:
    recording = read_recording(samples / "elbow_paper.csv")
    assert (recording.frame.size, recording.rate_hz) == (450, 100.0)
    assert [len(body.marker_offsets) for body in recording.bodies if body.marker_offsets is not None] == [4, 4]
    analysis = analyze(recording)
    assert analysis.keyframes.frame.tolist() == [0, 211, 449]
    assert analysis.points.origin == "markers"


def test_the_natural_elbow_has_two_axes_within_the_noise(samples: Path) -> None:
    """Flexion of 130 deg and pronation of 60; the axes are those of the truth to the noise of the poses."""
    truth = json.loads((samples / "elbow_natural.truth.json").read_text())
    analysis = analyze(read_recording(samples / "elbow_natural.csv"))
    joint = analysis.joint_type
    assert joint is not None
    assert (joint.type, joint.status) == ("two_axes", "determined")
    assert joint.two_axes is not None
    known = truth["two_axes"]
    for name, line in (("axis1", joint.two_axes.axis1), ("axis2", joint.two_axes.axis2)):
        own = "proximal" if name == "axis1" else "distal"  # there the reference frame's own noise does not matter
        direction = line.direction_proximal if own == "proximal" else line.direction_distal
        assert np.degrees(np.arccos(min(1.0, float(direction @ known[name][own]["direction"])))) < 0.3
    assert joint.two_axes.distance is not None
    assert 1000.0 * joint.two_axes.distance.value == pytest.approx(known["distance_mm"], abs=0.5)
    for k, name in enumerate(("angle1_deg", "angle2_deg")):
        error = np.degrees(joint.angle[:, k]) - truth["joint_angles"][name]
        assert np.sqrt(np.mean(error**2)) < 0.6  # the reference frame's own error among them
    ranges = [np.ptp(truth["joint_angles"][name]) for name in ("angle1_deg", "angle2_deg")]
    assert ranges == pytest.approx([130.0, 60.0], abs=0.1)
