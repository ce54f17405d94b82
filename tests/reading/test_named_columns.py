"""Any table is read once a file says which of its columns hold what."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles import known_trial, quaternion_xyzw
from scipy.spatial.transform import Rotation

from elbowscrew import Recording, analyze, read_recording
from elbowscrew.cli import main
from elbowscrew.errors import ElbowscrewError, RecordingError, SettingError, UsageError
from elbowscrew.opening import sha256_of
from elbowscrew.settings import Settings

TRIAL = known_trial(100.0, frames=90, inversion=45, seed=3)
POSES = {"upper": (TRIAL.proximal_R, TRIAL.proximal_p), "lower": (TRIAL.distal_R, TRIAL.distal_p)}
FRAMES = np.arange(90)


def written(path: Path, columns: dict[str, Any], *, delimiter: str = ",", above: str = "", names: bool = True) -> Path:
    rows = [delimiter.join(f"{x:.12g}" for x in row) for row in np.stack([*columns.values()], axis=1)]
    header = [delimiter.join(columns)] if names else []
    path.write_text(above + "\n".join([*header, *rows]) + "\n")
    return path


def quoted(names: Any) -> str:
    return json.dumps([str(name) for name in names])


def cells(body: str, kind: str) -> dict[str, NDArray[np.float64]]:
    """Columns of one body's rotation, as another program would write them."""
    R = POSES[body][0]
    if kind.startswith("quaternion"):
        q = quaternion_xyzw(R)
        return {f"{body}.{letter}": q[:, "xyzw".index(letter)] for letter in kind.partition(" ")[2]}
    if kind.startswith("euler"):
        sequence, _, unit = kind.partition(" ")[2].partition(" ")
        angles = Rotation.from_matrix(R).as_euler(sequence, degrees=unit == "deg")
        return {f"{body}.{k}": angles[:, k] for k in range(3)}
    return {f"{body}.r{i}{j}": R[:, i, j] for i in range(3) for j in range(3)}


def rotation_toml(kind: str, names: Any) -> str:
    if kind.startswith("quaternion"):
        return f'quaternion = {quoted(names)}\norder = "{kind.partition(" ")[2]}"\n'
    if kind.startswith("euler"):
        sequence, _, unit = kind.partition(" ")[2].partition(" ")
        return f'euler = {quoted(names)}\nsequence = "{sequence}"\ndegrees = {str(unit == "deg").lower()}\n'
    return f"matrix = {quoted(names)}\n"


def table_and_columns(
    folder: Path, kind: str, *, unit: str = "mm", scale: float = 1000.0, places: bool = False, **layout: Any
) -> tuple[Path, Path]:
    columns: dict[str, Any] = {"t": FRAMES / 50.0}
    toml = '[clock]\ntime = "t"\n'
    for body in POSES:
        rotation = cells(body, kind)
        position = {f"{body} {axis}": scale * POSES[body][1][:, k] for k, axis in enumerate("XYZ")}
        columns |= {**rotation, **position}
        toml += f"[bodies.{body}]\n{rotation_toml(kind, rotation)}position = {quoted(position)}\nunit = '{unit}'\n"
    if places:
        for k, name in enumerate(columns, 1):
            toml = toml.replace(f'"{name}"', f'"#{k}"')
    path = folder / "columns.toml"
    path.write_text(toml)
    return written(folder / "t.csv", columns, names=not places, **layout), path


def check(recording: Recording) -> None:
    """Poses and angle are those of the trial."""
    assert [body.name for body in recording.bodies] == ["upper", "lower"]
    assert recording.rate_hz == pytest.approx(50.0)
    analysis = analyze(recording, Settings(proximal="upper", distal="lower"))
    assert analysis.screw.angle == pytest.approx(TRIAL.angle, abs=1e-8)
    for body, (R, p) in zip(recording.bodies, POSES.values(), strict=True):
        found = body.dual_quat_lab_body[:, :4]
        assert np.abs((found[:, [1, 2, 3, 0]] * quaternion_xyzw(R)).sum(axis=1)) == pytest.approx(1.0, abs=1e-12)
        d = 2.0 * (Rotation.from_quat(found[:, [1, 2, 3, 0]]).inv().as_quat())  # e* of d = 2 e_dual e*
        x, y, z, w = d.T
        a, b, c, e = body.dual_quat_lab_body[:, [5, 6, 7, 4]].T
        moved = np.stack([e * x + a * w + b * z - c * y, e * y - a * z + b * w + c * x, e * z + a * y - b * x + c * w])
        assert moved.T == pytest.approx(p, abs=1e-8)


QUATERNIONS = ("quaternion wxyz", "quaternion xyzw")
EULER_ANGLES = ("euler XYZ deg", "euler zxy rad", "euler YXZ rad", "euler xyz deg", "euler YXY deg", "euler zyz rad")


@pytest.mark.parametrize("kind", [*QUATERNIONS, "matrix", *EULER_ANGLES])
def test_every_way_to_write_a_rotation_gives_the_same_motion(tmp_path: Path, kind: str) -> None:
    table, columns = table_and_columns(tmp_path, kind)
    check(read_recording(table, columns=columns))


@pytest.mark.parametrize("kind", ["quaternion xyzw", "matrix", "euler YXZ rad"])
def test_orientations_need_no_positions(tmp_path: Path, kind: str) -> None:
    table, columns = table_and_columns(tmp_path, kind)
    lines = columns.read_text().splitlines()
    columns.write_text("\n".join(line for line in lines if not line.startswith(("position", "unit"))))
    recording = read_recording(table, columns=columns)
    assert [body.located for body in recording.bodies] == [False, False]
    for body, (R, _) in zip(recording.bodies, POSES.values(), strict=True):
        found = body.dual_quat_lab_body[:, [1, 2, 3, 0]]
        assert np.abs((found * quaternion_xyzw(R)).sum(axis=1)) == pytest.approx(1.0, abs=1e-12)
    columns.write_text("\n".join(line for line in lines if not line.startswith("position")))
    with pytest.raises(UsageError, match="unit is of a position"):
        read_recording(table, columns=columns)


@pytest.mark.parametrize("rows", [3, 4])
def test_matrices_that_hold_the_position(tmp_path: Path, rows: int) -> None:
    columns: dict[str, Any] = {"n": 5 + FRAMES}
    toml = '[clock]\nframe = "n"\nrate_hz = 50\n'
    for body, (R, p) in POSES.items():
        T = np.tile(np.eye(4), (90, 1, 1))
        T[:, :3, :3], T[:, :3, 3] = R, 100.0 * p
        names = {f"{body}{i}{j}": T[:, i, j] for i in range(rows) for j in range(4)}
        columns |= names
        toml += f"[bodies.{body}]\nmatrix = {quoted(names)}\nunit = 'cm'\n"
    file = tmp_path / "c.toml"
    file.write_text(toml)
    table = written(tmp_path / "t.txt", columns, delimiter="\t")
    recording = read_recording(table, columns=file)
    assert recording.frame.tolist() == (5 + FRAMES).tolist()
    check(recording)
    if rows == 4:
        turned = toml.replace('"upper03"', "?").replace('"upper30"', '"upper03"').replace("?", '"upper30"')
        file.write_text(turned)
        with pytest.raises(
            RecordingError, match=r"expected 0, 0, 0, 1 in the last four columns of the matrix of 'upper'"
        ):
            read_recording(table, columns=file)


def test_columns_are_meant_by_their_places_too(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "quaternion xyzw", places=True, delimiter=";")
    check(read_recording(table, columns=columns))


def test_a_name_is_stronger_than_a_place(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix")
    for file in (table, columns):
        file.write_text(file.read_text().replace("lower.r00", "#2"))  # the 14th column
    check(read_recording(table, columns=columns))


def test_lines_above_the_names_and_units_below_them(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix", above="Lab\n\nrate,50\n")
    check(read_recording(table, columns=columns))
    lines = table.read_text().splitlines()
    lines.insert(4, ",".join(["s"] + ["mm"] * (lines[3].count(","))))
    table.write_text("\n".join(lines) + "\n")
    with pytest.raises(SettingError, match=r"t\.csv:5: column 1: .*found 's'; .*first_row = 6 under \[table\]"):
        read_recording(table, columns=columns)
    columns.write_text(columns.read_text() + "[table]\nfirst_row = 6\n")
    check(read_recording(table, columns=columns))
    columns.write_text(columns.read_text() + "header = 4\n")
    check(read_recording(table, columns=columns))


def test_a_table_without_any_clock_needs_the_rate(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix")
    columns.write_text(columns.read_text().replace('[clock]\ntime = "t"\n', ""))
    with pytest.raises(SettingError, match=r"has no times; give rate_hz .* of columns.toml, or rate_hz HZ"):
        read_recording(table, columns=columns)
    check(read_recording(table, columns=columns, rate_hz=50.0))
    columns.write_text(columns.read_text() + "[clock]\nrate_hz = 50\n")
    check(read_recording(table, columns=columns))
    with pytest.raises(SettingError, match=r"rate_hz=40: .*rate_hz = 50 itself"):
        read_recording(table, columns=columns, rate_hz=40.0)


def test_a_blank_row_is_a_lost_frame_where_rows_are_the_clock(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix")
    columns.write_text(columns.read_text().replace('time = "t"', "rate_hz = 50"))
    lines = table.read_text().splitlines()
    lines[11] = ""
    table.write_text("\n".join(lines) + "\n")
    recording = read_recording(table, columns=columns)
    assert recording.frame.size == 90
    assert np.flatnonzero(~recording.bodies[0].tracked).tolist() == [10]


def test_unit_of_length_is_asked_for_or_stated_by_an_option(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix")
    with pytest.raises(SettingError, match=r"\[bodies.upper\] of columns.toml has unit = 'mm'; leave units out"):
        read_recording(table, columns=columns, units="m")
    check(read_recording(table, columns=columns, units="mm"))
    columns.write_text(columns.read_text().replace("unit = 'mm'\n", "").replace('time = "t"\n', ""))
    asked = r"no unit of length for bodies.upper, bodies.lower and has no times; give unit in .* and rate_hz"
    with pytest.raises(SettingError, match=asked):
        read_recording(table, columns=columns)
    check(read_recording(table, columns=columns, units="mm", rate_hz=50.0))


def test_units_of_the_clock(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix")
    slow = columns.read_text()
    lines = table.read_text().splitlines()
    table.write_text("\n".join([lines[0], *(f"{20 * k},{line.partition(',')[2]}" for k, line in enumerate(lines[1:]))]))
    columns.write_text(slow.replace('time = "t"', 'time = "t"\nunit = "ms"'))
    check(read_recording(table, columns=columns))
    columns.write_text(slow)
    assert read_recording(table, columns=columns).warnings[0].code == "slow-clock"  # milliseconds taken for seconds


def test_markers(tmp_path: Path) -> None:
    columns: dict[str, Any] = {"t": FRAMES / 50.0}
    toml = '[clock]\ntime = "t"\n'
    cluster = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.08, 0], [0, 0, 0.09]])
    for body, (R, p) in POSES.items():
        for k, offset in enumerate(cluster):
            at = 1000.0 * (R @ offset + p)
            names = {f"{body}{k}{axis}": at[:, i] for i, axis in enumerate("xyz")}
            columns |= names
            toml += f"[markers.{body}{k}]\nposition = {quoted(names)}\nunit = 'mm'\n"
    file = tmp_path / "c.toml"
    file.write_text(toml)
    table = written(tmp_path / "t.csv", columns)
    with pytest.raises(RecordingError, match=r"no bodies in c.toml \(markers: upper0, .*proximal_markers"):
        read_recording(table, columns=file)
    settings = Settings(proximal_markers=("upper?",), distal_markers=("lower?",))
    analysis = analyze(read_recording(table, columns=file, markers=settings.markers), settings)
    assert analysis.screw.angle == pytest.approx(TRIAL.angle, abs=1e-8)


FAULTS: dict[str, tuple[str, str, str]] = {
    "a key": ("quaternion =", "quaternions =", r"unknown key 'bodies.upper.quaternions'; did you mean 'quaternion'\?"),
    "a table": ("[clock]", "[clocks]", r"unknown key 'clocks'; did you mean 'clock'\?"),
    "no order": ('order = "xyzw"\n', "", 'bodies.upper: quaternion needs order = "wxyz" or "xyzw"'),
    "an order": ('"xyzw"', '"wxzy"', "bodies.upper.order: should be 'wxyz' or 'xyzw', found 'wxzy'"),
    "a unit": ("'mm'", "'inch'", "bodies.upper.unit: should be 'm', 'cm' or 'mm', found 'inch'"),
    "two rotations": ("order =", 'euler = ["a", "b", "c"]\norder =', "found quaternion and euler"),
    "no TOML": ("[clock]", "[clock", "not TOML"),
    "two clocks": ("time =", "rate_hz = 5\ntime =", "clock: time and rate_hz both make a clock"),
    "a missing column": ('"upper.x"', '"uper.x"', "no column 'uper.x' in .*:1; did you mean 'upper.x'"),
    "a place too far": ('"upper.x"', '"#99"', r"upper.quaternion: no column '#99'; line 1 of .* has 15 columns"),
    "a number for a word": ("order =", "degrees = 0\norder =", "upper.degrees: should be a valid boolean, found 0"),
    "a column twice": ('"upper.x"', '"upper.y"', "'upper.y' is the column of bodies.upper.quaternion already"),
}  # fmt: skip


def test_a_sequence_in_which_an_axis_follows_itself_is_refused(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "euler XYZ deg")
    columns.write_text(columns.read_text().replace('"XYZ"', '"XXY"'))
    with pytest.raises(ElbowscrewError, match=r"expected .* YXY or another order .* found 'XXY'"):
        read_recording(table, columns=columns)


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_name_their_key(tmp_path: Path, fault: str, capsys: pytest.CaptureFixture[str]) -> None:
    right, wrong, message = FAULTS[fault]
    table, columns = table_and_columns(tmp_path, "quaternion xyzw")
    columns.write_text(columns.read_text().replace(right, wrong))
    with pytest.raises(ElbowscrewError, match=message) as raised:
        read_recording(table, columns=columns)
    assert "\n" not in str(raised.value)
    assert main(["info", str(table), "--columns", str(columns)]) == raised.value.exit_code
    assert isinstance(raised.value, UsageError | SettingError)
    assert capsys.readouterr().err.count("\n") == 1


def test_a_name_that_stands_twice_is_asked_back_by_place(tmp_path: Path) -> None:
    table, columns = table_and_columns(tmp_path, "matrix")
    table.write_text(table.read_text().replace("lower.r11", "upper.r11", 1))
    with pytest.raises(SettingError, match=r'\'upper.r11\' stands more than once .*; give "#6" and "#18"'):
        read_recording(table, columns=columns)


def test_the_result_keeps_what_the_file_said_and_its_digest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table, columns = table_and_columns(tmp_path, "euler XYZ deg")
    chosen = ["--columns", str(columns), "--proximal", "upper", "--distal", "lower", "--figure-format", "none"]
    assert main(["analyze", str(table), *chosen, "-o", str(tmp_path / "r"), "-q"]) == 0
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert summary["source"]["columns_file"] == {"name": "columns.toml", "sha256": sha256_of(columns)}
    assert summary["settings"]["columns"]["bodies"]["upper"]["sequence"] == "XYZ"
    assert "columns.toml" in (tmp_path / "r" / "report.html").read_text()
    assert main(["report", str(tmp_path / "r")]) == 0
    assert main(["compare", str(table), *chosen, "-o", str(tmp_path / "c"), "--counts", "2", "-q"]) == 0
    capsys.readouterr()


def test_a_batch_takes_tables_by_columns_and_notices_a_change(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    table, columns = table_and_columns(tmp_path, "matrix")
    table.rename(tmp_path / "in" / "take.txt")
    settings = ["--proximal", "upper", "--distal", "lower", "--figure-format", "none", "--workers", "1", "--json"]
    out = ["-o", str(tmp_path / "out")]
    assert main(["batch", str(tmp_path / "in"), "--columns", str(columns), *settings, *out]) == 0
    first = json.loads(capsys.readouterr().out)
    assert main(["batch", str(tmp_path / "in"), "--columns", str(columns), *settings, *out]) == 0
    again = json.loads(capsys.readouterr().out)
    columns.write_text(columns.read_text().replace("'mm'", "'cm'"))
    assert main(["batch", str(tmp_path / "in"), "--columns", str(columns), *settings, *out]) == 0
    other = json.loads(capsys.readouterr().out)
    assert [told["up_to_date"] for told in (first, again, other)] == [0, 1, 0]


def test_a_manifest_names_the_file_beside_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "in").mkdir()
    table_and_columns(tmp_path / "in", "matrix")
    manifest = tmp_path / "in" / "study.csv"
    manifest.write_text("path,columns,proximal,distal\nt.csv,columns.toml,upper,lower\n")
    monkeypatch.chdir(tmp_path)
    assert main(["batch", "in/study.csv", "--figure-format", "none", "--workers", "1", "-q", "-o", "out"]) == 0
    assert json.loads((tmp_path / "out" / "t" / "summary.json").read_text())["source"]["columns_file"] is not None
    capsys.readouterr()
