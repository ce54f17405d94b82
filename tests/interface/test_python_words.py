"""Errors of the Python interface speak of keywords, and its keywords are the settings."""

from __future__ import annotations

import dataclasses
import inspect
import pickle
import re
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import numpy as np
import pytest

import elbowscrew
from elbowscrew import Analysis, Settings, Simulation
from elbowscrew.configuring import settings_with
from elbowscrew.errors import ElbowscrewError, OutputError, ResultError, UsageError
from elbowscrew.interface.fields import ComparisonFields, SettingsFields, SimulationFields
from elbowscrew.interface.python_words import in_python
from elbowscrew.settings import SETTINGS
from elbowscrew.simulate import simulate_trial


def choices_in(annotation: Any) -> set[str]:
    """Strings that a type allows, in a union or a list."""
    if get_origin(annotation) is Literal:
        return {one for one in get_args(annotation) if isinstance(one, str)}
    return set().union(*map(choices_in, get_args(annotation)))


def test_every_setting_is_a_keyword_of_its_type() -> None:
    keywords = get_type_hints(SettingsFields)
    former = {"arm", "forearm", "arm_markers", "forearm_markers"}
    assert set(keywords) == set(Settings.model_fields) | former
    for name, field in Settings.model_fields.items():
        assert choices_in(keywords[name]) == choices_in(field.annotation), name


def test_every_field_of_a_simulation_is_a_keyword() -> None:
    keywords = get_type_hints(SimulationFields)
    former = {name: keywords.pop(name) for name in ("arm", "axis_drift_deg")}
    assert keywords == get_type_hints(Simulation)
    assert former == {"arm": keywords["proximal"], "axis_drift_deg": keywords["wander_deg"]}


def test_no_option_is_left_in_a_message() -> None:
    for one in SETTINGS:
        assert in_python(f"give --{one.option}.") == f"give {one.field}."
    assert in_python("--method sclerp or joint") == 'method="sclerp" or joint'
    assert in_python("--units m, cm or mm") == "units m, cm or mm"
    assert in_python("--max-turn 4000 keeps it") == "max_turn_deg_s=4000 keeps it"
    assert in_python("no option -- here, nor a-b") == "no option -- here, nor a-b"


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"max_gap": 3}, "unknown key 'max_gap'; did you mean 'max_gap_s'"),
        ({"max_gap_s": -1}, "max_gap_s: should be greater than or equal to 0, found -1"),
        ({"reference": 4444}, "reference=4444: no such frame"),
        ({"law": "linear", "law_peak": 0.4}, "leave law_peak out"),
        ({"distal": "Nobody"}, "distal"),
    ],
)
def test_errors_name_keywords(samples: Path, given: dict[str, Any], told: str) -> None:
    with pytest.raises(ElbowscrewError, match=re.escape(told)) as caught:
        elbowscrew.analyze(samples / "elbow_natural.csv", **given)
    assert "--" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"max_gap": 3}, "settings: unknown key 'max_gap'; did you mean 'max_gap_s'?"),
        (
            {"min_angle_deg": -1, "length_unit": "cm"},
            "min_angle_deg: should be greater than 0, found -1; settings: length",
        ),
        ({"law": "linear", "law_peak": 0.4}, "law_peak: the law 'linear' has no highest velocity; leave law_peak out"),
        ({"tolerance_mm": 2, "keyframes": (1, 2)}, "give either tolerance_mm or keyframes"),
        ({"joint": "knee", "express_in": "forearm"}, 'no segment of joint="knee"'),
        ({"export": ("parqet",)}, "did you mean 'parquet'?"),
    ],
)
def test_settings_that_cannot_be_are_told_in_one_line_by_their_fields(given: dict[str, Any], told: str) -> None:
    with pytest.raises(UsageError, match=re.escape(told)) as caught:
        Settings(**given)
    assert "--" not in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.__cause__ is caught.value.__context__ is None


def test_settings_show_what_was_chosen_and_do_not_change() -> None:
    found = Settings(min_angle_deg=5, keyframes=(0, 3))
    assert str(found) == repr(found) == "Settings(min_angle_deg=5.0, keyframes=(0, 3))"
    with pytest.raises(UsageError, match="settings do not change: make new ones, or give law beside them"):
        found.law = "linear"  # type: ignore[misc]
    assert pickle.loads(pickle.dumps(found)) == found  # noqa: S301 - our own


def test_an_existing_result_is_told_with_the_keyword_that_replaces_it(read_back: Analysis, elbow: Analysis) -> None:
    assert read_back.folder is not None
    with pytest.raises(OutputError, match="give overwrite=True to replace it"):
        elbowscrew.save_analysis(elbow, read_back.folder)


def test_a_trial_that_cannot_be_simulated_is_told_by_its_keywords() -> None:
    with pytest.raises(UsageError, match=r"impossible value of top_deg:"):
        elbowscrew.simulate_trial(top_deg=-1)
    with pytest.raises(UsageError, match=r"--top"):
        simulate_trial(top_deg=-1)


def test_a_comparison_takes_its_plan_as_keywords(elbow: Analysis) -> None:
    own = set(get_type_hints(ComparisonFields)) - set(get_type_hints(SettingsFields))
    assert own == {field.name for field in dataclasses.fields(elbowscrew.ComparisonPlan)} - {"knots"}
    plan = elbowscrew.ComparisonPlan(laws=("linear",), data=("raw",))
    found = elbowscrew.compare(elbow.recording, plan=plan, methods=["sclerp"], counts=[2], laws=["harmonic"])
    assert set(found.models.law) == {"harmonic"}
    assert set(found.models.method) == {"sclerp"}
    assert set(found.models.data) == {"raw"}
    with pytest.raises(UsageError, match="compare_trials: paths: expected the paths of recordings, found 0"):
        elbowscrew.compare_trials(range(2))  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"laws: expected some of .*did you mean 'linear'"):
        elbowscrew.compare(elbow.recording, laws=["linaer"])  # type: ignore[list-item]


def test_what_is_no_recording_is_told(elbow: Analysis) -> None:
    with pytest.raises(UsageError, match=r"found DataFrame; arrays become one by RigidBody\.from_quaternions"):
        elbowscrew.analyze(elbow.to_frame())  # type: ignore[arg-type]
    trial = simulate_trial(frames=60, inversion=30)
    np.testing.assert_array_equal(
        elbowscrew.analyze(trial).screw.angle, elbowscrew.analyze(trial.recording).screw.angle
    )


@pytest.mark.parametrize("given", [5, None, [[0.0]], np.zeros(3), "a\0b", "\ud800"])
@pytest.mark.parametrize(
    "name",
    [
        "read_recording", "read_result", "read_landmarks", "read_mesh", "read_keyframes", "keyframes_of",
        "save_simulation", "save_comparison", "save_motion", "save_analysis", "summary_from_analysis",
    ],
)  # fmt: skip
def test_what_is_of_another_type_is_told_in_a_line(name: str, given: object, tmp_path: Path) -> None:
    others = [tmp_path / "out"] if name.startswith("save") else []
    with pytest.raises(ElbowscrewError) as caught:
        getattr(elbowscrew, name)(given, *others)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_the_argument_that_does_not_fit_is_named(elbow: Analysis) -> None:
    with pytest.raises(UsageError, match="interpolate: frames: expected int, found str 'many'"):
        elbowscrew.interpolate(elbow, "many")  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"simulate_trial: seed: expected int, found float 1\.5"):
        elbowscrew.simulate_trial(seed=1.5)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="save_analysis: folder: expected path, found None"):
        elbowscrew.save_analysis(elbow, None)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="expected the name of a table, found ndarray"):
        elbow.to_frame(np.zeros(3))  # type: ignore[arg-type]
    for name in (None, "a\0b", "\ud800"):
        with pytest.raises(UsageError, match="samples: there is no"):
            elbowscrew.samples.path(name)  # type: ignore[arg-type]


def test_a_fault_that_is_not_the_callers_stays_what_it_is(elbow: Analysis) -> None:
    def failing(_done: int, _total: int) -> None:
        msg = "of the caller's own function"
        raise ValueError(msg)

    with pytest.raises(ValueError, match="of the caller's own function"):
        elbowscrew.compare(elbow.recording, laws=["linear"], counts=[2], data=["raw"], report=failing)


def test_one_path_is_a_list_of_it(samples: Path) -> None:
    with pytest.raises(ElbowscrewError, match=r"none of the 1 recordings .*nothing\.csv"):
        elbowscrew.compare_trials(str(samples / "nothing.csv"))


def test_a_file_of_a_result_is_not_its_folder(read_back: Analysis) -> None:
    assert read_back.folder is not None
    with pytest.raises(ResultError, match=f"give the folder of the result, as {re.escape(str(read_back.folder))}"):
        elbowscrew.read_result(read_back.folder / "summary.json")


def test_one_name_stands_for_a_list_of_it() -> None:
    assert Settings(figure_format="none", figures="theta", export="mat") == Settings(  # type: ignore[arg-type]
        figure_format=("none",), figures=("theta",), export=("mat",)
    )


def test_attributes_that_are_nearly_right_are_asked_back(elbow: Analysis) -> None:
    with pytest.raises(AttributeError, match="did you mean 'analyze'"):
        elbowscrew.analyse  # noqa: B018
    with pytest.raises(AttributeError, match="did you mean 'joint_axis'"):
        elbow.joint_axes  # type: ignore[attr-defined] # noqa: B018
    with pytest.raises(AttributeError, match=r"'theta'; numbers stand in to_frame\(\)"):
        elbow.theta  # type: ignore[attr-defined] # noqa: B018
    with pytest.raises(AttributeError, match="no plot is called 'thta'; did you mean 'theta'"):
        elbow.plot.thta  # type: ignore[attr-defined] # noqa: B018
    with pytest.raises(AttributeError, match="no plot is called 'trace'; there are theta, euler_parameters"):
        elbow.plot.trace  # type: ignore[attr-defined] # noqa: B018
    assert not hasattr(elbow, "_ipython_display_")


def test_a_synthetic_trial_shows_itself_in_a_line() -> None:
    told = repr(simulate_trial(frames=60, inversion=30))
    assert told.startswith("SimulatedTrial(Recording(60 frames at 100 Hz; bodies 'Upper Arm', 'Forearm'); markers 4 of")
    assert len(told) < 400


def test_keywords_are_stronger_than_settings() -> None:
    found = settings_with(Settings(proximal="A", lowpass_hz=6), {"arm": "B", "keyframes": [0, 9]})
    assert (found.proximal, found.lowpass_hz, found.keyframes) == ("B", 6, (0, 9))
    assert settings_with(None, {}) == Settings()


def test_no_public_function_gives_just_anything() -> None:
    functions = [getattr(elbowscrew, name) for name in elbowscrew.__all__]
    given = [one.__annotations__["return"] for one in functions if inspect.isfunction(one)]
    assert len(given) > 12
    assert not any("Any" in str(one) for one in given)
