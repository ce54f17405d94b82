"""C3D files that say one thing and hold another: read as the sound one, or refused with the reason."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Literal

import c3d_files
import ezc3d
import numpy as np
import pytest

from elbowscrew import read_recording
from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.reading.c3d_checks import check_sizes
from elbowscrew.reading.c3d_parameters import Statements

PLACES: Float = np.random.default_rng(5).uniform(-900.0, 900.0, (3, 4, 30)).astype(np.float32).astype(np.float64)
FRAMES_AT, ANALOG_AT, DATA_AT = 8, 4, 16


def sound(
    path: Path, *, analog: bool = False, rotations: bool = False, flagged: bool = False, samples: int = 2
) -> bytes:
    content = ezc3d.c3d()
    content["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    content["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    content["parameters"]["POINT"]["LABELS"]["value"] = ("P1", "P2", "P3", "P4")
    points = np.ones((4, 4, 30))
    points[:3] = PLACES
    content["data"]["points"] = points
    if flagged:
        content["data"]["meta_points"]["residuals"] = np.full((1, 4, 30), -1.0)
    if analog:
        content["parameters"]["ANALOG"]["RATE"]["value"] = [100.0 * samples]
        content["parameters"]["ANALOG"]["LABELS"]["value"] = ("V1", "V2")
        content["parameters"]["ANALOG"]["UNITS"]["value"] = ("V", "V")
        content["parameters"]["ANALOG"]["SCALE"]["value"] = [1.0, 1.0]
        content["parameters"]["ANALOG"]["OFFSET"]["value"] = [0, 0]
        content["data"]["analogs"] = np.arange(60.0 * samples).reshape(1, 2, 30 * samples)
    if rotations:
        content["data"]["rotations"] = np.tile(np.eye(4)[:, :, None, None], (1, 1, 2, 30))
        content.add_parameter("ROTATION", "RATE", [100.0])
        content.add_parameter("ROTATION", "LABELS", ("Arm", "Forearm"))
    content.write(str(path))
    return path.read_bytes()


def positions(path: Path) -> Float:
    recording = read_recording(path, markers="*")
    assert [marker.name for marker in recording.markers] == ["P1", "P2", "P3", "P4"]
    return np.stack([1000.0 * marker.position.T for marker in recording.markers], axis=1)


def header(data: bytes, at: int, value: int) -> bytes:
    return data[:at] + struct.pack("<H", value) + data[at + 2 :]


@pytest.mark.parametrize("analog", [False, True])
@pytest.mark.parametrize("processor", ["DEC", "SGI"])
def test_numbers_of_other_machines(tmp_path: Path, processor: Literal["DEC", "SGI"], analog: bool) -> None:
    path = tmp_path / "t.c3d"
    path.write_bytes(c3d_files.of_processor(sound(path, analog=analog), processor))
    assert positions(path) == pytest.approx(PLACES, rel=1e-6)


def test_offsets_of_floats(tmp_path: Path) -> None:
    path = tmp_path / "t.c3d"
    data = bytearray(sound(path, analog=True))
    offset = next(one for one in c3d_files.parameters(bytes(data)) if one.name == "OFFSET")
    # Two floats take the place of two whole numbers and the four bytes that begin the next entry: it moves down.
    behind = offset.values_at + 4
    end = struct.unpack_from("<H", data, DATA_AT)[0] * c3d_files.BLOCK - c3d_files.BLOCK
    link_at = next(at for at in reversed([*c3d_files.links(bytes(data))]) if at < offset.kind_at)
    data[behind:end] = bytes(4) + data[behind : end - 4]
    struct.pack_into("<H", data, link_at, struct.unpack_from("<H", data, link_at)[0] + 4)
    data[offset.kind_at] = 4
    struct.pack_into("<2f", data, offset.values_at, 0.5, -0.5)
    path.write_bytes(data)
    with pytest.raises(ValueError, match="OFFSET"):
        ezc3d.c3d(str(path))
    assert positions(path) == pytest.approx(PLACES, rel=1e-6)


def test_analog_words_that_the_parameters_do_not_declare(tmp_path: Path) -> None:
    path = tmp_path / "t.c3d"
    data = sound(path)
    start = struct.unpack_from("<H", data, DATA_AT)[0] * c3d_files.BLOCK - c3d_files.BLOCK
    frames = np.frombuffer(data[start : start + 30 * 64], dtype="<f4").reshape(30, 16)
    shifted = np.concatenate([frames, np.full((30, 6), 7.0, dtype="<f4")], axis=1).tobytes()
    shifted += bytes(-len(shifted) % c3d_files.BLOCK)
    path.write_bytes(header(data[:start], ANALOG_AT, 6) + shifted)
    with pytest.raises(RecordingError, match=r"6 analog words a frame, the parameters of 4 and 0, .* is not certain"):
        read_recording(path, markers="*")


def test_a_header_that_is_wrong_beside_right_parameters(tmp_path: Path) -> None:
    path = tmp_path / "t.c3d"
    path.write_bytes(header(sound(path, analog=True), ANALOG_AT, 0))
    assert positions(path) == pytest.approx(PLACES, rel=1e-6)


def test_rates_whose_ratio_is_not_whole_in_their_last_digit(tmp_path: Path) -> None:
    """In single precision 119.88 / 23.976 is 4.9999999: the library makes 4 samples of it."""
    path = tmp_path / "t.c3d"
    data = bytearray(sound(path, analog=True, samples=5))
    points, analog, *_ = (one.values_at for one in c3d_files.parameters(bytes(data)) if one.name == "RATE")
    for at, rate in ((points, 23.976), (analog, 119.88)):
        struct.pack_into("<f", data, at, rate)
    path.write_bytes(data)
    assert not np.allclose(ezc3d.c3d(str(path))["data"]["points"][:3], PLACES, rtol=1e-6)
    assert positions(path) == pytest.approx(PLACES, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "number", "kind", "value", "reason"),
    [
        ("FRAMES", 0, "H", 255, "30 and 255 frames .* is not certain"),
        ("FRAMES", 0, "H", 65535, "30 and 65535 frames .* is not certain"),
        ("RATE", 1, "f", 100.0, "4 analog words a frame, the parameters of 4 and 2"),
        ("RATE", 1, "f", 0.0, "4 analog words a frame, the parameters of 4 and 0"),
        ("RATE", 1, "f", 1e9, "no possible rates together"),
        ("RATE", 1, "f", float("nan"), "no possible rates together"),
        ("SCALE", 0, "f", 0.1, "its header tells of floats, but POINT:SCALE is 0.1"),
        ("SCALE", 0, "f", 0.0, "its header tells of floats, but POINT:SCALE is 0"),
        ("RATIO", 0, "H", 0xFF01, "it is cut"),
        ("RATIO", 0, "H", 0, "ROTATION:RATIO is 0, no possible one"),
        ("DATA_START", 1, "H", 300, "it is cut"),
    ],
)
def test_what_the_parameters_cannot_mean_is_refused_before_the_file_is_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, number: int, kind: str, value: float, reason: str
) -> None:
    monkeypatch.setattr("elbowscrew.reading.c3d._worker_output", None)
    path = tmp_path / "t.c3d"
    data = bytearray(sound(path, analog=True, rotations=True))
    at = [one.values_at for one in c3d_files.parameters(bytes(data)) if one.name == name][number]
    struct.pack_into(f"<{kind}", data, at, value)
    path.write_bytes(data)
    with pytest.raises(RecordingError, match=reason):
        read_recording(path, markers="*")


@pytest.mark.parametrize("start", [0, 2, 5, 6])
def test_points_that_the_header_has_begin_elsewhere(tmp_path: Path, start: int) -> None:
    path = tmp_path / "t.c3d"
    path.write_bytes(header(sound(path), DATA_AT, start))
    with pytest.raises(RecordingError, match="where a position stands is not certain"):
        read_recording(path, markers="*")


@pytest.mark.parametrize("rotations", [False, True])
def test_a_file_that_is_cut_is_not_taken_for_a_shorter_one(tmp_path: Path, rotations: bool) -> None:
    path = tmp_path / "t.c3d"
    data = sound(path, rotations=rotations)
    path.write_bytes(data[: len(data) - 700])
    with pytest.raises(RecordingError, match="it is cut: it states 30 frames"):
        read_recording(path, markers="*")


def test_points_that_are_all_flagged(tmp_path: Path) -> None:
    path = tmp_path / "t.c3d"
    sound(path, flagged=True)
    with pytest.raises(RecordingError, match="all points are flagged as not seen"):
        read_recording(path, markers="*")
    sound(path, flagged=True, rotations=True)
    assert [body.name for body in read_recording(path).bodies] == ["Arm", "Forearm"]


def test_cases(real_data: Path) -> None:
    control = read_recording(real_data / "cases" / "c3d_ok.c3d", markers="*")
    mete = read_recording(real_data / "cases" / "c3d_units_mete.c3d", markers="*")
    for one, other in zip(mete.markers, control.markers, strict=True):
        assert one.position == pytest.approx(other.position, rel=1e-5)
    with pytest.raises(RecordingError, match="6 analog words"):
        read_recording(real_data / "cases" / "c3d_analog_undeclared.c3d", markers="*")
    for name in ("theia_rot", "theia_rot_pts"):
        bodies = read_recording(real_data / "cases" / f"{name}.c3d").bodies
        assert [body.name for body in bodies] == ["r_uarm_4X4", "r_larm_4X4"]


def test_a_parameter_whose_name_has_control_characters_is_told_in_one_line() -> None:
    entry = bytes([3, 1]) + b"A\nB" + bytes([0, 0, 4, 2, 255, 255])
    blocks = (bytes([1, 0x50, 1, 84]) + entry).ljust(512, b"\0")
    with pytest.raises(RecordingError, match=r"up to 'A\\nB' state 65025 values") as found:
        check_sizes(Path("t.c3d"), Statements(bytes(512), 512, blocks, 4096))
    assert "\n" not in str(found.value)


def test_a_temporary_folder_that_takes_nothing_is_no_fault_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "t.c3d"
    path.write_bytes(c3d_files.of_processor(sound(path), "SGI"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    with pytest.raises(RecordingError, match=r"t\.c3d: a copy to open it by cannot be written: .*; make room"):
        read_recording(path, markers="*")


def test_a_process_that_cannot_be_started_is_no_fault_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "t.c3d"
    sound(path)
    monkeypatch.setattr("sys.executable", str(tmp_path / "missing"))
    with pytest.raises(RecordingError, match=r"t\.c3d: the process that opens it cannot be started: No such file"):
        read_recording(path, markers="*")
