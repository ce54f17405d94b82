"""Dual numbers, dual vectors, general dual quaternions and twists: laws and outside oracles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from poses import SHAPES, poses, random_poses
from scipy.linalg import expm
from scipy.optimize import minimize

from elbowscrew.geometry import (
    compose_screws,
    dual_matrix_from_dual_quat,
    dual_number,
    dual_quat_from_dual_matrix,
    dual_vector,
    general,
    line_through,
    screw_from_dual_matrix,
    screw_from_dual_quat,
    twist,
)
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_number import DualNumber

reals = st.floats(-3, 3)


def as_matrix(x: DualNumber) -> Float:
    """A dual number as the matrix [[a, b], [0, a]], whose algebra is the same."""
    return np.array([[float(x.real), float(x.dual)], [0.0, float(x.real)]])


def assert_same(x: DualNumber, matrix: Float) -> None:
    assert as_matrix(x) == pytest.approx(matrix, rel=1e-9, abs=1e-9)


@given(reals, reals, st.floats(0.2, 3), reals)
def test_arithmetic_is_that_of_triangular_matrices(a: float, b: float, c: float, d: float) -> None:
    x, y = dual_number.dual_number(a, b), dual_number.dual_number(c, d)
    assert_same(dual_number.add(x, y), as_matrix(x) + as_matrix(y))
    assert_same(dual_number.subtract(x, y), as_matrix(x) - as_matrix(y))
    assert_same(dual_number.multiply(x, y), as_matrix(x) @ as_matrix(y))
    assert_same(dual_number.divide(x, y), as_matrix(x) @ np.linalg.inv(as_matrix(y)))
    assert_same(dual_number.exp(x), expm(as_matrix(x)))


FUNCTIONS: dict[str, tuple[Callable[[DualNumber], DualNumber], Any, list[float]]] = {
    "sin": (dual_number.sin, mpmath.sin, [-2.0, 0.0, 0.7]),
    "cos": (dual_number.cos, mpmath.cos, [-2.0, 0.0, 0.7]),
    "tan": (dual_number.tan, mpmath.tan, [-1.0, 0.0, 0.7]),
    "asin": (dual_number.asin, mpmath.asin, [-0.9, 0.0, 0.7]),
    "acos": (dual_number.acos, mpmath.acos, [-0.9, 0.0, 0.7]),
    "sqrt": (dual_number.sqrt, mpmath.sqrt, [1e-8, 0.7, 1e6]),
    "exp": (dual_number.exp, mpmath.exp, [-5.0, 0.0, 3.0]),
    "log": (dual_number.log, mpmath.log, [1e-8, 0.7, 1e6]),
    "power": (lambda x: dual_number.power(x, 2.5), lambda x: x**2.5, [1e-3, 0.7, 100.0]),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_carry_their_derivative(name: str) -> None:
    ours, exact, places = FUNCTIONS[name]
    with mpmath.workdps(40):
        for place in places:
            value = ours(dual_number.dual_number(place, 1.5))
            assert float(value.real) == pytest.approx(float(exact(mpmath.mpf(place))), rel=1e-15, abs=1e-300)
            assert float(value.dual) == pytest.approx(1.5 * float(mpmath.diff(exact, mpmath.mpf(place))), rel=1e-13)


@given(st.floats(0.1, 3.0), reals, reals)
def test_atan2_undoes_sine_and_cosine(angle: float, dual: float, shift: float) -> None:
    x = dual_number.dual_number(angle, dual)
    found = dual_number.atan2(dual_number.sin(x), dual_number.cos(x))
    assert (found.real, found.dual) == pytest.approx((angle, dual), abs=1e-9)
    size = dual_number.dual_number(2.0, shift)
    scaled = [dual_number.multiply(size, part) for part in (dual_number.sin(x), dual_number.cos(x))]
    assert dual_number.atan2(*scaled).dual == pytest.approx(dual, abs=1e-9)


def test_what_is_not_defined_is_nan() -> None:
    one = dual_number.dual_number
    assert np.isnan(dual_number.divide(one(1.0), one(0.0, 1.0)).real)
    assert np.isnan(dual_number.asin(one(1.0, 1.0)).dual)
    assert np.isnan(dual_number.sqrt(one(-1.0)).real)
    assert np.isnan(dual_number.sqrt(one(0.0, 1.0)).dual)
    assert np.isnan(dual_number.log(one(0.0)).real)
    assert np.isnan(dual_number.log(one(-1.0, 1.0)).dual)
    assert dual_number.power(one(0.0, 3.0), 0.0).dual == 0.0
    assert np.isinf(dual_number.exp(one(1000.0, 1.0)).real)
    assert np.isnan(dual_number.atan2(one(0.0, 1.0), one(0.0, 1.0)).dual)


@given(poses(), poses())
def test_dual_angle_and_common_normal_of_two_lines(one: Float, other: Float) -> None:
    z = np.array([0.0, 0, 1, 0, 0, 0])
    a, b = dq.transform_lines(one, z), dq.transform_lines(other, z)
    sine = np.linalg.norm(np.cross(a[:3], b[:3]))
    if sine < 1e-2:
        return
    angle = dual_vector.angle_between_lines(a, b)
    pa, pb = np.cross(a[:3], a[3:]), np.cross(b[:3], b[3:])

    def gap(s: Float) -> float:
        return float(np.sum((pa + s[0] * a[:3] - pb - s[1] * b[:3]) ** 2))

    start = np.linalg.lstsq(np.stack([a[:3], -b[:3]], axis=1), pb - pa, rcond=None)[0]
    nearest = minimize(gap, start, method="Nelder-Mead", options={"xatol": 1e-12, "fatol": 1e-20})
    scale = 1.0 + np.abs(pa).max() + np.abs(pb).max()
    assert abs(float(angle.dual)) == pytest.approx(np.sqrt(nearest.fun), abs=1e-6 * scale)
    assert np.cos(float(angle.real)) == pytest.approx(a[:3] @ b[:3], abs=1e-12)
    assert float(dual_number.cos(angle).dual) == pytest.approx(float(dual_vector.dot(a, b).dual), abs=1e-8 * scale)
    normal = dual_vector.common_normal(a, b)
    for line in (a, b):  # it meets both at right angles
        product = dual_vector.dot(normal, line)
        assert float(product.real) == pytest.approx(0.0, abs=1e-9)
        assert float(product.dual) == pytest.approx(0.0, abs=1e-7 * scale / sine)


def test_parallel_lines_have_a_distance_and_a_normal_without_a_place() -> None:
    a, b = line_through([0, 0, 0], [0, 0, 1]), line_through([3, 4, 7], [0, 0, 1])
    angle = dual_vector.angle_between_lines(a, b)
    assert (float(angle.real), float(angle.dual)) == (0.0, 5.0)
    normal = dual_vector.common_normal(a, b)
    assert abs(normal[:3] @ [0.6, 0.8, 0.0]) == pytest.approx(1.0)
    assert np.isnan(normal[3:]).all()
    assert np.isnan(dual_vector.common_normal(a, a)).all()


@pytest.mark.parametrize("shape", SHAPES)
def test_general_functions_and_matrices_on_any_shape(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    A, B = rng.normal(size=(*shape, 8)), rng.normal(size=(*shape, 8))
    product = dq.multiply(A, B)
    assert (general.left_matrix(A) @ B[..., None])[..., 0] == pytest.approx(product, abs=1e-12)
    assert (general.right_matrix(B) @ A[..., None])[..., 0] == pytest.approx(product, abs=1e-12)
    assert general.exp(general.log(A)) == pytest.approx(A, abs=1e-9)
    half = general.power(A, np.full(shape, 0.5))
    assert dq.multiply(half, half) == pytest.approx(A, abs=1e-9)


def test_exponential_is_that_of_the_matrix() -> None:
    Q = np.random.default_rng(4).normal(size=(20, 8))
    for one in Q:
        assert general.exp(one) == pytest.approx(expm(general.left_matrix(one))[:, 0], rel=1e-9, abs=1e-9)


@given(poses(), poses())
def test_rodrigues_formula_is_the_product_of_dual_quaternions(first: Float, second: Float) -> None:
    A, B = dq.canonical(first), dq.canonical(second)
    C = dq.multiply(B, A)
    if min(A[0], B[0], abs(C[0])) < 0.05 or max(A[0], B[0], abs(C[0])) > 0.999:
        return
    found = compose_screws(screw_from_dual_quat(A), screw_from_dual_quat(B))
    expected = screw_from_dual_quat(C)
    assert found.angle == pytest.approx(expected.angle, abs=1e-8)
    assert found.slide == pytest.approx(expected.slide, rel=1e-6, abs=1e-5)
    assert found.direction == pytest.approx(expected.direction, abs=1e-7)
    assert found.moment == pytest.approx(expected.moment, rel=1e-6, abs=1e-4)


@given(poses())
def test_dual_matrices_move_lines_and_give_the_screw_back(Q: Float) -> None:
    line = line_through([0.3, 0.1, -0.2], [1.0, -2.0, 0.5])
    matrix = dual_matrix_from_dual_quat(Q)
    moved = np.concatenate([matrix.real @ line[:3], matrix.real @ line[3:] + matrix.dual @ line[:3]])
    assert moved == pytest.approx(dq.transform_lines(Q, line), abs=1e-9)
    # The elements of P 21 are those of the rotation matrix with dual Euler parameters.
    e = [dual_number.dual_number(Q[k], Q[4 + k]) for k in range(4)]
    square = [dual_number.multiply(part, part) for part in e]
    corner = dual_number.subtract(dual_number.add(square[0], square[1]), dual_number.add(square[2], square[3]))
    assert (matrix.real[0, 0], matrix.dual[0, 0]) == pytest.approx((float(corner.real), float(corner.dual)), abs=1e-9)
    back = dual_quat_from_dual_matrix(matrix)
    assert dq.align_signs(back, Q) == pytest.approx(Q, abs=1e-7)
    if 0.05 < abs(Q[0]) < 0.99:
        assert screw_from_dual_matrix(matrix).angle == pytest.approx(screw_from_dual_quat(dq.canonical(Q)).angle)


def test_twist_of_a_screw_motion_is_its_screw() -> None:
    """A motion of constant speed about and along a line has that line as its instantaneous axis, in either frame."""
    start = random_poses((), 5)
    line = line_through([0.2, -0.1, 0.4], [1.0, 2.0, -1.0])
    rate, pitch = 1.7, 0.03
    half = 0.5 * np.concatenate([rate * line[:3], rate * line[3:] + rate * pitch * line[:3]])
    time_s, h = 0.6, 1e-5
    pose = [dq.multiply(dq.exp(t * half), start) for t in (time_s - h, time_s, time_s + h)]
    derivative = (pose[2] - pose[0]) / (2 * h)
    fixed = twist.twist_in_fixed_frame(pose[1], derivative)
    screw = twist.instantaneous_screw(fixed)
    assert screw.rate == pytest.approx(rate, abs=1e-8)
    assert screw.pitch == pytest.approx(pitch, abs=1e-8)
    assert screw.line == pytest.approx(line, abs=1e-8)
    body = twist.twist_in_body_frame(pose[1], derivative)
    assert twist.adjoint(pose[1]) @ body == pytest.approx(fixed, abs=1e-8)
    assert twist.integrate_twist(start, twist.twist_in_body_frame(pose[1], derivative), time_s) == pytest.approx(
        pose[1], abs=1e-8
    )


def test_the_velocity_in_a_twist_is_that_of_the_point_at_the_origin() -> None:
    # Turning about z through (1, 0, 0): the body's point at the origin moves with w x (0 - p).
    quat, position = qn.quat_from_rotation_vector([0.0, 0.0, 0.3]), np.array([1.5, 0.2, 0.0])
    w = np.array([0.0, 0.0, 2.0])
    velocity = np.cross(w, position - [1.0, 0.0, 0.0])
    h = 1e-6
    ends = [
        dq.dual_quat_from_pose(qn.multiply(qn.quat_from_rotation_vector(s * h * w), quat), position + s * h * velocity)
        for s in (-1, 1)
    ]
    found = twist.twist_in_fixed_frame(dq.dual_quat_from_pose(quat, position), (ends[1] - ends[0]) / (2 * h))
    assert found == pytest.approx(np.concatenate([w, np.cross(w, [-1.0, 0.0, 0.0])]), abs=1e-8)


def test_a_translation_has_no_instantaneous_axis() -> None:
    screw = twist.instantaneous_screw([0.0, 0, 0, 1, 2, 3])
    assert screw.rate == 0.0
    assert np.isnan(screw.pitch)
    assert np.isnan(screw.line).all()
