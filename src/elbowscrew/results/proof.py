"""Digests of the files of a result, written with them and checked when they are read: against accident, not forgery.

``SHA256SUMS`` has a line a file, as ``sha256sum`` writes it, and ``sha256sum --check SHA256SUMS`` reads it.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final

from elbowscrew._version import __version__
from elbowscrew.errors import ResultError
from elbowscrew.opening import open_bytes, sha256_of, write_new
from elbowscrew.results.result_files import RESULT_FILES, SUMS, files_in, is_of_result, sums_in, version_told

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_READ_BYTES: Final = 1 << 20
_DRAWN: Final = ("figures/", "report.html", "methods.txt")


def seal(folder: Path, names: Sequence[str] = RESULT_FILES) -> None:
    """Write the digests of all files of a folder.

    Parameters
    ----------
    folder : Path
    names : sequence of str
        What may be there, in the order of the lines.
    """
    present = {name for name in files_in(folder) if is_of_result(name, names) and name != SUMS}
    ordered = (*(name for name in names if name in present), *sorted(present.difference(names)))
    sums = {name: sha256_of(folder / name) for name in ordered}
    write_new(folder / SUMS, _lines(sums))


@dataclass(frozen=True, slots=True)
class ProvedFile:
    """A file and the SHA-256 that it must have."""

    path: Path
    sha256: str

    @contextmanager
    def opened(self) -> Iterator[IO[bytes]]:
        """Open the file, and check when the block ends that what was read, and what is left, has its digest.

        Raises
        ------
        ResultError
            If it has not, whatever else was found wrong; nothing that was read from it is to be passed on.
        OSError
            If it cannot be read.
        """
        with open_bytes(self.path) as source:
            digested = _Digested(source)
            stream = io.BufferedReader(digested, _READ_BYTES)
            try:
                yield stream
            finally:
                digested.rest()
                if digested.sha256.hexdigest() != self.sha256:
                    raise _edited(self.path)


@dataclass(frozen=True, slots=True)
class Proof:
    """The digests of a result folder, read once: so that no two files of two states of it go together.

    Attributes
    ----------
    folder : Path
    sums : mapping of str to str
        SHA-256 by name.
    """

    folder: Path
    sums: Mapping[str, str]

    def has(self, name: str) -> bool:
        """Whether a file belongs to the result."""
        return name in self.sums

    def file(self, name: str) -> ProvedFile:
        """Give a file of the result.

        Raises
        ------
        ResultError
            If the result has no such file.
        """
        if name not in self.sums:
            msg = f"{self.folder / name}: is not named in {SUMS}, so that nothing proves it; analyze the trial again"
            raise ResultError(msg)
        return ProvedFile(self.folder / name, self.sums[name])

    def changed(self, proved: Collection[str] = ()) -> tuple[str, ...]:
        """Names of files that are not as they were written: edited, missing, or not named although they are ours.

        Those that have been proved are not looked at again.
        """
        named = [
            name for name, digest in self.sums.items() if name not in proved and not _has(self.folder / name, digest)
        ]
        try:
            others = set(files_in(self.folder)) - set(self.sums) - {SUMS}
        except OSError:
            others = set()
        return (*named, *sorted(filter(is_of_result, others)))

    def check_numbers(self, proved: Collection[str] = ()) -> None:
        """Raise `ResultError` if a table or a JSON file is not as it was written; what is drawn may be retouched."""
        changed = [name for name in self.changed(proved) if not name.startswith(_DRAWN)]
        if changed:
            raise _edited(self.folder / changed[0], changed[1:])

    def with_files(self, contents: Mapping[str, bytes]) -> bytes:
        """Give the digests as they are when files have been made again."""
        return _lines({**self.sums, **{name: hashlib.sha256(one).hexdigest() for name, one in contents.items()}})


def proof_of(folder: Path) -> Proof:
    """Read the digests of a result folder.

    Raises
    ------
    ResultError
        If there are none, as of versions that wrote none, or they are damaged.
    """
    path = folder / SUMS
    try:
        with open_bytes(path) as stream:
            text = stream.read().decode("utf-8", "replace")
    except FileNotFoundError as error:
        written = version_told(folder)
        if written is None:
            msg = f"{folder}: holds no finished result: summary.json: {error.strerror}; analyze the trial first"
        else:
            msg = (
                f"{folder}: has no {SUMS}, so that nothing proves its numbers (written by elbowscrew {written}; "
                f"this is {__version__}); analyze the trial again"
            )
        raise ResultError(msg) from error
    except OSError as error:
        msg = f"{path}: cannot be read: {error.strerror or error}; analyze the trial again"
        raise ResultError(msg) from error
    sums = sums_in(text)
    if sums is None or not all(map(is_of_result, sums)):
        msg = f"{path}: damaged: expected a line for each file, its SHA-256 and its name; analyze the trial again"
        raise ResultError(msg)
    return Proof(folder, sums)


class _Digested(io.RawIOBase):
    """A file that is read once, for its content and for its digest."""

    def __init__(self, source: io.BufferedReader) -> None:
        super().__init__()
        self._source = source
        self.sha256 = hashlib.sha256()

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        count = self._source.readinto(buffer)
        self.sha256.update(memoryview(buffer)[:count])
        return count

    def rest(self) -> None:
        """Read what has not been asked for."""
        while data := self._source.read(_READ_BYTES):
            self.sha256.update(data)


def _has(path: Path, digest: str) -> bool:
    try:
        return sha256_of(path) == digest
    except OSError:
        return False


def _lines(sums: Mapping[str, str]) -> bytes:
    return "".join(f"{digest}  {name}\n" for name, digest in sums.items()).encode()


def _edited(path: Path, others: Sequence[str] = ()) -> ResultError:
    also = f" (and {', '.join(others)})" if others else ""
    return ResultError(
        f"{path}{also}: not as it was written: edited, cut or missing, as {SUMS} tells; analyze the trial again"
    )
