"""What models are compared, and what their keyframes are taken from: the recording as it is, filtered, or thinned."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.choices import (
    BLEND_NAMES,
    CLOSED_LAWS,
    KEYFRAME_SOURCES,
    KNOT_NAMES,
    METHOD_NAMES,
    BlendName,
    KeyframeSource,
    KnotName,
    LawName,
    MethodName,
    functions_named,
)
from elbowscrew.errors import SettingError, UsageError, asked_back
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model import ModelPhases
from elbowscrew.motion.axes.measured import smoothed_displacement, twist_cutoff
from elbowscrew.motion.screws.measurement import Measurement
from elbowscrew.quantities import in_digits
from elbowscrew.settings import Settings

_LAWS: Final[tuple[LawName, ...]] = (*CLOSED_LAWS, "best", "empirical")  # in the order that tables have had
_MOST_PER_PHASE: Final = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonPlan:
    """Which models are compared: every combination of these.

    Attributes
    ----------
    methods : tuple of {"dlb", "sclerp", "sdlb", "dib", "catmull-rom", "joint"}
    laws : tuple of {"cycloidal", ...}
        Laws of motion, "best" and "empirical" among them.
    blends : tuple of {"piecewise", "global"}
    knots : tuple of {"law", "chord", "uniform", "angle"}
    counts : tuple of int
        Keyframes of each phase, its ends among them.
    data : tuple of {"raw", "lowpass", "decimated"}
        What keyframes and laws are taken from.
    decimation : tuple of int
        Use every N-th frame only.
    """

    methods: tuple[MethodName, ...] = METHOD_NAMES
    laws: tuple[LawName, ...] = _LAWS
    blends: tuple[BlendName, ...] = BLEND_NAMES
    knots: tuple[KnotName, ...] = ("law",)
    counts: tuple[int, ...] = (2, 3, 4, 5)
    data: tuple[KeyframeSource, ...] = KEYFRAME_SOURCES
    decimation: tuple[int, ...] = (2, 4)

    def __post_init__(self) -> None:
        """Check what the types cannot.

        Raises
        ------
        UsageError
            Naming the field, which is the option of ``compare``.
        """
        choices: dict[str, tuple[str, ...]] = {
            "methods": METHOD_NAMES,
            "laws": _LAWS,
            "blends": BLEND_NAMES,
            "knots": KNOT_NAMES,
            "data": KEYFRAME_SOURCES,
        }
        for name, allowed in choices.items():
            given = getattr(self, name)
            strange = [one for one in given if one not in allowed]
            if strange or not given:
                found = f"{', '.join(strange) or 'none'}{asked_back(','.join(strange), allowed)}"
                msg = f"{name}: expected some of {', '.join(allowed)}, found {found}"
                raise UsageError(msg)
        for name, low, high in (("counts", 2, _MOST_PER_PHASE), ("decimation", 2, 1000)):
            numbers = getattr(self, name)
            if not numbers or not all(low <= number <= high for number in numbers):
                found = ", ".join(map(str, numbers)) or "none"
                msg = f"{name}: expected whole numbers from {low} to {high}, found {found}"
                raise UsageError(msg)


class SourcePoses(NamedTuple):
    """What keyframes and laws are taken from: poses (N, 8), which of them count, and the phases at these."""

    name: str
    pose: Float
    usable: Bool
    phases: ModelPhases


def keyframe_sources_of(
    measured: Measurement, phases: ModelPhases, plan: ComparisonPlan, settings: Settings
) -> Iterator[SourcePoses]:
    """Give what the plan wants keyframes to be taken from.

    Raises
    ------
    SettingError
        If too few frames are left of a phase.
    """
    usable = measured.joint.measured.copy()
    usable[phases.bound_rows] = True
    recorded = SourcePoses("raw", measured.displacement, usable, phases)
    for data in plan.data:
        yield from SOURCES[data](recorded, measured, plan, settings)


def _raw(
    recorded: SourcePoses, _measured: Measurement, _plan: ComparisonPlan, _settings: Settings
) -> list[SourcePoses]:
    """Take the poses as they were recorded."""
    return [recorded]


def _lowpass(
    recorded: SourcePoses, measured: Measurement, _plan: ComparisonPlan, settings: Settings
) -> list[SourcePoses]:
    """Filter the bodies; the displacements keep the signs of the unfiltered ones."""
    given = settings.lowpass_hz
    cutoff_hz = given if isinstance(given, float) else twist_cutoff(measured, settings)
    pose = smoothed_displacement(measured, cutoff_hz)
    flipped = np.sum(pose[:, :4] * measured.displacement[:, :4], axis=1) < 0.0
    pose = np.where(flipped[:, None], -pose, pose)
    pose = np.where(np.isfinite(pose), pose, measured.displacement)
    name = f"lowpass {in_digits(cutoff_hz, 3)} Hz"
    return [SourcePoses(name, pose, recorded.usable, recorded.phases)]


def _decimated(
    recorded: SourcePoses, _measured: Measurement, plan: ComparisonPlan, _settings: Settings
) -> list[SourcePoses]:
    """Leave out frames at each rate of the plan."""
    return [_every(factor, recorded) for factor in plan.decimation]


SOURCES: Final[dict[str, Callable[..., list[SourcePoses]]]] = functions_named(KEYFRAME_SOURCES, globals())
"""What keyframes may be taken from: a new one is one function, and its name in `choices.KeyframeSource`."""


def _every(factor: int, recorded: SourcePoses) -> SourcePoses:
    usable, phases = recorded.usable, recorded.phases
    start = int(phases.bound_rows[0])
    kept = usable & ((np.arange(usable.size) - start) % factor == 0)
    rows = np.flatnonzero(kept)
    nearest = rows[np.abs(rows - np.r_[phases.bound_rows, phases.law_rows.ravel()][:, None]).argmin(axis=1)]
    bounds = nearest[: phases.bound_rows.size]
    laws = nearest[phases.bound_rows.size :].reshape(-1, 2)
    name = "every 2nd" if factor == 2 else "every 3rd" if factor == 3 else f"every {factor}th"
    if (np.diff(bounds) <= 0).any() or (np.diff(laws, axis=1) <= 0).any():
        msg = f"--decimation {factor}: a phase has less than two of the frames that are left; give a smaller one"
        raise SettingError(msg)
    return SourcePoses(name, recorded.pose, kept, ModelPhases(bound_rows=bounds, law_rows=laws))
