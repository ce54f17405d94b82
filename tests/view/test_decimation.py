"""Few points that draw the same line as all of them."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from elbowscrew.plots.series import line
from elbowscrew.view.decimation import drawn_band, drawn_rows


def test_short_series_are_drawn_whole() -> None:
    assert (drawn_rows(np.random.default_rng(0).normal(size=4000)) == np.arange(4000)).all()


@pytest.mark.parametrize("count", [4001, 100_000, 1_000_003])
def test_peaks_stay_and_points_are_few(count: int) -> None:
    rng = np.random.default_rng(count)
    curves = rng.normal(size=(2, count))
    curves[0, 777], curves[1, count - 5] = 30.0, -30.0
    rows = drawn_rows(*curves)
    assert rows.size <= 4 * 2000 + 2
    assert (np.diff(rows) > 0).all()
    assert rows[0] == 0
    assert rows[-1] == count - 1
    size = -(-count // 2000)
    for curve in curves:
        for start in range(0, count, size):
            mine = rows[(rows >= start) & (rows < start + size)]
            assert curve[mine].min() == curve[start : start + size].min()
            assert curve[mine].max() == curve[start : start + size].max()


def test_long_gaps_stay_gaps_and_lost_frames_are_no_peaks() -> None:
    curve = np.sin(np.linspace(0.0, 20.0, 100_000))
    curve[40_000:50_000] = np.nan
    curve[::7] = np.nan
    rows = drawn_rows(curve)
    inside = (rows > 40_100) & (rows < 49_900)
    assert np.isnan(curve[rows[inside]]).all()
    assert inside.any()
    outside = (rows < 40_000) | (rows >= 50_000)
    assert np.isfinite(curve[rows[outside]][1:-1]).all()


def test_the_picture_is_that_of_all_points() -> None:
    rng = np.random.default_rng(1)
    time_s = np.linspace(0.0, 1.0, 200_000)
    curve = np.sin(9.0 * time_s) + rng.normal(scale=0.05, size=time_s.size)
    pictures: list[Any] = []
    for rows in (np.arange(time_s.size), drawn_rows(curve)):
        figure = Figure(figsize=(6.7, 3.0), dpi=300)
        canvas: Any = FigureCanvasAgg(figure)
        figure.add_subplot().plot(time_s[rows], curve[rows], color="black", linewidth=1.3)
        canvas.draw()
        pictures.append(np.asarray(canvas.buffer_rgba(), dtype=np.float64)[..., 0])
    differing = np.abs(pictures[0] - pictures[1]) > 64.0
    assert differing.mean() < 2e-3


@pytest.mark.parametrize("count", [1, 2, 4000, 4001, 100_003])
def test_a_line_in_pieces_leaves_nothing_out(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count)
    ax = line(Figure().add_subplot(), np.arange(float(count)), values, label="measured", color="black")
    drawn = [np.asarray(piece.get_xydata()) for piece in ax.get_lines()]
    for before, after in pairwise(drawn):
        assert (before[-1] == after[0]).all()
    whole = np.concatenate([drawn[0], *(piece[1:] for piece in drawn[1:])])
    rows = drawn_rows(values)
    assert (whole == np.column_stack([rows, values[rows]])).all()
    assert (len(drawn) == 1) == (count <= 4000)
    assert ax.get_legend_handles_labels()[1] == ["measured"]


@pytest.mark.parametrize("count", [4000, 100_003])
def test_a_band_covers_all_of_its_frames_and_no_more(count: int) -> None:
    rng = np.random.default_rng(count)
    low = rng.normal(size=count)
    high = low + 0.1
    low[40:90], high[40:90] = np.nan, np.nan
    rows, lower, upper = drawn_band(low, high)
    assert rows.size <= 4000
    assert rows[0] == 0
    assert rows[-1] == count - 1
    assert np.nanmin(lower) == np.nanmin(low)
    assert np.nanmax(upper) == np.nanmax(high)
    for place in rng.integers(100, rows.size - 2, 50):
        inside = slice(rows[place], rows[place + 1])
        assert lower[place] == low[inside].min()
        assert upper[place] == high[inside].max()


def test_a_band_is_broken_where_nothing_is_known() -> None:
    curve = np.zeros(100_000)
    curve[30_000:60_000] = np.nan
    rows, lower, upper = drawn_band(curve - 1.0, curve + 1.0)
    inside = (rows > 30_100) & (rows < 59_900)
    assert inside.any()
    assert np.isnan(lower[inside]).all()
    assert np.isnan(upper[inside]).all()
