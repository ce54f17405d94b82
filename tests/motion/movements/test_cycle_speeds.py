"""Highest speeds of strokes: those of the motion, or none where they may lie among frames without a speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from elbowscrew import Analysis, analyze, simulate_trial
from elbowscrew.model import Recording


def without_frames(recording: Recording, lost: list[int]) -> Recording:
    """The same recording with poses of the distal body lost."""
    distal = recording.bodies[1]
    pose, loss = distal.dual_quat_lab_body.copy(), distal.loss.copy()
    pose[lost], loss[lost] = np.nan, 1
    return replace(recording, bodies=(recording.bodies[0], replace(distal, dual_quat_lab_body=pose, loss=loss)))


def analyzed(lost: list[int]) -> Analysis:
    trial = simulate_trial(joint_type="hinge", top_deg=90.0, frames=300, inversion=150, marker_noise_mm=0.05, seed=3)
    return analyze(without_frames(trial.recording, lost))


def codes(analysis: Analysis) -> set[str]:
    return {warning.code for warning in analysis.warnings}


def test_a_lost_frame_at_the_highest_speed_leaves_it_empty_with_a_warning() -> None:
    whole, broken = analyzed([]), analyzed([75])
    # Minimum jerk: 15/8 of the mean speed.
    assert np.degrees(whole.repetitions.outward_speed[0]) == pytest.approx(90.0 * 1.875 / 1.5, rel=0.03)
    assert "speeds-unknown" not in codes(whole)
    assert np.isnan(broken.repetitions.outward_speed[0])
    assert broken.repetitions.back_speed[0] == pytest.approx(whole.repetitions.back_speed[0], rel=0.03)
    assert "speeds-unknown" in codes(broken)


def test_a_lost_frame_at_the_top_takes_no_speed() -> None:
    broken = analyzed([150])
    assert np.isfinite([broken.repetitions.outward_speed[0], broken.repetitions.back_speed[0]]).all()
    assert "speeds-unknown" not in codes(broken)


def test_slow_strokes_keep_their_speed_though_slower_frames_have_none() -> None:
    slow = simulate_trial(
        joint_type="hinge", top_deg=30.0, frames=600, inversion=300, marker_noise_mm=0.05, seed=3
    ).recording
    found = analyze(slow)
    assert np.degrees(found.repetitions.outward_speed[0]) == pytest.approx(30.0 * 1.875 / 3.0, rel=0.05)
    assert "speeds-unknown" not in codes(found)


def test_what_the_filter_leaves_out_at_the_ends_of_a_recording_is_not_lost() -> None:
    found = analyze(
        simulate_trial(
            joint_type="hinge", top_deg=90.0, frames=90, inversion=45, law="linear", marker_noise_mm=0.05
        ).recording
    )
    speed = found.instantaneous.angular_velocity
    assert np.isnan(speed[[0, -1]]).all()
    assert np.isfinite([found.repetitions.outward_speed[0], found.repetitions.back_speed[0]]).all()
    assert "speeds-unknown" not in codes(found)


def test_a_gap_over_a_whole_stroke_but_its_slow_ends_leaves_its_speed_empty() -> None:
    broken = analyzed(list(range(15, 136)))
    assert np.isnan(broken.repetitions.outward_speed[0])
    assert np.degrees(broken.repetitions.back_speed[0]) == pytest.approx(90.0 * 1.875 / 1.5, rel=0.03)
    assert "speeds-unknown" in codes(broken)
