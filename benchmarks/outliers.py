"""How often the page of a study flags an outlier where there is none: run ``python benchmarks/outliers.py``."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np

from elbowscrew.geometry.arrays import Float
from elbowscrew.group.outliers import FALSE_ALARMS, outliers_of_study

SECONDS = 50.0
NUMBERS = 4
CONDITIONS = 2
MOST_TRIALS = 6
Clean = tuple[dict[str, Float], list[list[int]], list[str]]
"""Numbers of trials, the trials of each group, and their subjects."""


def trials_of_nobody(rng: np.random.Generator, count: int) -> Clean:
    """Clean groups of so many trials, their subjects not known."""
    rows = [list(range(k * count, (k + 1) * count)) for k in range(CONDITIONS)]
    return {str(k): rng.standard_normal(CONDITIONS * count) for k in range(NUMBERS)}, rows, [""] * CONDITIONS * count


def trials_of_subjects(rng: np.random.Generator, count: int, icc: float) -> Clean:
    """Clean groups of so many subjects with one to six trials each."""
    sizes = rng.integers(1, MOST_TRIALS + 1, size=(CONDITIONS, count))
    subjects = [f"S{k}" for row in sizes for k, size in enumerate(row) for _ in range(size)]
    ends = np.cumsum(sizes.sum(axis=1)).tolist()
    rows = [list(range(first, last)) for first, last in zip([0, *ends], ends, strict=False)]
    numbers = {}
    for k in range(NUMBERS):
        own = np.repeat(rng.standard_normal(sizes.size), sizes.ravel())
        numbers[str(k)] = np.sqrt(icc) * own + np.sqrt(1.0 - icc) * rng.standard_normal(len(subjects))
    return numbers, rows, subjects


def main() -> None:
    kinds: list[tuple[str, Callable[..., Clean], tuple[float, ...]]]
    kinds = [(f"{n} trials", trials_of_nobody, (n,)) for n in (5, 6, 8, 10, 15, 20, 30, 40)]
    kinds += [
        (f"{k} subjects, ICC {icc:g}", trials_of_subjects, (k, icc))
        for k in (2, 5, 6, 8, 12)
        for icc in (0.0, 0.5, 0.9)
    ]
    print(f"{CONDITIONS} conditions, {NUMBERS} numbers; stated: at most {FALSE_ALARMS:.0%} of pages")
    for name, make, how in kinds:
        rng = np.random.default_rng(2010)
        alarms = pages = 0
        ends = time.perf_counter() + SECONDS / len(kinds) * (float(sys.argv[1]) if len(sys.argv) > 1 else 1.0)
        while time.perf_counter() < ends:
            found = outliers_of_study(*make(rng, *how))
            alarms += any(one.trial.any() or one.subject.any() for one in found.values())
            pages += 1
        share = alarms / pages
        print(f"{name:24s} {share:6.2%} ± {np.sqrt(share * (1.0 - share) / pages):.2%} of {pages} pages")


if __name__ == "__main__":
    main()
