"""How noisy poses are, told from markers, an error column or a rest, whose noise is known as it was put there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import RigidBody, Settings, simulate_trial
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
from elbowscrew.motion.screws.pose_noise import JointNoise, covariance_from_markers, pose_noise

RATE_HZ = 100.0
TURN_SD, PLACE_SD = 1e-3, 2e-4
TRIAL = simulate_trial(frames=60, inversion=30, proximal="moving").recording


def body(poses: Float, **changes: Any) -> RigidBody:
    """A body with these poses (N, 8) and nothing else but what is given."""
    fields = {name: getattr(TRIAL.bodies[1], name) for name in RigidBody.__dataclass_fields__}
    loss = np.where(np.isfinite(poses).all(axis=1), fields["loss"][0], 1).astype(fields["loss"].dtype)
    bare = {"marker_offsets": None, "marker_residual": None, "reported_error": None}
    return RigidBody(**{**fields, **bare, "dual_quat_lab_body": poses, "loss": loss, **changes})


def poses(count: int, sd: tuple[float, float], seed: int = 0, drift: float = 0.0, fast: float = 0.0) -> Float:
    """Poses that jitter in their own frame, drift steadily along, and swing where they are fast."""
    rng = np.random.default_rng(seed)
    time = np.arange(count) / RATE_HZ
    turn = rng.normal(scale=sd[0], size=(count, 3))
    place = rng.normal(scale=sd[1], size=(count, 3)) + drift * time[:, None] + [0.1, 1.2, 0.3]
    place[:, 0] += fast * np.sin(7.0 * time)
    quat = (Rotation.from_rotvec([0.3, 0.2, -0.4]) * Rotation.from_rotvec(turn)).as_quat(scalar_first=True)
    return dual_quat_from_pose(quat, place)


def still(one: RigidBody, **settings: Any) -> Any:
    return pose_noise(one, RATE_HZ, Settings(noise="still", **settings))


@pytest.mark.parametrize("drift", [0.0, 5e-5])
def test_a_rest_tells_the_jitter_and_not_the_drift(drift: float) -> None:
    found = still(body(poses(4000, (TURN_SD, PLACE_SD), drift=drift)))
    sd = np.sqrt(np.diag(found.covariance))
    # 4000 frames less two degrees of freedom in each half second: 1.2 % is a standard deviation of the error.
    assert sd[:3] == pytest.approx(np.full(3, TURN_SD), rel=0.05)
    assert sd[3:] == pytest.approx(np.full(3, PLACE_SD), rel=0.05)
    assert (found.source, found.marker_noise) == ("still stretch", None)


def test_signs_of_the_quaternions_tell_nothing() -> None:
    one = poses(400, (TURN_SD, PLACE_SD))
    flipped = one * np.where(np.arange(400) % 3 == 0, -1.0, 1.0)[:, None]
    assert still(body(flipped)).covariance == pytest.approx(still(body(one)).covariance, rel=1e-9)


def test_a_half_second_of_rest_suffices_and_motion_is_none() -> None:
    """Cut into half seconds from the first frame on; at low rates into stretches of 20 frames."""
    moving = poses(400, (TURN_SD, PLACE_SD), fast=0.1)
    assert still(body(moving)) is None
    rest = poses(400, (TURN_SD, PLACE_SD))
    for first, last, told in ((100, 150, True), (101, 149, False)):
        mixed = moving.copy()
        mixed[first:last] = rest[first:last]
        assert (still(body(mixed)) is not None) == told
    assert still(body(rest[:50])) is not None
    assert still(body(rest[:49])) is None
    for count, told in ((20, True), (19, False)):
        assert (pose_noise(body(rest[:count]), 10.0, Settings(noise="still")) is not None) == told


def test_a_rest_that_is_not_wholly_tracked_tells_nothing() -> None:
    one = poses(100, (TURN_SD, PLACE_SD))
    one[[20, 70]] = np.nan
    assert still(body(one)) is None
    one[70] = poses(100, (TURN_SD, PLACE_SD))[70]
    assert still(body(one)) is not None


def test_a_rest_is_no_rest_if_it_jitters_by_more_than_a_millimeter() -> None:
    """RMS distance of points at the radius from where they are on average."""
    for size_mm, told in ((0.85, True), (1.3, False)):
        sd = size_mm / 1000.0 / np.sqrt(3.0)
        assert (still(body(poses(400, (0.0, sd)))) is not None) == told
        turn = size_mm / 1000.0 / np.sqrt(3.0) / 0.2
        assert (still(body(poses(400, (turn, 0.0))), radius_mm=200.0) is not None) == told
        assert still(body(poses(400, (turn, 0.0))), radius_mm=20.0) is not None


def test_of_many_rests_the_usual_ones_count_and_not_those_of_double_the_jitter() -> None:
    quiet, loud = poses(400, (TURN_SD, PLACE_SD)), poses(400, (2.6 * TURN_SD, 2.6 * PLACE_SD), seed=1)
    both = still(body(np.concatenate([quiet, loud]))).covariance
    assert both == pytest.approx(still(body(quiet)).covariance, rel=1e-9)
    alike = still(body(np.concatenate([quiet, poses(400, (1.5 * TURN_SD, 1.5 * PLACE_SD), seed=1)]))).covariance
    assert np.sqrt(alike[0, 0]) == pytest.approx(TURN_SD * np.sqrt(0.5 * (1.0 + 1.5**2)), rel=0.1)


def test_a_coordinate_that_repeats_has_the_noise_of_six_decimals() -> None:
    """A number rounded to 1e-6 errs evenly by half of that: a standard deviation of 1e-6 / sqrt(12)."""
    one = poses(200, (TURN_SD, PLACE_SD))
    rng = np.random.default_rng(4)
    still_there = np.tile(np.array([0.1, 1.2, 0.3]), (200, 1))
    turn = Rotation.from_rotvec(rng.normal(scale=TURN_SD, size=(200, 3))).as_quat(scalar_first=True)
    found = still(body(dual_quat_from_pose(turn, still_there))).covariance
    assert np.sqrt(np.diag(found)[3:]) == pytest.approx(np.full(3, 1e-6 / np.sqrt(12.0)), rel=1e-3)
    frozen_turn = dual_quat_from_pose(np.tile([1.0, 0, 0, 0], (200, 1)), rng.normal(scale=PLACE_SD, size=(200, 3)))
    # A rotation vector is twice the quaternion's part.
    assert np.sqrt(np.diag(still(body(frozen_turn)).covariance)[:3]) == pytest.approx(
        np.full(3, 2e-6 / np.sqrt(12.0)), rel=1e-3
    )
    assert still(body(np.tile(one[:1], (200, 1)))) is None  # no jitter at all is a file of constants


def square_cluster(count: int) -> Float:
    turn = 2.0 * np.pi * np.arange(count) / count
    return 0.05 * np.column_stack([np.cos(turn), np.sin(turn), 0.3 * (-1.0) ** np.arange(count)])


@pytest.mark.parametrize("markers", [3, 4, 7])
def test_residuals_of_a_fit_tell_the_noise_of_the_markers(markers: int) -> None:
    """A fit takes 6 of 3 M degrees of freedom: the sum of squares over sigma^2 is a chi-square of 3 M - 6."""
    sigma = 3e-4
    rng = np.random.default_rng(markers)
    square = sigma**2 * rng.chisquare(3 * markers - 6, size=20_000) / markers
    offsets = square_cluster(markers)
    one = body(np.tile(poses(1, (0.0, 0.0)), (20_000, 1)), marker_offsets=offsets, marker_residual=np.sqrt(square))
    found = pose_noise(one, RATE_HZ, Settings())
    assert found is not None
    assert found.source == "marker residuals"
    assert found.marker_noise is not None
    assert found.marker_noise == pytest.approx(sigma, rel=0.02 if markers > 3 else 0.03)
    assert found.covariance == pytest.approx(covariance_from_markers(offsets, found.marker_noise), rel=1e-9)
    # A tenth of frames with a marker astray moves a median little.
    astray = np.sqrt(square)
    astray[:2000] = 0.05
    moved = pose_noise(replace(one, marker_residual=astray), RATE_HZ, Settings())
    assert moved is not None
    assert moved.marker_noise == pytest.approx(sigma, rel=0.12)


def test_residuals_of_round_off_are_no_noise() -> None:
    """Markers without any error leave some 1e-17 m: whatever a joint leaves would be far beyond that."""
    given = {"marker_offsets": square_cluster(4)}
    frames = poses(50, (0.0, 0.0))
    for size, told in ((1e-16, False), (1e-8, True)):
        found = pose_noise(
            body(frames, marker_residual=np.full(50, size), **given), RATE_HZ, Settings(noise="residuals")
        )
        assert (found is not None) == told


def test_a_mean_error_is_less_than_the_root_of_the_mean_square() -> None:
    """Of a normal error in space, the mean distance is sqrt(8 / (3 pi)) of the RMS distance."""
    rng = np.random.default_rng(2)
    distance = np.linalg.norm(rng.normal(size=(200_000, 3)), axis=1)
    share = distance.mean() / np.sqrt(np.mean(distance**2))
    rms = 4e-4
    count = 100
    given = {"marker_offsets": square_cluster(4)}
    frames = np.tile(poses(1, (0.0, 0.0)), (count, 1))
    by_mean = pose_noise(body(frames, reported_error=np.full(count, share * rms), **given), RATE_HZ, Settings())
    by_rms = pose_noise(body(frames, marker_residual=np.full(count, rms), **given), RATE_HZ, Settings())
    assert by_mean is not None
    assert by_rms is not None
    assert by_mean.source == "error column"
    assert by_mean.marker_noise == pytest.approx(by_rms.marker_noise, rel=0.005)


def test_markers_without_a_residual_in_some_frames_still_tell_it() -> None:
    """A system writes 0 where it has none to tell; the median is of all frames."""
    frames = np.tile(poses(1, (0.0, 0.0)), (100, 1))
    some, all_of = np.full(100, 4e-4), np.full(100, 4e-4)
    some[::7] = 0.0
    given = {"marker_offsets": square_cluster(4)}
    found, wanted = (
        pose_noise(body(frames, marker_residual=one, **given), RATE_HZ, Settings()) for one in (some, all_of)
    )
    assert found is not None
    assert wanted is not None
    assert found.marker_noise == pytest.approx(wanted.marker_noise)


def test_what_is_no_error_is_left_out_of_the_column() -> None:
    frames = np.tile(poses(1, (0.0, 0.0)), (9, 1))
    column = np.array([1e-4, 2e-4, 3e-4, -1.0, 1.0, 5.0, np.nan, 2e-4, 2e-4])
    given = {"marker_offsets": square_cluster(4)}
    found = pose_noise(body(frames, reported_error=column, **given), RATE_HZ, Settings())
    alone = pose_noise(body(frames, reported_error=np.full(9, 2e-4), **given), RATE_HZ, Settings())
    assert found is not None
    assert alone is not None
    assert found.marker_noise == pytest.approx(alone.marker_noise)
    near = pose_noise(body(frames, reported_error=np.full(9, 0.99), **given), RATE_HZ, Settings())
    assert near is not None
    assert pose_noise(body(frames, reported_error=np.full(9, 1.0), **given), RATE_HZ, Settings()) is None
    assert pose_noise(body(frames, reported_error=np.zeros(9), **given), RATE_HZ, Settings()) is None


def test_only_tracked_frames_tell() -> None:
    frames = np.tile(poses(1, (0.0, 0.0)), (9, 1))
    frames[:5] = np.nan
    residual = np.where(np.arange(9) < 5, 0.5, 2e-4)
    found = pose_noise(body(frames, marker_residual=residual, marker_offsets=square_cluster(4)), RATE_HZ, Settings())
    whole = pose_noise(body(frames, marker_residual=np.full(9, 2e-4), marker_offsets=square_cluster(4)), RATE_HZ,
                       Settings())  # fmt: skip
    assert found is not None
    assert whole is not None
    assert found.marker_noise == pytest.approx(whole.marker_noise)


def test_the_first_source_there_is_is_taken_and_a_named_one_alone() -> None:
    frames = poses(200, (TURN_SD, PLACE_SD))
    cluster = {"marker_offsets": square_cluster(4)}
    every = body(frames, marker_residual=np.full(200, 2e-4), reported_error=np.full(200, 3e-4), **cluster)
    names = {
        name: getattr(pose_noise(every, RATE_HZ, Settings(noise=name)), "source", None)
        for name in ("auto", "residuals", "error-column", "still", "none")
    }
    assert names == {
        "auto": "marker residuals",
        "residuals": "marker residuals",
        "error-column": "error column",
        "still": "still stretch",
        "none": None,
    }
    less = replace(every, marker_residual=None)
    assert getattr(pose_noise(less, RATE_HZ, Settings()), "source", None) == "error column"


@pytest.mark.parametrize("kind", ["two", "on a line", "none"])
def test_markers_that_fix_no_pose_are_taken_for_a_cluster_of_four(kind: str) -> None:
    """Four points at the radius, spread alike: sigma^2 / 4 for the place, 3 sigma^2 / (8 r^2) for the rotation."""
    line = np.column_stack([[0.0, 0.05, 0.1, 0.15], np.zeros(4), np.zeros(4)])
    offsets = {"two": line[:2], "on a line": line, "none": None}[kind]
    one = body(poses(100, (0.0, 0.0)), marker_offsets=offsets)
    found = pose_noise(one, RATE_HZ, Settings(marker_noise_mm=0.4, radius_mm=80.0))
    assert found is not None
    assert found.source == "option, markers assumed"
    radius = 0.08
    corners = radius / np.sqrt(3.0) * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=np.float64)
    assert found.covariance == pytest.approx(covariance_from_markers(corners, 4e-4), abs=1e-20)
    wide = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.05, 0.02, 0]])
    assert pose_noise(replace(one, marker_offsets=wide), RATE_HZ, Settings(marker_noise_mm=0.4)).source == "option"  # type: ignore[union-attr]


def test_a_body_of_two_markers_has_no_residuals_to_go_by() -> None:
    one = body(poses(50, (0.0, 0.0)), marker_offsets=square_cluster(4)[:2], marker_residual=np.full(50, 1e-4))
    assert pose_noise(one, RATE_HZ, Settings(noise="residuals")) is None
    three = replace(one, marker_offsets=square_cluster(3))
    assert pose_noise(three, RATE_HZ, Settings(noise="residuals")) is not None


def test_the_joints_noise_is_known_if_that_of_each_moving_body_is() -> None:
    noisy, silent = body(poses(200, (TURN_SD, PLACE_SD))), body(np.tile(poses(1, (0.0, 0.0)), (200, 1)))
    settings = Settings(noise="still")
    both = JointNoise.of(noisy, noisy, RATE_HZ, settings).known
    assert both is not None
    assert both[0] is not None
    one = JointNoise.of(None, noisy, RATE_HZ, settings).known
    assert one is not None
    assert one[0] is None
    assert JointNoise.of(None, silent, RATE_HZ, settings).known is None  # nothing moves
    noiseless = Settings(noise="none")
    for proximal, distal in ((noisy, noisy), (silent, noisy), (noisy, silent), (None, noisy)):
        assert JointNoise.of(proximal, distal, RATE_HZ, noiseless).known is None


@pytest.mark.parametrize("rounding", [0.0, 1e-15, 1e-12])
def test_a_body_that_stands_still_needs_no_source_of_noise(rounding: float) -> None:
    """Neither does it matter by how many units in the last place its poses differ."""
    still = np.tile(poses(1, (0.0, 0.0)), (200, 1)) + rounding * np.random.default_rng(1).normal(size=(200, 8))
    noisy, silent, settings = body(poses(200, (TURN_SD, PLACE_SD))), body(still), Settings(noise="still")
    alone = JointNoise.of(None, noisy, RATE_HZ, settings).known
    assert alone is not None
    known = JointNoise.of(silent, noisy, RATE_HZ, settings).known
    assert known is not None
    assert known[0] is None
    assert np.array_equal(known[1].covariance, alone[1].covariance)
    swapped = JointNoise.of(noisy, silent, RATE_HZ, settings).known
    assert swapped is not None
    assert swapped[0] is not None
    assert np.array_equal(swapped[0].covariance, alone[1].covariance)
    assert not swapped[1].covariance.any()


def test_what_is_assumed_of_an_unknown_noise_is_none_of_a_body_that_is_not_there() -> None:
    moving, settings = body(poses(200, (TURN_SD, PLACE_SD))), Settings(noise="none")
    first, second = JointNoise.of(None, moving, RATE_HZ, settings).assumed
    assert first is None
    assert (second.source, second.marker_noise) == ("assumed", None)
    first, second = JointNoise.of(moving, moving, RATE_HZ, settings).assumed
    assert first is not None
    assert np.array_equal(first.covariance, second.covariance)  # the two bodies are alike
