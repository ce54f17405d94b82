"""Figures in files are drawn at once: they look as matplotlib draws them, and hang on nothing that was drawn before."""

from __future__ import annotations

import io
from typing import Any, cast

import numpy as np
import pytest
from drawn_trials import drawn_trial
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

from elbowscrew.plots import canvas, scale, style
from elbowscrew.plots.layout import settle
from elbowscrew.plots.registry import FIGURES
from elbowscrew.plots.scale import draw_at_once
from elbowscrew.plots.style import new_figure, publication_style
from elbowscrew.report.figure_files import figure_files

DRAWN = [
    ("error", "short", 85.0),
    ("joint", "two axes", 170.0),
    ("quality", "gappy", 60.0),
    ("joint_axis", "short", 85.0),
]


def pixels(figure: Figure) -> NDArray[np.uint8]:
    canvas: Any = figure.canvas
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()).copy()


@pytest.mark.parametrize(("name", "kind", "width_mm"), DRAWN)
def test_a_figure_drawn_at_once_has_the_pixels_of_one_that_matplotlib_draws(
    name: str, kind: str, width_mm: float
) -> None:
    with publication_style():
        figure = FIGURES[name](drawn_trial(kind), width_mm=width_mm)
        settle(figure)
        expected = pixels(figure)
        draw_at_once(figure)
        assert any(isinstance(one, scale.Scale) for ax in figure.axes for one in ax.get_children())
        assert np.array_equal(pixels(figure), expected)


def test_views_in_space_and_legends_are_as_matplotlib_draws_them(monkeypatch: pytest.MonkeyPatch) -> None:
    def drawn() -> tuple[bytes, list[NDArray[np.uint8]]]:
        with publication_style():
            figure = FIGURES["joint"](drawn_trial("two axes"), width_mm=170.0)
            settle(figure)
            found = [pixels(figure)]
            stream = io.BytesIO()
            figure.savefig(stream, format="svg", metadata={"Date": None})
            figure.set_dpi(110.0)
            return stream.getvalue(), [*found, pixels(figure)]

    ours = drawn()
    monkeypatch.setattr(canvas, "Space", Axes3D)
    monkeypatch.setattr(style, "_measured_once", lambda _box: None)
    expected = drawn()
    assert ours[0] == expected[0]
    for found, usual in zip(ours[1], expected[1], strict=True):
        assert np.array_equal(found, usual)


@pytest.mark.parametrize(("name", "kind", "width_mm"), DRAWN)
def test_panels_keep_clear_of_each_others_words(name: str, kind: str, width_mm: float) -> None:
    with publication_style():
        figure = FIGURES[name](drawn_trial(kind), width_mm=width_mm)
        settle(figure)
        boxes = [cast(Bbox, ax.get_tightbbox()) for ax in figure.axes]
    for k, box in enumerate(boxes):
        assert np.array_equal(Bbox.union([box, figure.bbox.padded(1.0)]).extents, figure.bbox.padded(1.0).extents)
        for other in boxes[:k]:
            both = Bbox.intersection(box, other)
            assert both is None or min(both.size) <= 1.0


def test_panels_stand_in_line() -> None:
    with publication_style():
        figure = new_figure(170.0, 100.0)
        panels = figure.subplots(2, 2, width_ratios=[2.0, 1.0])
        panels[0, 0].plot([0.0, 1.0], [0.0, 1e-3])
        panels[1, 0].set_ylabel("A name\nof two lines (mm)")
        settle(figure)
        places = [[ax.get_position() for ax in row] for row in panels]
    for row in places:
        assert row[0].intervaly.tolist() == row[1].intervaly.tolist()
        assert row[0].width == pytest.approx(2.0 * row[1].width, abs=3.0 / figure.bbox.width)
    for column in zip(*places, strict=True):
        assert column[0].intervalx.tolist() == column[1].intervalx.tolist()
    sides = np.array([[place.x0, place.x1] for row in places for place in row]) * figure.bbox.width
    assert sides == pytest.approx(np.round(sides), abs=1e-6)


def test_a_figure_is_the_same_whatever_was_drawn_before() -> None:
    trial = drawn_trial("short")
    for known in (canvas._SIZES, canvas._STAMPS, scale._BOXES, scale._LAYOUTS):
        known.clear()
    fresh = figure_files(trial, ["joint"], ["svg", "png"])
    figure_files(drawn_trial("gappy"), ["joint"], ["png"])
    figure_files(trial, ["joint"], ["pdf", "png"], 85.0)
    assert figure_files(trial, ["joint"], ["pdf", "svg", "png"]) | fresh == figure_files(
        trial, ["joint"], ["svg", "png", "pdf"]
    )


def test_a_figure_of_spaces_alone_is_laid_out() -> None:
    with publication_style():
        figure = new_figure(85.0, 60.0)
        spaces = [figure.add_subplot(1, 2, k, projection="3d") for k in (1, 2)]
        settle(figure)
        left, right = (cast(Bbox, ax.get_tightbbox()) for ax in spaces)
    assert left.x0 >= 0.0
    assert left.x1 <= right.x0
    assert right.x1 <= figure.bbox.x1
