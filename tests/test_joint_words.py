"""What a reader sees speaks of the joint that was analyzed, and of no other."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from drawn_trials import drawn_trial

from elbowscrew import Settings, __version__, analyze, save_analysis, save_simulation, simulate_trial
from elbowscrew.cli import main, render
from elbowscrew.errors import ResultError
from elbowscrew.report.joint_words import joint_sentences
from elbowscrew.report.methods import methods_of
from elbowscrew.results.proof import proof_of
from elbowscrew.results.summary_reading import read_summary
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.view.figure_names import FIGURE_ENTRIES

ANY = re.compile(
    r"(?i)\b(upper arm|forearm|arm|elbow|humer\w*|flexion|extension|pronation|thigh|shank|knee|hand"
    r"|(?:proximal |distal )?phalanx|finger|pelvis|hip|ankle|wrist|scapula|shoulder|trunk"
    r"|proximal segment|distal segment)\b"
)
CASES: dict[str, tuple[dict[str, Any], dict[str, str], set[str]]] = {
    "knee": ({"joint": "knee"}, {}, {"thigh", "shank"}),
    "finger": ({"joint": "finger"}, {}, {"proximal phalanx", "distal phalanx", "phalanx"}),
    "left": ({"joint": "elbow", "side": "left"}, {}, {"upper arm", "forearm", "arm"}),
    "generic": ({}, {"proximal": "#1", "distal": "#2"}, {"proximal segment", "distal segment"}),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("motion", ["moving", "still"])
def test_no_word_of_another_joint(case: str, motion: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    simulated, named, words = CASES[case]
    chosen: dict[str, Any] = dict(named)
    recording = simulate_trial(
        frames=120, inversion=60, gaps=1, repetitions=2, proximal=motion, seed=4, **simulated
    ).recording
    if case == "generic":
        bodies = tuple(replace(body, name=f"Rigid Body {k}") for k, body in enumerate(recording.bodies, 1))
        recording = replace(recording, bodies=bodies)
    if motion == "still":
        chosen = {"proximal": "none", "distal": "#2"}
    settings = Settings(express_in="proximal", step_deg=20.0, **chosen)
    analysis = analyze(recording, settings)
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=("svg",))
    render.analysis_table(read_summary(proof_of(folder)), Path("r"))
    render.warnings(read_summary(proof_of(folder))["warnings"])
    page = (folder / "report.html").read_text(encoding="utf-8")
    told = {
        "page": page,
        "methods": methods_of(view_of_result(folder)),
        "terminal": "".join(capsys.readouterr()),
        "warnings": " ".join(warning.message for warning in analysis.warnings),
        **{figure.name: figure.read_text(encoding="utf-8") for figure in folder.rglob("*.svg")},
    }
    for name, text in told.items():
        assert {found.lower() for found in ANY.findall(text)} <= words, name
    assert {found.lower() for found in ANY.findall(told["page"])} >= words - {"arm", "phalanx"}
    assert len(told) > 5


# What the formats call things of their own accord: a program's option is no word of a joint.
_OPTIONS = re.compile(r"--(?:arm|forearm)\b")


@pytest.mark.parametrize(("case", "kind"), [("knee", "two-axes"), ("finger", "screw-hinge")])
def test_no_word_of_another_joint_beside_the_trials_page(
    case: str, kind: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Study and its page, figures for publication, comparison, exports, info: each is made, and looked through."""
    simulated, _, words = CASES[case]
    monkeypatch.chdir(tmp_path)
    for seed in (1, 2):
        trial = simulate_trial(frames=90, inversion=45, joint_type=kind, side="left", seed=seed, **simulated)
        save_simulation(trial, tmp_path / "in" / f"t{seed}.csv")
    told: dict[str, str] = {}

    def run(name: str, *arguments: str) -> None:
        assert main(list(arguments)) == 0, name
        shown = capsys.readouterr()
        told[name] = shown.out + shown.err

    run("simulate", "simulate", "s.csv", "--joint", case, "--frames", "20", "--inversion", "9")
    run("info", "info", "in/t1.csv")
    run("info as JSON", "info", "in/t1.csv", "--json")
    run("batch", "batch", "in", "-o", "out", "--figure-format", "none", "--export", "sto")
    folders = sorted(path.parent for path in (tmp_path / "out").glob("*/summary.json"))
    assert len(folders) == 2
    names = ",".join(name for name, entry in FIGURE_ENTRIES.items() if not entry.needs)
    run("figures", "report", str(folders[0]), "--figures", names, "--figure-format", "svg", "-o", "figures")
    run("overlay", "report", "out", "--figures", "overlay", "--figure-format", "svg", "-o", "overlay")
    plan = ("--methods", "joint,sclerp", "--laws", "best", "--counts", "2", "--data", "raw", "--figure-format", "svg")
    run("compare", "compare", "in/t1.csv", "-o", "compared", *plan)
    run("compare trials", "compare", "in", "-o", "compared trials", *plan)
    keyframes = folders[0] / "keyframes.csv"
    run("interpolate", "interpolate", str(keyframes), "--frames", "9")
    kinds = {".svg", ".html", ".json", ".csv", ".sto"}
    written = [path for path in tmp_path.rglob("*") if path.suffix in kinds and path.parent.name != "in"]
    told |= {str(path.relative_to(tmp_path)): path.read_text(encoding="utf-8") for path in written}
    assert {path.suffix for path in written} == kinds
    drawn = {path.relative_to(tmp_path).parts[0] for path in written if path.suffix == ".svg"}
    assert drawn == {"figures", "overlay", "compared", "compared trials"}
    assert {path.stem for path in (tmp_path / "figures").glob("*.svg")} == set(names.split(","))
    for name, text in told.items():
        found = {word.lower() for word in ANY.findall(_OPTIONS.sub("", text))}
        assert found <= words | {case}, (name, found - words)
    for name in ("info", "out/summary.csv"):
        assert {word.lower() for word in ANY.findall(told[name])} & words, name


def test_a_result_says_the_joint_and_its_side(tmp_path: Path) -> None:
    recording = simulate_trial(joint="knee", side="left", frames=80, inversion=40).recording
    folder = save_analysis(analyze(recording), tmp_path / "r", figure_formats=(), report=False)
    words = read_summary(proof_of(folder))["trial"]["joint"]
    assert words == {"name": "knee", "proximal": "thigh", "distal": "shank", "side": "left"}


def test_a_result_of_before_is_refused_in_one_line_with_both_versions(tmp_path: Path) -> None:
    recording = simulate_trial(frames=80, inversion=40).recording
    folder = save_analysis(analyze(recording), tmp_path / "r", figure_formats=(), report=False)
    path = folder / "summary.json"
    summary = json.loads(path.read_text(encoding="utf-8"))
    trial = summary["trial"]
    del trial["joint"]
    trial["arm"], trial["forearm"] = trial.pop("proximal"), trial.pop("distal")
    path.write_text(json.dumps({**summary, "elbowscrew": "0.1.0"}), encoding="utf-8")
    (folder / "SHA256SUMS").unlink()
    with pytest.raises(ResultError) as caught:
        view_of_result(folder)
    told = str(caught.value)
    assert "0.1.0" in told
    assert __version__ in told
    assert "\n" not in told


@pytest.mark.parametrize(("turn", "told"), [(0.0, False), (3.0, True)])
def test_only_a_turn_is_told_of_sensors(turn: float, told: bool) -> None:
    """Millimeters say nothing of orientations without positions."""
    view = drawn_trial("wandering")
    skin = {"mm": 5.0, "deg": turn, "part_deg": 0.1, "part_mm": 0.2}
    summary: Any = {**view.joint_summary, "skin_motion": skin}
    sensors = replace(view, located=False, joint_summary=summary)
    assert ("A turn of the sensors on the bone of 3° was stated" in methods_of(sensors)) == told
    words = " ".join(joint_sentences(sensors))
    assert ("Stated and included is a turn of each sensor on its bone of 3" in words) == told
    assert ("millimeters of motion that --skin-motion states have no effect" in words) != told
    clusters = methods_of(replace(view, joint_summary=summary))
    assert f"on the bone of 5 mm{' and 3°' if told else ''} was stated" in clusters
