"""Synthetic joints of every type with known numbers: rigid, hinge, two axes, ball, and none of them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quat_from_screw
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import PoseNoise
from elbowscrew.motion.screws.uncertainty import joint_covariance


class MovingJoint(NamedTuple):
    """Exact relative poses (F, 8), and what they were made of, lines (6,) in the body they belong to."""

    poses: Float
    truth: dict[str, Any]


def unit(vector: Float) -> Float:
    return np.asarray(vector / np.linalg.norm(vector))


def smooth(count: int, rng: np.random.Generator) -> Float:
    """A series from 0 to 1 of a few cycles."""
    cycles = rng.uniform(1.0, 4.0)
    time = np.arange(count) / count
    waves = [
        rng.normal() / max(1.0, abs(k - cycles)) * np.sin(1.8 * np.pi * k * time + rng.uniform(0.0, 2.0 * np.pi))
        for k in range(1, int(2.0 * cycles) + 2)
    ]
    series = np.sum(waves, axis=0)
    return np.asarray((series - series.min()) / np.ptp(series))


def line(direction: Float, point: Float) -> Float:
    return np.concatenate([direction, np.cross(point, direction)])


def turned(angle: Float, about: Float) -> Float:
    return dual_quat_from_screw(angle, 0.0 * angle, about[:3], about[3:])


def rest_pose(rng: np.random.Generator) -> Float:
    return dq.dual_quat_from_pose(qn.quat_from_rotation_vector(rng.normal(0.0, 1.0, 3)), rng.normal(0.0, 0.15, 3))


def two_axes(
    count: int,
    ranges_deg: tuple[float, float],
    between_deg: float,
    distance: float,
    rng: np.random.Generator,
) -> MovingJoint:
    """Axis 1 in the proximal body, axis 2 in the distal one; at zero angles so far apart (deg, m)."""
    h1 = unit(rng.normal(size=3))
    p1 = rng.normal(0.0, 0.08, 3)
    normal = unit(np.cross(h1, rng.normal(size=3)))
    h2 = qn.rotate(qn.quat_from_rotation_vector(np.radians(between_deg) * normal), h1)
    p2 = p1 + 0.013 * h1 + distance * normal
    rest = rest_pose(rng)
    first, second = (np.radians(r) * (smooth(count, rng) - rng.uniform()) for r in ranges_deg)
    one, two = line(h1, p1), line(h2, p2)
    poses = dq.multiply(dq.multiply(turned(first, one), turned(second, two)), rest)
    axis2 = dq.transform_lines(dq.conjugate(rest), two)
    return MovingJoint(poses, {"axis1": one, "axis2": axis2, "angles": np.stack([first, second], axis=1)})


def hinge(count: int, range_deg: float, rng: np.random.Generator, pitch: float = 0.0) -> MovingJoint:
    """One axis, with a slide (m) for each radian."""
    axis = line(unit(rng.normal(size=3)), rng.normal(0.0, 0.08, 3))
    angle = np.radians(range_deg) * (smooth(count, rng) - rng.uniform())
    screw = dual_quat_from_screw(angle, pitch * angle, axis[:3], axis[3:])
    return MovingJoint(dq.multiply(screw, rest_pose(rng)), {"axis1": axis, "angles": angle})


def ball(count: int, range_deg: float, rng: np.random.Generator) -> MovingJoint:
    """A center (m) in both bodies."""
    vector = np.radians(range_deg) * np.stack([smooth(count, rng) - 0.5 for _ in range(3)], axis=1)
    turns = qn.multiply(qn.quat_from_rotation_vector(vector), qn.quat_from_rotation_vector(rng.normal(0.0, 1.0, 3)))
    proximal, distal = rng.normal(0.0, 0.08, 3), rng.normal(0.0, 0.15, 3)
    position = proximal - qn.rotate(turns, distal)
    return MovingJoint(dq.dual_quat_from_pose(turns, position), {"proximal": proximal, "distal": distal})


def rigid(count: int, rng: np.random.Generator) -> MovingJoint:
    return MovingJoint(np.repeat(rest_pose(rng)[None], count, axis=0), {})


def free(count: int, range_deg: float, rng: np.random.Generator) -> MovingJoint:
    """A ball whose center goes 15 cm to and fro."""
    exact = ball(count, range_deg, rng)
    shift = 0.15 * np.stack([smooth(count, rng) - 0.5 for _ in range(3)], axis=1)
    pose = dq.dual_quat_from_pose(np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)), shift)
    return MovingJoint(dq.multiply(pose, exact.poses), {})


def noisy(poses: Float, rng: np.random.Generator, rotation_deg: float, place: float) -> tuple[Float, Float]:
    """Both bodies' noise (deg and m a component) put on poses, and the covariance (F, 6, 6) it has."""
    deviation = np.array([np.radians(rotation_deg)] * 3 + [place] * 3)
    errors = rng.normal(size=(2, len(poses), 6)) * deviation
    seen = dq.multiply(dq.multiply(dq.exp(-0.5 * errors[0]), poses), dq.exp(0.5 * errors[1]))
    noise = PoseNoise(covariance=np.diag(deviation**2), source="known", marker_noise=None)
    return seen, joint_covariance(poses, noise, noise)


def with_skin(poses: Float, rng: np.random.Generator, rotation_deg: float, place: float) -> Float:
    """The distal cluster moves on its bone with the motion: so far (deg, m) over the motion's own course."""
    twist = np.concatenate([np.radians(rotation_deg) * unit(rng.normal(size=3)), place * unit(rng.normal(size=3))])
    away = dq.log(dq.canonical(dq.multiply(dq.conjugate(poses[0]), poses)))
    size = np.linalg.norm(away[:, :3], axis=1)
    course = size / max(size.max(), 1e-12)
    course = 0.7 * course + 0.3 * smooth(len(poses), rng)
    return dq.multiply(poses, dq.exp(0.5 * course[:, None] * twist))


def with_wander(poses: Float, truth: dict[str, Any], size_deg: float) -> Float:
    """The distal body tilts about an axis across the first one, in proportion to its angle."""
    if "axis1" not in truth:
        return poses
    angle = truth["angles"] if np.ndim(truth["angles"]) == 1 else truth["angles"][:, 0]
    share = (angle - angle.mean()) / max(np.ptp(angle), 1e-12)
    direction = truth["axis1"][:3]
    across = unit(np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))]))
    point = np.cross(direction, truth["axis1"][3:])
    return dq.multiply(turned(np.radians(size_deg) * (share**2 - np.mean(share**2)), line(across, point)), poses)


def angle_between(a: Float, b: Float) -> float:
    """Between two lines without sense, rad."""
    return float(np.arctan2(np.linalg.norm(np.cross(a[:3], b[:3])), abs(float(a[:3] @ b[:3]))))
