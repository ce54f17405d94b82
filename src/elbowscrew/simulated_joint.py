"""The joints that synthetic trials move by: their lines or center, their clusters of markers, and the truth of them."""

from __future__ import annotations

from typing import Any, Final, Literal, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quat_from_screw, line_through, point_nearest_origin, quaternion
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.geometry.dual_quaternion import (
    conjugate,
    dual_quat_from_pose,
    multiply,
    transform_lines,
    transform_points,
)
from elbowscrew.model.anatomy import LANDMARK_BODIES, LANDMARKS_OF, BonyJoint, Landmark, Landmarks, Side

# An adult's arm: the line through the elbow in the arm's frame, tilted as the trochlea is; the forearm's line from the
# head of the ulna past the capitulum, with the arm at rest; the segments' markers.
_JOINT_POINT: Final = np.array([0.004, -0.132, 0.011])
_JOINT_DIRECTION: Final = np.array([0.986, 0.104, -0.131])
_SECOND_POINT: Final = np.array([0.016, -0.128, 0.017])
_SECOND_DIRECTION: Final = np.array([0.058, 0.967, -0.248])
_ACROSS: Final = np.array([0.0, 1.0, 0.0])
_FOREARM_CENTER: Final = np.array([0.018, -0.251, 0.037])
_FOREARM_TURN: Final = np.array([0.09, 0.21, -0.06])
_ARM_MARKERS: Final = np.array([[38, 12, 31], [-41, 27, 8], [9, -44, -28], [-6, 5, -47]]) * 1e-3
_FOREARM_MARKERS: Final = np.array([[35, 33, -9], [-37, 14, 25], [-11, -45, 19], [28, -21, -38]]) * 1e-3
# Landmarks of a right limb with its distal body at rest, in the proximal body's frame, mm: the line of the epicondyles
# is 3.7 deg off the hinge in an elbow and 3.2 deg in a knee, which flexes the other way: so it has its front behind.
_LANDMARKS: Final[dict[BonyJoint, dict[str, tuple[float, float, float]]]] = {
    "elbow": {
        "EL": (37.6, -128.1, 7.5),
        "EM": (-25.6, -130.9, 17.5),
        "GH": (12.0, 140.0, -94.0),
        "US": (24.0, -368.0, 60.0),
        "RS": (58.0, -366.0, 22.0),
    },
    "knee": {
        "FLE": (-36.7, -215.3, 19.4),
        "FME": (46.7, -210.7, 10.6),
        "HC": (-17.0, 193.0, 64.0),
        "LC": (-30.8, -235.0, 12.7),
        "MC": (43.2, -235.0, 14.0),
        "LM": (-26.4, -602.4, -69.7),
        "MM": (40.6, -598.6, -42.2),
    },
}
_SIZES: Final = {
    "elbow": 1.0, "wrist": 0.8, "knee": 1.6, "ankle": 1.5, "hip": 1.5, "shoulder": 1.1, "finger": 0.3,
}  # fmt: skip
"""Lengths of the segments beside an arm's; the clusters of markers of smaller ones are smaller, too."""
_ACROSS_MIRRORED: Final = np.array([-1.0, 1.0, 1.0])
"""A left joint is the mirror image of a right one in the plane across x, which the joint's line lies near."""
_ODD_COURSE_RANGE: Final = 0.75 * np.sqrt(3.0)
_BALL_SHARES: Final = (0.5, 0.35)

_LAB, _PROXIMAL, _DISTAL = "lab", "proximal", "distal"


class Geometry(NamedTuple):
    """The joint's lines in the proximal body, the distal body's pose there at the start, and the clusters; meters.

    Attributes
    ----------
    line : ndarray, shape (6,)
        The hinge's, and the first of two axes; its point is a ball's center.
    center : ndarray, shape (3,)
    second : ndarray, shape (6,)
        The second of two axes, which is the distal body's.
    across : ndarray, shape (3,)
        Direction that a wandering axis tilts to.
    start : ndarray, shape (8,)
        Pose of the distal body at the start.
    proximal_markers, distal_markers : ndarray, shape (M, 3)
    """

    line: Float
    center: Float
    second: Float
    across: Float
    start: Float
    proximal_markers: Float
    distal_markers: Float

    @classmethod
    def of(cls, joint: str, side: Literal["left", "right"] | None) -> Geometry:
        """Geometry of a joint by its name and side."""
        size = _SIZES[joint]
        cluster = min(size, 1.0)
        mirror, axial = mirrors(side)
        return cls(
            line=line_through(size * mirror * _JOINT_POINT, axial * _JOINT_DIRECTION),
            center=size * mirror * _JOINT_POINT,
            second=line_through(size * mirror * _SECOND_POINT, axial * _SECOND_DIRECTION),
            across=axial * _ACROSS,
            start=dual_quat_from_pose(
                quaternion.quat_from_rotation_vector(axial * _FOREARM_TURN), size * mirror * _FOREARM_CENTER
            ),
            proximal_markers=cluster * mirror * _ARM_MARKERS,
            distal_markers=cluster * mirror * _FOREARM_MARKERS,
        )


def landmarks_of(joint: BonyJoint, side: Side) -> Landmarks:
    """Landmarks of the joint that moves in a synthetic trial, as coordinates in the frames of its two bodies."""
    start, mirror = Geometry.of(joint, side).start, mirrors(side)[0]
    found: dict[str, Any] = {}
    for name in LANDMARKS_OF[joint]:
        body, point = LANDMARK_BODIES[name], 1e-3 * mirror * np.array(_LANDMARKS[joint][name])
        found[name] = Landmark(
            point=point if body == "proximal" else transform_points(conjugate(start), point), frame=body
        )
    return Landmarks(side=side, **found)


def mirrors(side: Literal["left", "right"] | None) -> tuple[Float, Float]:
    """Factors (3,) of points and of axes of rotation: these are axial vectors and turn round in a mirror as well."""
    if side == "left":
        return _ACROSS_MIRRORED, -_ACROSS_MIRRORED
    return np.ones(3), np.ones(3)


class JointCourse(NamedTuple):
    """How a joint moved.

    Attributes
    ----------
    pose : ndarray, shape (N, 8)
        The distal body in the proximal one.
    theta : ndarray, shape (N,)
        Angle of the whole rotation since the start, rad.
    slide : ndarray, shape (N,)
        Along the one axis, m; NaN where there is more than one.
    truth : dict
        Type, lines or center, and the joint's own angles, ready for JSON.
    """

    pose: Float
    theta: Float
    slide: Float
    truth: dict[str, Any]


def one_axis(geometry: Geometry, angle: Float, slide: Float, tilt: Float, lab: Float) -> JointCourse:
    """Turn (N,) and slide (N,) along a line that tilts by angles (N,); `lab` is the proximal body's first pose."""
    lines = _tilted(geometry, tilt)
    pose = multiply(dual_quat_from_screw(angle, slide, lines[:, :3], lines[:, 3:]), geometry.start)
    kind = "screw_hinge" if slide.any() else "hinge"
    truth = {
        "joint_type": kind,
        "axis": _in_all(geometry.line, geometry.start, lab),
        "joint_angles": {"angle1_deg": np.degrees(angle).tolist()},
    }
    return JointCourse(pose, angle, slide, truth)


def two_axes(geometry: Geometry, first: Float, second: Float, tilt: Float, lab: Float) -> JointCourse:
    """Turn by angles (N,) about an axis of the proximal body, and (N,) about one of the distal body."""
    lines, other = _tilted(geometry, tilt), geometry.second
    turn = multiply(_turned(first, lines), _turned(second, other))
    truth = {
        "joint_type": "two_axes",
        "two_axes": {
            "axis1": _in_all(geometry.line, geometry.start, lab),
            "axis2": _in_all(geometry.second, geometry.start, lab),
            **_common_normal(geometry),
        },
        "joint_angles": {"angle1_deg": np.degrees(first).tolist(), "angle2_deg": np.degrees(second).tolist()},
    }
    return JointCourse(multiply(turn, geometry.start), _whole_angle(turn), np.full(first.size, np.nan), truth)


def ball(geometry: Geometry, course: Float, progress: Float, returns: Bool) -> JointCourse:
    """Turn by angles (N,) about the hinge's direction, with smaller turns across it, all about one point."""
    h = geometry.line[:3]
    along = geometry.second[:3] - (geometry.second[:3] @ h) * h
    along = along / length(along)
    top = float(np.abs(course).max())
    turn = quaternion.quat_from_rotation_vector(course[:, None] * h)
    shares = (odd_course(progress, returns), np.sin(np.pi * progress) ** 2)
    for size, share, axis in zip(_BALL_SHARES, shares, (along, np.cross(h, along)), strict=True):
        turn = quaternion.multiply(turn, quaternion.quat_from_rotation_vector((size * top * share)[:, None] * axis))
    center = geometry.center
    pose = multiply(dual_quat_from_pose(turn, center - quaternion.rotate(turn, center)), geometry.start)
    theta = _whole_angle(turn)
    vector = 2.0 * np.arctan2(length(turn[:, 1:]), turn[:, 0])[:, None] * _unit_or_zero(turn[:, 1:])
    truth = {
        "joint_type": "ball",
        "ball": {
            "center_in_proximal_mm": (1000.0 * center).tolist(),
            "center_in_distal_mm": (1000.0 * transform_points(conjugate(geometry.start), center)).tolist(),
        },
        "joint_angles": {f"rotation_{axis}_deg": np.degrees(vector[:, k]).tolist() for k, axis in enumerate("xyz")},
    }
    return JointCourse(pose, theta, np.full(theta.size, np.nan), truth)


def odd_course(progress: Float, returns: Bool) -> Float:
    """A course (N,) of range 1 that goes one way while the first angle rises, and the other while it falls.

    It rests where the first angle does, at its start and its top, and has there the value 0: so the two angles go
    round in a figure of eight, and neither is a function of the other.
    """
    x = 0.5 * np.pi * progress
    way = np.where(returns, -1.0, 1.0)
    return np.asarray(way * np.sin(2.0 * x) * np.sin(x) ** 2 / _ODD_COURSE_RANGE)


def _tilted(geometry: Geometry, tilt: Float) -> Float:
    """Lines (N, 6) through the joint's point, tilted by angles (N,) in a plane through it."""
    direction = geometry.line[:3]
    across = geometry.across - (geometry.across @ direction) * direction
    across = across / length(across)
    tilted = np.cos(tilt)[:, None] * direction + np.sin(tilt)[:, None] * across
    return np.concatenate([tilted, np.cross(geometry.center, tilted)], axis=1)


def _turned(angle: Float, line: Float) -> Float:
    return dual_quat_from_screw(angle, 0.0 * angle, line[..., :3], line[..., 3:])


def _whole_angle(turn: Float) -> Float:
    """Angle (N,) of rotations whose signs go on from the start, 0 to 2 pi."""
    return np.asarray(2.0 * np.arctan2(length(turn[:, 1:4]), turn[:, 0]))


def _unit_or_zero(vector: Float) -> Float:
    size = length(vector)[:, None]
    return np.divide(vector, size, out=np.zeros_like(vector), where=size > 0.0)


def _in_all(line: Float, start: Float, lab: Float) -> dict[str, dict[str, list[float]]]:
    """A line in the distal body, the proximal one and the laboratory, all as at the start."""
    at = {_DISTAL: transform_lines(conjugate(start), line), _PROXIMAL: line, _LAB: transform_lines(lab, line)}
    return {
        frame: {"direction": one[:3].tolist(), "point_mm": (1000.0 * point_nearest_origin(one)).tolist()}
        for frame, one in at.items()
    }


def _common_normal(geometry: Geometry) -> dict[str, float]:
    """Angle, distance and feet of the two axes, as `elbowscrew.model.joint_type.TwoAxes` defines them."""
    (h1, m1), (h2, m2) = ((line[:3], line[3:]) for line in (geometry.line, geometry.second))
    p1, p2 = np.cross(h1, m1), np.cross(h2, m2)
    normal = np.cross(h1, h2)
    along = np.linalg.solve(np.stack([h1, -h2, normal], axis=1), p2 - p1)
    # Along axis 2 from its point nearest the distal body's origin to that nearest the proximal one's.
    back = conjugate(geometry.start)
    shift = float(transform_points(back, np.zeros(3)) @ transform_lines(back, geometry.second)[:3])
    return {
        "angle_between_deg": float(np.degrees(np.arctan2(length(normal), abs(h1 @ h2)))),
        "distance_mm": float(1000.0 * along[2] * length(normal)),
        "foot1_mm": float(1000.0 * along[0]),
        "foot2_mm": float(1000.0 * (along[1] + shift)),
    }
