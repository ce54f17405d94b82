"""Axes of several subjects: in the bones' frame whatever the clusters, and their mean and spread by construction."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.axes import group_axis, in_bone
from elbowscrew.model.anatomy import Side

# A right arm in its humerus' own frame: forward, proximal, to the right.
LANDMARKS = {"GH": [0.0, 0.0, 0.0], "EL": [0.0, -0.3, 0.03], "EM": [0.0, -0.3, -0.03]}
DIRECTION = np.array([0.1, 0.2, 1.0]) / np.sqrt(1.05)
POINT = np.array([0.004, -0.303, 0.01])
MIRROR = np.array([1.0, 1.0, -1.0])


@pytest.mark.parametrize("side", ["right", "left"])
def test_one_axis_in_clusters_that_lie_anyhow_and_on_both_sides(side: Side) -> None:
    mirror = MIRROR if side == "left" else np.ones(3)
    for seed in range(5):
        turn, shift = Rotation.random(rng=seed), np.random.default_rng(seed).standard_normal(3)
        landmarks = {name: turn.apply(mirror * place) + shift for name, place in LANDMARKS.items()}
        sense = 1.0 if seed % 2 else -1.0
        direction, point = in_bone(
            sense * turn.apply(mirror * DIRECTION), turn.apply(mirror * POINT) + shift, landmarks, side, "elbow"
        )
        assert sense * direction == pytest.approx(DIRECTION)
        assert point == pytest.approx(POINT - [0.0, -0.3, 0.0])


def tilted(degrees: float, way: Float) -> Float:
    return np.asarray(Rotation.from_rotvec(np.radians(degrees) * way).apply([0.0, 0.0, 1.0]))


def test_mean_and_spread_of_axes_tilted_evenly_about_the_lateral_direction() -> None:
    """Four subjects 3 deg to all four sides, and 2 mm to all four sides where they pierce the plane."""
    axes = {}
    for k in range(4):
        way = Rotation.from_rotvec([0.0, 0.0, 0.5 * np.pi * k]).apply([1.0, 0.0, 0.0])
        direction = tilted(3.0, way)
        point = 0.002 * way + np.array([0.001, -0.004, 0.0]) + 0.7 * direction
        axes[f"s{k}"] = [(direction, point), (-direction, point - 0.2 * direction)][: 1 + k % 2]
    found = group_axis(axes)
    assert (found.subjects, found.trials) == (4, 6)
    assert found.direction == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert np.degrees(found.direction_sd) == pytest.approx(3.0 * np.sqrt(4 / 3))
    assert found.point == pytest.approx([0.001, -0.004, 0.0], abs=1e-12)
    assert found.point_sd == pytest.approx(0.002 * np.sqrt(4 / 3))


def test_a_subject_with_more_trials_weighs_no_more() -> None:
    far, near = tilted(10.0, np.array([1.0, 0.0, 0.0])), np.array([0.0, 0.0, 1.0])
    found = group_axis({"a": [(far, np.zeros(3))] * 9, "b": [(near, np.zeros(3))]})
    assert found.direction == pytest.approx(tilted(5.0, np.array([1.0, 0.0, 0.0])))


def test_what_is_not_known_of_one_subject_or_without_places() -> None:
    found = group_axis({"a": [(DIRECTION, np.full(3, np.nan))]})
    assert np.isnan([found.direction_sd, found.point_sd, *found.point]).all()
    assert found.direction == pytest.approx(DIRECTION)
