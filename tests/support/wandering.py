"""Motions without an axis, and what a model between some of their poses leaves of the markers, written out."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry import sclerp, sdlb
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.difference import points_from_markers

MARKERS = np.array([[38, 12, 31], [-41, 27, 8], [9, -44, -28], [-6, 5, -47], [60, 3, 10]]) * 1e-3
POINTS = points_from_markers(MARKERS)
BETWEEN: dict[str, Any] = {"sclerp": sclerp, "sdlb": sdlb}


def wandering(count: int, seed: int, step: float = 0.15) -> Float:
    """A motion without an axis: sums of small random turns and shifts."""
    rng = np.random.default_rng(seed)
    turn = np.cumsum(rng.normal(scale=step, size=(count, 3)), axis=0)
    place = np.cumsum(rng.normal(scale=0.1 * step, size=(count, 3)), axis=0)
    return dq.continuous_signs(dq.dual_quat_from_pose(qn.quat_from_rotation_vector(turn), place))


def marker_errors(pose: Float, parameter: Float, keys: tuple[int, ...], method: str) -> Float:
    """RMS distance of the markers in every frame, from the markers themselves."""
    model = np.empty_like(pose)
    for first, last in itertools.pairwise(keys):
        rows = np.arange(first, last + 1)
        span = parameter[last] - parameter[first]
        share = (parameter[rows] - parameter[first]) / span if span > 0 else np.zeros(rows.size)
        model[rows] = BETWEEN[method](pose[first], pose[last], share, way="as given")
        model[last] = pose[last]
    apart = dq.transform_points(pose[:, None], MARKERS) - dq.transform_points(model[:, None], MARKERS)
    distance: Float = np.sqrt(np.mean(np.sum(apart**2, axis=-1), axis=1))
    return distance
