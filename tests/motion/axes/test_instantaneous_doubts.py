"""What is told of instantaneous axes and speeds that are not, or not all, there."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.cli import main
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry.arrays import Float


def told(analysis: Analysis, code: str) -> list[str]:
    return [warning.message for warning in analysis.warnings if warning.code == code]


def jerky(jump_deg: float) -> Recording:
    """A slow hinge that is thrown to and fro within some hundredths of a second, five times."""
    time = np.arange(1200) / 100.0
    angle = 60.0 * np.sin(np.pi * time / 12.0) ** 2
    for at in (1.0, 3.0, 5.0, 7.0, 9.0):
        angle += jump_deg * np.exp(-0.5 * ((time - at) / 0.005) ** 2)
    angle += np.random.default_rng(2).normal(0.0, 0.02, time.size)
    pose = dual_quat_from_screw(np.radians(angle), 0.0 * angle, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])
    body = RigidBody(name="Forearm", dual_quat_lab_body=pose, loss=np.zeros(time.size, dtype=np.uint8))
    return Recording(bodies=(body,), frame=np.arange(time.size), time_s=time, rate_hz=100.0)


def test_what_the_filter_leaves_out_is_told() -> None:
    analysis = analyze(jerky(10.0), Settings(proximal="none", distal="Forearm"))
    (message,) = told(analysis, "fast-motion-left-out")
    assert f"up to {analysis.instantaneous.lowpass_hz:.3g} Hz" in message
    assert "--lowpass HZ" in message
    quiet = analyze(jerky(0.0), Settings(proximal="none", distal="Forearm"))
    assert not told(quiet, "fast-motion-left-out")


@pytest.mark.parametrize("resample_hz", [None, 120.0])
@pytest.mark.parametrize(("stroke_s", "left_out"), [(0.12, True), (0.8, False)])
def test_what_a_filter_that_was_given_leaves_out_is_told(
    stroke_s: float, resample_hz: float | None, left_out: bool
) -> None:
    """Through 6 Hz, strokes of 0.12 s are up to 6 deg too low and a fifth too slow, those of 0.8 s as they are."""
    frames = round(2.0 * stroke_s * 200.0)
    trial: dict[str, Any] = {"rate_hz": 200.0, "frames": frames, "inversion": frames // 2, "repetitions": 4}
    found = analyze(
        simulate_trial(joint_type="hinge", top_deg=90.0, law="polynomial-345", marker_noise_mm=0.05, **trial).recording,
        Settings(lowpass_hz=6.0, resample_hz=resample_hz),
    )
    assert bool(told(found, "fast-motion-left-out")) == left_out
    assert bool(told(found, "speeds-off")) == left_out


def fast_strokes(time: Float) -> Recording:
    """Four strokes of 90 deg out and back in 0.12 s each, by a harmonic law, from half a second on."""
    moving = np.clip(time - 0.5, 0.0, 0.96)
    angle = 45.0 * (1.0 - np.cos(2.0 * np.pi * moving / 0.24))
    angle += np.random.default_rng(4).normal(0.0, 0.02, time.size)
    pose = dual_quat_from_screw(np.radians(angle), 0.0 * angle, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(time.size, dtype=np.uint8))
    rate_hz = (time.size - 1) / float(time[-1])
    return Recording(bodies=(body,), frame=np.arange(time.size), time_s=time, rate_hz=rate_hz)


def test_no_rest_hides_what_a_filter_leaves_out() -> None:
    """A second of strokes and two of rest, or 100: what is left out of the movement is the same."""
    said = []
    for rest_s in (2.0, 100.0):
        time = np.arange(round((1.5 + rest_s) * 100.0)) / 100.0
        (message,) = told(analyze(fast_strokes(time), Settings(lowpass_hz=6.0)), "fast-motion-left-out")
        said.append(float(message.split("leaves out ")[1].split()[0]))
    assert said[0] > 2.0
    assert said[1] == pytest.approx(said[0], rel=0.1)


def test_what_a_filter_leaves_out_is_told_on_a_clock_of_two_rates() -> None:
    time = np.concatenate([np.arange(200) / 200.0, 1.0 + np.arange(200) / 100.0])
    found = analyze(fast_strokes(time), Settings(lowpass_hz=6.0, resample_hz=200.0))
    assert told(found, "fast-motion-left-out")
    assert not told(analyze(fast_strokes(time), Settings(lowpass_hz=40.0, resample_hz=200.0)), "fast-motion-left-out")


@pytest.mark.parametrize(
    "trial", [{}, {"marker_noise_mm": 0.5}, {"joint": "knee"}, {"repetitions": 3, "frames": 150, "inversion": 70}]
)
def test_noise_is_no_motion_that_is_left_out(trial: dict[str, Any]) -> None:
    assert not told(analyze(simulate_trial(**trial).recording), "fast-motion-left-out")


def test_why_no_frame_has_an_instantaneous_axis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    take, output = tmp_path / "take.csv", tmp_path / "out"
    assert main(["simulate", str(take)]) == 0
    capsys.readouterr()
    options = ("-o", str(output), "--min-rate", "12", "--figure-format", "none", "--no-report")
    assert main(["analyze", str(take), *options]) == 0
    lines = (output / "instantaneous.csv").read_text(encoding="utf-8").splitlines()
    assert all(line.endswith(",,,,,,") for line in lines[1:])
    summary = json.loads((output / "summary.json").read_text(encoding="utf-8"))
    (warning,) = (one for one in summary["warnings"] if one["code"] == "no-instantaneous-axis")
    assert "an axis needs 12 rad/s (--min-rate)" in warning["message"]
    assert warning["message"] in capsys.readouterr().err
    assert not told(analyze(simulate_trial().recording), "no-instantaneous-axis")
