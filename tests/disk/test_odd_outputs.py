"""Outputs that people give: mounted folders, folders in ones that take nothing, ``..``, huge folders, long names."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from elbowscrew import save_simulation, simulate_trial
from elbowscrew.cli import main
from elbowscrew.disk import placing
from elbowscrew.errors import OutputError
from elbowscrew.results.staging import check_result_folder, result_folder
from elbowscrew.study.folder import batch_folder

OLD, NEW = '{"elbowscrew": "0.0.1"}', '{"elbowscrew": "0.0.2"}'
posix = pytest.mark.skipif(sys.platform == "win32", reason="processes are forked")


def tree(folder: Path) -> dict[str, str]:
    return {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*") if path.is_file()}


def write_result(target: Path, text: str, figure: str) -> None:
    with result_folder(target, force=True) as staged:
        (staged / "summary.json").write_text(text)
        (staged / "figures").mkdir()
        (staged / "figures" / figure).write_text(text)


@pytest.fixture(params=["mounted", "no exchange", "read-only parent", "truly mounted"])
def fixed(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder that cannot change places."""
    target = tmp_path / "parent" / "out"
    target.mkdir(parents=True)
    if request.param == "truly mounted":
        tried = ["mount", "-t", "tmpfs", "none", str(target)]
        if not sys.platform.startswith("linux") or subprocess.run(tried, check=False, capture_output=True).returncode:
            pytest.skip("nothing can be mounted here")
        yield target
        subprocess.run(["umount", str(target)], check=True)
        return

    def refuse(name: str, number: int, refused: Callable[[Path], bool]) -> None:
        real = getattr(Path, name)

        def call(self: Path, *rest: object, **more: object) -> object:
            if refused(self):
                raise OSError(number, os.strerror(number), str(self))
            return real(self, *rest, **more)

        monkeypatch.setattr(Path, name, call)

    if request.param == "read-only parent":
        refuse("mkdir", errno.EACCES, lambda path: path.parent == target.parent)
    else:
        refuse("rename", errno.EBUSY, lambda path: path == target)

        def exchange(_one: Path, other: Path) -> bool:
            if request.param == "mounted" and other == target:
                raise OSError(errno.EBUSY, os.strerror(errno.EBUSY), str(other))
            return False

        monkeypatch.setattr(placing, "exchange", exchange)
    yield target


def test_a_folder_that_cannot_change_places_is_filled_and_its_result_replaced_whole(fixed: Path) -> None:
    place = fixed.stat().st_ino
    write_result(fixed, OLD, "theta.png")
    first = tree(fixed)
    assert {**first, "SHA256SUMS": ""} == {"summary.json": OLD, "figures/theta.png": OLD, "SHA256SUMS": ""}
    with pytest.raises(OutputError, match="--force"), result_folder(fixed, force=False):
        pass
    write_result(fixed, NEW, "axis.png")
    assert {**tree(fixed), "SHA256SUMS": ""} == {"summary.json": NEW, "figures/axis.png": NEW, "SHA256SUMS": ""}
    assert fixed.stat().st_ino == place
    assert list(fixed.parent.iterdir()) == [fixed]


@posix
@pytest.mark.parametrize("moves", range(8))
def test_a_run_killed_while_it_fills_a_folder_leaves_one_state_and_the_next_run_the_former(
    fixed: Path, moves: int
) -> None:
    """Killed at its so many-th rename inside the folder: three former things and three new ones."""
    write_result(fixed, OLD, "theta.png")
    before = tree(fixed)
    child = os.fork()
    if child == 0:
        count, real = 0, Path.rename

        def counted(self: Path, to: Path) -> Path:
            nonlocal count
            inside = fixed in self.parents
            if inside and count == moves:
                os.kill(os.getpid(), signal.SIGKILL)
            count += inside
            return real(self, to)

        patched: Any = Path
        patched.rename = counted
        write_result(fixed, NEW, "axis.png")
        os._exit(0)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert code == (-signal.SIGKILL if moves < 6 else 0)
    left = {name: text for name, text in tree(fixed).items() if ".elbowscrew-" not in name and name != "SHA256SUMS"}
    assert left.items() <= before.items() or set(left.values()) == {NEW}
    with pytest.raises(OutputError, match="--force"):
        check_result_folder(fixed, force=False)
    assert (
        tree(fixed) == before if moves < 6 else set(tree(fixed)) == {"summary.json", "figures/axis.png", "SHA256SUMS"}
    )


def test_a_small_disk_that_is_mounted_there_says_that_it_is_full(tmp_path: Path) -> None:
    target = tmp_path / "out"
    target.mkdir()
    tried = ["mount", "-t", "tmpfs", "-o", "size=16k", "none", str(target)]
    if not sys.platform.startswith("linux") or subprocess.run(tried, check=False, capture_output=True).returncode:
        pytest.skip("nothing can be mounted here")
    try:
        with pytest.raises(OutputError, match=r"out: cannot be written: No space left on device; nothing was left"):
            write_result(target, OLD + " " * 50_000, "theta.png")
        assert list(target.iterdir()) == []
        assert list(tmp_path.iterdir()) == [target]
    finally:
        subprocess.run(["umount", str(target)], check=True)


def test_what_somebody_adds_to_a_folder_that_is_filled_stays(fixed: Path) -> None:
    write_result(fixed, OLD, "theta.png")
    before = tree(fixed)

    def run() -> None:
        with result_folder(fixed, force=True) as staged:
            (staged / "summary.json").write_text(NEW)
            (fixed / "figures" / "thesis.ai").write_text("mine")

    with pytest.raises(OutputError, match="thesis"):
        run()
    assert tree(fixed) == {**before, "figures/thesis.ai": "mine"}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    save_simulation(simulate_trial(frames=60, inversion=30), tmp_path / "t.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_two_dots_lead_where_the_system_says_and_make_no_folder(here: Path) -> None:
    common = ["--figure-format", "none", "-q"]
    assert main(["analyze", "t.csv", *common, "-o", "none/../one"]) == 0
    assert main(["simulate", "none/../s.csv", "--frames", "60", "--inversion", "30"]) == 0
    assert main(["batch", "t.csv", *common, "--workers", "1", "-o", "none/../many"]) == 0
    assert (here / "one" / "summary.json").is_file()
    assert (here / "s.csv").is_file()
    assert (here / "many" / "t" / "summary.json").is_file()
    assert not (here / "none").exists()


@posix
def test_two_dots_behind_a_link_lead_out_of_where_it_leads(here: Path) -> None:
    (here / "far" / "inner").mkdir(parents=True)
    (here / "link").symlink_to(here / "far" / "inner")
    common = ["--figure-format", "none", "-q"]
    assert main(["batch", "t.csv", *common, "--workers", "1", "-o", "link/../many"]) == 0
    assert main(["analyze", "t.csv", *common, "-o", "link/../one"]) == 0
    assert sorted(path.name for path in (here / "far").iterdir()) == ["inner", "many", "one"]
    assert (here / "far" / "many" / "t" / "summary.json").is_file()
    assert not (here / "many").exists()


@posix
def test_a_path_of_over_260_characters_is_a_path(here: Path) -> None:
    deep = here / ("a" * 150) / ("b" * 150)
    common = ["--figure-format", "none", "-q"]
    assert main(["analyze", "t.csv", *common, "-o", str(deep / "one")]) == 0
    assert main(["batch", "t.csv", *common, "--workers", "1", "-o", str(deep / "many")]) == 0
    assert (deep / "one" / "summary.json").is_file()
    assert (deep / "many" / "t" / "summary.json").is_file()
    assert main(["analyze", "t.csv", *common, "-o", "c" * 300]) == 6


@pytest.mark.parametrize(
    "check", [lambda folder: check_result_folder(folder, force=True), lambda folder: batch_folder(folder).__enter__()]
)
def test_a_folder_with_thousands_of_files_of_others_is_not_walked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, check: Callable[[Path], object]
) -> None:
    for k in range(3000):
        (tmp_path / f"{k}.dat").touch()
    asked, real = 0, os.scandir

    class Counted:
        def __init__(self, path: str) -> None:
            self.entries = real(path)

        def __iter__(self) -> Iterator[os.DirEntry[str]]:
            nonlocal asked
            for one in self.entries:
                asked += 1
                yield one

        def __enter__(self) -> Counted:
            return self

        def __exit__(self, *_error: object) -> None:
            self.entries.close()

    def listed(_path: object) -> list[str]:
        pytest.fail("all names are asked for")

    monkeypatch.setattr(os, "scandir", Counted)
    monkeypatch.setattr(os, "listdir", listed)
    with pytest.raises(OutputError, match=r"the folder holds '\d+\.dat'"):
        check(tmp_path)
    assert 0 < asked < 5
