"""Whether the search for two axes fails, which joint is told for which, and what the intervals cover.

    python benchmarks/joint_types.py [--quick] [--stated] [--seed N] [--trials N] [starts] [types] [pronation]
        [coverage] [intervals] [angles] [wander]

Synthetic joints with both bodies' noise. Types: by noise, range and what real joints add, an axis that wanders by 5 deg
and a cluster that moves on the bone by 4 deg and 5 mm; the noise's size is told to the choice with
--stated. Apart from these stand hinges with an axial turn of 5 to 20 deg that goes with the flexion, as a knee's, and
elbows that pronate while they flex by 140 deg, with the noise told and not.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

import moving_joints as mj
from cluster_noise import Noise, seen, skin, smooth_skin, turning, wander, white
from trials import LINE, START
from typed_noise import (
    AXIS2,
    Kind,
    angles_held,
    angles_in_an_eight,
    joint_of,
    skin_of_both,
    typed_coverage,
    wandering_elbow,
)

from elbowscrew.geometry import dual_quaternion as dq
from elbowscrew.geometry import quaternion as qn
from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.joint.choice import choose_type
from elbowscrew.motion.joint.fitting import fit_type
from elbowscrew.motion.joint.likelihood import fit_mechanism
from elbowscrew.motion.joint.poses import Poses
from elbowscrew.motion.joint.starts import find_two_axes
from elbowscrew.motion.joint.typed import identify_joint
from elbowscrew.motion.screws.uncertainty import joint_covariance

FRAMES = 200
NOISES = ((0.1, 2e-4), (0.5, 1e-3))
RANGES_DEG = (20, 40, 90, 140)
DISTURBANCES = ("clean", "wander", "skin")
PRONATIONS_DEG = (2, 5, 10, 20, 30, 60)
TYPES = ("rigid", "hinge", "two_axes", "ball", "free")


def main() -> None:
    """Print the tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "parts", nargs="*", default=["starts", "types", "pronation", "coverage", "intervals", "angles", "wander"]
    )
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--seed", type=int, default=15)
    parser.add_argument("--stated", action="store_true", help="tell the choice of types how large the noise is")
    parser.add_argument(
        "--trials", type=int, default=None, help="in a cell; of the searches, the share of 1,500 is 1 in N"
    )
    options = parser.parse_args()
    trials = options.trials
    if "starts" in options.parts:
        starts(trials or (20 if options.quick else 1), options.seed)
    if "types" in options.parts:
        types(trials or (2 if options.quick else 12), options.seed, stated=options.stated)
    if "pronation" in options.parts:
        pronation(trials or (3 if options.quick else 20), options.seed)
    if "coverage" in options.parts:
        coverage(trials or (30 if options.quick else 300), options.seed)
    if "intervals" in options.parts:
        intervals(trials or (10 if options.quick else 60), options.seed)
    if "angles" in options.parts:
        angles(trials or (5 if options.quick else 30), options.seed)
    if "wander" in options.parts:
        wandering(trials or (3 if options.quick else 40), options.seed)


def noises() -> dict[str, Noise]:
    """Kinds of noise of the markers, by their names."""
    return {
        "white 0.2 mm": white(),
        "skin with the flexion, 5 mm": skin(5e-3),
        "skin with both angles, 5 mm": skin_of_both(5e-3),
        "skin, smooth, 5 mm": smooth_skin(5e-3),
        "markers wander, 2 mm": wander(2e-3),
        "clusters turn, 2 deg": turning(np.radians(2.0)),
    }


def angles(trials: int, seed: int) -> None:
    """Print which share of the errors of two axes' angles is within 1.96 standard deviations."""
    print("\n| deg | noise | given axes | with their errors |\n| --- | --- | --- | --- |")
    for top_deg in (60.0, 140.0):
        for name, noise in noises().items():
            given, whole = angles_held(joint_of("two_axes", top_deg), noise, trials, seed=seed)
            cells = [", ".join(f"{share:.2f}" for share in shares) for shares in (given, whole)]
            print(f"| {top_deg:g} | {name} | {cells[0]} | {cells[1]} |", flush=True)


WANDERS_DEG = ((0.0, 0.0), (1.5, 0.0), (3.0, 0.0), (6.0, 0.0), (0.0, 3.0))


def wandering(trials: int, seed: int) -> None:
    """Print how often one of two axes is told to wander, by how much, and whether the mean axes are in their cones."""
    print(
        "\n| deg | noise | tested | told of none | of axis 1 by 1.5, 3, 6 deg | of axis 2 by 3 deg | 6 deg found as |",
        end="",
    )
    print(" unseen | held |\n" + 9 * "| --- " + "|")
    for tops_deg in ((140.0, 80.0), (60.0, 60.0)):
        for name, noise in {
            "white 0.2 mm": white(),
            "skin with the flexion, 0.5 mm": skin(5e-4),
            "skin with the flexion, 5 mm": skin(5e-3),
            "clusters turn, 0.2 deg": turning(np.radians(0.2)),
            "clusters turn, 2 deg": turning(np.radians(2.0)),
        }.items():
            cells = [wander_cell(tops_deg, noise, sizes, trials, seed) for sizes in WANDERS_DEG]
            told = [np.mean([one.told for one in cell], axis=0) if cell else np.full(2, np.nan) for cell in cells]
            held = np.array([axis for cell in cells for one in cell if any(one.told) for axis in one.held])
            unseen = np.median([one.unseen_deg for cell in cells for one in cell] or [(np.nan, np.nan)], axis=0)
            sizes = [one.size_deg[0] for one in cells[3] if np.isfinite(one.size_deg[0])]
            print(
                f"| {tops_deg[0]:g}, {tops_deg[1]:g} | {name} | "
                f"{np.mean([len(cell) for cell in cells]) / trials:.2f} | "
                f"{told[0][0]:.2f}, {told[0][1]:.2f} | {', '.join(f'{share[0]:.2f}' for share in told[1:4])} | "
                f"{told[4][1]:.2f} | {f'{np.median(sizes):.1f}' if sizes else ''} | "
                f"{', '.join(f'{one:.2g}' for one in unseen)} | "
                f"{f'{held.mean():.2f} of {held.size}' if held.size else ''} |",
                flush=True,
            )


class ToldWander(NamedTuple):
    """Of axis 1 and 2: told or not, how far, how far none would be seen, and whether the mean axis is in its cone."""

    told: tuple[bool, ...]
    size_deg: tuple[float, ...]
    unseen_deg: tuple[float, ...]
    held: tuple[bool, ...]


def wander_cell(
    tops_deg: tuple[float, float], noise: Noise, sizes_deg: tuple[float, float], trials: int, seed: int
) -> list[ToldWander]:
    """Of the trials in which both axes are told."""
    course, truth = angles_in_an_eight(tops_deg), (LINE, dq.transform_lines(dq.conjugate(START), AXIS2))
    rng, found = np.random.default_rng(seed), []
    for _ in range(trials):
        hinge = wandering_elbow(course, sizes_deg, rng)
        case = seen(hinge, noise(hinge, rng))
        covariance = joint_covariance(case.joint, *case.noise)
        two = identify_joint(case.joint, covariance, case.joint[0], noise_known=True, clusters=case.clusters).two_axes
        if two is None or not all(line.determined for line in two.lines):
            continue
        wanders = [line.wander for line in two.lines]
        directions = two.axis1.direction_proximal, two.axis2.direction_distal
        off = [mj.angle_between(mine, true) for mine, true in zip(directions, truth, strict=True)]
        found.append(
            ToldWander(
                told=tuple(one is not None and one.significant for one in wanders),
                size_deg=tuple(np.nan if one is None else float(np.degrees(one.tilt)) for one in wanders),
                unseen_deg=tuple(45.0 if one is None else float(np.degrees(one.unseen_tilt)) for one in wanders),
                held=tuple(far <= line.axis_cone for far, line in zip(off, two.lines, strict=True)),
            )
        )
    return found


def intervals(trials: int, seed: int) -> None:
    """Print how often intervals are told, and which hold, that stand on markers, residuals and blocks."""
    joints: tuple[tuple[Kind, float, int], ...] = (
        ("two_axes", 140.0, 1),
        ("two_axes", 60.0, 1),
        ("two_axes", 140.0, 8),
        ("two_axes", 60.0, 8),
        ("ball", 60.0, 1),
    )
    print("\n| joint | deg | cycles | noise | held | told | told and missed | sharpness |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for kind, top_deg, cycles in joints:
        for name, noise in noises().items():
            found = typed_coverage(kind, joint_of(kind, top_deg, cycles), noise, trials, seed=seed, rms_alone=False)
            held, told, missed = (
                ", ".join(f"{what} {share:.2f}" for what, share in zip(found.names, shares, strict=True))
                for shares in (found.held, found.told_share, found.missed_share)
            )
            sharp = f"{found.sharpness.min():.1f} to {found.sharpness.max():.1f}"
            print(f"| {kind} | {top_deg:g} | {cycles} | {name} | {held} | {told} | {missed} | {sharp} |", flush=True)


def starts(share: int, seed: int) -> None:
    """Print how many searches end above the likelihood of the truth."""
    kinds = {
        "elbow": (1000, (60.0, 120.0), (0.0, 0.025)),
        "nearly parallel": (300, (0.0, 5.0), (0.01, 0.06)),
        "intersecting": (200, (30.0, 150.0), (0.0, 0.0)),
    }
    print("| axes | searches | failures | CPU time each, ms |\n| --- | --- | --- | --- |")
    for name, (count, between, distance) in kinds.items():
        rng = np.random.default_rng([seed, len(name)])
        failures, used = 0, 0.0
        for _ in range(count // share):
            ranges = (float(rng.uniform(20.0, 140.0)), float(rng.uniform(20.0, 140.0)))
            exact = mj.two_axes(450, ranges, rng.uniform(*between), rng.uniform(*distance), rng)
            seen, covariance = mj.noisy(exact.poses, rng, *NOISES[0])
            poses = Poses.of(seen, covariance)
            start = time.process_time()
            fit = fit_mechanism(find_two_axes(poses).mechanism.placed(seen), poses)
            used += time.process_time() - start
            # At the truth the variance is 1 with a standard deviation of sqrt(2 / 1788) = 0.033.
            failures += int(fit.variance > 1.2)
        searches = count // share
        print(f"| {name} | {searches} | {failures} | {1000.0 * used / searches:.0f} |")


def sample(kind: str, range_deg: float, rng: np.random.Generator) -> mj.MovingJoint:
    """A joint of a type; what is not rigid goes through the range with each of its angles."""
    match kind:
        case "rigid":
            return mj.rigid(FRAMES, rng)
        case "hinge":
            return mj.hinge(FRAMES, range_deg, rng)
        case "two_axes":
            between, apart = rng.uniform(60.0, 120.0), rng.uniform(0.0, 0.02)
            return mj.two_axes(FRAMES, (range_deg, rng.uniform(0.5, 1.0) * range_deg), between, apart, rng)
        case "ball":
            return mj.ball(FRAMES, range_deg, rng)
    return mj.free(FRAMES, range_deg, rng)


def types(trials: int, seed: int, *, stated: bool) -> None:
    """Print what is told for each type, and the shares that are right and surely wrong at ranges from 40 deg."""
    told: dict[tuple[str, str, int], Counter[str]] = {}
    right = sure_wrong = total = 0
    rng = np.random.default_rng(seed)
    for disturbance in DISTURBANCES:
        for range_deg in RANGES_DEG:
            for kind in TYPES:
                counter = told.setdefault((disturbance, kind, range_deg), Counter())
                for noise in NOISES:
                    for _ in range(trials):
                        exact = sample(kind, range_deg, rng)
                        poses = exact.poses
                        if disturbance == "wander" and kind in ("hinge", "two_axes"):
                            poses = mj.with_wander(poses, exact.truth, 5.0)
                        if disturbance == "skin" and kind != "rigid":
                            poses = mj.with_skin(poses, rng, 4.0, 0.005)
                        seen, covariance = mj.noisy(poses, rng, *noise)
                        choice = choose_type(Poses.of(seen, covariance), noise_known=stated)
                        name = "hinge" if choice.type == "screw_hinge" else choice.type
                        counter[f"{name} {choice.status or ''}".strip()] += 1
                        if range_deg >= 40:
                            total += 1
                            right += name == kind
                            sure_wrong += name != kind and choice.status == "determined"
    for range_deg in RANGES_DEG:
        counter = told.setdefault(("axial turn", "hinge", range_deg), Counter())
        for noise in NOISES:
            for _ in range(trials):
                seen, covariance = mj.noisy(screwing_home(range_deg, rng), rng, *noise)
                choice = choose_type(Poses.of(seen, covariance), noise_known=stated)
                name = "hinge" if choice.type == "screw_hinge" else choice.type
                counter[f"{name} {choice.status or ''}".strip()] += 1
    print("\n| disturbance | joint | range, deg | told |\n| --- | --- | --- | --- |")
    for (disturbance, kind, range_deg), counter in told.items():
        print(f"| {disturbance} | {kind} | {range_deg} | " + ", ".join(f"{n} {k}" for k, n in counter.items()) + " |")
    print(f"\nFrom 40 deg: right {right / total:.3f}, wrong and determined {sure_wrong / total:.3f} of {total}.")


def screwing_home(range_deg: float, rng: np.random.Generator) -> Float:
    """A hinge whose distal body turns on about a line of its own over the first part of the range."""
    exact = mj.hinge(FRAMES, range_deg, rng)
    angle, axis = exact.truth["angles"], exact.truth["axis1"]
    place = np.clip((angle - angle.min()) / np.ptp(angle) / rng.uniform(0.25, 1.0), 0.0, 1.0)
    turn = np.radians(rng.uniform(5.0, 20.0)) * (3.0 * place**2 - 2.0 * place**3)
    across = mj.unit(np.cross(axis[:3], rng.normal(size=3)))
    line = mj.line(across, np.cross(axis[:3], axis[3:]) + rng.normal(0.0, 0.01, 3))
    return dq.multiply(exact.poses, mj.turned(turn, dq.transform_lines(dq.conjugate(exact.poses[0]), line)))


def pronation(trials: int, seed: int) -> None:
    """Print what is told of an elbow that flexes by 140 deg and pronates by a little, out and back on other ways."""
    rng = np.random.default_rng(seed)
    print("\n| pronation, deg | cluster | noise | told | second rotation, deg | flexion axis off, deg |")
    print("| --- | --- | --- | --- | --- | --- |")
    for moves in (False, True):
        for size in PRONATIONS_DEG:
            for stated in (True, False):
                told: Counter[str] = Counter()
                second, off = [], []
                for _ in range(trials):
                    poses, axis = pronating(size, rng)
                    poses = mj.with_skin(poses, rng, 4.0, 0.005) if moves else poses
                    seen, covariance = mj.noisy(poses, rng, *NOISES[0])
                    found = identify_joint(seen, covariance, seen[0], noise_known=stated)
                    told[f"{found.type} {found.status or ''}".strip()] += 1
                    if found.second_rotation is not None:
                        second.append(float(np.degrees(found.second_rotation.range)))
                    if found.two_axes is not None:
                        off.append(np.degrees(mj.angle_between(found.two_axes.axis1.direction_proximal, axis)))
                kinds = ", ".join(f"{count} {name}" for name, count in told.items())
                cells = [f"{np.median(values):.2f}" if values else "" for values in (second, off)]
                where, noise = "moves" if moves else "sits", "stated" if stated else "not stated"
                print(f"| {size} | {where} | {noise} | {kinds} | {cells[0]} | {cells[1]} |", flush=True)


def pronating(size_deg: float, rng: np.random.Generator) -> tuple[Float, Float]:
    """Poses (450, 8) of an elbow, and its flexion axis (6,)."""
    time = np.linspace(0.0, 2.0 * np.pi, 450)
    flexion = np.radians(140.0) * 0.5 * (1.0 - np.cos(time))
    turn = np.radians(size_deg) * 0.5 * (1.0 - np.cos(time - rng.uniform(0.4, 1.2)))
    h1, p1 = mj.unit(rng.normal(size=3)), rng.normal(0.0, 0.08, 3)
    normal = mj.unit(np.cross(h1, rng.normal(size=3)))
    h2 = qn.rotate(qn.quat_from_rotation_vector(np.radians(rng.uniform(80.0, 95.0)) * normal), h1)
    first, second = mj.line(h1, p1), mj.line(h2, p1 + 0.013 * h1 + 0.008 * normal)
    poses = dq.multiply(dq.multiply(mj.turned(flexion, first), mj.turned(turn, second)), mj.rest_pose(rng))
    return poses, first


def coverage(trials: int, seed: int) -> None:
    """Print how often the truth is within its interval of 95 %, on white noise."""
    rng = np.random.default_rng(seed)
    inside = {"axis 1 direction": 0, "axis 1 place": 0, "axis 2 direction": 0, "axis 2 place": 0, "center": 0}
    for _ in range(trials):
        exact = mj.two_axes(FRAMES, (100.0, 70.0), 85.0, 0.012, rng)
        seen, covariance = mj.noisy(exact.poses, rng, *NOISES[0])
        poses = Poses.of(seen, covariance)
        fit = fit_mechanism(find_two_axes(poses).mechanism.placed(seen), poses)
        C = np.linalg.inv(fit.information)
        for k, pose in enumerate((fit.mechanism.proximal, fit.mechanism.distal)):
            line = dq.transform_lines(dq.conjugate(pose), exact.truth[f"axis{k + 1}"])
            line = line if line[2] > 0.0 else -line
            error = np.array([-line[1], line[0], -line[4], line[3]])
            for part, name in ((slice(0, 2), "direction"), (slice(2, 4), "place")):
                block = C[8 * k : 8 * k + 4, 8 * k : 8 * k + 4][part, part]
                square = float(error[part] @ np.linalg.solve(block, error[part]))
                inside[f"axis {k + 1} {name}"] += int(square < 5.991)
        joint = mj.ball(FRAMES, 60.0, rng)
        seen, covariance = mj.noisy(joint.poses, rng, *NOISES[0])
        ball = fit_type("ball", Poses.of(seen, covariance))
        off = ball.mechanism.proximal - joint.truth["proximal"]  # type: ignore[attr-defined]
        inside["center"] += int(float(off @ np.linalg.solve(np.linalg.inv(ball.information)[:3, :3], off)) < 7.815)
    print("\n| number | covered |\n| --- | --- |")
    for name, count in inside.items():
        print(f"| {name} | {count / trials:.3f} |")


if __name__ == "__main__":
    main()
