"""Orientations in OpenSim's storage, and in plain tables without positions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles import known_trial

from elbowscrew import Recording, read_recording
from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix

TRIAL = known_trial(110.0, frames=60, inversion=30, seed=9)
HEADER = ("DataRate=100.000000", "DataType=Quaternion", "version=3", "OpenSimVersion=4.5", "endheader")
QUAT = tuple(quat_from_rotation_matrix(np.array(R)) for R in (TRIAL.proximal_R, TRIAL.distal_R))


def lines(header: tuple[str, ...] = HEADER) -> list[str]:
    """A whole file, by the description of the format."""
    rows = [*header, "time\thumerus_r_imu\tulna_r_imu"]
    for k in range(60):
        cells = [",".join(f"{x:.9f}" for x in quat[k]) for quat in QUAT]
        rows.append("\t".join([f"{k / 100:.3f}", *cells]))
    return rows


def read(path: Path, rows: list[str]) -> Recording:
    path.write_text("\n".join(rows) + "\n")
    return read_recording(path)


def test_each_cell_of_a_storage_is_an_orientation_and_there_are_no_positions(tmp_path: Path) -> None:
    found = read(tmp_path / "t.sto", lines())
    assert [body.name for body in found.bodies] == ["humerus_r_imu", "ulna_r_imu"]
    assert found.rate_hz == pytest.approx(100.0)
    assert found.time_s == pytest.approx(np.arange(60) / 100.0)
    for body, quat in zip(found.bodies, QUAT, strict=True):
        assert not body.located
        assert np.abs(np.sum(body.dual_quat_lab_body[:, :4] * quat, axis=1)) == pytest.approx(1.0, abs=1e-8)
        assert not body.dual_quat_lab_body[:, 4:].any()
    assert [warning.code for warning in found.warnings] == ["frames-numbered"]


def test_a_header_may_hold_commas_and_come_in_any_order(tmp_path: Path) -> None:
    header = ("version=3", "Description=upper arm, forearm; 2 sensors", "DataType=Quaternion", "", "endheader", "")
    assert len(read(tmp_path / "t.sto", lines(header)).bodies) == 2


def test_blank_cells_and_zeros_are_lost(tmp_path: Path) -> None:
    rows = lines()
    for row, cell in ((10, ""), (12, "0,0,0,0"), (14, "nan,nan,nan,nan"), (16, "0.1,0.1,0.1,0.1")):
        rows[row] = "\t".join([*rows[row].split("\t")[:2], cell])
    found = read(tmp_path / "t.sto", rows)
    assert found.bodies[0].tracked.all()
    assert found.bodies[1].loss_counts() == {"blank": 2, "zero": 1, "invalid": 1}


def test_a_segment_without_a_title_is_not_taken_for_another(tmp_path: Path) -> None:
    rows = [line.replace("\thumerus_r_imu", "") for line in lines()]
    with pytest.raises(RecordingError, match=r"t\.sto:7: expected 5 cells, found 9"):
        read(tmp_path / "t.sto", rows)


def test_a_rate_that_the_times_contradict_is_told(tmp_path: Path) -> None:
    found = read(tmp_path / "t.sto", lines(("DataRate=60", *HEADER[1:])))
    assert found.rate_hz == pytest.approx(100.0)
    assert "frame-rate" in [warning.code for warning in found.warnings]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("DataType=Quaternion", "DataType=double", "found DataType=double"),
        ("DataType=Quaternion", "nRows=60", "found no DataType"),
        ("endheader", "", "no table follows the header"),
        ("\tulna_r_imu", "\thumerus_r_imu", "found humerus_r_imu twice"),
        ("time\t", "seconds\t", "expected 'time' and one column for each segment"),
    ],
)
def test_what_holds_no_orientations_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        read(tmp_path / "t.sto", [row.replace(old, new) for row in lines()])


def test_a_cell_of_other_than_four_numbers_is_refused_with_its_line(tmp_path: Path) -> None:
    rows = lines()
    rows[20] = rows[20].rpartition(",")[0]
    with pytest.raises(RecordingError, match=r"t\.sto:21: expected 9 cells, found 8"):
        read(tmp_path / "t.sto", rows)
    rows[20] = lines()[20].replace(",", ",x", 1)
    with pytest.raises(RecordingError, match=r"t\.sto:21: .*expected a number"):
        read(tmp_path / "t.sto", rows)


def test_units_mean_nothing_here(tmp_path: Path) -> None:
    (tmp_path / "t.sto").write_text("\n".join(lines()) + "\n")
    with pytest.raises(SettingError, match="units"):
        read_recording(tmp_path / "t.sto", units="mm")


def test_a_plain_table_may_have_bodies_without_positions_beside_others(tmp_path: Path) -> None:
    parts = [f"forearm_e{k}" for k in range(4)]
    titles = [*parts, *(f"upper_arm_e{k}" for k in range(4)), *(f"upper_arm_{axis}_mm" for axis in "xyz")]
    rows = [",".join(["frame", "time_s", *titles])]
    for k in range(60):
        cells = [*QUAT[1][k], *QUAT[0][k], *(1000.0 * np.array(TRIAL.proximal_p[k]))]
        rows.append(",".join([str(k), f"{k / 100}", *(f"{x:.9f}" for x in cells)]))
    found = read(tmp_path / "t.csv", rows)
    assert {body.name: body.located for body in found.bodies} == {"forearm": False, "upper_arm": True}
    assert not found.bodies[0].dual_quat_lab_body[:, 4:].any()


def test_some_of_the_numbers_of_a_pose_are_none(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"expected e0\.\.e3, x, y, z, or either alone"):
        read(tmp_path / "t.csv", ["frame,time_s,a_e0,a_e1,a_e2,a_e3,a_x_m", "0,0,1,0,0,0,1", "1,0.1,1,0,0,0,2"])
    with pytest.raises(RecordingError, match=r"expected e0\.\.e3, x, y, z, or either alone"):
        read(tmp_path / "t.csv", ["frame,time_s,a_e0,a_e1,a_e2", "0,0,1,0,0", "1,0.1,1,0,0"])


def test_the_cases(real_data: Path) -> None:
    table, storage = (read_recording(real_data / "cases" / name) for name in ("imu_only.csv", "orientations.sto"))
    for one, other in zip(table.bodies, storage.bodies, strict=True):
        assert not one.located
        assert not other.located
        assert one.dual_quat_lab_body == pytest.approx(other.dual_quat_lab_body, abs=2e-8)


@pytest.mark.parametrize("first", ["Coordinates", "name grf.mot", "results of a run"])
def test_angles_and_forces_are_refused_as_what_they_are(tmp_path: Path, first: str) -> None:
    rows = [first, "version=1", "nColumns=2", "inDegrees=yes", "endheader", "time\telbow_flexion", "0.0\t10", "0.1\t11"]
    with pytest.raises(RecordingError, match=r"joint angles and forces \(\.mot\) are no poses of two bodies; give the"):
        read(tmp_path / "t.mot", rows)


def test_orientations_may_stand_under_a_name(tmp_path: Path) -> None:
    assert len(read(tmp_path / "t.sto", lines(("orientations of a take", *HEADER))).bodies) == 2
