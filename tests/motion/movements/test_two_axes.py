"""Cuts of joints with two axes: on the angle about the first, whatever the second does meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from elbowscrew import Analysis, Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.choices import SimulatedJointType
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry.dual_quaternion import multiply
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
def test_the_largest_angle_is_that_of_the_cycle(joint_type: SimulatedJointType) -> None:
    trial = simulate_trial(joint_type=joint_type, repetitions=2, seed=2)
    analysis = analyze(trial.recording)
    found, frame = analysis.repetitions, analysis.screw.frame
    for k in range(found.number.size):
        inside = (frame >= found.start_frame[k]) & (frame <= found.end_frame[k])
        assert found.top_angle[k] == np.nanmax(analysis.screw.angle[inside])


def test_two_axes_are_cut_where_theta_turns_though_angle_1_has_the_other_sense() -> None:
    """Flexion goes from 45 down to 0 and then three times up to 93 deg, a little farther; theta, as far within 5 %, has
    the sense of its first excursion.
    """
    time = np.arange(561) / 100.0
    flexion = 46.5 + 46.5 * np.cos(np.pi * time / 0.8)
    first = time < 0.8
    flexion[first] = 22.5 + 22.5 * np.cos(np.pi * time[first] / 0.8)
    pronation = 15.0 * np.sin(2.0 * np.pi * time / 2.3)
    pose = multiply(
        dual_quat_from_screw(np.radians(flexion), 0.0 * time, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        dual_quat_from_screw(np.radians(pronation), 0.0 * time, [0.0, 1.0, 0.0], [0.01, 0.0, 0.0]),
    )
    pose = multiply(
        pose,
        dual_quat_from_screw(
            np.random.default_rng(1).normal(0.0, 1e-3, time.size), 0.0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]
        ),
    )
    body = RigidBody(name="Forearm", dual_quat_lab_body=pose, loss=np.zeros(time.size, dtype=np.uint8))
    found = analyze(Recording.from_bodies([body], rate_hz=100.0))
    assert found.joint_type is not None
    assert (found.joint_type.type, found.joint_type.status) == ("two_axes", "determined")
    assert np.cov(found.joint_type.angle[:, 0], found.sense.twist)[0, 1] < 0.0
    top = found.screw.angle[found.repetitions.inversion_frame - found.screw.frame[0]]
    assert (top > 0.5).all()
    for speed in (found.repetitions.outward_speed[1:], found.repetitions.back_speed[:-1]):
        assert np.degrees(speed) == pytest.approx(np.pi * 46.5 / 0.8, rel=0.1)
