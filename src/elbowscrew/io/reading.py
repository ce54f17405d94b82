"""The registry of readers: which format is it, and who reads it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Final

from elbowscrew.errors import RecordingError, UsageError
from elbowscrew.io import motive_columns, row_tagged
from elbowscrew.io.cells import parse_number
from elbowscrew.io.source import TextSource, open_source
from elbowscrew.model import Recording
from elbowscrew.tables import METERS


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """One entry of the registry.

    Attributes
    ----------
    name : str
    recognizes : callable
        Told the first cell of the file, in lower case and without quotes.
    read : callable
        Told the source, the unit of length and the rotation type the user gave, if any.
    """

    name: str
    recognizes: Callable[[str], bool]
    read: Callable[[TextSource, str | None, str | None], Recording]


FORMATS: Final = (
    Format(name="row-tagged", recognizes=lambda cell: cell in row_tagged.TAGS, read=row_tagged.read),
    Format(name="Motive columns", recognizes=lambda cell: cell == "format version", read=motive_columns.read),
)
"""A new format is one module with a `read` and one entry here; the first that recognizes the file reads it."""


def read_recording(path: str | os.PathLike[str], *, units: str | None = None, rotation: str | None = None) -> Recording:
    """Read an OptiTrack export.

    Parameters
    ----------
    path : path-like
        Motive's column layout (1.2 to 1.25) or the row-tagged layout (1.0, 1.1) of Tracking Tools.
    units : {"m", "cm", "mm"}, optional
        Unit of length, for a file that states none. A file's own statement is not overruled.
    rotation : str, optional
        "quaternion" or an Euler order such as "XYZ", for a file that states none.

    Returns
    -------
    Recording

    Raises
    ------
    RecordingError
        If the file cannot be read safely; the message says where and why.
    SettingError
        If the file lacks a statement that `units` or `rotation` must supply, or they contradict it.
    UsageError
        If `units` is no possible one.
    """
    if units is not None and units not in METERS:
        msg = f"units: expected one of {', '.join(METERS)}, found {units!r}"
        raise UsageError(msg)
    source = open_source(Path(path))
    first_line = next((line for line in islice(source.lines(), 20) if line.strip(", ;\t")), "")
    first_cell = first_line.split(source.delimiter)[0].strip().strip('"').strip().casefold()
    for entry in FORMATS:
        if entry.recognizes(first_cell):
            return entry.read(source, units, rotation)
    raise RecordingError(_refusal(source, first_line, first_cell))


def _refusal(source: TextSource, first_line: str, first_cell: str) -> str:
    try:
        parse_number(first_cell)
    except ValueError:
        return (
            f"{source.path}:1: not an OptiTrack export: expected 'Format Version' or a row tag such as 'comment' in "
            f"the first cell, found {first_cell[:40]!r}"
        )
    return (
        f"{source.path}:1: the header is missing (the file begins with a number), so nothing says what the columns "
        "are; export the take again with the header on"
    )
