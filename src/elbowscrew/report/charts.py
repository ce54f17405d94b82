"""Charts as inline SVG: sharp at any size, small, drawn without a plotting library and alike on every machine."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from html import escape
from math import isfinite
from typing import Final

import numpy as np
import orjson
from markupsafe import Markup

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.movements.phases import runs_of
from elbowscrew.quantities import rounded
from elbowscrew.view.bands import is_seen
from elbowscrew.view.decimation import drawn_rows

WIDTH: Final = 900.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 16.0, 10.0, 46.0
_UP_TICKS: Final = 5

# Viridis up to 0.88, as in the figures: its light end vanishes on white paper.
COLORS: Final = (
    "#440154", "#481d6f", "#453781", "#3c4f8a", "#32648e", "#2a788e",
    "#228b8d", "#1f9f88", "#2cb17e", "#4ec36b", "#7ad151", "#b0dd2f",
)  # fmt: skip


def color_of(fraction: float) -> str:
    """Color of a share from 0 to 1 on the scale of the figures."""
    place = min(max(fraction, 0.0), 1.0) * (len(COLORS) - 1)
    k = min(int(place), len(COLORS) - 2)
    parts = []
    for channel in (1, 3, 5):
        low, high = (int(COLORS[k + step][channel : channel + 2], 16) for step in (0, 1))
        parts.append(f"{round(low + (place - k) * (high - low)):02x}")
    return "#" + "".join(parts)


def ticks_between(low: float, high: float, most: int) -> tuple[list[float], int]:
    """Round numbers between two values, about `most` at most but three at least, and how many decimals they need."""
    if not high > low:
        return [low], 1
    size = 10.0 ** np.floor(np.log10((high - low) / most))
    steps = [float(factor * size) for factor in (10.0, 5.0, 2.0, 1.0)]
    few = min(step for step in steps if (high - low) / step <= most + 1e-9)
    step = min(few, max((step for step in steps if 3.0 * step <= high - low), default=few))
    first, last = int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9))
    decimals = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    return [k * step for k in range(first, last + 1)], decimals


def path_of(x: Float, y: Float) -> str:
    """SVG path through points in pixels, broken where one is not known."""
    parts, open_before = [], False
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        if a != a or b != b:
            open_before = False
            continue
        parts.append(f"{'L' if open_before else 'M'}{a:.1f} {b:.1f}")
        open_before = True
    return "".join(parts)


class Chart:
    """One panel of an SVG, with axes in data units; things are drawn in the order they are added.

    Parameters
    ----------
    name : str
        Tells this chart's ids from those of others on the page.
    title, description : str
        For those who do not see the chart.
    x_range, y_range : tuple of float
        In data units; the second is widened to leave air.
    x_label, y_label : str
    size : tuple of float
        Pixels of the panel with its margins.
    """

    def __init__(
        self,
        name: str,
        title: str,
        description: str,
        *,
        x_range: tuple[float, float],
        y_range: tuple[float, float],
        x_label: str,
        y_label: str,
        size: tuple[float, float] = (WIDTH, 340.0),
    ) -> None:
        self._name, self._title, self._description = name, title, description
        self._labels = x_label, y_label
        self._size = size
        self._x, self._y = x_range, y_range
        self._inner = (_LEFT, _TOP, size[0] - _RIGHT, size[1] - _BOTTOM)
        self._drawn: list[str] = []
        self._legend: list[tuple[str, str]] = []
        self._series: list[tuple[str, list[float | None], list[float | None]]] = []

    def x(self, values: Float) -> Float:
        """Pixels of data values along."""
        left, _, right, _ = self._inner
        return left + (values - self._x[0]) * (right - left) / (self._x[1] - self._x[0])

    def y(self, values: Float) -> Float:
        """Pixels of data values up."""
        _, top, _, bottom = self._inner
        return bottom - (values - self._y[0]) * (bottom - top) / (self._y[1] - self._y[0])

    def line(self, x: Float, y: Float, look: str, label: str = "", *, name: str = "") -> None:
        """Draw a curve, thinned to what the pixels can show; `name` is its own among those of one label."""
        rows = drawn_rows(y, keep_gaps=True, parts=int(self._inner[2] - self._inner[0]))
        self._drawn.append(f'<path class="{look}" d="{path_of(self.x(x[rows]), self.y(y[rows]))}"/>')
        self._keep(name or label or look, x[rows], y[rows])
        self._note(look, label)

    def loop(self, x: Float, y: Float, look: str) -> None:
        """Draw a curve that may come back along, so that no value of it belongs to a place along."""
        rows = drawn_rows(x, y, keep_gaps=True, parts=int(self._inner[2] - self._inner[0]))
        self._drawn.append(f'<path class="{look}" d="{path_of(self.x(x[rows]), self.y(y[rows]))}"/>')

    def band(self, x: Float, low: Float, high: Float, look: str, label: str = "") -> None:
        """Fill between two curves wherever both are known."""
        rows = drawn_rows(low, high, keep_gaps=True, parts=int(self._inner[2]))
        known = np.isfinite(low[rows]) & np.isfinite(high[rows])
        for first, last in zip(*runs_of(known), strict=True):
            part = rows[first : last + 1]
            along = self.x(np.concatenate([x[part], x[part][::-1]]))
            up = self.y(np.concatenate([low[part], high[part][::-1]]))
            self._drawn.append(f'<path class="{look}" d="{path_of(along, up)}Z"/>')
        if label:
            self._keep(f"{label}, lower", x[rows], low[rows])
            self._keep(f"{label}, upper", x[rows], high[rows])
        self._note(look, label)

    def reach(
        self, x: Float, y: Float, reach: Float, look: str, name: str, unit: str, span: float | None = None
    ) -> None:
        """Fill what lies within `reach` (N,) of a curve, and tell its median; where it would not be seen, tell that.

        `span` is what the chart's curves span where there are several; by default what this one does.
        """
        known = np.isfinite(reach) & np.isfinite(y)
        if not known.any():
            return
        half = f"±{rounded(float(np.median(reach[known])))} {unit}"
        if is_seen(y, reach, span):
            self.band(x, y - reach, y + reach, look, f"{name} ({half})")
        else:
            self.remark(f"{name}: {half}, too narrow to be drawn")

    def remark(self, text: str) -> None:
        """Say among the keys what is not drawn."""
        self._legend.append(("", text))

    def points(self, x: Float, y: Float, look: str, label: str = "", radius: float = 4.0) -> None:
        """Draw circles where the values are known."""
        for a, b in zip(self.x(x).tolist(), self.y(y).tolist(), strict=True):
            if a == a and b == b:
                self._drawn.append(f'<circle class="{look}" cx="{a:.1f}" cy="{b:.1f}" r="{radius:g}"/>')
        if label:
            self._keep(label, x, y)
        self._note(look, label)

    def spans(self, pieces: Iterable[tuple[float, float]], look: str, label: str = "") -> None:
        """Shade stretches along, from bottom to top."""
        _, top, _, bottom = self._inner
        found = False
        for first, last in pieces:
            low, high = (float(self.x(np.array(value))) for value in (first, last))
            self._drawn.append(
                f'<rect class="{look}" x="{low:.1f}" y="{top:.1f}" width="{max(high - low, 0.5):.1f}" '
                f'height="{bottom - top:.1f}"/>'
            )
            found = True
        if found:
            self._note(look, label)

    def segment(
        self, x: Sequence[float], y: Sequence[float], look: str, color: str = "", label: str = "", told: str = ""
    ) -> None:
        """Draw one straight piece, in a color of its own and with words for those who point at it, if given."""
        shape = path_of(self.x(np.array(x)), self.y(np.array(y)))
        stroke = f' stroke="{color}"' if color else ""
        end = f"><title>{escape(told)}</title></path>" if told else "/>"
        self._drawn.append(f'<path class="{look}"{stroke} d="{shape}"{end}')
        self._note(look, label)

    def svg(self) -> Markup:
        """Give the chart alone, with its keys, as an image with a text for those who do not see it."""
        return self.keys() + picture(self._name, self._title, self._description, *self._size, [self.panel()])

    def panel(self, offset: float = 0.0, lower: float = 0.0) -> str:
        """Give the parts to be put into a picture, shifted to the right and down."""
        left, top, right, bottom = self._inner
        clip = f"{self._name}-clip"
        return "".join(
            [
                f'<g transform="translate({offset:g} {lower:g})">',
                self._values(),
                f'<clipPath id="{clip}"><rect x="{left:g}" y="{top - 6:g}" width="{right - left:g}" '
                f'height="{bottom - top + 6:g}"/></clipPath>',
                *self._grid(),
                f'<g clip-path="url(#{clip})">',
                *self._drawn,
                "</g>",
                *self._axes(),
                "</g>",
            ]
        )

    def keys(self, *others: Chart) -> Markup:
        """Say what is what, also on other charts beside it, in a line that wraps where there is little room."""
        return keys_of(dict.fromkeys(key for chart in (self, *others) for key in chart._legend))

    def _grid(self) -> list[str]:
        left, _, right, _ = self._inner
        return [
            f'<path class="grid" d="M{left:g} {float(self.y(np.array(value))):.1f}H{right:g}"/>'
            for value in ticks_between(*self._y, _UP_TICKS)[0]
        ]

    def _axes(self) -> list[str]:
        left, top, right, bottom = self._inner
        parts = []
        values, decimals = ticks_between(*self._x, max(4, int((right - left) / 90)))
        for value in values:
            place = float(self.x(np.array(value)))
            parts.append(f'<path class="tick" d="M{place:.1f} {bottom:g}v5"/>')
            parts.append(
                f'<text x="{place:.1f}" y="{bottom + 20:g}" text-anchor="middle">{tick_text(value, decimals)}</text>'
            )
        values, decimals = ticks_between(*self._y, _UP_TICKS)
        for value in values:
            place = float(self.y(np.array(value))) + 4.5
            parts.append(
                f'<text x="{left - 8:g}" y="{place:.1f}" text-anchor="end">{tick_text(value, decimals)}</text>'
            )
        parts.append(f'<path class="axis" d="M{left:g} {bottom:g}H{right:g}"/>')
        middle, height = 0.5 * (left + right), 0.5 * (top + bottom)
        parts.append(f'<text x="{middle:g}" y="{bottom + 40:g}" text-anchor="middle">{escape(self._labels[0])}</text>')
        parts.append(
            f'<text x="15" y="{height:g}" text-anchor="middle" transform="rotate(-90 15 {height:g})">'
            f"{escape(self._labels[1])}</text>"
        )
        return parts

    def _keep(self, name: str, x: Float, y: Float) -> None:
        """Keep the values of what is drawn, for those who point at it or take it along."""
        self._series.append((name, _numbers(x), _numbers(y)))

    def _values(self) -> str:
        """Values of curves and points, as JSON that is not shown: a page's script tells them."""
        if not self._series:
            return ""
        box, along, up = self._inner, (self._labels[0], *self._x), (self._labels[1], *self._y)
        told = {"box": box, "along": along, "up": up, "series": self._series}
        return f"<metadata>{escape(orjson.dumps(told).decode(), quote=False)}</metadata>"

    def _note(self, look: str, label: str) -> None:
        if label and all(known != label for _, known in self._legend):
            self._legend.append((look, label))


def _numbers(values: Float) -> list[float | None]:
    """Values to seven digits, more than a chart shows; None where one is not known."""
    return _rounded(np.ascontiguousarray(values, dtype=np.float64).tobytes())


@functools.lru_cache(maxsize=8)
def _rounded(values: bytes) -> list[float | None]:
    """Do it once for all curves over the same times."""
    return [float(f"{value:.7g}") if isfinite(value) else None for value in np.frombuffer(values).tolist()]


def keys_of(legend: Iterable[tuple[str, str]]) -> Markup:
    """Keys of a chart, from pairs of look and label; behind them, without a look, what is said of things not drawn."""
    parts = []
    for look, label in sorted(legend, key=lambda key: not key[0]):
        if not look:
            parts.append(f"<span>{escape(label)}</span> ")
            continue
        if look.startswith(("keyframe", "center")):
            shape = f'<circle class="{look}" cx="14" cy="7" r="4"/>'
        elif look.startswith(("fill", "band")):
            shape = f'<rect class="{look}" x="2" y="1" width="24" height="12"/>'
        else:
            shape = f'<path class="{look}" d="M0 7h28"/>'
        swatch = f'<svg width="28" height="14" aria-hidden="true" focusable="false">{shape}</svg>'
        parts.append(f"<span>{swatch} {escape(label)}</span> ")
    return Markup(f'<p class="keys">{"".join(parts)}</p>')  # noqa: S704 - escaped above


def picture(name: str, title: str, description: str, width: float, height: float, panels: Iterable[str]) -> Markup:
    """Put panels into one SVG with a title and a description."""
    return Markup(  # noqa: S704 - numbers and escaped text only
        f'<svg class="chart" viewBox="0 0 {width:g} {height:g}" role="img" '
        f'aria-labelledby="{name}-title {name}-text"><title id="{name}-title">{escape(title)}</title>'
        f'<desc id="{name}-text">{escape(description)}</desc>{"".join(panels)}</svg>'
    )


def range_of(*series: Float, zero: bool = False, air: float = 0.06) -> tuple[float, float]:
    """Range of everything known, with air; with `zero` in it if asked for."""
    known = np.concatenate([values[np.isfinite(values)] for values in series])
    if not known.size:
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    width = (high - low) or max(abs(high), 1e-9)
    return low if zero and low == 0.0 else low - air * width, high + air * width


def tick_text(value: float, decimals: int) -> str:
    """Write the number of a tick, with a true minus sign."""
    return f"{value + 0.0:.{decimals}f}".replace("-", "−")
