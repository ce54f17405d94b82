"""Figures show the numbers they claim to show."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from drawn_trials import elbow_landmarks
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

from elbowscrew import Analysis, Settings, analyze, plots, simulate_trial
from elbowscrew.choices import METHOD_LABELS, METHOD_NAMES
from elbowscrew.model import Selection
from elbowscrew.plots import comparison, style
from elbowscrew.plots.joint import confidence_text
from elbowscrew.results.trial_views import view_of


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


def zorders(ax: Axes) -> dict[str, float]:
    return {str(one.get_label()): one.get_zorder() for one in ax.collections}


@pytest.mark.parametrize(("known", "behind"), [(0.01, "95 % of the frames' axes"), (0.4, "95 % confidence")])
def test_the_wider_of_two_regions_is_drawn_behind_the_other(analysis: Analysis, known: float, behind: str) -> None:
    view = replace(view_of(analysis), spread95=(0.1, 0.02), confidence95=(known, 0.05 * known))
    side = zorders(plots.plot_axis_from_the_side(Figure().add_subplot(), view, 0))
    drawn = {label: order for label, order in side.items() if label.startswith("95 %")}
    assert min(drawn, key=lambda label: drawn[label]).startswith(behind)
    circles = [one for one in plots.plot_axis_end_on(Figure().add_subplot(), view).patches if isinstance(one, Circle)]
    assert [one.zorder for one in sorted(circles, key=lambda one: -one.radius)] == sorted(one.zorder for one in circles)


def test_a_cone_is_drawn_in_space_where_it_can_be_told_from_the_axis_and_stays_in_the_box(analysis: Analysis) -> None:
    for angle, drawn in ((0.003, False), (0.2, True), (1.2, False)):
        view = replace(view_of(analysis), spread95=(np.nan, np.nan), confidence95=(angle, 1e-4))
        ax = plots.plot_joint_axis_in_space(new_space(), view)
        told = [str(one.get_label()) for one in ax.collections]
        assert ("95 % confidence of the joint axis" in told) == drawn, angle
        (axis,) = (one for one in ax.get_lines() if one.get_label() == "joint axis")
        assert axis.get_zorder() > 2.0 + len(ax.collections) + 10


def test_the_axes_of_the_frames_lie_in_the_box(analysis: Analysis) -> None:
    view = view_of(analysis)
    away = replace(view, axis_point=view.axis_point + np.array([0.0, 0.0, 0.4]))
    ax = plots.plot_joint_axis_in_space(new_space(), away)
    segments = np.asarray(ax.collections[0]._segments3d)
    for k, limits in enumerate((ax.get_xlim(), ax.get_ylim(), ax.get_zlim())):
        assert segments[..., k].min() >= limits[0] - 1e-9
        assert segments[..., k].max() <= limits[1] + 1e-9


def new_space() -> Axes3D:
    return cast(Axes3D, Figure().add_subplot(projection="3d"))


def test_selections_are_explained_where_the_first_trial_has_none() -> None:
    selection = Selection(
        row=np.array([0, 3, 6, 10]),
        count=np.array([2, 3, 4]),
        largest=np.array([0.01, 0.004, 0.001]),
        rms=np.array([0.01, 0.004, 0.001]),
        frames=11,
        tolerance=0.002,
        as_angle=False,
        complete=True,
    )
    ax = comparison.plot_selections(Figure().add_subplot(), [{}, {"dlb": selection}], Settings())
    assert [one.get_text() for one in ax.texts] == ["tolerance 2 mm"]
    assert ax.get_legend() is not None


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


def test_small_lengths_are_written_with_a_power_of_ten(analysis: Analysis) -> None:
    told = confidence_text(replace(view_of(analysis), confidence95=(7e-4, 5.5e-5)))
    assert told.endswith("95 % confidence: 0.0007 rad, 5.5·10⁻⁵ m")
