"""A study from end to end: the good trials right, the bad ones named, and the same bytes whoever did the work."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from studies import FAST, WAYS, batch, break_trial, command, contents, write_trials

from elbowscrew.cli import main
from elbowscrew.study.folder import batch_folder
from elbowscrew.study_columns import study_header

SOUND, BROKEN = 24, list(WAYS)
MANY = 30
LEADS_BACK = ' · <a href="../index.html">all trials of the study</a>'.encode()


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Thirty-six trials in two folders, twelve of them broken, and what is none among them."""
    folder = tmp_path_factory.mktemp("study")
    first = write_trials(folder / "data", (SOUND + len(BROKEN)) // 2)
    second = write_trials(folder / "data" / "P02", (SOUND + len(BROKEN)) // 2)
    for path, way in zip((first + second)[::3], BROKEN, strict=True):
        break_trial(path, way)
        path.rename(path.with_name(f"{way}.csv"))
    (folder / "data" / "people.csv").write_text("subject,age\nA,31\n")
    return folder


@pytest.fixture(scope="module")
def undisturbed(study: Path) -> Path:
    done = batch("data", "--recursive", *FAST, "--workers", 2, "-o", "out", folder=study, code=7)
    assert "36 of 36 trials done, 12 failed" in done.stderr
    return study / "out"


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_every_bad_trial_is_named_with_its_reason(undisturbed: Path) -> None:
    found = rows(undisturbed / "failures.csv")
    assert list(found[0]) == ["path", "error_class", "message", "exit_code"]
    assert {Path(row["path"]).stem: (row["error_class"], int(row["exit_code"])) for row in found} == {
        way: (kind, code) for way, (_, kind, code) in WAYS.items()
    }
    for row in found:
        assert row["message"].startswith(row["path"])
        assert "\n" not in row["message"]


def test_every_good_trial_is_there_and_right(undisturbed: Path) -> None:
    found = rows(undisturbed / "summary.csv")
    assert list(found[0]) == ["trial", "path", *study_header("deg", "mm")]
    assert len(found) == SOUND
    for row in found:
        number = int(row["trial"].rsplit("trial", 1)[1])
        assert float(row["theta_max_deg"]) == pytest.approx(80.0 + number % 60, abs=1.5)
        axis = np.array([float(row[f"joint_axis_{x}"]) for x in "xyz"])
        assert np.linalg.norm(axis) == pytest.approx(1.0)
    folders = {path.name for path in undisturbed.iterdir() if path.is_dir()}
    assert folders == {row["trial"] for row in found}


def test_a_result_is_what_analyze_makes(undisturbed: Path, study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for row in rows(undisturbed / "summary.csv")[::8]:
        alone = study / "alone" / row["trial"]
        assert main(["analyze", str(study / "data" / row["path"]), "-q", "-o", str(alone), *FAST]) == 0
        one, other = contents(alone), contents(undisturbed / row["trial"])
        pages = [found.pop("report.html") for found in (one, other)]
        assert pages[0] == pages[1].replace(LEADS_BACK, b"")
        sums = [found.pop("SHA256SUMS").splitlines() for found in (one, other)]
        assert [line[64:] for line in sums[0] if line not in sums[1]] == [b"  report.html"]
        assert one == other
        summary = json.loads((alone / "summary.json").read_text())
        assert float(row["rmse_theta_deg"]) == summary["interpolation"]["rmse_theta_deg"]
        assert float(row["point_x_mm"]) == summary["motion"]["mean_axis"]["point_mm"][0]


@pytest.mark.parametrize("way", [("--workers", 1), ("--workers", 2, "--scheduler", "local-cluster")], ids=["1", "dask"])
def test_the_bytes_do_not_depend_on_who_did_the_work(study: Path, undisturbed: Path, way: tuple[object, ...]) -> None:
    other = study / "other" / undisturbed.name  # the page of a study is called as its folder is
    batch("data", "--recursive", *FAST, *way, "-q", "-o", other, "--restart", folder=study, code=7)
    assert contents(other) == contents(undisturbed)


def test_pages_lead_to_the_study_and_the_terminal_says_what_to_open(study: Path, undisturbed: Path) -> None:
    again = batch("data", "--recursive", *FAST, "-o", "out", folder=study, code=7)
    assert re.search(r"Open +out/index\.html", again.stdout.replace("\n", ""))
    page = next(undisturbed.glob("*/report.html")).read_text(encoding="utf-8")
    assert LEADS_BACK.decode() in page
    assert len(rows(undisturbed / "cycles.csv")) == 101 * len(rows(undisturbed / "repetitions.csv")) > 0


def test_units_change_names_and_values_together(study: Path, undisturbed: Path) -> None:
    batch("data", *FAST, "--angle-unit", "rad", "--length-unit", "m", "-q", "-o", "si", folder=study, code=7)
    before = {row["path"]: row for row in rows(undisturbed / "summary.csv")}
    found = rows(study / "si" / "summary.csv")
    assert found
    for row in found:
        other = before[row["path"]]
        assert float(row["theta_max_rad"]) == pytest.approx(np.radians(float(other["theta_max_deg"])), rel=1e-12)
        assert float(row["slide_max_m"]) == pytest.approx(float(other["slide_max_mm"]) / 1000.0, rel=1e-12)
        assert float(row["joint_pitch_m_per_rad"]) == pytest.approx(float(other["joint_pitch_mm_per_rad"]) / 1000.0)
        assert "theta_max_deg" not in row


def test_json_is_one_object(study: Path, undisturbed: Path) -> None:
    done = batch("data", "--recursive", *FAST, "--json", "-o", "out", folder=study, code=7)
    told = json.loads(done.stdout)
    assert (told["trials"], told["up_to_date"], told["analyzed"], told["failed"]) == (36, 24, 0, 12)
    assert told["skipped"] == [{"path": "people.csv", "reason": "a table, but not of a recording"}]
    assert len(told["failures"]) == 12


def test_quiet_says_nothing(study: Path, undisturbed: Path) -> None:
    done = batch("data/trial1.csv", "data/trial2.csv", *FAST, "-q", "-o", "quiet", folder=study)
    assert (done.stdout, done.stderr) == ("", "")


def test_hostile_names_stay_in_the_output_folder_and_out_of_formulas(tmp_path: Path) -> None:
    names = ["=1+1", "-x", "@a", "a..b", "a\nb", "Trial", "trial", "x" * 200, "é", "e\u0301", "‮abc", "'; rm -rf"]
    (path,) = write_trials(tmp_path / "in", 1)
    text = path.read_text()
    path.unlink()
    for name in names:
        (tmp_path / "in" / f"{name}.csv").write_text(text.replace("Upper Arm", "=Upper Arm"))
    (tmp_path / "in" / "=bad.csv").touch()
    batch("in", *FAST, "-q", folder=tmp_path, code=7)
    found = rows(tmp_path / "batch_elbowscrew" / "summary.csv")
    assert len({row["trial"].casefold() for row in found}) == len(names)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["batch_elbowscrew", "in"]
    assert {row["proximal_body"] for row in found} == {"'=Upper Arm"}
    for row in [*found, *rows(tmp_path / "batch_elbowscrew" / "failures.csv")]:
        for cell in row.values():
            assert "\n" not in cell
            if cell[:1] in ("=", "+", "-", "@"):
                float(cell)


def test_two_batches_on_one_folder(tmp_path: Path) -> None:
    write_trials(tmp_path / "in", 1)
    with batch_folder(tmp_path / "out"):
        done = batch("in", *FAST, "-q", "-o", "out", folder=tmp_path, code=6)
    assert "another batch is running there" in done.stderr
    assert not contents(tmp_path / "out")


def test_an_input_that_vanishes_is_a_failure(tmp_path: Path) -> None:
    write_trials(tmp_path, 2)
    (tmp_path / "study.csv").write_text("path,subject\ntrial0.csv,A\nnone.csv,B\ntrial1.csv,C\n")
    batch("study.csv", *FAST, "-q", folder=tmp_path, code=7)
    (failure,) = rows(tmp_path / "batch_elbowscrew" / "failures.csv")
    assert failure["path"] == "none.csv"
    assert "no such file" in failure["message"]
    assert [row["subject"] for row in rows(tmp_path / "batch_elbowscrew" / "summary.csv")] == ["A", "C"]


def test_a_folder_of_the_users_is_one_trials_failure(tmp_path: Path) -> None:
    write_trials(tmp_path / "in", 2)
    batch("in", *FAST, "-q", folder=tmp_path)
    (tmp_path / "batch_elbowscrew" / "trial0" / "notes.txt").write_text("mine")
    batch("in", *FAST, "-q", "--restart", folder=tmp_path, code=7)
    (failure,) = rows(tmp_path / "batch_elbowscrew" / "failures.csv")
    assert "notes.txt" in failure["message"]
    assert (tmp_path / "batch_elbowscrew" / "trial0" / "notes.txt").read_text() == "mine"


LIMITED = """
import resource, sys
from elbowscrew.study.folder import batch_folder
from elbowscrew.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
if __name__ == "__main__":
    sys.exit(main(sys.argv[2:]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX limits")
@pytest.mark.parametrize(("size", "figures"), [(0, "none"), (2_000, "none"), (15_000, "none"), (60_000, "png")])
def test_a_full_disk_is_one_line_and_leaves_nothing(tmp_path: Path, size: int, figures: str) -> None:
    """Files cannot grow beyond the limit, in the workers neither."""
    write_trials(tmp_path / "in", 4)
    (tmp_path / "limited.py").write_text(LIMITED)
    arguments = ["limited.py", str(size), "batch", "in", "-q", "-o", "out", "--figure-format", figures]
    done = subprocess.run([sys.executable, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 6
    assert done.stderr.startswith("elbowscrew: error: ")
    assert done.stderr.count("\n") == 1
    assert "cannot be written" in done.stderr
    assert not contents(tmp_path / "out")


@pytest.mark.skipif(not Path("/proc").exists(), reason="needs a folder that nobody can write to")
def test_an_output_that_cannot_be_written_is_exit_6(tmp_path: Path) -> None:
    write_trials(tmp_path / "in", 1)
    done = batch("in", *FAST, "-o", "/proc/elbowscrew", folder=tmp_path, code=6)
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_scheduler_that_is_not_there_is_wrong_usage(tmp_path: Path) -> None:
    write_trials(tmp_path / "in", 1)
    done = batch("in", *FAST, "--scheduler", "127.0.0.1:1", folder=tmp_path, code=2)
    assert "--scheduler 127.0.0.1:1: no Dask scheduler answers there" in done.stderr
    assert done.stderr.splitlines()[-1].startswith("elbowscrew: error: ")


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Trials enough that a batch of them is still running when its first result is there."""
    folder = tmp_path_factory.mktemp("many")
    write_trials(folder, MANY)
    return folder


@pytest.fixture
def running(tmp_path: Path, many: Path) -> Iterator[subprocess.Popen[str]]:
    shutil.copytree(many, tmp_path / "in")
    process = subprocess.Popen(
        command("in", *FAST, "--workers", 2, "-o", "out"), cwd=tmp_path, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background job ignores it
    )  # fmt: skip
    deadline = time.monotonic() + 60.0
    while not list(tmp_path.glob("out/*/summary.json")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    yield process
    process.kill()
    process.communicate()


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize(("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("whole_group", [False, True])
def test_an_interrupted_batch_leaves_whole_results_only(
    tmp_path: Path, running: subprocess.Popen[str], sent: signal.Signals, code: int, whole_group: bool
) -> None:
    if whole_group:  # as Ctrl-C on a terminal does
        os.killpg(running.pid, sent)
    else:
        running.send_signal(sent)
    _, error = running.communicate(timeout=60)
    assert running.returncode == code
    assert "Traceback" not in error
    assert error.splitlines()[-1].endswith("nothing was left half-written")
    assert not list((tmp_path / "out").glob(".elbowscrew-*.partial"))
    assert not (tmp_path / "out" / "summary.csv").exists()


@pytest.mark.skipif(not Path("/proc").exists(), reason="finds the workers there")
def test_killed_workers_cost_no_trial(tmp_path: Path, running: subprocess.Popen[str]) -> None:
    """Two times a worker is shot from outside: its trial is done again, and all comes out."""
    shot: list[int] = []
    while len(shot) < 2:
        assert running.poll() is None
        for pid in workers_of(running.pid)[:1]:
            with suppress(ProcessLookupError):  # the pool ends the others when one of them has died
                os.kill(pid, signal.SIGKILL)
                shot.append(pid)
                while pid in workers_of(running.pid):
                    time.sleep(0.005)
    _, error = running.communicate(timeout=120)
    assert running.returncode == 0, error
    assert len(rows(tmp_path / "out" / "summary.csv")) == MANY
    assert not list((tmp_path / "out").glob(".elbowscrew-*.partial"))


def workers_of(pid: int) -> list[int]:
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rsplit(")", 1)[1].split()
            words = path.with_name("cmdline").read_bytes()
        except OSError:
            continue
        if int(fields[1]) == pid and b"spawn_main" in words:
            found.append(int(path.parent.name))
    return sorted(found)
