"""Derivatives of screw parameters, and the circle that holds 95 %."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from poses import SHAPES, poses, random_poses

from elbowscrew.geometry import dual_quat_from_screw, screw_from_dual_quat
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import confidence_radius, screw_sensitivity


@given(poses(), st.integers(0, 5))
def test_derivatives_are_those_of_finite_differences(Q: Float, k: int) -> None:
    size = float(np.linalg.norm(Q[1:4]))
    scale = 1.0 + float(np.linalg.norm(dq.pose_from_dual_quat(Q)[1]))
    if size < 0.1 or scale > 100.0:
        return
    h = 1e-6
    twist = np.zeros(6)
    twist[k] = 0.5 * h
    ahead, back = (screw_from_dual_quat(dq.multiply(dq.exp(sign * twist), Q)) for sign in (1.0, -1.0))
    found, n = screw_sensitivity(Q), screw_from_dual_quat(Q).direction
    assert found.angle[k] == pytest.approx((ahead.angle - back.angle) / (2 * h), abs=1e-7)
    assert found.slide[k] == pytest.approx((ahead.slide - back.slide) / (2 * h), abs=1e-6 * scale)
    assert found.direction[:, k] == pytest.approx((ahead.direction - back.direction) / (2 * h), abs=1e-6 / size)
    moved = (ahead.point - back.point) / (2 * h)
    assert found.point[:, k] == pytest.approx(moved - (moved @ n) * n, abs=1e-5 * scale / size**2)


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_are_kept(shape: tuple[int, ...]) -> None:
    found = screw_sensitivity(random_poses(shape))
    assert (found.angle.shape, found.slide.shape) == ((*shape, 6), (*shape, 6))
    assert (found.direction.shape, found.point.shape) == ((*shape, 3, 6), (*shape, 3, 6))


def test_a_translation_has_no_axis_to_be_sensitive() -> None:
    assert np.isnan(screw_sensitivity(dq.dual_quat_from_pose([1, 0, 0, 0], [1, 2, 3])).direction).all()


def test_direction_noise_grows_as_one_over_the_sine_of_half_the_angle() -> None:
    """Woltring's law: equal rotation noise at both ends gives sigma/sin(theta/2), both components together."""
    angle = np.radians([5.0, 20.0, 90.0, 140.0, 179.0])
    D = dual_quat_from_screw(angle, 0.0, [0.0, 0, 1], [0.0, 0, 0])
    direction = screw_sensitivity(D).direction[:, :, :3]
    # The twist is -e_0 + R e: twice the covariance of one isotropic rotation.
    spread = np.sqrt(2.0 * np.sum(direction**2, axis=(1, 2)))
    assert spread == pytest.approx(1.0 / np.sin(angle / 2), rel=1e-12)


@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.05, 0.3, 0.7, 1.0])
def test_the_circle_holds_95_percent(ratio: float) -> None:
    count = 400_000
    z = np.random.default_rng(7).normal(size=(count, 2)) * np.array([2.0, 2.0 * np.sqrt(ratio)])
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    radius = confidence_radius(turn @ np.diag([4.0, 4.0 * ratio]) @ turn.T)
    share = np.mean(np.hypot(*z.T) <= radius)
    assert share == pytest.approx(0.95, abs=4.0 * np.sqrt(0.95 * 0.05 / count))


def test_the_circle_of_two_equal_variances_is_known_exactly() -> None:
    assert confidence_radius(np.eye(2)) == pytest.approx(np.sqrt(-2.0 * np.log(0.05)), rel=1e-9)
    assert confidence_radius(np.zeros((3, 3))) == 0.0
    assert np.isnan(confidence_radius(np.full((2, 2), np.nan)))
