"""What a model interpolates: the measured poses, or the angles of the joint that was found."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from elbowscrew.errors import SettingError
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.model.joint_coordinates import MOVING_JOINTS, JointCoordinates
from elbowscrew.model.joint_type import JointType
from elbowscrew.motion.interpolation.modeling import METHODS, Method, joint_method
from elbowscrew.motion.joint.coordinates import joint_angles_of, with_turns_of
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.motion.screws.uncertainty import fitted_covariance


class Interpolation(NamedTuple):
    """A way from keyframe to keyframe.

    Attributes
    ----------
    coordinates : ndarray, shape (N, 8) or (N, k)
        Of the measured motion: poses, or angles of the joint.
    method : callable
        From coordinates to poses.
    joint : JointCoordinates or None
        The joint whose angles they are.
    """

    coordinates: Float
    method: Method
    joint: JointCoordinates | None


def interpolation_called(name: str, pose: Float, joint: ModelJoint | None) -> Interpolation:
    """Give a method by its name, and the coordinates of displacements (N, 8) that it takes.

    Parameters
    ----------
    name : str
    pose : ndarray, shape (N, 8)
    joint : ModelJoint or None
        Only ``joint`` needs it.
    """
    if name != "joint" or joint is None:
        return Interpolation(pose, METHODS[name], None)
    return Interpolation(joint.angles_of(pose), joint_method(joint.coordinates), joint.coordinates)


class ModelJoint(NamedTuple):
    """A joint, and the motion that it was fitted to."""

    coordinates: JointCoordinates
    measured: Measurement

    @classmethod
    def of(cls, measured: Measurement, found: JointType | None) -> ModelJoint:
        """Take the joint that was found.

        Raises
        ------
        SettingError
            If it has no angles of its own.
        """
        coordinates = None if found is None or not found.has_angles else found.coordinates
        if found is None or coordinates is None:
            raise _without_angles("undetermined" if found is None else found.type)
        if len(coordinates.axis) == 1 and np.nansum(found.angle[:, 0] * measured.course) < 0.0:
            coordinates = replace(coordinates, axis=-coordinates.axis)  # the sense of theta
        return cls(coordinates, measured)

    def angles_of(self, pose: Float) -> Float:
        """Angles (N, k) of displacements (N, 8) in the order of the measured frames, weighed by their noise."""
        measured = self.measured

        def covariance(rows: Index) -> Float:
            poses = measured.joint.dual_quat_proximal_distal[rows]
            return fitted_covariance(measured.joint, poses, *measured.noise.assumed)

        angle = joint_angles_of(self.coordinates, pose, covariance, measured.joint.reference_row)
        return with_turns_of(angle, measured.sense.twist) if angle.shape[1] == 1 else angle


def _without_angles(kind: str) -> SettingError:
    if kind in MOVING_JOINTS:
        why = f"the motion does not determine the angles of a joint of type {kind.replace('_', '-')}"
    else:
        why = f"the joint is {kind} here, which has no angles of its own to interpolate"
    return SettingError(f"--method joint: {why}; give --method sclerp, or state the type with --joint-type")
