"""Anatomical landmarks, and a joint's motion in its bones' own frames; frozen, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.geometry.arrays import Float
from elbowscrew.joints import joints_of
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.table_record import TableRecord

Side = Literal["right", "left"]
LandmarkFrame = Literal["proximal", "distal", "lab"]
FunctionalAxisName = Literal["joint_axis", "axis1"]

BonyJoint = Literal["elbow", "knee"]
"""A joint whose bones' frames are built from landmarks."""

LANDMARKS: Final[Mapping[str, str]] = {
    "EL": "lateral epicondyle",
    "EM": "medial epicondyle",
    "US": "ulnar styloid",
    "RS": "radial styloid",
    "GH": "glenohumeral center",
    "FLE": "lateral femoral epicondyle",
    "FME": "medial femoral epicondyle",
    "HC": "hip center",
    "LC": "lateral tibial condyle",
    "MC": "medial tibial condyle",
    "LM": "lateral malleolus",
    "MM": "medial malleolus",
}
"""The names of the landmarks (Wu and others 2002 and 2005, Cappozzo and others 1995), and what they are."""
LANDMARK_BODIES: Final[Mapping[str, Literal["proximal", "distal"]]] = {
    **dict.fromkeys(("EL", "EM", "GH", "FLE", "FME", "HC"), "proximal"),
    **dict.fromkeys(("US", "RS", "LC", "MC", "LM", "MM"), "distal"),
}
"""The body that each rests in."""
LANDMARKS_OF: Final[Mapping[BonyJoint, tuple[str, ...]]] = {
    "elbow": ("EL", "EM", "US", "RS", "GH"),
    "knee": ("FLE", "FME", "HC", "LC", "MC", "LM", "MM"),
}
"""The landmarks of each joint; the first two are its epicondyles, lateral and medial."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Landmark(ArrayRecord):
    """Where one landmark is: markers of the recording, or coordinates; one of the two.

    Attributes
    ----------
    markers : tuple of str
        Names; the landmark is in the middle of them.
    point : ndarray, shape (3,), optional
        Meters.
    frame : {"proximal", "distal", "lab"}, optional
        What the coordinates are of: one of the two bodies, or the laboratory at the reference.
    """

    markers: tuple[str, ...] = ()
    point: Float | None = None
    frame: LandmarkFrame | None = None

    def __post_init__(self) -> None:
        """Check what the types cannot."""
        if bool(self.markers) == (self.point is not None) or (self.point is None) != (self.frame is None):
            msg = "a landmark is given by markers, or by a point with its frame"
            raise ValueError(msg)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Landmarks(ArrayRecord):
    """The landmarks that the frames of both bones are built from: all of an elbow, or all of a knee.

    Attributes
    ----------
    side : {"right", "left"}
    EL, EM : Landmark, optional
        Lateral and medial epicondyle of the humerus.
    US, RS : Landmark, optional
        Ulnar and radial styloid.
    GH : Landmark, optional
        Center of the glenohumeral joint.
    FLE, FME : Landmark, optional
        Lateral and medial epicondyle of the femur.
    HC : Landmark, optional
        Center of the hip joint.
    LC, MC : Landmark, optional
        Lateral and medial condyle of the tibia.
    LM, MM : Landmark, optional
        Lateral and medial malleolus.
    source : str
        Where they come from, for messages.
    """

    side: Side
    EL: Landmark | None = None
    EM: Landmark | None = None
    US: Landmark | None = None
    RS: Landmark | None = None
    GH: Landmark | None = None
    FLE: Landmark | None = None
    FME: Landmark | None = None
    HC: Landmark | None = None
    LC: Landmark | None = None
    MC: Landmark | None = None
    LM: Landmark | None = None
    MM: Landmark | None = None
    source: str = "landmarks"

    def __post_init__(self) -> None:
        """Check what the types cannot."""
        given = {name for name in LANDMARKS if getattr(self, name) is not None}
        if not any(given == set(names) for names in LANDMARKS_OF.values()):
            each = "; ".join(f"of the {joint} {', '.join(names)}" for joint, names in LANDMARKS_OF.items())
            msg = f"landmarks are all of one joint: {each}; given: {', '.join(sorted(given)) or 'none'}"
            raise ValueError(msg)

    @property
    def joint(self) -> BonyJoint:
        """The joint they are of."""
        return "elbow" if self.EL is not None else "knee"

    @property
    def by_name(self) -> dict[str, Landmark]:
        """The joint's landmarks by their names."""
        return {name: getattr(self, name) for name in LANDMARKS_OF[self.joint]}

    @property
    def markers(self) -> tuple[str, ...]:
        """All markers wanted of the recording."""
        return tuple(dict.fromkeys(marker for landmark in self.by_name.values() for marker in landmark.markers))


class Limits(NamedTuple):
    """A size with the limits that hold it with 95 %; NaN where they are not known."""

    value: float
    low: float
    high: float


NO_LIMITS: Final = Limits(np.nan, np.nan, np.nan)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AnatomicalMotion(TableRecord):
    """A joint's angles by the sequence of its bones, and its screw axes beside the epicondyle line.

    Attributes
    ----------
    side : {"right", "left"}
    frame, time_s : ndarray, shape (N,)
    angles : ndarray, shape (N, 3)
        Angles about Z of the proximal bone, the floating X and Y of the distal bone, radians, by the names of `names`;
        of the same sense on both sides; first and third continuous in time, and NaN where the second is within 5 deg
        of a right angle.
    axis_angle, axis_distance : ndarray, shape (N,)
        Angle (rad, 0 to pi/2) between each frame's screw axis and the epicondyle line, and distance (m) of the axis
        from the point midway between the epicondyles; NaN where there is no axis.
    functional_axis : {"joint_axis", "axis1"} or None
        What the joint flexes about: its axis as a whole, its mean where it wanders, or the first of two axes;
        None where the motion shows none.
    functional_axis_angle, functional_axis_distance : Limits
        Its angle (rad) to the epicondyle line and its distance (m) from the midpoint, with 95 % limits for the
        clusters' frames, without the error of the landmarks; NaN without such an axis.
    epicondyle_line : ndarray, shape (6,)
        Plücker vector in the proximal body's frame, from the medial to the lateral epicondyle.
    joint_center_proximal, joint_center_distal : ndarray, shape (3,)
        The point midway between the epicondyles, in the proximal body's frame, and in the distal one's at the
        reference, meters.
    dual_quat_proximal_bone, dual_quat_distal_bone : ndarray, shape (8,)
        The frames of both bones, as poses in the frames of the two bodies.
    points : mapping of str to ndarray, shape (3,)
        The landmarks, each in the frame of the body that it rests in, meters.
    landmarks : Landmarks
        What was asked for.

    References
    ----------
    Wu and others 2005, J Biomech 38:981-992 (elbow); Grood and Suntay 1983, J Biomech Eng 105:136-144 (knee).
    """

    side: Side
    frame: NDArray[np.int64]
    time_s: Float
    angles: Float
    axis_angle: Float
    axis_distance: Float
    functional_axis: FunctionalAxisName | None
    functional_axis_angle: Limits
    functional_axis_distance: Limits
    epicondyle_line: Float
    joint_center_proximal: Float
    joint_center_distal: Float
    dual_quat_proximal_bone: Float
    dual_quat_distal_bone: Float
    points: Mapping[str, Float]
    landmarks: Landmarks

    @property
    def table(self) -> tuple[tables.Column, ...]:
        """Columns, those of the joint's own angles among them."""
        return tables.ANATOMY_COLUMNS[self.landmarks.joint]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the three angles, each an attribute."""
        return joints_of(self.landmarks.joint)[0].angle_keys

    @property
    def flexion(self) -> Float:
        """Flexion, shape (N,), rad."""
        return self._angle("flexion")

    @property
    def carrying_angle(self) -> Float:
        """An elbow's carrying angle, shape (N,), rad: varus positive."""
        return self._angle("carrying_angle")

    @property
    def pronation(self) -> Float:
        """An elbow's pronation, shape (N,), rad."""
        return self._angle("pronation")

    @property
    def adduction(self) -> Float:
        """A knee's adduction, shape (N,), rad: varus positive."""
        return self._angle("adduction")

    @property
    def internal_rotation(self) -> Float:
        """A knee's internal rotation, shape (N,), rad."""
        return self._angle("internal_rotation")

    def _angle(self, name: str) -> Float:
        if name not in self.names:
            msg = f"{name} is no angle of the {self.landmarks.joint}; it has {', '.join(self.names)}"
            raise AttributeError(msg)
        return self.angles[:, self.names.index(name)]

    @property
    def epicondyle_width(self) -> float:
        """Distance between the epicondyles, meters."""
        lateral, medial = (self.points[name] for name in LANDMARKS_OF[self.landmarks.joint][:2])
        return float(np.linalg.norm(lateral - medial))
