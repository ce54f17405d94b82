"""What the shell offers for a word that is begun: names of bodies in the file at hand, and choices of a list."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import typer


def bodies(context: typer.Context, incomplete: str) -> list[str]:
    """Offer the bodies of the recording that stands on the command line already; none if it cannot be read."""
    names: dict[str, None] = {}
    # An option that waits for its value keeps the parser from telling which words are arguments.
    words = [word for word in context.args if not word.startswith("-")]
    for word in (words or [str(context.params.get("trial"))])[:1]:
        with suppress(Exception):  # a shell has no place for what is wrong with the file
            from elbowscrew.reading.registry import read_recording

            names |= dict.fromkeys(body.name for body in read_recording(Path(word)).bodies)
    return [_typed(name) for name in names if name.startswith(incomplete)]


def choices(names: Sequence[str]) -> Callable[[str], list[str]]:
    """Make what offers the last part of a list with commas."""

    def offered(incomplete: str) -> list[str]:
        before, comma, begun = incomplete.rpartition(",")
        return [f"{before}{comma}{name}" for name in names if name.startswith(begun) and name not in before.split(",")]

    return offered


def _typed(name: str) -> str:
    """Write a name as it is typed: bash takes what it is offered as it stands, other shells quote it themselves."""
    bash = os.environ.get("_ELBOWSCREW_COMPLETE") == "complete_bash"
    return "".join(f"\\{one}" if bash and not (one.isalnum() or one in "._-/:") else one for one in name)
