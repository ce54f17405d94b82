"""Tables of 4 x 4 matrices: by rows or by columns, of both bodies or of one each, without clock and unit."""

from __future__ import annotations

import json
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import known_trial
from scipy.spatial.transform import Rotation

from elbowscrew import Settings, analyze, read_recording
from elbowscrew.cli import main
from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.opening import sha256_of
from elbowscrew.study.manifest import read_manifest

TRIAL = known_trial(110.0, frames=60, inversion=30, seed=9)
STATED: dict[str, Any] = {"units": "mm", "rate_hz": 100.0}


def rows_of(R: Any, p: Any, *, by_columns: bool = False) -> list[str]:
    matrices = np.tile(np.eye(4), (len(R), 1, 1))
    matrices[:, :3, :3], matrices[:, :3, 3] = R, 1000.0 * np.asarray(p)
    if by_columns:
        matrices = np.swapaxes(matrices, 1, 2)
    return [",".join(f"{x:.9f}" for x in row) for row in matrices.reshape(-1, 16)]


def both(*, by_columns: bool = False) -> tuple[list[str], list[str]]:
    return (
        rows_of(TRIAL.proximal_R, TRIAL.proximal_p, by_columns=by_columns),
        rows_of(TRIAL.distal_R, TRIAL.distal_p, by_columns=by_columns),
    )


def write(path: Path, rows: list[str]) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize("by_columns", [False, True])
@pytest.mark.parametrize("mark", [",", "\t", " ", ";"])
def test_one_file_a_body(tmp_path: Path, mark: str, by_columns: bool) -> None:
    arm, forearm = ([row.replace(",", mark) for row in rows] for rows in both(by_columns=by_columns))
    first, second = write(tmp_path / "humerus.tra", arm), write(tmp_path / "ulna.tra", forearm)
    recording = read_recording(first, distal_path=second, **STATED)
    assert [body.name for body in recording.bodies] == ["humerus", "ulna"]
    assert recording.warnings == ()
    assert recording.time_s == pytest.approx(np.arange(60) / 100.0)
    assert analyze(recording).screw.angle == pytest.approx(TRIAL.angle, abs=1e-7)


def test_both_bodies_in_one_file_must_be_told_apart(tmp_path: Path) -> None:
    path = write(tmp_path / "take.tra", [",".join(pair) for pair in zip(*both(), strict=True)])
    recording = read_recording(path, **STATED)
    with pytest.raises(SettingError, match="which body is the proximal one"):
        analyze(recording)
    found = analyze(recording, Settings(proximal="#1", distal="#2"))
    assert found.screw.angle == pytest.approx(TRIAL.angle, abs=1e-7)


def test_the_order_of_two_files_is_taken_and_doubted_where_names_speak_of_the_reverse(tmp_path: Path) -> None:
    arm, forearm = both()
    swapped = read_recording(
        write(tmp_path / "ulna.tra", arm), distal_path=write(tmp_path / "humerus.tra", forearm), **STATED
    )
    found = analyze(swapped)
    assert found.distal.name == "humerus"
    assert "order-differs" in [warning.code for warning in found.warnings]
    silent = read_recording(write(tmp_path / "a.tra", arm), distal_path=write(tmp_path / "b.tra", forearm), **STATED)
    found = analyze(silent)
    assert found.distal.name == "b"
    assert "order-differs" not in [warning.code for warning in found.warnings]


def test_files_of_one_name_in_two_folders(tmp_path: Path) -> None:
    first, second = (write(tmp_path / name / "t1.tra", rows) for name, rows in zip("ab", both(), strict=True))
    recording = read_recording(first, distal_path=second, **STATED)
    assert [body.name for body in recording.bodies] == ["proximal", "distal"]


def test_lost_frames_keep_their_place(tmp_path: Path) -> None:
    _, forearm = both()
    forearm[10] = ",".join(["NaN"] * 16)
    forearm[12] = "," * 15
    forearm[14] = ",".join(["0"] * 16)
    forearm[16] = ""
    recording = read_recording(write(tmp_path / "ulna.tra", [*forearm, "", ""]), **STATED)
    (body,) = recording.bodies
    assert np.flatnonzero(~body.tracked).tolist() == [10, 12, 14, 16]
    assert recording.frame.size == 60


def test_a_first_frame_that_is_lost(tmp_path: Path) -> None:
    _, forearm = both(by_columns=True)
    forearm[0] = ",".join(["nan"] * 16)
    (body,) = read_recording(write(tmp_path / "ulna.tra", forearm), **STATED).bodies
    assert np.flatnonzero(~body.tracked).tolist() == [0]


@pytest.mark.parametrize("end", ["", ","])
@pytest.mark.parametrize("numbered", [False, True])
def test_a_body_that_is_blank_in_the_first_row_is_not_left_out(tmp_path: Path, numbered: bool, end: str) -> None:
    rows = [",".join(pair) for pair in zip(*both(), strict=True)]
    rows[0] = both()[0][0] + "," * 16
    rows = [(f"{k}," if numbered else "") + row + end for k, row in enumerate(rows)]
    recording = read_recording(write(tmp_path / "t.tra", rows), **STATED)
    assert [np.flatnonzero(~body.tracked).tolist() for body in recording.bodies] == [[], [0]]


def test_one_body_alone_is_told(tmp_path: Path) -> None:
    path = write(tmp_path / "ulna.tra", both()[1])
    assert [warning.code for warning in read_recording(path, **STATED).warnings] == ["one-body"]


def test_what_the_file_does_not_state_is_asked_for_at_once(tmp_path: Path) -> None:
    path = write(tmp_path / "ulna.tra", both()[1])
    with pytest.raises(SettingError, match="give units m, cm or mm, and rate_hz HZ"):
        read_recording(path)
    with pytest.raises(SettingError, match="give rate_hz HZ"):
        read_recording(path, units="mm")


def test_rotations_that_could_stand_either_way_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "ulna.tra", rows_of(TRIAL.distal_R, np.zeros((60, 3))))
    with pytest.raises(RecordingError, match="row by row or column by column"):
        read_recording(path, **STATED)
    still = write(tmp_path / "rest.tra", rows_of(np.tile(np.eye(3), (60, 1, 1)), np.zeros((60, 3))))
    assert read_recording(still, **STATED).frame.size == 60  # either way the same


@pytest.mark.parametrize(
    ("row", "says"),
    [
        (rows_of(TRIAL.distal_R, TRIAL.distal_p, by_columns=True)[20], r"ulna\.tra:21: expected 0, 0, 0, 1"),
        ("1,2,3", r"ulna\.tra:21: expected 16 cells, found 3"),
        (",".join(["x"] * 16), r"ulna\.tra:21: column 1"),
    ],
)
def test_rows_that_do_not_fit_are_refused(tmp_path: Path, row: str, says: str) -> None:
    rows = both()[1]
    rows[20] = row
    with pytest.raises(RecordingError, match=says):
        read_recording(write(tmp_path / "ulna.tra", rows), **STATED)


def test_a_table_without_a_header_that_has_as_many_cells_is_none(tmp_path: Path) -> None:
    row = ",".join(["0", "0.00", *["0.1", "0.2", "0.3", "0.9", "1.0", "2.0", "3.0"] * 2])
    with pytest.raises(RecordingError, match="header is missing"):
        read_recording(write(tmp_path / "t.csv", [row, row]), **STATED)


def test_files_that_do_not_fit_together_are_refused(tmp_path: Path) -> None:
    arm, forearm = both()
    first = write(tmp_path / "humerus.tra", arm)
    with pytest.raises(RecordingError, match="found 60 from 0 s and 59 from 0 s"):
        read_recording(first, distal_path=write(tmp_path / "ulna.tra", forearm[:59]), **STATED)
    pair = write(tmp_path / "both.tra", [",".join(cells) for cells in zip(arm, forearm, strict=True)])
    with pytest.raises(RecordingError, match="found 2"):
        read_recording(first, distal_path=pair, **STATED)


def test_the_case_at_hand_is_its_hinge_and_keeps_both_digests(
    real_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [real_data / "cases" / name for name in ("humerus.tra", "ulna.tra")]
    told = ["--units", "mm", "--rate", "100", "--express-in", "proximal", "--json", "--no-report"]
    assert main(["analyze", *map(str, files), *told, "-o", str(tmp_path / "out")]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["source"]["sha256"] == sha256_of(files[0])
    assert summary["source"]["distal_file"] == {"name": "ulna.tra", "sha256": sha256_of(files[1])}
    recording = read_recording(files[0], distal_path=files[1], **STATED)
    found = analyze(recording, Settings(express_in="proximal"))
    assert np.degrees(np.nanmax(found.screw.angle)) == pytest.approx(120.0, abs=0.01)
    direction = np.array([0.98, 0.1, 0.17]) / np.linalg.norm([0.98, 0.1, 0.17])
    assert found.mean_axis.direction == pytest.approx(direction, abs=1e-4)
    offset = found.mean_axis.point - np.array([0.0, -0.28, 0.01])
    assert np.linalg.norm(np.cross(offset, direction)) < 1e-5


def test_a_manifest_names_both_files_and_a_changed_one_is_analyzed_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, rows in zip(("humerus", "ulna"), both(), strict=True):
        write(tmp_path / f"{name}.tra", rows)
    manifest = tmp_path / "m.csv"
    manifest.write_text("path,path_distal,units,rate\nhumerus.tra,ulna.tra,mm,100\n")
    assert [trial.distal_path for trial in read_manifest(manifest)] == [tmp_path / "ulna.tra"]
    line = ["batch", str(manifest), "-o", str(tmp_path / "out"), "--workers", "1", "--json", "--figure-format", "svg"]
    done = []
    for _ in range(2):
        assert main(line) == 0
        done.append(json.loads(capsys.readouterr().out)["analyzed"])
    write(tmp_path / "ulna.tra", [*both()[1][:-1], both()[1][-2]])
    assert main(line) == 0
    done.append(json.loads(capsys.readouterr().out)["analyzed"])
    assert done == [1, 0, 1]


@pytest.mark.parametrize("mark", [",", " "])
def test_a_column_of_frame_numbers_is_the_clock(tmp_path: Path, mark: str) -> None:
    rows = [f"{10 + 2 * k},{row}".replace(",", mark) for k, row in enumerate(both()[1])]
    recording = read_recording(write(tmp_path / "ulna.tra", rows), **STATED)
    assert recording.frame.tolist() == list(range(10, 130, 2))
    assert np.diff(recording.time_s) == pytest.approx(0.02)
    assert recording.rate_hz == pytest.approx(100.0)
    rows[3] = rows[3].replace("16", "16.5", 1)
    with pytest.raises(RecordingError, match=r"ulna\.tra:4: expected a whole frame number"):
        read_recording(write(tmp_path / "ulna.tra", rows), **STATED)


def test_a_unit_that_cannot_be_is_asked_back(tmp_path: Path) -> None:
    first, second = (write(tmp_path / name, rows) for name, rows in zip(("a.tra", "b.tra"), both(), strict=True))
    with pytest.raises(SettingError, match=r"units=.m. puts what is in the file .* m from the origin: is .*mm"):
        read_recording(first, distal_path=second, units="m", rate_hz=100.0)
    meters = [write(tmp_path / f"{path.stem}_m.tra", metric(path)) for path in (first, second)]
    doubted = read_recording(meters[0], distal_path=meters[1], units="mm", rate_hz=100.0)
    assert [warning.code for warning in doubted.warnings] == ["units-doubtful"]
    assert "is its unit m" in doubted.warnings[0].message
    assert read_recording(meters[0], distal_path=meters[1], units="m", rate_hz=100.0).warnings == ()


def metric(path: Path) -> list[str]:
    """Rows of a file in millimeters, in meters."""
    cells = np.loadtxt(path, delimiter=",")
    cells[:, [3, 7, 11]] /= 1000.0
    return [",".join(f"{x:.9f}" for x in row) for row in cells]


def titled(name: str, *, suffix: str = "") -> str:
    """Titles as XMALab writes them: the last coordinate is called TY, too."""
    parts = [f"R{k}1 R{k}2 R{k}3 0{k}".split() for k in (1, 2, 3)]
    return " , ".join(f"{name}_{part}{suffix}" for part in (*chain.from_iterable(parts), "TX", "TY", "TY", "1"))


@pytest.mark.parametrize("suffix", ["", "_10Hz"])
@pytest.mark.parametrize("numbered", [False, True])
def test_the_header_of_xmalab(tmp_path: Path, numbered: bool, suffix: str) -> None:
    rows = [" , ".join(pair).replace(",", " , ") for pair in zip(*both(by_columns=True), strict=True)]
    rows[7] = " , ".join(["NaN"] * 32)
    header = f"{titled('upper arm', suffix=suffix)} , {titled('Ulna_2', suffix=suffix)}"
    if numbered:
        rows = [f"{k + 1} , {row}" for k, row in enumerate(rows)]
        header = f"Frame , {header}"
    path = write(tmp_path / "trial.csv", [header, *rows])
    with pytest.raises(SettingError, match="give units m, cm or mm, and rate_hz HZ"):
        read_recording(path)
    recording = read_recording(path, **STATED)
    assert [body.name for body in recording.bodies] == ["upper arm", "Ulna_2"]
    assert [np.flatnonzero(~body.tracked).tolist() for body in recording.bodies] == [[7], [7]]
    assert recording.frame[0] == numbered
    found = analyze(recording, Settings(proximal="#1", distal="#2"))
    assert np.delete(found.screw.angle, 7) == pytest.approx(np.delete(TRIAL.angle, 7), abs=1e-7)


def test_titles_of_xmalab_that_are_not_whole(tmp_path: Path) -> None:
    rows = [" , ".join(pair) for pair in zip(*both(by_columns=True), strict=True)]
    for header in (
        f"{titled('a')} , {titled('a')}",
        f"{titled('a')} , {titled('b').replace('R12', 'R21')}",
        titled("a"),
    ):
        with pytest.raises(
            RecordingError, match=r"t\.csv:1: .*sixteen for each body|t\.csv:2: expected 16 cells, found 32"
        ):
            read_recording(write(tmp_path / "t.csv", [header, *rows]), **STATED)
    with pytest.raises(RecordingError, match="no frame follows"):
        read_recording(write(tmp_path / "t.csv", [titled("a")]), **STATED)


def angles_of(R: Any, p: Any) -> list[str]:
    """x, y, z, yaw, pitch, roll by SciPy: about the body's own z, y and x."""
    turns = Rotation.from_matrix(R).as_euler("ZYX", degrees=True)
    return [" ".join(f"{x:.16f}" for x in row) for row in np.hstack([1000.0 * np.asarray(p), turns])]


def test_six_numbers_of_autoscoper(tmp_path: Path) -> None:
    arm, forearm = angles_of(TRIAL.proximal_R, TRIAL.proximal_p), angles_of(TRIAL.distal_R, TRIAL.distal_p)
    arm[3] = " ".join(["NaN"] * 6)
    first, second = write(tmp_path / "humerus.tra", arm), write(tmp_path / "ulna.tra", forearm)
    recording = read_recording(first, distal_path=second, **STATED)
    assert [body.name for body in recording.bodies] == ["humerus", "ulna"]
    assert {warning.code for warning in recording.warnings} == {"autoscoper-angles"}
    found = analyze(recording)
    assert np.delete(found.screw.angle, 3) == pytest.approx(np.delete(TRIAL.angle, 3), abs=1e-9)
    as_matrices = [write(tmp_path / name, rows) for name, rows in zip(("a.tra", "b.tra"), both(), strict=True)]
    other = read_recording(as_matrices[0], distal_path=as_matrices[1], **STATED)
    pose = recording.bodies[1].dual_quat_lab_body
    assert np.abs(pose - other.bodies[1].dual_quat_lab_body).max() < 1e-8
    both_in_one = [f"{a} {b}" for a, b in zip(arm, forearm, strict=True)]
    together = read_recording(write(tmp_path / "all.tra", both_in_one), **STATED)
    assert np.array_equal(together.bodies[1].dual_quat_lab_body, pose)
    with pytest.raises(SettingError, match="give units m, cm or mm, and rate_hz HZ"):
        read_recording(first)


def test_a_first_row_that_lacks_a_cell_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "all.tra", ["1 2 3 0 10 0 0 1 6 0 -20 ", "1 2 3 0 10 0 9 5 6 27 -20 7"])
    with pytest.raises(RecordingError, match="expected six numbers a body in the first row, found 11 cells"):
        read_recording(path, **STATED)


def test_angles_that_may_be_radians_are_not_guessed(tmp_path: Path) -> None:
    turns = Rotation.from_matrix(TRIAL.distal_R).as_euler("ZYX")
    rows = [",".join(f"{x:.9f}" for x in row) for row in np.hstack([1000.0 * np.asarray(TRIAL.distal_p), turns])]
    with pytest.raises(RecordingError, match=r"within 2 pi.*columns FILE"):
        read_recording(write(tmp_path / "ulna.tra", rows), **STATED)
    with pytest.raises(RecordingError, match=r"angles of 400 are none.*columns FILE"):
        read_recording(write(tmp_path / "ulna.tra", [*rows, "1,2,3,400,0,0"]), **STATED)


@pytest.mark.parametrize("count", [6, 12])
def test_six_numbers_a_row_are_not_guessed(tmp_path: Path, count: int) -> None:
    path = write(tmp_path / "t.csv", [",".join(["1.5,2,3,10,20,30"] * (count // 6))] * 5)
    with pytest.raises(RecordingError, match=r"Autoscoper.*end in \.tra.*columns FILE"):
        read_recording(path, **STATED)
