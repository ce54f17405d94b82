"""Figures of slide, velocity, cycles, anatomy and quality show the numbers of the analysis, in the units asked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn_trials import drawn_trial, elbow_landmarks
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from elbowscrew import Analysis, Settings, analyze, simulate_trial
from elbowscrew.plots import FIGURES, anatomy, cycles, kinematics, quality
from elbowscrew.plots.axis import with_instantaneous_axes
from elbowscrew.plots.panels import panels_of
from elbowscrew.plots.series import plot_overview
from elbowscrew.report.captions import caption_of
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.long_trials import Stretch

Drawn = NDArray[np.float64]


@pytest.fixture(scope="module")
def trial() -> Analysis:
    recording = simulate_trial(frames=150, inversion=70, repetitions=3, gaps=2, gap_frames=15, seed=4).recording
    settings = Settings(angle_unit="rad", length_unit="m", marker_noise_mm=0.5)
    return analyze(recording, settings, landmarks=elbow_landmarks())


def line(ax: Axes, label: str) -> tuple[Drawn, Drawn]:
    (found,) = (one for one in ax.get_lines() if one.get_label() == label)
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def test_the_slide_is_drawn_against_the_angle_with_its_interval(trial: Analysis) -> None:
    screw = trial.screw
    ax = kinematics.plot_slide(Figure().add_subplot(), trial)
    x, y = line(ax, "measured")
    assert x == pytest.approx(screw.angle, nan_ok=True)
    assert y == pytest.approx(screw.slide, nan_ok=True)
    (band,) = (one for one in ax.collections if one.get_label() == "95 % interval")
    assert isinstance(band, PolyCollection)
    sides = np.array([-1.0, 1.0])[:, None] * 1.959964 * screw.slide_sd + screw.slide
    drawn = []
    for path in band.get_paths():
        outline = np.asarray(path.vertices)[:-1]  # which comes back to its first corner
        low, high = outline[: len(outline) // 2], outline[: len(outline) // 2 - 1 : -1]
        rows = np.flatnonzero(np.isin(screw.angle, low[:, 0]))
        assert (np.diff(rows) == 1).all()
        assert (np.diff(low[:, 0]) > 0.0).all() or (np.diff(low[:, 0]) < 0.0).all()
        assert np.stack([low, high]) == pytest.approx(np.stack([np.tile(screw.angle[rows], (2, 1)), sides[:, rows]], 2))
        drawn += rows[:-1].tolist()
    known = np.flatnonzero(np.isfinite(screw.slide[:-1] + screw.slide[1:]))
    assert drawn == known.tolist()  # what lies between each two frames once, and nothing over a gap
    assert len(band.get_paths()) < 0.2 * known.size


def test_the_slope_of_a_screw_hinge_is_its_pitch() -> None:
    found = analyze(simulate_trial(frames=150, inversion=70, marker_noise_mm=0.05, slide_mm=9.0).recording)
    x, y = line(kinematics.plot_slide(Figure().add_subplot(), found), "slope of the screw-hinge")
    assert np.ptp(y) / np.radians(np.ptp(x)) == pytest.approx(9.0 / np.radians(130.0), rel=0.01)
    slide = found.screw.slide
    off = np.interp(np.degrees(found.screw.angle), x, y) - 1000.0 * slide
    assert np.nanmedian(off) == pytest.approx(0.0, abs=0.02)


def test_of_a_long_trial_the_slides_medians_are_drawn() -> None:
    view = drawn_trial("long")
    ax = kinematics.plot_slide_span(Figure().add_subplot(), view)
    rising, falling = line(ax, "median, angle rising"), line(ax, "median, angle falling")
    # A screw-hinge slides 3 mm over 130 deg, on the same line out and back.
    for x, y in (rising, falling):
        slope = np.polyfit(x[np.isfinite(y)], y[np.isfinite(y)], 1)[0]
        assert 130.0 * slope == pytest.approx(3.0, abs=0.1)
    assert np.nanmax(np.abs(rising[1] - falling[1])) < 0.4
    (band,) = (one for one in ax.collections if one.get_label() == "90 % of the frames")
    corners = np.asarray(band.get_paths()[0].vertices)
    near = np.abs(view.angle - np.radians(rising[0][30])) < np.radians(1.0)
    middle = corners[np.abs(corners[:, 0] - rising[0][30]) < 1e-9, 1]
    inside = (1000.0 * view.slide[near] > middle.min()) & (1000.0 * view.slide[near] < middle.max())
    assert inside.mean() == pytest.approx(0.9, abs=0.03)


def test_of_fast_cycles_the_medians_have_no_holes() -> None:
    """Cycles of 40 frames that are all at the same angles: in the middle these are 10 deg apart."""
    view = drawn_trial("long")
    time = np.arange(view.frame.size)
    angle = np.radians(65.0) * (1.0 - np.cos(2.0 * np.pi * time / 40.0))
    ax = kinematics.plot_slide_span(Figure().add_subplot(), replace(view, angle=angle, slide=0.001 * np.sin(angle)))
    for label in ("median, angle rising", "median, angle falling"):
        assert np.isfinite(line(ax, label)[1]).all(), label


def test_the_band_of_slides_is_drawn_where_frames_go_both_ways() -> None:
    """Every cycle rises to 120 deg by steps, and falls from there at once to 60 deg."""
    view = drawn_trial("long")
    time = np.arange(view.frame.size)
    share = time % 400 / 400.0
    high = np.where(share < 0.75, 60.0 + 80.0 * share, 120.0)
    low = 60.0 * np.where(share < 0.9, (0.9 - share) / 0.15, (share - 0.9) / 0.1)
    angle = np.radians(np.where(share < 0.75, high, low))
    ax = kinematics.plot_slide_span(Figure().add_subplot(), replace(view, angle=angle, slide=0.001 * np.sin(time)))
    (band,) = (one for one in ax.collections if one.get_label() == "90 % of the frames")
    there = np.concatenate([np.asarray(path.vertices)[:, 0] for path in band.get_paths()])
    assert not ((there > 65.0) & (there < 115.0)).any()  # at the top itself frames turn back
    assert (there < 60.0).any()
    assert np.isfinite(line(ax, "median, angle rising")[1][-5:]).all()


def test_velocities_over_time(trial: Analysis) -> None:
    moving = trial.instantaneous
    turning = kinematics.plot_angular_velocity(Figure().add_subplot(), trial)
    assert line(turning, "measured, filtered")[1] == pytest.approx(moving.angular_velocity, nan_ok=True)
    assert turning.get_ylabel() == "Angular velocity (rad/s)"
    sliding = kinematics.plot_slide_velocity(Figure().add_subplot(), trial)
    assert line(sliding, "measured, filtered")[1] == pytest.approx(moving.slide_velocity, nan_ok=True)


def test_the_mean_of_the_instantaneous_axes_of_a_hinge_is_its_axis() -> None:
    made = simulate_trial(frames=200, inversion=90, joint_type="hinge", marker_noise_mm=0.0)
    mean = with_instantaneous_axes(view_of(analyze(made.recording)))
    truth: Any = made.truth["axis"]["distal"]
    direction, point = np.array(truth["direction"]), 0.001 * np.array(truth["point_mm"])
    assert abs(mean.mean_direction @ direction) == pytest.approx(1.0, abs=1e-9)
    away = mean.mean_point - point
    assert away - (away @ direction) * direction == pytest.approx(np.zeros(3), abs=1e-5)


def test_cycles_with_their_mean_and_deviation(trial: Analysis) -> None:
    curves = trial.cycle_curves.angle.reshape(-1, 101)
    ax = cycles.plot_cycles(Figure().add_subplot(), trial)
    assert line(ax, f"mean of {len(curves)} cycles")[1] == pytest.approx(trial.repeatability.mean, nan_ok=True)
    assert len(ax.get_lines()) == 1  # it would hide the cycles
    assert not ax.collections  # and its deviation is too narrow to be seen
    view = view_of(trial)
    apart = view.extra["cycles"]["angle"] + 0.1 * (view.extra["cycles"]["cycle"] == 1)
    spread = replace(view, extra={**view.extra, "cycles": {**view.extra["cycles"], "angle": apart}})
    ax = cycles.plot_cycles(Figure().add_subplot(), spread)
    drawn = [np.asarray(one.get_ydata()) for one in ax.get_lines()[: len(curves)]]
    assert np.array(drawn) == pytest.approx(apart.reshape(-1, 101), nan_ok=True)
    assert line(ax, "mean")[1] == pytest.approx(trial.repeatability.mean, nan_ok=True)
    assert view.repetition_curve is not None
    wide = replace(view, repetition_curve={**view.repetition_curve, "theta_sd": np.full(101, 0.2)})
    (band,) = cycles.plot_cycles(Figure().add_subplot(), wide).collections
    vertices = np.asarray(band.get_paths()[0].vertices)
    middle = vertices[np.abs(vertices[:, 0] - 30.0) < 1e-9, 1]
    assert np.ptp(middle) == pytest.approx(0.4)


def test_anatomical_angles_over_time_and_against_flexion(trial: Analysis) -> None:
    found = trial.anatomy
    assert found is not None
    for name in ("flexion", "carrying_angle", "pronation"):
        ax = anatomy.plot_anatomical_angle(Figure().add_subplot(), trial, name)
        assert line(ax, "measured")[1] == pytest.approx(getattr(found, name), nan_ok=True)
    x, y = line(anatomy.plot_against_flexion(Figure().add_subplot(), trial, "pronation"), "measured")
    assert x == pytest.approx(found.flexion, nan_ok=True)
    assert y == pytest.approx(found.pronation, nan_ok=True)


def test_losses_are_drawn_where_frames_were_lost(trial: Analysis) -> None:
    ax = quality.plot_losses(Figure().add_subplot(), trial)
    rows = [label.get_text() for label in ax.get_yticklabels()]
    assert rows == ["upper arm:\nnone lost", "forearm:\nblank"]
    assert not ax.collections[0].get_paths()
    spans = [np.asarray(path.vertices)[:, 0] for path in ax.collections[1].get_paths()]
    time_s = trial.screw.time_s
    drawn = np.any([(time_s > span.min()) & (time_s < span.max()) for span in spans], axis=0)
    assert (drawn == (trial.screw.distal_loss == "blank")).all()
    assert drawn.sum() == 30
    sd = quality.plot_angle_sd(Figure().add_subplot(), trial)
    largest = np.nanmax(trial.screw.angle_sd)
    assert sd.get_ylim() == pytest.approx((0.0, 1.08 * largest))  # clear of the edge, also where all are alike
    assert line(sd, "of each frame")[1] == pytest.approx(trial.screw.angle_sd, nan_ok=True)


@pytest.mark.parametrize("frames", [2000, 2001])
def test_what_jumps_from_frame_to_frame_is_no_solid_block(frames: int) -> None:
    long = view_of(analyze(simulate_trial(frames=frames, inversion=900).recording))
    for figure in ("quality", "joint_angles"):
        labels = {label for ax in FIGURES[figure](long).axes for label in ax.get_legend_handles_labels()[1]}
        assert ("of each frame" in labels) == (frames == 2000)
        assert ("median of each part" in labels) == (frames == 2001)
        told = "black: median, and grey: range of each part" in caption_of(figure, long).lower()
        assert told == (frames == 2001)


def test_the_quality_has_a_panel_for_all_that_is_known(trial: Analysis) -> None:
    turning = drawn_trial("orientations")
    assert len(panels_of("quality", turning)) == len(FIGURES["quality"](turning).axes)
    assert len(FIGURES["quality"](trial).axes) == 4
    assert [ax.get_ylabel() for ax in FIGURES["quality"](drawn_trial("orientations")).axes[1:]] == [
        "Residual\nrotation (deg)"
    ]


@pytest.mark.parametrize(("share", "curves"), [(0.05, 0), (0.2, 1)])
def test_a_short_stretch_of_a_long_trial_is_marked_and_not_blackened(share: float, curves: int) -> None:
    view = drawn_trial("long")
    ax = plot_overview(Figure().add_subplot(), view, Stretch(100, 100 + round(share * view.frame.size), ""))
    assert len(ax.get_lines()) == curves


def test_the_slope_stands_out_from_noise(trial: Analysis) -> None:
    """A wider white line lies between it and the curve."""
    lines = kinematics.plot_slide(Figure().add_subplot(), trial).get_lines()
    labels = [one.get_label() for one in lines]
    slope = labels.index("slope of the screw-hinge")
    under = lines[slope - 1]
    assert labels.index("measured") < slope - 1
    assert under.get_color() == "white"
    assert under.get_linewidth() > 2.0 * lines[slope].get_linewidth()
    assert np.asarray(under.get_xydata()) == pytest.approx(np.asarray(lines[slope].get_xydata()))
