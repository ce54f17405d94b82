"""A joint as a function of its own angles: it makes the poses that the truth says, and gives the angles back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew import analyze, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.coordinates import expressed_angles, expressed_joint, joint_angles_of, joint_poses

TRIALS: dict[str, dict[str, Any]] = {
    "hinge": {"joint_type": "hinge", "top_deg": 200.0},
    "screw_hinge": {"joint_type": "screw-hinge", "slide_mm": 25.0, "side": "left"},
    "two_axes": {"joint_type": "two-axes", "side": "left", "proximal": "moving"},
    "ball": {"joint_type": "ball", "joint": "shoulder", "top_deg": 110.0},
}
SHARED = {"hinge": (9, 1), "screw_hinge": (10, 1), "two_axes": (12, 2), "ball": (6, 3)}


def known(kind: str) -> tuple[Any, Float]:
    """Analysis of exact poses, and the true angles (N, k), rad; a ball's in the proximal body's axes."""
    trial = simulate_trial(frames=160, inversion=70, marker_noise_mm=0.0, **TRIALS[kind])
    columns = [np.radians(values) for values in trial.truth["joint_angles"].values()]
    return analyze(trial.recording), np.stack(columns, axis=1)


@pytest.mark.parametrize("kind", TRIALS)
def test_a_joint_at_its_true_angles_is_the_motion(kind: str) -> None:
    analysis, angle = known(kind)
    joint = analysis.joint_type.coordinates
    assert (joint.type, joint.shared, joint.angles) == (kind, *SHARED[kind])
    assert joint.end == pytest.approx([1, 0, 0, 0, 0, 0, 0, 0], abs=1e-9)  # it fits perfectly
    back = dq.conjugate(analysis.joint.reference)
    made = joint_poses(joint, expressed_angles(joint, angle, back))
    sign = np.sign(np.sum(made[:, :4] * analysis.displacement[:, :4], axis=1))[:, None]
    assert sign * made == pytest.approx(analysis.displacement, abs=1e-9)
    assert np.abs(np.diff(made[:, :4], axis=0)).max() < 0.2  # signs go on with the angles


@pytest.mark.parametrize("kind", TRIALS)
def test_angles_of_poses_are_the_true_ones(kind: str) -> None:
    analysis, angle = known(kind)
    joint = analysis.joint_type.coordinates
    poses = analysis.displacement.copy()
    poses[20:25] = np.nan
    covariance = np.diag([1e-6] * 3 + [1e-7] * 3)
    found = joint_angles_of(joint, poses, lambda rows: np.broadcast_to(covariance, (rows.size, 6, 6)), 0)
    expected = expressed_angles(joint, angle, dq.conjugate(analysis.joint.reference))
    assert np.isnan(found[20:25]).all()
    good = np.delete(np.arange(160), np.s_[20:25])
    assert found[good] == pytest.approx(expected[good], abs=1e-7)


def test_both_signs_of_the_series_give_the_same_angles() -> None:
    for kind in TRIALS:
        analysis, _ = known(kind)
        joint = analysis.joint_type.coordinates
        one, other = (
            joint_angles_of(joint, sign * analysis.displacement, lambda rows: np.tile(np.eye(6), (rows.size, 1, 1)), 0)
            for sign in (1.0, -1.0)
        )
        assert one == pytest.approx(other, abs=1e-12), kind


@pytest.mark.parametrize("kind", TRIALS)
def test_a_joint_written_in_another_frame_moves_as_the_same_joint(kind: str) -> None:
    analysis, angle = known(kind)
    joint = analysis.joint_type.coordinates
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_quat()
    change = dq.dual_quat_from_pose(rotation[[3, 0, 1, 2]], [0.2, -0.4, 1.3])
    moved = joint_poses(expressed_joint(joint, change), expressed_angles(joint, angle, change))
    expected = dq.multiply(dq.multiply(change, joint_poses(joint, angle)), dq.conjugate(change))
    assert moved == pytest.approx(expected, abs=1e-12)


def test_the_end_takes_up_a_reference_that_does_not_fit() -> None:
    """With noise the reference pose is off the joint: at zero angles the joint is as near it as it can come."""
    trial = simulate_trial(joint_type="two-axes", marker_noise_mm=0.5, frames=160, inversion=70, seed=2)
    analysis = analyze(trial.recording)
    assert analysis.joint_type is not None
    joint = analysis.joint_type.coordinates
    assert joint is not None
    _, place = dq.pose_from_dual_quat(joint.end)
    assert 1e-5 < np.linalg.norm(place) < 5e-3
    at = joint_poses(joint, np.zeros((1, 2)))
    assert at[0] == pytest.approx(joint.end, abs=1e-15)
    # Over all frames the joint leaves no more at its reference than elsewhere.
    assert analysis.joint_angles is not None
    made = joint_poses(joint, analysis.joint_angles.angle)
    left = dq.log(dq.canonical(dq.multiply(dq.conjugate(made), analysis.displacement)))
    assert np.degrees(2.0 * np.linalg.norm(left[:, :3], axis=1)).max() < 4.0


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_the_end_is_a_small_rotation_whichever_way_it_goes(seed: int) -> None:
    """Its sign is the one whose scalar part is positive; that of no other part says anything."""
    trial = simulate_trial(joint_type="two-axes", marker_noise_mm=0.5, frames=120, inversion=60, seed=seed)
    joint_type = analyze(trial.recording).joint_type
    assert joint_type is not None
    assert joint_type.coordinates is not None
    assert joint_type.coordinates.end[0] > 0.99
