"""Blending of many poses by weights: DLB and DIB (`Q` and `-Q`: see `elbowscrew.geometry.interpolation`)."""

from __future__ import annotations

import itertools
import operator
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowscrew.geometry import _rows, dual_quaternion
from elbowscrew.geometry._blocks import BLOCK, in_blocks, is_single
from elbowscrew.geometry._small_angle import VANISHING_NORM, length, row_length
from elbowscrew.geometry._ways import WayRound, check_way, choose_signs
from elbowscrew.geometry.arrays import Float


def lagrange_weights(fraction: ArrayLike, knots: ArrayLike) -> NDArray[np.float64]:
    """Lagrange polynomials on the knots: weight j is 1 at knot j, 0 at the others, and the weights add up to 1.

    Parameters
    ----------
    fraction : array_like, shape (...)
        Where to evaluate.
    knots : array_like, shape (n,)
        Different from each other.

    Returns
    -------
    ndarray, shape (..., n)

    Raises
    ------
    ValueError
        If two knots are the same.

    References
    ----------
    P 34.

    Examples
    --------
    >>> lagrange_weights(0.25, [0.0, 0.5, 1.0])
    array([ 0.375,  0.75 , -0.125])
    """
    knot = np.asarray(knots, dtype=np.float64)
    if np.unique(knot).size != knot.size:
        msg = f"knots must differ from each other, found {knot.tolist()}"
        raise ValueError(msg)
    values: list[float] = knot.tolist()
    sizes = [_products_but_one([value - other for other in values])[j] for j, value in enumerate(values)]

    def kernel(t: _rows.Rows) -> list[Float]:
        products = _products_but_one([t[0] - value for value in values])
        return [product / size for product, size in zip(products, sizes, strict=True)]

    return in_blocks(kernel, np.asarray(fraction, dtype=np.float64)[..., None], width=knot.size)


def _products_but_one(factors: Sequence[Any]) -> list[Any]:
    """Products of all factors but the first, all but the second, and so on: of numbers, or of arrays."""
    before = list(itertools.accumulate(factors[:-1], operator.mul))
    behind = list(itertools.accumulate(factors[:0:-1], operator.mul))[::-1]
    if not before:
        return [1.0]
    return [behind[0], *(one * other for one, other in zip(before[:-1], behind[1:], strict=True)), before[-1]]


def dlb(poses: ArrayLike, weights: ArrayLike, *, way: WayRound = "shortest") -> NDArray[np.float64]:
    """Blend poses: weighted sum, normalized by the dual norm.

    Parameters
    ----------
    poses : array_like, shape (..., n, 8)
        Unit dual quaternions.
    weights : array_like, shape (..., n)
        One for each pose, adding up to 1; they may be negative (`lagrange_weights`).
    way : {"shortest", "longest", "as given"}
        Signs of all poses nearer the first one's, farther from it, or as they stand.

    Returns
    -------
    ndarray, shape (..., 8)
        NaN where the weighted sum vanishes, so that its direction would be noise.

    Raises
    ------
    ValueError
        If `way` is none of the three.

    References
    ----------
    P 33, algorithm 2.

    Examples
    --------
    A number of P table 1.

    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> poses = dual_quat_from_screw([0, np.pi / 8, np.pi / 4], [0, 5, 10], [0, 0, 1], [0, 0, 0])
    >>> blend = dlb(poses, lagrange_weights(0.2, [0, 0.5, 1]))
    >>> dual_quaternion.pose_from_dual_quat(blend)[1].round(6) + 0.0
    array([0.     , 0.     , 2.03664])
    """
    keys, w = _Keys.of(poses, way), np.asarray(weights, dtype=np.float64)
    return in_blocks(keys.blend, keys.flat, w, width=8)


class _Keys(NamedTuple):
    """Keyframes to blend, with their signs chosen.

    Attributes
    ----------
    flat : ndarray, shape (..., n * 8)
        All poses of a frame, one after the other.
    way : WayRound
    columns : ndarray, shape (8, n), or None
        The poses as they are to be blended if they are the same in all frames.
    """

    flat: Float
    way: WayRound
    columns: Float | None

    @classmethod
    def of(cls, poses: ArrayLike, way: WayRound) -> _Keys:
        check_way(way)
        Q = np.asarray(poses, dtype=np.float64)
        flat = Q.reshape(*Q.shape[:-2], 8 * Q.shape[-2])
        if not is_single(flat):
            return cls(flat, way, None)
        return cls(flat, way, np.stack(cls(flat, way, None).rows(flat.reshape(-1, 1)), axis=1)[..., 0])

    def rows(self, flat: Float) -> list[_rows.Rows]:
        """Rows of each pose, out of the rows of all."""
        first, *others = flat.reshape(-1, 8, flat.shape[-1])
        return [first, *(choose_signs(other, first, self.way) for other in others)]

    def blend(self, flat: Float, weights: Float) -> list[Float]:
        """Weighted sum, normalized (P 33)."""
        total = _rows.weighted(weights, self.rows(flat)) if self.columns is None else self.columns @ weights
        return _rows.normalized(total, VANISHING_NORM)

    def steps(self, flat: Float, frames: int) -> Callable[[_rows.Rows], Iterator[tuple[slice, _rows.Rows]]]:
        """Give a function of poses B that gives the steps from there to keyframes, ``B* Q_i``, and which these are.

        Of short series it gives many at once, rows (n, m): there, each call of NumPy takes longer than its numbers do.
        """
        at_once = max(BLOCK // frames, 1)
        parts = [slice(start, start + at_once) for start in range(0, len(flat) // 8, at_once)]
        if self.columns is None:
            keys = np.swapaxes(np.array(self.rows(flat)), 0, 1)
            return lambda B: ((part, _rows.dual_product(_rows.conjugate(B), keys[:, part])) for part in parts)
        real, dual = (np.stack(maps) for maps in zip(*map(_rows.right_maps, self.columns.T), strict=True))

        def steps(B: _rows.Rows) -> Iterator[tuple[slice, _rows.Rows]]:
            back = np.stack(_rows.conjugate(B))
            for part in parts:
                yield part, [*np.moveaxis(real[part] @ back[:4], 1, 0), *np.moveaxis(dual[part] @ back, 1, 0)]

        return steps


class IterativeBlend(NamedTuple):
    """Result of `dib`.

    Attributes
    ----------
    dual_quat : ndarray, shape (..., 8)
        The blended poses, unit dual quaternions.
    iterations : int
        Steps taken, for all poses together.
    residual : ndarray, shape (...)
        Length of the last step: of its rotation (rad) and of its translation relative to the size of the poses.
    """

    dual_quat: NDArray[np.float64]
    iterations: int
    residual: NDArray[np.float64]


def dib(
    poses: ArrayLike,
    weights: ArrayLike,
    *,
    tolerance: float = 1e-12,
    max_iterations: int = 100,
    way: WayRound = "shortest",
) -> IterativeBlend:
    """Dual quaternion iterative blending: from DLB on, ``B <- B exp(sum_i w_i log(B* Q_i))`` until the step is small.

    The result is the weighted mean on the group itself: it does not depend on the frame, and between two poses it is
    ScLERP.

    Parameters
    ----------
    poses : array_like, shape (..., n, 8)
        Unit dual quaternions.
    weights : array_like, shape (..., n)
        One for each pose, adding up to 1; as in `dlb`.
    tolerance : float
        Largest step at which to stop.
    max_iterations : int
        Stop here in any case; look at the residual then.
    way : {"shortest", "longest", "as given"}
        As in `dlb`.

    Returns
    -------
    IterativeBlend
        NaN where the first blend vanishes.

    Raises
    ------
    ValueError
        If `way` is none of the three.

    References
    ----------
    P algorithm 3.

    Examples
    --------
    A number of P table 1.

    >>> from elbowscrew.geometry import dual_quat_from_screw
    >>> poses = dual_quat_from_screw([0, np.pi / 8, np.pi / 4], [0, 5, 10], [0, 0, 1], [0, 0, 0])
    >>> blend = dib(poses, lagrange_weights(0.2, [0, 0.5, 1]))
    >>> dual_quaternion.pose_from_dual_quat(blend.dual_quat)[1].round(6) + 0.0
    array([0., 0., 2.])
    """
    keys, w = _Keys.of(poses, way), np.asarray(weights, dtype=np.float64)
    reach = np.max(length(dual_quaternion.pose_from_dual_quat(poses)[1]), axis=-1, initial=0.0)
    iterations = 0

    def kernel(flat: Float, weights: Float, reach: Float) -> list[Float]:
        nonlocal iterations
        blend = keys.blend(flat, weights)
        residual = np.full(blend[0].shape, np.inf)
        steps = keys.steps(flat, residual.size)
        done = 0
        while done < max_iterations and np.any(residual > tolerance):
            step = np.zeros((6, residual.size))
            for part, rows in steps(blend):
                for total, row in zip(step, _rows.logarithm(rows)[0], strict=True):
                    total += np.sum(weights[part] * row, axis=0)
            blend = _rows.normalized(_rows.dual_product(blend, _rows.exponential(step)))
            residual = np.maximum(row_length(step[:3]), row_length(step[3:]) / (1.0 + reach[0]))
            done += 1
        iterations = max(iterations, done)
        return [*blend, residual]

    found = in_blocks(kernel, keys.flat, w, reach[..., None], width=9)
    return IterativeBlend(found[..., :8], iterations, found[..., 8])
