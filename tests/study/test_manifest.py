"""Manifests: columns carried, settings per trial, and errors that name line and column."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from studies import write_trials

from elbowscrew.cli import main
from elbowscrew.errors import UsageError
from elbowscrew.study.manifest import is_manifest, read_manifest
from elbowscrew.study.trials import find_trials


def manifest(folder: Path, text: str) -> Path:
    path = folder / "manifest.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_settings_of_a_trial_are_stronger_than_the_options_and_columns_are_carried(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_trials(tmp_path / "data", 3)
    manifest(
        tmp_path / "data",
        "path,subject,condition,Min_Angle,keyframes,method\n"
        'trial0.csv,=HYPERLINK("x"),fast,20,0 30 59,\n'
        "trial1.csv,B,-5,,,sclerp\n"
        'trial2.csv,"C\nD",slow,,"0,20,59",dlb\n',
    )
    arguments = ["batch", "data/manifest.csv", "--min-angle", "15", "--figure-format", "none", "--workers", "1", "-q"]
    assert main(arguments) == 0, capsys.readouterr().err
    with Path("batch_elbowscrew/summary.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["path"] for row in rows] == ["trial0.csv", "trial1.csv", "trial2.csv"]
    assert [row["subject"] for row in rows] == ['\'=HYPERLINK("x")', "B", "C D"]
    assert [row["condition"] for row in rows] == ["fast", "-5", "slow"]
    assert [row["Min_Angle"] for row in rows] == ["20", "", ""]
    settings = [
        json.loads(Path("batch_elbowscrew", row["trial"], "summary.json").read_text())["settings"] for row in rows
    ]
    assert [one["min-angle"] for one in settings] == [20.0, 15.0, 15.0]
    assert [one["keyframes"] for one in settings] == [[0, 30, 59], None, [0, 20, 59]]
    assert [one["method"] for one in settings] == ["dlb", "sclerp", "dlb"]


def test_one_recording_with_two_settings_needs_names(tmp_path: Path) -> None:
    twice = "path,forearm{0}\nt.csv,Left{1}\nt.csv,Right{2}\n"
    with pytest.raises(UsageError, match=r"manifest.csv:3: column 'path': 't.csv' stands in line 2, too"):
        read_manifest(manifest(tmp_path, twice.format("", "", "")))
    found = read_manifest(manifest(tmp_path, twice.format(",name", ",left arm", ",right arm")))
    assert [trial.name for trial in found] == ["left arm", "right arm"]


def test_semicolons_bring_decimal_commas(tmp_path: Path) -> None:
    (trial,) = read_manifest(manifest(tmp_path, "path;max-gap;lowpass;subject\nt.csv;0,25;none;1,5\n"))
    assert trial.settings == {"max-gap": "0.25", "lowpass": "none"}
    assert trial.columns["subject"] == "1,5"


def test_paths_are_relative_to_the_manifest(tmp_path: Path) -> None:
    folder = tmp_path / "study"
    (one,) = write_trials(folder / "data", 1)
    marks = "side,landmarks,path\nleft,arm.toml,data/trial0.csv\n"
    (trial,) = find_trials([str(manifest(folder, marks))]).trials
    assert trial.path == one
    assert trial.label == "data/trial0.csv"
    assert trial.landmarks == folder / "arm.toml"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("path,min-angle\na.csv,5\nb.csv,x\n", ":3: column 'min-angle': should be a valid number"),
        ("path,min-angle\na.csv,-5\n", ":2: column 'min-angle': should be greater than 0, found '-5'"),
        ("path,method\na.csv,magic\n", ":2: column 'method': should be 'dlb'"),
        ("path,keyframes\na.csv,9 5\n", ":2: column 'keyframes': keyframes must increase"),
        ("path,keyframes,inversion\na.csv,0 5 9,7\n", ":2: the inversion (7) must be one of the keyframes"),
        ("path,min-angel\na.csv,5\n", ":1: column 'min-angel': did you mean the setting 'min-angle'"),
        ("path,min_angel\na.csv,5\n", ":1: column 'min_angel': did you mean the setting 'min-angle'"),
        ("path,frames\na.csv,5\n", ":1: column 'frames' is one of summary.csv already"),
        ("path,theta_max_rad\na.csv,5\n", ":1: column 'theta_max_rad' is one of summary.csv already"),
        ("path,a,a\na.csv,5,6\n", ":1: column 'a' appears twice"),
        ("path,,a\na.csv,5,6\n", ":1: column 2 has no name"),
        ("path,a\na.csv\n", ":2: expected 2 cells as in the header, found 1"),
        ("path,a\n,5\n", ":2: column 'path': the cell is empty"),
        ("path,a\n", "the manifest has no rows"),
        ('path,a\n"a.csv,5\n', "not a CSV"),
        ("path,arm\na.csv,A\nb.csv\nc.csv\n", ":3: expected 2 cells as in the header, found 1; "),
    ],
)
def test_a_fault_is_told_with_line_and_column(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], text: str, says: str
) -> None:
    monkeypatch.chdir(tmp_path)
    path = manifest(tmp_path, text)
    assert is_manifest(path)
    assert main(["batch", path.name]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert [one.name for one in tmp_path.iterdir()] == ["manifest.csv"]


def test_the_settings_of_all_and_the_landmarks_of_one_are_checked_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_trials(tmp_path, 1)
    manifest(tmp_path, "path,landmarks\ntrial0.csv,none.toml\n")
    assert main(["batch", "manifest.csv"]) == 2
    assert "manifest.csv:2: none.toml: cannot be read" in capsys.readouterr().err.replace(f"{tmp_path}/", "")
    assert main(["batch", ".", "--config", "none.toml"]) == 2
    assert not Path("batch_elbowscrew").exists()


def test_trials_of_two_manifests_that_are_called_the_same_need_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        write_trials(tmp_path / name, 1)
        manifest(tmp_path / name, "path\ntrial0.csv\n")
    assert main(["batch", "a/manifest.csv", "b/manifest.csv"]) == 2
    assert "two trials are called 'trial0.csv'" in capsys.readouterr().err
