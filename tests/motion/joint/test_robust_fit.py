"""Fits that weigh outliers down: where they end hangs on the poses alone."""

from __future__ import annotations

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.fitting import Fitted, fit_type
from elbowscrew.motion.joint.likelihood import Mechanism, fit_mechanism
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.robust_fit import fit_robustly, refined_robustly
from elbowscrew.motion.joint.simple_types import Ball


def with_skin_and_outliers(kind: Fitted, seed: int) -> Poses:
    """Residuals that go with the motion leave many frames half in and half out of the weights."""
    rng = np.random.default_rng(seed)
    exact = {
        "hinge": lambda: mj.hinge(300, 90.0, rng),
        "two_axes": lambda: mj.two_axes(300, (110.0, 70.0), 85.0, 0.01, rng),
        "ball": lambda: mj.ball(300, 60.0, rng),
    }[kind]()
    errors = rng.normal(size=(300, 6)) * np.repeat([0.15, 0.04], 3)
    errors[rng.random(300) >= 0.1] = 0.0
    moved = dq.multiply(mj.with_skin(exact.poses, rng, 4.0, 0.005), dq.exp(0.5 * errors))
    return Poses.of(*mj.noisy(moved, rng, 0.1, 2e-4))


def places(mechanism: Mechanism) -> Float:
    """Numbers of both lines, or of the center in both bodies."""
    both = [mechanism.proximal, mechanism.distal]  # type: ignore[attr-defined]
    return np.concatenate(both if isinstance(mechanism, Ball) else [dq.transform_lines(pose, Z_LINE) for pose in both])


@pytest.mark.parametrize(("kind", "seed"), [("hinge", 3), ("two_axes", 11), ("ball", 10)])
def test_robust_fits_from_two_starts_are_one(kind: Fitted, seed: int) -> None:
    poses = with_skin_and_outliers(kind, seed)
    plain = fit_type(kind, poses)
    away = np.random.default_rng(5).normal(0.0, 0.02, plain.mechanism.shared_count)
    elsewhere = plain.mechanism.moved(away, np.zeros(plain.own_by_shared.shape[:2]))
    starts = [plain, fit_mechanism(elsewhere, poses, iterations=1)]
    rough = [fit_robustly(start, poses) for start in starts]
    fine = [refined_robustly(fit, poses) for fit in rough]
    assert np.abs(places(rough[0].mechanism) - places(rough[1].mechanism)).max() > 1e-10  # some rounds are not enough
    assert places(fine[0].mechanism) == pytest.approx(places(fine[1].mechanism), abs=1e-12)
    assert places(fine[0].mechanism) == pytest.approx(places(rough[0].mechanism), abs=1e-4)


def test_poses_that_each_joint_meets_stay_as_they_are() -> None:
    """A ball of orientations alone leaves nothing that could be weighed."""
    rng = np.random.default_rng(6)
    seen, covariance = mj.noisy(mj.ball(60, 60.0, rng).poses, rng, 0.1, 2e-4)
    covariance = covariance.copy()
    covariance[:, :3, 3:] = covariance[:, 3:, :3] = 0.0
    covariance[:, 3:, 3:] = np.inf
    fit = fit_type("ball", Poses.of(seen, covariance))
    for found in (fit_robustly(fit, fit_poses := Poses.of(seen, covariance)), refined_robustly(fit, fit_poses)):
        assert found is fit
