"""An angle that only steps once between two levels, as that of a joint does whose marker cluster slips."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.quantities import in_digits

_LARGEST: Final = np.radians(25.0)
"""A larger one is a movement: somebody who turns the forearm once, or bends a knee and holds it."""

_LARGEST_SPREAD: Final = 0.15
_LONGEST_PASSAGE: Final = 0.05
_SHORTEST_LEVEL: Final = 0.05
_FEWEST: Final = 20
_MAD_TO_SD: Final = 1.4826


class SingleStep(NamedTuple):
    """Where it is, the row after it, and how far it goes, radians."""

    row: int
    size: float

    @property
    def words(self) -> str:
        """How far, and what would do so."""
        return f"steps once, by {in_digits(np.degrees(self.size))} deg, and else stays, as where a cluster slips"


def single_step(angle: Float) -> SingleStep | None:
    """Tell whether an angle (N,), radians, in order of time, steps once by 25 deg at most and else stays.

    Both levels keep within 15 % of the step, by their median deviations, hold a twentieth of the frames and more, and
    no more than a twentieth lie between the quarters of the step.
    """
    rows = np.flatnonzero(np.isfinite(angle))
    values = angle[rows]
    count = len(values)
    if count < _FEWEST:
        return None
    # The change that leaves least about the means of both sides.
    before = np.arange(1, count)
    sums = np.cumsum(values - values.mean())[:-1]
    gain = sums**2 * count / (before * (count - before))
    least = max(int(_SHORTEST_LEVEL * count), 2)
    gain[:least], gain[count - least :] = 0.0, 0.0
    at = int(np.argmax(gain)) + 1
    levels = [float(np.median(part)) for part in (values[:at], values[at:])]
    size = abs(levels[1] - levels[0])
    if not 0.0 < size <= _LARGEST:
        return None
    parts = (values[:at] - levels[0], values[at:] - levels[1])
    spread = _MAD_TO_SD * max(float(np.median(np.abs(part))) for part in parts)
    share = (values - levels[0]) / (levels[1] - levels[0])
    passage = np.mean((share > 0.25) & (share < 0.75))
    crossings = np.count_nonzero(np.diff(share > 0.5))
    if spread > _LARGEST_SPREAD * size or passage > _LONGEST_PASSAGE or crossings != 1:
        return None
    return SingleStep(int(rows[at]), size)
