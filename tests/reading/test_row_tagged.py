"""The row-tagged layout of Tracking Tools."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from motive_files import bodies_of, write_row_tagged
from oracles import known_trial

from elbowscrew import read_recording
from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry import dual_quaternion as dq

TRIAL = known_trial(95.0, frames=30, inversion=14, seed=5)


@pytest.mark.parametrize("version", ["1.0", "1.1"])
@pytest.mark.parametrize("quoted", [True, False])
def test_poses_are_matched_by_id_and_absent_bodies_are_lost(tmp_path: Path, version: str, quoted: bool) -> None:
    bodies = bodies_of(TRIAL)
    bodies[1].lost = np.isin(np.arange(30), [4, 5, 29])
    bodies[0].lost = np.isin(np.arange(30), [5])
    path = write_row_tagged(tmp_path / "take.csv", bodies, version=version, quoted=quoted)
    recording = read_recording(path)
    assert recording.source is not None
    assert recording.source.layout == f"row-tagged {version}"
    proximal, distal = recording.bodies
    assert (proximal.name, distal.name) == ("Upper Arm", "Forearm")
    assert proximal.loss_counts() == {"absent": 1}
    assert distal.loss_counts() == {"absent": 3}
    for body, R, p in ((proximal, TRIAL.proximal_R, TRIAL.proximal_p), (distal, TRIAL.distal_R, TRIAL.distal_p)):
        matrix = dq.matrix_from_dual_quat(body.dual_quat_lab_body[body.tracked])
        assert matrix[:, :3, :3] == pytest.approx(R[body.tracked], abs=1e-12)
        assert matrix[:, :3, 3] == pytest.approx(p[body.tracked], abs=1e-12)
    assert distal.marker_offsets == pytest.approx(np.array([[0.04, 0, 0], [-0.02, 0.03, 0], [-0.02, -0.03, 0]]))
    assert recording.rate_hz == pytest.approx(100.0)


def edited(tmp_path: Path, old: str, new: str) -> Path:
    path = write_row_tagged(tmp_path / "take.csv", bodies_of(TRIAL))
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return path


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("righthanded", "lefthanded", "left-handed"),
        ('rigidbody,"Forearm",2', 'rigidbody,"Forearm",7', "not certain which pose is whose"),
        ('rigidbody,"Forearm",2,3,', 'rigidbody,"Forearm",2,4,1,2,1e308,', "10 km"),
        ("frame,7,0.07000000,2", "frame,7,0.07000000,3", "cut"),
        ("frame,7,0.07000000,2", "frame,7,abc,2", "expected a number, found 'abc'"),
        ("frame,7,0.07000000,2,2", "frame,7,0.07000000,2,1", "twice in the frame"),
        ("frame,7,", "frame,7.5,", "whole number"),
        ("frame,7,", "frame,1e19,", "whole number"),
        ("frame,7,", "fram,7,", "expected one of"),
    ],
)
def test_what_is_not_certain_is_refused_with_its_place(tmp_path: Path, old: str, new: str, says: str) -> None:
    with pytest.raises(RecordingError, match=says):
        read_recording(edited(tmp_path, old, new))


def test_a_wrong_frame_count_is_a_warning(tmp_path: Path) -> None:
    recording = read_recording(edited(tmp_path, "info,framecount,30", "info,framecount,31"))
    assert [warning.code for warning in recording.warnings] == ["frame-count"]


def test_the_unit_is_always_meters(tmp_path: Path) -> None:
    path = write_row_tagged(tmp_path / "take.csv", bodies_of(TRIAL))
    with pytest.raises(SettingError, match="row-tagged"):
        read_recording(path, units="mm")


def test_bodies_may_be_named_by_a_number(tmp_path: Path) -> None:
    path = write_row_tagged(tmp_path / "take.csv", bodies_of(TRIAL, ("1", "2")), quoted=False)
    assert [body.name for body in read_recording(path).bodies] == ["1", "2"]


def test_semicolons_and_decimal_commas(tmp_path: Path) -> None:
    path = write_row_tagged(tmp_path / "take.csv", bodies_of(TRIAL), decimals=8)
    plain = read_recording(path)
    path.write_text(path.read_text().replace(",", ";").replace(".", ","))
    resaved = read_recording(path)
    for one, other in zip(plain.bodies, resaved.bodies, strict=True):
        assert (one.dual_quat_lab_body == other.dual_quat_lab_body).all()
