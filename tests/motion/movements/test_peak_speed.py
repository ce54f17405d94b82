"""Highest speeds by local fits, against laws whose highest speed is known, and what is told where the filter errs."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, analyze, simulate_trial
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.peak_speed import peak_speed

LAWS = {
    "minimum jerk": (lambda u: 10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5, 1.875),
    "constant": (lambda u: u, 1.0),
    "harmonic": (lambda u: 0.5 - 0.5 * np.cos(np.pi * u), 0.5 * np.pi),
    "cycloidal": (lambda u: u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi), 2.0),
}


def strokes(law: str, frames: int) -> tuple[Float, int, int]:
    """Out and back twice, with rests beside, and the first stroke's rows."""
    out = LAWS[law][0](np.arange(frames + 1) / frames)
    once, rest = np.concatenate([out, out[-2::-1]]), max(3, frames // 5)
    return np.concatenate([np.zeros(rest), once, once[1:], np.zeros(rest)]), rest, rest + frames


@pytest.mark.parametrize("law", list(LAWS))
@pytest.mark.parametrize(("frames", "rate_hz"), [(150, 100.0), (30, 200.0), (30, 50.0), (600, 400.0)])
@pytest.mark.parametrize("noise", [0.0003, 0.003])
def test_a_highest_speed_is_unbiased_and_within_its_sd(law: str, frames: int, rate_hz: float, noise: float) -> None:
    angle, first, last = strokes(law, frames)
    truth = LAWS[law][1] * rate_hz / frames
    random = np.random.default_rng(3)
    found = []
    for _ in range(40):
        rotation = np.zeros((angle.size, 3))
        rotation[:, 0] = angle + random.normal(0.0, noise, angle.size)
        one = peak_speed(rotation, first, last, 1.0 / rate_hz, noise)
        assert one is not None
        found.append((one.speed / truth - 1.0, one.sd / truth))
    error, sd = np.transpose(found)
    assert abs(error.mean()) < 0.02
    assert np.mean(np.abs(error) < 1.96 * sd) >= 0.8
    assert np.median(sd) < 0.05


def told(analysis: Analysis) -> list[str]:
    return [warning.message for warning in analysis.warnings if warning.code == "speeds-off"]


def test_a_filter_that_overshoots_is_told_with_the_speed_by_local_fits() -> None:
    # 85 deg out and back four times at 500 deg/s: the two passes overshoot where the stroke turns.
    angle = np.concatenate([85.0 * (1.0 - np.abs(np.linspace(-1.0, 1.0, 19)))[:-1]] * 4 + [np.zeros(1)])
    pose = dual_quat_from_screw(np.radians(angle), 0.0 * angle, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(angle.size, dtype=np.uint8))
    found = analyze(Recording.from_bodies([body], rate_hz=50.0))
    truth = 85.0 / 9.0 * 50.0
    assert np.degrees(np.nanmax(found.repetitions.outward_speed)) > 1.04 * truth
    (message,) = told(found)
    by_fits = float(message.split("by the filter, ")[1].split()[0])
    assert by_fits == pytest.approx(truth, rel=0.02)


@pytest.mark.parametrize("noise_mm", [0.05, 0.5, 2.0])
def test_nothing_is_told_of_speeds_that_are_right(noise_mm: float) -> None:
    for seed in range(3):
        trial = simulate_trial(
            joint_type="hinge", marker_noise_mm=noise_mm, seed=seed, repetitions=2, frames=200, inversion=90
        )
        assert not told(analyze(trial.recording))
