"""Synthetic trials: the truth they state is the motion they show."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import Settings, Simulation, analyze, read_landmarks, read_recording, simulate_trial
from elbowscrew.choices import JOINT_NAMES, JointName
from elbowscrew.errors import OutputError, UsageError
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.saving import save_simulation

TYPES: dict[str, dict[str, Any]] = {
    "hinge": {"joint_type": "hinge"},
    "screw-hinge": {"joint_type": "screw-hinge"},
    "wandering": {"joint_type": "hinge", "wander_deg": 6.0},
    "two-axes": {"joint_type": "two-axes", "wander_deg": 2.0},
    "ball": {"joint_type": "ball", "joint": "hip", "top_deg": 70},
    "skin": {"joint_type": "two-axes", "joint": "wrist", "skin_mm": 4.0},
}
SHORT: dict[str, Any] = {"frames": 120, "inversion": 55, "marker_noise_mm": 0.0, "proximal": "moving"}


@pytest.mark.parametrize("joint", JOINT_NAMES)
def test_every_joint_can_be_simulated_and_its_bodies_speak_of_it(joint: JointName) -> None:
    recording = simulate_trial(joint=joint, **SHORT).recording
    assert analyze(recording).named_joint.name == joint


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
@pytest.mark.parametrize("proximal", ["still", "moving"])
def test_the_truth_is_found_again_without_noise(express_in: Any, proximal: Any) -> None:
    trial = simulate_trial(
        marker_noise_mm=0.0, proximal=proximal, top_deg=142, sign_flips=True, gaps=2, repetitions=2, seed=5
    )
    analysis = analyze(trial.recording, Settings(express_in=express_in))
    valid = analysis.screw.valid
    assert np.flatnonzero(~valid).tolist() == trial.truth["lost_frames"]
    assert np.degrees(analysis.screw.angle)[valid] == pytest.approx(np.array(trial.truth["theta_deg"])[valid], abs=1e-7)
    known = analysis.screw.axis_known & valid
    assert 1000 * analysis.screw.slide[known] == pytest.approx(np.array(trial.truth["slide_mm"])[known], abs=1e-6)
    truth = trial.truth["axis"][express_in]
    assert analysis.mean_axis.direction == pytest.approx(truth["direction"], abs=1e-9)
    assert 1000 * analysis.mean_axis.point == pytest.approx(truth["point_mm"], abs=1e-6)
    assert trial.truth["inversion_frames"] == [211, 211 + 449]


def test_the_angles_of_a_row_tagged_file_are_those_of_its_quaternions(tmp_path: Path) -> None:
    """R = Rx(roll) Rz(pitch) Ry(yaw): turns about axes that go along, written as yaw, pitch, roll."""
    trial = simulate_trial(proximal="moving", frames=120, inversion=60, seed=2)
    export, _ = save_simulation(trial, tmp_path / "t.csv", layout="row-tagged")
    rows = [line.split(",") for line in export.read_text("utf-8").splitlines()]
    bodies = [row[first + 1 : first + 11] for row in rows if row[0] == "frame" for first in (4, 15) if row[3] == "2"]
    found = np.array(bodies, dtype=float)
    assert len(found) == 240
    angles = Rotation.from_quat(found[:, 3:7]).as_euler("XZY", degrees=True)
    assert np.ptp(angles[:, 2]) > 40.0
    assert found[:, [9, 8, 7]] == pytest.approx(angles, abs=1e-4)


@pytest.mark.parametrize("layout", ["motive", "row-tagged"])
@pytest.mark.parametrize("unit", ["m", "cm", "mm"])
def test_written_trials_are_read_back(tmp_path: Path, layout: Any, unit: Any) -> None:
    trial = simulate_trial(proximal="moving", gaps=3, sign_flips=True, frames=120, inversion=60, seed=2)
    if layout == "row-tagged" and unit != "m":
        with pytest.raises(UsageError, match="meters"):
            save_simulation(trial, tmp_path / "t.csv", layout=layout, length_unit=unit)
        return
    export, truth = save_simulation(trial, tmp_path / "t.csv", layout=layout, length_unit=unit)
    assert truth == tmp_path / "t.truth.json"
    assert json.loads(truth.read_text())["settings"]["seed"] == 2
    recording = read_recording(export)
    for ours, theirs in zip(trial.recording.bodies, recording.bodies, strict=True):
        assert ours.name == theirs.name
        assert (ours.tracked == theirs.tracked).all()
        known = ours.tracked
        same = theirs.dual_quat_lab_body[known] * np.sign(
            np.sum(theirs.dual_quat_lab_body * ours.dual_quat_lab_body, axis=1)[known, None]
        )
        assert same == pytest.approx(ours.dual_quat_lab_body[known], abs=3e-6)
        assert theirs.marker_offsets == pytest.approx(ours.marker_offsets, abs=3e-6)
    assert recording.rate_hz == pytest.approx(100.0)


@pytest.mark.parametrize("joint_type", ["hinge", "two-axes"])
def test_intervals_are_those_of_the_trial_saved_and_read(tmp_path: Path, joint_type: Any) -> None:
    """The markers are as well known in memory: without them the 5 mm of skin were no part of the intervals."""
    trial = simulate_trial(proximal="moving", joint_type=joint_type, skin_mm=5.0, gaps=2, frames=240, inversion=100)
    export, _ = save_simulation(trial, tmp_path / "t.csv")
    radii = []
    for recording in (trial.recording, read_recording(export)):
        found = analyze(recording)
        told = found.joint_type
        assert told is not None
        if joint_type == "hinge":
            best = found.joint_axis.best
            assert best is not None
            assert best.decided_by == "A"
            radii.append([best.axis_cone, best.point_radius])
        else:
            assert told.two_axes is not None
            assert told.decided_by == "A"
            radii.append([r for line in told.two_axes.lines for r in (line.axis_cone, line.point_radius)])
    assert radii[0] == pytest.approx(radii[1], rel=1e-3)


def test_what_is_exact_tells_of_no_noise() -> None:
    for body in simulate_trial(marker_noise_mm=0.0).recording.bodies:
        assert body.marker_residual is None
        assert body.marker_motion is None


def test_the_seed_decides() -> None:
    one, same, other = (simulate_trial(seed=seed) for seed in (1, 1, 2))
    first = one.recording.bodies[1].dual_quat_lab_body
    assert (first == same.recording.bodies[1].dual_quat_lab_body).all()
    assert not np.allclose(first, other.recording.bodies[1].dual_quat_lab_body)


def test_the_noise_is_as_large_as_asked() -> None:
    trial = simulate_trial(marker_noise_mm=0.5, frames=2000, inversion=900, seed=3)
    clean = simulate_trial(marker_noise_mm=0.0, frames=2000, inversion=900, seed=3)
    noise = trial.markers["Forearm"] - clean.markers["Forearm"]
    assert 1000 * noise.std() == pytest.approx(0.5, rel=0.02)
    assert np.abs(1000 * noise.mean(axis=(0, 1))).max() < 0.02


def test_rests_come_before_and_after() -> None:
    trial = simulate_trial(marker_noise_mm=0.0, rest_before_s=0.5, rest_after_s=0.25, repetitions=2)
    theta = np.array(trial.truth["theta_deg"])
    assert theta.size == Simulation(rest_before_s=0.5, rest_after_s=0.25, repetitions=2).total_frames == 974
    assert (theta[:50] == 0).all()
    assert (theta[-25:] == 0).all()
    assert theta[trial.truth["inversion_frames"]] == pytest.approx([130, 130])


@pytest.mark.parametrize(
    "settings",
    [{"frames": 2}, {"inversion": 449}, {"inversion": 0}, {"top_deg": 0.0}, {"top_deg": float("nan")},
     {"rate_hz": 0.0}, {"marker_noise_mm": -1.0}, {"gaps": 100}, {"seed": -1}, {"rest_after_s": -1.0},
     {"pronation_deg": 0.0, "joint_type": "two-axes"}, {"pronation_deg": 20.0}, {"skin_mm": -1.0},
     {"slide_mm": 3.0, "joint_type": "hinge"}, {"wander_deg": 2.0, "joint_type": "ball"}],
)  # fmt: skip
def test_impossible_trials_are_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="simulate: "):
        simulate_trial(**settings)


def test_existing_files_are_kept(tmp_path: Path) -> None:
    trial = simulate_trial(frames=20, inversion=10)
    (tmp_path / "t.truth.json").write_text("mine")
    with pytest.raises(OutputError, match="--force"):
        save_simulation(trial, tmp_path / "t.csv")
    assert not (tmp_path / "t.csv").exists()
    assert (tmp_path / "t.truth.json").read_text() == "mine"


@pytest.mark.parametrize("name", TYPES)
def test_a_left_joint_is_the_right_one_in_a_mirror(name: str) -> None:
    """Places turn round in x; rotations, as axial vectors, in y and z. Angles stay."""
    right, left = (simulate_trial(**SHORT, **TYPES[name], side=side, seed=4) for side in ("right", "left"))
    for body, mirrored in zip(right.recording.bodies, left.recording.bodies, strict=True):
        assert (body.name.split()[0], mirrored.name.split()[0]) == ("Right", "Left")
        R, place = _pose(body.dual_quat_lab_body)
        mirror = np.diag([-1.0, 1.0, 1.0])
        assert _pose(mirrored.dual_quat_lab_body)[0] == pytest.approx(mirror @ R @ mirror, abs=1e-12)
        assert _pose(mirrored.dual_quat_lab_body)[1] == pytest.approx(place @ mirror, abs=1e-12)
        assert left.markers[mirrored.name] == pytest.approx(right.markers[body.name] @ mirror, abs=1e-12)
    assert left.truth["theta_deg"] == pytest.approx(right.truth["theta_deg"], abs=1e-9)
    for column, angle in right.truth["joint_angles"].items():
        sign = -1.0 if column in ("rotation_y_deg", "rotation_z_deg") else 1.0  # a vector in the body, not an angle
        assert left.truth["joint_angles"][column] == pytest.approx(sign * np.array(angle), abs=1e-9)
    if "slide_mm" in right.truth:  # a screw is right-handed on one side only
        assert left.truth["slide_mm"] == pytest.approx(-np.array(right.truth["slide_mm"]), abs=1e-12)
    if "two_axes" in right.truth:
        for key, sign in (("angle_between_deg", 1), ("distance_mm", -1), ("foot1_mm", -1), ("foot2_mm", -1)):
            assert left.truth["two_axes"][key] == pytest.approx(sign * right.truth["two_axes"][key])


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_truth_of_two_axes_rebuilds_the_motion(side: Any) -> None:
    """By SciPy's rotations: first about axis 2, then about axis 1, both where they are at the start."""
    from scipy.spatial.transform import Rotation

    trial = simulate_trial(**SHORT, joint_type="two-axes", pronation_deg=80.0, side=side)
    R, place = _relative(trial.recording)
    truth = trial.truth["two_axes"]
    rotation, position = R[0][None], place[0][None]
    for axis, angle in (("axis2", "angle2_deg"), ("axis1", "angle1_deg")):
        h, p = (np.array(truth[axis]["proximal"][key]) for key in ("direction", "point_mm"))
        turn = Rotation.from_rotvec(np.radians(trial.truth["joint_angles"][angle])[:, None] * h).as_matrix()
        position = np.einsum("nij,nj->ni", turn, position - 1e-3 * p) + 1e-3 * p
        rotation = turn @ rotation
    assert rotation == pytest.approx(R, abs=1e-9)
    assert position == pytest.approx(place, abs=1e-9)
    turned = np.radians(trial.truth["theta_deg"])
    assert 2.0 * np.cos(turned) + 1.0 == pytest.approx(np.trace(R @ R[0].T, axis1=1, axis2=2), abs=1e-9)
    assert np.ptp(trial.truth["joint_angles"]["angle2_deg"]) == pytest.approx(80.0, rel=2e-3)
    # The common normal by the points of both lines: its ends are on them, and it is as long as the truth says.
    ends = []
    for axis, body, foot in (("axis1", "proximal", "foot1_mm"), ("axis2", "distal", "foot2_mm")):
        h, p = (np.array(truth[axis][body][key]) for key in ("direction", "point_mm"))
        end = 1e-3 * (p + truth[foot] * h)
        ends.append(end if body == "proximal" else R[0] @ end + place[0])
    h1, h2 = (np.array(truth[axis]["proximal"]["direction"]) for axis in ("axis1", "axis2"))
    normal = np.cross(h1, h2) / np.linalg.norm(np.cross(h1, h2))
    assert ends[1] - ends[0] == pytest.approx(1e-3 * truth["distance_mm"] * normal, abs=1e-12)
    assert np.cos(np.radians(truth["angle_between_deg"])) == pytest.approx(abs(h1 @ h2))


def test_the_truth_of_a_ball_rebuilds_the_motion() -> None:
    from scipy.spatial.transform import Rotation

    trial = simulate_trial(**SHORT, joint_type="ball", joint="shoulder", top_deg=100.0)
    R, place = _relative(trial.recording)
    center, own = (1e-3 * np.array(trial.truth["ball"][f"center_in_{body}_mm"]) for body in ("proximal", "distal"))
    assert R @ own + place == pytest.approx(np.tile(center, (120, 1)), abs=1e-12)
    vector = np.radians(np.stack([trial.truth["joint_angles"][f"rotation_{x}_deg"] for x in "xyz"], axis=1))
    assert Rotation.from_rotvec(vector).as_matrix() @ R[0] == pytest.approx(R, abs=1e-9)
    assert np.degrees(np.linalg.norm(vector, axis=1)) == pytest.approx(np.array(trial.truth["theta_deg"]), abs=1e-9)
    # Three directions of their own: no line and no plane of rotation vectors.
    assert np.degrees(np.linalg.svd(vector - vector.mean(axis=0))[1] / np.sqrt(120)).min() > 5.0


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("proximal", ["still", "moving"])
def test_two_axes_are_found_again(side: Any, proximal: Any) -> None:
    trial = simulate_trial(joint_type="two-axes", side=side, proximal=proximal, marker_noise_mm=0.0)
    joint = analyze(trial.recording).joint_type
    assert joint is not None
    assert (joint.type, joint.status) == ("two_axes", "determined")
    two, truth = joint.two_axes, trial.truth["two_axes"]
    assert two is not None
    for name, line in (("axis1", two.axis1), ("axis2", two.axis2)):
        for body in ("proximal", "distal"):
            direction, point = (getattr(line, f"{key}_{body}") for key in ("direction", "point"))
            assert direction == pytest.approx(truth[name][body]["direction"], abs=1e-8)
            assert np.cross(direction, 1e3 * point - truth[name][body]["point_mm"]) == pytest.approx(
                np.zeros(3), abs=1e-6
            )
    assert np.degrees(two.angle_between.value) == pytest.approx(truth["angle_between_deg"], abs=1e-6)
    for key, measure in (("distance_mm", two.distance), ("foot1_mm", two.foot1), ("foot2_mm", two.foot2)):
        assert measure is not None
        assert 1e3 * measure.value == pytest.approx(truth[key], abs=1e-6)
    for k in range(2):
        told = trial.truth["joint_angles"][f"angle{k + 1}_deg"]
        assert np.degrees(joint.angle[:, k]) == pytest.approx(np.array(told), abs=1e-7)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_ball_is_found_again(side: Any) -> None:
    trial = simulate_trial(joint_type="ball", joint="hip", top_deg=90.0, side=side, marker_noise_mm=0.0)
    joint = analyze(trial.recording).joint_type
    assert joint is not None
    assert (joint.type, joint.status) == ("ball", "determined")
    assert joint.ball is not None
    assert 1e3 * joint.ball.center_proximal == pytest.approx(trial.truth["ball"]["center_in_proximal_mm"], abs=1e-6)
    assert 1e3 * joint.ball.center_distal == pytest.approx(trial.truth["ball"]["center_in_distal_mm"], abs=1e-6)
    for k, axis in enumerate("xyz"):
        told = trial.truth["joint_angles"][f"rotation_{axis}_deg"]
        assert np.degrees(joint.angle[:, k]) == pytest.approx(np.array(told), abs=1e-7)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("kind", ["hinge", "screw-hinge"])
def test_one_axis_is_found_again(side: Any, kind: Any) -> None:
    trial = simulate_trial(joint_type=kind, side=side, marker_noise_mm=0.0)
    analysis = analyze(trial.recording)
    assert analysis.joint_type is None or analysis.joint_type.type == kind.replace("-", "_")
    assert trial.truth["joint_type"] == kind.replace("-", "_")
    found = analysis.joint_axis
    assert found.preferred == kind.replace("-", "_")
    assert found.best is not None
    assert found.best.line.direction == pytest.approx(trial.truth["axis"]["distal"]["direction"], abs=1e-8)
    truth = np.array(trial.truth["axis"]["distal"]["point_mm"])
    assert np.cross(found.best.line.direction, 1e3 * found.best.line.point - truth) == pytest.approx(
        np.zeros(3), abs=1e-6
    )
    slide = {"hinge": 0.0, "screw-hinge": 3.0}[kind] * (-1.0 if side == "left" else 1.0)
    assert trial.truth["slide_mm"][211] == pytest.approx(slide)


def test_markers_move_with_flexion_as_far_as_asked_and_as_the_truth_says() -> None:
    trial = simulate_trial(**{**SHORT, "proximal": "still"}, joint_type="hinge", skin_mm=5.0, seed=7)
    clean = simulate_trial(**{**SHORT, "proximal": "still"}, joint_type="hinge", seed=7)
    course: dict[str, Callable[[Any], Any]] = {
        "u": lambda u: u,
        "sin(pi u/2)": lambda u: np.sin(np.pi * u / 2),
        "u^2": np.square,
        "sin(pi u)": lambda u: np.sin(np.pi * u),
    }
    share = np.array(trial.truth["theta_deg"]) / 130.0
    bodies = zip(trial.recording.bodies, clean.recording.bodies, strict=True)
    for body, exact in bodies:
        R, _ = _pose(exact.dual_quat_lab_body)
        moved = np.einsum("nji,nmj->nmi", R, trial.markers[body.name] - clean.markers[body.name])
        for k, told in enumerate(trial.truth["skin"][body.name]):
            assert np.linalg.norm(told["direction"]) == pytest.approx(1.0)
            expected = 5e-3 * course[told["course"]](share)[:, None] * told["direction"]
            assert moved[:, k] == pytest.approx(expected, abs=1e-12)
        assert np.linalg.norm(moved, axis=2).max(axis=0) == pytest.approx(5e-3, rel=1e-3)
        assert moved[0] == pytest.approx(np.zeros((4, 3)), abs=1e-12)
        # The pose is that of the markers as seen: no rigid motion brings them nearer to their places.
        R, place = _pose(body.dual_quat_lab_body)
        back = np.einsum("nji,nmj->nmi", R, trial.markers[body.name] - place[:, None])
        left = back - body.marker_offsets
        assert body.marker_offsets is not None
        assert left.mean(axis=1) == pytest.approx(np.zeros((120, 3)), abs=1e-9)
        assert np.cross(body.marker_offsets, left).sum(axis=1) == pytest.approx(np.zeros((120, 3)), abs=1e-9)


def test_skin_leaves_the_noise_as_it_was() -> None:
    with_skin, without = (simulate_trial(frames=60, inversion=30, skin_mm=skin, seed=3) for skin in (2.0, 0.0))
    still = with_skin.markers["Upper Arm"][0] - without.markers["Upper Arm"][0]
    assert still == pytest.approx(np.zeros((4, 3)), abs=1e-12)


def test_former_names_are_understood() -> None:
    one, other = simulate_trial(axis_drift_deg=5.0, arm="moving"), simulate_trial(wander_deg=5.0, proximal="moving")
    assert one.truth == other.truth
    assert one.truth["settings"]["wander_deg"] == 5.0


def test_an_axis_wanders_as_far_as_asked() -> None:
    """The finite rotation to the top is about a line that far from the one the motion starts about."""
    trial = simulate_trial(joint_type="hinge", wander_deg=6.0, marker_noise_mm=0.0)
    R, _ = _relative(trial.recording)
    turn = R[211] @ R[0].T
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    start = trial.truth["axis"]["proximal"]["direction"]
    assert np.degrees(np.arccos(axis @ start / np.linalg.norm(axis))) == pytest.approx(6.0, abs=1e-9)


def _pose(dual_quat: Any) -> tuple[Any, Any]:
    """Rotation matrices and places, by the matrix form of the quaternion product."""
    q, dual = dual_quat[:, :4], dual_quat[:, 4:]
    w, v, dw, dv = q[:, :1], q[:, 1:], dual[:, :1], dual[:, 1:]
    return rotation_matrix_from_quat(q), 2.0 * (w * dv - dw * v - np.cross(dv, v))


def _relative(recording: Any) -> tuple[Any, Any]:
    (A, a), (F, f) = (_pose(body.dual_quat_lab_body) for body in recording.bodies)
    return np.swapaxes(A, 1, 2) @ F, np.einsum("nji,nj->ni", A, f - a)


def test_an_elbows_landmarks_are_written_as_they_are_read(tmp_path: Path) -> None:
    trial = simulate_trial(side="left", **SHORT)
    *_, path = save_simulation(trial, tmp_path / "t.csv", landmarks=True)
    found, made = read_landmarks(path), trial.landmarks
    assert path.name == "t.landmarks.toml"
    assert made is not None
    assert found.side == made.side == "left"
    for name, mark in made.by_name.items():
        assert found.by_name[name].frame == mark.frame
        assert found.by_name[name].point == pytest.approx(mark.point, abs=5.1e-6)
    save_simulation(trial, tmp_path / "t.csv", landmarks=True, overwrite=True)
    with pytest.raises(UsageError, match="only an elbow and a knee have landmarks"):
        save_simulation(simulate_trial(joint="wrist", **SHORT), tmp_path / "k.csv", landmarks=True)
    assert not list(tmp_path.glob("k.*"))
