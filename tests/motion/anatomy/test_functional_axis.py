"""The axis against the epicondyles: its limits are what its errors make of them, in whatever frame it is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from elbowscrew import Settings, analyze, simulate_trial
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.lines import angle_of_lines
from elbowscrew.geometry.sensitivity import NORMAL_95, confidence_radius
from elbowscrew.model.anatomy import AnatomicalMotion, Landmark, Landmarks
from elbowscrew.motion.joint.estimates import ProximalErrors
from elbowscrew.motion.joint.lines import Z_LINE, line_pose, line_twist
from elbowscrew.simulate import SimulatedTrial

EXPRESSED = ("distal", "proximal", "lab")


class Known:
    """In the place of an interval: numbers whose covariance is known."""

    def __init__(self, covariance: Float) -> None:
        self.covariance = covariance

    def radius(self, rows: Float) -> float:
        return float(confidence_radius(rows @ self.covariance @ rows.T))


@pytest.mark.parametrize("seed", range(3))
def test_reach_is_what_errors_of_the_line_make_of_angle_and_distance(seed: int) -> None:
    """The line is moved 20,000 times: one way is the angle's own spread, the circle what the line may do at all."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4)) * np.array([2e-3, 2e-3, 4e-4, 4e-4])[:, None]
    pose = line_pose(rng.normal(size=3), rng.normal(scale=0.1, size=3))
    shared = np.eye(4)
    errors = ProximalErrors(Known(root @ root.T), shared[:2], shared[2:], pose)  # type: ignore[arg-type]
    step = rng.normal(size=(20_000, 4)) @ root.T
    moved = dq.transform_lines(dq.multiply(pose, dq.exp(line_twist(step))), Z_LINE)
    direction = dq.transform_lines(pose, Z_LINE)[:3] + 0.3 * rng.normal(size=3)
    direction = direction / np.linalg.norm(direction)
    point = dq.pose_from_dual_quat(pose)[1] + rng.normal(scale=0.05, size=3)

    def distance(lines: Float) -> Float:
        return np.asarray(np.linalg.norm(lines[..., 3:] - np.cross(point, lines[..., :3]), axis=-1))

    line = dq.transform_lines(pose, Z_LINE)
    for found, reach in (
        (angle_of_lines(moved, direction) - angle_of_lines(line, direction), errors.towards_direction(direction)),
        (distance(moved) - distance(line), errors.towards_point(point)),
    ):
        assert NORMAL_95 * found.std() == pytest.approx(reach.along, rel=0.03)
        assert reach.along <= reach.circle * (1.0 + 1e-9)
    tilt = np.arccos(np.clip(moved[:, :3] @ line[:3], -1.0, 1.0))
    assert np.mean(tilt <= errors.towards_direction(direction).circle) == pytest.approx(0.95, abs=0.006)


def landmarks_beside(trial: SimulatedTrial, tilt_deg: float, aside_mm: float, name: str = "axis") -> Landmarks:
    """Epicondyles whose line is off the trial's first axis by so much, in the arm."""
    line = trial.truth["axis"] if name == "axis" else trial.truth["two_axes"]["axis1"]
    h, p = (np.array(line["proximal"][key]) for key in ("direction", "point_mm"))
    across = np.cross(h, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    middle = 1e-3 * (p + aside_mm * np.cross(h, across))
    tilt = np.radians(tilt_deg)
    half = 0.035 * (np.cos(tilt) * h + np.sin(tilt) * across)
    down = np.array([0.0, -0.25, 0.0])
    points = {"EL": middle + half, "EM": middle - half, "GH": middle - down, "US": middle + down}
    points["RS"] = points["US"] + half
    marks: dict[str, Any] = {mark: Landmark(point=point, frame="proximal") for mark, point in points.items()}
    return Landmarks(side="right", **marks)


def anatomy_of(trial: SimulatedTrial, landmarks: Landmarks, **settings: Any) -> AnatomicalMotion:
    found = analyze(trial.recording, Settings(**settings), landmarks=landmarks).anatomy
    assert found is not None
    return found


@pytest.mark.parametrize("wander_deg", [0.0, 10.0])
def test_limits_do_not_hang_on_the_frame_that_screws_are_expressed_in(wander_deg: float) -> None:
    trial = simulate_trial(
        frames=120, inversion=60, proximal="moving", joint_type="hinge", wander_deg=wander_deg, marker_noise_mm=0.3
    )
    landmarks = landmarks_beside(trial, 8.0, 5.0)
    one, *others = (anatomy_of(trial, landmarks, express_in=frame) for frame in EXPRESSED)
    for limits in (one.functional_axis_angle, one.functional_axis_distance):
        assert 0.0 < limits.low < limits.value < limits.high
    for other in others:
        assert other.functional_axis_angle == pytest.approx(one.functional_axis_angle, rel=1e-6)
        assert other.functional_axis_distance == pytest.approx(one.functional_axis_distance, rel=1e-6)
    if not wander_deg:
        assert one.functional_axis_angle.low <= np.radians(8.0) <= one.functional_axis_angle.high
        assert one.functional_axis_distance.low <= 0.005 <= one.functional_axis_distance.high


def test_an_axis_that_may_be_the_line_itself_has_no_lower_limit() -> None:
    trial = simulate_trial(frames=100, inversion=50, joint_type="hinge", marker_noise_mm=0.5, seed=4)
    found = anatomy_of(trial, landmarks_beside(trial, 0.0, 0.0))
    for limits in (found.functional_axis_angle, found.functional_axis_distance):
        assert limits.low == 0.0 < limits.value < limits.high


def test_stated_skin_motion_is_in_the_limits() -> None:
    trial = simulate_trial(frames=100, inversion=50, joint_type="hinge", marker_noise_mm=0.2)
    landmarks = landmarks_beside(trial, 10.0, 5.0)
    plain, skin = (anatomy_of(trial, landmarks, skin_motion=stated) for stated in (None, (3.0, 2.0)))
    assert skin.functional_axis_angle.value == plain.functional_axis_angle.value
    assert skin.functional_axis_angle.high > plain.functional_axis_angle.high + np.radians(0.5)
    assert skin.functional_axis_distance.high > plain.functional_axis_distance.high + 0.0005


def test_of_two_axes_the_first_is_held_against_the_epicondyles() -> None:
    trial = simulate_trial(frames=150, inversion=70, joint_type="two-axes", proximal="moving", marker_noise_mm=0.1)
    landmarks = landmarks_beside(trial, 6.0, 4.0, "two_axes")
    found = analyze(trial.recording, landmarks=landmarks)
    motion, joint = found.anatomy, found.joint_type
    assert motion is not None
    assert joint is not None
    assert joint.two_axes is not None
    assert motion.functional_axis == "axis1"
    for limits, truth in (
        (motion.functional_axis_angle, np.radians(6.0)),
        (motion.functional_axis_distance, 0.004),
    ):
        assert limits.low <= truth <= limits.high
    angle = motion.functional_axis_angle
    assert angle.high - angle.value == pytest.approx(joint.two_axes.axis1.axis_cone, rel=1e-9)


def test_of_a_ball_no_axis_is_told() -> None:
    trial = simulate_trial(frames=120, inversion=60, joint_type="ball", marker_noise_mm=0.1, top_deg=70.0)
    hinge = simulate_trial(frames=120, inversion=60, joint_type="hinge")
    found = anatomy_of(trial, landmarks_beside(hinge, 6.0, 4.0))
    assert found.functional_axis is None
    assert np.isnan([*found.functional_axis_angle, *found.functional_axis_distance]).all()
    assert np.isfinite(found.joint_center_proximal).all()
