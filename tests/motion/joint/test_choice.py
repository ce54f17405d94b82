"""What the choice of a type says where the motion is no joint's, or some of its poses are astray."""

from __future__ import annotations

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.choice import choose_type
from elbowscrew.motion.joint.likelihood import Poses


def astray(poses: Float, share: float, rng: np.random.Generator) -> Float:
    """Some of the poses leave their places by some 9 deg and 4 cm a component."""
    errors = rng.normal(size=(len(poses), 6)) * np.repeat([0.15, 0.04], 3)
    errors[rng.random(len(poses)) >= share] = 0.0
    return dq.multiply(poses, dq.exp(0.5 * errors))


@pytest.mark.parametrize("kind", ["two_axes", "ball"])
def test_a_joint_with_outliers_is_not_called_free(kind: str) -> None:
    rng = np.random.default_rng(4)
    exact = mj.ball(200, 60.0, rng) if kind == "ball" else mj.two_axes(200, (110.0, 70.0), 85.0, 0.01, rng)
    seen, covariance = mj.noisy(astray(exact.poses, 0.12, rng), rng, 0.1, 2e-4)
    poses = Poses.of(seen, covariance)
    plain, robust = (choose_type(poses, noise_known=True, robust=robust) for robust in (False, True))
    assert (plain.type, plain.status) == ("undetermined", None)
    assert "outliers" in plain.reason
    assert (robust.type, robust.status) == (kind, "determined")


def test_a_motion_that_no_joint_has_is_free_also_after_a_long_rest() -> None:
    rng = np.random.default_rng(5)
    exact = mj.free(200, 40.0, rng).poses
    rested = np.concatenate([np.repeat(exact[:1], 600, axis=0), exact])
    for moved in (exact, rested):
        seen, covariance = mj.noisy(moved, rng, 0.1, 2e-4)
        found = choose_type(Poses.of(seen, covariance), noise_known=True)
        assert (found.type, found.status) == ("free", "determined")
