"""How far what is filled in for lost frames may be off, against motions that are known in the gaps."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import TrackingLoss
from elbowscrew.motion.difference import angle_between
from elbowscrew.motion.smoothing.gaps import fill_gaps, filled_gaps

RATE = 100.0


def poses(angle_deg: Float) -> Float:
    return dual_quat_from_screw(np.radians(angle_deg), 0.0 * angle_deg, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])


def strokes(rng: np.random.Generator) -> Float:
    """Three strokes of 90 deg out and back by minimum jerk, with rests and holds of random lengths, degrees."""
    duration = int(rng.integers(30, 150))
    out = np.arange(1, duration + 1) / duration
    law = 90.0 * (10.0 * out**3 - 15.0 * out**4 + 6.0 * out**5)
    parts = [np.zeros(int(rng.integers(20, 60)))]
    for _ in range(3):
        parts += [law, np.full(int(rng.integers(0, 40)), 90.0), 90.0 - law, np.zeros(int(rng.integers(20, 60)))]
    return np.concatenate(parts)


@pytest.mark.parametrize("noise_deg", [0.0, 0.1, 0.5])
def test_no_fill_is_far_off_unless_that_is_told(noise_deg: float) -> None:
    rng = np.random.default_rng(5)
    errors, bounds, noises = [], [], []
    for _ in range(200):
        truth = strokes(rng)
        elapsed = np.arange(truth.size) / RATE
        pose = poses(truth + rng.normal(0.0, noise_deg, truth.size))
        first = int(rng.integers(20, truth.size - 80))
        lost = slice(first, first + int(rng.integers(3, 60)))
        pose[lost] = np.nan
        bridged, filled = fill_gaps(pose, elapsed, RATE, 1.0)
        assert filled.sum() == lost.stop - lost.start
        found = filled_gaps(pose, filled, elapsed, RATE)
        assert (found.before.tolist(), found.after.tolist()) == ([lost.start - 1], [lost.stop])
        errors.append(angle_between(bridged[lost], poses(truth)[lost]).max())
        bounds.append(found.off[0])
        noises.append(np.radians(noise_deg) * found.noise[0])
    error, bound, noise = np.degrees([errors, bounds, noises])
    off = error > 1.0 + 3.0 * noise_deg
    assert off.sum() >= 40
    assert np.mean((bound + noise + 2.0 * noise_deg)[off] >= error[off]) >= 0.92
    assert (bound > np.maximum(1.0, 2.0 * noise))[error > 2.0 + 3.0 * noise_deg].all()
    assert np.median(bound[off] / error[off]) < 2.5


def test_a_screw_at_constant_speed_is_filled_rightly_and_nothing_is_told() -> None:
    pose = poses(np.arange(100.0))
    elapsed = np.arange(100) / RATE
    pose[40:60] = np.nan
    found = filled_gaps(pose, np.isnan(pose[:, 0]), elapsed, RATE)
    assert found.off == pytest.approx(0.0, abs=1e-9)


def told(angle: Float, lost: slice, max_gap_s: float) -> list[str]:
    pose, loss = poses(angle), np.zeros(angle.size, dtype=np.uint8)
    pose[lost], loss[lost] = np.nan, TrackingLoss.ABSENT
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=loss)
    analysis: Analysis = analyze(Recording.from_bodies([body], rate_hz=RATE), Settings(max_gap_s=max_gap_s))
    return [warning.message for warning in analysis.warnings if warning.code == "fill-doubtful"]


def test_a_top_that_is_filled_over_is_told_with_its_size() -> None:
    """Of strokes of 0.6 s the 0.25 s beside a top are lost, and what is put in is 31 deg too low."""
    angle = 45.0 * (1.0 - np.cos(2.0 * np.pi * np.arange(481) / 120.0))
    lost = slice(156, 205)
    (message,) = told(angle, lost, 0.6)
    size = float(message.split("up to ")[1].split()[0])
    assert 90.0 - angle[155] <= size <= 2.5 * (90.0 - angle[155])
    assert "frames 156 to 204" in message
    assert "and by over 1 deg in 1 of 1 filled gaps" in message
    assert not told(angle, lost, 0.1)  # nothing is filled
    slow = 45.0 * (1.0 - np.cos(2.0 * np.pi * np.arange(961) / 240.0))
    assert not told(slow, slice(118, 123), 0.6)  # nothing goes far within five frames
