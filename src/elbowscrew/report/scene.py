"""What the three-dimensional view shows, as plain numbers: millimeters and degrees, in the frame of the axes."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import pose_from_dual_quat, transform_points
from elbowscrew.geometry.quaternion import rotate
from elbowscrew.report.charts import COLORS
from elbowscrew.view.joint_space import joint_in_body
from elbowscrew.view.scene import (
    Region,
    bodies_in_space,
    bones_in_space,
    directions_across,
    frames_in_space,
    joint_bundle,
)
from elbowscrew.view.trial_view import TrialView

MOST_FRAMES: Final = 900
"""Frames that are played; of longer trials every so many."""
WIDEST: Final = 1.0
"""Half-angle (rad) of the widest region that is drawn; a wider one hides all else."""
_DECIMALS: Final = 2
_ANGLE_DECIMALS: Final = 4  # three more than are told: a number rounded twice may end otherwise than beside it
_PURE_DECIMALS: Final = 5
_BONE_DECIMALS: Final = 1


def scene_of(trial: TrialView) -> dict[str, Any]:
    """Gather bodies, axes and motion of a trial for the view that turns and plays.

    Parameters
    ----------
    trial : TrialView

    Returns
    -------
    dict
        Numbers and the words for the segments, ready for JSON; None where nothing is known. Poses are displacements:
        quaternion, then translation, applied to the distal body as it is at the reference.
    """
    bundle = joint_bundle(trial).scaled(1000.0)
    proximal, distal = _bodies(trial)
    across, _ = directions_across(bundle.direction)
    rows = evenly_thinned(np.arange(trial.frame.size), MOST_FRAMES)
    angle = np.degrees(trial.angle)
    known = angle[trial.axis_known]
    return {
        "frame": trial.frame[rows].tolist(),
        "time": _rounded(trial.time_s[rows], 4),
        "theta": _rounded(angle[rows], _ANGLE_DECIMALS),
        "slide": _rounded(1000.0 * trial.slide[rows], _DECIMALS),
        "valid": trial.valid[rows].astype(int).tolist(),
        "turn": _rounded(trial.euler_parameters[rows], _PURE_DECIMALS),
        "shift": _rounded(1000.0 * trial.translation[rows], _DECIMALS),
        "axis": _rounded(trial.axis_direction[rows], _PURE_DECIMALS),
        "point": _rounded(1000.0 * trial.axis_point[rows], _DECIMALS),
        "segments": _rounded(bundle.segments.reshape(-1, 6), _DECIMALS),
        "segmentTheta": _rounded(angle[bundle.rows], _DECIMALS),
        "thetaRange": [float(known.min()), float(known.max())],
        "direction": _rounded(bundle.direction, _PURE_DECIMALS),
        "center": _rounded(bundle.center, _DECIMALS),
        "half": round(bundle.half, _DECIMALS),
        "across": _rounded(np.stack(across), _PURE_DECIMALS),
        "spread": _region(bundle.spread),
        "confidence": None if bundle.confidence is None else _region(bundle.confidence),
        "joint": _joint(trial, bundle.half),
        "proximal": proximal,
        "distal": distal,
        "bones": _bones(trial),
        "colors": list(COLORS),
    }


def _bodies(trial: TrialView) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Give both bodies at the reference, with the words for their segments."""
    bodies, words = bodies_in_space(trial), trial.named_joint
    return (
        _body(words.proximal.name, bodies.proximal, bodies.proximal_markers),
        _body(words.distal.name, bodies.start, bodies.distal_markers),
    )


def _body(word: str, origin: Float | None, markers: Float | None) -> dict[str, Any] | None:
    if origin is None:
        return None
    return {
        "word": word,
        "origin": _rounded(1000.0 * origin, _DECIMALS),
        "markers": [] if markers is None else _rounded(1000.0 * markers, _DECIMALS),
    }


def _bones(trial: TrialView) -> list[dict[str, Any]]:
    """Give the bones' triangles at the reference, all numbers in a row."""
    return [
        {
            "of": end,
            "vertices": _rounded(1000.0 * vertices.reshape(-1), _BONE_DECIMALS),
            "faces": trial.meshes[end].faces.reshape(-1).tolist(),
        }
        for end, vertices in bones_in_space(trial).items()
    ]


def _joint(trial: TrialView, half: float) -> dict[str, Any]:
    """Give both axes of a joint that has two, at the reference, or its center; nothing of one axis, which is there."""
    joint, (to_here, _) = joint_in_body(trial, "proximal"), frames_in_space(trial)
    turn = pose_from_dual_quat(to_here)[0]
    axes = []
    for axis, moves in zip(joint.axes if len(joint.axes) == 2 else (), (False, True), strict=False):
        direction = rotate(turn, axis.direction)
        known = axis.known
        axes.append(
            {
                "name": axis.name,
                "direction": _rounded(direction, _PURE_DECIMALS),
                "center": _rounded(1000.0 * transform_points(to_here, axis.point), _DECIMALS),
                "half": round(half, _DECIMALS),
                "across": _rounded(np.stack(directions_across(direction)[0]), _PURE_DECIMALS),
                "known": None if known is None else _region(Region(known.angle, 1000.0 * known.radius)),
                "moves": moves,
            }
        )
    center, semi_axes = joint.center, joint.semi_axes
    return {
        "axes": axes,
        "center": None if center is None else _rounded(1000.0 * transform_points(to_here, center), _DECIMALS),
        "semiAxes": None if semi_axes is None else _rounded(1000.0 * rotate(turn, semi_axes), 4),
    }


def _region(region: Region) -> list[float] | None:
    if not np.isfinite([region.angle, region.radius]).all() or region.angle > WIDEST:
        return None
    return [round(region.angle, 6), round(region.radius, 4)]


def _rounded(values: Float, decimals: int) -> list[Any]:
    """Rounded numbers as lists; None for a row, or a number, that is not known."""
    rounded = np.round(values, decimals) + 0.0  # no -0.0
    if values.ndim == 2:
        known = np.logical_and.reduce(np.isfinite(values), axis=1)
        return [row if good else None for row, good in zip(rounded.tolist(), known, strict=True)]
    return [value if value == value else None for value in rounded.tolist()]
