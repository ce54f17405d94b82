"""Text that may come from files: nothing of it may speak to the terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from functools import partial
from typing import Any, TextIO

from elbowscrew.errors import OutputError, shortened


class _Guarded:
    """A standard stream, be it a library that writes to it; once it takes nothing, all goes nowhere."""

    def __init__(self, stream: TextIO, broken: Callable[[OSError], None]) -> None:
        self._stream = stream
        self._broken = broken
        self._error: OSError | None = None

    def write(self, text: str) -> int:
        if text != "":  # libraries find out in this way what a stream takes; a full disk may refuse even that
            self._try(partial(self._stream.write, text))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        self.write("".join(lines))

    def flush(self) -> None:
        self._try(self._stream.flush)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def _try(self, write: Callable[[], object]) -> None:
        if self._error is None:
            try:
                write()
            except OSError as error:
                self._error = error
                _forget(self._stream)
        if self._error is not None:
            self._broken(self._error)


@contextmanager
def guarded_streams() -> Iterator[None]:
    """Let errors of standard output be told as such, and those of standard error stop no work, as long as it lasts.

    A reader that has read enough is no error, and nothing more is written for him; what cannot be written to standard
    output raises `OutputError` where it is written.
    """
    out: Any = _Guarded(sys.stdout, _output_broken)
    error: Any = _Guarded(sys.stderr, lambda _error: None)
    with redirect_stdout(out), redirect_stderr(error):
        yield


def _output_broken(error: OSError) -> None:
    if not isinstance(error, BrokenPipeError):
        msg = f"standard output cannot be written: {error.strerror or error}"
        raise OutputError(msg) from error


def tell(text: str) -> None:
    """Write a line to standard error."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def emit(text: str) -> None:
    """Write to standard output."""
    sys.stdout.write(text)
    sys.stdout.flush()


def _forget(stream: TextIO) -> None:
    """Let what is still written to a stream, by the interpreter's own last flush too, go nowhere."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def printable(text: str) -> str:
    """Put a question mark in place of every character that is not printable, control characters above all."""
    return "".join(character if character.isprintable() else "?" for character in text)


def one_line(text: str) -> str:
    """Fold white space, line ends included, to single blanks, make the rest printable, and cut it if it has no end."""
    return printable(shortened(" ".join(text.split())))


def two_decimals(value: float | None) -> str:
    """Write a number with two decimals; a dash where it is not known."""
    return "–" if value is None else f"{value:z.2f}"


def vector_text(values: Iterable[float], decimals: int) -> str:
    """Write a vector's components."""
    return ", ".join(f"{value:z.{decimals}f}" for value in values)
