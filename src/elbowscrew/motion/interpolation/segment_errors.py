"""How far the poses between two keyframes are from the motion that joins these two, for many pairs at once.

Between two poses ScLERP and sDLB both turn about the one screw that joins them. Seen from the first pose, with its
rotation vector r, angle ``theta = |r|`` and the dual part v of its logarithm (doubled), the moving pose is

    R = 1 + f2 [r]x + f3 [r]x [r]x / theta,          d = f1 h h^T v + f2 (1 - h h^T) v + f3 [h]x v

with ``f2 = sin(x)/theta``, ``f3 = (1 - cos x)/theta`` of the angle x turned so far, and f1 the share of the slide. So
the coordinates in which the RMS displacement is the Euclidean distance are three fixed vectors of each pair times
three numbers of each frame.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.model import BodyPoints
from elbowscrew.model.joint_coordinates import JointCoordinates
from elbowscrew.motion.difference import point_coordinates, spokes
from elbowscrew.motion.joint.coordinates import joint_poses

_Basis = Callable[[Float, Float], tuple[Float, Float, Float]]

# Below this the square of an angle is no number, and the turn none.
_SMALL: Final = 1e-150


class ScrewSegments(NamedTuple):
    """Motions from one pose to others about one screw each.

    Attributes
    ----------
    angle : ndarray, shape (J,)
        Rotation of the whole step, radians.
    vectors : ndarray, shape (3, J, 12)
        Coordinates that f1, f2 and f3 multiply.
    basis : callable
        From the share of a step and its angle to f1, f2 and f3.
    """

    angle: Float
    vectors: Float
    basis: _Basis

    def at(self, chosen: Any) -> ScrewSegments:
        """Give some of the motions."""
        return self._replace(angle=self.angle[chosen], vectors=self.vectors[:, chosen])

    def displacement(self, seen: Float, fraction: Float) -> Float:
        """RMS displacement (J,) of one pose for each segment, seen (J, 12), at a fraction (J,) of it."""
        f1, f2, f3 = self.basis(fraction, self.angle)
        B = self.vectors
        rest = seen - f1[:, None] * B[0] - f2[:, None] * B[1] - f3[:, None] * B[2]
        distance: Float = np.sqrt(np.einsum("jc,jc->j", rest, rest))
        return distance

    def squares(self, seen: Float, fraction: Float) -> Float:
        """Squared RMS displacement (M, J) of poses, seen (M, 12), for every segment, at fractions (M, J).

        By the square's terms, as matrix products: to some 1e-16 of the squared distance from the first pose.
        """
        B = self.vectors
        f = self.basis(fraction, self.angle)
        square = np.repeat(np.sum(seen**2, axis=1)[:, None], fraction.shape[1], axis=1)
        for k in range(3):
            term = seen @ (-2.0 * B[k].T)
            for other in range(k, 3):
                gram = (1.0 if other == k else 2.0) * np.sum(B[k] * B[other], axis=1)
                term += gram * f[other]
            term *= f[k]
            square += term
        return square.clip(0.0)


class AxesSegments(NamedTuple):
    """Motions from one pose to others about two axes at once, both angles growing evenly.

    Attributes
    ----------
    step : ndarray, shape (J, 2)
        Both angles of the whole step, radians.
    vectors : ndarray, shape (9, 12)
        Coordinates that the products of 1, cos and sin of the first angle and of the second multiply.
    """

    step: Float
    vectors: Float

    def at(self, chosen: Any) -> AxesSegments:
        """Give some of the motions."""
        return self._replace(step=self.step[chosen])

    def displacement(self, seen: Float, fraction: Float) -> Float:
        """As `ScrewSegments.displacement`."""
        rest = seen - np.stack(self._products(fraction), axis=-1) @ self.vectors
        distance: Float = np.sqrt(np.einsum("jc,jc->j", rest, rest))
        return distance

    def squares(self, seen: Float, fraction: Float) -> Float:
        """As `ScrewSegments.squares`."""
        f, gram, along = self._products(fraction), self.vectors @ self.vectors.T, seen @ (-2.0 * self.vectors.T)
        square = np.repeat(np.sum(seen**2, axis=1)[:, None], fraction.shape[1], axis=1)
        for k in range(len(f)):
            term = np.repeat(along[:, k, None], fraction.shape[1], axis=1)
            for other in range(k, len(f)):
                term += ((1.0 if other == k else 2.0) * gram[k, other]) * f[other]
            term *= f[k]
            square += term
        return square.clip(0.0)

    def _products(self, fraction: Float) -> list[Float]:
        first, second = fraction * self.step[:, 0], fraction * self.step[:, 1]
        one = np.ones(first.shape)
        return [m * n for m in (one, np.cos(first), np.sin(first)) for n in (one, np.cos(second), np.sin(second))]


Segments = ScrewSegments | AxesSegments


class JointSeries(NamedTuple):
    """A joint and its angles (N, k) in a motion."""

    joint: JointCoordinates
    angle: Float


class PoseTrack(NamedTuple):
    """Poses, and the positions of the body's points in them and in the model's poses of the same frames.

    Attributes
    ----------
    pose : ndarray, shape (N, 8)
        Of the model at a keyframe: the measured one, or the joint's at its angles.
    rotation : ndarray, shape (N, 3, 3)
        Of these poses.
    frame : ndarray, shape (4, 3)
        The points' three spokes and their centroid, in the body.
    placed, modeled : ndarray, shape (N, 4, 3)
        The same in the laboratory, in the measured poses and in those of the model.
    left : ndarray, shape (N,)
        RMS displacement that the model leaves of a keyframe itself: none, or what the joint leaves.
    basis : callable
        How the model goes along a screw.
    series : JointSeries or None
        The joint whose angles the model interpolates.
    """

    pose: Float
    rotation: Float
    frame: Float
    placed: Float
    modeled: Float
    left: Float
    basis: _Basis
    series: JointSeries | None

    @classmethod
    def of(cls, pose: Float, points: BodyPoints, method: str, series: JointSeries | None = None) -> PoseTrack:
        """Place the points in poses (N, 8) whose signs say which way round, and in those of a joint."""
        frame = np.concatenate([spokes(points), points.centroid[:, None]], axis=1).T
        placed = point_coordinates(pose, points).reshape(-1, 4, 3)
        modeled = placed
        if series is not None:
            pose = joint_poses(series.joint, series.angle)
            modeled = point_coordinates(pose, points).reshape(-1, 4, 3)
        rotation = rotation_matrix_from_quat(dq.pose_from_dual_quat(pose)[0])
        basis = BASES["sclerp" if series is not None else method]
        left = np.sqrt(np.sum((placed - modeled) ** 2, axis=(1, 2)))
        return cls(np.ascontiguousarray(pose), rotation, frame, placed, modeled, left, basis, series)

    def at(self, rows: Any) -> PoseTrack:
        """Give some of the poses."""
        arrays = {name: getattr(self, name)[rows] for name in ("pose", "rotation", "placed", "modeled", "left")}
        series = None if self.series is None else self.series._replace(angle=self.series.angle[rows])
        return self._replace(**arrays, series=series)

    def seen_from(self, first: int, rows: Any) -> Float:
        """Coordinates (M, 12) of measured poses as seen from a keyframe, less those of that pose of the model."""
        seen: Float = (self.placed[rows] - self.modeled[first]) @ self.rotation[first]
        return seen.reshape(-1, 12)

    def segments_from(self, first: int, rows: Any) -> Segments:
        """Motions from one pose of the model to others."""
        if self.series is not None and len(self.series.joint.axis) > 1:
            return self._about_two_axes(self.series, first, rows)
        twist = 2.0 * dq.log(dq.multiply(dq.conjugate(self.pose[first]), self.pose[rows]))
        turn, shift = twist[:, :3], twist[:, 3:]
        angle = np.sqrt(np.einsum("jc,jc->j", turn, turn))
        # Without rotation the direction does not matter: f1 = f2 there.
        h = np.divide(turn, angle[:, None], out=np.zeros(turn.shape), where=angle[:, None] > _SMALL)
        along = np.sum(h * shift, axis=1)[:, None] * h
        crossed = _cross(turn[:, None, :], self.frame)
        vectors = np.zeros((3, len(turn), 4, 3))
        vectors[1] = crossed
        vectors[2] = _cross(h[:, None, :], crossed)
        vectors[0, :, 3] = along
        vectors[1, :, 3] += shift - along
        vectors[2, :, 3] += _cross(h, shift)
        return ScrewSegments(angle, vectors.reshape(3, len(turn), 12), self.basis)

    def _about_two_axes(self, series: JointSeries, first: int, rows: Any) -> AxesSegments:
        """Seen from a pose, the first axis is where it is there, and the second where it is in the body."""
        joint = series.joint
        parts = []
        for k, pose in ((0, self.pose[first]), (1, joint.end)):
            back = dq.conjugate(pose)
            axis, point = quaternion.rotate(back[:4], joint.axis[k]), dq.transform_points(back, joint.point[k])
            parts.append(_turn_parts(axis, point))
        spots = np.concatenate([self.frame, np.array([[0.0], [0.0], [0.0], [1.0]])], axis=1)
        vectors = np.stack([(spots @ (m @ n).T)[:, :3] for m in parts[0] for n in parts[1]])
        vectors[0] -= self.frame
        return AxesSegments(series.angle[rows] - series.angle[first], vectors.reshape(9, 12))


def _turn_parts(axis: Float, point: Float) -> tuple[Float, Float, Float]:
    """Matrices (4, 4) that 1, cos and sin of an angle multiply in a turn about an axis through a point."""
    along = np.outer(axis, axis)
    cross = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    found = []
    for k, part in enumerate((along, np.eye(3) - along, cross)):
        matrix = np.zeros((4, 4))
        matrix[:3, :3], matrix[:3, 3] = part, -part @ point
        if k == 0:
            matrix[:3, 3] += point
            matrix[3, 3] = 1.0
        found.append(matrix)
    return found[0], found[1], found[2]


def _cross(a: Float, b: Float) -> Float:
    """Cross product (..., 3), without `numpy.cross`' overhead for small arrays."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def _screw_basis(fraction: Float, angle: Float) -> tuple[Float, Float, Float]:
    """ScLERP: the angle grows with the fraction, and so does the slide."""
    # sin x = 2 T/(1 + T^2) and 1 - cos x = T sin x with T = tan(x/2): one tangent in place of sine and cosine.
    tangent = np.tan(fraction * (0.5 * angle))
    sine = 2.0 * tangent / (1.0 + tangent * tangent)
    return fraction, _over(sine, angle, fraction), _over(tangent * sine, angle, 0.0)


def _blend_basis(fraction: Float, angle: Float) -> tuple[Float, Float, Float]:
    """Linear blending of two poses: the same screw at another speed."""
    a, c = fraction * np.sin(0.5 * angle), 1.0 - fraction + fraction * np.cos(0.5 * angle)
    square = a * a + c * c
    share = 1.0 - c * (1.0 - fraction) / square
    return share, _over(2.0 * a * c / square, angle, share), _over(2.0 * a * a / square, angle, 0.0)


def _over(value: Float, angle: Float, limit: Float | float) -> Float:
    """Value over angle, the limit where there is no angle."""
    turns = angle > _SMALL
    ratio = value * np.divide(1.0, angle, out=np.zeros(angle.shape), where=turns)
    return ratio if turns.all() else np.where(turns, ratio, limit)


BASES: Final[dict[str, _Basis]] = {"sclerp": _screw_basis, "sdlb": _blend_basis}
"""Methods whose motion between two keyframes depends on these two alone."""
