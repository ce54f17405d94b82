"""The frames that decide which joint it is: spread over the motion, so that a long rest does not outvote it."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._blocks import evenly_thinned
from elbowscrew.geometry.arrays import Float, Index

_CELLS: Final = 20  # across the range of the rotation
_LARGEST_SHARE: Final = 0.5
_FEWEST: Final = 50
_ROUNDS: Final = 200


def deciding_frames(joint: Float, most: int) -> Index:
    """Rows, in order, of at most so many of the poses (F, 8): evenly spread, but half of them in one pose at most.

    Poses are one where their rotation vectors differ by less than a twentieth of the range, whenever they come. Where
    the motion does not visit enough of them, as without any, the rows are evenly spread in time.
    """
    vector = 2.0 * dq.log(dq.canonical(dq.multiply(dq.conjugate(joint[:1]), joint)))[:, :3]
    size = float(np.ptp(vector, axis=0).max()) / _CELLS
    rows = np.arange(len(joint))
    if not size > 0.0:
        return evenly_thinned(rows, most)
    # A pose at the edge of a cell of one grid lies amid a cell of the other.
    crowd = np.maximum(*(_crowd(np.floor(vector / size + shift).astype(np.int64)) for shift in (0.0, 0.5)))
    largest, total = np.inf, float(rows.size)
    for _ in range(_ROUNDS):
        largest, before = _LARGEST_SHARE * total, total
        total = float(np.minimum(1.0, largest / crowd).sum())
        if total >= 0.999 * before:
            break
    if total == rows.size or total < _FEWEST:
        return evenly_thinned(rows, most)
    part = np.cumsum(np.minimum(1.0, largest / crowd))
    wanted = np.linspace(part[0], part[-1], min(most, int(total)))
    return np.unique(np.searchsorted(part, wanted * (1.0 - 1e-12)))


def _crowd(cell: Index) -> Float:
    """How many poses lie in the cell (F, 3) of each."""
    _, which, count = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
    return np.asarray(count[which.reshape(-1)], dtype=np.float64)
