"""How long the command takes to start, beside what it stands on: ``python benchmarks/start_up.py``."""

from __future__ import annotations

import sys

from rows import SCRIPT, Row, alternate, clean_environment, run, share, table

BARE, TYPER = "python -c pass", "python -c 'import typer'"


def measure(*, quick: bool) -> list[Row]:
    """Measure help and version."""
    rounds = 10 if quick else 40
    start = alternate(
        {
            "ours": lambda: run(SCRIPT, "--help"),
            TYPER: lambda: run(sys.executable, "-c", "import typer"),
        },
        rounds,
    )
    version = alternate(
        {
            "ours": lambda: run(SCRIPT, "--version"),
            BARE: lambda: run(sys.executable, "-c", "pass"),
        },
        rounds,
    )
    return [share("--help", start, TYPER, 2.5), share("--version", version, BARE, 1.5)]


if __name__ == "__main__":
    clean_environment()
    print(table(measure(quick=False)))
