"""The samples are what `simulate` makes, and the analysis finds their truth within the noise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import Settings, analyze, read_recording, simulate_trial

NAMES = ("elbow_paper", "elbow_moving_arm_mm", "elbow_row_tagged", "knee", "elbow_left")


@pytest.mark.parametrize("name", NAMES)
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
