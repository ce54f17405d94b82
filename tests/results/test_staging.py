"""Results appear whole or not at all, and nothing of the user's is lost."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import pytest

from elbowscrew import plots
from elbowscrew.choices import ExportName, FigureName
from elbowscrew.errors import OutputError
from elbowscrew.plots.registry import FIGURES
from elbowscrew.results.exporting import EXPORTS
from elbowscrew.results.result_files import RESULT_FILES
from elbowscrew.results.staging import replace_file, result_folder, write_files
from elbowscrew.view.figure_names import FIGURE_ENTRIES

OLD = '{"elbowscrew": "0.0.1"}'


def earlier_result(folder: Path) -> Path:
    folder.mkdir()
    (folder / "summary.json").write_text(OLD)
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
    assert (target / "summary.json").read_text() == OLD
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_an_earlier_result_is_replaced_whole_on_request_only(tmp_path: Path) -> None:
    target = earlier_result(tmp_path / "result")
    with pytest.raises(OutputError, match="--force"), result_folder(target, force=False):
        pass
    with result_folder(target, force=True) as staged:
        (staged / "summary.json").write_text("new")
    assert sorted(path.name for path in target.iterdir()) == ["SHA256SUMS", "summary.json"]
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
    with pytest.raises(OutputError, match="not a folder"), result_folder(file, force=True):
        pass
    assert file.read_text() == "mine"


@pytest.mark.parametrize("name", ["figures/edited.ai", "figures/theta.tif", "notes/a.txt"])
def test_files_of_the_user_inside_a_result_are_never_lost(tmp_path: Path, name: str) -> None:
    target = earlier_result(tmp_path / "result")
    (target / name).parent.mkdir(exist_ok=True)
    (target / name).write_text("mine")
    with pytest.raises(OutputError, match="not ours"), result_folder(target, force=True):
        pass
    assert (target / name).read_text() == "mine"


def test_a_summary_of_something_else_is_no_result(tmp_path: Path) -> None:
    target = tmp_path / "mine"
    target.mkdir()
    (target / "summary.json").write_text('{"my": "data"}')
    with pytest.raises(OutputError, match="no elbowscrew result"), result_folder(target, force=True):
        pass


def test_a_summary_that_cannot_be_read_is_not_called_somebody_elses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = earlier_result(tmp_path / "result")

    def fail(path: Path, *_rest: object, **_more: object) -> str:
        raise OSError(errno.EIO, os.strerror(errno.EIO), str(path))

    monkeypatch.setattr("elbowscrew.results.result_files.read_text", fail)
    with (
        pytest.raises(OutputError, match=r"summary\.json: cannot be read \(Input/output error\)") as told,
        result_folder(target, force=True),
    ):
        pass
    assert not isinstance(told.value.__cause__, OSError)  # in a batch it stops no other trial
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


@pytest.mark.parametrize("force", [False, True])
def test_what_appears_meanwhile_is_not_overwritten(tmp_path: Path, force: bool) -> None:
    target = tmp_path / "result"

    def run() -> None:
        with result_folder(target, force=force) as staged:
            (staged / "summary.json").write_text("new")
            target.mkdir()
            (target / "thesis.txt").write_text("mine")

    with pytest.raises(OutputError, match="thesis"):
        run()
    assert [path.name for path in tmp_path.rglob("*")] == ["result", "thesis.txt"]


def test_a_link_to_a_folder_is_followed(tmp_path: Path) -> None:
    real = earlier_result(tmp_path / "real")
    link = tmp_path / "link"
    link.symlink_to(real)
    with result_folder(link, force=True) as staged:
        (staged / "summary.json").write_text(OLD + " ")
    assert link.is_symlink()
    assert (real / "summary.json").read_text() == OLD + " "
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "real"]


def test_folders_made_on_the_way_go_when_it_fails(tmp_path: Path) -> None:
    def run() -> None:
        with result_folder(tmp_path / "a" / "b" / "result", force=False):
            raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space"):
        run()
    assert list(tmp_path.iterdir()) == []


def test_the_current_folder_is_no_result_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match="current folder"), result_folder(Path(), force=True):
        pass


def test_a_result_may_hold_every_saved_figure_and_export() -> None:
    drawn = {name.removeprefix("figures/") for name in RESULT_FILES if name.startswith("figures/")}
    kinds = ("png", "svg", "pdf", "tiff", "eps", "caption.txt")
    assert drawn == {f"{name}.{kind}" for name in plots.FIGURES for kind in kinds}
    assert set(FIGURE_ENTRIES) == set(get_args(FigureName))
    assert {"screw.csv", "screw.parquet", "trial.mat", "joint_angle.sto"} <= set(RESULT_FILES)
    assert set(EXPORTS) == set(get_args(ExportName))


@pytest.mark.parametrize("name", FIGURE_ENTRIES)
def test_every_figure_entry_names_a_function(name: str) -> None:
    assert callable(FIGURES[name])


def test_files_are_replaced_on_request_only_and_only_ours(tmp_path: Path) -> None:
    one, two = tmp_path / "one.csv", tmp_path / "two.json"
    write_files(tmp_path, {one.name: ["synthetic 1"], two.name: ["synthetic 2"]}, replaceable=None)
    with pytest.raises(OutputError, match="--force"):
        write_files(tmp_path, {one.name: ["synthetic 3"]}, replaceable=None)
    write_files(tmp_path, {one.name: ["synthetic 3"]}, replaceable=("synthetic",))
    assert one.read_text() == "synthetic 3\n"
    one.write_text("a recording")
    with pytest.raises(OutputError) as caught:
        write_files(tmp_path, {two.name: ["new"], one.name: ["new"]}, replaceable=("synthetic",))
    assert str(caught.value) == f"{one}: exists already and was not written by elbowscrew; give another name"
    assert (one.read_text(), two.read_text()) == ("a recording", "synthetic 2\n")
    with pytest.raises(OutputError) as caught:
        write_files(tmp_path.parent, {tmp_path.name: ["x"]}, replaceable=("synthetic",))
    assert str(caught.value) == f"{tmp_path}: exists already and is not a file; give another name"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.csv", "two.json"]


def test_of_files_that_belong_together_all_appear_or_none(tmp_path: Path) -> None:
    def lines() -> Iterator[str]:
        yield "one"
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_files(tmp_path, {"a.csv": ["whole"], "b.csv": lines()}, replaceable=None)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["screw.csv", "SHA256SUMS", "figures/theta.png", "report.html"])
def test_a_folder_in_the_place_of_a_file_of_ours_is_somebodys(tmp_path: Path, name: str) -> None:
    target = earlier_result(tmp_path / "result")
    (target / name).unlink(missing_ok=True)
    (target / name).mkdir()
    (target / name / "thesis.tex").write_text("years of work")
    with (
        pytest.raises(OutputError, match=f"the folder holds '{name}/', which is not ours"),
        result_folder(target, force=True) as staged,
    ):
        (staged / "summary.json").write_text("new")
    assert (target / name / "thesis.tex").read_text() == "years of work"


def test_a_folder_in_the_place_of_a_table_of_a_batch_is_somebodys(tmp_path: Path) -> None:
    table = tmp_path / "summary.csv"
    table.mkdir()
    (table / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match=r"summary\.csv: cannot be written: Is a directory"):
        replace_file(table, b"new")
    assert (table / "thesis.tex").read_text() == "years of work"
    assert list(tmp_path.iterdir()) == [table]
