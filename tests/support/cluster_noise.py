"""Synthetic hinges whose markers err in the ways that real ones do, and how often an interval holds the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from poses import random_poses
from scipy.signal import butter, sosfiltfilt
from trials import ARM, FOREARM, LINE, START, joint_poses

from elbowscrew import Recording
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import nonrigid_coordinates, pose_from_points
from elbowscrew.geometry.arrays import Bool, Float
from elbowscrew.model import Marker, PoseNoise
from elbowscrew.motion.joint.influence import Influence, influence_of_fit
from elbowscrew.motion.joint.interval import SURE, ClusterMotion, JointInterval, SkinMotion, joint_interval
from elbowscrew.motion.joint.joint_fit import LineFit, fit_joint
from elbowscrew.motion.screws.pose_noise import covariance_from_markers
from elbowscrew.motion.screws.uncertainty import joint_covariance

Noise = Callable[["Hinge", np.random.Generator], tuple[Float, Float]]

RATE_HZ = 100.0
FRAMES_A_CYCLE = 450
WHITE_M = 2e-4
NEAR = dq.pose_from_dual_quat(START)[1]
_LENGTH_RAD = 1.05


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """A hinge that flexes and extends smoothly, seen by two clusters."""

    top_deg: float = 140.0
    cycles: int = 1
    markers: int = 4
    still: bool = False
    exact: Float | None = None

    @property
    def angle(self) -> Float:
        return np.asarray(
            np.radians(self.top_deg) * 0.5 * (1.0 - np.cos(np.arange(self.frames) * 2.0 * np.pi / FRAMES_A_CYCLE))
        )

    @property
    def frames(self) -> int:
        return FRAMES_A_CYCLE * self.cycles

    @property
    def shapes(self) -> tuple[Float, Float]:
        """Markers of the proximal and of the distal cluster about their centroids."""
        proximal, distal = (shape[: self.markers] for shape in (ARM, FOREARM))
        return proximal - proximal.mean(axis=0), distal - distal.mean(axis=0)


class Seen(NamedTuple):
    joint: Float
    clusters: tuple[ClusterMotion, ...]
    noise: tuple[PoseNoise | None, PoseNoise]


def seen(hinge: Hinge, noise: tuple[Float, Float]) -> Seen:
    """Poses and non-rigid coordinates of clusters whose markers are off by (F, M, 3) in their bodies' frames."""
    joint = joint_poses(hinge.angle, np.zeros(hinge.frames)) if hinge.exact is None else hinge.exact
    clusters, told = [], []
    for segment, shape, off in zip(("proximal", "distal"), hinge.shapes, noise, strict=True):
        if segment == "proximal" and hinge.still:
            continue
        own = pose_from_points(shape, shape + off)
        z = nonrigid_coordinates(dq.transform_points(dq.conjugate(own)[:, None, :], shape + off), shape)
        clusters.append(ClusterMotion(segment="distal" if segment == "distal" else "proximal", shape=shape, nonrigid=z))
        covariance = covariance_from_markers(shape, float(np.sqrt(np.mean(z**2))))
        told.append(PoseNoise(covariance=covariance, source="known", marker_noise=None))
        joint = dq.multiply(joint, own) if segment == "distal" else dq.multiply(dq.conjugate(own), joint)
    return Seen(joint, tuple(clusters), (None, told[0]) if hinge.still else (told[0], told[1]))


def recording_of(hinge: Hinge, noise: tuple[Float, Float], lost: Bool | None = None) -> Recording:
    """Markers alone, the proximal cluster anywhere in the laboratory, the distal one not seen in some frames (F,)."""
    joint = joint_poses(hinge.angle, np.zeros(hinge.frames))
    arm = random_poses((), 5)
    markers = []
    for letter, pose, shape, off in zip("AF", (arm, dq.multiply(arm, joint)), hinge.shapes, noise, strict=True):
        places = dq.transform_points(np.broadcast_to(pose, (hinge.frames, 8))[:, None, :], shape + off)
        if letter == "F" and lost is not None:
            places = np.where(lost[:, None, None], np.nan, places)
        markers += [Marker(name=f"{letter}{k}", position=places[:, k]) for k in range(len(shape))]
    time_s = np.arange(hinge.frames) / 100.0
    return Recording(bodies=(), frame=np.arange(hinge.frames), time_s=time_s, rate_hz=100.0, markers=tuple(markers))


def fitted(case: Seen, *, screw: bool = False, robust: bool = False) -> tuple[LineFit, Influence]:
    covariance = joint_covariance(case.joint, *case.noise)
    fit = fit_joint(case.joint, covariance, LINE, NEAR, screw=screw, robust=robust)
    return fit, influence_of_fit(fit, case.joint, covariance)


def line_errors(line_pose: Float, truth: Float) -> tuple[float, float]:
    """Angle (rad) of a true line to the z axis of a pose, and its distance (m) across that axis at its origin."""
    off = dq.transform_lines(dq.conjugate(line_pose), truth)
    h = off[:3] / np.linalg.norm(off[:3])
    point = np.cross(h, off[3:] / np.linalg.norm(off[:3]))
    point = point - h * (point[2] / h[2])
    return float(np.arctan2(np.hypot(h[0], h[1]), abs(h[2]))), float(np.hypot(point[0], point[1]))


@dataclass(frozen=True)
class Held:
    """Errors and 95 % radii, shape (trials, numbers)."""

    error: Float
    radius: Float

    @property
    def held(self) -> Float:
        return np.asarray(np.mean(self.error <= self.radius, axis=0))

    @property
    def sharpness(self) -> Float:
        return np.asarray(self.radius.mean(axis=0) / np.quantile(self.error, 0.95, axis=0))


@dataclass(frozen=True)
class Coverage(Held):
    """One column each: direction and place in the proximal body, the same in the distal one."""

    spurious_pitch: float


ROWS = tuple(np.eye(9)[k : k + 2] for k in (0, 2, 4, 6))


def interval_of(case: Seen, influence: Influence, skin: tuple[SkinMotion, ...] = ()) -> JointInterval:
    return joint_interval(influence, case.clusters, skin=skin)


def with_rms_alone(case: Seen) -> Seen:
    """What an analysis keeps of the markers: their RMS in each frame."""
    kept = tuple(
        replace(one, nonrigid=None, rms=np.sqrt(np.sum(one.nonrigid**2, axis=1) / len(one.shape)))
        for one in case.clusters
        if one.nonrigid is not None
    )
    return case._replace(clusters=kept)


def coverage(
    hinge: Hinge,
    noise: Noise,
    trials: int,
    *,
    seed: int,
    skin: tuple[SkinMotion, ...] = (),
    pitch: bool = False,
    rms_alone: bool = False,
) -> Coverage:
    """Errors and 95 % radii of a hinge's line in both bodies, and how often a pitch is told that is not there."""
    rng = np.random.default_rng(seed)
    truth = LINE, dq.transform_lines(dq.conjugate(START), LINE)
    error, radius, pitched = [], [], 0
    for _ in range(trials):
        case = seen(hinge, noise(hinge, rng))
        case = with_rms_alone(case) if rms_alone else case
        fit, influence = fitted(case)
        interval = interval_of(case, influence, skin)
        error.append([*line_errors(fit.proximal, truth[0]), *line_errors(fit.distal, truth[1])])
        radius.append([interval.radius(rows) for rows in ROWS])
        if pitch:
            screw, screwed = fitted(case, screw=True)
            pitched += abs(screw.pitch) > interval_of(case, screwed, skin).radius(np.eye(10)[9:], SURE)
    return Coverage(np.array(error), np.array(radius), pitched / trials)


def white(size: float = WHITE_M) -> Noise:
    """Noise of its own in each coordinate of each frame."""

    def noise(hinge: Hinge, rng: np.random.Generator) -> tuple[Float, Float]:
        first, second = (rng.normal(scale=size, size=(hinge.frames, *shape.shape)) for shape in hinge.shapes)
        return first, second

    return noise


def wander(size: float) -> Noise:
    """Each marker wanders slowly, as the calibration or a soft mount makes it."""

    def noise(hinge: Hinge, rng: np.random.Generator) -> tuple[Float, Float]:
        first, second = (
            size * _slow(rng, hinge.frames, shape.shape) + quiet
            for shape, quiet in zip(hinge.shapes, white()(hinge, rng), strict=True)
        )
        return first, second

    return noise


def skin(size: float) -> Noise:
    """Each marker goes its own way with the flexion, half as far on the proximal body."""

    def one(hinge: Hinge, rng: np.random.Generator, shape: Float) -> Float:
        way = rng.normal(size=shape.shape)
        way /= np.linalg.norm(way, axis=1)[:, None]
        return course(hinge)[:, None, None] * way

    return _per_cluster(size, one)


def smooth_skin(size: float) -> Noise:
    """Each coordinate of each marker is a smooth random function of the angle, 0 at the start."""

    def one(hinge: Hinge, rng: np.random.Generator, shape: Float) -> Float:
        grid = np.linspace(0.0, np.radians(hinge.top_deg), 60)
        square = np.exp(-0.5 * ((grid[:, None] - grid) / _LENGTH_RAD) ** 2) + 1e-9 * np.eye(60)
        wave = np.linalg.cholesky(square) @ rng.normal(size=(60, shape.size))
        series = np.stack([np.interp(hinge.angle, grid, column) for column in (wave - wave[0]).T], axis=1)
        series = series.reshape(-1, *shape.shape)
        return np.asarray(series / np.sqrt(np.mean(np.sum(series**2, axis=2))))

    return _per_cluster(size, one)


def turning(size: float) -> Noise:
    """Each cluster turns as a whole at random in time, RMS `size` radians; half as much on the proximal body."""

    def one(hinge: Hinge, rng: np.random.Generator, shape: Float) -> Float:
        turn = _slow(rng, hinge.frames, (3,))
        turn /= np.sqrt(np.mean(np.sum(turn**2, axis=1)))
        return np.asarray(np.cross(turn[:, None, :], shape[None]))

    return _per_cluster(size, one)


def turning_with_flexion(turn: float, shift: float) -> Noise:
    """Each cluster turns (rad) and shifts (m) as a whole with the flexion; half as much on the proximal body."""

    def one(hinge: Hinge, rng: np.random.Generator, shape: Float) -> Float:
        turned, shifted = rng.normal(size=(2, 3))
        moved = turn * np.cross(turned / np.linalg.norm(turned), shape) + shift * shifted / np.linalg.norm(shifted)
        return np.asarray(course(hinge)[:, None, None] * moved)

    return _per_cluster(1.0, one)


def course(hinge: Hinge) -> Float:
    """How skin goes with the flexion: the sine of half the angle, 1 at the top."""
    return np.asarray(np.sin(0.5 * hinge.angle) / np.sin(0.5 * np.radians(hinge.top_deg)))


def _per_cluster(size: float, one: Callable[[Hinge, np.random.Generator, Float], Float]) -> Noise:
    def noise(hinge: Hinge, rng: np.random.Generator) -> tuple[Float, Float]:
        first, second = (
            share * size * one(hinge, rng, shape) + quiet
            for share, shape, quiet in zip((0.5, 1.0), hinge.shapes, white()(hinge, rng), strict=True)
        )
        return first, second

    return noise


def _slow(rng: np.random.Generator, count: int, shape: tuple[int, ...]) -> Float:
    margin = 400
    series = rng.normal(size=(count + 2 * margin, *shape))
    slow = sosfiltfilt(butter(2, 0.8, fs=RATE_HZ, output="sos"), series, axis=0)[margin : margin + count]
    return np.asarray(slow / np.sqrt(np.mean(slow**2)))


def wandering(top_deg: float, turn: float, shift: float, *, cycles: int = 1) -> Hinge:
    """A joint that turns about `LINE` in the middle of its range; the axis turns and shifts in all by so much."""
    plain = Hinge(top_deg=top_deg, cycles=cycles)
    top = np.radians(top_deg)
    steps = 2000
    middle = (np.arange(steps) + 0.5) / steps
    across = np.cross(LINE[:3], [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    point = np.cross(LINE[:3], LINE[3:]) + 0.1 * LINE[:3]
    quat = dq.exp(0.5 * np.stack([np.concatenate([turn * (m - 0.5) * across, np.zeros(3)]) for m in middle]))[:, :4]
    h = np.stack([dq.transform_points(np.concatenate([q, np.zeros(4)]), LINE[:3]) for q in quat])
    # The axis turns about the point where the errors are told, so that turn and shift are what they are called.
    place = point + shift * (middle - 0.5)[:, None] * across
    twist = np.concatenate([h, np.cross(place, h)], axis=1)
    poses = [dq.exp(np.zeros(6))]
    for each in dq.exp(0.5 * top / steps * twist):
        poses.append(dq.normalize(dq.multiply(each, poses[-1])))
    table = dq.continuous_signs(np.stack(poses))
    at = plain.angle / top * steps
    low = np.minimum(at.astype(int), steps - 1)
    share = (at - low)[:, None]
    between = dq.multiply(table[low], dq.exp(share * dq.log(dq.multiply(dq.conjugate(table[low]), table[low + 1]))))
    return Hinge(top_deg=top_deg, cycles=cycles, exact=dq.multiply(between, START))
