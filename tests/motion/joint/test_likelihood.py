"""Fits of every type end where the likelihood is largest, wherever they start."""

from __future__ import annotations

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint, inverse_left_jacobian
from elbowscrew.motion.joint.fitting import Fitted, fit_type
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, fit_mechanism, refined, settled
from elbowscrew.motion.joint.poses import Poses

KINDS: tuple[Fitted, ...] = ("rigid", "hinge", "screw_hinge", "two_axes", "ball")


def moved(kind: Fitted, seed: int, share: float = 1.0) -> Poses:
    """Poses with 1 deg and 2 mm of noise, the cluster on the skin, or a share of both."""
    rng = np.random.default_rng(seed)
    exact = {
        "rigid": lambda: mj.rigid(120, rng),
        "hinge": lambda: mj.hinge(120, 110.0, rng),
        "screw_hinge": lambda: mj.hinge(120, 110.0, rng, pitch=0.01),
        "two_axes": lambda: mj.two_axes(120, (120.0, 80.0), 80.0, 0.01, rng),
        "ball": lambda: mj.ball(120, 70.0, rng),
    }[kind]().poses
    return Poses.of(*mj.noisy(mj.with_skin(exact, rng, 4.0 * share, 0.005 * share), rng, share, 2e-3 * share))


def own_steps(fit: Fit[Mechanism]) -> Float:
    return np.zeros((len(fit.square), fit.own_count))


def cost(mechanism: Mechanism, poses: Poses) -> float:
    residual = mechanism.linear(poses.joint).residual
    return float(np.sum((poses.whitener @ adjoint(mechanism.residual_frame) @ residual[..., None]) ** 2))


@pytest.mark.parametrize("kind", KINDS)
def test_no_number_of_a_fit_lowers_its_cost(kind: Fitted) -> None:
    """By central differences; without the Jacobian of the residual, fits were off by up to a fifth of a deviation."""
    poses = moved(kind, 31)
    fit = refined(fit_type(kind, poses), poses)
    assert cost(fit.mechanism, poses) == pytest.approx(fit.cost, rel=1e-12)
    deviation = 1.0 / np.sqrt(np.diag(fit.information))
    slopes = []
    for step in 1e-3 * np.diag(deviation):
        ahead, behind = (cost(fit.mechanism.moved(s, own_steps(fit)), poses) for s in (step, -step))
        slopes.append((ahead - behind) / 2e-3)
    for k in range(fit.own_count):
        for frame in (0, 60, 119):
            own = own_steps(fit)
            own[frame, k] = 1e-5
            none = np.zeros(fit.mechanism.shared_count)
            ahead, behind = (cost(fit.mechanism.moved(none, s * own), poses) for s in (1.0, -1.0))
            slopes.append((ahead - behind) / 2e-5 * np.sqrt(fit.own_covariance[frame, k, k]))
    assert np.abs(slopes).max() < 1e-5


@pytest.mark.parametrize("kind", KINDS)
def test_fits_from_three_starts_are_one(kind: Fitted) -> None:
    """Also where the own numbers start far away, so that the first steps raise what they are expected to leave."""
    poses = moved(kind, 32)
    fit = fit_type(kind, poses)
    deviation = 1.0 / np.sqrt(np.diag(fit.information))
    rng = np.random.default_rng(33)
    ends = []
    for size in (0.0, 1.0, 5.0):
        start = fit.mechanism.moved(size * deviation * rng.normal(size=deviation.size), own_steps(fit))
        found = refined(fit_mechanism(start.placed(poses.joint), poses), poses).mechanism
        model = dq.multiply(poses.joint, dq.exp(-0.5 * _in_distal(found, poses)))
        ends.append(model * np.sign(model[:, :1]))
    for end in ends[1:]:
        assert np.abs(end - ends[0]).max() < 1e-12


def _in_distal(mechanism: Mechanism, poses: Poses) -> Float:
    """What the model leaves of each pose, as a twist in the distal body's own frame."""
    return mechanism.linear(poses.joint).residual @ adjoint(mechanism.residual_frame).T


def test_a_residual_changes_as_its_jacobian_says() -> None:
    rng = np.random.default_rng(34)
    for size, error in ((0.0, 1e-9), (0.3, 1e-8), (1.0, 2e-5)):
        twist = size * np.concatenate([mj.unit(rng.normal(size=3)), mj.unit(rng.normal(size=3))])
        columns = []
        for step in np.eye(6) * 1e-5:
            ends = [2.0 * dq.log(dq.multiply(dq.exp(0.5 * s * step), dq.exp(0.5 * twist))) for s in (1.0, -1.0)]
            columns.append((ends[0] - ends[1]) / 2e-5)
        assert inverse_left_jacobian(twist) == pytest.approx(np.stack(columns, axis=1), abs=error)
        assert inverse_left_jacobian(twist) @ twist == pytest.approx(twist)


@pytest.mark.parametrize("kind", ["hinge", "two_axes"])
def test_angles_follow_the_axes_as_the_fit_says(kind: Fitted) -> None:
    """Against angles that are found anew with the axes moved; to first order in what the joint leaves."""
    poses = moved(kind, 35, 1e-3)
    fit = refined(fit_type(kind, poses), poses)
    for k, step in enumerate(1e-5 * np.eye(fit.mechanism.shared_count)):
        ends = []
        for sign in (1.0, -1.0):
            start = fit.mechanism.moved(sign * step, sign * fit.own_by_shared[..., k] * 1e-5)
            ends.append(settled(start, poses, rounds=6).mechanism.frames)
        change = (ends[0] - ends[1]) / 2e-5
        turns = np.round((change - fit.own_by_shared[..., k]) * 2e-5 / (2.0 * np.pi)) * 2.0 * np.pi / 2e-5
        assert change - turns == pytest.approx(fit.own_by_shared[..., k], abs=1e-3)
