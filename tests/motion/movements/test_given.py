"""Cycles that are given: whatever their cuts, no speed is noise and nothing is told of what is no cycle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from elbowscrew import Analysis, Settings, analyze, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import SettingError

TRIAL = simulate_trial(repetitions=3, rest_before_s=1.0, rest_after_s=0.5, seed=3)
FOUND = analyze(TRIAL.recording).repetitions
TOPS = FOUND.inversion_frame / TRIAL.recording.rate_hz


def given(*cycles: tuple[float, float]) -> Analysis:
    return analyze(TRIAL.recording, Settings(cycles=cycles))


def told(analysis: Analysis, code: str) -> list[str]:
    return [warning.message for warning in analysis.warnings if warning.code == code]


def test_cycles_from_top_to_top_have_their_speeds() -> None:
    """Back of one found cycle, then out of the next."""
    analysis = given((TOPS[0], TOPS[1]), (TOPS[1], TOPS[2]))
    cycles = analysis.repetitions
    assert cycles.back_speed == pytest.approx(FOUND.back_speed[:2])
    assert cycles.outward_speed == pytest.approx(FOUND.outward_speed[1:])
    lows = analysis.screw.angle[np.searchsorted(analysis.screw.frame, cycles.inversion_frame)]
    assert np.degrees(lows) == pytest.approx([0.0, 0.0], abs=1.0)
    assert "cycles 1, 2: cut at a top" in told(analysis, "given-cycles")[0]


def test_a_cycle_in_a_rest_has_no_speeds() -> None:
    analysis = given((0.1, 0.8), (float(FOUND.start_time_s[0]), float(FOUND.end_time_s[0])))
    speeds = np.column_stack([analysis.repetitions.outward_speed, analysis.repetitions.back_speed])
    assert np.isnan(speeds[0]).all()
    assert speeds[1] == pytest.approx([FOUND.outward_speed[0], FOUND.back_speed[0]])
    assert "cycle 1: without a swing" in told(analysis, "given-cycles")[0]
    assert not told(analysis, "speeds-unknown")


@pytest.mark.parametrize("length_s", [0.001, 0.01, 0.05])
def test_a_cycle_of_few_frames_is_refused(length_s: float) -> None:
    with pytest.raises(SettingError, match="expected 10 frames or more, found"):
        given((2.0, 2.0 + length_s))


def test_a_swing_larger_than_all_is_told() -> None:
    analysis = analyze(TRIAL.recording, Settings(cycle_swing_deg=200.0))
    assert not analysis.repetitions.number.size
    assert "200 deg of --cycle-swing" in told(analysis, "no-such-swing")[0]
    assert not told(analyze(TRIAL.recording, Settings(cycle_swing_deg=100.0)), "no-such-swing")


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--cycles", "start_time_s,end_time_s\n1,two\n", "expected a start in seconds and an end after it"),
        ("--cycles", "start_time_s,end_time_s\n1,2\n1.5,3\n", "one after the other"),
        ("--keyframes", "0,0,50", "must increase"),
        ("--lowpass", "-3", "above 0 Hz"),
        ("--skin-motion", "500,5", "millimeters"),
    ],
)
def test_what_was_found_is_said_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, value: str, words: str
) -> None:
    take = tmp_path / "take.csv"
    assert main(["simulate", str(take)]) == 0
    if option == "--cycles":
        (tmp_path / "cycles.csv").write_text(value, encoding="utf-8")
        value = str(tmp_path / "cycles.csv")
    capsys.readouterr()
    assert main(["analyze", str(take), "-o", str(tmp_path / "out"), option, value]) != 0
    (error,) = capsys.readouterr().err.splitlines()
    assert words in error
    assert error.count("found ") <= 1


def test_a_number_that_is_given_twice_counts_twice(tmp_path: Path) -> None:
    """Five millimeters and five degrees, not five millimeters alone."""
    take, out = tmp_path / "take.csv", tmp_path / "out"
    assert main(["simulate", str(take)]) == 0
    options = ("--no-report", "--figure-format", "none", "--skin-motion", "5,5")
    assert main(["analyze", str(take), "-o", str(out), *options]) == 0
    assert '"skin-motion": [\n      5.0,\n      5.0\n    ]' in (out / "summary.json").read_text(encoding="utf-8")
