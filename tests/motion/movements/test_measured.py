"""The cuts of measured motions: what they depend on, and what may be given in their place."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from elbowscrew import Recording, Settings, analyze, read_recording, simulate_trial
from elbowscrew.cli import main
from elbowscrew.motion.movements.boundaries import REASONS, Cuts
from elbowscrew.motion.movements.cuts import cut
from elbowscrew.motion.movements.measured import cut_warnings, measured_cuts
from elbowscrew.motion.screws.measurement import measure

TRIALS: list[dict[str, Any]] = [
    {"repetitions": 3, "rest_before_s": 0.7, "seed": 1},
    {"repetitions": 4, "hold_s": 0.5, "rest_after_s": 1.0, "marker_noise_mm": 0.5, "seed": 2},
    {"joint": "knee", "repetitions": 2, "rest_before_s": 0.4, "seed": 3},
    {"tremor_deg": 1.0, "tremor_hz": 6.0, "repetitions": 3, "seed": 4},
    {"top_deg": 15.0, "repetitions": 5, "marker_noise_mm": 0.3, "seed": 5},
]


def cuts_of(recording: Recording, **settings: Any) -> Cuts:
    wanted = Settings(**settings)
    return measured_cuts(measure(recording, wanted), wanted)


@pytest.mark.parametrize("trial", TRIALS)
@pytest.mark.parametrize(
    "filtered", [{"lowpass_hz": "auto"}, {"lowpass_hz": 3.0}, {"lowpass_hz": 4.0, "resample_hz": 50.0}]
)
def test_no_filter_moves_a_cut(trial: dict[str, Any], filtered: dict[str, Any]) -> None:
    recording = simulate_trial(**trial).recording
    plain, other = cuts_of(recording), cuts_of(recording, **filtered)
    assert plain.cycles.start_s.size == trial["repetitions"]
    assert np.allclose(other.cycles.times_s, plain.cycles.times_s, rtol=0.0, atol=1e-9)
    assert np.allclose(other.movements.onset_s, plain.movements.onset_s, rtol=0.0, atol=1e-9)
    assert np.allclose(other.movements.offset_s, plain.movements.offset_s, rtol=0.0, atol=1e-9)
    assert other.cycles.start_reasons == plain.cycles.start_reasons


@pytest.mark.parametrize("take", ["v121_thomazach_20230627_0117", "v121_thomazach_20230706_122504"])
@pytest.mark.parametrize("proximal", [1, 2])
def test_no_filter_moves_a_cut_of_a_real_take(real_data: Path, take: str, proximal: int) -> None:
    recording = read_recording(real_data / "real" / f"{take}.csv")
    bodies = {"proximal": f"Rigid Body {proximal}", "distal": f"Rigid Body {proximal + 1}"}
    plain, other = cuts_of(recording, **bodies), cuts_of(recording, **bodies, lowpass_hz="auto")
    assert np.allclose(other.cycles.times_s, plain.cycles.times_s, rtol=0.0, atol=1e-9)
    assert np.allclose(other.movements.onset_s, plain.movements.onset_s, rtol=0.0, atol=1e-9)


def test_noise_that_is_stated_is_the_noise() -> None:
    recording = simulate_trial(marker_noise_mm=0.2, seed=1).recording
    found, stated = cuts_of(recording), cuts_of(recording, marker_noise_mm=0.2)
    assert stated.noise == pytest.approx(found.noise, rel=0.1)  # both are right
    # A body that stands still has no more noise than it shows, whatever is stated: less of it is told.
    quieter = cuts_of(recording, marker_noise_mm=0.02)
    assert quieter.noise == pytest.approx(0.1 * stated.noise)
    assert quieter.cycles.start_sd_s[0] < found.cycles.start_sd_s[0]


def test_a_short_recording_has_the_noise_of_its_markers(tmp_path: Path) -> None:
    """Third differences of 18 frames tell nothing."""
    found = []
    for frames in (18, 450):
        path = tmp_path / f"{frames}.csv"
        trial = ("--frames", str(frames), "--inversion", str(frames // 2), "--marker-noise", "0.2", "--seed", "3")
        assert main(["simulate", str(path), *trial]) == 0
        found.append(cuts_of(read_recording(path)).noise)
    assert found[0] == pytest.approx(found[1], rel=0.3)


def test_the_residuals_of_the_markers_are_no_white_noise(real_data: Path) -> None:
    """A robot's clusters are off what they were calibrated as by ten times and more of what they jitter."""
    recording = read_recording(real_data / "real" / "v121_thomazach_20230706_122504.csv")
    bodies = {"proximal": "Rigid Body 1", "distal": "Rigid Body 2"}
    assert cuts_of(recording, **bodies).noise < np.radians(0.01)


@pytest.fixture(scope="module")
def three_cycles(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recording with cycles from 0.50 to 5.00 s, 5.00 to 9.49 s and 9.49 to 13.99 s."""
    path = tmp_path_factory.mktemp("cycles") / "take.csv"
    assert main(["simulate", str(path), "--repetitions", "3", "--rest-before", "0.5", "--rest-after", "0.5"]) == 0
    return path


def analyzed(take: Path, folder: Path, *options: object) -> tuple[int, dict[str, Any]]:
    output = folder / "out"
    code = main(["analyze", str(take), "-o", str(output), "--figure-format", "none", "--no-report", *map(str, options)])
    return code, json.loads((output / "summary.json").read_text(encoding="utf-8")) if code == 0 else {}


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_cycles_that_are_given_are_those_told(three_cycles: Path, tmp_path: Path) -> None:
    times = tmp_path / "times.csv"
    times.write_text("note,end_time_s,start_time_s\na,4.25,0.75\nb,9.0,4.25\n", encoding="utf-8")
    code, _ = analyzed(three_cycles, tmp_path, "--cycles", times)
    rows = table(tmp_path / "out" / "repetitions.csv")
    assert code == 0
    assert [(float(row["start_time_s"]), float(row["end_time_s"])) for row in rows] == [(0.75, 4.25), (4.25, 9.0)]
    assert {row["start_time_sd_s"] for row in rows} == {""}  # nobody stated one
    assert len(table(tmp_path / "out" / "cycles.csv")) == 2 * 101


def test_cycles_need_not_be_looked_for(three_cycles: Path, tmp_path: Path) -> None:
    code, summary = analyzed(three_cycles, tmp_path, "--no-cycles")
    assert code == 0
    assert table(tmp_path / "out" / "repetitions.csv") == []
    assert not (tmp_path / "out" / "cycles.csv").exists()
    _, usual = analyzed(three_cycles, tmp_path / "usual")
    assert summary["interpolation"]["phase_laws"] == usual["interpolation"]["phase_laws"]
    assert len(table(tmp_path / "usual" / "out" / "repetitions.csv")) == 3


@pytest.mark.parametrize(("swing", "cycles"), [("5", 3), ("110", 3), ("150", 0)])
def test_a_least_swing_may_be_given(three_cycles: Path, tmp_path: Path, swing: str, cycles: int) -> None:
    """The joint swings by 120 deg."""
    code, _ = analyzed(three_cycles, tmp_path, "--cycle-swing", swing)
    path = tmp_path / "out" / "repetitions.csv"
    assert code == 0
    assert (len(table(path)) if path.exists() else 0) == cycles


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("start,end\n1,2\n", 2, "start_time_s and end_time_s"),
        ("start_time_s,end_time_s\n1,two\n", 2, ":2: expected a start in seconds and an end after it"),
        ("start_time_s,end_time_s\n1,2\n3,2\n", 2, ":3: expected a start in seconds and an end after it"),
        ("start_time_s,end_time_s\n1,\n", 2, ":2: expected a start in seconds"),
        ("start_time_s,end_time_s\n1,inf\n", 2, ":2: expected a start in seconds"),
        ("start_time_s,end_time_s\n", 2, "no cycle"),
        ("", 2, "start_time_s and end_time_s"),
        ("\udcff\udcfe", 2, "not a CSV file in UTF-8"),
        ("start_time_s,end_time_s\n1,900\n", 4, "a cycle from 1 to 900 s; expected one after the other, within"),
        ("start_time_s,end_time_s\n1,4\n3,6\n", 4, "a cycle from 3 to 6 s; expected one after the other"),
        (None, 2, "No such file"),
    ],
)
def test_a_wrong_file_of_cycles_is_refused_in_one_line(
    three_cycles: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str | None, code: int, words: str
) -> None:
    times = tmp_path / "times.csv"
    if text is not None:
        times.write_bytes(text.encode("utf-8", "surrogateescape"))
    capsys.readouterr()
    assert analyzed(three_cycles, tmp_path, "--cycles", times)[0] == code
    error = capsys.readouterr().err.splitlines()
    assert len(error) == 1
    assert words in error[0]
    assert not (tmp_path / "out").exists()


def test_given_cycles_and_none_contradict(
    three_cycles: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    times = tmp_path / "times.csv"
    times.write_text("start_time_s,end_time_s\n1,4\n", encoding="utf-8")
    capsys.readouterr()
    assert analyzed(three_cycles, tmp_path, "--cycles", times, "--no-cycles")[0] == 2
    assert "contradict" in capsys.readouterr().err


@pytest.mark.parametrize("phases", ["movement", "whole"])
def test_the_share_that_the_model_covers(three_cycles: Path, tmp_path: Path, phases: str) -> None:
    """Of 14.5 s the joint moves in 13.5 s, which is all that phases of the movement hold."""
    _, summary = analyzed(three_cycles, tmp_path, "--phases", phases)
    rows = table(tmp_path / "out" / "interpolation.csv")
    share = np.mean([row["theta_deg"] != "" for row in rows])
    assert summary["interpolation"]["covered_share"] == pytest.approx(share, abs=1e-9)
    assert share == pytest.approx(1.0 if phases == "whole" else 13.49 / 14.49, abs=0.01)


@pytest.mark.parametrize("proximal", [1, 2])
def test_a_filter_hardly_moves_the_models_error(real_data: Path, proximal: int) -> None:
    recording = read_recording(real_data / "real" / "v121_thomazach_20230627_0117.csv")
    errors = []
    for lowpass in (None, "auto"):
        wanted = Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {proximal + 1}", lowpass_hz=lowpass)
        modeled = analyze(recording, wanted).interpolated
        errors.append([np.sqrt(np.nanmean(series**2)) for series in (modeled.angle_error, modeled.rms_displacement)])
    assert errors[1] == pytest.approx(errors[0], rel=0.1)


def test_what_the_standard_deviation_tells_is_no_warning() -> None:
    """A doubt about the law at a foot is told where it may move the cut by a twentieth of the cycle."""
    way = np.linspace(0.0, 80.0, 30)
    angle = np.concatenate([np.zeros(60), *4 * [way, way[::-1]], np.zeros(60)])
    noisy = np.radians(angle + np.random.default_rng(5).normal(0.0, 0.6, angle.size))
    cuts = cut(noisy, np.arange(angle.size) / 100.0, 100.0)
    cycles = cuts.cycles
    assert any("law" in codes for codes in cycles.start_reasons)
    for share, told in ((0.049, False), (0.051, True)):
        sd = share * (cycles.end_s - cycles.start_s)
        doubted = replace(cuts, cycles=replace(cycles, start_sd_s=sd))
        words = " ".join(warning.message for warning in cut_warnings(doubted, Settings()))
        assert ("start of cycle" in words and REASONS["law"] in words) == told


@pytest.mark.parametrize("small", [0.12, 0.2, 0.3])
def test_small_strokes_between_large_ones_are_told(small: float) -> None:
    """Tops of 90 and a fifth of that in turn: the small ones are no cycles, which had no word."""
    time, tops = np.arange(150) / 150.0, [90.0, small * 90.0] * 4
    angle = np.concatenate([0.5 * top * (1.0 - np.cos(2.0 * np.pi * time)) for top in tops])
    angle += np.random.default_rng(2).normal(0.0, 0.1, angle.size)
    elapsed = np.arange(angle.size) / 100.0
    cuts = cut(np.radians(angle), elapsed, 100.0)
    assert cuts.cycles.start_s.size == 4
    (message,) = (one.message for one in cut_warnings(cuts, Settings()) if one.code == "small-strokes")
    assert message.startswith("4 strokes out and back")
    assert np.degrees(cuts.small) == pytest.approx(small * 90.0, abs=1.5)
    advised = float(message.split("--cycle-swing ")[1].split()[0])
    counted = cut(np.radians(angle), elapsed, 100.0, least_swing=np.radians(advised))
    assert counted.cycles.start_s.size == 8
    assert not counted.small.size


def test_hesitations_are_no_small_strokes() -> None:
    """On the way, at the top, and tremor at rest."""
    time = np.arange(3000) / 100.0
    angle = 45.0 * (1.0 - np.cos(2.0 * np.pi * time / 5.0)) + 6.0 * np.sin(2.0 * np.pi * time / 1.25)
    assert not cut(np.radians(angle), time, 100.0).small.size
    for trial in TRIALS:
        assert not cuts_of(simulate_trial(**trial).recording).small.size
