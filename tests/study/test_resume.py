"""A batch that was stopped, or is run again, ends with the bytes of one that was never disturbed."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from studies import FAST, batch, break_trial, command, contents, write_trials
from trials import LANDMARKS

OUT = "batch_elbowscrew"
SOUND = 6


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("resume")
    paths = write_trials(folder / "in", SOUND + 2)
    break_trial(paths[3], "unit")
    break_trial(paths[7], "empty")
    batch("in", *FAST, "-q", folder=folder, code=7)
    return folder


@pytest.fixture
def finished(study: Path, tmp_path: Path) -> Path:
    """A folder with a finished batch, to change at will."""
    shutil.copytree(study, tmp_path / "study")
    return tmp_path / "study"


def stamps(folder: Path) -> dict[str, int]:
    """When each trial's result was made."""
    return {path.parent.name: path.stat().st_mtime_ns for path in folder.glob("*/summary.json")}


def redone(folder: Path, *arguments: object, code: int = 7) -> set[str]:
    """Run the batch again and say whose results are new."""
    before = stamps(folder / OUT)
    batch("in", *FAST, "-q", *arguments, folder=folder, code=code)
    after = stamps(folder / OUT)
    return {name for name in after if after[name] != before.get(name)}


def test_nothing_is_done_twice_and_the_tables_are_the_same(finished: Path) -> None:
    before = contents(finished / OUT)
    assert redone(finished) == set()
    assert contents(finished / OUT) == before


def test_all_is_done_again_on_request(finished: Path) -> None:
    before = contents(finished / OUT)
    assert len(redone(finished, "--restart")) == SOUND
    assert contents(finished / OUT) == before


def test_only_a_changed_recording_is_done_again(finished: Path) -> None:
    path = finished / "in" / "trial5.csv"
    path.write_text(path.read_text() + "\n")
    shutil.copy(finished / "in" / "trial0.csv", finished / "in" / "trial7.csv")
    assert redone(finished) == {"trial5", "trial7"}


def test_other_settings_do_all_again_and_the_old_ones_give_the_old_bytes(finished: Path) -> None:
    before = contents(finished / OUT)
    assert len(redone(finished, "--min-angle", 12)) == SOUND
    assert contents(finished / OUT) != before
    assert len(redone(finished)) == SOUND
    assert contents(finished / OUT) == before


def test_exports_are_part_of_the_settings(finished: Path) -> None:
    assert len(redone(finished, "--export", "sto")) == SOUND
    assert (finished / OUT / "trial0" / "joint_angle.sto").exists()
    assert redone(finished, "--export", "sto") == set()


def test_what_a_file_of_landmarks_says_counts_and_not_its_name(finished: Path) -> None:
    toml = finished / "arm.toml"
    toml.write_text(LANDMARKS)
    assert len(redone(finished, "--landmarks", "arm.toml")) == SOUND
    toml.rename(finished / "other.toml")
    assert redone(finished, "--landmarks", "other.toml") == set()
    (finished / "other.toml").write_text(LANDMARKS.replace("352", "351"))
    assert len(redone(finished, "--landmarks", "other.toml")) == SOUND


@pytest.mark.parametrize("key", ["elbowscrew", "versions", "settings", "landmarks"])
def test_a_result_of_another_program_is_done_again(finished: Path, key: str) -> None:
    path = finished / OUT / "trial2" / "summary.json"
    summary = json.loads(path.read_text())
    summary[key] = {"numpy": "1.0"}
    path.write_text(json.dumps(summary))
    assert redone(finished) == {"trial2"}


def test_a_result_that_is_not_whole_is_done_again(finished: Path) -> None:
    before = contents(finished / OUT)
    (finished / OUT / "trial0" / "screw.csv").unlink()
    (finished / OUT / "trial1" / "screw.csv").write_bytes(b"")
    (finished / OUT / "trial2" / "summary.json").write_bytes(b"")  # as a power failure leaves it
    (finished / OUT / "trial4" / "joint.json").write_text("{}")
    shutil.rmtree(finished / OUT / "trial5")
    assert redone(finished) == {"trial0", "trial1", "trial2", "trial4", "trial5"}
    assert contents(finished / OUT) == before


def test_a_trial_that_fails_now_is_out_of_the_table_and_its_old_result_is_told_of(finished: Path) -> None:
    break_trial(finished / "in" / "trial0.csv", "unit")
    done = batch("in", *FAST, folder=finished, code=7)
    said = "holds results that do not belong to this batch and are not in summary.csv: trial0 [other-results]"
    assert said in done.stderr
    assert "trial0," not in (finished / OUT / "summary.csv").read_text()
    assert "trial0.csv" in (finished / OUT / "failures.csv").read_text()


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize("seed", range(4))
def test_killed_at_any_moment_a_second_run_ends_as_if_nothing_had_been(study: Path, tmp_path: Path, seed: int) -> None:
    """Only the batch itself is shot: its workers must see to themselves, and write nothing afterwards."""
    shutil.copytree(study / "in", tmp_path / "in")
    rng = np.random.default_rng(seed)
    for _ in range(2):
        process = subprocess.Popen(
            command("in", *FAST, "-q", "--workers", 2), cwd=tmp_path, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip
        # From the start on, or from the first result on: there the moments are dense.
        deadline = time.monotonic() + 30.0
        while seed % 2 and not list(tmp_path.glob(f"{OUT}/*/summary.json")) and time.monotonic() < deadline:
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, 0.5))
        process.send_signal(signal.SIGKILL)
        process.wait(timeout=60)
    batch("in", *FAST, "-q", folder=tmp_path, code=7)
    assert contents(tmp_path / OUT) == contents(study / OUT)
