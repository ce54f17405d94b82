"""The command line: parse, call one function, render. Only this package knows typer and rich."""

from __future__ import annotations

import sys

from elbowscrew._version import __version__

TYPE_CHECKING = False  # typing itself would double the time of `elbowscrew --version`
if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["command", "main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; a defect of the program raises."""
    from elbowscrew.cli.program import run_program

    return run_program(list(sys.argv[1:] if arguments is None else arguments))


def command() -> int:
    """Run the command line as a process of its own; see `main`."""
    if sys.argv[1:] == ["--version"] and _version_told():
        return 0
    _fill_closed_streams()
    from elbowscrew._search_path import leave_out_current_folder

    leave_out_current_folder()  # before anything else is imported

    import gc

    from elbowscrew._process import set_up_process

    set_up_process()
    code = main()
    gc.freeze()  # all of it ends with the process: a last search for garbage takes a tenth of a second
    return code


def _fill_closed_streams() -> None:
    """Let the first three descriptors lead to nowhere where they are closed, here and in processes that are started.

    Else the next files or pipes to be opened get their numbers, and a worker is given others in their place.
    """
    import os

    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # it gets the lowest number that is free


def _version_told() -> bool:
    """Tell the version before anything else is loaded; if there is nowhere to tell it, `main` knows what to say."""
    import os

    try:
        os.write(sys.stdout.fileno(), f"elbowscrew {__version__}\n".encode())  # past a buffer that would keep it
    except (AttributeError, OSError):
        return False
    return True
