"""Laws of motion: how far the motion is, t in [0, 1], at the time tau in [0, 1] of a phase."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

Law = Callable[[ArrayLike], NDArray[np.float64]]


def cycloidal(tau: ArrayLike) -> NDArray[np.float64]:
    """``t = tau - sin(2 pi tau) / (2 pi)``, shape of tau: rest to rest without a jump in acceleration (P 36).

    Examples
    --------
    >>> cycloidal([0.0, 0.25, 0.5, 1.0]).round(6)
    array([0.      , 0.090845, 0.5     , 1.      ])
    """
    x = np.asarray(tau, dtype=np.float64)
    return x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi)


def linear(tau: ArrayLike) -> NDArray[np.float64]:
    """``t = tau``: constant speed."""
    return np.array(tau, dtype=np.float64)


LAWS: Final[dict[str, Law]] = {"cycloidal": cycloidal, "linear": linear}
"""A new law is one function above and one entry here (and its name in `Settings.law`)."""
