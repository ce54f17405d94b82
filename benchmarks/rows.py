"""What the benchmarks share: tasks timed in alternation, and rows of a table with what was wanted of them."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

SCRIPT = Path(sys.executable).with_name("elbowscrew")


@dataclass(frozen=True, kw_only=True)
class Row:
    """One number, with its range over the rounds, what was wanted of it, and the times behind it."""

    what: str
    value: float
    unit: str
    low: float | None = None
    high: float | None = None
    wanted: float | None = None
    sense: Literal["at least", "at most"] = "at most"
    behind: str = ""

    @property
    def met(self) -> bool | None:
        """Whether it is as was wanted; None if nothing was."""
        if self.wanted is None:
            return None
        return self.value >= self.wanted if self.sense == "at least" else self.value <= self.wanted

    def cells(self) -> list[str]:
        """Texts of the table's columns."""
        spread = "" if self.low is None or self.high is None else f" ({_digits(self.low)} to {_digits(self.high)})"
        wanted = "" if self.wanted is None else f"{self.sense} {_digits(self.wanted)}"
        met = {None: "", True: "yes", False: "**no**"}[self.met]
        return [self.what, f"{_digits(self.value)} {self.unit}{spread}", wanted, met, self.behind]


HEADER = ("", "measured, median (range)", "wanted", "reached", "times behind it")


def table(rows: Sequence[Row]) -> str:
    """Give rows as a Markdown table."""
    lines = [HEADER, ("---",) * len(HEADER), *(row.cells() for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def as_json(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Give rows ready for JSON."""
    return [{**asdict(row), "met": row.met} for row in rows]


def from_json(rows: Sequence[Mapping[str, Any]]) -> list[Row]:
    """Give back what `as_json` was given."""
    return [Row(**{key: value for key, value in row.items() if key != "met"}) for row in rows]


Times = Mapping[str, Sequence[float]]


def alternate(tasks: Mapping[str, Callable[[], object]], rounds: int, *, warm: bool = True) -> dict[str, list[float]]:
    """Seconds of tasks that take turns, so that a busy moment meets all alike; the first turn may warm up."""
    times: dict[str, list[float]] = {name: [] for name in tasks}
    for turn in range(rounds + warm):
        for name, task in tasks.items():
            start = time.perf_counter()
            task()
            taken = time.perf_counter() - start
            if turn or not warm:
                times[name].append(taken)
    return times


def faster(what: str, times: Times, yardstick: str, wanted: float | None = None, *, per: int | None = None) -> Row:
    """How many times as fast as a yardstick the task called "ours" is."""
    ratios = [theirs / mine for mine, theirs in zip(times["ours"], times[yardstick], strict=True)]
    return Row(
        what=what,
        value=statistics.median(times[yardstick]) / statistics.median(times["ours"]),
        unit=f"x as fast as {yardstick}",
        low=min(ratios),
        high=max(ratios),
        wanted=wanted,
        sense="at least",
        behind=_behind(times, yardstick, per),
    )


def share(what: str, times: Times, yardstick: str, wanted: float | None = None, *, per: int | None = None) -> Row:
    """How many times as long as a yardstick the task called "ours" takes."""
    ratios = [mine / theirs for mine, theirs in zip(times["ours"], times[yardstick], strict=True)]
    return Row(
        what=what,
        value=statistics.median(times["ours"]) / statistics.median(times[yardstick]),
        unit=f"x the time of {yardstick}",
        low=min(ratios),
        high=max(ratios),
        wanted=wanted,
        behind=_behind(times, yardstick, per),
    )


def _behind(times: Times, yardstick: str, per: int | None) -> str:
    mine, theirs = (statistics.median(times[name]) for name in ("ours", yardstick))
    if per is not None:
        return f"{1e9 * mine / per:.1f} against {1e9 * theirs / per:.1f} ns a frame"
    return f"{_time(mine)} against {_time(theirs)}"


def _time(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def _digits(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


class Run(NamedTuple):
    """Seconds and bytes of memory at most of a process."""

    seconds: float
    memory: int


# A process counts as its own what the one that started it holds: so a small one starts and times it.
_TIMED = """
import os, sys, time
start = time.perf_counter()
process = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(process, 0)
print(time.perf_counter() - start, usage.ru_maxrss, os.waitstatus_to_exitcode(status), file=sys.stderr)
"""


def run(*command: object) -> Run:
    """Run a command to its end; it must succeed."""
    timed = [sys.executable, "-c", _TIMED, *(str(part) for part in command)]
    done = subprocess.run(timed, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True)
    seconds, memory, code = done.stderr.splitlines()[-1].split()
    if int(code):
        msg = f"{command[0]} ended with {code}: {done.stderr}"
        raise SystemExit(msg)
    return Run(float(seconds), int(memory) * (1 if sys.platform == "darwin" else 1024))


def clean_environment() -> None:
    """Start again without settings that slow NumPy's matrix products, or each start of Python, if there are any."""
    hindering = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE", "PYTHONDONTWRITEBYTECODE")
    if [name for name in hindering if os.environ.pop(name, None) is not None]:
        sys.stdout.flush()
        os.execv(sys.executable, [sys.executable, *sys.argv])  # noqa: S606
