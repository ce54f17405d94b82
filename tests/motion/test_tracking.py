"""Lost tracking and short gaps."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from poses import random_poses

from elbowscrew import Recording, RigidBody, Settings, analyze
from elbowscrew.errors import AnalysisError, RecordingError
from elbowscrew.geometry import dual_quat_from_screw, sclerp
from elbowscrew.model import TrackingLoss
from elbowscrew.motion.clock import elapsed_time
from elbowscrew.motion.gaps import fill_gaps
from elbowscrew.motion.tracking import check_tracking

Float = NDArray[np.float64]


def body(pose: Float) -> RigidBody:
    return RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(len(pose), dtype=np.uint8))


def test_repeated_poses_are_lost_but_the_first() -> None:
    pose = random_poses((10,), 1)
    pose[4] = pose[3]
    pose[5] = -pose[3]
    checked, warnings = check_tracking(body(pose), keep_frozen=False)
    assert np.flatnonzero(checked.loss == TrackingLoss.FROZEN).tolist() == [4, 5]
    assert np.isnan(checked.dual_quat_lab_body[4:6]).all()
    assert [warning.code for warning in warnings] == ["frozen"]
    kept, none = check_tracking(body(pose), keep_frozen=True)
    assert kept.tracked.all()
    assert none == ()


def test_a_pose_that_comes_back_after_a_gap_is_no_repetition() -> None:
    pose = random_poses((6,), 2)
    pose[4] = pose[2]
    pose[3] = np.nan
    lost = body(pose)
    lost.loss[3] = TrackingLoss.BLANK
    assert check_tracking(lost, keep_frozen=False)[0].tracked.sum() == 5


def test_a_body_that_never_moves_is_a_fixed_reference() -> None:
    pose = np.repeat(random_poses((1,), 3), 8, axis=0)
    pose[3] *= -1.0
    checked, warnings = check_tracking(body(pose), keep_frozen=False)
    assert checked.tracked.all()
    assert [warning.code for warning in warnings] == ["fixed-body"]


def test_a_body_that_was_never_solved_is_not_tracked() -> None:
    pose = np.tile([1.0, 0, 0, 0, 0, 0, 0, 0], (8, 1))
    checked, warnings = check_tracking(body(pose), keep_frozen=False)
    assert not checked.tracked.any()
    assert [warning.code for warning in warnings] == ["never-solved"]


def test_a_quaternion_of_zeros_is_no_pose() -> None:
    quat = np.array([[1.0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 2.0]])
    rigid = RigidBody.from_quaternions("b", quat, np.zeros((3, 3)))
    assert rigid.loss.tolist() == [TrackingLoss.NONE, TrackingLoss.ZERO, TrackingLoss.NONE]


def series(count: int = 40) -> Float:
    angle = np.linspace(0.0, 2.0, count)
    return dual_quat_from_screw(angle, 0.01 * angle, [0.0, 0.6, 0.8], [0.1, -0.08, 0.06])


def test_gaps_up_to_the_limit_are_filled_by_screw_interpolation() -> None:
    pose = series()
    lost = pose.copy()
    for first, last in ((5, 5), (10, 19), (25, 35)):
        lost[first : last + 1] = np.nan
    bridged, filled = fill_gaps(lost, np.arange(40) / 100.0, 100.0, 0.1)
    assert np.flatnonzero(filled).tolist() == [5, *range(10, 20)]
    # A uniform screw motion is what ScLERP is.
    assert bridged[filled] == pytest.approx(pose[filled], abs=1e-14)
    assert np.isnan(bridged[25:36]).all()
    assert bridged[10:20] == pytest.approx(sclerp(pose[9], pose[20], np.arange(1, 11) / 11.0))


def test_gaps_at_the_ends_and_a_limit_of_zero_fill_nothing() -> None:
    lost = series()
    lost[[0, 1, 20, 39]] = np.nan
    for limit, expected in ((0.1, [20]), (0.0, [])):
        assert np.flatnonzero(fill_gaps(lost, np.arange(40) / 100.0, 100.0, limit)[1]).tolist() == expected


def recording(frame: NDArray[np.int64], time_s: Float, rate_hz: float = 100.0) -> Recording:
    return Recording(bodies=(body(random_poses((len(frame),))),), frame=frame, time_s=time_s, rate_hz=rate_hz)


def test_the_clock_counts_frames_where_times_are_rounded() -> None:
    frame = np.arange(868362, 868402)
    rounded = np.round(np.arange(40) / 120.0, 3)
    assert elapsed_time(recording(frame, rounded, 120.0)) == pytest.approx(np.arange(40) / 120.0, abs=1e-15)


def test_the_clock_is_the_time_where_frame_numbers_repeat() -> None:
    frame, time_s = np.array([0, 1, 1, 2, 5]), np.array([10.0, 10.01, 10.02, 10.03, 10.05])
    assert elapsed_time(recording(frame, time_s)) == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.05])


def test_a_clock_that_runs_backwards_is_refused() -> None:
    with pytest.raises(RecordingError, match="frame 3"):
        elapsed_time(recording(np.array([0, 1, 1, 3]), np.array([0.0, 0.01, 0.02, 0.015])))


def test_too_little_tracking_cannot_be_analyzed() -> None:
    pose = series()
    pose[10:35] = np.nan
    lost = body(pose)
    lost.loss[10:35] = TrackingLoss.BLANK
    taken = Recording.from_bodies([lost], rate_hz=100)
    with pytest.raises(AnalysisError, match=r"37\.5 % of 40 frames \(25 blank\)"):
        analyze(taken)
    assert analyze(taken, Settings(min_tracked_percent=30)).screw.valid.sum() == 15
    pose[:] = np.nan
    lost.loss[:] = TrackingLoss.BLANK
    with pytest.raises(AnalysisError, match=r"0\.0 %"):
        analyze(taken, Settings(min_tracked_percent=0))


def test_a_motion_without_rotation_cannot_be_analyzed() -> None:
    shift = np.zeros((30, 3))
    shift[:, 0] = np.linspace(0, 1, 30)
    still = RigidBody.from_quaternions("b", np.tile([1.0, 0, 0, 0], (30, 1)), shift)
    with pytest.raises(AnalysisError, match="no rotation"):
        analyze(Recording.from_bodies([still], rate_hz=100))
