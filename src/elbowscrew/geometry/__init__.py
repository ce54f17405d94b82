"""Quaternions, dual quaternions, screws and their interpolation: pure NumPy on arrays of any leading shape.

Nothing here knows of time, files, units or names of bodies. The modules `quaternion`, `dual_number`, `dual_vector`,
`dual_matrix`, `dual_quaternion` (unit: poses), `general` (any dual quaternion) and `twist` are used by their names.
"""

from elbowscrew.geometry import dual_matrix, dual_number, dual_quaternion, dual_vector, general, quaternion, twist
from elbowscrew.geometry._ways import WayRound
from elbowscrew.geometry.blending import IterativeBlend, dib, dlb, lagrange_weights
from elbowscrew.geometry.dual_matrix import DualMatrix
from elbowscrew.geometry.dual_number import DualNumber
from elbowscrew.geometry.interpolation import chain, nlerp, sclerp, sdlb
from elbowscrew.geometry.registration import (
    FittedPose,
    fit_poses,
    fit_poses_dual_qr,
    nonrigid_coordinates,
    pose_from_points,
)
from elbowscrew.geometry.screw import (
    Screw,
    compose_screws,
    dual_matrix_from_dual_quat,
    dual_quat_from_dual_matrix,
    dual_quat_from_screw,
    line_through,
    point_nearest_origin,
    screw_from_dual_matrix,
    screw_from_dual_quat,
)
from elbowscrew.geometry.spline import catmull_rom

__all__ = [
    "DualMatrix",
    "DualNumber",
    "FittedPose",
    "IterativeBlend",
    "Screw",
    "WayRound",
    "catmull_rom",
    "chain",
    "compose_screws",
    "dib",
    "dlb",
    "dual_matrix",
    "dual_matrix_from_dual_quat",
    "dual_number",
    "dual_quat_from_dual_matrix",
    "dual_quat_from_screw",
    "dual_quaternion",
    "dual_vector",
    "fit_poses",
    "fit_poses_dual_qr",
    "general",
    "lagrange_weights",
    "line_through",
    "nlerp",
    "nonrigid_coordinates",
    "point_nearest_origin",
    "pose_from_points",
    "quaternion",
    "sclerp",
    "screw_from_dual_matrix",
    "screw_from_dual_quat",
    "sdlb",
    "twist",
]
