"""No figure has ink at the edge, texts over each other, or a legend over what it explains.

Each figure is drawn as narrow as it may be and at two other widths, of trials of all kinds in turn;
``benchmarks/figures.py`` draws all figures of all trials at all widths.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from drawn_trials import KINDS, drawn_trial
from ink import faults_of
from matplotlib.figure import Figure
from matplotlib.text import Text

from elbowscrew import compare, simulate_trial
from elbowscrew.group.curves import PERCENT, group_curve
from elbowscrew.motion.interpolation.keyframe_sources import ComparisonPlan
from elbowscrew.plots.comparison import comparison_figure
from elbowscrew.plots.layout import settle
from elbowscrew.plots.overlay import conditions_figure, mean_curve, overlay_figure, subjects_figure
from elbowscrew.plots.registry import FIGURES
from elbowscrew.plots.style import letter, new_figure, publication_style
from elbowscrew.view.figure_names import FIGURE_ENTRIES, has_figure

WIDTHS_MM = (70.0, 85.0, 120.0, 170.0, 180.0)
NAMES = tuple(FIGURE_ENTRIES)


def widths_and_kinds(name: str) -> list[tuple[float, str]]:
    """Three widths, the narrowest among them, each with another kind of trial that has the figure."""
    kinds = [kind for kind in KINDS if has_figure(name, drawn_trial(kind))]
    first = NAMES.index(name)
    widths = (60.0, *(WIDTHS_MM[(first + 2 * k) % len(WIDTHS_MM)] for k in range(2)))
    return [(width, kinds[(first + k) % len(kinds)]) for k, width in enumerate(widths)]


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_cut_off_or_drawn_over(name: str) -> None:
    found = {}
    for width, kind in widths_and_kinds(name):
        with publication_style():
            figure = FIGURES[name](drawn_trial(kind), width_mm=width)
            settle(figure)
            found[width, kind] = faults_of(figure)
    assert not {at: faults for at, faults in found.items() if faults}


def test_a_power_of_ten_stands_in_the_unit_and_not_over_the_panels_letter() -> None:
    with publication_style():
        figure = new_figure(85.0, 60.0)
        upper, lower = figure.subplots(2, 1)
        upper.plot([0.0, 1.0], [1e-6, 4e-6])
        upper.set_ylabel("Error (deg)")
        lower.plot([0.0, 1e9], [0.0, 3.0])
        lower.set_xlabel("Time (s)")
        lower.set_ylabel("e (–)")
        letter(upper, lower)
        settle(figure)
        assert faults_of(figure) == []
    assert (upper.get_ylabel(), lower.get_xlabel(), lower.get_ylabel()) == ("Error (10⁻⁶ deg)", "Time (10⁹ s)", "e (–)")
    ticks = {float(tick.get_text().replace("−", "-")) for tick in upper.get_yticklabels()}
    assert ticks & {1.0, 2.0, 3.0, 4.0}


def test_nor_are_trials_and_models_beside_each_other() -> None:
    curves = [mean_curve(drawn_trial(kind)) for kind in ("short", "multi-cycle", "two axes")]
    plan = ComparisonPlan(laws=("linear", "cycloidal"), counts=(2, 3), data=("raw", "decimated"))
    compared = compare(simulate_trial(frames=120, inversion=55).recording, plan=plan)
    with publication_style():
        figures = [overlay_figure([one for one in curves if one], width_mm=width) for width in (60.0, 170.0)]
        heights = np.linspace(90.0, 150.0, 7)
        bump = np.radians(np.sin(np.pi * PERCENT / 100.0) ** 2)
        groups = {
            name: group_curve({f"s{k}": [one * bump] for k, one in enumerate(heights[:count] + shift)})
            for name, count, shift in (("slow", 7, 0.0), ("a condition with a long name", 3, 20.0), ("fast", 7, 9.0))
        }
        figures += [
            make(groups, width_mm=width) for make in (conditions_figure, subjects_figure) for width in (60.0, 170.0)
        ]
        for figure in (*figures, comparison_figure(compared)):
            settle(figure)
            assert faults_of(figure) == []


def drawn(figure: Figure) -> str:
    with publication_style():
        return "; ".join(faults_of(figure))


def test_what_is_wrong_is_seen() -> None:
    """The test above can fail: by each of the faults that it looks for."""
    with publication_style():
        figure = new_figure(85.0, 60.0)
        ax = figure.add_subplot()
        ax.plot([0.0, 1.0], [0.0, 1.0], label="line")
        ax.set_ylabel("Angle (deg)")
        letter(ax)
        settle(figure)
        assert faults_of(figure) == []
        ax.text(0.4, 0.4, "first")
        ax.text(0.41, 0.41, "second")
        assert "'first' over 'second'" in drawn(figure)
        ax.text(0.8, 0.2, "———————————————— a text that is too long")
        assert "is cut off" in drawn(figure)
        assert "ink at the right edge" in drawn(figure)
        ax.text(-0.05, 0.6, "across the axis")
        assert "'across the axis' runs out of its panel" in drawn(figure)
        ax.legend(loc="center")
        assert "legend over line 'line'" in drawn(figure)
        figure.legend(["line"], loc="lower left")
        assert "legend over an axes" in drawn(figure)
        ax.axhspan(0.1, 0.2, color=(1.0, 0.0, 0.0, 0.5))
        assert "is transparent" in drawn(figure)


def test_what_is_wrong_in_a_space_is_seen() -> None:
    """Matplotlib's own places for its words: over each other where a space is small."""
    with publication_style():
        figure = new_figure(60.0, 60.0)
        space = figure.add_subplot(2, 1, 1, projection="3d")
        space.set_xlim(-0.16, 0.16)
        assert "'−0.1' over '0.0'" in drawn(figure)
        settle(figure)
        assert faults_of(figure) == []


def test_words_in_a_space_clear_their_axis_and_each_other() -> None:
    with publication_style():
        figure = new_figure(60.0, 60.0)
        space = figure.add_subplot(projection="3d")
        for limits, name in ((space.set_xlim, "x"), (space.set_ylim, "y"), (space.set_zlim, "z")):
            limits(-1200.0, 1200.0)
            getattr(space, f"set_{name}label")(f"{name} (mm)")
        settle(figure)
        assert faults_of(figure) == []
        for axis in (space.xaxis, space.yaxis, space.zaxis):
            line = axis.line.get_transform().transform(np.column_stack(axis.line.get_data()))
            along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
            out = np.array([along[1], -along[0]])
            marks = axis.get_major_ticks(len(axis.get_majorticklocs()))
            labels = [tick.label1 for tick in marks if -1200.0 <= tick.get_loc() <= 1200.0]
            assert len(labels) >= 2
            ways = [corners @ out - line[0] @ out for corners in map(corners_of, labels)]
            points = figure.dpi / 72.0
            assert all((way > 2.0 * points).all() or (way < -2.0 * points).all() for way in ways)
            assert np.abs(ways).min() < 6.0 * points  # and not far off either
            name = abs((corners_of(axis.label).mean(axis=0) - line[0]) @ out) - np.abs(ways).max()
            assert 4.0 * points < name < 9.0 * points  # its middle


def corners_of(text: Text) -> Any:
    box = text.get_window_extent()
    return np.array([(x, y) for x in (box.x0, box.x1) for y in (box.y0, box.y1)])
