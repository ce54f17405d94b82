"""What is read is a regular file and what is written a new one, whatever has been put in its place."""

from __future__ import annotations

import io
import os
import socket
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from elbowscrew import read_recording, samples
from elbowscrew.cli import main
from elbowscrew.errors import OutputError, RecordingError
from elbowscrew.opening import create, open_bytes, open_own, open_text, read_text, read_toml
from elbowscrew.reading import source
from elbowscrew.results.result_files import BATCH_MARK
from elbowscrew.results.staging import write_files
from elbowscrew.study.folder import at_work, batch_folder

posix = pytest.mark.skipif(sys.platform == "win32", reason="links, pipes and sockets of POSIX")
PRECIOUS = b"years of work\n"


def pipe(path: Path) -> None:
    os.mkfifo(path)


def listener(path: Path) -> None:
    before = Path.cwd()
    os.chdir(path.parent)  # the address of a socket is short
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(path.name)
    os.chdir(before)


def device(path: Path) -> None:
    path.symlink_to("/dev/zero")


class Failing(io.TextIOWrapper):
    """A text whose disk fails when it is closed."""

    def close(self) -> None:
        was_open = not self.closed
        super().close()
        if was_open:
            raise OSError(5, "Input/output error")


def test_a_recording_that_cannot_be_closed_was_read_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "take.csv"
    path.write_text("a,b\n1,2\n")
    recording = source.open_source(path)
    monkeypatch.setattr(source, "open_text", lambda path, encoding: Failing(open_bytes(path), encoding=encoding))
    begun: Any = recording.lines()
    assert next(begun) == "a,b"
    begun.close()  # as Python does to lines that nobody asks for any more, and there nobody could be told
    assert list(recording.lines()) == ["a,b", "1,2"]
    assert list(recording.blocks(1)) == [["1,2"]]


def test_a_disk_that_fails_once_is_told_and_no_file_that_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "take.csv"
    path.write_text("a,b\n1,2\n")
    recording = source.open_source(path)
    calls = []

    def once(path: Path, encoding: str) -> io.TextIOWrapper:
        calls.append(path)
        if len(calls) == 1:
            raise OSError(5, "Input/output error")
        return open_text(path, encoding=encoding)

    monkeypatch.setattr(source, "open_text", once)
    with pytest.raises(RecordingError, match=r"take.csv: cannot be read: Input/output error$"):
        list(recording.blocks(0))


@pytest.mark.parametrize("name", ["elbow_natural", "elbow_row_tagged", "knee"])
def test_an_interruption_while_a_recording_is_closed_is_not_lost(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python passes over what comes while a generator is closed that nobody holds any more."""
    closed, when = 0, -1

    class Interrupted(io.TextIOWrapper):
        def close(self) -> None:
            nonlocal closed
            was_open = not self.closed
            super().close()
            closed += was_open
            if was_open and closed == when:
                raise KeyboardInterrupt

    monkeypatch.setattr(source, "open_text", lambda path, encoding: Interrupted(open_bytes(path), encoding=encoding))
    read_recording(samples.path(name))
    times = closed
    assert times > 1
    for number in range(1, times + 1):
        closed, when = 0, number
        with pytest.raises(KeyboardInterrupt):
            read_recording(samples.path(name))


STRANGE = pytest.mark.parametrize("make", [pipe, listener, device])


@pytest.fixture
def precious(tmp_path: Path) -> Path:
    file = tmp_path / "precious"
    file.write_bytes(PRECIOUS)
    return file


@posix
@STRANGE
@pytest.mark.parametrize("read", [open_bytes, open_text, read_text, open_own])
def test_only_regular_files_are_opened(
    tmp_path: Path, make: Callable[[Path], None], read: Callable[[Path], object]
) -> None:
    make(tmp_path / "file")
    with pytest.raises(OSError, match=r"no regular file|link"):
        read(tmp_path / "file")


def test_a_folder_is_told_as_one(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError if os.name != "nt" else OSError):
        open_bytes(tmp_path)


def test_a_file_larger_than_anybody_means_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"12345678")
    assert read_text(tmp_path / "file", largest=8) == "12345678"
    with pytest.raises(OSError, match="over 7 bytes"):
        read_text(tmp_path / "file", largest=7)


@posix
@STRANGE
def test_a_command_waits_for_no_pipe(
    tmp_path: Path, samples: Path, capsys: pytest.CaptureFixture[str], make: Callable[[Path], None]
) -> None:
    take, strange = samples / "elbow_paper.csv", tmp_path / "strange.csv"
    make(strange)
    assert main(["analyze", str(take), "-o", str(tmp_path / "out"), "--config", str(strange)]) == 2
    assert main(["analyze", str(take), "-o", str(tmp_path / "out"), "--landmarks", str(strange)]) == 2
    assert main(["analyze", str(take), "-o", str(tmp_path / "out"), "--cycles", str(strange)]) == 2
    assert main(["interpolate", str(strange), "--frames", "9"]) == 3
    assert main(["info", str(strange)]) == 3
    assert main(["batch", str(strange), "-o", str(tmp_path / "out")]) in (2, 7)
    told = capsys.readouterr().err.splitlines()
    assert sum("no regular file" in line for line in told) >= 5
    assert not (tmp_path / "out").exists() or (tmp_path / "out" / "failures.csv").exists()


@posix
@STRANGE
@pytest.mark.parametrize("name", ["summary.json", "joint.json", "screw.csv", "interpolation.csv", "report.html"])
def test_nor_for_one_in_a_result(
    tmp_path: Path, samples: Path, capsys: pytest.CaptureFixture[str], make: Callable[[Path], None], name: str
) -> None:
    take, result = str(samples / "elbow_paper.csv"), tmp_path / "study" / "result"
    assert main(["analyze", take, "-o", str(result), "--figure-format", "none", "-q"]) == 0
    (result / name).unlink()
    make(result / name)
    assert main(["report", str(result)]) in (3, 6)
    assert main(["report", str(tmp_path / "study")]) in (3, 6, 0)
    assert main(["analyze", take, "-o", str(result), "--figure-format", "none", "-q"]) == 6
    assert capsys.readouterr().err.count("error") >= 2


@posix
@pytest.mark.parametrize("link", [Path.symlink_to, Path.hardlink_to])
@pytest.mark.parametrize("name", [BATCH_MARK, ".elbowscrew-work.lock"])
def test_a_link_in_the_output_of_a_batch_is_not_followed(
    tmp_path: Path, precious: Path, link: Callable[[Path, Path], None], name: str
) -> None:
    out = tmp_path / "out"
    with batch_folder(out):
        pass
    (out / name).unlink()
    link(out / name, precious)
    with pytest.raises(OutputError, match="link to another file"), batch_folder(out):
        pass
    assert precious.read_bytes() == PRECIOUS
    if name != BATCH_MARK:
        with pytest.raises(OSError, match="link to another file"), at_work(out):
            pass


@posix
@pytest.mark.parametrize("to", ["precious", "not there"])
def test_no_file_is_written_through_a_link(tmp_path: Path, precious: Path, to: str) -> None:
    precious.write_bytes(b"synthetic")
    link = tmp_path / "link.csv"
    link.symlink_to(tmp_path / to)
    with pytest.raises(OutputError, match="is a link"):
        write_files(tmp_path, {link.name: b"synthetic"}, replaceable=("synthetic",))
    with pytest.raises(OSError):  # noqa: PT011 - of the system
        create(link)
    assert link.is_symlink()
    assert precious.read_bytes() == b"synthetic"
    assert not (tmp_path / "not there").exists()


@posix
def test_a_trial_of_a_batch_goes_into_no_other_folder(
    tmp_path: Path, samples: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take, other, out = samples / "elbow_paper.csv", tmp_path / "other", tmp_path / "out"
    assert main(["analyze", str(take), "-o", str(other), "--figure-format", "none", "-q"]) == 0
    before = {path.name: path.read_bytes() for path in other.iterdir()}
    with batch_folder(out):
        (out / "elbow_paper").symlink_to(other)
    common = ["batch", str(take), "-o", str(out), "--figure-format", "none", "--workers", "1", "-q", "--min-angle", "9"]
    assert main(common) == 7
    assert "is a link" in (out / "failures.csv").read_text()
    assert {path.name: path.read_bytes() for path in other.iterdir()} == before


@pytest.mark.parametrize(
    ("text", "says"),
    [("a = " + "9" * 5000, "a whole number of thousands of digits"), ("a = " + "[" * 5000, "too many")],
)
def test_toml_that_nobody_means_is_told_in_words_for_its_author(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(ValueError, match=says) as told:
        read_toml(tmp_path / "a.toml")
    assert "sys." not in str(told.value)
