"""Every number of the 2010 paper that this part of the mathematics prints."""

from __future__ import annotations

import numpy as np
import pytest

from elbowscrew.geometry import (
    dlb,
    dual_quat_from_screw,
    lagrange_weights,
    pose_from_points,
    sclerp,
    screw_from_dual_quat,
    sdlb,
)
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float

QUARTER_TURN = [np.cos(np.pi / 4), 0.0, 0.0, np.sin(np.pi / 4)]


def test_numerical_example_of_section_2() -> None:
    # P 9 is printed with norm 2, and so is the product of P 11.
    Q_T = np.array([2.0, 0, 0, 0, 0, 2, 2, 1])
    Q_R = np.array([*QUARTER_TURN, 0, 0, 0, 0])
    Q = dq.multiply(Q_T, Q_R)
    printed = [1.4142, 0, 0, 1.4142, -0.7071, 2.8284, 0, 0.7071]
    assert Q == pytest.approx(printed, abs=5e-5)
    screw = screw_from_dual_quat(dq.normalize(Q))
    assert round(float(screw.angle), 6) == 1.570796
    assert screw.slide == pytest.approx(1.0, abs=1e-15)
    assert screw.direction == pytest.approx([0, 0, 1], abs=1e-15)
    assert screw.moment == pytest.approx([2, 0, 0], abs=1e-15)
    assert screw.point == pytest.approx([0, 2, 0], abs=1e-15)
    assert dq.normalize(Q) == pytest.approx(dq.dual_quat_from_pose(QUARTER_TURN, [2, 2, 1]), abs=1e-15)


def test_numerical_example_of_section_4() -> None:
    before = np.array([[1, 0, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]], dtype=float)
    after = np.array([[2, 3, 1], [0, 3, 1], [0, 3, 2], [0, 2, 2]], dtype=float)
    pose = dq.canonical(pose_from_points(before, after))
    R, d = dq.matrix_from_dual_quat(pose)[:3, :3], dq.matrix_from_dual_quat(pose)[:3, 3]
    # The dual matrix R + eps [d]x R.
    cross = np.array([[0, -d[2], d[1]], [d[2], 0, -d[0]], [-d[1], d[0], 0]])
    assert pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), abs=1e-14) == R
    assert pytest.approx(np.array([[-1, 0, 2], [0, -1, -2], [2, 2, 0]]), abs=1e-13) == cross @ R
    screw = screw_from_dual_quat(pose)
    assert (round(float(screw.angle), 6), round(float(screw.slide), 6)) == (1.570796, 1.0)
    assert screw.point == pytest.approx([0, 2, 0], abs=1e-13)


START = dual_quat_from_screw(0.0, 0.0, [0, 0, 1], [0, 0, 0])
END = dq.dual_quat_from_pose([np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)], [0, 0, 10])
HALF_WAY = sclerp(START, END, 0.5)

TABLE_1 = {
    "ScLERP": [(0.0, 0.0, 0.0), (0.2, 2.0, 0.157080), (0.4, 4.0, 0.314159), (0.6, 6.0, 0.471239), (0.8, 8.0, 0.628319),
               (1.0, 10.0, 0.785398)],
    "sDLB": [(0.0, 0.0, 0.0), (0.2, 1.925100, 0.155128), (0.4, 3.962077, 0.313176), (0.6, 6.037923, 0.472222),
             (0.8, 8.074900, 0.630270), (1.0, 10.0, 0.785398)],
    "DLB": [(0.0, 0.0, 0.0), (0.2, 2.036640, 0.158043), (0.4, 4.018432, 0.314643), (0.5, 5.0, 0.392699),
            (0.6, 5.981568, 0.470756), (0.8, 7.963360, 0.627355), (1.0, 10.0, 0.785398)],
}  # fmt: skip


def interpolated(method: str, t: float) -> Float:
    if method == "ScLERP":
        return sclerp(START, END, t)
    if method == "sDLB":
        return sdlb(START, END, t)
    return dlb(np.stack([START, HALF_WAY, END]), lagrange_weights(t, [0.0, 0.5, 1.0]))


@pytest.mark.parametrize(("method", "t", "d_z", "theta"), [(m, *row) for m, rows in TABLE_1.items() for row in rows])
def test_table_1_to_every_printed_digit(method: str, t: float, d_z: float, theta: float) -> None:
    pose = interpolated(method, t)
    position = dq.pose_from_dual_quat(pose)[1]
    assert round(float(position[2]), 6) == d_z
    assert round(float(screw_from_dual_quat(pose).angle), 6) == theta
    assert position[:2] == pytest.approx([0, 0], abs=1e-15)
