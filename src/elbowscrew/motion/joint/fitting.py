"""Each type of joint fitted to poses from its own start, and how sure its shared numbers are."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, Literal

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.joint_fit import integrated_autocorrelation
from elbowscrew.motion.joint.likelihood import Fit, M, Mechanism, fit_mechanism
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.robust_fit import fit_robustly
from elbowscrew.motion.joint.simple_types import Ball, OneAxis, Rigid
from elbowscrew.motion.joint.starts import find_two_axes
from elbowscrew.motion.joint.two_axes import is_phantom

Fitted = Literal["rigid", "hinge", "screw_hinge", "two_axes", "ball"]

_ITERATIONS: Final = 25
_PHANTOM_ITERATIONS: Final = 4
_TOLERANCE: Final = 1e-6
_LEAST_INFORMATION: Final = 1e-13
_LEAST_FREEDOM: Final = 20.0


def fit_type(name: Fitted, poses: Poses, *, robust: bool = False, hinge: Fit[OneAxis] | None = None) -> Fit[Mechanism]:
    """Fit one type of joint to poses, from its own start; a screw-hinge from the hinge, and leaving no more.

    Who has the hinge of least squares already passes it on.
    """
    fit: Fit[Mechanism]
    match name:
        case "rigid":
            fit = _least(Rigid.start(poses.joint), poses)
        case "hinge":
            fit = hinge or least_hinge(poses)
        case "screw_hinge":
            fit = _least(replace((hinge or least_hinge(poses)).mechanism, screw=True), poses)
        case "two_axes":
            found = find_two_axes(poses)
            # A phantom has no optimum worth a long search: it only has to be told.
            iterations = _PHANTOM_ITERATIONS if is_phantom(found) else _ITERATIONS
            fit = _least(found.mechanism.placed(poses.joint), poses, iterations)
        case "ball":
            fit = _least(Ball.start(poses.joint), poses)
    return fit_robustly(fit, poses) if robust else fit


def least_hinge(poses: Poses) -> Fit[OneAxis]:
    """Fit a hinge by least squares."""
    return _least(OneAxis.start(poses.joint), poses)


def _least(start: M, poses: Poses, iterations: int = _ITERATIONS) -> Fit[M]:
    return fit_mechanism(start, poses, iterations=iterations, tolerance=_TOLERANCE)


def fit_again(start: M, poses: Poses, weight: Float) -> Fit[M]:
    """Fit a joint from another start, under the weights (F,) that the frames have."""
    return fit_mechanism(start, poses, iterations=_ITERATIONS, tolerance=_TOLERANCE, weight=weight)


def shared_covariance(fit: Fit[Mechanism], *, noise_known: bool) -> Float:
    """Covariance (P, P) of the shared numbers: of the stated noise, or of larger and correlated residuals.

    NaN where the frames do not determine them, or are too few to tell of a noise that nobody states; and of the numbers
    that orientations do not tell.
    """
    scale = np.sqrt(np.maximum(np.diag(fit.information), 0.0))
    unknown = np.full((fit.mechanism.shared_count,) * 2, np.nan)
    if not scale.size or not (scale > 0.0).all() or not (noise_known or fit.freedom >= _LEAST_FREEDOM):
        return unknown
    values, vectors = np.linalg.eigh(fit.information / np.outer(scale, scale))
    if values[0] < _LEAST_INFORMATION:
        return unknown
    inverse: Float = (vectors / values) @ vectors.T / np.outer(scale, scale)
    told = range(len(unknown)) if fit.told is None else fit.told
    unknown[np.ix_(told, told)] = (
        inverse * max(fit.variance, 1.0 if noise_known else 0.0) * frames_that_count_as_one(fit)
    )
    return unknown


def frames_that_count_as_one(fit: Fit[Mechanism]) -> float:
    """Integrated autocorrelation of the residuals: 1 for white noise."""
    return integrated_autocorrelation(fit.whitened * np.sqrt(fit.weight)[:, None])
