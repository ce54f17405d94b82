"""What other distributions bring along, by their entry points; nothing is looked for before it is needed."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, Final, TypeVar

from elbowscrew.errors import UsageError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

READERS: Final = "elbowscrew.readers"
"""The group of entry points, each of which names a reader of a format."""
LAWS: Final = "elbowscrew.laws"
"""That of laws of motion: the name of the entry point is the name of the law."""

EXPORTERS: Final = "elbowscrew.exporters"
"""That of functions that write a trial for other programs: the name of the entry point is that of the export."""

Kind = TypeVar("Kind")


@cache
def names(group: str) -> tuple[str, ...]:
    """Give the names in a group, without loading anything."""
    return tuple(sorted(_points(group)))


@cache
def _points(group: str) -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points

    return {one.name: one for one in entry_points(group=group)}


def loaded(group: str, name: str, kind: type[Kind]) -> Kind:
    """Load what an entry point names.

    Raises
    ------
    UsageError
        If it cannot be loaded, or is not of the kind.
    """
    point = _points(group)[name]
    try:
        found: Any = point.load()
    except Exception as error:  # whatever a module may do when it is imported
        msg = f"{told(group, name)} cannot be loaded: {brief(error)}; mend or uninstall it"
        raise UsageError(msg) from error
    if not isinstance(found, kind):
        msg = f"{told(group, name)}: expected a {kind.__name__}, found {type(found).__name__}; mend or uninstall it"
        raise UsageError(msg)
    return found


def told(group: str, name: str) -> str:
    """Say whose an entry point is."""
    point = _points(group)[name]
    owner = "an unknown distribution" if point.dist is None else f"the distribution {point.dist.name!r}"
    return f"the {group.rpartition('.')[2].removesuffix('s')} {name!r} of {owner} ({point.value})"


def brief(error: BaseException) -> str:
    """Give an error of somebody else's in a line."""
    return " ".join(f"{type(error).__name__} {error}".split())


def forget() -> None:
    """Look anew, as after an installation."""
    names.cache_clear()
    _points.cache_clear()
