"""The frames that decide the joint's type: even where the motion is, few of a rest."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew import analyze, simulate_trial
from elbowscrew.choices import SimulatedJointType
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.deciding_frames import deciding_frames


def poses(angle_deg: Float) -> Float:
    return dual_quat_from_screw(np.radians(angle_deg), 0.0 * angle_deg, [0.6, 0.0, 0.8], [0.0, 0.1, 0.0])


def test_a_steady_motion_is_spread_evenly() -> None:
    rows = deciding_frames(poses(np.linspace(0.0, 120.0, 1001)), 201)
    assert rows.tolist() == np.arange(0, 1001, 5).tolist()


@pytest.mark.parametrize("at", [0.0, 40.0, 43.1, 120.0])
def test_a_rest_has_half_of_them_at_most_wherever_it_is(at: float) -> None:
    rng = np.random.default_rng(1)
    sweep = np.concatenate([np.linspace(0.0, 120.0, 300), np.linspace(120.0, 0.0, 300)])
    rest = at + rng.normal(0.0, 0.1, 30_000)
    rows = deciding_frames(poses(np.concatenate([rest, sweep])), 200)
    assert rows.size >= 190
    assert np.all(np.diff(rows) > 0)
    assert 0.45 <= np.mean(rows < rest.size) <= 0.55
    moved = np.sort(np.concatenate([rest, sweep])[rows[rows >= rest.size]])
    assert np.diff(moved).max() < 15.0  # the poses of the rest are thinned with it


def test_poses_that_are_all_the_same_are_spread_in_time() -> None:
    assert deciding_frames(poses(np.zeros(1000)), 10).tolist() == np.linspace(0, 999, 10).astype(int).tolist()
    assert deciding_frames(poses(np.array([0.0, 1.0])), 10).tolist() == [0, 1]


@pytest.mark.parametrize("joint", ["hinge", "two-axes", "ball"])
def test_a_long_rest_does_not_change_the_type(joint: SimulatedJointType) -> None:
    trial = simulate_trial(
        frames=101,
        inversion=50,
        repetitions=4,
        rest_before_s=40.0,
        rest_after_s=40.0,
        marker_noise_mm=0.3,
        seed=3,
        proximal="moving",
        joint_type=joint,
        pronation_deg=60.0 if joint == "two-axes" else None,
    )
    found = analyze(trial.recording).joint_type
    assert found is not None
    assert found.type == joint.replace("-", "_")
