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
from sealed import resealed

from elbowscrew import Analysis, Settings, analyze, save_analysis, simulate_trial
from elbowscrew.errors import ResultError
from elbowscrew.plots import FIGURES
from elbowscrew.plots.layout import settle
from elbowscrew.plots.style import publication_style
from elbowscrew.results.trial_views import is_result, view_of, view_of_result
from elbowscrew.view.figure_names import has_figure
from elbowscrew.view.trial_view import TrialView

WAYS: dict[str, dict[str, Any]] = {
    "as it comes": {},
    "in the arm, in meters": {"express_in": "proximal", "length_unit": "m"},
    "in the laboratory, in radians": {"express_in": "lab", "angle_unit": "rad"},
    "a repeated movement": {"reference_window": 5},
    "the whole recording in two phases": {"phases": "whole"},
    "few poses": {"tolerance_mm": 5.0},
    "a ball": {},
    "an axis that wanders": {"express_in": "proximal"},
    "two axes": {"express_in": "lab"},
}


class Pair(NamedTuple):
    analysis: Analysis
    view: TrialView


@pytest.fixture(scope="module", params=WAYS)
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Pair:
    way = str(request.param)
    if way == "a ball":
        recording = ball()
    elif way == "an axis that wanders":
        recording = simulate_trial(frames=150, inversion=60, joint_type="hinge", wander_deg=8.0, seed=5).recording
    elif way == "two axes":
        recording = simulate_trial(frames=150, inversion=60, joint_type="two-axes", seed=5).recording
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
    assert (analysis.joint_axis.best is None) == (way in ("a ball", "two axes"))
    assert (analysis.joint_axis.path is not None) == (way == "an axis that wanders")
    return Pair(analysis, view_of_result(folder, tuple(FIGURES)))


SERIES = {
    **{name: ("screw", name) for name in ("frame", "time_s", "valid", "filled", "angle", "angle_sd", "slide")},
    **{name: ("screw", name) for name in ("axis_direction", "axis_point", "axis_cone", "point_radius")},
    **{name: ("screw", name) for name in ("euler_parameters", "translation")},
    "modeled_angle": ("interpolated", "angle"),
    "modeled_euler_parameters": ("interpolated", "euler_parameters"),
    **{name: ("interpolated", name) for name in ("angle_error", "rms_displacement")},
}
"""Where an analysis has each series of a view."""
PARTS = ("phases", "keyframes", "repetitions", "joint_angles", "axis_path")


def numbers(value: Any) -> list[tuple[str, Any]]:
    """Arrays of a part of a view, by name."""
    if isinstance(value, np.ndarray):
        return [("", value)]
    return [(field.name, getattr(value, field.name)) for field in fields(value)]


def test_tables_come_back_as_they_were(pair: Pair) -> None:
    found = {
        name: (getattr(getattr(pair.analysis, part), of), getattr(pair.view, name))
        for name, (part, of) in SERIES.items()
    }
    found |= {
        name: (values, getattr(pair.view.repetitions, name)) for name, values in numbers(pair.analysis.repetitions)
    }
    for name, (before, after) in found.items():
        if before.dtype.kind == "f":
            # A unit there and back costs the last digit.
            assert after == pytest.approx(before, rel=1e-15, abs=0.0, nan_ok=True), name
        else:
            assert after.tolist() == before.tolist(), name


def test_an_analysis_at_hand_shows_the_very_numbers_of_its_result(pair: Pair) -> None:
    at_hand, read = view_of(pair.analysis), pair.view
    told = [field.name for field in fields(read) if field.name not in ("summary", "joint_summary", "repetition_curve")]
    for name in told:
        one, other = getattr(read, name), getattr(at_hand, name)
        if one is None or other is None:
            assert one is other is None, name
        elif name in PARTS or isinstance(one, np.ndarray):
            for (of, first), (_, second) in zip(numbers(one), numbers(other), strict=True):
                if isinstance(first, np.ndarray):
                    assert np.array_equal(first, second, first.dtype.kind == "f"), (name, of)
        elif name == "extra":
            assert set(one) == set(other) >= {"instantaneous", "losses"}
            for table, columns in one.items():
                for column, values in columns.items():
                    assert np.array_equal(values, other[table][column], values.dtype.kind == "f"), (table, column)
        elif name in ("confidence95", "spread95"):
            assert np.array_equal(one, other, equal_nan=True)
        else:
            assert one == other, name
    assert at_hand.summary == read.summary
    assert at_hand.joint_summary == read.joint_summary
    curves = read.repetition_curve, at_hand.repetition_curve
    assert (curves[0] is None) == (curves[1] is None)
    if curves[0] is not None and curves[1] is not None:
        for name, values in curves[0].items():
            assert np.array_equal(values, curves[1][name], equal_nan=True), name


def test_the_joint_comes_back(pair: Pair) -> None:
    analysis, view = pair
    tables: list[tuple[Any, Any]] = [
        (analysis.joint_angles, view.joint_angles),
        (analysis.joint_axis.path, view.axis_path),
    ]
    for table, again in tables:
        if table is None or again is None:
            assert table is again is None
            continue
        for name, values in numbers(table):
            # A unit there and back costs the last digit.
            assert getattr(again, name) == pytest.approx(values, rel=1e-15, abs=0.0, nan_ok=True), name


def test_poses_keyframes_and_movements_come_back(pair: Pair) -> None:
    analysis, view = pair
    assert view.reference == pytest.approx(analysis.joint.reference, abs=1e-14)
    assert view.proximal_in_lab == pytest.approx(analysis.joint.dual_quat_lab_proximal, abs=1e-14)
    assert view.keyframes.row.tolist() == analysis.keyframes.row.tolist()
    assert view.keyframes.phase_bounds.tolist() == analysis.keyframes.phase_bounds.tolist()
    assert view.summary["motion"]["inversion_frames"] == analysis.screw.frame[analysis.inversion_rows].tolist()
    assert view.keyframes.phases.law_rows.tolist() == analysis.keyframes.phases.law_rows.tolist()
    assert view.phases.moving.tolist() == analysis.phases.moving.tolist()
    told = {"method": analysis.settings.model_method, "law": analysis.settings.model_law}
    assert view.settings == analysis.settings.model_copy(update=told)
    assert (view.rate_hz, view.named_joint) == (analysis.recording.rate_hz, analysis.named_joint)
    names = None if analysis.proximal is None else analysis.proximal.name, analysis.distal.name
    assert (view.proximal_name, view.distal_name) == names


def test_axes_and_markers_come_back(pair: Pair) -> None:
    analysis, view = pair
    mean, joint = analysis.mean_axis, analysis.joint_axis
    assert view.mean_direction == pytest.approx(mean.direction)
    assert view.mean_point == pytest.approx(mean.point)
    assert view.spread95 == pytest.approx(mean.spread95, nan_ok=True)
    told = joint.headline
    line = joint.weighted_mean if told is None else told.line
    assert view.joint_direction == pytest.approx(line.direction)
    assert view.joint_point == pytest.approx(line.point)
    assert (view.confidence95 is None) == (joint.best is None)
    if told is not None:
        known = told.axis_cone, told.point_radius
        assert view.confidence95 == pytest.approx(known, nan_ok=True)
    for body, markers in ((analysis.proximal, view.proximal_markers), (analysis.distal, view.distal_markers)):
        offsets = None if body is None else body.marker_offsets
        assert (markers is None) == (offsets is None)
        if markers is not None and offsets is not None:
            assert markers == pytest.approx(offsets)


@pytest.mark.parametrize("name", ["theta", "joint", "slide", "joint_angles", "axis_path"])
def test_figures_of_a_result_read_back_are_those_of_the_analysis(pair: Pair, name: str) -> None:
    assert has_figure(name, pair.view) == has_figure(name, view_of(pair.analysis))
    if has_figure(name, pair.view):
        assert drawn(name, pair.view) == drawn(name, pair.analysis)


def drawn(name: str, trial: Analysis | TrialView) -> str:
    stream = io.BytesIO()
    with publication_style():
        figure = FIGURES[name](trial)
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
    view_of_result(folder)
    before = (folder / "SHA256SUMS").read_bytes()
    damage(folder)
    for sums in (before, (resealed(folder) / "SHA256SUMS").read_bytes()):
        (folder / "SHA256SUMS").write_bytes(sums)
        check_told(folder)


def check_told(folder: Path) -> None:
    with pytest.raises(ResultError) as told:
        view_of_result(folder)
    message = str(told.value)
    assert message.startswith(str(folder))
    assert "\n" not in message
    assert "analyze the trial" in message
    assert told.value.exit_code == 3
