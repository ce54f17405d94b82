"""Exponential, logarithm, power, screw parameters and ScLERP in hundreds of digits, of the very numbers we are given.

Written from the definitions (screw parameters by arctangent, not by the dual quaternion formulas under test). Dual
quaternions are lists of eight multiprecision numbers. A float is unit only to round-off: each is normalized first.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import mpmath
import numpy as np

from elbowscrew.geometry import dual_quat_from_screw, sclerp, screw_from_dual_quat
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry.arrays import Float

Number = Any  # mpmath has no types

DIGITS = 700  # twice the exponent of 1e-300, and fifty beside
ANGLES = (0.0, 1e-300, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3, 1e-2, 0.1, 1.0, 3.0, np.pi - 1e-8, np.pi, 2 * np.pi - 1e-8)
SLIDES = (0.0, 1e-3, 1.0, 1e3, 1e6)
POWER = 0.37
UNIT_ROUNDOFF_BOUND = 1e-14


def exact(values: Iterable[float]) -> list[Number]:
    return [mpmath.mpf(float(value)) for value in values]


def size(vector: list[Number]) -> Number:
    return mpmath.sqrt(sum(x * x for x in vector))


def _quaternion_product(a: list[Number], b: list[Number]) -> list[Number]:
    return [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]


def product(A: list[Number], B: list[Number]) -> list[Number]:
    left, right = _quaternion_product(A[:4], B[4:]), _quaternion_product(A[4:], B[:4])
    return [*_quaternion_product(A[:4], B[:4]), *(x + y for x, y in zip(left, right, strict=True))]


def conjugate(A: list[Number]) -> list[Number]:
    return [x if k % 4 == 0 else -x for k, x in enumerate(A)]


def normalized(A: list[Number]) -> list[Number]:
    n = size(A[:4])
    real, dual = [x / n for x in A[:4]], [x / n for x in A[4:]]
    along = sum(x * y for x, y in zip(real, dual, strict=True))
    return [*real, *(y - along * x for x, y in zip(real, dual, strict=True))]


def screw(A: list[Number]) -> tuple[Number, Number, list[Number], list[Number]]:
    """Half angle, half slide, direction and moment; without rotation the direction is that of the slide."""
    Q = normalized(A)
    s = size(Q[1:4])
    if s == 0:
        half = size(Q[5:])
        return s, half, [x / half for x in Q[5:]] if half else Q[5:], []
    h = [x / s for x in Q[1:4]]
    half_slide = -Q[4] / s
    return mpmath.atan2(s, Q[0]), half_slide, h, [
        (y - half_slide * Q[0] * x) / s for x, y in zip(h, Q[5:], strict=True)
    ]  # fmt: skip


def from_screw(half: Number, half_slide: Number, h: list[Number], m: list[Number]) -> list[Number]:
    c, s = mpmath.cos(half), mpmath.sin(half)
    return [c, *(s * x for x in h), -half_slide * s, *(s * y + half_slide * c * x for x, y in zip(h, m, strict=True))]


def exponential(u: list[Number]) -> list[Number]:
    a, b = u[:3], u[3:]
    n = size(a)
    if n == 0:
        return [mpmath.mpf(1), *a, mpmath.mpf(0), *b]
    h = [x / n for x in a]
    half_slide = sum(x * y for x, y in zip(h, b, strict=True))
    return from_screw(n, half_slide, h, [(y - half_slide * x) / n for x, y in zip(h, b, strict=True)])


def logarithm(A: list[Number]) -> list[Number]:
    half, half_slide, h, m = screw(A)
    if half == 0:
        return [mpmath.mpf(0)] * 3 + [half_slide * x for x in h]
    return [*(half * x for x in h), *(half_slide * x + half * y for x, y in zip(h, m, strict=True))]


def power(A: list[Number], t: float) -> list[Number]:
    return exponential([mpmath.mpf(t) * x for x in logarithm(A)])


def _error(ours: Float, truth: list[Number]) -> Number:
    return size([x - y for x, y in zip(exact(np.atleast_1d(ours)), truth, strict=True)])


def relative_errors(theta: float, slide: float, seed: int) -> dict[str, tuple[float, float]]:
    """Error of every function at a random screw, and what the conditioning of its problem allows for a unit of it.

    Both are relative to the norm of the part (rotation or dual); the slide's and the moment's are absolute errors over
    the lengths that they are the difference of.
    """
    rng = np.random.default_rng(seed)
    h = rng.normal(size=3)
    h /= np.linalg.norm(h)
    m = np.cross(rng.normal(size=3), h)
    sine = abs(float(np.sin(theta / 2)))
    # Near a full turn the axis is that of a small rotation, theta - 2 pi; the logarithm takes its digits with it.
    turned = 1.0 if theta < np.pi else 1.0 / sine
    found: dict[str, tuple[float, float]] = {}

    def note(name: str, ours: Float, truth: list[Number], allowed: float, scale: Number | None = None) -> None:
        norm = size(truth) if scale is None else scale
        error = _error(ours, truth)
        found[name] = (float(error / norm) if norm else float(error), allowed)

    def both(name: str, ours: Float, truth: list[Number], split: int, real: float, dual: float) -> None:
        note(f"{name}, rotation", ours[:split], truth[:split], real)
        note(f"{name}, dual part", ours[split:], truth[split:], dual)

    with mpmath.workdps(DIGITS):
        u = np.concatenate([0.5 * theta * h, 0.5 * slide * h + 0.5 * theta * m])
        Q = dq.exp(u)
        # The sine of an angle near pi loses the digits that the angle has before the point.
        both("exp", Q, exponential(exact(u)), 4, 1.0, 1.0 if theta < np.pi else turned * theta / 2)
        both("log", dq.log(Q), logarithm(exact(Q)), 3, 1.0, turned)
        both("power", dq.power(Q, POWER), power(exact(Q), POWER), 4, 1.0, turned)
        S = dual_quat_from_screw(theta, slide, h, m)
        half, half_slide = mpmath.mpf(theta) / 2, mpmath.mpf(slide) / 2
        both("from screw", S, from_screw(half, half_slide, exact(h), exact(m)), 4, 1.0, 1.0)
        if theta > 0.0:
            ours = screw_from_dual_quat(S)
            half, half_slide, direction, moment = screw(exact(S))
            lengths = size(moment) + abs(2 * half_slide)
            note("angle", ours.angle, [2 * half], 1.0)
            note("direction", ours.direction, direction, 1.0)
            note("slide", ours.slide, [2 * half_slide], 1.0, lengths)
            note("moment", ours.moment, moment, 1.0 / sine, lengths)
        A = dq.dual_quat_from_pose([0.5, 0.5, 0.5, 0.5], rng.normal(size=3))
        B = dq.multiply(A, S)
        start, end = normalized(exact(A)), normalized(exact(B))
        blend = product(start, power(product(conjugate(start), end), POWER))
        both("ScLERP", sclerp(A, B, POWER, way="as given"), blend, 4, turned, turned**2)
    return found
