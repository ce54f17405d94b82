"""The numbers of a trial that the page of a study shows, and how each is read from ``summary.json``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

from elbowscrew.model.summary_types import Summary


class Measure(NamedTuple):
    """A number of each trial.

    Attributes
    ----------
    key, title, unit : str
    read : callable
        Takes it out of ``summary.json``; None where not known.
    decimals : int
    skewed : bool
        Whether it is its logarithm that is about normal.
    """

    key: str
    title: str
    unit: str
    read: Callable[[Summary], float | None]
    decimals: int
    skewed: bool = False


def _top(one: Summary) -> float:
    return one["motion"]["theta_max_deg"]


def _dispersion(one: Summary) -> float | None:
    return one["motion"]["axis_dispersion_deg"]


def _second(one: Summary) -> float | None:
    """Range about the second of two axes; None of other joints."""
    two = one["motion"]["joint_numbers"]["two_axes"]
    return None if two is None else two["axis2"]["range_deg"]


def _error(one: Summary) -> float | None:
    return one["interpolation"]["rms_angle_error_deg"]


def _cone(one: Summary) -> float | None:
    joint = one["motion"]["joint_axis"]
    return None if joint is None else joint["axis_cone95_deg"]


MEASURES: Final = (
    Measure("top", "Largest angle", "deg", _top, 1),
    Measure("dispersion", "Dispersion of the axes", "deg", _dispersion, 2, skewed=True),
    Measure("second", "Range about the second axis", "deg", _second, 1),
    Measure("error", "Model error, RMS rotation", "deg", _error, 2, skewed=True),
)
"""Those that are compared over the trials."""
COLUMNS: Final = (
    Measure("frames", "Frames", "", lambda one: one["trial"]["frames"], 0),
    Measure("tracked", "Tracked", "%", lambda one: 100.0 * (1.0 - one["trial"]["missing_share"]), 1),
    *MEASURES,
    Measure("cone", "Axis 95\N{NO-BREAK SPACE}% cone", "deg", _cone, 3),
    Measure("displacement", "RMS displacement", "mm", lambda one: one["interpolation"]["rms_displacement_mm"], 2),
    Measure("repetitions", "Repetitions", "", lambda one: one["motion"]["repetitions"], 0),
)
"""Those that stand in the table of the trials, in order."""
