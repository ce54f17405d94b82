"""A joint in its bones' own frames: its three angles, and the screw axis beside the epicondyles.

Frames and sequence are those of `elbowscrew.motion.anatomy.bone_frames`: the ISB's for the elbow (Wu and others 2005,
J Biomech 38:981-992), Grood and Suntay's for the knee (1983, J Biomech Eng 105:136-144).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from elbowscrew.choices import ExpressIn
from elbowscrew.errors import SettingError
from elbowscrew.geometry import line_through
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, multiply, transform_lines, transform_points
from elbowscrew.geometry.lines import angle_of_lines
from elbowscrew.joints import GENERIC, Joint, joints_of, side_between, side_of
from elbowscrew.model import JointMotion, QualityWarning, Recording, RigidBody
from elbowscrew.model.anatomy import LANDMARK_BODIES, LANDMARKS_OF, NO_LIMITS, AnatomicalMotion, BonyJoint, Landmarks
from elbowscrew.motion.anatomy.bone_frames import BONES, bone_angles, epicondyles, frame_of_proximal
from elbowscrew.motion.anatomy.functional_axis import FunctionalAxis
from elbowscrew.motion.anatomy.landmarks import landmark_points
from elbowscrew.motion.screws.relative import frame_change

# No elbow or knee is overextended so far in a tenth of its motion; nor turned so far in the middle of it.
_LEAST_FLEXION: Final = np.radians(-30.0)
_OF_FRAMES: Final = 10.0
_USUAL_ROTATION: Final[dict[BonyJoint, tuple[float, float]]] = {
    "elbow": (np.radians(-60.0), np.inf),
    "knee": (np.radians(-60.0), np.radians(60.0)),
}
_EXCHANGED: Final[dict[BonyJoint, str]] = {"elbow": "EL and EM, or US and RS", "knee": "FLE and FME, or LC and MC"}


def angle_to_epicondyles(axis_direction: ArrayLike, epicondyle_line: ArrayLike) -> Float:
    """Angle between screw axes and the epicondyle line, either way round: radians, shape (...), 0 to pi/2.

    Parameters
    ----------
    axis_direction : array_like, shape (..., 3)
        Unit vectors in the proximal body's frame.
    epicondyle_line : array_like, shape (6,)
        Plücker vector in the proximal body's frame.

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
    """Write lines (..., 6) of the frame that the screws are expressed in, in the proximal body's."""
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
    """Angles of the bones in every frame, and the joint's screw axes beside the epicondyle line.

    The epicondyles belong to the proximal bone. The forearm's frame needs them, too: it takes their positions at the
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
        Finite helical axis of each frame in the proximal body's frame (`proximal_lines`); NaN where there is none.
    functional : FunctionalAxis or None
        What the joint flexes about; None if the motion shows no such axis.

    Returns
    -------
    AnatomicalMotion
    tuple of QualityWarning
        "landmark-moves" for a marker that does not rest in its body, "landmarks-doubtful" for angles no joint has.

    Raises
    ------
    SettingError
        If a marker is not in the recording or never seen together with its body, or landmarks lie on one line.
    """
    points, warnings = landmark_points(landmarks, recording, {"proximal": proximal, "distal": distal}, joint)
    kind, side = landmarks.joint, landmarks.side
    lateral, medial = epicondyles(points, kind)
    to_distal = conjugate(joint.reference)
    at_reference = points | {
        name: transform_points(to_distal, points[name])
        for name, body in LANDMARK_BODIES.items()
        if name in points and body == "proximal"
    }
    proximal_bone = frame_of_proximal(points, side, kind)
    distal_bone = BONES[kind].distal(at_reference, side)
    for frame, names in zip((proximal_bone, distal_bone), BONES[kind].flat, strict=True):
        if not np.isfinite(frame).all():
            msg = f"{landmarks.source}: {names} lie nearly on one line and give no plane; check their positions"
            raise SettingError(msg)
    found = bone_angles(
        multiply(multiply(conjugate(proximal_bone), joint.dual_quat_proximal_distal), distal_bone), side, kind
    )
    line = line_through(medial, lateral - medial)
    center = 0.5 * (lateral + medial)
    motion = AnatomicalMotion(
        side=side,
        frame=recording.frame,
        time_s=recording.time_s,
        angles=np.stack([_continuous(found.flexion), found.adduction, _continuous(found.rotation)], axis=1),
        axis_angle=angle_to_epicondyles(axis_lines[:, :3], line),
        axis_distance=distance_from_point(axis_lines, center),
        functional_axis=None if functional is None else functional.name,
        functional_axis_angle=NO_LIMITS if functional is None else functional.angle_to(line[:3]),
        functional_axis_distance=NO_LIMITS if functional is None else functional.distance_from(center),
        epicondyle_line=line,
        joint_center_proximal=center,
        joint_center_distal=transform_points(to_distal, center),
        dual_quat_proximal_bone=proximal_bone,
        dual_quat_distal_bone=distal_bone,
        points=points,
        landmarks=landmarks,
    )
    return motion, (*warnings, *_doubts(motion, landmarks))


def joint_of_landmarks(named: Joint, landmarks: Landmarks) -> Joint:
    """Give the joint that landmarks are of, from whose bones their frames are built.

    Raises
    ------
    SettingError
        If the bodies, or ``--joint``, speak of another joint.
    """
    own = joints_of(landmarks.joint)[0]
    if named not in (GENERIC, own):
        needed = next((f", or give {', '.join(of)}" for joint, of in LANDMARKS_OF.items() if joint == named.name), "")
        msg = (
            f"{landmarks.source}: the landmarks are for the {own.name}, and the joint is the {named.name} "
            f"({named.proximal.name} and {named.distal.name}); leave --landmarks out{needed}"
        )
        raise SettingError(msg)
    return own


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
    kind, word = landmarks.joint, motion.names[2].replace("_", " ")
    flexion = float(np.percentile(motion.flexion[known], _OF_FRAMES))
    rotation = float(np.median(motion.angles[known, 2]))
    least, most = _USUAL_ROTATION[kind]
    if flexion >= _LEAST_FLEXION and least <= rotation <= most:
        return ()
    message = (
        f"{landmarks.source}: flexion is {np.degrees(flexion):.0f} deg or less in a tenth of the frames and {word} "
        f"{np.degrees(rotation):.0f} deg in the median, which no {kind} does: check that the side is right, and that "
        f"{_EXCHANGED[kind]}, are not exchanged"
    )
    return (QualityWarning(code="landmarks-doubtful", message=message),)
