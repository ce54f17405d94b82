"""The output folder: one batch at a time, nothing of the user's touched, nothing half-written left."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from elbowscrew.disk.temporary import replaced_of
from elbowscrew.errors import OutputError
from elbowscrew.results.result_files import BATCH_MARK
from elbowscrew.study.folder import at_work, batch_folder

HOLDER = """
import sys, time
from pathlib import Path
from elbowscrew.study.folder import batch_folder, at_work
with {held}(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def holder(folder: Path, held: str = "batch_folder") -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER.format(held=held), str(folder)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


def end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


def test_a_second_batch_is_told_of_the_first_and_a_dead_one_holds_nothing(tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = holder(out)
    try:
        with (
            pytest.raises(OutputError, match=rf"another batch is running there \(process {first.pid}\)"),
            batch_folder(out),
        ):
            pass
    finally:
        end(first)
    with batch_folder(out):
        assert f"process {os.getpid()}" in (out / BATCH_MARK).read_text()
    with batch_folder(out):
        pass


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX locks")
def test_a_worker_that_outlives_its_batch_is_waited_for(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with batch_folder(out):
        pass
    worker = holder(out, "at_work")
    threading.Timer(0.5, worker.kill).start()
    with batch_folder(out):
        assert worker.poll() == -signal.SIGKILL
    worker.communicate()


def test_workers_do_not_hinder_each_other(tmp_path: Path) -> None:
    with at_work(tmp_path), at_work(tmp_path):
        pass


def test_leftovers_of_ours_go_and_nothing_else(tmp_path: Path) -> None:
    out = tmp_path / "out"
    former = ".elbowscrew-fedcba9876543210.replaced"  # of a result that is not there: it may be all that is left of it
    kept = [
        former,
        "trial",
        ".elbowscrew-notes.partial",
        ".elbowscrew-0123456789abcdef.txt",
        "0123456789abcdef.partial",
    ]
    with batch_folder(out):
        for name in (*kept, ".elbowscrew-0123456789abcdef.partial", replaced_of(out, "trial").name):
            (out / name / "figures").mkdir(parents=True)
            (out / name / "figures" / "theta.png").touch()
        (out / ".elbowscrew-0123456789abcde0.partial").write_text("half a table")
        elsewhere = tmp_path / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "mine").touch()
        (out / ".elbowscrew-0123456789abcde1.partial").symlink_to(elsewhere)
        leave = shutil.copytree(out, tmp_path / "killed", symlinks=True)  # what a kill -9 at this moment leaves
    with batch_folder(leave):
        assert left(leave) == {*kept, ".elbowscrew-0123456789abcde1.partial"}
    assert left(out) == left(leave)
    assert (elsewhere / "mine").exists()


def left(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir() if path.suffix != ".lock"}


def test_a_folder_of_something_else_is_not_touched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").touch()
    (tmp_path / "file").touch()
    for name, says in (("mine", "holds 'thesis.txt' and is no output of a batch"), ("file", "is not a folder")):
        with pytest.raises(OutputError, match=says), batch_folder(tmp_path / name):
            pass
    monkeypatch.chdir(tmp_path / "mine")
    with pytest.raises(OutputError, match="is the current folder"), batch_folder(Path()):
        pass
    with pytest.raises(OutputError, match="cannot be written"), batch_folder(tmp_path / "file" / "out"):
        pass
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "mine", "thesis.txt"]


def test_an_empty_folder_is_taken_and_an_error_within_is_not_changed(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(OSError, match="of the block"), batch_folder(tmp_path / "out"):
        raise OSError("of the block")
