"""A sheet that is drawn on faster than matplotlib's: figures of a study show the same words over and over."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from math import ceil, cos, floor, radians, sin
from typing import Any, Final, NamedTuple, TypeVar, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import axis3d
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

_MOST: Final = 1024
_AIR: Final = 4  # pixels about a word


_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


def kept(known: dict[_Key, _Value], key: _Key, make: Callable[[], _Value]) -> _Value:
    """Give what is known under a key, made if it is not; of very many all are forgotten."""
    found = known.get(key)
    if found is None:
        if len(known) >= _MOST:
            known.clear()
        found = known[key] = make()
    return found


class _Stamp(NamedTuple):
    """A word in pixels, the lowest row first (height, width, 4), and how far its corner is off its origin."""

    pixels: NDArray[np.uint8]
    right: int
    up: int


_SIZES: Final[dict[Any, tuple[float, float, float]]] = {}
_STAMPS: Final[dict[Any, _Stamp]] = {}


class Renderer(RendererAgg):
    """Matplotlib's, but each word is measured and drawn once, and put on whole pixels wherever it comes again."""

    def get_text_width_height_descent(self, s: str, prop: Any, ismath: Any) -> tuple[float, float, float]:
        """Give the size of a word, pixels."""
        measure = cast(Any, super()).get_text_width_height_descent
        return kept(_SIZES, (s, hash(prop), ismath, self.dpi), lambda: measure(s, prop, ismath))

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float, ismath: Any = False, mtext: Any = None
    ) -> None:
        """Draw a word."""
        key = s, hash(prop), angle, ismath, self.dpi, gc.get_rgb(), gc.get_antialiased()
        stamp = kept(_STAMPS, key, lambda: self._stamp(gc, s, prop, angle, ismath, mtext))
        self.draw_image(gc, round(x) + stamp.right, round(self.height - y) + stamp.up, stamp.pixels)

    def _stamp(self, gc: Any, s: str, prop: Any, angle: float, ismath: Any, mtext: Any) -> _Stamp:
        width, height, descent = self.get_text_width_height_descent(s, prop, ismath)
        turn = radians(angle)
        corners = [(u, v) for u in (0.0, width) for v in (-descent, height - descent)]
        across = [u * cos(turn) - v * sin(turn) for u, v in corners]
        up = [u * sin(turn) + v * cos(turn) for u, v in corners]
        left, low = floor(min(across)) - _AIR, floor(min(up)) - _AIR
        shape = ceil(max(across)) + _AIR - left, ceil(max(up)) + _AIR - low
        alone = cast(Any, RendererAgg)(*shape, self.dpi)
        fresh = alone.new_gc()
        fresh.set_foreground(gc.get_rgb(), isRGBA=True)
        fresh.set_antialiased(gc.get_antialiased())
        alone.draw_text(fresh, -left, shape[1] + low, s, prop, angle, ismath, mtext)
        pixels = np.asarray(alone.buffer_rgba(), dtype=np.uint8)
        return _Stamp(np.ascontiguousarray(pixels[::-1]), left, low)


class Canvas(FigureCanvasAgg):
    """Matplotlib's with such a renderer."""

    def get_renderer(self) -> Any:
        """Give the renderer of the figure's size."""
        width, height = self.get_width_height(physical=True)
        key = width, height, self.figure.dpi
        if getattr(self, "_size", None) != key:
            self.renderer = cast(Any, Renderer)(width, height, self.figure.dpi)
            self._size = key
        return cast(Any, self.renderer)


class _WithoutTicks:
    """An axis that makes ticks when it is drawn: to cut off and to hide their grid lines matplotlib would make some."""

    def reset_ticks(self) -> None:
        """Begin with none."""
        self.majorTicks: list[Any] = []
        self.minorTicks: list[Any] = []


class _Flat(_WithoutTicks):
    """Such an axis of a panel."""

    def get_ticks_position(self) -> Any:
        """Tell on which side they are."""
        axis: Any = super()
        for ticks, make in ((self.majorTicks, axis.get_major_ticks), (self.minorTicks, axis.get_minor_ticks)):
            if not ticks:
                make(1)
        return axis.get_ticks_position()


class _XAxis(_Flat, XAxis):
    pass


class _YAxis(_Flat, YAxis):
    pass


class Panel(Axes):
    """Matplotlib's, but without ticks before any are asked for."""

    def _init_axis(self) -> None:
        self.xaxis, self.yaxis = _XAxis(self, clear=False), _YAxis(self, clear=False)
        for side, axis in (("bottom", self.xaxis), ("top", self.xaxis), ("left", self.yaxis), ("right", self.yaxis)):
            self.spines[side].register_axis(axis)


class _InSpace(_WithoutTicks):
    """Such an axis of a view in space, whose ticks are copies of its first one, made in a tenth of the time.

    Only the mark and the label are drawn, and are a tick's own.
    """

    def _get_tick(self, major: bool) -> Any:
        ticks = self.majorTicks if major else self.minorTicks
        if not ticks:
            return cast(Any, super())._get_tick(major=major)
        tick = copy(ticks[0])
        tick.tick1line, tick.label1 = copy(tick.tick1line), copy(tick.label1)
        return tick

    def _copy_tick_props(self, src: Any, dest: Any) -> None:
        """Nothing is left to copy."""


class _SpaceX(_InSpace, axis3d.XAxis):  # type: ignore[misc]
    pass


class _SpaceY(_InSpace, axis3d.YAxis):  # type: ignore[misc]
    pass


class _SpaceZ(_InSpace, axis3d.ZAxis):  # type: ignore[misc]
    pass


class Space(Axes3D):  # type: ignore[misc]
    """Matplotlib's view in space with such axes."""

    def _init_axis(self) -> None:
        self.xaxis, self.yaxis, self.zaxis = _SpaceX(self), _SpaceY(self), _SpaceZ(self)


class Sheet(Figure):
    """Matplotlib's with such a canvas and such panels."""

    def __init__(self, size: tuple[float, float], dots_per_inch: float) -> None:
        super().__init__(figsize=size, dpi=dots_per_inch)
        Canvas(self)

    def add_subplot(self, *args: Any, **kwargs: Any) -> Any:
        """Add a panel, or a view in space."""
        if kwargs.get("projection") == "3d":
            del kwargs["projection"]
            kwargs["axes_class"] = Space
        elif "projection" not in kwargs:
            kwargs.setdefault("axes_class", Panel)
        return super().add_subplot(*args, **kwargs)
