"""Every function on arrays of any leading shape agrees with its calls one by one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from poses import SHAPES, random_poses

from elbowscrew import geometry as g
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import dual_vector, general, quaternion, twist
from elbowscrew.geometry.arrays import Float

KNOTS = np.array([0.0, 0.3, 1.0])
MARKERS = np.array([[0.04, 0, 0.01], [-0.03, 0.05, 0], [0, -0.04, 0.01], [0.01, 0.02, -0.06]])


def line_of(Q: Float) -> Float:
    return dq.transform_lines(Q, [0.0, 0, 1, 0, 0, 0])


FUNCTIONS: dict[str, Callable[[Float, Float, Float], Any]] = {
    "multiply": lambda a, b, t: dq.multiply(a, b),
    "inverse": lambda a, b, t: dq.inverse(a + 0.1 * b),
    "normalize": lambda a, b, t: dq.normalize(a + 0.1 * b),
    "norm": lambda a, b, t: np.stack(dq.norm(a + 0.1 * b), axis=-1),
    "exp": lambda a, b, t: dq.exp(a[..., 1:7]),
    "log": lambda a, b, t: dq.log(a),
    "power": lambda a, b, t: dq.power(a, t),
    "canonical": lambda a, b, t: dq.canonical(a),
    "align_signs": lambda a, b, t: dq.align_signs(a, b),
    "matrix": lambda a, b, t: dq.dual_quat_from_matrix(dq.matrix_from_dual_quat(a)),
    "transform_points": lambda a, b, t: dq.transform_points(a, b[..., :3]),
    "screw": lambda a, b, t: g.dual_quat_from_screw(*g.screw_from_dual_quat(a)),
    "dual_matrix": lambda a, b, t: g.dual_quat_from_dual_matrix(g.dual_matrix_from_dual_quat(a)),
    "polar": lambda a, b, t: g.dual_matrix.polar(g.dual_matrix_from_dual_quat(a))[0].dual,
    "sclerp": lambda a, b, t: g.sclerp(a, b, t),
    "sdlb": lambda a, b, t: g.sdlb(a, b, t),
    "nlerp": lambda a, b, t: g.nlerp(a[..., :4], b[..., :4], t),
    "dlb": lambda a, b, t: g.dlb(np.stack([a, b, dq.multiply(a, b)], axis=-2), g.lagrange_weights(t, KNOTS)),
    "dib": lambda a, b, t: g.dib(np.stack([a, g.sclerp(a, b, 0.2)], axis=-2), np.stack([1 - t, t], -1)).dual_quat,
    "chain": lambda a, b, t: g.chain(np.stack([a, b], axis=-2)),
    "catmull_rom": lambda a, b, t: g.catmull_rom(random_poses((4,), 3), [0.0, 0.4, 0.5, 1.0], t),
    "general": lambda a, b, t: general.power(2.0 * a + b, t),
    "left_matrix": lambda a, b, t: general.left_matrix(a),
    "rotate": lambda a, b, t: quaternion.rotate(a[..., :4], b[..., :3]),
    "quat_from_rotation_vector": lambda a, b, t: quaternion.quat_from_rotation_vector(a[..., :3]),
    "line_angle": lambda a, b, t: np.stack(dual_vector.angle_between_lines(line_of(a), line_of(b)), axis=-1),
    "common_normal": lambda a, b, t: dual_vector.common_normal(line_of(a), line_of(b)),
    "twist": lambda a, b, t: twist.twist_in_fixed_frame(a, b),
    "adjoint": lambda a, b, t: twist.adjoint(a),
    "integrate_twist": lambda a, b, t: twist.integrate_twist(a, b[..., 1:7], t),
    "instantaneous_screw": lambda a, b, t: twist.instantaneous_screw(a[..., 1:7]).line,
    "fit_poses": lambda a, b, t: g.fit_poses(MARKERS, dq.transform_points(a[..., None, :], MARKERS)).dual_quat,
    "fit_poses_dual_qr": lambda a, b, t: (
        g.fit_poses_dual_qr(MARKERS, dq.transform_points(a[..., None, :], MARKERS)).dual_quat
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_batches_agree_with_single_calls(name: str, shape: tuple[int, ...]) -> None:
    a, b = random_poses(shape, 1), random_poses(shape, 2)
    t = np.random.default_rng(5).uniform(size=shape)
    together = np.asarray(FUNCTIONS[name](a, b, t))
    assert together.shape[: len(shape)] == shape
    for index in np.ndindex(shape):
        alone = np.asarray(FUNCTIONS[name](a[index], b[index], t[index]))
        assert together[index] == pytest.approx(alone, abs=1e-12, nan_ok=True)
    assert np.isfinite(together).all()
