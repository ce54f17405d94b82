"""The motion modeled from its keyframes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, Literal, NamedTuple

import numpy as np

from elbowscrew.choices import POSE_METHOD_NAMES, functions_named
from elbowscrew.errors import SettingError
from elbowscrew.geometry import catmull_rom, dib, dlb, lagrange_weights, sclerp, sdlb
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import Keyframes
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.motion.interpolation.keyframes import phase_time
from elbowscrew.motion.joint.coordinates import joint_poses
from elbowscrew.quantities import in_digits

Method = Callable[[Float, Float, Float], Float]


_LARGEST_WEIGHT: Final = 100.0
_LARGEST_STEP: Final = 1e-9


def _weights(parameter: Float, knots: Float) -> Float:
    weights = lagrange_weights(parameter, knots)
    largest = float(np.abs(weights).max(initial=0.0))
    if not largest <= _LARGEST_WEIGHT:
        msg = (
            f"--keyframes: a polynomial through {knots.size} poses weighs them by up to {in_digits(largest)}, and "
            "their noise with them; give fewer keyframes, or --method sclerp"
        )
        raise SettingError(msg)
    return weights


def _dlb(poses: Float, knots: Float, parameter: Float) -> Float:
    return dlb(poses, _weights(parameter, knots), way="as given")


def _dib(poses: Float, knots: Float, parameter: Float) -> Float:
    blend = dib(poses, _weights(parameter, knots), way="as given")
    if (blend.residual > _LARGEST_STEP).any():
        msg = (
            f"--method dib: the blend still moves by {in_digits(blend.residual.max())} rad after {blend.iterations} "
            "iterations; give keyframes closer together, or --method dlb"
        )
        raise SettingError(msg)
    return blend.dual_quat


def _catmull_rom(poses: Float, knots: Float, parameter: Float) -> Float:
    return catmull_rom(poses, knots, parameter, way="as given")


def _between_neighbors(two_poses: Callable[..., Float]) -> Method:
    def method(poses: Float, knots: Float, parameter: Float) -> Float:
        k = np.clip(np.searchsorted(knots, parameter, side="right") - 1, 0, knots.size - 2)
        local = (parameter - knots[k]) / (knots[k + 1] - knots[k])
        return two_poses(poses[k], poses[k + 1], local, way="as given")

    return method


_sclerp: Final = _between_neighbors(sclerp)
_sdlb: Final = _between_neighbors(sdlb)

METHODS: Final[dict[str, Method]] = functions_named(POSE_METHOD_NAMES, globals())
"""Each takes keyframe poses (K, 8), their knots (K,) and parameters (n,) and gives poses (n, 8).

The poses come from a sign-continuous series, which tells which way round the motion went, so no method looks for the
shorter path of its own. A new method is one function above, and its name in
`elbowscrew.choices.PoseMethodName`.
"""
FROM_NEIGHBORS: Final = frozenset({"sclerp", "sdlb", "joint"})
"""Methods whose motion between two keyframes depends on these two alone."""


def joint_method(joint: JointCoordinates) -> Method:
    """Interpolate a joint's angles (K, k) in place of poses: evenly between neighbors, a ball's rotations by slerp.

    About one axis or a center this is ScLERP of the poses that the joint has at the keyframes.
    """

    def angles(start: Float, end: Float, local: Float, *, way: str) -> Float:
        return joint_poses(joint, start + local[:, None] * (end - start))

    def rotations(start: Float, end: Float, local: Float, *, way: Literal["as given"]) -> Float:
        return sclerp(joint_poses(joint, start), joint_poses(joint, end), local, way=way)

    return _between_neighbors(rotations if joint.type == "ball" else angles)


class ModeledPoses(NamedTuple):
    """Poses of the model: phase (N,) masked outside the keyframes, law's t (N,), dual quaternions (N, 8)."""

    phase: np.ma.MaskedArray[Any, np.dtype[np.int64]]
    fraction: Float
    dual_quat: Float


def model_motion(
    coordinates: Float,
    elapsed: Float,
    keyframes: Keyframes,
    method: Method,
    laws: Sequence[Callable[[Float], Float]],
) -> ModeledPoses:
    """Interpolate the keyframes' poses under a time law (P 33-36).

    In each phase tau runs from 0 to 1 while its law runs, and the law gives t. The frame of an inversion belongs to
    the phase it begins, as P 36 prints it. A global blend takes all poses at once, with the parameter
    ``(phase + t) / phases``.

    Parameters
    ----------
    coordinates : ndarray, shape (N, 8) or (N, k)
        The measured motion, sign-continuous, or the joint's angles.
    elapsed : ndarray, shape (N,)
        Seconds.
    keyframes : Keyframes
    method : callable
        From `METHODS`, or of `joint_method`.
    laws : sequence of callable
        One for each phase.
    """
    phase = np.ma.array(np.zeros(elapsed.size, dtype=np.int64), mask=True)
    fraction = np.full(elapsed.size, np.nan)
    modeled = np.full((elapsed.size, 8), np.nan)
    phases, bounds = keyframes.phases, keyframes.phase_bounds
    piecewise = len(keyframes.knots) == phases.count
    for p, law in enumerate(laws):
        members = keyframes.row[bounds[p] : bounds[p + 1] + 1]
        rows = np.arange(members[0], members[-1] + (1 if p == phases.count - 1 else 0))
        t = law(phase_time(phases, p, elapsed, rows))
        phase[rows] = p + 1
        fraction[rows] = t
        if piecewise:
            modeled[rows] = method(coordinates[members], keyframes.knots[p], t)
        else:
            modeled[rows] = method(coordinates[keyframes.row], keyframes.knots[0], (p + t) / phases.count)
    return ModeledPoses(phase, fraction, modeled)
