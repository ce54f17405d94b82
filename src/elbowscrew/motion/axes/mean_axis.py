"""Mean of the finite helical axes and their spread about it."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.lines import angle_of_lines, direction_between, piercing
from elbowscrew.model import MeanAxis

_MOST_COMPARED: Final = 1000
_STEP: Final = float(np.radians(1.0))
_ROUNDING: Final = 1e-12
_SHARE_ACROSS: Final = 0.05

MOST_ACROSS: Final = float(np.radians(75.0))
"""Largest angle of an axis from the mean one at which it has a distance from that."""


def mean_line_of(angle: Float, line: Float) -> tuple[Float, Float]:
    """Direction and point nearest the origin, each (3,), of the weighted mean of lines; as of `mean_axis_of`.

    Parameters
    ----------
    angle : ndarray, shape (N,)
    line : ndarray, shape (N, 6)
        All of them known.
    """
    weights = np.sin(0.5 * angle) ** 2
    mean = weights @ line / weights.sum()
    scale = length(mean[:3])
    direction = mean[:3] / scale
    return direction, np.cross(direction, mean[3:] / scale)


def mean_axis_of(angle: Float, line: Float, near: Float) -> MeanAxis:
    """Weighted mean of lines, as dual vectors, with weights ``sin^2(theta/2)``.

    The direction noise of a finite axis grows as 1/sin(theta/2), so these are the inverse variances. The spread is
    told about the plain mean of the directions, every frame alike, as the literature does and so that it compares.
    An axis more than 75 deg from the mean one has no distance from it: nearly in the plane across, it pierces that
    anywhere or nowhere. Where more than 5 % of the axes are so far off, as a ball's are, no axis has. A single axis has
    no spread, and is none from itself.

    Parameters
    ----------
    angle : ndarray, shape (N,)
        Rotation of each frame, radians.
    line : ndarray, shape (N, 6)
        Plücker vectors, one way round; NaN where there is no axis. At least one must be known.
    near : ndarray, shape (3,)
        A point of the body; distances are taken across the mean axis where it passes this point.

    References
    ----------
    Woltring 1994, Human Movement Science 13.
    """
    known = np.isfinite(line).all(axis=1)
    direction, point = mean_line_of(angle[known], line[known])
    plain = line[known, :3].mean(axis=0)
    deviation = direction_between(line, plain)
    # Where each axis pierces the plane across the mean axis at `near`: the same in whatever frame it is described.
    center = point + ((near - point) @ direction) * direction
    position = piercing(line[:, :3], np.cross(line[:, :3], line[:, 3:]), direction, center) - center
    weights = np.sin(0.5 * angle[known]) ** 2
    off = angle_of_lines(line[known], direction)
    position[np.flatnonzero(known)[off > MOST_ACROSS]] = np.nan
    if np.mean(off > MOST_ACROSS) > _SHARE_ACROSS:
        position[:] = np.nan
    chosen = evenly_thinned(np.flatnonzero(known), _MOST_COMPARED)
    if len(off) < 2:
        unknown = np.full(len(line), np.nan)
        return MeanAxis(
            direction=direction,
            point=point,
            dispersion=np.nan,
            weighted_dispersion=np.nan,
            deviation=unknown,
            distance=unknown,
            excursion=np.nan,
            position_excursion=np.nan,
        )
    return MeanAxis(
        direction=direction,
        point=point,
        dispersion=_dispersion_by_angle(angle[known], line[known, :3]),
        weighted_dispersion=float(np.sqrt(weights @ off**2 / weights.sum())),
        deviation=deviation,
        distance=length(position),
        excursion=float(2.0 * np.arcsin(min(0.5 * _largest_distance(line[chosen, :3]), 1.0))),
        position_excursion=_largest_distance(position[chosen]) if np.isfinite(position).any() else float("nan"),
    )


def _dispersion_by_angle(angle: Float, direction: Float) -> float:
    """Median angle of directions from their mean, where each degree of the motion counts as much as another.

    So it does not hang on how long the joint stays at an angle.
    """
    step = np.floor((angle - angle.min()) / _STEP).astype(np.int64)
    weight = 1.0 / np.bincount(step)[step]
    mean = weight @ direction
    deviation = direction_between(direction, mean)
    order = np.argsort(deviation)
    share = np.cumsum(weight[order])
    lower, upper = np.searchsorted(share, 0.5 * share[-1] * np.array([1.0 - _ROUNDING, 1.0 + _ROUNDING]))
    return float(0.5 * (deviation[order[lower]] + deviation[order[min(upper, order.size - 1)]]))


def _largest_distance(points: Float) -> float:
    """Between any two of the points (M, 3)."""
    known = points[np.isfinite(points).all(axis=1)]
    if not len(known):
        return 0.0
    radius = length(known - known.mean(axis=0))
    found = float(length(known - known[np.argmax(radius)]).max())
    # Two points that are farther apart than these are as far from the mean together: the inner points are none of them.
    outer = known[radius >= (1.0 - _ROUNDING) * found - radius.max()]
    return max(found, *(float(length(outer - one).max()) for one in outer))
