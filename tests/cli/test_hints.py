"""What is nearly right is asked back, help is at hand by ``-h``, and a shell is told what fits."""

from __future__ import annotations

from pathlib import Path

import pytest

from elbowscrew.cli import main


@pytest.mark.parametrize(
    ("given", "code", "told"),
    [
        ("analyze TRIAL --tolerence 2mm", 2, "No such option: --tolerence; did you mean '--tolerance'?"),
        ("analyze TRIAL --joint elbw", 2, "'finger'; did you mean 'elbow'?"),
        ("analyze TRIAL --law cyclodal", 2, "did you mean 'cycloidal'?"),
        ("analyze TRIAL --figures thetta", 2, "found 'thetta'; did you mean 'theta'?"),
        ("analyze TRIAL --joint-type twoaxes", 2, "found 'twoaxes'; did you mean 'two_axes'?"),
        ("analyze TRIAL --config lba.toml", 2, "No such file or directory; did you mean 'lab.toml'?"),
        ("analyze TRIAL --config lab.toml", 2, "lab.toml: method: should be 'dlb', "),
        ("analyze TRIAL --landmarks lba.toml", 2, "; did you mean 'lab.toml'?"),
        ("analyze TRAIL.csv", 3, "TRAIL.csv: no such file; did you mean 'trial.csv'?"),
        ("batch trail.csv", 2, "no such file or folder; did you mean 'trial.csv'?"),
        ("compare TRIAL --methods dlbb,sclerb", 2, "did you mean 'dlb' and 'sclerp'?"),
        ("report . --figures thta", 2, "found thta; did you mean 'theta'?"),
        ("report . --figures theta --width singel", 2, "found 'singel'; did you mean 'single'?"),
        ("report study_elbowscre", 3, "no such folder; did you mean 'study_elbowscrew'?"),
        ("interpolate keyframe.csv --frames 3", 3, "; did you mean 'keyframes.csv'?"),
        ("simulate out.csv --law minimumjerk", 2, "did you mean 'minimum-jerk'?"),
        ("anlyze TRIAL", 2, "'analyze'? See `elbowscrew --help`"),
        ("analyze TRIAL --joint-type xyzzy", 2, "found 'xyzzy'\n"),
    ],
)
def test_what_is_nearly_right_is_asked_back(
    given: str,
    code: int,
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("trial.csv", "keyframes.csv"):
        Path(name).write_text("")
    Path("lab.toml").write_text('method = "dlbb"\n')
    Path("study_elbowscrew").mkdir()
    assert main(given.replace("TRIAL", "trial.csv").split()) == code
    errors = capsys.readouterr().err
    assert told in errors
    assert errors.count("\n") == 1


def test_a_list_that_has_no_sound_value_is_told_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyze", str(tmp_path / "trial.csv"), "--figure-format", "pgn"]) == 2
    assert capsys.readouterr().err.count("figure-format") == 1


@pytest.mark.parametrize("given", [["-h"], ["analyze", "-h"], ["paper", "-h"]])
def test_the_short_option_gives_the_help(given: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(given) == 0
    shown = capsys.readouterr().out
    assert "Usage: elbowscrew" in shown
    assert "-h" in shown


def offered(line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What bash is told to offer for the last word of a line."""
    monkeypatch.setenv("_ELBOWSCREW_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(len(line.split(" ")) - 1))
    with pytest.raises(SystemExit, match="0"):
        main([])
    return capsys.readouterr().out.splitlines()


def test_bodies_of_the_file_are_offered(
    samples: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(samples)
    both = ["Right\\ Upper\\ Arm", "Right\\ Forearm"]
    assert offered("elbowscrew analyze elbow_natural.csv --proximal ", monkeypatch, capsys) == both
    assert offered("elbowscrew compare --lowpass 6 elbow_natural.csv --forearm ", monkeypatch, capsys) == both
    assert offered("elbowscrew analyze elbow_paper.truth.json --distal ", monkeypatch, capsys) == [""]


def test_choices_of_a_list_are_offered(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert offered("elbowscrew analyze trial.csv --figures theta,sl", monkeypatch, capsys) == ["theta,slide"]
    assert offered("elbowscrew analyze trial.csv --export parquet,", monkeypatch, capsys) == [
        "parquet,mat",
        "parquet,sto",
    ]
