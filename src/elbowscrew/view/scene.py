"""What stands in space around the joint, in the frame the screws are expressed in: axes, bodies and the path."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.dual_quaternion import conjugate, multiply, pose_from_dual_quat, transform_points
from elbowscrew.geometry.quaternion import rotate
from elbowscrew.view.trial_view import ENDS, End, TrialView

_MOST_AXES: Final = 60
_STEEPEST: Final = 1.4


class Bodies(NamedTuple):
    """Bodies in the frame shown, meters.

    The path (N, 3) of the distal body's origin with its mean (3,) and the corners (2, 3) of the box about it, and where
    it is at the reference (3,); the proximal body's origin (3,), None without one; and the markers (M, 3) of the
    proximal and of the distal body at the reference, None where the file has none.
    """

    path: Float
    middle: Float
    corners: Float
    start: Float
    proximal: Float | None
    proximal_markers: Float | None
    distal_markers: Float | None


class Region(NamedTuple):
    """What holds 95 % of lines about an axis: a half-angle (rad) and a radius, meters unless scaled."""

    angle: float
    radius: float

    def reach(self, along: Float) -> Float:
        """How far from the axis it reaches: position and direction err independently of each other."""
        reach: Float = np.hypot(self.radius, np.tan(min(self.angle, _STEEPEST)) * along)
        return reach


class Bundle(NamedTuple):
    """The joint's axis among the axes of the frames, meters unless scaled.

    It passes `center` along `direction` and is drawn `half` to either side; `rows` are some of the frames with an axis
    and `segments` (M, 2, 3) pieces of these. Its name says that it is the mean axis where the motion has no single one,
    and then there is no `confidence`.
    """

    name: str
    direction: Float
    center: Float
    half: float
    rows: NDArray[np.int64]
    segments: Float
    spread: Region
    confidence: Region | None

    @property
    def regions(self) -> dict[str, Region]:
        """What holds 95 % of the frames' axes (``spread``) and of the joint's axis (``confidence``), if known."""
        named = {"spread": self.spread, "confidence": self.confidence}
        return {
            name: region
            for name, region in named.items()
            if region is not None and np.isfinite([region.angle, region.radius]).all()
        }

    def reach_across(self, widest: float) -> float:
        """How far across the axis a view of it goes: as far as the regions, or as most of the axes that are drawn.

        The latter where no region is known or one has a half-angle beyond `widest` (rad).
        """
        regions = self.regions.values()
        if regions and all(region.angle <= widest for region in regions):
            return max(float(region.reach(np.array([self.half]))[0]) for region in regions) or 1.0
        offset = self.segments - self.center
        across = offset - (offset @ self.direction)[..., None] * self.direction
        return float(np.percentile(np.linalg.norm(across, axis=2), 95.0)) or 1.0

    def scaled(self, scale: float) -> Bundle:
        """Give the same bundle in another unit of length."""
        spread, known = self.spread, self.confidence
        return self._replace(
            center=scale * self.center,
            half=scale * self.half,
            segments=scale * self.segments,
            spread=Region(spread.angle, scale * spread.radius),
            confidence=None if known is None else Region(known.angle, scale * known.radius),
        )


def frames_in_space(view: TrialView) -> tuple[Float, Float]:
    """Poses (8,) of the proximal and of the distal body at the reference, in the frame the screws are expressed in."""
    reference, proximal = view.reference, view.proximal_in_lab
    identity = np.array([1.0, 0, 0, 0, 0, 0, 0, 0])
    return {
        "distal": (conjugate(reference), identity),
        "proximal": (identity, reference),
        "lab": (proximal, multiply(proximal, reference)),
    }[view.settings.express_in]


def bodies_in_space(view: TrialView) -> Bodies:
    """Place the bodies in the frame the screws are expressed in."""
    change, at_reference = frames_in_space(view)
    markers = [
        None if offsets is None else transform_points(pose, offsets)
        for offsets, pose in ((view.proximal_markers, change), (view.distal_markers, at_reference))
    ]
    start = pose_from_dual_quat(at_reference)[1]
    # The displacement takes the distal body's origin along from where it is at the reference.
    path = view.translation
    if start.any():
        path = path + rotate(view.euler_parameters, start)
    return Bodies(
        path=path,
        middle=np.mean(path, axis=0, where=np.isfinite(path)),
        corners=np.stack([np.fmin.reduce(path, axis=0), np.fmax.reduce(path, axis=0)]),
        start=start,
        proximal=None if view.proximal_name is None else pose_from_dual_quat(change)[1],
        proximal_markers=markers[0],
        distal_markers=markers[1],
    )


def bones_in_space(view: TrialView) -> dict[End, Float]:
    """Place the vertices (V, 3) of the bones' meshes as they are at the reference, in that frame, meters."""
    poses = dict(zip(ENDS, frames_in_space(view), strict=True))
    return {end: transform_points(poses[end], mesh.vertices) for end, mesh in view.meshes.items()}


def joint_bundle(view: TrialView) -> Bundle:
    """Gather the joint's axis, the axes of the frames about it, and what holds 95 % of each."""
    direction, point, known = view.joint_direction, view.joint_point, view.confidence95
    bodies = bodies_in_space(view)
    center = point + ((bodies.middle - point) @ direction) * direction
    half = half_length(bodies, center)
    rows, segments = axis_segments(view, center, half)
    return Bundle(
        name="mean axis" if known is None else "joint axis",
        direction=direction,
        center=center,
        half=1.15 * half,
        rows=rows,
        segments=segments,
        spread=Region(*view.spread95),
        confidence=None if known is None else Region(*known),
    )


def half_length(bodies: Bodies, center: Float) -> float:
    """Tell how far to either side of a center (3,) on it an axis is drawn beside the path: a little over half of it."""
    return 0.55 * float(np.max(np.ptp(np.concatenate([bodies.corners, center[None]]), axis=0)))


def axis_segments(view: TrialView, center: Float, half: float) -> tuple[NDArray[np.int64], Float]:
    """Rows (M,) of some of the frames with an axis, and pieces (M, 2, 3) of their axes about the center, meters."""
    rows = evenly_thinned(np.flatnonzero(view.axis_known), _MOST_AXES)
    direction, point = view.axis_direction[rows], view.axis_point[rows]
    middle = point + np.sum((center - point) * direction, axis=1, keepdims=True) * direction
    return rows, np.stack([middle - half * direction, middle + half * direction], axis=1)


def directions_across(direction: Float) -> tuple[tuple[Float, Float], tuple[str, str]]:
    """Two unit vectors across a direction (3,), and the coordinates that they lean to."""
    n = direction
    order = np.argsort(np.abs(n), kind="stable")
    first, second = sorted(order[:2])
    u = np.eye(3)[first] - n[first] * n
    u /= np.linalg.norm(u)
    v = np.cross(n, u)
    if v[second] < 0.0:
        v = -v
    return (u, v), ("xyz"[first], "xyz"[second])
