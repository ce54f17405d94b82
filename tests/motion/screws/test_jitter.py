"""The noise of poses without markers, told by their own jitter, against that of markers that only the tests know."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from elbowscrew import RigidBody, Settings, simulate_trial
from elbowscrew.geometry import pose_from_points
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose, multiply
from elbowscrew.motion.screws.jitter import jitter_covariance
from elbowscrew.motion.screws.pose_noise import JointNoise, covariance_from_markers, pose_noise

RATE_HZ = 100.0
LEAST = np.full(6, 3e-7)
SIGMA = 3e-4
BODY = simulate_trial(frames=60, inversion=30, proximal="moving").recording.bodies[1]
CLUSTERS = {
    "three at 30 mm": np.array([[0.03, 0.0, 0.0], [-0.015, 0.026, 0.0], [-0.015, -0.026, 0.0]]),
    "a long one": np.array([[0.12, 0.01, 0.0], [-0.12, 0.01, 0.0], [0.0, -0.01, 0.015], [0.0, -0.01, -0.015]]),
    "five at 80 mm": 0.08 * np.array([[1, 0, 0.2], [-1, 0, 0.2], [0, 1, 0.2], [0, -1, 0.2], [0, 0, -0.8]]),
}


def throw(count: int, hz: float = 3.0) -> Float:
    """Poses (N, 8) of a body that is swung to and fro about two axes, by 60 deg and 300 mm."""
    time = np.arange(count) / RATE_HZ
    turn = np.radians(30.0) * np.column_stack(
        [np.sin(2.0 * np.pi * hz * time), np.cos(1.7 * np.pi * hz * time), 0.0 * time]
    )
    place = 0.15 * np.column_stack([np.cos(2.0 * np.pi * hz * time), 0.0 * time, np.sin(1.3 * np.pi * hz * time)])
    return dual_quat_from_pose(Rotation.from_rotvec(turn).as_quat(scalar_first=True), place)


def body(poses: Float, off: Float, shape: Float) -> RigidBody:
    """A body of which only poses are kept, fitted to markers that are off by (N, M, 3) in its frame."""
    seen = multiply(poses, pose_from_points(shape, shape + off))
    return RigidBody(
        **{name: getattr(BODY, name) for name in ("name",)},
        dual_quat_lab_body=seen,
        loss=np.full(len(poses), BODY.loss[0], dtype=BODY.loss.dtype),
    )


def noisy(kind: str, count: int = 6000, sigma: float = SIGMA, seed: int = 0) -> RigidBody:
    shape = CLUSTERS[kind] - CLUSTERS[kind].mean(axis=0)
    off = np.random.default_rng(seed).normal(scale=sigma, size=(count, len(shape), 3))
    return body(throw(count), off, shape)


def relative(found: Float | None, kind: str, sigma: float = SIGMA) -> Float:
    """Of the true covariance's own axes, the found variances over the true ones."""
    assert found is not None
    shape = CLUSTERS[kind] - CLUSTERS[kind].mean(axis=0)
    values, axes = np.linalg.eigh(covariance_from_markers(shape, sigma))
    return np.asarray(np.sum(axes * (found @ axes), axis=0) / values)


@pytest.mark.parametrize("kind", list(CLUSTERS))
def test_jitter_tells_the_covariance_that_unseen_markers_make(kind: str) -> None:
    """In each direction: a long cluster's turn about its length errs eight times as much as across it."""
    # 6000 differences, of which some 2000 count: 3 % is a standard deviation of a variance.
    assert relative(jitter_covariance(noisy(kind), LEAST), kind) == pytest.approx(np.ones(6), abs=0.12)


def test_lost_frames_and_leaps_hardly_change_it() -> None:
    one = noisy("three at 30 mm")
    poses, loss = one.dual_quat_lab_body.copy(), one.loss.copy()
    poses[::90] = multiply(poses[::90], dual_quat_from_pose([1.0, 0.0, 0.0, 0.0], [0.05, 0.0, 0.0]))
    poses[40::100], loss[40::100] = np.nan, 1
    found = jitter_covariance(replace(one, dual_quat_lab_body=poses, loss=loss), LEAST)
    assert relative(found, "three at 30 mm") == pytest.approx(np.ones(6), abs=0.25)


@pytest.mark.parametrize("kind", ["no noise", "rounding", "one axis", "few frames", "a filter", "no run"])
def test_what_does_not_tell_is_not_told(kind: str) -> None:
    shape = CLUSTERS["five at 80 mm"] - CLUSTERS["five at 80 mm"].mean(axis=0)
    off = np.random.default_rng(1).normal(scale=SIGMA, size=(2000, len(shape), 3))
    told = body(throw(2000), off, shape)
    assert jitter_covariance(told, LEAST) is not None
    loss = told.loss.copy()
    loss[::6] = 1
    turns = np.radians(0.2) * np.random.default_rng(2).normal(size=(2000, 1)) * [0.0, 0.0, 1.0]
    about_z = Rotation.from_rotvec(turns).as_quat(scalar_first=True)
    silent = {
        "one axis": replace(told, dual_quat_lab_body=dual_quat_from_pose(about_z, np.zeros((2000, 3)))),
        "no noise": body(throw(2000), 0.0 * off, shape),
        "rounding": body(throw(2000), 1e-3 * off, shape),
        "few frames": body(throw(105), off[:105], shape),
        "a filter": body(throw(2000), gaussian_filter1d(off, 4.0, axis=0), shape),
        "no run": replace(told, loss=loss),
    }[kind]
    assert jitter_covariance(silent, LEAST) is None


@pytest.mark.parametrize(("times", "told"), [(2.5, False), (3.5, True)])
def test_less_than_three_times_the_rounding_is_not_told(times: float, told: bool) -> None:
    shape = CLUSTERS["five at 80 mm"] - CLUSTERS["five at 80 mm"].mean(axis=0)
    sd = np.sqrt(np.diag(covariance_from_markers(shape, SIGMA)))
    found = jitter_covariance(noisy("five at 80 mm"), sd / times)
    assert (found is not None) == told


@pytest.mark.parametrize(
    ("stated", "sd"), [(0.15, 0.15 / np.sqrt(3.0)), (0.3, 0.3 / np.sqrt(3.0)), (0.4, 0.2), (2.0, 1.0)]
)
def test_a_stated_noise_keeps_its_size_whatever_the_number_of_markers(stated: float, sd: float) -> None:
    """Three markers of 0.3 mm jitter by 0.173 mm: a pose of as much or less is of three, one of more of four."""
    found = pose_noise(noisy("three at 30 mm"), RATE_HZ, Settings(marker_noise_mm=stated))
    assert found is not None
    assert found.source == "option, shared out as the poses jitter"
    assert 1000.0 * np.sqrt(np.trace(found.covariance[3:, 3:]) / 3.0) == pytest.approx(sd, rel=0.05)
    turn, shift = (np.trace(part) for part in (found.covariance[:3, :3], found.covariance[3:, 3:]))
    true = covariance_from_markers(CLUSTERS["three at 30 mm"], SIGMA)
    assert turn / shift == pytest.approx(np.trace(true[:3, :3]) / np.trace(true[3:, 3:]), rel=0.1)


def test_an_error_column_never_makes_less_than_the_jitter_nor_than_four_markers_would() -> None:
    one = noisy("three at 30 mm")
    mean_to_rms = np.sqrt(8.0 / (3.0 * np.pi))
    sd = {}
    for error in (1e-4, 2e-3):
        found = pose_noise(replace(one, reported_error=np.full(len(one.loss), error)), RATE_HZ, Settings())
        assert found is not None
        assert found.source == "error column, shared out as the poses jitter"
        sd[error] = np.sqrt(np.trace(found.covariance[3:, 3:]) / 3.0)
    assert sd[1e-4] == pytest.approx(SIGMA / np.sqrt(3.0), rel=0.05)
    median = (1.0 - 2.0 / (9.0 * 6.0)) ** 3
    assert sd[2e-3] == pytest.approx(2e-3 / mean_to_rms / np.sqrt(6.0 * median), rel=1e-9)


def test_an_unknown_noise_has_the_shape_of_the_jitter_if_both_bodies_tell_it() -> None:
    """Each by itself: the shape of one says nothing of the other, a common cluster nothing beside a measured one."""
    first, second = noisy("three at 30 mm"), noisy("five at 80 mm", seed=3)
    silent = body(throw(6000, hz=2.0), np.zeros((6000, 3, 3)), CLUSTERS["three at 30 mm"])
    settings = Settings(noise="none")
    proximal, distal = JointNoise.of(first, second, RATE_HZ, settings).assumed
    assert proximal is not None
    for noise, kind in ((proximal, "three at 30 mm"), (distal, "five at 80 mm")):
        assert relative(noise.covariance, kind) == pytest.approx(np.ones(6), abs=0.12)
    proximal, distal = JointNoise.of(silent, second, RATE_HZ, settings).assumed
    assert proximal is not None
    assert proximal.covariance == pytest.approx(distal.covariance)
    assert JointNoise.of(None, second, RATE_HZ, settings).assumed[1].covariance == pytest.approx(
        jitter_covariance(second, 0.0 * LEAST)
    )
