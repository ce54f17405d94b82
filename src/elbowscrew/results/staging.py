"""Results appear whole or not at all, never over anything that is not ours, and with the digests of all their files."""

from __future__ import annotations

import errno
import os
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from elbowscrew.disk.file_sets import write_set
from elbowscrew.disk.folders import make_parents, new_folder, remove_empty, straight, sweep
from elbowscrew.disk.placing import recover
from elbowscrew.disk.temporary import REPLACED, is_temporary
from elbowscrew.errors import OutputError
from elbowscrew.opening import open_bytes
from elbowscrew.results.proof import seal
from elbowscrew.results.result_files import (
    ANALYSIS,
    ResultKind,
    files_in,
    is_or_was_summary,
    placed_by_exporters,
)


@contextmanager
def result_folder(target: Path, *, force: bool, kind: ResultKind = ANALYSIS) -> Iterator[Path]:
    """Give a temporary folder to write into, and make it the target when the block ends well.

    Parameters
    ----------
    target : Path
        The result folder. An empty folder is taken over; its parents are made; a link is followed.
    force : bool
        Replace an earlier result, but never a folder that holds anything else.
    kind : ResultKind

    Raises
    ------
    OutputError
        If the target exists, or the disk does not take the result. Nothing is left behind then, and an earlier
        result is as it was.
    """
    check_result_folder(target, force=force, kind=kind)
    try:
        with new_folder(
            target.resolve(),
            check=lambda folder: _check_content(target, folder, force, kind),
            finish=lambda folder: seal(folder, kind.files),
        ) as staged:
            yield staged
    except OSError as error:
        raise output_error(target, error) from error


def settle(folder: Path) -> None:
    """Undo what a killed run has begun to do to a result folder, and sweep what it has left.

    Raises
    ------
    OutputError
        If the disk does not take it.
    """
    try:
        recover(folder.resolve())
        if folder.is_dir():
            sweep(folder)
    except OSError as error:
        raise output_error(folder, error) from error


def moved_aside(folder: Path) -> list[Path]:
    """Find results in a folder that a killed run has moved aside: only a run to the same place knows what it was."""
    return sorted(path for path in folder.iterdir() if is_temporary(path.name) and path.name.endswith(REPLACED))


def check_result_folder(target: Path, *, force: bool, kind: ResultKind = ANALYSIS) -> None:
    """Raise `OutputError` if the result may not be put there; what a killed run has left is undone first."""
    try:
        if target.is_dir():
            if target.resolve() == Path.cwd():
                msg = f"{target}: is the current folder; give --output a folder of its own"
                raise OutputError(msg)
            _check_names(target, target, kind)  # before a folder of somebody else's is searched
        settle(target)
        if not os.path.lexists(target):
            return
        if not target.is_dir():
            msg = f"{target}: exists and is not a folder; give another --output"
            raise OutputError(msg)
        _check_content(target, target, force, kind)
    except OSError as error:
        raise output_error(target, error) from error


def _check_content(target: Path, folder: Path, force: bool, kind: ResultKind) -> None:
    """Raise `OutputError` if what is in the folder that is or was the target may not be replaced."""
    if not _check_names(target, folder, kind):
        return
    try:
        ours = is_or_was_summary(folder / kind.summary)
    except OSError as error:
        why = error.strerror or error
        msg = (
            f"{target / kind.summary}: cannot be read ({why}), so that nothing tells whose it is; give another --output"
        )
        raise OutputError(msg) from None  # of this folder alone: others may be written
    if not ours:
        msg = f"{target}: the folder holds files but no elbowscrew result; give another --output"
        raise OutputError(msg)
    if not force:
        msg = f"{target}: there is a result already; give --force to replace it, or another --output"
        raise OutputError(msg)


def _check_names(target: Path, folder: Path, kind: ResultKind) -> int:
    """Count what is in a result folder; raise `OutputError` if anything has another name."""
    known, count = placed_by_exporters(folder).union(kind.files), 0
    for name in files_in(folder):
        count += 1
        if name not in known:
            msg = f"{target}: the folder holds {name!r}, which is not ours; give another --output"
            raise OutputError(msg)
    return count


def write_files(
    folder: Path, contents: Mapping[str, Iterable[str] | bytes], *, replaceable: Collection[str] | None
) -> None:
    """Write files that belong together: all of them appear, each whole, or none.

    Parameters
    ----------
    folder : Path
        Where to; it is made.
    contents : mapping of str to iterable of str, or bytes
        By names; lines of each file, without line ends, or all of it.
    replaceable : collection of str, or None
        None to replace nothing; else an existing file is replaced if it is empty, as a crash may leave it, or its first
        4096 bytes hold one of these words, which tell that it is one of ours.

    Raises
    ------
    OutputError
        If a file exists that may not be replaced, or the disk does not take them. What was there is as it was.
    """
    folder = straight(folder)
    first = folder / next(iter(contents))
    made: list[Path] = []
    try:
        if folder.is_dir():
            sweep(folder)
        for name in contents:
            _check_file(folder / name, folder / name, replaceable)
        made = make_parents(first)
        write_set(folder, contents, lambda path: _check_file(folder / path.name, path, replaceable))
        made = []
    except OSError as error:
        raise output_error(first, error) from error
    finally:
        remove_empty(made)


def replace_file(target: Path, content: bytes) -> None:
    """Write a file whole, in place of an earlier one.

    Raises
    ------
    OutputError
        If a folder has its name, or the disk does not take it; what was there is as it was.
    """

    def check(former: Path) -> None:
        if former.is_dir() and not former.is_symlink():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))

    try:
        write_set(target.parent, {target.name: content}, check)
    except OSError as error:
        raise output_error(target, error) from error


def _check_file(target: Path, path: Path, replaceable: Collection[str] | None) -> None:
    """Raise `OutputError` if what is or was the target may not be replaced."""
    if not os.path.lexists(path):
        return
    if path.is_symlink() or not path.is_file():
        what = "is a link" if path.is_symlink() else "is not a file"
        msg = f"{target}: exists already and {what}; give another name"
        raise OutputError(msg)
    if replaceable is None:
        msg = f"{target}: exists already; give --force to replace it, or another name"
        raise OutputError(msg)
    with open_bytes(path) as stream:
        head = stream.read(4096)
    if head.strip(b"\0") and not any(word.encode() in head for word in replaceable):
        msg = f"{target}: exists already and was not written by elbowscrew; give another name"
        raise OutputError(msg)


def output_error(target: Path, error: OSError) -> OutputError:
    """Say that the disk did not take something, and whether all is as it was."""
    after = " ".join(getattr(error, "__notes__", ())[:1]) or "nothing was left behind"
    return OutputError(f"{target}: cannot be written: {error.strerror or error}; {after}")
