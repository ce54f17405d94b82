"""Models beside each other: the yardstick, what is left out, and the numbers that are known."""

from __future__ import annotations

import itertools
import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import (
    Comparison,
    ComparisonPlan,
    Recording,
    RigidBody,
    Settings,
    analyze,
    compare,
    compare_trials,
    save_simulation,
    simulate_trial,
)
from elbowscrew.cli import main
from elbowscrew.errors import AnalysisError, UsageError
from elbowscrew.geometry import dual_quat_from_screw, line_through
from elbowscrew.motion.interpolation.comparison import models_of

TRIAL = simulate_trial(
    frames=200, inversion=90, rest_before_s=0.5, proximal="moving", marker_noise_mm=0.1, seed=5
).recording
SMALL = ComparisonPlan(laws=("cycloidal", "best"), counts=(2, 3), data=("raw",))


def errors_of(found: Comparison, **wanted: Any) -> float:
    models = found.models
    chosen = np.logical_and.reduce([getattr(models, name) == value for name, value in wanted.items()])
    assert chosen.sum() == 1, wanted
    return float(models.rms_displacement[chosen][0])


@pytest.mark.parametrize("method", ["dlb", "sclerp", "catmull-rom"])
@pytest.mark.parametrize("law", ["cycloidal", "best"])
def test_two_keyframes_a_phase_are_the_model_of_analyze(method: Any, law: Any) -> None:
    found = compare(TRIAL, plan=ComparisonPlan(methods=(method,), laws=(law,), counts=(2,), data=("raw",)))
    modeled = analyze(TRIAL, Settings(method=method, law=law)).interpolated
    direct = {
        "rms_displacement": np.sqrt(np.nanmean(modeled.rms_displacement**2)),
        "max_displacement": np.nanmax(modeled.rms_displacement),
        "rms_angle_error": np.sqrt(np.nanmean(modeled.angle_error**2)),
        "max_translation_error": np.nanmax(modeled.translation_error),
        "rms_axis_error": np.sqrt(np.nanmean(modeled.axis_error**2)),
        "max_axis_distance": np.nanmax(modeled.axis_distance),
    }
    row = np.flatnonzero(found.models.blend == "piecewise")
    for name, value in direct.items():
        assert getattr(found.models, name)[row] == pytest.approx([value], rel=1e-12)
    worst = int(np.nanargmax(modeled.rms_displacement))
    assert found.models.max_displacement_frame[row].tolist() == [modeled.frame[worst]]


def test_each_step_is_reported_and_the_last_is_the_fewest_keyframes(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    models = compare(TRIAL, plan=SMALL, report=lambda *step: told.append(step)).models
    steps = models.rank.size + 1
    assert told == [(done, steps) for done in range(1, steps + 1)]
    told.clear()
    save_simulation(simulate_trial(frames=60, inversion=30), tmp_path / "take.csv")
    paths = [tmp_path / "missing.csv", tmp_path / "take.csv"]
    found = compare_trials(iter(paths), plan=SMALL, report=lambda *step: told.append(step))
    assert (len(found.trials), len(found.failures), told) == (1, 1, [(1, 2), (2, 2)])


def test_models_are_ranked_and_every_model_is_there_once() -> None:
    models = compare(TRIAL, plan=SMALL).models
    assert (np.diff(models.rms_displacement[models.note == ""]) >= 0.0).all()
    assert models.rank.tolist() == list(range(1, models.rank.size + 1))
    names = ("data", "method", "blend", "law", "knots", "keyframes_per_phase")
    keys = list(zip(*(getattr(models, name).tolist() for name in names), strict=True))
    assert len(set(keys)) == len(keys)
    assert (models.ns_per_frame[models.note == ""] > 0.0).all()


@pytest.mark.parametrize("knots", ["law", "uniform", "angle"])
def test_what_is_left_out_is_the_same_model_as_what_is_there(knots: Any) -> None:
    """Every combination by `analyze`, which knows nothing of this: no two of those compared are alike by definition."""
    plan = ComparisonPlan(laws=("cycloidal",), knots=(knots,), counts=(2, 3), data=("raw",))
    kept = {(model.method, model.blend, model.keyframes) for model in models_of(plan)}
    phases = analyze(TRIAL).keyframes.phases.bound_rows
    middle = [(int(a) + int(b)) // 2 for a, b in itertools.pairwise(phases)]
    for count, rows in ((2, phases.tolist()), (3, sorted([*phases.tolist(), *middle]))):
        poses = {}
        for method in plan.methods:
            for blend in plan.blends:
                chosen: dict[str, Any] = {"method": method, "blend": blend, "knots": knots}
                settings = Settings(
                    keyframes=tuple(TRIAL.frame[rows].tolist()), inversion=int(TRIAL.frame[phases[1]]),
                    law="cycloidal", **chosen,
                )  # fmt: skip
                motion = analyze(TRIAL, settings).interpolated
                poses[method, blend] = np.concatenate([motion.euler_parameters, motion.translation], axis=1)
        for left_out in set(poses) - {(method, blend) for method, blend, number in kept if number == count}:
            twins = [
                key for key in poses if (*key, count) in kept and np.nanmax(np.abs(poses[key] - poses[left_out])) < 1e-9
            ]
            assert twins, (left_out, count)


def test_a_filter_and_a_lower_rate_change_the_keyframes_and_not_the_yardstick() -> None:
    plan = ComparisonPlan(methods=("sclerp",), laws=("polynomial-345",), blends=("piecewise",), counts=(2, 4))
    found = compare(TRIAL, Settings(lowpass_hz=4.0), plan)
    assert set(found.models.data.tolist()) == {"raw", "lowpass 4 Hz", "every 2nd", "every 4th"}
    raw = compare(TRIAL, plan=ComparisonPlan(**{**_fields(plan), "data": ("raw",)}))
    for count in (2, 4):
        assert errors_of(found, data="raw", keyframes_per_phase=count) == errors_of(raw, keyframes_per_phase=count)
        filtered = errors_of(found, data="lowpass 4 Hz", keyframes_per_phase=count)
        assert filtered != errors_of(raw, keyframes_per_phase=count)
        assert filtered == pytest.approx(errors_of(raw, keyframes_per_phase=count), rel=0.6)


def _fields(plan: ComparisonPlan) -> dict[str, Any]:
    return {name: getattr(plan, name) for name in plan.__dataclass_fields__}


def test_what_cannot_be_made_is_told_with_the_reason() -> None:
    plan = ComparisonPlan(methods=("dlb",), laws=("linear",), counts=(20,), knots=("uniform",), data=("raw",))
    models = compare(TRIAL, plan=plan).models
    assert all("weighs them by up to" in note for note in models.note)
    assert np.isnan(models.rms_displacement).all()
    assert models.max_displacement_frame.mask.all()


def test_each_model_has_its_own_errors_whatever_stands_beside_it() -> None:
    plan = ComparisonPlan(laws=("linear",), blends=("piecewise",), counts=(3, 20), knots=("uniform",), data=("raw",))
    every = compare(TRIAL, plan=plan).models
    assert {bool(note) for note in every.note} == {True, False}
    for method in set(every.method):
        alone = compare(TRIAL, plan=ComparisonPlan(**{**_fields(plan), "methods": (method,)})).models
        for count in plan.counts:
            rows = (np.flatnonzero((of.method == method) & (of.keyframes_per_phase == count)) for of in (every, alone))
            for beside, single in itertools.zip_longest(*(of.tolist() for of in rows)):
                for name in {field.name for field in fields(alone)} - {"rank", "ns_per_frame"}:
                    told, expected = getattr(every, name)[beside], getattr(alone, name)[single]
                    np.testing.assert_array_equal(np.ma.filled(told, -1), np.ma.filled(expected, -1), err_msg=name)


def hinge(count: int = 1201) -> Recording:
    line = line_through([0.1, -0.2, 0.05], [0.2, 0.9, -0.3])
    pose = dual_quat_from_screw(np.linspace(0.0, np.radians(130.0), count), 0.0, line[:3], line[3:])
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(count, dtype=np.uint8))
    return Recording.from_bodies([body], rate_hz=100)


def test_the_known_errors_of_blending_a_hinge() -> None:
    """0 to 130 deg under DLB with uniform Lagrange knots, at 2 to 5 keyframes; ScLERP has none at all."""
    plan = ComparisonPlan(
        methods=("dlb", "sclerp"), laws=("linear",), blends=("piecewise",), knots=("uniform",), data=("raw",)
    )
    models = compare(hinge(), Settings(phases="whole"), plan).models
    dlb = models.method == "dlb"
    order = np.argsort(models.keyframes_per_phase[dlb])
    largest = np.degrees(models.max_angle_error[dlb][order])
    assert largest == pytest.approx([2.870, 1.282, 0.0329, 0.00582], rel=2e-3)
    assert models.rms_displacement[~dlb].max() < 1e-12


def test_the_selection_is_that_of_the_movement() -> None:
    found = compare(TRIAL, Settings(tolerance_mm=5.0), SMALL)
    assert set(found.selections) == {"joint", "sclerp", "sdlb"}
    for method, selection in found.selections.items():
        assert selection.row[0] == found.phases.bound_rows[0]
        assert selection.row[-1] == found.phases.bound_rows[-1]
        keyframes = tuple(TRIAL.frame[selection.row].tolist())
        # The law of time itself, over one phase: keyframes by their own times.
        by_method: dict[str, Any] = {"method": method, "law": "linear"}
        again = analyze(TRIAL, Settings(keyframes=keyframes, **by_method)).interpolated
        bends = set(analyze(TRIAL, Settings(keyframes=keyframes)).inversion_rows.tolist())
        assert bends <= set(selection.row.tolist())
        assert np.nanmax(again.rms_displacement) == pytest.approx(selection.largest[-1], abs=1e-9)
        assert selection.largest[-1] <= 5e-3


def test_over_trials_there_are_mean_and_standard_deviation(tmp_path: Path) -> None:
    paths = []
    for seed in range(3):
        trial = simulate_trial(frames=120, inversion=55, seed=seed, marker_noise_mm=0.3)
        paths.append(save_simulation(trial, tmp_path / f"{seed}.csv")[0])
    found = compare_trials(paths, plan=SMALL)
    assert found.models.trials.tolist() == [3] * found.models.rank.size
    values = [errors_of(one, method="sclerp", law="cycloidal", keyframes_per_phase=2) for one in found.trials]
    models = found.models
    row = (models.method == "sclerp") & (models.law == "cycloidal") & (models.keyframes_per_phase == 2)
    assert models.rms_displacement_mean[row] == pytest.approx([np.mean(values)], rel=1e-12)
    assert models.rms_displacement_sd[row] == pytest.approx([np.std(values, ddof=1)], rel=1e-9)


def test_a_folder_without_any_good_recording_says_why(tmp_path: Path) -> None:
    path = tmp_path / "no.csv"
    path.write_text("nothing\n")
    with pytest.raises(AnalysisError, match=r"none of the 1 recordings .* no.csv"):
        compare_trials([path], plan=SMALL)


@pytest.mark.parametrize(
    ("plan", "says"),
    [
        ({"methods": ("slerp",)}, "^methods: expected some of dlb, sclerp"),
        ({"laws": ()}, "^laws: .* found none"),
        ({"counts": (1,)}, "^counts: expected whole numbers from 2 to 20, found 1"),
        ({"decimation": (0,)}, "^decimation:"),
        ({"data": ("filtered",)}, "^data: expected some of raw"),
    ],
)
def test_impossible_plans(plan: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        ComparisonPlan(**plan)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "study"
    folder.mkdir()
    for seed in range(2):
        save_simulation(simulate_trial(frames=80, inversion=40, seed=seed), folder / f"t{seed}.csv")
    few = ["--laws", "linear,polynomial-345", "--counts", "2,3", "--data", "raw,decimated"]
    assert main(["compare", "study/t0.csv", *few]) == 0
    out = capsys.readouterr().out
    assert "Fewest, sclerp" in out
    names = sorted(path.relative_to("t0_compare").as_posix() for path in Path("t0_compare").rglob("*.*"))
    assert names == ["compare.csv", "compare.json", "figures/compare.caption.txt", "figures/compare.png"]
    assert main(["compare", "study/t0.csv", *few]) == 6
    assert "give --force" in capsys.readouterr().err
    assert main(["compare", "study/t0.csv", *few, "--force", "--json", "--figure-format", "none"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary == json.loads(Path("t0_compare/compare.json").read_text())
    assert summary["best"][0]["rank"] == 1
    assert main(["compare", "study", *few, "-q"]) == 0
    assert json.loads(Path("study_compare/compare.json").read_text())["failures"] == []
    (folder / "broken.csv").write_text("nothing\n")
    assert main(["compare", "study", *few, "-o", "again"]) == 7
    captured = capsys.readouterr()
    assert "broken.csv:1: no format that is read" in captured.err
    assert "2 compared, 1 failed" in captured.out
    assert main(["compare", "nowhere.csv"]) == 3
    assert main(["compare", "study/t0.csv", "--counts", "two", "-o", "x"]) == 2
    assert main(["compare", "study/t0.csv", "--decimation", "100", "-o", "x"]) == 4
    assert "a phase has less than two" in capsys.readouterr().err
    assert not Path("x").exists()
