"""What ``info`` tells: all that is in a file, what it does not say, and what to type next."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import save_simulation, simulate_trial
from elbowscrew.cli import main

Capture = pytest.CaptureFixture[str]


def told(capsys: Capture, *words: str, code: int = 0) -> str:
    assert main(["info", *words]) == code
    return capsys.readouterr().out


def as_json(capsys: Capture, *words: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(told(capsys, *words, "--json"))
    return found


def next_words(out: str) -> list[str]:
    line = out.splitlines()[-1]
    words = shlex.split(line)
    assert words[:2] == ["elbowscrew", "analyze"]
    return words[1:]


def table(path: Path, bodies: tuple[str, ...], markers: tuple[str, ...] = (), *, clock: str = "frame,time_s") -> Path:
    trial = simulate_trial(frames=60, inversion=30, seed=2).recording
    columns: dict[str, Any] = {}
    for k, name in enumerate(bodies):
        pose = trial.bodies[k % 2].dual_quat_lab_body
        columns |= {f"{name}_e{i}": pose[:, i] for i in range(4)}
        columns |= {f"{name}_{axis}_m": 0.1 * k + 0.01 * np.arange(60) for axis in "xyz"}
    for k, name in enumerate(markers):
        columns |= {f"{name}_{axis}_mm": np.where(np.arange(60) < 15, 0.0, 10.0 * k + 1.0) for axis in "xyz"}
    ticks = [[str(f), repr(f / 100)] for f in range(60)]
    rows = [",".join([*(tick if "," in clock else tick[:1]), *map(repr, map(float, row))])
            for tick, row in zip(ticks, zip(*columns.values(), strict=True), strict=True)]  # fmt: skip
    path.write_text("\n".join([",".join([clock, *columns]), *rows]) + "\n")
    return path


def test_the_next_line_can_be_typed_as_it_is(tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "take 'one' & two.csv"
    save_simulation(simulate_trial(frames=60, inversion=30), path)
    words = next_words(told(capsys, str(path)))
    assert words == ["analyze", str(path)]
    assert main([*words, "--figure-format", "none", "-q"]) == 0


def test_what_was_given_is_in_the_next_line(tmp_path: Path, capsys: Capture) -> None:
    path = table(tmp_path / "t.csv", ("arm", "forearm"), clock="frame")
    words = next_words(told(capsys, str(path), "--rate", "120", "--max-speed", "9"))
    assert dict(zip(words[2::2], words[3::2], strict=True)) == {"--rate": "120", "--max-speed": "9"}
    assert as_json(capsys, str(path), "--rate", "120")["next"].endswith("--rate 120")


def test_two_bodies_whose_names_say_nothing_are_numbered(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = table(tmp_path / "t.csv", ("Kugel", "Tisch"))
    out = told(capsys, str(path))
    assert "if the first of the two is the proximal one" in out
    words = next_words(out)
    assert words[2:] == ["--proximal", "#1", "--distal", "#2"]
    assert main([*words, "--figure-format", "none", "-q", "-o", "r"]) == 0
    trial = json.loads((tmp_path / "r" / "summary.json").read_text())["trial"]
    assert (trial["proximal"]["name"], trial["distal"]["name"]) == ("Kugel", "Tisch")


def test_a_number_is_never_taken_for_an_id_or_a_name(tmp_path: Path, capsys: Capture) -> None:
    """A body that is called #1 is meant by that before the first of the file."""
    path = table(tmp_path / "t.csv", ("Kugel", "#1", "Tisch"))
    chosen = ["--proximal", "#1", "--distal", "#3", "--figure-format", "none", "-q", "-o", str(tmp_path / "r")]
    assert main(["analyze", str(path), *chosen]) == 0
    trial = json.loads((tmp_path / "r" / "summary.json").read_text())["trial"]
    assert (trial["proximal"]["name"], trial["distal"]["name"]) == ("#1", "Tisch")
    capsys.readouterr()
    assert main(["analyze", str(path), "--proximal", "1", "--distal", "#3", "-o", str(tmp_path / "s")]) == 4
    assert "no such body" in capsys.readouterr().err


def test_all_bodies_and_markers_are_listed_if_asked_for(tmp_path: Path, capsys: Capture) -> None:
    bodies, markers = tuple(f"piece {k}" for k in range(30)), tuple(f"dot{k}" for k in range(40))
    path = table(tmp_path / "t.csv", bodies, markers)
    short, whole = told(capsys, str(path)), told(capsys, str(path), "--all")
    assert "#24 " in short
    assert "#25 " not in short
    assert "6 more bodies (--all)" in short
    assert "16 more (--all)" in short
    assert all(f"#{k} " in whole and f"piece {k - 1}" in whole for k in range(1, 31))
    assert "dot39 75 %" in whole.replace("\n", " ").replace("  ", " ")
    assert "more" not in whole
    found = as_json(capsys, str(path))
    assert [body["name"] for body in found["trial"]["bodies"]] == list(bodies)
    assert found["markers"] == [{"name": name, "seen_share": None} for name in markers]  # named, not read
    assert {one["seen_share"] for one in as_json(capsys, str(path), "--all")["markers"]} == {0.75}


def test_what_is_missing_is_one_question_and_the_rest_is_told(real_data: Path, capsys: Capture) -> None:
    case = str(real_data / "cases" / "units_missing_info.csv")
    out = told(capsys, case)
    question = " ".join(" ".join(out.split("Not told")[1].split("Body")[0].split()).split(" #")[0].split())
    assert "--units m, cm or mm; --rotation XYZ" in question
    assert "forearm" in out
    assert "100.0 %" in out
    assert next_words(out)[2:] == ["--units", "UNIT", "--rotation", "ORDER"]
    found = as_json(capsys, case)
    assert [one["option"] for one in found["missing"]] == ["units", "rotation"]
    assert (found["source"]["length_unit"], found["source"]["rotation"]) == (None, None)
    body = found["trial"]["bodies"][0]
    assert (body["fastest_turn_deg_s"], body["fastest_speed_m_s"]) == (None, None)
    assert found["trial"]["frames"] == 3
    assert as_json(capsys, case, "--units", "cm", "--rotation", "XYZ")["missing"] == []


def test_unit_rate_and_bodies_are_asked_for_together(tmp_path: Path, capsys: Capture) -> None:
    identity = "1 0 0 0 0 1 0 0 0 0 1 5 0 0 0 1"
    path = tmp_path / "pair.tra"
    path.write_text("\n".join(f"{identity} {identity.replace('5', str(k + 6))}" for k in range(20)) + "\n")
    found = as_json(capsys, str(path))
    assert [one["option"] for one in found["missing"]] == ["units", "rate", "proximal"]
    assert (found["trial"]["rate_hz"], found["trial"]["duration_s"], found["trial"]["clock"]) == (None, None, None)
    words = shlex.split(found["next"])
    assert words[3:] == ["--units", "UNIT", "--rate", "HZ", "--proximal", "#1", "--distal", "#2"]


def test_markers_that_fall_into_two_groups_are_proposed(real_data: Path, capsys: Capture) -> None:
    out = told(capsys, str(real_data / "cases" / "trc_ok.trc"))
    assert next_words(out)[2:] == ["--proximal-markers", "A*", "--distal-markers", "F*"]
    assert "if the first of the two is the proximal one" in out


@pytest.mark.parametrize("bodies", [(), ("arm", "forearm")])
def test_patterns_that_fit_nothing_name_the_markers(tmp_path: Path, capsys: Capture, bodies: tuple[str, ...]) -> None:
    path = table(tmp_path / "t.csv", bodies, ("Elbow", "Wrist", "Hand"))
    for given in ("X*", "Elbow,Rist"):
        assert main(["info", str(path), "--markers", given]) == 4
        err = capsys.readouterr().err
        assert "Elbow, Wrist, Hand" in err
        assert ("did you mean 'Wrist'" in err) == ("Rist" in given)
    assert main(["info", str(path), "--markers", "elb*"]) == 0


def test_what_analyze_refuses_is_told_before_its_line(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "t.sto"
    rows = [f"{k / 100}\t1,0,0,0\t1,0,0,0" for k in range(9)]
    path.write_text("\n".join(["DataType=Quaternion", "endheader", "time\tone\tother", *rows]) + "\n")
    out = told(capsys, str(path))
    assert "analyze refuses it: tracked in less than 50 % of the frames: one, other." in " ".join(out.split())
    words = next_words(out)
    assert main([*words, "--figure-format", "none", "-q", "-o", str(tmp_path / "r")]) == 5
    capsys.readouterr()
    sound = table(tmp_path / "t.csv", ("arm", "forearm"))
    assert "analyze refuses it" not in told(capsys, str(sound))
