"""Wander of one of two axes: its size, where both axes are on the mean, and none where there is none."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from cluster_noise import Hinge, Noise, Seen, line_errors, seen, skin, turning, white
from trials import LINE, START
from typed_noise import AXIS2, angles_in_an_eight, fitted_type, second_angle, wandering_elbow

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.motion.joint.interval import SURE, SkinMotion, joint_interval
from elbowscrew.motion.joint.likelihood import Fit
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.two_axes import SHIFTS, TILTS, TwoAxesMechanism
from elbowscrew.motion.joint.type_interval import Evidence, influence_of_type, interval_of_type
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.joint.wander_of_two import WanderOfTwo, wander_of_two
from elbowscrew.motion.screws.uncertainty import joint_covariance

TRUTH = (LINE, dq.transform_lines(dq.conjugate(START), AXIS2))
WIDE = angles_in_an_eight((140.0, 80.0))


class Case(NamedTuple):
    fit: Fit[TwoAxesMechanism]
    poses: Poses
    evidence: Evidence
    found: WanderOfTwo


def case_of(seen_so: Seen) -> Case:
    fit = fitted_type("two_axes", seen_so)[0]
    assert isinstance(fit.mechanism, TwoAxesMechanism)
    poses = Poses.of(seen_so.joint, joint_covariance(seen_so.joint, *seen_so.noise))
    evidence = Evidence(noise_known=True, clusters=seen_so.clusters)
    two: Fit[TwoAxesMechanism] = fit  # type: ignore[assignment]
    return Case(two, poses, evidence, wander_of_two(two, poses, evidence))


def elbow(sizes_deg: tuple[float, float], noise: Noise, rng: np.random.Generator, angles: Float = WIDE) -> Case:
    hinge = wandering_elbow(angles, sizes_deg, rng)
    return case_of(seen(hinge, noise(hinge, rng)))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("size_deg", [3.0, 6.0])
def test_the_size_is_found_of_the_axis_that_wanders(axis: int, size_deg: float) -> None:
    rng = np.random.default_rng(1)
    sizes = (size_deg, 0.0) if axis == 0 else (0.0, size_deg)
    both = [elbow(sizes, white(1e-4), rng).found.each for _ in range(8)]
    found = []
    for each in both:
        mine, other = each[axis], each[1 - axis]
        assert mine is not None
        assert other is not None
        assert (mine.significant, other.significant) == (True, False)
        assert 0.0 < mine.tilt_sd < mine.unseen_tilt < mine.tilt
        found.append(np.degrees(mine.tilt))
    assert np.mean(found) == pytest.approx(size_deg, abs=0.15 + 0.02 * size_deg)


@pytest.mark.parametrize("sizes_deg", [(3.0, 0.0), (0.0, 3.0)])
def test_the_mean_axes_are_within_their_cones_and_that_of_the_fit_is_not(sizes_deg: tuple[float, float]) -> None:
    rng, trials = np.random.default_rng(2), 15
    held, of_fit = np.zeros((trials, 2, 2), dtype=bool), np.zeros(trials, dtype=bool)
    wanders = int(sizes_deg[1] > 0.0)
    for trial in range(trials):
        fit, poses, evidence, found = elbow(sizes_deg, white(), rng)
        mean = fit.mechanism.moved(found.step, np.zeros_like(fit.mechanism.frames))
        for k, (pose, line) in enumerate(zip((mean.proximal, mean.distal), TRUTH, strict=True)):
            turn, shift = line_errors(pose, line)
            held[trial, k] = turn <= found.interval.radius(TILTS[k]), shift <= found.interval.radius(SHIFTS[k])
        fitted = (fit.mechanism.proximal, fit.mechanism.distal)[wanders]
        interval = interval_of_type(fit, poses, evidence, np.zeros(2))
        of_fit[trial] = line_errors(fitted, TRUTH[wanders])[0] <= interval.radius(TILTS[wanders])
    assert held.mean() >= 0.9
    assert not of_fit.any()


NOISES = {"white": white(), "skin": skin(5e-3), "less skin": skin(5e-4), "turning": turning(np.radians(0.5))}


@pytest.mark.parametrize("noise", NOISES.values(), ids=list(NOISES))
def test_noise_is_no_wander(noise: Noise) -> None:
    """One cycle of both angles, which slow noise can follow as no other motion."""
    rng = np.random.default_rng(3)
    plain = Hinge(top_deg=60.0)
    angles = np.stack([plain.angle, 2.0 * second_angle(plain)], axis=1)
    alarms = [elbow((0.0, 0.0), noise, rng, angles).found.significant for _ in range(15)]
    assert sum(alarms) <= 1


def test_slow_noise_that_the_markers_do_not_show_is_judged_by_blocks_too() -> None:
    """By its spectrum alone it would be told as wander twice as often as by chance, and more."""
    rng = np.random.default_rng(4)
    fit, poses, evidence, found = elbow((0.0, 0.0), turning(np.radians(0.2)), rng)
    assert found.interval.blocks is not None
    of_the_joint = joint_interval(influence_of_type(fit, poses), evidence.clusters)
    assert of_the_joint.residuals is not None
    assert not of_the_joint.residuals.flat
    assert of_the_joint.blocks is None
    assert elbow((0.0, 0.0), white(), rng).found.interval.blocks is None


def test_of_orientations_alone_nothing_is_told_of_a_wander() -> None:
    rng = np.random.default_rng(5)
    hinge = wandering_elbow(WIDE, (6.0, 0.0), rng)
    case = seen(hinge, white(2e-5)(hinge, rng))
    covariance = joint_covariance(case.joint, *case.noise).copy()
    covariance[:, :3, 3:] = covariance[:, 3:, :3] = 0.0
    covariance[:, 3:, 3:] = np.inf
    turns = dq.dual_quat_from_pose(case.joint[:, :4], np.zeros((hinge.frames, 3)))
    found = identify_joint(turns, covariance, turns[0], noise_known=True, forced="two_axes")
    assert found.two_axes is not None
    assert all(line.determined for line in found.two_axes.lines)
    assert [line.wander for line in found.two_axes.lines] == [None, None]


def test_the_interval_is_that_of_both_wanders_beside_the_joint() -> None:
    """Radii of the joint's numbers, stated skin with them, are those of all numbers, and no smaller than the fit's."""
    rng = np.random.default_rng(6)
    stated = (SkinMotion(segment="distal", shift=2e-3, turn=0.02),)
    for noise in (white(), turning(np.radians(0.5)), skin(2e-3)):
        fit, poses, evidence, _ = elbow((0.0, 0.0), noise, rng)
        evidence = replace(evidence, skin=stated)
        found = wander_of_two(fit, poses, evidence)
        alone = replace(interval_of_type(fit, poses, evidence, np.zeros(2)), nearby=())
        for rows in (*TILTS, *SHIFTS):
            assert found.interval.radius(rows) >= 0.99 * alone.radius(rows)
        assert found.interval.skin_radius(TILTS[0]) > 0.0


def test_of_first_numbers_the_interval_stays_as_it_is() -> None:
    rng = np.random.default_rng(7)
    for noise in (white(), turning(np.radians(0.5)), skin(2e-3)):
        fit, poses, evidence, _ = elbow((0.0, 0.0), noise, rng)
        stated = (SkinMotion(segment="distal", shift=2e-3, turn=0.02),)
        whole = joint_interval(influence_of_type(fit, poses), evidence.clusters, skin=stated)
        first = whole.of_first(4)
        for rows in (np.eye(4)[:2], np.eye(4)[2:], np.array([[1.0, -2.0, 0.5, 0.1]])):
            padded = np.concatenate([rows, np.zeros((len(rows), 8))], axis=1)
            for level in (0.95, SURE):
                assert first.radius(rows, level) == pytest.approx(whole.radius(padded, level), rel=1e-12)
            assert first.decided_by(rows) == whole.decided_by(padded)


def test_a_standard_deviation_is_that_along_the_way_it_goes() -> None:
    found = elbow((3.0, 0.0), white(), np.random.default_rng(8)).found
    one = found.each[0]
    assert one is not None
    # Of two numbers alike a radius of 99.73 % is 3.44 deviations of each, of one alone 3.00.
    assert 3.0 / 1.01 < one.unseen_tilt / one.tilt_sd < 12.0
    assert one.tilt_sd * NORMAL_95 < one.unseen_tilt


def test_a_second_angle_that_stands_still_tells_of_no_wander() -> None:
    """And then nothing is said of either axis."""
    rng = np.random.default_rng(9)
    hinge = wandering_elbow(WIDE * [1.0, 1e-9], (0.0, 0.0), rng)
    case = seen(hinge, white()(hinge, rng))
    fit = fitted_type("two_axes", case)[0]
    still = replace(fit.mechanism, frames=fit.mechanism.frames * [1.0, 0.0])
    poses = Poses.of(case.joint, joint_covariance(case.joint, *case.noise))
    found = wander_of_two(fit._replace(mechanism=still), poses, Evidence(noise_known=True))  # type: ignore[arg-type]
    assert found.each == (None, None)
    assert not found.significant
    assert found.words == ""
    assert np.isnan(found.interval.radius(TILTS[0]))


def test_both_axes_that_wander_are_both_named() -> None:
    found = elbow((6.0, 6.0), white(1e-4), np.random.default_rng(10)).found
    one, two = found.each
    assert one is not None
    assert two is not None
    told = [f"wanders by {np.degrees(w.tilt):.2g} deg and {1e3 * w.shift:.2g} mm" for w in (one, two)]
    assert found.words == f"axis 1 {told[0]} and axis 2 {told[1]}"


@pytest.mark.parametrize("sizes_deg", [(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)])
def test_a_joint_is_told_by_its_mean_axes_where_one_wanders(sizes_deg: tuple[float, float]) -> None:
    """Lines, how they stand to each other, and angles; and its type is then approximate."""
    rng = np.random.default_rng(11)
    hinge = wandering_elbow(WIDE, sizes_deg, rng)
    case = seen(hinge, white()(hinge, rng))
    covariance = joint_covariance(case.joint, *case.noise)
    found = identify_joint(case.joint, covariance, case.joint[0], noise_known=True, clusters=case.clusters)
    two = found.two_axes
    assert two is not None
    assert all(line.determined for line in two.lines)
    wanders = [line.wander is not None and line.wander.significant for line in two.lines]
    assert wanders == [size > 0.0 for size in sizes_deg]
    assert (two.wanders, two.only_wander_doubted) == (any(wanders), any(wanders))
    assert found.status == ("approximate" if any(wanders) else "determined")
    for number, wandering in enumerate(wanders, start=1):
        assert (f"; axis {number} wanders by " in found.reason) == wandering
    directions = two.axis1.direction_proximal, two.axis2.direction_distal
    points = two.axis1.point_proximal, two.axis2.point_distal
    for line, direction, point, truth in zip(two.lines, directions, points, TRUTH, strict=True):
        off = np.cross(direction, truth[:3])
        assert np.arcsin(np.linalg.norm(off)) <= 1.2 * line.axis_cone
        apart = np.cross(truth[:3], truth[3:]) - point
        assert np.linalg.norm(apart - truth[:3] * (apart @ truth[:3])) <= 1.5 * line.point_radius
    sense = np.sign(np.sum(found.angle * (WIDE - WIDE[0]), axis=0))
    error = np.degrees(np.sqrt(np.mean((sense * found.angle - (WIDE - WIDE[0])) ** 2, axis=0)))
    assert (error < 0.9).all()
    assert np.isfinite(two.covariance).all()
    assert np.sqrt(np.trace(two.covariance[:2, :2])) < 1.2 * two.axis1.axis_cone
    # Keyframes are joined by the axes that leave least, which those of a wandering joint are not.
    joint = found.coordinates
    assert joint is not None
    same = np.degrees(np.arcsin(np.linalg.norm(np.cross(joint.axis[0], two.axis1.direction_distal))))
    if wanders[0]:
        assert np.radians(same) > two.axis1.axis_cone
    if not any(wanders):
        assert same < 1e-6
