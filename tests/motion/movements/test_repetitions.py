"""Movements, repetitions, and how alike these are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import find_peaks

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, read_recording, simulate_trial
from elbowscrew.geometry import dual_quat_from_screw, line_through
from elbowscrew.motion.movements.cuts import cut
from elbowscrew.motion.movements.phases import turning_points
from elbowscrew.motion.movements.repetitions import intraclass_correlation, multiple_correlation

FRAMES, TURN, COUNT, REST = 300, 120, 5, 150


def repeated(**changes: Any) -> Analysis:
    given = {"repetitions": COUNT, "rest_before_s": 1.5, "rest_after_s": 1.5, "frames": FRAMES, "inversion": TURN}
    return analyze(simulate_trial(proximal="moving", **{**given, **changes}).recording, Settings(marker_noise_mm=0.2))


def test_every_repetition_is_found_where_it_is() -> None:
    analysis = repeated(seed=3)
    found = analysis.repetitions
    starts = REST + np.arange(COUNT) * (FRAMES - 1)
    assert np.abs(found.start_frame - starts).max() <= 3
    assert np.abs(found.end_frame - (starts + FRAMES - 1)).max() <= 3
    assert np.abs(found.inversion_frame - (starts + TURN)).max() <= 3
    assert found.duration_s == pytest.approx(np.full(COUNT, (FRAMES - 1) / 100), rel=0.01)
    assert (found.end_frame[:-1] <= found.start_frame[1:]).all()
    assert np.degrees(found.top_angle) == pytest.approx(np.full(COUNT, 130.0), abs=1.5)
    # Minimum jerk: 15/8 of the mean speed at its highest.
    for speed, frames in ((found.outward_speed, TURN), (found.back_speed, FRAMES - 1 - TURN)):
        assert np.degrees(speed) == pytest.approx(np.full(COUNT, 15 / 8 * 130 / frames * 100), rel=0.02)
    assert np.degrees(found.axis_deviation).max() < 0.1
    # The model goes through every one of them.
    assert np.abs(analysis.keyframes.frame[1::2] - (starts + TURN)).max() <= 3
    assert np.nanmax(analysis.interpolated.angle_error) < np.radians(10.0)


def test_one_model_of_several_repetitions_is_told_of() -> None:
    for settings in (Settings(phases="whole"), Settings(inversion=REST + TURN)):
        recording = simulate_trial(
            repetitions=COUNT, rest_before_s=1.5, rest_after_s=1.5, frames=FRAMES, inversion=TURN
        ).recording
        assert "several-repetitions" in [warning.code for warning in analyze(recording, settings).warnings]


def test_onset_and_offset_of_the_movement() -> None:
    phases = repeated(seed=4).phases
    assert phases.onset_rows.size == 1
    assert phases.onset_rows[0] == pytest.approx(REST, abs=3)
    assert phases.offset_rows[0] == pytest.approx(REST + COUNT * (FRAMES - 1), abs=3)


def test_a_hold_at_the_top_parts_movements_but_no_repetition() -> None:
    time = np.arange(1000) / 100
    share = np.interp(time, [0, 2, 3, 6, 7, 10], [0, 0, 1, 1, 0, 0])
    angle = np.radians(90.0) * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    found = cut(angle, time, 100.0)
    assert found.movements.onset_s.size == 2
    assert found.cycles.times_s.shape == (1, 3)
    assert found.cycles.times_s[0] == pytest.approx([2.0, 4.5, 7.0], abs=0.05)


def test_a_motion_that_does_not_return_is_no_repetition() -> None:
    time = np.arange(300) / 100
    found = cut(np.radians(80.0) * time / 3.0, time, 100.0)
    assert found.movements.onset_s.size == 1
    assert found.cycles.times_s.shape == (0, 3)


@given(st.lists(st.integers(-50, 50), min_size=3, max_size=60), st.integers(1, 40))
def test_turning_points_are_the_prominent_peaks_of_scipy(values: list[int], swing: int) -> None:
    series = np.array(values, dtype=np.float64) + 1e-3 * np.arange(len(values))
    found = turning_points(series, float(swing))
    assert (np.abs(np.diff(series[found])) >= swing - 1e-9).all() or found.size <= 2
    inner = found[1:-1]
    highs = inner[series[inner] > series[found[:-2]]] if inner.size else inner
    peaks, figures = find_peaks(series, prominence=0.0)
    prominence = dict(zip(peaks.tolist(), figures["prominences"].tolist(), strict=True))
    assert all(prominence[int(high)] >= swing - 1e-9 for high in highs)
    # Between two highs found there is none of that prominence left.
    assert highs.size >= np.sum(figures["prominences"] >= swing + 1e-9) or found.size <= 2


def test_icc_of_the_table_of_shrout_and_fleiss() -> None:
    """Six targets, four judges (Psychological Bulletin 86, 1979): ICC(2,1) is 0.29."""
    table = np.array([[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]], dtype=float)
    assert round(intraclass_correlation(table), 2) == 0.29


def test_cmc_is_kadabas_formula() -> None:
    rng = np.random.default_rng(2)
    curves = np.sin(np.linspace(0, 6, 40)) + 0.3 * rng.normal(size=(4, 40))
    within = whole = 0.0
    for g in range(4):
        for t in range(40):
            within += (curves[g, t] - np.mean([curves[k, t] for k in range(4)])) ** 2
            whole += (curves[g, t] - np.mean(curves)) ** 2
    expected = np.sqrt(1 - (within / (40 * 3)) / (whole / (4 * 40 - 1)))
    assert multiple_correlation(curves) == pytest.approx(expected)


def test_curves_that_are_one_agree_wholly_and_one_curve_says_nothing() -> None:
    curve = np.sin(np.linspace(0, 3, 50))
    assert multiple_correlation(np.stack([curve] * 3)) == pytest.approx(1.0)
    assert intraclass_correlation(np.stack([curve] * 3, axis=1)) == pytest.approx(1.0)
    assert np.isnan(multiple_correlation(curve[None]))
    assert np.isnan(intraclass_correlation(curve[:, None]))
    assert np.isnan(multiple_correlation(np.ones((3, 5))))


def test_repeatability_of_alike_repetitions() -> None:
    found = repeated(seed=5).repeatability
    assert found.icc > 0.97
    assert found.cmc > 0.97
    assert np.nanmax(found.count) == COUNT
    assert np.degrees(found.mean.max()) == pytest.approx(130.0, abs=2.0)
    assert np.degrees(found.axis_sd) < 0.1
    assert found.point_sd < 2e-4
    alone = repeated(repetitions=1)
    single = alone.repeatability
    assert alone.repetitions.number.size == 1
    assert np.isfinite(alone.repetitions.axis_direction).all()
    assert np.isnan(alone.repetitions.axis_deviation).all()  # it is the mean itself
    assert np.isnan(single.icc)
    assert np.isnan(single.axis_sd)
    assert np.isnan(single.sd).all()


def test_axes_of_repetitions_about_two_lines_are_told_apart() -> None:
    """Two cycles about lines that are 10 deg and 8 mm apart: half of that each from their mean."""
    angle = np.radians(50.0) * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, 200)))
    tilt = np.radians(10.0)
    lines = line_through([0.0, 0, 0], [0.0, 0, 1]), line_through([0.008, 0, 0], [0.0, np.sin(tilt), np.cos(tilt)])
    pose = np.concatenate([dual_quat_from_screw(angle, 0.0, line[:3], line[3:]) for line in lines])
    body = RigidBody(name="b", dual_quat_lab_body=pose, loss=np.zeros(400, dtype=np.uint8))
    analysis = analyze(Recording.from_bodies([body], rate_hz=100), Settings(frozen="keep"))
    assert analysis.repetitions.number.size == 2
    assert np.degrees(analysis.repetitions.axis_deviation) == pytest.approx([5.0, 5.0], abs=1e-6)
    assert np.degrees(analysis.repeatability.axis_sd) == pytest.approx(5.0 * np.sqrt(2.0), abs=1e-6)
    assert analysis.repeatability.point_sd == pytest.approx(0.004 * np.sqrt(2.0), rel=0.02)


@pytest.mark.parametrize(
    ("name", "proximal", "onset_s"),
    [("v121_thomazach_20230627_0117", 1, 3.6), ("v121_thomazach_20230706_122504", 1, 13.6)],
)
def test_real_takes_rest_before_they_move(real_data: Path, name: str, proximal: int, onset_s: float) -> None:
    recording = read_recording(real_data / "real" / f"{name}.csv")
    settings = Settings(proximal=f"Rigid Body {proximal}", distal=f"Rigid Body {proximal + 1}")
    analysis = analyze(recording, settings)
    elapsed = recording.time_s - recording.time_s[0]
    onsets = elapsed[analysis.phases.onset_rows]
    assert np.abs(onsets - onset_s).min() < 0.15
    assert not analysis.phases.moving[elapsed < onset_s - 1.0].mean() > 0.2
    tops = elapsed[analysis.repetitions.inversion_frame - recording.frame[0]]
    if proximal == 1 and name.endswith("122504"):
        assert tops == pytest.approx([13.9, 15.0, 15.9, 19.8, 21.0, 21.9], abs=0.15)
    else:
        assert tops.size == 0
