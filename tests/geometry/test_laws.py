"""The laws of the algebra, over random and adversarial input and over batch shapes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from poses import SHAPES, poses, random_poses, vectors

from elbowscrew.geometry import (
    dual_quat_from_screw,
    line_through,
    pose_from_points,
    screw_from_dual_quat,
)
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float

ONE = np.array([1.0, 0, 0, 0, 0, 0, 0, 0])


@given(poses(), poses(), poses())
def test_product_is_associative(a: Float, b: Float, c: Float) -> None:
    left = dq.multiply(dq.multiply(a, b), c)
    assert left == pytest.approx(dq.multiply(a, dq.multiply(b, c)), abs=1e-11)


@given(poses())
def test_inverse_and_conjugate_undo(Q: Float) -> None:
    assert dq.multiply(Q, dq.conjugate(Q)) == pytest.approx(ONE, abs=1e-11)
    assert dq.multiply(Q, dq.inverse(Q)) == pytest.approx(ONE, abs=1e-11)


@given(arrays(np.float64, 8, elements=st.floats(-10, 10)).filter(lambda Q: np.linalg.norm(Q[:4]) > 0.1))
def test_norm_is_a_dual_number_that_normalizing_makes_one(Q: Float) -> None:
    norm = dq.norm(Q)
    # |Q|^2 = Q Q*, which is a dual number.
    square = dq.multiply(Q, dq.conjugate(Q))
    assert square == pytest.approx(
        [norm.real**2, 0, 0, 0, 2 * norm.real * norm.dual, 0, 0, 0], abs=1e-9 * (1 + float(norm.real) ** 2)
    )
    unit = dq.norm(dq.normalize(Q))
    assert unit.real == pytest.approx(1.0, abs=1e-14)
    assert unit.dual == pytest.approx(0.0, abs=1e-11)
    assert dq.multiply(Q, dq.inverse(Q)) == pytest.approx(ONE, abs=1e-9)


@given(arrays(np.float64, 6, elements=st.floats(-1.5, 1.5)))
@example(np.array([5e-324, 5e-324, 5e-324, 1.0, 5e-324, 5e-324]))
@example(np.array([1.5e-323, 0.0, 0.0, 1.0, 1.0, 1.0]))
@example(np.array([0.0, 5e-324, 0.0, 0.5, 0.25, 1.0]))
def test_log_undoes_exp(half_twist: Float) -> None:
    # |half rotation vector| < pi is the whole range of the logarithm.
    assert dq.log(dq.exp(half_twist)) == pytest.approx(half_twist, rel=1e-12, abs=1e-12)


@given(poses())
def test_exp_undoes_log(Q: Float) -> None:
    near_full_turn = Q[0] < -0.999999
    if not near_full_turn:
        assert dq.exp(dq.log(Q)) == pytest.approx(Q, rel=1e-10, abs=1e-9)


@given(poses(), st.floats(-2, 2), st.floats(-2, 2))
def test_powers_of_one_pose_add_up(Q: Float, s: float, t: float) -> None:
    Q = dq.canonical(Q)
    product = dq.multiply(dq.power(Q, s), dq.power(Q, t))
    assert product == pytest.approx(dq.power(Q, s + t), abs=1e-9)
    assert dq.power(Q, 1.0) == pytest.approx(Q, abs=1e-10)
    assert dq.power(Q, 0.0) == pytest.approx(ONE, abs=1e-15)


@given(poses(), vectors)
def test_pose_functions_do_not_see_the_sign(Q: Float, point: Float) -> None:
    line = line_through(point, np.array([1.0, 2.0, -0.5]))
    assert dq.transform_points(Q, point) == pytest.approx(dq.transform_points(-Q, point), abs=1e-12)
    assert dq.transform_lines(Q, line) == pytest.approx(dq.transform_lines(-Q, line), abs=1e-12)
    assert dq.matrix_from_dual_quat(Q) == pytest.approx(dq.matrix_from_dual_quat(-Q), abs=1e-15)
    assert dq.canonical(Q) == pytest.approx(dq.canonical(-Q)) or abs(Q[0]) < 1e-300


@given(poses())
def test_the_other_sign_is_the_same_screw_the_other_way_round(Q: Float) -> None:
    one, other = screw_from_dual_quat(Q), screw_from_dual_quat(-Q)
    assert one.angle + other.angle == pytest.approx(2 * np.pi, abs=1e-12)
    if np.linalg.norm(Q[1:4]) > 0:
        assert other.direction == pytest.approx(-one.direction)
        assert other.slide == pytest.approx(-one.slide)


@given(poses(), vectors, vectors)
def test_points_and_lines_move_together(Q: Float, point: Float, direction: Float) -> None:
    if np.linalg.norm(direction) < 1e-3:
        direction = np.array([0.0, 0.0, 1.0])
    moved = dq.transform_lines(Q, line_through(point, direction))
    a, b = dq.transform_points(Q, point), dq.transform_points(Q, point + direction)
    assert moved == pytest.approx(line_through(a, b - a), rel=1e-9, abs=1e-8)


@given(poses(), vectors)
def test_transforms_are_the_conjugations_of_the_theory(Q: Float, point: Float) -> None:
    as_dual_quat = np.concatenate([[1.0, 0, 0, 0, 0], point])
    moved = dq.multiply(dq.multiply(Q, as_dual_quat), dq.full_conjugate(Q))
    assert moved == pytest.approx(np.concatenate([[1.0, 0, 0, 0, 0], dq.transform_points(Q, point)]), abs=1e-9)
    line = line_through(point, np.array([0.3, -1.0, 2.0]))
    pure = np.concatenate([[0.0], line[:3], [0.0], line[3:]])
    conjugated = dq.multiply(dq.multiply(Q, pure), dq.conjugate(Q))
    assert conjugated[[1, 2, 3, 5, 6, 7]] == pytest.approx(dq.transform_lines(Q, line), abs=1e-9)


@given(poses(), poses())
def test_screw_moves_with_the_laboratory_frame(change: Float, Q: Float) -> None:
    Q = dq.canonical(Q)
    if np.linalg.norm(Q[1:4]) < 0.05:
        return
    here = screw_from_dual_quat(Q)
    there = screw_from_dual_quat(dq.multiply(dq.multiply(change, Q), dq.conjugate(change)))
    line = np.concatenate([here.direction, here.moment])
    assert there.angle == pytest.approx(here.angle, abs=1e-10)
    assert there.slide == pytest.approx(here.slide, abs=1e-7)
    moved = dq.transform_lines(change, line)
    assert np.concatenate([there.direction, there.moment]) == pytest.approx(moved, rel=1e-7, abs=1e-6)


@pytest.mark.parametrize("angle", [1e-9, 1e-3, 1.0, np.pi - 1e-9, np.pi, np.pi + 1e-3, 6.0])
def test_screw_parameters_round_trip(angle: float) -> None:
    line = line_through([0.3, -0.2, 0.5], [1.0, 2.0, -1.0])
    screw = screw_from_dual_quat(dual_quat_from_screw(angle, 0.07, line[:3], line[3:]))
    assert screw.angle == pytest.approx(angle, rel=1e-14)
    assert screw.slide == pytest.approx(0.07, rel=1e-12)
    assert screw.direction == pytest.approx(line[:3], abs=1e-12)
    # The place is conditioned as (length / angle).
    assert screw.moment == pytest.approx(line[3:], abs=1e-14 + 1e-15 / np.sin(angle / 2))


def test_translation_has_a_direction_but_no_place() -> None:
    screw = screw_from_dual_quat(dq.dual_quat_from_pose([1.0, 0, 0, 0], [0.0, 3.0, 4.0]))
    assert screw.angle == 0.0
    assert screw.slide == 5.0
    assert screw.direction == pytest.approx([0.0, 0.6, 0.8])
    assert np.isnan(screw.moment).all()
    assert np.isnan(screw.point).all()


def test_the_identity_has_no_axis() -> None:
    screw = screw_from_dual_quat(ONE)
    assert screw.angle == 0.0
    assert screw.slide == 0.0
    assert np.isnan(screw.direction).all()


def test_a_full_turn_has_no_logarithm() -> None:
    assert np.isnan(dq.log(-ONE)).all()
    assert np.isnan(dq.normalize(np.zeros(8))).all()


@pytest.mark.parametrize("shape", SHAPES)
def test_batch_shapes_are_kept_and_agree_with_single_calls(shape: tuple[int, ...]) -> None:
    a, b = random_poses(shape, 1), random_poses(shape, 2)
    results = {
        "multiply": dq.multiply(a, b),
        "inverse": dq.inverse(a),
        "normalize": dq.normalize(1.7 * a),
        "power": dq.power(a, np.full(shape, 0.3)),
        "exp": dq.exp(a[..., :6]),
        "canonical": dq.canonical(a),
        "matrix": dq.dual_quat_from_matrix(dq.matrix_from_dual_quat(a)),
    }
    assert dq.log(a).shape == (*shape, 6)
    assert screw_from_dual_quat(a).point.shape == (*shape, 3)
    assert dq.transform_points(a, np.zeros(3)).shape == (*shape, 3)
    for name, result in results.items():
        assert result.shape == (*shape, 8), name
    if a.size:
        first = (0,) * len(shape)
        assert results["multiply"][first] == pytest.approx(dq.multiply(a[first], b[first]))
        assert results["power"][first] == pytest.approx(dq.power(a[first], 0.3))


def test_signs_are_made_continuous_over_gaps() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 50)
    smooth = dual_quat_from_screw(angle, 0.0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    flipped = smooth * np.where(np.random.default_rng(3).random(50) < 0.5, -1.0, 1.0)[:, None]
    flipped[0] = smooth[0]
    flipped[20:23] = np.nan
    known = np.r_[0:20, 23:50]
    assert dq.continuous_signs(flipped)[known] == pytest.approx(smooth[known])


@given(poses())
def test_pose_from_points_finds_the_pose(Q: Float) -> None:
    body = np.array([[0.04, 0, 0], [-0.03, 0.05, 0], [0, -0.04, 0.01], [0.01, 0.02, -0.06]])
    found = pose_from_points(body, dq.transform_points(Q, body))
    assert dq.align_signs(found, Q)[:4] == pytest.approx(Q[:4], abs=1e-9)
    assert dq.transform_points(found, body) == pytest.approx(dq.transform_points(Q, body), abs=1e-9)


def test_pose_from_three_points_is_no_reflection() -> None:
    body = np.array([[0.04, 0, 0], [-0.03, 0.05, 0], [0, -0.04, 0.0]])
    noise = np.random.default_rng(0).normal(scale=2e-3, size=(200, 3, 3))
    found = dq.matrix_from_dual_quat(pose_from_points(body, body + noise))
    assert np.linalg.det(found[:, :3, :3]) == pytest.approx(np.ones(200))
