"""Lost tracking and short gaps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from poses import random_poses

from elbowscrew import Recording, RigidBody, Settings, analyze
from elbowscrew.errors import AnalysisError, RecordingError
from elbowscrew.geometry import dual_quat_from_screw, sclerp
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import TrackingLoss
from elbowscrew.motion.screws.measurement import measure
from elbowscrew.motion.smoothing.gaps import fill_gaps
from elbowscrew.motion.tracking.body_pairs import turns_on_the_spot
from elbowscrew.motion.tracking.clock import elapsed_time
from elbowscrew.motion.tracking.losses import is_same_pose
from elbowscrew.motion.tracking.lost_poses import check_tracking
from elbowscrew.motion.tracking.quality import check_bodies, clock_quality, clock_warnings


def body(pose: Float, name: str = "b") -> RigidBody:
    lost = ~np.isfinite(pose).all(axis=1)
    return RigidBody(name=name, dual_quat_lab_body=pose, loss=np.where(lost, TrackingLoss.BLANK, 0).astype(np.uint8))


def checked(pose: Float, rate_hz: float = 100.0, **settings: Any) -> tuple[RigidBody, list[str]]:
    one = body(pose)
    taken = Recording.from_bodies([one], rate_hz=rate_hz)
    found = check_tracking(one, taken, elapsed_time(taken), Settings(**settings))
    return found.body, [warning.code for warning in found.warnings]


def test_repeated_poses_are_lost_but_the_first() -> None:
    pose = series(20)
    pose[4] = pose[3]
    pose[5] = -pose[3]
    found, codes = checked(pose)
    assert np.flatnonzero(found.loss == TrackingLoss.FROZEN).tolist() == [4, 5]
    assert np.isnan(found.dual_quat_lab_body[4:6]).all()
    assert codes == ["frozen"]
    kept, codes = checked(pose, frozen="keep")
    assert kept.tracked.all()
    assert codes == []


def test_a_pose_that_comes_back_after_a_gap_is_no_repetition() -> None:
    pose = series(40)
    pose[22] = pose[20]
    pose[21] = np.nan
    assert checked(pose)[0].tracked.sum() == 39


def test_a_body_that_never_moves_is_a_fixed_reference() -> None:
    pose = np.repeat(random_poses((1,), 3), 8, axis=0)
    pose[3] *= -1.0
    found, codes = checked(pose)
    assert found.tracked.all()
    assert codes == ["fixed-body"]


def test_a_body_that_was_never_solved_is_not_tracked() -> None:
    found, codes = checked(np.tile([1.0, 0, 0, 0, 0, 0, 0, 0], (8, 1)))
    assert not found.tracked.any()
    assert codes == ["never-solved"]


IDENTITY = np.array([1.0, 0, 0, 0, 0, 0, 0, 0])


@pytest.mark.parametrize("rows", [[0], [1], [20], [20, 21, 22], [39], [0, 39]])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("place", [None, [0.05, 0.0, 0.0]])
def test_an_identity_out_of_the_motion_is_not_tracked(rows: list[int], sign: float, place: Any) -> None:
    pose = dq.multiply(dq.dual_quat_from_pose([1.0, 0, 0, 0], [0.3, 1.0, 0.2]), series(40))
    pose = dq.multiply(pose, dual_quat_from_screw(0.3, 0.0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    pose[rows] = sign * (IDENTITY if place is None else dq.dual_quat_from_pose([1.0, 0, 0, 0], place))
    found, codes = checked(pose)
    assert np.flatnonzero(~found.tracked).tolist() == rows
    assert codes == ["identity-pose"]
    assert (found.loss[rows] == TrackingLoss.ZERO).all()


def test_an_identity_the_motion_passes_is_a_measurement() -> None:
    # A body that starts, turns and ends in its own reference frame, at the origin, as synthetic ones do.
    angle = 2.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 81))
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.6, 0.8], [0.1, -0.08, 0.06])
    pose[[0, 40, 80]] = IDENTITY
    assert checked(pose)[0].tracked.all()


def flipped(pose: Float, rows: slice) -> Float:
    """Turn the body by half a turn about its own x axis, as a symmetric marker set does."""
    out = pose.copy()
    out[rows] = dq.multiply(pose[rows], [0.0, 1.0, 0, 0, 0, 0, 0, 0])
    return out


@pytest.mark.parametrize("rows", [slice(30, 31), slice(30, 50), slice(0, 5), slice(195, 200)])
def test_flips_that_come_back_are_lost_and_the_rest_is_as_it_was(rows: slice) -> None:
    pose = series(200)
    found, codes = checked(flipped(pose, rows))
    assert np.flatnonzero(found.loss == TrackingLoss.LEAP).tolist() == list(range(200))[rows]
    assert codes == ["leap"]
    clean = analyze(Recording.from_bodies([body(pose)], rate_hz=100), Settings(reference=20))
    other = analyze(Recording.from_bodies([body(flipped(pose, rows))], rate_hz=100), Settings(reference=20))
    kept = other.screw.valid
    assert other.screw.angle[kept] == pytest.approx(clean.screw.angle[kept], abs=1e-12)


def test_a_spike_of_place_alone_is_lost() -> None:
    pose = series(100)
    pose[40] = dq.multiply(dq.dual_quat_from_pose([1.0, 0, 0, 0], [0.0, 0.3, 0.0]), pose[40])
    found, codes = checked(pose)
    assert np.flatnonzero(~found.tracked).tolist() == [40]
    assert codes == ["leap"]


def test_a_leap_that_does_not_come_back_is_told_and_kept() -> None:
    pose = flipped(series(400), slice(200, 400))
    found, codes = checked(pose)
    assert found.tracked.all()
    assert codes == ["leap-unresolved"]


def test_a_flip_behind_a_gap_is_told_and_the_gap_is_not_filled() -> None:
    for gap in range(1, 16):
        pose = flipped(series(400), slice(200 + gap, 400))
        pose[200 : 200 + gap] = np.nan
        measured = measure(Recording.from_bodies([body(pose)], rate_hz=100), Settings())
        assert "leap-unresolved" in [warning.code for warning in measured.warnings]
        assert not measured.screw.filled.any()


def test_a_clock_that_jitters_makes_no_leaps() -> None:
    rng = np.random.default_rng(4)
    angle = 2.2 * np.sin(np.linspace(0.0, 3.0, 450))
    one = body(dual_quat_from_screw(angle, 0.0, [0.0, 0.6, 0.8], [0.3, -0.16, 0.12]))
    time_s = np.sort(np.arange(450) / 100 + rng.uniform(-0.009, 0.009, size=450))
    taken = Recording(bodies=(one,), frame=np.arange(450), time_s=time_s, rate_hz=100.0)
    analysis = analyze(taken)
    assert analysis.screw.valid.all()
    assert np.degrees(analysis.screw.angle.max()) == pytest.approx(np.degrees(2.2), abs=0.01)


@pytest.mark.parametrize("rate_hz", [30.0, 60.0, 120.0, 360.0, 1000.0])
def test_fast_motion_is_no_leap(rate_hz: float) -> None:
    time_s = np.arange(0.0, 1.5, 1.0 / rate_hz)
    angle = 1.2 - 1.2 * np.cos(2.0 * np.pi * 2.6 * time_s)  # to 138 deg and back, up to 1120 deg/s
    noise = np.random.default_rng(1).normal(scale=5e-4, size=(time_s.size, 3))
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.6, 0.8], [0.3, -0.16, 0.12])
    pose = dq.multiply(pose, dq.dual_quat_from_pose(qn.quat_from_rotation_vector(10.0 * noise), noise))
    found, codes = checked(pose, rate_hz)
    assert found.tracked.all()
    assert codes == []


def test_a_spike_below_the_limits_is_lost() -> None:
    pose = series(60)
    pose[30] = dq.multiply(pose[30], dq.dual_quat_from_pose(qn.quat_from_rotation_vector([0.4, 0.0, 0.0]), [0, 0, 0]))
    for rate_hz in (30.0, 100.0):
        found, codes = checked(pose, rate_hz)
        assert np.flatnonzero(~found.tracked).tolist() == [30]
        assert codes == ["leap"]


def test_a_body_at_rest_in_its_own_frame_is_measured() -> None:
    angle = np.concatenate([np.zeros(80), np.linspace(0.0, 2.0, 60)])
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.6, 0.8], [0.1, -0.08, 0.06])
    assert checked(pose, frozen="keep")[0].tracked.all()


def test_the_limits_of_a_step_can_be_changed() -> None:
    angle = np.linspace(0.0, 6.0, 40)
    pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.6, 0.8], [0.0, 0.0, 0.0])  # 8.8 deg a frame: 881 deg/s
    assert checked(pose)[1] == []
    assert "leap" in checked(pose, max_turn_deg_s=300.0)[1]  # and the floor of 5 deg a step
    assert checked(pose, max_turn_deg_s=900.0)[1] == []


def test_a_body_that_really_turns_fast_is_told_with_its_speed_and_the_option_that_keeps_it() -> None:
    angle = np.radians(40.0) * np.arange(120)  # 4000 deg/s at 100 Hz
    fast = body(dual_quat_from_screw(angle, 0.0, [0.0, 0.6, 0.8], [0.0, 0.0, 0.0]))
    taken = Recording.from_bodies([fast], rate_hz=100)
    with pytest.raises(AnalysisError, match=r"evenly there, at up to 4000 deg/s.* max_turn_deg_s=4800 keeps it"):
        analyze(taken)
    kept = analyze(taken, Settings(max_turn_deg_s=4800))
    assert np.degrees(kept.screw.angle) == pytest.approx(np.degrees(angle), abs=1e-6)


def test_flips_are_not_taken_for_a_fast_body() -> None:
    pose = series(60)
    flip = dq.dual_quat_from_pose(qn.quat_from_rotation_vector([0.0, 2.5, 0.0]), [0.0, 0.0, 0.0])
    pose[20:30:2] = dq.multiply(pose[20:30:2], flip)
    one = body(pose)
    taken = Recording.from_bodies([one], rate_hz=100)
    messages = [warning.message for warning in check_tracking(one, taken, elapsed_time(taken), Settings()).warnings]
    assert messages
    assert not any("evenly" in message for message in messages)


def test_a_motion_that_goes_on_behind_a_gap_is_no_leap() -> None:
    pose = series(400)
    pose[100:200] = np.nan
    assert checked(pose)[1] == []


def test_bodies_that_exchange_their_places_are_told() -> None:
    one, other = series(300), dq.multiply(dq.dual_quat_from_pose([1.0, 0, 0, 0], [0.4, 0.1, 0.0]), series(300)[::-1])
    swapped_one, swapped_other = one.copy(), other.copy()
    swapped_one[120:140], swapped_other[120:140] = other[120:140], one[120:140]
    taken = Recording.from_bodies([body(swapped_one, "A"), body(swapped_other, "B")], rate_hz=100)
    _, found, _, warnings = check_bodies(taken, taken.bodies, Settings())
    swaps = [warning for warning in warnings if warning.code == "swapped-bodies"]
    assert [warning.frames for warning in swaps] == [(120, 140)]
    for body_found in found:
        assert np.flatnonzero(~body_found.body.tracked).tolist() == list(range(120, 140))


def test_an_exchange_behind_a_gap_is_told() -> None:
    one, other = series(300), dq.multiply(dq.dual_quat_from_pose([1.0, 0, 0, 0], [0.4, 0.1, 0.0]), series(300)[::-1])
    swapped_one, swapped_other = one.copy(), other.copy()
    swapped_one[150:], swapped_other[150:] = other[150:], one[150:]
    swapped_one[135:150] = swapped_other[135:150] = np.nan
    taken = Recording.from_bodies([body(swapped_one, "A"), body(swapped_other, "B")], rate_hz=100)
    warnings = check_bodies(taken, taken.bodies, Settings()).warnings
    assert [warning.frames for warning in warnings if warning.code == "swapped-bodies"] == [(150,)]


@pytest.mark.parametrize(("gap_s", "told"), [(0.5, True), (1.5, False)])
def test_where_bodies_were_long_out_of_sight_an_exchange_is_no_claim(gap_s: float, told: bool) -> None:
    """In a second and more each may have gone where the other was."""
    one, other = series(600), dq.multiply(dq.dual_quat_from_pose([1.0, 0, 0, 0], [0.4, 0.1, 0.0]), series(600)[::-1])
    swapped_one, swapped_other = one.copy(), other.copy()
    swapped_one[400:], swapped_other[400:] = other[400:], one[400:]
    lost = slice(400 - round(100 * gap_s), 400)
    swapped_one[lost] = swapped_other[lost] = np.nan
    taken = Recording.from_bodies([body(swapped_one, "A"), body(swapped_other, "B")], rate_hz=100)
    warnings = check_bodies(taken, taken.bodies, Settings()).warnings
    assert ("swapped-bodies" in [warning.code for warning in warnings]) == told


@pytest.mark.parametrize("rate_hz", [5.0, 9.0, 10.0, 11.0, 25.0, 60.0, 360.0])
def test_flips_are_found_at_any_rate(rate_hz: float) -> None:
    pose = dual_quat_from_screw(np.linspace(0.0, 2.0, 120), 0.0, [0.0, 0.6, 0.8], [0.1, -0.08, 0.06])
    for row in range(10, 110, 7):
        found, codes = checked(flipped(pose, slice(row, row + 1)), rate_hz)
        assert np.flatnonzero(~found.tracked).tolist() == [row]
        assert codes == ["leap"]


def test_quality_tells_the_figures_of_a_body() -> None:
    pose = series(100)
    pose[10:20] *= -1.0
    pose[50:55] = np.nan
    residual = np.full(100, 2e-4)
    residual[70] = 8e-3
    one = replace(body(pose), marker_residual=residual, marker_offsets=np.array([[0.1, 0, 0], [0.0, 0.02, 0]]))
    taken = Recording.from_bodies([one], rate_hz=100)
    checked = check_bodies(taken, taken.bodies, Settings())
    (quality,), warnings = checked.quality, checked.warnings
    assert quality.tracked_share == pytest.approx(0.95)
    assert quality.lost_frames == {"blank": 5}
    assert quality.sign_flips == 2
    assert quality.fastest_turn == pytest.approx(2.0 / 99 * 100)
    assert quality.marker_residual is not None
    assert (quality.marker_residual.median, quality.marker_residual.largest) == pytest.approx((2e-4, 8e-3))
    assert quality.pivot_offset == pytest.approx(np.hypot(0.05, 0.01))
    codes = {warning.code: warning for warning in warnings}
    assert set(codes) == {"sign-flips", "marker-residual", "pivot-offset"}
    assert codes["marker-residual"].frames == (70,)
    assert codes["sign-flips"].severity == "note"


def test_the_clock_tells_of_frames_that_are_missing() -> None:
    frame = np.r_[0:20, 30:50]
    taken = recording(frame, frame / 100.0)
    quality = clock_quality(taken)
    assert (quality.missing_frames, quality.frame_gaps, quality.repeated_frames) == (10, 1, 0)
    assert [warning.code for warning in clock_warnings(taken)] == ["missing-frames"]
    twice = recording(np.array([0, 1, 1, 2, 3]), np.array([0.0, 0.01, 0.02, 0.03, 0.04]))
    assert [warning.code for warning in clock_warnings(twice)] == ["frame-numbers"]


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


@pytest.mark.parametrize("decimals", [0, 1, 2])
def test_times_rounded_by_a_spreadsheet_leave_the_frames_as_the_clock(decimals: int) -> None:
    frame = np.arange(480)
    taken = recording(frame, np.round(frame / 240.0, decimals), 240.0)
    assert elapsed_time(taken) == pytest.approx(frame / 240.0, abs=1e-15)
    assert clock_warnings(taken) == ()


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


@pytest.mark.parametrize("lost", [28, 33, 36, 40, 60, 72])
@pytest.mark.parametrize("after", [60, 300])
def test_a_body_that_goes_on_turning_over_a_gap_has_not_leapt(lost: int, after: int) -> None:
    # 500 deg/s: half a turn in 36 frames.
    pose = dual_quat_from_screw(np.radians(5.0 * np.arange(400.0)), 0.0, [0.0, 0.6, 0.8], [0.1, 0.0, 0.0])
    pose[after : after + lost] = np.nan
    found, codes = checked(pose)
    assert found.tracked.sum() == 400 - lost
    assert codes == []


def test_a_body_that_comes_back_turned_round_after_a_gap_at_rest_has_leapt() -> None:
    pose = flipped(series(200), slice(120, 200))
    pose[100:120] = np.nan
    assert checked(pose)[1] == ["leap"]


def test_a_leap_is_told_by_its_size_and_by_the_limits_that_it_breaks() -> None:
    one = body(flipped(series(200), slice(0, 30)))
    taken = Recording.from_bodies([one], rate_hz=100.0)
    (warning,) = check_tracking(one, taken, elapsed_time(taken), Settings()).warnings
    assert "leaps out of its motion by up to 180 deg" in warning.message
    assert "120 deg and 0.5 m within 0.1 s" in warning.message


def test_a_pose_is_the_same_to_the_last_digit_of_either_sign() -> None:
    poses = random_poses((6,), seed=3)
    others = poses.copy()
    others[1] = -others[1]
    others[2, 0] = np.nextafter(others[2, 0], 2.0)
    others[3, 7] = -np.nextafter(others[3, 7], 2.0)
    others[4, 4:] = -others[4, 4:]
    assert is_same_pose(others, poses).tolist() == [True, True, False, False, False, True]


def test_a_body_that_goes_away_late_is_not_on_the_spot() -> None:
    turn = np.linspace(0.0, 1.0, 1500)
    poses = dual_quat_from_screw(turn, 0.0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    assert turns_on_the_spot(body(poses))
    poses[1400:] = dual_quat_from_screw(turn[1400:], 0.01, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    assert not turns_on_the_spot(body(poses))
