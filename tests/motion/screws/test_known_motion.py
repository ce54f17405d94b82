"""End to end on motions that are known, made by rotation matrices: files in, tables out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from motive_files import bodies_of, write_columns, write_row_tagged
from numpy.typing import NDArray
from oracles import ComplexDualQuaternion, KnownTrial, known_trial, quaternion_xyzw, relative_motion

from elbowscrew import Analysis, Settings, analyze, read_recording
from elbowscrew.geometry.arrays import Float

TRIALS: dict[str, dict[str, Any]] = {
    "95 deg, m": {"top": 95.0, "unit": "Meters"},
    "142 deg, mm": {"top": 142.0, "unit": "Millimeters"},
    "200 deg, cm": {"top": 200.0, "unit": "Centimeters"},
    "180 deg": {"top": 180.0, "unit": "Meters"},
    "142 deg, 1.25": {"top": 142.0, "unit": "Millimeters", "version": "1.25"},
}


def analyzed(
    tmp_path: Path, trial: KnownTrial, settings: Settings, *, lost: NDArray[np.bool_] | None = None, **options: Any
) -> Analysis:
    bodies = bodies_of(trial, seed=9)
    bodies[1].lost = lost
    return analyze(read_recording(write_columns(tmp_path / "take.csv", bodies, **options)), settings)


def angle_between_deg(a: Float, b: Float) -> Float:
    angle: Float = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1)))
    return angle


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
@pytest.mark.parametrize("case", TRIALS.values(), ids=TRIALS.keys())
def test_screw_of_every_frame(tmp_path: Path, case: dict[str, Any], express_in: Any) -> None:
    options = dict(case)
    trial = known_trial(options.pop("top"), seed=4)
    lost = np.isin(np.arange(450), [50, 51, 52, 300, *range(320, 345)])
    result = analyzed(tmp_path, trial, Settings(express_in=express_in), lost=lost, **options).screw
    assert result.valid.tolist() == (~lost).tolist()
    valid = result.valid
    assert np.degrees(np.abs(result.angle - trial.angle))[valid].max() < 1e-6
    large = valid & (np.degrees(trial.angle) > 10.0)
    direction, point = trial.line_in(express_in)
    assert angle_between_deg(result.axis_direction[large], direction).max() < 1e-5
    assert np.abs(result.axis_point[large] - point).max() < 1e-7
    assert np.abs(result.slide - trial.slide)[large].max() < 1e-7
    small = np.degrees(trial.angle) < 10.0 - 1e-6
    for undefined in (result.slide, result.axis_direction, result.axis_point):
        assert np.isnan(undefined[small]).all()
    # Short gaps are filled and marked, the long one stays a gap.
    assert np.flatnonzero(result.filled).tolist() == [50, 51, 52, 300]
    assert np.isnan(result.angle[320:345]).all()
    # A chord over four frames misses a smoothstep by its curvature: h^2/8 times 6 tops.
    chord_deg = np.degrees(trial.angle.max()) * 6.0 * (4 / 211) ** 2 / 8.0
    assert np.degrees(np.abs(result.angle - trial.angle))[result.filled].max() < chord_deg


@pytest.mark.parametrize("top", [95.0, 142.0, 200.0])
def test_six_printed_decimals(tmp_path: Path, top: float) -> None:
    trial = known_trial(top, seed=7)
    result = analyzed(tmp_path, trial, Settings(frozen="keep"), decimals=6).screw
    assert np.degrees(np.abs(result.angle - trial.angle)).max() < 3e-4


@pytest.mark.parametrize("version", ["1.0", "1.1"])
def test_row_tagged_files_give_the_same_motion(tmp_path: Path, version: str) -> None:
    trial = known_trial(142.0, seed=2)
    recording = read_recording(write_row_tagged(tmp_path / "take.csv", bodies_of(trial), version=version))
    result = analyze(recording).screw
    assert np.degrees(np.abs(result.angle - trial.angle)).max() < 1e-6


def test_displacement_is_equation_35_with_continuous_signs(tmp_path: Path) -> None:
    trial = known_trial(200.0, seed=1)
    result = analyzed(tmp_path, trial, Settings()).screw
    R, d = relative_motion(trial)
    assert result.translation == pytest.approx(d, abs=1e-9)
    expected = quaternion_xyzw(R)[:, [3, 0, 1, 2]]
    assert np.abs(np.sum(expected * result.euler_parameters, axis=1)) == pytest.approx(np.ones(450), abs=1e-12)
    assert result.euler_parameters[0] == pytest.approx([1, 0, 0, 0], abs=1e-12)
    assert (np.sum(result.euler_parameters[1:] * result.euler_parameters[:-1], axis=1) > 0).all()


def test_moving_the_laboratory_moves_nothing_seen_from_the_bodies(tmp_path: Path) -> None:
    trial = known_trial(120.0, seed=6)
    change = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    change *= np.sign(np.linalg.det(change))
    shift = np.array([2.0, -1.0, 0.5])
    moved = KnownTrial(
        change @ trial.proximal_R,
        trial.proximal_p @ change.T + shift,
        change @ trial.distal_R,
        trial.distal_p @ change.T + shift,
        trial.angle,
        trial.slide,
        trial.direction,
        trial.point,
    )
    for express_in in ("distal", "proximal"):
        settings = Settings(express_in=express_in)
        one, other = (analyzed(tmp_path, t, settings) for t in (trial, moved))
        assert other.screw.angle == pytest.approx(one.screw.angle, abs=1e-10)
        assert other.screw.axis_direction == pytest.approx(one.screw.axis_direction, abs=1e-9, nan_ok=True)
        assert other.screw.axis_point == pytest.approx(one.screw.axis_point, abs=1e-9, nan_ok=True)
        ours, theirs = one.interpolated.rms_displacement, other.interpolated.rms_displacement
        assert theirs == pytest.approx(ours, abs=1e-10)
    distances = [
        analyzed(tmp_path, trial, Settings(express_in=frame), decimals=4).mean_axis.distance
        for frame in ("distal", "proximal", "lab")
    ]
    assert np.nanmax(distances[0]) > 1e-4
    for distance in distances[1:]:
        assert distance == pytest.approx(distances[0], abs=1e-9, nan_ok=True)
    lab = analyzed(tmp_path, moved, Settings(express_in="lab")).screw
    large = lab.axis_known
    direction, _ = trial.line_in("lab")
    assert angle_between_deg(lab.axis_direction[large], change @ direction).max() < 1e-6


def independent_model(trial: KnownTrial, keyframes: tuple[int, ...]) -> list[ComplexDualQuaternion]:
    """The paper's model: two poses a phase, cycloidal law, in 2x2 complex matrices."""
    R, d = relative_motion(trial)
    quats = quaternion_xyzw(R)[:, [3, 0, 1, 2]]
    start, turn, end = keyframes
    for k in range(1, len(quats)):
        quats[k] *= np.sign(quats[k] @ quats[k - 1])
    quats *= np.sign(quats[0, 0])
    keys = {k: ComplexDualQuaternion.from_pose(quats[k], d[k]) for k in keyframes}
    poses = []
    for i in range(start, end + 1):
        first, last = (start, turn) if i < turn else (turn, end)
        tau = (i - first) / (last - first)
        t = tau - np.sin(2 * np.pi * tau) / (2 * np.pi)
        poses.append(ComplexDualQuaternion.blend([keys[first], keys[last]], [1 - t, t]))
    return poses


@pytest.mark.parametrize("top", [95.0, 142.0, 200.0])
def test_the_papers_model_equals_an_independent_one(tmp_path: Path, top: float) -> None:
    trial = known_trial(top, seed=8)
    settings = Settings(inversion=211, keyframes=(0, 211, 449))
    result = analyzed(tmp_path, trial, settings).interpolated
    expected = independent_model(trial, (0, 211, 449))
    angle = np.array([2.0 * pose.half_angle for pose in expected])
    assert np.degrees(np.abs(np.abs(result.angle) - angle)).max() < 1e-6
    assert np.abs(result.translation - [pose.position for pose in expected]).max() < 1e-8
    assert result.phase.tolist() == [1] * 211 + [2] * 239
    assert result.fraction[[0, 211, 449]] == pytest.approx([0, 0, 1])


def test_model_errors_are_the_distances_between_the_poses(tmp_path: Path) -> None:
    trial = known_trial(110.0, seed=12)
    analysis = analyzed(tmp_path, trial, Settings(radius_mm=40.0))
    result = analysis.interpolated
    R, d = relative_motion(trial)
    # Points with that radius of gyration, alike in all directions: the corners of a cube.
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.04 / np.sqrt(3)
    e = result.euler_parameters
    from scipy.spatial.transform import Rotation

    R_model = Rotation.from_quat(e, scalar_first=True).as_matrix()
    measured = corners @ np.swapaxes(R, 1, 2) + d[:, None]
    modeled = corners @ np.swapaxes(R_model, 1, 2) + result.translation[:, None]
    direct = np.sqrt(np.mean(np.sum((measured - modeled) ** 2, axis=2), axis=1))
    assert result.rms_displacement == pytest.approx(direct, abs=1e-9)
    assert result.translation_error == pytest.approx(np.linalg.norm(d - result.translation, axis=1), abs=1e-9)
    between = Rotation.from_matrix(np.swapaxes(R, 1, 2) @ R_model).magnitude()
    assert result.angle_error == pytest.approx(between, abs=1e-7)
    keys = analysis.keyframes.row
    assert result.rms_displacement[keys] == pytest.approx(np.zeros(3), abs=1e-9)


def test_the_reference_may_be_another_frame_or_a_mean(tmp_path: Path) -> None:
    trial = known_trial(60.0, seed=13)
    shifted = analyzed(tmp_path, trial, Settings(reference=100)).screw
    assert shifted.angle - (trial.angle - trial.angle[100]) == pytest.approx(np.zeros(450), abs=1e-8)
    # Passing the reference the angle goes negative instead of bouncing.
    assert np.degrees(shifted.angle.min()) < -15
    windowed = analyzed(tmp_path, trial, Settings(reference=100, reference_window=21)).screw
    assert np.degrees(np.abs(windowed.angle[110])) < 0.05


def test_one_body_is_the_forearm_of_a_still_arm(tmp_path: Path) -> None:
    trial = known_trial(100.0, seed=14)
    still = KnownTrial(
        np.repeat(np.eye(3)[None], 450, axis=0),
        np.zeros((450, 3)),
        np.swapaxes(trial.proximal_R, 1, 2) @ trial.distal_R,
        (np.swapaxes(trial.proximal_R, 1, 2) @ (trial.distal_p - trial.proximal_p)[:, :, None])[..., 0],
        trial.angle,
        trial.slide,
        trial.direction,
        trial.point,
    )
    path = write_columns(tmp_path / "one.csv", bodies_of(still, ("x", "Rigid Body 7"))[1:])
    analysis = analyze(read_recording(path), Settings(express_in="proximal"))
    assert analysis.proximal is None
    assert analysis.screw.angle == pytest.approx(trial.angle, abs=1e-9)
    large = analysis.screw.axis_known
    assert angle_between_deg(analysis.screw.axis_direction[large], trial.direction).max() < 1e-6
