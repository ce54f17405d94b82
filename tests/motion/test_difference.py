"""How far two poses are apart: the markers themselves, and what makes it a metric."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.difference import (
    angle_between,
    origin_distance,
    points_from_markers,
    points_from_radius,
    rms_displacement,
    turn_and_distance,
)

SEEDS = st.integers(0, 1_000_000)


def poses(rng: np.random.Generator, count: int) -> Float:
    return dq.dual_quat_from_pose(
        qn.quat_from_rotation_vector(rng.normal(size=(count, 3)) * 1.5), rng.normal(scale=0.3, size=(count, 3))
    )


@given(seed=SEEDS, markers=st.integers(1, 12))
def test_it_is_exactly_the_rms_over_the_markers(seed: int, markers: int) -> None:
    rng = np.random.default_rng(seed)
    offsets = rng.normal(scale=0.08, size=(markers, 3)) + rng.normal(scale=0.1, size=3)
    a, b = poses(rng, 2)
    apart = dq.transform_points(a, offsets) - dq.transform_points(b, offsets)
    direct = np.sqrt(np.mean(np.sum(apart**2, axis=1)))
    assert rms_displacement(a, b, points_from_markers(offsets)) == pytest.approx(direct, abs=1e-12)


@given(seed=SEEDS, radius=st.floats(1e-3, 0.5))
def test_for_a_round_body_it_is_the_closed_form(seed: int, radius: float) -> None:
    """With the origin at the centroid: ``E^2 = dd^2 + (8/3) rho^2 sin^2(delta/2)``."""
    a, b = poses(np.random.default_rng(seed), 2)
    shift = dq.pose_from_dual_quat(a)[1] - dq.pose_from_dual_quat(b)[1]
    square = shift @ shift + 8.0 / 3.0 * radius**2 * np.sin(0.5 * angle_between(a, b)) ** 2
    assert rms_displacement(a, b, points_from_radius(radius)) == pytest.approx(np.sqrt(square), abs=1e-12)


@given(seed=SEEDS)
def test_it_is_a_metric_and_knows_no_laboratory(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = points_from_markers(rng.normal(scale=0.1, size=(4, 3)))
    a, b, c, moved = poses(rng, 4)
    distance = rms_displacement(a, b, points)
    assert rms_displacement(b, a, points) == pytest.approx(distance, abs=1e-15)
    assert rms_displacement(a, -a, points) == pytest.approx(0.0, abs=1e-15)
    assert distance <= rms_displacement(a, c, points) + rms_displacement(c, b, points) + 1e-15
    assert rms_displacement(dq.multiply(moved, a), dq.multiply(moved, b), points) == pytest.approx(distance, abs=1e-12)


def test_turn_and_distance_in_one_pass_are_the_same_numbers() -> None:
    a, b = (poses(np.random.default_rng(seed), 50) for seed in (1, 2))
    turn, distance = turn_and_distance(a, b)
    assert turn.tolist() == angle_between(a, b).tolist()
    assert distance.tolist() == origin_distance(a, b).tolist()
