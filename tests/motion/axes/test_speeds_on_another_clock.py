"""Speeds of a recording that is put on another clock, or whose frames are not all measurements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.geometry.arrays import Index

PEAK_DEG_S = 90.0 * 1.875 / 1.5
"""Minimum jerk over 90 deg in 1.5 s: 15/8 of the mean speed."""


def trial(noise_mm: float) -> Recording:
    return simulate_trial(
        joint_type="hinge", top_deg=90.0, frames=301, inversion=150, marker_noise_mm=noise_mm, seed=5
    ).recording


def rows_of(recording: Recording, rows: Index, rate_hz: float) -> Recording:
    """Rows of a recording, at a rate, as an export with nothing but the bodies."""
    frame = np.arange(rows.size)
    bodies = tuple(
        RigidBody(name=body.name, dual_quat_lab_body=body.dual_quat_lab_body[rows], loss=body.loss[rows])
        for body in recording.bodies
    )
    return Recording(bodies=bodies, frame=frame, time_s=frame / rate_hz, rate_hz=rate_hz)


def cutoff_of(analysis: Analysis) -> float:
    assert analysis.instantaneous.lowpass_hz is not None
    return analysis.instantaneous.lowpass_hz


@pytest.mark.parametrize("rate_hz", [40.0, 70.0, 500.0, 1000.0])
@pytest.mark.parametrize("lowpass_hz", [None, "auto", 5.0])
def test_another_clock_makes_no_other_speed(rate_hz: float, lowpass_hz: float | None) -> None:
    recording = trial(0.5)
    own = analyze(recording, Settings(lowpass_hz=lowpass_hz))
    other = analyze(recording, Settings(lowpass_hz=lowpass_hz, resample_hz=rate_hz))
    assert cutoff_of(other) == pytest.approx(cutoff_of(own), rel=1e-9)
    for one in ("outward_speed", "back_speed"):
        assert getattr(other.repetitions, one) == pytest.approx(getattr(own.repetitions, one), rel=0.01)
    # At an instant that both clocks have, the speed is the same number.
    shared = np.isclose(own.elapsed[:, None], other.elapsed, rtol=0.0, atol=1e-9).nonzero()
    speeds = own.instantaneous.angular_velocity[shared[0]], other.instantaneous.angular_velocity[shared[1]]
    both = np.isfinite(speeds[0]) & np.isfinite(speeds[1])
    assert both.sum() > 20
    assert speeds[1][both] == pytest.approx(speeds[0][both], abs=1e-9)


def test_frames_that_were_repeated_are_no_noise_above_the_motion() -> None:
    half = rows_of(trial(0.5), np.arange(0, 301, 2), 50.0)
    twice = rows_of(half, np.repeat(np.arange(151), 2), 100.0)
    found = analyze(twice, Settings(resample_hz=50.0))
    assert np.degrees(found.repetitions.outward_speed[0]) == pytest.approx(PEAK_DEG_S, rel=0.05)
    # On their own clock, on which every second frame is lost, nobody can say; but not 40 Hz.
    assert cutoff_of(analyze(twice)) < 10.0


def test_a_clock_of_two_rates_put_on_a_faster_one_has_the_noise_of_its_own_rates() -> None:
    recording = trial(0.5)
    rows = np.r_[0:150, 150:301:2]
    two = replace(rows_of(recording, rows, 100.0), time_s=rows / 100.0)
    found = analyze(two, Settings(resample_hz=400.0))
    assert cutoff_of(found) < 10.0
    assert np.degrees(np.nanmax(found.instantaneous.angular_velocity)) == pytest.approx(PEAK_DEG_S, rel=0.05)
