"""Whether an interval about a curve is wide enough to be seen on paper."""

from __future__ import annotations

from typing import Final

import numpy as np

from elbowscrew.geometry.arrays import Float

# Of the panel's range: on a panel some 50 mm high a band that reaches a little beyond the line, 0.4 mm wide.
_LEAST: Final = 0.007


def is_seen(values: Float, reach: Float, span: float | None = None) -> bool:
    """Tell whether a band of `reach` (N,) to either side of `values` (N,) shows on a figure.

    Where it does not, or is not known, the figure leaves it out and its caption tells of it. `span` is what the panel's
    curves span where it has several; by default what these values do.
    """
    known = np.isfinite(reach) & np.isfinite(values)
    if not known.any():
        return False
    span = float(np.ptp(values[known])) if span is None else span
    return float(np.percentile(reach[known], 95.0)) > _LEAST * span


def span_of(curves: Float) -> float:
    """What curves on one panel span together, NaN left out; 0 of none."""
    known = curves[np.isfinite(curves)]
    return float(np.ptp(known)) if known.size else 0.0
