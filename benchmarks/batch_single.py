"""The yardstick of ``batch.py``: seconds, and seconds of processor time, of the work on a folder in one process.

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
    times, processor = [], []
    for path in sorted(data.glob("*.csv")):
        start, start_processor = time.perf_counter(), time.process_time()
        save_analysis(analyze_file(path, Settings()), out / path.stem, force=True)
        times.append(time.perf_counter() - start)
        processor.append(time.process_time() - start_processor)
    print(*(sum(values[1:]) * len(values) / (len(values) - 1) for values in (times, processor)))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
