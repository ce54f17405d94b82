"""Which joint it is: laws of the fits, truth within its interval, the choice, and the cases with known joints."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import moving_joints as mj
import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import pose_from_points
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.twist import adjoint
from elbowscrew.model import PoseNoise
from elbowscrew.motion.joint.choice import choose_type
from elbowscrew.motion.joint.fitting import Fitted, fit_type, shared_covariance
from elbowscrew.motion.joint.joint_fit import fit_joint
from elbowscrew.motion.joint.likelihood import fit_mechanism
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.joint.pieces import influence_pieces
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import OneAxis
from elbowscrew.motion.joint.starts import find_two_axes
from elbowscrew.motion.joint.two_axes import TwoAxesMechanism, axes_geometry, geometry_slopes
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.screws.uncertainty import joint_covariance

ROTATION_DEG, PLACE = 0.1, 2e-4
ALL: tuple[Fitted, ...] = ("rigid", "hinge", "screw_hinge", "two_axes", "ball")


def elbow(seed: int, count: int = 200) -> tuple[Float, Float, mj.MovingJoint]:
    rng = np.random.default_rng(seed)
    exact = mj.two_axes(count, (100.0, 70.0), 85.0, 0.012, rng)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
    return seen, covariance, exact


def tangent_error(pose: Float, line: Float) -> Float:
    """Tilts and shifts (4,) of a true line in the frame of a found one."""
    seen = dq.transform_lines(dq.conjugate(pose), line)
    seen = seen if seen[2] > 0.0 else -seen
    h, m = seen[:3], seen[3:]
    # A line near z: its direction is (tilt y, -tilt x, 1), and it passes the plane z = 0 at the shift (-m_y, m_x).
    return np.array([-h[1], h[0], -m[1], m[0]])


@pytest.mark.parametrize("name", ALL)
def test_signs_and_order_of_the_frames_do_not_matter(name: Fitted) -> None:
    seen, covariance, _ = elbow(1, 120)
    fit = fit_type(name, Poses.of(seen, covariance))
    order = np.random.default_rng(2).permutation(len(seen))
    sign = np.where(np.arange(len(seen)) % 3 == 0, -1.0, 1.0)
    shuffled = fit_type(name, Poses.of(sign[order, None] * seen[order], covariance[order]))
    assert shuffled.cost == pytest.approx(fit.cost, rel=1e-6)


def test_other_frames_of_the_bodies_move_the_axes_with_them() -> None:
    seen, covariance, _ = elbow(3)
    rng = np.random.default_rng(4)
    new_proximal, new_distal = mj.rest_pose(rng), mj.rest_pose(rng)
    moved = dq.multiply(dq.multiply(new_proximal, seen), new_distal)
    back = adjoint(dq.conjugate(new_distal))
    there = identify_joint(moved, back @ covariance @ back.T, moved[0], noise_known=True).two_axes
    here = identify_joint(seen, covariance, seen[0], noise_known=True).two_axes
    assert here is not None
    assert there is not None
    turned = qn.rotate(new_proximal[:4], here.axis1.direction_proximal)
    assert mj.angle_between(there.axis1.direction_proximal, turned) < 1e-6
    np.testing.assert_allclose(
        there.axis1.point_proximal, dq.transform_points(new_proximal, here.axis1.point_proximal), atol=1e-7
    )
    np.testing.assert_allclose(
        there.axis2.point_distal,
        dq.transform_points(dq.conjugate(new_distal), here.axis2.point_distal),
        atol=1e-7,
    )
    assert there.angle_between.value == pytest.approx(here.angle_between.value, abs=1e-7)
    assert there.axis1.axis_cone == pytest.approx(here.axis1.axis_cone, rel=1e-3)


@pytest.mark.parametrize("screw", [False, True])
def test_one_axis_is_the_same_in_both_searches(screw: bool) -> None:
    """Two implementations of one likelihood meet in one line."""
    rng = np.random.default_rng(5)
    exact = mj.hinge(150, 90.0, rng, pitch=0.004 if screw else 0.0)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
    fit = fit_mechanism(OneAxis.start(seen, screw=screw), Poses.of(seen, covariance), tolerance=1e-15)
    near = dq.pose_from_dual_quat(fit.mechanism.proximal)[1]
    line = fit_joint(seen, covariance, dq.transform_lines(fit.mechanism.proximal, Z_LINE), near, screw=screw)
    assert mj.angle_between(
        dq.transform_lines(fit.mechanism.proximal, Z_LINE), dq.transform_lines(line.proximal, Z_LINE)
    ) == pytest.approx(0.0, abs=1e-6)  # a thousandth of its standard deviation
    assert fit.variance == pytest.approx(line.noise_ratio**2, rel=1e-6)
    assert np.trace(np.linalg.inv(fit.information)[:2, :2]) == pytest.approx(
        np.trace(np.linalg.inv(line.information)[:2, :2]), rel=1e-4
    )


def test_two_axes_are_covered_by_their_intervals() -> None:
    """The squared error in units of the covariance is a chi-square: 95 % of it below its quantile."""
    rng = np.random.default_rng(6)
    inside, squares, count = np.zeros(4), np.zeros(2), 30
    for _ in range(count):
        exact = mj.two_axes(120, (100.0, 70.0), 85.0, 0.012, rng)
        seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
        poses = Poses.of(seen, covariance)
        fit = fit_mechanism(find_two_axes(poses).mechanism.placed(seen), poses)
        C = np.asarray(np.linalg.inv(fit.information), dtype=np.float64)
        for k, pose in enumerate((fit.mechanism.proximal, fit.mechanism.distal)):
            error = tangent_error(pose, exact.truth[f"axis{k + 1}"])
            square = error @ np.linalg.solve(C[8 * k : 8 * k + 4, 8 * k : 8 * k + 4], error)
            squares[k] += square / count
            inside[k] += square < 9.488
        geometry, slopes = axes_geometry(fit.mechanism), geometry_slopes(fit.mechanism)
        G = slopes @ C @ slopes.T
        folded = min(geometry.angle, np.pi - geometry.angle)
        inside[2] += abs(folded - np.radians(85.0)) < 1.96 * np.sqrt(G[0, 0])
        inside[3] += abs(abs(geometry.distance) - 0.012) < 1.96 * np.sqrt(G[1, 1])
    # Three standard deviations of a share of 95 % in so many trials, and of the mean of a chi-square of 4.
    assert (inside / count > 0.95 - 3.0 * np.sqrt(0.05 * 0.95 / count)).all()
    np.testing.assert_allclose(squares, 4.0, atol=3.0 * np.sqrt(8.0 / count))


def test_a_center_is_covered_by_its_interval() -> None:
    rng = np.random.default_rng(7)
    squares, count = 0.0, 40
    for _ in range(count):
        exact = mj.ball(120, 60.0, rng)
        seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
        fit = fit_type("ball", Poses.of(seen, covariance))
        mechanism = fit.mechanism
        error = np.concatenate([mechanism.proximal - exact.truth["proximal"], mechanism.distal - exact.truth["distal"]])  # type: ignore[attr-defined]
        squares += error @ fit.information @ error / count
    assert squares == pytest.approx(6.0, abs=3.0 * np.sqrt(12.0 / count))


def test_pieces_of_influence_tell_what_a_pose_error_does() -> None:
    """Moving one pose by a small twist moves the fit by what the pieces say."""
    seen, covariance, _ = elbow(8, 80)
    poses = Poses.of(seen, covariance)
    fit = fit_mechanism(find_two_axes(poses).mechanism.placed(seen), poses, tolerance=1e-14)
    pieces = influence_pieces(fit, poses)
    psi = np.linalg.solve(fit.information, np.swapaxes(pieces.design[40], 0, 1) @ pieces.whitener[40])
    error = 1e-3 * np.array([1.0, -2.0, 0.5, 0.3, 0.2, -0.4])
    ends = []
    for sign in (1.0, -1.0):
        nudged = seen.copy()
        nudged[40] = dq.multiply(seen[40], dq.exp(sign * 0.5 * error))
        again = fit_mechanism(fit.mechanism, Poses(nudged, poses.whitener), tolerance=1e-15)
        ends.append(
            2.0 * dq.log(dq.canonical(dq.multiply(dq.conjugate(fit.mechanism.proximal), again.mechanism.proximal)))
        )
    step, expected = 0.5 * (ends[0] - ends[1])[[0, 1, 3, 4]], (psi @ error)[:4]
    np.testing.assert_allclose(step, expected, atol=0.03 * float(np.abs(expected).max()))
    square = np.einsum("fip,fiq->pq", pieces.design, pieces.design)
    np.testing.assert_allclose(square, fit.information, atol=2e-3 * float(np.abs(fit.information).max()))


@pytest.mark.parametrize(
    ("between", "distance", "seed"), [((60.0, 120.0), 0.025, 11), ((0.0, 5.0), 0.06, 12), ((30.0, 150.0), 0.0, 13)]
)
def test_no_start_fails(between: tuple[float, float], distance: float, seed: int) -> None:
    """Every search ends at the truth's own likelihood: elbows, nearly parallel axes, axes that intersect."""
    rng = np.random.default_rng(seed)
    for _ in range(6):
        ranges = (rng.uniform(20.0, 140.0), rng.uniform(20.0, 140.0))
        apart = max(distance * rng.uniform(), 0.01 if between[0] == 0.0 else 0.0)
        exact = mj.two_axes(120, ranges, rng.uniform(*between), apart, rng)
        seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
        poses = Poses.of(seen, covariance)
        truth = find_two_axes(Poses.of(exact.poses, covariance)).mechanism
        found = fit_mechanism(find_two_axes(poses).mechanism.placed(seen), poses)
        assert found.variance < 1.3
        assert found.cost <= fit_mechanism(truth.placed(seen), poses).cost * (1.0 + 1e-6)


SAMPLES = {
    "rigid": lambda rng: mj.rigid(200, rng),
    "hinge": lambda rng: mj.hinge(200, 80.0, rng),
    "screw_hinge": lambda rng: mj.hinge(200, 80.0, rng, pitch=0.01),
    "two_axes": lambda rng: mj.two_axes(200, (90.0, 60.0), 85.0, 0.01, rng),
    "ball": lambda rng: mj.ball(200, 60.0, rng),
    "free": lambda rng: mj.free(200, 60.0, rng),
}


@pytest.mark.parametrize("name", list(SAMPLES))
@pytest.mark.parametrize("noise_known", [True, False])
def test_each_type_is_told(name: str, noise_known: bool) -> None:
    rng = np.random.default_rng(21)
    exact = SAMPLES[name](rng)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
    choice = choose_type(Poses.of(seen, covariance), noise_known=noise_known)
    assert (choice.type, choice.status) == (name, "determined")


@pytest.mark.parametrize("one", ["hinge", "screw_hinge"])
@pytest.mark.parametrize("noise_known", [True, False])
def test_a_single_axis_is_told_as_it_was_found_to_be(one: Literal["hinge", "screw_hinge"], noise_known: bool) -> None:
    """By the joint's axis, whose interval knows of the markers."""
    rng = np.random.default_rng(16)
    for pitch in (0.0, 0.01):
        seen, covariance = mj.noisy(mj.hinge(200, 80.0, rng, pitch=pitch).poses, rng, ROTATION_DEG, PLACE)
        assert identify_joint(seen, covariance, seen[0], noise_known=noise_known, one=one).type == one


def test_a_stated_type_is_taken_whatever_the_motion() -> None:
    seen, covariance, _ = elbow(22)
    found = identify_joint(seen, covariance, seen[0], noise_known=True, forced="ball")
    assert (found.type, found.status) == ("ball", "forced")
    assert found.angle.shape == (len(seen), 3)
    assert [candidate.type for candidate in found.candidates] == ["ball"]


def test_a_hinge_is_no_phantom_of_two_axes() -> None:
    rng = np.random.default_rng(23)
    exact = mj.hinge(200, 80.0, rng)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
    found = identify_joint(seen, covariance, seen[0], noise_known=False)
    assert found.type == "hinge"
    assert "two_axes" not in {one.type for one in found.candidates}  # what the hinge leaves is white
    hinge, two = (fit_type(name, Poses.of(seen, covariance)) for name in ALL if name in ("hinge", "two_axes"))
    assert two.variance > 0.85 * hinge.variance  # another angle a frame has only noise to explain
    assert found.angle[0, 0] == pytest.approx(0.0, abs=np.radians(1.0))
    assert np.ptp(found.angle) == pytest.approx(np.ptp(exact.truth["angles"]), abs=np.radians(0.6))


def test_outliers_move_robust_axes_little() -> None:
    seen, covariance, exact = elbow(24)
    rng = np.random.default_rng(25)
    bad = rng.choice(len(seen), len(seen) // 12, replace=False)
    seen[bad] = dq.multiply(seen[bad], dq.exp(0.5 * rng.normal(size=(bad.size, 6)) * ([0.3] * 3 + [0.05] * 3)))
    errors = []
    for robust in (True, False):
        fit = fit_type("two_axes", Poses.of(seen, covariance), robust=robust)
        assert isinstance(fit.mechanism, TwoAxesMechanism)
        line = dq.transform_lines(fit.mechanism.proximal, Z_LINE)
        errors.append(mj.angle_between(line, exact.truth["axis1"]))
    assert errors[0] < np.radians(0.1)
    assert errors[0] < 0.2 * errors[1]


def test_the_angles_are_those_that_moved_the_joint() -> None:
    seen, covariance, exact = elbow(26)
    found = identify_joint(seen, covariance, exact.poses[0], noise_known=True)
    truth = exact.truth["angles"] - exact.truth["angles"][0]
    for k in range(2):
        sense = np.sign(truth[:, k] @ found.angle[:, k])
        error = found.angle[:, k] - sense * truth[:, k]
        assert np.sqrt(np.mean((error / found.angle_sd[:, k]) ** 2)) == pytest.approx(1.0, abs=0.25)
    assert found.angle[:, 0].max() >= -found.angle[:, 0].min()


def one_at_a_time(exact: mj.MovingJoint, together: float = 0.0) -> Float:
    """First one angle to and fro, then the other; while the first one moves, the second sways by so much (rad)."""
    sway = 0.5 - 0.5 * np.cos(np.linspace(0.0, 4.0 * np.pi, 100))
    first = np.concatenate([2.0 * sway, np.zeros(100)])
    second = np.concatenate([together * np.sin(np.linspace(0.0, 9.0, 100)), 1.4 * sway])
    rest = exact.poses[0]
    one, two = exact.truth["axis1"], dq.transform_lines(rest, exact.truth["axis2"])
    return dq.multiply(dq.multiply(mj.turned(first, one), mj.turned(second, two)), rest)


@pytest.mark.parametrize("between", [90.0, 1.0])
@pytest.mark.parametrize("noise_known", [True, False])
def test_axes_that_turn_one_at_a_time_have_no_order(between: float, noise_known: bool) -> None:
    """Both orders make the very same poses, where each axis turns at zero of the other: none of them is known."""
    for seed in range(2):
        rng = np.random.default_rng([31, seed])
        exact = mj.two_axes(2, (90.0, 90.0), between, 0.04, rng)
        seen, covariance = mj.noisy(one_at_a_time(exact), rng, ROTATION_DEG, PLACE)
        found = identify_joint(seen, covariance, seen[0], noise_known=noise_known)
        assert found.two_axes is not None
        assert not found.two_axes.order_determined
        assert found.status == "approximate"


@pytest.mark.parametrize("noise_known", [True, False])
def test_axes_that_turn_together_for_a_while_have_an_order(noise_known: bool) -> None:
    """And the one that is found is the true one."""
    for seed in range(3):
        rng = np.random.default_rng([32, seed])
        exact = mj.two_axes(2, (90.0, 90.0), 80.0, 0.02, rng)
        seen, covariance = mj.noisy(one_at_a_time(exact, 0.3), rng, ROTATION_DEG, PLACE)
        found = identify_joint(seen, covariance, seen[0], noise_known=noise_known).two_axes
        assert found is not None
        assert found.order_determined
        assert mj.angle_between(found.axis1.direction_proximal, exact.truth["axis1"]) < np.radians(1.0)
        assert mj.angle_between(found.axis2.direction_distal, exact.truth["axis2"]) < np.radians(1.0)


def test_white_noise_alone_makes_no_joint_a_free_one() -> None:
    """It leaves more than 12 mm, of what is a ball or two axes all the same."""
    for seed in range(2):
        rng = np.random.default_rng([33, seed])
        for exact in (mj.two_axes(400, (110.0, 80.0), 85.0, 0.012, rng), mj.ball(400, 80.0, rng)):
            seen, covariance = mj.noisy(exact.poses, rng, 0.5, 0.008)
            found = identify_joint(seen, covariance, seen[0], noise_known=False)
            assert found.type not in ("free", "undetermined"), found.reason
            assert np.sqrt(np.nanmean(found.residual_translation**2)) > 0.012
    loose = mj.free(400, 60.0, np.random.default_rng(34))
    seen, covariance = mj.noisy(loose.poses, np.random.default_rng(35), 0.5, 0.002)
    assert identify_joint(seen, covariance, seen[0], noise_known=False).type == "free"


@pytest.mark.parametrize("seed", [1, 4, 11])
def test_noise_of_rotations_alone_makes_no_joint_a_free_one(seed: int) -> None:
    """2.4 deg shift the end of a lever by more than 12 mm, along two directions: most squares are below their mean."""
    rng = np.random.default_rng([36, seed])
    for exact in (mj.ball(200, 22.0, rng), mj.two_axes(200, (55.0, 18.0), 70.0, 0.02, rng)):
        seen, covariance = mj.noisy(exact.poses, rng, 2.4, 0.004)
        assert identify_joint(seen, covariance, seen[0], noise_known=False).type != "free"


@pytest.mark.parametrize("seed", [2, 15, 26])
def test_a_screw_hinge_leaves_no_more_than_the_hinge_that_it_may_be(seed: int) -> None:
    """Of motions that are neither, in which searches of their own end in other minima."""
    rng = np.random.default_rng([41, seed])
    exact = mj.free(120, 140.0, rng) if seed % 2 else mj.ball(120, 140.0, rng)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
    line, near = mj.line(mj.unit(rng.normal(size=3)), rng.normal(0.0, 0.08, 3)), dq.pose_from_dual_quat(seen[0])[1]
    hinge = fit_joint(seen, covariance, line, near)
    screw = fit_joint(seen, covariance, line, near, screw=True, start=hinge)
    assert screw.noise_ratio**2 * screw.freedom <= hinge.noise_ratio**2 * hinge.freedom * (1.0 + 1e-9)
    costs = [fit_type(name, Poses.of(seen, covariance)).cost for name in ("hinge", "screw_hinge")]
    assert costs[1] <= costs[0] * (1.0 + 1e-9)


def beside_a_hinge(size_deg: float, seed: int, rest: int = 0) -> tuple[Float, Float]:
    """Poses of a hinge that turns a little about an axis across it, too, and that axis in the distal body."""
    rng = np.random.default_rng([43, seed])
    exact = mj.two_axes(2, (90.0, 90.0), 90.0, 0.002, rng)
    time = np.arange(400) / 400.0
    first = 1.05 * (1.0 - np.cos(4.0 * np.pi * time))
    second = np.radians(0.5 * size_deg) * np.sin(6.0 * np.pi * time)
    first, second = (np.concatenate([angle, np.full(rest, angle[-1])]) for angle in (first, second))
    pose = exact.poses[0]
    one, two = exact.truth["axis1"], dq.transform_lines(pose, exact.truth["axis2"])
    return dq.multiply(dq.multiply(mj.turned(first, one), mj.turned(second, two)), pose), exact.truth["axis2"]


@pytest.mark.parametrize("rest", [0, 1600])
def test_a_small_second_rotation_is_told_within_its_cone(rest: int) -> None:
    """A long rest, of which fewer frames decide, is no reason not to know it."""
    told = []
    for seed in range(6):
        exact, axis2 = beside_a_hinge(2.0, seed, rest)
        seen, covariance = mj.noisy(exact, np.random.default_rng(seed), 0.004, 1e-5)
        found = identify_joint(seen, covariance, seen[0], noise_known=False)
        second = found.second_rotation
        if found.type == "hinge" and second is not None and second.axis is not None:
            told.append(mj.angle_between(second.axis.direction_distal, axis2) < 1.5 * second.axis.axis_cone)
            assert second.range == pytest.approx(np.radians(2.0), rel=0.15)
    assert len(told) >= 2
    assert all(told)


@pytest.mark.parametrize("rotation_deg", [0.1, 0.5])
def test_noise_is_no_second_rotation(rotation_deg: float) -> None:
    """Though it is three times the stated one, so that it does not explain what a hinge leaves."""
    exact, _ = beside_a_hinge(0.0, 1)
    seen, covariance = mj.noisy(exact, np.random.default_rng(3), rotation_deg, 2e-3 * rotation_deg)
    found = identify_joint(seen, covariance / 9.0, seen[0], noise_known=True)
    assert found.type == "hinge"
    assert "two_axes" in {candidate.type for candidate in found.candidates}
    assert found.second_rotation is None


def test_noise_that_nobody_states_needs_frames_to_tell_it() -> None:
    rng = np.random.default_rng(27)
    exact = mj.hinge(5, 80.0, rng)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, PLACE)
    fit = fit_mechanism(OneAxis.start(seen), Poses.of(seen, covariance))
    assert np.isnan(shared_covariance(fit, noise_known=False)).all()
    assert np.isfinite(shared_covariance(fit, noise_known=True)).all()


def case(folder: Path, name: str, distal: str, proximal: str | None = None) -> Float:
    table = pd.read_csv(folder / "cases" / f"{name}.csv")

    def poses(body: str) -> Float:
        quat = table[[f"{body}_e{k}" for k in range(4)]].to_numpy(np.float64)
        return dq.dual_quat_from_pose(quat, table[[f"{body}_{c}_m" for c in "xyz"]].to_numpy(np.float64))

    seen = poses(distal)
    seen = seen if proximal is None else dq.multiply(dq.conjugate(poses(proximal)), seen)
    return np.asarray(dq.normalize(seen[np.isfinite(seen).all(axis=1)]))


def noise(rotation_deg: float, place: float) -> PoseNoise:
    square = np.diag([np.radians(rotation_deg) ** 2] * 3 + [place**2] * 3)
    return PoseNoise(covariance=square, source="known", marker_noise=None)


@pytest.mark.parametrize("noise_known", [True, False])
def test_the_elbow_of_two_axes(real_data: Path, noise_known: bool) -> None:
    seen = case(real_data, "two_axis_elbow", "forearm")
    found = identify_joint(seen, noise(0.1, 2e-4).covariance, seen[0], noise_known=noise_known)
    assert (found.type, found.status) == ("two_axes", "determined")
    joint = found.two_axes
    assert joint is not None
    assert joint.distance is not None
    assert mj.angle_between(joint.axis1.direction_proximal, mj.unit(np.array([0.98, 0.1, 0.17]))) < np.radians(0.1)
    assert mj.angle_between(joint.axis2.direction_proximal, mj.unit(np.array([0.1, -0.99, 0.05]))) < np.radians(0.1)
    assert np.degrees(joint.angle_between.value) == pytest.approx(89.57, abs=0.1)
    assert abs(joint.distance.value) == pytest.approx(0.012225, abs=1e-4)


def test_measured_elbow_angles_on_published_axes(real_data: Path) -> None:
    seen = case(real_data, "das3_real_motion", "forearm")
    found = identify_joint(seen, noise(0.2, 3e-4).covariance, seen[0], noise_known=True)
    joint = found.two_axes
    assert joint is not None
    assert joint.distance is not None
    assert mj.angle_between(joint.axis1.direction_proximal, mj.unit(np.array([0.969, -0.247, 0.0]))) < np.radians(0.05)
    pronation = mj.unit(np.array([0.182, 0.98227, -0.044946]))
    assert mj.angle_between(joint.axis2.direction_distal, pronation) < np.radians(0.05)
    assert abs(joint.distance.value) == pytest.approx(0.007135, abs=5e-5)
    assert np.degrees(joint.angle_between.value) == pytest.approx(86.20, abs=0.05)


def test_the_hip_is_a_ball(real_data: Path) -> None:
    seen = case(real_data, "hip_ball", "femur", "pelvis")
    one = noise(0.05, 1e-4)
    found = identify_joint(seen, joint_covariance(seen, one, one), seen[0], noise_known=True)
    assert (found.type, found.status) == ("ball", "determined")
    assert found.ball is not None
    np.testing.assert_allclose(found.ball.center_proximal, [0.03, -0.05, 0.08], atol=2e-4)
    np.testing.assert_allclose(found.ball.center_distal, [0.0, 0.25, 0.0], atol=2e-4)
    assert np.linalg.norm(found.ball.center_proximal - [0.03, -0.05, 0.08]) < 2.0 * found.ball.radius


def test_score_stands_beside_the_center_of_a_ball() -> None:
    """The least squares of all frames' ``R c_F - c_A = -d`` at once; the truth where there is no noise."""
    rng = np.random.default_rng(31)
    exact = mj.ball(200, 40.0, rng)
    seen, covariance = mj.noisy(exact.poses, rng, ROTATION_DEG, 1e-3)
    for poses in (seen, exact.poses):
        found = identify_joint(poses, covariance, poses[0], noise_known=True, forced="ball").ball
        assert found is not None
        quat, position = dq.pose_from_dual_quat(poses)
        R = Rotation.from_quat(quat, scalar_first=True).as_matrix()
        system = np.concatenate([R, np.broadcast_to(-np.eye(3), R.shape)], axis=2).reshape(-1, 6)
        wanted = np.linalg.lstsq(system, -position.ravel(), rcond=None)[0]
        np.testing.assert_allclose(found.score_distal, wanted[:3], atol=1e-9)
        np.testing.assert_allclose(found.score_proximal, wanted[3:], atol=1e-9)
        assert np.abs(found.score_proximal - exact.truth["proximal"]).max() < (5e-3 if poses is seen else 1e-9)


def test_flexion_with_pronation_is_no_hinge(real_data: Path) -> None:
    """140 deg of flexion with 60 deg of pronation at the same time; one axis would be 20 deg off."""
    table = pd.read_csv(real_data / "cases" / "pronation60.csv")

    def cluster(name: str) -> Float:
        columns = [f"{name}{k}_{c}_m" for k in range(4) for c in "xyz"]
        markers = table[columns].to_numpy(np.float64).reshape(-1, 4, 3)
        return pose_from_points(markers[0] - markers[0].mean(axis=0), markers)

    seen = dq.multiply(dq.conjugate(cluster("UA")), cluster("FA"))
    one = noise(0.2, 1e-4)
    found = identify_joint(seen, joint_covariance(seen, one, one), seen[0], noise_known=False)
    assert found.type == "two_axes"
    assert found.two_axes is not None
    ranges = np.degrees(np.ptp(found.angle, axis=0))
    np.testing.assert_allclose(ranges, [140.0, 60.0], atol=3.0)
