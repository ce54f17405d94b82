"""Errors of every frame's screw: noise of the poses, propagation, and what the user is told."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coverage_of_screws import coverage
from scipy.signal import butter, sosfreqz
from scipy.spatial.transform import Rotation
from trials import ARM, FOREARM, SIGMA

from elbowscrew import Analysis, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.configuring import settings_from
from elbowscrew.errors import AnalysisError, SettingError, UsageError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import pose_from_points
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import PoseNoise
from elbowscrew.motion.screws.pose_noise import covariance_from_markers, pose_noise
from elbowscrew.motion.screws.uncertainty import errors_from_covariance, least_angle
from elbowscrew.simulate import SimulatedTrial


@pytest.mark.parametrize("proximal_moves", [False, True])
@pytest.mark.parametrize("angle_deg", [5, 30, 100, 170])
def test_intervals_cover_95_percent(angle_deg: int, proximal_moves: bool) -> None:
    trials = 3000
    # Four standard deviations of a share; the 10,000 trials of benchmarks/uncertainty.py are nearer.
    slack = 4.0 * np.sqrt(0.95 * 0.05 / trials)
    shares = coverage(np.radians(angle_deg), trials, proximal_moves=proximal_moves, seed=angle_deg)
    assert shares == pytest.approx((0.95,) * 4, abs=slack)


@pytest.mark.parametrize("shift", [0.0, 0.1])
def test_the_covariance_of_a_fitted_pose(shift: float) -> None:
    """Markers about their centroid, and markers whose body has its origin elsewhere."""
    offsets = ARM + np.array([shift, 0.0, 0.5 * shift])
    rng = np.random.default_rng(3)
    count = 20_000
    pose = pose_from_points(offsets, offsets + rng.normal(scale=SIGMA, size=(count, *offsets.shape)))
    error = 2.0 * dq.log(dq.canonical(pose))
    stated = covariance_from_markers(offsets, SIGMA)
    scale = np.sqrt(np.outer(np.diag(stated), np.diag(stated)))
    assert np.cov(error.T) / scale == pytest.approx(stated / scale, abs=6.0 / np.sqrt(count))


def body(**changes: Any) -> RigidBody:
    trial = simulate_trial(marker_noise_mm=1000 * SIGMA, rest_before_s=2.0, seed=5)
    distal = trial.recording.bodies[1]
    given = {name: getattr(distal, name) for name in RigidBody.__dataclass_fields__}
    return RigidBody(**{**given, "marker_residual": residuals(trial), **changes})


def residuals(trial: SimulatedTrial) -> Float:
    """RMS distance of the markers from the fitted body, frame by frame."""
    distal = trial.recording.bodies[1]
    assert distal.marker_offsets is not None
    expected = dq.transform_points(distal.dual_quat_lab_body[:, None, :], distal.marker_offsets)
    gap = trial.markers["Forearm"] - expected
    return np.asarray(np.sqrt(np.mean(np.sum(gap**2, axis=2), axis=1)))


def test_each_source_finds_the_noise_there_is() -> None:
    wanted = covariance_from_markers(FOREARM - FOREARM.mean(axis=0), SIGMA)
    mean_distance = residuals(simulate_trial(marker_noise_mm=1000 * SIGMA, rest_before_s=2.0, seed=5)) * 0.92
    sources: dict[Any, RigidBody] = {
        "residuals": body(),
        "still": body(),
        "error-column": body(reported_error=mean_distance),
    }
    for name, one in sources.items():
        found = pose_noise(one, 100.0, Settings(noise=name))
        assert found is not None
        ratio = np.sqrt(np.diag(found.covariance) / np.diag(wanted))
        # 650 frames of 6 degrees of freedom, and 200 frames at rest of one each.
        assert ratio == pytest.approx(np.ones(6), abs=0.25 if name == "still" else 0.06), name
    assert pose_noise(body(marker_residual=None), 100.0, Settings(noise="residuals")) is None
    automatic = pose_noise(body(marker_residual=None), 100.0, Settings())
    assert automatic is not None
    assert automatic.source == "still stretch"


def test_a_body_that_never_rests_has_no_still_stretch() -> None:
    trial = simulate_trial(marker_noise_mm=0.2, proximal="moving", frames=200, inversion=90, rate_hz=100.0)
    assert pose_noise(trial.recording.bodies[1], 100.0, Settings(noise="still")) is None


def test_the_users_word_is_the_strongest_and_needs_no_markers() -> None:
    found = pose_noise(body(), 100.0, Settings(marker_noise_mm=0.5))
    assert found is not None
    assert (found.source, found.marker_noise) == ("option", 5e-4)
    bare = pose_noise(body(marker_offsets=None), 100.0, Settings(marker_noise_mm=0.5, radius_mm=40))
    assert bare is not None
    assert bare.source == "option, shared out as the poses jitter"
    assert np.trace(bare.covariance[3:, 3:]) / 3.0 == pytest.approx(5e-4**2 / 4)


def analyzed(**settings: Any) -> Analysis:
    return analyze(simulate_trial(proximal="moving", seed=2).recording, Settings(marker_noise_mm=0.2, **settings))


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_errors_do_not_depend_on_the_frame_but_for_the_points_place(express_in: Any) -> None:
    one, other = analyzed().screw, analyzed(express_in=express_in).screw
    for name in ("angle_sd", "slide_sd", "axis_sd", "axis_cone"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9, nan_ok=True)


def line_matrix(pose: Float) -> Float:
    """How a pose turns a twist (rotation, then displacement of the origin), by its rotation matrix."""
    quat, place = dq.pose_from_dual_quat(pose)
    turn = Rotation.from_quat(quat, scalar_first=True).as_matrix()
    x, y, z = place
    lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.block([[turn, np.zeros((3, 3))], [lever @ turn, turn]])


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.1, -0.2, 0.3)])
@pytest.mark.parametrize("turn_deg", [(0.0, 0.0, 0.0), (0.0, 0.0, 90.0), (180.0, 0.0, 0.0), (40.0, -70.0, 25.0)])
def test_errors_in_another_frame_are_those_of_what_is_written_there(
    shift: tuple[float, float, float], turn_deg: tuple[float, float, float]
) -> None:
    """Also where that frame is only shifted along one of the axes, or turned about one."""
    rng = np.random.default_rng(8)
    quat = Rotation.from_rotvec(turn_deg, degrees=True).as_quat(scalar_first=True)
    change = dq.dual_quat_from_pose(quat, np.array(shift))
    moved = dq.dual_quat_from_pose(
        Rotation.from_rotvec(rng.normal(size=(5, 3))).as_quat(scalar_first=True), rng.normal(scale=0.2, size=(5, 3))
    )
    roots = rng.normal(scale=1e-3, size=(2, 6, 6))
    frame, reference = roots @ np.swapaxes(roots, 1, 2)
    there = line_matrix(change)
    found = errors_from_covariance(moved, frame, reference, change)
    wanted = errors_from_covariance(
        dq.multiply(dq.multiply(change, moved), dq.conjugate(change)),
        there @ frame @ there.T,
        there @ reference @ there.T,
        dq.dual_quat_from_pose(np.array([1.0, 0, 0, 0]), np.zeros(3)),
    )
    for name in found._fields:
        assert getattr(found, name) == pytest.approx(getattr(wanted, name), rel=1e-9), name


def test_errors_stand_where_their_quantities_do() -> None:
    screw = analyzed().screw
    assert (np.isfinite(screw.axis_sd) == screw.axis_known).all()
    assert (np.isfinite(screw.slide_sd) == np.isfinite(screw.slide)).all()
    assert np.isnan(screw.angle_sd[0])
    assert np.isfinite(screw.angle_sd[screw.axis_known]).all()
    assert np.nanmin(screw.axis_cone / screw.axis_sd) >= 1.73
    assert np.nanmax(screw.axis_cone / screw.axis_sd) <= 1.97


@pytest.mark.parametrize("poses", [4, 25])
def test_a_reference_of_many_poses_errs_by_less(poses: int) -> None:
    """Two poses of one noise make twice its variance, and the mean of n has its n-th part."""
    recording = simulate_trial(rest_before_s=1.0, seed=2).recording
    one, many = (
        analyze(recording, Settings(marker_noise_mm=0.2, reference_window=count)).screw for count in (1, poses)
    )
    wide = one.angle > np.radians(60.0)
    assert wide.any()
    ratio = many.angle_sd[wide] / one.angle_sd[wide]
    assert ratio == pytest.approx(np.sqrt(0.5 * (1.0 + 1.0 / poses)), rel=0.02)


def test_a_filled_frame_has_no_error_of_its_own() -> None:
    recording = simulate_trial(gaps=3, gap_frames=5, seed=1).recording
    screw = analyze(recording, Settings(marker_noise_mm=0.2)).screw
    assert screw.filled.any()
    assert np.isnan(screw.angle_sd[screw.filled]).all()


def test_the_sense_reckons_with_the_noise_that_a_filter_leaves_in_most_frames() -> None:
    """White noise of both passes of a Butterworth filter: the mean of the squared gain over all frequencies."""
    rate_hz, cutoff_hz = 100.0, 6.0
    recording = simulate_trial(proximal="moving", rate_hz=rate_hz, seed=2).recording
    plain = analyze(recording, Settings(marker_noise_mm=0.2)).sense.sigma
    filtered = analyze(recording, Settings(marker_noise_mm=0.2, lowpass_hz=cutoff_hz)).sense.sigma
    sections = butter(2, cutoff_hz / (np.sqrt(2.0) - 1.0) ** 0.25, fs=rate_hz, output="sos")
    one_pass = np.abs(sosfreqz(sections, worN=20_000)[1]) ** 2
    assert filtered / plain == pytest.approx(np.sqrt(np.mean(one_pass**2)), rel=5e-3)


def test_the_least_angle_can_be_a_precision() -> None:
    screw = analyzed(axis_sd_deg=0.5).screw
    assert np.nanmax(screw.axis_sd) <= np.radians(0.5)
    coarse = analyzed(axis_sd_deg=5.0).screw
    assert coarse.axis_known.sum() > screw.axis_known.sum()
    with pytest.raises(AnalysisError, match=r"no axis is known to the 0\.001 deg .* the best is known to 0\.[12]"):
        analyzed(axis_sd_deg=0.001)
    assert settings_from(options={"axis_sd": "2deg"}).axis_sd_deg == 2.0
    assert settings_from(options={"axis_sd": "0.1rad"}).axis_sd_deg == pytest.approx(np.degrees(0.1))
    with pytest.raises(UsageError, match="2deg"):
        settings_from(options={"axis_sd": "2 furlongs"})


def test_from_the_least_angle_on_axes_in_random_directions_are_known_that_well() -> None:
    """An error e tilts a unit axis n by |e - (n.e) n| / (2 sin(theta/2)); frame and reference both have one."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(2, 6, 6))
    proximal, distal = (
        PoseNoise(covariance=1e-6 * half @ half.T, source="made up", marker_noise=None) for half in root
    )
    turn = Rotation.from_rotvec([0.4, -1.0, 0.3])
    motion: Any = SimpleNamespace(reference=dq.dual_quat_from_pose(turn.as_quat(scalar_first=True), [0.1, 0.2, 0.3]))
    back = turn.inv().as_matrix()
    for still, S in (
        (True, distal.covariance[:3, :3]),
        (False, distal.covariance[:3, :3] + back @ proximal.covariance[:3, :3] @ back.T),
    ):
        n = rng.normal(size=(200_000, 3))
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        found = least_angle(0.02, motion, None if still else proximal, distal)
        across = np.trace(S) - np.einsum("ni,ij,nj->n", n, S, n)
        variance = 2.0 * across / (2.0 * np.sin(0.5 * found)) ** 2
        assert np.sqrt(variance.mean()) == pytest.approx(0.02, rel=0.005)
    assert least_angle(1e-6, motion, proximal, distal) == pytest.approx(np.pi)


def test_without_noise_there_are_no_errors_and_no_precision_to_ask_for() -> None:
    recording = simulate_trial(proximal="moving", seed=2).recording
    analysis = analyze(recording, Settings(noise="none"))
    assert np.isnan(analysis.screw.axis_sd).all()
    assert "noise-unknown" in [warning.code for warning in analysis.warnings]
    with pytest.raises(SettingError, match="marker_noise_mm"):
        analyze(recording, Settings(noise="none", axis_sd_deg=1))


def test_an_error_column_that_holds_no_errors_is_no_source() -> None:
    assert pose_noise(body(reported_error=np.full(650, 1e300)), 100.0, Settings(noise="error-column")) is None
    assert pose_noise(body(reported_error=np.full(650, -1.0)), 100.0, Settings(noise="error-column")) is None
