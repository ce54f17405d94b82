"""Every variant of the column layout gives the poses that were written."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from motive_files import bodies_of, write_columns
from oracles import KnownTrial, known_trial, quaternion_xyzw

from elbowscrew import read_recording, save_simulation, simulate_trial
from elbowscrew.errors import RecordingError, SettingError, UsageError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float

TRIAL = known_trial(95.0, frames=40, inversion=20, seed=3)

VARIANTS: dict[str, dict[str, Any]] = {
    "1.21": {"version": "1.21"},
    "1.22": {"version": "1.22"},
    "1.23": {"version": "1.23"},
    "1.24": {"version": "1.24", "quoted_ids": False},
    "1.25 with Parent row": {"version": "1.25"},
    "millimeters": {"unit": "Millimeters"},
    "centimeters": {"unit": "Centimeters"},
    "CRLF": {"end": "\r\n"},
    "CR": {"end": "\r"},
    "BOM": {"bom": True},
    "padded by a spreadsheet": {"padding": 13, "end": "\r\n", "quoted_ids": False},
    "padded 1.21": {"version": "1.21", "padding": 4},
    "time code column": {"version": "1.24", "timecode": True},
    "lower-case w": {"w_label": "w"},
    "rotation type missing": {"header": {"Rotation Type": None}},
    **{f"Euler {''.join(order)}": {"rotation": "".join(order)} for order in permutations("XYZ")},
}


def assert_poses(recording: Any, trial: KnownTrial, tolerance: float = 1e-12) -> None:
    for body, R, p in zip(
        recording.bodies, (trial.proximal_R, trial.distal_R), (trial.proximal_p, trial.distal_p), strict=True
    ):
        matrix = dq.matrix_from_dual_quat(body.dual_quat_lab_body)
        assert matrix[:, :3, :3] == pytest.approx(R, abs=tolerance)
        assert matrix[:, :3, 3] == pytest.approx(p, abs=tolerance)


@pytest.mark.parametrize("options", VARIANTS.values(), ids=VARIANTS.keys())
def test_every_variant_gives_the_poses_written(tmp_path: Path, options: dict[str, Any]) -> None:
    path = write_columns(tmp_path / "take.csv", bodies_of(TRIAL, seed=1), **options)
    recording = read_recording(path)
    assert [body.name for body in recording.bodies] == ["Upper Arm", "Forearm"]
    assert_poses(recording, TRIAL)
    assert recording.rate_hz == 100.0
    assert recording.frame.tolist() == list(range(40))
    assert recording.time_s == pytest.approx(np.arange(40) / 100)
    assert not recording.warnings


def test_six_decimals_are_normalized(tmp_path: Path) -> None:
    recording = read_recording(write_columns(tmp_path / "take.csv", bodies_of(TRIAL), decimals=6))
    assert_poses(recording, TRIAL, tolerance=3e-6)
    norm = dq.norm(recording.bodies[0].dual_quat_lab_body)
    assert norm.real == pytest.approx(1.0, abs=1e-15)


def test_blank_cells_are_lost_frames(tmp_path: Path) -> None:
    bodies = bodies_of(TRIAL)
    bodies[1].lost = np.isin(np.arange(40), [0, 7, 8, 39])
    recording = read_recording(write_columns(tmp_path / "take.csv", bodies))
    proximal, distal = recording.bodies
    assert proximal.tracked.all()
    assert np.flatnonzero(~distal.tracked).tolist() == [0, 7, 8, 39]
    assert distal.loss_counts() == {"blank": 4}
    assert np.isnan(distal.dual_quat_lab_body[[0, 7, 8, 39]]).all()
    known = distal.tracked
    assert dq.matrix_from_dual_quat(distal.dual_quat_lab_body)[known, :3, 3] == pytest.approx(TRIAL.distal_p[known])


def test_bodies_of_one_name_are_told_apart_by_id(tmp_path: Path) -> None:
    path = write_columns(tmp_path / "take.csv", bodies_of(TRIAL, ("Red", "Red")))
    recording = read_recording(path)
    assert [(body.name, body.identifier) for body in recording.bodies] == [("Red", "A" * 32), ("Red", "B" * 32)]
    assert_poses(recording, TRIAL)


def test_a_body_that_stands_twice_is_refused(tmp_path: Path) -> None:
    bodies = bodies_of(TRIAL, ("Red", "Red"))
    bodies[1].identifier = bodies[0].identifier
    with pytest.raises(RecordingError, match="twice"):
        read_recording(write_columns(tmp_path / "take.csv", bodies))


def test_interleaved_markers_do_not_disturb_and_are_the_offsets(tmp_path: Path) -> None:
    """Body, its markers, next body, its markers: as Motive 1.23 and 1.24 write now and then."""
    offsets = np.array([[0.03, 0.0, 0.01], [-0.02, 0.04, 0.0], [0.0, -0.05, 0.02]])
    lines = ["Format Version,1.24,Take Name,x,Capture Frame Rate,100,Export Frame Rate,100,Rotation Type,Quaternion,"
             "Length Units,Millimeters,Coordinate Space,Global", ""]  # fmt: skip
    labels: list[tuple[str, ...]] = []
    columns: list[Float] = []
    for body in bodies_of(TRIAL):
        labels += [("Rigid Body", body.name, body.identifier, "Rotation", axis) for axis in "XYZW"]
        labels += [("Rigid Body", body.name, body.identifier, "Position", axis) for axis in "XYZ"]
        columns += [quaternion_xyzw(body.R), 1000 * body.p]
        for k, offset in enumerate(offsets):
            name = f'"{body.name}:Marker{k + 1}"'
            labels += [("Rigid Body Marker", name, f'"{body.identifier}"', "Position", axis) for axis in "XYZ"]
            labels.append(("Rigid Body Marker", name, f'"{body.identifier}"', "Marker Quality", ""))
            columns += [1000 * (body.R @ offset + body.p), np.ones((40, 1))]
    for row, title in enumerate(("Type", "Name", "ID", "")):
        lines.append(",".join(["", title, *(label[row] for label in labels)]))
    lines.append(",".join(["Frame", "Time (Seconds)", *(label[4] for label in labels)]))
    data = np.concatenate(columns, axis=1)
    lines += [",".join([str(k), str(k / 100), *map(repr, row)]) for k, row in enumerate(data.tolist())]
    path = tmp_path / "take.csv"
    path.write_text("\n".join(lines) + "\n")
    recording = read_recording(path)
    assert_poses(recording, TRIAL)
    for rigid in recording.bodies:
        assert rigid.marker_offsets == pytest.approx(offsets, abs=1e-9)


def test_frame_numbers_and_times_are_the_files_own(tmp_path: Path) -> None:
    recording = read_recording(write_columns(tmp_path / "take.csv", bodies_of(TRIAL), first_frame=72210))
    assert recording.frame[[0, -1]].tolist() == [72210, 72249]
    assert recording.time_s[0] == 0.0


def test_a_missing_unit_must_be_given_and_a_stated_one_not_contradicted(tmp_path: Path) -> None:
    silent = write_columns(tmp_path / "a.csv", bodies_of(TRIAL), unit="Centimeters", header={"Length Units": None})
    with pytest.raises(SettingError, match="give units m, cm or mm"):
        read_recording(silent)
    assert_poses(read_recording(silent, units="cm"), TRIAL)
    stated = write_columns(tmp_path / "b.csv", bodies_of(TRIAL))
    with pytest.raises(SettingError, match="contradicts"):
        read_recording(stated, units="mm")
    with pytest.raises(UsageError, match="units"):
        read_recording(stated, units="inch")


def test_a_missing_euler_order_must_be_given(tmp_path: Path) -> None:
    silent = write_columns(tmp_path / "a.csv", bodies_of(TRIAL), rotation="ZYX", header={"Rotation Type": None})
    with pytest.raises(SettingError, match="give rotation XYZ"):
        read_recording(silent)
    assert_poses(read_recording(silent, rotation="ZYX"), TRIAL)
    with pytest.raises(SettingError, match="rotation"):
        read_recording(silent, rotation="quaternion")
    quaternions = write_columns(tmp_path / "q.csv", bodies_of(TRIAL))
    with pytest.raises(SettingError, match="the file has quaternions"):
        read_recording(quaternions, rotation="XYZ")


MIRROR = np.diag([1.0, 1.0, -1.0])


def mirrored_file(
    path: Path, *, markers: bool, version: str = "1.1", trial: KnownTrial = TRIAL, noise_m: float = 0.0
) -> Path:
    """Bodies written mirrored in z, as version 1.1 has them, their markers as they are, or seen with noise."""
    rng = np.random.default_rng(1)
    offsets = np.array([[0.03, 0.0, 0.01], [-0.02, 0.04, 0.0], [0.0, -0.05, 0.02]])
    labels: list[tuple[str, ...]] = []
    columns: list[Float] = []
    for body in bodies_of(trial):
        labels += [("Rigid Body", body.name, body.identifier, "Rotation", axis) for axis in "XYZW"]
        labels += [("Rigid Body", body.name, body.identifier, "Position", axis) for axis in "XYZ"]
        columns += [quaternion_xyzw(MIRROR @ body.R @ MIRROR), body.p @ MIRROR]
        for k, offset in enumerate(offsets if markers else []):
            labels += [("Rigid Body Marker", f"Marker {k + 1}", body.identifier, "Position", axis) for axis in "XYZ"]
            columns.append(body.R @ offset + body.p + noise_m * rng.normal(size=body.p.shape))
    lines = [f"Format Version,{version},Take Name,x,Capture Frame Rate,100,Export Frame Rate,99.999992", ""]
    lines += [",".join(["", "", *(label[row] for label in labels)]) for row in range(4)]
    lines.append(",".join(["Frame", "Time", *(label[4] for label in labels)]))
    data = np.concatenate(columns, axis=1)
    lines += [",".join([str(k), repr(66.49 + k / 100), *map(repr, row)]) for k, row in enumerate(data.tolist())]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_mirrored_bodies_of_version_1_1_are_corrected_against_their_markers(tmp_path: Path) -> None:
    recording = read_recording(mirrored_file(tmp_path / "a.csv", markers=True), units="m")
    assert_poses(recording, TRIAL)
    assert [warning.code for warning in recording.warnings] == ["mirrored", "mirrored"]
    assert recording.bodies[0].marker_offsets == pytest.approx(
        np.array([[0.03, 0.0, 0.01], [-0.02, 0.04, 0.0], [0.0, -0.05, 0.02]]), abs=1e-9
    )


@pytest.mark.parametrize(("noise_mm", "rest"), [(1.0, True), (8.0, False)])
def test_markers_that_the_cameras_saw_belong_to_a_body_in_which_they_rest(
    tmp_path: Path, noise_mm: float, rest: bool
) -> None:
    """Seen markers stray by a millimeter or so; what strays by more than skin does is no part of the body."""
    recording = read_recording(mirrored_file(tmp_path / "a.csv", markers=True, noise_m=1e-3 * noise_mm), units="m")
    for body in recording.bodies:
        assert (body.marker_offsets is not None) == rest
        if body.marker_offsets is not None:
            expected = np.array([[0.03, 0.0, 0.01], [-0.02, 0.04, 0.0], [0.0, -0.05, 0.02]])
            assert body.marker_offsets == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(("stated", "believed"), [(100.4, True), (99.6, True), (103.0, False), (97.0, False)])
def test_a_header_whose_rate_is_off_by_more_than_rounding_is_overruled_by_the_times(
    tmp_path: Path, stated: float, believed: bool
) -> None:
    long = known_trial(95.0, frames=1000, inversion=400, seed=3)  # of few frames the ends' rounding explains more
    path = write_columns(tmp_path / "a.csv", bodies_of(long), header={"Export Frame Rate": f"{stated:.6f}"})
    recording = read_recording(path)
    assert recording.rate_hz == pytest.approx(stated if believed else 100.0, rel=1e-6)
    assert [warning.code for warning in recording.warnings] == ([] if believed else ["frame-rate"])


def test_without_markers_the_version_decides_and_says_so(tmp_path: Path) -> None:
    recording = read_recording(mirrored_file(tmp_path / "a.csv", markers=False), units="m")
    assert_poses(recording, TRIAL)
    assert [warning.code for warning in recording.warnings] == ["mirrored-by-version"] * 2
    plain = read_recording(mirrored_file(tmp_path / "b.csv", markers=False, version="1.2"), units="m")
    assert not plain.warnings


def test_markers_decide_against_the_version(tmp_path: Path) -> None:
    recording = read_recording(mirrored_file(tmp_path / "a.csv", markers=True, version="1.21"), units="m")
    assert_poses(recording, TRIAL)
    assert [warning.code for warning in recording.warnings] == ["mirrored", "mirrored"]


@pytest.mark.parametrize("decimal_comma", [False, True])
@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_spreadsheets_other_delimiters_and_decimal_commas(tmp_path: Path, delimiter: str, decimal_comma: bool) -> None:
    bodies = bodies_of(TRIAL)
    bodies[1].lost = np.isin(np.arange(40), [3])
    text = write_columns(tmp_path / "take.csv", bodies).read_text().replace(",", delimiter)
    path = tmp_path / "resaved.csv"
    path.write_text(text.replace(".", ",") if decimal_comma else text)
    recording = read_recording(path)
    assert recording.source is not None
    assert recording.source.layout == "Motive columns 1.23"
    assert recording.rate_hz == 100.0
    bodies[1].lost = None
    known = recording.bodies[1].tracked
    assert np.flatnonzero(~known).tolist() == [3]
    matrix = dq.matrix_from_dual_quat(recording.bodies[1].dual_quat_lab_body)
    assert matrix[known, :3, :3] == pytest.approx(TRIAL.distal_R[known], abs=1e-12)


def test_a_blank_line_before_the_header_changes_nothing(tmp_path: Path) -> None:
    path = write_columns(tmp_path / "take.csv", bodies_of(TRIAL), unit="Millimeters")
    path.write_text("\n,,,\n" + path.read_text())
    assert_poses(read_recording(path), TRIAL)


@pytest.mark.parametrize(
    ("line", "edit"),
    [
        (30, lambda cells: cells[:5] + cells[6:]),
        (30, lambda cells: [*cells[:5], "0", *cells[5:]]),
        (30, lambda cells: [*cells, "7"]),
        (7, lambda cells: [*cells, "7"]),
        (30, lambda cells: [*cells[:4], '"1', '2"', *cells[5:]]),
    ],
)
@pytest.mark.parametrize("blank", [False, True])
def test_cells_that_are_shifted_are_an_error(tmp_path: Path, line: int, edit: Any, blank: bool) -> None:
    bodies = bodies_of(TRIAL)
    bodies[1].lost = np.isin(np.arange(40), [20]) if blank else None
    lines = write_columns(tmp_path / "good.csv", bodies).read_text().splitlines()
    lines[line] = ",".join(edit(lines[line].split(",")))
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match=r"bad\.csv:\d+: (expected 18|expected 19|column)"):
        read_recording(path)


def test_one_cell_missing_in_every_line_is_an_error(tmp_path: Path) -> None:
    lines = good_lines(tmp_path)
    lines[7:] = [",".join([*line.split(",")[:5], *line.split(",")[6:]]) for line in lines[7:]]
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match=r"bad\.csv:8: expected 18 cells, found 17"):
        read_recording(path)


def test_a_header_whose_types_are_cut_is_refused(tmp_path: Path) -> None:
    lines = good_lines(tmp_path)
    lines[2] = ",".join(lines[2].split(",")[:10])
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match="without type or name"):
        read_recording(path)


@pytest.mark.parametrize(("column", "text"), [(5, "99"), (5, "1e-200"), (6, "1e160"), (6, "-20000")])
def test_a_pose_that_cannot_be_is_lost_with_a_warning(tmp_path: Path, column: int, text: str) -> None:
    lines = good_lines(tmp_path)
    cells = lines[20].split(",")
    cells[column] = text
    if text == "1e-200":
        cells[2:5] = ["0", "0", "0"]
    lines[20] = ",".join(cells)
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    recording = read_recording(path)
    assert recording.bodies[0].loss_counts() == {"invalid": 1}
    assert "invalid-pose" in [warning.code for warning in recording.warnings]


def test_a_rate_that_the_times_contradict_is_not_used(tmp_path: Path) -> None:
    path = write_columns(tmp_path / "a.csv", bodies_of(TRIAL), header={"Export Frame Rate": "1.000000"})
    recording = read_recording(path)
    assert recording.rate_hz == pytest.approx(100.0)
    assert [warning.code for warning in recording.warnings] == ["frame-rate"]


@pytest.mark.parametrize(
    ("column", "text"), [(0, "1e300"), (0, "9223372036854775808"), (0, "1.5"), (1, "1e308"), (0, "")]
)
def test_frames_and_times_that_cannot_be_are_an_error(tmp_path: Path, column: int, text: str) -> None:
    lines = good_lines(tmp_path)
    cells = lines[20].split(",")
    cells[column] = text
    lines[20] = ",".join(cells)
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match=r"bad\.csv:21: expected a whole frame number and a time"):
        read_recording(path)


def good_lines(tmp_path: Path) -> list[str]:
    return write_columns(tmp_path / "good.csv", bodies_of(TRIAL)).read_text().splitlines()


@pytest.mark.parametrize("text", ["abc", "nan", "inf", "1e400", "1_0", "0x1A", "--1", "1.0.0", "#REF!"])
@pytest.mark.parametrize("line", [7, 30])
def test_a_cell_that_is_no_number_is_an_error_with_its_place(tmp_path: Path, text: str, line: int) -> None:
    lines = good_lines(tmp_path)
    cells = lines[line].split(",")
    cells[4] = text
    lines[line] = ",".join(cells)
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match=rf"bad\.csv:{line + 1}: column 5: expected a number") as caught:
        read_recording(path)
    assert text in str(caught.value)


def test_a_line_that_is_cut_is_an_error_with_its_place(tmp_path: Path) -> None:
    lines = good_lines(tmp_path)
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines[:-1]) + "\n" + lines[-1][:60])
    with pytest.raises(RecordingError, match=r"bad\.csv:47: expected 18 cells, found \d+: the line is cut or"):
        read_recording(path)
    path.write_text("\n".join(lines))
    assert [warning.code for warning in read_recording(path).warnings] == ["no-final-newline"]


@pytest.mark.parametrize("kept", range(7))
def test_a_header_that_is_cut_is_refused(tmp_path: Path, kept: int) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(good_lines(tmp_path)[:kept]) + "\n")
    with pytest.raises(RecordingError):
        read_recording(path)


def test_a_header_without_frames_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(good_lines(tmp_path)[:7]) + "\n")
    with pytest.raises(RecordingError, match="no frame"):
        read_recording(path)


def test_no_rigid_bodies_says_what_is_there(tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(
        "Format Version,1.23,Length Units,Meters\n\n,Type,Marker,Marker,Marker\n,Name,a,a,a\n,ID,1,1,1\n"
        ",,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z\n0,0.0,1,2,3\n"
    )
    with pytest.raises(RecordingError, match=r"no rigid bodies in the file \(found: Marker\)"):
        read_recording(path)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "empty"),
        (b"\n\n ,,\n", "empty"),
        (b"\x00\x01\x02Format Version", "binary"),
        (b"PK\x03\x04rest", "zip"),
        ("Format Version,1.23".encode("utf-16"), "UTF-16"),
        (b"Format Version,1.23,Take Name,caf\x81\n\n", "UTF-8"),
        (b"Format Version,1.23,Take Name," + 40_000 * b"\xc3\xa9" + b"caf\xe9\n\n", "UTF-8"),
        (b"0,0.0,0,8,0.1,0.2\n1,0.01,0,8,0.1,0.2\n", "header is missing"),
        (b"time;x;y\n", "no format that is read"),
        (b"Format Version;1.23;Take Name\n", "header is cut"),
    ],
)
def test_what_is_no_export_is_refused_with_the_reason(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=says):
        read_recording(path)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no such file"):
        read_recording(tmp_path / "nothing.csv")
    with pytest.raises(RecordingError, match="folder"):
        read_recording(tmp_path)


@pytest.mark.parametrize(("delimiter", "other"), [("\t", ","), (";", ".")])
def test_thousands_separators_are_not_taken_for_decimal_marks(tmp_path: Path, delimiter: str, other: str) -> None:
    text = write_columns(tmp_path / "take.csv", bodies_of(TRIAL), decimals=6).read_text().replace(",", delimiter)
    lines = (text if other == "," else text.replace(".", ",")).splitlines()
    cells = lines[20].split(delimiter)
    cells[7] = f"1{other}240"
    lines[20] = delimiter.join(cells)
    path = tmp_path / "resaved.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match=r"resaved\.csv:21: numbers have both commas and points"):
        read_recording(path)


def test_one_cell_more_in_every_line_is_an_error(tmp_path: Path) -> None:
    lines = good_lines(tmp_path)
    lines[7:] = [",".join([*line.split(",")[:5], "0.5", *line.split(",")[5:]]) for line in lines[7:]]
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match=r"bad\.csv:8: expected 18 cells, found 19"):
        read_recording(path)


def test_rotation_columns_in_another_order_than_stated_are_refused(tmp_path: Path) -> None:
    path = write_columns(tmp_path / "a.csv", bodies_of(TRIAL), rotation="YXZ", header={"Rotation Type": "XYZ"})
    with pytest.raises(RecordingError, match="which XYZ contradicts"):
        read_recording(path)
    silent = write_columns(tmp_path / "b.csv", bodies_of(TRIAL), rotation="YXZ", header={"Rotation Type": None})
    with pytest.raises(SettingError, match="which XYZ contradicts"):
        read_recording(silent, rotation="XYZ")


def test_a_body_that_is_found_late_keeps_its_markers(tmp_path: Path) -> None:
    trial = known_trial(60.0, frames=1300, inversion=600)
    path = mirrored_file(tmp_path / "late.csv", markers=True, version="1.21", trial=trial)
    lines = path.read_text().splitlines()
    for k in range(7, 7 + 1200):
        cells = lines[k].split(",")
        lines[k] = ",".join([*cells[:2], *[""] * (len(cells) - 2)])
    path.write_text("\n".join(lines) + "\n")
    recording = read_recording(path, units="m")
    assert [body.tracked.sum() for body in recording.bodies] == [100, 100]
    assert all(body.marker_offsets is not None and len(body.marker_offsets) == 3 for body in recording.bodies)


def test_bodies_swapped_are_known_by_the_shape_of_their_clusters(samples: Path, tmp_path: Path) -> None:
    """Poses and markers of the two bodies exchanged for a while, the markers in another order."""
    lines = (samples / "elbow_paper.csv").read_text().splitlines()
    names, fields = lines[3].replace('"', "").split(","), lines[5].split(",")
    kinds = lines[2].split(",")
    column = {
        (kind, name.split(":")[0], number): [k for k in range(2, len(names)) if (kinds[k], names[k]) == (kind, name)]
        for kind, name, number in {
            (kinds[k], names[k], names[k][-1] if ":" in names[k] else "") for k in range(2, len(names)) if fields[k]
        }
    }
    for row in range(7 + 300, 7 + 340):
        cells = lines[row].split(",")
        new = list(cells)
        for (kind, name, number), here in column.items():
            if kind == "Rigid Body Marker":
                continue
            other = "Forearm" if name == "Upper Arm" else "Upper Arm"
            turned = {"": "", "1": "3", "2": "1", "3": "2", "4": "4"}[number]
            for target, origin in zip(here, column[(kind, other, turned)], strict=True):
                new[target] = cells[origin]
        lines[row] = ",".join(new)
    path = tmp_path / "swapped.csv"
    path.write_text("\n".join(lines) + "\n")
    found = {warning.code: warning for warning in read_recording(path).warnings}
    assert found["swapped-clusters"].count == 40
    assert found["swapped-clusters"].frames == tuple(range(300, 310))
    assert "swapped-clusters" not in [warning.code for warning in read_recording(samples / "elbow_paper.csv").warnings]


def test_markers_kilometers_away_do_not_reach_the_residual(tmp_path: Path) -> None:
    trial = simulate_trial(frames=40, inversion=20, seed=2)
    path = tmp_path / "take.csv"
    save_simulation(trial, path)
    whole = read_recording(path).bodies[1].marker_residual
    lines = path.read_text().splitlines()
    cells = lines[20].split(",")
    cells[-1] = "1e300"
    lines[20] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    recording = read_recording(path)
    found = recording.bodies[1].marker_residual
    assert "invalid-marker" in [warning.code for warning in recording.warnings]
    assert found is not None
    assert whole is not None
    assert np.isfinite(found).all()
    assert np.flatnonzero(found != whole).tolist() == [20 - 7]
    assert found.max() < 2e-3


def test_markers_of_one_name_are_asked_for_with_their_id(tmp_path: Path) -> None:
    path, _ = save_simulation(simulate_trial(frames=5, inversion=2), tmp_path / "take.csv")
    lines = path.read_text().split("\n")
    kinds, names, ids = (line.split(",") for line in lines[2:5])
    loose = [k for k, kind in enumerate(kinds) if kind == "Marker"][:6]
    for k in loose:
        names[k] = '"twin"'
    first, second = (ids[k].strip('"') for k in (loose[0], loose[3]))
    assert first != second
    lines[3] = ",".join(names)
    path.write_text("\n".join(lines))
    both = read_recording(path, markers=("twin",)).markers
    assert [marker.name for marker in both] == [f"twin ({first})", f"twin ({second})"]
    one = read_recording(path, markers=(f"twin ({second})",)).markers
    assert [marker.name for marker in one] == [f"twin ({second})"]
    assert (one[0].position == both[1].position).all()
