"""Errors of the estimators of a hinge's line, beside the bound of Cramér and Rao.

    python benchmarks/joint_axis.py [TRIALS]

Hinges of 450 frames, both bodies moving, four markers each with 0.2 mm noise.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from hinges import hinge_errors

TOPS_DEG = (20, 60, 140)


def main() -> None:
    """Print RMS errors in degrees as a table in Markdown."""
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    columns = {top: hinge_errors(top, trials, seed=top) for top in TOPS_DEG}
    robust = {top: hinge_errors(top, max(trials // 10, 50), seed=top + 1, robust_too=True) for top in TOPS_DEG}
    print("| estimator | " + " | ".join(f"{top} deg" for top in TOPS_DEG) + " |")
    print("| --- |" + " --- |" * len(TOPS_DEG))
    for name in columns[TOPS_DEG[0]]:
        print(f"| {name} | " + " | ".join(rms(columns[top][name]) for top in TOPS_DEG) + " |")
    for name in robust[TOPS_DEG[0]]:
        if "robust" in name or "outliers" in name:
            print(f"| {name} | " + " | ".join(rms(robust[top][name]) for top in TOPS_DEG) + " |")


def rms(errors: np.ndarray) -> str:
    return f"{np.degrees(np.sqrt(np.mean(errors**2))):.4f}"


if __name__ == "__main__":
    main()
