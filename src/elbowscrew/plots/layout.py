"""Where the panels of a figure stand: as large as what is written around them lets them be."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import ceil
from typing import Any, Final, NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.ticker import FixedLocator, MaxNLocator
from matplotlib.transforms import Bbox

from elbowscrew.geometry.arrays import Float
from elbowscrew.plots.scale import Scale, scales_of
from elbowscrew.plots.space_labels import place_labels
from elbowscrew.plots.style import TEXT
from elbowscrew.quantities import power_of_ten

_ROUNDS: Final = 12  # at most
_AIR: Final = 3.0  # points about each panel with its words, and about a legend
_MARKER: Final = 3.2  # points by which a keyframe at the edge of a panel stands out
_LEAST_AIR: Final = 2.0  # pixels
_LABELS: Final = 40.0  # points that the labels on both sides of a view in space take, or so
_LITTLE: Final = 0.85
_POWER: Final = re.compile(r"1e(.+)")
_UNIT: Final = re.compile(r"(.*)\(([^()]*)\)", re.DOTALL)


class _Margins(NamedTuple):
    """What a panel's words take around it, whole pixels."""

    left: int = 0
    bottom: int = 0
    right: int = 0
    top: int = 0


def settle(figure: Figure) -> None:
    """Lay a figure out once and for all, its panels on whole pixels.

    Panels of one column of the grid have their sides above each other, and those of one row beside each other, as in
    matplotlib's constrained layout; but what is written around a panel is measured from its words alone. Ticks are
    found anew when a panel has its size, and may be wider than there was room for: then it is laid out again, with no
    less room. Tick labels that would touch are thinned.
    """
    renderer = cast(Any, figure.canvas).get_renderer()
    flat = [ax for ax in figure.axes if ax.name != "3d" and ax.get_subplotspec() is not None]
    spaces = [ax for ax in figure.axes if ax.name == "3d" and ax.get_subplotspec() is not None]
    room = _room(figure, renderer)
    held: dict[Axes, _Margins] = {}
    cells = _cells(figure, room, dict.fromkeys([*flat, *spaces], _Margins()))
    for attempt in range(_ROUNDS):
        found = {}
        for ax in flat:
            ax.apply_aspect()
            scales = scales_of(ax)
            boxes = [scale.boxes(renderer) for scale in scales]
            if _multiplied(ax) | _thinned(scales, boxes):
                scales = scales_of(ax)
                boxes = [scale.boxes(renderer) for scale in scales]
            found[ax] = _margins(ax, scales, boxes, renderer)
        if attempt > 1:
            found = {ax: _Margins(*map(max, one, held[ax])) for ax, one in found.items()}
        if found == held:
            break
        held = found
        cells = _cells(figure, room, held | dict.fromkeys(spaces, _Margins()))
        for ax in flat:
            _place(ax, cells[ax].inner)
    for ax in spaces:
        _place_space(ax, cells[ax], renderer)


def _room(figure: Figure, renderer: Any) -> Bbox:
    """What the legends above and below leave of the paper."""
    low, high = 0.0, figure.bbox.height
    for legend in figure.legends:
        box = legend.get_window_extent(renderer)
        height = box.height + 2.0 * _AIR * figure.dpi / 72.0
        if box.y0 + box.y1 > figure.bbox.height:
            high -= height
        else:
            low += height
    return Bbox([(0.0, low), (figure.bbox.width, high)])


def _margins(ax: Axes, scales: Sequence[Scale], boxes: Sequence[Float], renderer: Any) -> _Margins:
    pixels = ax.figure.dpi / 72.0
    panel = ax.get_position(original=True).transformed(ax.figure.transFigure)
    around = [scale.box(renderer, found) for scale, found in zip(scales, boxes, strict=True)]
    drawn = {scale.axis for scale in scales}
    for axis in (ax.xaxis, ax.yaxis) if ax.axison else ():
        if axis not in drawn and axis.get_visible():
            other = axis.get_tightbbox(renderer, for_layout_only=True)
            around += [] if other is None else [other]
    out = _MARKER * pixels
    sides = Bbox.union([*around, ax.bbox.padded(out)])
    titles = any(ax.get_title(place) for place in ("left", "center", "right"))
    above = _title_height(ax) * pixels if titles else 0.0
    return _Margins(
        max(ceil(panel.x0 - sides.x0), 0),
        max(ceil(panel.y0 - sides.y0), 0),
        max(ceil(sides.x1 - panel.x1), 0),
        max(ceil(max(sides.y1, ax.bbox.y1 + above) - panel.y1), 0),
    )


def _title_height(ax: Axes) -> float:
    """Height of a panel's title above it, points."""
    import matplotlib as mpl

    return float(mpl.rcParams["axes.titlepad"]) + 1.2 * float(ax.title.get_fontsize())


class _Cell(NamedTuple):
    """A panel's place in its grid, pixels: its own, and that with all that is written around those beside it."""

    inner: Bbox
    outer: Bbox


def _cells(figure: Figure, room: Bbox, margins: dict[Axes, _Margins]) -> dict[Axes, _Cell]:
    """Part the room between the panels."""
    members: dict[Any, list[tuple[SubplotSpec, _Margins]]] = defaultdict(list)
    for ax, around in margins.items():
        spec = cast(SubplotSpec, ax.get_subplotspec())
        members[spec.get_gridspec()].append((spec, around))
    air = _AIR * figure.dpi / 72.0
    parted: dict[Any, tuple[Float, Float]] = {}

    def cell(spec: SubplotSpec) -> _Cell:
        grid: Any = spec.get_gridspec()
        if grid not in parted:
            parent = getattr(grid, "_subplot_spec", None)
            box = room if parent is None else cell(parent).outer
            rows, columns = grid.get_geometry()
            own = members[grid]
            left, right, top, bottom = np.zeros(columns), np.zeros(columns), np.zeros(rows), np.zeros(rows)
            for one, around in own:
                left[one.colspan.start] = max(left[one.colspan.start], around.left + air)
                right[one.colspan.stop - 1] = max(right[one.colspan.stop - 1], around.right + air)
                top[one.rowspan.start] = max(top[one.rowspan.start], around.top + air)
                bottom[one.rowspan.stop - 1] = max(bottom[one.rowspan.stop - 1], around.bottom + air)
            across = _parted(box.x0, box.x1, grid.get_width_ratios() or [1.0] * columns, left, right)
            down = _parted(-box.y1, -box.y0, grid.get_height_ratios() or [1.0] * rows, top, bottom)
            parted[grid] = across, down
        across, down = parted[grid]
        x, y = across[spec.colspan], -down[spec.rowspan]
        return _Cell(Bbox([(x[0, 1], y[-1, 2]), (x[-1, 2], y[0, 1])]), Bbox([(x[0, 0], y[-1, 3]), (x[-1, 3], y[0, 0])]))

    return {ax: cell(cast(SubplotSpec, ax.get_subplotspec())) for ax in margins}


def _parted(low: float, high: float, ratios: Iterable[float], before: Float, after: Float) -> Float:
    """Where each part begins with its margin, begins, ends, and ends with its margin: shape (K, 4)."""
    share = np.array(list(ratios), dtype=np.float64)
    free = max(high - low - float(before.sum() + after.sum()), 1.0)
    size = free * share / share.sum()
    ends = low + np.cumsum(before + size + after)
    starts = ends - (before + size + after)
    return np.column_stack([starts, starts + before, ends - after, ends])


def _place(ax: Axes, box: Bbox) -> None:
    """Put a panel on whole pixels."""
    width, height = ax.figure.bbox.size
    x0, y0, x1, y1 = (round(float(value)) for value in box.extents)
    ax.set_position((x0 / width, y0 / height, (x1 - x0) / width, (y1 - y0) / height), which="both")
    ax.set_in_layout(True)  # which it is no more when it was placed by hand


def _place_space(ax: Axes, cell: _Cell, renderer: Any) -> None:
    """Put a view in space into the middle of the room that it has, smaller if need be.

    Its labels stand all around, and keep their size; and matplotlib draws it in a square that it leaves empty in part.
    """
    room = cell.outer.padded(-_LEAST_AIR)
    kept = _LABELS * ax.figure.dpi / 72.0
    _place(ax, cell.inner)
    scale = 1.0
    for _ in range(_ROUNDS):
        words = place_labels(ax, renderer)
        if _multiplied(ax):
            words = place_labels(ax, renderer)
        drawn = Axes.get_tightbbox(ax, renderer)  # which is that of a view in space without its axes
        box = words if drawn is None else Bbox.union([words, drawn])
        scale = min(1.0, *((np.array(room.size) - kept) / (np.array(box.size) - kept)).tolist())
        old = ax.get_position(original=True).transformed(ax.figure.transFigure)
        moved = _middle(room) + scale * (_middle(old) - _middle(box))
        half = 0.5 * scale * np.array(old.size)
        _place(ax, Bbox([moved - half, moved + half]))
        if scale > _LITTLE:  # the labels are as large as was thought, or it hardly matters
            break
    if scale < 1.0:
        place_labels(ax, renderer)  # which may touch, now that it is smaller


def _middle(box: Bbox) -> Float:
    return np.array([0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)])


def _multiplied(ax: Axes) -> bool:
    """Write powers of ten by which ticks are multiplied into the units, and keep them; tell whether there were any.

    Matplotlib would write them above the axes, over the panel's letter.
    """
    found = False
    for axis in cast(Any, ax)._axis_map.values():
        formatter = axis.get_major_formatter()
        told = _POWER.fullmatch(formatter.get_offset())
        if told and axis.get_offset_text().get_visible():
            power = int(told[1].replace("\N{MINUS SIGN}", "-"))
            formatter.set_powerlimits((power, power))
            axis.get_offset_text().set_visible(False)
            axis.set_label_text(_multiplied_label(axis.get_label_text(), power_of_ten(power)))
            found = True
    return found


def _multiplied_label(label: str, factor: str) -> str:
    """Put a factor before the unit in parentheses at the end of a label; an empty one stays so."""
    found = _UNIT.fullmatch(label)
    name, unit = found.groups() if found else (f"{label} ", "–")
    return f"{name}({factor}{'' if unit == '–' else f' {unit}'})" if label else ""


def _thinned(scales: Sequence[Scale], boxes: Sequence[Float]) -> bool:
    """Take fewer ticks where labels touch; tell whether any did."""
    found = False
    for scale, labels in zip(scales, boxes, strict=True):
        if scale.is_free and _touch(labels, scale):
            few = len(labels) < 4  # fewer than three, one of them 0, no rule for round numbers gives
            ends = FixedLocator(scale.places[[0, -1]].tolist())
            scale.axis.set_major_locator(ends if few else MaxNLocator(len(labels) - 2, steps=[1, 2, 2.5, 5, 10]))
            found = True
    return found


def _touch(boxes: Float, scale: Scale) -> bool:
    """Whether neighbors lie closer to each other than half a digit's width along the axis, or at all up the axis."""
    along = 0 if scale.lies else 1
    ends = sorted((box[along], box[along + 2]) for box in boxes.tolist())
    apart = 0.3 * TEXT * scale.axis.get_figure().dpi / 72.0 if scale.lies else 0.0
    return len(ends) > 2 and any(after[0] - before[1] < apart for before, after in pairwise(ends))
