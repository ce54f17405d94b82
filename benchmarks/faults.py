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
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from fault_process import (
    CLOSED_ABOVE,
    FAIL,
    KILL,
    KILL_ON,
    LIBRARY,
    MOUNTED,
    NO_EXCHANGE,
    Ended,
    Fault,
    compute_once,
    freeze,
    restart_with_shim,
    run_forked,
)

if TYPE_CHECKING:
    from fault_scenarios import Scenario, Tree

FAULTS = (
    Fault("ENOSPC", FAIL, errno.ENOSPC),
    Fault("EIO", FAIL, errno.EIO),
    Fault("SIGKILL", KILL, signal.SIGKILL),
    Fault("SIGTERM", KILL, signal.SIGTERM),
    Fault("SIGINT", KILL, signal.SIGINT),
    Fault("SIGINT again and again", KILL_ON, signal.SIGINT),
)
CODES = {FAIL: {0, 3, 6, 7}, signal.SIGTERM: {0, 3, 6, 7, 143}, signal.SIGINT: {0, 3, 6, 7, 130}, signal.SIGKILL: {-9}}
OVER_TRIALS = ("summary.csv", "failures.csv", "cycles.csv", "repetitions.csv", "index.html", "in_compare")
"""What tells of a trial that could not be read or written, and is made of the others."""
TELLING = (3, 7)
_QUICK_STEP = 194
_UNTOUCHED = re.compile(r"^elbowscrew: error: (.*): cannot be written: .*; nothing was left behind$", re.MULTILINE)
DISKS = {NO_EXCHANGE: "no exchange", CLOSED_ABOVE: "closed above", MOUNTED: "mounted"}


@dataclass
class Tally:
    """How many points were tried, and what was wrong.

    With a file, what is found is written there line by line, and points of an earlier run that it holds are known.
    """

    points: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)
    left: Counter[str] = field(default_factory=Counter)
    book: Path | None = None
    until: float = math.inf
    known: set[tuple[str, str]] = field(default_factory=set)

    def __post_init__(self) -> None:
        if self.book is not None and self.book.exists():
            for line in self.book.read_text(encoding="utf-8").splitlines():
                name, place, *faults = json.loads(line)
                self._count(name, place, faults)

    def is_known(self, name: str, place: str) -> bool:
        return (name, place) in self.known

    def add(self, name: str, place: str, faults: list[str]) -> None:
        self._count(name, place, faults)
        for fault in faults:
            print(f"WRONG {name}, {place}: {fault}", flush=True)
        if self.book is not None:
            with self.book.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps([name, place, *faults]) + "\n")
        if time.monotonic() > self.until:
            raise OutOfTime

    def _count(self, name: str, place: str, faults: list[str]) -> None:
        self.known.add((name, place))
        self.points[name] += 1
        self.wrong += [f"{name}, {place}: {fault}" for fault in faults]


class OutOfTime(Exception):  # noqa: N818 - no error
    """The minutes that were given are over."""


class Bench:
    """One scenario: the state before it, the one after it, and what runs of it leave behind.

    The program is the same in every run, and tells no time: what the next run makes of a state of the disk is found out
    once for each such state, to the last byte and with everything temporary in it.
    """

    def __init__(self, name: str, scratch: Path, cannot: int = 0) -> None:
        from fault_scenarios import SCENARIOS, tree_of
        from power_loss import steps_in

        self.scenario: Scenario = next(one for one in SCENARIOS if one.name == name)
        self.cannot = cannot
        self.name = name if not cannot else f"{name}, {DISKS[cannot]}"
        self.before, self.work = scratch / "before", scratch / "work"
        shutil.rmtree(scratch, ignore_errors=True)
        self.before.mkdir(parents=True)
        self.scenario.prepare(self.before)
        warm_up(self.scenario.arguments, self.before, self.work)
        self.begin()
        freeze()
        journal = scratch / "journal"
        self.undisturbed = self.run(journal=journal)
        assert self.undisturbed.code == 0, self.undisturbed.said
        self.steps = steps_in(journal)
        """Calls at which there is something to undo, or to recover."""
        self.old, self.new = tree_of(self.before), tree_of(self.work)
        assert self.new != self.old
        assert sums_hold(self.work)
        self._ends: dict[object, list[str]] = {}

    def begin(self) -> None:
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.before, self.work)

    def run(self, fault: Fault | None = None, call: int = -1, journal: Path | None = None) -> Ended:
        return run_forked(self.scenario.arguments, self.work, fault, call, cannot=self.cannot, journal=journal)

    def faults_of_next_run(self, tree: Tree) -> list[str]:
        """Run once more, undisturbed, and say what is not as if nothing had been."""
        from fault_scenarios import part_of, state_of, temporaries_of, tree_of

        state = state_of(self.work)
        if state not in self._ends:
            again = self.run()
            final, found = tree_of(self.work), []
            done = all(part_of(tree, part) == part_of(self.new, part) for part in self.scenario.parts)
            if again.code != 0 and not (done and again.code == 6):
                found.append(f"the next run ended with {again.code}: {again.said[-2000:]}")
            if final != self.new:
                differing = sorted(set(final.items()) ^ set(self.new.items()))
                found.append(f"after the next run {differing[:2]} differ")
            if temporaries_of(self.work):
                found.append(f"after the next run there are {temporaries_of(self.work)}")
            self._ends[state] = found
        return self._ends[state]


def disturb(bench: Bench, tally: Tally, *, step: int) -> None:
    """Disturb one scenario at every `step`-th call, each fault at calls of its own where steps are long."""
    from fault_scenarios import UNSETTLED, part_of, temporaries_of, tree_of

    scenario, old, new = bench.scenario, bench.old, bench.new
    moves = bench.cannot & (CLOSED_ABOVE | MOUNTED)  # all that is in a folder that stays, by several renames

    def faults_of(tree: Tree, fault: Fault, ended: Ended) -> list[str]:
        found = []
        dead = fault.number == signal.SIGKILL and fault.action == KILL
        for part in scenario.parts:
            now, was, will = (part_of(one, part) for one in (tree, old, new))
            known = now in (was, will) or (not now and part[0] in scenario.passing)
            several = len(part) > 1 or moves
            pending = dead and several and (now.items() <= was.items() or now.items() <= will.items())
            moving = dead and bench.cannot & NO_EXCHANGE and not now  # the next run puts it back
            if is_told(part, fault, ended):
                if not sums_hold(bench.work / part[0]):
                    found.append(f"{part[0]} has other digests than those told")
                continue
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
            found.append(f"ended with {ended.code}: {ended.said[-2000:]}")
        return found

    def told_wrong(tree: Tree, ended: Ended) -> list[str]:
        """Say what is not as it was although the command failed, or said that nothing was left behind."""
        told = [Path(path).as_posix() for path in _UNTOUCHED.findall(ended.said)]
        parts = [part for part in scenario.parts if any(part_of(dict.fromkeys(told, ""), (one,)) for one in part)]
        alone = len(scenario.parts) == 1
        if alone and ended.code not in (0, *TELLING) and UNSETTLED not in ended.said:
            parts = [*scenario.parts]
        found = [
            f"{part[0]} is not as it was"
            for part in parts
            if part_of(tree, part) not in ({} if part[0] in scenario.passing else None, part_of(old, part))
        ]
        if told and alone and temporaries_of(bench.work):
            found.append("something was left behind")
        return [f"{one} though the command failed" for one in found]

    for fault, call in points_of(bench, step):
        place = f"{fault.name} at call {call}"
        if tally.is_known(bench.name, place):
            continue
        bench.begin()
        ended = bench.run(fault, call)
        tree = tree_of(bench.work)
        found = faults_of(tree, fault, ended)
        if fault.action == FAIL:
            found += told_wrong(tree, ended)
        if temporaries_of(bench.work) and ended.code >= 0:
            tally.left[f"{fault.name} {bench.name}"] += 1
        tally.add(bench.name, place, found + bench.faults_of_next_run(tree))


def is_told(part: tuple[str, ...], fault: Fault, ended: Ended) -> bool:
    """Whether a part need not be the old or the new one, as it tells of a trial that could not be read or written."""
    return fault.action == FAIL and ended.code in TELLING and Path(part[0]).name in OVER_TRIALS


def points_of(bench: Bench, step: int) -> Iterator[tuple[Fault, int]]:
    """Yield every `step`-th call for each fault; of those left out, some at which there is something to undo."""
    calls, steps = bench.undisturbed.calls, bench.steps
    for k, fault in enumerate(FAULTS):
        first = k * min(step, calls) // len(FAULTS)
        yield from ((fault, call) for call in range(1 + first, calls + 1, step))
    if step > 1 and bench.scenario.disks:
        yield from ((fault, call) for fault in FAULTS if fault.name in ("EIO", "SIGKILL") for call in steps)


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


def sums_hold(folder: Path) -> bool:
    """Have ``sha256sum`` check every result."""
    check = ["sha256sum", "--check", "--quiet"]
    return all(
        subprocess.run([*check, sums.name], cwd=sums.parent, check=False).returncode == 0
        for sums in folder.rglob("SHA256SUMS")
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0] if __doc__ else "")
    parser.add_argument("--quick", action="store_true", help="a few points of most commands")
    parser.add_argument("--step", type=int, default=1, help="only every so many-th call")
    parser.add_argument("--python", action="store_true", help="disturb Python's functions, as without a C compiler")
    parser.add_argument("--book", type=Path, help="file of the points tried; what an earlier run has tried is left out")
    parser.add_argument("--minutes", type=float, default=math.inf, help="stop then; the book tells where")
    parser.add_argument("names", nargs="*", help="scenarios; all by default")
    given = parser.parse_args()
    if LIBRARY not in os.environ:
        compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
        return restart_with_shim(None if given.python else compiler)
    begun = time.monotonic()
    tally = Tally(book=given.book, until=begun + 60 * given.minutes)
    compute_once()
    from fault_scenarios import check_complete

    check_complete()
    try:
        with tempfile.TemporaryDirectory(prefix="elbowscrew-faults-") as scratch:
            run_all(given, tally, Path(scratch))
    except OutOfTime:
        print("not all: the minutes are over")
        return 2
    print(
        f"{sum(tally.points.values())} points, {len(tally.wrong)} wrong;"
        f" {sum(tally.left.values())} left something for the next run"
    )
    print(dict(tally.left))
    return 1 if tally.wrong else 0


def run_all(given: argparse.Namespace, tally: Tally, scratch: Path) -> None:
    """Try the scenarios that were asked for."""
    from fault_scenarios import SCENARIOS
    from power_loss import cut_power

    begun = time.monotonic()
    for scenario in SCENARIOS:
        if (given.names and scenario.name not in given.names) or (given.quick and not scenario.quick):
            continue
        step = _QUICK_STEP if given.quick else given.step
        bench = Bench(scenario.name, scratch / "faults")
        disturb(bench, tally, step=step)
        cut_power(bench, scratch / "power", tally, step=step, sync_step=7 if given.quick else 1)
        for cannot in scenario.disks if not given.python else scenario.disks & {NO_EXCHANGE}:
            disturb(Bench(scenario.name, scratch / "faults", cannot), tally, step=step)
        print(f"{time.monotonic() - begun:7.1f} s  {dict(tally.points)}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
