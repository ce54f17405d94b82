"""Numbers that are not as they were written are named and never passed on."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from sealed import resealed

from elbowscrew import analyze, compare, save_analysis, save_comparison, simulate_trial
from elbowscrew._version import __version__
from elbowscrew.cli import main
from elbowscrew.errors import OutputError, ResultError
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.opening import sha256_of
from elbowscrew.report import remake_pages, write_study_page, write_trial_page
from elbowscrew.report.study import read_study
from elbowscrew.results.proof import ProvedFile, proof_of
from elbowscrew.results.staging import check_result_folder
from elbowscrew.results.summary_reading import read_summary
from elbowscrew.results.trial_views import view_of_result

STRAYS = (".DS_Store", "Thumbs.db", "desktop.ini")
needs_sha256sum = pytest.mark.skipif(shutil.which("sha256sum") is None, reason="no sha256sum")


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    analysis = analyze(simulate_trial(frames=60, inversion=30, repetitions=2, seed=3).recording)
    folder = tmp_path_factory.mktemp("proof") / "r"
    return save_analysis(analysis, folder, figure_formats=("svg",), exports=("sto",))


@pytest.fixture
def copy(result: Path, tmp_path: Path) -> Path:
    return shutil.copytree(result, tmp_path / "r")


def check(folder: Path) -> list[str]:
    """What ``sha256sum`` finds wrong; every file of the folder must be named."""
    done = subprocess.run(
        ["sha256sum", "--check", "--quiet", "--strict", "SHA256SUMS"], cwd=folder, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    named = [line.split("  ", 1)[1] for line in (folder / "SHA256SUMS").read_text().splitlines()]
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert set(named) == files - {"SHA256SUMS"}
    return [line.split(":", 1)[0] for line in done.stdout.splitlines()]


@needs_sha256sum
def test_sha256sum_finds_every_file_as_it_was_written_and_a_changed_one(copy: Path) -> None:
    assert check(copy) == []
    write_trial_page(copy)
    assert check(copy) == []
    (copy / "figures" / "theta.svg").write_text("<svg/>")
    assert check(copy) == ["figures/theta.svg"]


@needs_sha256sum
def test_a_comparison_has_its_digests(tmp_path: Path) -> None:
    plan = ComparisonPlan(laws=("linear",), counts=(2,), data=("raw",))
    found = compare(simulate_trial(frames=60, inversion=30).recording, plan=plan)
    assert check(save_comparison(found, tmp_path / "c", figure_formats=())) == []


@needs_sha256sum
def test_a_page_made_again_has_its_digest(copy: Path) -> None:
    page = copy / "report.html"
    page.write_text(page.read_text(encoding="utf-8").replace("<title>", "<title>Old "), encoding="utf-8")
    resealed(copy)
    before = (copy / "SHA256SUMS").read_text()
    write_trial_page(copy)
    after = (copy / "SHA256SUMS").read_text()
    changed = set(before.splitlines()) ^ set(after.splitlines())
    assert {line.split("  ")[1] for line in changed} == {"report.html"}
    assert check(copy) == []
    assert {path.name for path in copy.iterdir() if path.name.startswith(".")} == set()


def edit(path: Path) -> None:
    """Change one digit, to another one."""
    text = path.read_bytes()
    place = max(text.rfind(digit) for digit in b"1234567")
    path.write_bytes(text[:place] + bytes([text[place] + 1]) + text[place + 1 :])


def numbers(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.is_file() and path.suffix in (".csv", ".json", ".sto"))


def test_whatever_file_of_numbers_was_edited_is_named(result: Path, tmp_path: Path) -> None:
    names = numbers(result)
    assert len(names) > 8
    for name in names:
        folder = shutil.copytree(result, tmp_path / name)
        page = (folder / "report.html").read_bytes()
        edit(folder / name)
        with pytest.raises(ResultError, match=rf"{name}: not as it was written.*SHA256SUMS") as told:
            write_trial_page(folder)
        assert "\n" not in str(told.value)
        with pytest.raises(ResultError, match=name):
            view_of_result(folder)
        assert (folder / "report.html").read_bytes() == page
        (folder / name).unlink()
        with pytest.raises(ResultError, match=name):
            view_of_result(folder)


@pytest.mark.parametrize("check", [lambda folder: proof_of(folder).check_numbers(), view_of_result])
def test_all_files_of_numbers_that_were_edited_are_named_together(copy: Path, check: Callable[[Path], object]) -> None:
    names = ("screw.csv", "interpolation.csv", "keyframes.csv")
    for name in names:
        (copy / name).write_text("0")
    with pytest.raises(ResultError) as caught:
        check(copy)
    text = str(caught.value)
    assert [text.count(name) for name in names] == [1, 1, 1]
    assert text.startswith(str(copy))
    assert text.endswith("not as it was written: edited, cut or missing, as SHA256SUMS tells; analyze the trial again")


def test_doubled_angles_and_a_summary_of_999_are_never_passed_on(copy: Path, tmp_path: Path) -> None:
    for name in ("tables", "summary"):
        shutil.copytree(copy, tmp_path / "study" / name)
    table = tmp_path / "study" / "tables" / "screw.csv"
    header, *rows = [line.split(",") for line in table.read_text().splitlines()]
    place = header.index("theta_deg")
    for row in rows:
        row[place] = row[place] and repr(2.0 * float(row[place]))
    table.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n")
    path = tmp_path / "study" / "summary" / "summary.json"
    summary = json.loads(path.read_text())
    summary["motion"]["theta_max_deg"] = 999.5
    path.write_text(json.dumps(summary))
    shutil.copytree(copy, tmp_path / "study" / "sound")
    page = write_study_page(tmp_path / "study").read_text(encoding="utf-8")
    assert "999.5" not in page
    assert page.count("not as it was written") == 2
    assert "1 trial" in page


def test_a_file_of_ours_that_has_no_digest_proves_nothing(copy: Path) -> None:
    (copy / "anatomy.csv").write_text("frame\n")
    (copy / "notes of mine.txt").write_text("a user's")
    assert proof_of(copy).changed() == ("anatomy.csv",)
    with pytest.raises(ResultError, match=r"anatomy\.csv"):
        view_of_result(copy)
    (copy / "anatomy.csv").unlink()
    view_of_result(copy)


def test_figures_may_be_retouched(copy: Path) -> None:
    (copy / "figures" / "theta.svg").write_text("<svg/>")
    write_trial_page(copy)
    assert (copy / "figures" / "theta.svg").read_text() == "<svg/>"


def test_a_result_without_digests_is_refused_with_both_versions(copy: Path) -> None:
    (copy / "SHA256SUMS").unlink()
    with pytest.raises(ResultError, match="has no SHA256SUMS") as told:
        view_of_result(copy)
    assert str(told.value).count(__version__) == 2


@pytest.mark.parametrize("text", ["", "abc\n", "0" * 64 + "  screw.csv", "0" * 64 + "  ../precious\n", "\0\0"])
def test_digests_that_are_none_are_refused(copy: Path, text: str) -> None:
    (copy / "SHA256SUMS").write_text(text)
    with pytest.raises(ResultError) as told:
        view_of_result(copy)
    assert "SHA256SUMS" in str(told.value)
    assert "\n" not in str(told.value)


def test_a_file_that_changes_while_it_is_read_is_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "screw.csv"
    path.write_bytes(b"0,1\n" * 1_000_000)
    source = ProvedFile(path, sha256_of(path))
    with source.opened() as stream:
        assert stream.read() == path.read_bytes()

    def read_and_change() -> None:
        with source.opened() as stream:
            stream.read(10)
            with path.open("r+b") as other:
                other.seek(-2, 2)
                other.write(b"2")

    with pytest.raises(ResultError, match="not as it was written"):
        read_and_change()


def test_files_of_two_states_of_a_result_do_not_go_together(copy: Path) -> None:
    """A result that is replaced while it is read: what comes after is not of the digests that were read."""
    proof = proof_of(copy)
    read_summary(proof)
    other = simulate_trial(frames=60, inversion=30, seed=4).recording
    save_analysis(analyze(other), copy, overwrite=True, figure_formats=())
    with pytest.raises(ResultError, match="not as it was written"):
        read_summary(proof)


@pytest.mark.parametrize("stray", STRAYS)
def test_what_desktops_leave_blocks_nothing(copy: Path, stray: str) -> None:
    for place in (copy, copy / "figures"):
        (place / stray).write_bytes(b"\0\1")
    recording = simulate_trial(frames=60, inversion=30, seed=4).recording
    write_trial_page(copy)
    save_analysis(analyze(recording), copy, overwrite=True, figure_formats=())
    assert not (copy / stray).exists()
    empty = copy.parent / "empty"
    empty.mkdir()
    (empty / stray).write_bytes(b"\0\1")
    save_analysis(analyze(recording), empty, figure_formats=(), report=False)
    assert (empty / "summary.json").exists()


@pytest.mark.parametrize("kept", [0, 1, 15, 700])
@pytest.mark.parametrize("zeros", [0, 512])
def test_a_summary_that_a_crash_has_cut_does_not_block_force(copy: Path, kept: int, zeros: int) -> None:
    path = copy / "summary.json"
    path.write_bytes(path.read_bytes()[:kept] + b"\0" * zeros)
    check_result_folder(copy, force=True)
    path.write_text('{"my": "data"}')
    with pytest.raises(OutputError, match="no elbowscrew result"):
        check_result_folder(copy, force=True)


def test_pages_that_a_crash_has_emptied_are_made_again(copy: Path) -> None:
    for content in (b"", b"\0" * 512):
        (copy / "report.html").write_bytes(content)
        (copy.parent / "index.html").write_bytes(content)
        assert main(["report", str(copy.parent), "-q"]) == 0
        assert (copy / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
        assert (copy.parent / "index.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("name", ["summary.json", "screw.csv"])
def test_a_result_that_has_lost_a_file_is_not_passed_over(copy: Path, name: str) -> None:
    (copy / name).unlink()
    made = remake_pages([copy.parent])
    assert any(name in str(error) for error in made.errors)
    assert [one.path for one in read_study(copy.parent).unread] == ["r"]
