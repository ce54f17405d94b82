"""The joint by its type in space: its axes or its center as each body sees them at the reference."""

from __future__ import annotations

from typing import Any, Final, Literal, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, pose_from_dual_quat, transform_points
from elbowscrew.geometry.quaternion import quat_from_rotation_vector, rotate
from elbowscrew.model.joint_summary_types import EstimateSummary
from elbowscrew.view.scene import Region
from elbowscrew.view.trial_view import TrialView

End = Literal["proximal", "distal"]

_CARRIED: Final = 7
_SHORTEST: Final = 0.03  # m

ANGLE_NAMES: Final = {
    1: ("Joint angle",),
    2: ("Angle 1", "Angle 2"),
    3: ("Rotation x", "Rotation y", "Rotation z"),
}
"""What the joint's own angles are called, by how many there are: by no anatomy, which the clusters do not know."""


class AxisInBody(NamedTuple):
    """An axis in one body, meters: how it lies there at the reference, and where the other axis carries it.

    `lines` (K, 2, 3) are its direction and point at K angles about the other axis; none where it is fixed in this
    body. `known` holds 95 %; None where the axis is not determined.
    """

    name: str
    direction: Float
    point: Float
    lines: Float
    known: Region | None

    def ends(self, half: float) -> Float:
        """Both ends (2, 3) of a piece of it."""
        found: Float = self.point + half * np.outer([-1.0, 1.0], self.direction)
        return found


class JointInBody(NamedTuple):
    """What a body sees of the joint at the reference, meters.

    Which one it is and its word; its own markers (M, 3) and the other body's, None where the file has none; the other
    body's origin (3,); the axes; and the center (3,) with the semi-axes (3, 3) of its 95 % ellipsoid, None where there
    is none.
    """

    end: End
    word: str
    markers: Float | None
    other_markers: Float | None
    other_origin: Float
    axes: tuple[AxisInBody, ...]
    center: Float | None
    semi_axes: Float | None

    @property
    def points(self) -> Float:
        """All that stands there, shape (M, 3)."""
        parts = [np.zeros((1, 3)), self.other_origin[None]]
        parts += [markers for markers in (self.markers, self.other_markers) if markers is not None]
        parts += [axis.point[None] for axis in self.axes]
        parts += [] if self.center is None else [self.center[None]]
        return np.concatenate(parts)

    @property
    def half(self) -> float:
        """Half the length that an axis is drawn with."""
        return max(0.45 * float(np.ptp(self.points, axis=0).max()), _SHORTEST)


def joint_in_body(view: TrialView, end: End) -> JointInBody:
    """Gather what one of the bodies sees of the joint, at the reference."""
    proximal = end == "proximal"
    to_here = view.reference if proximal else conjugate(view.reference)
    markers = view.proximal_markers, view.distal_markers
    here, there = markers if proximal else markers[::-1]
    ball, words = view.joint_summary["ball"], view.named_joint
    center = None if ball is None else ball["center_in_proximal_mm" if proximal else "center_in_distal_mm"]
    return JointInBody(
        end=end,
        word=words.proximal.name if proximal else words.distal.name,
        markers=here,
        other_markers=None if there is None else transform_points(to_here, there),
        other_origin=pose_from_dual_quat(to_here)[1],
        axes=_axes(view, end),
        center=None if center is None else _meters(center),
        semi_axes=None
        if ball is None or ball["semi_axes95_mm"] is None
        else _semi_axes(_meters(ball["semi_axes95_mm"]), view.reference, end),
    )


def _meters(millimeters: Any) -> Float:
    return np.array(millimeters, dtype=np.float64) / 1000.0


def _semi_axes(proximal: Float, reference: Float, end: End) -> Float:
    """The ellipsoid as the body sees it, that in the proximal body."""
    if end == "proximal":
        return proximal
    return rotate(pose_from_dual_quat(conjugate(reference))[0], proximal)


def _axes(view: TrialView, end: End) -> tuple[AxisInBody, ...]:
    """The axes of the joint: two, or the one that is told first."""
    joint = view.joint_summary
    two = joint["two_axes"]
    if two is None:
        one = joint["mean_axis"] or (None if joint["preferred"] is None else joint[joint["preferred"]])
        if one is None:
            return ()
        return (_in_body("axis", one, end, _region(one["axis_cone95_deg"], one["point_radius95_mm"])),)
    axes = [
        _in_body(name, line, end, _region(line["cone95_deg"], line["radius95_mm"]))
        for name, line in (("axis 1", two["axis1"]), ("axis 2", two["axis2"]))
    ]
    if view.joint_angles is not None:
        # In the distal body the first axis goes round the second, the other way.
        about, moving, sense = (0, 1, 1.0) if end == "proximal" else (1, 0, -1.0)
        angle = view.joint_angles.angle[:, about]
        turns = sense * np.linspace(np.nanmin(angle), np.nanmax(angle), _CARRIED)
        axes[moving] = axes[moving]._replace(lines=carried(axes[moving], axes[about], turns))
    return tuple(axes)


def _in_body(name: str, line: EstimateSummary, end: End, known: Region | None) -> AxisInBody:
    if end == "proximal":
        direction, point = line["direction_in_proximal"], line["point_in_proximal_mm"]
    else:
        direction, point = line["direction_in_distal"], line["point_in_distal_mm"]
    return AxisInBody(name, np.array(direction, dtype=np.float64), _meters(point), np.zeros((0, 2, 3)), known)


def _region(cone_deg: float | None, radius_mm: float | None) -> Region | None:
    return None if cone_deg is None or radius_mm is None else Region(float(np.radians(cone_deg)), radius_mm / 1000.0)


def carried(axis: AxisInBody, about: AxisInBody, angle: Float) -> Float:
    """Direction and point (K, 2, 3) of an axis that was turned by angles (K,) about another one."""
    turn = quat_from_rotation_vector(angle[:, None] * about.direction)
    return np.stack([rotate(turn, axis.direction), about.point + rotate(turn, axis.point - about.point)], axis=1)
