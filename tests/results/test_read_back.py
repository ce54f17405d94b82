"""A result read back is the result that was written."""

from __future__ import annotations

import io
import json
import re
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from finished_results import ball

from elbowscrew import Analysis, Settings, analyze, save_analysis, simulate_trial
from elbowscrew.errors import ResultError
from elbowscrew.plots import FIGURES
from elbowscrew.plots.style import publication_style, settle
from elbowscrew.results.read_back import as_finished, is_result, read_finished
from elbowscrew.view.finished import FinishedTrial
from elbowscrew.view.shown import Shown

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
WAYS: dict[str, dict[str, Any]] = {
    "as it comes": {},
    "in the arm, in meters": {"express_in": "proximal", "length_unit": "m"},
    "in the laboratory, in radians": {"express_in": "lab", "angle_unit": "rad"},
    "a repeated movement": {"reference_window": 5},
    "the whole recording in two phases": {"phases": "whole"},
    "few poses": {"tolerance_mm": 5.0},
    "a ball": {},
}


class Pair(NamedTuple):
    analysis: Analysis
    finished: FinishedTrial


@pytest.fixture(scope="module", params=WAYS)
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Pair:
    way = str(request.param)
    if way == "a ball":
        recording = ball()
    else:
        recording = simulate_trial(
            frames=150,
            inversion=60,
            gaps=2,
            gap_frames=14,
            proximal="still" if way == "as it comes" else "moving",
            repetitions=3 if way == "a repeated movement" else 1,
            seed=5,
        ).recording
    analysis = analyze(recording, Settings(**WAYS[way]))
    folder = save_analysis(analysis, tmp_path_factory.mktemp("result") / "r", figure_formats=())
    assert (analysis.joint_axis.best is None) == (way == "a ball")
    return Pair(analysis, read_finished(folder))


@pytest.mark.parametrize("part", ["screw", "interpolated", "repetitions"])
def test_tables_come_back_as_they_were(pair: Pair, part: str) -> None:
    written, read = getattr(pair.analysis, part), getattr(pair.finished, part)
    for field in fields(written):
        before, after = getattr(written, field.name), getattr(read, field.name)
        if before.dtype.kind == "f":
            # A unit there and back costs the last digit.
            assert after == pytest.approx(before, rel=1e-15, abs=0.0, nan_ok=True), field.name
        else:
            assert np.ma.getmaskarray(before).tolist() == np.ma.getmaskarray(after).tolist(), field.name
            assert np.ma.filled(before, 0).tolist() == np.ma.filled(after, 0).tolist(), field.name


@pytest.mark.parametrize("part", ["screw", "interpolated", "repetitions", "keyframes", "phases", "joint"])
def test_a_result_at_hand_has_the_very_numbers_of_the_one_read_back(pair: Pair, part: str) -> None:
    folder, read = pair.finished.folder, pair.finished
    at_hand = as_finished(pair.analysis, folder, read.summary, read.joint_summary)
    for field in fields(getattr(read, part)):
        one, other = getattr(getattr(read, part), field.name), getattr(getattr(at_hand, part), field.name)
        if isinstance(one, np.ndarray):
            assert np.ma.getmaskarray(one).tolist() == np.ma.getmaskarray(other).tolist(), field.name
            assert np.array_equal(np.ma.filled(one, 0), np.ma.filled(other, 0), one.dtype.kind == "f"), field.name
    curves = read.repetition_curve, at_hand.repetition_curve
    assert (curves[0] is None) == (curves[1] is None)
    if curves[0] is not None and curves[1] is not None:
        for name, values in curves[0].items():
            assert np.array_equal(values, curves[1][name], equal_nan=True), name


def test_poses_keyframes_and_movements_come_back(pair: Pair) -> None:
    analysis, finished = pair
    for pose in ("reference", "dual_quat_lab_proximal"):
        assert getattr(finished.joint, pose) == pytest.approx(getattr(analysis.joint, pose), abs=1e-14), pose
    assert finished.keyframes.row.tolist() == analysis.keyframes.row.tolist()
    assert finished.keyframes.phase_bounds.tolist() == analysis.keyframes.phase_bounds.tolist()
    assert finished.summary["motion"]["inversion_frames"] == analysis.screw.frame[analysis.inversion_rows].tolist()
    assert finished.keyframes.phases.law_rows.tolist() == analysis.keyframes.phases.law_rows.tolist()
    assert finished.phases.moving.tolist() == analysis.phases.moving.tolist()
    assert finished.joint_axis.preferred == analysis.joint_axis.preferred
    told = {"method": analysis.settings.model_method, "law": analysis.settings.model_law}
    assert finished.settings == analysis.settings.model_copy(update=told)


@pytest.mark.parametrize("name", FIGURES)
def test_figures_of_a_result_read_back_are_those_of_the_analysis(pair: Pair, name: str) -> None:
    again, first = drawn(name, pair.finished), drawn(name, pair.analysis)
    assert NUMBER.sub("#", again) == NUMBER.sub("#", first)
    # Coordinates have six decimals, of which a unit there and back may turn the last.
    coordinates = [np.array(NUMBER.findall(text), dtype=np.float64) for text in (again, first)]
    assert coordinates[0] == pytest.approx(coordinates[1], rel=1e-9, abs=2e-6)


def drawn(name: str, shown: Shown) -> str:
    stream = io.BytesIO()
    with publication_style():
        figure = FIGURES[name](shown)
        settle(figure)
        figure.savefig(stream, format="svg", metadata={"Date": None})
    # Names of shapes are hashes of their coordinates.
    return re.sub(r"(?<=[#\"])[a-zA-Z]\w*?[0-9a-f]{10}(?=[)\"])", "name", stream.getvalue().decode())


def lose_the_summary(folder: Path) -> None:
    (folder / "summary.json").unlink()


def cut_the_summary(folder: Path) -> None:
    (folder / "summary.json").write_text((folder / "summary.json").read_text()[:700])


def make_it_a_list(folder: Path) -> None:
    (folder / "summary.json").write_text("[]")


def put_words_for_numbers(folder: Path) -> None:
    joint = json.loads((folder / "joint.json").read_text())
    joint["bodies"]["distal_in_proximal"] = "nowhere"
    (folder / "joint.json").write_text(json.dumps(joint))


def cut_the_table(folder: Path) -> None:
    (folder / "screw.csv").write_text((folder / "screw.csv").read_text()[:-30])


def shift_a_row(folder: Path) -> None:
    lines = (folder / "screw.csv").read_text().splitlines()
    lines[7] = lines[7].partition(",")[2]
    (folder / "screw.csv").write_text("\n".join(lines) + "\n")


def rename_a_column(folder: Path) -> None:
    text = (folder / "interpolation.csv").read_text()
    (folder / "interpolation.csv").write_text(text.replace("theta_deg", "theta_rad"))


def lose_a_frame(folder: Path) -> None:
    lines = (folder / "screw.csv").read_text().splitlines()
    (folder / "screw.csv").write_text("\n".join(lines[:1] + lines[2:]) + "\n")


def add_a_setting(folder: Path) -> None:
    summary = json.loads((folder / "summary.json").read_text())
    summary["settings"]["color"] = "red"
    (folder / "summary.json").write_text(json.dumps(summary))


DAMAGES = [
    lose_the_summary,
    cut_the_summary,
    make_it_a_list,
    put_words_for_numbers,
    cut_the_table,
    shift_a_row,
    rename_a_column,
    lose_a_frame,
    add_a_setting,
]


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_a_damaged_result_is_told_in_one_line(tmp_path: Path, damage: Any) -> None:
    analysis = analyze(simulate_trial(frames=60, inversion=30).recording)
    folder = save_analysis(analysis, tmp_path / "r", figure_formats=())
    assert is_result(folder)
    read_finished(folder)
    damage(folder)
    with pytest.raises(ResultError) as told:
        read_finished(folder)
    message = str(told.value)
    assert message.startswith(str(folder))
    assert "\n" not in message
    assert "analyze the trial" in message
    assert told.value.exit_code == 3
