"""Two axes and balls seen by markers that err as those of `cluster_noise`, and how often intervals hold the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import moving_joints as mj
import numpy as np
from cluster_noise import FRAMES_A_CYCLE, Held, Hinge, Noise, Seen, seen, white, with_rms_alone
from numpy.typing import NDArray
from trials import LINE, START

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.geometry.sensitivity import NORMAL_95
from elbowscrew.motion.joint.every_frame import Everywhere, numbers_everywhere
from elbowscrew.motion.joint.interval import JointInterval
from elbowscrew.motion.joint.likelihood import Fit, Mechanism, fit_mechanism
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import Ball
from elbowscrew.motion.joint.starts import _from_lines
from elbowscrew.motion.joint.two_axes import TwoAxesMechanism, axes_geometry, geometry_slopes
from elbowscrew.motion.joint.two_axes_told import axes_lines
from elbowscrew.motion.joint.type_interval import Evidence, interval_of_type
from elbowscrew.motion.screws.uncertainty import joint_covariance

Kind = Literal["two_axes", "ball"]
POINT = np.cross(LINE[:3], LINE[3:])
NORMAL = mj.unit(np.cross(LINE[:3], [0.0, 0.0, 1.0]))
BETWEEN, APART = np.radians(86.0), 0.01
ACROSS = qn.rotate(qn.quat_from_rotation_vector(BETWEEN * NORMAL), LINE[:3])
# At the reference; the feet of the common normal are where the places of the axes are told.
AXIS2 = mj.line(ACROSS, POINT + APART * NORMAL)
CENTER = POINT + 0.02 * NORMAL


def second_angle(hinge: Hinge) -> Float:
    """Pronation of half the range, an eighth of a turn behind the flexion, so that no way is retraced."""
    phase = np.arange(hinge.frames) * 2.0 * np.pi / (hinge.frames / hinge.cycles)
    return np.asarray(np.radians(0.5 * hinge.top_deg) * 0.5 * (1.0 - np.cos(phase - 0.8)))


def joint_of(kind: Kind, top_deg: float, cycles: int = 1) -> Hinge:
    """A moving joint for the kinds of noise, which go with its flexion."""
    plain = Hinge(top_deg=top_deg, cycles=cycles)
    first, second = mj.turned(plain.angle, LINE), mj.turned(second_angle(plain), AXIS2)
    if kind == "two_axes":
        return Hinge(top_deg=top_deg, cycles=cycles, exact=dq.multiply(dq.multiply(first, second), START))
    third = mj.turned(0.5 * second_angle(plain)[::-1], mj.line(NORMAL, CENTER))
    about = [
        mj.turned(angle, mj.line(h, CENTER)) for angle, h in ((plain.angle, LINE[:3]), (second_angle(plain), ACROSS))
    ]
    exact = dq.multiply(dq.multiply(dq.multiply(about[0], about[1]), third), START)
    return Hinge(top_deg=top_deg, cycles=cycles, exact=exact)


def skin_of_both(size: float) -> Noise:
    """Each marker goes one way with the flexion and another with the pronation, half as far on the proximal body."""

    def noise(hinge: Hinge, rng: np.random.Generator) -> tuple[Float, Float]:
        courses = [np.sin(0.5 * a) / np.sin(0.5 * np.ptp(a)) for a in (hinge.angle, second_angle(hinge))]
        quiet = white()(hinge, rng)
        off = []
        for share, shape, rest in zip((0.5, 1.0), hinge.shapes, quiet, strict=True):
            ways = rng.normal(size=(2, *shape.shape))
            ways *= share * size / np.sqrt(2.0) / np.linalg.norm(ways, axis=2)[..., None]
            off.append(np.einsum("cf,cmk->fmk", courses, ways) + rest)
        return off[0], off[1]

    return noise


@dataclass(frozen=True)
class TypedCoverage(Held):
    """Of the numbers that `names` says; `told` are those (trials, numbers) that an analysis gives an interval for."""

    names: tuple[str, ...]
    told: NDArray[np.bool_]

    @property
    def told_share(self) -> Float:
        """In how many of the trials there is an interval."""
        return np.asarray(self.told.mean(axis=0))

    @property
    def missed_share(self) -> Float:
        """In how many of all trials there is one that does not hold the truth."""
        return np.asarray(np.mean(self.told & (self.error > self.radius), axis=0))


def fitted_type(kind: Kind, case: Seen) -> tuple[Fit[Mechanism], JointInterval]:
    """The joint fitted from a start at the truth, and its interval."""
    poses = Poses.of(case.joint, joint_covariance(case.joint, *case.noise))
    start: Mechanism
    if kind == "ball":
        start = Ball.start(case.joint)
    else:
        back = dq.conjugate(START)
        one, two = (
            (LINE[:3], POINT),
            (dq.transform_lines(back, AXIS2)[:3], dq.transform_points(back, POINT + APART * NORMAL)),
        )
        start = _from_lines(case.joint, one, two)
    fit = fit_mechanism(start, poses)
    return fit, interval_of_type(fit, poses, Evidence(noise_known=True, clusters=case.clusters))


def typed_coverage(
    kind: Kind, hinge: Hinge, noise: Noise, trials: int, *, seed: int, rms_alone: bool = True
) -> TypedCoverage:
    """How far the numbers of a joint are from the truth, and how far they are told to be at most."""
    rng = np.random.default_rng(seed)
    error, radius, told = [], [], []
    for _ in range(trials):
        case = seen(hinge, noise(hinge, rng))
        fit, interval = fitted_type(kind, with_rms_alone(case) if rms_alone else case)
        mechanism = fit.mechanism
        found = _of_ball(mechanism, interval) if isinstance(mechanism, Ball) else _of_axes(mechanism, interval)
        error.append(found[0])
        radius.append(found[1])
        told.append([True, True])
        if isinstance(mechanism, TwoAxesMechanism):
            one, two = (line.determined for line in axes_lines(mechanism, fit, START, interval))
            told[-1] = [one, one, two, two, one and two, one and two]
    names: tuple[str, ...] = ("center in the proximal body", "center in the distal body")
    if kind == "two_axes":
        names = ("direction 1", "place 1", "direction 2", "place 2", "angle between", "distance")
    return TypedCoverage(np.array(error), np.array(radius), names, np.array(told))


def _of_ball(found: Ball, interval: JointInterval) -> tuple[list[float], list[float]]:
    truth = CENTER, dq.transform_points(dq.conjugate(START), CENTER)
    off = [float(np.linalg.norm(p - q)) for p, q in zip((found.proximal, found.distal), truth, strict=True)]
    return off, [interval.radius(rows) for rows in (np.eye(6)[:3], np.eye(6)[3:])]


def _of_axes(found: Mechanism, interval: JointInterval) -> tuple[list[float], list[float]]:
    assert isinstance(found, TwoAxesMechanism)
    error, radius = [], []
    truth = LINE, dq.transform_lines(dq.conjugate(START), AXIS2)
    for k, (pose, line) in enumerate(zip((found.proximal, found.distal), truth, strict=True)):
        off = dq.transform_lines(dq.conjugate(pose), line)
        off = off if off[2] > 0.0 else -off
        point = np.cross(off[:3], off[3:])
        point = point - off[:3] * (point[2] / off[2])
        error += [float(np.hypot(off[0], off[1])), float(np.hypot(point[0], point[1]))]
        radius += [interval.radius(np.eye(12)[8 * k + n : 8 * k + n + 2]) for n in (0, 2)]
    geometry, slopes = axes_geometry(found), geometry_slopes(found)
    between = min(geometry.angle, np.pi - geometry.angle)
    error += [abs(between - BETWEEN), abs(abs(geometry.distance) - APART)]
    radius += [interval.radius(row[None]) for row in slopes[:2]]
    return error, radius


def angles_held(hinge: Hinge, noise: Noise, trials: int, *, seed: int) -> tuple[Float, Float]:
    """Share (2,) of the errors of two axes' angles within 1.96 deviations: for given axes, and with what these err."""
    truth = np.stack([hinge.angle, second_angle(hinge)], axis=1)
    rng = np.random.default_rng(seed)
    given, whole = [], []
    for _ in range(trials):
        case = seen(hinge, noise(hinge, rng))
        fit, interval = fitted_type("two_axes", case)
        covariance = joint_covariance(case.joint, *case.noise)
        every = Everywhere(case.joint, covariance.__getitem__, np.ones(hinge.frames), covariance[0])
        found = numbers_everywhere(fit.mechanism, every, case.joint[0], interval)
        off = np.abs(found.angle * np.sign(np.sum(found.angle * truth, axis=0)) - (truth - truth[0]))[15::30]
        own, axes = np.sqrt(max(fit.variance, 1.0)) * found.angle_sd[15::30], found.axes_sd[15::30]
        given.append(np.mean(off <= NORMAL_95 * own, axis=0))
        whole.append(np.mean(off <= NORMAL_95 * np.hypot(own, axes), axis=0))
    return np.mean(given, axis=0), np.mean(whole, axis=0)


def angles_in_an_eight(tops_deg: tuple[float, float], frames: int = FRAMES_A_CYCLE) -> Float:
    """Flexion out and back, and pronation that goes to and fro on each of both ways, (F, 2) radians."""
    phase = np.arange(frames) * 2.0 * np.pi / FRAMES_A_CYCLE
    courses = (1.0 - np.cos(phase), np.sin(2.0 * phase))
    return np.stack([np.radians(0.5 * top) * one for top, one in zip(tops_deg, courses, strict=True)], axis=1)


def wandering_elbow(angles: Float, wander_deg: tuple[float, float], rng: np.random.Generator) -> Hinge:
    """Two axes that are `LINE` and `AXIS2` on the mean, each turning by so much in all with its own angle (F, 2).

    The first in the proximal body, the second in the distal one, any way across itself.
    """
    back = dq.conjugate(START)
    second = dq.transform_lines(back, AXIS2), dq.transform_points(back, POINT + APART * NORMAL)
    sizes = [float(np.radians(size)) for size in wander_deg]
    first = _about_a_wandering_axis(angles[:, 0], LINE, POINT, sizes[0], rng)
    other = _about_a_wandering_axis(-angles[:, 1], *second, sizes[1], rng)
    exact = dq.multiply(dq.multiply(first, START), dq.conjugate(other))
    return Hinge(top_deg=float(np.degrees(np.ptp(angles[:, 0]))), exact=exact)


def _about_a_wandering_axis(angle: Float, line: Float, point: Float, size: float, rng: np.random.Generator) -> Float:
    """Poses (F, 8) of a body that turns about an axis through a point, the line itself in the middle of the range."""
    steps = 1000
    across = mj.unit(np.cross(line[:3], rng.normal(size=3)))
    grid = np.linspace(angle.min(), angle.max(), steps + 1)
    tilt = size * (np.arange(steps) + 0.5) / steps - 0.5 * size
    h = np.cos(tilt)[:, None] * line[:3] + np.sin(tilt)[:, None] * np.cross(across, line[:3])
    small = dq.exp(0.5 * (grid[1] - grid[0]) * np.concatenate([h, np.cross(point, h)], axis=1))
    poses = [dq.exp(np.zeros(6))]
    for one in small:
        poses.append(dq.normalize(dq.multiply(one, poses[-1])))
    table = dq.continuous_signs(np.stack(poses))

    def at(where: Float) -> Float:
        place = (where - grid[0]) / (grid[1] - grid[0])
        low = np.clip(place.astype(int), 0, steps - 1)
        step = dq.log(dq.multiply(dq.conjugate(table[low]), table[low + 1]))
        return dq.multiply(table[low], dq.exp((place - low)[:, None] * step))

    return dq.multiply(at(angle), dq.conjugate(at(np.zeros(1))[0]))
