"""Readers of other formats, from other distributions: found by their entry points, asked when none of ours fits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Final

from elbowscrew import plug_ins
from elbowscrew.errors import ElbowscrewError, RecordingError
from elbowscrew.model import Recording, Source
from elbowscrew.opening import sha256_of
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import first_bytes

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
    return tuple(plug_ins.loaded(plug_ins.READERS, name, Reader) for name in plug_ins.names(plug_ins.READERS))


def reader_of(file: Path) -> Reader | None:
    """Give the reader that recognizes a file; None if none does, or the file cannot be opened."""
    head = first_bytes(file, _HEAD_BYTES)
    if not head:
        return None
    for reader in readers():
        try:
            fits = bool(reader.recognizes(head))
        except (Exception, SystemExit) as error:
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
    except (Exception, SystemExit) as error:
        raise _failed(file, reader, error) from error
    if not isinstance(found, Recording):
        msg = f"{file}: the reader {reader.name!r}: expected a Recording, found {type(found).__name__}"
        raise RecordingError(msg)
    source = found.source or Source(path=str(file), sha256=sha256_of(file), layout=reader.name)
    names = [name for name, one in zip(plug_ins.names(plug_ins.READERS), readers(), strict=True) if one is reader]
    return replace(found, source=replace(source, plug_in=plug_ins.versions(plug_ins.READERS, names)))


def _failed(file: Path, reader: Reader, error: BaseException) -> RecordingError:
    return RecordingError(f"{file}: the reader {reader.name!r}, a plug-in, failed: {plug_ins.brief(error)}")
