"""Sense of theta on 960 motions of 24 kinds: ``python benchmarks/sense.py [--seeds 40] [--first 0]`` (half a minute).

A motion is wrong where more than 0.2 % of its frames are off by more than 30 deg. Beside it stand rules that are
simpler: each axis oriented by the one before, the hemisphere of the dominant axis, and that with whole turns counted
along time.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from sense_motions import KINDS, SenseMotion, made, rotation, share_wrong

from elbowscrew.geometry.arrays import Float
from elbowscrew.motion.screws.sense import sense_of

WRONG_SHARE = 0.002


def by_sense(motion: SenseMotion) -> Float:
    return sense_of(motion.quat, motion.time_s, 0).angle


def unsigned(motion: SenseMotion) -> tuple[Float, Float, Float]:
    quat = np.where(motion.quat[:, :1] < 0.0, -motion.quat, motion.quat)
    size = np.linalg.norm(quat[:, 1:], axis=1)
    return 2.0 * np.arctan2(size, quat[:, 0]), quat[:, 1:], size


def oriented(angle: Float) -> Float:
    return angle if np.nanmax(angle) >= -np.nanmin(angle) else -angle


def by_the_one_before(motion: SenseMotion) -> Float:
    """Continuous signs of the quaternions, the axis kept from frame to frame, half angles unwrapped."""
    angle, vector, size = unsigned(motion)
    known = np.flatnonzero(np.isfinite(size))
    quat = np.column_stack([np.cos(0.5 * angle), vector])[known]
    flips = np.sum(quat[1:] * quat[:-1], axis=1) < 0.0
    quat *= np.cumprod(np.concatenate([[1.0], np.where(flips, -1.0, 1.0)]))[:, None]
    last, half = None, np.empty(known.size)
    for k, (scalar, *v) in enumerate(quat):
        axis = np.array(v)
        sense = 1.0 if last is None or axis @ last >= 0.0 else -1.0
        if np.linalg.norm(axis) >= np.sin(np.radians(5.0)):
            last = sense * axis
        half[k] = np.arctan2(sense * np.linalg.norm(axis), scalar)
    half = np.unwrap(half)
    found = np.full(size.size, np.nan)
    found[known] = 2.0 * (half - np.pi * np.round(half[0] / np.pi))
    return oriented(found)


def by_hemisphere(motion: SenseMotion) -> Float:
    angle, vector, _ = unsigned(motion)
    known = np.isfinite(angle)
    u = np.linalg.eigh(vector[known].T @ vector[known])[1][:, 2]
    return oriented(np.where(vector @ u < 0.0, -angle, angle))


def by_hemisphere_and_time(motion: SenseMotion) -> Float:
    angle = by_hemisphere(motion)
    known = np.isfinite(angle)
    angle[known] = np.unwrap(angle[known])
    return oriented(angle - 2.0 * np.pi * np.round(angle[0] / (2.0 * np.pi)))


RULES = {
    "sense": by_sense,
    "the one before": by_the_one_before,
    "hemisphere": by_hemisphere,
    "hemisphere, time": by_hemisphere_and_time,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=40, help="motions of each kind")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    options = parser.parse_args()
    seeds, first = options.seeds, options.first
    print("| kind | ratio | " + " | ".join(RULES) + " |")
    print("| --- | --- |" + " ---: |" * len(RULES))
    total = dict.fromkeys(RULES, 0)
    for kind in KINDS:
        motions = [made(kind, seed) for seed in range(first, first + seeds)]
        ratios = [sense_of(one.quat, one.time_s, 0).ratio for one in motions]
        wrong = {
            name: sum(share_wrong(one, rule(one)) > WRONG_SHARE for one in motions) for name, rule in RULES.items()
        }
        total = {name: total[name] + wrong[name] for name in RULES}
        cells = " | ".join(str(count or "") for count in wrong.values())
        print(f"| {kind} | {min(ratios):.3f}–{max(ratios):.3f} | {cells} |")
    print(f"| **of {seeds * len(KINDS)}** | | " + " | ".join(str(count) for count in total.values()) + " |")
    for frames in (450, 1_000_000):
        x = np.radians(60.0) * (1.0 - np.cos(np.arange(frames) / 40.0))
        quat = rotation(x, np.array([1.0, 0.0, 0.0]))
        start = time.perf_counter()
        sense_of(quat, np.arange(frames) / 100.0, 0)
        print(f"{frames} frames: {1e3 * (time.perf_counter() - start):.1f} ms")


if __name__ == "__main__":
    main()
