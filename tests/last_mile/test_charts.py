"""Curves, levels and points of the page's charts are where the tables put them, by the charts' own ticks."""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import ArrayLike
from read_charts import Read, panels_in
from recomputed import rms
from told_results import Float, Told


def panels(told: Told, title: str) -> list[Read]:
    page = (told.folder / "report.html").read_text(encoding="utf-8")
    (chart,) = re.findall(rf"<svg[^>]*>\s*<title[^>]*>{title}</title>.*?</svg>", page, re.S)
    return panels_in(chart)


def curve(panel: Read, look: str) -> tuple[Float, Float]:
    """Values along and up of the one path with that look."""
    (points,) = panel.outline(look)
    return points[:, 0], points[:, 1]


def same_reach(found: Float, values: ArrayLike, pixel: float) -> None:
    """Highest and lowest to a pixel."""
    assert found.max() == pytest.approx(np.nanmax(values), abs=pixel)
    assert found.min() == pytest.approx(np.nanmin(values), abs=pixel)


def test_angle_over_time(told: Told) -> None:
    (panel,) = panels(told, "Angle over time")
    for look, table in (("measured", told.screw), ("modeled", told.model)):
        time_s, theta = curve(panel, look)
        same_reach(theta, table["theta_deg"], panel.pixel)
        when = table["time_s"].to_numpy()[int(np.nanargmax(table["theta_deg"].to_numpy(float)))]
        assert np.interp(when, time_s, theta) == pytest.approx(table["theta_deg"].max(), abs=panel.pixel)
    time_s, theta, _ = np.array(panel.dots("keyframe")).T
    assert time_s == pytest.approx(told.keyframes["time_s"].to_numpy(), abs=0.01)
    assert theta == pytest.approx(told.keyframes["theta_deg"].to_numpy(), abs=panel.pixel)


def test_error_over_time(told: Told) -> None:
    both = panels(told, "Error of the model over time")
    for panel, name in zip(both, ("angle_error_deg", "rms_displacement_mm"), strict=True):
        _, errors = curve(panel, "measured")
        same_reach(errors, told.model[name], panel.pixel)
        _, level = curve(panel, "level")
        assert level == pytest.approx(np.full(2, rms(told.model[name])), abs=panel.pixel)


def test_euler_parameters_over_time(told: Told) -> None:
    for k, panel in enumerate(panels(told, "Euler parameters over time")):
        for look, table in (("measured", told.screw), ("modeled", told.model)):
            same_reach(curve(panel, look)[1], table[f"e{k}"], panel.pixel)
