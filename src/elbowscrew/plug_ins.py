"""What other distributions bring along, by their entry points; nothing is looked for before it is needed."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, Any, Final, TypeVar

from elbowscrew.errors import UsageError, shortened

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
def _points(group: str) -> dict[str, tuple[EntryPoint, ...]]:
    from importlib.metadata import entry_points

    found: dict[str, tuple[EntryPoint, ...]] = {}
    for one in entry_points(group=group):
        found[one.name] = (*found.get(one.name, ()), one)
    return found


def loaded(group: str, name: str, kind: type[Kind]) -> Kind:
    """Load what an entry point names.

    Raises
    ------
    UsageError
        If it cannot be loaded, or is not of the kind, or two distributions bring one of the name.
    """
    point, *others = _points(group)[name]
    if others:
        msg = f"{' and '.join(_told(group, one) for one in (point, *others))} have one name; uninstall all but one"
        raise UsageError(msg)
    try:
        found: Any = point.load()
    except (Exception, SystemExit) as error:  # whatever a module may do when it is imported
        msg = f"{told(group, name)} cannot be loaded: {brief(error)}; mend or uninstall it"
        raise UsageError(msg) from error
    if not isinstance(found, kind):
        msg = f"{told(group, name)}: expected a {kind.__name__}, found {type(found).__name__}; mend or uninstall it"
        raise UsageError(msg)
    return found


def told(group: str, name: str) -> str:
    """Say whose an entry point is."""
    return _told(group, _points(group)[name][0])


def _told(group: str, point: EntryPoint) -> str:
    owner = "an unknown distribution" if point.dist is None else f"the distribution {point.dist.name!r}"
    return f"the {group.rpartition('.')[2].removesuffix('s')} {point.name!r} of {owner} ({point.value})"


def versions(group: str, wanted: Iterable[str]) -> dict[str, str]:
    """Give the versions of the distributions that bring entry points of these names, as far as there are any."""
    dists = [point.dist for name in wanted for point in _points(group).get(name, ())]
    return {dist.name: dist.version for dist in dists if dist is not None}


def brief(error: BaseException) -> str:
    """Give an error of somebody else's in a line, as far as it can be shown."""
    try:
        said = str(error)
    except Exception:  # its own words may fail, too
        said = ""
    words = " ".join(f"{type(error).__name__} {said}".split())
    return shortened("".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in words))


def forget() -> None:
    """Look anew, as after an installation."""
    names.cache_clear()
    _points.cache_clear()
