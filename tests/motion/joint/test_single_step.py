"""An angle that only steps once is no certain joint's: a cluster that slips makes one."""

from __future__ import annotations

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew import Recording, RigidBody, analyze, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.single_step import single_step
from elbowscrew.motion.joint.typed import identify_joint


def stepped(count: int, deg: float, at: int, frames: int = 1, noise_deg: float = 0.1, seed: int = 0) -> Float:
    """An angle of so many frames that goes up within some frames, radians."""
    rise = np.clip((np.arange(count) - at + 0.5 * frames) / frames, 0.0, 1.0)
    return np.radians(deg * rise + np.random.default_rng(seed).normal(scale=noise_deg, size=count))


@pytest.mark.parametrize("frames", [1, 20])
@pytest.mark.parametrize("deg", [2.0, -5.0, 12.0, 24.0])
def test_one_step_is_seen_with_its_size_and_place(deg: float, frames: int) -> None:
    found = single_step(stepped(600, deg, 250, frames))
    assert found is not None
    assert np.degrees(found.size) == pytest.approx(abs(deg), abs=0.1)
    assert abs(found.row - 250) <= frames


@pytest.mark.parametrize("offset_deg", [-70.0, 40.0])
def test_a_step_may_be_anywhere_in_the_range(offset_deg: float) -> None:
    found = single_step(stepped(600, 5.0, 250) + np.radians(offset_deg))
    assert found is not None
    assert found.row == 250


@pytest.mark.parametrize(("noise_deg", "seen"), [(0.6, True), (0.9, False)])
def test_levels_keep_within_15_percent_of_the_step(noise_deg: float, seen: bool) -> None:
    assert (single_step(stepped(600, 5.0, 250, noise_deg=noise_deg)) is not None) == seen


@pytest.mark.parametrize(("frames", "seen"), [(50, True), (75, False)])
def test_no_more_than_a_twentieth_of_the_frames_are_on_the_way(frames: int, seen: bool) -> None:
    """Of 600: half of the passage lies between the quarters of the step."""
    assert (single_step(stepped(600, 10.0, 250, frames)) is not None) == seen


@pytest.mark.parametrize("at", [60, 150, 540])
def test_the_place_does_not_depend_on_how_long_the_levels_are(at: int) -> None:
    found = single_step(stepped(600, 5.0, at, noise_deg=0.5))
    assert found is not None
    assert abs(found.row - at) <= 1


def test_lost_frames_change_neither() -> None:
    angle = stepped(600, 5.0, 250)
    angle[::7], angle[240:245] = np.nan, np.nan
    found = single_step(angle)
    assert found is not None
    assert found.row in (250, 251, 252)
    assert np.degrees(found.size) == pytest.approx(5.0, abs=0.1)


TIME = np.linspace(0.0, 1.0, 600)


@pytest.mark.parametrize(
    "angle",
    [
        stepped(600, 40.0, 300),  # somebody turns once and holds it
        stepped(600, 5.0, 300) - stepped(600, 5.0, 450, seed=1),  # and back
        stepped(600, 5.0, 200) + stepped(600, 5.0, 400, seed=1),
        stepped(600, 5.0, 300, frames=300),
        stepped(600, 0.0, 300),
        np.radians(10.0) * np.sin(2.0 * np.pi * TIME),
        np.radians(10.0) * (1.0 - np.cos(np.pi * TIME)),
        np.radians(10.0) * np.sign(np.sin(6.0 * np.pi * TIME)),
        stepped(600, 1.0, 300, noise_deg=0.5),
        stepped(600, 5.0, 596),
        stepped(12, 5.0, 6),
        np.full(600, np.nan),
    ],
    ids=[
        "large",
        "back",
        "twice",
        "slow",
        "none",
        "sine",
        "once over all",
        "to and fro",
        "noise",
        "end",
        "few",
        "lost",
    ],
)
def test_what_moves_otherwise_is_no_single_step(angle: Float) -> None:
    assert single_step(angle) is None


@pytest.mark.parametrize("noise_known", [True, False])
def test_a_slip_makes_no_second_axis_that_is_determined(noise_known: bool) -> None:
    """5 deg and 8 mm, once: axis 2 was told within a third of a degree, where there is none."""
    rng = np.random.default_rng(2)
    hinge = mj.hinge(300, 100.0, rng)
    angle = np.radians(50.0) * (1.0 - np.cos(np.linspace(0.0, 8.0 * np.pi, 300)))
    exact = dq.multiply(mj.turned(angle, hinge.truth["axis1"]), hinge.poses[0])
    slip = dq.exp(0.5 * np.array([0.03, 0.07, -0.04, 0.005, -0.004, 0.005]))
    poses = np.concatenate([exact[:170], dq.multiply(exact[170:], slip)])
    seen, covariance = mj.noisy(poses, rng, 0.1, 2e-4)
    found = identify_joint(seen, covariance, seen[0], noise_known=noise_known)
    assert (found.type, found.status) == ("two_axes", "approximate")
    assert "angle 2 steps once, by " in found.reason
    assert found.two_axes is not None
    assert [line.determined for line in found.two_axes.lines] == [True, False]


def test_a_slip_of_a_rigid_pair_is_no_hinge_that_is_determined() -> None:
    """And the warning says where it is."""
    trial = simulate_trial(joint_type="hinge", frames=400, seed=3)
    arm, forearm = trial.recording.bodies
    still = np.repeat(forearm.dual_quat_lab_body[:1], 400, axis=0)
    rng = np.random.default_rng(5)
    jitter = dq.exp(0.5 * rng.normal(size=(400, 6)) * np.repeat([1e-3, 2e-4], 3))
    slip = np.where(np.arange(400)[:, None] < 150, 0.0, 0.5 * np.array([0.2, 0.05, -0.04, 0.005, -0.01, 0.015]))
    moved = dq.multiply(dq.multiply(still, dq.exp(slip)), jitter)
    arm_still = np.repeat(arm.dual_quat_lab_body[:1], 400, axis=0)
    bodies = [
        RigidBody(name=body.name, dual_quat_lab_body=poses, loss=body.loss)
        for body, poses in ((arm, arm_still), (forearm, moved))
    ]
    recording = Recording.from_bodies(bodies, rate_hz=100.0)
    analysis = analyze(recording)
    assert analysis.joint_type is not None
    assert analysis.joint_type.type in ("hinge", "screw_hinge")
    assert analysis.joint_type.status == "approximate"
    (told,) = (one.message for one in analysis.warnings if one.code == "steps-once")
    assert told.startswith("the joint's angle steps once, by 12 deg, and else stays, as where a cluster slips")
    assert f"the step is at frame {recording.frame[150]}:" in told
