"""What is wrong with a figure's look: ink at the edge, text over text, legends over what they explain, transparency."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

Corners = NDArray[np.float64]

# The box of a text is as high as the tallest letters and as deep as the lowest, whether it has any.
_LOOSE_POINTS = 0.8


def faults_of(figure: Figure) -> list[str]:
    """Draw a figure that is laid out, and tell all that is wrong, in words."""
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    found = [f"ink at the {side} edge" for side in _inked_sides(pixels)]
    texts = [(text, _corners(text, figure.dpi)) for text in _texts(figure)]
    least, most = np.array(figure.bbox.min) - 1.0, np.array(figure.bbox.max) + 1.0
    for text, corners in texts:
        low, high = corners.min(axis=0), corners.max(axis=0)
        if (low < least).any() or (high > most).any():
            found.append(f"{_named(text)} is cut off")
    for (one, first), (other, second) in combinations(texts, 2):
        if _overlap(first, second):
            found.append(f"{_named(one)} over {_named(other)}")
    for legend in _legends(figure):
        found += _under(legend, figure)
    for ax in figure.axes:
        for text in [] if isinstance(ax, Axes3D) or not ax.get_visible() else ax.texts:
            if text.get_visible() and text.get_text().strip() and not _within(text.get_window_extent(), ax.bbox):
                found.append(f"{_named(text)} runs out of its panel")
    return found + [f"{artist} is transparent" for artist in figure.findobj() if _is_transparent(artist)]


def _is_transparent(artist: Any) -> bool:
    """Whether it lets through what is behind it, as EPS cannot; what is not drawn at all is not meant."""
    if artist.get_alpha() not in (None, 0, 1):
        return True
    colors = [getattr(artist, name)() for name in ("get_facecolor", "get_edgecolor") if hasattr(artist, name)]
    opacity = np.concatenate([np.atleast_2d(to_rgba_array(color))[:, 3] for color in colors] or [np.ones(1)])
    return bool(((opacity > 0.0) & (opacity < 1.0)).any())


def _inked_sides(pixels: NDArray[np.uint8]) -> Iterator[str]:
    ink = np.asarray((pixels < 250).any(axis=2))
    sides = {"upper": ink[:1], "lower": ink[-1:], "left": ink[:, :1], "right": ink[:, -1:]}
    yield from (name for name, part in sides.items() if part.any())


def _texts(figure: Figure) -> list[Text]:
    """All texts that are drawn: of ticks only those within the limits; matplotlib keeps the others, too."""
    found = [*figure.texts]
    suptitle = getattr(figure, "_suptitle", None)
    found += [] if suptitle is None else [suptitle]
    for legend in _legends(figure):
        found += [*legend.get_texts(), legend.get_title()]
    for ax in figure.axes:
        if ax.get_visible():
            titles = [getattr(ax, name) for name in ("title", "_left_title", "_right_title")]
            has_axes = getattr(ax, "_axis3don", ax.axison)  # a view in space has its own word for it
            found += [*ax.texts, *titles, *(_axis_texts(ax) if has_axes else ())]
    return list(dict.fromkeys(text for text in found if text.get_visible() and text.get_text().strip()))


def _axis_texts(ax: Any) -> list[Text]:
    found: list[Text] = []
    for axis in (ax.xaxis, ax.yaxis, *((ax.zaxis,) if isinstance(ax, Axes3D) else ())):
        if axis.get_visible():
            labels = [label for tick in _ticks(axis) for label in (tick.label1, tick.label2)]
            found += [axis.label, axis.get_offset_text(), *labels]
    return [text for text in found if text.get_visible()]


def _ticks(axis: Any) -> list[Any]:
    """Ticks within the limits; those in space where they were drawn, as matplotlib's own list would move them."""
    if axis.axis_name == "z" or isinstance(axis.axes, Axes3D):
        low, high = sorted(axis.get_view_interval())
        close = 1e-9 * (high - low)
        made = axis.majorTicks[: len(axis.get_majorticklocs())]
        return [tick for tick in made if low - close <= tick.get_loc() <= high + close]
    return list(axis._update_ticks())


def _corners(text: Text, dpi: float) -> Corners:
    """Four corners of a text, turned as it is, a little inside of its box."""
    box = text.get_window_extent()
    center = 0.5 * (np.array(box.min) + np.array(box.max))
    rotation = text.get_rotation()
    text.set_rotation(0.0)
    width, height = text.get_window_extent().size
    text.set_rotation(rotation)
    turn = np.radians(rotation)
    loose = _LOOSE_POINTS * dpi / 72.0
    half = 0.5 * np.array([width, height - 2.0 * loose])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.maximum(half, 0.5)
    way = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    return np.asarray(center + corners @ way)


def _overlap(one: Corners, other: Corners) -> bool:
    """Whether two rectangles share an area: no side of either parts them."""
    for corners in (one, other):
        for side in (corners[1] - corners[0], corners[3] - corners[0]):
            first, second = one @ side, other @ side
            if first.max() <= second.min() or second.max() <= first.min():
                return False
    return True


def _named(text: Text) -> str:
    return repr(text.get_text().replace("\n", " "))


def _legends(figure: Figure) -> list[Legend]:
    return [one for one in figure.findobj(Legend) if isinstance(one, Legend) and one.get_visible()]


def _under(legend: Legend, figure: Figure) -> Iterator[str]:
    """Tell what a legend lies over: a whole axes, where it is the figure's, or data and spines of its own."""
    box = legend.get_window_extent()
    for ax in figure.axes:
        if not ax.get_visible():
            continue
        if legend.axes is not ax and not isinstance(ax, Axes3D):
            around = ax.get_tightbbox()
            if around is not None and _shared(box, around):
                yield f"legend over an axes with {ax.get_ylabel()!r}"
        elif isinstance(ax, Axes3D) and legend.axes is not ax and _shared(box, _ink_box(ax)):
            yield "legend over a space"
        else:
            if not isinstance(ax, Axes3D) and not _within(box, ax.bbox):
                yield f"legend over the edge of {ax.get_ylabel()!r}"
            for kind, points in _drawn(ax):
                if _crosses(points, box):
                    yield f"legend over {kind} of {ax.get_ylabel()!r}"


def _within(inner: Any, outer: Any) -> bool:
    return bool(
        inner.x0 >= outer.x0 and inner.x1 <= outer.x1 + 1.0 and inner.y0 >= outer.y0 and inner.y1 <= outer.y1 + 1.0
    )


def _ink_box(ax: Axes) -> Bbox:
    """About all that is drawn in a space, of which matplotlib knows no better than its square."""
    points = [points for _, points in _drawn(ax) if len(points)]
    texts = [_corners(text, 300.0) for text in (*_axis_texts(ax), *ax.texts) if text.get_text().strip()]
    every = np.concatenate([*points, *texts])
    every = every[np.isfinite(every).all(axis=1)]
    return Bbox([every.min(axis=0), every.max(axis=0)])


def _shared(one: Bbox, other: Bbox) -> bool:
    both = Bbox.intersection(one, other)
    return both is not None and both.width > 1.0 and both.height > 1.0


def _drawn(ax: Axes) -> Iterator[tuple[str, Corners]]:
    """Lines and collections of an axes as points (M, 2) on the paper."""
    for line in ax.lines:
        if isinstance(line, Line2D) and line.get_visible():
            x, y = np.broadcast_arrays(*(np.atleast_1d(np.asarray(part, dtype=float)) for part in line.get_data()))
            yield f"line {line.get_label()!r}", np.asarray(line.get_transform().transform(np.column_stack([x, y])))
    for part in ax.collections:
        if isinstance(part, Collection) and part.get_visible():
            transform = part.get_transform()
            offsets = np.ma.filled(part.get_offsets(), np.nan)
            if len(offsets) > 1:
                yield "points", np.asarray(part.get_offset_transform().transform(offsets))
            else:
                for path in part.get_paths():
                    yield "shape", np.asarray(transform.transform(path.vertices))


def _crosses(points: Corners, box: Bbox) -> bool:
    """Whether a line through points runs through a box; looked at in as many places as it has pixels."""
    known = points[np.isfinite(points).all(axis=1)]
    if len(known) == 0:
        return False
    steps = np.linspace(0.0, 1.0, 33)[:, None, None]
    path = (known[:-1] + steps * np.diff(known, axis=0)).reshape(-1, 2) if len(known) > 1 else known
    inside = (path > np.array(box.min) + 1.0).all(axis=1) & (path < np.array(box.max) - 1.0).all(axis=1)
    return bool(inside.any())
