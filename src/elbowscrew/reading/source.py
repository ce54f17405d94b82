"""A text file as the readers see it: checked, hashed, and given out line by line."""

from __future__ import annotations

import codecs
import csv
import re
import threading
from collections.abc import Generator, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Final, TextIO

from elbowscrew.errors import RecordingError, files_beside
from elbowscrew.opening import digest_of, open_bytes, open_text

_HEAD_BYTES: Final = 65536
_MAX_LINE: Final = 1 << 24
_BLOCK_CHARACTERS: Final = 3 << 17
_LIMIT_LOCK: Final = threading.RLock()
# Only a line of numbers may have its cells separated by blanks.
_NUMBERS: Final = re.compile(rb"(?:[-+.\deE]+|nan)(?: (?:[-+.\deE]+|nan))+", re.IGNORECASE)

_UTF_8: Final = "utf-8-sig"
_WINDOWS: Final = "cp1252"
_BLANK: Final = ", ;\t"

END_OF_STORAGE_HEADER: Final = "endheader"
"""The line behind which OpenSim's storages have their table."""

# Signatures of files that are taken for a CSV export by mistake.
_NOT_TEXT: Final = {
    b"PK\x03\x04": "a zip archive or a spreadsheet workbook; save it as CSV",
    b"\xff\xfe": "UTF-16 text; save it as CSV in UTF-8",
    b"\xfe\xff": "UTF-16 text; save it as CSV in UTF-8",
    b"\x1f\x8b": "gzip-compressed; unpack it first",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class TextSource:
    """A file that has been found to be text.

    Attributes
    ----------
    path : Path
    sha256 : str
        Of the bytes as they are on disk.
    ends_with_newline : bool
        False hints that the file may have been cut.
    delimiter : str
        Comma, semicolon or tab; a blank between numbers.
    encoding : str
        UTF-8, or Windows-1252 where the first text is none, as older programs write names and paths.
    """

    path: Path
    sha256: str
    ends_with_newline: bool
    delimiter: str
    encoding: str = _UTF_8

    @property
    def is_utf_8(self) -> bool:
        """Whether the text is what it should be."""
        return self.encoding == _UTF_8

    @property
    def decimal_comma(self) -> bool:
        """Whether a comma in a number is its decimal point: it can be where it does not separate cells."""
        return self.delimiter != ","

    def cells(self, line: str) -> list[str]:
        """Split a line into its cells, stripped.

        Raises
        ------
        csv.Error
            If the quotes of the line do not fit.
        """
        reader = csv.reader([line], delimiter=self.delimiter, strict=True)
        if len(line) < csv.field_size_limit():
            row = next(reader, [])
        else:
            with longest_cell(_MAX_LINE):
                row = next(reader, [])
        return [cell.strip() for cell in row]

    def head(self, count: int) -> list[str]:
        """Give the first lines, at most so many; as `lines`.

        Whoever does not want all lines takes them here: a generator that is left to Python to be closed swallows the
        signal that comes just then.
        """
        with closing(self.lines()) as lines:
            return list(islice(lines, count))

    def first_filled(self) -> tuple[int, str]:
        """Give number and text of the first line with any content, which every source has; as `lines`."""
        with closing(self.lines()) as lines:
            return next((k, line) for k, line in enumerate(lines, start=1) if line.strip(_BLANK))

    def lines(self) -> Generator[str, None, None]:
        """Yield the lines without their ends, be these LF, CRLF or CR.

        Raises
        ------
        RecordingError
            If a line is not UTF-8, or is longer than any export's.
        """
        number = 0
        try:
            with self._open() as stream:
                while line := stream.readline(_MAX_LINE):
                    number += 1
                    if len(line) >= _MAX_LINE:
                        msg = f"{self.path}:{number}: a line of over {_MAX_LINE} characters: not an OptiTrack export"
                        raise RecordingError(msg)
                    yield line.removesuffix("\n")
        except UnicodeDecodeError as error:
            msg = (
                f"{self.path}: not UTF-8 text (byte 0x{error.object[error.start]:02x} after line {number}); "
                "save it in UTF-8"
            )
            raise RecordingError(msg) from error
        except OSError as error:
            raise self._unread(error) from error

    def blocks(self, first_line: int) -> Iterator[list[str]]:
        """Yield the lines from `first_line` on, counted from 0, many at a time: the same as `lines`, but faster.

        Raises
        ------
        RecordingError
            As `lines`.
        """
        try:
            with self._open() as stream:
                for _ in range(first_line):
                    stream.readline(_MAX_LINE)
                while text := stream.read(_BLOCK_CHARACTERS):
                    text += stream.readline(_MAX_LINE)
                    block = text.removesuffix("\n").split("\n")
                    if len(text) >= _MAX_LINE and max(map(len, block)) >= _MAX_LINE:
                        break
                    yield block
                else:
                    return
        except UnicodeDecodeError:
            pass
        except OSError as error:
            raise self._unread(error) from error
        for _ in self.lines():  # which tells what is wrong, and where
            pass
        msg = f"{self.path}: the file changes while it is read; wait until it is written"
        raise RecordingError(msg)

    def _unread(self, error: OSError) -> RecordingError:
        return RecordingError(f"{self.path}: cannot be read: {error.strerror}")

    @contextmanager
    def _open(self) -> Iterator[TextIO]:
        """Open the text. A disk that fails at its closing takes nothing from what was read, be it all or the begin."""
        stream = open_text(self.path, encoding=self.encoding)
        try:
            yield stream
        finally:
            with suppress(OSError):
                stream.close()


@contextmanager
def longest_cell(characters: int) -> Iterator[None]:
    """Have `csv` read cells of up to so many characters, within the block only: the limit is that of the process."""
    with _LIMIT_LOCK:
        before = csv.field_size_limit(characters)
        try:
            yield
        finally:
            csv.field_size_limit(before)


def first_bytes(path: Path, count: int) -> bytes:
    """Read the first bytes of a file; none if it is no regular file or cannot be read, as `open_source` reports."""
    try:
        with open_bytes(path) as stream:
            return stream.read(count)
    except (OSError, ValueError):
        return b""


def open_source(path: Path) -> TextSource:
    """Check that a file is there and is text.

    Raises
    ------
    RecordingError
        If it is missing, a folder, unreadable, empty or binary.
    """
    try:
        with open_bytes(path) as stream:
            head = stream.read(_HEAD_BYTES)
            stream.seek(0)
            digest = digest_of(stream)
            last = b""
            if head:
                stream.seek(-1, 2)
                last = stream.read(1)
    except FileNotFoundError as error:
        msg = f"{path}: no such file{files_beside(path) or '; check the name and the folder'}"
        raise RecordingError(msg) from error
    except IsADirectoryError as error:
        msg = f"{path}: a folder, not a recording; give one exported CSV file"
        raise RecordingError(msg) from error
    except (OSError, ValueError) as error:  # a NUL in the name is a ValueError
        reason = getattr(error, "strerror", None) or error
        msg = f"{path}: cannot be read: {reason}; check the file and its permissions"
        raise RecordingError(msg) from error
    if not head.strip(b"\xef\xbb\xbf\r\n\t ,;"):
        msg = f"{path}: the file is empty; export the take again"
        raise RecordingError(msg)
    for signature, what in _NOT_TEXT.items():
        if head.startswith(signature):
            msg = f"{path}: {what}"
            raise RecordingError(msg)
    if b"\0" in head:
        msg = f"{path}: a binary file, not text; export the take as CSV"
        raise RecordingError(msg)
    return TextSource(
        path=path,
        sha256=digest,
        ends_with_newline=last in (b"\n", b"\r"),
        delimiter=_delimiter_of(head),
        encoding=_encoding_of(head),
    )


def _encoding_of(head: bytes) -> str:
    with suppress(UnicodeDecodeError):
        codecs.getincrementaldecoder(_UTF_8)().decode(head, final=len(head) < _HEAD_BYTES)
        return _UTF_8
    with suppress(UnicodeDecodeError):
        head.decode(_WINDOWS)
        return _WINDOWS
    return _UTF_8


def _delimiter_of(head: bytes) -> str:
    """Tell the delimiter by the first line with any content that more than one cell shows.

    A TRC file begins with a path, which may have any of them: there the line of the markers' names tells. The cells of
    a storage of OpenSim may hold commas, and its header anything: there the line behind the header tells.
    """
    lines = head.splitlines()
    ends = [k for k, line in enumerate(lines) if line.strip().lower() == END_OF_STORAGE_HEADER.encode()]
    if ends and any(b"\t" in line for line in lines[ends[0] + 1 :]):
        return "\t"
    if head.removeprefix(b"\xef\xbb\xbf").lstrip()[:12].lower() == b"pathfiletype":
        lines = [line for line in lines if line.lstrip()[:5].lower() == b"frame"] or lines
    for line in lines:
        counts = {mark: line.count(mark.encode()) for mark in ("\t", ",", ";")}
        if any(counts.values()):
            return max(counts, key=lambda mark: counts[mark])
    first = next((line.strip() for line in lines if line.strip()), b"")
    return " " if _NUMBERS.fullmatch(first) else ","
