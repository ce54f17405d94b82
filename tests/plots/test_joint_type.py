"""The joint's own figures show its axes where the motion carries them, its angles, and what they are known to."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from elbowscrew import Analysis, Settings, analyze, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.quaternion import rotate
from elbowscrew.model.joint_type import Measure
from elbowscrew.plots import joint_angles
from elbowscrew.plots import joint_type as drawing
from elbowscrew.results.trial_views import view_of
from elbowscrew.view.figure_names import has_figure
from elbowscrew.view.joint_space import carried, joint_in_body

SHORT: dict[str, Any] = {"frames": 120, "inversion": 60, "proximal": "moving", "seed": 4}


@pytest.fixture(scope="module")
def elbow() -> Analysis:
    return analyze(simulate_trial(**SHORT, joint_type="two-axes").recording)


@pytest.fixture(scope="module")
def hip() -> Analysis:
    return analyze(simulate_trial(**SHORT, joint_type="ball", joint="hip", top_deg=70.0).recording)


@pytest.fixture(scope="module")
def wandering() -> Analysis:
    trial = simulate_trial(**SHORT, joint_type="hinge", wander_deg=12.0)
    return analyze(trial.recording, Settings(express_in="proximal"))


def labels(ax: Axes) -> dict[str, Any]:
    return {str(line.get_label()): np.asarray(line.get_ydata()) for line in ax.get_lines()}


def test_each_body_sees_the_other_axis_where_the_motion_carries_it() -> None:
    """Axis 2 is fixed in the distal body, whose measured pose says where it is in the proximal one, and back."""
    elbow = analyze(simulate_trial(**SHORT, joint_type="two-axes", marker_noise_mm=0.0).recording)
    assert elbow.joint_angles is not None
    assert elbow.joint_type is not None
    two = elbow.joint_type.two_axes
    assert two is not None
    rows = np.arange(0, 120, 7)
    pose = elbow.joint.dual_quat_proximal_distal[rows]
    quat = dq.pose_from_dual_quat(pose)[0]
    proximal, distal = (joint_in_body(view_of(elbow), end) for end in ("proximal", "distal"))
    places = carried(proximal.axes[1], proximal.axes[0], elbow.joint_angles.angle[rows, 0])
    assert places[:, 0] == pytest.approx(rotate(quat, two.axis2.direction_distal), abs=1e-5)
    assert places[:, 1] == pytest.approx(dq.transform_points(pose, two.axis2.point_distal), abs=1e-6)
    back = dq.conjugate(pose)
    places = carried(distal.axes[0], distal.axes[1], -elbow.joint_angles.angle[rows, 1])
    assert places[:, 0] == pytest.approx(
        rotate(dq.pose_from_dual_quat(back)[0], two.axis1.direction_proximal), abs=0.01
    )
    assert places[:, 1] == pytest.approx(dq.transform_points(back, two.axis1.point_proximal), abs=1e-6)


def test_the_title_says_how_far_apart_the_axes_are(elbow: Analysis) -> None:
    assert elbow.joint_type is not None
    two = elbow.joint_type.two_axes
    assert two is not None
    assert two.distance is not None
    text = drawing.joint_text(elbow)
    assert text.startswith("Joint: two axes (determined), ")
    assert text.endswith(
        f"{np.degrees(two.angle_between.value):.3g} deg and {1000 * abs(two.distance.value):.3g} mm apart"
    )


def test_parallel_axes_have_a_distance_and_no_angle(elbow: Analysis) -> None:
    assert elbow.joint_type is not None
    assert elbow.joint_type.two_axes is not None
    parallel = replace(elbow.joint_type.two_axes, distance=None, offset=Measure(value=0.0321, sd=1e-4))
    text = drawing.joint_text(replace(elbow, joint_type=replace(elbow.joint_type, two_axes=parallel)))
    assert text == "Joint: two axes (determined), parallel, 32.1 mm apart"


def test_the_band_of_an_axis_is_what_holds_95_percent(elbow: Analysis) -> None:
    assert elbow.joint_type is not None
    two = elbow.joint_type.two_axes
    assert two is not None
    for k, end in enumerate(("proximal", "distal")):
        body = joint_in_body(view_of(elbow), end)  # type: ignore[arg-type]
        ax = drawing.plot_axis_known(Figure().add_subplot(), elbow, body, k)
        corners = np.asarray(ax.collections[0].get_paths()[0].vertices)
        known = two.lines[k]
        assert np.abs(corners[:, 1]).min() == pytest.approx(1000.0 * known.point_radius)
        reach = np.hypot(known.point_radius, np.tan(known.axis_cone) * body.half)
        assert np.abs(corners[:, 1]).max() == pytest.approx(1000.0 * reach)
        (text,) = (one.get_text() for one in ax.texts)
        assert text == f"95 %: {np.degrees(known.axis_cone):.2g} deg\n{1000.0 * known.point_radius:.2g} mm"


def test_an_axis_that_is_not_determined_has_no_band(elbow: Analysis) -> None:
    body = joint_in_body(view_of(elbow), "proximal")
    unsure = body._replace(axes=(body.axes[0]._replace(known=None), body.axes[1]))
    ax = drawing.plot_axis_known(Figure().add_subplot(), elbow, unsure, 0)
    assert not ax.collections
    assert [one.get_text() for one in ax.texts] == ["not determined"]


def test_the_outline_of_the_center_is_the_shadow_of_its_ellipsoid(hip: Analysis) -> None:
    """The widest of a direction n on an ellipsoid with covariance C is k sqrt(n C n), one k for all directions."""
    assert hip.joint_type is not None
    assert hip.joint_type.ball is not None
    C = hip.joint_type.ball.covariance[:3, :3]
    sizes = []
    for side, axes in enumerate(((0, 1), (0, 2))):
        ax = drawing.plot_center(Figure().add_subplot(), hip, joint_in_body(view_of(hip), "proximal"), side)
        outline = np.asarray(ax.patches[0].get_path().vertices)
        sizes += [outline[:, k].max() / np.sqrt(C[axis, axis]) for k, axis in enumerate(axes)]
    assert sizes == pytest.approx([sizes[0]] * 4, rel=3e-3)


def test_an_ellipsoid_of_a_center_known_alike_in_all_directions_is_the_ball_of_its_radius(hip: Analysis) -> None:
    assert hip.joint_type is not None
    assert hip.joint_type.ball is not None
    covariance = np.eye(6) * 3e-7
    alike = replace(hip.joint_type.ball, covariance=covariance, radius=0.004)
    assert np.linalg.norm(alike.semi_axes, axis=1) == pytest.approx([0.004] * 3)
    # Of one direction alone it is longer than the radius, as 95 % of one error lie within 1.96 and of three in 2.795.
    covariance = np.diag([1e-6, 1e-18, 1e-18, 1.0, 1.0, 1.0])
    alone = replace(hip.joint_type.ball, covariance=covariance, radius=1.959964e-3)
    assert np.linalg.norm(alone.semi_axes, axis=1).max() == pytest.approx(2.795483e-3, rel=1e-6)


def test_the_ellipsoid_turns_with_the_body_that_sees_it(hip: Analysis) -> None:
    proximal, distal = (joint_in_body(view_of(hip), end).semi_axes for end in ("proximal", "distal"))
    assert proximal is not None
    assert distal is not None
    turn = dq.pose_from_dual_quat(hip.joint.reference)[0]
    assert rotate(turn, distal) == pytest.approx(proximal)


def test_angles_over_time_and_against_each_other(elbow: Analysis) -> None:
    found = elbow.joint_angles
    assert found is not None
    figure = joint_angles.joint_angles_figure(elbow)
    first, rotation, translation, together = figure.axes
    drawn = labels(first)
    for k in range(2):
        assert drawn[f"Angle {k + 1}"] == pytest.approx(np.degrees(found.angle[:, k]))
    assert labels(rotation)["of each frame"] == pytest.approx(np.degrees(found.residual_rotation))
    assert labels(translation)["of each frame"] == pytest.approx(1000.0 * found.residual_translation)
    line = together.get_lines()[0]
    assert np.asarray(line.get_xdata()) == pytest.approx(np.degrees(found.angle[:, 0]))
    assert np.asarray(line.get_ydata()) == pytest.approx(np.degrees(found.angle[:, 1]))


def test_an_axis_that_wanders_is_drawn_against_the_angle(wandering: Analysis) -> None:
    path, mean = wandering.joint_axis.path, wandering.joint_axis.mean_axis
    assert path is not None
    assert mean is not None
    tilts, shifts = joint_angles.axis_path_figure(wandering).axes
    two = [np.asarray(line.get_ydata()) for line in tilts.get_lines()[:2]]
    away = np.degrees(np.arccos(np.clip(path.direction @ mean.line.direction, -1.0, 1.0)))
    assert np.hypot(*np.tan(np.radians(two))) == pytest.approx(np.tan(np.radians(away)), abs=1e-6)
    assert np.asarray(tilts.get_lines()[0].get_xdata()) == pytest.approx(np.degrees(path.angle))
    assert away.max() > 3.0
    # A shift is where the axis meets the plane across the mean axis.
    for k, point in enumerate(path.point):
        along = ((mean.line.point - point) @ mean.line.direction) / (path.direction[k] @ mean.line.direction)
        far = 1000.0 * np.linalg.norm(point + along * path.direction[k] - mean.line.point)
        drawn = [np.asarray(line.get_ydata())[k] for line in shifts.get_lines()[:2]]
        assert np.hypot(*drawn) == pytest.approx(far, abs=1e-6)


def test_figures_are_there_where_the_joint_has_what_they_show(
    elbow: Analysis, hip: Analysis, wandering: Analysis
) -> None:
    rigid = analyze(simulate_trial(**SHORT).recording, Settings(joint_type="rigid"))
    names = ("joint", "joint_angles", "axis_path")
    there = {
        which: [name for name in names if has_figure(name, view_of(one))]
        for which, one in {"elbow": elbow, "hip": hip, "wandering": wandering, "rigid": rigid}.items()
    }
    assert there == {
        "elbow": ["joint", "joint_angles"],
        "hip": ["joint", "joint_angles"],
        "wandering": ["joint", "joint_angles", "axis_path"],
        "rigid": ["joint"],
    }
    assert drawing.joint_text(rigid) == "Joint: a rigid joint (as stated)"
    for missing, draw in ((rigid, joint_angles.joint_angles_figure), (elbow, joint_angles.axis_path_figure)):
        with pytest.raises(ValueError, match=r"no wander|no angles"):
            draw(missing)
