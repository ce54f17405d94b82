"""Intervals of a hinge: they hold the truth under every kind of marker noise, whatever frames they are written in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cluster_noise import (
    NEAR,
    ROWS,
    WHITE_M,
    Hinge,
    Noise,
    Seen,
    coverage,
    fitted,
    interval_of,
    line_errors,
    seen,
    skin,
    smooth_skin,
    turning,
    turning_with_flexion,
    wander,
    white,
    with_rms_alone,
)
from scipy.optimize import brentq
from scipy.stats import binom, t
from trials import LINE, START, joint_poses

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import nonrigid_coordinates
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.sensitivity import confidence_radius
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.influence import influence_of_fit
from elbowscrew.motion.joint.interval import (
    SURE,
    ClusterMotion,
    SkinMotion,
    joint_interval,
    pose_radii,
    skin_covariance,
    skin_sensitivity,
)
from elbowscrew.motion.joint.joint_fit import fit_joint
from elbowscrew.motion.joint.lines import Z_LINE
from elbowscrew.motion.joint.nonrigid import cluster_like, nonrigid_covariance, residual_covariance
from elbowscrew.motion.joint.tails import Mixture
from elbowscrew.motion.screws.pose_noise import covariance_from_markers
from elbowscrew.motion.screws.uncertainty import joint_covariance

TRIALS = 40


def fewest(share: float, trials: int = TRIALS) -> float:
    """Share that an interval of coverage `share` misses once in a thousand repetitions of so many trials."""
    return float(binom.ppf(1e-3, trials, share)) / trials


@pytest.mark.parametrize("top_deg", [20.0, 140.0])
def test_white_noise_is_held_and_no_more_than_needed(top_deg: float) -> None:
    found = coverage(Hinge(top_deg=top_deg), white(), TRIALS, seed=3, pitch=True)
    assert (found.held >= fewest(0.95)).all()
    # A radius of 95 % in a plane is 1.73 times the RMS error of two equal components, 1.96 times that of one alone;
    # an RMS of so many trials is known to 3 / sqrt(2 TRIALS).
    ratio = found.radius.mean(axis=0) / np.sqrt(np.mean(found.error**2, axis=0))
    slack = 3.0 / np.sqrt(2.0 * TRIALS)
    assert (ratio > 1.73 * (1.0 - slack)).all()
    assert (ratio < 1.96 * (1.0 + slack)).all()
    assert found.spurious_pitch <= 0.08


@pytest.mark.parametrize(
    ("hinge", "noise"),
    [
        (Hinge(), wander(2e-3)),
        (Hinge(), skin(5e-3)),
        (Hinge(top_deg=60.0), smooth_skin(5e-3)),
        (Hinge(top_deg=60.0), turning(np.radians(2.0))),
        (Hinge(markers=3), skin(5e-3)),
        (Hinge(top_deg=60.0, markers=3), smooth_skin(5e-3)),
        (Hinge(still=True), smooth_skin(5e-3)),
    ],
    ids=["wander", "skin", "smooth skin", "turning", "three markers", "three, smooth", "still"],
)
def test_markers_that_move_widen_the_interval_by_what_they_do(hinge: Hinge, noise: Noise) -> None:
    found = coverage(hinge, noise, TRIALS, seed=4, pitch=True)
    assert (found.held[[0, 2]] >= fewest(0.90)).all()
    assert (found.held[[1, 3]] >= fewest(0.88)).all()
    assert (found.sharpness < 2.2).all()
    assert found.spurious_pitch <= 0.08


def test_more_cycles_of_skin_do_not_undo_the_interval() -> None:
    found = coverage(Hinge(cycles=4), skin(5e-3), 40, seed=5)
    assert (found.held >= fewest(0.88, 40)).all()


def test_a_cluster_that_goes_with_the_flexion_is_held_where_it_is_stated() -> None:
    moved = turning_with_flexion(np.radians(2.0), 2e-3)
    stated = (
        SkinMotion(segment="distal", shift=2e-3, turn=np.radians(2.0)),
        SkinMotion(segment="proximal", shift=1e-3, turn=np.radians(1.0)),
    )
    told = coverage(Hinge(), moved, TRIALS, seed=6, skin=stated)
    assert (told.held >= fewest(0.92)).all()
    # No single trial shows it: that is why it is to be stated.
    assert (coverage(Hinge(), moved, TRIALS, seed=6).held < 0.5).all()


@pytest.mark.parametrize("noise", [smooth_skin(5e-3), wander(2e-3)], ids=["smooth skin", "wander"])
@pytest.mark.parametrize("markers", [3, 4])
def test_noise_that_is_not_white_is_as_sure_as_the_markers_that_show_it(markers: int, noise: Noise) -> None:
    """The model of its spectrum adds nothing to what 3 M - 6 coordinates tell, and white noise nearly all."""
    hinge, rng = Hinge(top_deg=60.0, markers=markers), np.random.default_rng(8)
    for kind, most in ((noise, 3 * markers - 6), (white(), np.inf)):
        case = seen(hinge, kind(hinge, rng))
        found = case.clusters[1].covariance(fitted(case)[1])
        assert found is not None
        assert (found.freedom == most).all() if np.isfinite(most) else found.weight @ found.freedom > 100.0


def test_the_markers_covariance_is_unbiased_for_skin() -> None:
    """Squared errors over many trials have the mean of the covariance, whatever the correlation."""
    rng = np.random.default_rng(7)
    hinge, kind = Hinge(top_deg=90.0, still=True), smooth_skin(2e-3)
    square, stated = [], []
    for _ in range(100):
        case = seen(hinge, kind(hinge, rng))
        fit, influence = fitted(case)
        found = case.clusters[0].covariance(influence)
        assert found is not None
        square.append(line_errors(fit.proximal, LINE)[0] ** 2)
        stated.append(np.trace(found.mean[:2, :2]))
    # Mean of 100 squares of two components: 0.1 to 0.14 of its size, and the stated ones' own 0.05.
    assert np.mean(square) / np.mean(stated) == pytest.approx(1.0, abs=0.4)


@pytest.mark.parametrize(("range_deg", "expected"), [(20, 2.9), (60, 0.97), (90, 0.67), (140, 0.45)])
@pytest.mark.parametrize("cycles", [1, 5])
def test_the_axis_turns_with_its_cluster_by_the_known_share(range_deg: int, expected: float, cycles: int) -> None:
    angle = Hinge(top_deg=range_deg, cycles=cycles).angle
    assert skin_sensitivity(angle) == pytest.approx(expected, rel=0.02)


def test_the_share_is_what_a_fit_does() -> None:
    """Poses of a cluster that turns by 1 deg across the axis with the flexion, fitted as they are."""
    hinge = Hinge(top_deg=60.0, still=True)
    course = np.sin(0.5 * hinge.angle) / np.sin(np.radians(30.0))
    joint = joint_poses(hinge.angle, np.zeros(hinge.frames))
    line = dq.transform_lines(dq.conjugate(START), LINE)
    across = np.cross(line[:3], [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    turned = dq.exp(0.5 * np.radians(1.0) * course[:, None] * np.concatenate([across, np.zeros(3)]))
    # Weights under which the rotations alone tell the direction.
    weights = np.broadcast_to(np.diag([1e-6] * 3 + [1.0] * 3), (hinge.frames, 6, 6))
    fit = fit_joint(dq.multiply(joint, turned), weights, LINE, NEAR)
    assert np.degrees(line_errors(fit.proximal, LINE)[0]) == pytest.approx(skin_sensitivity(hinge.angle), rel=0.05)


def test_the_influence_is_the_derivative_of_the_fit() -> None:
    rng = np.random.default_rng(9)
    hinge = Hinge(top_deg=80.0)
    case = seen(hinge, white(1e-7)(hinge, rng))
    fit, influence = fitted(case)
    covariance = joint_covariance(case.joint, *case.noise)
    small = 1e-6 * rng.normal(size=(hinge.frames, 6))
    for psi, joint in (
        (influence.of_distal, dq.multiply(case.joint, dq.exp(0.5 * small))),
        # A proximal pose A exp(x) makes the relative pose exp(-x) J.
        (influence.of_proximal, dq.multiply(dq.exp(-0.5 * small), case.joint)),
    ):
        moved = fit_joint(joint, covariance, LINE, dq.pose_from_dual_quat(fit.proximal)[1])
        change = 2.0 * dq.log(dq.canonical(dq.multiply(dq.conjugate(fit.proximal), moved.proximal)))
        expected = np.einsum("fpi,fi->p", psi, small)
        assert change[:2] == pytest.approx(expected[:2], rel=0.02, abs=1e-9)


def test_radii_do_not_depend_on_the_frames_of_the_bodies() -> None:
    rng = np.random.default_rng(10)
    hinge = Hinge(top_deg=70.0)
    case = seen(hinge, skin(2e-3)(hinge, rng))
    interval = interval_of(case, fitted(case)[1])
    turn = dq.dual_quat_from_pose(qn.quat_from_rotation_vector([0.4, -0.9, 0.3]), [0.05, -0.02, 0.08])
    other = dq.dual_quat_from_pose(qn.quat_from_rotation_vector([-1.0, 0.2, 0.5]), [-0.03, 0.04, 0.01])
    changes = {"proximal": turn, "distal": other}
    moved = Seen(
        dq.multiply(dq.multiply(dq.conjugate(turn), case.joint), other),
        tuple(
            ClusterMotion(
                segment=cluster.segment,
                shape=dq.transform_points(dq.conjugate(changes[cluster.segment]), cluster.shape),
                nonrigid=cluster.nonrigid,
            )
            for cluster in case.clusters
        ),
        case.noise,
    )
    covariance = joint_covariance(case.joint, *case.noise)
    into = adjoint(dq.conjugate(other))
    turned = into @ covariance @ into.T
    line = dq.transform_lines(dq.conjugate(turn), LINE)
    near = dq.transform_points(dq.conjugate(turn), dq.pose_from_dual_quat(fitted(case)[0].proximal)[1])
    fit = fit_joint(moved.joint, turned, line, near)
    same = joint_interval(influence_of_fit(fit, moved.joint, turned), moved.clusters)
    for rows in ROWS:
        first, second = interval.radii(rows), same.radii(rows)
        assert second["A"] == pytest.approx(first["A"], rel=1e-4)
        # The residuals' coordinates, whose spectra B joins, hang on the frames where noise is not alike in all of them.
        assert second["B"] == pytest.approx(first["B"], rel=5e-3)
        assert same.decided_by(rows) == interval.decided_by(rows)


def test_with_the_rms_of_the_markers_alone_the_interval_survives_skin_over_eight_cycles() -> None:
    """What `analyze` keeps of the markers; a formula for white noise covers a tenth here."""
    found = coverage(Hinge(top_deg=60.0, cycles=8), skin(5e-3), 30, seed=904, rms_alone=True)
    assert (found.held >= 0.85).all()
    assert (found.sharpness <= 2.0).all()


def test_nonrigid_coordinates_are_what_no_pose_explains() -> None:
    rng = np.random.default_rng(11)
    shape = Hinge().shapes[1]
    twist = 1e-6 * rng.normal(size=(5, 6))
    moved = dq.transform_points(dq.exp(0.5 * twist)[:, None, :], shape)
    assert np.abs(nonrigid_coordinates(moved, shape)).max() < 1e-10
    off = rng.normal(size=(5, 4, 3))
    z = nonrigid_coordinates(shape + off, shape)
    jacobian = np.concatenate(
        [np.stack([np.cross(e, shape) for e in np.eye(3)], axis=2), np.tile(np.eye(3), (4, 1, 1))], 2
    )
    rest = [np.linalg.lstsq(jacobian.reshape(12, 6), row.ravel(), rcond=None)[1][0] for row in off]
    assert np.sum(z**2, axis=1) == pytest.approx(np.array(rest))


def test_an_rms_alone_tells_skin_from_white_noise() -> None:
    rng = np.random.default_rng(12)
    hinge = Hinge(top_deg=100.0, still=True)
    shape = hinge.shapes[1]
    ratio = {}
    for name, kind in (("white", white()), ("skin", skin(5e-3))):
        case = seen(hinge, kind(hinge, rng))
        _, influence = fitted(case)
        z = case.clusters[0].nonrigid
        assert z is not None
        rms = np.sqrt(np.sum(z**2, axis=1) / len(shape))
        whole = nonrigid_covariance(influence, shape, z, segment="distal")
        alone = residual_covariance(influence, shape, rms, segment="distal")
        assert whole is not None
        assert alone is not None
        ratio[name] = np.sqrt(np.trace(alone.mean[:2, :2]) / np.trace(whole.mean[:2, :2]))
    assert ratio["white"] == pytest.approx(1.0, abs=0.1)
    assert 0.4 < ratio["skin"] < 2.5


@pytest.mark.parametrize("spread", [(0.03, 0.03, 0.0), (0.12, 0.02, 0.02), (0.05, 0.04, 0.03)])
def test_four_markers_stand_for_those_that_make_such_turns(spread: tuple[float, float, float]) -> None:
    """Planar, long and roundish clusters, turned; a pose has no more of its markers than this covariance."""
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    shape = qn.rotate(qn.quat_from_rotation_vector([0.3, -0.8, 0.5]), corners * np.array(spread))
    wanted = covariance_from_markers(shape, 2e-4)
    like = cluster_like(wanted)
    assert like.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    assert covariance_from_markers(like, 2e-4) == pytest.approx(wanted, rel=1e-6, abs=1e-20)


def test_the_number_of_markers_is_told_by_how_their_errors_stand_to_the_jitter() -> None:
    """Three leave 3 sigma^2 of squares a frame and a place of sigma^2 / 3, four 6 sigma^2 / 4 and sigma^2 / 4."""
    rng = np.random.default_rng(4)
    hinge = Hinge(top_deg=100.0, still=True)
    case = seen(hinge, white()(hinge, rng))
    _, influence = fitted(case)
    shape = hinge.shapes[1]
    for count in (3, 4):
        freedom = 3 * count - 6
        rms = WHITE_M * np.sqrt(rng.chisquare(freedom, hinge.frames) / count)
        told = residual_covariance(influence, shape, rms, segment="distal", pose_variance=WHITE_M**2 / count)
        assert told is not None
        # What three markers make of white noise, in the place of four that have the jitter's shape.
        psi = influence.of_distal @ np.linalg.cholesky(covariance_from_markers(shape, 1.0))
        true = 4.0 / count * WHITE_M**2 * np.tensordot(psi, psi, axes=((0, 2), (0, 2)))
        assert np.diag(told.mean) == pytest.approx(np.diag(true), rel=0.15)


@pytest.mark.parametrize("rest", ["first frame", "middle"])
def test_errors_alone_hold_the_axis_of_skin_that_goes_with_the_flexion(rest: str) -> None:
    """The residuals alone held 4 of 10 in one cycle, and 1 of 30 in eight; the shape is that of a frame at rest."""
    rng = np.random.default_rng(8)
    hinge = Hinge(top_deg=140.0, cycles=2)
    held = []
    for _ in range(TRIALS):
        arm, forearm = skin(5e-3)(hinge, rng)
        off = (arm, forearm) if rest == "first frame" else (arm - arm[112], forearm - forearm[112])
        case = with_rms_alone(seen(hinge, off))
        unseen = tuple(
            replace(one, shape=cluster_like(noise.covariance), pose_variance=WHITE_M**2 / len(one.shape))
            for one, noise in zip(case.clusters, case.noise, strict=True)
            if noise is not None
        )
        fit, influence = fitted(case)
        interval = joint_interval(influence, unseen)
        error = line_errors(fit.proximal, LINE)
        held.append([error[0] <= interval.radius(ROWS[0]), error[1] <= interval.radius(ROWS[1])])
    direction, place = np.mean(held, axis=0)
    assert direction >= fewest(0.9)
    assert place >= fewest(0.88)


def test_frames_whose_markers_hide_take_their_neighbors_and_too_many_tell_nothing() -> None:
    rng = np.random.default_rng(13)
    hinge = Hinge(still=True)
    case = seen(hinge, skin(5e-3)(hinge, rng))
    _, influence = fitted(case)
    z, shape = case.clusters[0].nonrigid, case.clusters[0].shape
    assert z is not None
    whole = nonrigid_covariance(influence, shape, z, segment="distal")
    holes = z.copy()
    holes[rng.random(len(z)) < 0.2] = np.nan
    some = nonrigid_covariance(influence, shape, holes, segment="distal")
    assert whole is not None
    assert some is not None
    assert some.radius(0.95) == pytest.approx(whole.radius(0.95), rel=0.05)
    holes[: len(z) * 2 // 3] = np.nan
    assert nonrigid_covariance(influence, shape, holes, segment="distal") is None


def test_frames_that_do_not_determine_the_joint_have_no_radius() -> None:
    hinge = Hinge(top_deg=0.0, still=True)
    case = seen(hinge, (np.zeros((hinge.frames, 4, 3)), np.zeros((hinge.frames, 4, 3))))
    noise = covariance_from_markers(hinge.shapes[1], 2e-4)
    covariance = np.broadcast_to(noise, (hinge.frames, 6, 6))
    fit = fit_joint(case.joint, covariance, LINE, np.zeros(3))
    interval = joint_interval(influence_of_fit(fit, case.joint, covariance), ())
    assert np.isnan(interval.radius(ROWS[0]))
    assert interval.decided_by(ROWS[0]) is None


def test_quantiles_are_those_of_normal_and_student() -> None:
    plane = np.diag([2.0, 2.0])
    assert Mixture.of_one(plane).radius(0.95) == pytest.approx(float(confidence_radius(plane)), rel=1e-3)
    assert Mixture.of_one(np.diag([2.0, 0.5])).radius(0.95) == pytest.approx(
        float(confidence_radius(np.diag([2.0, 0.5]))), rel=0.006
    )
    assert Mixture.of_one(np.array([[9.0]]), 6.0).radius(SURE) == pytest.approx(
        3.0 * t.ppf(0.5 + SURE / 2, 6), rel=1e-6
    )
    assert Mixture.of_one(np.eye(3)).radius(0.95) == pytest.approx(np.sqrt(7.814728), rel=1e-4)


def test_independent_errors_add() -> None:
    one, other = Mixture.of_one(np.diag([4.0, 4.0]), 6.0), Mixture.of_one(np.diag([4.0, 4.0]), 6.0)
    both = one.plus(other)
    assert both.mean == pytest.approx(np.diag([8.0, 8.0]))
    assert both.freedom == pytest.approx([12.0])  # Welch and Satterthwaite: equal parts double it
    assert one.plus(Mixture.of_one(np.zeros((2, 2)))).radius(0.95) == pytest.approx(one.radius(0.95))


def test_the_pose_of_a_body_carries_its_lines() -> None:
    rng = np.random.default_rng(14)
    covariance = covariance_from_markers(Hinge().shapes[0] + [0.02, 0.1, -0.05], 2e-4)
    point = np.cross(LINE[:3], LINE[3:])
    twist = rng.multivariate_normal(np.zeros(6), covariance, size=20_000)
    moved = dq.transform_points(dq.exp(0.5 * twist), point) - point
    h = LINE[:3] / np.linalg.norm(LINE[:3])
    place = np.linalg.norm(moved - (moved @ h)[:, None] * h, axis=1)
    turn = np.linalg.norm(np.cross(twist[:, :3], h), axis=1)
    cone, radius = pose_radii(covariance, h, point)
    assert np.mean(turn <= cone) == pytest.approx(0.95, abs=0.006)
    assert np.mean(place <= radius) == pytest.approx(0.95, abs=0.006)


def test_a_mixture_of_covariances_holds_its_share() -> None:
    """Along one direction it is a mixture of Student's t, each scaled by its own standard deviation."""
    variance, freedom, weight = np.array([1e-6, 9e-6, 4e-6]), np.array([3.0, 8.0, np.inf]), np.array([0.5, 0.2, 0.3])
    mixture = Mixture(variance[:, None, None], freedom, weight)

    def outside(radius: float) -> float:
        return float(2.0 * np.sum(weight * t.sf(radius / np.sqrt(variance), freedom)))

    for level in (0.5, 0.95, SURE):
        wanted = brentq(lambda radius, level=level: outside(radius) - (1.0 - level), 0.0, 1.0, xtol=1e-16)
        assert mixture.radius(level) == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("power", [1.5, 3.0])
def test_stated_skin_is_what_a_fit_does_when_its_cluster_goes_so(power: float) -> None:
    """Turned and shifted along the worst of the courses, whichever that is where the joint stays longest."""
    hinge = Hinge(top_deg=70.0, still=True)
    angle = np.radians(70.0) * np.linspace(0.0, 1.0, hinge.frames) ** power
    exact = joint_poses(angle, np.zeros(hinge.frames))
    covariance = np.broadcast_to(covariance_from_markers(hinge.shapes[1], 2e-4), (hinge.frames, 6, 6))
    fit = fit_joint(exact, covariance, LINE, NEAR)
    influence = influence_of_fit(fit, exact, covariance)
    u = angle / angle[-1]
    size, shift = 1e-4, 1e-5
    told = []
    for course in (u, np.sin(0.5 * np.pi * u), u**2, np.sin(np.pi * u)):
        square = np.zeros(2)
        for twist in np.diag([size] * 3 + [shift] * 3):
            moved = dq.multiply(exact, dq.exp(0.5 * course[:, None] * twist))
            after = fit_joint(moved, covariance, LINE, NEAR, start=fit)
            for k, (one, other) in enumerate(((fit.proximal, after.proximal), (fit.distal, after.distal))):
                direction = dq.transform_lines(dq.conjugate(one), dq.transform_lines(other, Z_LINE))
                square[k] += np.sum(direction[:2] ** 2)
        told.append(square / 3.0)
    found = skin_covariance(influence, (SkinMotion(segment="distal", turn=size, shift=shift),))
    tilts = np.array([np.trace(rows @ found @ rows.T) for rows in (ROWS[0], ROWS[2])])
    assert tilts == pytest.approx(np.max(told, axis=0), rel=1e-3)
