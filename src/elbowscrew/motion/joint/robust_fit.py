"""Fits of every type of joint that outliers hardly move: Tukey's biweight of the frames' distances."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.likelihood import Fit, M, fit_mechanism, is_round_off, stepped
from elbowscrew.motion.joint.poses import Poses

_ROUNDS: Final = 30
_START_ROUNDS: Final = 10
_STEPS: Final = 2
_REFINEMENTS: Final = 100
_LEAST_SCALE: Final = 1e-150  # whose reciprocal has a square
# By the residual's degrees of freedom a frame: median of chi-square, and Tukey's constant with 95 % efficiency, from
# the asymptotic variance of an M-estimate of location in so many dimensions (Maronna, Martin and Yohai 2006).
_MEDIAN_SQUARE: Final = {1: 0.455, 2: 1.386, 3: 2.366, 4: 3.357, 5: 4.351, 6: 5.348}
_TUKEY: Final = {1: 4.685, 2: 5.123, 3: 5.490, 4: 5.810, 5: 6.096, 6: 6.356}


def fit_robustly(fit: Fit[M], poses: Poses) -> Fit[M]:
    """Go on from a fit by Tukey's biweight, after a start by weights 1/distance that forgets the outliers.

    References
    ----------
    Maronna, Martin and Yohai 2006; the scale is the median distance.
    """
    if not fit.frame_freedom:  # each frame is met exactly
        return fit
    variance = np.inf
    for k in range(_ROUNDS):
        relative = _relative_distance(fit)
        weight = 1.0 / np.maximum(relative, 1.0) if k < _START_ROUNDS else _biweight(relative, fit.frame_freedom)
        fit = fit_mechanism(fit.mechanism, poses, iterations=_STEPS, weight=weight)
        if k > _START_ROUNDS and abs(fit.variance - variance) <= 1e-10 * variance:
            break
        variance = fit.variance
    return fit


def refined_robustly(fit: Fit[M], poses: Poses) -> Fit[M]:
    """Go on from a robust fit until a step, after which the frames are weighed anew, is all round-off.

    Weights follow the distances that they make, so that steps shrink by a factor, where those of plain fits shrink to
    their squares.
    """
    if not fit.frame_freedom or not fit.information.size:
        return fit
    size = np.inf
    for _ in range(_REFINEMENTS):
        before = size
        fit, size = stepped(fit, poses, _biweight(_relative_distance(fit), fit.frame_freedom))
        if is_round_off(size, before):
            break
    return fit


def _relative_distance(fit: Fit[M]) -> Float:
    """Distance of each frame (F,) in units of that which the median has."""
    distance = np.sqrt(fit.square)
    scale = float(np.median(distance)) / np.sqrt(_MEDIAN_SQUARE[fit.frame_freedom])
    return np.asarray(distance / max(scale, _LEAST_SCALE))


def _biweight(relative: Float, freedom: int) -> Float:
    return np.asarray(np.maximum(1.0 - (relative / _TUKEY[freedom]) ** 2, 0.0) ** 2)
