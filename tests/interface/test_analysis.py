"""What `analyze` gives and `read_result` reads back: the same object, as far as files hold it."""

from __future__ import annotations

import copy
import json
import pickle
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import elbowscrew
from elbowscrew import Analysis, model
from elbowscrew.errors import NotKeptError, ResultError, UsageError
from elbowscrew.interface.facts import facts
from elbowscrew.results.writing import results_by_table


def test_a_result_read_back_is_the_same_but_for_the_last_digit(elbow: Analysis, read_back: Analysis) -> None:
    assert type(read_back) is type(elbow)
    assert set(read_back.tables) == set(results_by_table(elbow))
    for name in (*elbow.tables, "joint", "warnings"):
        ours, theirs = (one.table(name).to_frame() for one in (elbow, read_back))  # type: ignore[arg-type]
        pd.testing.assert_frame_equal(ours, theirs, rtol=4e-16, atol=0.0, check_exact=False)
    assert read_back.summary == json.loads(json.dumps(elbow.summary))
    assert read_back.joint_summary == json.loads(json.dumps(elbow.joint_summary))
    assert repr(read_back) == repr(elbow)
    assert read_back._repr_html_() == elbow._repr_html_()


def test_parts_that_files_hold_are_read_back(elbow: Analysis, read_back: Analysis) -> None:
    assert read_back.settings == elbow.settings.model_copy(update={"method": "dlb", "law": "cycloidal"})
    assert read_back.laws[0].name == elbow.laws[0].name
    assert [law.rms for law in read_back.laws] == pytest.approx([law.rms for law in elbow.laws])
    assert read_back.inversion_rows.tolist() == elbow.inversion_rows.tolist()
    assert read_back.warnings == elbow.warnings
    assert read_back.keyframes.row.tolist() == elbow.keyframes.row.tolist()
    for knots, known in zip(read_back.keyframes.knots, elbow.keyframes.knots, strict=True):
        np.testing.assert_allclose(knots, known)
    assert read_back.instantaneous.lowpass_hz == elbow.instantaneous.lowpass_hz
    assert read_back.steps is not None
    assert read_back.anatomy is None


def test_what_files_do_not_hold_is_an_error_and_told_by_the_class(elbow: Analysis, read_back: Analysis) -> None:
    lacking = [field.name for field in fields(model.Analysis) if not hasattr(read_back, field.name)]
    told = set(re.findall(r"`(\w+)`", str(Analysis.__doc__).split("Notes")[1]))
    assert "recording" in lacking
    assert set(lacking) <= told
    with pytest.raises(NotKeptError, match=r"recording is not kept.*to_frame"):
        _ = read_back.recording
    assert all(hasattr(elbow, name) for name in lacking)
    for one in (elbow, read_back):
        with pytest.raises(AttributeError, match="no attribute 'theta'"):
            _ = one.theta  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("trial", "settings"),
    [
        ({"joint_type": "ball", "joint": "hip"}, {"method": "joint", "express_in": "proximal", "angle_unit": "rad"}),
        ({"joint_type": "hinge", "gaps": 2}, {"blend": "global", "keyframes": [0, 20, 40, 79], "length_unit": "m"}),
        ({"joint_type": "two-axes", "located": False}, {"tolerance_mm": 9, "express_in": "lab"}),
    ],
)
def test_results_of_all_kinds_are_read_back(trial: dict[str, Any], settings: dict[str, Any], tmp_path: Path) -> None:
    located = trial.pop("located", True)
    recording = elbowscrew.simulate_trial(frames=80, inversion=38, seed=5, **trial).recording
    if not located:
        bodies = [body.without_positions() for body in recording.bodies]
        recording = elbowscrew.Recording.from_bodies(bodies, rate_hz=recording.rate_hz)
    found = elbowscrew.analyze(recording, **settings)
    back = elbowscrew.read_result(elbowscrew.save_analysis(found, tmp_path / "r", figure_formats=(), report=False))
    assert set(back.tables) == set(found.tables)
    for name in (*found.tables, "joint", "warnings"):
        ours, theirs = (one.table(name).to_frame() for one in (found, back))  # type: ignore[arg-type]
        pd.testing.assert_frame_equal(ours, theirs, rtol=5e-16, atol=0.0, check_exact=False)
    assert repr(back) == repr(found)
    assert hasattr(back, "keyframes") == (settings.get("method") != "joint")
    if hasattr(back, "keyframes"):
        for knots, known in zip(back.keyframes.knots, found.keyframes.knots, strict=True):
            np.testing.assert_allclose(knots, known, atol=1e-12)
    assert back.plot.available == found.plot.available


def test_a_selection_and_cycles_are_read_back(tmp_path: Path) -> None:
    trial = elbowscrew.simulate_trial(frames=80, inversion=38, repetitions=3, rest_before_s=0.3, seed=4)
    found = elbowscrew.analyze(trial.recording, tolerance_mm=20)
    back = elbowscrew.read_result(elbowscrew.save_analysis(found, tmp_path / "r", figure_formats=(), report=False))
    assert found.selection is not None
    assert back.selection is not None
    assert back.selection.row.tolist() == found.selection.row.tolist()
    np.testing.assert_allclose(back.selection.largest, found.selection.largest)
    assert back.selection.tolerance == found.selection.tolerance
    assert back.repeatability.icc == found.repeatability.icc
    assert back.repeatability.axis_sd == pytest.approx(found.repeatability.axis_sd)
    assert back.to_xarray("cycles").sizes == {"cycle": 3, "percent": 101}


def test_the_display_tells_axes_with_their_intervals(elbow: Analysis) -> None:
    told = repr(elbow)
    two = elbow.joint_summary["two_axes"]
    assert two is not None
    assert two["axis1"]["cone95_deg"] is not None
    assert f"95 % within {two['axis1']['cone95_deg']:.3f} deg" in told
    assert "two axes (determined)" in told
    assert "Right Upper Arm → Right Forearm" in told
    assert "no-single-axis" in told
    assert max(map(len, told.splitlines())) < 160


def test_each_axis_is_displayed_in_the_body_that_its_cone_is_in(elbow: Analysis) -> None:
    """It was told in the frame of the screws, where its cone is another."""
    told, two = dict(facts(elbow.summary, elbow.joint_summary)), elbow.joint_summary["two_axes"]
    assert two is not None
    for name, body, line in (("axis 1", "proximal", two["axis1"]), ("axis 2", "distal", two["axis2"])):
        words = rf"\((.*)\) through \((.*)\) mm in the {body} frame; 95 % within (.*) deg and (.*) mm"
        found = re.fullmatch(words, told[name].replace("\N{MINUS SIGN}", "-"))
        assert found is not None
        direction, point = ([float(x) for x in found[k].split(", ")] for k in (1, 2))
        assert direction == pytest.approx(line[f"direction_in_{body}"], abs=6e-4)  # type: ignore[literal-required]
        assert point == pytest.approx(line[f"point_in_{body}_mm"], abs=0.06)  # type: ignore[literal-required]
        assert float(found[3]) == pytest.approx(line["cone95_deg"], rel=0.01)
        assert float(found[4]) == pytest.approx(line["radius95_mm"], rel=0.02)


def test_an_axis_that_is_not_known_is_said_to_be_so(elbow: Analysis) -> None:
    joint = copy.deepcopy(elbow.joint_summary)
    assert joint["two_axes"] is not None
    joint["two_axes"]["axis1"]["determined"] = False
    joint["two_axes"]["axis2"]["cone95_deg"] = None
    told = dict(facts(elbow.summary, joint))
    assert told["axis 1"].endswith("; not determined")
    assert told["axis 2"].endswith("; not known how surely")
    joint["two_axes"] = None
    assert dict(facts(elbow.summary, joint))["axis"] == "the motion has no single axis"


def test_names_are_escaped_in_a_notebook() -> None:
    recording = elbowscrew.simulate_trial(frames=60, inversion=30).recording
    bodies = [
        model.RigidBody(name=f"<b>{body.name}</b>", dual_quat_lab_body=body.dual_quat_lab_body, loss=body.loss)
        for body in recording.bodies
    ]
    found = elbowscrew.analyze(elbowscrew.Recording.from_bodies(bodies, rate_hz=100.0))
    assert "&lt;b&gt;Upper Arm" in found._repr_html_()
    assert "<b>Upper Arm" not in found._repr_html_()


def test_all_of_a_trial_is_one_dataset(elbow: Analysis, tmp_path: Path) -> None:
    data = elbow.to_xarray()
    np.testing.assert_array_equal(data["theta"], elbow.to_frame()["theta_deg"])
    np.testing.assert_array_equal(data["interpolation_theta"], elbow.to_frame("interpolation")["theta_deg"])
    assert data.attrs["joint_type"] == "two_axes"
    data.to_netcdf(tmp_path / "trial.nc")
    with xr.open_dataset(tmp_path / "trial.nc") as back:
        xr.testing.assert_equal(back.load(), data)


def test_results_are_pickled_with_all_they_have(elbow: Analysis, read_back: Analysis) -> None:
    assert elbow.plot is elbow.plot
    for one in (elbow, read_back):
        back = pickle.loads(pickle.dumps(one))  # noqa: S301 - our own
        pd.testing.assert_frame_equal(back.to_frame(), one.to_frame())
        assert repr(back) == repr(one)
    assert pickle.loads(pickle.dumps(elbowscrew.analyze)) is elbowscrew.analyze  # noqa: S301 - our own


def test_a_table_that_is_not_there_is_named_with_those_that_are(elbow: Analysis) -> None:
    with pytest.raises(UsageError, match="no table 'anatomy'; there are screw, "):
        elbow.to_frame("anatomy")


def test_a_damaged_result_is_refused(read_back: Analysis, tmp_path: Path) -> None:
    assert read_back.folder is not None
    for file in read_back.folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / "cycles.csv").write_text("cycle,percent,theta_deg\n")
    with pytest.raises(ResultError, match=r"cycles\.csv"):
        elbowscrew.read_result(tmp_path)


def test_the_view_in_space_is_a_frame_of_its_own(elbow: Analysis) -> None:
    shown = elbow.view_3d(400)
    assert shown._repr_html_().startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')
    assert 'id="space"' in shown.page
    with pytest.raises(UsageError, match="height"):
        elbow.view_3d(3)
