"""One likelihood for every type of joint: all relative poses at once, the frames' own numbers eliminated.

The model of frame i is a pose ``J_i(shared, own_i)``; the measured one is ``J_i exp(e_i)`` with ``e_i`` normal. Shared
numbers (lines, centers) are the same in all frames, own numbers (angles) belong to one. At a point of the search the
whitened residual of a frame is ``r - G d - D f``: projecting it off the columns of D eliminates the frame's numbers
(Schur's complement), what is left is a small problem for the shared ones. The types are named
in ``docs/explanation/joint.md``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import ClassVar, Final, Generic, NamedTuple, Self, TypeVar

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Bool, Float, Index
from elbowscrew.geometry.twist import adjoint, inverse_left_jacobian
from elbowscrew.motion.joint.poses import COMPONENTS, Poses

M = TypeVar("M", bound="Mechanism")
M_co = TypeVar("M_co", bound="Mechanism", covariant=True)

_TRIES: Final = 10
_LARGEST_FRAME_STEP: Final = 0.7
_SETTLED: Final = 1e-4
_RACE_GAIN: Final = 1e-3
_NEAR: Final = 1e-3
_OWN_ROUNDS: Final = 2
_SMALLEST_STEP: Final = 1e-7
_REFINEMENTS: Final = 30
# Steps shrink until they are round-off, which does not. Short ones gain less than round-off would judge.
_ROUND_OFF: Final = 1e-13
_SMALL: Final = 1e-8
_SHRINKS: Final = 0.9
_SHORT: Final = 1e-4
_BLOCK: Final = 4096
_TINY: Final = np.finfo(np.float64).tiny


class Linear(NamedTuple):
    """A mechanism near its present numbers, twists in the frame its residuals are written in.

    Attributes
    ----------
    residual : ndarray, shape (F, 6)
        From the model's pose to the measured one.
    own : ndarray, shape (F, 6, k)
        Derivatives of the model's pose by the frame's own numbers.
    shared : ndarray, shape (F, 6, P)
        The same by the shared numbers.
    """

    residual: Float
    own: Float
    shared: Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mechanism(ABC):
    """A type of joint with its numbers.

    Attributes
    ----------
    frames : ndarray, shape (F, ...)
        The numbers that belong to one frame each.
    turning : tuple of int
        Which of the shared numbers turn the body: orientations tell no others.
    """

    turning: ClassVar[tuple[int, ...]]

    frames: Float

    @property
    @abstractmethod
    def shared_count(self) -> int:
        """How many shared numbers there are."""

    @property
    @abstractmethod
    def residual_frame(self) -> Float:
        """Pose (8,) in the distal body of the frame that residuals are written in."""

    @abstractmethod
    def linear(self, joint: Float) -> Linear:
        """Residuals and derivatives at poses (F, 8), which `frames` must belong to."""

    def whole(self, shared: Float) -> Float:
        """All shared numbers (..., P) of those that are told, the others 0."""
        if shared.shape[-1] == self.shared_count:
            return shared
        found = np.zeros((*shared.shape[:-1], self.shared_count))
        found[..., list(self.turning)] = shared
        return found

    @abstractmethod
    def moved(self, shared: Float, own: Float) -> Self:
        """After a step of the shared numbers (P,) and of the frames' (F, k)."""

    @abstractmethod
    def placed(self, joint: Float) -> Self:
        """With the same shared numbers on other poses (F, 8): the frames' own numbers in closed form."""

    def stacked(self, several: list[Self]) -> Self:
        """Several of one type as one, with an axis more in front of all arrays and one for the frames."""
        arrays = {name: np.stack([getattr(one, name) for one in several]) for name in self._arrays()}
        return replace(self, **{name: a if name == "frames" else a[:, None] for name, a in arrays.items()})

    def parted(self, count: int) -> list[Self]:
        """Undo `stacked`."""
        return [
            replace(self, **{n: a[k] if n == "frames" else a[k, 0] for n, a in self._arrays().items()})
            for k in range(count)
        ]

    def where_better(self, other: Self, better: Bool) -> Self:
        """Of two stacks, take the other's where it is better."""
        theirs = other._arrays()
        return replace(self, **{name: _where(better, theirs[name], mine) for name, mine in self._arrays().items()})

    def _arrays(self) -> dict[str, Float]:
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}

    def on(self, rows: Index) -> Self:
        """Give the same joint on some of its frames."""
        return replace(self, frames=self.frames[rows])


class Fit(NamedTuple, Generic[M_co]):
    """A mechanism at its most likely numbers.

    Attributes
    ----------
    mechanism : Mechanism
    square : ndarray, shape (F,)
        Squared whitened distance of each frame, its own numbers at the optimum.
    whitened : ndarray, shape (F, 6) or (F, 3)
        Whitened residual, projected off the frame's own numbers; three where the positions were not measured.
    residual : ndarray, shape (F, 6)
        The same as a twist in `Mechanism.residual_frame`.
    weight : ndarray, shape (F,)
        1, or less for outliers of a robust fit.
    information : ndarray, shape (P, P)
        Inverse of the covariance of the shared numbers that are told (`told`) under the stated noise.
    own_covariance : ndarray, shape (F, k, k)
        Of the frame's own numbers for given shared ones, under the stated noise.
    own_by_shared : ndarray, shape (F, k, P)
        How the frame's own numbers at their optimum change with the shared ones that are told.
    """

    mechanism: M_co
    square: Float
    whitened: Float
    residual: Float
    weight: Float
    information: Float
    own_covariance: Float
    own_by_shared: Float

    @property
    def told(self) -> tuple[int, ...] | None:
        """Which of the shared numbers the poses tell of; None where it is all of them."""
        return None if self.whitened.shape[-1] == COMPONENTS else self.mechanism.turning

    @property
    def frame_freedom(self) -> int:
        """Degrees of freedom that the residual of one frame has."""
        return int(self.whitened.shape[-1]) - self.own_count

    @property
    def cost(self) -> float:
        """Sum of the weighed squares."""
        return float(self.weight @ self.square)

    @property
    def own_count(self) -> int:
        """Numbers that each frame has of its own."""
        return int(self.own_covariance.shape[1])

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the residuals."""
        return float(self.frame_freedom * self.weight.sum() - len(self.information))

    @property
    def variance(self) -> float:
        """Whitened variance for each degree of freedom: 1 where the stated noise explains the residuals."""
        return self.cost / max(self.freedom, 1.0)

    @property
    def residual_rotation(self) -> float:
        """RMS rotation left, rad."""
        return self._rms(slice(0, 3))

    @property
    def residual_translation(self) -> float:
        """RMS translation left, m, at the origin of the residuals' frame."""
        return self._rms(slice(3, 6))

    def _rms(self, part: slice) -> float:
        return float(np.sqrt(np.average(np.sum(self.residual[:, part] ** 2, axis=1), weights=self.weight)))


class _Reduced(NamedTuple):
    """Equations of the shared numbers; `here` is the squared distance (F,) where each frame's own numbers are now.

    `square` is that across them, which they are expected to come to: right to third order in how far they have to go.
    """

    here: Float
    information: Float
    gradient: Float
    square: Float
    whitened: Float
    residual: Float
    own_step: Float
    own_by_shared: Float
    own_covariance: Float


def _reduced(mechanism: Mechanism, poses: Poses, weight: Float) -> _Reduced:
    linear = mechanism.linear(poses.joint)
    k = linear.own.shape[-1]
    # The residual's frame turns with the model: without its Jacobian, which leaves the residual itself as it is, these
    # were not the equations of the least cost, by a fifth of a standard deviation at 1 deg of noise.
    jacobian = inverse_left_jacobian(linear.residual)
    whitener = poses.whitener @ adjoint(mechanism.residual_frame) @ jacobian
    told = linear.shared if poses.located else linear.shared[..., list(mechanism.turning)]
    whole = whitener @ np.concatenate([linear.own, linear.residual[..., None], told], axis=-1)
    own, rest = whole[..., :k], whole[..., k:]
    here = np.einsum("...fi,...fi->...f", rest[..., 0], rest[..., 0])
    across = np.swapaxes(own, -1, -2)
    square = across @ own
    # Where two numbers of a frame do one and the same, as the angles of parallel axes in one line: no step, not NaN.
    square = square + (1e-10 / max(k, 1)) * np.trace(square, axis1=-2, axis2=-1)[..., None, None] * np.eye(k)
    # One number is not inverted as a matrix, which takes a call of LAPACK for each frame.
    covariance = 1.0 / square if k == 1 and square.all() else np.linalg.inv(square)
    mixed = covariance @ (across @ rest)
    rest = rest - own @ mixed
    residual, shared = rest[..., 0], rest[..., 1:]
    flat = (*shared.shape[:-3], shared.shape[-3] * shared.shape[-2], shared.shape[-1])
    weighed = np.swapaxes((shared * weight[:, None, None]).reshape(flat), -1, -2)
    return _Reduced(
        here=here,
        information=weighed @ shared.reshape(flat),
        gradient=(weighed @ residual.reshape(*flat[:-1], 1))[..., 0],
        square=np.einsum("...fi,...fi->...f", residual, residual),
        whitened=residual,
        residual=linear.residual - (jacobian @ (linear.own @ mixed[..., :1]))[..., 0],
        own_step=mixed[..., 0],
        own_by_shared=mixed[..., 1:],
        own_covariance=covariance,
    )


def race(mechanisms: list[M], poses: Poses, *, rounds: int) -> list[Fit[M]]:
    """Let several starts of one type run side by side for some rounds of Levenberg and Marquardt.

    Parameters
    ----------
    mechanisms : list of Mechanism
        Starts, their frames those of the poses; `Mechanism.stacked` makes one of them.
    poses : Poses
    rounds : int
        Steps that each tries, fewer where none of them gains any more; one that does not lower the cost is taken back
        and tried shorter in the next.
    """
    weight = np.ones(len(poses.joint))
    field = mechanisms[0].stacked(mechanisms)
    at = _reduced(field, poses, weight)
    cost = at.square.sum(axis=-1)
    damping = np.full(len(mechanisms), 1e-6)
    for _ in range(rounds):
        scale = np.sqrt(np.maximum(np.diagonal(at.information, axis1=-2, axis2=-1), _TINY))
        damped = at.information / (scale[:, :, None] * scale[:, None, :])
        damped = damped + damping[:, None, None] * np.eye(scale.shape[1])
        step = np.linalg.solve(damped, (at.gradient / scale)[..., None])[..., 0] / scale
        own = at.own_step - (at.own_by_shared @ step[:, None, :, None])[..., 0]
        after = field.moved(field.whole(step), np.clip(own, -_LARGEST_FRAME_STEP, _LARGEST_FRAME_STEP))
        new = _reduced(after, poses, weight)
        new_cost = new.square.sum(axis=-1)
        better = new_cost <= cost * (1.0 + 1e-12)
        ended = better.all() and (cost - new_cost <= _RACE_GAIN * cost).all()
        field = field.where_better(after, better)
        at = _Reduced(*(_where(better, mine, theirs) for mine, theirs in zip(new, at, strict=True)))
        cost = np.where(better, new_cost, cost)
        if ended:
            break
        damping = np.where(better, np.maximum(0.1 * damping, 1e-10), 100.0 * np.maximum(damping, 1e-6))
    return [
        _fitted(one, _Reduced(*(part[k] for part in at)), weight) for k, one in enumerate(field.parted(len(mechanisms)))
    ]


def _where(better: Bool, mine: Float, theirs: Float) -> Float:
    return np.where(better.reshape(-1, *([1] * (mine.ndim - 1))), mine, theirs)


def fit_mechanism(
    mechanism: M,
    poses: Poses,
    *,
    iterations: int = 40,
    tolerance: float = 1e-10,
    weight: Float | None = None,
) -> Fit[M]:
    """Maximize the likelihood from a start, by Levenberg and Marquardt with the frames' own numbers eliminated.

    Parameters
    ----------
    mechanism : Mechanism
        Start, its frames those of the poses.
    poses : Poses
    iterations : int
    tolerance : float
        Least relative gain that another iteration is made for.
    weight : ndarray, shape (F,), optional
        Of each frame; 1 by itself.
    """
    weight = np.ones(len(poses.joint)) if weight is None else weight
    mechanism, at = _at_own_optimum(mechanism, poses, weight)
    damping = 1e-6
    if not at.gradient.size:  # nothing is shared that the poses tell of
        return settled(mechanism, poses)
    cost = float(weight @ at.square)
    for _ in range(iterations):
        scale = np.sqrt(np.maximum(np.diag(at.information), _TINY))
        scaled = at.information / np.outer(scale, scale)
        unsettled = np.abs(at.own_step).max(initial=0.0)
        for _ in range(_TRIES):
            damped = scaled + damping * np.eye(len(scale))
            step = np.linalg.lstsq(damped, at.gradient / scale, rcond=1e-13)[0] / scale
            # A full step lowers the cost by gradient times step: below the tolerance there is nothing to try.
            if unsettled < _SETTLED and at.gradient @ step <= tolerance * cost:
                return _fitted(mechanism, at, weight)
            own = np.clip(at.own_step - at.own_by_shared @ step, -_LARGEST_FRAME_STEP, _LARGEST_FRAME_STEP)
            after, new = _at_own_optimum(mechanism.moved(mechanism.whole(step), own), poses, weight)
            new_cost = float(weight @ new.square)
            if new_cost <= cost * (1.0 + 1e-12):
                break
            damping = 10.0 * max(damping, 1e-7)
        else:
            break
        gain = cost - new_cost
        mechanism, at, cost = after, new, new_cost
        damping = max(0.1 * damping, 1e-10)
        if gain <= tolerance * cost and unsettled < _SETTLED:
            break
    return _fitted(mechanism, at, weight)


def _at_own_optimum(mechanism: M, poses: Poses, weight: Float) -> tuple[M, _Reduced]:
    """With the frames' own numbers near enough to their optimum that the cost there is right."""
    at = _reduced(mechanism, poses, weight)
    for _ in range(_OWN_ROUNDS):
        if not np.abs(at.own_step).max(initial=0.0) > _NEAR:
            break
        own = np.clip(at.own_step, -_LARGEST_FRAME_STEP, _LARGEST_FRAME_STEP)
        mechanism = mechanism.moved(np.zeros(mechanism.shared_count), own)
        at = _reduced(mechanism, poses, weight)
    return mechanism, at


def refined(fit: Fit[M], poses: Poses) -> Fit[M]:
    """Go on from a fit, by Gauss and Newton under its weights, until a step is all round-off.

    Fits from different starts then agree to 1e-12 rad and m where the poses determine the joint. Where a step that is
    not short lowers no cost, the fit stays as it is.
    """
    mechanism, weight = fit.mechanism, fit.weight
    at = _reduced(mechanism, poses, weight)
    size = np.inf
    for _ in range(_REFINEMENTS if at.gradient.size else 0):
        before = size
        after, size = _after_full_step(mechanism, at)
        new = _reduced(after, poses, weight)
        if size > _SHORT and not weight @ new.here <= weight @ at.here:
            break
        mechanism, at = after, new
        if is_round_off(size, before):
            break
    return _fitted(mechanism, at, weight)


def is_round_off(size: float, before: float) -> bool:
    """Whether steps have shrunk until they are round-off, by the size of the last and of the one before it."""
    return size < _ROUND_OFF or _SHRINKS * before < size < _SMALL


def stepped(fit: Fit[M], poses: Poses, weight: Float) -> tuple[Fit[M], float]:
    """One step of Gauss and Newton under the weights (F,), and how far it led, rad and m."""
    mechanism, size = _after_full_step(fit.mechanism, _reduced(fit.mechanism, poses, weight))
    return _fitted(mechanism, _reduced(mechanism, poses, weight), weight), size


def _after_full_step(mechanism: M, at: _Reduced) -> tuple[M, float]:
    scale = np.sqrt(np.maximum(np.diag(at.information), _TINY))
    step = np.linalg.lstsq(at.information / np.outer(scale, scale), at.gradient / scale, rcond=1e-13)[0] / scale
    own = at.own_step - at.own_by_shared @ step
    size = float(max(np.abs(step).max(), np.abs(own).max(initial=0.0)))
    return mechanism.moved(mechanism.whole(step), own), size


def _fitted(mechanism: M, at: _Reduced, weight: Float) -> Fit[M]:
    return Fit(
        mechanism, at.square, at.whitened, at.residual, weight, at.information, at.own_covariance, -at.own_by_shared
    )


def settled(mechanism: M, poses: Poses, *, rounds: int = 3) -> Fit[M]:
    """Put a joint on poses: each frame's own numbers at their optimum, the shared ones as they are.

    Frames are looked at in blocks, so that a long trial needs no more memory than a short one beside its results.
    """
    fits = []
    start = mechanism.placed(poses.joint)
    for first in range(0, len(poses.joint), _BLOCK):
        rows = np.arange(first, min(first + _BLOCK, len(poses.joint)))
        part, block, weight = start.on(rows), poses.at(rows), np.ones(rows.size)
        at = _reduced(part, block, weight)
        for _ in range(rounds if at.own_step.size else 0):
            if np.abs(at.own_step).max() < _SMALLEST_STEP:
                break
            step = np.clip(at.own_step, -_LARGEST_FRAME_STEP, _LARGEST_FRAME_STEP)
            part = part.moved(np.zeros(part.shared_count), step)
            at = _reduced(part, block, weight)
        fits.append(_fitted(part, at, weight))
    join: Callable[[list[Float]], Float] = np.concatenate
    return Fit(
        mechanism=replace(fits[0].mechanism, frames=join([fit.mechanism.frames for fit in fits])),
        square=join([fit.square for fit in fits]),
        whitened=join([fit.whitened for fit in fits]),
        residual=join([fit.residual for fit in fits]),
        weight=join([fit.weight for fit in fits]),
        information=np.sum([fit.information for fit in fits], axis=0),
        own_covariance=join([fit.own_covariance for fit in fits]),
        own_by_shared=join([fit.own_by_shared for fit in fits]),
    )


def residual_twist(model: Float, joint: Float) -> Float:
    """Twist (F, 6) that leads from the model's poses to the measured ones, in the model's frame."""
    return 2.0 * dq.log(dq.canonical(dq.multiply(dq.conjugate(model), joint)))
