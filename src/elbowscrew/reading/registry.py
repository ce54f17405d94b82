"""The registry of readers: which format is it, and who reads it."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Final, Generic, TypeVar

from elbowscrew.column_file import ColumnFile, read_column_file
from elbowscrew.errors import RecordingError, SettingError, UsageError
from elbowscrew.model import QualityWarning, Recording
from elbowscrew.quantities import METERS
from elbowscrew.reading import (
    autoscoper,
    c3d,
    matrices,
    motive_columns,
    named_columns,
    plain_table,
    qualisys,
    row_tagged,
    storage,
    trc,
)
from elbowscrew.reading.cells import parse_number
from elbowscrew.reading.clock import is_rate
from elbowscrew.reading.joining import joined
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.plugged import read_by, reader_of, readers
from elbowscrew.reading.scale import with_scale_checked
from elbowscrew.reading.source import TextSource, first_bytes, open_source

_HEAD_BYTES: Final = 16
_UNITS: Final = frozenset({"units"})
_MARKERS: Final = frozenset({"markers"})
_RATE: Final = frozenset({"rate_hz"})
_ALL: Final = _UNITS | _MARKERS | {"rotation"}


Head = TypeVar("Head")
Opened = TypeVar("Opened")


@dataclass(frozen=True, slots=True, kw_only=True)
class Format(Generic[Head, Opened]):
    """One entry of the registry: a text format is told by cells and read from lines, a binary one from the file.

    Attributes
    ----------
    name : str
    endings : tuple of str
        How the names of its files end, in lower case, so that they are found in folders.
    recognizes : callable
        Told the cells of the first line with any content, in lower case; of a binary format, its first bytes.
    read : callable
    accepts : frozenset of str
        The fields of `ReadOptions` that mean something for it.
    only_ending : str
        If not empty, of files whose names end otherwise none is of this format: their cells might be anything.
    """

    name: str
    endings: tuple[str, ...]
    recognizes: Callable[[Head], bool]
    read: Callable[[Opened, ReadOptions], Recording]
    accepts: frozenset[str]
    only_ending: str = ""


FORMATS: Final[tuple[Format[list[str], TextSource], ...]] = (
    Format(
        name="Motive columns",
        endings=(".csv",),
        recognizes=motive_columns.recognizes,
        read=motive_columns.read,
        accepts=_ALL,
    ),
    Format(
        name="plain table",
        endings=(".csv",),
        recognizes=plain_table.recognizes,
        read=plain_table.read,
        accepts=_MARKERS | _RATE,
    ),
    Format(name="TRC", endings=(".trc",), recognizes=trc.recognizes, read=trc.read, accepts=_UNITS | _MARKERS),
    Format(
        name="Qualisys",
        endings=(".tsv",),
        recognizes=qualisys.recognizes,
        read=qualisys.read,
        accepts=_MARKERS,
    ),
    # Before row tags, of which 'frame' is one. No endings: in a folder, two of its files may be one trial.
    Format(
        name="4 x 4 matrices", endings=(), recognizes=matrices.recognizes, read=matrices.read, accepts=_UNITS | _RATE
    ),
    Format(
        name="row-tagged",
        endings=(".csv",),
        recognizes=row_tagged.recognizes,
        read=row_tagged.read,
        accepts=frozenset(),
    ),
    Format(
        name="OpenSim storage",
        endings=(".sto",),
        recognizes=storage.recognizes,
        read=storage.read,
        accepts=frozenset(),
    ),
    Format(
        name="Autoscoper poses",
        endings=(),
        recognizes=autoscoper.recognizes,
        read=autoscoper.read,
        accepts=_UNITS | _RATE,
        only_ending=".tra",
    ),
)
"""A new text format is one module with `recognizes` and `read` and one entry here; the first that fits reads it."""

BINARY_FORMATS: Final[tuple[Format[bytes, Path], ...]] = (
    Format(name="C3D", endings=(".c3d",), recognizes=c3d.recognizes, read=c3d.read, accepts=_UNITS | _MARKERS),
)
"""Formats that are no text, likewise."""

_ENDINGS: Final = (*(one.endings for one in FORMATS), *(one.endings for one in BINARY_FORMATS))
ENDINGS: Final = tuple(dict.fromkeys(chain.from_iterable(_ENDINGS)))
"""How the names of recordings end, in folders and for patterns; a file that is named itself may end as it likes."""
TABLE_ENDINGS: Final = (".csv", ".tsv", ".txt")
"""How those of tables end, where a file of columns says what is in them."""


def read_recording(
    path: str | os.PathLike[str],
    *,
    distal_path: str | os.PathLike[str] | None = None,
    units: str | None = None,
    rotation: str | None = None,
    rate_hz: float | None = None,
    columns: str | os.PathLike[str] | ColumnFile | None = None,
    markers: str | Sequence[str] = (),
    bones: str | Sequence[str] = (),
) -> Recording:
    """Read a recording.

    Parameters
    ----------
    path : path-like
        An OptiTrack export (Motive's column layout 1.1 to 1.25, the row-tagged layout 1.0 and 1.1), a plain table, a
        TRC file, an export of Qualisys, orientations in OpenSim's storage, a table of 4 x 4 matrices, poses of
        Autoscoper, or a C3D file (with the extra ``[c3d]``).
    distal_path : path-like, optional
        The file of the distal body, where each body has a file of its own: `path` is that of the proximal one.
    units : {"m", "cm", "mm"}, optional
        Unit of length, for a file that states none. A file's own statement is not overruled.
    rotation : str, optional
        "quaternion" or an Euler order such as "XYZ", for a file that states none.
    rate_hz : float, optional
        Frames a second, for a plain table that has no times, and for matrices.
    columns : path-like or ColumnFile, optional
        The TOML file that says what the columns of any other table are.
    markers : str or sequence of str, optional
        Names of markers to read, or patterns such as "Arm*"; none by default.
    bones : str or sequence of str, optional
        Names of bones of Motive's skeletons to read as bodies, or patterns; none by default. Names that are no bone's
        mean nothing here.

    Returns
    -------
    Recording
        In meters and seconds.

    Raises
    ------
    RecordingError
        If a file cannot be read safely, or two do not fit together; the message says where and why.
    SettingError
        If the file lacks a statement that `units`, `rotation` or `rate_hz` must supply, or they contradict it, or its
        format knows no such thing.
    UsageError
        If `units`, `rate_hz` or `columns` is no possible one.

    Examples
    --------
    >>> import elbowscrew, tempfile
    >>> trial = elbowscrew.simulate_trial(frames=60, inversion=30)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     read_recording(elbowscrew.save_simulation(trial, f"{folder}/trial.csv")[0]).rate_hz
    100.0
    """
    if units is not None and units not in METERS:
        msg = f"units: expected one of {', '.join(METERS)}, found {units!r}"
        raise UsageError(msg)
    if rate_hz is not None and not is_rate(rate_hz):
        msg = f"rate_hz: expected a frame rate in hertz, found {rate_hz!r}"
        raise UsageError(msg)
    options = ReadOptions(
        units=units,
        rotation=rotation,
        rate_hz=rate_hz,
        markers=(markers,) if isinstance(markers, str) else tuple(markers),
        bones=(bones,) if isinstance(bones, str) else tuple(bones),
        columns=_column_file(columns),
        alone=distal_path is None,
    )
    recording = _read(Path(path), options)
    if distal_path is not None:
        recording = joined(recording, _read(Path(distal_path), options))
    return with_scale_checked(recording, units)


def all_endings() -> tuple[str, ...]:
    """How the names of recordings end, those that plug-ins read among them."""
    return tuple(dict.fromkeys((*ENDINGS, *chain.from_iterable(reader.endings for reader in readers()))))


def _column_file(given: str | os.PathLike[str] | ColumnFile | None) -> ColumnFile | None:
    if given is None or isinstance(given, ColumnFile):
        return given
    try:
        return read_column_file(Path(given))
    except ValueError as error:
        msg = f"columns: {error}"
        raise UsageError(msg) from error


def _read(file: Path, options: ReadOptions) -> Recording:
    if options.columns is not None:
        _check_options(file, "named columns", options, _UNITS | _MARKERS | _RATE)
        source = open_source(file)
        return _told(source, named_columns.read(source, options, options.columns))
    head = first_bytes(file, _HEAD_BYTES)
    for binary in BINARY_FORMATS:
        if binary.recognizes(head):
            _check_options(file, binary.name, options, binary.accepts)
            return binary.read(file, options)
    try:
        source = open_source(file)
    except RecordingError:
        found = _read_by_plug_in(file, options)
        if found is None:
            raise
        return found
    first_line = next((line for line in source.head(20) if line.strip(", ;\t")), "")
    cells = [cell.strip().strip('"').strip().casefold() for cell in first_line.split(source.delimiter)]
    for entry in FORMATS:
        if entry.recognizes(cells) and file.suffix.casefold().endswith(entry.only_ending):
            _check_options(file, entry.name, options, entry.accepts)
            return _told(source, entry.read(source, options))
    found = _read_by_plug_in(file, options)
    if found is not None:
        return found
    if storage.has_header(source):
        return _told(source, storage.read(source, options))
    raise RecordingError(_refusal(source, cells))


def _told(source: TextSource, recording: Recording) -> Recording:
    """Add a note where the text is not UTF-8."""
    if source.is_utf_8:
        return recording
    message = f"the text of {source.path.name} is not UTF-8: names were read as Windows-1252"
    note = QualityWarning(code="not-utf-8", message=message, severity="note")
    return replace(recording, warnings=(*recording.warnings, note))


def _read_by_plug_in(file: Path, options: ReadOptions) -> Recording | None:
    """Read a file that is of none of our formats, if a plug-in's it is; None if not."""
    reader = reader_of(file)
    if reader is None:
        return None
    _check_options(file, reader.name, options, reader.accepts)
    return read_by(reader, file, options)


def _check_options(path: Path, name: str, options: ReadOptions, accepted: frozenset[str]) -> None:
    given = {key for key in _ALL | _RATE if getattr(options, key)}
    unknown = sorted(given - accepted)
    if unknown:
        told = ", ".join(key.removesuffix("_hz") for key in unknown)
        landmarks = ", and give landmarks as coordinates" if "markers" in unknown else ""
        msg = f"{path}: {told}: a file of this format ({name}) states or has no such thing; leave it out{landmarks}"
        raise SettingError(msg)


def _refusal(source: TextSource, cells: list[str]) -> str:
    try:
        numbers = [parse_number(cell) for cell in cells]
    except ValueError:
        return (
            f"{source.path}:1: no format that is read: expected 'Format Version', a row tag such as 'comment', or "
            f"'frame,time_s' in the first cells, found {cells[0][:40]!r}; any table is read once --columns FILE.toml "
            "says what its columns are (docs/reference/plain-table.md)"
        )
    angles = (
        " (if they are Autoscoper's x, y, z, yaw, pitch, roll, let the file's name end in .tra)"
        if autoscoper.recognizes(cells)
        else ""
    )
    return (
        f"{source.path}:1: the header is missing (the file begins with a number), so nothing says what the "
        f"{len(numbers)} columns are{angles}; export the take again with the header on, or say what they are by "
        "--columns FILE.toml (docs/reference/plain-table.md)"
    )


def recordings_in(folder: str | os.PathLike[str], endings: tuple[str, ...] | None = None) -> tuple[Path, ...]:
    """Files of a folder that may be recordings, by the endings of their names, all of ours by default, in their order.

    Raises
    ------
    RecordingError
        If the folder cannot be read, or has none.
    """
    root, endings = Path(folder), endings or all_endings()
    try:
        found = sorted(path for path in root.iterdir() if path.suffix.casefold() in endings and path.is_file())
    except OSError as error:
        msg = f"{root}: cannot be read: {error.strerror or error}"
        raise RecordingError(msg) from error
    if not found:
        msg = f"{root}: expected recordings ({', '.join(endings)}) in the folder, found none"
        raise RecordingError(msg)
    return tuple(found)
