"""Swapped bodies by the shape of their marker clusters: distances tell which cluster is seen, in whatever order."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning
from elbowscrew.reading.builders import ArrayBuilder

_OFF_M: Final = 0.005
_MOST_ROWS: Final = 65536
_FRAMES_TOLD: Final = 10


def signature(points: Float) -> Float:
    """Sorted distances between all pairs of points (..., M, 3), shape (..., M (M - 1) / 2): free of order and pose."""
    first, second = np.triu_indices(points.shape[-2], k=1)
    return np.sort(np.linalg.norm(points[..., first, :] - points[..., second, :], axis=-1), axis=-1)


class ClusterMismatch:
    """The frames in which a body's markers do not fit it, and the shape they have then."""

    def __init__(self, name: str, offsets: Float) -> None:
        self.name = name
        self.own = signature(offsets)
        self._rows, self._shapes = ArrayBuilder(dtype=np.int64), ArrayBuilder((self.own.size,))
        self._seen_rows = self._kept = 0

    def append(self, seen: Float, residual: Float) -> None:
        """Take a block of frames: markers seen, shape (n, M, 3), and the RMS of their misfit, shape (n,)."""
        odd = np.flatnonzero((np.nan_to_num(residual) > _OFF_M) & np.isfinite(seen).all(axis=(1, 2)))
        odd = odd[: _MOST_ROWS - self._kept]
        self._rows.append(odd + self._seen_rows)
        self._shapes.append(signature(seen[odd]))
        self._kept += odd.size
        self._seen_rows += len(seen)

    def finish(self) -> tuple[NDArray[np.int64], Float]:
        """Give the rows and their signatures."""
        return self._rows.finish(), self._shapes.finish()


def swap_warnings(bodies: Sequence[ClusterMismatch], frame: NDArray[np.int64]) -> list[QualityWarning]:
    """Tell of frames in which the markers of two bodies have each other's shape."""
    found = []
    odd = [body.finish() for body in bodies]
    for i, j in combinations(range(len(bodies)), 2):
        one, other = bodies[i], bodies[j]
        if one.own.size != other.own.size or _misfit(one.own, other.own) <= _OFF_M:
            continue
        rows, first, second = np.intersect1d(odd[i][0], odd[j][0], return_indices=True)
        exchanged = (_misfit(odd[i][1][first], other.own) < _OFF_M) & (_misfit(odd[j][1][second], one.own) < _OFF_M)
        swapped = rows[exchanged]
        if swapped.size:
            message = (
                f"in {swapped.size} frames, the first {frame[swapped[0]]}, the markers of {one.name!r} have the shape "
                f"of {other.name!r} and the other way round: the bodies are swapped; relabel them in Motive"
            )
            told = tuple(frame[swapped[:_FRAMES_TOLD]].tolist())
            found.append(QualityWarning(code="swapped-clusters", message=message, frames=told, count=int(swapped.size)))
    return found


def _misfit(shapes: Float, shape: Float) -> Float:
    misfit: Float = np.abs(shapes - shape).max(axis=-1)
    return misfit
