"""Anatomical landmarks of an arm, and its motion in the bones' own frames; frozen, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.array_record import ArrayRecord
from elbowscrew.model.table_record import TableRecord

Side = Literal["right", "left"]
LandmarkFrame = Literal["proximal", "distal", "lab"]
FunctionalAxisName = Literal["joint_axis", "axis1"]

LANDMARKS: Final[Mapping[str, str]] = {
    "EL": "lateral epicondyle",
    "EM": "medial epicondyle",
    "US": "ulnar styloid",
    "RS": "radial styloid",
    "GH": "glenohumeral center",
}
"""The names of the landmarks (Wu and others 2005), and what they are."""
LANDMARK_BODIES: Final[Mapping[str, Literal["proximal", "distal"]]] = {
    "EL": "proximal",
    "EM": "proximal",
    "US": "distal",
    "RS": "distal",
    "GH": "proximal",
}
"""The body that each rests in."""


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
    """The landmarks that the frames of humerus and forearm are built from.

    Attributes
    ----------
    side : {"right", "left"}
    EL, EM : Landmark
        Lateral and medial epicondyle.
    US, RS : Landmark
        Ulnar and radial styloid.
    GH : Landmark
        Center of the glenohumeral joint.
    source : str
        Where they come from, for messages.
    """

    side: Side
    EL: Landmark
    EM: Landmark
    US: Landmark
    RS: Landmark
    GH: Landmark
    source: str = "landmarks"

    @property
    def by_name(self) -> dict[str, Landmark]:
        """The five landmarks by their names."""
        return {name: getattr(self, name) for name in LANDMARKS}

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
    """The elbow's angles by the ISB's sequence, and its screw axes beside the epicondyle line.

    Attributes
    ----------
    side : {"right", "left"}
    frame, time_s : ndarray, shape (N,)
    flexion, carrying_angle, pronation : ndarray, shape (N,)
        Angles about the humerus' Z, the floating X and the forearm's Y, radians; of the same sense on both sides;
        flexion and pronation continuous in time, and NaN where the carrying angle is within 5 deg of a right angle.
    axis_angle, axis_distance : ndarray, shape (N,)
        Angle (rad, 0 to pi/2) between each frame's screw axis and the epicondyle line, and distance (m) of the axis
        from the point midway between the epicondyles; NaN where there is no axis.
    functional_axis : {"joint_axis", "axis1"} or None
        What the elbow flexes about: the joint's axis as a whole, its mean where it wanders, or the first of two axes;
        None where the motion shows none.
    functional_axis_angle, functional_axis_distance : Limits
        Its angle (rad) to the epicondyle line and its distance (m) from the midpoint, with 95 % limits for the
        clusters' frames, without the error of the landmarks; NaN without such an axis.
    epicondyle_line : ndarray, shape (6,)
        Plücker vector in the arm's frame, from the medial to the lateral epicondyle.
    joint_center_proximal, joint_center_distal : ndarray, shape (3,)
        The point midway between the epicondyles, in the arm's frame, and in the forearm's at the reference, meters.
    dual_quat_proximal_humerus, dual_quat_distal_isb : ndarray, shape (8,)
        The ISB's frames of humerus and forearm, as poses in the frames of the two bodies.
    points : mapping of str to ndarray, shape (3,)
        EL, EM and GH in the arm's frame, US and RS in the forearm's, meters.
    landmarks : Landmarks
        What was asked for.

    References
    ----------
    Wu and others 2005, J Biomech 38:981-992.
    """

    table: ClassVar = tables.ANATOMY_COLUMNS

    side: Side
    frame: NDArray[np.int64]
    time_s: Float
    flexion: Float
    carrying_angle: Float
    pronation: Float
    axis_angle: Float
    axis_distance: Float
    functional_axis: FunctionalAxisName | None
    functional_axis_angle: Limits
    functional_axis_distance: Limits
    epicondyle_line: Float
    joint_center_proximal: Float
    joint_center_distal: Float
    dual_quat_proximal_humerus: Float
    dual_quat_distal_isb: Float
    points: Mapping[str, Float]
    landmarks: Landmarks

    @property
    def epicondyle_width(self) -> float:
        """Distance between the epicondyles, meters."""
        return float(np.linalg.norm(self.points["EL"] - self.points["EM"]))
