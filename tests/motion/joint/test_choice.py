"""What the choice of a type says where the motion is no joint's, or some of its poses are astray."""

from __future__ import annotations

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.choice import choose_type
from elbowscrew.motion.joint.contest import Contest
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.typed import identify_joint


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


def with_angles(exact: mj.MovingJoint, angles: Float) -> Float:
    """The same two axes at other angles (F, 2)."""
    first, second = exact.truth["angles"][0]
    one, two = exact.truth["axis1"], exact.truth["axis2"]
    rest = dq.multiply(mj.turned(-first, one), dq.multiply(exact.poses[0], mj.turned(-second, two)))
    return dq.multiply(mj.turned(angles[:, 0], one), dq.multiply(rest, mj.turned(angles[:, 1], two)))


@pytest.mark.parametrize("noise_known", [True, False])
@pytest.mark.parametrize("ranges_deg", [(500.0, 60.0), (60.0, 500.0), (420.0, 400.0)])
@pytest.mark.parametrize("between", [85.0, 40.0])
def test_axes_that_turn_on_and_on_are_two_axes(
    ranges_deg: tuple[float, float], between: float, noise_known: bool
) -> None:
    """What winds and is known is no phantom of a hinge, whose two angles undo each other."""
    rng = np.random.default_rng(8)
    time = np.linspace(0.0, 2.0 * np.pi, 300)
    angles = np.radians(ranges_deg) * np.stack([0.5 - 0.5 * np.cos(time), 0.5 + 0.5 * np.sin(2.0 * time)], axis=1)
    exact = mj.two_axes(200, (90.0, 60.0), between, 0.03, rng)
    seen, covariance = mj.noisy(with_angles(exact, angles), rng, 0.1, 2e-4)
    found = identify_joint(seen, covariance, seen[0], noise_known=noise_known)
    assert (found.type, found.status) == ("two_axes", "determined")
    assert found.two_axes is not None
    assert np.degrees(mj.angle_between(found.two_axes.axis1.direction_proximal, exact.truth["axis1"])) < 0.2
    # Each angle but for its sense, and the second from wherever the first frame has it.
    for k in range(2):
        near = found.angle[:, k] - found.angle[0, k]
        told = near if near @ (angles[:, k] - angles[0, k]) > 0.0 else -near
        assert np.degrees(told) == pytest.approx(np.degrees(angles[:, k] - angles[0, k]), abs=4.0)


@pytest.mark.parametrize("turns", [1.0, 3.0])
def test_a_hinge_that_turns_on_and_on_stays_a_hinge(turns: float) -> None:
    rng = np.random.default_rng(9)
    exact = mj.hinge(200, 90.0, rng)
    angle = 2.0 * np.pi * turns * np.linspace(0.0, 1.0, 300)
    poses = dq.multiply(mj.turned(angle, exact.truth["axis1"]), exact.poses[0])
    seen, covariance = mj.noisy(poses, rng, 0.1, 2e-4)
    for noise_known in (True, False):
        found = choose_type(Poses.of(seen, covariance), noise_known=noise_known)
        assert (found.type, found.status) == ("hinge", "determined")


@pytest.mark.parametrize("noise_known", [True, False])
@pytest.mark.parametrize("turns", [3, 6])
def test_a_circumduction_is_that_of_a_ball(noise_known: bool, turns: int) -> None:
    """Two axes that wind against each other do the same, six numbers more and no joint of a body."""
    rng = np.random.default_rng(6)
    around = np.linspace(0.0, 2.0 * np.pi * turns, 400)
    vector = np.radians(25.0) * np.stack([np.cos(around), 0.0 * around, np.sin(around)], axis=1)
    turned = qn.quat_from_rotation_vector(vector)
    center, distal = np.array([0.03, -0.05, 0.08]), np.array([0.0, 0.25, 0.02])
    exact = dq.dual_quat_from_pose(turned, center - qn.rotate(turned, distal))
    seen, covariance = mj.noisy(exact, rng, 0.1, 2e-4)
    found = identify_joint(seen, covariance, seen[0], noise_known=noise_known)
    assert (found.type, found.status) == ("ball", "determined")
    assert found.ball is not None
    assert np.linalg.norm(found.ball.center_proximal - center) < 1e-3


@pytest.mark.parametrize("noise_known", [True, False])
def test_soft_tissue_on_a_long_lever_makes_no_free_joint(noise_known: bool) -> None:
    """A knee's clusters, 25 cm from it, that turn on their bones by 6 deg leave more than 12 mm of every type."""
    rng = np.random.default_rng(7)
    exact = mj.hinge(400, 100.0, rng)
    apart = dq.dual_quat_from_pose([1.0, 0.0, 0.0, 0.0], [0.0, 0.25, 0.0])
    waves = np.sin(np.linspace(0.0, 9.0, 400)[:, None] * rng.uniform(1.0, 3.0, 6) + rng.uniform(0.0, 6.0, 6))
    skin = dq.exp(0.5 * waves * np.repeat([np.radians(6.0), 0.009], 3))
    seen, covariance = mj.noisy(dq.multiply(dq.multiply(exact.poses, apart), skin), rng, 0.1, 2e-4)
    # Stated with skin in it, as markers' residuals have it, but not all of it.
    told = covariance + 0.35 * np.diag(np.repeat([np.radians(6.0) ** 2, 0.009**2], 3)) if noise_known else covariance
    found = choose_type(Poses.of(seen, told), noise_known=noise_known)
    assert min(one.residual_translation for one in found.candidates if one.valid) > 0.012
    assert found.type in ("hinge", "two_axes") if noise_known else (found.type, found.status) == ("undetermined", None)
    assert noise_known or found.reason.endswith("a small part of what moves, as skin on a long lever leaves it")


def test_what_goes_a_long_way_has_no_skin_of_100_mm() -> None:
    """A boat on a circle of ten meters that leaves a decimeter: 1 % of its way, but no joint's."""
    rng = np.random.default_rng(3)
    exact = mj.hinge(300, 180.0, rng).poses
    away = dq.dual_quat_from_pose([1.0, 0.0, 0.0, 0.0], [0.0, 10.0, 0.0])
    shift = 0.15 * np.sin(np.linspace(0.0, 9.0, 300)[:, None] * rng.uniform(1.0, 3.0, 3) + rng.uniform(0.0, 6.0, 3))
    off = dq.dual_quat_from_pose(np.tile([1.0, 0.0, 0.0, 0.0], (300, 1)), shift)
    seen, covariance = mj.noisy(dq.multiply(dq.multiply(exact, away), off), rng, 0.1, 2e-4)
    found = choose_type(Poses.of(seen, covariance), noise_known=False)
    assert (found.type, found.status) == ("free", "determined")


def test_a_joint_that_some_types_come_near_is_not_free() -> None:
    """A ball that hardly turns, in much noise: of a rigid joint it is 20 mm off, of others not."""
    rng = np.random.default_rng(0)
    seen, covariance = mj.noisy(mj.ball(200, 28.0, rng).poses, rng, 2.1, 2.5e-3)
    for noise_known in (True, False):
        found = choose_type(Poses.of(seen, covariance), noise_known=noise_known)
        left = {one.type: one.residual_translation for one in found.candidates if one.valid}
        assert left["rigid"] > 0.02
        assert min(left.values()) < 0.012
        assert (found.type, found.status) == ("ball", "determined")


@pytest.mark.parametrize("along", [0, 1, 2])
def test_outliers_are_few_frames_whichever_way_they_lie(along: int) -> None:
    rng = np.random.default_rng(10)
    exact = mj.ball(200, 60.0, rng)
    errors = np.zeros((200, 6))
    errors[7::50, 3 + along] = 0.2 * np.array([1.0, -1.0, 1.0, -1.0])
    seen, covariance = mj.noisy(dq.multiply(exact.poses, dq.exp(0.5 * errors)), rng, 0.1, 2e-4)
    contest = Contest(Poses.of(seen, covariance), noise_known=True, robust=False)
    assert contest.left_by_few_frames("ball")
    # A center that goes to and fro the same way is off in all of them.
    errors[:, 3 + along] = 0.2 * np.sin(np.linspace(0.0, 20.0, 200))
    seen, covariance = mj.noisy(dq.multiply(exact.poses, dq.exp(0.5 * errors)), rng, 0.1, 2e-4)
    assert not Contest(Poses.of(seen, covariance), noise_known=True, robust=False).left_by_few_frames("ball")


def test_a_motion_without_a_joint_has_no_angles() -> None:
    rng = np.random.default_rng(11)
    seen, covariance = mj.noisy(mj.free(100, 40.0, rng).poses, rng, 0.1, 2e-4)
    found = identify_joint(seen, covariance, seen[0], noise_known=True)
    assert found.type == "free"
    assert not found.has_angles
    for empty in (found.angle, found.angle_sd, found.residual_rotation, found.residual_translation):
        assert empty.shape == (0,) * empty.ndim
