"""Smooth motions through keyframes at irregular distances."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import dual_quaternion
from elbowscrew.geometry._ways import WayRound, check_way
from elbowscrew.geometry.interpolation import sclerp


def catmull_rom(
    poses: ArrayLike, knots: ArrayLike, parameter: ArrayLike, *, way: WayRound = "shortest"
) -> NDArray[np.float64]:
    """Smooth motion through all keyframes at their knots: the Barry-Goldman pyramid, ScLERP in place of lerp.

    Parameters
    ----------
    poses : array_like, shape (n, 8)
        Unit dual quaternions, at least two.
    knots : array_like, shape (n,)
        Increasing, at any distances.
    parameter : array_like, shape (...)
        Where to evaluate; beyond the ends the end segments go on.
    way : {"shortest", "longest", "as given"}
        Sign of each pose nearer the one before, farther from it, or as it stands.

    Returns
    -------
    ndarray, shape (..., 8)
        The velocity is continuous at the knots. Beyond the ends the first and the last step are repeated.

    Raises
    ------
    ValueError
        If there are fewer than two poses, or the knots are not as many and increasing.

    References
    ----------
    K, section on splines; Barry and Goldman 1988.

    Examples
    --------
    Heights 0, 1, 3 and 4 at the knots 0, 1, 2 and 3: half way between the middle ones.

    >>> poses = np.outer([0, 0.5, 1.5, 2], [0, 0, 0, 0, 0, 0, 0, 1]) + [1, 0, 0, 0, 0, 0, 0, 0]
    >>> dual_quaternion.pose_from_dual_quat(catmull_rom(poses, [0, 1, 2, 3], [1, 1.5]))[1].round(6) + 0.0
    array([[0., 0., 1.],
           [0., 0., 2.]])
    """
    Q = np.asarray(poses, dtype=np.float64)
    t = np.asarray(knots, dtype=np.float64)
    if Q.ndim != 2 or len(Q) < 2 or t.shape != (len(Q),) or (np.diff(t) <= 0.0).any():
        msg = f"expected two poses or more with increasing knots, found {Q.shape} and {t.tolist()}"
        raise ValueError(msg)
    check_way(way)
    if way != "as given":
        Q = dual_quaternion.continuous_signs(Q)
    if way == "longest":
        Q[1::2] *= -1.0
    before = sclerp(Q[0], Q[1], -1.0, way="as given")
    after = sclerp(Q[-2], Q[-1], 2.0, way="as given")
    Q = np.concatenate([before[None], Q, after[None]])
    t = np.concatenate([[2.0 * t[0] - t[1]], t, [2.0 * t[-1] - t[-2]]])
    x = np.asarray(parameter, dtype=np.float64)
    first = np.clip(np.searchsorted(t, x, side="right") - 1, 1, len(t) - 3) - 1
    level = np.stack([Q[first + k] for k in range(4)])
    for width in (1, 2, 3):
        spans = [_span(t, first, k, width) for k in range(4 - width)]
        low, high = (np.stack(ends) for ends in zip(*spans, strict=True))
        level = sclerp(level[:-1], level[1:], (x - low) / (high - low), way="as given")
    blend: NDArray[np.float64] = level[0]
    return blend


def _span(
    knots: NDArray[np.float64], first: NDArray[np.intp], k: int, width: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Ends of the interval a node of the pyramid blends over: the middle one at the top, wider ones below."""
    low, high = (k, k + 1) if width == 1 else (k, k + 2) if width == 2 else (1, 2)
    return knots[first + low], knots[first + high]
