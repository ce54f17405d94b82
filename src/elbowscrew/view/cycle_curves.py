"""The angle of each cycle over its own time, and what all of them span."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.view.bands import is_seen
from elbowscrew.view.trial_view import TrialView


class CycleCurves(NamedTuple):
    """Curves (C, P) of the angle, radians, over percents (P,) of each cycle's time."""

    percent: Float
    curves: Float

    def span(self) -> tuple[Float, Float]:
        """Give the smallest and the largest angle at each percent, NaN where none is known."""
        return np.fmin.reduce(self.curves), np.fmax.reduce(self.curves)

    @property
    def is_seen(self) -> bool:
        """Whether what they span shows beside a line through its middle."""
        low, high = self.span()
        return is_seen(0.5 * (low + high), 0.5 * (high - low))

    @property
    def widest(self) -> float:
        """The most that they span at one percent; 0 where none is known."""
        low, high = self.span()
        return float(np.nanmax(high - low)) if np.isfinite(high - low).any() else 0.0


def cycle_curves(view: TrialView) -> CycleCurves:
    """Take the curves from the table of the cycles."""
    table = view.extra["cycles"]
    count = np.unique(table["cycle"]).size
    return CycleCurves(table["percent"].reshape(count, -1)[0], table["angle"].reshape(count, -1))
