"""Recordings on another clock."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from poses import random_poses
from scipy.spatial.transform import Rotation, Slerp

from elbowscrew import Recording, RigidBody, analyze, simulate_trial
from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Marker, TrackingLoss
from elbowscrew.motion.difference import angle_between, origin_distance
from elbowscrew.motion.smoothing.resampling import resample_recording
from elbowscrew.motion.tracking.clock import elapsed_time

DIRECTION = np.array([0.6, 0.0, 0.8])
MOMENT = np.cross([0.1, 0.2, -0.3], DIRECTION)
VELOCITY = np.array([1.0, -2.0, 0.5])


def body(pose: Float, **figures: Any) -> RigidBody:
    lost = ~np.isfinite(pose).all(axis=1)
    loss = np.where(lost, TrackingLoss.BLANK, TrackingLoss.NONE).astype(np.uint8)
    return RigidBody(name="b", dual_quat_lab_body=pose, loss=loss, **figures)


def steady(time_s: Float) -> Float:
    turn = dual_quat_from_screw(3.0 * time_s, 0.2 * time_s, DIRECTION, MOMENT)
    return dq.multiply(random_poses((), 3), turn)


def steady_take(count: int = 101, rate_hz: float = 100.0) -> Recording:
    return Recording.from_bodies([body(steady(np.arange(count) / rate_hz))], rate_hz=rate_hz)


def pose_of(recording: Recording) -> Float:
    return recording.bodies[0].dual_quat_lab_body


def loss_of(recording: Recording) -> list[int]:
    return [int(reason) for reason in recording.bodies[0].loss]


def largest_difference(a: Float, b: Float) -> float:
    return float(max(angle_between(a, b).max(), origin_distance(a, b).max()))


@pytest.mark.parametrize("rate_hz", [7.0, 33.3, 50.0, 99.9, 100.0, 120.0, 1000.0])
def test_a_steady_screw_motion_is_resampled_exactly(rate_hz: float) -> None:
    taken = replace(steady_take(), frame=np.arange(101) + 5000, time_s=50.0 + np.arange(101) / 100.0)
    result = resample_recording(taken, rate_hz)
    assert result.rate_hz == rate_hz
    assert result.frame.tolist() == list(range(int(np.floor(rate_hz + 1e-9)) + 1))
    assert result.frame.dtype == np.int64
    assert result.time_s == pytest.approx(50.0 + result.frame / rate_hz, abs=1e-12)
    assert result.bodies[0].tracked.all()
    assert largest_difference(pose_of(result), steady(result.frame / rate_hz)) < 1e-13
    assert elapsed_time(result) == pytest.approx(result.frame / rate_hz, abs=1e-12)


def test_between_frames_rotations_go_as_scipys_slerp() -> None:
    pose = random_poses((30,), 8)
    result = resample_recording(Recording.from_bodies([body(pose)], rate_hz=10.0), 37.0)
    slerp = Slerp(np.arange(30) / 10.0, Rotation.from_quat(pose[:, :4], scalar_first=True))
    expected = slerp(result.frame / 37.0)
    found = Rotation.from_quat(pose_of(result)[:, :4], scalar_first=True)
    assert (expected.inv() * found).magnitude().max() < 1e-7


def test_the_same_rate_gives_the_same_poses() -> None:
    taken = simulate_trial(gaps=3, sign_flips=True, seed=4).recording
    result = resample_recording(taken, taken.rate_hz)
    for ours, theirs in zip(result.bodies, taken.bodies, strict=True):
        assert np.array_equal(ours.dual_quat_lab_body, theirs.dual_quat_lab_body, equal_nan=True)
        assert np.array_equal(ours.loss, theirs.loss)
    assert np.array_equal(result.time_s, taken.time_s)
    assert [(warning.code, warning.severity) for warning in result.warnings] == [("resampled", "note")]


@pytest.mark.parametrize("rate_hz", [120.0, 99.7, 100.1])
@pytest.mark.parametrize("factor", [2, 3, 5])
def test_up_and_down_again_returns(factor: int, rate_hz: float) -> None:
    taken = simulate_trial(gaps=3, sign_flips=True, seed=4, rate_hz=rate_hz).recording
    there = resample_recording(taken, factor * taken.rate_hz)
    back = resample_recording(there, taken.rate_hz)
    assert there.frame.size == (taken.frame.size - 1) * factor + 1
    for ours, theirs in zip(back.bodies, taken.bodies, strict=True):
        assert np.array_equal(ours.loss, theirs.loss)
        known = theirs.tracked
        assert largest_difference(ours.dual_quat_lab_body[known], theirs.dual_quat_lab_body[known]) < 1e-12
        assert np.isnan(ours.dual_quat_lab_body[~known]).all()


def test_whole_fractions_of_the_rate_pick_frames() -> None:
    taken = simulate_trial(seed=5).recording
    result = resample_recording(taken, 25.0)
    assert np.array_equal(pose_of(result), pose_of(taken)[::4])


def test_nothing_is_interpolated_across_a_lost_frame() -> None:
    taken = steady_take(9, 10.0)
    pose = pose_of(taken).copy()
    pose[[3, 6, 7]] = np.nan
    one = replace(body(pose), loss=np.array([0, 0, 0, 4, 0, 0, 1, 6, 0], dtype=np.uint8))
    at_lost = replace(taken, bodies=(one,))
    result = resample_recording(at_lost, 40.0)
    # Frame 3 is lost, and all that lies strictly between its neighbors; so are 6 and 7, each with its nearer reason.
    frozen, blank, leap = TrackingLoss.FROZEN, TrackingLoss.BLANK, TrackingLoss.LEAP
    expected = [0] * 9 + [frozen] * 7 + [0] * 5 + [blank] * 5 + [leap] * 6 + [0]
    assert loss_of(result) == expected
    lost = np.array(expected) != 0
    assert np.isnan(pose_of(result)[lost]).all()
    assert largest_difference(pose_of(result)[~lost], steady(result.frame / 40.0)[~lost]) < 1e-14
    # Of the frames at 6.4 and 6.6, between two lost ones, each has its nearer one's reason.
    assert loss_of(resample_recording(at_lost, 50.0))[32:34] == [blank, leap]


def test_nothing_is_interpolated_across_frames_that_are_not_in_the_file() -> None:
    whole = steady_take(11, 10.0)
    rows = np.array([0, 1, 2, 3, 7, 8, 9, 10])
    marker = Marker(name="m", position=np.arange(33.0).reshape(11, 3)[rows])
    taken = replace(
        whole,
        bodies=(body(pose_of(whole)[rows], marker_residual=np.ones(8)),),
        frame=whole.frame[rows],
        time_s=whole.time_s[rows],
        markers=(marker,),
    )
    result = resample_recording(taken, 20.0)
    assert loss_of(result) == [0] * 7 + [TrackingLoss.ABSENT] * 7 + [0] * 7
    assert np.isnan(result.markers[0].position[7:14]).all()
    residual = result.bodies[0].marker_residual
    assert residual is not None
    assert np.isnan(residual).tolist() == [False] * 7 + [True] * 7 + [False] * 7
    assert largest_difference(pose_of(result)[14:], steady(result.frame / 20.0)[14:]) < 1e-14


def test_nothing_is_interpolated_across_a_leap() -> None:
    taken = steady_take(9, 10.0)
    pose = pose_of(taken).copy()
    pose[5:] = dq.multiply(pose[5:], [0.0, 1.0, 0, 0, 0, 0, 0, 0])
    one = body(pose, marker_residual=np.ones(9))
    result = resample_recording(replace(taken, bodies=(one,)), 30.0, broken_rows=np.array([5]))
    assert loss_of(result) == [0] * 13 + [TrackingLoss.LEAP] * 2 + [0] * 10
    assert np.isnan(pose_of(result)[13:15]).all()
    residual = result.bodies[0].marker_residual
    assert residual is not None
    assert np.flatnonzero(np.isnan(residual)).tolist() == [13, 14]


def test_markers_and_figures_go_linearly() -> None:
    time_s = np.arange(21) / 20.0
    line = time_s[:, None] * VELOCITY + 3.0
    line[10] = np.nan
    one = body(steady(time_s), marker_residual=1e-3 * time_s, reported_error=time_s + 1.0, shape_deviation=2.0 * time_s)
    taken = replace(Recording.from_bodies([one], rate_hz=20.0), markers=(Marker(name="m", position=line),))
    result = resample_recording(taken, 50.0)
    times = result.frame / 50.0
    found = result.bodies[0]
    assert found.marker_residual == pytest.approx(1e-3 * times, abs=1e-15)
    assert found.reported_error == pytest.approx(times + 1.0, abs=1e-14)
    assert found.shape_deviation == pytest.approx(2.0 * times, abs=1e-14)
    seen = np.isfinite(result.markers[0].position).all(axis=1)
    assert np.flatnonzero(~seen).tolist() == [23, 24, 25, 26, 27]
    assert result.markers[0].position[seen] == pytest.approx(times[seen, None] * VELOCITY + 3.0, abs=1e-14)


def test_a_body_that_stands_still_does_so_to_the_last_digit() -> None:
    pose = np.repeat(random_poses((1,), 3), 50, axis=0)
    pose[::3] *= -1.0
    result = pose_of(resample_recording(Recording.from_bodies([body(pose)], rate_hz=100.0), 133.0))
    assert np.array_equal(np.abs(result), np.repeat(np.abs(pose[:1]), len(result), axis=0))


def test_an_uneven_clock_becomes_an_even_one() -> None:
    time_s = 4.0 + np.sort(np.random.default_rng(2).uniform(0.0, 2.0, 200))
    repeated = np.repeat(np.arange(100), 2)
    taken = Recording(bodies=(body(steady(time_s - time_s[0])),), frame=repeated, time_s=time_s, rate_hz=10.0)
    result = resample_recording(taken, 60.0)
    assert np.diff(result.time_s) == pytest.approx(np.full(result.frame.size - 1, 1.0 / 60.0), abs=1e-12)
    assert time_s[-1] - result.time_s[-1] < 1.0 / 60.0
    assert largest_difference(pose_of(result), steady(result.frame / 60.0)) < 1e-13


def test_the_change_is_told() -> None:
    taken = steady_take()
    warnings = resample_recording(resample_recording(taken, 200.0), 40.0).warnings
    assert [(w.code, w.severity) for w in warnings] == [
        ("resampled", "note"),
        ("resampled", "note"),
        ("aliasing", "warning"),
    ]
    assert "from 100 to 200 frames per second" in warnings[0].message
    assert "count from 0" in warnings[0].message
    assert "above 20 Hz" in warnings[2].message
    assert "--lowpass" in warnings[2].message


@pytest.mark.parametrize("rate_hz", [0.0, -5.0, 0.9, 1e8, float("nan"), float("inf")])
def test_impossible_rates_are_refused(rate_hz: float) -> None:
    with pytest.raises(SettingError, match=r"--resample .*expected a rate above 0 that gives 2 to 10000000 frames"):
        resample_recording(steady_take(), rate_hz)


@pytest.mark.parametrize("count", [0, 1])
def test_a_recording_of_one_frame_has_no_rate(count: int) -> None:
    with pytest.raises(SettingError, match="--resample"):
        resample_recording(steady_take(count), 100.0)


def test_a_recording_without_a_clock_is_refused() -> None:
    taken = replace(steady_take(5), frame=np.zeros(5, dtype=np.int64), time_s=np.zeros(5))
    with pytest.raises(RecordingError):
        resample_recording(taken, 50.0)


def test_an_analysis_at_half_the_rate_finds_the_same_motion() -> None:
    taken = simulate_trial(frames=451, inversion=210, marker_noise_mm=0.0, proximal="moving").recording
    full, half = analyze(taken), analyze(resample_recording(taken, 50.0))
    assert half.screw.angle == pytest.approx(full.screw.angle[::2], abs=1e-12)
    assert half.keyframes.frame.tolist() == [0, 105, 225]
