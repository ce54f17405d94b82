"""A fitted joint taken apart by frames: what its covariance under any noise is made of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.likelihood import Fit, Mechanism
from elbowscrew.motion.joint.poses import Poses


class Pieces(NamedTuple):
    """A fit, linear in the errors of its poses: what a covariance under any noise is made of.

    A pose error ``e_t`` (twist in the distal body's frame) moves the shared numbers by ``I^-1 design^T whitener e_t``.

    Attributes
    ----------
    whitened : ndarray, shape (F, 6 - k), or (F, 3 - k) where the positions were not measured
        Residuals across the frame's own numbers, each of variance 1 under the stated noise.
    design : ndarray, shape (F, 6 - k, P)
        Their derivatives by the shared numbers that are told.
    whitener : ndarray, shape (F, 6 - k, 6)
        Their derivatives by the error of the pose.
    """

    whitened: Float
    design: Float
    whitener: Float


def influence_pieces(fit: Fit[Mechanism], poses: Poses) -> Pieces:
    """Take a fit apart, frame by frame, weights of a robust fit included; to first order in the residuals.

    Parameters
    ----------
    fit : Fit
    poses : Poses
        Those of the fit.
    """
    linear = fit.mechanism.linear(poses.joint)
    whitener = poses.whitener @ adjoint(fit.mechanism.residual_frame)
    k = linear.own.shape[2]
    across = np.linalg.qr(whitener @ linear.own, mode="complete")[0][..., k:]
    across = across if k else np.eye(poses.whitener.shape[-2])
    across = np.swapaxes(across, -1, -2) * np.sqrt(fit.weight)[:, None, None]
    whitened = across @ (whitener @ linear.residual[..., None])
    told = linear.shared if fit.told is None else linear.shared[..., list(fit.told)]
    return Pieces(whitened[..., 0], across @ whitener @ told, across @ poses.whitener)
