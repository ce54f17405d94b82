"""How long the command takes to start, beside what it stands on: ``python benchmarks/start_up.py``."""

from __future__ import annotations

import sys

from rows import SCRIPT, Row, clean_environment, run, share, table

BARE, TYPER = "python -c pass", "python -c 'import typer'"
# The script that pip 23 puts in place imports re; those that newer ones write do not.
LEAN_SCRIPT = "import sys; from elbowscrew.cli import command; sys.exit(command())"


def beside(what: str, command: tuple[object, ...], yardstick: str, code: str, rounds: int, wanted: float | None) -> Row:
    """Run a command and a line of Python in turns."""
    times: dict[str, list[float]] = {"ours": [], yardstick: []}
    for _ in range(rounds):
        times["ours"].append(run(*command).seconds)
        times[yardstick].append(run(sys.executable, "-c", code).seconds)
    return share(what, times, yardstick, wanted)


def measure(*, quick: bool) -> list[Row]:
    """Measure help and version."""
    rounds = 10 if quick else 40
    lean = (sys.executable, "-c", LEAN_SCRIPT, "--version")
    return [
        beside("--help", (SCRIPT, "--help"), TYPER, "import typer", rounds, 2.5),
        beside("--version", (SCRIPT, "--version"), BARE, "pass", rounds, 1.5),
        beside("--version, by a script that does not import re", lean, BARE, "pass", rounds, 1.5),
        beside("`import re` alone", (sys.executable, "-c", "import re"), BARE, "pass", rounds, None),
    ]


if __name__ == "__main__":
    clean_environment()
    print(table(measure(quick=False)))
