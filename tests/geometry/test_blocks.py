"""Long series: blocks, layouts in memory and broadcasting change nothing, and cost no memory."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from multiprecision import ANGLES
from numpy.typing import NDArray
from poses import random_poses

from elbowscrew import geometry as g
from elbowscrew.geometry import _blocks
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float

LONG = 2 * _blocks.BLOCK + 3
MIB = 2**20
KNOTS = np.array([0.0, 0.3, 0.55, 0.8, 1.0])
KEYS = dq.align_signs(g.sclerp(random_poses((), 4), random_poses((5,), 5), 0.2), random_poses((), 4))

FUNCTIONS: dict[str, Callable[[Float, Float, Float], Any]] = {
    "multiply": lambda a, b, t: dq.multiply(a, b),
    "left factor": lambda a, b, t: dq.multiply(KEYS[0], b),
    "right factor": lambda a, b, t: dq.multiply(a, KEYS[0]),
    "normalize": lambda a, b, t: dq.normalize(a + 0.1 * b),
    "exp": lambda a, b, t: dq.exp(a[..., 1:7]),
    "log": lambda a, b, t: dq.log(a),
    "power": lambda a, b, t: dq.power(a, t),
    "one power": lambda a, b, t: dq.power(KEYS[0], t),
    "pose": lambda a, b, t: dq.dual_quat_from_pose(*dq.pose_from_dual_quat(a)),
    "screw": lambda a, b, t: np.concatenate([np.atleast_2d(x.T) for x in g.screw_from_dual_quat(a)], axis=0).T,
    "align_signs": lambda a, b, t: dq.align_signs(a, b),
    "continuous_signs": lambda a, b, t: np.abs(dq.continuous_signs(a)),
    "sclerp": lambda a, b, t: g.sclerp(a, b, t),
    "sclerp of two": lambda a, b, t: g.sclerp(KEYS[0], KEYS[1], t),
    "sdlb": lambda a, b, t: g.sdlb(a, b, t),
    "weights": lambda a, b, t: g.lagrange_weights(t, KNOTS),
    "dlb": lambda a, b, t: g.dlb(KEYS, g.lagrange_weights(t, KNOTS)),
    "dlb of series": lambda a, b, t: g.dlb(np.stack([a, b], axis=-2), np.stack([1.0 - t, t], axis=-1)),
    "dib": lambda a, b, t: g.dib(KEYS, g.lagrange_weights(t, KNOTS)).dual_quat,
    "rotate": lambda a, b, t: qn.rotate(a[..., :4], b[..., :3]),
    "matrix": lambda a, b, t: dq.matrix_from_dual_quat(a).reshape(*a.shape[:-1], 16),
    "lines": lambda a, b, t: dq.transform_lines(a, b[..., :6]),
}


def series(seed: int) -> tuple[Float, Float, Float]:
    return random_poses((LONG,), seed), random_poses((LONG,), seed + 1), np.random.default_rng(seed).uniform(size=LONG)


def every_other_of_twice(values: Float) -> Float:
    return np.repeat(values, 2, axis=-1)[..., ::2]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_blocks_and_layouts_give_what_single_calls_give(name: str) -> None:
    a, b, t = series(1)
    rows = (0, 1, _blocks.BLOCK - 1, _blocks.BLOCK, 2 * _blocks.BLOCK, LONG - 1)
    whole = FUNCTIONS[name](a, b, t)
    alone = np.stack([FUNCTIONS[name](a[k : k + 1], b[k : k + 1], t[k : k + 1])[0] for k in rows])
    assert whole[list(rows)] == pytest.approx(alone, abs=1e-13)
    for layout in (np.ascontiguousarray, np.asfortranarray, every_other_of_twice):
        other = FUNCTIONS[name](layout(a), layout(b), every_other_of_twice(t))
        assert np.abs(other - whole).max() <= 1e-13


def test_results_lie_in_memory_as_rows_of_components() -> None:
    a, b, _ = series(3)
    for layout in (np.ascontiguousarray, np.asfortranarray):
        assert dq.multiply(layout(a), b).T.flags.c_contiguous


@pytest.mark.parametrize(
    "shapes", [((7, 1), (1, 5)), ((3, 1, 2), (4, 1)), ((1, 1), (6,)), ((2, 3), (3,)), ((0, 1), (4,))]
)
def test_leading_shapes_broadcast_as_numpy_has_them(shapes: tuple[tuple[int, ...], tuple[int, ...]]) -> None:
    a, b = random_poses(shapes[0], 1), random_poses(shapes[1], 2)
    shape = np.broadcast_shapes(*shapes)
    spread = (np.broadcast_to(a, (*shape, 8)).copy(), np.broadcast_to(b, (*shape, 8)).copy())
    assert dq.multiply(a, b).shape == (*shape, 8)
    assert dq.multiply(a, b) == pytest.approx(dq.multiply(*spread), abs=1e-15)
    t = np.random.default_rng(1).uniform(size=(5, *(1,) * len(shape)))
    assert g.sclerp(a, b, t) == pytest.approx(g.sclerp(*spread, np.broadcast_to(t, (5, *shape))), abs=1e-14)
    one = np.broadcast_to(KEYS[0], (1, 1, 1, 8))
    assert dq.multiply(one, b).shape == np.broadcast_shapes((1, 1, 1, 8), b.shape)
    assert dq.multiply(b, one).shape == np.broadcast_shapes((1, 1, 1, 8), b.shape)
    assert g.sclerp(one, one, t).shape == (*np.broadcast_shapes((1, 1, 1), t.shape), 8)


def test_every_angle_in_one_block_is_as_exact_as_alone() -> None:
    angles = np.array(ANGLES[1:])
    h = np.array([0.36, 0.48, 0.8])
    m = np.cross([0.3, -0.2, 0.5], h)
    u = np.concatenate([0.5 * angles[:, None] * h, 0.5 * h + 0.5 * angles[:, None] * m], axis=1)
    together = dq.exp(u)
    assert together == pytest.approx(np.stack([dq.exp(one) for one in u]), rel=1e-15, abs=0.0)
    assert dq.log(together) == pytest.approx(np.stack([dq.log(one) for one in together]), rel=1e-15, abs=0.0)
    screws = np.stack([np.hstack(g.screw_from_dual_quat(one)) for one in together])
    one = g.screw_from_dual_quat(together)
    assert np.column_stack(one) == pytest.approx(screws, rel=1e-15, abs=0.0)
    start = random_poses((), 8)
    ends = dq.multiply(start, together[:-1])  # a full turn is ill-conditioned
    many = g.sclerp(np.stack([start] * len(ends)), ends, np.full(len(ends), 0.37), way="as given")
    few = np.stack([g.sclerp(start, end, 0.37, way="as given") for end in ends])
    assert many == pytest.approx(few, abs=2e-15)


def test_what_is_lost_in_one_frame_stays_there() -> None:
    a, b, t = series(5)
    a[[3, 100]] = np.nan
    a[4] = [1.0, 0, 0, 0, 0, 0, 0, 0]
    a[5] = [-1.0, 0, 0, 0, 0, 0, 0, 0]
    a[6, 4:] = np.nan  # the place alone is not known
    for name in ("multiply", "right factor", "log", "power", "pose", "sclerp", "dlb of series", "continuous_signs"):
        found = FUNCTIONS[name](a, b, t)
        lost = np.flatnonzero(np.isnan(found).any(axis=-1))
        assert set(lost) - {5} == {3, 6, 100}, name
        assert np.isfinite(found[6, :3]).all(), name
    screw = g.screw_from_dual_quat(a)
    assert screw.angle[4:6] == pytest.approx([0.0, 2.0 * np.pi])
    assert np.isnan(screw.direction[4:6]).all()
    assert np.isfinite(screw.direction[7:100]).all()


def test_signs_are_carried_over_the_blocks() -> None:
    angle = np.linspace(0.0, 8.0 * np.pi, LONG)
    smooth = g.dual_quat_from_screw(angle, 0.1, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    rng = np.random.default_rng(3)
    flipped = np.where(rng.random((LONG, 1)) < 0.5, -smooth, smooth)
    flipped[0] = smooth[0]
    gaps = np.r_[5:9, _blocks.BLOCK - 2 : _blocks.BLOCK + 1]
    flipped[gaps, 0] = np.nan
    known = np.setdiff1d(np.arange(LONG), gaps)
    assert (dq.continuous_signs(flipped)[known] == smooth[known]).all()
    nothing = np.full((LONG, 8), np.nan)
    nothing[-1] = smooth[-1]
    assert (dq.continuous_signs(nothing)[-1] == smooth[-1]).all()


def in_longdouble(a: Float, b: Float) -> NDArray[np.longdouble]:
    """Product of dual quaternions, term by term from the definition ``i j = k`` and so on."""
    table = (
        {(0, k): (k, 1) for k in range(4)} | {(k, 0): (k, 1) for k in range(4)} | {(k, k): (0, -1) for k in (1, 2, 3)}
    )
    table[0, 0] = (0, 1)
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        table[i, j], table[j, i] = (k, 1), (k, -1)
    A, B = a.astype(np.longdouble), b.astype(np.longdouble)
    total = np.zeros(A.shape, dtype=np.longdouble)
    for (i, j), (k, sign) in table.items():
        total[:, k] += sign * A[:, i] * B[:, j]
        total[:, 4 + k] += sign * (A[:, i] * B[:, 4 + j] + A[:, 4 + i] * B[:, j])
    return total


def test_products_are_the_plain_formula_to_round_off() -> None:
    a, b, _ = series(7)
    exact = in_longdouble(a, b)
    scale = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    assert (np.abs(dq.multiply(a, b) - exact).max(axis=1) <= 1e-15 * scale).all()
    one = np.broadcast_to(a[:1], b.shape)
    scale = np.linalg.norm(a[0]) * np.linalg.norm(b, axis=1)
    assert (np.abs(dq.multiply(a[0], b) - in_longdouble(one, b)).max(axis=1) <= 1e-15 * scale).all()
    assert (np.abs(dq.multiply(b, a[0]) - in_longdouble(b, one)).max(axis=1) <= 1e-15 * scale).all()


ONE_KERNEL = (
    *("multiply", "left factor", "right factor", "exp", "log", "power", "one power", "align_signs"),
    *("sclerp", "sclerp of two", "sdlb", "weights", "rotate", "lines"),
)


@pytest.mark.parametrize("name", ONE_KERNEL)
def test_a_kernel_takes_little_memory_beside_its_result(name: str) -> None:
    count = 200_000
    a = np.tile(random_poses((1000,), 1), (count // 1000, 1))
    b, t = a[::-1], np.linspace(0.0, 1.0, count)
    tracemalloc.start()
    try:
        found = FUNCTIONS[name](a, b, t)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak <= found.nbytes + 8 * MIB
