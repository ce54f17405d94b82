"""Results appear whole or not at all, and nothing of the user's is lost."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from elbowscrew.errors import OutputError
from elbowscrew.io.staging import result_folder, write_file


def earlier_result(folder: Path) -> Path:
    folder.mkdir()
    (folder / "summary.json").write_text("old")
    (folder / "figures").mkdir()
    (folder / "figures" / "theta.png").write_text("old")
    return folder


def test_a_new_folder_appears_when_the_block_ends(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "result"
    with result_folder(target, force=False) as staged:
        (staged / "summary.json").write_text("new")
        assert not target.exists()
    assert (target / "summary.json").read_text() == "new"
    assert [path.name for path in target.parent.iterdir()] == ["result"]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError()])
def test_a_failure_leaves_nothing_and_keeps_the_earlier_result(tmp_path: Path, error: BaseException) -> None:
    target = earlier_result(tmp_path / "result")
    expected = OutputError if isinstance(error, OSError) else type(error)

    def fail_half_way() -> None:
        with result_folder(target, force=True) as staged:
            (staged / "summary.json").write_text("half")
            raise error

    with pytest.raises(expected):
        fail_half_way()
    assert (target / "summary.json").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_an_earlier_result_is_replaced_whole_on_request_only(tmp_path: Path) -> None:
    target = earlier_result(tmp_path / "result")
    with pytest.raises(OutputError, match="--force"), result_folder(target, force=False):
        pass
    with result_folder(target, force=True) as staged:
        (staged / "summary.json").write_text("new")
    assert sorted(path.name for path in target.iterdir()) == ["summary.json"]
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_a_folder_with_anything_else_in_it_is_never_replaced(tmp_path: Path) -> None:
    target = earlier_result(tmp_path / "result")
    (target / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match=r"notes\.txt"), result_folder(target, force=True):
        pass
    assert (target / "notes.txt").read_text() == "mine"
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "screw.csv").write_text("mine")
    with pytest.raises(OutputError, match="no elbowscrew result"), result_folder(foreign, force=True):
        pass


def test_an_empty_folder_is_taken_over_and_a_file_is_not(tmp_path: Path) -> None:
    target = tmp_path / "empty"
    target.mkdir()
    with result_folder(target, force=False) as staged:
        (staged / "summary.json").write_text("new")
    assert (target / "summary.json").exists()
    file = tmp_path / "file"
    file.write_text("mine")
    with pytest.raises(OutputError, match="no folder"), result_folder(file, force=True):
        pass
    assert file.read_text() == "mine"


def test_a_file_is_replaced_on_request_only(tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    write_file(target, ["one"], force=False)
    with pytest.raises(OutputError, match="--force"):
        write_file(target, ["two"], force=False)
    assert target.read_text() == "one\n"
    write_file(target, ["two"], force=True)
    assert target.read_text() == "two\n"
    with pytest.raises(OutputError, match="no file"):
        write_file(tmp_path, ["three"], force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv"]


def test_an_interrupted_file_leaves_nothing(tmp_path: Path) -> None:
    def lines() -> object:
        yield "one"
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_file(tmp_path / "out.csv", lines(), force=False)  # type: ignore[arg-type]
    assert os.listdir(tmp_path) == []  # noqa: PTH208 - hidden files count too
