"""Axes from pose to pose and of the moment."""

from __future__ import annotations

import numpy as np
import pytest
from trials import LINE, START, joint_poses

from elbowscrew import Recording, RigidBody, Settings, analyze, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import line_through
from elbowscrew.model import HelicalSteps
from elbowscrew.motion.axes.instantaneous import instantaneous_motion, twists
from elbowscrew.motion.axes.measured import measured_steps
from elbowscrew.motion.screws.measurement import measure


def steps_of(step_deg: float, *, noise_mm: float = 0.0, seed: int = 0) -> HelicalSteps:
    trial = simulate_trial(marker_noise_mm=noise_mm, proximal="moving", seed=seed)
    settings = Settings(step_deg=step_deg, express_in="proximal", marker_noise_mm=0.2)
    steps = measured_steps(measure(trial.recording, settings), settings)  # what `analyze` has, and nothing beside it
    assert steps is not None
    return steps


def test_steps_follow_the_motion_there_and_back_about_the_joints_line() -> None:
    steps = steps_of(15.0)
    assert (np.abs(steps.angle) >= np.radians(15.0) - 1e-12).all()
    assert steps.start_frame[0] == 0
    assert (steps.end_frame[:-1] == steps.start_frame[1:]).all()
    assert steps.angle.sum() == pytest.approx(0.0, abs=np.radians(15.0))
    assert (steps.angle[: len(steps.angle) // 2] > 0).all()
    assert (steps.angle[-3:] < 0).all()
    lines = line_through(steps.axis_point, steps.axis_direction)
    assert lines == pytest.approx(np.broadcast_to(LINE, lines.shape), abs=1e-9)


def test_no_steps_unless_asked_for_and_none_where_the_motion_is_smaller() -> None:
    assert analyze(simulate_trial().recording).steps is None
    steps = steps_of(170.0)
    assert steps.angle.size == 0
    assert len(steps.to_frame()) == 0


def test_a_steps_interval_holds_the_truth_in_95_percent() -> None:
    inside = []
    for seed in range(60):
        steps = steps_of(20.0, noise_mm=0.2, seed=seed)
        tilt = np.arcsin(np.linalg.norm(np.cross(steps.axis_direction, LINE[:3]), axis=1))
        inside.append(tilt <= steps.axis_cone)
    shares = np.concatenate(inside)
    # Neighboring steps share a pose and so are not independent: twice the deviation of a share.
    assert shares.mean() == pytest.approx(0.95, abs=4.0 * 2.0 * np.sqrt(0.95 * 0.05 / shares.size))


def test_the_instantaneous_axis_of_a_screw_motion_is_its_line_at_any_speed() -> None:
    time = np.linspace(0.0, 2.0, 241)
    angle = np.sin(np.pi * time) + 0.3 * time**2
    D = dq.multiply(joint_poses(angle, 0.01 * angle), dq.conjugate(START))
    D = np.where((np.arange(241) == 100)[:, None], np.nan, D) * np.where(np.arange(241) % 7 < 3, -1.0, 1.0)[:, None]
    frame = np.arange(241)
    known = np.isfinite(D[:, 0])
    found = instantaneous_motion(twists(D, known, time, 120.0, 1), frame, time, 0.25, -LINE[:3], lowpass_hz=60.0)
    rate = -(np.pi * np.cos(np.pi * time) + 0.6 * time)
    given = np.isfinite(found.axis_direction[:, 0])
    assert not given[[0, 99, 100, 101, 240]].any()
    assert (np.abs(rate[given]) > 0.249).all()
    assert given.sum() > 200
    # Second order in the time between the frames.
    assert found.angular_velocity[given] == pytest.approx(rate[given], abs=np.pi**3 / 6 / 120**2 * 1.1)
    assert found.slide_velocity[given] == pytest.approx(0.01 * found.angular_velocity[given], abs=1e-12)
    lines = line_through(found.axis_point[given], found.axis_direction[given])
    assert lines == pytest.approx(np.broadcast_to(-LINE, lines.shape), abs=1e-9)


def test_a_body_at_rest_has_no_instantaneous_axis() -> None:
    pose = np.broadcast_to(START, (50, 8))
    time = np.arange(50) / 100
    twist = twists(pose, np.ones(50, dtype=np.bool_), time, 100.0, 1)
    found = instantaneous_motion(twist, np.arange(50), time, 0.25, LINE[:3], lowpass_hz=50.0)
    assert np.isnan(found.axis_direction).all()
    assert np.isnan(found.slide_velocity).all()
    assert np.nanmax(np.abs(found.angular_velocity)) < 1e-12


def test_columns_of_steps_change_with_the_units() -> None:
    names = list(steps_of(15.0).to_frame("rad", "m").columns)
    assert "theta_rad" in names
    assert "point_radius95_m" in names
    recording = Recording.from_bodies(
        [
            RigidBody(
                name="b",
                dual_quat_lab_body=joint_poses(np.linspace(0, 1, 40), np.zeros(40)),
                loss=np.zeros(40, dtype=np.uint8),
            )
        ],
        rate_hz=100,
    )
    steps = analyze(recording, Settings(step_deg=10)).steps
    assert steps is not None
    assert np.isnan(steps.axis_sd).all()
