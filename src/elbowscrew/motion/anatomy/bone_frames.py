"""The bones' own frames from landmarks, and the angles between them: elbow and knee by one sequence.

Axes are the ISB's: X forward, Y proximal, Z to the subject's right, and ``R = Rz(a) Rx(b) Ry(c)`` of the distal bone
seen from the proximal one. A forearm flexes forward, to positive a, and a shank backward. For left limbs the ISB
mirrors the data, z to -z; the same angles come without mirroring if the second and third change their sign.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import dual_quat_from_pose
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix, rotation_matrix_from_quat
from elbowscrew.model.anatomy import LANDMARKS_OF, BonyJoint, Side

# Noise of the first and third angle grows as 1/cos(second): here 11.5 times, as that of an axis at 10 deg of rotation.
_GIMBAL_LOCK: Final = np.radians(5.0)
# Sine of an angle: landmarks nearer to one line than this give no plane.
_FLATNESS: Final = 0.02


class BoneAngles(NamedTuple):
    """Angles of the sequence Z-X-Y, radians, shape (...).

    Attributes
    ----------
    flexion : ndarray
        About the proximal bone's Z: positive in flexion, negative in hyperextension; in (-pi, pi].
    adduction : ndarray
        About the floating X: positive in varus, so that an elbow's usual carrying angle, in valgus, is negative; within
        pi/2.
    rotation : ndarray
        About the distal bone's Y: positive in pronation and internal rotation; 0 where the distal bone's landmarks lie
        as the epicondyles do; in (-pi, pi].
    """

    flexion: Float
    adduction: Float
    rotation: Float


def proximal_frame(center: ArrayLike, lateral: ArrayLike, medial: ArrayLike, side: Side) -> Float:
    """Pose of the humerus' or the femur's frame, shape (..., 8), in the frame that its landmarks are given in.

    Origin `center`; Y from the middle of the epicondyles to it; X across the plane of the three, forward; Z to the
    subject's right, across Y in the frontal plane.

    Parameters
    ----------
    center : array_like, shape (..., 3)
        Of the shoulder or the hip, meters.
    lateral, medial : array_like, shape (..., 3)
        The epicondyles, meters.
    side : {"right", "left"}

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the three are nearly on one line.

    References
    ----------
    Wu and others 2005, the first of the humerus' two options; Grood and Suntay 1983, the femur's, from the hip.

    Examples
    --------
    >>> proximal_frame([0, 0, 0], [0, -0.3, 0.03], [0, -0.3, -0.03], "right")
    array([1., 0., 0., 0., 0., 0., 0., 0.])
    """
    top, outer, inner = (np.asarray(point, dtype=np.float64) for point in (center, lateral, medial))
    return _frame(top, top - 0.5 * (outer + inner), outer - inner, side)


def forearm_frame(US: ArrayLike, RS: ArrayLike, EL: ArrayLike, EM: ArrayLike, side: Side) -> Float:
    """Pose of the forearm's frame, shape (..., 8), in the frame that its landmarks are given in.

    Origin US; Y from US to the middle of EL and EM; X across the plane of US, RS and that middle, forward in
    supination; Z to the subject's right.

    Parameters
    ----------
    US, RS, EL, EM : array_like, shape (..., 3)
        Meters.
    side : {"right", "left"}

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the three points are nearly on one line.

    References
    ----------
    Wu and others 2005, the frame of the forearm.
    """
    us, rs, el, em = (np.asarray(point, dtype=np.float64) for point in (US, RS, EL, EM))
    return _frame(us, 0.5 * (el + em) - us, rs - us, side)


def tibia_frame(LC: ArrayLike, MC: ArrayLike, LM: ArrayLike, MM: ArrayLike, side: Side) -> Float:
    """Pose of the tibia's frame, shape (..., 8), in the frame that its landmarks are given in.

    Origin midway between LM and MM, the ankle's center; Y from there to the middle of LC and MC, the plateau's center;
    X across Y and the line of the condyles, forward; Z to the subject's right.

    Parameters
    ----------
    LC, MC, LM, MM : array_like, shape (..., 3)
        Meters.
    side : {"right", "left"}

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the condyles lie nearly along the shank.

    References
    ----------
    Grood and Suntay 1983: the mechanical axis of the tibia, and the line of its condyles.
    """
    lc, mc, lm, mm = (np.asarray(point, dtype=np.float64) for point in (LC, MC, LM, MM))
    ankle = 0.5 * (lm + mm)
    return _frame(ankle, 0.5 * (lc + mc) - ankle, lc - mc, side)


def bone_angles(dual_quat_proximal_distal: ArrayLike, side: Side, joint: BonyJoint) -> BoneAngles:
    """Angles of the distal bone's frame seen from the proximal one's, each for itself.

    They are the rotations about the proximal bone's Z, the distal bone's Y and the floating axis across both, which is
    Grood and Suntay's joint coordinate system. Flexion and rotation are NaN where the second angle is within 5 deg of
    a right angle (gimbal lock): there only their sum or difference is known.

    Parameters
    ----------
    dual_quat_proximal_distal : array_like, shape (..., 8)
    side : {"right", "left"}
    joint : {"elbow", "knee"}
        A knee flexes the other way.

    References
    ----------
    Wu and others 2005, 3.4.1, the elbow; Grood and Suntay 1983, the knee.
    """
    R = rotation_matrix_from_quat(np.asarray(dual_quat_proximal_distal, dtype=np.float64)[..., :4])
    cosine = np.hypot(R[..., 0, 1], R[..., 1, 1])
    locked = cosine < np.sin(_GIMBAL_LOCK)
    forward = 1.0 if joint == "elbow" else -1.0
    flexion = np.where(locked, np.nan, np.arctan2(-forward * R[..., 0, 1], R[..., 1, 1]))
    rotation = np.where(locked, np.nan, np.arctan2(-R[..., 2, 0], R[..., 2, 2]))
    mirrored = _mirrored(side)
    return BoneAngles(flexion, mirrored * np.arctan2(R[..., 2, 1], cosine), mirrored * rotation)


class Bones(NamedTuple):
    """How the frames of a joint's two bones are built from its landmarks.

    Attributes
    ----------
    proximal : tuple of str
        The landmarks of the proximal bone: center, lateral and medial epicondyle.
    distal : callable
        The distal bone's frame, by all points in the distal body's frame and the side.
    flat : tuple of str
        What gives no plane where either frame is NaN.
    """

    proximal: tuple[str, str, str]
    distal: Callable[[Mapping[str, Float], Side], Float]
    flat: tuple[str, str]


BONES: Final[Mapping[BonyJoint, Bones]] = {
    "elbow": Bones(
        ("GH", "EL", "EM"),
        lambda at, side: forearm_frame(at["US"], at["RS"], at["EL"], at["EM"], side),
        ("GH, EL and EM", "US, RS and the middle of EL and EM"),
    ),
    "knee": Bones(
        ("HC", "FLE", "FME"),
        lambda at, side: tibia_frame(at["LC"], at["MC"], at["LM"], at["MM"], side),
        ("HC, FLE and FME", "LC, MC and the middle of LM and MM"),
    ),
}
"""Each joint whose bones have frames; its landmarks stand in `elbowscrew.model.anatomy.LANDMARKS_OF`."""


def frame_of_proximal(points: Mapping[str, Float], side: Side, joint: BonyJoint) -> Float:
    """Pose (8,) of the proximal bone's frame, from its landmarks (3,) by their names."""
    center, lateral, medial = (points[name] for name in BONES[joint].proximal)
    return proximal_frame(center, lateral, medial, side)


def epicondyles(points: Mapping[str, Float], joint: BonyJoint) -> tuple[Float, Float]:
    """Lateral and medial epicondyle, each shape (3,)."""
    lateral, medial = LANDMARKS_OF[joint][:2]
    return points[lateral], points[medial]


def _mirrored(side: Side) -> float:
    return 1.0 if side == "right" else -1.0


def _frame(origin: Float, proximal: Float, radial: Float, side: Side) -> Float:
    """Pose of the frame with Y along `proximal` and Z, as near as may be, along `radial`, or against it on the left."""
    Y, outward = (divide(vector, length(vector)[..., None]) for vector in (proximal, _mirrored(side) * radial))
    across = np.cross(Y, outward)
    sine = length(across)[..., None]
    X = divide(across, np.where(sine < _FLATNESS, np.nan, sine))
    R = np.stack([X, Y, np.cross(X, Y)], axis=-1)
    return dual_quat_from_pose(quat_from_rotation_matrix(R), origin)
