"""The joint's line from all relative poses at once: maximum likelihood of a hinge or screw-hinge, and SARA.

The model of frame i is ``J_i = A Z(theta_i, s_0 + p theta_i) F^-1 exp(e_i)``: A is a pose whose z axis is the line in
the proximal body, F one whose z axis is the line in the distal body, Z the screw motion along z. All frames share the
two lines (four parameters each), s_0 and the pitch p; each has its own angle, which is eliminated. No pose is the
reference, so that no pose's noise is shared by all. ``docs/explanation/joint-axis.md`` derives the bound
that the covariance attains.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.quaternion import quat_from_rotation_matrix, rotation_matrix_from_quat
from elbowscrew.geometry.twist import adjoint, inverse_left_jacobian
from elbowscrew.motion.joint.poses import information_of

_ITERATIONS: Final = 30
# Steps shrink until they are round-off, which does not.
_SMALL_STEP: Final = 1e-13
_ROUND_OFF: Final = 1e-8
_SHRINKS: Final = 0.9
_HALVINGS: Final = 12
# A step that is to lower the cost by less than such a share is far smaller than the noise: round-off would judge it.
_LEAST_GAIN: Final = 1e-9
_SHORT: Final = 1e-4  # rad and m: longer steps gain nothing only where the poses do not determine the joint
_LEAST_SCALE: Final = 1e-150  # whose reciprocal has a square
_ROBUST_START: Final = 10
_ROBUST_ROUNDS: Final = 100
# Residuals across the angle have 5 degrees of freedom a frame: median of chi-square, and Tukey's constant that keeps
# 95 % efficiency there (Kudraszow and Maronna 2011 tabulate it for M-estimates of several dimensions).
_FREEDOM: Final = 5
_MEDIAN_SQUARE: Final = 4.351
_TUKEY: Final = 6.10
# Fewer degrees of freedom do not tell of a noise that nobody states; less information is round-off.
_LEAST_FREEDOM: Final = 20.0
_LEAST_INFORMATION: Final = 1e-13
_SHARED_HINGE: Final = (0, 1, 3, 4)  # tilts about x and y, shifts along x and y
HINGE_NUMBERS: Final = 9
"""Shared parameters of a hinge: those of both lines, and the slide at angle 0."""


class LineFit(NamedTuple):
    """Result of `fit_joint`.

    Attributes
    ----------
    proximal, distal : ndarray, shape (8,)
        Poses A and F: the line is their z axis.
    angle : ndarray, shape (F,)
        Of each frame about the line, radians.
    pitch : float
    residual : ndarray, shape (F, 6)
        What is left of each pose, as a twist in the frame of the line (z along it) on the distal body's side.
    weight : ndarray, shape (F,)
    information : ndarray, shape (P, P)
        Inverse of the covariance of the shared parameters under the stated noise.
    noise_ratio, correlation : float
        Whitened RMS of the residuals, and the number of frames that count as one.
    freedom : float
        Degrees of freedom that the residuals have.
    told : tuple of int or None
        Which of the shared parameters the P of the information are; None where it is all of them.
    """

    proximal: Float
    distal: Float
    angle: Float
    pitch: float
    residual: Float
    weight: Float
    information: Float
    noise_ratio: float
    correlation: float
    freedom: float
    told: tuple[int, ...] | None = None

    def covariance(self, *, noise_known: bool) -> Float:
        """Covariance of the shared parameters, shape (P, P).

        That of the stated noise; larger where the residuals are larger or go together from frame to frame. Where the
        noise is not known, the residuals alone tell of it. NaN where the frames do not determine the line, or are too
        few to tell of the noise. Of parameters that are not told it is 0.
        """
        scale = np.sqrt(np.maximum(np.diag(self.information), 0.0))
        unknown = np.full(_whole(self.information, self.told).shape, np.nan)
        told = noise_known or self.freedom >= _LEAST_FREEDOM
        if not told or not (scale > 0.0).all():
            return unknown
        values, vectors = np.linalg.eigh(self.information / np.outer(scale, scale))
        if values[0] < _LEAST_INFORMATION:
            return unknown
        inverse: Float = (vectors / values) @ vectors.T / np.outer(scale, scale)
        least = 1.0 if noise_known else 0.0
        return _whole(inverse * max(self.noise_ratio, least) ** 2 * self.correlation, self.told)


def _whole(covariance: Float, told: tuple[int, ...] | None) -> Float:
    if told is None:
        return covariance
    found = np.zeros((HINGE_NUMBERS, HINGE_NUMBERS))
    found[np.ix_(told, told)] = covariance
    return found


def fit_joint(
    joint: Float,
    covariance: Float,
    line: Float,
    near: Float,
    *,
    screw: bool = False,
    robust: bool = False,
    start: LineFit | None = None,
) -> LineFit:
    """Fit a hinge or screw-hinge to relative poses by maximum likelihood.

    Parameters
    ----------
    joint : ndarray, shape (F, 8)
        The distal body in the proximal one, any signs, in order of time.
    covariance : ndarray, shape (F, 6, 6)
        Of each pose's error in the distal body's frame (`joint_covariance`); its scale does not move the fit.
    line : ndarray, shape (6,)
        Start: the line in the proximal body.
    near : ndarray, shape (3,)
        The line's origin is put at its point nearest this one, in the proximal body.
    screw : bool
        Let the slide grow with the angle.
    robust : bool
        Tukey's biweight after a start by weights 1/distance, in place of least squares.
    start : LineFit, optional
        Fit of the same poses to go on from, in place of the line: a screw-hinge that goes on from the hinge leaves no
        more than that.

    References
    ----------
    Gauss and Newton with the frames' angles eliminated; robust: Maronna, Martin and Yohai 2006.
    """
    W = information_of(covariance)
    A = _line_pose(line, near)
    # The distal body's line: where the proximal body's is seen from it, in the middle of the motion.
    F = dq.normalize(dq.multiply(dq.conjugate(joint[len(joint) // 2]), A))
    weight = np.ones(len(joint))
    best = _Numbers(A, F, _angles(joint, A, F), 0.0)
    if start is not None:
        best = _Numbers(start.proximal, start.distal, start.angle, start.pitch)
    at = _seen_from(best, joint, W)
    size = np.inf
    for _ in range(_ITERATIONS):
        before = size
        at, size = _step(at, joint, W, weight, screw)
        if _settled(size, before):
            break
    if robust:
        for k in range(_ROBUST_ROUNDS):
            distance = np.sqrt(np.maximum(_square(at), 0.0))
            scale = float(np.median(distance)) / np.sqrt(_MEDIAN_SQUARE)
            relative = distance / max(scale, _LEAST_SCALE)
            if k < _ROBUST_START:
                weight = 1.0 / np.maximum(relative, 1.0)
            else:
                weight = np.maximum(1.0 - (relative / _TUKEY) ** 2, 0.0) ** 2
            before = size
            at, size = _step(at, joint, W, weight, screw)
            if k > _ROBUST_START and _settled(size, before):
                break
    return _result(at, W, weight, screw)


class _Numbers(NamedTuple):
    """What is fitted."""

    proximal: Float
    distal: Float
    angle: Float
    pitch: float

    @property
    def screws(self) -> Float:
        """Screw motions (F, 8) along z."""
        half = 0.5 * np.stack([self.angle, self.pitch * self.angle], axis=1)
        zero = np.zeros((len(half), 2))
        return dq.exp(np.concatenate([zero, half[:, :1], zero, half[:, 1:]], axis=1))


class _Seen(NamedTuple):
    """The poses as seen from some numbers, whose `screws` (F, 8) are kept: what is left, in the frame of the line.

    `residual` (F, 6) leads from the model's pose to the measured one, `weights` (F, 6, 6) is its information, and
    `jacobian` (F, 6, 6) how it changes with a small twist of the model.
    """

    numbers: _Numbers
    screws: Float
    residual: Float
    weights: Float
    jacobian: Float


def _line_pose(line: Float, near: Float) -> Float:
    """A pose with the z axis along a line, its origin at the line's point nearest `near`."""
    h = line[:3] / length(line[:3])
    foot = np.cross(h, line[3:])
    origin = foot + ((near - foot) @ h) * h
    x = np.eye(3)[int(np.argmin(np.abs(h)))]
    x = x - (x @ h) * h
    x = x / length(x)
    return dq.dual_quat_from_pose(quat_from_rotation_matrix(np.stack([x, np.cross(h, x), h], axis=1)), origin)


def _angles(joint: Float, A: Float, F: Float) -> Float:
    """Angle about the line that fits each pose best: twice the argument of its scalar and z part, made continuous."""
    Z = dq.multiply(dq.multiply(dq.conjugate(A), joint), F)
    half: Float = np.unwrap(np.arctan2(Z[:, 3], Z[:, 0]), period=np.pi)
    return 2.0 * half


def _seen_from(numbers: _Numbers, joint: Float, W: Float) -> _Seen:
    screws = numbers.screws
    rest = dq.multiply(
        dq.multiply(dq.conjugate(screws), dq.conjugate(numbers.proximal)), dq.multiply(joint, numbers.distal)
    )
    residual = 2.0 * dq.log(dq.canonical(rest))
    return _Seen(numbers, screws, residual, _weights_in_line(numbers, W), inverse_left_jacobian(residual))


def _weights_in_line(numbers: _Numbers, W: Float) -> Float:
    """Information matrices in the frame of the line: ``Ad(F)^T W Ad(F)``."""
    turned = adjoint(numbers.distal)
    return np.swapaxes(turned, -1, -2) @ W @ turned


def _square(at: _Seen) -> Float:
    """Squared whitened distance of each frame, its angle at the optimum."""
    return _across(at.residual, at.weights, (at.jacobian @ _own_column(at.numbers))[..., 0])[0]


def _across(residual: Float, W_line: Float, along: Float) -> tuple[Float, Float, Float, Float]:
    """Squared distances (F,) across the frame's angle, and ``W r``, ``d.W r`` and ``d.W d``, d the change by it."""
    weighted = (W_line @ residual[..., None])[..., 0]
    pull, own = np.sum(weighted * along, axis=1), np.einsum("fi,fij,fj->f", along, W_line, along)
    return np.sum(weighted * residual, axis=1) - pull**2 / own, weighted, pull, own


def _own_column(numbers: _Numbers) -> Float:
    """Derivative (F, 6, 1) of the model's pose by the frame's own angle, in the frame of the line."""
    along = np.array([0.0, 0.0, 1.0, 0.0, 0.0, numbers.pitch])
    return np.broadcast_to(along[:, None], (numbers.angle.size, 6, 1))


def _derivatives(angle: Float, screws: Float, screw: bool) -> Float:
    """Derivatives (F, 6, P) of the model's pose by the shared parameters, in the frame of the line."""
    back = adjoint(dq.conjugate(screws))
    proximal = back[:, :, list(_SHARED_HINGE)]
    distal = np.broadcast_to(-np.eye(6)[:, list(_SHARED_HINGE)], proximal.shape)
    slide = np.broadcast_to(np.eye(6)[:, 5:], (angle.size, 6, 1))
    columns = [proximal, distal, slide]
    if screw:
        columns.append(slide * angle[:, None, None])
    return np.concatenate(columns, axis=2)


class _Equations(NamedTuple):
    """Normal equations of the shared parameters (P), each frame's angle eliminated.

    `own` is the step of that angle, `mixed` by how much less a shared step makes it; `along` is the residual's change
    by it, and `square` the squared distance across it.
    """

    information: Float
    gradient: Float
    own: Float
    mixed: Float
    along: Float
    square: Float


def _normal_equations(at: _Seen, weight: Float, screw: bool) -> _Equations:
    by_shared = _derivatives(at.numbers.angle, at.screws, screw)
    # The residual's frame turns with the model: without its Jacobian these are not the equations of the least cost.
    columns = at.jacobian @ np.concatenate([by_shared, _own_column(at.numbers)], axis=2)
    G, along = columns[..., :-1], columns[..., -1]
    WG = at.weights @ G
    square, weighted, own_pull, own = _across(at.residual, at.weights, along)
    mixed = np.einsum("fip,fi->fp", WG, along)
    pull = np.einsum("fip,fi->fp", G, weighted)
    # Factors are weighed beforehand: sums of three factors take twice as long, and come to the same.
    information = np.einsum("fip,fiq->pq", weight[:, None, None] * G, WG)
    information -= np.einsum("fp,fq->pq", (weight / own)[:, None] * mixed, mixed)
    gradient = weight @ (pull - mixed * (own_pull / own)[:, None])
    return _Equations(information, gradient, own_pull / own, mixed / own[:, None], along, square)


def _step(at: _Seen, joint: Float, W: Float, weight: Float, screw: bool) -> tuple[_Seen, float]:
    """One step of Gauss and Newton, and the size of a full one in radians and meters; 0 where no step is better."""
    information, gradient, own, mixed, *_, square = _normal_equations(at, weight, screw)
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(np.float64).tiny))
    step = np.linalg.lstsq(information / np.outer(scale, scale), gradient / scale, rcond=1e-13)[0] / scale
    size, gain, cost = float(np.abs(step).max()), float(gradient @ step), float(weight @ square)
    lost = size <= _SHORT and gain <= _LEAST_GAIN * cost  # what it gains is lost in the round-off of the cost
    for _ in range(_HALVINGS):  # a full step may lead too far where the poses are far from any hinge
        after = _seen_from(_moved(at.numbers, step, own - mixed @ step, screw=screw), joint, W)
        if lost or weight @ _square(after) <= cost:
            return after, size
        step, own = 0.5 * step, 0.5 * own
    return at, 0.0


def _settled(size: float, before: float) -> bool:
    """Whether a step is all round-off, by its size and that of the one before it."""
    return size < _SMALL_STEP or _SHRINKS * before < size < _ROUND_OFF


def _moved(at: _Numbers, step: Float, turn: Float, *, screw: bool) -> _Numbers:
    tilt = np.zeros((2, 6))
    tilt[0, list(_SHARED_HINGE)] = step[:4]
    tilt[1, list(_SHARED_HINGE)] = step[4:8]
    # The slide at angle 0 is a shift of the distal body's frame against its line: Z(0, s) F^-1 = (F Z(0, -s))^-1.
    tilt[1, 5] = -step[8]
    by_line = dq.exp(0.5 * tilt)
    lines = dq.normalize([dq.multiply(at.proximal, by_line[0]), dq.multiply(at.distal, by_line[1])])
    return _Numbers(lines[0], lines[1], at.angle + turn, at.pitch + (float(step[9]) if screw else 0.0))


def _result(at: _Seen, W: Float, weight: Float, screw: bool) -> LineFit:
    found = _normal_equations(at, weight, screw)
    information, own, square = found.information, found.own, found.square
    residual = at.residual - own[:, None] * found.along
    count = weight.sum()
    freedom = float(_FREEDOM * count - len(information))
    in_distal = residual @ adjoint(at.numbers.distal).T
    whitened = np.einsum("fji,fj->fi", np.linalg.cholesky(W), in_distal) * np.sqrt(weight)[:, None]
    return LineFit(
        proximal=at.numbers.proximal,
        distal=at.numbers.distal,
        angle=at.numbers.angle + own,
        pitch=at.numbers.pitch,
        residual=residual,
        weight=weight,
        information=information,
        noise_ratio=float(np.sqrt((weight * square).sum() / max(freedom, 1.0))),
        correlation=integrated_autocorrelation(whitened),
        freedom=freedom,
    )


def linear_model(fit: LineFit, covariance: Float) -> tuple[Float, Float, Float]:
    """What a fit is to first order in its frames, for those who follow errors through it.

    Parameters
    ----------
    fit : LineFit
    covariance : ndarray, shape (F, 6, 6)
        As `fit_joint` had it.

    Returns
    -------
    tuple of ndarray
        Derivatives (F, 6, P) of the model's poses by the shared parameters and (6,) by a frame's own angle, and the
        information (F, 6, 6) of each pose; all in the frame of the line.
    """
    at = _Numbers(fit.proximal, fit.distal, fit.angle, fit.pitch)
    derivatives = _derivatives(at.angle, at.screws, screw=len(fit.information) > HINGE_NUMBERS)
    own = np.array([0.0, 0.0, 1.0, 0.0, 0.0, fit.pitch])
    return derivatives, own, _weights_in_line(at, information_of(covariance))


def integrated_autocorrelation(series: Float) -> float:
    """Number of successive rows that count as one, of series (F, k): ``1 + 2 sum rho`` up to Sokal's window."""
    count = len(series)
    if count < 8:
        return 1.0
    size = 1 << (2 * count - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(series - series.mean(axis=0), size, axis=0)) ** 2
    covariance = np.fft.irfft(spectrum.sum(axis=1), size)[: count // 2]
    if not covariance[0] > 0.0:
        return 1.0
    summed = 2.0 * np.cumsum(covariance / covariance[0]) - 1.0
    window = np.flatnonzero(np.arange(summed.size) >= 5.0 * summed)
    return max(float(summed[window[0]] if window.size else summed.max()), 1.0)


def sara_lines(joint: Float, angle: Float) -> tuple[Float, Float]:
    """Symmetrical axis of rotation: the lines (6,) in the two bodies whose points stay nearest each other.

    Solves ``R_i c_F - c_A = -t_i`` for the point in both bodies by least squares; the axis is the direction in which
    the solution is not determined.

    Parameters
    ----------
    joint : ndarray, shape (F, 8)
    angle : ndarray, shape (F,)
        Of the motion, for the sense of the axis: positive about it.

    References
    ----------
    Ehrig, Taylor, Duda and Heller 2007, Journal of Biomechanics 40.
    """
    quat, position = dq.pose_from_dual_quat(joint)
    R = rotation_matrix_from_quat(quat)
    count = len(joint)
    # Normal equations of the 3F x 6 system, about the mean positions so that no digit is lost.
    mean_R, mean_t = R.mean(axis=0), position.mean(axis=0)
    square = np.block([[np.eye(3), -mean_R.T], [-mean_R, np.eye(3)]])
    right = np.concatenate([-np.einsum("fji,fj->i", R, position) / count, mean_t])
    values, vectors = np.linalg.eigh(square)
    axis = vectors[:, 0]
    solution = vectors[:, 1:] @ ((vectors[:, 1:].T @ right) / values[1:])
    distal, proximal = axis[:3] / length(axis[:3]), axis[3:] / length(axis[3:])
    # A right-handed turn by the change of angle between the two most different frames tells the sense.
    low, high = int(np.argmin(angle)), int(np.argmax(angle))
    turn = dq.canonical(dq.multiply(dq.conjugate(joint[low]), joint[high]))
    half = 0.5 * (angle[high] - angle[low])
    sense = np.sign(turn[1:4] @ distal * (np.sin(half) * np.sign(np.cos(half)) or 1.0)) or 1.0
    lines = [
        np.concatenate([sense * h, np.cross(p, sense * h)])
        for h, p in ((proximal, solution[3:]), (distal, solution[:3]))
    ]
    return lines[0], lines[1]
