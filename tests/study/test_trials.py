"""Which files of a folder are trials, and which are passed over."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest
from studies import WAYS, break_trial, write_trials

from elbowscrew.cli import main
from elbowscrew.errors import UsageError
from elbowscrew.study.trials import find_trials, natural_key


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_trials(tmp_path / "study", 3)
    shutil.copytree(tmp_path / "study", tmp_path / "study" / "P02")
    return tmp_path / "study"


def labels(*paths: str, recursive: bool = False, follow: bool = False, exclude: Path | None = None) -> list[str]:
    found = find_trials(paths, recursive=recursive, follow_symlinks=follow, exclude=exclude)
    return [trial.label for trial in found.trials]


def test_a_folder_and_those_below_it(study: Path) -> None:
    assert labels("study") == ["trial0.csv", "trial1.csv", "trial2.csv"]
    below = ["P02/trial0.csv", "P02/trial1.csv", "P02/trial2.csv"]
    assert labels("study", recursive=True) == [*below, *labels("study")]
    assert labels(str(study), recursive=True) == labels("study/", recursive=True) == labels("study", recursive=True)


def test_files_patterns_and_several_paths(study: Path) -> None:
    assert labels("study/trial1.csv") == ["study/trial1.csv"]
    assert labels("study/*1.csv", "study/P02") == ["study/P02/trial0.csv", "study/P02/trial1.csv",
                                                   "study/P02/trial2.csv", "study/trial1.csv"]  # fmt: skip
    assert labels("study/**/trial2.csv") == ["study/P02/trial2.csv", "study/trial2.csv"]


def test_a_recording_is_taken_once_however_often_it_is_named(study: Path) -> None:
    assert labels("study/trial1.csv", "study/./trial1.csv", "study/P02/../trial1.csv") == ["study/trial1.csv"]
    assert len(labels("study", "study/*.csv", str(study))) == 3


def test_the_order_is_natural() -> None:
    names = ["t10.csv", "t2.csv", "T1.csv", "t1.csv", "a/t2.csv"]
    assert sorted(names, key=natural_key) == ["a/t2.csv", "T1.csv", "t1.csv", "t2.csv", "t10.csv"]


@pytest.mark.parametrize("way", WAYS)
def test_a_broken_recording_is_still_a_trial(study: Path, way: str) -> None:
    break_trial(study / "trial1.csv", way)
    assert len(labels("study")) == 3


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("subject,age\nA,31\nB,28\n", "not of a recording"),
        ("\ufeffSubject;Age;Height\nA;31;1,80\n", "not of a recording"),
        ("path,arm-markers,keyframes\ntrial1.csv,A*,\n", "manifest"),
    ],
)
def test_other_tables_are_passed_over_and_told_of(study: Path, text: str, reason: str) -> None:
    (study / "people.csv").write_text(text, encoding="utf-8")
    (study / "notes.txt").write_text("not a table")
    found = find_trials(["study"])
    assert len(found.trials) == 3
    assert [one.path for one in found.skipped] == ["people.csv"]
    assert reason in found.skipped[0].reason


def test_results_and_outputs_are_no_trials(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyze", "study/trial0.csv", "-q", "-o", "study/r", "--figure-format", "none"]) == 0
    assert main(["batch", "study", "-q", "-o", "study/out", "--figure-format", "none", "--workers", "1"]) == 0
    capsys.readouterr()
    assert len(labels("study", recursive=True)) == 6
    (study / "later").mkdir()
    shutil.copy(study / "trial0.csv", study / "later")
    assert len(labels("study", recursive=True)) == 7
    assert len(labels("study", recursive=True, exclude=study / "later")) == 6


def test_other_endings_and_hidden_files_are_no_trials(study: Path) -> None:
    shutil.copy(study / "trial0.csv", study / "trial0.txt")
    shutil.copy(study / "trial0.csv", study / ".trial0.csv")
    (study / ".git").mkdir()
    shutil.copy(study / "trial0.csv", study / ".git")
    shutil.copy(study / "trial0.csv", study / "TRIAL9.CSV")
    assert labels("study", recursive=True)[-1] == "TRIAL9.CSV"
    assert len(labels("study", recursive=True)) == 7
    assert labels("study/trial0.txt") == ["study/trial0.txt"]


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_links_out_of_the_folder_are_followed_on_request_only(study: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    (secret,) = write_trials(outside, 1, stem="secret")
    (study / "link.csv").symlink_to(secret)
    (study / "folder").symlink_to(outside)
    (study / "round").symlink_to(study)
    (study / "inside.csv").symlink_to(study / "trial0.csv")
    found = find_trials(["study"], recursive=True)
    assert {one.path for one in found.skipped} == {"link.csv", "study/folder"}
    assert all("--follow-symlinks" in one.reason for one in found.skipped)
    assert len(found.trials) == 6
    followed = find_trials(["study"], recursive=True, follow_symlinks=True)
    assert len(followed.trials) == 7
    assert not followed.skipped
    assert labels("study/link.csv") == ["study/link.csv"]


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("nowhere", "no such file or folder"),
        ("study/*.trc", "no file fits this pattern"),
        ("empty", "no trial found: expected files that end in .csv, .trc, .tsv, .sto, .c3d"),
        ("parent", "--recursive looks into the folders below, such as 'study'"),
    ],
)
def test_a_path_that_leads_to_nothing_is_an_error(study: Path, tmp_path: Path, path: str, says: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "parent" / "study").mkdir(parents=True)
    with pytest.raises(UsageError, match=re.escape(says)):
        find_trials([path])


def test_a_storage_of_opensim_without_orientations_is_passed_over(tmp_path: Path) -> None:
    header, table = "nRows=1\nnColumns=2\nendheader\n", "time\thumerus\n0.0\t1,0,0,0\n"
    (tmp_path / "angles.sto").write_text(f"Coordinates\n{header}time\tflexion\n0.0\t1.0\n")
    (tmp_path / "sensors.sto").write_text(f"DataType=Quaternion\n{header}{table}")
    found = find_trials([str(tmp_path)])
    assert [trial.label for trial in found.trials] == ["sensors.sto"]
    assert [one.reason for one in found.skipped] == ["a storage of OpenSim, but not of orientations"]


def test_with_a_file_of_columns_every_table_is_a_trial(study: Path) -> None:
    (study / "people.csv").write_text("subject,age\nA,31\n")
    (study / "take.txt").write_text("t,q\n0,1\n")
    (study / "take.c3d").write_text("no table")
    manifest = study / "study.csv"
    manifest.write_text("path\npeople.csv\n")
    found = {trial.path.name for trial in find_trials(["study"], any_table=True).trials}
    assert {"people.csv", "take.txt"} <= found
    assert not {"take.c3d", "study.csv"} & found
