"""The command line: parse, call one function, render. Only this package knows typer and rich."""

from __future__ import annotations

import sys

from elbowscrew._version import __version__

TYPE_CHECKING = False  # typing itself would double the time of `elbowscrew --version`
if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; a defect of the program raises."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given == ["--version"]:  # told before anything else is loaded
        try:
            sys.stdout.write(f"elbowscrew {__version__}\n")
            sys.stdout.flush()
        except (AttributeError, OSError):
            pass  # nowhere to tell it: what becomes of that is the program's to say
        else:
            return 0
    from elbowscrew.cli.program import run_program

    return run_program(given)
