"""Text that may come from files: nothing of it may speak to the terminal."""

from elbowscrew.errors import shortened


class NobodyReads(Exception):  # noqa: N818 - no error: whoever read our output has read enough
    """Standard output was closed by its reader."""


def printable(text: str) -> str:
    """Put a question mark in place of every character that is not printable, control characters above all."""
    return "".join(character if character.isprintable() else "?" for character in text)


def one_line(text: str) -> str:
    """Fold white space, line ends included, to single blanks, make the rest printable, and cut it if it has no end."""
    return printable(shortened(" ".join(text.split())))
