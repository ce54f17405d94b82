"""Finding the trials of a study in folders, files, patterns and manifests."""

from __future__ import annotations

import csv
import glob
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elbowscrew.errors import UsageError, files_beside
from elbowscrew.reading.plugged import reader_of
from elbowscrew.reading.registry import FORMATS, TABLE_ENDINGS, all_endings
from elbowscrew.reading.source import END_OF_STORAGE_HEADER, first_bytes
from elbowscrew.results.result_files import BATCH_MARK, is_summary
from elbowscrew.study.manifest import is_manifest, read_manifest
from elbowscrew.study.trial import Trial

_HEAD_BYTES: Final = 16384
# Words of an export's header: a file that has one is a recording, be it a damaged one.
_WORDS: Final = re.compile(
    r"format version|rigid ?body|rotation|position|pathfiletype|capture|quaternion|marker|righthanded|frame|time|take",
    re.IGNORECASE,
)
_ORIENTATIONS: Final = re.compile(r"^\s*datatype\s*=\s*quaternion", re.IGNORECASE | re.MULTILINE)
_NUMBER: Final = re.compile(r"\s*[-+]?(\d+([.,]\d+)?|[.,]\d+)([eE][-+]?\d+)?\s*")


@dataclass(frozen=True, slots=True, kw_only=True)
class Skipped:
    """A file or folder that was passed over, and why."""

    path: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """All trials found, in their order, and what was passed over."""

    trials: tuple[Trial, ...]
    skipped: tuple[Skipped, ...]


def find_trials(
    paths: Sequence[str],
    *,
    recursive: bool = False,
    follow_symlinks: bool = False,
    exclude: Path | None = None,
    any_table: bool = False,
) -> Study:
    """Find the trials that paths stand for.

    Parameters
    ----------
    paths : sequence of str
        Folders, files, patterns (``data/*.csv``), or manifests: tables with a column ``path``.
    recursive : bool
        Look into the folders below, too.
    follow_symlinks : bool
        Follow links that lead out of the folder given.
    exclude : Path, optional
        The output folder: nothing in it is a trial.
    any_table : bool
        Take every table for a recording, as a file of columns says what is in it.

    Returns
    -------
    Study
        Each recording once, in natural order of the labels.

    Raises
    ------
    UsageError
        If a path leads nowhere, a manifest does not fit, or there is no trial at all.
    """
    search = _Search(recursive, follow_symlinks, exclude, any_table)
    alone = len(paths) == 1
    for text in paths:
        path = Path(text)
        if path.is_dir():
            search.folder(path, "" if alone else _posix(path).rstrip("/") + "/")
        elif os.path.lexists(path):
            if is_manifest(path):
                search.manifest(path)
            else:
                search.add(path, _posix(path))
        else:
            search.pattern(text)
    search.check()
    return Study(
        trials=tuple(sorted(search.trials, key=lambda trial: natural_key(trial.label))),
        skipped=tuple(sorted(search.skipped, key=lambda one: natural_key(one.path))),
    )


def natural_key(text: str) -> tuple[list[tuple[int, str]], str]:
    """Sort key that puts ``trial 2`` before ``trial 10``; the text itself decides between equals."""
    parts = re.split(r"([0-9]+)", text.casefold())
    numbers = [part.lstrip("0") for part in parts]  # in their order, however many digits they have
    return [(len(numbers[k]), numbers[k]) if k % 2 else (-1, part) for k, part in enumerate(parts)], text


class _Search:
    """What has been found up to now."""

    def __init__(self, recursive: bool, follow_symlinks: bool, exclude: Path | None, any_table: bool) -> None:
        self.any_table = any_table
        self.endings = TABLE_ENDINGS if any_table else all_endings()
        self.recursive = recursive
        self.follow_symlinks = follow_symlinks
        self.exclude = None if exclude is None else _identity(exclude)
        self.trials: list[Trial] = []
        self.skipped: list[Skipped] = []
        self.known: set[Path] = set()
        self.below: list[str] = []

    def add(self, path: Path, label: str, *, by_file: bool = True) -> None:
        """Take a file, unless it has been found before under another name."""
        real = _real(path)
        if real not in self.known:
            self.known.add(real)
            self.trials.append(Trial(path=Path(os.path.abspath(path)), label=label, by_file=by_file))  # noqa: PTH100 - keeps links

    def manifest(self, path: Path) -> None:
        for trial in read_manifest(path):
            self.known.add(_real(trial.path))
            self.trials.append(trial)

    def pattern(self, text: str) -> None:
        if not glob.has_magic(text):
            msg = f"{text}: no such file or folder{files_beside(text) or '; check the name'}"
            raise UsageError(msg)
        matches = [Path(match) for match in sorted(glob.glob(text, recursive=True))]  # noqa: PTH207 - may be absolute
        if not matches:
            msg = f"{text}: no file fits this pattern; check it, or give the folder"
            raise UsageError(msg)
        for path in matches:
            if path.is_file() and path.suffix.casefold() in self.endings and not self._ours(path.parent):
                self._candidate(path, _posix(path))

    def folder(self, root: Path, prefix: str) -> None:
        """Take the recordings of a folder, and of those below it if that is asked for."""
        real_root = _real(root)
        for path in self._files(root, real_root):
            label = prefix + _posix(path.relative_to(root))
            if self._may_be_followed(path, real_root, label):
                self._candidate(path, label, by_file=False)

    def check(self) -> None:
        if self.trials:
            return
        if self.below:
            msg = f"no trial in the folder itself; --recursive looks into the folders below, such as {self.below[0]!r}"
        else:
            ends = ", ".join(self.endings)
            passed = f"; passed over: {self.skipped[0].path} ({self.skipped[0].reason})" if self.skipped else ""
            msg = f"no trial found: expected files that end in {ends}{passed}"
        raise UsageError(msg)

    def _files(self, root: Path, real_root: Path) -> Iterator[Path]:
        """Yield the files of a folder and of those below it, however deep, in the order of their names."""
        seen = {_identity(root)}
        left = self._entries(root)
        while left:
            path = left.pop()
            try:
                if not path.is_dir():
                    if path.suffix.casefold() in self.endings:
                        yield path
                    continue
                identity = _identity(path)
                if identity in seen or self._ours(path):
                    continue
            except OSError as error:
                self._unreadable(path, error)
                continue
            if not self.recursive:
                self.below.append(path.name)
            elif self._may_be_followed(path, real_root, _posix(path)):
                seen.add(identity)
                left += self._entries(path)

    def _entries(self, folder: Path) -> list[Path]:
        """Give what is in a folder, the last by name first."""
        try:
            return sorted((path for path in folder.iterdir() if not path.name.startswith(".")), reverse=True)
        except OSError as error:
            self._unreadable(folder, error)
            return []

    def _unreadable(self, path: Path, error: OSError) -> None:
        self.skipped.append(Skipped(path=_posix(path), reason=f"cannot be read: {error.strerror or error}"))

    def _may_be_followed(self, path: Path, real_root: Path, label: str) -> bool:
        if self.follow_symlinks or not path.is_symlink() or _real(path).is_relative_to(real_root):
            return True
        self.skipped.append(Skipped(path=label, reason="a link out of the folder; --follow-symlinks follows it"))
        return False

    def _ours(self, folder: Path) -> bool:
        """Whether a folder is a result, or the output of a batch."""
        if self.exclude is not None and _identity(folder) == self.exclude:
            return True
        return (folder / BATCH_MARK).exists() or is_summary(folder / "summary.json")

    def _candidate(self, path: Path, label: str, *, by_file: bool = True) -> None:
        reason = _other_table(path, any_table=self.any_table)
        if reason:
            self.skipped.append(Skipped(path=label, reason=reason))
        else:
            self.add(path, label, by_file=by_file)


def _other_table(path: Path, *, any_table: bool) -> str:
    """Say what a file is that is certainly no recording; empty for all that is one, or may be a damaged one.

    A damaged recording must come up as a failure, so only a sound table about something else is passed over: a header
    of several words, none of them known from exports, with rows as long as it is.
    """
    ending = path.suffix.casefold()
    if ending not in (".csv", ".sto"):
        return ""
    if is_manifest(path):
        return "a manifest; give it in place of the folder"
    if any_table:
        return ""
    try:
        head = first_bytes(path, _HEAD_BYTES).decode(
            "utf-8-sig", "strict" if path.stat().st_size < _HEAD_BYTES else "ignore"
        )
    except (OSError, UnicodeDecodeError):
        return ""
    lines = [line for line in head.splitlines() if line.strip()]
    if ending == ".sto":
        other = any(line.strip().casefold() == END_OF_STORAGE_HEADER for line in lines) and not _ORIENTATIONS.search(
            head
        )
        return "a storage of OpenSim, but not of orientations" if other else ""
    if len(lines) < 2 or "\0" in head or _WORDS.search("\n".join(lines[:8])):
        return ""
    delimiter = max(",;\t", key=lines[0].count)
    try:
        header, row = (next(csv.reader([line], delimiter=delimiter)) for line in lines[:2])
    except csv.Error:
        return ""
    cells = [cell.strip().casefold() for cell in header]
    words = all(cells) and not any(map(_NUMBER.fullmatch, cells)) and len(set(cells)) == len(cells) > 1
    if not words or len(row) != len(header) or any(entry.recognizes(cells) for entry in FORMATS):
        return ""
    if reader_of(path) is not None:
        return ""
    return "a table, but not of a recording"


def _real(path: Path) -> Path:
    """Follow links as far as they lead; `Path.resolve` raises an error where they lead in a circle."""
    return Path(os.path.realpath(path))


def _identity(path: Path) -> tuple[int, int] | None:
    """Tell which file or folder it is, whatever it is called; None if there is none."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino


def _posix(path: Path) -> str:
    return path.as_posix()
