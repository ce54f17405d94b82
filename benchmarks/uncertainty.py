"""Coverage of the 95 % intervals of a frame's screw: 10,000 noisy pairs of poses for each angle.

    python benchmarks/uncertainty.py [TRIALS]

Each trial sees both poses of the pair through noisy markers, fits the bodies, and asks whether the truth lies within
the interval that is computed from that trial alone.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from coverage_of_screws import coverage

ANGLES_DEG = (5, 10, 20, 45, 90, 135, 170)


def main() -> None:
    """Print a table in Markdown."""
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    print("| arm | θ deg | θ % | slide % | direction % | place % |")
    print("| --- | --- | --- | --- | --- | --- |")
    for proximal_moves in (False, True):
        for angle in ANGLES_DEG:
            shares = coverage(np.radians(angle), trials, proximal_moves=proximal_moves, seed=angle)
            cells = " | ".join(f"{100.0 * share:.1f}" for share in shares)
            print(f"| {'moving' if proximal_moves else 'still'} | {angle} | {cells} |")


if __name__ == "__main__":
    main()
