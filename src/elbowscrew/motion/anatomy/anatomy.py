"""The elbow in the bones' own frames: flexion, carrying angle, pronation, and the screw axis beside the epicondyles.

Frames and sequence are the ISB's (Wu and others 2005, J Biomech 38:981-992): X forward, Y proximal, Z to the subject's
right, and ``R = Rz(flexion) Rx(carrying) Ry(pronation)`` of the forearm seen from the humerus. For left arms the ISB
mirrors the data, z to -z; the same angles come without mirroring if the second and third change their sign.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.choices import ExpressIn
from elbowscrew.errors import SettingError
from elbowscrew.geometry import line_through
from elbowscrew.geometry._small_angle import divide, length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import (
    conjugate,
    dual_quat_from_pose,
    multiply,
    transform_lines,
    transform_points,
)
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix, rotation_matrix_from_quat
from elbowscrew.joints import ELBOW, GENERIC, Joint, side_between, side_of
from elbowscrew.model import JointMotion, QualityWarning, Recording, RigidBody
from elbowscrew.model.anatomy import NO_LIMITS, AnatomicalMotion, Landmarks, Side
from elbowscrew.motion.anatomy.functional_axis import FunctionalAxis
from elbowscrew.motion.anatomy.landmarks import landmark_points
from elbowscrew.motion.difference import angle_of_lines
from elbowscrew.motion.screws.relative import frame_change

# Noise of flexion and pronation grows as 1/cos(carrying): here 11.5 times, as that of an axis at 10 deg of rotation.
_GIMBAL_LOCK: Final = np.radians(5.0)
# Sine of an angle: landmarks nearer to one line than this give no plane.
_FLATNESS: Final = 0.02
# No elbow is overextended or oversupinated so far in the middle of its motion.
_LEAST_MEDIAN_FLEXION: Final = np.radians(-30.0)
_LEAST_MEDIAN_PRONATION: Final = np.radians(-60.0)


class ElbowAngles(NamedTuple):
    """Angles of the ISB's sequence Z-X-Y, radians, shape (...).

    Attributes
    ----------
    flexion : ndarray
        About the humerus' Z: positive in flexion, negative in hyperextension; in (-pi, pi].
    carrying_angle : ndarray
        About the floating X: positive in varus, so that the usual carrying angle, in valgus, is negative; within pi/2.
    pronation : ndarray
        About the forearm's Y: 0 where the styloids lie as the epicondyles do, positive in pronation; in (-pi, pi].
    """

    flexion: Float
    carrying_angle: Float
    pronation: Float


def humerus_frame(GH: ArrayLike, EL: ArrayLike, EM: ArrayLike, side: Side) -> Float:
    """Pose of the humerus' frame, shape (..., 8), in the frame that its landmarks are given in.

    Origin GH; Y from the middle of EL and EM to GH; X across the plane of the three, forward; Z to the subject's right.

    Parameters
    ----------
    GH, EL, EM : array_like, shape (..., 3)
        Meters.
    side : {"right", "left"}

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the three are nearly on one line.

    References
    ----------
    Wu and others 2005, the first of the humerus' two options.

    Examples
    --------
    >>> humerus_frame([0, 0, 0], [0, -0.3, 0.03], [0, -0.3, -0.03], "right")
    array([1., 0., 0., 0., 0., 0., 0., 0.])
    """
    gh, el, em = (np.asarray(point, dtype=np.float64) for point in (GH, EL, EM))
    return _frame(gh, gh - 0.5 * (el + em), el - em, side)


def distal_frame(US: ArrayLike, RS: ArrayLike, EL: ArrayLike, EM: ArrayLike, side: Side) -> Float:
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


def elbow_angles(dual_quat_humerus_distal: ArrayLike, side: Side) -> ElbowAngles:
    """Angles of the forearm's frame seen from the humerus', each for itself.

    Flexion and pronation are NaN where the carrying angle is within 5 deg of a right angle (gimbal lock): there only
    their sum or difference is known.

    Parameters
    ----------
    dual_quat_humerus_distal : array_like, shape (..., 8)
    side : {"right", "left"}

    References
    ----------
    Wu and others 2005, 3.4.1, the elbow.
    """
    R = rotation_matrix_from_quat(np.asarray(dual_quat_humerus_distal, dtype=np.float64)[..., :4])
    cosine = np.hypot(R[..., 0, 1], R[..., 1, 1])
    locked = cosine < np.sin(_GIMBAL_LOCK)
    flexion = np.where(locked, np.nan, np.arctan2(-R[..., 0, 1], R[..., 1, 1]))
    pronation = np.where(locked, np.nan, np.arctan2(-R[..., 2, 0], R[..., 2, 2]))
    mirrored = _mirrored(side)
    return ElbowAngles(flexion, mirrored * np.arctan2(R[..., 2, 1], cosine), mirrored * pronation)


def angle_to_epicondyles(axis_direction: ArrayLike, epicondyle_line: ArrayLike) -> Float:
    """Angle between screw axes and the epicondyle line, either way round: radians, shape (...), 0 to pi/2.

    Parameters
    ----------
    axis_direction : array_like, shape (..., 3)
        Unit vectors in the arm's frame.
    epicondyle_line : array_like, shape (6,)
        Plücker vector in the arm's frame.

    Examples
    --------
    >>> float(np.degrees(angle_to_epicondyles([0, 0, -1], [0, 0, 1, 0, 0, 0])))
    0.0
    """
    h = np.asarray(axis_direction, dtype=np.float64)
    along = np.asarray(epicondyle_line, dtype=np.float64)[:3]
    return angle_of_lines(h, along)


def distance_from_point(axis_line: ArrayLike, point: ArrayLike) -> Float:
    """Distance, shape (...), of lines (..., 6) from a point (3,), as of screw axes from the epicondyles' midpoint."""
    line = np.asarray(axis_line, dtype=np.float64)
    return length(line[..., 3:] - np.cross(np.asarray(point, dtype=np.float64), line[..., :3]))


def proximal_lines(lines: Float, joint: JointMotion, express_in: ExpressIn) -> Float:
    """Write lines (..., 6) of the frame that the screws are expressed in, in the arm's."""
    return transform_lines(multiply(joint.reference, conjugate(frame_change(joint, express_in))), lines)


def anatomical_motion(
    landmarks: Landmarks,
    recording: Recording,
    proximal: RigidBody | None,
    distal: RigidBody,
    joint: JointMotion,
    *,
    axis_lines: Float,
    functional: FunctionalAxis | None,
) -> tuple[AnatomicalMotion, tuple[QualityWarning, ...]]:
    """Angles of the elbow in every frame, and its screw axes beside the epicondyle line.

    The epicondyles belong to the humerus. The forearm's frame needs them, too: it takes their positions at the
    reference and keeps them fixed in the forearm.

    Parameters
    ----------
    landmarks : Landmarks
    recording : Recording
        Read with the landmarks' markers.
    proximal : RigidBody or None
        None if it stands still; its frame is then the laboratory's.
    distal : RigidBody
    joint : JointMotion
    axis_lines : ndarray, shape (N, 6)
        Finite helical axis of each frame in the arm's frame (`proximal_lines`); NaN where there is none.
    functional : FunctionalAxis or None
        What the elbow flexes about; None if the motion shows no such axis.

    Returns
    -------
    AnatomicalMotion
    tuple of QualityWarning
        "landmark-moves" for a marker that does not rest in its body, "landmarks-doubtful" for angles no elbow has.

    Raises
    ------
    SettingError
        If a marker is not in the recording or never seen together with its body, or landmarks lie on one line.
    """
    points, warnings = landmark_points(landmarks, recording, {"proximal": proximal, "distal": distal}, joint)
    EL, EM = (transform_points(conjugate(joint.reference), points[name]) for name in ("EL", "EM"))
    humerus = humerus_frame(points["GH"], points["EL"], points["EM"], landmarks.side)
    distal_isb = distal_frame(points["US"], points["RS"], EL, EM, landmarks.side)
    for frame, names in ((humerus, "GH, EL and EM"), (distal_isb, "US, RS and the middle of EL and EM")):
        if not np.isfinite(frame).all():
            msg = f"{landmarks.source}: {names} lie nearly on one line and give no plane; check their positions"
            raise SettingError(msg)
    angles = elbow_angles(
        multiply(multiply(conjugate(humerus), joint.dual_quat_proximal_distal), distal_isb), landmarks.side
    )
    line = line_through(points["EM"], points["EL"] - points["EM"])
    center = 0.5 * (points["EL"] + points["EM"])
    motion = AnatomicalMotion(
        side=landmarks.side,
        frame=recording.frame,
        time_s=recording.time_s,
        flexion=_continuous(angles.flexion),
        carrying_angle=angles.carrying_angle,
        pronation=_continuous(angles.pronation),
        axis_angle=angle_to_epicondyles(axis_lines[:, :3], line),
        axis_distance=distance_from_point(axis_lines, center),
        functional_axis=None if functional is None else functional.name,
        functional_axis_angle=NO_LIMITS if functional is None else functional.angle_to(line[:3]),
        functional_axis_distance=NO_LIMITS if functional is None else functional.distance_from(center),
        epicondyle_line=line,
        joint_center_proximal=center,
        joint_center_distal=0.5 * (EL + EM),
        dual_quat_proximal_humerus=humerus,
        dual_quat_distal_isb=distal_isb,
        points=points,
        landmarks=landmarks,
    )
    return motion, (*warnings, *_doubts(motion, landmarks))


def joint_of_landmarks(named: Joint, landmarks: Landmarks) -> Joint:
    """Give the joint that landmarks are of: an elbow, whose bones the ISB's frames are built from.

    Raises
    ------
    SettingError
        If the bodies, or ``--joint``, speak of another joint.
    """
    if named not in (GENERIC, ELBOW):
        msg = (
            f"{landmarks.source}: landmarks are for the elbow, and the joint is the {named.name} "
            f"({named.proximal.name} and {named.distal.name}); leave --landmarks out"
        )
        raise SettingError(msg)
    return ELBOW


def side_doubts(
    landmarks: Landmarks, proximal: RigidBody | None, distal: RigidBody, *, named: bool
) -> tuple[QualityWarning, ...]:
    """Look whether the landmarks are of the side that the bodies' names speak of: the angles' signs hang on it.

    Parameters
    ----------
    landmarks : Landmarks
    proximal : RigidBody or None
    distal : RigidBody
    named : bool
        Whether options name the bodies: then a body of another side may be meant.

    Returns
    -------
    tuple of QualityWarning
        "landmarks-side" where they disagree and options name the bodies.

    Raises
    ------
    SettingError
        If they disagree otherwise.
    """
    side = side_of(distal.name) if proximal is None else side_between(proximal.name, distal.name)
    if side in (None, landmarks.side):
        return ()
    bodies = f"{distal.name!r}" if proximal is None else f"{proximal.name!r} and {distal.name!r}"
    message = f"{landmarks.source}: the landmarks are of the {landmarks.side} side, and {bodies} of the {side} one"
    if not named:
        what = "--distal" if proximal is None else "both --proximal and --distal"
        msg = f'{message}; write side = "{side}" there, or give {what} if that is meant'
        raise SettingError(msg)
    return (QualityWarning(code="landmarks-side", message=f"{message}; its side decides the signs of the angles"),)


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


def _continuous(angle: Float) -> Float:
    """Make angles (N,) continuous in time; across a gap they go the shorter way."""
    known = np.isfinite(angle)
    unwrapped = angle.copy()
    unwrapped[known] = np.unwrap(angle[known])
    return unwrapped


def _doubts(motion: AnatomicalMotion, landmarks: Landmarks) -> tuple[QualityWarning, ...]:
    """Warn of angles that come of landmarks or sides taken for each other."""
    known = np.isfinite(motion.flexion)
    if not known.any():
        return ()
    flexion, pronation = (float(np.median(angle[known])) for angle in (motion.flexion, motion.pronation))
    if flexion >= _LEAST_MEDIAN_FLEXION and pronation >= _LEAST_MEDIAN_PRONATION:
        return ()
    message = (
        f"{landmarks.source}: flexion is {np.degrees(flexion):.0f} deg and pronation {np.degrees(pronation):.0f} deg "
        "in the median, which no elbow does: check that the side is right, and that EL and EM, or US and RS, are not "
        "exchanged"
    )
    return (QualityWarning(code="landmarks-doubtful", message=message),)
