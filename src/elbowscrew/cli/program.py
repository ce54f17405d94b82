"""Start of the program: one place where every error becomes one line and an exit code."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

from elbowscrew.cli.text import emit, guarded_streams, one_line, tell
from elbowscrew.errors import ElbowscrewError, OutputError, UsageError, asked_back

INTERRUPTED = 130


class Terminated(BaseException):
    """A signal asked the program to end."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def run_program(given: list[str]) -> int:
    """Run the command line and return the exit code; a defect of the program raises."""
    _mend_streams()
    with guarded_streams(), _ended_by_signals():
        return _ended(given)


def _ended(given: list[str]) -> int:
    try:
        code = _run(given)
        emit("")
    except ElbowscrewError as error:
        return _report(str(error), error.exit_code)
    except KeyboardInterrupt:
        return _report("interrupted; nothing was left half-written", INTERRUPTED)
    except Terminated as signal:
        return _report("terminated; nothing was left half-written", 128 + signal.number)
    except MemoryError:
        return _report("not enough memory; take fewer frames, or export fewer columns", OutputError.exit_code)
    except OSError as error:
        place = f"{error.filename}: " if error.filename is not None else ""
        return _report(f"{place}{error.strerror or error}", OutputError.exit_code)
    return code


def _run(given: list[str]) -> int:
    from typer.exceptions import TyperException

    from elbowscrew.cli.app import run

    try:
        code = run(given or ["--help"])
    except TyperException as error:
        return _report_usage(error)
    if code == INTERRUPTED:
        raise KeyboardInterrupt
    if not given:
        return UsageError.exit_code
    return code if isinstance(code, int) else 0


def _report(message: str, code: int) -> int:
    tell(f"elbowscrew: error: {one_line(message)}")
    return code


def _report_usage(error: Exception) -> int:
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "elbowscrew"
    message = _usage_message(error).replace("Value error, ", "").rstrip(".")
    _report(f"{message}{'' if message.endswith('?') else '.'} See `{path} --help`", UsageError.exit_code)
    return int(getattr(error, "exit_code", UsageError.exit_code))


def _usage_message(error: Exception) -> str:
    """Give the parser's message, with what may have been meant in place of a name or a choice that is none."""
    option = getattr(error, "option_name", None)
    if option is not None and hasattr(error, "possibilities"):
        return f"No such option: {option}{asked_back(option, error.possibilities or ())}"
    message = str(error.format_message()) if hasattr(error, "format_message") else str(error)
    value, is_none, choices = message.partition("' is not one of ")
    if not is_none:
        return message
    given = value.rpartition(": '")[2]
    return message.rstrip(".") + asked_back(given, re.findall(r"'([^']+)'", choices))


def _mend_streams() -> None:
    """Give the program streams to write to even where there are none, or none that know all characters."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Let the first signal that ends the program unwind the stack, so that temporary files go, and others not cut that.

    Signals that are ignored stay so: a closed terminal does not end what was started by ``nohup``.
    """
    import signal

    before: dict[int, Any] = {}

    def stop(number: int, _frame: FrameType | None) -> None:
        for one in before:
            signal.signal(one, signal.SIG_IGN)
        raise KeyboardInterrupt if number == signal.SIGINT else Terminated(number)

    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)  # not all systems have all
        if number is not None and signal.getsignal(number) not in (None, signal.SIG_IGN):
            with suppress(ValueError):  # only the main thread hears them
                before[number] = signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
