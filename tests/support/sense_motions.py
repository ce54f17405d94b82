"""Motions whose sense of rotation is known, of 24 kinds: the truth comes from how each was made, not from its poses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowscrew.geometry.arrays import Float

Random = np.random.Generator

RATE_HZ: Final = 100.0
REFERENCE: Final = 0


class SenseMotion(NamedTuple):
    """A motion and the angle that is right for it.

    Attributes
    ----------
    quat : ndarray, shape (N, 4)
        Displacements since row 0, each of a random sign; NaN where lost.
    time_s : ndarray, shape (N,)
    angle : ndarray, shape (N,)
        Theta, radians.
    signed : bool
    either : bool
        The excursions to both sides are equal, and either may be positive.
    """

    quat: Float
    time_s: Float
    angle: Float
    signed: bool
    either: bool = False


def product(a: Float, b: Float) -> Float:
    """Hamilton product."""
    aw, av, bw, bv = a[..., :1], a[..., 1:], b[..., :1], b[..., 1:]
    real = aw * bw - np.sum(av * bv, axis=-1, keepdims=True)
    return np.concatenate([real, aw * bv + bw * av + np.cross(av, bv)], axis=-1)


def conjugate(a: Float) -> Float:
    found: Float = a * np.array([1.0, -1.0, -1.0, -1.0])
    return found


def rotation(angle: Float, axis: Float) -> Float:
    """Turn about unit axes; angles (N,) in radians."""
    half = 0.5 * np.asarray(angle)[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * np.broadcast_to(axis, (*half.shape[:-1], 3))], axis=-1)


def unit(vector: Float) -> Float:
    found: Float = vector / np.linalg.norm(vector, axis=-1, keepdims=True)
    return found


def any_axis(random: Random) -> Float:
    return unit(random.normal(size=3))


def across(axis: Float, random: Random) -> Float:
    other = random.normal(size=3)
    return unit(other - (other @ axis) * axis)


def noisy(quat: Float, degrees: float, random: Random) -> Float:
    """Turn each pose by a random rotation vector with this deviation a component."""
    vector = np.radians(degrees) * random.normal(size=(len(quat), 3))
    size = np.linalg.norm(vector, axis=1)
    return product(quat, rotation(size, vector / np.maximum(size, 1e-300)[:, None]))


def smooth(count: int, period: float, random: Random) -> Float:
    """Random curve of deviation 1 that changes over about `period` frames, shape (count,)."""
    wide = max(int(period), 2)
    kernel = np.hanning(2 * wide + 1)
    curve = np.convolve(random.normal(size=count + 2 * wide), kernel, mode="valid")
    found: Float = (curve - curve.mean()) / curve.std()
    return found


def strokes(tops: Float, frames: int, starts: float | Float = 0.0, rest: int = 0) -> Float:
    """From a start to each top and back, smoothly, with rests at the start; degrees."""
    begin = np.broadcast_to(starts, (len(tops) + 1,))
    share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, frames, endpoint=False))
    parts = []
    for k, top in enumerate(tops):
        parts += [begin[k] + (top - begin[k]) * share, top + (begin[k + 1] - top) * share]
        parts += [np.full(rest, float(begin[k + 1]))]
    return np.concatenate(parts)


def _finished(
    quat: Float,
    course: Float,
    random: Random,
    *,
    noise: float = 0.2,
    signed: bool = True,
    either: bool = False,
    lost: NDArray[np.bool_] | None = None,
    from_pose: Float | None = None,
) -> SenseMotion:
    """Count from the first pose, add noise, and give each frame the value of its rotation that is nearest `course`.

    `course` (degrees) is the rotation about the kind's own axis since the first frame; its sense and whole turns are
    the truth, the amount is the rotation's.
    """
    clean = product(conjugate(quat[:1] if from_pose is None else from_pose), quat)
    measured = noisy(clean, noise, random)
    measured = product(conjugate(measured[:1]), measured)
    phi = 2.0 * np.arctan2(np.linalg.norm(measured[:, 1:], axis=1), np.abs(measured[:, 0]))
    angle = phi
    if signed:
        wanted = np.radians(course - course[0])
        turn = 2.0 * np.pi
        plus, minus = (one + turn * np.round((wanted - one) / turn) for one in (phi, -phi))
        angle = np.where(np.abs(plus - wanted) <= np.abs(minus - wanted), plus, minus)
        angle = angle * (1.0 if angle.max() >= -angle.min() else -1.0)
    measured = measured * random.choice([-1.0, 1.0], size=(len(measured), 1))
    if lost is not None:
        measured[lost] = np.nan
    return SenseMotion(measured, np.arange(len(measured)) / RATE_HZ, angle, signed, either)


def _tops(random: Random, low: float = 60.0, high: float = 140.0) -> Float:
    return random.uniform(low, high) * random.uniform(0.9, 1.0, size=random.integers(2, 6))


def _frames(random: Random) -> int:
    return int(random.integers(30, 120))


def hinge(random: Random) -> SenseMotion:
    x = strokes(_tops(random), _frames(random))
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def hinge_with_rests(random: Random) -> SenseMotion:
    x = strokes(_tops(random), _frames(random), rest=60)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, noise=1.0)


def hinge_noisy(random: Random) -> SenseMotion:
    x = strokes(_tops(random), _frames(random), rest=20)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, noise=3.0)


def hinge_small(random: Random) -> SenseMotion:
    x = strokes(_tops(random, 12.0, 20.0), _frames(random), rest=10)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, noise=1.0)


def hyperextension(random: Random) -> SenseMotion:
    """Through the reference to the other side, by the same axis."""
    x = strokes(_tops(random, 90.0, 140.0), _frames(random), starts=-random.uniform(10.0, 30.0))
    x = np.concatenate([np.linspace(0.0, x[0], 20), x])
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def reference_inside(random: Random) -> SenseMotion:
    """The reference is in the middle of the range; so both sides may be equal."""
    x = strokes(_tops(random), _frames(random))
    begin = int(random.integers(0, len(x)))
    x = np.concatenate([x[begin:], x])
    either = abs((x.max() - x[0]) - (x[0] - x.min())) < 0.1 * np.ptp(x)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, either=either)


def both_sides(random: Random) -> SenseMotion:
    x = random.uniform(40.0, 80.0) * np.sin(np.linspace(0.0, 2.0 * np.pi * random.integers(2, 5), 500))
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, either=True)


def passes_aside(random: Random) -> SenseMotion:
    """Equal strokes between which the joint passes beside the reference, by 6 to 15 deg about another axis."""
    u, other = any_axis(random), across(any_axis(random), random)
    other = unit(other - (other @ u) * u)
    x = strokes(np.full(5, random.uniform(70.0, 110.0)), 50, starts=random.uniform(-3.0, 1.0, size=6))
    side = np.repeat(random.choice([-1.0, 1.0], size=5), 100)
    aside = random.uniform(6.0, 15.0) * np.exp(-((x / 25.0) ** 2)) * side
    quat = product(rotation(np.radians(x), u), rotation(np.radians(aside), other))
    # The reference is the joint's neutral pose, which it leaves for the first stroke at once.
    quat = np.concatenate([np.array([[1.0, 0.0, 0.0, 0.0]]), quat])
    course = np.concatenate([[0.0], np.maximum(x, 0.0)])
    return _finished(quat, course, random)


def wandering(random: Random, degrees: float) -> SenseMotion:
    u = any_axis(random)
    x = strokes(_tops(random), _frames(random), starts=random.uniform(0.0, 4.0, size=1))
    one, other = across(u, random), across(u, random)
    tilt = np.radians(degrees) * smooth(x.size, 40.0, random)
    axis = unit(u + np.tan(np.clip(tilt, -1.0, 1.0))[:, None] * unit(one + 0.3 * other))
    start = np.zeros((1, 3)) + u
    return _finished(rotation(np.radians(x), axis), x, random, from_pose=rotation(np.radians(x[:1]), start))


def wandering_10(random: Random) -> SenseMotion:
    return wandering(random, 10.0)


def wandering_20(random: Random) -> SenseMotion:
    return wandering(random, 20.0)


def elbow(random: Random) -> SenseMotion:
    """Flexion with pronation that goes its own way, as in a task of the hand."""
    u = any_axis(random)
    x = strokes(_tops(random, 80.0, 140.0), _frames(random))
    turn = random.uniform(8.0, 16.0) * smooth(x.size, 60.0, random)
    quat = product(rotation(np.radians(x), u), rotation(np.radians(turn - turn[0]), across(u, random)))
    return _finished(quat, np.where(x < 20.0, np.maximum(x, 1.0), x), random)


def carried_along(random: Random) -> SenseMotion:
    """A second rotation in proportion to the first."""
    u = any_axis(random)
    x = strokes(_tops(random, 80.0, 140.0), _frames(random))
    quat = product(rotation(np.radians(x), u), rotation(np.radians(0.4 * x), across(u, random)))
    return _finished(quat, x, random)


def screw_home(random: Random) -> SenseMotion:
    """A knee: axial rotation in the first third of flexion only."""
    u = any_axis(random)
    top = random.uniform(90.0, 120.0)
    x = strokes(np.full(3, top), 60)
    axial = random.uniform(10.0, 20.0) * np.minimum(x / (top / 3.0), 1.0)
    quat = product(rotation(np.radians(x), u), rotation(np.radians(axial), across(u, random)))
    return _finished(quat, x, random)


def top_half_turn(random: Random) -> SenseMotion:
    x = strokes(np.full(3, 180.0), _frames(random))
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def top_full_turn(random: Random) -> SenseMotion:
    x = strokes(np.full(3, 360.0), _frames(random) + 40)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def beyond_half_turn(random: Random) -> SenseMotion:
    x = strokes(np.full(3, random.uniform(185.0, 300.0)), _frames(random))
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def beyond_half_turn_gaps(random: Random) -> SenseMotion:
    """Beyond the half turn, and lost on most of the ways there and back."""
    x = strokes(np.full(4, 200.0), 60)
    lost = (x > 50.0) & (x < 192.0)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, lost=lost)


def crank(random: Random) -> SenseMotion:
    share = np.linspace(0.0, 1.0, 600)
    x = 360.0 * random.uniform(1.5, 6.0) * (share - 0.1 * np.sin(2.0 * np.pi * share))
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def crank_there_and_back(random: Random) -> SenseMotion:
    x = strokes(np.full(2, 360.0 * random.uniform(1.3, 4.0)), 300)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, noise=1.0)


def crank_gaps(random: Random) -> SenseMotion:
    """A crank at an even pace that is lost for more than half a turn at a time."""
    x = np.linspace(0.0, 360.0 * random.uniform(3.0, 6.0), 600)
    lost = np.zeros(x.size, dtype=np.bool_)
    for start in random.integers(60, 520, size=3):
        lost[start : start + int(random.uniform(200.0, 330.0) / (x[1] - x[0]))] = True
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, lost=lost)


def fast(random: Random) -> SenseMotion:
    """Some 40 deg from frame to frame."""
    x = strokes(np.full(6, random.uniform(90.0, 150.0)), 5, rest=3)
    return _finished(rotation(np.radians(x), any_axis(random)), x, random)


def lost_frames(random: Random) -> SenseMotion:
    """A hinge with many gaps, long ones too."""
    x = strokes(_tops(random, 90.0, 150.0), _frames(random), rest=10)
    lost = smooth(x.size, 15.0, random) > 0.0
    lost[0] = False
    return _finished(rotation(np.radians(x), any_axis(random)), x, random, lost=lost)


def ball(random: Random) -> SenseMotion:
    vector = np.radians(40.0) * np.column_stack([smooth(800, 20.0, random) for _ in range(3)])
    size = np.linalg.norm(vector, axis=1)
    return _finished(rotation(size, vector / size[:, None]), size, random, signed=False)


def two_axes(random: Random) -> SenseMotion:
    """Two rotations as large as each other that know nothing of each other."""
    u = any_axis(random)
    one, other = (60.0 + 30.0 * smooth(900, 25.0, random) for _ in range(2))
    one[0] = other[0] = 60.0
    quat = product(rotation(np.radians(one), u), rotation(np.radians(other), across(u, random)))
    return _finished(quat, one, random, signed=False)


KINDS: Final[dict[str, Callable[[Random], SenseMotion]]] = {
    kind.__name__: kind
    for kind in (
        hinge, hinge_with_rests, hinge_noisy, hinge_small, hyperextension, reference_inside, both_sides, passes_aside,
        wandering_10, wandering_20, elbow, carried_along, screw_home, top_half_turn, top_full_turn, beyond_half_turn,
        beyond_half_turn_gaps, crank, crank_there_and_back, crank_gaps, fast, lost_frames, ball, two_axes,
    )
}  # fmt: skip


def made(kind: str, seed: int) -> SenseMotion:
    return KINDS[kind](np.random.default_rng([list(KINDS).index(kind), seed]))


def share_wrong(motion: SenseMotion, angle: Float) -> float:
    """Share of the known frames whose angle is more than 30 deg off."""
    known = np.isfinite(motion.quat[:, 0])
    ways = (1.0, -1.0) if motion.either else (1.0,)
    return min(float((np.abs(way * angle - motion.angle)[known] > np.radians(30.0)).mean()) for way in ways)
