"""Orientations without positions: what directions and angles say is as with positions, and no place is told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from moving_joints import MovingJoint, ball, two_axes
from oracles import known_trial, rodrigues

from elbowscrew import Analysis, Landmarks, Recording, Settings, analyze, compare, interpolate, keyframes_of
from elbowscrew.errors import SettingError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import RigidBody
from elbowscrew.model.anatomy import Landmark
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.quantities import Quantity
from elbowscrew.results.joint_summary import joint_summary
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.results.writing import results_by_table

HINGE = known_trial(110.0, frames=150, inversion=75, slide=0.0, seed=3, gentle=True)
NOISE = np.radians(0.2)


def bodies(R: tuple[Float, Float], p: tuple[Float, Float] | None, *, noise: float = 0.0, seed: int = 0) -> Recording:
    """Two bodies by their matrices, each turned at random in its own frame."""
    rng = np.random.default_rng(seed)
    found = []
    for k, name in enumerate(("upper arm", "forearm")):
        turn = rodrigues_of(noise * rng.normal(size=(len(R[k]), 3)))
        found.append(RigidBody.from_matrices(name, R[k] @ turn, None if p is None else p[k]))
    return Recording.from_bodies(found, rate_hz=100.0)


def rodrigues_of(vector: Float) -> Float:
    """Rotation matrices of small rotation vectors (N, 3), by their quaternions."""
    return np.asarray(quaternion.rotation_matrix_from_quat(quaternion.quat_from_rotation_vector(vector)))


def hinge(*, located: bool, noise: float = 0.0, seed: int = 0, lab: Float | None = None) -> Recording:
    L = np.eye(3) if lab is None else lab
    R = L @ HINGE.proximal_R, L @ HINGE.distal_R
    return bodies(R, (HINGE.proximal_p, HINGE.distal_p) if located and lab is None else None, noise=noise, seed=seed)


def moving(joint: MovingJoint, *, located: bool, noise: float = NOISE, seed: int = 0) -> Recording:
    """A distal body in a still proximal one, with noise of its rotation, and of its position in proportion."""
    rng = np.random.default_rng(seed)
    off = noise * rng.normal(size=(len(joint.poses), 6)) * [1.0, 1.0, 1.0, 0.05, 0.05, 0.05]
    pose = dq.multiply(joint.poses, dq.exp(0.5 * off))
    quat, position = dq.pose_from_dual_quat(pose)
    body = RigidBody.from_quaternions("forearm", quat, position if located else None)
    return Recording.from_bodies([body], rate_hz=100.0)


def angle_to(one: Float, other: Float) -> float:
    """Angle (deg) between two lines."""
    return float(np.degrees(np.arccos(min(abs(float(one @ other)), 1.0))))


def test_theta_and_directions_are_those_with_positions() -> None:
    one, other = (analyze(hinge(located=located)) for located in (True, False))
    assert other.screw.angle == pytest.approx(one.screw.angle, abs=1e-12)
    assert other.screw.axis_direction == pytest.approx(one.screw.axis_direction, abs=1e-9, nan_ok=True)
    assert other.mean_axis.direction == pytest.approx(one.mean_axis.direction, abs=1e-12)
    assert other.screw.angle == pytest.approx(HINGE.angle, abs=1e-9)
    assert other.joint_axis.best is not None
    assert other.joint_axis.best.line.direction_proximal == pytest.approx(HINGE.direction, abs=1e-9)
    assert other.repetitions.top_angle == pytest.approx(one.repetitions.top_angle, abs=1e-12)
    assert other.interpolated.angle_error == pytest.approx(one.interpolated.angle_error, abs=1e-9, nan_ok=True)


def test_with_noise_the_axis_is_that_of_rotations_and_its_cone_as_wide_as_its_error_asks() -> None:
    off, cones = [], []
    for seed in range(40):
        found = analyze(hinge(located=False, noise=NOISE, seed=seed), Settings(joint_type="hinge")).joint_axis.best
        assert found is not None
        off.append(angle_to(found.line.direction_proximal, HINGE.direction))
        cones.append(np.degrees(found.axis_cone))
    covered = float(np.mean(np.array(off) <= np.array(cones) + 1e-12))
    assert 0.85 <= covered <= 1.0  # 95 %, with 40 trials
    assert 0.7 <= float(np.mean(cones) / np.percentile(off, 95.0)) <= 1.7
    assert max(off) < 0.2


def test_a_rotation_of_the_laboratory_changes_nothing() -> None:
    lab = rodrigues(np.array([0.3, -1.0, 0.5]), np.array([2.0]))[0]
    one, other = (analyze(hinge(located=False, noise=NOISE, seed=1, lab=L)) for L in (np.eye(3), lab))
    assert other.screw.angle == pytest.approx(one.screw.angle, abs=1e-9)
    assert other.screw.axis_direction == pytest.approx(one.screw.axis_direction, abs=1e-8, nan_ok=True)
    fits = [found.joint_axis.best for found in (one, other)]
    assert fits[0] is not None
    assert fits[1] is not None
    assert fits[1].line.direction == pytest.approx(fits[0].line.direction, abs=1e-8)
    assert fits[1].axis_cone == pytest.approx(fits[0].axis_cone, rel=1e-6)


def lengths_in(found: Any, path: str = "") -> dict[str, Any]:
    """Numbers of a JSON object whose names say that they are lengths."""
    if isinstance(found, list):
        return {key: one for k, item in enumerate(found) for key, one in lengths_in(item, f"{path}.{k}").items()}
    if not isinstance(found, dict):
        return {}
    own = {f"{path}.{key}": value for key, value in found.items() if "_mm" in key or key.endswith("_m_s")}
    return own | {key: one for name, item in found.items() for key, one in lengths_in(item, f"{path}.{name}").items()}


@pytest.mark.parametrize("kind", ["hinge", "two axes", "ball", "knee"])
def test_no_table_and_no_summary_tells_of_a_place(kind: str) -> None:
    found = unlocated_analysis(kind)
    for name, table in results_by_table(found).items():
        for column in table.table:
            if column.quantity in (Quantity.LENGTH, Quantity.VELOCITY):
                assert np.isnan(column.values(table)).all(), (name, column.name)
    summary: Any = summary_from_analysis(found)
    told = lengths_in({"summary": {**summary, "settings": None}, "joint": joint_summary(found)})
    assert {key for key, value in told.items() if value is not None} == set()
    assert len(told) > 40
    assert summary["trial"]["positions"] is False
    assert [warning["code"] for warning in summary["warnings"]].count("no-positions") == 1


def unlocated_analysis(kind: str) -> Analysis:
    rng = np.random.default_rng(5)
    if kind == "hinge":
        return analyze(hinge(located=False, noise=NOISE), Settings(step_deg=10.0, tolerance_mm="2deg"))
    if kind == "two axes":
        return analyze(moving(two_axes(300, (110.0, 70.0), 88.0, 0.01, rng), located=False), Settings(method="joint"))
    if kind == "ball":
        return analyze(moving(ball(300, 35.0, rng), located=False))
    # An axis that turns by 20 deg over the flexion.
    theta = np.radians(100.0) * np.sin(np.linspace(0.0, np.pi, 300)) ** 2
    z = rodrigues(np.array([0.0, 0.0, 1.0]), theta)
    tilt = rodrigues(np.array([0.0, 1.0, 0.0]), np.radians(20.0) * np.sin(0.5 * theta))
    return analyze(bodies((np.tile(np.eye(3), (300, 1, 1)), z @ tilt), None, noise=NOISE))


def test_an_axis_that_wanders_does_so_without_positions() -> None:
    found = unlocated_analysis("knee").joint_axis
    assert found.wander is not None
    assert found.wander.significant
    assert found.mean_axis is not None
    assert found.path is not None
    assert np.isfinite(found.path.direction).all()


@pytest.mark.parametrize("express_in", ["lab", "distal"])
def test_few_orientations_have_an_axis_and_no_cone(express_in: str) -> None:
    """Too few to tell of a noise that nobody states."""
    few = bodies((HINGE.proximal_R[:75:14], HINGE.distal_R[:75:14]), None, noise=NOISE)
    found = analyze(few, Settings(express_in=express_in, joint_type="hinge")).joint_axis.best
    assert found is not None
    assert np.isfinite(found.line.direction).all()
    assert np.isnan([found.axis_sd, found.axis_cone, found.point_radius]).all()


def test_two_axes_are_found_by_rotation_alone() -> None:
    joint = two_axes(400, (110.0, 70.0), 80.0, 0.01, np.random.default_rng(7))
    one, other = (analyze(moving(joint, located=located)).joint_type for located in (True, False))
    assert one is not None
    assert other is not None
    assert (one.type, other.type) == ("two_axes", "two_axes")
    assert other.two_axes is not None
    assert other.two_axes.distance is None
    assert np.degrees(other.two_axes.angle_between.value) == pytest.approx(80.0, abs=0.5)
    truth = joint.truth
    for line, (name, body) in zip(other.two_axes.lines, (("axis1", "proximal"), ("axis2", "distal")), strict=True):
        direction = getattr(line, f"direction_{body}")
        assert angle_to(direction, truth[name][:3]) <= max(np.degrees(line.axis_cone), 1e-6) * 1.5


def test_three_rotations_are_a_ball_as_far_as_rotations_tell() -> None:
    found = analyze(moving(ball(300, 90.0, np.random.default_rng(2)), located=False))
    kind = found.joint_type
    assert kind is not None
    assert (kind.type, kind.status, kind.ball) == ("ball", "approximate", None)
    assert "orientations alone do not tell" in kind.reason
    assert found.joint_angles is not None
    assert found.joint_angles.angle.shape == (300, 3)
    assert np.isnan(found.joint_angles.angle_sd[1:]).all()  # nothing is left that would tell of the noise


@pytest.mark.parametrize("stated", ["hinge", "two_axes", "ball"])
def test_a_type_may_be_stated(stated: str) -> None:
    found = analyze(hinge(located=False, noise=NOISE), Settings(joint_type=stated)).joint_type
    assert found is not None
    assert (found.type, found.status) == (stated, "forced")


def on_the_spot(radius: float) -> tuple[Recording, float]:
    """The hinge of a body whose points turn about its origin: a displacement of the points is a chord of the angle."""
    angle = HINGE.angle + 0.1 * np.sin(5.0 * np.arange(150) / 20.0)
    R = rodrigues(np.array([1.0, 0.2, 0.1]), angle) @ rodrigues(np.array([0.0, 1.0, 0.3]), 0.3 * np.sqrt(angle + 0.2))
    body = RigidBody.from_matrices("forearm", R, np.tile([0.1, 0.0, 0.0], (150, 1)))
    return Recording.from_bodies([body], rate_hz=100.0), radius * np.sqrt(8.0 / 3.0)


@pytest.mark.parametrize("method", ["sclerp", "sdlb"])
def test_a_tolerance_is_an_angle_and_the_fewest_keyframes_are_those_of_its_chord(method: Any) -> None:
    recording, scale = on_the_spot(0.05)
    unlocated = replace(recording, bodies=tuple(body.without_positions() for body in recording.bodies))
    limit = np.radians(1.5)
    found = analyze(unlocated, Settings(tolerance_mm="1.5deg", method=method))
    by_points = Settings(tolerance_mm=1000.0 * scale * np.sin(0.5 * limit), radius_mm=50.0, method=method)
    assert found.keyframes.row.tolist() == analyze(recording, by_points).keyframes.row.tolist()
    assert np.nanmax(found.interpolated.angle_error) <= limit * (1.0 + 1e-6)
    assert found.selection is not None
    assert found.selection.as_angle
    assert found.selection.tolerance == pytest.approx(limit)
    assert found.selection.largest[-1] == pytest.approx(np.nanmax(found.interpolated.angle_error), rel=1e-6)
    assert found.selection.largest[-2] > limit
    plain = analyze(unlocated, Settings(tolerance_mm=1.5, method=method))
    assert plain.keyframes.row.tolist() == found.keyframes.row.tolist()
    assert "tolerance-in-degrees" in [warning.code for warning in plain.warnings]
    assert "tolerance-in-degrees" not in [warning.code for warning in found.warnings]


def test_what_says_nothing_of_orientations_is_refused() -> None:
    with pytest.raises(SettingError, match="marker_noise_mm: body 'upper arm' has orientations and no positions"):
        analyze(hinge(located=False), Settings(marker_noise_mm=1.0))
    with pytest.raises(SettingError, match=r"joint_type screw-hinge: .* tell of no slide"):
        analyze(hinge(located=False), Settings(joint_type="screw_hinge"))
    with pytest.raises(SettingError, match="the bodies have positions, and the error is a length"):
        analyze(hinge(located=True), Settings(tolerance_mm="2deg"))
    at = Landmark(markers=("a",))
    with pytest.raises(SettingError, match="landmarks: landmarks are places"):
        analyze(hinge(located=False), landmarks=Landmarks(side="right", EL=at, EM=at, US=at, RS=at, GH=at))


def test_positions_of_one_body_alone_are_not_used_and_that_is_told() -> None:
    full, bare = hinge(located=True), hinge(located=False)
    mixed = replace(full, bodies=(full.bodies[0], bare.bodies[1]))
    found = analyze(mixed)
    assert found.screw.angle == pytest.approx(analyze(bare).screw.angle, abs=1e-12)
    assert np.isnan(found.screw.slide).all()
    told = next(warning for warning in found.warnings if warning.code == "no-positions")
    assert "the positions of 'upper arm' are not used" in told.message


def test_stated_turns_of_the_sensors_widen_the_cone() -> None:
    plain, stated = (
        analyze(hinge(located=False, noise=NOISE), Settings(skin_motion=skin)).joint_axis.best
        for skin in (None, (0.0, 3.0))
    )
    assert plain is not None
    assert stated is not None
    assert stated.axis_cone == pytest.approx(np.hypot(plain.axis_cone, stated.skin_cone))
    assert np.radians(0.5) < stated.skin_cone < np.radians(6.0)
    assert np.isnan(stated.skin_radius)


def test_models_are_ranked_by_their_angles() -> None:
    plan = ComparisonPlan(laws=("linear", "polynomial-345"), counts=(2, 3), data=("raw",))
    found = compare(hinge(located=False), plan=plan)
    known = np.isfinite(found.models.rms_angle_error)
    assert known.sum() >= 4
    assert (np.diff(found.models.rms_angle_error[known]) >= 0.0).all()
    assert np.isnan(found.models.rms_displacement).all()
    assert np.isnan(found.models.rms_translation_error).all()
    assert found.models.law[0] == "polynomial-345"
    selection = found.selections["sclerp"]
    assert selection.as_angle
    assert selection.tolerance == pytest.approx(np.radians(2.0))


@pytest.mark.parametrize("method", ["dlb", "sclerp", "joint"])
def test_keyframes_rebuild_the_rotation_and_no_place(method: Any) -> None:
    found = analyze(hinge(located=False), Settings(method=method))
    keyframes = keyframes_of(found)
    rebuilt = interpolate(keyframes, 150)
    assert rebuilt.angle == pytest.approx(found.interpolated.angle, abs=1e-9)
    assert np.isnan(rebuilt.slide).all()
    assert np.isnan(rebuilt.translation).all()
    assert np.isnan(keyframes.translation).all()


def test_filters_gaps_and_another_rate_leave_orientations_as_they_leave_poses() -> None:
    def gapped(recording: Recording) -> Recording:
        lost = []
        for body in recording.bodies:
            pose, loss = body.dual_quat_lab_body.copy(), body.loss.copy()
            pose[40:44], loss[40:44] = np.nan, 1
            lost.append(replace(body, dual_quat_lab_body=pose, loss=loss))
        return replace(recording, bodies=tuple(lost))

    settings = Settings(lowpass_hz=6.0, resample_hz=50.0)
    one, other = (analyze(gapped(hinge(located=located, noise=NOISE)), settings) for located in (True, False))
    assert other.screw.filled.sum() == one.screw.filled.sum()
    assert other.screw.angle == pytest.approx(one.screw.angle, abs=1e-9)
    assert not other.joint.dual_quat_proximal_distal[:, 4:].any()


def test_cases(real_data: Any) -> None:
    from elbowscrew import read_recording

    truth = np.array([0.98, 0.1, 0.17]) / np.linalg.norm([0.98, 0.1, 0.17])
    for name in ("imu_only.csv", "orientations.sto", "imu_zero_pos.csv"):
        found = analyze(read_recording(real_data / "cases" / name), Settings(express_in="proximal"))
        assert np.degrees(found.screw.angle.max()) == pytest.approx(120.0, abs=1e-5)
        assert found.mean_axis.direction == pytest.approx(truth, abs=1e-7)
        best = found.joint_axis.best
        assert best is not None
        assert best.line.direction == pytest.approx(truth, abs=1e-7)
        assert np.isnan(best.line.point).all()
        assert np.isnan(best.point_radius)
        codes = [warning.code for warning in found.warnings]
        assert codes.count("no-positions") == 1
        assert ("constant-positions" in codes) == (name == "imu_zero_pos.csv")
