"""Text that may come from files: nothing of it may speak to the terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from typing import TextIO

from elbowscrew.errors import OutputError, shortened


def tell(text: str) -> None:
    """Write a line to standard error; that nobody takes it stops no work, and changes no exit code."""
    try:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
    except (OSError, ValueError):
        _forget(sys.stderr)


def emit(text: str) -> None:
    """Write to standard output; a reader that has read enough is no error, and nothing more is written for him.

    Raises
    ------
    OutputError
        If standard output cannot be written.
    """
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        forget_output()
    except OSError as error:
        forget_output()
        msg = f"standard output cannot be written: {error.strerror or error}"
        raise OutputError(msg) from error


def forget_output() -> None:
    """Let what is still written to standard output go nowhere."""
    _forget(sys.stdout)


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


def rounded(value: float | None) -> str:
    """Write a number with two decimals; a dash where it is not known."""
    return "–" if value is None else f"{value:z.2f}"


def vector_text(values: Iterable[float], decimals: int) -> str:
    """Write a vector's components."""
    return ", ".join(f"{value:z.{decimals}f}" for value in values)
