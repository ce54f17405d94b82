"""Where the words at the axes of a view in space stand: clear of the box, of each other and of their neighbors'.

Matplotlib puts them at a distance that knows nothing of how wide they are.
"""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from typing import Any, Final, NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, MaxNLocator
from matplotlib.transforms import Bbox

from elbowscrew.geometry.arrays import Float
from elbowscrew.plots.scale import about_its_point

_ROUNDS: Final = 8  # at most
_STEPS: Final = (1, 2, 2.5, 5, 10)
_GAP: Final = 3.5  # points between the box and a tick label, with the tick's mark
_NAME_GAP: Final = 1.5  # points between a tick label and the axis' name
_CLOSE: Final = 0.3  # points by which a distance may be off
_ASIDE: Final = 2.0  # points between two labels
_PAD, _NAME_PAD = 8.0, 21.0  # points that matplotlib adds of its own accord


class _Side(NamedTuple):
    """An axis as it stands on the paper, pixels.

    Attributes
    ----------
    axis : object
        Matplotlib's.
    ticks : list
        Those within the limits.
    boxes : ndarray, shape (K, 4)
        Lower left and upper right corners of their labels.
    out : ndarray, shape (2,)
        Across the axis, away from the box.
    ends : ndarray, shape (2, 2)
        Of the axis.
    """

    axis: Any
    ticks: list[Any]
    boxes: Float
    out: Float
    ends: Float


def place_labels(ax: Axes, renderer: Any) -> Bbox:
    """Put tick labels and names of a view in space where they are clear, with fewer ticks where they would touch.

    Returns
    -------
    Bbox
        Of the axes with their words, pixels.
    """
    axes = list(cast(Any, ax)._axis_map.values())
    ax.apply_aspect()
    sides = [_side(axis, renderer) for axis in axes]
    for _ in range(_ROUNDS):
        changed = [_thinned(side, renderer) or _moved(side, renderer) for side in sides]
        if not any(changed):
            changed = _parted(sides, renderer)
            if not any(changed):
                break
        sides = [_side(side.axis, renderer) if new else side for side, new in zip(sides, changed, strict=True)]
    return Bbox.union([_box(side, renderer) for side in sides])


def _box(side: _Side, renderer: Any) -> Bbox:
    """What an axis takes with its words, pixels."""
    name = side.axis.label
    corners = [side.ends, side.boxes.reshape(-1, 2)]
    if name.get_visible() and name.get_text():
        at = _on_paper(side.axis, [name.get_position()])
        corners.append(at + np.reshape(about_its_point(name, name.get_text(), renderer), (2, 2)))
    every = np.concatenate(corners)
    return Bbox([every.min(axis=0), every.max(axis=0)])


def _thinned(side: _Side, renderer: Any) -> bool:
    """Take fewer ticks where labels touch; tell whether any did."""
    count = len(side.ticks)
    if count < 3 or not _touch(side.boxes, renderer):
        return False
    if count > 3:
        side.axis.set_major_locator(MaxNLocator(count - 2, steps=_STEPS))
    else:
        _keep(side.axis, [side.ticks[0], side.ticks[-1]])
    return True


def _moved(side: _Side, renderer: Any) -> bool:
    """Put the tick labels off the axis by as much as the widest needs, and the name beyond them; tell if they were not.

    How far a pad reaches is not quite in proportion to it.
    """
    axis, name = side.axis, side.axis.label
    close = _gap(_CLOSE, renderer)
    short = beyond = 0.0
    if side.ticks:
        short = _gap(_GAP, renderer) - float((_middles(side) - _reach(side)).min())
        beyond = float((_middles(side) + _reach(side)).max()) + short
    if abs(short) > close:
        apart = _off(side, [tick.label1.get_position() for tick in side.ticks])
        axis.set_tick_params(pad=(side.ticks[0].get_pad() + _PAD) * (apart + short) / apart - _PAD)
    if not (name.get_visible() and name.get_text()):
        return abs(short) > close
    apart = _off(side, [name.get_position()])
    wanted = beyond + _gap(_NAME_GAP, renderer) + 0.5 * _height(name, renderer)
    if abs(wanted - apart) > close:
        axis.labelpad = (axis.labelpad + _NAME_PAD) * wanted / apart - _NAME_PAD
    return abs(short) > close or abs(wanted - apart) > close


def _off(side: _Side, points: Any) -> float:
    """How far points of the axis' own are off it on the paper, pixels, in the mean."""
    return float(((_on_paper(side.axis, points) - side.ends[0]) @ side.out).mean())


def _height(name: Any, renderer: Any) -> float:
    """Height of a text before it is turned, pixels."""
    found = renderer.get_text_width_height_descent(name.get_text(), name.get_fontproperties(), ismath=False)
    return float(found[1])


def _parted(sides: list[_Side], renderer: Any) -> list[bool]:
    """Leave out a tick at each corner where labels of two axes meet, of the one with more; tell whose ticks are new."""
    new = [False] * len(sides)
    for n, (one, other) in enumerate(pairwise(sides)):
        met = _met(one, other, renderer)
        if met is not None and not new[n]:
            fewer = len(other.ticks) >= min(len(one.ticks), 3)
            side, left = (other, met[1]) if fewer else (one, met[0])
            _keep(side.axis, [tick for k, tick in enumerate(side.ticks) if k != left])
            new[n + fewer] = True
    return new


def _met(one: _Side, other: _Side, renderer: Any) -> tuple[int, int] | None:
    """Which two labels of different axes touch."""
    apart = _gap(_ASIDE, renderer)
    pairs = ((k, j) for k in range(len(one.boxes)) for j in range(len(other.boxes)))
    return next(((k, j) for k, j in pairs if _overlap(one.boxes[k], other.boxes[j], apart)), None)


def _keep(axis: Any, ticks: list[Any]) -> None:
    axis.set_major_locator(FixedLocator([tick.get_loc() for tick in ticks]))


def _put_in_place(axis: Any, renderer: Any) -> None:
    """Put line, ticks and words where they will be drawn: before matplotlib 3.11 drawing them alone did so."""
    axis.axes.M = axis.axes.get_proj()
    put_all = getattr(axis, "_update_all_positions", None)
    if put_all is None:
        axis.draw(renderer)  # which the figure's own drawing wipes off
    else:
        deque(put_all(), maxlen=0)


def _side(axis: Any, renderer: Any) -> _Side:
    _put_in_place(axis, renderer)
    low, high = sorted(axis.get_view_interval())
    close = 1e-9 * (high - low)
    made = axis.majorTicks[: len(axis.get_majorticklocs())]  # those behind them are left from an earlier choice
    ticks = [tick for tick in made if low - close <= tick.get_loc() <= high + close]
    for tick in ticks:
        tick.label1.set_va("center")
        tick.label1.set_ha("center")
    labels = [tick.label1 for tick in ticks]
    about = np.array([about_its_point(label, label.get_text(), renderer) for label in labels]).reshape(-1, 4)
    boxes = about + np.tile(_on_paper(axis, np.array([label.get_position() for label in labels]).reshape(-1, 2)), 2)
    ends = _on_paper(axis, np.column_stack(axis.line.get_data()))
    along = ends[1] - ends[0]
    out = np.array([along[1], -along[0]]) / float(np.hypot(*along))
    middle = ends.mean(axis=0)
    box = np.array(axis.axes.bbox.extents)
    inside = 0.5 * (box[:2] + box[2:]) - middle  # the view's own middle lies on the other side
    return _Side(axis, ticks, boxes, -out if float(out @ inside) > 0.0 else out, ends)


def _on_paper(axis: Any, points: Any) -> Float:
    return np.asarray(axis.axes.transData.transform(np.asarray(points)), dtype=np.float64)


def _middles(side: _Side) -> Float:
    return np.asarray((0.5 * (side.boxes[:, :2] + side.boxes[:, 2:]) - side.ends[0]) @ side.out)


def _reach(side: _Side) -> Float:
    return np.asarray(0.5 * (side.boxes[:, 2:] - side.boxes[:, :2]) @ np.abs(side.out))


def _touch(boxes: Float, renderer: Any) -> bool:
    apart = _gap(_ASIDE, renderer)
    return any(_overlap(one, other, apart) for one, other in pairwise(boxes))


def _overlap(one: Float, other: Float, apart: float) -> bool:
    """Whether two boxes come closer to each other than so many pixels."""
    return bool((one[:2] < other[2:] + apart).all() and (other[:2] < one[2:] + apart).all())


def _gap(points: float, renderer: Any) -> float:
    return float(renderer.points_to_pixels(points))
