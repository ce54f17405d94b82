"""Which segments from a keyframe cannot hold, told from how far the body gets, before any segment is made."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Bool, Float, Index

_STRIDE: Final = 16  # of so many frames one is looked at
_ROUND_OFF_M: Final = 2e-8
_WHOLE_TURN: Final = 1e-9 - 1.0  # cosine of half a turn that is nearly whole: its bounds are lost in round-off


class Cone(NamedTuple):
    """The speeds at which a segment from a keyframe may go, given by every frame that it passes.

    In the coordinates of the poses the RMS displacement is the distance. A turn by x and a slide t about one screw lead
    ``f = sqrt(4 r^2 sin^2(x/2) + t^2)`` away from the first pose, r the points' RMS distance from the screw. By ScLERP,
    x and t grow as u, the share of the segment: so ``f(u)/u`` falls, at most by the factor ``h/sin(h)`` from the start
    to the end, h half the whole turn. By sDLB it is between ``cos(h)`` and ``1/cos^2(h/2)`` times ``f(1)``. And f(u)
    is within the tolerance of how far away the measured pose is: a segment to where later frames lie outside of what
    an earlier one allows cannot hold, as in the search of Imai and Iri.

    Attributes
    ----------
    placed : ndarray, shape (N, 12)
        Coordinates of the poses (`elbowscrew.motion.difference.point_coordinates`).
    quat : ndarray, shape (N, 4)
    parameter : ndarray, shape (N,)
    tolerance : float
        In the unit of the coordinates.
    even : bool
        Whether the method is ScLERP; else it is sDLB.

    References
    ----------
    Imai and Iri 1988.
    """

    placed: Float
    quat: Float
    parameter: Float
    tolerance: float
    even: bool

    def leaves(self, first: int, ends: Index) -> Index:
        """Give those of later rows, increasing, to which frames between allow a segment, all that hold among them."""
        least, most = self._allowed(first, int(ends[-1]))
        ends = ends[: np.searchsorted(ends, first + _STRIDE * least.size)]
        passed = (ends - first) // _STRIDE
        c = self.quat[ends] @ self.quat[first]
        speed = self._distance(first, ends) / (self.parameter[ends] - self.parameter[first])
        slowest, fastest = self._factors(c)
        with np.errstate(over="ignore"):
            holds: Bool = (speed * slowest <= most[passed]) & (speed * fastest >= least[passed])
        holds |= c < _WHOLE_TURN
        left: Index = ends[holds]
        return left

    def _allowed(self, first: int, last: int) -> tuple[Float, Float]:
        """Least and largest ``f(u)/u`` by the frames looked at, before any, after one, and so on while any is left."""
        rows = np.arange(first + _STRIDE, last + 1, _STRIDE)
        distance, span = self._distance(first, rows), self.parameter[rows] - self.parameter[first]
        reach = self.tolerance + _ROUND_OFF_M
        with np.errstate(divide="ignore", invalid="ignore"):
            low, high = (distance - reach) / span, (distance + reach) / span
        least = np.fmax.accumulate(np.concatenate([[-np.inf], low]))
        most = np.fmin.accumulate(np.concatenate([[np.inf], high]))
        widest = (self.quat[first : last + 1] @ self.quat[first]).min()
        slowest, fastest = self._factors(widest)
        with np.errstate(invalid="ignore", over="ignore"):
            closed = np.flatnonzero((least * slowest.clip(0.0) > most * fastest) & (widest >= _WHOLE_TURN))
        kept = slice(closed[0] if closed.size else None)
        return least[kept], most[kept]

    def _distance(self, first: int, rows: Index) -> Float:
        way = self.placed[rows] - self.placed[first]
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", way, way)))

    def _factors(self, c: Float) -> tuple[Float, Float]:
        """Bounds of ``f(u)/u`` by f(1), where c is the cosine of half the turn, or the least that it may be."""
        c = np.clip(c, -1.0, 1.0)
        if self.even:
            half = np.arccos(c)
            return np.ones_like(half), 1.0 / np.sinc(half / np.pi).clip(1e-300)
        return c, 2.0 / (1.0 + c).clip(1e-300)
