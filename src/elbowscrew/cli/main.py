"""Start of the program: one place where every error becomes one line and an exit code."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from types import FrameType

from elbowscrew._version import __version__
from elbowscrew.cli.text import one_line
from elbowscrew.errors import ElbowscrewError, OutputError, RecordingError, UsageError

INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; a defect of the program raises."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given == ["--version"]:
        sys.stdout.write(f"elbowscrew {__version__}\n")
        return 0
    from typer.exceptions import TyperException

    from elbowscrew.cli.app import run

    _end_cleanly_when_terminated()
    try:
        code = run(given or ["--help"])
        sys.stdout.flush()
    except ElbowscrewError as error:
        return _report(str(error), error.exit_code)
    except TyperException as error:
        return _report_usage(error)
    except KeyboardInterrupt:
        return _report("interrupted; nothing was left half-written", INTERRUPTED)
    except BrokenPipeError:
        # Whoever read our output has read enough.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except MemoryError:
        return _report(
            "the recording does not fit into memory; export fewer frames or columns", RecordingError.exit_code
        )
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _report(f"standard output cannot be written: {error.strerror or error}", OutputError.exit_code)
    if code == INTERRUPTED:
        return _report("interrupted; nothing was left half-written", INTERRUPTED)
    if not given:
        return UsageError.exit_code
    return code if isinstance(code, int) else 0


def _report(message: str, code: int) -> int:
    sys.stderr.write(f"elbowscrew: error: {one_line(message)}\n")
    return code


def _report_usage(error: Exception) -> int:
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "elbowscrew"
    message = error.format_message() if hasattr(error, "format_message") else str(error)
    _report(f"{message.replace('Value error, ', '').rstrip('.')}. See `{path} --help`", UsageError.exit_code)
    return int(getattr(error, "exit_code", 2))


def _end_cleanly_when_terminated() -> None:
    """Let a SIGTERM unwind the stack, so that temporary files go."""
    import signal

    def stop(number: int, _frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    try:
        signal.signal(signal.SIGTERM, stop)
    except ValueError:  # not in the main thread
        return
