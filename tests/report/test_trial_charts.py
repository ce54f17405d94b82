"""The charts of a trial's page show what the trial holds, each thing with its name, in degrees and millimeters."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_trials import drawn_trial
from read_charts import Read, keys_in, numbers, panels_in, picture_in, remarks_in

from elbowscrew.choices import METHOD_LABELS
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.report.charts import COLORS
from elbowscrew.report.scene import scene_of
from elbowscrew.report.trial_charts import (
    axis_chart,
    error_chart,
    euler_chart,
    model_name,
    repetition_chart,
    theta_chart,
)
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.view.long_trials import stretch_of
from elbowscrew.view.trial_view import TrialView

TRACKING = [("rect", "fill-lost", "not tracked"), ("rect", "fill-filled", "filled in")]


@pytest.fixture(scope="module")
def trial(result: Path) -> TrialView:
    """A finished trial with noise that is known, a stretch that is lost and one that is filled in."""
    found = view_of_result(result)
    valid, filled = found.valid.copy(), np.zeros_like(found.filled)
    valid[20:30], valid[300:303] = False, False
    filled[300:303] = True
    lost = ~valid & ~filled
    changes: dict[str, Any] = {
        name: np.where(lost, np.nan, getattr(found, name)) for name in ("angle", "angle_error", "rms_displacement")
    }
    return replace(found, valid=valid, filled=filled, angle_sd=np.full(valid.size, np.radians(0.5)), **changes)


def description(html: str) -> tuple[str, str]:
    root = picture_in(html)
    return root[0].text or "", root[1].text or ""


def assert_spans(panel: Read, look: str, trial: TrialView, mask: Bool) -> None:
    """A rectangle from half a frame before the first frame to half a frame after the last of every run."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    half = 0.5 / trial.rate_hz
    runs = [(trial.time_s[a] - half, trial.time_s[b - 1] + half) for a, b in edges.reshape(-1, 2)]
    drawn = [
        np.polyval(panel.x, [float(one.get("x", "")), float(one.get("x", "")) + float(one.get("width", ""))])
        for one in panel.every("rect", look)
    ]
    assert np.array(drawn) == pytest.approx(np.array(runs), abs=0.3 * abs(panel.x[0]))


def assert_band(panel: Read, look: str, low: Float, high: Float) -> None:
    up = np.concatenate([outline[:, 1] for outline in panel.outline(look)])
    edges = np.concatenate([low, high])
    assert (up.min(), up.max()) == pytest.approx((np.nanmin(edges), np.nanmax(edges)), abs=panel.pixel)


def test_angle_over_time(trial: TrialView) -> None:
    html = theta_chart(trial)
    (panel,) = panels_in(html)
    assert panel.words == ["Time (s)", "Angle θ (deg)"]
    assert keys_in(html) == [
        ("rect", "fill-moving", "moving"),
        *TRACKING,
        ("rect", "band-known", "95 % interval (±0.98 deg)"),  # 1.96 standard deviations of 0.5 deg
        ("path", "measured", "measured"),
        ("path", "modeled", model_name(trial)),
        ("circle", "keyframe", "keyframes"),
    ]
    assert_spans(panel, "fill-lost", trial, ~trial.valid & ~trial.filled)
    assert_spans(panel, "fill-filled", trial, trial.filled)
    theta = np.degrees(trial.angle)
    assert_band(panel, "band-known", theta - 0.98, theta + 0.98)
    moving = [np.polyval(panel.x, float(one.get("x", ""))) for one in panel.every("rect", "fill-moving")]
    assert moving == pytest.approx(trial.time_s[trial.phases.onset_rows], abs=0.02)
    dots = np.array(panel.dots("keyframe"))[:, :2]
    rows = trial.keyframes.row[np.isfinite(theta[trial.keyframes.row])]
    assert dots == pytest.approx(np.column_stack([trial.time_s[rows], theta[rows]]), abs=panel.pixel)
    title, text = description(html)
    assert title == "Angle over time"
    top = int(np.nanargmax(theta))
    assert f"over {trial.time_s[-1] - trial.time_s[0]:.2f} seconds" in text
    assert f"{theta[top]:.1f} degrees, at frame {trial.frame[top]}." in text


def test_a_long_trial_has_an_overview_and_a_stretch() -> None:
    trial = drawn_trial("long")
    theta = np.degrees(trial.angle)
    stretch = stretch_of(trial)
    assert stretch is not None
    rows = slice(stretch.first, stretch.end)
    html = theta_chart(trial)
    above, below = panels_in(html)
    assert [above.words, below.words] == [["Time (s)", "θ (deg)"], ["Time (s)", "Angle θ (deg)"]]
    assert_band(above, "band-spread", theta, theta)
    (mark,) = above.every("rect", "fill-stretch")
    ends = [float(mark.get("x", "")), float(mark.get("x", "")) + float(mark.get("width", ""))]
    assert np.polyval(above.x, ends) == pytest.approx(trial.time_s[[rows.start, rows.stop - 1]], abs=2 * above.x[0])
    for panel, look in ((above, "thin-measured"), (below, "measured")):
        points = np.concatenate(panel.outline(look))
        times = trial.time_s[[rows.start, rows.stop - 1]]
        assert [points[:, 0].min(), points[:, 0].max()] == pytest.approx(times, abs=2 * panel.x[0])
        assert points[:, 1].max() == pytest.approx(np.nanmax(theta[rows]), abs=panel.pixel)
    inside = (trial.keyframes.row >= rows.start) & (trial.keyframes.row < rows.stop)
    known = np.isfinite(theta[trial.keyframes.row])
    assert len(below.dots("keyframe")) == int((inside & known).sum())
    assert f"below, of {stretch.told}, measured and modeled" in description(html)[1]
    errors = error_chart(trial)
    for panel, values in zip(
        panels_in(errors), (np.degrees(trial.angle_error), 1000.0 * trial.rms_displacement), strict=True
    ):
        assert_band(panel, "band-spread", values, values)
        (middle,) = panel.outline("measured")
        assert len(middle) < 200  # no block
        assert np.nanmin(values) <= middle[:, 1].min() + panel.pixel
        assert middle[:, 1].max() <= np.nanmax(values) + panel.pixel
    assert f"over time, of {stretch.told}." in description(euler_chart(trial))[1]


def test_all_of_the_curves_is_in_sight(trial: TrialView) -> None:
    for html in (theta_chart(trial), error_chart(trial), euler_chart(trial)):
        for panel in panels_in(html):
            left, _, right = numbers(panel.every("path", "axis")[0])
            (frame,) = next(panel.root.iter("clipPath"))
            top = float(frame.get("y", ""))
            low = top + float(frame.get("height", ""))
            for look in ("measured", "modeled"):
                for path in panel.every("path", look):
                    points = np.array(numbers(path)).reshape(-1, 2)
                    assert left <= points[:, 0].min()
                    assert points[:, 0].max() <= right
                    assert top <= points[:, 1].min()
                    assert points[:, 1].max() <= low + 0.1


def places(html: str) -> list[tuple[float, float]]:
    found = [re.fullmatch(r"translate\(([\d.]+) ([\d.]+)\)", part.get("transform", "")) for part in picture_in(html)]
    return [(float(match[1]), float(match[2])) for match in found if match]


def test_errors_one_above_the_other(trial: TrialView) -> None:
    html = error_chart(trial)
    panels = panels_in(html)
    for panel, values, label in zip(
        panels,
        (np.degrees(trial.angle_error), 1000.0 * trial.rms_displacement),
        ("Angle error (deg)", "RMS displacement (mm)"),
        strict=True,
    ):
        assert panel.words == ["Time (s)", label]
        (points,) = panel.outline("measured")
        assert points[:, 1].max() == pytest.approx(np.nanmax(values), abs=panel.pixel)
        (level,) = panel.outline("level")
        rms = np.sqrt(np.nanmean(values**2))
        assert level == pytest.approx(
            np.array([[trial.time_s[0], rms], [trial.time_s[-1], rms]]), abs=max(panel.pixel, abs(panel.x[0]))
        )
        assert_spans(panel, "fill-lost", trial, ~trial.valid & ~trial.filled)
        low = numbers(panel.every("path", "axis")[0])[1]
        assert np.polyval(panel.y, low) == pytest.approx(0.0, abs=panel.pixel)  # errors are seen from zero on
    assert keys_in(html) == [*TRACKING, ("path", "measured", "model against measurement"), ("path", "level", "RMS")]
    (one, other) = places(html)
    assert (one, other[0]) == ((0.0, 0.0), 0.0)
    assert_apart(html, places(html), 1)
    title, text = description(html)
    assert title == "Error of the model over time"
    assert f"RMS displacement of the {trial.named_joint.distal.name}'s points, over time." in text


def assert_apart(html: str, found: list[tuple[float, float]], columns: int) -> None:
    """Panels fill the picture row by row, none over another."""
    width, height = (float(part) for part in picture_in(html).get("viewBox", "").split()[2:])
    rows = -(-len(found) // columns)
    for k, (along, down) in enumerate(found):
        assert along == pytest.approx(width / columns * (k % columns))
        assert down == pytest.approx((height / rows) * (k // columns), abs=0.02 * height)


def test_four_euler_parameters(trial: TrialView) -> None:
    html = euler_chart(trial)
    for k, panel in enumerate(panels_in(html)):
        assert panel.words == ["Time (s)", f"e{'₀₁₂₃'[k]} (–)"]
        for look, values in (("measured", trial.euler_parameters), ("modeled", trial.modeled_euler_parameters)):
            (points,) = panel.outline(look)
            assert points[:, 1].max() == pytest.approx(np.nanmax(values[:, k]), abs=panel.pixel)
        rows = trial.keyframes.row
        dots = np.array(panel.dots("keyframe"))
        assert dots[:, 0] == pytest.approx(trial.time_s[rows], abs=abs(panel.x[0]))
        assert dots[:, 1] == pytest.approx(trial.euler_parameters[rows, k], abs=panel.pixel)
        assert_spans(panel, "fill-filled", trial, trial.filled)
    assert keys_in(html) == [
        *TRACKING,
        ("path", "measured", "measured"),
        ("path", "modeled", "modeled"),
        ("circle", "keyframe", "keyframes"),
    ]
    assert_apart(html, places(html), 2)
    assert description(html) == ("Euler parameters over time", "e0 to e3, measured and modeled, over time.")


def color_at(share: float) -> list[float]:
    """By linear interpolation between the colors of the scale."""
    channels = np.array([[int(color[k : k + 2], 16) for k in (1, 3, 5)] for color in COLORS])
    return [float(np.interp(share, np.linspace(0.0, 1.0, len(COLORS)), channel)) for channel in channels.T]


def rgb(color: str) -> list[int]:
    return [int(color[k : k + 2], 16) for k in (1, 3, 5)]


@pytest.mark.parametrize("kind", ["result", "ball_result"])
def test_axes_end_on_and_from_the_side(kind: str, request: pytest.FixtureRequest) -> None:
    """Against the view in space, which says lines, center and regions as numbers."""
    trial = view_of_result(request.getfixturevalue(kind))
    scene, html = scene_of(trial), axis_chart(trial)
    end_on, side = panels_in(html)
    direction, center = np.array(scene["direction"]), np.array(scene["center"])
    across = np.array(scene["across"])
    lines = np.array(scene["segments"]).reshape(-1, 2, 3) - center
    close = 2.0 * max(end_on.pixel, abs(side.x[0]))
    for panel, axes in ((end_on, across), (side, np.stack([direction, across[1]]))):
        drawn = np.array(panel.outline("thread"))
        assert drawn == pytest.approx(lines @ axes.T, abs=close)
    assert end_on.dots("center") == [pytest.approx([0.0, 0.0, 3.0], abs=close)]
    (joint,) = side.outline("joint")
    assert joint == pytest.approx(np.array([[-scene["half"], 0.0], [scene["half"], 0.0]]), abs=close)
    # Across, both panels have one scale, and the end-on one is as wide as high in millimeters.
    assert end_on.y == pytest.approx(side.y, rel=0.01)
    assert abs(end_on.x[0]) == pytest.approx(abs(end_on.y[0]), rel=0.01)
    told = {"band-spread": trial.spread95, "band-confidence": trial.confidence95}
    looks = [look for look, region in told.items() if region is not None and np.isfinite(region).all()]
    for look, region in zip(told, (scene["spread"], scene["confidence"]), strict=True):
        if look not in looks:  # a ball's axes have no distance from their mean, and so no region
            assert end_on.outline(look) == side.outline(look) == []
        if region is None:
            continue
        angle, radius = region
        (circle,) = end_on.outline(look)
        assert np.hypot(*circle.T) == pytest.approx(np.full(len(circle), radius), abs=close)
        assert np.ptp(circle, axis=0) == pytest.approx([2.0 * radius, 2.0 * radius], abs=2.0 * close)
        (hull,) = side.outline(look)
        far = hull[:, 0]
        assert np.abs(hull[:, 1]) == pytest.approx(np.hypot(radius, np.tan(angle) * far), abs=close)
    drawn = np.linalg.norm(np.array(end_on.outline("thread")), axis=2)
    assert np.percentile(drawn, 95.0) < abs(
        np.diff(np.polyval(end_on.x, numbers(end_on.every("path", "axis")[0])[::2]))[0]
    )
    name = "mean axis" if scene["confidence"] is None else "joint axis"
    words = {"band-spread": "95 % of the frames' axes", "band-confidence": "95 % confidence of the joint axis"}
    assert keys_in(html) == [*(("rect", look, words[look]) for look in looks), ("path", "joint", name)]
    toward = ["xyz"[int(np.argmax(np.abs(one)))] for one in across]
    for panel, along, up in (
        (end_on, f"Across, toward {toward[0]}", toward[1]),
        (side, f"Along the {name}", toward[1]),
    ):
        assert panel.words == [f"{along} (mm)", f"Across, toward {up} (mm)"]
    assert places(html)[0] == (0.0, 0.0)
    assert places(html)[1] == (0.5 * float(picture_in(html).get("viewBox", "").split()[2]), 0.0)
    title, text = description(html)
    assert title == "Axes of the frames about the joint's axis"
    assert f"The {name} and the axes of {len(lines)} frames about it" in text


def test_colors_of_the_axes_are_those_of_the_scale_below(result: Path) -> None:
    trial = view_of_result(result)
    html, scene = axis_chart(trial), scene_of(trial)
    theta = np.array(scene["segmentTheta"])
    shares = (theta - theta.min()) / np.ptp(theta)
    for panel in panels_in(html):
        strokes = [rgb(one.get("stroke", "")) for one in panel.every("path", "thread")]
        assert np.array(strokes) == pytest.approx(np.array([color_at(share) for share in shares]), abs=0.6)
    root = picture_in(html)
    bar = [one for one in root if one.tag == "rect"]
    begins = np.array([float(one.get("x", "")) for one in bar])
    widths = np.array([float(one.get("width", "")) for one in bar])
    assert (begins[1:] - begins[:-1] <= widths[:-1] + 0.11).all()  # without a seam
    whole = begins[-1] + widths[-1] - begins[0]
    for k, one in enumerate(bar):
        assert rgb(one.get("fill", "")) == pytest.approx(color_at(k / (len(bar) - 1)), abs=0.6)
    texts = [one for one in root if one.tag == "text"]
    *ticks, label = texts
    assert label.text == "Angle θ of the frame (deg)"
    values = np.array([float((one.text or "").replace("−", "-")) for one in ticks])
    marks = np.array([float(one.get("x", "")) for one in ticks])
    assert begins[0] + whole * (values - theta.min()) / np.ptp(theta) == pytest.approx(marks, abs=1.0)
    assert len(values) >= 3
    bottom = float(root.get("viewBox", "").split()[3])
    lowest = max(float(one.get("y", "")) + float(one.get("height", "")) for one in bar)
    assert lowest < min(float(one.get("y", "")) for one in ticks) < float(label.get("y", "")) < bottom
    panels_end = max(float(text.get("y", "")) for part in root if part.tag == "g" for text in part.iter("text")
                     if not (text.get("transform") or ""))  # fmt: skip
    assert panels_end < lowest
    assert float(label.get("x", "")) == pytest.approx(begins[0] + 0.5 * whole, abs=1.0)


def test_repetitions_are_a_mean_and_a_band() -> None:
    percent = np.linspace(0.0, 100.0, 101)
    mean, sd = np.radians(60.0 - 60.0 * np.cos(0.02 * np.pi * percent)), np.radians(5.0 + 0.0 * percent)
    html = repetition_chart({"percent": percent, "theta_mean": mean, "theta_sd": sd}, 7)
    (panel,) = panels_in(html)
    assert panel.words == ["Time of the cycle (%)", "Angle θ (deg)"]
    (points,) = panel.outline("measured")
    assert points == pytest.approx(np.column_stack([percent, np.degrees(mean)]), abs=panel.pixel)
    assert_band(panel, "band-known", np.degrees(mean - sd), np.degrees(mean + sd))
    assert keys_in(html) == [
        ("rect", "band-known", "± standard deviation"),
        ("path", "measured", "mean of 7 repetitions"),
    ]
    left, low, right = numbers(panel.every("path", "axis")[0])
    assert np.polyval(panel.x, [left, right]) == pytest.approx([0.0, 100.0], abs=0.1)
    assert np.polyval(panel.y, low) < -5.0
    title, text = description(html)
    assert title == "Angle over the repetitions"
    assert "over 7 repetitions, time normalized to the cycle." in text


def test_the_model_is_named_by_its_method_and_how_many_poses_it_goes_through(trial: TrialView) -> None:
    method = METHOD_LABELS[trial.settings.model_method]
    assert model_name(trial) == f"{method} through {len(trial.keyframes.row)} poses"


def test_a_picture_of_each_chart_holds_its_parts(result: Path) -> None:
    """Panels end above the picture's end, and no chart's ids are another's."""
    trial = view_of_result(result)
    charts = [theta_chart(trial), error_chart(trial), euler_chart(trial), axis_chart(trial)]
    ids: list[str] = []
    for html in charts:
        root = picture_in(html)
        bottom = float(root.get("viewBox", "").split()[3])
        for part in root.iter("g"):
            lower = float(re.findall(r"[\d.]+", part.get("transform", "translate(0 0)"))[1])
            for text in part.iter("text"):
                assert lower + float(text.get("y", "")) < bottom
        ids += [one.get("id", "") for one in root.iter() if one.get("id")]
    assert len(set(ids)) == len(ids)


def test_an_interval_and_a_deviation_that_nobody_would_see_are_told_and_not_drawn(trial: TrialView) -> None:
    sharp = replace(trial, angle_sd=np.full(trial.angle.shape, 1e-15))
    html = theta_chart(sharp)
    assert panels_in(html)[0].outline("band-known") == []
    assert remarks_in(html) == ["95 % interval: ±1.1·10⁻¹³ deg, too narrow to be drawn"]
    curve = {
        "percent": np.arange(101.0),
        "theta_mean": np.linspace(0.0, 2.0, 101),
        "theta_sd": np.full(101, np.radians(0.02)),
    }
    html = repetition_chart(curve, 3)
    assert panels_in(html)[0].outline("band-known") == []
    assert remarks_in(html) == ["standard deviation: 0.02 deg at most, too narrow to be drawn"]
