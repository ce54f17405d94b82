"""Against scipy's RigidTransform, pytransform3d and 50-digit arithmetic."""

from __future__ import annotations

import numpy as np
import pytest
import pytransform3d.transformations as pt
from scipy.spatial.transform import RigidTransform, Rotation

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry import sclerp, screw_from_dual_quat
from elbowscrew.geometry.arrays import Float

ANGLES = (1e-300, 1e-12, 1e-7, 1e-3, 0.5, 2.0, np.pi - 1e-7, np.pi - 1e-12, np.pi)


def poses_near(angle: float, count: int = 40) -> tuple[Float, Float, Float]:
    """Rotation vectors of one length, positions, and the poses with both signs."""
    rng = np.random.default_rng(int(1e6 * angle) % 1000)
    axis = rng.normal(size=(count, 3))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    position = rng.normal(size=(count, 3))
    pose = dq.dual_quat_from_pose(qn.quat_from_rotation_vector(angle * axis), position)
    signs = np.where(np.arange(count) % 2, -1.0, 1.0)[:, None]
    return angle * axis, position, signs * pose


def scipy_transform(vector: Float, position: Float) -> RigidTransform:
    return RigidTransform.from_components(position, Rotation.from_rotvec(vector))


@pytest.mark.parametrize("angle", ANGLES)
def test_matrix_pose_and_product_agree_with_scipy(angle: float) -> None:
    vector, position, pose = poses_near(angle)
    theirs = scipy_transform(vector, position)
    assert dq.matrix_from_dual_quat(pose) == pytest.approx(theirs.as_matrix(), abs=1e-12)
    their_pose = theirs.as_dual_quat(scalar_first=True)
    assert dq.align_signs(their_pose, pose) == pytest.approx(pose, abs=1e-12)
    product = dq.matrix_from_dual_quat(dq.multiply(pose[:-1], pose[1:]))
    assert product == pytest.approx((theirs[:-1] * theirs[1:]).as_matrix(), abs=1e-12)
    back = dq.align_signs(dq.dual_quat_from_matrix(theirs.as_matrix()), pose)
    assert back == pytest.approx(pose, abs=1e-12 if angle < 3 else 1e-11)


@pytest.mark.parametrize("angle", [a for a in ANGLES if a < 3])
def test_log_exp_and_power_agree_with_scipy(angle: float) -> None:
    vector, position, pose = poses_near(angle)
    theirs = scipy_transform(vector, position)
    logarithm = 2.0 * dq.log(dq.canonical(pose))
    assert logarithm == pytest.approx(theirs.as_exp_coords(), abs=1e-12)
    # scipy 1.17 rounds the exponent to single precision: take one that it keeps.
    part = dq.matrix_from_dual_quat(dq.power(dq.canonical(pose), 0.375))
    assert part == pytest.approx((theirs**0.375).as_matrix(), abs=1e-12)


@pytest.mark.parametrize("angle", ANGLES)
def test_sclerp_agrees_with_scipy_and_pytransform3d(angle: float) -> None:
    vector, position, pose = poses_near(angle, 8)
    theirs = scipy_transform(vector, position)
    start = theirs[0]
    for k, t in enumerate((0.0, 0.25, 0.5, 0.875, 1.0, 0.375, 0.75)):
        end = dq.multiply(pose[0], pose[k + 1])
        ours = sclerp(pose[0], end, t)
        matrix = dq.matrix_from_dual_quat(ours)
        if angle < np.pi:
            assert matrix == pytest.approx((start * theirs[k + 1] ** t).as_matrix(), abs=1e-12)
            assert ours == pytest.approx(pt.dual_quaternion_sclerp(pose[0], end, t), abs=1e-12)
        else:  # both ways round are equally short, and round-off chooses
            both = [_way_round(start, vector[k + 1], position[k + 1], turn, t) for turn in (np.pi, -np.pi)]
            assert min(np.abs(matrix - expected).max() for expected in both) < 1e-12


def _way_round(start: RigidTransform, vector: Float, position: Float, turn: float, t: float) -> Float:
    """Part of the screw motion that ends in the pose, by the turn given, built from its axis and point."""
    step = scipy_transform(vector, position)
    screw = screw_from_dual_quat(step.as_dual_quat(scalar_first=True))
    turned = Rotation.from_rotvec(t * turn * vector / np.linalg.norm(vector))
    shift = screw.point - turned.apply(screw.point) + t * screw.slide * screw.direction
    return np.asarray((start * RigidTransform.from_components(shift, turned)).as_matrix())


@pytest.mark.parametrize("order", [*qn.EULER_ORDERS, "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"])
def test_euler_angles_are_intrinsic(order: str) -> None:
    angles = np.random.default_rng(5).uniform(-3, 3, size=(50, 3))
    theirs = Rotation.from_euler(order, angles).as_matrix()
    ours = qn.rotation_matrix_from_quat(qn.quat_from_euler_angles(angles, order))
    assert ours == pytest.approx(theirs, abs=1e-14)


@pytest.mark.parametrize("order", ["XXY", "XYY", "xyz", "XY", "XYZX", "XYW", ""])
def test_what_is_no_order_of_euler_angles_is_refused(order: str) -> None:
    with pytest.raises(ValueError, match="no axis follows itself"):
        qn.quat_from_euler_angles(np.zeros(3), order)
