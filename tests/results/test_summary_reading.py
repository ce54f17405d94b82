"""A summary that was damaged or edited is told in one line with the file and the key, whatever is wrong in it."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from sealed import reproved, resealed

from elbowscrew import analyze, save_analysis, simulate_trial
from elbowscrew._version import __version__
from elbowscrew.errors import ResultError
from elbowscrew.results.proof import proof_of
from elbowscrew.results.summary_reading import read_joint_summary, read_summary
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.saving import write_result

READERS: dict[str, Callable[[Path], Any]] = {
    "summary.json": lambda folder: read_summary(reproved(folder)),
    "joint.json": lambda folder: read_joint_summary(reproved(folder)),
}
OPEN = {"settings", "lost_frames", "versions", "landmarks_mm"}
"""Objects whose keys are no fixed names."""


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    analysis = analyze(simulate_trial(frames=80, inversion=40, proximal="moving", gaps=1, seed=3).recording)
    return save_analysis(analysis, tmp_path_factory.mktemp("result") / "r", figure_formats=(), report=False)


@pytest.fixture
def folder(result: Path, tmp_path: Path) -> Path:
    for path in result.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path


def content_of(folder: Path, name: str) -> Any:
    return json.loads((folder / name).read_text(encoding="utf-8"))


def keys_of(content: Any, place: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    for key, value in content.items() if isinstance(content, dict) else enumerate(content):
        if isinstance(content, dict):
            yield (*place, key)
        if isinstance(value, dict | list) and key not in OPEN:
            yield from keys_of(value, (*place, key))


def told(read: Callable[[Path], Any], folder: Path) -> str:
    with pytest.raises(ResultError) as caught:
        read(folder)
    assert caught.value.exit_code == 3
    message = str(caught.value)
    assert "\n" not in message
    assert "analyze the trial" in message
    return message


@pytest.mark.parametrize("name", READERS)
def test_any_key_that_is_missing_or_of_another_kind_is_named(folder: Path, name: str) -> None:
    whole = content_of(folder, name)
    seen = 0
    for place in keys_of(whole):
        changed = copy.deepcopy(whole)
        parent: Any = changed
        for key in place[:-1]:
            parent = parent[key]
        dotted = ".".join(map(str, place))
        wrongs: list[Any] = [[[]]] if place == ("settings",) else [[[]], {"a": []}]
        for wrong in wrongs:
            parent[place[-1]] = wrong
            (folder / name).write_text(json.dumps(changed))
            assert told(READERS[name], folder).startswith(f"{folder / name}: {dotted}"), (place, wrong)
        del parent[place[-1]]
        (folder / name).write_text(json.dumps(changed))
        assert told(READERS[name], folder) == f"{folder / name}: {dotted}: is missing; analyze the trial again", place
        seen += 1
    assert seen > 80


def test_what_was_expected_and_what_was_found_is_told(folder: Path) -> None:
    summary = content_of(folder, "summary.json")
    summary["motion"]["theta_max_deg"] = [1.0, 2.0]
    (folder / "summary.json").write_text(json.dumps(summary))
    where = f"{folder / 'summary.json'}: motion.theta_max_deg: "
    assert (
        told(READERS["summary.json"], folder)
        == f"{where}expected a valid number, found a list of 2; analyze the trial again"
    )


@pytest.mark.parametrize("name", READERS)
def test_a_number_as_text_is_no_number(folder: Path, name: str) -> None:
    whole = content_of(folder, name)
    seen = 0
    for place in keys_of(whole):
        changed = copy.deepcopy(whole)
        parent: Any = changed
        for key in place[:-1]:
            parent = parent[key]
        if type(parent[place[-1]]) not in (int, float) or OPEN & set(place):
            continue
        parent[place[-1]] = str(parent[place[-1]])
        (folder / name).write_text(json.dumps(changed))
        assert told(READERS[name], folder).startswith(f"{folder / name}: {'.'.join(map(str, place))}: expected"), place
        seen += 1
    assert seen > 20


def test_another_version_is_named_beside_a_key_that_it_lacks(folder: Path) -> None:
    summary = content_of(folder, "summary.json")
    del summary["motion"]["signed"]
    (folder / "summary.json").write_text(json.dumps({**summary, "elbowscrew": "9.1"}))
    where, other = f"{folder / 'summary.json'}: motion.signed: is missing", f"9.1; this is {__version__}"
    assert told(READERS["summary.json"], folder) == f"{where} (written by elbowscrew {other}); analyze the trial again"


def test_another_version_with_the_same_keys_is_read_and_keys_of_ones_own_are_passed_over(folder: Path) -> None:
    summary = content_of(folder, "summary.json")
    (folder / "summary.json").write_text(json.dumps({**summary, "elbowscrew": "9.1", "operator": "me"}))
    assert read_summary(reproved(folder)) == {**summary, "elbowscrew": "9.1"}


@pytest.mark.parametrize("word", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_no_number_is_not_taken_for_one(folder: Path, word: str) -> None:
    summary = content_of(folder, "summary.json")
    text = json.dumps(summary).replace(json.dumps(summary["motion"]["theta_max_deg"]), word)
    (folder / "summary.json").write_text(text)
    assert word in told(READERS["summary.json"], folder)


@pytest.mark.parametrize("key", ["min-angle", "color"])
def test_a_setting_that_cannot_be_is_named(folder: Path, key: str) -> None:
    summary = content_of(folder, "summary.json")
    summary["settings"][key] = "wide"
    (folder / "summary.json").write_text(json.dumps(summary))
    message = told(view_of_result, resealed(folder))
    assert message.startswith(f"{folder / 'summary.json'}: settings")
    assert key in message


def test_the_preferred_fit_must_be_there(folder: Path) -> None:
    joint = content_of(folder, "joint.json")
    preferred = joint["preferred"]
    (folder / "joint.json").write_text(json.dumps({**joint, preferred: None}))
    assert told(READERS["joint.json"], folder).startswith(f"{folder / 'joint.json'}: {preferred}: ")


@pytest.mark.parametrize("number", [10**30, -(10**30), 10**6, -1])
def test_a_frame_beyond_all_numbers_is_told(folder: Path, number: int) -> None:
    summary = content_of(folder, "summary.json")
    summary["interpolation"]["keyframes"][-1] = number
    (folder / "summary.json").write_text(json.dumps(summary))
    assert told(view_of_result, resealed(folder)).startswith(str(folder))


def test_the_summary_that_was_written_is_the_one_on_disk(tmp_path: Path) -> None:
    """Once built it need not be read: no value is of a kind that JSON does not give back."""
    analysis = analyze(simulate_trial(frames=80, inversion=40, gaps=1, seed=3).recording)
    written = write_result(analysis, tmp_path / "r", figure_formats=(), report=False)
    assert read_summary(proof_of(tmp_path / "r")) == written
    assert kinds(written) == kinds(content_of(tmp_path / "r", "summary.json"))


def kinds(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: kinds(value) for key, value in content.items()}
    if isinstance(content, list):
        return [kinds(value) for value in content]
    assert not isinstance(content, float) or math.isfinite(content)
    return type(content)
