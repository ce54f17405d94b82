"""Batch on a large study: run ``python benchmarks/batch.py`` (a few minutes), or one of its parts by name.

``speed``   200 trials with their figures: the sum of single-trial work in one process, then batch with 1 and 2 workers,
            and without figures. Memory of a worker may not grow with the number of trials.
``broken``  1,000 trials, one in twenty broken in ten ways: exit code 7, the good ones there, the bad ones named; the
            same bytes with 1 worker, 2 workers and two workers of a Dask cluster.
``kills``   kill -9 at 20 random moments of that study: the run after that gives the bytes of an undisturbed one.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "support"))

from rows import Row, clean_environment, table
from studies import WAYS, break_trial, command, contents

FAST = ("--figure-format", "none")
CHOSEN = list(WAYS)[:10]
LOOP = "joblib" if find_spec("joblib") else "process pool"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=["speed", "broken", "kills", []], default=[])
    parser.add_argument("--trials", type=int, help="trials of each part")
    parser.add_argument("--folder", type=Path, help="where to work; a temporary folder by default")
    given = parser.parse_args()
    clean_environment()
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary)
        for part in given.parts or ["speed", "broken", "kills"]:
            print(f"== {part}")
            {"speed": speed, "broken": broken, "kills": kills}[part](folder, given.trials)


def speed(folder: Path, trials: int | None) -> None:
    print(table(measure(folder, trials or 200)))


def measure(folder: Path, count: int) -> list[Row]:
    """Measure a study of so many trials with 1 and 2 workers, beside the same work in one process."""
    study(folder / "speed", count, frames=450)
    script = Path(__file__).with_name("batch_single.py")
    one_thread = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "agg"}
    command = [sys.executable, *map(str, (script, folder / "speed", folder / "single"))]
    told = subprocess.run(command, check=True, capture_output=True, text=True, env=one_thread).stdout
    alone = json.loads(told)
    found = {}
    for workers in (1, 2):
        for share_of in (4, 1):
            some = folder / f"speed{share_of}"
            shutil.rmtree(some, ignore_errors=True)
            some.mkdir()
            for path in sorted((folder / "speed").iterdir())[: count // share_of]:
                os.link(path, some / path.name)
            found[workers, share_of] = timed(some, folder / f"out{workers}", workers)
    bare = timed(folder / "speed", folder / "bare", 2, *FAST)
    loop = scripted(folder, count, 2)
    one, two = found[1, 1], found[2, 1]
    stages = alone["stages_ms"]
    told = " ms, ".join(f"{name} {stages[name]:.0f}" for name in ("read", "analyze", "write", "page"))
    return [
        Row(
            what=f"batch of {count} trials, 2 workers",
            value=one.elapsed / two.elapsed,
            unit="x as fast as 1 worker",
            wanted=1.85,
            sense="at least",
            behind=f"{two.elapsed:.1f} against {one.elapsed:.1f} s",
        ),
        Row(
            what=f"batch of {count} trials, 2 workers",
            value=two.elapsed / loop,
            unit=f"x the time of a {LOOP} loop over the pandas script, 2 workers",
            behind=f"{two.elapsed:.1f} against {loop:.1f} s",
        ),
        Row(
            what="a trial with 1 worker",
            value=one.elapsed / alone["seconds"],
            unit="x the time of the warm work in one process",
            wanted=1.1,
            behind=f"{1e3 * one.elapsed / count:.0f} against {1e3 * alone['seconds'] / count:.0f} ms",
        ),
        Row(
            what="a trial with 1 worker, processor time",
            value=one.processor / alone["processor"],
            unit="x that of the warm work in one process",
            wanted=1.1,
            behind=f"{1e3 * one.processor / count:.0f} against {1e3 * alone['processor'] / count:.0f} ms",
        ),
        Row(what="a trial, all outputs", value=1e3 * alone["seconds"] / count, unit="ms", wanted=400.0),
        Row(
            what="a trial without figures",
            value=stages["read"] + stages["analyze"] + stages["tables and page"],
            unit="ms",
            wanted=130.0,
            behind=f"{told} ms, the page read back from the disk",
        ),
        Row(
            what="analysis of 450 frames, with type and intervals",
            value=stages["analyze"],
            unit="ms",
            wanted=100.0,
        ),
        Row(what="the usual figures of a trial, PNG", value=stages["figures"], unit="ms", wanted=260.0),
        Row(
            what="memory of a worker, 1 worker",
            value=one.memory / 1e6,
            unit="MB at most",
            behind=f"{found[1, 4].memory / 1e6:.0f} MB with a quarter of the trials",
        ),
        Row(
            what="memory of the parent, 1 worker",
            value=one.parent / 1e6,
            unit="MB at most",
            behind=f"{found[1, 4].parent / 1e6:.0f} MB with a quarter of the trials",
        ),
        Row(
            what="batch without figures, 2 workers",
            value=count / bare.elapsed,
            unit="trials a second",
            behind="start-up and the study's page are in it",
        ),
    ]


def scripted(folder: Path, count: int, workers: int) -> float:
    """Seconds that the pandas script takes for the same trials, in a loop over as many processes."""
    loop = Path(__file__).with_name("yardsticks") / "pandas_batch.py"
    start = time.perf_counter()
    out = folder / "scripted"
    subprocess.run([sys.executable, loop, folder / "speed", out, str(workers)], check=True, stdout=subprocess.DEVNULL)
    elapsed = time.perf_counter() - start
    assert len(list(out.iterdir())) == count
    shutil.rmtree(out)
    return elapsed


class Timing(NamedTuple):
    elapsed: float
    processor: float
    memory: int
    parent: int


def broken(folder: Path, trials: int | None) -> None:
    count = trials or 1000
    bad = study(folder / "broken", count, frames=60, broken=0.05)
    ways = {"2 workers": ("--workers", 2), "1 worker": ("--workers", 1),
            "Dask, 2 workers": ("--workers", 2, "--scheduler", "local-cluster")}  # fmt: skip
    outputs = {}
    for name, options in ways.items():
        out = folder / name / "results"  # the page of a study is called as its folder is
        elapsed = run(folder / "broken", out, *options, *FAST, code=7)
        outputs[name] = contents(out)
        print(f"{name:16s} {elapsed:7.2f} s, {1000 * elapsed / count:.1f} ms a trial")
    first = outputs["2 workers"]
    assert all(other == first for other in outputs.values())
    failures = list(csv.DictReader(first["failures.csv"].decode().splitlines()))
    assert {row["path"]: row["error_class"] for row in failures} == bad
    good = list(csv.DictReader(first["summary.csv"].decode().splitlines()))
    assert len(good) == count - len(bad)
    for row in good:
        assert abs(float(row["theta_max_deg"]) - (80.0 + int(row["trial"][1:]) % 60)) < 2.0
    print(f"{len(good)} results, {len(bad)} failures named, every file the same in all three")


def kills(folder: Path, trials: int | None) -> None:
    count = trials or 1000
    if not (folder / "broken").exists():
        study(folder / "broken", count, frames=60, broken=0.05)
    undisturbed = folder / "undisturbed" / "results"
    elapsed = run(folder / "broken", undisturbed, "--workers", 2, *FAST, code=7)
    out = folder / "killed" / "results"
    chance = random.Random(2010)  # noqa: S311
    moments = sorted(chance.uniform(0.0, elapsed) for _ in range(20))
    done = []
    for before, moment in zip([0.0, *moments], moments, strict=False):
        arguments = command(folder / "broken", "-q", "-o", out, "--workers", 2, *FAST)
        process = subprocess.Popen(arguments, start_new_session=True)
        # What earlier runs have finished is there already: each run gets the start-up and the time to its own moment.
        time.sleep(chance.uniform(0.0, 0.8) + moment - before)
        process.send_signal(signal.SIGKILL)
        process.wait()
        done.append(len(list(out.glob("*/summary.json"))))
    last = run(folder / "broken", out, "--workers", 2, *FAST, code=7)
    assert contents(out) == contents(undisturbed)
    print(f"killed 20 times with {', '.join(map(str, done))} results there; the last run took {last:.2f} s: same bytes")


def study(folder: Path, count: int, *, frames: int, broken: float = 0.0) -> dict[str, str]:
    """Write a study, and say which trials are broken and what their errors are called."""
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    with ProcessPoolExecutor() as pool:
        list(pool.map(write_one, [folder] * count, range(count), [frames] * count, chunksize=10))
    bad = {}
    for k in range(round(broken * count)):
        path, way = folder / f"t{k * count // round(broken * count)}.csv", CHOSEN[k % len(CHOSEN)]
        break_trial(path, way)
        bad[path.name] = WAYS[way][1]
    return bad


def write_one(folder: Path, k: int, frames: int) -> None:
    from elbowscrew import save_simulation, simulate_trial

    trial = simulate_trial(frames=frames, inversion=frames // 2, top_deg=80.0 + k % 60, seed=k)
    save_simulation(trial, folder / f"t{k}.csv")[1].unlink()


def run(data: Path, out: Path, *options: object, code: int) -> float:
    shutil.rmtree(out, ignore_errors=True) if "killed" not in out.name else None
    start = time.perf_counter()
    done = subprocess.run(command(data, "-q", "-o", out, *options), check=False)
    assert done.returncode == code
    return time.perf_counter() - start


def timed(data: Path, out: Path, workers: int, *options: str) -> Timing:
    """Time of a batch, processor time of all its processes, and the most memory one of its workers took."""
    shutil.rmtree(out, ignore_errors=True)
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    process = subprocess.Popen(command(data, "-q", "-o", out, "--workers", workers, *options))
    most, parent = [0], [0]
    watcher = threading.Thread(target=watch, args=(process, most, parent))
    watcher.start()
    assert process.wait() == 0
    elapsed, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    watcher.join()
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Timing(elapsed, processor, max(most), max(parent))


def watch(process: subprocess.Popen[bytes], most: list[int], parent: list[int]) -> None:
    while process.poll() is None:
        parent.append(high_water(process.pid))
        most.append(max([0, *(high_water(pid) for pid in children(process.pid))]))
        time.sleep(0.2)


def children(pid: int) -> Sequence[int]:
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def high_water(pid: int) -> int:
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM")), 0)


if __name__ == "__main__":
    main()
