"""Poses from markers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from poses import SHAPES, random_poses
from scipy.spatial.transform import Rotation

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import fit_poses, fit_poses_dual_qr

BODY = np.array([[0.04, 0, 0.01], [-0.03, 0.05, 0], [0, -0.04, 0.01], [0.01, 0.02, -0.06], [0.02, -0.03, 0.05]])


@pytest.mark.parametrize("fit", [fit_poses, fit_poses_dual_qr])
@pytest.mark.parametrize("shape", SHAPES)
def test_exact_markers_give_the_pose(fit: object, shape: tuple[int, ...]) -> None:
    pose = random_poses(shape, 3)
    found = fit(BODY, dq.transform_points(pose[..., None, :], BODY))  # type: ignore[operator]
    assert found.dual_quat.shape == (*shape, 8)
    assert dq.align_signs(found.dual_quat, pose) == pytest.approx(pose, abs=1e-12)
    assert found.deviation == pytest.approx(np.zeros(shape), abs=1e-12)


def test_the_papers_dual_matrix_of_section_4() -> None:
    before = np.array([[1, 0, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]], dtype=float)
    after = np.array([[2, 3, 1], [0, 3, 1], [0, 3, 2], [0, 2, 2]], dtype=float)
    found = fit_poses_dual_qr(before, after)
    R, d = dq.matrix_from_dual_quat(found.dual_quat)[:3, :3], dq.matrix_from_dual_quat(found.dual_quat)[:3, 3]
    assert R == pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), abs=1e-12)
    cross = np.array([[0, -d[2], d[1]], [d[2], 0, -d[0]], [-d[1], d[0], 0]])
    assert cross @ R == pytest.approx(np.array([[-1, 0, 2], [0, -1, -2], [2, 2, 0]]), abs=1e-12)
    assert found.deviation == pytest.approx(0.0, abs=1e-12)


def test_least_squares_agrees_with_scipy_frame_by_frame_whatever_is_seen() -> None:
    rng = np.random.default_rng(5)
    pose = random_poses((60,), 6)
    seen = dq.transform_points(pose[:, None, :], BODY) + rng.normal(scale=1e-3, size=(60, 5, 3))
    seen[rng.random((60, 5)) < 0.25] = np.nan
    found = fit_poses(BODY, seen)
    for k in range(60):
        known = np.isfinite(seen[k]).all(axis=1)
        if known.sum() < 3:
            assert np.isnan(found.dual_quat[k]).all()
            assert np.isnan(found.deviation[k])
            continue
        body, target = BODY[known], seen[k, known]
        rotation, distance = Rotation.align_vectors(target - target.mean(axis=0), body - body.mean(axis=0))
        matrix = dq.matrix_from_dual_quat(found.dual_quat[k])
        assert matrix[:3, :3] == pytest.approx(rotation.as_matrix(), abs=1e-9)
        assert matrix[:3, 3] == pytest.approx(target.mean(axis=0) - rotation.apply(body.mean(axis=0)), abs=1e-9)
        assert found.deviation[k] == pytest.approx(distance / np.sqrt(known.sum()), abs=1e-9)


def test_markers_that_do_not_fix_a_pose_give_none() -> None:
    pose = random_poses((4,), 7)
    line = np.outer([0.0, 1.0, 2.0, 3.5], [0.1, 0.2, 0.3])
    assert np.isnan(fit_poses(line, dq.transform_points(pose[:, None, :], line)).dual_quat).all()
    plane = BODY[:4] * [1.0, 1.0, 0.0]
    in_plane = dq.transform_points(pose[:, None, :], plane)
    assert np.isnan(fit_poses_dual_qr(plane, in_plane).dual_quat).all()
    assert dq.align_signs(fit_poses(plane, in_plane).dual_quat, pose) == pytest.approx(pose, abs=1e-12)
    three = dq.transform_points(pose[:, None, :], BODY)
    three[:, 3:] = np.nan
    assert np.isnan(fit_poses_dual_qr(BODY, three).dual_quat).all()
    assert np.isnan(fit_poses(BODY, np.full((2, 5, 3), np.nan)).dual_quat).all()


def test_deviation_tells_a_cluster_that_is_not_rigid() -> None:
    pose = random_poses((50,), 8)
    stretched = dq.transform_points(pose[:, None, :], BODY * [1.1, 1.0, 1.0])
    rigid = dq.transform_points(pose[:, None, :], BODY)
    for fit in (fit_poses, fit_poses_dual_qr):
        assert (fit(BODY, stretched).deviation > 100 * np.abs(fit(BODY, rigid).deviation).max()).all()
    # Stretching by 10 % along the first axis is the triangular factor itself.
    assert fit_poses_dual_qr(BODY, stretched).deviation == pytest.approx(np.full(50, 0.1), abs=1e-9)


@pytest.mark.parametrize("fit", [fit_poses, fit_poses_dual_qr])
@pytest.mark.parametrize("count", [1, 2])
def test_one_or_two_markers_give_none(fit: Any, count: int) -> None:
    found = fit(BODY[:count], np.broadcast_to(BODY[:count], (4, count, 3)))
    assert np.isnan(found.dual_quat).all()
    assert np.isnan(found.deviation).all()
    assert found.dual_quat.shape == (4, 8)
