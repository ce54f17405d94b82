"""Quaternions, dual quaternions, screws and their interpolation: pure NumPy on arrays of any leading shape.

Nothing here knows of time, files, units or names of bodies.
"""

from elbowscrew.geometry import dual_matrix, dual_quaternion, quaternion
from elbowscrew.geometry.interpolation import dlb, lagrange_weights, sclerp, sdlb
from elbowscrew.geometry.registration import FittedPose, fit_poses, fit_poses_dual_qr, pose_from_points
from elbowscrew.geometry.screw import (
    Screw,
    dual_quat_from_screw,
    line_through,
    point_nearest_origin,
    screw_from_dual_quat,
)

__all__ = [
    "FittedPose",
    "Screw",
    "dlb",
    "dual_matrix",
    "dual_quat_from_screw",
    "dual_quaternion",
    "fit_poses",
    "fit_poses_dual_qr",
    "lagrange_weights",
    "line_through",
    "point_nearest_origin",
    "pose_from_points",
    "quaternion",
    "sclerp",
    "screw_from_dual_quat",
    "sdlb",
]
