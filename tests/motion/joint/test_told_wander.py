"""An axis that wanders as an analysis tells it: against the angle, and its mean in each frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cluster_noise import NEAR, Hinge, seen, wandering, white
from trials import LINE, START

from elbowscrew import Settings, analyze, simulate_trial
from elbowscrew.choices import ExpressIn
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import JointAxis, JointMotion, PoseNoise
from elbowscrew.motion.joint.joint_axis import estimate_joint_axis
from elbowscrew.motion.screws.pose_noise import JointNoise
from elbowscrew.results.joint_summary import joint_summary

TOP, TURN, SHIFT = np.radians(120.0), np.radians(6.0), 4e-3
LAB = dq.dual_quat_from_pose(qn.quat_from_rotation_vector([0.3, -0.2, 0.5]), [0.4, 0.1, 1.2])
AT = 75  # the reference, where the joint is flexed to a quarter of its range


def true_line(angle: Float) -> Float:
    """The line (..., 6) in the proximal body when the joint is flexed so far, as `wandering` makes it."""
    share = np.asarray(angle)[..., None] / TOP - 0.5
    across = np.cross(LINE[:3], [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    point = np.cross(LINE[:3], LINE[3:]) + 0.1 * LINE[:3] + SHIFT * share * across
    turn = TURN * share
    h = np.cos(turn) * LINE[:3] + np.sin(turn) * np.cross(across, LINE[:3])
    return np.concatenate([h, np.cross(point, h)], axis=-1)


def told(hinge: Hinge, express_in: ExpressIn, seed: int, size: float) -> JointAxis:
    case = seen(hinge, white(size)(hinge, np.random.default_rng(seed)))
    count = len(case.joint)
    assert hinge.exact is not None or hinge.top_deg
    joint = JointMotion(
        dual_quat_proximal_distal=case.joint,
        measured=np.ones(count, dtype=bool),
        filled=np.zeros(count, dtype=bool),
        reference=case.joint[AT],
        reference_row=AT,
        lowpass_hz=None,
        dual_quat_lab_proximal=LAB,
    )
    proximal, distal = case.noise
    assert isinstance(distal, PoseNoise)
    start = dq.transform_lines(dq.conjugate(joint.reference), true_line(0.5 * TOP))
    angle = hinge.angle - hinge.angle[AT]
    noise = JointNoise(proximal, distal, 1.0, 1.0)
    return estimate_joint_axis(joint, angle, start, noise, np.ones(count), express_in=express_in, robust=False).axis


def poses_of(hinge: Hinge) -> Float:
    assert hinge.exact is not None
    return hinge.exact


def away(found: Float, point: Float, truth: Float) -> tuple[float, float]:
    """Angle (rad) between a direction and a true line, with sense, and the distance (m) of a point from it."""
    sine = float(np.linalg.norm(np.cross(found, truth[:3])))
    return float(np.arctan2(sine, found @ truth[:3])), float(np.linalg.norm(np.cross(point, truth[:3]) - truth[3:]))


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_the_path_is_the_axis_of_the_moment_at_each_angle(express_in: ExpressIn) -> None:
    hinge = wandering(120.0, TURN, SHIFT)
    axis = told(hinge, express_in, 1, 2e-5)
    assert axis.wander is not None
    assert axis.wander.significant
    assert axis.path is not None
    first = hinge.angle[AT]
    frame = {"distal": dq.conjugate(poses_of(hinge)[AT]), "proximal": np.eye(8)[0], "lab": LAB}[express_in]
    # The angle is the fitted hinge's, which a shift of 4 mm leaves by a degree or two at this lever.
    assert axis.path.angle[0] == pytest.approx(TOP / 30.0 - first, abs=np.radians(2.0))
    assert axis.path.angle[-1] == pytest.approx(TOP * 29.0 / 30.0 - first, abs=np.radians(2.0))
    assert axis.path.frames.sum() == len(hinge.angle)
    assert axis.path.frames[0] > axis.path.frames[7]  # a joint that turns back is longest at the ends
    for angle, direction, point in zip(axis.path.angle, axis.path.direction, axis.path.point, strict=True):
        # At the joint, wherever the printed point is; one linear step of 6 deg and 4 mm.
        near = point + direction * (direction @ (dq.transform_points(frame, NEAR) - point))
        off = away(direction, near, dq.transform_lines(frame, true_line(angle + first)))
        assert off[0] < np.radians(0.2)
        assert off[1] < 4e-4
        assert abs(point @ direction) < 1e-12


@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_the_mean_is_that_of_the_path_and_in_each_body_of_its_own(express_in: ExpressIn) -> None:
    hinge = wandering(120.0, TURN, SHIFT)
    axis = told(hinge, express_in, 2, 2e-5)
    assert axis.mean_axis is not None
    assert axis.headline is axis.mean_axis
    line = axis.mean_axis.line
    frame = {"distal": dq.conjugate(poses_of(hinge)[AT]), "proximal": np.eye(8)[0], "lab": LAB}[express_in]
    middle = true_line(0.5 * TOP)
    assert away(line.direction, line.point, dq.transform_lines(frame, middle))[0] < np.radians(0.1)
    assert away(line.direction, line.point, dq.transform_lines(frame, middle))[1] < 2e-4
    assert away(line.direction_proximal, line.point_proximal, middle)[0] < np.radians(0.1)
    # In the distal body that moves, from the exact poses: the mean of the lines there over an even grid of angles.
    up = poses_of(hinge)[: len(hinge.angle) // 2]
    there = dq.transform_lines(dq.conjugate(up), true_line(hinge.angle[: len(up)]))
    grid = np.linspace(0.0, TOP, 200)
    mean = np.mean([[np.interp(a, hinge.angle[: len(up)], column) for column in there.T] for a in grid], axis=0)
    off = away(line.direction_distal, line.point_distal, mean / np.linalg.norm(mean[:3]))
    assert off[0] < np.radians(0.1)
    assert off[1] < 3e-4
    # The wander is large enough that the mean in the body is not the one at the reference.
    assert away(line.direction_distal, line.point_distal, dq.transform_lines(dq.conjugate(START), middle))[0] > 0.01


def test_the_mean_axis_and_the_size_are_within_their_errors() -> None:
    hinge = wandering(120.0, TURN, SHIFT)
    trials = 40
    held, sizes, wide = 0, [], []
    for seed in range(trials):
        axis = told(hinge, "proximal", 100 + seed, 2e-4)
        assert axis.mean_axis is not None
        assert axis.wander is not None
        off = away(axis.mean_axis.line.direction, axis.mean_axis.line.point, true_line(0.5 * TOP))
        held += off[0] <= axis.mean_axis.axis_cone
        sizes.append(axis.wander.tilt)
        wide.append(axis.wander.tilt_sd)
    assert held >= 34  # 38 of 40 at 95 %, less three standard deviations
    assert np.std(sizes) == pytest.approx(np.mean(wide), rel=0.4)
    assert np.mean(sizes) == pytest.approx(TURN, abs=np.radians(0.1))


def test_an_axis_that_stays_has_a_bound_and_no_path() -> None:
    analysis = analyze(simulate_trial(seed=5).recording)
    axis = analysis.joint_axis
    assert axis.wander is not None
    assert not axis.wander.significant
    assert axis.mean_axis is None
    assert axis.path is None
    assert axis.headline is axis.best
    found: Any = joint_summary(analysis)
    assert found["mean_axis"] is None
    assert found["wander"]["significant"] is False
    assert found["wander"]["size_deg"] < found["wander"]["unseen_deg"]
    assert found["wander"]["size_mm"] < found["wander"]["unseen_mm"]


def test_an_axis_that_drifts_is_told_with_its_mean() -> None:
    """The simulated line tilts by 12 deg in proportion to the angle."""
    analysis = analyze(simulate_trial(seed=6, axis_drift_deg=12.0).recording, Settings(express_in="proximal"))
    found: Any = joint_summary(analysis)
    assert found["wander"]["significant"] is True
    assert found["wander"]["size_deg"] > found["wander"]["unseen_deg"] > 0.0
    assert found["mean_axis"]["direction"] == found["mean_axis"]["direction_in_proximal"]
    assert 0.0 < found["mean_axis"]["axis_sd_deg"] < found["mean_axis"]["axis_cone95_deg"]
    path = analysis.joint_axis.path
    assert path is not None
    assert np.degrees(path.angle[0]) < np.degrees(path.angle[-1])
    ends = np.degrees(np.arccos(path.direction[0] @ path.direction[-1]))
    assert ends == pytest.approx(14.0 / 15.0 * found["wander"]["size_deg"], rel=0.05)
