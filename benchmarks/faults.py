"""Every call that writes may fail, and the process may die at it: run ``python benchmarks/faults.py [--quick]``.

Each command of the program is run once undisturbed, and then again and again: at its first, second, ... write, rename,
exchange, fsync, mkdir, unlink, open or close the disk is full, or broken, or the process is killed, terminated or
interrupted. Afterwards every result must be the old one or the new one, to the last byte, and the next run must end as
if nothing had been. Then power is cut at every sync (``power_loss.py``).
"""

from __future__ import annotations

import argparse
import errno
import io
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path

from fault_process import FAIL, KILL, LIBRARY, Ended, Fault, compute_once, freeze, restart_with_shim, run_forked

FAULTS = (
    Fault("ENOSPC", FAIL, errno.ENOSPC),
    Fault("EIO", FAIL, errno.EIO),
    Fault("SIGKILL", KILL, signal.SIGKILL),
    Fault("SIGTERM", KILL, signal.SIGTERM),
    Fault("SIGINT", KILL, signal.SIGINT),
)
CODES = {FAIL: {0, 3, 6, 7}, signal.SIGTERM: {0, 3, 6, 7, 143}, signal.SIGINT: {0, 3, 6, 7, 130}, signal.SIGKILL: {-9}}
TABLES = ("summary.csv", "failures.csv", "cycles.csv", "repetitions.csv", "index.html")
TELLING = (3, 7)


@dataclass
class Tally:
    """How many points were tried, and what was wrong."""

    points: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)
    left: int = 0
    leaving: Counter[str] = field(default_factory=Counter)

    def add(self, name: str, place: str, faults: list[str]) -> None:
        self.points[name] += 1
        self.wrong += [f"{name}, {place}: {fault}" for fault in faults]


def disturb(name: str, scratch: Path, tally: Tally, *, step: int, exchange: bool = True) -> None:
    """Disturb one scenario at every `step`-th call."""
    from fault_scenarios import SCENARIOS, Scenario, Tree, part_of, temporaries_of, tree_of

    scenario: Scenario = next(one for one in SCENARIOS if one.name == name)
    before, work = scratch / "before", scratch / "work"
    for folder in (before, work):
        shutil.rmtree(folder, ignore_errors=True)
    before.mkdir(parents=True)
    scenario.prepare(before)
    old = tree_of(before)

    def begin() -> None:
        shutil.rmtree(work, ignore_errors=True)
        shutil.copytree(before, work)

    def run(fault: Fault | None = None, call: int = -1) -> Ended:
        return run_forked(scenario.arguments, work, fault, call, exchange=exchange)

    warm_up(scenario.arguments, before, work)
    begin()
    freeze()
    undisturbed = run()
    new = tree_of(work)
    assert undisturbed.code == 0, undisturbed.said
    assert new != old
    check_sums(work)

    def faults_of(tree: Tree, fault: Fault, ended: Ended) -> list[str]:
        found = []
        dead = fault.number == signal.SIGKILL and fault.action == KILL
        for part in scenario.parts:
            now, was, will = (part_of(one, part) for one in (tree, old, new))
            known = now in (was, will) or (not now and part[0] in scenario.passing)
            pending = dead and len(part) > 1 and (now.items() <= was.items() or now.items() <= will.items())
            moving = dead and not exchange and not now  # between two renames; the next run puts it back
            if fault.action == FAIL and ended.code in TELLING and Path(part[0]).name in TABLES:
                continue  # they tell of a trial that could not be read or written
            if not known and not pending and not moving:
                found.append(f"{part[0]} is neither the old one nor the new one")
            if ended.code == 0 and now != will:
                found.append(f"{part[0]} is not the new one though the command said so")
        around = {path for one in (tree, old) for path in one} - {
            path for part in scenario.parts for one in (tree, old) for path in part_of(one, part)
        }
        found += [f"{path} was touched" for path in around if tree.get(path) != old.get(path)]
        expected = CODES[FAIL] if fault.action == FAIL else CODES[signal.Signals(fault.number)]
        if ended.code not in expected or "Traceback" in ended.said:
            found.append(f"ended with {ended.code}: {ended.said[-300:]}")
        return found

    for fault in FAULTS:
        for call in range(1, undisturbed.calls + 1, step):
            begin()
            ended = run(fault, call)
            tree = tree_of(work)
            found = faults_of(tree, fault, ended)
            if temporaries_of(work) and ended.code >= 0:
                tally.left += 1
                tally.leaving[f"{fault.name} {name}"] += 1
            again = run()
            final = tree_of(work)
            done = all(part_of(tree, part) == part_of(new, part) for part in scenario.parts)
            if again.code != 0 and not (done and again.code == 6):
                found.append(f"the next run ended with {again.code}: {again.said[-300:]}")
            if final != new:
                found.append(f"after the next run {sorted(set(final.items()) ^ set(new.items()))[:2]} differ")
            if temporaries_of(work):
                found.append(f"after the next run there are {temporaries_of(work)}")
            tally.add(name if exchange else f"{name}, no exchange", f"{fault.name} at call {call}", found)


def warm_up(arguments: tuple[str, ...], before: Path, work: Path) -> None:
    """Run a command in this very process, so that what it computes is at hand in the forks."""
    from elbowscrew.cli import main

    shutil.copytree(before, work, dirs_exist_ok=True)
    here = Path.cwd()
    os.chdir(work)
    try:
        with redirect_stdout(io.StringIO()):
            main(list(arguments))
    finally:
        os.chdir(here)


def check_sums(folder: Path) -> None:
    """Have ``sha256sum`` check every result."""
    for sums in folder.rglob("SHA256SUMS"):
        subprocess.run(["sha256sum", "--check", "--quiet", sums.name], cwd=sums.parent, check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0] if __doc__ else "")
    parser.add_argument("--quick", action="store_true", help="a few points of most commands")
    parser.add_argument("--step", type=int, default=1, help="only every so many-th call")
    parser.add_argument("--python", action="store_true", help="disturb Python's functions, as without a C compiler")
    parser.add_argument("names", nargs="*", help="scenarios; all by default")
    given = parser.parse_args()
    if LIBRARY not in os.environ:
        compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
        return restart_with_shim(None if given.python else compiler)
    compute_once()
    from fault_scenarios import SCENARIOS, check_complete
    from power_loss import cut_power

    check_complete()
    tally, begun = Tally(), time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="elbowscrew-faults-") as scratch:
        for scenario in SCENARIOS:
            if (given.names and scenario.name not in given.names) or (given.quick and not scenario.quick):
                continue
            step = 97 if given.quick else given.step
            disturb(scenario.name, Path(scratch) / "faults", tally, step=step)
            if scenario.name in ("analyze --force", "compare --force", "simulate --force"):
                disturb(scenario.name, Path(scratch) / "faults", tally, step=step, exchange=False)
            cut_power(scenario.name, Path(scratch) / "power", tally, step=step, sync_step=7 if given.quick else 1)
            print(f"{time.perf_counter() - begun:7.1f} s  {dict(tally.points)}", flush=True)
            for line in tally.wrong[:20]:
                print("WRONG", line, flush=True)
    print(
        f"{sum(tally.points.values())} points, {len(tally.wrong)} wrong; {tally.left} left something for the next run"
    )
    print(dict(tally.leaving))
    return 1 if tally.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
