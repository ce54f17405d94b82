"""The mean of subjects' axes in the proximal bone's own frame, and how far they lie apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.lines import angle_of_lines, piercing
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.model.anatomy import BonyJoint, Side
from elbowscrew.motion.anatomy.bone_frames import epicondyles, frame_of_proximal

_MIRROR: Final[Float] = np.array([1.0, 1.0, -1.0])


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupAxis:
    """The mean axis of one condition, in the frame of the humerus or the femur, right and left limbs alike.

    Attributes
    ----------
    subjects, trials : int
    direction : ndarray, shape (3,)
        Forward, proximal, lateral; pointing laterally.
    point : ndarray, shape (3,)
        Where it pierces the plane across it through the middle of the epicondyles, from that middle; meters, NaN
        where places are not known.
    direction_sd : float
        Standard deviation of the subjects' directions, both components together, radians; NaN of one subject.
    point_sd : float
        The same of where they pierce that plane, meters.
    """

    subjects: int
    trials: int
    direction: Float
    point: Float
    direction_sd: float
    point_sd: float


def in_bone(
    direction: Float, point: Float, landmarks: Mapping[str, Float], side: Side, joint: BonyJoint
) -> tuple[Float, Float]:
    """Write an axis in the proximal bone's frame as a right limb has it, its point from the middle of the epicondyles.

    Parameters
    ----------
    direction, point : ndarray, shape (3,)
        In the proximal body's frame; the point in meters, NaN where not known.
    landmarks : mapping of str to ndarray, shape (3,)
        Those of the proximal bone in that frame, meters.
    side : {"right", "left"}
        A left limb is mirrored in the sagittal plane, as the ISB does.
    joint : {"elbow", "knee"}
        Of which the landmarks are.

    Returns
    -------
    tuple of ndarray, shape (3,)
        Direction, whichever way round, and point.

    References
    ----------
    Wu and others 2005, J Biomech 38:981-992; Grood and Suntay 1983, J Biomech Eng 105:136-144.
    """
    to_bone = rotation_matrix_from_quat(frame_of_proximal(landmarks, side, joint)[:4]).T
    lateral, medial = epicondyles(landmarks, joint)
    mirror = _MIRROR if side == "left" else 1.0
    return mirror * (to_bone @ direction), mirror * (to_bone @ (point - 0.5 * (lateral + medial)))


def group_axis(axes: Mapping[str, Sequence[tuple[Float, Float]]]) -> GroupAxis:
    """Average axes, first within each subject, then over the subjects.

    Parameters
    ----------
    axes : mapping of str to sequence of (ndarray, ndarray)
        Direction and point of the axis in each trial of each subject, from `in_bone`.
    """
    directions = [np.stack([direction for direction, _ in axes[name]]) for name in sorted(axes)]
    of_subjects = np.stack([_mean_direction(one) for one in directions])
    mean = _mean_direction(of_subjects)
    if mean[2] < 0.0:
        mean = -mean
    points = np.stack(
        [
            piercing(one, np.stack([point for _, point in axes[name]]), mean, np.zeros(3)).mean(axis=0)
            for name, one in zip(sorted(axes), directions, strict=True)
        ]
    )
    point = points.mean(axis=0)
    return GroupAxis(
        subjects=len(axes),
        trials=sum(map(len, axes.values())),
        direction=mean,
        point=point,
        direction_sd=_sd(angle_of_lines(of_subjects, mean)),
        point_sd=_sd(length(points - point)),
    )


def _mean_direction(directions: Float) -> Float:
    """Unit vector, shape (3,), to which the squared sines of the angles of lines (n, 3) add up to the least."""
    return np.asarray(np.linalg.eigh(directions.T @ directions)[1][:, -1], dtype=np.float64)


def _sd(distances: Float) -> float:
    return float(np.sqrt(np.sum(distances**2) / (distances.size - 1))) if distances.size > 1 else float("nan")
