"""Cuts of joints with two axes: on the angle about the first, whatever the second does meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from elbowscrew import Analysis, Settings, analyze, simulate_trial
from elbowscrew.simulate import SimulatedTrial


def natural(**more: Any) -> SimulatedTrial:
    """An elbow that flexes and pronates; it has its largest rotation before, or after, its largest flexion."""
    return simulate_trial(
        joint_type="two-axes", pronation_deg=60.0, rate_hz=100.0, frames=300, inversion=140, proximal="moving", **more
    )


def frames_of_inversion(analysis: Analysis) -> list[int]:
    return list(map(int, analysis.screw.frame[analysis.inversion_rows]))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_joint_of_two_axes_turns_back_where_its_first_angle_does(seed: int) -> None:
    trial = natural(seed=seed)
    true = int(np.argmax(np.abs(trial.truth["joint_angles"]["angle1_deg"])))
    analysis = analyze(trial.recording)
    assert analysis.joint_type is not None
    assert (analysis.joint_type.type, analysis.joint_type.status) == ("two_axes", "determined")
    assert analysis.repetitions.inversion_frame == pytest.approx([true], abs=2)


@pytest.mark.parametrize("trial", [natural(seed=4), natural(seed=5, repetitions=3), simulate_trial(repetitions=3)])
def test_keyframes_and_cycles_turn_back_at_the_same_frames(trial: SimulatedTrial) -> None:
    analysis = analyze(trial.recording)
    found = analysis.repetitions
    inner = np.round(0.5 * (found.end_frame[:-1] + found.start_frame[1:])).astype(int)
    assert frames_of_inversion(analysis) == pytest.approx(np.sort([*found.inversion_frame, *inner]), abs=1)
    assert set(found.inversion_frame) <= set(frames_of_inversion(analysis))


def test_a_filter_hardly_moves_the_cuts_of_two_axes() -> None:
    """The axes are of the filtered poses; what is cut is not filtered."""
    trial = natural(seed=6, repetitions=3)
    found = [analyze(trial.recording, Settings(lowpass_hz=lowpass)).repetitions for lowpass in (None, 4.0)]
    for name in ("start_time_s", "end_time_s"):
        assert getattr(found[1], name) == pytest.approx(getattr(found[0], name), abs=0.002)


@pytest.mark.parametrize("joint_type", ["two-axes", "hinge"])
def test_the_largest_angle_is_that_of_the_cycle(joint_type: str) -> None:
    trial = simulate_trial(joint_type=joint_type, repetitions=2, seed=2)
    analysis = analyze(trial.recording)
    found, frame = analysis.repetitions, analysis.screw.frame
    for k in range(found.number.size):
        inside = (frame >= found.start_frame[k]) & (frame <= found.end_frame[k])
        assert found.top_angle[k] == np.nanmax(analysis.screw.angle[inside])
