"""`--joint-type` and ``joint_angles.csv`` as an analysis gives them: zero, senses, columns, files."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, read_recording, save_analysis, simulate_trial
from elbowscrew.configuring import settings_from
from elbowscrew.errors import UsageError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.results.joint_summary import joint_summary
from elbowscrew.results.result_files import RESULT_FILES

FLEXION = np.array([0.98, 0.1, 0.17]) / np.linalg.norm([0.98, 0.1, 0.17])


def hinged(angle: Float, *, name: str = "Forearm", noise: float = 0.0) -> Recording:
    """One body that turns about an axis that stands still."""
    rng = np.random.default_rng(4)
    line = np.concatenate([FLEXION, np.cross([0.02, -0.28, 0.01], FLEXION)])
    turn = dq.exp(0.5 * angle[:, None] * line)
    rest = dq.dual_quat_from_pose(np.array([0.8, 0.6, 0.0, 0.0]), np.array([0.05, -0.4, 0.1]))
    poses = dq.multiply(dq.multiply(turn, rest), dq.exp(noise * rng.normal(size=(angle.size, 6))))
    quat, position = dq.pose_from_dual_quat(poses)
    return Recording.from_bodies([RigidBody.from_quaternions(name, quat, position)], rate_hz=100.0)


def columns_of(path: Path) -> dict[str, list[str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}


def elbow(real_data: Path, **settings: object) -> Analysis:
    recording = read_recording(real_data / "cases" / "two_axis_elbow.csv")
    return analyze(recording, Settings(proximal="none", **settings))  # type: ignore[arg-type]


def test_a_hinges_angle_is_the_one_that_turned_it(tmp_path: Path) -> None:
    angle = np.radians(110.0) * np.sin(np.linspace(0.0, np.pi, 301)) ** 2 - np.radians(10.0)
    angle[0] = 0.0
    for sense in (1.0, -1.0):
        analysis = analyze(hinged(sense * angle))
        found = analysis.joint_angles
        assert found is not None
        assert found.angle[:, 0] == pytest.approx(angle, abs=1e-9)
        best = analysis.joint_axis.best
        assert best is not None
        assert best.line.direction_proximal == pytest.approx(sense * FLEXION, abs=1e-9)  # the right hand's rule
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=(), report=False)
    written = columns_of(folder / "joint_angles.csv")
    assert list(written) == ["frame", "time_s", "angle1_deg", "angle1_sd_deg", "residual_deg", "residual_mm"]
    assert np.array(written["angle1_deg"], dtype=float) == pytest.approx(np.degrees(angle), abs=1e-6)


@pytest.mark.parametrize("lost", [slice(110, 170), slice(60, 120)])
def test_a_hinge_does_not_lose_a_turn_in_a_gap(lost: slice) -> None:
    """Theta does not either: over half a turn the shorter way round is the wrong one."""
    angle = np.radians(900.0) * np.sin(np.linspace(0.0, 0.5 * np.pi, 301)) ** 2
    whole = hinged(angle)
    body = whole.bodies[0]
    quat, position = dq.pose_from_dual_quat(body.dual_quat_lab_body)
    quat[lost] = np.nan
    gap = Recording.from_bodies([RigidBody.from_quaternions(body.name, quat, position)], rate_hz=100.0)
    analysis = analyze(gap, Settings(method="joint", tolerance_mm=5.0))
    found, known = analysis.joint_angles, analysis.screw.valid
    assert found is not None
    assert abs(angle[lost.stop] - angle[lost.start - 1]) > np.pi
    assert found.angle[known, 0] == pytest.approx(angle[known], abs=1e-6)
    assert analysis.screw.angle[known] == pytest.approx(angle[known], abs=1e-6)
    model = analysis.interpolated
    assert np.nanmax(np.abs(model.rms_displacement)) < 0.0051


def test_an_exact_hinge_stated_to_have_two_axes_is_told() -> None:
    """Both axes in one line: two angles of a frame do one and the same."""
    analysis = analyze(hinged(np.radians(900.0) * np.linspace(0.0, 1.0, 301)), Settings(joint_type="two_axes"))
    assert "stated-joint" in {warning.code for warning in analysis.warnings}
    assert analyze(hinged(np.radians(900.0) * np.linspace(0.0, 1.0, 301))).joint_type.type == "hinge"  # type: ignore[union-attr]


def test_the_zero_is_the_reference_whichever_it_is() -> None:
    angle = np.radians(80.0) * np.sin(np.linspace(0.0, np.pi, 201)) ** 2
    for row, sense in ((30, 1.0), (70, -1.0)):  # the larger excursion is positive
        found = analyze(hinged(angle), Settings(reference=row)).joint_angles
        assert found is not None
        assert found.angle[:, 0] == pytest.approx(sense * (angle - angle[row]), abs=1e-9)
        assert found.angle[row, 0] == 0.0


def test_two_angles_stand_in_the_table_with_the_units_asked_for(real_data: Path, tmp_path: Path) -> None:
    analysis = elbow(real_data, angle_unit="rad", length_unit="m")
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=(), report=False, exports=("mat",))
    written = columns_of(folder / "joint_angles.csv")
    names = ["angle1_rad", "angle1_sd_rad", "angle2_rad", "angle2_sd_rad", "residual_rad", "residual_m"]
    assert list(written) == ["frame", "time_s", *names]
    assert len(written["frame"]) == analysis.screw.frame.size
    assert "joint_angles.csv" in RESULT_FILES
    read = np.array([written["angle1_rad"], written["angle2_rad"]], dtype=float)
    # The truth of the case: flexion to 120 deg, pronation to 80 deg, from 0 at the first frame.
    assert np.degrees(read[0].max()) == pytest.approx(120.0, abs=0.5)
    assert np.degrees(np.ptp(read[1])) == pytest.approx(80.0, abs=1.0)
    assert read[:, 0].tolist() == [0.0, 0.0]


def test_the_second_angle_turns_round_on_a_left_side(real_data: Path) -> None:
    """Pronation is positive about the forearm's axis toward the elbow on the right side, the other way on the left."""
    recording = read_recording(real_data / "cases" / "two_axis_elbow.csv")
    angles = {}
    for side in ("right", "left"):
        body = RigidBody.from_quaternions(
            f"{side} forearm", *dq.pose_from_dual_quat(recording.bodies[0].dual_quat_lab_body)
        )
        analysis = analyze(Recording.from_bodies([body], rate_hz=recording.rate_hz), Settings(proximal="none"))
        assert analysis.joint_angles is not None
        assert analysis.joint_type is not None
        two = analysis.joint_type.two_axes
        assert two is not None
        toward = float(two.axis2.direction_distal @ two.axis2.point_distal)
        assert (toward > 0.0) == (side == "right")
        angles[side] = analysis.joint_angles.angle
    assert angles["left"][:, 1] == pytest.approx(-angles["right"][:, 1], abs=1e-6)
    assert angles["left"][:, 0] == pytest.approx(angles["right"][:, 0], abs=1e-6)
    assert angles["right"][:, 0].max() > -angles["right"][:, 0].min()


def test_filled_frames_have_angles_and_no_error_bars() -> None:
    analysis = analyze(simulate_trial(frames=150, inversion=60, gaps=3, gap_frames=5, seed=5).recording)
    found, screw = analysis.joint_angles, analysis.screw
    assert found is not None
    assert screw.filled.any()
    assert np.isfinite(found.angle[:, 0]).tolist() == (screw.valid | screw.filled).tolist()
    for known in (found.angle_sd[:, 0], found.residual_rotation, found.residual_translation):
        assert np.isfinite(known).tolist() == screw.valid.tolist()


@pytest.mark.parametrize("name", ["hinge", "screw_hinge", "two_axes", "ball", "rigid", "free"])
def test_a_type_can_be_stated(name: str, real_data: Path, tmp_path: Path) -> None:
    analysis = elbow(real_data, joint_type=name)
    found = joint_summary(analysis)
    told = found["joint_type"]
    assert (told["type"], told["status"]) == (name, "forced")
    single = name in ("hinge", "screw_hinge")
    assert found["preferred"] == (name if single else None)
    assert found["single_axis"] == single
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=(), report=False)
    has_angles = name not in ("rigid", "free")
    assert (folder / "joint_angles.csv").exists() == has_angles
    if single:
        # The motion is none of a hinge, and that is told: 40 % and more of the rotation are left.
        assert analysis.joint_axis.unexplained > 0.25
        assert "stated-joint" in {warning.code for warning in analysis.warnings}


def test_two_axes_that_the_motion_does_not_show_are_told() -> None:
    angle = np.radians(90.0) * np.sin(np.linspace(0.0, np.pi, 201)) ** 2
    analysis = analyze(hinged(angle, noise=5e-4), Settings(joint_type="two_axes"))
    told = joint_summary(analysis)
    assert (told["joint_type"]["type"], told["joint_type"]["status"]) == ("two_axes", "forced")
    axes = told["two_axes"]
    assert axes is not None
    assert axes["axis2"]["determined"] is False
    assert axes["axis2"]["cone95_deg"] is None
    warned = {warning.code for warning in analysis.warnings}
    assert "stated-joint" in warned
    assert "no-single-axis" not in warned  # it has one


def test_a_type_that_its_frames_do_not_determine_has_no_angles(real_data: Path) -> None:
    found = elbow(real_data).joint_type
    assert found is not None
    assert found.has_angles
    unsure = tuple(replace(one, valid=one.type != "two_axes") for one in found.candidates)
    assert not replace(found, candidates=unsure).has_angles


def test_the_option_takes_hyphens_and_refuses_what_it_does_not_know() -> None:
    assert settings_from(None, {"joint_type": "two-axes"}).stated_joint == "two_axes"
    assert settings_from(None, {"joint_type": "auto"}).stated_joint is None
    with pytest.raises(UsageError, match=r"joint-type: expected auto, rigid, hinge.*found 'saddle'"):
        settings_from(None, {"joint_type": "saddle"})
