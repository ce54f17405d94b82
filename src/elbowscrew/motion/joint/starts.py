"""Where the search for two axes begins: four families of starts, raced. None is random.

1. Of two axes ``h1^T R_i h2`` is constant, whatever the angles: its relative variance is minimized from a grid.
2. Parallel axes: the second goes round the first on a circle in the plane across them.
3. What a hinge leaves: the first component of its residual is the other axis' twist.
4. The same at stated distances, for axes nearly in one line or nearly parallel.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry._small_angle import length
from elbowscrew.geometry.arrays import Float, Index
from elbowscrew.geometry.quaternion import rotation_matrix_from_quat
from elbowscrew.geometry.twist import adjoint
from elbowscrew.motion.joint.likelihood import Fit, fit_mechanism, race
from elbowscrew.motion.joint.lines import Z_LINE, about_z, angle_about_z, least_solution, line_pose, mean_rotation_pair
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.simple_types import OneAxis
from elbowscrew.motion.joint.two_axes import TwoAxesMechanism, is_phantom

_GRID: Final = 150
_ALTERNATIONS: Final = 12
_ROTATION_FRAMES: Final = 2000
_MOST_PAIRS: Final = 6
_SAME_PAIR: Final = np.cos(np.radians(8.0))
_RADIAN: Final = 0.08  # m that weigh as a radian in a hinge's residual
_SCANNED: Final = (0.005, 0.015, 0.04, 0.1)  # m between axes whose distance no start tells
_MOST_SCANNED: Final = 3
_RACE_FRAMES: Final = 80
_ROUNDS: Final = 6
_FIRST_ROUNDS: Final = 3
_AHEAD: Final = 6
_FRAMES: Final = 150
_NEARLY_PARALLEL: Final = 0.35


class _Runner(NamedTuple):
    fit: Fit[TwoAxesMechanism]
    phantom: bool

    @property
    def cost(self) -> float:
        return float(np.mean(self.fit.square))


def find_two_axes(poses: Poses) -> Fit[TwoAxesMechanism]:
    """Find the two axes of poses without a start: the best of all families, fitted to at most 150 frames.

    Parameters
    ----------
    poses : Poses
        At least a dozen.

    Returns
    -------
    Fit
        Of a `TwoAxesMechanism`; a phantom only where nothing else comes near.
    """
    few, _ = poses.thinned(_FRAMES)
    hinge = fit_mechanism(OneAxis.start(few.joint), few, iterations=8, tolerance=1e-2)
    first, second = _turned_to_body(hinge.mechanism) if poses.located else (about_z(np.zeros(())),) * 2
    proximal, distal = dq.multiply(hinge.mechanism.proximal, first), dq.multiply(hinge.mechanism.distal, second)
    seen = Poses(
        joint=dq.multiply(dq.conjugate(proximal), dq.multiply(poses.joint, distal)),
        whitener=poses.whitener @ adjoint(distal),
    )
    found = _find_about_z(seen, _moved_to_z(hinge, first, second))
    at = found.mechanism
    return found._replace(
        mechanism=replace(at, proximal=dq.multiply(proximal, at.proximal), distal=dq.multiply(distal, at.distal))
    )


def _turned_to_body(hinge: OneAxis) -> tuple[Float, Float]:
    """Screw motions (8,) of the proximal and of the distal frame of a hinge's axis along it.

    They lead to beside the origin of that body whose origin is nearer the axis, with x towards it, and to no angle in
    the middle frame. With both bodies told in frames there the searches see the same numbers wherever the other body's
    frame is, as where poses are those in the laboratory or in an arm that stands still.
    """
    middle = float(hinge.frames[len(hinge.frames) // 2, 0])
    lines = (hinge.proximal, hinge.distal)
    origins = [dq.transform_points(dq.conjugate(line), np.zeros(3)) for line in lines]
    nearer = int(np.argmin([np.hypot(origin[0], origin[1]) for origin in origins]))
    x, y, along = origins[nearer]
    turn = float(np.arctan2(y, x))
    return about_z(np.asarray(turn + middle * nearer), along), about_z(np.asarray(turn - middle * (1 - nearer)), along)


def _moved_to_z(hinge: Fit[OneAxis], first: Float, second: Float) -> Fit[OneAxis]:
    """The same hinge between frames of both bodies that lie on its axis, moved along it by screw motions (8,)."""
    still, at = about_z(np.zeros(())), hinge.mechanism
    turned = 2.0 * (np.arctan2(second[3], second[0]) - np.arctan2(first[3], first[0]))
    return hinge._replace(
        mechanism=replace(at, proximal=still, distal=still, frames=at.frames + turned),
        residual=hinge.residual @ adjoint(dq.conjugate(second)).T,
    )


def _find_about_z(poses: Poses, hinge: Fit[OneAxis]) -> Fit[TwoAxesMechanism]:
    """Find them where the hinge that fits best is the z axis of both bodies."""
    few, _ = poses.thinned(_FRAMES)
    fewer, racing = few.thinned(_RACE_FRAMES)
    starts = _constant_angle_starts(poses.thinned(_ROTATION_FRAMES)[0].joint, few.joint)
    if poses.located:
        starts += [*_parallel_starts(few.joint), *_residual_starts(hinge, None)]
    else:  # all lines pass one point, and parallel axes are one
        starts += _residual_starts(hinge, (1.0,))
    runners = sorted(_race(starts, racing, fewer), key=lambda runner: runner.cost)
    going: list[_Runner] = []
    for runner in runners[:4]:
        if runner.cost > 300.0 * runners[0].cost:
            break
        if going and not going[0].phantom and runner.cost > 20.0 * runners[0].cost:
            break
        if going and not runner.phantom and abs(runner.cost / runners[0].cost - 1.0) < 0.02:
            continue  # the same joint from another start
        going.append(runner)
    best = _on(going, few)
    least = min(best, key=lambda runner: runner.cost)
    if poses.located and (least.phantom or _sine(least.fit) < _NEARLY_PARALLEL):
        scanned = _race_of_the_best(_residual_starts(hinge, _SCANNED), racing, fewer)
        near = [runner for runner in scanned if not runner.phantom and runner.cost < 3.0 * least.cost]
        best += _on(sorted(near, key=lambda runner: runner.cost)[:_MOST_SCANNED], few)
    return _winner(best, few)


def _winner(best: list[_Runner], few: Poses) -> Fit[TwoAxesMechanism]:
    """Finish the best two; a phantom wins only by more than four times the likelihood's exponent."""
    best = sorted(best, key=lambda runner: runner.cost)
    real = [runner for runner in best if not runner.phantom and runner.cost < 4.0 * best[0].cost]
    order = real + [runner for runner in best if runner.phantom] or best
    finished: list[_Runner] = []
    for runner in order[:2]:
        if finished and (runner.cost > 10.0 * finished[0].cost or abs(runner.cost / finished[0].cost - 1.0) < 0.05):
            break
        finished.append(_run(runner.fit.mechanism, few, 8 if runner.phantom else 30, 1e-6))
    return min(finished, key=lambda runner: runner.cost * (4.0 if runner.phantom else 1.0)).fit


def _run(start: TwoAxesMechanism, poses: Poses, iterations: int, tolerance: float) -> _Runner:
    fit = fit_mechanism(start, poses, iterations=iterations, tolerance=tolerance)
    return _Runner(fit, is_phantom(fit))


def _race(starts: list[TwoAxesMechanism], racing: Index, poses: Poses) -> list[_Runner]:
    fits = race([start.on(racing) for start in starts], poses, rounds=_ROUNDS)
    return [_Runner(fit, is_phantom(fit)) for fit in fits]


def _race_of_the_best(starts: list[TwoAxesMechanism], racing: Index, poses: Poses) -> list[_Runner]:
    """Race many starts for a while, and go on with those that are ahead."""
    fits = race([start.on(racing) for start in starts], poses, rounds=_FIRST_ROUNDS)
    ahead = sorted(fits, key=lambda fit: fit.cost)[:_AHEAD]
    fits = race([fit.mechanism for fit in ahead], poses, rounds=_ROUNDS - _FIRST_ROUNDS)
    return [_Runner(fit, is_phantom(fit)) for fit in fits]


def _on(runners: list[_Runner], poses: Poses) -> list[_Runner]:
    """Let them run on, on more poses."""
    if not runners:
        return []
    fits = race([runner.fit.mechanism.placed(poses.joint) for runner in runners], poses, rounds=_ROUNDS)
    return [_Runner(fit, is_phantom(fit)) for fit in fits]


def _sine(fit: Fit[TwoAxesMechanism]) -> float:
    return float(np.hypot(*dq.transform_lines(fit.mechanism.between, Z_LINE)[:2]))


def _constant_angle_starts(many: Float, joint: Float) -> list[TwoAxesMechanism]:
    return [
        _from_lines(joint, (h1, q1), (h2, q2))
        for h1, h2 in _direction_pairs(rotation_matrix_from_quat(many[:, :4]))
        for q1, q2 in [_points_of_lines(joint, h1, h2)]
    ]


def _direction_pairs(R: Float) -> list[tuple[Float, Float]]:
    """Directions in both bodies whose angle stays most nearly constant, relative to how far it could vary.

    ``var(h1^T R h2) / E[1 - (h1^T R h2)^2]`` is minimized for one direction at a time, a generalized eigenproblem of
    3 x 3. Without the denominator two directions along one small rotation would do as well as the axes.
    """
    mean = R.mean(axis=0)
    flat = R.reshape(-1, 9)
    square = (flat.T @ flat / len(R)).reshape(3, 3, 3, 3)
    second = _sphere(_GRID)
    for _ in range(_ALTERNATIONS):
        first, _ = _least_varying(np.einsum("ijkl,bj,bl->bik", square, second, second, optimize=True), second @ mean.T)
        second, ratio = _least_varying(np.einsum("ijkl,bi,bk->bjl", square, first, first, optimize=True), first @ mean)
    pairs: list[tuple[Float, Float]] = []
    for k in np.argsort(ratio):
        new = all(min(abs(first[k] @ a), abs(second[k] @ b)) < _SAME_PAIR for a, b in pairs)
        if new:
            pairs.append((first[k], second[k]))
        if len(pairs) == _MOST_PAIRS:
            break
    return pairs


def _least_varying(square: Float, mean: Float) -> tuple[Float, Float]:
    """Unit vectors (B, 3) with the least ``h.(E - m m^T) h / h.(1 - E) h``, and that ratio."""
    variance = square - mean[:, :, None] * mean[:, None, :]
    lower = np.linalg.inv(np.linalg.cholesky((1.0 + 1e-7) * np.eye(3) - square))
    values, vectors = np.linalg.eigh(lower @ variance @ np.swapaxes(lower, -1, -2))
    found = np.einsum("bji,bj->bi", lower, vectors[..., 0])
    return found / length(found)[:, None], values[:, 0]


def _points_of_lines(joint: Float, h1: Float, h2: Float) -> tuple[Float, Float]:
    """Points of two lines of known directions, in the proximal and the distal body, by one linear system.

    ``R q2 + d = q1 + c``, where c goes round h1 with the second axis: constant in the plane that h2 turns with.
    """
    quat, position = dq.pose_from_dual_quat(joint)
    R = rotation_matrix_from_quat(quat)
    frame = rotation_matrix_from_quat(line_pose(h1, np.zeros(3))[:4])
    seen = (R @ h2) @ frame
    angle = np.arctan2(seen[:, 1], seen[:, 0])
    x, y = frame[:, 0], frame[:, 1]
    radial = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y
    normal = np.cos(angle)[:, None] * y - np.sin(angle)[:, None] * x
    system = np.concatenate(
        [R, -np.broadcast_to(np.eye(3), R.shape), -radial[..., None], -normal[..., None]], axis=2
    ).reshape(-1, 8)
    solution = least_solution(system.T @ system, system.T @ -position.reshape(-1), 1)
    return solution[3:6], solution[:3]


def _parallel_starts(joint: Float) -> list[TwoAxesMechanism]:
    """Parallel axes: in the plane across them a point of the distal body stays on a circle about one of the proximal.

    ``|z + e p2 - p1| = r`` with z the distal origin and e the rotation, as complex numbers, is linear in p1, p2, their
    product and the constant.
    """
    h, g = mean_rotation_pair(joint)
    A, F = line_pose(h, np.zeros(3)), line_pose(g, np.zeros(3))
    turn = np.exp(1j * angle_about_z(dq.multiply(dq.multiply(dq.conjugate(A), joint), F)))
    position = dq.pose_from_dual_quat(dq.multiply(dq.conjugate(A), joint))[1]
    z = position[:, 0] + 1j * position[:, 1]
    middle = z.mean()
    z = z - middle
    linear = [2.0 * np.conj(z) * turn, -2.0 * np.conj(z), -2.0 * turn]
    columns = [part for term in linear for part in (term.real, -term.imag)]
    system = np.stack([*columns, np.ones(z.size)], axis=1)
    found = np.linalg.lstsq(system, -(np.abs(z) ** 2), rcond=1e-6)[0]
    p2, p1 = found[0] + 1j * found[1], found[2] + 1j * found[3]
    arm = z + turn * p2 - p1
    first = np.unwrap(np.angle(arm))
    q1 = dq.transform_points(A, np.array([(p1 + middle).real, (p1 + middle).imag, 0.0]))
    q2 = dq.transform_points(F, np.array([p2.real, p2.imag, 0.0]))
    return [_from_lines(joint, (h, q1), (g, q2), first)]


def _residual_starts(hinge: Fit[OneAxis], distances: tuple[float, ...] | None) -> list[TwoAxesMechanism]:
    """Second axes from what a hinge leaves, on either side of it.

    The main twist ``(w, v)`` of the residual is the second axis' but for a share c of the hinge's own rotation, which
    each frame's angle has taken: the one c that makes it a pure rotation, ``w.v = 0``. Where the axes are parallel, c
    is what puts the second axis at a distance.
    """
    at = hinge.mechanism
    angle = at.frames[:, 0]
    starts = []
    for in_distal in (True, False):
        twist = hinge.residual
        if not in_distal:
            twist = np.einsum("fij,fj->fi", adjoint(about_z(angle)), twist)
        weighed = (twist - twist.mean(axis=0)) * [_RADIAN, _RADIAN, _RADIAN, 1.0, 1.0, 1.0]
        main = np.linalg.eigh(weighed.T @ weighed)[1][:, -1] / [_RADIAN, _RADIAN, _RADIAN, 1.0, 1.0, 1.0]
        w, v = main[:3] * [1.0, 1.0, 0.0], main[3:]
        if distances is not None:
            across = float(np.hypot(v[0], v[1]))
            shares = [sign * across / distance for distance in distances for sign in (1.0, -1.0)]
        elif abs(v[2]) > 1e-9:
            shares = [-float(w @ v) / float(v[2])]
        else:
            continue
        for share in shares:
            turn = w + np.array([0.0, 0.0, share])
            size = float(length(turn))
            if size < 1e-12:
                continue
            other = line_pose(turn / size, np.cross(turn, v) / size**2)
            starts.append(_beside(at, other, angle, in_distal=in_distal))
    return starts


def _beside(hinge: OneAxis, other: Float, angle: Float, *, in_distal: bool) -> TwoAxesMechanism:
    """Give a hinge's axis a second one, a pose in the frame of the hinge's line: ``M`` is how it stands to it."""
    zero = np.zeros(angle.size)
    if in_distal:
        return TwoAxesMechanism(
            proximal=hinge.proximal,
            between=other,
            distal=dq.multiply(hinge.distal, other),
            frames=np.stack([angle, zero], axis=1),
        )
    return TwoAxesMechanism(
        proximal=dq.multiply(hinge.proximal, other),
        between=dq.conjugate(other),
        distal=hinge.distal,
        frames=np.stack([zero, angle], axis=1),
    )


def _from_lines(
    joint: Float, first: tuple[Float, Float], second: tuple[Float, Float], angle: Float | None = None
) -> TwoAxesMechanism:
    """Two lines, direction and point each; M from the middle frame, from which both angles count."""
    A, F = line_pose(*first), line_pose(*second)
    seen = dq.multiply(dq.multiply(dq.conjugate(A), joint), F)
    middle = len(joint) // 2
    if angle is None:
        line = dq.transform_lines(seen, Z_LINE)
        angle = np.arctan2(line[:, 1], line[:, 0])
    angle = angle - angle[middle]
    rest = dq.multiply(dq.conjugate(seen[middle]), dq.multiply(about_z(-angle), seen))
    frames = np.stack([np.unwrap(angle), angle_about_z(rest)], axis=1)
    return TwoAxesMechanism(proximal=A, between=seen[middle], distal=F, frames=frames)


def _sphere(count: int) -> Float:
    """Directions spread evenly over half a sphere: Fibonacci's spiral."""
    k = np.arange(count) + 0.5
    z, turn = 1.0 - k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=1)
