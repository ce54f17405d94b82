"""What a small error of each pose does to the numbers that a fitted joint shares among its frames."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.joint_fit import LineFit, linear_model
from elbowscrew.motion.joint.poses import whitener_of

_LEAST_INFORMATION: Final = 1e-13
_SAME: Final = 1e-12


class Influence(NamedTuple):
    """A maximum-likelihood fit, linear in the errors of its F poses.

    Attributes
    ----------
    angle : ndarray, shape (F,)
        What the motion is told by, radians: noise that goes with it cannot be told from the joint.
    inverse : ndarray, shape (P, P)
        Covariance of the shared numbers under the stated noise; NaN where the frames do not determine them.
    whitened : ndarray, shape (F, k)
        Residuals across the frames' own angles, each of variance 1 under the stated noise.
    design : ndarray, shape (F, k, P)
        Their derivatives by the shared numbers.
    whitener : ndarray, shape (F, k, 6)
        What makes a whitened residual of a small twist ``xi`` of the distal body's pose, ``J_t exp(xi)``.
    joint : ndarray, shape (F, 8)
        The relative poses themselves.
    second : ndarray, shape (F,), or None
        Another angle, where the motion is told by two.
    told : tuple of int or None
        Which of the joint's shared numbers these P are, where orientations alone do not tell all of them.
    """

    angle: Float
    inverse: Float
    whitened: Float
    design: Float
    whitener: Float
    joint: Float
    second: Float | None = None
    told: tuple[int, ...] | None = None

    @property
    def angles(self) -> Float:
        """All that the motion is told by, shape (F, 1) or (F, 2)."""
        return self.angle[:, None] if self.second is None else np.stack([self.angle, self.second], axis=1)

    @property
    def of_distal(self) -> Float:
        """Change (F, P, 6) of the shared numbers by a small twist of the distal body's pose, in its own frame."""
        return self.inverse @ (np.swapaxes(self.design, -1, -2) @ self.whitener)

    @property
    def of_proximal(self) -> Float:
        """Change (F, P, 6) of the shared numbers by a small twist of the proximal body's pose, in its own frame."""
        return -self.of_distal @ adjoint(dq.conjugate(self.joint))

    @property
    def determined(self) -> bool:
        """Whether the frames determine all the shared numbers."""
        return bool(np.isfinite(self.inverse).all())

    def size(self, covariance: Float) -> Float:
        """Covariances (..., P, P) in units of the stated noise's, ``tr(I C)``: the same in all frames and units."""
        scale = np.sqrt(np.diag(self.inverse))
        unit = np.outer(scale, scale)
        return np.asarray(np.trace(np.linalg.solve(self.inverse / unit, covariance / unit), axis1=-2, axis2=-1))

    @property
    def variance(self) -> float:
        """Squared whitened residuals over their degrees of freedom: 1 where the stated noise explains them."""
        return float(np.sum(self.whitened**2) / max(self.whitened.size - len(self.inverse), 1))


def influence_of_fit(fit: LineFit, joint: Float, covariance: Float) -> Influence:
    """Influence of each pose on the numbers of a hinge or screw-hinge.

    Parameters
    ----------
    fit : LineFit
    joint : ndarray, shape (F, 8)
        The poses it was fitted to.
    covariance : ndarray, shape (F, 6, 6)
        The weights it was fitted with.
    """
    derivatives, own, information = linear_model(fit, covariance)
    return influence_of_poses(
        fit.residual,
        derivatives,
        np.broadcast_to(own[:, None], (len(joint), 6, 1)),
        information,
        dq.conjugate(fit.distal),
        joint=joint,
        angle=fit.angle,
        weight=fit.weight,
        told=fit.told,
    )


def influence_of_poses(
    residual: Float,
    derivatives: Float,
    own: Float,
    information: Float,
    line_distal: Float,
    *,
    joint: Float,
    angle: Float,
    weight: Float,
    told: tuple[int, ...] | None = None,
) -> Influence:
    """Influence of each pose on the shared numbers of a joint of any type, the frames' own numbers eliminated.

    Parameters
    ----------
    residual : ndarray, shape (F, 6)
        What the model leaves of each pose, as a twist on the distal side.
    derivatives : ndarray, shape (F, 6, P)
        Of the model's poses by the shared numbers.
    own : ndarray, shape (F, 6, K)
        Of the model's poses by the frames' own numbers: one angle of a hinge, three of a ball.
    information : ndarray, shape (F, 6, 6)
        Of each pose; as the three before, in the frame of the distal line.
    line_distal : ndarray, shape (8,)
        Pose of the distal body in the frame of its line, ``F^-1``.
    joint : ndarray, shape (F, 8)
    angle, weight : ndarray, shape (F,)
        The motion, and the weight of each frame in the fit.
    told : tuple of int, optional
        Which of the shared numbers the poses tell of, if not of all.

    References
    ----------
    ``Psi_t = I^-1 (G^T - m g^T/own) W Ad(F)^-1``: with the rows Q across the whitened own columns it is
    ``I^-1 X^T Q L^T Ad(F)^-1``, where ``W = L L^T`` and ``X = Q L^T G``. Q turns steadily along the frames, so that the
    whitened residuals are series in time.
    """
    root = whitener_of(information)
    across = _across(root @ own) @ root * np.sqrt(weight)[:, None, None]
    design = across @ (derivatives if told is None else derivatives[..., list(told)])
    # The root of the frame's weight is in the whitener and in the design, so that the influence has all of it.
    return Influence(
        angle=angle,
        inverse=_inverse(np.tensordot(design, design, axes=((0, 1), (0, 1)))),
        whitened=(across @ residual[..., None])[..., 0],
        design=design,
        whitener=across @ adjoint(line_distal),
        joint=joint,
        told=told,
    )


def with_columns(influence: Influence, columns: Float) -> tuple[Influence, Float]:
    """Let the model have E shared numbers more, in one linear step.

    Parameters
    ----------
    influence : Influence
    columns : ndarray, shape (F, 6, E)
        Derivatives of the model's poses by the numbers more, as twists of the distal body in its own frame.

    Returns
    -------
    tuple of Influence and ndarray
        With P + E shared numbers, and their step (P + E,).
    """
    design = np.concatenate([influence.design, influence.whitener @ columns], axis=2)
    inverse = _inverse(np.tensordot(design, design, axes=((0, 1), (0, 1))))
    step = inverse @ np.tensordot(design, influence.whitened, axes=((0, 1), (0, 1)))
    return influence._replace(inverse=inverse, design=design, whitened=influence.whitened - design @ step), step


def _across(own: Float) -> Float:
    """Orthonormal rows (F, n - K, n) across the K columns (F, n, K) of each frame, turning no more than these do."""
    turned = np.swapaxes(own, -1, -2)
    rows, count = own.shape[-2:]
    square = turned @ own
    # Two columns of a frame may do one and the same, as the angles of parallel axes in one line.
    square = square + _SAME / max(count, 1) * np.trace(square, axis1=1, axis2=2)[:, None, None] * np.eye(count)
    projector = own @ np.linalg.solve(square, turned)
    # Fixed directions as far as can be from all frames' columns, made orthogonal to each frame's own.
    fixed = np.linalg.eigh(projector.mean(axis=0))[1][:, : rows - count]
    rest = fixed - projector @ fixed
    square = np.swapaxes(rest, -1, -2) @ rest
    return np.linalg.solve(np.linalg.cholesky(square), np.swapaxes(rest, -1, -2))


def _inverse(information: Float) -> Float:
    scale = np.sqrt(np.maximum(np.diag(information), 0.0))
    unknown = np.full(information.shape, np.nan)
    if not (scale > 0.0).all() or not np.isfinite(information).all():
        return unknown
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    if values[0] < _LEAST_INFORMATION:
        return unknown
    return np.asarray((vectors / values) @ vectors.T / np.outer(scale, scale), dtype=np.float64)
