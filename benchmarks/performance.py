"""All that is measured of the speed, beside what a user would take instead: ``python benchmarks/performance.py``.

Half an hour on two cores, on a machine that does nothing else: times are taken in alternation with their yardsticks, so
that the ratios hold where the times do not. Parts can be asked for by name; ``--quick`` takes five minutes, by fewer
rounds and trials, and shorter series of the kernels and tables.
``--json FILE`` keeps the numbers, ``--docs FILE`` writes the page. ``--from FILE`` takes the numbers of an earlier run,
but those of the parts that are asked for by name.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import tempfile
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import batch
import kernels
import keyframes
import pages
import start_up
import tables
import trial
from rows import Row, as_json, clean_environment, from_json, table

LIBRARIES = ("numpy", "scipy", "pandas", "polars", "matplotlib", "pytransform3d", "orjson", "typer")

Part = tuple[str, str, Callable[[Path, bool], list[Row]]]

PARTS: dict[str, Part] = {
    "kernels": (
        "Kernels of the geometry",
        "pytransform3d is given the same dual quaternions, scipy's RigidTransform its own transforms where it has the "
        "operation (native), else dual quaternions in and out. DIB runs to 1e-12. That the results are those of the "
        "plain formulas is tested (`tests/geometry`).",
        lambda folder, quick: kernels.measure(quick=quick),
    ),
    "tables": (
        "Reading and writing",
        "Ours reads with the SHA-256 of the file, checks every line's cells, and builds unit dual quaternions; the "
        "yardsticks give bare numbers. Ours and polars write digits that read back as the same number; so does pandas.",
        lambda folder, quick: tables.measure(folder, quick=quick),
    ),
    "trial": (
        "One trial, as a process from start to end",
        "The yardsticks are `benchmarks/yardsticks/read_and_draw.py`, which computes nothing, and `pandas_script.py`, "
        "which makes the same tables and the same five figures with pandas, scipy and pyplot. Neither checks the "
        "recording, knows errors, fits the joint's axis, or writes a page.",
        lambda folder, quick: trial.measure(folder, quick=quick),
    ),
    "start-up": (
        "Start-up",
        "The command is as pip installs it.",
        lambda folder, quick: start_up.measure(quick=quick),
    ),
    "batch": (
        "Studies",
        "Synthetic trials of 450 frames, all figures and pages, local processes. With figures a study is bound by "
        "matplotlib, without them by the analysis of each trial.",
        lambda folder, quick: batch.measure(folder, 40 if quick else 200),
    ),
    "selection": (
        "Fewest keyframes, and models compared",
        "The best of several runs.",
        lambda folder, quick: keyframes.measure(quick=quick),
    ),
    "pages": (
        "Pages",
        "Loaded to the end of the load event, where playwright and Chromium are there.",
        lambda folder, quick: pages.measure(folder / "pages"),
    ),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all by default")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--docs", type=Path)
    parser.add_argument("--from", dest="earlier", type=Path)
    given = parser.parse_args()
    unknown = set(given.parts) - set(PARTS)
    if unknown:
        parser.error(f"unknown part {', '.join(sorted(unknown))}")
    clean_environment()
    results = {"machine": machine(), "parts": {}}
    if given.earlier is not None:
        results = json.loads(given.earlier.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        for name in given.parts or (PARTS if given.earlier is None else ()):
            results["parts"][name] = measured(name, Path(folder), quick=given.quick)
            if given.json is not None:
                given.json.write_text(json.dumps(results, indent=1), encoding="utf-8")
    if given.docs is not None:
        given.docs.write_text(page(results), encoding="utf-8")


def measured(name: str, folder: Path, *, quick: bool) -> list[dict[str, Any]]:
    title, _, measure = PARTS[name]
    print(f"## {title}\n", flush=True)
    rows = measure(folder, quick)
    print(table(rows), flush=True)
    return as_json(rows)


def machine() -> dict[str, Any]:
    """What the numbers were measured with."""
    return {
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "system": platform.system(),
        "python": platform.python_version(),
        "elbowscrew": version("elbowscrew"),
        "libraries": {name: version(name) for name in LIBRARIES},
    }


def page(results: dict[str, Any]) -> str:
    """Write the page of the documentation."""
    about = results["machine"]
    libraries = ", ".join(f"{name} {number}" for name, number in about["libraries"].items())
    rows = [
        Row(**{key: value for key, value in row.items() if key != "met"})
        for part in results["parts"].values()
        for row in part
    ]
    pace = next((row.value / trial.PACE_S for row in rows if row.what == trial.PACE), None)
    missed = [row for row in rows if row.met is False]
    late = [row for row in missed if pace is not None and row.unit in ("s", "ms", "us")]
    wanted = [row for row in rows if row.met is not None]
    parts = [
        INTRODUCTION.format(
            elbowscrew=about["elbowscrew"],
            cores=about["cores"],
            load=about["load"],
            system=about["system"],
            python=about["python"],
            libraries=libraries,
            reached=len(wanted) - len(missed),
            wanted=len(wanted),
            pace="" if pace is None else PACE.format(here=trial.PACE_S * pace, there=trial.PACE_S, times=pace),
        ),
        *(f"- {told_missed(row, pace if row in late else None)}\n" for row in missed),
        "\n",
    ]
    for name in PARTS:
        if name not in results["parts"]:
            continue
        found = results["parts"][name]
        title, text, _ = PARTS[name]
        parts.append(f"## {title}\n\n{text}\n\n{table(from_json(found))}\n")
    return "".join(parts).rstrip() + "\n"


def told_missed(row: Row, pace: float | None) -> str:
    """Tell a number that was missed; a time also as it would be on the machine for which it was wanted."""
    told = f"{row.what}: {row.cells()[1]}, wanted {row.sense} {row.wanted:g}"
    if pace is None or row.wanted is None:
        return told
    there = replace(row, value=row.value / pace, low=None, high=None)
    return f"{told}; {there.cells()[1]} there, which is {'reached' if there.met else 'missed'}"


PACE = """
Times were wanted of a machine on which the pandas script, with the same versions of its libraries, took {there:.2f} s.
In this run it took {here:.2f} s, {times:.2f} times as long. A time that was missed is also told divided by that
("there").
"""

INTRODUCTION = """# Performance

Made by `python benchmarks/performance.py --docs docs/explanation/performance.md`; do not edit. Everything is measured
beside what a user would take instead.

elbowscrew {elbowscrew}, {cores} cores, {system}, Python {python}, {libraries}.
When it began, {load:.1f} other processes ran in the mean of a minute; where that is much over 0, times are too long
and ratios rough.
Tasks take turns with their yardsticks; a ratio is that of the
medians, its range that of the rounds. Read the ratios: the times are those of one machine.
{pace}
Of {wanted} numbers that were wanted {reached} are reached. Missed:

"""


if __name__ == "__main__":
    main()
