"""Trees and names as disks and people leave them: one strange thing costs no other trial."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from elbowscrew.cli import main
from elbowscrew.errors import ResultError, UsageError
from elbowscrew.report.study import result_folders
from elbowscrew.results.proof import ProvedFile
from elbowscrew.study.manifest import read_manifest
from elbowscrew.study.trials import find_trials

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="links and names of POSIX")


@pytest.fixture
def take(samples: Path) -> bytes:
    return (samples / "elbow_paper.csv").read_bytes()


@pytest.fixture
def deep(tmp_path: Path, take: bytes) -> Iterator[Path]:
    """A take 1300 folders below: more than Python's own functions remove, so that it is done here."""
    here = Path.cwd()
    try:
        os.chdir(tmp_path)
        for _ in range(1300):
            Path("d").mkdir()
            os.chdir("d")
        Path("take.csv").write_bytes(take)
        yield Path.cwd()
    finally:
        for name in os.listdir():  # noqa: PTH208
            Path(name).unlink()
        while Path.cwd() != tmp_path:
            os.chdir("..")
            Path("d").rmdir()
        os.chdir(here)


def test_a_tree_is_searched_however_deep_it_is(tmp_path: Path, deep: Path) -> None:
    (found,) = find_trials([str(tmp_path)], recursive=True).trials
    assert found.path == deep / "take.csv"
    assert list(result_folders(tmp_path)) == []
    Path("summary.json").touch()
    Path("screw.csv").touch()
    assert list(result_folders(tmp_path)) == [deep]


def test_links_in_a_circle_and_into_nothing_are_failures_of_their_own(tmp_path: Path, take: bytes) -> None:
    study = tmp_path / "in"
    (study / "below").mkdir(parents=True)
    (study / "good.csv").write_bytes(take)
    (study / "circle.csv").symlink_to("circle.csv")
    (study / "nothing.csv").symlink_to("nowhere")
    (study / "below" / "up").symlink_to("..")
    (study / "circle").symlink_to("circle")
    found = find_trials([str(study)], recursive=True)
    assert [trial.label for trial in found.trials] == ["circle.csv", "good.csv", "nothing.csv"]


def test_a_name_that_is_no_text_is_a_name_like_others(tmp_path: Path, take: bytes) -> None:
    study = tmp_path / "in"
    study.mkdir()
    try:
        Path(os.fsdecode(os.fsencode(study) + b"/na\xffme.csv")).write_bytes(take)
    except OSError:
        pytest.skip("the disk takes no such name")
    Path(os.fsdecode(os.fsencode(study) + b"/bad\xff.csv")).write_bytes(b"Format Version,1.23\n")
    out = tmp_path / "out"
    common = [str(study), "-o", str(out), "--figure-format", "none", "--workers", "1", "-q"]
    done = subprocess.run([sys.executable, "-m", "elbowscrew", "batch", *common], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (7, b"")
    (row,) = csv.DictReader((out / "summary.csv").read_text(encoding="utf-8").splitlines())
    assert row["path"] == "na?me.csv"
    assert "bad?.csv" in (out / "failures.csv").read_text(encoding="utf-8")
    assert (out / row["trial"] / "report.html").exists()
    name = os.fsdecode(os.fsencode(study) + b"/na\xffme.csv")
    assert main(["analyze", name, "-o", str(tmp_path / "one"), "--figure-format", "none", "-q"]) == 0


@pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="all may be read by root")
def test_what_may_not_be_read_is_passed_over_or_fails_alone(tmp_path: Path, take: bytes) -> None:
    (tmp_path / "good.csv").write_bytes(take)
    for name, mode in (("closed", 0o000), ("listed", 0o444)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "take.csv").write_bytes(take)
        (tmp_path / name).chmod(mode)
    try:
        found = find_trials([str(tmp_path)], recursive=True)
    finally:
        for name in ("closed", "listed"):
            (tmp_path / name).chmod(0o755)
    assert [trial.label for trial in found.trials] == ["good.csv"]
    assert len(found.skipped) == 2


def test_an_entry_that_the_system_refuses_is_passed_over(
    tmp_path: Path, take: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a folder that may be listed but not entered, or a name too long for the system."""
    (tmp_path / "good.csv").write_bytes(take)
    (tmp_path / "refused").mkdir()
    is_dir = Path.is_dir

    def refusing(path: Path) -> bool:
        if path.name == "refused":
            raise PermissionError(13, "Permission denied")
        return is_dir(path)

    monkeypatch.setattr(Path, "is_dir", refusing)
    found = find_trials([str(tmp_path)], recursive=True)
    assert [trial.label for trial in found.trials] == ["good.csv"]
    assert [one.reason for one in found.skipped] == ["cannot be read: Permission denied"]


def test_a_nul_late_in_a_manifest_is_told_with_its_line(tmp_path: Path) -> None:
    manifest = tmp_path / "manifest.csv"
    rows = [f"trial{k}.csv" for k in range(10_000)]
    manifest.write_text("path\n" + "\n".join(rows) + "\na\0b.csv\n")
    with pytest.raises(UsageError, match=r"manifest\.csv:10002: a NUL character"):
        read_manifest(manifest)


def test_paths_of_5000_digits_in_a_manifest_are_failures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    manifest = tmp_path / "manifest.csv"
    manifest.write_text("path\n" + "1" * 5000 + "\n" + "2" * 5000 + "\n")
    out = tmp_path / "out"
    assert main(["batch", str(manifest), "-o", str(out), "--workers", "1", "-q"]) == 7
    assert (out / "failures.csv").read_text().count("RecordingError") == 2
    assert "Traceback" not in capsys.readouterr().err


STREAMS = ["2>/dev/full", "2>&-", "2>&1 | head -c 1", "| head -c 1", ">&- 2>&-"]


@pytest.mark.parametrize("streams", STREAMS)
def test_who_reads_changes_neither_work_nor_exit_code(tmp_path: Path, take: bytes, streams: str) -> None:
    study = tmp_path / "in"
    study.mkdir()
    (study / "good.csv").write_bytes(take)
    (study / "bad.csv").write_bytes(b"Format Version,1.23\n")
    (study / "passed_over.csv").write_text("colour,size\nred,big\n")
    script = f"{sys.executable} -m elbowscrew batch in -o out --figure-format none --workers 1 -v {streams}\n"
    done = subprocess.run(
        ["bash", "-c", script + "exit ${PIPESTATUS[0]}"], cwd=tmp_path, capture_output=True, check=False
    )
    assert done.returncode == 7
    assert b"Traceback" not in done.stderr
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names >= {"good", "summary.csv", "failures.csv", "index.html"}


def test_closed_streams_lead_to_nowhere_in_what_is_started_too() -> None:
    program = (
        "import os, sys; sys.argv[1:] = ['info', 'none.csv']; from elbowscrew.cli import command; code = command(); "
        "nowhere = os.stat(os.devnull); "
        "print(code, [os.path.samestat(os.fstat(k), nowhere) and os.get_inheritable(k) for k in (0, 2)])"
    )
    script = f'{sys.executable} -c "{program}" <&- 2>&-'
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "3 [True, True]\n"


def test_a_usage_error_costs_no_tables(tmp_path: Path, take: bytes) -> None:
    (tmp_path / "take.csv").write_bytes(take)
    out = tmp_path / "out"
    common = ["batch", str(tmp_path / "take.csv"), "-o", str(out), "--figure-format", "none", "--workers", "1", "-q"]
    assert main(common) == 0
    before = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file() and path.suffix == ".csv"}
    for wrong in (["--min-angle", "x"], ["--config", "nothing"], ["--scheduler", "x"], ["--landmarks", "nothing"],
                  ["--restart", "--scheduler", "127.0.0.1:1"]):  # fmt: skip
        assert main([*common, *wrong]) == 2
        assert {path.name: path.read_bytes() for path in out.glob("*.csv")} == before


def test_what_the_page_cannot_read_is_an_error_and_costs_no_row(
    tmp_path: Path, take: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "take.csv").write_bytes(take)
    out = tmp_path / "out"
    common = ["batch", str(tmp_path / "take.csv"), "-o", str(out), "--figure-format", "none", "--workers", "1", "-q"]

    def fail(source: ProvedFile, *_rest: object) -> None:
        msg = f"{source.path}: cannot be read: Input/output error"
        raise ResultError(msg)

    with monkeypatch.context() as patched:
        patched.setattr("elbowscrew.report.study.read_columns", fail)
        assert main(common) == 3
    told = capsys.readouterr().err
    assert f"{out / 'index.html'}: shows a trial as failed: " in told
    assert len((out / "summary.csv").read_text().splitlines()) == 2
    assert main(common) == 0
    assert capsys.readouterr().err == ""


def test_one_bad_result_stops_no_other_page(tmp_path: Path, take: bytes, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "take.csv").write_bytes(take)
    results = [tmp_path / "study" / name for name in "abcde"]
    for folder in results:
        assert main(["analyze", str(tmp_path / "take.csv"), "-o", str(folder), "--figure-format", "none", "-q"]) == 0
    summary = (results[0] / "summary.json").read_text()
    (results[0] / "summary.json").write_text(summary.replace('"theta_max_deg": ', '"theta_max_deg": [1, 2], "x": '))
    (results[1] / "summary.json").write_text(summary.replace('"name": "take.csv"', '"name": "\\ud800"'))
    (results[2] / "report.html").unlink()
    (results[2] / "report.html").mkdir()
    (results[3] / "summary.json").write_text(summary.replace('"rate_hz": ', '"rate_hz": 1e200, "x": '))
    (results[4] / "report.html").unlink()
    assert main(["report", *map(str, results)]) in (3, 6)
    assert capsys.readouterr().err.count("elbowscrew: error: ") == 4
    assert (results[4] / "report.html").is_file()
