"""Poses for tests: strategies and seeded samples."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float

SHAPES: tuple[tuple[int, ...], ...] = ((), (1,), (3, 1, 2), (0,))

vectors = arrays(np.float64, 3, elements=st.floats(-3.0, 3.0))
lengths = arrays(np.float64, 3, elements=st.floats(-1e3, 1e3))


@st.composite
def poses(draw: Any) -> Float:
    return dq.dual_quat_from_pose(qn.quat_from_rotation_vector(draw(vectors)), draw(lengths))


def random_poses(shape: tuple[int, ...], seed: int = 0) -> Float:
    rng = np.random.default_rng(seed)
    quat = qn.normalize(rng.normal(size=(*shape, 4)))
    return dq.dual_quat_from_pose(quat, rng.normal(size=(*shape, 3)))
