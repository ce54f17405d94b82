"""Numbers for JSON: None where nothing is known, as JSON has no NaN."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from elbowscrew.geometry.arrays import Float


def known(value: Any) -> float | None:
    """Give a number, or None if it is not finite."""
    return float(value) if np.isfinite(value) else None


def known_vector(values: Float) -> list[float] | None:
    """Give the numbers of a vector, or None if one of them is not finite."""
    return [float(value) for value in values] if np.isfinite(values).all() else None


def statistic(function: Callable[[Float], Any], values: Float) -> float | None:
    """Give a statistic of the values, or None if all of them are NaN."""
    return float(function(values)) if np.isfinite(values).any() else None


def rms(values: Float) -> Any:
    """Root of the mean square of the values that are known."""
    return np.sqrt(np.nanmean(values**2))
