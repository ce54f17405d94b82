"""Wander of a hinge's axis: its size, its place, and no wander where there is none."""

from __future__ import annotations

import numpy as np
import pytest
from cluster_noise import ROWS, Hinge, Noise, fitted, line_errors, seen, skin, wander, wandering, white
from trials import LINE

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.direction_fit import fit_direction
from elbowscrew.motion.joint.influence import Influence, influence_of_fit
from elbowscrew.motion.joint.interval import joint_interval
from elbowscrew.motion.joint.joint_fit import HINGE_NUMBERS, LineFit
from elbowscrew.motion.joint.lines import line_twist
from elbowscrew.motion.joint.wander import Wander, wander_of_axis
from elbowscrew.motion.screws.uncertainty import joint_covariance


def found(hinge: Hinge, noise: Noise, rng: np.random.Generator) -> tuple[LineFit, Influence, Wander]:
    case = seen(hinge, noise(hinge, rng))
    fit, influence = fitted(case)
    result = wander_of_axis(fit, influence, case.clusters)
    assert result is not None
    return fit, influence, result


def line_pose(fit: LineFit, result: Wander, angle: float) -> Float:
    """Pose whose z axis is the line in the proximal body at an angle."""
    step = result.error_rows(np.array(angle)) @ result.step
    return dq.multiply(fit.proximal, dq.exp(line_twist(step)))


@pytest.mark.parametrize("top_deg", [60.0, 140.0])
@pytest.mark.parametrize("turn_deg", [1.0, 2.0, 4.0, 8.0])
def test_the_size_of_the_wander_is_found(top_deg: float, turn_deg: float) -> None:
    rng = np.random.default_rng(1)
    hinge = wandering(top_deg, np.radians(turn_deg), 0.0)
    all_found = [found(hinge, white(1e-4), rng)[2] for _ in range(12)]
    assert np.mean([np.degrees(w.tilt) for w in all_found]) == pytest.approx(turn_deg, abs=0.13 + 0.02 * turn_deg)
    assert all(w.significant for w in all_found)


def test_the_mean_axis_is_that_of_the_middle_and_the_hinge_is_not() -> None:
    rng = np.random.default_rng(2)
    hinge = wandering(140.0, np.radians(4.0), 3e-3)
    held = hinge_held = 0
    trials = 25
    rows = np.eye(13)
    for _ in range(trials):
        fit, influence, result = found(hinge, white(), rng)
        middle = line_errors(line_pose(fit, result, result.middle), LINE)
        held += middle[0] <= result.interval.radius(rows[:2]) and middle[1] <= result.interval.radius(rows[2:4])
        white_only = joint_interval(influence, ()).residuals
        assert white_only is not None
        hinge_held += line_errors(fit.proximal, LINE)[0] <= white_only.white.of(ROWS[0]).radius(0.95)
    assert held >= 20
    assert hinge_held == 0


def test_the_axis_is_where_it_is_at_every_angle() -> None:
    hinge = wandering(120.0, np.radians(6.0), 0.0)
    fit, _, result = found(hinge, white(2e-5), np.random.default_rng(3))
    across = np.cross(LINE[:3], [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    for share in (0.0, 0.25, 1.0):
        angle = result.middle + (2.0 * share - 1.0) * result.half_range
        turn = np.radians(6.0) * (share - 0.5)
        h = np.cos(turn) * LINE[:3] + np.sin(turn) * np.cross(across, LINE[:3])
        # The hinge's angle grows with the joint's, or against it.
        errors = [
            line_errors(line_pose(fit, result, a), np.concatenate([h, LINE[3:]]))[0]
            for a in (angle, 2.0 * result.middle - angle)
        ]
        assert np.degrees(min(errors)) < 0.15


@pytest.mark.parametrize("noise", [white(), wander(2e-3), skin(5e-3)], ids=["white", "slow", "skin"])
def test_noise_is_no_wander(noise: Noise) -> None:
    rng = np.random.default_rng(4)
    alarms = [found(Hinge(), noise, rng)[2].significant for _ in range(30)]
    assert np.mean(alarms) <= 0.07


def test_of_orientations_alone_the_tilts_are_found_and_no_places() -> None:
    hinge = wandering(120.0, np.radians(6.0), 0.0)
    case = seen(hinge, white(2e-5)(hinge, np.random.default_rng(5)))
    covariance = joint_covariance(case.joint, *case.noise).copy()
    covariance[:, :3, 3:] = covariance[:, 3:, :3] = 0.0
    covariance[:, 3:, 3:] = np.inf
    turned = dq.dual_quat_from_pose(case.joint[:, :4], np.zeros((hinge.frames, 3)))
    fit = fit_direction(turned, covariance)
    result = wander_of_axis(fit, influence_of_fit(fit, turned, covariance), ())
    assert result is not None
    assert result.significant
    assert np.degrees(result.tilt) == pytest.approx(6.0, abs=0.3)
    numbers = HINGE_NUMBERS + 4
    tilts = [0, 1, 4, 5, HINGE_NUMBERS, HINGE_NUMBERS + 1]
    places = [k for k in range(numbers) if k not in tilts]
    assert (result.step.shape, result.inverse.shape) == ((numbers,), (numbers, numbers))
    assert not result.step[places].any()
    assert not result.inverse[places].any()
    assert (np.linalg.eigvalsh(result.inverse[np.ix_(tilts, tilts)]) > 0.0).all()
    rows = result.error_rows(np.array(result.middle + result.half_range))
    assert (rows.shape, result.mean_rows.shape) == ((4, numbers), (4, numbers))
