"""Qualisys's 6D export: poses by its matrices, which stand column by column; blanks and zeros are lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles import known_trial

from elbowscrew import Settings, analyze, read_recording
from elbowscrew.errors import NoBodiesError, RecordingError, SettingError

TRIAL = known_trial(110.0, frames=60, inversion=30, seed=9)


def lines() -> list[str]:
    """A whole file, by the description of the format."""
    stated = [("NO_OF_FRAMES", "60"), ("NO_OF_CAMERAS", "8"), ("NO_OF_BODIES", "2"), ("FREQUENCY", "100")]
    stated += [
        ("TIME_STAMP", "2024-03-14, 10:11:12\t1.5"),
        ("DATA_INCLUDED", "6D"),
        ("BODY_NAMES", "Upper Arm\tForearm"),
    ]
    columns = ["Y", "Z", "Roll", "Pitch", "Yaw", "Residual", *(f"Rot[{k}]" for k in range(9))]
    rows = ["\t".join(pair) for pair in stated]
    rows.append("\t".join(["Frame", "Time", "Upper Arm X", *columns, "Forearm X", *columns]) + "\t")
    for k in range(60):
        cells = [str(k + 1), f"{k / 100:.5f}"]
        for R, p in ((TRIAL.proximal_R, TRIAL.proximal_p), (TRIAL.distal_R, TRIAL.distal_p)):
            down = [R[k][row][column] for column in range(3) for row in range(3)]
            cells += [f"{x:.9f}" for x in (*(1000.0 * p[k]), 1.0, 2.0, 3.0, 0.4, *down)]
        rows.append("\t".join(cells) + "\t")
    return rows


def write(path: Path, rows: list[str]) -> Path:
    path.write_text("\r\n".join(rows) + "\r\n")
    return path


def test_poses(tmp_path: Path) -> None:
    recording = read_recording(write(tmp_path / "t.tsv", lines()))
    assert [body.name for body in recording.bodies] == ["Upper Arm", "Forearm"]
    assert recording.rate_hz == pytest.approx(100.0)
    assert recording.warnings == ()
    assert analyze(recording).screw.angle == pytest.approx(TRIAL.angle, abs=1e-7)


def test_blank_and_zero_poses_are_lost_and_others_that_are_none_are_told(tmp_path: Path) -> None:
    rows = lines()
    for row, written in ((12, ""), (14, "0.000"), (16, "0.7"), (18, "nan")):
        cells = rows[row].split("\t")
        rows[row] = "\t".join([*cells[:18], *([written] * 16), ""])
    found = read_recording(write(tmp_path / "t.tsv", rows))
    assert found.bodies[0].tracked.all()
    assert found.bodies[1].loss_counts() == {"blank": 2, "zero": 1, "invalid": 1}
    assert [warning.code for warning in found.warnings] == ["invalid-pose"]


def test_what_may_be_left_out_on_export(tmp_path: Path) -> None:
    whole = read_recording(write(tmp_path / "t.tsv", lines()))
    rows = lines()
    titles = next(k for k, row in enumerate(rows) if row.startswith("Frame"))
    lost = rows[titles + 5].split("\t")
    rows[titles + 5] = "\t".join([*lost[:2], *([""] * (len(lost) - 2))])
    without_clock = [row.split("\t", 2)[2] for row in rows[titles:]]
    events = [f"EVENT\tE{k}\t{k}\t{k / 100}" for k in range(60)]
    newer = ["FILE_VERSION\t2.0.0", *rows[:titles], *events]
    for case in ([*newer, *rows[titles:]], rows[titles:], [*newer, *without_clock]):
        found = read_recording(write(tmp_path / "u.tsv", case))
        assert [body.name for body in found.bodies] == ["Upper Arm", "Forearm"]
        assert found.rate_hz == pytest.approx(100.0)
        assert (found.frame - found.frame[0]).tolist() == list(range(60))
        assert (found.time_s - found.time_s[0]) == pytest.approx(np.arange(60) / 100.0)
        for one, other in zip(found.bodies, whole.bodies, strict=True):
            assert np.flatnonzero(~one.tracked).tolist() == [4]
            assert np.array_equal(one.dual_quat_lab_body[5:], other.dual_quat_lab_body[5:])
    with pytest.raises(RecordingError, match="no times and no FREQUENCY"):
        read_recording(write(tmp_path / "u.tsv", without_clock))


def test_decimal_commas(tmp_path: Path) -> None:
    whole = read_recording(write(tmp_path / "t.tsv", lines()))
    german = [row if k < 7 else row.replace(".", ",") for k, row in enumerate(lines())]
    found = read_recording(write(tmp_path / "u.tsv", german))
    assert np.array_equal(found.bodies[1].dual_quat_lab_body, whole.bodies[1].dual_quat_lab_body)
    assert found.warnings == ()


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("Rot[4]", "Rot[5]", "has not X, Y, Z and Rot"),
        ("Forearm X", "Hand X", "body 'Forearm' has not X"),
        ("BODY_NAMES\tUpper Arm\tForearm", "BODY_NAMES\tUpper Arm", "1 bodies are named, and 2"),
        ("Frame\tTime", "Time\tFrame", "the first body's X is not column 1"),
        ("Rot[", "R[", "nothing says which column"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path: Path, old: str, new: str, says: str) -> None:
    with pytest.raises(RecordingError, match=says):
        read_recording(write(tmp_path / "t.tsv", [row.replace(old, new) for row in lines()]))


def marker_lines() -> list[str]:
    """An export of six markers, three of which turn; the second is not seen in frame 3, the last in frame 4."""
    at = np.array([[90.0, 0, 0], [0, 60, 0], [0, 0, 70]])
    rows = [("NO_OF_FRAMES", "60"), ("NO_OF_MARKERS", "6"), ("FREQUENCY", "100"), ("DATA_INCLUDED", "3D")]
    lines = ["\t".join(row) for row in rows]
    lines.append("MARKER_NAMES\tA1\tA2\tA3\tF1\tF2\tF3")
    lines.append(
        "\t".join(["Frame", "Time", *(f"{name} {axis}" for name in "A1 A2 A3 F1 F2 F3".split() for axis in "XYZ")])
    )
    for k in range(60):
        cells = [str(k + 1), f"{k / 100:.5f}"]
        for R, p in ((TRIAL.proximal_R, TRIAL.proximal_p), (TRIAL.distal_R, TRIAL.distal_p)):
            cells += [f"{x:.6f}" for point in at for x in (np.asarray(R[k]) @ point + 1000.0 * np.asarray(p[k]))]
        if k == 2:
            cells[5:8] = ["0.000"] * 3
        lines.append("\t".join(cells if k != 3 else [*cells[:17], "", "", ""]))
    return lines


def test_an_export_of_markers(tmp_path: Path) -> None:
    rows = marker_lines()
    path = write(tmp_path / "t.tsv", rows)
    found = read_recording(path, markers=("A*", "F*"))
    assert [marker.name for marker in found.markers] == ["A1", "A2", "A3", "F1", "F2", "F3"]
    assert np.flatnonzero(np.isnan(found.markers[1].position[:, 0])).tolist() == [2]
    assert np.flatnonzero(np.isnan(found.markers[5].position[:, 0])).tolist() == [3]
    assert found.warnings == ()
    analysis = analyze(found, Settings(proximal_markers=("A*",), distal_markers=("F*",)))
    seen = np.delete(np.arange(60), [2, 3])
    assert analysis.screw.angle[seen] == pytest.approx(TRIAL.angle[seen], abs=1e-5)
    without_titles = [*rows[:5], *rows[6:]]
    without_clock = [*rows[:5], *(row.split("\t", 2)[2] for row in rows[6:])]
    trailing = [*rows[:6], *(row + "\t" for row in rows[6:])]
    for case in (without_titles, without_clock, trailing, ["FILE_VERSION\t2.0.0", *rows]):
        other = read_recording(write(tmp_path / "u.tsv", case), markers=("A*", "F*"))
        for one, same in zip(found.markers, other.markers, strict=True):
            assert np.array_equal(one.position, same.position, equal_nan=True)
        assert other.rate_hz == pytest.approx(100.0)
        assert other.time_s - other.time_s[0] == pytest.approx(found.time_s)
    begins_lost = ["\t\t\t" + row.split("\t", 3)[3] for row in without_clock[5:7]]
    other = read_recording(
        write(tmp_path / "u.tsv", [*without_clock[:5], *begins_lost, *without_clock[7:]]), markers="A?"
    )
    assert np.flatnonzero(np.isnan(other.markers[0].position[:, 0])).tolist() == [0, 1]
    with pytest.raises(NoBodiesError, match="A1, A2"):
        read_recording(path)
    with pytest.raises(RecordingError, match=r"X, Y, Z of 5 markers of different names.*found 20 cells a row"):
        read_recording(write(tmp_path / "u.tsv", [row.replace("\tF3", "") for row in rows]), markers="*")
    with pytest.raises(RecordingError, match="F2 twice"):
        read_recording(write(tmp_path / "u.tsv", [row.replace("\tF3", "\tF2") for row in rows]), markers="*")


def test_lines_that_are_cut_and_options_that_mean_nothing_are_refused(tmp_path: Path) -> None:
    rows = lines()
    cut = write(tmp_path / "t.tsv", [*rows[:20], rows[20].rpartition("\t")[0].rpartition("\t")[0], *rows[21:]])
    with pytest.raises(RecordingError, match=r"t\.tsv:21: expected 35 cells, found 33"):
        read_recording(cut)
    with pytest.raises(SettingError, match=r"bodies .6D. have none"):
        read_recording(write(tmp_path / "u.tsv", rows), markers="A*")
    with pytest.raises(SettingError, match="Qualisys"):
        read_recording(write(tmp_path / "u.tsv", rows), units="mm")


def test_files_at_hand(real_data: Path) -> None:
    case = read_recording(real_data / "cases" / "qtm_6D.tsv")
    analysis = analyze(case)
    assert np.degrees(np.nanmax(analysis.screw.angle)) == pytest.approx(120.0, abs=0.01)
    direction = analysis.mean_axis.direction
    assert direction == pytest.approx(np.array([0.98, 0.1, 0.17]) / np.linalg.norm([0.98, 0.1, 0.17]), abs=1e-3)
    real = read_recording(real_data / "real" / "qtm_6D_floating_body.tsv")
    assert [(body.name, int(body.tracked.sum())) for body in real.bodies] == [("PSVH", 3000)]
