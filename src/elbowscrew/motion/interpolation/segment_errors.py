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
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.model import BodyPoints
from elbowscrew.motion.difference import point_coordinates, spokes

_Basis = Callable[[Float, Float], tuple[Float, Float, Float]]

# Below this the square of an angle is no number, and the turn none.
_SMALL: Final = 1e-150


class Segments(NamedTuple):
    """Motions from one pose to others.

    Attributes
    ----------
    angle : ndarray, shape (J,)
        Rotation of the whole step, radians.
    vectors : ndarray, shape (3, J, 12)
        Coordinates that f1, f2 and f3 multiply.
    """

    angle: Float
    vectors: Float


class PoseTrack(NamedTuple):
    """Poses, and the places of the body's points in them.

    Attributes
    ----------
    pose : ndarray, shape (N, 8)
    rotation, position : ndarray, shape (N, 3, 3) and (N, 3)
    frame : ndarray, shape (4, 3)
        The points' three spokes and their centroid, in the body.
    placed : ndarray, shape (N, 4, 3)
        The same in the laboratory.
    """

    pose: Float
    rotation: Float
    position: Float
    frame: Float
    placed: Float

    @classmethod
    def of(cls, pose: Float, points: BodyPoints) -> PoseTrack:
        """Place the points in poses (N, 8) whose signs say which way round."""
        quat, position = dq.pose_from_dual_quat(pose)
        frame = np.concatenate([spokes(points), points.centroid[:, None]], axis=1).T
        placed = point_coordinates(pose, points).reshape(-1, 4, 3)
        return cls(np.ascontiguousarray(pose), rotation_matrix_from_quat(quat), position, frame, placed)

    def seen_from(self, first: int, rows: Any) -> Float:
        """Coordinates (M, 12) of poses as seen from one of them, less those of that pose itself."""
        seen: Float = (self.placed[rows] - self.placed[first]) @ self.rotation[first]
        return seen.reshape(-1, 12)

    def segments_from(self, first: int, rows: Any) -> Segments:
        """Motions from one pose to others."""
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
        return Segments(angle, vectors.reshape(3, len(turn), 12))


def _cross(a: Float, b: Float) -> Float:
    """Cross product (..., 3), without `numpy.cross`' overhead for small arrays."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def displacement_along(seen: Float, segments: Segments, fraction: Float, basis: _Basis) -> Float:
    """RMS displacement (J,) of one pose for each segment, seen (J, 12), at a fraction (J,) of it."""
    f1, f2, f3 = basis(fraction, segments.angle)
    B = segments.vectors
    rest = seen - f1[:, None] * B[0] - f2[:, None] * B[1] - f3[:, None] * B[2]
    distance: Float = np.sqrt(np.einsum("jc,jc->j", rest, rest))
    return distance


def squares_along(seen: Float, segments: Segments, fraction: Float, basis: _Basis) -> Float:
    """Squared RMS displacement (M, J) of poses, seen (M, 12), for every segment, at fractions (M, J).

    By the square's terms, as matrix products: to some 1e-16 of the squared distance from the first pose.
    """
    B = segments.vectors
    f = basis(fraction, segments.angle)
    square = np.repeat(np.sum(seen**2, axis=1)[:, None], fraction.shape[1], axis=1)
    for k in range(3):
        term = seen @ (-2.0 * B[k].T)
        for other in range(k, 3):
            gram = (1.0 if other == k else 2.0) * np.sum(B[k] * B[other], axis=1)
            term += gram * f[other]
        term *= f[k]
        square += term
    return square.clip(0.0)


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
