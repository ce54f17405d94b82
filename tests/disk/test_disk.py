"""What is put on disk is the former state or the next one, whoever dies or fails in between."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from elbowscrew.disk import file_sets, folders, placing
from elbowscrew.disk.file_sets import write_set
from elbowscrew.disk.folders import new_folder, sweep
from elbowscrew.disk.placing import put, recover
from elbowscrew.disk.syncing import exchange, signals_held, sync
from elbowscrew.disk.temporary import held_folder, partial_of, replaced_of
from elbowscrew.errors import OutputError
from elbowscrew.results.staging import check_result_folder, result_folder, write_files
from elbowscrew.study.folder import batch_folder

posix = pytest.mark.skipif(sys.platform == "win32", reason="POSIX locks and signals")
OLD, NEW = '{"elbowscrew": "old"}', '{"elbowscrew": "new"}'


def any_folder(_folder: Path) -> None:
    """Let any folder be replaced."""


def result(folder: Path, text: str = OLD) -> Path:
    folder.mkdir(parents=True)
    (folder / "summary.json").write_text(text)
    return folder


def told(folder: Path) -> str:
    return (folder / "summary.json").read_text()


def replace(target: Path) -> None:
    with result_folder(target, force=True) as staged:
        (staged / "summary.json").write_text(NEW)


@pytest.fixture(params=["exchange", "two renames"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    if request.param == "two renames":
        monkeypatch.setattr(placing, "exchange", lambda _one, _other: False)
    return str(request.param)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="renameat2")
def test_two_folders_change_places_in_one_step(tmp_path: Path) -> None:
    one, other = result(tmp_path / "a", OLD), result(tmp_path / "b", NEW)
    assert exchange(one, other)
    assert (told(one), told(other)) == (NEW, OLD)
    with pytest.raises(FileNotFoundError):
        exchange(one, tmp_path / "none")


def test_a_result_is_replaced_and_nothing_is_left(tmp_path: Path, way: str) -> None:
    target = result(tmp_path / "r")
    replace(target)
    assert told(target) == NEW
    assert [path.name for path in tmp_path.iterdir()] == ["r"], way


@pytest.mark.parametrize("number", [1, 2])
def test_a_rename_that_fails_leaves_the_former_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    monkeypatch.setattr(placing, "exchange", lambda _one, _other: False)
    target, rename, calls = result(tmp_path / "r"), Path.rename, []

    def failing(self: Path, to: Path) -> Path:
        calls.append(to)
        if len(calls) == number:
            raise OSError(5, "Input/output error")
        return rename(self, to)

    monkeypatch.setattr(Path, "rename", failing)
    with pytest.raises(OutputError, match="Input/output error"):
        replace(target)
    assert told(target) == OLD
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


def test_a_sync_that_fails_after_the_step_undoes_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str) -> None:
    target = result(tmp_path / "r")

    def failing(path: Path) -> None:
        if path == tmp_path:
            raise OSError(5, f"Input/output error, {way}")

    monkeypatch.setattr(placing, "sync", failing)
    with pytest.raises(OutputError, match="Input/output error"):
        replace(target)
    assert told(target) == OLD
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


def test_what_somebody_adds_at_the_last_moment_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    target, swap = result(tmp_path / "r"), placing._swap

    def late(staged: Path, destination: Path) -> object:
        (destination / "thesis.txt").write_text(way)
        return swap(staged, destination)

    monkeypatch.setattr(placing, "_swap", late)
    with pytest.raises(OutputError, match="thesis"):
        replace(target)
    assert told(target) == OLD
    assert (target / "thesis.txt").read_text() == way


@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT", "SIGHUP"])
def test_a_signal_waits_until_the_step_is_done(tmp_path: Path, way: str, name: str) -> None:
    class Came(BaseException):
        pass

    def handler(_number: int, _frame: object) -> None:
        raise Came

    number = getattr(signal, name)
    before = signal.signal(number, handler)
    try:
        staged, target = result(tmp_path / "staged", NEW), result(tmp_path / "r")
        with pytest.raises(Came):
            put(staged, target, lambda _former: os.kill(os.getpid(), number))
        assert told(target) == NEW
        assert [path.name for path in tmp_path.iterdir()] == ["r"], way
        assert signal.getsignal(number) is handler
        held = []
        with pytest.raises(Came), signals_held():  # noqa: PT012 - when it comes is what is asked
            os.kill(os.getpid(), number)
            held.append(number)
        assert held
    finally:
        signal.signal(number, before)


@posix
def test_a_run_killed_between_two_renames_loses_nothing(tmp_path: Path) -> None:
    target = tmp_path / "r"
    result(replaced_of(tmp_path, "r"))
    result(partial_of(tmp_path, "r"), NEW)
    sweep(tmp_path, held=True)
    with pytest.raises(OutputError, match="there is a result already"):
        check_result_folder(target, force=False)
    assert told(target) == OLD
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


@posix
def test_a_run_killed_after_the_step_leaves_nothing_for_long(tmp_path: Path) -> None:
    target = result(tmp_path / "r", NEW)
    result(replaced_of(tmp_path, "r"))
    result(partial_of(tmp_path, "r"))
    recover(target)
    assert told(target) == NEW
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


@posix
def test_another_run_to_the_same_place_is_told_and_its_work_not_swept(tmp_path: Path) -> None:
    with held_folder(tmp_path, "r") as staged:
        (staged / "summary.json").write_text(NEW)
        with pytest.raises(OutputError, match="another run is writing there"):
            replace(tmp_path / "r")
        sweep(tmp_path, held=True)
        recover(tmp_path / "r")
        assert told(staged) == NEW
    replace(tmp_path / "r")


@posix
def test_a_run_that_was_killed_holds_nothing(tmp_path: Path) -> None:
    script = (
        "import os, sys\nfrom pathlib import Path\nfrom elbowscrew.disk.temporary import held_folder\n"
        "with held_folder(Path(sys.argv[1]), 'r') as staged:\n"
        "    (staged / 'half').touch()\n    os.kill(os.getpid(), 9)\n"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], check=False)
    assert done.returncode == -signal.SIGKILL
    assert len(list(tmp_path.iterdir())) == 1
    replace(tmp_path / "r")
    assert [path.name for path in tmp_path.iterdir()] == ["r"]


def former_files(folder: Path) -> dict[str, str]:
    for name in ("a", "b", "c"):
        (folder / name).write_text(f"old {name}")
    return contents(folder)


def contents(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


@pytest.mark.parametrize("number", range(6))
@pytest.mark.parametrize("error", [OSError(5, "Input/output error"), KeyboardInterrupt()])
def test_of_several_files_all_are_replaced_or_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, error: BaseException
) -> None:
    before, calls = former_files(tmp_path), []

    def failing(name: str) -> None:
        real = getattr(Path, name)

        def call(self: Path, to: Path) -> object:
            calls.append(to)
            if len(calls) == number + 1:
                raise error
            return real(self, to)

        monkeypatch.setattr(Path, name, call)

    failing("rename")
    failing("replace")
    with pytest.raises(type(error)):
        write_set(tmp_path, dict.fromkeys("abc", b"new"), any_folder)
    assert len(calls) > number
    assert contents(tmp_path) == before


@posix
@pytest.mark.parametrize("moves", range(7))
def test_files_of_a_run_that_was_killed_are_the_former_ones_again(tmp_path: Path, moves: int) -> None:
    """A child is killed at its so many-th rename; never does a new file stand beside a former one."""
    before = former_files(tmp_path)
    child = os.fork()
    if child == 0:
        count = 0

        def counted(name: str) -> None:
            real = getattr(Path, name)

            def call(self: Path, *others: Path) -> object:
                nonlocal count
                if count == moves:
                    os.kill(os.getpid(), signal.SIGKILL)
                count += 1
                return real(self, *others)

            setattr(Path, name, call)

        for name in ("rename", "replace", "unlink"):
            counted(name)
        write_set(tmp_path, {name: f"new {name}".encode() for name in "abc"}, any_folder)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    left = {path.name: path.read_text() for path in tmp_path.iterdir() if path.is_file()}
    new = {name: f"new {name}" for name in "abc"}
    assert left.items() <= before.items() or left.items() <= new.items()
    sweep(tmp_path)
    assert contents(tmp_path) == before


@posix
def test_a_file_that_somebody_put_in_the_place_of_a_former_one_stays_and_so_does_that(tmp_path: Path) -> None:
    staged = partial_of(tmp_path, "a/b")
    staged.mkdir()
    (staged / "plan").write_text('{"new": {"a": "0", "b": "0"}, "former": ["a", "b"]}')
    (staged / "former").mkdir()
    for name in "ab":
        (staged / "former" / name).write_text(f"former {name}")
    (tmp_path / "a").write_text("of somebody")
    for _ in range(2):
        sweep(tmp_path)
    assert (tmp_path / "a").read_text() == "of somebody"
    assert (tmp_path / "b").read_text() == "former b"
    assert (staged / "former" / "a").read_text() == "former a"
    write_files(tmp_path, {"a": b"x", "b": b"y"}, replaceable=("",))
    assert (staged / "former" / "a").read_text() == "former a"


def test_a_plan_that_is_none_and_a_name_that_leads_elsewhere_are_not_followed(tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    precious.write_text("mine")
    inner = tmp_path / "out"
    led = '{"new": {"../precious": "0"}, "former": ["../precious"]}'
    for k, plan in enumerate((led, "[", "[1]", '{"a": 1}', '{"new": {"a": 1}, "former": [1]}', "")):
        staged = inner / f".elbowscrew-{k:016x}.partial"
        (staged / "former").mkdir(parents=True)
        (staged / "plan").write_text(plan)
        for name in ("precious", "a"):
            (staged / "former" / name).write_text("other")
    sweep(inner, held=True)
    assert precious.read_text() == "mine"
    assert len(list(inner.rglob("former/a"))) == 6, "former files go with no plan that nobody understands"


class Cut(BaseException):
    """The run ends here, and nothing of it is run any more."""


@pytest.mark.parametrize("text", ["old", "new"])
def test_files_are_put_back_once_when_the_disk_stays_full_be_they_the_same_or_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    """The names are back, their folder cannot be synced, and so the next run finds the plan again."""
    for name in "ab":
        (tmp_path / name).write_text(text)
    before, count = contents(tmp_path), 0

    def filling(path: Path) -> None:
        nonlocal count
        count += 1
        if count >= 4:  # the former ones have gone, and the new ones come
            raise OSError(28, "No space left on device")
        sync(path)

    monkeypatch.setattr(file_sets, "sync", filling)
    with pytest.raises(OutputError, match=r"No space left on device; not all that was begun could be undone"):
        write_files(tmp_path, {"a": b"new", "b": b"new"}, replaceable=("",))
    monkeypatch.undo()
    left = partial_of(tmp_path, "a/b")
    assert (left / "plan").exists()
    sweep(tmp_path)
    assert contents(tmp_path) == before


def test_a_file_that_was_not_there_goes_again_though_power_left_it_in_both_places(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = former_files(tmp_path)
    new = partial_of(tmp_path, "a/x") / "new"

    def cutting(path: Path) -> None:
        sync(path)
        if path == tmp_path and (tmp_path / "x").exists():
            (new / "x").write_text("new")  # that it went from there had not been synced
            raise Cut

    monkeypatch.setattr(file_sets, "sync", cutting)
    monkeypatch.setattr(file_sets, "roll_back", lambda _staged: False)
    with pytest.raises(Cut):
        write_set(tmp_path, dict.fromkeys("ax", b"new"), any_folder)
    monkeypatch.undo()
    sweep(tmp_path)
    assert contents(tmp_path) == before


def test_that_nothing_was_left_behind_is_said_only_where_it_is_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    """The new file is in its place, which cannot be synced; it stays there if the old one is gone."""

    def failing(_path: Path) -> None:
        raise OSError(5, "Input/output error")

    (tmp_path / "a").write_text("old")
    monkeypatch.setattr(placing, "sync", failing)
    with pytest.raises(OutputError) as caught:
        write_files(tmp_path, {"a": b"new"}, replaceable=("",))
    undone = way == "exchange" and sys.platform.startswith("linux")
    after = "nothing was left behind" if undone else "not all that was begun could be undone, so run it again"
    assert str(caught.value).endswith(f"cannot be written: Input/output error; {after}")
    assert contents(tmp_path) == {"a": "old" if undone else "new"}


@posix
def test_an_interruption_while_the_temporary_folder_goes_waits_until_it_is_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unlink = os.unlink
    former = signal.signal(signal.SIGINT, signal.default_int_handler)  # it is ignored in the background

    def interrupted(*given: Any, **more: Any) -> None:
        unlink(*given, **more)
        os.kill(os.getpid(), signal.SIGINT)

    def run() -> None:
        with held_folder(tmp_path, "a") as staged:
            for name in "abc":
                (staged / name).touch()
            monkeypatch.setattr(os, "unlink", interrupted)

    try:
        with pytest.raises(KeyboardInterrupt):
            run()
    finally:
        signal.signal(signal.SIGINT, former)
    assert list(tmp_path.iterdir()) == []


def test_a_lock_that_cannot_be_closed_is_no_error_of_what_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    close = os.close

    def failing(handle: int) -> None:
        close(handle)
        raise OSError(5, "Input/output error")

    with held_folder(tmp_path, "a"):
        monkeypatch.setattr(os, "close", failing)


def test_everything_is_synced_before_it_takes_its_place_and_the_place_after(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[str] = []
    fsync = os.fsync

    def noted(handle: int) -> None:
        path = str(Path(f"/proc/self/fd/{handle}").readlink()) if Path("/proc/self/fd").exists() else ""
        seen.append(path.removeprefix(f"{tmp_path.resolve()}"))
        fsync(handle)

    monkeypatch.setattr(os, "fsync", noted)
    swap = placing._swap

    def marked(staged: Path, destination: Path) -> object:
        seen.append("swap")
        return swap(staged, destination)

    monkeypatch.setattr(placing, "_swap", marked)
    with new_folder(tmp_path / "deep" / "r", any_folder, any_folder) as staged:
        (staged / "figures").mkdir()
        (staged / "figures" / "x").touch()
        (staged / "y").touch()
    if not Path("/proc/self/fd").exists():
        pytest.skip("names of open files are not known here")
    place = f"/deep/{partial_of(tmp_path, 'r').name}"
    before, after = seen[: seen.index("swap")], seen[seen.index("swap") + 1 :]
    assert sorted(before) == sorted(["", f"{place}/figures/x", f"{place}/figures", f"{place}/y", place])
    assert before[-1] == place
    assert before.index(f"{place}/figures/x") < before.index(f"{place}/figures")
    assert after == ["/deep"]


@pytest.mark.parametrize("writer", ["result", "files", "batch"])
def test_folders_made_on_the_way_are_synced_into_theirs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, writer: str
) -> None:
    synced: list[Path] = []
    monkeypatch.setattr(folders, "sync", synced.append)
    out = tmp_path / "a" / "b"
    if writer == "result":
        replace(out / "r")
    elif writer == "files":
        write_files(out, {"x": b"x"}, replaceable=None)
    else:
        with batch_folder(out):
            pass
    assert {tmp_path, tmp_path / "a"} <= set(synced)


def test_folders_made_on_the_way_go_when_they_cannot_be_synced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(_path: Path) -> None:
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(folders, "sync", failing)
    with pytest.raises(OutputError, match="Input/output error"):
        write_files(tmp_path / "a" / "b", {"x": b"x"}, replaceable=None)
    assert list(tmp_path.iterdir()) == []
