"""What the cone tells of segments: none that holds is left out, and most that do not hold are."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from wandering import BETWEEN, POINTS, marker_errors, wandering

import elbowscrew.motion.interpolation.keyframe_selection as selection_module
import elbowscrew.motion.interpolation.segment_cone as cone_module
from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.difference import point_coordinates
from elbowscrew.motion.interpolation.segment_cone import Cone
from elbowscrew.motion.interpolation.segment_errors import BASES


def cone_of(pose: Float, parameter: Float, tolerance: float, method: str) -> Cone:
    return Cone(point_coordinates(pose, POINTS), pose[:, :4], parameter, tolerance, method == "sclerp")


@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize("method", BASES)
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), step=st.floats(0.02, 0.6))
def test_a_segment_that_just_holds_is_left(method: str, stride: int, seed: int, step: float) -> None:
    pose = wandering(10, seed, step)
    parameter = np.cumsum(np.random.default_rng(seed).uniform(0.3, 1.0, 10))
    parameter[4] = parameter[3]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cone_module, "_STRIDE", stride)
        for first, last in itertools.combinations(range(10), 2):
            if parameter[last] > parameter[first]:
                rows = np.arange(first, last + 1)
                error = marker_errors(pose[rows], parameter[rows], (0, rows.size - 1), method).max()
                assert last in cone_of(pose, parameter, float(error), method).leaves(first, np.arange(last, 10))


@pytest.mark.parametrize("method", BASES)
@given(seed=st.integers(0, 10_000), angle=st.floats(0.0, 6.2), slide=st.floats(-0.3, 0.3))
def test_nor_is_one_that_is_the_motion_itself(method: str, seed: int, angle: float, slide: float) -> None:
    rng = np.random.default_rng(seed)
    start = wandering(2, seed)[1]
    moment = np.cross(rng.normal(scale=0.2, size=3), [0.0, 0.0, 1.0])
    end = dq.multiply(dual_quat_from_screw(angle, slide, [0.0, 0.0, 1.0], moment), start)
    share = np.concatenate([[0.0], np.sort(rng.uniform(size=40)), [1.0]])
    pose = BETWEEN[method](start, end, share, way="as given")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cone_module, "_STRIDE", 1)
        assert cone_of(pose, share, 1e-9, method).leaves(0, np.array([41])).tolist() == [41]


@pytest.mark.parametrize("method", BASES)
def test_what_turns_back_or_slows_down_is_left_out(method: str) -> None:
    rows = np.arange(801)
    there_and_back = 1.0 - np.abs(rows / 400.0 - 1.0)
    slowing = 1.0 - (1.0 - rows / 800.0) ** 2
    for angle in (there_and_back, slowing, slowing[::-1]):
        pose = dual_quat_from_screw(angle, 0.0, [0.0, 0.0, 1.0], [0.2, 0.0, 0.0])
        told = np.isin(rows[1:], cone_of(pose, rows.astype(float), 1e-3, method).leaves(0, rows[1:]))
        truth = [
            marker_errors(pose[: last + 1], rows[: last + 1].astype(float), (0, last), method).max() <= 1e-3
            for last in rows[1::25].tolist()
        ]
        assert not (np.array(truth) & ~told[::25]).any()
        assert told.sum() < 1.3 * 25 * sum(truth)


def test_a_search_with_the_cone_finds_the_same_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    pose = wandering(700, 3, 0.01)
    for method in BASES:
        found = selection_module.select_keyframes(pose, np.arange(700.0), POINTS, 0.02, method=method)
        with monkeypatch.context() as patch:
            patch.setattr(selection_module, "_cone", lambda *_: None)
            other = selection_module.select_keyframes(pose, np.arange(700.0), POINTS, 0.02, method=method)
        assert found.row.tolist() == other.row.tolist()
        assert not found.complete
