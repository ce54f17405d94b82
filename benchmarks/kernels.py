"""The kernels beside what a user would take instead: ``python benchmarks/kernels.py [NAME]``.

Each kernel is timed in alternation with its yardsticks, so that a busy moment of the machine meets all alike: read the
ratios, not the times. pytransform3d works on the same dual quaternions; scipy's RigidTransform is given its own
transforms where it has the operation ("native"), else dual quaternions in and out.
"""

from __future__ import annotations

import statistics
import sys
import tracemalloc
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytransform3d.trajectories
from rows import Row, alternate, clean_environment, faster, share, table
from scipy.spatial.transform import RigidTransform

from elbowscrew import geometry
from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion
from elbowscrew.geometry.arrays import Float

Task = Callable[[], Any]

pt: Any = pytransform3d.trajectories  # it has types in parts only

COPY = "a copy of its bytes"
SHORT = 450
SHORT_REPEATS = 200
SHORT_TARGET_US = 150.0
MEMORY_TARGET_MIB = 8.0
DIB_TOLERANCE = 1e-12


class Case(NamedTuple):
    """A kernel and what it is measured beside: by name, each with the least ratio wanted, if one is."""

    ours: Task
    copied: tuple[Float, ...]
    yardsticks: dict[str, tuple[Task, float | None]]
    most_copies: float | None = None


def poses(frames: int, seed: int) -> Float:
    """An elbow's range of motion, noise and all: rotations of up to 150 degrees about a wandering axis."""
    rng = np.random.default_rng(seed)
    angle = np.radians(76.0 - 75.0 * np.cos(np.linspace(0.0, 40.0, frames)))
    axis = np.array([0.1, 0.2, 0.97]) + rng.normal(scale=0.02, size=(frames, 3))
    quat = quaternion.quat_from_rotation_vector(
        angle[:, None] * quaternion.normalize(np.pad(axis, ((0, 0), (1, 0))))[:, 1:]
    )
    return dq.dual_quat_from_pose(quat, rng.normal(scale=0.3, size=(frames, 3)))


def keyframes() -> tuple[Float, Float]:
    """Five poses of a hinge over 130 degrees, with some noise, and their knots."""
    knots = np.linspace(0.0, 1.0, 5)
    line = geometry.line_through([0.02, 0.01, 0.25], [0.1, 0.2, 0.97])
    keys = geometry.dual_quat_from_screw(np.radians(130.0) * knots, 0.005 * knots, line[:3], line[3:])
    noise = np.random.default_rng(9).normal(scale=0.01, size=(5, 6))
    return dq.multiply(keys, dq.exp(noise)), knots


def scipy_dib(keys: RigidTransform, weights: Float, start: RigidTransform) -> RigidTransform:
    """The same loop on scipy's transforms."""
    blend = start
    while True:
        inverse = blend.inv()
        step = sum(weights[:, k : k + 1] * (inverse * keys[k]).as_exp_coords() for k in range(len(keys)))
        blend = blend * RigidTransform.from_exp_coords(step)
        if np.abs(step).max() <= DIB_TOLERANCE:
            return blend


def cases(frames: int) -> dict[str, Case]:
    """Build all kernels on so many frames."""
    A, B = poses(frames, 1), poses(frames, 2)
    quat, position = dq.pose_from_dual_quat(A)
    pq = np.concatenate([position, quat], axis=1)
    half_twist = dq.log(A)
    t = np.random.default_rng(3).uniform(size=frames)
    keys, knots = keyframes()
    weights = geometry.lagrange_weights(t, knots)
    key, end = keys[0], keys[-1]
    starts, ends = np.broadcast_to(key, (frames, 8)), np.broadcast_to(end, (frames, 8))
    # The yardsticks get their arrays as they like them best.
    A_c, B_c = np.ascontiguousarray(A), np.ascontiguousarray(B)
    R, S = (RigidTransform.from_dual_quat(Q, scalar_first=True) for Q in (A_c, B_c))
    matrices, twists = R.as_matrix(), 2.0 * np.ascontiguousarray(half_twist)
    blended = geometry.dlb(keys, weights)
    scipy_keys, scipy_start = (
        RigidTransform.from_dual_quat(np.ascontiguousarray(Q), scalar_first=True) for Q in (keys, blended)
    )

    def scipy_screw() -> Any:
        twist = RigidTransform.from_dual_quat(A_c, scalar_first=True).as_exp_coords()
        angle = np.linalg.norm(twist[:, :3], axis=1)
        direction = twist[:, :3] / angle[:, None]
        slide = np.sum(direction * twist[:, 3:], axis=1)
        return angle, slide, direction, (twist[:, 3:] - slide[:, None] * direction) / angle[:, None]

    def scipy_sclerp() -> Any:
        first, last = (RigidTransform.from_dual_quat(Q, scalar_first=True) for Q in (key, end))
        step = (first.inv() * last).as_exp_coords()
        return (first * RigidTransform.from_exp_coords(t[:, None] * step)).as_dual_quat(scalar_first=True)

    return {
        "pose to dual quaternion": Case(
            lambda: dq.dual_quat_from_pose(quat, position),
            (quat, position),
            {"pytransform3d": (lambda: pt.dual_quaternions_from_pqs(pq), None)},
        ),
        "product": Case(
            lambda: dq.multiply(A, B),
            (A, B),
            {
                "pytransform3d": (lambda: pt.batch_concatenate_dual_quaternions(A_c, B_c), 7.0),
                "scipy native": (lambda: R * S, 12.0),
            },
        ),
        "product, rows of 8 in memory": Case(
            lambda: dq.multiply(A_c, B_c),
            (A, B),
            {
                "pytransform3d": (lambda: pt.batch_concatenate_dual_quaternions(A_c, B_c), 7.0),
                "scipy native": (lambda: R * S, 12.0),
            },
        ),
        "product by one pose": Case(
            lambda: dq.multiply(key, B),
            (B,),
            {
                "pytransform3d": (lambda: pt.batch_concatenate_dual_quaternions(starts, B_c), None),
                "scipy native": (lambda: R[0] * S, None),
            },
        ),
        "screw parameters": Case(
            lambda: geometry.screw_from_dual_quat(A),
            (A,),
            {
                "pytransform3d": (lambda: pt.screw_parameters_from_dual_quaternions(A_c), 10.0),
                "scipy in and out": (scipy_screw, 30.0),
            },
        ),
        "log": Case(
            lambda: dq.log(A),
            (half_twist,),
            {
                "pytransform3d from dual quaternions": (
                    lambda: pt.exponential_coordinates_from_transforms(pt.transforms_from_dual_quaternions(A_c)),
                    15.0,
                ),
                "pytransform3d from matrices": (lambda: pt.exponential_coordinates_from_transforms(matrices), None),
                "scipy native": (R.as_exp_coords, 20.0),
            },
        ),
        "exp": Case(
            lambda: dq.exp(half_twist),
            (A,),
            {
                "pytransform3d": (lambda: pt.transforms_from_exponential_coordinates(twists), None),
                "scipy native": (lambda: RigidTransform.from_exp_coords(twists), None),
            },
        ),
        "power": Case(
            lambda: dq.power(A, t),
            (A, t),
            {
                "pytransform3d": (lambda: pt.dual_quaternions_power(A_c, t), None),
                "scipy native, one t": (lambda: R**0.37, None),
            },
        ),
        "ScLERP at N values of t": Case(
            lambda: geometry.sclerp(key, end, t),
            (t, A),
            {
                "pytransform3d": (lambda: pt.dual_quaternions_sclerp(starts, ends, t), 18.0),
                "scipy in and out": (scipy_sclerp, 35.0),
            },
        ),
        "DLB of 5 keyframes": Case(lambda: geometry.dlb(keys, weights), (weights, A), {}, most_copies=12.0),
        "weights and DLB of 5 keyframes": Case(
            lambda: geometry.dlb(keys, geometry.lagrange_weights(t, knots)), (t, A), {}, most_copies=12.0
        ),
        "DIB of 5 keyframes": Case(
            lambda: geometry.dib(keys, weights, tolerance=DIB_TOLERANCE),
            (weights, A),
            {
                "scipy loop": (lambda: scipy_dib(scipy_keys, weights, scipy_start), 20.0),
                "DLB of 5 keyframes": (lambda: geometry.dlb(keys, weights), -45.0),
            },
        ),
        "continuous signs": Case(lambda: dq.continuous_signs(A), (A,), {}),
        "normalize": Case(lambda: dq.normalize(A), (A,), {}),
        "dual quaternion to pose": Case(
            lambda: dq.pose_from_dual_quat(A),
            (A,),
            {"pytransform3d": (lambda: pt.pqs_from_dual_quaternions(A_c), None)},
        ),
    }


def memory_above_result(task: Task) -> float:
    """MiB that are allocated at most at a time beside the result."""
    tracemalloc.start()
    result = task()
    kept, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del result
    return (peak - kept) / 2**20


def long_rows(name: str, case: Case, frames: int, rounds: int) -> list[Row]:
    """Time a kernel, its yardsticks and a copy of its bytes in turns; and its memory."""
    copies = [np.empty_like(array) for array in case.copied]

    def copy() -> None:
        for target, array in zip(copies, case.copied, strict=True):
            np.copyto(target, array)

    tasks = {"ours": case.ours, COPY: copy, **{key: task for key, (task, _) in case.yardsticks.items()}}
    times = alternate(tasks, rounds)
    rows = []
    for key, (_, wanted) in case.yardsticks.items():
        if wanted is not None and wanted < 0.0:  # slower than this one, by no more than so much
            rows.append(share(name, times, key, -wanted, per=frames))
        else:
            rows.append(faster(name, times, key, wanted, per=frames))
    rows.append(share(name, times, COPY, case.most_copies, per=frames))
    if name.startswith("weights"):  # which are held beside the result, as long as it
        return rows
    memory = memory_above_result(case.ours)
    return [*rows, Row(what=f"{name}, memory above the result", value=memory, unit="MiB", wanted=MEMORY_TARGET_MIB)]


def short_row(name: str, case: Case) -> Row:
    """Time of a kernel at few frames."""
    taken = [1e6 * value for value in alternate({"ours": case.ours}, SHORT_REPEATS)["ours"]]
    return Row(
        what=f"{name}, {SHORT} frames",
        value=statistics.median(taken),
        unit="us",
        low=min(taken),
        high=float(np.percentile(taken, 95.0)),
        wanted=None if name.startswith("DIB") else SHORT_TARGET_US,
    )


def measure(*, quick: bool, only: str = "") -> list[Row]:
    """Measure all kernels, long and short."""
    frames, rounds = (100_000, 5) if quick else (1_000_000, 7)
    rows = []
    for name, case in cases(frames).items():
        if only in name:
            rows += long_rows(name, case, frames, 3 if name.startswith("DIB") else rounds)
    return [*rows, *(short_row(name, case) for name, case in cases(SHORT).items() if only in name)]


if __name__ == "__main__":
    clean_environment()
    print(table(measure(quick=False, only="".join(sys.argv[1:]))))
