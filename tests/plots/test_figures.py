"""Figures show the numbers they claim to show."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn_trials import elbow_landmarks
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from numpy.typing import NDArray

from elbowscrew import Analysis, Settings, analyze, plots, simulate_trial
from elbowscrew.choices import METHOD_LABELS, METHOD_NAMES
from elbowscrew.plots import comparison, style


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    recording = simulate_trial(frames=120, inversion=60, gaps=2, gap_frames=20, seed=4).recording
    return analyze(recording, Settings(angle_unit="rad", length_unit="m"))


def lines(ax: Axes) -> dict[str, NDArray[np.float64]]:
    return {str(line.get_label()): np.asarray(line.get_ydata()) for line in ax.get_lines()}


def test_theta_shows_measured_modeled_and_keyframes_in_the_units_asked_for(analysis: Analysis) -> None:
    ax = plots.plot_theta(Figure().add_subplot(), analysis)
    drawn = lines(ax)
    assert drawn["measured"] == pytest.approx(analysis.screw.angle, nan_ok=True)
    assert drawn["DLB through 3 poses"] == pytest.approx(analysis.interpolated.angle, nan_ok=True)
    assert drawn["keyframes"] == pytest.approx(analysis.screw.angle[analysis.keyframes.row])
    assert ax.get_ylabel() == "Angle θ (rad)"
    assert ax.get_xlabel() == "Time (s)"


def spans(ax: Axes, color: str) -> list[Any]:
    return [
        np.asarray(path.vertices)[:, 0]
        for collection in ax.collections
        if isinstance(collection, PolyCollection) and np.all(collection.get_facecolor() == np.array(to_rgba(color)))
        for path in collection.get_paths()
    ]


def shaded(found: list[Any], time_s: NDArray[np.float64]) -> NDArray[np.bool_]:
    inside = np.zeros(time_s.size, dtype=bool)
    for times in found:
        inside |= (time_s > times.min() - 1e-9) & (time_s < times.max() + 1e-9)
    return inside


def test_lost_frames_and_movements_are_shaded(analysis: Analysis) -> None:
    ax = plots.plot_euler_parameter(Figure().add_subplot(), analysis, 0)
    lost = spans(ax, style.LOST["color"])
    assert (shaded(lost, analysis.screw.time_s) == ~analysis.screw.valid).all()
    theta = plots.plot_theta(Figure().add_subplot(), analysis)
    moving = spans(theta, style.MOVING["color"])
    assert len(moving) == analysis.phases.onset_rows.size > 0
    assert (shaded(moving, analysis.screw.time_s) == analysis.phases.moving).all()


def test_the_band_of_the_angle_is_its_95_percent_interval_where_it_can_be_seen() -> None:
    recording = simulate_trial(frames=120, inversion=60).recording
    exact = plots.plot_theta(Figure().add_subplot(), analyze(recording, Settings(marker_noise_mm=0.1)))
    assert "95 % interval" not in exact.get_legend_handles_labels()[1]
    analysis = analyze(recording, Settings(marker_noise_mm=2.0))
    ax = plots.plot_theta(Figure().add_subplot(), analysis)
    (band,) = (one for one in ax.collections if one.get_label() == "95 % interval")
    path = np.asarray(band.get_paths()[0].vertices)
    row = 60
    there = path[np.abs(path[:, 0] - analysis.screw.time_s[row]) < 1e-9, 1]
    reach = np.degrees(1.959964 * analysis.screw.angle_sd[row])
    assert np.ptp(there) == pytest.approx(2.0 * reach)


@pytest.mark.parametrize("single", [True, False])
def test_the_joints_axis_is_drawn_with_its_cone_or_without(analysis: Analysis, single: bool) -> None:
    axis = replace(analysis.joint_axis, single=single)
    if not single:
        axis = replace(axis, hinge=None, screw_hinge=None)
    shown = replace(analysis, joint_axis=axis)
    end_on = plots.plot_axis_end_on(Figure().add_subplot(), shown)
    side = plots.plot_axis_from_the_side(Figure().add_subplot(), shown, 0)
    assert len(end_on.patches) == (2 if single else 1)
    labels = side.get_legend_handles_labels()[1]
    assert ("95 % confidence of the joint axis" in labels) == single
    assert side.get_xlabel().startswith(f"Along the {'joint' if single else 'mean'} axis (")
    best = analysis.joint_axis.best
    if single and best is not None:
        circle: Any = end_on.patches[1]
        assert circle.radius == pytest.approx(best.point_radius)


def test_errors_and_euler_parameters(analysis: Analysis) -> None:
    angle = plots.plot_angle_error(Figure().add_subplot(), analysis)
    assert lines(angle)["model against measurement"] == pytest.approx(analysis.interpolated.angle_error, nan_ok=True)
    displacement = plots.plot_rms_displacement(Figure().add_subplot(), analysis)
    assert displacement.get_ylabel() == "RMS displacement (m)"
    third = plots.plot_euler_parameter(Figure().add_subplot(), analysis, 3)
    assert lines(third)["measured"] == pytest.approx(analysis.screw.euler_parameters[:, 3], nan_ok=True)


def test_tilts_are_the_angles_to_the_mean_axis(analysis: Analysis) -> None:
    ax = plots.plot_axis_directions(Figure().add_subplot(), analysis)
    offsets = np.asarray(ax.collections[0].get_offsets())
    directions = analysis.screw.axis_direction[analysis.screw.axis_known]
    expected = np.arccos(np.clip(directions @ analysis.mean_axis.direction, -1, 1))
    assert np.hypot(*offsets.T) == pytest.approx(expected, abs=4e-5)
    assert ax.get_xlabel().endswith("(rad)")


def test_places_of_axes_that_are_one_line_are_at_the_mean() -> None:
    exact = analyze(simulate_trial(marker_noise_mm=0.0, frames=60, inversion=30).recording)
    ax = plots.plot_axis_positions(Figure().add_subplot(), exact)
    assert np.abs(np.asarray(ax.collections[0].get_offsets())).max() < 1e-6


@pytest.mark.parametrize("name", plots.FIGURES)
@pytest.mark.parametrize("express_in", ["distal", "proximal", "lab"])
def test_every_axes_of_every_figure_has_labels_with_units(name: str, express_in: Any) -> None:
    wander = {"joint_type": "hinge", "wander_deg": 12.0} if name == "axis_path" else {}
    recording = simulate_trial(frames=80, inversion=40, gaps=1, **wander).recording  # type: ignore[arg-type]
    landmarks = elbow_landmarks() if name == "anatomy" else None
    figure = plots.FIGURES[name](analyze(recording, Settings(express_in=express_in), landmarks=landmarks))
    figure.draw_without_rendering()
    labels = [ax.get_ylabel() for ax in figure.axes if ax.get_ylabel()] + [
        ax.get_xlabel() for ax in figure.axes if ax.get_xlabel()
    ]
    assert labels
    assert all("(" in label and label.endswith(")") for label in labels)


def test_every_method_has_its_label_and_its_kind_between_two_poses() -> None:
    assert set(METHOD_LABELS) == set(METHOD_NAMES) == set(comparison._BETWEEN_TWO)
