"""The ticks, tick labels and name of one axis of a panel, measured and drawn all at once.

Matplotlib makes five artists of every tick, and finds the place of each anew whenever it is asked how large a figure
is. Of a panel's ticks only the numbers differ: so one tick stands for all.
"""

from __future__ import annotations

from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import TICKDOWN, TICKLEFT
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator, NullLocator
from matplotlib.transforms import Bbox

from elbowscrew.geometry.arrays import Float
from elbowscrew.plots.canvas import kept

_CLOSE: Final = 1e-10  # of the axis' length: a tick at its very end


class Scale(Artist):
    """The x or y axis of a panel.

    Attributes
    ----------
    places : ndarray, shape (K,)
        Where the ticks are that lie within the limits.
    words : list of str
        Their labels.
    """

    def __init__(self, axis: Any) -> None:
        super().__init__()
        self.axis = axis
        self.set_zorder(axis.get_zorder())
        every = np.asarray(axis.get_majorticklocs(), dtype=np.float64)
        words = axis.get_major_formatter().format_ticks(every)
        low, high = sorted(axis.get_view_interval())
        close = _CLOSE * (high - low)
        inside = (every >= low - close) & (every <= high + close)
        self.places: Float = every[inside]
        self.words: list[str] = [word for word, seen in zip(words, inside.tolist(), strict=True) if seen]
        self.lies = axis.axis_name == "x"
        self.shows_words = bool(axis.get_tick_params().get("labelbottom" if self.lies else "labelleft", True))
        self.label, self.marks = _tick_of(axis, lies=self.lies)

    @property
    def is_free(self) -> bool:
        """Whether its ticks may be changed."""
        return not isinstance(self.axis.get_major_locator(), FixedLocator)

    def boxes(self, renderer: Any) -> Float:
        """Lower left and upper right corners of the labels, pixels, shape (K, 4)."""
        seen = [k for k, word in enumerate(self.words) if word and self.shows_words]
        at = np.tile(self.label.get_transform().transform(self._along(self.places[seen])), 2)
        sizes = [about_its_point(self.label, self.words[k], renderer) for k in seen]
        return np.asarray(at + np.array(sizes).reshape(-1, 4))

    def box(self, renderer: Any, boxes: Float) -> Bbox:
        """What the labels and the name take, pixels, the panel's side among it; the name counts by its height alone."""
        panel = self.axis.axes.bbox
        low = np.minimum([panel.x0, panel.y0], boxes[:, :2].min(axis=0, initial=np.inf))
        high = np.maximum([panel.x1, panel.y1], boxes[:, 2:].max(axis=0, initial=-np.inf))
        name = self.axis.label
        if name.get_visible() and name.get_text():
            across = int(self.lies)
            size = about_its_point(name, name.get_text(), renderer)
            low[across] = self._name_at(boxes) - (size[2 + across] - size[across])
        return Bbox([low, high])

    def _name_at(self, boxes: Float) -> float:
        """Where the name begins, going away from the panel, pixels."""
        across = int(self.lies)
        nearest = min(float(self.axis.axes.bbox.min[across]), float(boxes[:, across].min(initial=np.inf)))
        return nearest - float(self.axis.labelpad * self.axis.get_figure().dpi) / 72.0

    def _along(self, places: Float) -> Float:
        corner = np.zeros_like(places)
        return np.column_stack([places, corner] if self.lies else [corner, places])

    def draw(self, renderer: Any) -> None:
        """Draw marks, labels and the name."""
        points, name = self._along(self.places), self.axis.label
        self.marks.set_data(*points.T)
        self.marks.draw(renderer)
        for word, point in zip(self.words if self.shows_words else (), points.tolist(), strict=False):
            self.label.set_text(word)
            self.label.set_position(point)
            self.label.draw(renderer)
        if name.get_text():
            x, y = name.get_position()
            at = self._name_at(self.boxes(renderer))
            name.set_position((x, at) if self.lies else (at, y))
            name.draw(renderer)


def _tick_of(axis: Any, *, lies: bool) -> tuple[Text, Line2D]:
    """Label and mark of a tick of an axis, which are those of any other, made once for all that measure and draw it."""
    if not hasattr(axis, "one_tick"):
        axis.one_tick = _new_tick(axis, lies=lies)
    label, marks = axis.one_tick
    return label, marks


def _new_tick(axis: Any, *, lies: bool) -> tuple[Text, Line2D]:
    ax, kind = axis.axes, "xtick" if lies else "ytick"
    usual: Any = mpl.rcParams
    look = {name: usual[f"{kind}.major.{name}"] for name in ("size", "width", "pad")}
    color = usual[f"{kind}.color"]
    transform, vertical, horizontal = (ax.get_xaxis_text1_transform if lies else ax.get_yaxis_text1_transform)(
        look["size"] + look["pad"]
    )
    label = _Label(
        color=color, fontsize=usual[f"{kind}.labelsize"], va=vertical, ha=horizontal, transform=transform
    )  # fmt: skip
    label.set_figure(ax.figure)
    mark: Any = TICKDOWN if lies else TICKLEFT
    marks = Line2D(
        [], [], linestyle="none", marker=mark, color=color, markersize=look["size"],
        markeredgewidth=look["width"], transform=(ax.get_xaxis_transform if lies else ax.get_yaxis_transform)("tick1"),
    )  # fmt: skip
    marks.set_figure(ax.figure)
    return label, marks


_BOXES: Final[dict[Any, tuple[float, float, float, float]]] = {}
_LAYOUTS: Final[dict[Any, Any]] = {}


class _Label(Text):
    """The label of a tick: the same numbers stand in the figures of all trials."""

    def _get_layout(self, renderer: Any) -> Any:
        lay_out: Any = super()._get_layout  # type: ignore[misc]
        if not isinstance(renderer, RendererAgg):
            return lay_out(renderer)
        return kept(_LAYOUTS, (self.get_text(), *_look(self, renderer)), lambda: lay_out(renderer))


def _look(text: Any, renderer: Any) -> tuple[Any, ...]:
    """What a text's size hangs on beside its word."""
    font = hash(text.get_fontproperties())
    return renderer.dpi, font, text.get_rotation(), text.get_ha(), text.get_va(), text.get_rotation_mode()


def about_its_point(text: Any, word: str, renderer: Any) -> tuple[float, float, float, float]:
    """Corners of a word about the point where a text puts it, pixels; kept of what is drawn in pixels."""
    if not isinstance(renderer, RendererAgg):
        return _measured(text, word, renderer)
    return kept(_BOXES, (word, *_look(text, renderer)), lambda: _measured(text, word, renderer))


def _measured(text: Any, word: str, renderer: Any) -> tuple[float, float, float, float]:
    before = text.get_text(), text.get_position()
    text.set_text(word)
    text.set_position((0.0, 0.0))
    box = text.get_window_extent(renderer)
    x, y = text.get_transform().transform((0.0, 0.0))
    text.set_text(before[0])
    text.set_position(before[1])
    return box.x0 - x, box.y0 - y, box.x1 - x, box.y1 - y


def scales_of(ax: Axes) -> list[Scale]:
    """Give the axes of a panel that are drawn so: those that are plain."""
    if not ax.axison or ax.name == "3d":
        return []
    return [Scale(axis) for axis in (ax.xaxis, ax.yaxis) if _is_plain(axis)]


def _is_plain(axis: Any) -> bool:
    return bool(
        axis.get_visible()
        and axis.get_scale() == "linear"
        and isinstance(axis.get_minor_locator(), NullLocator)
        and axis.get_label_position() in ("bottom", "left")
        and not (axis.get_tick_params().get("right") or axis.get_tick_params().get("top"))
    )


def draw_at_once(figure: Figure) -> None:
    """Let the plain axes of all panels be drawn so: a figure that is laid out, and will not be changed any more."""
    for ax in figure.axes:
        for scale in scales_of(ax):
            scale.axis.set_visible(False)
            ax.add_artist(scale)
