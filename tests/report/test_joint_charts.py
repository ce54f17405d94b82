"""The charts of the joint's own angles and of an axis that wanders, read back from the page's SVG."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest
from drawn_trials import drawn_trial
from PIL import Image
from read_charts import keys_in, panels_in, picture_in, remarks_in

from elbowscrew.geometry.arrays import Float
from elbowscrew.plots import FIGURES
from elbowscrew.plots.style import AXES, KEYFRAME, MEASURED, MODELED
from elbowscrew.quantities import rounded
from elbowscrew.report.captions import caption_of
from elbowscrew.report.clip import clip_of
from elbowscrew.report.joint_charts import angles_chart, wander_chart
from elbowscrew.view.long_trials import stretch_of


@pytest.mark.parametrize(
    ("kind", "names"),
    [("two axes", ["Angle 1", "Angle 2"]), ("ball", ["Rotation x", "Rotation y", "Rotation z"])],
)
def test_own_angles_over_time(kind: str, names: list[str]) -> None:
    trial = drawn_trial(kind)
    own = trial.joint_angles
    assert own is not None
    # Angles of unlike standard deviation: the band of one is not that of another.
    own = replace(own, angle_sd=np.radians(np.full(own.angle.shape, 1.0) * np.arange(1, own.angle.shape[1] + 1)))
    trial = replace(trial, joint_angles=own)
    html = angles_chart(trial)
    assert html is not None
    over_time, *beside = panels_in(html)
    assert over_time.words == ["Time (s)", "Angles (deg)"]
    told = [key for key in keys_in(html) if key[1] != "fill-lost"]
    assert told == [
        key
        for k, name in enumerate(names)
        for key in (
            ("rect", "band-known", f"95 % interval of {name} (±{1.959964 * (k + 1):.2g} deg)"),
            ("path", f"axis{k + 1}", name),
        )
    ]
    bands = over_time.outline("band-known")
    for k in range(len(names)):
        (points,) = over_time.outline(f"axis{k + 1}")
        angle = np.degrees(own.angle[:, k])
        assert points == pytest.approx(
            np.column_stack([own.time_s, angle]), abs=2.0 * max(over_time.pixel, over_time.x[0])
        )
        assert bands[k][:, 1].max() == pytest.approx(angle.max() + 1.96 * (k + 1), abs=over_time.pixel)
        assert bands[k][:, 1].min() == pytest.approx(angle.min() - 1.96 * (k + 1), abs=over_time.pixel)
    assert len(beside) == (kind == "two axes")


def test_intervals_that_nobody_would_see_are_told_and_not_drawn() -> None:
    trial = drawn_trial("two axes")
    own = trial.joint_angles
    assert own is not None
    narrow = replace(own, angle_sd=np.full(own.angle.shape, [1e-15, 0.1]))
    html = angles_chart(replace(trial, joint_angles=narrow))
    assert html is not None
    labels = remarks_in(html)
    assert labels == [f"95 % interval of Angle 1: ±{rounded(np.degrees(1.959964e-15))} deg, too narrow to be drawn"]
    assert len(panels_in(html)[0].outline("band-known")) == 1
    trial = drawn_trial("wandering")
    path = trial.axis_path
    assert path is not None
    sharp = replace(path, axis_sd=np.full(path.axis_sd.shape, 1e-9), point_sd=np.full(path.point_sd.shape, 0.001))
    html = wander_chart(replace(trial, axis_path=sharp))
    assert html is not None
    half = rounded(np.degrees(1.959964e-9 / np.sqrt(2.0)))
    assert remarks_in(html) == [f"95 % of each tilt: ±{half} deg, too narrow to be drawn"]
    tilts, shifts = panels_in(html)
    assert len(tilts.outline("band-known")) == 0
    assert len(shifts.outline("band-known")) == 2
    assert ("rect", "band-known", "95 % of each") in keys_in(html)
    unknown = replace(path, axis_sd=np.full(path.axis_sd.shape, np.nan), point_sd=np.full(path.point_sd.shape, np.nan))
    html = wander_chart(replace(trial, axis_path=unknown))
    assert html is not None
    assert "95 %" not in html
    millimeters = rounded(1.959964 / np.sqrt(2.0))
    told = f"95 % of each (median): tilt ±{half} deg (too narrow to be drawn), shift ±{millimeters} mm (orange band)."
    assert told in caption_of("axis_path", replace(trial, axis_path=sharp))
    assert "tilt not known, shift not known" in caption_of("axis_path", replace(trial, axis_path=unknown))
    bands = [len(ax.collections) for ax in FIGURES["axis_path"](replace(trial, axis_path=sharp)).axes]
    assert bands == [0, 2]


def test_the_second_angle_against_the_first() -> None:
    trial = drawn_trial("two axes")
    own = trial.joint_angles
    assert own is not None
    angle = own.angle.copy()
    angle[:3] = np.nan
    html = angles_chart(replace(trial, joint_angles=replace(own, angle=angle)))
    assert html is not None
    _, panel = panels_in(html)
    assert panel.words == ["Angle 1 (deg)", "Angle 2 (deg)"]
    (points,) = panel.outline("measured")
    for one, known in zip(points.T, np.degrees(angle[3:].T), strict=True):
        assert [one.min(), one.max()] == pytest.approx([known.min(), known.max()], abs=2.0 * panel.pixel)
    assert panel.root.find("metadata") is None  # one value along has several up: none to tell by pointing
    assert panel.dots("center")[0][:2] == pytest.approx(np.degrees(angle[3]), abs=2.0 * panel.pixel)
    assert picture_in(html)[1].text == "Angle 1, Angle 2 over time; on the right Angle 2 against Angle 1."


def test_of_a_long_recording_both_extremes_of_a_curve_that_comes_back_are_drawn() -> None:
    """Far from the turns of the second angle the first one leaps, for a frame."""
    trial = drawn_trial("two axes")
    own = trial.joint_angles
    assert own is not None
    count = 20_000
    angle = np.radians(np.column_stack([np.sin(np.arange(count)), np.linspace(0.0, 50.0, count)]))
    angle[7_001, 0] = np.radians(40.0)
    shape = (count,)
    longer = replace(
        own, time_s=np.arange(count) / 100.0, frame=np.arange(count), angle=angle, angle_sd=np.full((count, 2), np.nan),
        residual_rotation=np.zeros(shape), residual_translation=np.zeros(shape),
    )  # fmt: skip
    html = angles_chart(replace(trial, joint_angles=longer))
    assert html is not None
    (points,) = panels_in(html)[1].outline("measured")
    assert points[:, 0].max() == pytest.approx(40.0, abs=0.3)
    assert len(points) < 3_000


def test_a_hinge_has_no_chart_of_its_own_and_a_long_trial_one_of_its_stretch() -> None:
    assert angles_chart(drawn_trial("noise-free")) is None
    assert wander_chart(drawn_trial("two axes")) is None
    trial = drawn_trial("long")
    stretch = stretch_of(trial)
    own = trial.joint_angles
    assert stretch is not None
    assert own is not None
    second = replace(own, angle=np.repeat(own.angle[:, :1], 2, axis=1), angle_sd=np.repeat(own.angle_sd[:, :1], 2, 1))
    html = angles_chart(replace(trial, joint_angles=second))
    assert html is not None
    times = np.concatenate(panels_in(html)[0].outline("axis1"))[:, 0]
    assert [times.min(), times.max()] == pytest.approx(trial.time_s[[stretch.first, stretch.end - 1]], abs=0.1)
    assert f"over time, of {stretch.told};" in (picture_in(html)[1].text or "")


def drawn(html: str, number: int) -> tuple[Float, Float]:
    """Angles, and both components (2, K), of a panel."""
    panel = panels_in(html)[number]
    first, second = (panel.outline(look)[0] for look in ("axis1", "axis2"))
    assert first[:, 0] == pytest.approx(second[:, 0])
    return first[:, 0], np.array([first[:, 1], second[:, 1]])


def test_the_axis_against_the_angle() -> None:
    """Tilt and shift, both components together, against the path in the table."""
    trial = drawn_trial("wandering")
    path, mean, point = trial.axis_path, trial.joint_direction, trial.joint_point
    assert path is not None
    html = wander_chart(trial)
    assert html is not None
    tilts, shifts = panels_in(html)
    assert tilts.words == ["Angle (deg)", "Tilt from the mean axis (deg)"]
    assert shifts.words == ["Angle (deg)", "Shift from the mean axis (mm)"]
    angle, parts = drawn(html, 0)
    assert angle == pytest.approx(np.degrees(path.angle), abs=2.0 * abs(tilts.x[0]))
    off = np.degrees(np.arctan(np.linalg.norm(np.tan(np.radians(parts)), axis=0)))
    assert off == pytest.approx(np.degrees(np.arccos(path.direction @ mean)), abs=2.0 * tilts.pixel)
    assert off.max() > 20.0 * tilts.pixel
    along = ((point - path.point) @ mean) / (path.direction @ mean)
    there = path.point + along[:, None] * path.direction
    _, parts = drawn(html, 1)
    far = 1000.0 * np.linalg.norm(there - point, axis=1)
    assert np.linalg.norm(parts, axis=0) == pytest.approx(far, abs=2.0 * shifts.pixel)
    for panel, sd, values in ((tilts, np.degrees(path.axis_sd), off), (shifts, 1000.0 * path.point_sd, far)):
        band = panel.outline("band-known")[0]
        middle = panel.outline("axis1")[0]
        reach = 1.959964 * sd / np.sqrt(2.0)
        assert band[: len(sd), 1] - middle[:, 1] == pytest.approx(-reach, abs=3.0 * panel.pixel)
        assert reach.max() > 0.0
        assert values.size == sd.size
    toward = [label for _, look, label in keys_in(html) if look in ("axis1", "axis2")]
    across = np.argsort(np.abs(mean), kind="stable")[:2]
    assert toward == [f"toward {'xyz'[k]}" for k in sorted(across)]


def test_of_orientations_the_axis_tilts_and_has_no_place() -> None:
    html = wander_chart(replace(drawn_trial("wandering"), located=False))
    assert html is not None
    assert [panel.words[1] for panel in panels_in(html)] == ["Tilt from the mean axis (deg)"]
    assert picture_in(html)[1].text == "Tilt of the joint's axis from its mean."


def test_axes_have_one_color_in_figures_on_the_page_and_in_its_view() -> None:
    page = (resources.files("elbowscrew.report") / "static" / "page.css").read_text()
    colors = [str(look["color"]).lower() for look in AXES]
    light = page[: page.index("@media")]
    assert re.findall(r"--axis[123]: (#[0-9a-f]{6})", light) == colors
    for name, look in (("modeled", MODELED), ("keyframe", KEYFRAME), ("measured", MEASURED)):
        assert f"--{name}: {str(look['color']).lower()};" in light, name
    dark = re.findall(r"--axis[123]: (#[0-9a-f]{6})", page[len(light) :])
    assert len(set(dark)) == 3
    still = np.asarray(Image.open(io.BytesIO(clip_of(drawn_trial("two axes"), ".png"))).convert("RGB")).astype(int)
    for color in colors[:2]:
        wanted = [int(color[k : k + 2], 16) for k in (1, 3, 5)]
        assert (np.abs(still - wanted).max(axis=2) < 3).sum() > 20, color  # the first is seen nearly end-on
