"""The JSON files are what the published schemas say, to the last key, as an independent validator sees it."""

from __future__ import annotations

import copy
import json
import runpy
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, get_type_hints

import pytest
from finished_results import ball, flexion_only
from jsonschema import Draft202012Validator
from trials import LANDMARKS

from elbowscrew import (
    Analysis,
    Settings,
    analyze,
    compare,
    compare_trials,
    read_recording,
    save_simulation,
    simulate_trial,
)
from elbowscrew.model.comparison_summary_types import ComparedModel, ModelOverTrials
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.quantities import unit_suffixes
from elbowscrew.reading.landmarks import read_landmarks
from elbowscrew.results.comparison_summary import comparison_summary, trials_summary
from elbowscrew.results.joint_summary import joint_summary
from elbowscrew.results.recording_summary import summary_from_recording
from elbowscrew.results.summary import summary_from_analysis
from elbowscrew.study_columns import STUDY_COLUMNS
from elbowscrew.tables import COMPARISON_COLUMNS, TRIALS_COMPARISON_COLUMNS, Column

SAMPLES = ("elbow_paper", "elbow_moving_arm_mm", "elbow_row_tagged", "knee", "elbow_left", "elbow_natural")
WAYS: dict[str, dict[str, Any]] = {
    "few poses": {"tolerance_mm": 5.0},
    "the best law, in radians": {"law": "best", "angle_unit": "rad", "express_in": "proximal", "lowpass_hz": "auto"},
    "all there is to set": {
        "skin_motion": (2.0, 1.0),
        "cycles": ((0.0, 2.0), (2.0, 4.0)),
        "keyframes": (0, 100, 200),
        "marker_noise_mm": 0.3,
        "export": ("mat",),
        "axis_sd_deg": 2.0,
        "resample_hz": 50.0,
    },
}
CASES: dict[str, dict[str, Any]] = {
    "cases/two_axis_elbow": {"proximal": "none"},
    "cases/hip_ball": {},
    "cases/knee_screwhome": {},
    "real/v121_thomazach_20230627_0117": {"proximal": "Rigid Body 1", "distal": "Rigid Body 2"},
    "real/motive_rowtag_v11_1body": {},
    "real/v123_transboat_circle020": {},
}


@cache
def validator(root: Path, name: str) -> Draft202012Validator:
    schema = json.loads((root / "docs" / "schemas" / f"{name}.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def faults(root: Path, name: str, content: object) -> list[str]:
    read_back = json.loads(json.dumps(content, allow_nan=False))
    return [f"{error.json_path}: {error.message}" for error in validator(root, name).iter_errors(read_back)]


def assert_fits(root: Path, analysis: Analysis) -> None:
    assert faults(root, "summary", summary_from_analysis(analysis)) == []
    assert faults(root, "joint", joint_summary(analysis)) == []


def test_the_published_schemas_are_those_of_the_types(root: Path) -> None:
    made = runpy.run_path(str(root / "docs" / "make_schemas.py"))
    folder = root / "docs" / "schemas"
    assert {path.name for path in folder.iterdir()} == {f"{name}.schema.json" for name in made["FILES"]}
    for name in made["FILES"]:
        assert (folder / f"{name}.schema.json").read_text(encoding="utf-8") == made["text"](name), name


@pytest.mark.parametrize("name", SAMPLES)
def test_samples_fit(root: Path, samples: Path, name: str) -> None:
    recording = read_recording(samples / f"{name}.csv")
    assert_fits(root, analyze(recording))
    assert faults(root, "info", summary_from_recording(recording)) == []


@pytest.mark.parametrize("way", WAYS)
def test_settings_of_every_kind_fit(root: Path, samples: Path, way: str) -> None:
    assert_fits(root, analyze(read_recording(samples / "elbow_moving_arm_mm.csv"), Settings(**WAYS[way])))


@pytest.mark.parametrize("make", [ball, flexion_only])
def test_motions_without_an_axis_or_a_cycle_fit(root: Path, make: Any) -> None:
    assert_fits(root, analyze(make()))


def test_landmarks_fit(root: Path, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(LANDMARKS)
    recording = simulate_trial(frames=120, inversion=60, proximal="moving").recording
    assert_fits(root, analyze(recording, landmarks=read_landmarks(tmp_path / "arm.toml")))


@pytest.mark.parametrize("name", CASES)
def test_real_recordings_and_cases_fit(root: Path, real_data: Path, name: str) -> None:
    recording = read_recording(real_data / f"{name}.csv")
    assert_fits(root, analyze(recording, Settings(**CASES[name])))


def test_a_file_without_bodies_fits(root: Path) -> None:
    recording = simulate_trial(frames=20, inversion=10).recording
    summary = summary_from_recording(replace(recording, bodies=()))
    assert summary["roles"]["distal"] is None
    assert faults(root, "info", summary) == []


def test_comparisons_fit(root: Path, tmp_path: Path) -> None:
    plan = ComparisonPlan(laws=("linear", "empirical"), counts=(2, 3), data=("raw",))
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for seed, path in enumerate(paths):
        save_simulation(simulate_trial(frames=60, inversion=30, seed=seed), path)
    (tmp_path / "c.csv").write_text("no recording")
    one = comparison_summary(compare(read_recording(paths[0]), Settings(tolerance_mm=5.0), plan))
    assert one["best"]
    assert one["selections"]
    assert faults(root, "compare", one) == []
    several = trials_summary(compare_trials([*paths, tmp_path / "c.csv"], plan=plan))
    assert several["best"]
    assert len(several["failures"]) == 1
    assert faults(root, "compare", several) == []


def columns_of(table: tuple[Column, ...]) -> set[str]:
    suffixes = unit_suffixes("deg", "mm")
    return {f"{column.name}{suffixes.get(column.quantity, '')}" for column in table}


def test_a_model_has_the_columns_of_its_table() -> None:
    assert set(get_type_hints(ComparedModel)) == columns_of(COMPARISON_COLUMNS) - {"note"}
    assert set(get_type_hints(ModelOverTrials)) == columns_of(TRIALS_COMPARISON_COLUMNS)


def places(content: Any, place: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Each place in a JSON file."""
    for key, value in content.items() if isinstance(content, dict) else enumerate(content):
        yield (*place, key)
        if isinstance(value, dict | list):
            yield from places(value, (*place, key))


OPEN = {"lost_frames", "versions", "landmarks_mm"}
"""Objects whose keys are no fixed names."""


def test_a_key_too_many_or_too_few_is_seen_wherever_it_is(root: Path, samples: Path) -> None:
    analysis = analyze(read_recording(samples / "elbow_moving_arm_mm.csv"))
    summary = summary_from_analysis(analysis)
    for name, whole in (("summary", summary), ("joint", joint_summary(analysis))):
        assert faults(root, name, whole) == []
        for place in [(), *places(whole)]:
            changed = copy.deepcopy(whole)
            part: Any = changed
            for key in place:
                part = part[key]
            if not isinstance(part, dict) or OPEN.intersection(place):
                continue
            for key in list(part):
                value = part.pop(key)
                assert faults(root, name, changed) != [], (*place, key)
                part[key] = value
            part["remark"] = "?"
            assert faults(root, name, changed) != [], place


def test_every_column_of_a_study_is_in_the_summary(root: Path) -> None:
    schema = validator(root, "summary").schema
    for column in STUDY_COLUMNS:
        if column.keys[0] == "warnings":
            assert column.keys[1] in schema["$defs"]["WarningSummary"]["properties"]["severity"]["enum"]
            continue
        part = schema
        for key in column.keys:
            part = next((one for one in part.get("anyOf", ()) if "maxItems" in one), part)
            if isinstance(key, int):
                assert key < part["maxItems"]
                part = part["items"]
            else:
                part = part["properties"][key]
            reference = next((one["$ref"] for one in (part, *part.get("anyOf", ())) if "$ref" in one), None)
            part = part if reference is None else schema["$defs"][reference.rsplit("/", 1)[1]]
