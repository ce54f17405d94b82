"""Recordings of other systems: plain tables, TRC and C3D; and markers of any."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import pytest
from oracles import known_trial, quaternion_xyzw

from elbowscrew import Settings, analyze, read_recording, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.reading.clock import rate_of

TRIAL = known_trial(110.0, frames=80, inversion=40, seed=21)
CLUSTER = np.array([[0.04, 0, 0.01], [-0.03, 0.05, 0], [0, -0.04, 0.01], [0.01, 0.02, -0.06]])


def markers_of(R: Float, p: Float) -> Float:
    return np.asarray(np.swapaxes(R @ CLUSTER.T, 1, 2) + p[:, None])


ARM, FOREARM = markers_of(TRIAL.proximal_R, TRIAL.proximal_p), markers_of(TRIAL.distal_R, TRIAL.distal_p)
MARKERS = {f"UA{k + 1}": ARM[:, k] for k in range(4)} | {f"FA{k + 1}": FOREARM[:, k] for k in range(4)}
Change = dict[tuple[int, int], str]
CHOICE: dict[str, Any] = {"arm_markers": ("ua?",), "forearm_markers": ("FA1", "FA2", "FA[34]")}


def table(path: Path, *, bodies: bool, markers: bool, unit: str = "m", change: Change | None = None) -> Path:
    scale = {"m": 1.0, "cm": 100.0, "mm": 1000.0}[unit]
    names, columns = ["frame", "time_s"], [np.arange(80.0)[:, None], np.arange(80.0)[:, None] / 100]
    if bodies:
        for name, R, p in (("arm", TRIAL.proximal_R, TRIAL.proximal_p), ("fore_arm", TRIAL.distal_R, TRIAL.distal_p)):
            names += [f"{name}_e{k}" for k in range(4)] + [f"{name}_{axis}_{unit}" for axis in "xyz"]
            columns += [quaternion_xyzw(R)[:, [3, 0, 1, 2]], scale * p]
    if markers:
        for name, position in MARKERS.items():
            names += [f"{name}_{axis}_{unit}" for axis in "xyz"]
            columns.append(scale * position)
    rows = [[repr(value) for value in row] for row in np.concatenate(columns, axis=1).tolist()]
    for (row, column), text in (change or {}).items():
        rows[row][column] = text
    path.write_text("\n".join([",".join(names), *(",".join(row) for row in rows)]) + "\n")
    return path


def trc(path: Path, unit: str = "mm", header: dict[str, str] | None = None) -> Path:
    stated = {
        "DataRate": "100",
        "CameraRate": "100",
        "NumFrames": "80",
        "NumMarkers": "8",
        "Units": unit,
        **(header or {}),
    }
    scale = {"m": 1.0, "mm": 1000.0, "": 1000.0}[unit]
    names = [cell for name in MARKERS for cell in (name, "", "")]
    axes = [f"{axis}{k + 1}" for k in range(8) for axis in "XYZ"]
    lines = ["PathFileType\t4\t(X/Y/Z)\tt.trc", "\t".join(stated), "\t".join(stated.values())]
    lines += ["\t".join(["Frame#", "Time", *names]), "\t".join(["", "", *axes]), ""]
    data = scale * np.concatenate(list(MARKERS.values()), axis=1)
    lines += ["\t".join([str(k + 1), f"{k / 100:.6f}", *map(repr, row)]) for k, row in enumerate(data.tolist())]
    path.write_text("\n".join(lines) + "\n")
    return path


def c3d(path: Path, *, rotations: bool, unit: str = "mm") -> Path:
    content = ezc3d.c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    content["parameters"]["POINT"]["UNITS"]["value"] = [unit]
    content["parameters"]["POINT"]["LABELS"]["value"] = tuple(MARKERS)
    points = np.ones((4, 8, 80))
    points[:3] = 1000.0 * np.moveaxis(np.stack(list(MARKERS.values())), [0, 1, 2], [1, 2, 0])
    content["data"]["points"] = points
    if rotations:
        matrices = np.tile(np.eye(4)[:, :, None, None], (1, 1, 2, 80))
        for k, (R, p) in enumerate(((TRIAL.proximal_R, TRIAL.proximal_p), (TRIAL.distal_R, TRIAL.distal_p))):
            matrices[:3, :3, k] = np.moveaxis(R, 0, -1)
            matrices[:3, 3, k] = 1000.0 * p.T
        content["data"]["rotations"] = matrices
        content.add_parameter("ROTATION", "RATE", [100.0])
        content.add_parameter("ROTATION", "LABELS", ("Arm", "Forearm"))
    content.write(str(path))
    return path


@pytest.mark.parametrize("unit", ["m", "cm", "mm"])
def test_bodies_of_a_plain_table(tmp_path: Path, unit: str) -> None:
    change = {(5, column): "" for column in range(9, 16)}
    recording = read_recording(table(tmp_path / "t.csv", bodies=True, markers=True, unit=unit, change=change))
    assert [body.name for body in recording.bodies] == ["arm", "fore_arm"]
    assert recording.markers == ()
    assert recording.rate_hz == pytest.approx(100.0)
    screw = analyze(recording).screw
    assert np.flatnonzero(~screw.valid).tolist() == [5]
    assert screw.angle[screw.valid] == pytest.approx(TRIAL.angle[screw.valid], abs=1e-9)


@pytest.mark.parametrize("method", ["svd", "dual-qr"])
@pytest.mark.parametrize("kind", ["table", "trc", "c3d"])
def test_poses_from_markers(tmp_path: Path, kind: str, method: Any) -> None:
    path = {
        "table": lambda: table(tmp_path / "t.csv", bodies=False, markers=True),
        "trc": lambda: trc(tmp_path / "t.trc"),
        "c3d": lambda: c3d(tmp_path / "t.c3d", rotations=False),
    }[kind]()
    settings = Settings(pose_method=method, express_in="lab", **CHOICE)
    recording = read_recording(path, markers=settings.markers)
    assert sorted(marker.name for marker in recording.markers) == sorted(MARKERS)
    analysis = analyze(recording, settings)
    tolerance = 1e-5 if kind == "c3d" else 1e-9  # C3D holds single precision
    assert analysis.screw.angle == pytest.approx(TRIAL.angle, abs=tolerance)
    direction, _ = TRIAL.line_in("lab")
    known = analysis.screw.axis_known
    assert np.abs(analysis.screw.axis_direction[known] - direction).max() < 1e2 * tolerance
    assert analysis.points.origin == "markers"
    assert analysis.quality[1].marker_residual is not None
    assert analysis.quality[1].marker_residual.largest < 1e-6


def test_rotations_of_a_c3d_file(tmp_path: Path) -> None:
    recording = read_recording(c3d(tmp_path / "t.c3d", rotations=True))
    assert [body.name for body in recording.bodies] == ["Arm", "Forearm"]
    assert analyze(recording).screw.angle == pytest.approx(TRIAL.angle, abs=1e-5)


def test_markers_that_are_missing_now_and_then(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    change: Change = {}
    for row in range(1, 80):
        lost = int(rng.integers(0, 8))
        change |= {(row, 2 + 3 * lost + axis): "" for axis in range(3)}
    change |= {(30, 2 + 3 * k + axis): "" for k in (4, 5) for axis in range(3)}
    path = table(tmp_path / "t.csv", bodies=False, markers=True, change=change)
    settings = Settings(**CHOICE)
    screw = analyze(read_recording(path, markers=settings.markers), settings).screw
    assert np.flatnonzero(~screw.valid).tolist() == [30]
    assert screw.distal_loss[30] == "blank"
    assert screw.angle[screw.valid] == pytest.approx(TRIAL.angle[screw.valid], abs=1e-9)


@pytest.mark.parametrize("name", ["elbow_paper", "elbow_moving_arm_mm"])
def test_markers_and_solved_bodies_of_one_export_agree(samples: Path, name: str) -> None:
    settings = Settings(proximal_markers=("Upper Arm:*",), distal_markers=("Forearm:Marker?",))
    recording = read_recording(samples / f"{name}.csv", markers=settings.markers)
    assert len(recording.markers) == 8
    solved, fitted = analyze(recording), analyze(recording, settings)
    # Bodies and markers are printed with six decimals, of meters or of millimeters.
    both = solved.screw.valid & fitted.screw.valid
    assert both.sum() > 400
    assert fitted.screw.angle[both] == pytest.approx(solved.screw.angle[both], abs=3e-4)


def test_markers_of_the_samples_do_not_fit_to_the_last_digit(samples: Path) -> None:
    recording = read_recording(samples / "elbow_paper.csv")
    residual = recording.bodies[0].marker_residual
    assert residual is not None
    # Four markers have 12 coordinates, of which the pose takes 6: RMS distance sigma sqrt(6/4).
    assert 1000 * np.sqrt(np.mean(residual**2)) == pytest.approx(0.1 * np.sqrt(1.5), rel=0.03)
    trial = simulate_trial(marker_noise_mm=0.0)
    assert trial.recording.bodies[0].marker_offsets is not None


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"arm_markers": ("UA*",), "forearm_markers": ("FA1", "FA2")}, "fits 2 markers"),
        ({"arm_markers": ("UA*",), "forearm_markers": ("X*",)}, "fits 0 markers"),
        ({"arm_markers": ("UA*",), "arm": "arm", "forearm_markers": ("FA*",)}, "give one of them"),
        ({"arm_markers": ("UA*",), "forearm_markers": ("FA1", "FA2", "FA3"), "pose_method": "dual-qr"}, "needs 4"),
        ({}, "give proximal_markers and distal_markers"),
    ],
)
def test_choices_of_markers_that_do_not_fit(tmp_path: Path, settings: dict[str, Any], says: str) -> None:
    path = table(tmp_path / "t.csv", bodies=False, markers=True)
    with pytest.raises(SettingError, match=says):
        analyze(read_recording(path, markers=("*",)), Settings(**settings))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({(3, 4): "abc"}, r"t\.csv:5: column 5: expected a number, found 'abc'"),
        ({(3, 0): ""}, r"t\.csv:5: expected a whole frame number"),
        ({(3, 4): "1,2"}, r"t\.csv:5: expected 16 cells, found 17"),
    ],
)
def test_faults_of_a_plain_table_have_their_place(tmp_path: Path, change: Any, says: str) -> None:
    with pytest.raises(RecordingError, match=says):
        read_recording(table(tmp_path / "t.csv", bodies=True, markers=False, change=change))


@pytest.mark.parametrize(
    ("header", "says"),
    [
        ("frame,time_s,arm_e0,arm_e1,arm_e2,arm_e3,arm_x_m,arm_y_m", "'arm' has only"),
        ("frame,time_s,arm_x,arm_y,arm_z", "is neither"),
        ("frame,time_s,a_x_m,a_y_mm,a_z_m", "two units"),
        ("frame,time_s,a_x_m,a_x_m,a_z_m", "stands twice"),
        ("frame,time_s", "no rigid bodies"),
    ],
)
def test_headers_of_a_plain_table_that_do_not_fit(tmp_path: Path, header: str, says: str) -> None:
    path = tmp_path / "t.csv"
    path.write_text(header + "\n")
    with pytest.raises(RecordingError, match=says):
        read_recording(path, markers=("*",))


def test_trc_files_state_their_unit_and_rate(tmp_path: Path) -> None:
    silent = trc(tmp_path / "a.trc", unit="")
    with pytest.raises(SettingError, match="give units m, cm or mm"):
        read_recording(silent, markers=("*",))
    recording = read_recording(silent, markers=("*",), units="mm")
    assert recording.markers[0].position == pytest.approx(ARM[:, 0], abs=1e-12)
    with pytest.raises(SettingError, match="states mm itself"):
        read_recording(trc(tmp_path / "b.trc"), markers=("*",), units="m")
    with pytest.raises(RecordingError, match=r"no rigid bodies in the file \(markers: UA1"):
        read_recording(trc(tmp_path / "c.trc"))
    wrong = read_recording(trc(tmp_path / "d.trc", header={"DataRate": "50"}), markers=("*",))
    assert wrong.rate_hz == pytest.approx(100.0)
    assert [warning.code for warning in wrong.warnings] == ["frame-rate"]


def test_times_in_milliseconds_are_told_by_the_rate(tmp_path: Path) -> None:
    right = read_recording(trc(tmp_path / "a.trc"), markers=("*",))
    path = trc(tmp_path / "b.trc")
    rows = [line.split("\t") for line in path.read_text().splitlines()]
    for row in rows[6:]:
        row[1] = f"{1000.0 * float(row[1]):.3f}"
    path.write_text("\n".join(map("\t".join, rows)) + "\n")
    found = read_recording(path, markers=("*",))
    assert found.time_s == pytest.approx(right.time_s, abs=1e-12)
    assert found.rate_hz == right.rate_hz
    (warning,) = found.warnings
    assert warning.code == "times-in-milliseconds"
    assert "its times go on by 10 a frame, at 100 frames a second as the header states" in warning.message
    # At another rate than the header's nothing says what the times are.
    slower = trc(tmp_path / "c.trc", header={"DataRate": "50"})
    slower.write_text("\n".join(map("\t".join, [*rows[:2], ["50", *rows[2][1:]], *rows[3:]])) + "\n")
    assert [one.code for one in read_recording(slower, markers=("*",)).warnings] == ["frame-rate"]


def test_c3d_files_that_are_none_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "t.c3d"
    path.write_bytes(b"\x02\x50" + bytes(2000))
    with pytest.raises(RecordingError, match="not a C3D file"):
        read_recording(path)
    with pytest.raises(RecordingError, match=r"no rigid bodies \(rotations\) in the file \(markers: UA1"):
        read_recording(c3d(tmp_path / "u.c3d", rotations=False))


def test_poses_do_not_see_where_the_origin_of_a_cluster_is(tmp_path: Path) -> None:
    """The screw of the joint does not depend on the body frames the markers happen to define."""
    settings = Settings(express_in="lab", **CHOICE)
    fitted = analyze(read_recording(table(tmp_path / "a.csv", bodies=False, markers=True), markers=("*",)), settings)
    solved = analyze(read_recording(table(tmp_path / "b.csv", bodies=True, markers=False)), Settings(express_in="lab"))
    known = solved.screw.axis_known
    assert fitted.screw.axis_point[known] == pytest.approx(solved.screw.axis_point[known], abs=1e-9)
    assert fitted.screw.slide[known] == pytest.approx(solved.screw.slide[known], abs=1e-9)
    assert dq.norm(fitted.joint.reference).real == pytest.approx(1.0)


def test_a_damaged_c3d_file_takes_nobody_with_it(tmp_path: Path) -> None:
    """The library behind ezc3d aborts on some of these."""
    good = c3d(tmp_path / "good.c3d", rotations=True).read_bytes()
    rng = np.random.default_rng(1)
    refused = 0
    for k in range(12):
        data = bytearray(good)
        for position in rng.integers(2, 2000, size=40):
            data[position] = int(rng.integers(0, 256))
        path = tmp_path / f"bad{k}.c3d"
        path.write_bytes(bytes(data[: int(rng.integers(600, len(data)))]))
        try:
            read_recording(path)
        except (RecordingError, SettingError):
            refused += 1
    assert refused > 6


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("t.csv", {"units": "mm"}, "plain table"),
        ("t.csv", {"rotation": "XYZ"}, "plain table"),
        ("t.trc", {"rotation": "XYZ", "markers": "*"}, "TRC"),
        ("t.c3d", {"rotation": "XYZ"}, "C3D"),
    ],
)
def test_options_that_mean_nothing_for_a_format_are_refused(
    tmp_path: Path, name: str, options: dict[str, Any], says: str
) -> None:
    path = {
        "t.csv": lambda: table(tmp_path / "t.csv", bodies=True, markers=False),
        "t.trc": lambda: trc(tmp_path / "t.trc"),
        "t.c3d": lambda: c3d(tmp_path / "t.c3d", rotations=True),
    }[name]()
    with pytest.raises(SettingError, match=rf"of this format \({says}\)"):
        read_recording(path, **options)


def test_one_pattern_may_be_given_as_text(tmp_path: Path) -> None:
    path = table(tmp_path / "t.csv", bodies=False, markers=True)
    assert len(read_recording(path, markers="UA*").markers) == 4


def test_a_c3d_file_that_is_cut_is_refused_and_frames_count_from_one(tmp_path: Path) -> None:
    path = c3d(tmp_path / "t.c3d", rotations=True)
    assert read_recording(path).frame[[0, -1]].tolist() == [1, 80]
    data = path.read_bytes()
    cut = tmp_path / "cut.c3d"
    cut.write_bytes(data[: len(data) // 2])
    with pytest.raises(RecordingError):
        read_recording(cut)


def test_the_columns_of_a_trc_file_are_those_its_labels_say(tmp_path: Path) -> None:
    path = trc(tmp_path / "t.trc")
    text = path.read_text()
    path.write_text(text.replace("X1\tY1\tZ1", "X1\tZ1\tY1"))
    with pytest.raises(RecordingError, match=r"t\.trc:5: marker 'UA1': expected its X, Y, Z"):
        read_recording(path, markers="*")
    path.write_text(text.replace("UA1\t\t\tUA2", "UA1\tUA9\tUA2\t"))
    with pytest.raises(RecordingError, match=r"expected its X, Y, Z .* 9 names and 24 axes"):
        read_recording(path, markers="*")
    path.write_text(text.rstrip("\n"))
    assert [warning.code for warning in read_recording(path, markers="*").warnings] == ["no-final-newline"]


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"arm_markers": ("UA*", "UAX"), "forearm_markers": ("FA*",)}, "UAX fits no marker"),
        ({"arm_markers": ("UA*",), "forearm_markers": ("FA*", "UA1")}, "UA1 are chosen for both bodies"),
    ],
)
def test_markers_are_chosen_with_care(tmp_path: Path, settings: dict[str, Any], says: str) -> None:
    recording = read_recording(table(tmp_path / "t.csv", bodies=False, markers=True), markers="*")
    with pytest.raises(SettingError, match=says):
        analyze(recording, Settings(**settings))


def test_markers_on_a_line_are_refused_and_origins_are_not_seen(tmp_path: Path) -> None:
    flat: dict[str, Any] = {"arm_markers": ("UA1", "UA2", "UA3"), "forearm_markers": ("FA*",)}
    change = {(row, 2 + 3 * k + axis): repr(0.1 * (k + 1)) for row in range(80) for k in range(3) for axis in range(3)}
    recording = read_recording(table(tmp_path / "t.csv", bodies=False, markers=True, change=change), markers="*")
    with pytest.raises(SettingError, match="one line"):
        analyze(recording, Settings(**flat))
    zeros = {(row, 14 + axis): "0" for row in (5, 40) for axis in range(3)}
    recording = read_recording(table(tmp_path / "u.csv", bodies=False, markers=True, change=zeros), markers="*")
    assert analyze(recording, Settings(**CHOICE)).screw.angle == pytest.approx(TRIAL.angle, abs=1e-9)


def test_a_marker_gone_astray_for_a_frame_does_not_bend_the_cluster(tmp_path: Path) -> None:
    change = {(33, 14): repr(50.0)}
    recording = read_recording(table(tmp_path / "t.csv", bodies=False, markers=True, change=change), markers="*")
    analysis = analyze(recording, Settings(**CHOICE))
    assert np.flatnonzero(~analysis.screw.valid).tolist() == [33]
    good = analysis.screw.valid
    assert analysis.screw.angle[good] == pytest.approx(TRIAL.angle[good], abs=1e-9)
    assert {"marker-residual", "leap"} <= {warning.code for warning in analysis.warnings}


@pytest.mark.parametrize("far", ["1e300", "-20000"])
def test_markers_kilometers_away_are_not_seen(tmp_path: Path, far: str) -> None:
    whole = read_recording(table(tmp_path / "t.csv", bodies=False, markers=True), markers="*")
    path = table(tmp_path / "far.csv", bodies=False, markers=True, change={(7, 3): far})
    recording = read_recording(path, markers="*")
    assert [warning.code for warning in recording.warnings] == ["invalid-marker"]
    name = recording.markers[0].name
    assert np.flatnonzero(np.isnan(recording.markers[0].position).any(axis=1)).tolist() == [7]
    settings = Settings(proximal_markers=("UA*",), distal_markers=("FA*",))
    found, expected = analyze(recording, settings).screw, analyze(whole, settings).screw
    assert name == "UA1"
    assert found.angle == pytest.approx(expected.angle, abs=1e-9)  # the other markers of the cluster give the pose


def test_info_tells_of_markers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = table(tmp_path / "t.csv", bodies=False, markers=True, change={(3, 2): "", (3, 3): "", (3, 4): ""})
    assert main(["info", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert {marker["name"]: marker["seen_share"] for marker in told["markers"]}["UA1"] == pytest.approx(79 / 80)
    assert len(told["markers"]) == 8
    assert main(["info", str(path)]) == 0
    assert "8 markers" in capsys.readouterr().out


def test_times_too_close_for_any_rate_give_none() -> None:
    frame = np.array([0, 9])
    assert np.isnan(rate_of(frame, np.array([0.0, 1e-320])))
    assert np.isnan(rate_of(frame, np.array([1.0, 0.0])))
    assert rate_of(frame, np.array([0.0, 0.09])) == pytest.approx(100.0)


def test_text_of_windows_is_read_and_told(tmp_path: Path) -> None:
    """A path with an umlaut in the first line, as an exporting program writes it, is no wall."""
    text = (
        "PathFileType\t4\t(X/Y/Z)\tC:\\Users\\J\u00f6rg\\t.trc\nDataRate\tUnits\n100\tmm\n"
        "Frame#\tTime\tArm l\u00e4ngs\t\t\n\t\tX1\tY1\tZ1\n\n1\t0\t100\t2\t3\n2\t0.01\t100\t2\t4\n"
    )
    paths = [tmp_path / "windows.trc", tmp_path / "utf8.trc"]
    for path, encoding in zip(paths, ("cp1252", "utf-8"), strict=True):
        path.write_bytes(text.encode(encoding))
    one, other = (read_recording(path, markers="Arm*") for path in paths)
    assert one.markers[0].name == other.markers[0].name == "Arm l\u00e4ngs"
    assert np.array_equal(one.markers[0].position, other.markers[0].position)
    assert [(warning.code, warning.severity) for warning in one.warnings] == [("not-utf-8", "note")]
    assert other.warnings == ()


def test_a_table_that_begins_with_frame_is_sent_to_columns(tmp_path: Path) -> None:
    path = tmp_path / "suit.csv"
    path.write_text("Frame,Right Upper Arm q0,Right Upper Arm q1\n0,1,0\n")
    with pytest.raises(RecordingError, match=r"once columns FILE\.toml says"):
        read_recording(path)
