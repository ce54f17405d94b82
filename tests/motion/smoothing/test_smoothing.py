"""Filter and resampling as the analysis uses them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from elbowscrew import Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.configuring import settings_from
from elbowscrew.errors import SettingError, UsageError
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.motion.screws.measurement import measure

TRIAL = simulate_trial(seed=9, proximal="moving", gaps=3, gap_frames=4, sign_flips=True)
TRUTH = np.radians(TRIAL.truth["theta_deg"])


def analyzed(**settings: Any) -> Any:
    return analyze(TRIAL.recording, Settings(marker_noise_mm=0.2, **settings))


@pytest.mark.parametrize("lowpass", [6.0, "auto"])
def test_a_filter_brings_the_angle_nearer_the_truth_and_says_how_near(lowpass: Any) -> None:
    raw, smooth = analyzed().screw, analyzed(lowpass_hz=lowpass).screw
    # The reference keeps its noise, which all frames share: what the filter changes is the rest.
    errors = [one.angle - TRUTH for one in (raw, smooth)]
    spread = [np.nanstd(error[raw.axis_known]) for error in errors]
    assert spread[1] < 0.6 * spread[0]
    assert np.nanmedian(smooth.angle_sd) < np.nanmedian(raw.angle_sd)
    assert (smooth.valid == raw.valid).all()
    assert (smooth.filled == raw.filled).all()


def test_intervals_hold_after_a_filter() -> None:
    inside = []
    for seed in range(30):
        trial = simulate_trial(seed=seed, proximal="moving")
        screw = measure(trial.recording, Settings(marker_noise_mm=0.2, lowpass_hz=8.0)).screw  # that of `analyze`
        error = screw.angle - np.radians(trial.truth["theta_deg"])
        inside.append(np.abs(error[100:350:50]) <= 1.96 * screw.angle_sd[100:350:50])
    # All frames of a trial share its reference, so that a trial counts hardly more than once.
    assert np.mean(inside) == pytest.approx(0.95, abs=4.0 * np.sqrt(0.95 * 0.05 / 30))


def test_frames_beside_a_gap_keep_their_noise() -> None:
    trial = simulate_trial(seed=3, gaps=1, gap_frames=40)
    screw = analyze(trial.recording, Settings(marker_noise_mm=0.2, lowpass_hz=4.0)).screw
    lost = np.flatnonzero(~screw.valid)
    assert lost.size == 40
    for beside, away in ((lost[0] - 1, lost[0] - 30), (lost[-1] + 1, lost[-1] + 30)):
        # Noise of the reference and of the frame against that of the reference and 8 % of the frame's.
        assert screw.angle_sd[beside] == pytest.approx(np.sqrt(2.0 / 1.08) * screw.angle_sd[away], rel=0.03)


@pytest.mark.parametrize(
    ("given", "severity"), [({}, "note"), ({"reference": 20}, "warning"), ({"keyframes": (10, 100, 200)}, "warning")]
)
def test_frames_that_are_given_beside_another_rate_are_told_to_be_of_that(given: dict[str, Any], severity: str) -> None:
    found = {warning.code: warning for warning in analyzed(resample_hz=50, **given).warnings}
    assert found["resampled"].severity == severity
    assert all(f"--{name}" in found["resampled"].message for name in given)


def test_a_resampled_trial_counts_its_frames_anew() -> None:
    full, half = analyzed(lowpass_hz=6.0), analyzed(lowpass_hz=6.0, resample_hz=50)
    assert half.screw.frame.tolist() == list(range(225))
    assert half.recording.rate_hz == 50
    both = half.screw.valid & full.screw.valid[::2]
    assert half.screw.angle[both] == pytest.approx(full.screw.angle[::2][both], abs=1e-12)
    codes = {warning.code: warning.severity for warning in half.warnings}
    assert codes["resampled"] == "note"
    assert "aliasing" not in codes
    assert "aliasing" in [warning.code for warning in analyzed(resample_hz=50).warnings]


def test_cut_offs_as_they_are_given() -> None:
    assert settings_from(options={"lowpass": "none"}).lowpass_hz is None
    assert settings_from(options={"lowpass": "auto"}).lowpass_hz == "auto"
    assert settings_from(options={"lowpass": "6"}).lowpass_hz == 6.0
    for wrong in ("fast", "-3", "0", "nan"):
        with pytest.raises(UsageError, match="lowpass"):
            settings_from(options={"lowpass": wrong})
    with pytest.raises(SettingError, match="lowpass_hz=80"):
        analyzed(lowpass_hz=80.0)
    with pytest.raises(SettingError, match=r"resample_hz=0\.01"):
        analyzed(resample_hz=0.01)


@pytest.mark.parametrize("rate_hz", [0.5, 8.0, 1e6])
def test_no_rate_is_too_low_or_too_high_for_the_instantaneous_axis(rate_hz: float) -> None:
    found = analyze(
        simulate_trial(frames=60, inversion=30, rate_hz=rate_hz).recording,
        Settings(max_turn_deg_s=1e12, max_speed_m_s=1e9),
    ).instantaneous
    assert found.lowpass_hz is not None
    assert 0.0 < found.lowpass_hz < 0.5 * rate_hz


def test_a_clock_of_two_rates_is_not_filtered() -> None:
    """A cut-off is one at one rate only."""
    with pytest.raises(SettingError, match="resample_hz"):
        analyze(two_rates(), Settings(lowpass_hz=3.0))
    assert analyze(two_rates()).screw.angle.size == two_rates().frame.size


def test_speeds_on_a_clock_of_two_rates() -> None:
    """None without the reason told; and on an even clock the true ones in either half."""
    uneven = analyze(two_rates(), Settings())
    assert not np.isfinite(uneven.instantaneous.angular_velocity).any()
    (message,) = [one.message for one in uneven.warnings if one.code == "no-instantaneous-axis"]
    assert "--resample HZ" in message
    for settings in (Settings(resample_hz=100.0), Settings(resample_hz=100.0, lowpass_hz=15.0)):
        even = analyze(two_rates(), settings)
        speed = np.degrees(even.instantaneous.angular_velocity)
        true = 94.25 * np.sin(2.0 * np.pi * even.elapsed / 3.0)
        inner = (even.elapsed > 0.4) & (even.elapsed < even.elapsed[-1] - 0.4)
        assert speed[inner] == pytest.approx(true[inner], abs=0.5)


@pytest.mark.parametrize("resample_hz", [50.0, 100.0, 150.0])
def test_a_filter_after_a_change_of_rate_has_one_cut_off(resample_hz: float) -> None:
    """At the cut-off its gain is the root of a half, on either side of the change of the recording's clock."""
    angle, free = (
        analyze(two_rates(ripple_deg=1.0), Settings(resample_hz=resample_hz, lowpass_hz=lowpass_hz)).screw.angle
        for lowpass_hz in (3.0, None)
    )
    smooth = analyze(two_rates(), Settings(resample_hz=resample_hz, lowpass_hz=3.0)).screw.angle
    plain = analyze(two_rates(), Settings(resample_hz=resample_hz)).screw.angle
    time = np.arange(angle.size) / resample_hz
    for begin, end in ((0.5, 2.5), (3.5, 5.5)):
        part = (time > begin) & (time < end)
        gain = np.std((angle - smooth)[part]) / np.std((free - plain)[part])
        assert gain == pytest.approx(np.sqrt(0.5), rel=0.02)


def two_rates(ripple_deg: float = 0.0) -> Recording:
    time = np.concatenate([np.arange(300) / 100.0, 3.0 + np.arange(150) / 50.0])
    angle = np.radians(45.0) * (1.0 - np.cos(2.0 * np.pi * time / 3.0))
    angle += np.radians(ripple_deg) * np.sin(2.0 * np.pi * 3.0 * time)
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.0, 1.0], [0.0, 0.1, 0.0])
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(time.size, dtype=np.uint8))
    recording = Recording.from_bodies([body], rate_hz=100)
    return replace(recording, time_s=time)


def test_a_fast_motion_keeps_its_speed() -> None:
    """Four strokes of 90 deg in 0.15 s each way: 15/8 of the mean speed at its highest, 1125 deg/s."""
    time = np.arange(600) / 200.0
    angle = np.zeros(time.size)
    for k in range(4):
        for turn, begin in ((90.0, 0.4 + 0.6 * k), (-90.0, 0.7 + 0.6 * k)):
            tau = np.clip((time - begin) / 0.15, 0.0, 1.0)
            angle += np.radians(turn) * tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2)
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.0, 1.0], [0.0, 0.1, 0.0])
    jitter = np.random.default_rng(0).normal(scale=5e-5, size=(time.size, 3))
    pose = dq.multiply(pose, dq.dual_quat_from_pose([1.0, 0.0, 0.0, 0.0], jitter))
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(time.size, dtype=np.uint8))
    found = analyze(Recording.from_bodies([body], rate_hz=200)).repetitions
    assert np.degrees(found.outward_speed) == pytest.approx(np.full(4, 1125.0), rel=0.03)
    assert np.degrees(found.back_speed) == pytest.approx(np.full(4, 1125.0), rel=0.03)
