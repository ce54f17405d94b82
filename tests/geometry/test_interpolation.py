"""Laws of interpolation and blending."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from poses import poses, random_poses

from elbowscrew.geometry import (
    catmull_rom,
    chain,
    dib,
    dlb,
    dual_quat_from_screw,
    lagrange_weights,
    nlerp,
    sclerp,
    screw_from_dual_quat,
    sdlb,
)
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float


@given(poses(), poses())
def test_ends_are_met_up_to_sign(a: Float, b: Float) -> None:
    if np.linalg.norm(a[:4] + b[:4]) < 1e-6 or np.linalg.norm(a[:4] - b[:4]) < 1e-6:
        return
    for method in (sclerp, sdlb):
        assert method(a, b, 0.0) == pytest.approx(a, abs=1e-10)
        assert dq.align_signs(method(a, b, 1.0), b) == pytest.approx(b, abs=1e-8)


@given(poses(), poses(), poses(), st.floats(0, 1))
def test_no_method_depends_on_the_frame_on_either_side(left: Float, a: Float, b: Float, t: float) -> None:
    if abs(a[:4] @ b[:4]) < 1e-3:
        return
    for method in (sclerp, sdlb):
        inside = dq.multiply(left, dq.multiply(method(a, b, t), left))
        outside = method(dq.multiply(left, dq.multiply(a, left)), dq.multiply(left, dq.multiply(b, left)), t)
        assert outside == pytest.approx(inside, rel=1e-7, abs=1e-5)


@given(poses(), poses(), st.floats(0, 1))
def test_the_sign_of_a_pose_does_not_matter_on_the_shortest_path(a: Float, b: Float, t: float) -> None:
    if abs(a[:4] @ b[:4]) < 1e-6:
        return
    for method in (sclerp, sdlb):
        assert method(a, -b, t) == pytest.approx(method(a, b, t), abs=1e-12)


def test_the_way_round_is_kept_on_request() -> None:
    line = ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    start, end = dual_quat_from_screw(0.0, 0.0, *line), dual_quat_from_screw(np.radians(200.0), 0.2, *line)
    half = dual_quat_from_screw(np.radians(100.0), 0.1, *line)
    assert sclerp(start, end, 0.5, way="as given") == pytest.approx(half)
    assert sdlb(start, end, 0.5, way="as given")[:4] == pytest.approx(half[:4])
    assert sclerp(start, end, 0.5, way="longest") == pytest.approx(half)
    assert sclerp(start, -end, 0.5, way="longest") == pytest.approx(half)
    assert nlerp(start[:4], end[:4], 0.5, way="longest") == pytest.approx(half[:4])
    three = np.stack([start, half, end])
    blend = dib(three, lagrange_weights([0.25, 0.95], [0.0, 0.5, 1.0]), way="as given").dual_quat
    assert np.degrees(screw_from_dual_quat(blend).angle) == pytest.approx([50.0, 190.0], abs=1e-6)
    assert catmull_rom(three, [0.0, 0.5, 1.0], 0.5, way="longest")[0] == pytest.approx(-half[0])
    with pytest.raises(ValueError, match="'longest'"):
        sclerp(start, end, 0.5, way="short")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="'longest'"):
        catmull_rom(three, [0.0, 0.5, 1.0], 0.5, way="short")  # type: ignore[arg-type]
    back = dual_quat_from_screw(np.radians(-80.0), 0.1, *line)
    assert sclerp(start, end, 0.5)[:4] == pytest.approx(back[:4])


@given(arrays(np.float64, 5, elements=st.floats(0.1, 0.5)), st.floats(-1, 1))
def test_lagrange_weights_reproduce_polynomials(gaps: Float, t: float) -> None:
    knots = np.cumsum(gaps) - 1.5
    weights = lagrange_weights(t, knots)
    for degree in range(5):
        assert weights @ knots**degree == pytest.approx(t**degree, abs=1e-8)
    assert lagrange_weights(knots, knots) == pytest.approx(np.eye(5), abs=1e-12)


def test_blending_meets_the_keyframes_and_broadcasts() -> None:
    keys = dq.align_signs(random_poses((4,), 4), random_poses((4,), 4)[0])
    knots = np.array([0.0, 0.3, 0.6, 1.0])
    blended = dlb(keys, lagrange_weights(knots, knots))
    assert blended == pytest.approx(keys, abs=1e-12)
    assert dlb(keys, lagrange_weights(np.linspace(0, 1, 6).reshape(3, 2), knots)).shape == (3, 2, 8)


def test_a_blend_that_cancels_is_undefined() -> None:
    line = ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    start, end = dual_quat_from_screw(0.0, 0.0, *line), dual_quat_from_screw(2 * np.pi, 0.0, *line)
    assert np.isnan(sdlb(start, end, 0.5, way="as given")).all()


def test_equal_knots_are_refused() -> None:
    with pytest.raises(ValueError, match="differ"):
        lagrange_weights(0.5, [0.0, 0.0, 1.0])


@given(poses(), poses(), st.floats(0, 1))
def test_iterative_blending_of_two_poses_is_sclerp(a: Float, b: Float, t: float) -> None:
    if abs(a[:4] @ b[:4]) < 0.05:
        return
    found = dib(np.stack([a, b]), np.array([1.0 - t, t]))
    assert found.residual <= 1e-12
    scale = 1.0 + np.abs(dq.pose_from_dual_quat(np.stack([a, b]))[1]).max()
    assert dq.align_signs(found.dual_quat, a) == pytest.approx(dq.align_signs(sclerp(a, b, t), a), abs=1e-9 * scale)


def test_iterative_blending_solves_its_fixed_point_equation() -> None:
    from scipy.optimize import fsolve

    keys = random_poses((4,), 9)
    keys = sclerp(keys[0], keys, 0.4)
    keys = dq.align_signs(keys, keys[0])
    for weights in (np.full(4, 0.25), np.array([0.6, 0.6, -0.3, 0.1])):
        found = dib(keys, weights)
        assert found.residual < 1e-12

        def equation(x: Float, weights: Float = weights) -> Float:
            guess = dq.multiply(keys[0], dq.exp(x))
            return np.asarray(weights @ dq.log(dq.canonical(dq.multiply(dq.conjugate(guess), keys))))

        solved = dq.multiply(keys[0], dq.exp(fsolve(equation, np.zeros(6), xtol=1e-13)))
        assert dq.align_signs(found.dual_quat, solved) == pytest.approx(solved, abs=1e-10)


def test_iterative_blending_reports_that_it_was_stopped() -> None:
    keys = random_poses((3,), 10)
    found = dib(keys, np.full((5, 3), 1 / 3), max_iterations=1)
    assert found.iterations == 1
    assert found.residual.shape == (5,)
    assert (found.residual > 1e-12).all()


@given(poses(), poses())
def test_iterative_blending_does_not_depend_on_the_frame(left: Float, right: Float) -> None:
    keys = sclerp(random_poses((), 3), random_poses((3,), 3), 0.3)
    weights = np.array([0.2, 0.5, 0.3])
    inside = dq.multiply(left, dq.multiply(dib(keys, weights).dual_quat, right))
    outside = dib(dq.multiply(left, dq.multiply(keys, right)), weights, tolerance=1e-13).dual_quat
    assert dq.align_signs(outside, inside) == pytest.approx(inside, rel=1e-8, abs=1e-6)


KNOTS = np.array([0.0, 0.15, 0.5, 0.6, 1.0])


def test_catmull_rom_meets_its_keyframes_with_continuous_velocity() -> None:
    keys = random_poses((5,), 11)
    assert dq.align_signs(catmull_rom(keys, KNOTS, KNOTS), keys) == pytest.approx(keys, abs=1e-12)
    h = 1e-6
    for knot in KNOTS[1:-1]:
        before, here, after = catmull_rom(keys, KNOTS, np.array([knot - h, knot, knot + h]))
        assert (after - here) / h == pytest.approx((here - before) / h, abs=2e-3)
    assert catmull_rom(keys, KNOTS, np.zeros((2, 3))).shape == (2, 3, 8)


def test_catmull_rom_of_a_uniform_screw_is_that_screw() -> None:
    line = ([0.0, 0.6, 0.8], [0.1, -0.08, 0.06])
    keys = dual_quat_from_screw(2.0 * KNOTS, 0.3 * KNOTS, *line)
    t = np.linspace(-0.1, 1.1, 41)
    expected = dual_quat_from_screw(2.0 * t, 0.3 * t, *line)
    assert catmull_rom(keys, KNOTS, t) == pytest.approx(expected, abs=1e-12)
    with pytest.raises(ValueError, match="increasing"):
        catmull_rom(keys, KNOTS[::-1], t)


def test_nlerp_goes_the_way_of_slerp() -> None:
    from scipy.spatial.transform import Rotation, Slerp

    a, b = random_poses((2,), 12)[:, :4]
    half = nlerp(a, b, 0.5)
    theirs = Slerp([0, 1], Rotation.from_quat(np.stack([a, b]), scalar_first=True))(0.5).as_quat(scalar_first=True)
    assert abs(half @ theirs) == pytest.approx(1.0)
    assert nlerp(a, -b, 0.3) == pytest.approx(nlerp(a, b, 0.3))
    assert nlerp(a, b, np.zeros((2, 3))).shape == (2, 3, 4)
    assert np.isnan(nlerp(a, -a, 0.5, way="as given")).all()


def test_a_chain_puts_every_link_into_the_root() -> None:
    links = random_poses((6, 4), 13)
    found = chain(links)
    matrices = dq.matrix_from_dual_quat(links)
    expected = matrices[:, 0]
    for k in range(1, 4):
        expected = expected @ matrices[:, k]
    assert dq.matrix_from_dual_quat(found[:, 3]) == pytest.approx(expected, abs=1e-12)
    assert found[:, 0] == pytest.approx(links[:, 0])
