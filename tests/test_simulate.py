"""Synthetic trials: the truth they state is the motion they show."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import Settings, Simulation, analyze, read_recording, simulate_trial
from elbowscrew.errors import OutputError, UsageError
from elbowscrew.saving import save_simulation


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
@pytest.mark.parametrize("proximal", ["still", "moving"])
def test_the_truth_is_found_again_without_noise(express_in: Any, proximal: Any) -> None:
    trial = simulate_trial(
        marker_noise_mm=0.0, proximal=proximal, top_deg=142, sign_flips=True, gaps=2, repetitions=2, seed=5
    )
    analysis = analyze(trial.recording, Settings(express_in=express_in))
    valid = analysis.screw.valid
    assert np.flatnonzero(~valid).tolist() == trial.truth["lost_frames"]
    assert np.degrees(analysis.screw.angle)[valid] == pytest.approx(np.array(trial.truth["theta_deg"])[valid], abs=1e-7)
    known = analysis.screw.axis_known & valid
    assert 1000 * analysis.screw.slide[known] == pytest.approx(np.array(trial.truth["slide_mm"])[known], abs=1e-6)
    truth = trial.truth["axis"][express_in]
    assert analysis.mean_axis.direction == pytest.approx(truth["direction"], abs=1e-9)
    assert 1000 * analysis.mean_axis.point == pytest.approx(truth["point_mm"], abs=1e-6)
    assert trial.truth["inversion_frames"] == [211, 211 + 449]


@pytest.mark.parametrize("layout", ["motive", "row-tagged"])
@pytest.mark.parametrize("unit", ["m", "cm", "mm"])
def test_written_trials_are_read_back(tmp_path: Path, layout: Any, unit: Any) -> None:
    trial = simulate_trial(proximal="moving", gaps=3, sign_flips=True, frames=120, inversion=60, seed=2)
    if layout == "row-tagged" and unit != "m":
        with pytest.raises(UsageError, match="meters"):
            save_simulation(trial, tmp_path / "t.csv", layout=layout, length_unit=unit)
        return
    export, truth = save_simulation(trial, tmp_path / "t.csv", layout=layout, length_unit=unit)
    assert truth == tmp_path / "t.truth.json"
    assert json.loads(truth.read_text())["settings"]["seed"] == 2
    recording = read_recording(export)
    for ours, theirs in zip(trial.recording.bodies, recording.bodies, strict=True):
        assert ours.name == theirs.name
        assert (ours.tracked == theirs.tracked).all()
        known = ours.tracked
        same = theirs.dual_quat_lab_body[known] * np.sign(
            np.sum(theirs.dual_quat_lab_body * ours.dual_quat_lab_body, axis=1)[known, None]
        )
        assert same == pytest.approx(ours.dual_quat_lab_body[known], abs=3e-6)
        assert theirs.marker_offsets == pytest.approx(ours.marker_offsets, abs=3e-6)
    assert recording.rate_hz == pytest.approx(100.0)


def test_the_seed_decides() -> None:
    one, same, other = (simulate_trial(seed=seed) for seed in (1, 1, 2))
    first = one.recording.bodies[1].dual_quat_lab_body
    assert (first == same.recording.bodies[1].dual_quat_lab_body).all()
    assert not np.allclose(first, other.recording.bodies[1].dual_quat_lab_body)


def test_the_noise_is_as_large_as_asked() -> None:
    trial = simulate_trial(marker_noise_mm=0.5, frames=2000, inversion=900, seed=3)
    clean = simulate_trial(marker_noise_mm=0.0, frames=2000, inversion=900, seed=3)
    noise = trial.markers["Forearm"] - clean.markers["Forearm"]
    assert 1000 * noise.std() == pytest.approx(0.5, rel=0.02)
    assert np.abs(1000 * noise.mean(axis=(0, 1))).max() < 0.02


def test_rests_come_before_and_after() -> None:
    trial = simulate_trial(marker_noise_mm=0.0, rest_before_s=0.5, rest_after_s=0.25, repetitions=2)
    theta = np.array(trial.truth["theta_deg"])
    assert theta.size == Simulation(rest_before_s=0.5, rest_after_s=0.25, repetitions=2).total_frames == 974
    assert (theta[:50] == 0).all()
    assert (theta[-25:] == 0).all()
    assert theta[trial.truth["inversion_frames"]] == pytest.approx([130, 130])


@pytest.mark.parametrize(
    "settings",
    [{"frames": 2}, {"inversion": 449}, {"inversion": 0}, {"top_deg": 0.0}, {"top_deg": float("nan")},
     {"rate_hz": 0.0}, {"marker_noise_mm": -1.0}, {"gaps": 100}, {"seed": -1}, {"rest_after_s": -1.0}],
)  # fmt: skip
def test_impossible_trials_are_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="--"):
        simulate_trial(**settings)


def test_existing_files_are_kept(tmp_path: Path) -> None:
    trial = simulate_trial(frames=20, inversion=10)
    (tmp_path / "t.truth.json").write_text("mine")
    with pytest.raises(OutputError, match="--force"):
        save_simulation(trial, tmp_path / "t.csv")
    assert not (tmp_path / "t.csv").exists()
    assert (tmp_path / "t.truth.json").read_text() == "mine"
