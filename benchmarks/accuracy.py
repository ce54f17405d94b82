"""Relative errors of the geometry against arithmetic in hundreds of digits.

    python benchmarks/accuracy.py

For each angle the largest error over slides from 0 to 1e6 and twenty screws each.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from multiprecision import ANGLES, SLIDES, relative_errors

NAMES = ("0", "1e-300", "1e-16", "1e-12", "1e-8", "1e-5", "1e-3", "0.01", "0.1", "1", "3", "π - 1e-8", "π", "2π - 1e-8")
SCREWS = 20


def main() -> None:
    """Print a table in Markdown; "–" where there is no axis."""
    table: dict[str, dict[str, float]] = {name: {} for name in NAMES}
    for name, theta in zip(NAMES, ANGLES, strict=True):
        for slide in SLIDES:
            for seed in range(SCREWS):
                for what, (error, _) in relative_errors(theta, slide, seed).items():
                    table[name][what] = max(table[name].get(what, 0.0), error)
    rows = list(table["1"])
    print("| θ | " + " | ".join(NAMES) + " |")
    print("| --- |" + " --- |" * len(NAMES))
    for what in rows:
        cells = [f"{table[name][what]:.0e}" if what in table[name] else "–" for name in NAMES]
        print(f"| {what} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
