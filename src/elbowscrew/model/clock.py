"""How finely a clock is written."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def time_resolution(time_s: NDArray[np.float64]) -> float:
    """Seconds in the last decimal of the times: 1, 0.1 or 0.01 where a spreadsheet rounded them, else 0.001."""
    for decimals in range(3):
        if (np.round(time_s, decimals) == time_s).all():
            return float(10.0**-decimals)
    return 1e-3
