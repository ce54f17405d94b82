"""``elbowscrew analyze`` as a whole process beside what one would write instead: ``python benchmarks/trial.py``.

Yardsticks (``benchmarks/yardsticks``): a bare pandas read with the same five figures in pyplot, and a script with
pandas, scipy and pyplot that makes the same tables and figures. Both know less: no page, no errors, no checks.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from rows import SCRIPT, Row, Run, clean_environment, faster, run, share, table

from elbowscrew import save_simulation, simulate_trial
from elbowscrew.simulate import Simulation

YARDSTICKS = Path(__file__).with_name("yardsticks")
DRAWN, SCRIPTED = "pandas read and pyplot figures", "the pandas script"
CYCLE = 450
EXPORT_COLUMNS = 50
SIZES = (450, 10_000, 30_000, 100_000, 300_000, 1_000_000, 2_000_000)


def long_export(folder: Path, frames: int) -> Path:
    """Write an export of 50 columns with so many frames, a cycle of flexion and extension in every 450 of them."""
    path = folder / f"export{frames}.csv"
    if path.exists():
        return path
    # A cycle ends where the next one begins, so that each but the first is one frame shorter.
    cycles = max(1, -(-(frames - 1) // (CYCLE - 1)))
    trial = simulate_trial(Simulation(frames=CYCLE, repetitions=cycles))
    whole, truth = save_simulation(trial, folder / "whole.csv", force=True)
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
    for _ in range(rounds):
        for name in names:
            out = folder / "out"
            found[name].append(run(*commands[name], out))
            shutil.rmtree(out)
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
        Row(
            what=f"most memory at {frames:,} frames",
            value=memory["ours"],
            unit="GB",
            wanted=None if least is None else 1.0,
            behind=f"{memory[DRAWN]:.2f} GB of the figures alone, {memory[SCRIPTED]:.2f} GB of the script",
        ),
    ]


def scaling(folder: Path, sizes: tuple[int, ...]) -> list[Row]:
    """Exponent of the time over the number of frames, above what the smallest takes, which is start-up and figures."""
    found = {frames: min(one.seconds for one in runs(folder, frames, 3, ("ours",))["ours"]) for frames in sizes}
    least, *longer = sizes
    above = [found[frames] - found[least] for frames in longer]
    exponent = float(np.polyfit(np.log(longer), np.log(above), 1)[0])
    told = ", ".join(f"{frames:,}: {found[frames]:.2f} s" for frames in sizes)
    return [
        Row(
            what=f"exponent of the time, {longer[0]:,} to {longer[-1]:,} frames, start-up and figures taken off",
            value=exponent,
            unit="",
            wanted=1.05,
            behind=told,
        )
    ]


def measure(folder: Path, *, quick: bool) -> list[Row]:
    """Measure short and long trials."""
    long, sizes = (100_000, SIZES[:4]) if quick else (1_000_000, SIZES)
    return [
        *beside(folder, 450, 5 if quick else 15, most=(0.8, 0.65), least=None),
        *beside(folder, long, 1 if quick else 3, most=(1.5, 0.0), least=12.0),
        *scaling(folder, sizes),
    ]


if __name__ == "__main__":
    clean_environment()
    with tempfile.TemporaryDirectory() as temporary:
        print(table(measure(Path(temporary), quick=False)))
