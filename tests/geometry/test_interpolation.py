"""Laws of interpolation and blending."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from poses import poses, random_poses

from elbowscrew.geometry import dlb, dual_quat_from_screw, lagrange_weights, sclerp, sdlb
from elbowscrew.geometry import dual_quaternion as dq

Float = NDArray[np.float64]


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
    assert sclerp(start, end, 0.5, shortest_path=False) == pytest.approx(half)
    assert sdlb(start, end, 0.5, shortest_path=False)[:4] == pytest.approx(half[:4])
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
    assert np.isnan(sdlb(start, end, 0.5, shortest_path=False)).all()


def test_equal_knots_are_refused() -> None:
    with pytest.raises(ValueError, match="differ"):
        lagrange_weights(0.5, [0.0, 0.0, 1.0])
