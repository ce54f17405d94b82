"""Joints that rotate about two axes: ``J_i = A Z(alpha_i) M Z(beta_i) F^-1``.

The z axis of A is the axis in the proximal body, that of F the one in the distal body, and M holds how the second
stands to the first. M moves by the four directions across the two that only rename angles, so that parallel, crossing
and intersecting axes are alike regular, which they are not in the numbers of Denavit and Hartenberg.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.likelihood import Fit, Linear, Mechanism, residual_twist
from elbowscrew.motion.joint.lines import LINE_STEPS, Z_LINE, about_z, angle_about_z, line_twist

_LENGTH: Final = 0.1  # m that weigh as a radian where rotations and shifts are compared
_LARGEST_ANGLE_SD: Final = np.radians(8.0)
_LARGEST_WINDING: Final = 2.0 * np.pi + 0.5
_STEP: Final = 1e-6

TILTS: Final = (np.eye(12)[0:2], np.eye(12)[8:10])
"""Rows of the tilts of axis 1 and of axis 2 among the 12 shared numbers."""

SHIFTS: Final = (np.eye(12)[2:4], np.eye(12)[10:12])
"""Rows of the shifts of axis 1 and of axis 2."""
_CROSSING_ROUNDS: Final = 4
_TINY: Final = float(np.finfo(np.float64).tiny)
_SCALE: Final = np.array([1.0, 1.0, 1.0, _LENGTH, _LENGTH, _LENGTH])

_LEFT_TOGETHER: Final = 0.005  # of an angle's variance: what the other one, cubed at most, does not tell of it
LARGEST_UNDONE: Final = 0.36
"""Of `undone_share`: errors that draw the axes together to that extent leave nothing of where they were."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TwoAxesMechanism(Mechanism):
    """Poses A, M and F, shape (8,) each. ``frames``: both angles (F, 2), rad."""

    turning: ClassVar = (0, 1, 4, 8, 9)

    proximal: Float
    between: Float
    distal: Float

    @property
    def shared_count(self) -> int:
        """Tilts and shifts of both lines, and four of M between them."""
        return 12

    @property
    def residual_frame(self) -> Float:
        """That of the second line in the distal body."""
        return self.distal

    @property
    def directions(self) -> Float:
        """Twists (6, 4) that M moves by: across those of both angles; the first alone turns where M only does."""
        second = dq.transform_lines(dq.conjugate(self.between), Z_LINE)
        angles = np.stack([np.broadcast_to(Z_LINE, second.shape), second], axis=-1)
        if not second[..., 3:].any():
            found = np.zeros((*angles.shape[:-1], 4))
            found[..., :3, 0] = np.linalg.svd(angles[..., :3, :])[0][..., 2]
            found[..., 3:, 1:] = np.eye(3)
            return found
        left = np.linalg.svd(angles / _SCALE[:, None])[0]
        across: Float = left[..., 2:] * _SCALE[:, None]
        return across

    def linear(self, joint: Float) -> Linear:
        """12 shared numbers (tilts and shifts of both lines, 4 of M between them), 2 of a frame's own."""
        second = about_z(self.frames[..., 1])
        after = dq.multiply(self.between, second)
        whole = dq.multiply(about_z(self.frames[..., 0]), after)
        residual = residual_twist(dq.multiply(self.proximal, whole), dq.multiply(joint, self.distal))
        first_line = dq.transform_lines(dq.conjugate(after), Z_LINE)
        own = np.stack([first_line, np.broadcast_to(Z_LINE, first_line.shape)], axis=-1)
        proximal = adjoint(dq.conjugate(whole))[..., list(LINE_STEPS)]
        between = adjoint(dq.conjugate(second)) @ self.directions
        distal = np.broadcast_to(-np.eye(6)[:, list(LINE_STEPS)], proximal.shape)
        return Linear(residual, own, np.concatenate([proximal, between, distal], axis=-1))

    def moved(self, shared: Float, own: Float) -> Self:
        """Move both lines, M and the angles."""
        steps = shared.reshape(*self.proximal.shape[:-1], 12)  # of several joints side by side, one each
        between = dq.exp(0.5 * (self.directions @ steps[..., 4:8, None])[..., 0])
        return replace(
            self,
            proximal=dq.normalize(dq.multiply(self.proximal, dq.exp(line_twist(steps[..., :4])))),
            between=dq.normalize(dq.multiply(self.between, between)),
            distal=dq.normalize(dq.multiply(self.distal, dq.exp(line_twist(steps[..., 8:])))),
            frames=self.frames + own,
        )

    def numbers_by(self, other: TwoAxesMechanism) -> Float:
        """Small changes (12, 12) of these shared numbers by those of axes nearby, where M moves by other directions."""
        found = np.eye(12)
        found[4:8, 4:8] = np.linalg.lstsq(
            self.directions / _SCALE[:, None], other.directions / _SCALE[:, None], rcond=None
        )[0]
        return found

    def placed(self, joint: Float) -> Self:
        """Angle 1 by which the second line has gone round the first, then angle 2 from what is left.

        Direction and moment of the line turn alike about z, so that one phase serves parallel axes, whose direction
        tells nothing, and axes that intersect, whose moment does not.
        """
        seen = dq.multiply(dq.multiply(dq.conjugate(self.proximal), joint), self.distal)
        line, zero = dq.transform_lines(seen, Z_LINE), dq.transform_lines(self.between, Z_LINE)
        phase = _across(line[:, :3]) * np.conj(_across(zero[:3]))
        phase = phase + _across(line[:, 3:]) * np.conj(_across(zero[3:])) / _LENGTH**2
        first = np.unwrap(np.angle(phase))
        rest = dq.multiply(dq.conjugate(self.between), dq.multiply(about_z(-first), seen))
        return replace(self, frames=np.stack([first, angle_about_z(rest)], axis=1))

    def zeroed(self, reference: Float) -> Self:
        """Count both angles from those (2,) of a reference pose; the motion stays as it is."""
        between = dq.multiply(dq.multiply(about_z(reference[0]), self.between), about_z(reference[1]))
        return replace(self, between=dq.normalize(between), frames=self.frames - reference)

    def turned(self, first: float, second: float) -> Self:
        """Reverse the sense of an axis where its sign is -1: half a turn of its frame about x."""
        half = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        back = dq.conjugate(half)
        at = self
        if first < 0.0:
            at = replace(at, proximal=dq.multiply(at.proximal, half), between=dq.multiply(back, at.between))
        if second < 0.0:
            at = replace(at, distal=dq.multiply(at.distal, half), between=dq.multiply(at.between, half))
        return replace(at, frames=at.frames * [first, second])

    def exchanged(self) -> Self:
        """The same lines in the other order: the second is the one in the proximal body.

        They are taken where the frames' angles cross: a motion that turns about one of them at a time, from there and
        back, is the same in either order.
        """
        first, second = self.crossing()
        proximal = dq.multiply(dq.multiply(self.proximal, about_z(first)), self.between)
        between = dq.multiply(dq.conjugate(self.between), about_z(-first))
        return replace(
            self,
            proximal=proximal,
            between=between,
            distal=dq.multiply(dq.multiply(self.distal, about_z(-second)), between),
            frames=(self.frames - [first, second])[:, ::-1].copy(),
        )

    def has_first_axis_of(self, other: TwoAxesMechanism, another: TwoAxesMechanism) -> bool:
        """Whether the axis in the proximal body is nearer the one of a joint than that of another one."""
        mine, these, those = (dq.transform_lines(at.proximal, Z_LINE) for at in (self, other, another))
        return _line_gap(mine, these) < _line_gap(mine, those)

    def crossing(self) -> Float:
        """Both angles (2,) where each of them is while the other is away."""
        found = np.median(self.frames, axis=0)
        for _ in range(_CROSSING_ROUNDS):
            away = np.abs(self.frames - found)
            found = np.array([_weighted_median(self.frames[:, k], away[:, 1 - k]) for k in range(2)])
        return found

    def slid(self, first: float, second: float) -> Self:
        """Put the origins of both lines' frames so far (m) along the lines; the joint stays as it is."""
        one, two = about_z(np.zeros(()), first), about_z(np.zeros(()), second)
        return replace(
            self,
            proximal=dq.multiply(self.proximal, one),
            between=dq.multiply(dq.conjugate(one), dq.multiply(self.between, two)),
            distal=dq.multiply(self.distal, two),
        )


class AxesGeometry(NamedTuple):
    """How two axes stand to each other; as numbers (5,) with `_geometry`.

    Attributes
    ----------
    angle : float
        Between the directions as they point, rad, 0 to pi.
    distance : float
        Along the common normal, m, positive on the side of ``axis 1 x axis 2``; NaN where the axes are parallel.
    foot1, foot2 : float
        Of the common normal, m along each axis from its point nearest the origin of its own body.
    offset : float
        Between the lines across axis 1 at the second one's origin, m: the distance of parallel axes.
    """

    angle: float
    distance: float
    foot1: float
    foot2: float
    offset: float


def axes_geometry(at: TwoAxesMechanism) -> AxesGeometry:
    """Angle, distance and feet of the common normal."""
    line = dq.transform_lines(at.between, Z_LINE)
    origin = dq.pose_from_dual_quat(at.between)[1]
    h = line[:3]
    sine = float(np.hypot(h[0], h[1]))
    angle = float(np.arctan2(sine, h[2]))
    offset = float(length(origin[:2]))
    if sine < np.finfo(np.float64).eps:
        return AxesGeometry(angle, np.nan, np.nan, np.nan, offset)
    normal = np.array([-h[1], h[0], 0.0]) / sine
    distance = float(origin @ normal)
    # The second line meets the normal's plane where it is nearest z: at t along it from its origin.
    along = -float(origin[:2] @ h[:2]) / sine**2
    foot1, foot2 = float(origin[2] + along * h[2]), along
    return AxesGeometry(
        angle, distance, foot1 - _nearest_origin(at.proximal), foot2 - _nearest_origin(at.distal), offset
    )


def geometry_slopes(at: TwoAxesMechanism) -> Float:
    """Derivatives (5, 12) of `AxesGeometry` by the shared numbers, from central differences."""
    columns = []
    for step in np.eye(12) * _STEP:
        zero = np.zeros(at.frames.shape)
        ahead, behind = (np.array(axes_geometry(at.moved(s, zero))) for s in (step, -step))
        columns.append((ahead - behind) / (2.0 * _STEP))
    return np.stack(columns, axis=1)


def angle_sd(fit: Fit[Mechanism]) -> Float:
    """Median standard deviation (2,) of both angles, rad, scaled by the fit's own residuals."""
    variance = np.median(np.diagonal(fit.own_covariance, axis1=1, axis2=2), axis=0) * fit.variance
    return np.asarray(np.sqrt(variance), dtype=np.float64)


def undone_share(at: TwoAxesMechanism) -> float:
    """Share of both angles' variance that each of them undoes of the other; negative where they add up.

    ``-2 cos(g) cov(a, b) / (var a + var b)``, g between the directions: to first order the rotation's variance is what
    is left. Slow errors draw two axes together until large angles against each other follow them.
    """
    spread = np.cov(at.frames.T)
    cosine = float(dq.transform_lines(at.between, Z_LINE)[2])
    return -2.0 * cosine * float(spread[0, 1]) / max(float(np.trace(spread)), _TINY)


def angles_go_together(at: TwoAxesMechanism) -> bool:
    """Whether one angle follows from the other: then all that tells the axes is how one path is curved.

    Another pair of axes, some degrees off, may have nearly the same path, and no interval about one pair holds it.
    """
    first, second = (at.frames - at.frames.mean(axis=0)).T
    return _follows(second, first) or _follows(first, second)


def _follows(angle: Float, other: Float) -> bool:
    """Whether a cubic in the other angle leaves next to nothing of one; both (F,), about their means."""
    powers = np.vander(other / max(float(np.abs(other).max()), _TINY), 4)
    left = angle - powers @ np.linalg.lstsq(powers, angle, rcond=None)[0]
    return float(left @ left) <= _LEFT_TOGETHER * float(angle @ angle)


def is_phantom(fit: Fit[Mechanism]) -> bool:
    """Whether two axes nearly in one only share out its rotation: their angles wind against each other, or are unknown.

    Angles that wind and do not undo each other are those of a joint that turns on and on.
    """
    if angle_sd(fit).max() > _LARGEST_ANGLE_SD:
        return True
    at = fit.mechanism
    winds = bool(np.ptp(at.frames, axis=0).max() > _LARGEST_WINDING)
    return winds and isinstance(at, TwoAxesMechanism) and undone_share(at) > LARGEST_UNDONE


def _line_gap(line: Float, other: Float) -> float:
    """Between two lines (6,), whichever way they point, a radian weighing as much as 0.1 m."""
    sense = 1.0 if line[:3] @ other[:3] >= 0.0 else -1.0
    return float(length((line - sense * other) / np.repeat([1.0, _LENGTH], 3)))


def _weighted_median(values: Float, weight: Float) -> float:
    order = np.argsort(values)
    total = np.cumsum(weight[order])
    return float(values[order[int(np.searchsorted(total, 0.5 * total[-1]))]])


def _across(vector: Float) -> NDArray[np.complex128]:
    return np.asarray(vector[..., 0] + 1j * vector[..., 1], dtype=np.complex128)


def _nearest_origin(pose: Float) -> float:
    """Where along the z axis of a pose its point nearest the body's origin is."""
    line, origin = dq.transform_lines(pose, Z_LINE), dq.pose_from_dual_quat(pose)[1]
    return -float(origin @ line[:3])
