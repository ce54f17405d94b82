"""The yardstick of ``batch.py``: the work on a folder in one process, ``batch_single.py DATA OUT``; JSON on the output.

Reading, analyzing and writing, as ``elbowscrew analyze`` does them. Imports and the first trial, which fills caches,
are not counted, but made up for by the mean of the others. Then the same stage by stage.
"""

from __future__ import annotations

import json
import shutil
import statistics
import sys
import time
from collections import defaultdict
from pathlib import Path

from elbowscrew import Settings, analyze, read_recording, save_analysis
from elbowscrew._process import collect_garbage, set_up_process
from elbowscrew.report import write_trial_page
from elbowscrew.report.figure_files import figure_files
from elbowscrew.saving import analyze_file
from elbowscrew.view.figure_names import USUAL_FIGURES

STAGED = 50
STAGES = ("read", "analyze", "write", "page", "figures", "tables and page")


def main(data: Path, out: Path) -> None:
    set_up_process()
    paths = sorted(data.glob("*.csv"))
    times, processor = [], []
    for path in paths:
        start, start_processor = time.perf_counter(), time.process_time()
        save_analysis(analyze_file(path, Settings()), out / path.stem, overwrite=True)
        collect_garbage()
        times.append(time.perf_counter() - start)
        processor.append(time.process_time() - start_processor)
    whole = [sum(values[1:]) * len(values) / (len(values) - 1) for values in (times, processor)]
    print(json.dumps({"seconds": whole[0], "processor": whole[1], "stages_ms": stages(paths[:STAGED], out)}))


def stages(paths: list[Path], out: Path) -> dict[str, float]:
    """Milliseconds of a trial, by what is done: the median of several."""
    found: dict[str, list[float]] = defaultdict(list)
    for path in paths:
        folder = out / path.stem
        shutil.rmtree(folder)
        marks = [time.perf_counter()]
        recording = read_recording(path)
        marks.append(time.perf_counter())
        analysis = analyze(recording, Settings())
        marks.append(time.perf_counter())
        save_analysis(analysis, folder, figure_formats=(), report=False)
        marks.append(time.perf_counter())
        write_trial_page(folder)
        marks.append(time.perf_counter())
        figure_files(analysis, USUAL_FIGURES, ("png",))
        marks.append(time.perf_counter())
        save_analysis(analysis, folder, overwrite=True, figure_formats=())
        marks.append(time.perf_counter())
        collect_garbage()
        for name, before, after in zip(STAGES, marks, marks[1:], strict=False):
            found[name].append(1e3 * (after - before))
    return {name: statistics.median(values) for name, values in found.items()}


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
