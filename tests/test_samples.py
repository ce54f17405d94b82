"""The samples are what `simulate` makes, and the analysis finds their truth within the noise."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from typer.testing import CliRunner

from elbowscrew import Settings, analyze, read_landmarks, read_recording, simulate_trial
from elbowscrew.cli.app import app
from elbowscrew.errors import OutputError, UsageError
from elbowscrew.geometry.arrays import Float
from elbowscrew.samples import SAMPLES, copy_to, path
from elbowscrew.study.trials import find_trials

NAMES = ("elbow_paper", "elbow_moving_arm_mm", "elbow_row_tagged", "knee", "elbow_left")
ALL = (*NAMES, "elbow_natural")
STUDY = tuple(f"study/P0{subject}_{trial}" for subject in (1, 2, 3) for trial in (1, 2))
# Of a right elbow at rest in the arm's frame, mm.
AT_REST = {
    "EL": np.array([37.6, -128.1, 7.5]),
    "EM": np.array([-25.6, -130.9, 17.5]),
    "GH": np.array([12.0, 140.0, -94.0]),
    "US": np.array([24.0, -368.0, 60.0]),
    "RS": np.array([58.0, -366.0, 22.0]),
}
WITH_LANDMARKS = ("elbow_left", "elbow_natural", "knee")


@pytest.mark.parametrize("name", [*ALL, STUDY[0]])
def test_the_documented_command_makes_the_sample(
    samples: Path, root: Path, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = re.findall(
        r"^elbowscrew (simulate (\S+)\.csv .*)$", (root / "docs/reference/simulate.md").read_text("utf-8"), re.M
    )
    assert {made for _, made in lines} == {*ALL, *STUDY}
    there = {path.relative_to(samples).with_suffix("").as_posix() for path in samples.rglob("*.csv")}
    assert there == {*ALL, *STUDY, "study/manifest"}
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, shlex.split({made: line for line, made in lines}[name]))
    assert done.exit_code == 0, done.output
    heads = [(folder / f"{name}.csv").read_text("utf-8").splitlines()[0] for folder in (samples, tmp_path)]
    assert heads[0] == heads[1]  # take, unit, layout
    mine, theirs = (json.loads((folder / f"{name}.truth.json").read_text("utf-8")) for folder in (samples, tmp_path))
    assert mine["settings"] == theirs["settings"]
    assert _numbers(mine) == pytest.approx(_numbers(theirs), abs=1e-9)
    landmarks = [folder / f"{name}.landmarks.toml" for folder in (samples, tmp_path)]
    assert [path.is_file() for path in landmarks] == [name in WITH_LANDMARKS] * 2
    if name in WITH_LANDMARKS:
        assert landmarks[0].read_text("utf-8") == landmarks[1].read_text("utf-8")


def _numbers(value: Any) -> list[float]:
    """All numbers of a truth, in its order."""
    if isinstance(value, dict):
        return [number for one in value.values() for number in _numbers(one)]
    if isinstance(value, list):
        return [number for one in value for number in _numbers(one)]
    return [float(value)] if isinstance(value, int | float) else []


@pytest.mark.parametrize("name", [*ALL, *STUDY])
def test_samples_are_made_by_simulate(samples: Path, name: str) -> None:
    truth = json.loads((samples / f"{name}.truth.json").read_text())
    trial = simulate_trial(**truth["settings"])
    recording = read_recording(samples / f"{name}.csv")
    for ours, theirs in zip(trial.recording.bodies, recording.bodies, strict=True):
        known = ours.tracked
        assert (known == theirs.tracked).all()
        sign = np.sign(np.sum(theirs.dual_quat_lab_body * ours.dual_quat_lab_body, axis=1)[known, None])
        assert sign * theirs.dual_quat_lab_body[known] == pytest.approx(ours.dual_quat_lab_body[known], abs=3e-6)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_the_truth_is_found_within_the_noise(samples: Path, name: str, express_in: Any) -> None:
    truth = json.loads((samples / f"{name}.truth.json").read_text())
    analysis = analyze(read_recording(samples / f"{name}.csv"), Settings(express_in=express_in))
    valid = analysis.screw.valid
    # Angle noise: sqrt(2) sigma / (sqrt(m) rho) for each of two bodies (accuracy of a pose from four markers), 4.5 SD.
    sigma_deg = np.degrees(2.0 * truth["settings"]["marker_noise_mm"] / (2.0 * 35.0))
    error = np.degrees(analysis.screw.angle) - truth["theta_deg"]
    assert np.abs(error[valid]).max() < 4.5 * sigma_deg
    found, known = analysis.mean_axis, truth["axis"][express_in]
    tilt = np.degrees(np.arccos(min(1.0, float(found.direction @ known["direction"]))))
    assert tilt < 3.0 * sigma_deg
    assert truth["lost_frames"] == np.flatnonzero(~valid).tolist()


def test_the_paper_like_trial_is_like_the_papers(samples: Path) -> None:
    recording = read_recording(samples / "elbow_paper.csv")
    assert (recording.frame.size, recording.rate_hz) == (450, 100.0)
    assert [len(body.marker_offsets) for body in recording.bodies if body.marker_offsets is not None] == [4, 4]
    analysis = analyze(recording)
    assert analysis.keyframes.frame.tolist() == [0, 211, 449]
    assert analysis.points.origin == "markers"


def test_the_natural_elbow_has_two_axes_within_the_noise(samples: Path) -> None:
    """Flexion of 130 deg and pronation of 60; the axes are those of the truth to the noise of the poses."""
    truth = json.loads((samples / "elbow_natural.truth.json").read_text())
    analysis = analyze(read_recording(samples / "elbow_natural.csv"))
    joint = analysis.joint_type
    assert joint is not None
    assert (joint.type, joint.status) == ("two_axes", "determined")
    assert joint.two_axes is not None
    known = truth["two_axes"]
    for name, line in (("axis1", joint.two_axes.axis1), ("axis2", joint.two_axes.axis2)):
        own = "proximal" if name == "axis1" else "distal"  # there the reference frame's own noise does not matter
        direction = line.direction_proximal if own == "proximal" else line.direction_distal
        assert np.degrees(np.arccos(min(1.0, float(direction @ known[name][own]["direction"])))) < 0.3
    assert joint.two_axes.distance is not None
    assert 1000.0 * joint.two_axes.distance.value == pytest.approx(known["distance_mm"], abs=0.5)
    for k, name in enumerate(("angle1_deg", "angle2_deg")):
        error = np.degrees(joint.angle[:, k]) - truth["joint_angles"][name]
        assert np.sqrt(np.mean(error**2)) < 0.6  # the reference frame's own error among them
    ranges = [np.ptp(truth["joint_angles"][name]) for name in ("angle1_deg", "angle2_deg")]
    assert ranges == pytest.approx([130.0, 60.0], abs=0.1)


@pytest.mark.parametrize("name", WITH_LANDMARKS[:2])
def test_the_bones_of_a_sample_turn_as_its_truth_says(samples: Path, name: str) -> None:
    """By matrices: the frames of humerus and forearm at rest, then the truth's rotations between them."""
    truth = json.loads((samples / f"{name}.truth.json").read_text())
    landmarks = read_landmarks(samples / f"{name}.landmarks.toml")
    analysis = analyze(read_recording(samples / f"{name}.csv"), landmarks=landmarks)
    assert analysis.anatomy is not None
    assert not {warning.code for warning in analysis.warnings if warning.code.startswith("landmark")}
    left = landmarks.side == "left"
    mirror = np.diag([-1.0 if left else 1.0, 1.0, 1.0])
    points = {mark: mirror @ AT_REST[mark] for mark in AT_REST}
    humerus = bone(points["GH"] - (points["EL"] + points["EM"]) / 2, points["EL"] - points["EM"], left=left)
    forearm = bone((points["EL"] + points["EM"]) / 2 - points["US"], points["RS"] - points["US"], left=left)
    axes = [truth["two_axes"][f"axis{k}"] for k in (1, 2)] if "two_axes" in truth else [truth["axis"]]
    turn = Rotation.identity()
    for k, axis in enumerate(axes, start=1):
        angle = np.radians(truth["joint_angles"][f"angle{k}_deg"])
        turn = turn * Rotation.from_rotvec(np.outer(angle, axis["proximal"]["direction"]))
    expected = (Rotation.from_matrix(humerus).inv() * turn * Rotation.from_matrix(forearm)).as_euler("ZXY")
    expected = expected * ([1.0, -1.0, -1.0] if left else [1.0, 1.0, 1.0])
    found = analysis.anatomy
    for angle, column in zip((found.flexion, found.carrying_angle, found.pronation), expected.T, strict=True):
        assert np.degrees(angle) == pytest.approx(np.degrees(column), abs=1.5)  # the reference's noise among them
        assert np.degrees(np.sqrt(np.mean((angle - column) ** 2))) < 0.7
    line = points["EL"] - points["EM"]
    cosine = abs(line @ axes[0]["proximal"]["direction"]) / np.linalg.norm(line)
    limits = found.functional_axis_angle
    assert 2.0 * limits.low - limits.value <= np.arccos(cosine) <= 2.0 * limits.high - limits.value


def test_a_mirrored_motion_has_the_same_anatomy() -> None:
    right, left = (
        simulate_trial(
            side=side, joint_type="two-axes", marker_noise_mm=0.0, frames=100, inversion=45, proximal="moving"
        )
        for side in ("right", "left")
    )
    found = [analyze(trial.recording, landmarks=trial.landmarks).anatomy for trial in (right, left)]
    assert found[0] is not None
    assert found[1] is not None
    for name in ("flexion", "carrying_angle", "pronation"):
        assert getattr(found[1], name) == pytest.approx(getattr(found[0], name), abs=1e-9)
        assert np.ptp(getattr(found[0], name)) > np.radians(10.0)
    assert found[1].functional_axis_angle.value == pytest.approx(found[0].functional_axis_angle.value, abs=1e-6)
    mirror = [-1.0, 1.0, 1.0]
    assert found[1].joint_center_distal == pytest.approx(mirror * found[0].joint_center_distal, abs=1e-12)


def bone(proximal: Float, radial: Float, *, left: bool) -> Float:
    """The ISB's frame of a bone: Y along it, X forward, Z to the subject's right."""
    y = proximal / np.linalg.norm(proximal)
    x = np.cross(y, -radial if left else radial)
    x = x / np.linalg.norm(x)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def test_samples_are_found_by_name(samples: Path) -> None:
    for name in SAMPLES:
        assert path(name).exists()
    assert path("elbow_left.landmarks.toml").is_file()
    assert path("study").is_dir()
    there, known = (
        {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*") if file.is_file()}
        for folder in (path(), samples)
    )
    assert there == known  # of an installed program they are beside it
    with pytest.raises(UsageError, match="no 'kne'; did you mean 'knee'"):
        path("kne")
    with pytest.raises(UsageError, match="there are elbow_paper"):
        path("../README.md")
    assert {"study/manifest", "study"} & set(SAMPLES) == {"study"}
    assert set(SAMPLES) == {*ALL, "study"}


def test_samples_are_copied_and_nothing_is_replaced(samples: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["samples", "--copy", str(tmp_path / "new")])
    assert done.exit_code == 0, done.output
    for file in samples.rglob("*.*"):
        assert (tmp_path / "new" / file.relative_to(samples)).read_bytes() == file.read_bytes()
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "knee.csv").write_text("mine")
    with pytest.raises(OutputError, match=r"knee\.csv: exists already"):
        copy_to(tmp_path / "old")
    assert [file.name for file in (tmp_path / "old").iterdir()] == ["knee.csv"]
    assert all(name in CliRunner().invoke(app, ["samples"]).output for name in SAMPLES)


def test_a_copy_that_was_interrupted_is_finished(samples: Path, tmp_path: Path) -> None:
    files = copy_to(tmp_path)
    kept = tmp_path / "study" / "manifest.csv"
    before = kept.stat().st_mtime_ns
    for file in files:
        if file != kept:
            file.unlink()
    assert copy_to(tmp_path) == files
    assert all(file.read_bytes() == (samples / file.relative_to(tmp_path)).read_bytes() for file in files)
    assert kept.stat().st_mtime_ns == before
    kept.unlink()
    kept.symlink_to(samples / "study" / "manifest.csv")
    with pytest.raises(OutputError, match=r"manifest\.csv: exists already"):
        copy_to(tmp_path)


def test_the_study_has_a_manifest_of_all_its_trials() -> None:
    found = find_trials([str(path("study") / "manifest.csv")])
    assert [trial.columns["subject"] for trial in found.trials] == ["P01", "P01", "P02", "P02", "P03", "P03"]
