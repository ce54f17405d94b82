"""Intervals of two axes and of a ball: truth within them under skin, and the hinge's own where both can be asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cluster_noise import Hinge, Noise, seen, skin, smooth_skin, turning, wander, white, with_rms_alone
from trials import LINE, START
from typed_noise import AXIS2, Kind, angles_held, fitted_type, joint_of, skin_of_both, typed_coverage

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.motion.joint.influence import influence_of_fit
from elbowscrew.motion.joint.interval import SkinMotion, joint_interval
from elbowscrew.motion.joint.joint_fit import fit_joint
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, fit_mechanism
from elbowscrew.motion.joint.lines import Z_LINE, about_z
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import OneAxis
from elbowscrew.motion.joint.two_axes import SHIFTS, TILTS, TwoAxesMechanism, geometry_slopes, undone_share
from elbowscrew.motion.joint.type_interval import Evidence, interval_of_type
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.screws.uncertainty import joint_covariance


def test_a_hinge_has_one_interval_in_both_searches() -> None:
    """The general way, by any type's derivatives, and the hinge's own meet."""
    hinge = Hinge(top_deg=100.0)
    case = seen(hinge, skin(3e-3)(hinge, np.random.default_rng(1)))
    covariance = joint_covariance(case.joint, *case.noise)
    poses = Poses.of(case.joint, covariance)
    fit = fit_mechanism(OneAxis.start(case.joint), poses, tolerance=1e-15)
    stated = (SkinMotion(segment="distal", shift=2e-3, turn=0.02), SkinMotion(segment="proximal", shift=1e-3))
    evidence = Evidence(noise_known=True, clusters=case.clusters, skin=stated)
    found = interval_of_type(fit, poses, evidence)
    near = dq.pose_from_dual_quat(fit.mechanism.proximal)[1]
    line = fit_joint(case.joint, covariance, dq.transform_lines(fit.mechanism.proximal, Z_LINE), near)
    own = joint_interval(influence_of_fit(line, case.joint, covariance), case.clusters, skin=stated)
    for k in (0, 4):  # tilts of the line in either body, whose axes across it may stand otherwise
        rows = np.eye(9)[k : k + 2]
        assert found.radius(rows) == pytest.approx(own.radius(rows), rel=1e-3)
        assert found.skin_radius(rows) == pytest.approx(own.skin_radius(rows), rel=1e-3)
        assert found.radii(rows).keys() == own.radii(rows).keys()


def two_axes_of(fit: Fit[Mechanism]) -> TwoAxesMechanism:
    assert isinstance(fit.mechanism, TwoAxesMechanism)
    return fit.mechanism


KINDS: list[tuple[Kind, Noise, float]] = [
    ("two_axes", white(), 0.93),
    ("two_axes", skin(5e-3), 0.88),
    ("two_axes", skin_of_both(5e-3), 0.88),
    ("ball", white(), 0.93),
    ("ball", skin(5e-3), 0.88),
]


@pytest.mark.parametrize(("kind", "noise", "least"), KINDS, ids=["white", "skin", "both", "ball-white", "ball-skin"])
def test_the_truth_is_within_the_interval(kind: Kind, noise: Noise, least: float) -> None:
    """Pooled over the numbers, which go together within a trial: three standard deviations of 25 trials at worst."""
    trials = 25
    found = typed_coverage(kind, joint_of(kind, 100.0), noise, trials, seed=2)
    slack = 3.0 * np.sqrt(least * (1.0 - least) / trials)
    assert found.held.mean() > least - slack
    assert (found.sharpness < 6.0).all()


@pytest.mark.parametrize("noise", [wander(2e-3), turning(np.radians(2.0))], ids=["wander", "turning"])
def test_slow_noise_and_little_pronation_determine_no_axis(noise: Noise) -> None:
    """30 deg of pronation in one cycle, and errors of 2 deg that last as long: the axis is tens of degrees off."""
    joint, rng = joint_of("two_axes", 60.0), np.random.default_rng(4)
    for _ in range(3):
        case = with_rms_alone(seen(joint, noise(joint, rng)))
        covariance = joint_covariance(case.joint, *case.noise)
        found = identify_joint(
            case.joint, covariance, case.joint[0], noise_known=True, forced="two_axes", clusters=case.clusters
        )
        assert found.two_axes is not None
        assert not all(line.determined for line in found.two_axes.lines)
        free = identify_joint(case.joint, covariance, case.joint[0], noise_known=True, clusters=case.clusters)
        assert free.status != "determined"


def test_axes_that_errors_have_drawn_together_are_not_told() -> None:
    """Skin makes of 86 deg between the axes some 20, with 84 deg against 68: the cone of 7 deg is 45 deg off."""
    joint, rng = joint_of("two_axes", 60.0), np.random.default_rng(101)
    noise = skin_of_both(5e-3)
    noise(joint, rng)
    case = seen(joint, noise(joint, rng))
    covariance = joint_covariance(case.joint, *case.noise)
    found = identify_joint(
        case.joint, covariance, case.joint[0], noise_known=True, forced="two_axes", clusters=case.clusters
    )
    two = found.two_axes
    assert two is not None
    assert np.degrees(two.axis1.axis_cone) < 10.0
    assert np.degrees(two.angle_between.value) < 30.0
    assert [line.determined for line in two.lines] == [False, False]
    assert two.distance is not None
    assert np.isnan([two.angle_between.sd, two.distance.sd]).all()


@pytest.mark.parametrize("between", [0.0, 20.0, 90.0, 160.0])
@pytest.mark.parametrize("goes_with", [-0.8, 0.0, 0.8])
def test_what_one_angle_undoes_of_the_other_is_missing_in_the_rotation(between: float, goes_with: float) -> None:
    rng = np.random.default_rng(6)
    angles = 1e-3 * rng.normal(size=(400, 2)) @ np.linalg.cholesky([[1.0, goes_with], [goes_with, 1.0]]).T
    tilt = dq.exp(np.array([0.5 * np.radians(between), 0.0, 0.0, 0.01, 0.0, 0.0]))
    identity = np.eye(8)[0]
    at = TwoAxesMechanism(proximal=identity, between=tilt, distal=identity, frames=angles)
    pose = dq.multiply(dq.multiply(about_z(angles[:, 0]), tilt), about_z(angles[:, 1]))
    turned = 2.0 * dq.log(dq.multiply(pose, dq.conjugate(tilt)))[:, :3]
    left = float(np.trace(np.cov(turned.T)) / np.trace(np.cov(angles.T)))
    assert undone_share(at) == pytest.approx(1.0 - left, abs=3e-3)


def test_skin_taken_for_white_noise_would_not_hold() -> None:
    """What makes the intervals hold is the markers' own motion: under white noise alone they would hold a third."""
    joint, rng = joint_of("two_axes", 100.0), np.random.default_rng(3)
    white_only = []
    for _ in range(12):
        fit, interval = fitted_type("two_axes", seen(joint, skin(5e-3)(joint, rng)))
        assert interval.residuals is not None
        assert interval.markers is not None
        off = dq.transform_lines(
            dq.conjugate(fit.mechanism.residual_frame), dq.transform_lines(dq.conjugate(START), AXIS2)
        )
        tilt = float(np.hypot(off[0], off[1]))
        white_only.append(tilt <= interval.residuals.white.of(np.eye(12)[8:10]).radius(0.95))
    assert np.mean(white_only) < 0.7


def test_deviations_of_many_numbers_are_those_of_their_radii() -> None:
    """Of each method and of stated skin motion, whatever the factors between variances and radii."""
    rng = np.random.default_rng(8)
    for top_deg, noise in ((100.0, white()), (100.0, skin(5e-3)), (60.0, turning(np.radians(2.0)))):
        joint = joint_of("two_axes", top_deg)
        case = seen(joint, noise(joint, rng))
        fit, interval = fitted_type("two_axes", case)
        poses = Poses.of(case.joint, joint_covariance(case.joint, *case.noise))
        stated = (SkinMotion(segment="distal", shift=2e-3, turn=0.02),)
        found = interval_of_type(fit, poses, Evidence(noise_known=True, clusters=case.clusters, skin=stated))
        for one in (interval, found):
            rows = (fit.own_by_shared - fit.own_by_shared[0])[20::60].reshape(-1, 12)
            exact = [one.radius(row[None]) / NORMAL_95 for row in rows]
            assert one.spread(rows[::4]).deviations(rows) == pytest.approx(exact, rel=0.03)


def test_an_axis_is_within_its_interval_where_the_other_is_hardly_known() -> None:
    """Where axis 2 may lie 40 deg off, an interval of axis 1 that is linear in the errors holds four in five."""
    joint = joint_of("two_axes", 60.0)
    held, linear = [], []
    for noise in (smooth_skin(5e-3), turning(np.radians(2.0))):
        rng = np.random.default_rng(21)
        for _ in range(20):
            fit, interval = fitted_type("two_axes", seen(joint, noise(joint, rng)))
            off = dq.transform_lines(dq.conjugate(two_axes_of(fit).proximal), LINE)
            error = float(np.hypot(off[0], off[1]))
            held.append(error <= interval.radius(TILTS[0]))
            linear.append(error <= replace(interval, nearby=()).radius(TILTS[0]))
    assert np.mean(held) >= 0.9
    assert np.mean(linear) <= 0.85


def test_an_interval_with_ends_is_the_root_mean_square_of_theirs() -> None:
    joint, rng = joint_of("two_axes", 60.0), np.random.default_rng(22)
    noise = turning(np.radians(2.0))
    fit, interval = fitted_type("two_axes", seen(joint, noise(joint, rng)))
    assert len(interval.nearby) == 4
    slopes = geometry_slopes(two_axes_of(fit))[:1]
    for rows in (*TILTS, *SHIFTS, slopes):
        each = [replace(interval, nearby=()).radius(rows)]
        each += [one.interval.radius(rows @ one.back) for one in interval.nearby]
        assert interval.radius(rows) == pytest.approx(np.sqrt(np.mean(np.square(each))), rel=1e-12)
        assert interval.decided_by(rows) == replace(interval, nearby=()).decided_by(rows)


def test_axes_known_well_are_linear_in_their_errors() -> None:
    """And no time is spent on the ends of their intervals."""
    joint, rng = joint_of("two_axes", 60.0), np.random.default_rng(23)
    assert fitted_type("two_axes", seen(joint, white()(joint, rng)))[1].nearby == ()


@pytest.mark.parametrize("seed", range(3))
def test_numbers_of_axes_nearby_are_those_of_the_fit(seed: int) -> None:
    """The angle between the axes changes by the numbers there as by those of the fit that they stand for."""
    joint, rng = joint_of("two_axes", 60.0), np.random.default_rng(seed)
    at = two_axes_of(fitted_type("two_axes", seen(joint, white()(joint, rng)))[0])
    moved = at.moved(rng.normal(scale=0.1, size=12), np.zeros_like(at.frames))
    carried = geometry_slopes(at)[0] @ at.numbers_by(moved)
    assert carried == pytest.approx(geometry_slopes(moved)[0], abs=5e-3)
    assert np.abs(geometry_slopes(at)[0] - geometry_slopes(moved)[0]).max() > 0.02


def test_error_bars_of_angles_hold_what_the_axes_err() -> None:
    """For given axes they held two thirds of the errors of clusters that turn by 2 deg."""
    given, whole = angles_held(joint_of("two_axes", 140.0), turning(np.radians(2.0)), 12, seed=9)
    assert whole.mean() > 0.85
    assert given.mean() < 0.8
