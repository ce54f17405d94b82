"""Low-pass filter of poses: its laws, SciPy's filter as an oracle, and the noise it leaves."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from poses import random_poses
from scipy import signal, special

from elbowscrew import Recording, simulate_trial
from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.difference import angle_between, origin_distance, points_from_radius, rms_displacement
from elbowscrew.motion.smoothing.filtering import (
    FEWEST_FRAMES,
    automatic_cutoff,
    lowpass_poses,
    noise_gain,
)
from elbowscrew.motion.tracking.clock import elapsed_time

RATE = 100.0
DIRECTION = np.array([0.6, 0.0, 0.8])
MOMENT = np.cross([0.1, 0.2, -0.3], DIRECTION)


def clock(count: int, rate_hz: float = RATE) -> Float:
    return np.arange(count) / rate_hz


def lively(count: int, seed: int = 0) -> Float:
    """A motion over large angles with noise that is not small."""
    rng = np.random.default_rng(seed)
    time_s = clock(count)[:, None]
    slow = np.sin(2 * np.pi * time_s * [0.4, 0.7, 0.3] + [0.1, 2.0, 4.0]) * [1.0, 0.6, 0.4]
    place = np.cos(2 * np.pi * time_s * [0.5, 0.2, 0.6]) * 0.2 + [0.3, 1.2, -0.4]
    quat = qn.quat_from_rotation_vector(slow + 0.02 * rng.normal(size=slow.shape))
    return dq.dual_quat_from_pose(quat, place + 0.005 * rng.normal(size=place.shape))


def filtered(poses: Float, cutoff_hz: float = 6.0, rate_hz: float = RATE) -> Float:
    return lowpass_poses(poses, clock(len(poses), rate_hz), rate_hz, cutoff_hz)


def largest_difference(a: Float, b: Float) -> float:
    """Of angle (rad) and place (m) together."""
    return float(max(angle_between(a, b).max(), origin_distance(a, b).max()))


def two_pass_gain(frequency_hz: Any, cutoff_hz: float, rate_hz: float = RATE) -> Float:
    """Of the filter as wanted: ``1/sqrt(2)`` at the cut-off, maximally flat, of order 2 x 2, bilinear."""
    ratio = np.tan(np.pi * np.asarray(frequency_hz) / rate_hz) / np.tan(np.pi * cutoff_hz / rate_hz)
    return np.asarray(1.0 / (1.0 + (np.sqrt(2.0) - 1.0) * ratio**4))


@pytest.mark.parametrize("cutoff_hz", [2.0, 6.0, 25.0, 40.0])
@pytest.mark.parametrize("share", [0.5, 1.0, 1.2])
def test_a_small_swing_shrinks_by_the_gain_and_does_not_lag(cutoff_hz: float, share: float) -> None:
    frequency_hz = cutoff_hz * share
    # From one passage through the middle to another, so that the run's continuation is the swing itself.
    swing = 1e-4 * np.sin(2 * np.pi * frequency_hz * clock(1001))
    result = filtered(dual_quat_from_screw(swing, 0.0, DIRECTION, MOMENT), cutoff_hz)
    gain = float(two_pass_gain(frequency_hz, cutoff_hz))
    if share == 1.0:
        assert gain == pytest.approx(1.0 / np.sqrt(2.0), rel=1e-12)
    # The gain of an angle of 1e-4 is that of its half's sine, off by its square.
    assert 2.0 * result[:, 1:4] @ DIRECTION == pytest.approx(gain * swing, abs=1e-12)


@pytest.mark.parametrize("rate_hz", [30.0, 100.0, 1000.0])
def test_small_motion_is_filtered_as_scipy_filters_its_components(rate_hz: float) -> None:
    rng = np.random.default_rng(3)
    small = 1e-5 * np.cumsum(rng.normal(size=(600, 6)), axis=0) / np.sqrt(600)
    quat = qn.quat_from_rotation_vector(small[:, :3])
    result = filtered(dq.dual_quat_from_pose(quat, small[:, 3:]), 6.0, rate_hz)
    # Designed where the tangents of the frequencies have the ratio (Winter's 0.802) that takes two passes to -3 dB.
    ratio = (2.0**0.5 - 1.0) ** 0.25
    designed = np.arctan(np.tan(np.pi * 6.0 / rate_hz) / ratio) * rate_hz / np.pi
    b, a = signal.butter(2, designed, fs=rate_hz)
    expected = signal.filtfilt(b, a, small, axis=0, padlen=599)
    quat, place = dq.pose_from_dual_quat(result)
    found = np.concatenate([2.0 * quat[:, 1:], place], axis=1)
    assert np.abs(found - expected).max() < 2e-5 * np.abs(small).max()


@pytest.mark.parametrize("cutoff_hz", [0.05, 1.0, 6.0, 20.0, 40.0, 45.0, 49.9])
@pytest.mark.parametrize("count", [FEWEST_FRAMES, 7, 30, 450])
def test_a_screw_motion_at_constant_speed_passes_unchanged(cutoff_hz: float, count: int) -> None:
    time_s = clock(count)
    base = random_poses((), 4)
    for turn, slide in ((0.0, 0.0), (0.0, 0.5), (9.0, 0.0), (9.0, 0.5), (-40.0, 0.1)):
        pose = dq.multiply(base, dual_quat_from_screw(turn * time_s, slide * time_s, DIRECTION, MOMENT))
        # Far below the turn's own frequency the filter passes a ten-thousandth of it, and of its digits.
        bound = 1e-11 if cutoff_hz >= 1.0 else 1e-6
        assert largest_difference(filtered(pose, cutoff_hz), pose) < bound


def test_a_body_at_rest_stays_where_it_is() -> None:
    pose = np.repeat(random_poses((1,), 5), 100, axis=0)
    assert np.abs(filtered(pose) - pose).max() < 1e-14


@pytest.mark.parametrize("frequency_hz", [0.25, 0.5, 1.0])
def test_slow_motion_without_noise_is_kept_within_what_the_gain_takes(frequency_hz: float) -> None:
    amplitude, cutoff_hz = np.radians(65.0), 6.0
    swing = amplitude * np.sin(2 * np.pi * frequency_hz * clock(801))
    pose = dual_quat_from_screw(swing, 0.0, DIRECTION, MOMENT)
    # exp(i a/2 sin wt) is the sum of J_n(a/2) exp(i n w t) (Jacobi and Anger); each loses 1 - gain(n w).
    order = np.arange(1, 41)
    loss = 2.0 * np.abs(special.jv(order, amplitude / 2.0)) @ (1.0 - two_pass_gain(order * frequency_hz, cutoff_hz))
    error = angle_between(filtered(pose, cutoff_hz), pose)
    assert error.max() <= 2.0 * np.arcsin(loss) + 1e-12
    assert error.max() > 0.2 * loss


def test_time_has_no_direction() -> None:
    pose = lively(400)
    assert largest_difference(filtered(pose[::-1])[::-1], filtered(pose)) < 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_constant_poses_on_either_side_pass_through_the_filter(seed: int) -> None:
    left, right = random_poses((2,), seed)
    pose = lively(300, seed)
    moved = dq.multiply(dq.multiply(left, pose), right)
    expected = dq.multiply(dq.multiply(left, filtered(pose)), right)
    assert np.abs(filtered(moved) - expected).max() < 1e-12


def test_a_body_far_from_the_origin_loses_only_the_digits_of_its_place() -> None:
    pose = lively(300)
    far = dq.dual_quat_from_pose(random_poses(())[:4], [4e3, -3e3, 5e3])
    moved = dq.multiply(far, pose)
    assert np.abs(dq.multiply(dq.conjugate(far), filtered(moved, 1.0)) - filtered(pose, 1.0)).max() < 1e-11


def test_signs_in_the_file_do_not_matter() -> None:
    pose = lively(300)
    pose[100:103] = np.nan
    signs = np.where(np.random.default_rng(1).random(300) < 0.5, -1.0, 1.0)
    signs[0] = 1.0
    result = filtered(pose)
    assert np.array_equal(filtered(pose * signs[:, None]), result, equal_nan=True)
    assert np.array_equal(filtered(-pose), -result, equal_nan=True)
    known = result[np.isfinite(result[:, 0])]
    assert (np.sum(known[1:, :4] * known[:-1, :4], axis=1) > 0.0).all()


def test_results_are_unit_dual_quaternions() -> None:
    result = filtered(lively(300))
    assert np.sum(result[:, :4] ** 2, axis=1) == pytest.approx(np.ones(300), abs=1e-14)
    assert np.abs(np.sum(result[:, :4] * result[:, 4:], axis=1)).max() < 1e-14


def test_the_ends_of_a_run_stay_as_they_are() -> None:
    pose = lively(300)
    assert largest_difference(filtered(pose)[[0, -1]], pose[[0, -1]]) < 1e-13


def test_gaps_stay_gaps_and_let_nothing_through() -> None:
    pose = lively(300)
    pose[120:125] = np.nan
    pose[200, 3] = np.nan
    other = pose.copy()
    other[:120] = lively(120, seed=7)
    one, two = filtered(pose), filtered(other)
    lost = np.isnan(one).all(axis=1)
    assert np.flatnonzero(lost).tolist() == [120, 121, 122, 123, 124, 200]
    assert np.isfinite(one[~lost]).all()
    assert np.array_equal(np.abs(one[125:]), np.abs(two[125:]), equal_nan=True)
    assert np.array_equal(one[:120], filtered(pose[:120]))


def test_a_run_ends_where_frames_are_missing_and_where_the_motion_leaps() -> None:
    pose = lively(300)
    halves = np.concatenate([filtered(pose[:140]), filtered(pose[140:])])
    elapsed = clock(300)
    elapsed[140:] += 0.6 / RATE
    assert largest_difference(lowpass_poses(pose, elapsed, RATE, 6.0), halves) < 1e-15
    broken = lowpass_poses(pose, clock(300), RATE, 6.0, broken_rows=np.array([140]))
    assert largest_difference(broken, halves) < 1e-15
    elapsed[140:] -= 0.2 / RATE
    assert np.array_equal(lowpass_poses(pose, elapsed, RATE, 6.0), filtered(pose))
    assert largest_difference(halves, filtered(pose)) > 1e-3


def test_short_runs_are_as_they_were() -> None:
    pose = lively(40)
    pose[[5, 12, 13]] = np.nan
    result = filtered(pose)
    rows = np.array([*range(6, 12), *range(14, 40)])
    assert np.array_equal(result[:5], pose[:5])
    assert (np.abs(result[rows] - pose[rows]).max(axis=1) > 0.0).sum() >= 26
    for count in range(FEWEST_FRAMES):
        assert np.array_equal(filtered(pose[:count]), pose[:count])


@pytest.mark.parametrize(
    ("rate_hz", "cutoff_hz"), [(100.0, 1.0), (100.0, 6.0), (120.0, 10.0), (30.0, 12.0), (1e3, 6.0)]
)
def test_noise_gain_is_the_impulse_responses_square(rate_hz: float, cutoff_hz: float) -> None:
    response = impulse_response(rate_hz, cutoff_hz)
    assert noise_gain(rate_hz, cutoff_hz) == pytest.approx(np.sum(response**2), rel=1e-9)


def impulse_response(rate_hz: float, cutoff_hz: float) -> Float:
    """Of the gain as wanted, by its inverse Fourier transform over more frames than the filter remembers."""
    frequency = np.fft.rfftfreq(2**15)
    frequency[-1] -= 1e-12
    response: Float = np.fft.irfft(two_pass_gain(frequency * rate_hz, cutoff_hz, rate_hz))
    return response


@pytest.mark.parametrize("cutoff_hz", [3.0, 6.0, 20.0])
@pytest.mark.parametrize("moving", [False, True])
def test_white_noise_shrinks_by_the_noise_gain(cutoff_hz: float, moving: bool) -> None:
    count, size = 20_000, np.array([1e-4] * 3 + [2e-5] * 3)
    noise = size * np.random.default_rng(11).normal(size=(count, 6))
    turn = np.radians(60.0) * np.sin(2 * np.pi * 0.2 * clock(count)) if moving else np.zeros(count)
    still = dq.multiply(random_poses((), 2), dual_quat_from_screw(turn, 0.1 * turn, DIRECTION, MOMENT))
    clean, noisy = (filtered(pose, cutoff_hz) for pose in (still, dq.multiply(still, dq.exp(noise))))
    left = dq.log(dq.canonical(dq.multiply(dq.conjugate(clean), noisy)))[500:-500] / size
    # The variance of a mean of squares of noise with this correlation, over six components.
    response = impulse_response(RATE, cutoff_hz)
    spectrum = np.abs(np.fft.rfft(response)) ** 2
    correlation = np.fft.irfft(spectrum) / np.sum(response**2)
    deviation = np.sqrt(2.0 * np.sum(correlation**2) / left.size)
    assert np.mean(left**2) / noise_gain(RATE, cutoff_hz) == pytest.approx(1.0, abs=4.0 * deviation)
    assert deviation < 0.02


@pytest.mark.parametrize("cutoff_hz", [0.0, -1.0, 50.0, 49.999, 60.0, 1e-3, float("nan"), float("inf")])
def test_a_cutoff_that_the_rate_does_not_allow_is_refused(cutoff_hz: float) -> None:
    with pytest.raises(SettingError, match=r"--lowpass .*expected a cut-off from 0.01 to 49.99 Hz"):
        filtered(lively(20), cutoff_hz)
    with pytest.raises(SettingError, match="--lowpass"):
        noise_gain(RATE, cutoff_hz)


def simulated(body: int = 1, **settings: Any) -> tuple[Recording, Float, Float]:
    """Recording, measured and true poses of one of its bodies."""
    noisy, clean = simulate_trial(**settings), simulate_trial(**{**settings, "marker_noise_mm": 0.0})
    poses = [trial.recording.bodies[body].dual_quat_lab_body for trial in (noisy, clean)]
    return noisy.recording, poses[0], poses[1]


def rms_error(poses: Float, truth: Float) -> float:
    return float(np.sqrt(np.mean(rms_displacement(poses, truth, points_from_radius(0.05)) ** 2)))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "settings",
    [{"proximal": "moving"}, {"rate_hz": 240.0, "frames": 1081, "inversion": 500}, {"frames": 200, "inversion": 90}],
)
def test_the_automatic_cutoff_takes_most_of_the_noise_away(settings: dict[str, Any], seed: int) -> None:
    recording, measured, truth = simulated(**settings, seed=seed)
    elapsed, rate_hz = elapsed_time(recording), recording.rate_hz
    cutoff_hz = automatic_cutoff(measured, elapsed, rate_hz, 0.05)
    assert 1.5 < cutoff_hz < 6.0
    errors = [rms_error(lowpass_poses(measured, elapsed, rate_hz, hz), truth) for hz in np.geomspace(1.0, 20.0, 40)]
    found = rms_error(lowpass_poses(measured, elapsed, rate_hz, cutoff_hz), truth)
    assert found < 0.5 * rms_error(measured, truth)
    assert found < 1.4 * min(errors)


def test_the_automatic_cutoff_does_not_depend_on_frames_signs_or_size() -> None:
    recording, measured, _ = simulated(seed=1)
    elapsed = elapsed_time(recording)
    found = automatic_cutoff(measured, elapsed, RATE, 0.05)
    signs = np.where(np.random.default_rng(0).random(450) < 0.5, -1.0, 1.0)[:, None]
    assert automatic_cutoff(dq.multiply(random_poses((), 1), measured * signs), elapsed, RATE, 0.05) == pytest.approx(
        found, rel=1e-9
    )


def test_more_noise_asks_for_a_lower_cutoff() -> None:
    found = []
    for noise in (0.02, 0.2, 2.0):
        recording, measured, _ = simulated(marker_noise_mm=noise, seed=2)
        found.append(automatic_cutoff(measured, elapsed_time(recording), RATE, 0.05))
    assert all(less > 1.2 * more for less, more in itertools.pairwise(found))


def test_poses_without_noise_are_filtered_as_little_as_possible() -> None:
    recording, _, truth = simulated()
    assert automatic_cutoff(truth, elapsed_time(recording), RATE, 0.05) == 0.4 * RATE
    still = np.repeat(random_poses((1,), 5), 200, axis=0)
    assert automatic_cutoff(still, clock(200), RATE, 0.05) == 0.4 * RATE


@pytest.mark.parametrize("seed", range(4))
def test_a_body_at_rest_is_filtered_strongly(seed: int) -> None:
    noise = np.random.default_rng(seed).normal(scale=1e-4, size=(1000, 6))
    pose = dq.multiply(random_poses((), seed), dq.exp(noise))
    assert 1.0 <= automatic_cutoff(pose, clock(1000), RATE, 0.05) < 5.0


def test_the_automatic_cutoff_looks_at_whole_seconds_only() -> None:
    recording, measured, _ = simulated(seed=1)
    elapsed = elapsed_time(recording)
    cut = measured.copy()
    cut[[230, 250, 270]] = np.nan
    # Two runs are long enough: the cut-off is that of both, and what the short ones hold does not matter.
    found = automatic_cutoff(cut, elapsed, RATE, 0.05)
    other = cut.copy()
    other[231:250] = lively(19)
    assert automatic_cutoff(other, elapsed, RATE, 0.05) == pytest.approx(found, rel=1e-12)
    cut[::90] = np.nan
    with pytest.raises(SettingError, match=r"--lowpass auto: expected 100 frames without a gap.* found 89 at 100"):
        automatic_cutoff(cut, elapsed, RATE, 0.05)
    with pytest.raises(SettingError, match="--lowpass auto"):
        automatic_cutoff(measured[:99], elapsed[:99], RATE, 0.05)
    with pytest.raises(SettingError, match="over 5 frames per second"):
        automatic_cutoff(measured, clock(450, 4.0), 4.0, 0.05)
