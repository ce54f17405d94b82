"""How a number spreads over the trials of a study: strips with boxes by condition."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from html import escape
from typing import Final

import numpy as np
from markupsafe import Markup

from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.report.charts import path_of, picture, range_of, tick_text, ticks_between

_LEAST: Final = 5
_WIDTH: Final = 640.0
_ROW: Final = 40.0
_LONGEST: Final = 22
MOST_POINTS: Final = 150
"""Trials of a group that are drawn one by one; of more it is how many there are of each value."""
_BINS: Final = 60


def strip_chart(name: str, title: str, unit: str, groups: Mapping[str, tuple[Float, Sequence[str], Bool]]) -> Markup:
    """Draw every trial as a point, or many as a histogram, a strip for each group, over a box of its quartiles.

    Parameters
    ----------
    name : str
        Tells the chart's ids from others'.
    title, unit : str
    groups : mapping of str to (ndarray of shape (N,), sequence of str, ndarray of bool of shape (N,))
        Values, the names of their trials, and whether they stand out, by group.
    """
    low, high = range_of(*(values for values, _, _ in groups.values()), air=0.04)
    left = 20.0 + 7.6 * max(min(max(map(len, groups)), _LONGEST), 6)
    right, bottom = _WIDTH - 16.0, 8.0 + _ROW * len(groups)

    def along(value: float) -> float:
        return left + (right - left) * (value - low) / (high - low)

    parts = []
    values, decimals = ticks_between(low, high, 6)
    for value in values:
        text = tick_text(value, decimals)
        parts.append(f'<path class="grid" d="M{along(value):.1f} 4V{bottom:g}"/>')
        parts.append(f'<text x="{along(value):.1f}" y="{bottom + 20:g}" text-anchor="middle">{text}</text>')
    parts.append(f'<path class="axis" d="M{left:g} {bottom:g}H{right:g}"/>')
    parts.append(
        f'<text x="{0.5 * (left + right):g}" y="{bottom + 42:g}" text-anchor="middle">{escape(title)} ({unit})</text>'
    )
    for k, (group, (numbers, names, far)) in enumerate(groups.items()):
        middle = 8.0 + _ROW * (k + 0.5)
        shown = group if len(group) <= _LONGEST else group[: _LONGEST - 1] + "…"
        parts.append(f'<text x="{left - 10:g}" y="{middle + 5:g}" text-anchor="end">{escape(shown)}</text>')
        known = numbers[np.isfinite(numbers)]
        many = known.size > MOST_POINTS
        if many:
            parts.append(_histogram(known, middle, along, (low, high)))
        if known.size >= _LEAST:
            parts.append(_box(known, middle, along))
        # Points side by side, by a sequence that spreads evenly and is the same every time.
        spread = (np.arange(numbers.size) * 0.618034 % 1.0 - 0.5) * 0.5 * _ROW
        for value, offset, outlying, trial in zip(numbers.tolist(), spread.tolist(), far.tolist(), names, strict=True):
            if value == value and (outlying or not many):
                look = "far" if outlying else "one"
                told = f"<title>{escape(trial)}</title>" if outlying else ""
                tag = f'<circle class="{look}" cx="{along(value):.1f}" cy="{middle + offset:.1f}" r="3"'
                parts.append(f"{tag}>{told}</circle>" if told else f"{tag}/>")
    text = f"{title} of every trial" + (f" in {len(groups)} groups" if len(groups) > 1 else "") + ", outliers marked."
    return picture(name, title, text, _WIDTH, bottom + 50.0, parts)


def _histogram(known: Float, middle: float, along: Callable[[float], float], span: tuple[float, float]) -> str:
    """Outline of how many values there are, alike above and below the middle of the strip."""
    counts, edges = np.histogram(known, _BINS, span)
    up = np.repeat(0.44 * _ROW * counts / counts.max(), 2)
    x = np.repeat([along(float(edge)) for edge in edges], 2)[1:-1]
    y = np.concatenate([middle - up, middle + up[::-1]])
    return f'<path class="many" d="{path_of(np.concatenate([x, x[::-1]]), y)}Z"/>'


def _box(known: Float, middle: float, along: Callable[[float], float]) -> str:
    first, median, third = np.percentile(known, [25, 50, 75])
    reach = 1.5 * (third - first)
    low, high = known[known >= first - reach].min(), known[known <= third + reach].max()
    a, b, c, d, e = (along(float(value)) for value in (low, first, median, third, high))
    top, tall = middle - 0.32 * _ROW, 0.64 * _ROW
    return (
        f'<path class="whisker" d="M{a:.1f} {middle:g}H{b:.1f}M{d:.1f} {middle:g}H{e:.1f}"/>'
        f'<rect class="box" x="{b:.1f}" y="{top:.1f}" width="{max(d - b, 1.0):.1f}" height="{tall:.1f}"/>'
        f'<path class="median" d="M{c:.1f} {top:.1f}v{tall:.1f}"/>'
    )
