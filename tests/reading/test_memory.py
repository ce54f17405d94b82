"""A reader needs little more memory than what is kept of a file, whatever its width."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from motive_files import bodies_of
from oracles import known_trial, quaternion_xyzw

from elbowscrew import read_recording
from elbowscrew.errors import RecordingError
from elbowscrew.reading import source

ROWS, MARKERS = 40_000, 40


@pytest.fixture(scope="module")
def wide_take(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two bodies and forty markers that nobody asks for, and whose cells are no numbers."""
    trial = known_trial(90.0, frames=200, inversion=100)
    labels: list[tuple[str, ...]] = []
    cells: list[list[str]] = [[] for _ in range(200)]
    for body in bodies_of(trial):
        labels += [("Rigid Body", body.name, body.identifier, "Rotation", axis) for axis in "XYZW"]
        labels += [("Rigid Body", body.name, body.identifier, "Position", axis) for axis in "XYZ"]
        data = np.concatenate([quaternion_xyzw(body.R), body.p], axis=1)
        for k, row in enumerate(data.tolist()):
            cells[k] += [f"{value:.6f}" for value in row]
    for k in range(MARKERS):
        labels += [("Marker", f"Unlabeled {k}", f"{k}", "Position", axis) for axis in "XYZ"]
    rest = ",".join(["not-read"] * (3 * MARKERS))
    path = tmp_path_factory.mktemp("wide") / "wide.csv"
    with path.open("w") as stream:
        stream.write("Format Version,1.23,Export Frame Rate,100,Rotation Type,Quaternion,Length Units,Meters\n\n")
        for row, title in enumerate(("Type", "Name", "ID", "")):
            stream.write(",".join(["", title, *(label[row] for label in labels)]) + "\n")
        stream.write(",".join(["Frame", "Time (Seconds)", *(label[4] for label in labels)]) + "\n")
        stream.writelines(f"{k},{k / 100:.6f},{','.join(cells[k % 200])},{rest}\n" for k in range(ROWS))
    return path


def test_memory_is_bounded_by_the_columns_kept(wide_take: Path) -> None:
    kept = ROWS * (2 + 2 * 7) * 8  # frame, time, and seven cells a body, in float64
    block = 8 << 20  # some thousand lines of text, whatever the length of the file
    read_recording(wide_take)  # imports are not the reader's memory
    tracemalloc.start()
    try:
        recording = read_recording(wide_take)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert recording.frame.size == ROWS
    assert peak < 1.5 * kept + block


def long_take(path: Path, kind: str) -> Path:
    """A long recording of two bodies (or six markers) in one of the other formats."""
    trial = known_trial(90.0, frames=200, inversion=100)
    poses = [np.concatenate([quaternion_xyzw(b.R)[:, [3, 0, 1, 2]], b.p], axis=1) for b in bodies_of(trial)]
    texts = [[",".join(f"{value:.6f}" for value in row) for row in pose.tolist()] for pose in poses]
    tagged = [
        [",".join(f"{value:.6f}" for value in (*row[4:], *row[1:4], row[0])) for row in pose.tolist()] for pose in poses
    ]
    with path.open("w") as stream:
        if kind == "row-tagged":
            stream.write("righthanded\n" + "".join(f'rigidbody,"b{k}",{k},0\n' for k in (1, 2)))
            stream.writelines(
                f"frame,{k},{k / 100:.6f},2,1,{tagged[0][k % 200]},0,0,0,2,{tagged[1][k % 200]},0,0,0,0\n"
                for k in range(ROWS)
            )
        elif kind == "plain table":
            names = [f"b{k}_{part}" for k in (1, 2) for part in ("e0", "e1", "e2", "e3", "x_m", "y_m", "z_m")]
            stream.write(",".join(["frame,time_s", *names]) + "\n")
            stream.writelines(f"{k},{k / 100:.6f},{texts[0][k % 200]},{texts[1][k % 200]}\n" for k in range(ROWS))
        else:
            titles = "".join(f"m{k}\t\t\t" for k in range(5))
            stream.write(
                f"PathFileType\t4\nDataRate\tUnits\n100\tmm\nFrame#\tTime\t{titles}\n\t\t" + "X\tY\tZ\t" * 5 + "\n"
            )
            stream.writelines(
                f"{k}\t{k / 100:.6f}\t" + "\t".join(f"{k + j}.25" for j in range(15)) + "\n" for k in range(ROWS)
            )
    return path


@pytest.mark.parametrize("kind", ["row-tagged", "plain table", "TRC"])
def test_memory_is_bounded_in_every_format(tmp_path: Path, kind: str) -> None:
    path = long_take(tmp_path / "long.txt", kind)
    markers = "*" if kind == "TRC" else ()
    read_recording(path, markers=markers)
    tracemalloc.start()
    try:
        recording = read_recording(path, markers=markers)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert recording.frame.size == ROWS
    assert peak < 1.5 * ROWS * (2 + (15 if kind == "TRC" else 14)) * 8 + (8 << 20)


def test_columns_that_are_not_in_use_are_not_read(wide_take: Path) -> None:
    assert all(body.tracked.all() for body in read_recording(wide_take).bodies)
    with pytest.raises(RecordingError, match="expected a number, found 'not-read'"):
        read_recording(wide_take, markers=("Unlabeled 7",))


def test_an_endless_line_is_refused_without_reading_it_all(tmp_path: Path) -> None:
    path = tmp_path / "endless.csv"
    with path.open("w") as stream:
        stream.write("Format Version,1.23\n\n")
        for _ in range(40):
            stream.write("x" * (1 << 20))
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match=r"endless\.csv:3: a line of over"):
            read_recording(path)
        assert tracemalloc.get_traced_memory()[1] < 100 << 20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("last", ["", "end"])
def test_lines_are_the_same_one_by_one_and_many_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: str, last: str
) -> None:
    lines = [f"{k},{'é' * (k % 50)}" if k % 9 else "" for k in range(1000)]
    path = tmp_path / "t.csv"
    path.write_bytes(b"\xef\xbb\xbf" + end.join([*lines, last]).encode())
    opened = source.open_source(path)
    expected = [*lines, last] if last else lines
    assert list(opened.lines()) == expected
    for size in (1, 2, 100, 1 << 20):
        monkeypatch.setattr(source, "_BLOCK_CHARACTERS", size)
        assert [line for block in opened.blocks(3) for line in block] == expected[3:]
    assert list(opened.blocks(2000)) == []


def test_a_line_between_two_blocks_is_told_if_it_is_too_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(source, "_MAX_LINE", 100)
    path = tmp_path / "t.csv"
    path.write_text("1,2\n" + "x" * 99 + "\n" + "1,2\n" * 50)
    for size in (2, 30, 90, 150, 1000):
        monkeypatch.setattr(source, "_BLOCK_CHARACTERS", size)
        assert sum(len(block) for block in source.open_source(path).blocks(0)) == 52
    path.write_text("1,2\n" * 7 + "x" * 100 + "\n" + "1,2\n" * 50)
    for size in (2, 30, 90, 150, 1000):
        monkeypatch.setattr(source, "_BLOCK_CHARACTERS", size)
        with pytest.raises(RecordingError, match=r"t\.csv:8: a line of over 100 characters"):
            list(source.open_source(path).blocks(0))
