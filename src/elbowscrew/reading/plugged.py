"""Readers of other formats, from other distributions: found by their entry points, asked when none of ours fits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Final

from elbowscrew.errors import ElbowscrewError, RecordingError, UsageError
from elbowscrew.model import Recording, Source
from elbowscrew.opening import sha256_of
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import first_bytes

GROUP: Final = "elbowscrew.readers"
"""The group of entry points, each of which names a `Reader`."""
_HEAD_BYTES: Final = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class Reader:
    """A format that another distribution reads.

    Attributes
    ----------
    name : str
        As it is told of the recording (`Source.layout`).
    endings : tuple of str
        How the names of its files end, in lower case (``.xyz``), so that they are found in folders.
    recognizes : callable
        Told the first bytes of a file, 4096 at most: whether it is of this format.
    read : callable
        Told the path and `ReadOptions`; gives a `Recording`, in meters and seconds. What it raises for a file that
        cannot be read safely is `RecordingError`.
    accepts : frozenset of str
        The fields of `ReadOptions` that mean something for it, of "units", "rotation", "rate_hz" and "markers"; the
        others are refused.
    """

    name: str
    endings: tuple[str, ...]
    recognizes: Callable[[bytes], bool]
    read: Callable[[Path, ReadOptions], Recording]
    accepts: frozenset[str] = frozenset()


@cache
def readers() -> tuple[Reader, ...]:
    """Load the readers of all distributions that are installed, in the order of their names.

    Raises
    ------
    UsageError
        If one cannot be loaded, or is none.
    """
    return tuple(_loaded(one) for one in sorted(entry_points(group=GROUP), key=lambda one: one.name))


def _loaded(point: EntryPoint) -> Reader:
    owner = "an unknown distribution" if point.dist is None else f"the distribution {point.dist.name!r}"
    told = f"the reader {point.name!r} of {owner} ({point.value})"
    try:
        found: object = point.load()
    except Exception as error:  # whatever a module may do when it is imported
        msg = f"{told} cannot be loaded: {_brief(error)}; mend or uninstall it"
        raise UsageError(msg) from error
    if not isinstance(found, Reader):
        msg = f"{told}: expected an elbowscrew.Reader, found {type(found).__name__}; mend or uninstall it"
        raise UsageError(msg)
    return found


def reader_of(file: Path) -> Reader | None:
    """Give the reader that recognizes a file; None if none does, or the file cannot be opened."""
    head = first_bytes(file, _HEAD_BYTES)
    if not head:
        return None
    for reader in readers():
        try:
            fits = reader.recognizes(head)
        except Exception as error:
            raise _failed(file, reader, error) from error
        if fits:
            return reader
    return None


def read_by(reader: Reader, file: Path, options: ReadOptions) -> Recording:
    """Let a reader read a file, and note the file where the reader does not.

    Raises
    ------
    RecordingError
        If it raises any error that is not one of ours, or gives no recording.
    """
    try:
        found: object = reader.read(file, options)
    except ElbowscrewError:
        raise
    except Exception as error:
        raise _failed(file, reader, error) from error
    if not isinstance(found, Recording):
        msg = f"{file}: the reader {reader.name!r}: expected a Recording, found {type(found).__name__}"
        raise RecordingError(msg)
    if found.source is not None:
        return found
    return replace(found, source=Source(path=str(file), sha256=sha256_of(file), layout=reader.name))


def _failed(file: Path, reader: Reader, error: Exception) -> RecordingError:
    return RecordingError(f"{file}: the reader {reader.name!r}, a plug-in, failed: {_brief(error)}")


def _brief(error: Exception) -> str:
    return " ".join(f"{type(error).__name__} {error}".split())
