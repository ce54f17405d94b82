"""Which body is called proximal changes no axis and no cone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import moving_joints as mj
import numpy as np
import pytest

from elbowscrew import Analysis, Recording, Settings, analyze, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.starts import find_two_axes


def analyzed(recording: Recording, proximal: str, distal: str, express_in: str) -> Analysis:
    return analyze(recording, Settings(proximal=proximal, distal=distal, express_in=express_in, joint="elbow"))


def off(one: Float, other: Float) -> float:
    """Angle between two lines without a sense, rad."""
    return float(np.arcsin(min(1.0, float(np.linalg.norm(np.cross(one, other))))))


def test_swapped_roles_give_the_same_hinge_and_cone() -> None:
    recording = simulate_trial(joint_type="hinge", proximal="moving", frames=200, inversion=95, seed=3).recording
    arm, forearm = (body.name for body in recording.bodies)
    one = analyzed(recording, arm, forearm, "distal").joint_axis.headline
    two = analyzed(recording, forearm, arm, "proximal").joint_axis.headline
    assert one is not None
    assert two is not None
    assert off(one.line.direction, two.line.direction) < 1e-5
    assert two.axis_cone == pytest.approx(one.axis_cone, rel=0.02)
    assert two.line.point == pytest.approx(one.line.point, abs=1e-5)
    assert two.point_radius == pytest.approx(one.point_radius, rel=0.02)


def test_swapped_roles_exchange_the_two_axes() -> None:
    recording = simulate_trial(joint_type="two-axes", proximal="moving", frames=200, inversion=95, seed=3).recording
    arm, forearm = (body.name for body in recording.bodies)
    one = analyzed(recording, arm, forearm, "distal").joint_type
    two = analyzed(recording, forearm, arm, "distal").joint_type
    assert one is not None
    assert two is not None
    assert one.two_axes is not None
    assert two.two_axes is not None
    for mine, theirs in ((one.two_axes.axis1, two.two_axes.axis2), (one.two_axes.axis2, two.two_axes.axis1)):
        assert off(mine.direction_distal, theirs.direction_proximal) < 1e-3
        assert theirs.axis_cone == pytest.approx(mine.axis_cone, rel=0.1)
    assert two.two_axes.angle_between.value == pytest.approx(one.two_axes.angle_between.value, abs=1e-3)


@pytest.mark.parametrize("jitter", [0.0, 1e-7, 1e-6])
@pytest.mark.parametrize("stated", [{}, {"marker_noise_mm": 0.2}, {"noise": "still"}])
def test_a_body_that_stands_still_is_like_none(jitter: float, stated: dict[str, Any]) -> None:
    """A micrometer of jitter is no cluster's noise: axis and cone do not leap where a body is not quite still."""
    trial = simulate_trial(
        joint_type="hinge", proximal="still", frames=200, inversion=95, rest_before_s=1.0, seed=3
    ).recording
    arm, forearm = trial.bodies
    shaken = jitter * np.random.default_rng(4).normal(size=(len(arm.loss), 6)) * [10.0, 10.0, 10.0, 1.0, 1.0, 1.0]
    still = dq.multiply(arm.dual_quat_lab_body[0], dq.exp(0.5 * shaken))
    assert arm.marker_motion is not None
    # Its markers are as still as its poses.
    at_rest = replace(arm.marker_motion, nonrigid=0.0 * arm.marker_motion.nonrigid)
    quiet = replace(arm, dual_quat_lab_body=still, marker_residual=np.zeros(arm.loss.size), marker_motion=at_rest)
    recording = replace(trial, bodies=(quiet, forearm))
    roles = (("none", forearm.name, "distal"), (arm.name, forearm.name, "distal"), (forearm.name, arm.name, "proximal"))
    lines = []
    for proximal, distal, express_in in roles:
        settings = Settings(proximal=proximal, distal=distal, express_in=express_in, joint="elbow", **stated)
        analysis = analyze(recording, settings)
        found = analysis.joint_axis.headline
        assert found is not None
        assert "noise-unknown" not in [warning.code for warning in analysis.warnings]
        lines.append(found)
    for line in lines[1:]:
        assert off(lines[0].line.direction, line.line.direction) < 5e-6
        assert line.line.point == pytest.approx(lines[0].line.point, abs=2e-6)
        assert line.axis_cone == pytest.approx(lines[0].axis_cone, rel=0.005)
        assert line.point_radius == pytest.approx(lines[0].point_radius, rel=0.005)


@pytest.mark.parametrize("seed", range(3))
def test_where_the_laboratory_is_changes_no_search(seed: int) -> None:
    """A hinge whose body leaps aside while it turns: no two axes have moved so, and several pairs come near."""
    rng = np.random.default_rng(seed)
    angle = np.radians(np.clip(np.arange(-15, 43) * 10.0, 0.0, 130.0))
    poses = dq.multiply(
        mj.turned(angle, mj.line(mj.unit(rng.normal(size=3)), rng.normal(0.0, 0.1, 3))), mj.rest_pose(rng)
    )
    leap = np.zeros((58, 8))
    leap[:, 0] = 1.0
    leap[16:28, 5:] = 0.5 * rng.normal(0.0, 0.02, 3)
    seen, covariance = mj.noisy(dq.multiply(leap, poses), rng, 0.05, 3e-4)
    fits = []
    for place in ([1.0, -2.0, 0.5], [-1.5, 1.0, 2.0]):
        laboratory = dq.dual_quat_from_pose(mj.unit(rng.normal(size=4)), place)
        fit = find_two_axes(Poses.of(dq.multiply(laboratory, seen), covariance))
        axis = dq.transform_lines(dq.conjugate(laboratory), dq.transform_lines(fit.mechanism.proximal, Z_LINE))
        fits.append((fit.cost, axis))
    assert fits[1][0] == pytest.approx(fits[0][0], rel=1e-3)
    assert off(fits[0][1][:3], fits[1][1][:3]) < 3e-3
