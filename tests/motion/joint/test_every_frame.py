"""The joint's own angles in every frame: against the motion they were made with, and with honest error bars."""

from __future__ import annotations

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint import every_frame
from elbowscrew.motion.joint.every_frame import Everywhere, inverse_jacobian, numbers_everywhere
from elbowscrew.motion.joint.fitting import Fitted, fit_type
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.typed import identify_joint


def moved(kind: str, count: int, seed: int) -> tuple[Float, Float, Float]:
    """Exact poses, noisy ones, and the covariances of these."""
    rng = np.random.default_rng(seed)
    exact = {
        "hinge": lambda: mj.hinge(count, 110.0, rng),
        "two_axes": lambda: mj.two_axes(count, (120.0, 80.0), 80.0, 0.01, rng),
        "ball": lambda: mj.ball(count, 70.0, rng),
    }[kind]().poses
    return exact, *mj.noisy(exact, rng, 0.1, 2e-4)


def everywhere(joint: Float, covariance: Float, reference: Float | None = None) -> Everywhere:
    return Everywhere(joint, lambda rows: covariance[rows], np.ones(len(joint)), reference)


@pytest.mark.parametrize("kind", ["hinge", "two_axes", "ball"])
def test_standard_deviations_hold_what_frame_and_reference_err(kind: Fitted) -> None:
    """Errors against the exact angles, over trials: each has a reference of its own, whose error all frames share."""
    scaled = []
    for seed in range(30):
        exact, seen, covariance = moved(kind, 90, 100 + seed)
        mechanism = fit_type(kind, Poses.of(exact, covariance)).mechanism
        noise_free = numbers_everywhere(mechanism, everywhere(exact, covariance), exact[0])
        found = numbers_everywhere(mechanism, everywhere(seen, covariance, covariance[0]), seen[0])
        far = np.linalg.norm(noise_free.angle, axis=1) < 3.0
        scaled.append(((found.angle - noise_free.angle) / found.angle_sd)[10:][far[10:]])
    assert np.sqrt(np.mean(np.concatenate(scaled) ** 2)) == pytest.approx(1.0, abs=0.12)


def test_long_trials_have_the_angles_of_short_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in ("hinge", "two_axes", "ball"):
        _, seen, covariance = moved(kind, 6000, 5)
        mechanism = fit_type(kind, Poses.of(seen[::30], covariance[::30])).mechanism
        frames = everywhere(seen, covariance, covariance[0])
        settled = numbers_everywhere(mechanism, frames, seen[0])
        with monkeypatch.context() as capped:
            capped.setattr(every_frame, "_MOST_SETTLED", 1500)
            near = numbers_everywhere(mechanism, frames, seen[0])
        assert np.abs((near.angle - settled.angle) / settled.angle_sd).max() < 0.1, kind
        assert near.angle_sd == pytest.approx(settled.angle_sd, rel=0.02), kind
        assert near.residual_rotation == pytest.approx(settled.residual_rotation, abs=1e-4), kind
        assert near.residual_translation == pytest.approx(settled.residual_translation, abs=1e-5), kind


def test_blocks_and_gaps_leave_no_turn_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three turns of a crank, some frames without a pose, looked at eleven frames at a time."""
    rng = np.random.default_rng(8)
    line = mj.line(mj.unit(rng.normal(size=3)), rng.normal(0.0, 0.1, 3))
    angle = np.linspace(0.0, 6.0 * np.pi, 200)
    poses = dq.multiply(mj.turned(angle, line), mj.rest_pose(rng))
    poses[rng.random(200) < 0.5] *= -1.0
    covariance = np.broadcast_to(np.diag([1e-6] * 3 + [1e-8] * 3), (200, 6, 6))
    mechanism = fit_type("hinge", Poses.of(poses, covariance)).mechanism
    poses[60:70] = np.nan
    monkeypatch.setattr(every_frame, "_BLOCK", 11)
    found = numbers_everywhere(mechanism, everywhere(poses, covariance), poses[0])
    seen = np.isfinite(found.angle[:, 0])
    assert np.flatnonzero(~seen).tolist() == list(range(60, 70))
    turned = (found.angle[:, 0] - found.angle[0, 0]) * np.sign(found.angle[20, 0] - found.angle[0, 0])
    assert turned[seen] == pytest.approx(angle[seen], abs=1e-9)


def test_a_rotation_vector_grows_as_the_jacobian_says() -> None:
    rng = np.random.default_rng(2)
    for size in (0.0, 1e-9, 0.2, 0.3, 1.0, 3.0, 3.141):
        vector = size * mj.unit(rng.normal(size=3))
        columns = []
        for step in np.eye(3) * 1e-6:
            ends = [
                2.0 * dq.log(dq.canonical(dq.multiply(_turn(sign * step), _turn(vector))))[:3] for sign in (1.0, -1.0)
            ]
            columns.append((ends[0] - ends[1]) / 2e-6)
        if size < 3.1:  # beyond, a step crosses half a turn
            assert inverse_jacobian(vector[None])[0] == pytest.approx(np.stack(columns, axis=1), abs=1e-8), size
        assert np.isfinite(inverse_jacobian(vector[None])).all()


def _turn(vector: Float) -> Float:
    return np.concatenate([qn.quat_from_rotation_vector(vector), np.zeros(4)])


def test_a_filter_narrows_the_error_bars_and_unknown_noise_takes_them_from_the_residuals() -> None:
    exact, seen, covariance = moved("hinge", 300, 9)
    whole, quarter = (
        identify_joint(
            seen,
            covariance,
            exact[0],
            noise_known=True,
            forced="hinge",
            everywhere=Everywhere(seen, lambda rows: covariance[rows], np.full(300, gain)),
        )
        for gain in (1.0, 0.25)
    )
    assert quarter.angle_sd == pytest.approx(0.5 * whole.angle_sd)
    told = identify_joint(seen, covariance, exact[0], noise_known=True, forced="hinge")
    untold = identify_joint(seen, 100.0 * covariance, exact[0], noise_known=False, forced="hinge")
    assert untold.angle_sd == pytest.approx(told.angle_sd, rel=0.1)


def test_a_long_trial_of_a_rigid_joint_has_residuals_and_no_angles(monkeypatch: pytest.MonkeyPatch) -> None:
    """It ended in an error where frames are taken by their neighbors, which a joint without angles does not have."""
    rng = np.random.default_rng(4)
    seen, covariance = mj.noisy(np.tile(mj.rest_pose(rng), (3000, 1)), rng, 0.1, 2e-4)
    mechanism = fit_type("rigid", Poses.of(seen[::30], covariance[::30])).mechanism
    monkeypatch.setattr(every_frame, "_MOST_SETTLED", 1500)
    found = numbers_everywhere(mechanism, everywhere(seen, covariance), seen[0])
    assert found.angle.shape == (3000, 0)
    noise = np.sqrt(np.trace(covariance[:, :3, :3], axis1=1, axis2=2).mean())
    assert np.sqrt(np.mean(found.residual_rotation**2)) == pytest.approx(noise, rel=0.05)
