"""Lines in space: how far they are apart, wherever they lie."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from poses import random_poses

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import line_through
from elbowscrew.geometry.lines import direction_between, distance_across

SEEDS = st.integers(0, 1_000_000)


@given(seed=SEEDS, tilt=st.floats(0.0, 1.2), shift=st.floats(0.0, 0.2))
def test_axes_are_apart_by_their_tilt_and_their_shift(seed: int, tilt: float, shift: float) -> None:
    """A line, and the same tilted in the plane through a point of it and shifted across, anywhere in space."""
    near = np.array([0.0, 0.0, 0.3])
    line = line_through([0.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    other = line_through([shift, 0.0, 0.3], [0.0, np.sin(tilt), np.cos(tilt)])
    moved = random_poses((), seed)
    line, other, near = (
        dq.transform_lines(moved, line),
        dq.transform_lines(moved, other),
        dq.transform_points(moved, near),
    )
    assert direction_between(line, other) == pytest.approx(tilt, abs=1e-12)
    assert distance_across(line, other, near) == pytest.approx(shift, abs=1e-12)


def test_an_axis_that_is_not_known_is_at_no_distance() -> None:
    line = line_through([0.0, 0, 0], [0.0, 0, 1])
    unknown = np.full(6, np.nan)
    assert np.isnan(direction_between(line, unknown))
    assert np.isnan(distance_across(line, unknown, np.zeros(3)))
    # Nor is one that never meets the plane across the other.
    assert np.isnan(distance_across(line, line_through([0.0, 0, 0], [1.0, 0, 0]), np.zeros(3)))
