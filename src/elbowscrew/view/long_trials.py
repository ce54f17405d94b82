"""Trials too long to draw every movement of: a stretch that stands for the others, and what all of them span."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float
from elbowscrew.model import MovementPhases
from elbowscrew.view.trial_view import TrialView

MOST_CYCLES: Final = 20
"""More are not drawn one by one."""
_MOST_FRAMES: Final = 20_000
_MOST_NOISY: Final = 2000  # frames that differ from one to the next: more blacken a column's width
_CYCLES_SHOWN: Final = 3
_FRAMES_SHOWN: Final = 2000
_MOST_PARTS: Final = 150
_LEAST_PARTS: Final = 20  # fewer would say little, and cycles that few and long can be followed
_OF_FRAMES: Final = ("anatomy", "instantaneous", "losses")


def is_dense(view: TrialView) -> bool:
    """Tell whether what jumps from frame to frame would be drawn as a solid block."""
    return view.frame.size > _MOST_NOISY or stretch_of(view) is not None


class Stretch(NamedTuple):
    """Rows of a long trial, from `first` to before `end`, and what they are in words."""

    first: int
    end: int
    told: str


class Envelope(NamedTuple):
    """What a long series spans in each part of its time: middle (s), smallest, median and largest value, (K,) each.

    The first and the last part stand at their outer ends once more, so that all of the time is covered.
    """

    time_s: Float
    low: Float
    middle: Float
    high: Float


def stretch_of(view: TrialView) -> Stretch | None:
    """Choose the stretch that is most like the others; None of a trial short enough to be drawn as a whole.

    Of cycles, three in a row whose largest angles and durations lie nearest the medians of all; without them, or where
    these would be a long trial again, 2000 frames whose range of the angle does. Frames that were not tracked count
    against a stretch.
    """
    cycles, frames = view.repetitions, view.frame.size
    if cycles.number.size <= MOST_CYCLES and frames <= _MOST_FRAMES:
        return None
    if cycles.number.size >= _CYCLES_SHOWN:
        first, end = _rows_of_cycles(view)
        unlike = _unlike(cycles.top_angle) + _unlike(cycles.duration_s) + _lost(view, first, end)
        of_each = np.lib.stride_tricks.sliding_window_view(unlike, _CYCLES_SHOWN).sum(axis=1)
        best = int(np.argmin(of_each))
        last = best + _CYCLES_SHOWN - 1
        told = f"cycles {cycles.number[best]} to {cycles.number[last]} of {cycles.number.size}"
        if end[last] - first[best] <= _MOST_FRAMES:
            return Stretch(int(first[best]), int(end[last]), told)
    first = np.arange(0, frames - _FRAMES_SHOWN + 1, _FRAMES_SHOWN // 2)
    end = first + _FRAMES_SHOWN
    spans = [_span(view.angle[start:stop]) for start, stop in zip(first, end, strict=True)]
    best = int(np.argmin(_unlike(np.array(spans)) + _lost(view, first, end)))
    told = f"frames {view.frame[first[best]]} to {view.frame[end[best] - 1]} of {frames}"
    return Stretch(int(first[best]), int(end[best]), told)


def _rows_of_cycles(view: TrialView) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Row at which each cycle begins, and the one after its last."""
    cycles = view.repetitions
    first = np.searchsorted(view.time_s, cycles.start_time_s)
    return first, np.searchsorted(view.time_s, cycles.end_time_s, side="right")


def _span(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if known.size else np.nan


def _unlike(values: Float) -> Float:
    """How far values are from their median, in shares of it; unknown ones the farthest."""
    if not np.isfinite(values).any():
        return np.zeros(values.size)
    middle = float(np.nanmedian(values))
    away = np.abs(values - middle) / (abs(middle) or 1.0)
    return np.where(np.isfinite(away), away, np.nanmax(away) + 1.0)


def _lost(view: TrialView, first: NDArray[Any], end: NDArray[Any]) -> Float:
    """Share of frames without a measured pose between rows."""
    lost = np.concatenate([[0], np.cumsum(~view.valid)])
    found: Float = (lost[end] - lost[first]) / np.maximum(end - first, 1)
    return found


def shown_part(view: TrialView) -> tuple[TrialView, Stretch | None]:
    """Give what is drawn over time of a trial: all of it, or of a long one its stretch."""
    stretch = stretch_of(view)
    return (view, None) if stretch is None else (_cut(view, stretch), stretch)


def _cut(view: TrialView, stretch: Stretch) -> TrialView:
    rows = slice(stretch.first, stretch.end)
    count = view.frame.size
    series: dict[str, Any] = {
        field.name: value[rows]
        for field in fields(view)
        if isinstance(value := getattr(view, field.name), np.ndarray) and value.shape[:1] == (count,)
    }
    angles = view.joint_angles
    if angles is not None:
        angles = replace(angles, **{field.name: getattr(angles, field.name)[rows] for field in fields(angles)})
    knots = view.keyframes.row
    inside = (knots >= stretch.first) & (knots < stretch.end)
    phases = view.phases
    seen = (phases.offset_rows >= stretch.first) & (phases.onset_rows < stretch.end)
    last = stretch.end - stretch.first - 1
    begin, end = _rows_of_cycles(view)
    whole = (begin >= stretch.first) & (end <= stretch.end)
    cycles = view.repetitions
    extra = {
        name: {of: values[rows] if name in _OF_FRAMES else values for of, values in table.items()}
        for name, table in view.extra.items()
    }
    return replace(
        view,
        **series,
        joint_angles=angles,
        keyframes=replace(
            view.keyframes, row=knots[inside] - stretch.first, frame=view.keyframes.frame[inside], knots=()
        ),
        phases=MovementPhases(
            onset_rows=np.clip(phases.onset_rows[seen] - stretch.first, 0, last),
            offset_rows=np.clip(phases.offset_rows[seen] - stretch.first, 0, last),
            moving=phases.moving[rows],
        ),
        repetitions=replace(cycles, **{field.name: getattr(cycles, field.name)[whole] for field in fields(cycles)}),
        extra=extra,
    )


def envelope(view: TrialView, values: Float) -> Envelope:
    """Tell what a series (N,) spans in each part of the time.

    A part is a cycle, or some cycles in a row, with the rest after them; a rest longer than any cycle has parts of its
    own, as long as the longest cycle at least. So equal cycles span the same in all parts. Where this would give few
    parts, they are short equal ones, which follow the curve.
    """
    edges = _edges(view)
    known = [part[np.isfinite(part)] for part in np.split(values, edges[1:-1])]
    found = np.array([np.percentile(part, [0.0, 50.0, 100.0]) if part.size else [np.nan] * 3 for part in known])
    middle = view.time_s[np.minimum((edges[:-1] + edges[1:]) // 2, values.size - 1)]
    low, median, high = np.concatenate([found[:1], found, found[-1:]]).T
    return Envelope(np.concatenate([view.time_s[:1], middle, view.time_s[-1:]]), low, median, high)


def _edges(view: TrialView) -> NDArray[np.intp]:
    """Rows between which the parts of a long trial lie, the first and the last included."""
    count = view.frame.size
    begin, end = _rows_of_cycles(view)
    longest = int(np.max(end - begin, initial=1))
    rests = zip([0, *end.tolist()], [*begin.tolist(), count], strict=True) if begin.size else ()
    resting = [rest + longest * np.arange((back - rest) // longest) for rest, back in rests]
    starts = np.unique(np.concatenate([begin, *resting]))
    starts = starts[:: max(-(-starts.size // _MOST_PARTS), 1)]
    if starts.size < _LEAST_PARTS:
        return np.linspace(0, count, _MOST_PARTS + 1).astype(np.intp)
    return np.concatenate([[0], starts[1:], [count]])
