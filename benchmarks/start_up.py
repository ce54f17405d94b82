"""How long the command takes to start, beside what it stands on: run ``python benchmarks/start_up.py``.

The yardstick for ``--help`` is ``import typer`` (at most 2.5 times as long), for ``--version`` bare Python.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

ROUNDS = 20
COMMANDS = {
    "python -c pass": [sys.executable, "-c", "pass"],
    "import typer": [sys.executable, "-c", "import typer"],
    "elbowscrew --version": [sys.executable, "-m", "elbowscrew", "--version"],
    "elbowscrew --help": [sys.executable, "-m", "elbowscrew", "--help"],
}


def main() -> None:
    times: dict[str, list[float]] = {name: [] for name in COMMANDS}
    for _ in range(ROUNDS):  # in alternation, so that a busy moment meets all alike
        for name, command in COMMANDS.items():
            start = time.perf_counter()
            subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
            times[name].append(time.perf_counter() - start)
    medians = {name: statistics.median(values) for name, values in times.items()}
    for name, median in medians.items():
        print(f"{name:24s} {1000 * median:7.1f} ms")
    print(f"--help / import typer    {medians['elbowscrew --help'] / medians['import typer']:7.2f}")
    print(f"--version / bare Python  {medians['elbowscrew --version'] / medians['python -c pass']:7.2f}")


if __name__ == "__main__":
    main()
