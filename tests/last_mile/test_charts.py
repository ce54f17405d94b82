"""Curves, levels and points of the page's charts are where the tables put them, by the charts' own ticks."""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import ArrayLike
from recomputed import rms
from told_results import Float, Told

PANEL = re.compile(r"<g transform=\"translate\(.*?(?=<g transform=\"translate\(|\Z)", re.S)
POINTS = re.compile(r"[ML]?(-?[\d.]+) (-?[\d.]+)")


class Panel:
    """Part of a chart with its own ticks: pixels to values by the labels of two of them."""

    def __init__(self, svg: str) -> None:
        self.svg = svg
        down = re.findall(r'<text x="[\d.]+" y="([\d.]+)" text-anchor="end">(−?[\d.]+)</text>', svg)
        along = re.findall(r'<text x="([\d.]+)" y="[\d.]+" text-anchor="middle">(−?[\d.]+)</text>', svg)
        lines = sorted(float(y) for y in re.findall(r'class="grid" d="M[\d.]+ ([\d.]+)H', svg))
        self._y = fitted(lines, sorted((number(text) for _, text in down), reverse=True))
        self._x = fitted([float(x) for x, _ in along], [number(text) for _, text in along])

    def curve(self, look: str) -> tuple[Float, Float]:
        """Values along and up of the path with that look."""
        (path,) = re.findall(rf'<path class="{look}"[^>]* d="([^"]*)"', self.svg)
        points = np.array([[float(x), float(y)] for x, y in POINTS.findall(path)])
        return np.polyval(self._x, points[:, 0]), np.polyval(self._y, points[:, 1])

    def dots(self) -> tuple[Float, Float]:
        """Values along and up of the keyframes."""
        points = np.array(re.findall(r'<circle class="keyframe" cx="([\d.]+)" cy="([\d.]+)"', self.svg), float)
        return np.polyval(self._x, points[:, 0]), np.polyval(self._y, points[:, 1])

    @property
    def pixel(self) -> float:
        return float(abs(self._y[0]))


def number(text: str) -> float:
    return float(text.replace("−", "-"))


def fitted(pixels: list[float], values: list[float]) -> Float:
    assert len(pixels) == len(values) > 1
    line = np.polyfit(pixels, values, 1)
    assert np.allclose(np.polyval(line, pixels), values, atol=0.6 * abs(line[0]))
    return np.asarray(line)


def panels(told: Told, title: str) -> list[Panel]:
    page = (told.folder / "report.html").read_text(encoding="utf-8")
    (chart,) = re.findall(rf"<svg[^>]*>\s*<title[^>]*>{title}</title>.*?</svg>", page, re.S)
    return [Panel(part) for part in PANEL.findall(chart)] or [Panel(chart)]


def same_reach(found: Float, values: ArrayLike, pixel: float) -> None:
    """Highest and lowest to a pixel."""
    assert found.max() == pytest.approx(np.nanmax(values), abs=pixel)
    assert found.min() == pytest.approx(np.nanmin(values), abs=pixel)


def test_angle_over_time(told: Told) -> None:
    (panel,) = panels(told, "Angle over time")
    for look, table in (("measured", told.screw), ("modeled", told.model)):
        time_s, theta = panel.curve(look)
        same_reach(theta, table["theta_deg"], panel.pixel)
        when = table["time_s"].to_numpy()[int(np.nanargmax(table["theta_deg"].to_numpy(float)))]
        assert np.interp(when, time_s, theta) == pytest.approx(table["theta_deg"].max(), abs=panel.pixel)
    time_s, theta = panel.dots()
    assert time_s == pytest.approx(told.keyframes["time_s"].to_numpy(), abs=0.01)
    assert theta == pytest.approx(told.keyframes["theta_deg"].to_numpy(), abs=panel.pixel)


def test_error_over_time(told: Told) -> None:
    both = panels(told, "Error of the model over time")
    for panel, name in zip(both, ("angle_error_deg", "rms_displacement_mm"), strict=True):
        _, errors = panel.curve("measured")
        same_reach(errors, told.model[name], panel.pixel)
        _, level = panel.curve("level")
        assert level == pytest.approx(np.full(2, rms(told.model[name])), abs=panel.pixel)


def test_euler_parameters_over_time(told: Told) -> None:
    for k, panel in enumerate(panels(told, "Euler parameters over time")):
        for look, table in (("measured", told.screw), ("modeled", told.model)):
            same_reach(panel.curve(look)[1], table[f"e{k}"], panel.pixel)
