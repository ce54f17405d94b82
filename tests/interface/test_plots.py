"""Plots by attribute: new, or on one's own Axes."""

from __future__ import annotations

from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes

import elbowscrew
from elbowscrew import Analysis
from elbowscrew.choices import FigureName
from elbowscrew.errors import UsageError
from elbowscrew.interface.plotting import OnePanel, Plots, SeveralPanels
from elbowscrew.plots.panels import panels_of
from elbowscrew.plots.registry import FIGURES
from elbowscrew.view.figure_names import FIGURE_ENTRIES

NAMES: list[FigureName] = list(FIGURE_ENTRIES)  # type: ignore[arg-type]
LACKING = ("anatomy", "axis_path")  # of this elbow


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    plt.close("all")


def test_there_is_a_plot_for_each_figure(elbow: Analysis) -> None:
    assert set(elbow.plot.available) == set(NAMES) - set(LACKING)
    assert all(isinstance(getattr(elbow.plot, name), OnePanel) for name in NAMES)


@pytest.mark.parametrize("name", [name for name in NAMES if name not in LACKING])
def test_a_figure_is_made_of_the_panels_that_are_drawn_on_own_axes(elbow: Analysis, name: FigureName) -> None:
    view = elbow.trial_view()
    panels = panels_of(name, view)
    whole = [ax for ax in FIGURES[name](view).axes if ax.get_label() != "<colorbar>"]
    assert [ax.name == "3d" for ax in whole] == [panel.in_space for panel in panels]
    figure = plt.figure()
    axes = [
        figure.add_subplot(1, len(panels), k + 1, projection="3d" if panel.in_space else None)
        for k, panel in enumerate(panels)
    ]
    plot = getattr(elbow.plot, name)
    several = isinstance(plot, SeveralPanels)
    assert several == (len(panels) > 1)
    drawn = plot(axes) if several else (plot(axes[0]),)
    assert list(drawn) == axes
    for ours, theirs in zip(axes, whole, strict=True):
        assert len(ours.lines) == len(theirs.lines)
        for line, known in zip(ours.lines, theirs.lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), known.get_xydata())
        assert (ours.get_legend() is None) == (not ours.get_legend_handles_labels()[1])


def test_a_new_plot_is_pyplots_and_takes_the_style_of_its_curve(elbow: Analysis) -> None:
    ax = elbow.plot.theta(color="red", linewidth=3, label="mine")
    assert ax.figure is plt.gcf()
    assert ax.lines[0].get_color() == "red"
    assert ax.lines[1].get_color() != "red"
    legend = plt.gcf().legends[0]
    assert legend.get_texts()[0].get_text() == "mine"
    assert legend.legend_handles[0].get_color() == "red"  # type: ignore[union-attr]


def test_own_axes_keep_what_is_there(elbow: Analysis) -> None:
    _, ax = plt.subplots()
    (there,) = ax.plot([0, 1], color="green", label="there")
    assert elbow.plot.theta(ax, color="red") is ax
    assert there.get_color() == "green"
    assert ax.lines[1].get_color() == "red"
    legend = ax.get_legend()
    assert legend is not None
    assert "there" in [text.get_text() for text in legend.get_texts()]


def test_the_overview_is_angle_slide_and_error(elbow: Analysis, read_back: Analysis) -> None:
    for one in (elbow, read_back):
        axes = one.plot()
        assert len(axes) == 4
        assert all(isinstance(ax, Axes) for ax in axes)


def test_axes_that_do_not_fit_are_told(elbow: Analysis) -> None:
    figure, ax = plt.subplots()
    with pytest.raises(UsageError, match="2 panels: expected ax with as many Axes, found 1"):
        elbow.plot.error([ax])
    with pytest.raises(UsageError, match="projection"):
        elbow.plot.axis(figure.subplots(1, 3))
    with pytest.raises(UsageError, match=r"plot\.available"):
        elbow.plot.axis_path()
    assert isinstance(elbow.plot, Plots)


def test_plots_are_an_attribute_of_the_package(elbow: Analysis) -> None:
    _, ax = plt.subplots()
    assert elbowscrew.plots.plot_theta(ax, elbow) is ax
