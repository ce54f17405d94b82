"""The yardstick of ``batch.py``: seconds of the work on each trial of a folder, one after another in this process.

Reading, analyzing and writing, as ``elbowscrew analyze`` does them; imports and the first trial, which fills caches,
are not counted, but made up for by the mean of the others.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from elbowscrew import Settings, save_analysis
from elbowscrew.results import analyze_file


def main(data: Path, out: Path) -> None:
    times = []
    for path in sorted(data.glob("*.csv")):
        start = time.perf_counter()
        save_analysis(analyze_file(path, Settings()), out / path.stem, force=True)
        times.append(time.perf_counter() - start)
    print(sum(times[1:]) * len(times) / (len(times) - 1))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
