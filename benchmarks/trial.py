"""``elbowscrew analyze`` as a whole process beside what one would write instead: ``python benchmarks/trial.py``.

Yardsticks (``benchmarks/yardsticks``): a bare pandas read with the same five figures in pyplot, and a script with
pandas, scipy and pyplot that makes the same tables and figures. Both know less: no page, no errors, no checks.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from rows import SCRIPT, Row, Run, alternate, clean_environment, faster, run, share, table
from scipy.optimize import curve_fit

from elbowscrew import save_simulation, simulate_trial
from elbowscrew.geometry.arrays import Float
from elbowscrew.results.trial_views import view_of_result
from elbowscrew.simulate import Simulation

YARDSTICKS = Path(__file__).with_name("yardsticks")
BARE = "pandas read_csv of all its tables"
DRAWN, SCRIPTED = "pandas read and pyplot figures", "the pandas script"
CYCLE = 450
EXPORT_COLUMNS = 50
WANTED_S = {450: 0.8, 1_000_000: 11.0}
PACE = f"{SCRIPTED}, 450 frames"
PACE_S = 2.08
"""What the script took on the machine, with the same versions of its libraries, for which times are wanted."""
SIZES = (10_000, 30_000, 100_000, 300_000, 1_000_000, 2_000_000)


def long_export(folder: Path, frames: int) -> Path:
    """Write an export of 50 columns with so many frames, a cycle of flexion and extension in every 450 of them."""
    path = folder / f"export{frames}.csv"
    if path.exists():
        return path
    # A cycle ends where the next one begins, so that each but the first is one frame shorter.
    cycles = max(1, -(-(frames - 1) // (CYCLE - 1)))
    trial = simulate_trial(Simulation(frames=CYCLE, repetitions=cycles))
    whole, truth = save_simulation(trial, folder / "whole.csv", overwrite=True)
    truth.unlink()
    with whole.open(encoding="utf-8") as source, path.open("w", encoding="utf-8") as target:
        for number, line in enumerate(source):
            if number >= HEADER_LINES + frames:
                break
            cells = line.rstrip("\r\n").split(",")
            target.write(line if number < 1 else ",".join(cells[:EXPORT_COLUMNS]) + "\n")
    whole.unlink()
    return path


HEADER_LINES = 7


def runs(folder: Path, frames: int, rounds: int, names: tuple[str, ...]) -> dict[str, list[Run]]:
    """Run processes in turns, each into a folder that is not there yet."""
    path = long_export(folder, frames)
    commands: dict[str, tuple[object, ...]] = {
        "ours": (SCRIPT, "analyze", path, "--quiet", "-o"),
        DRAWN: (sys.executable, YARDSTICKS / "read_and_draw.py", path),
        SCRIPTED: (sys.executable, YARDSTICKS / "pandas_script.py", path),
    }
    found: dict[str, list[Run]] = {name: [] for name in names}
    for turn in range(rounds + 1):
        for name in names if turn or frames <= CYCLE else ():  # the first turn of a short trial warms up
            out = folder / "out"
            one = run(*commands[name], out)
            shutil.rmtree(out)
            if turn:
                found[name].append(one)
    return found


def beside(folder: Path, frames: int, rounds: int, *, most: tuple[float, float], least: float | None) -> list[Row]:
    """One trial of so many frames beside both yardsticks; `most` of their times, or `least` as fast as the script."""
    found = runs(folder, frames, rounds, ("ours", DRAWN, SCRIPTED))
    times = {name: [one.seconds for one in values] for name, values in found.items()}
    what = f"analyze, {frames:,} frames, all outputs"
    script = share(what, times, SCRIPTED, most[1]) if least is None else faster(what, times, SCRIPTED, least)
    memory = {name: max(one.memory for one in values) / 1e9 for name, values in found.items()}
    return [
        share(what, times, DRAWN, most[0]),
        script,
        Row(what=what, value=statistics.median(times["ours"]), unit="s", wanted=WANTED_S.get(frames)),
        Row(what=f"{SCRIPTED}, {frames:,} frames", value=statistics.median(times[SCRIPTED]), unit="s"),
        Row(
            what=f"most memory at {frames:,} frames",
            value=memory["ours"],
            unit="GB",
            wanted=None if least is None else 1.0,
            behind=f"{memory[DRAWN]:.2f} GB of the figures alone, {memory[SCRIPTED]:.2f} GB of the script",
        ),
    ]


def scaling(folder: Path, sizes: tuple[int, ...]) -> list[Row]:
    """Exponent of the time over the number of frames beside a constant, which is start-up, figures and page."""
    found = {frames: min(one.seconds for one in runs(folder, frames, 3, ("ours",))["ours"]) for frames in sizes}
    frames, seconds = np.array(sizes, dtype=np.float64) / sizes[-1], np.array(list(found.values()))

    def of(size: Float, constant: float, scale: float, exponent: float) -> Float:
        return constant + scale * size**exponent

    start = (1.0, seconds[-1], 1.0)
    (constant, _, exponent), _ = curve_fit(of, frames, seconds, start, sigma=seconds, bounds=(0.0, np.inf))
    told = ", ".join(f"{count:,}: {taken:.2f} s" for count, taken in found.items())
    return [
        Row(
            what=f"time c + b N^p over the frames, {sizes[0]:,} to {sizes[-1]:,}",
            value=abs(float(exponent) - 1.0),
            unit="between p and 1",
            wanted=0.05,
            behind=f"p = {exponent:.3f}, c = {constant:.2f} s; {told}",
        )
    ]


def reading_back(folder: Path, frames: int, wanted: float) -> list[Row]:
    """What `report` needs of a long result, read from its tables with all checks, beside pandas on the same tables."""
    result = folder / "result"
    run(SCRIPT, "analyze", long_export(folder, frames), "--quiet", "--figure-format", "none", "-o", result)
    tables = sorted(result.glob("*.csv"))
    times = alternate(
        {"ours": lambda: view_of_result(result), BARE: lambda: [pd.read_csv(path) for path in tables]}, 1, warm=False
    )
    size = sum(path.stat().st_size for path in tables) / 1e6
    shutil.rmtree(result)
    what = f"reading a result of {frames:,} frames back"
    return [
        share(what, times, BARE),
        Row(what=what, value=times["ours"][0], unit="s", wanted=wanted, behind=f"{size:.0f} MB of tables, and digests"),
    ]


def measure(folder: Path, *, quick: bool) -> list[Row]:
    """Measure short and long trials."""
    return [
        *beside(folder, 450, 5 if quick else 15, most=(0.8, 0.4), least=None),
        *beside(folder, 1_000_000, 1 if quick else 3, most=(1.5, 0.0), least=12.0),
        *reading_back(folder, 1_000_000, 1.6),
        *scaling(folder, SIZES[:3] if quick else SIZES),
    ]


if __name__ == "__main__":
    clean_environment()
    with tempfile.TemporaryDirectory() as temporary:
        print(table(measure(Path(temporary), quick=False)))
