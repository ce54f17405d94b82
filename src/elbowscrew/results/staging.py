"""Results appear whole or not at all: written beside their destination and moved there in one step."""

from __future__ import annotations

import json
import os
import re
import secrets
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final, NamedTuple

from elbowscrew.choices import DRAWN_FORMATS
from elbowscrew.errors import OutputError
from elbowscrew.opening import create, open_bytes, read_text
from elbowscrew.results.exporting import EXPORTS
from elbowscrew.tables import TABLES
from elbowscrew.view.figure_names import SAVED_FIGURES

_TABLE_ENDINGS: Final = (".csv", *(export.file for export in EXPORTS.values() if export.file.startswith(".")))
RESULT_FILES: Final = (
    "summary.json",
    "joint.json",
    *(f"{name}{ending}" for name in TABLES for ending in _TABLE_ENDINGS),
    *(export.file for export in EXPORTS.values() if not export.file.startswith(".")),
    "report.html",
    *(f"figures/{name}.{kind}" for name in SAVED_FIGURES for kind in DRAWN_FORMATS),
)
"""All that a result folder may hold."""


class ResultKind(NamedTuple):
    """What a result folder may hold, and the JSON file in it that tells whose it is."""

    files: tuple[str, ...]
    summary: str


ANALYSIS: Final = ResultKind(RESULT_FILES, "summary.json")
COMPARISON: Final = ResultKind(
    ("compare.csv", "compare.json", *(f"figures/compare.{kind}" for kind in DRAWN_FORMATS)), "compare.json"
)

_PREFIX: Final = ".elbowscrew-"
_TEMPORARY: Final = re.compile(re.escape(_PREFIX) + r"[0-9a-f]{16}\.(partial|replaced)")


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
    staged, made = None, []
    try:
        destination = target.resolve()
        made = _make_parents(destination)
        staged = _temporary(destination)
        staged.mkdir()
        yield staged
        check_result_folder(target, force=force, kind=kind)  # somebody may have put something there meanwhile
        _move_into_place(staged, destination, kind)
        made = []
    except OSError as error:
        raise _output_error(target, error) from error
    finally:
        if staged is not None:
            shutil.rmtree(staged, ignore_errors=True)
        _remove_empty(made)


def check_result_folder(target: Path, *, force: bool, kind: ResultKind = ANALYSIS) -> None:
    """Raise `OutputError` if the result may not be put there."""
    try:
        if not os.path.lexists(target):
            return
        if not target.is_dir():
            msg = f"{target}: exists and is not a folder; give another --output"
            raise OutputError(msg)
        if target.resolve() == Path.cwd():
            msg = f"{target}: is the current folder; give --output a folder of its own"
            raise OutputError(msg)
        present = {path.relative_to(target).as_posix() for path in target.rglob("*")} - {"figures"}
        if not present:
            return
        unknown = sorted(present - set(kind.files))
        if unknown or not is_summary(target / kind.summary):
            what = f"holds {unknown[0]!r}, which is not ours" if unknown else "holds files but no elbowscrew result"
            msg = f"{target}: the folder {what}; give another --output"
            raise OutputError(msg)
    except OSError as error:
        raise _output_error(target, error) from error
    if not force:
        msg = f"{target}: there is a result already; give --force to replace it, or another --output"
        raise OutputError(msg)


def is_summary(path: Path) -> bool:
    """Whether a file is the summary of a result."""
    try:
        summary = json.loads(read_text(path))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(summary, dict) and "elbowscrew" in summary


def write_files(contents: Mapping[Path, Iterable[str] | bytes], *, replaceable: str | None) -> None:
    """Write files that belong together: all of them appear, each whole, or none.

    Parameters
    ----------
    contents : mapping of Path to iterable of str, or bytes
        Lines of each file, without line ends, or all of it.
    replaceable : str or None
        None to replace nothing; else an existing file is replaced if its first 4096 bytes hold this word, which tells
        that it is one of ours.

    Raises
    ------
    OutputError
        If a file exists that may not be replaced, or the disk does not take them.
    """
    for target in contents:
        _check_file(target, replaceable)
    staged: dict[Path, Path] = {}
    made: list[Path] = []
    target = next(iter(contents))
    try:
        for target, lines in contents.items():
            destination = _destination(target)
            made += _make_parents(destination)
            staged[target] = _temporary(destination)
            with create(staged[target]) as stream:
                if isinstance(lines, bytes):
                    stream.write(lines)
                else:
                    stream.writelines(f"{line}\n".encode() for line in lines)
        for target, temporary in staged.items():
            _check_file(target, replaceable)
            temporary.replace(_destination(target))
        made = []
    except OSError as error:
        raise _output_error(target, error) from error
    finally:
        for temporary in staged.values():
            temporary.unlink(missing_ok=True)
        _remove_empty(made)


def replace_file(target: Path, content: bytes) -> None:
    """Write a file whole, in place of an earlier one.

    Raises
    ------
    OutputError
        If the disk does not take it; an earlier file is as it was.
    """
    temporary = _temporary(target)
    try:
        with create(temporary) as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(target)
    except OSError as error:
        raise _output_error(target, error) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def remove_leftovers(folder: Path) -> None:
    """Remove what runs that were killed have left in a folder: temporary files and folders of ours, nothing else."""
    for path in folder.iterdir():
        if not _TEMPORARY.fullmatch(path.name) or path.is_symlink():
            continue
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def remove_damaged(target: Path) -> None:
    """Remove a result that a power failure has cut: files of our names only, without a summary that can be read."""
    if not target.is_dir() or target.is_symlink() or is_summary(target / "summary.json"):
        return
    present = {path.relative_to(target).as_posix() for path in target.rglob("*")} - {"figures"}
    if "summary.json" in present and present <= set(RESULT_FILES):
        for name in present:
            (target / name).unlink(missing_ok=True)
        _remove_empty([target / "figures"])


def _check_file(target: Path, replaceable: str | None) -> None:
    try:
        if not os.path.lexists(target):
            return
        if target.is_symlink() or not target.is_file():
            what = "is a link" if target.is_symlink() else "is not a file"
            msg = f"{target}: exists already and {what}; give another name"
            raise OutputError(msg)
        if replaceable is None:
            msg = f"{target}: exists already; give --force to replace it, or another name"
            raise OutputError(msg)
        with open_bytes(target) as stream:
            if replaceable.encode() not in stream.read(4096):
                msg = f"{target}: exists already and was not written by elbowscrew; give another name"
                raise OutputError(msg)
    except OSError as error:
        raise _output_error(target, error) from error


def _destination(target: Path) -> Path:
    """Follow the links that lead to the folder of a file, but never one in the place of the file."""
    return target.parent.resolve() / target.name


def _make_parents(destination: Path) -> list[Path]:
    """Make the folders above a destination, and say which are new, the innermost first."""
    missing = []
    for parent in destination.parents:
        if parent.exists():
            break
        missing.append(parent)
    destination.parent.mkdir(parents=True, exist_ok=True)
    return missing


def _remove_empty(folders: Iterable[Path]) -> None:
    for folder in folders:
        with suppress(OSError):
            folder.rmdir()


def _move_into_place(staged: Path, destination: Path, kind: ResultKind) -> None:
    """Move the staged folder to its destination; an earlier result steps aside, and is removed after or comes back."""
    if not destination.is_dir() or not any(destination.iterdir()):
        if os.name == "nt" and destination.is_dir():
            destination.rmdir()
        staged.rename(destination)  # over an empty folder, never over one that has just been filled
        return
    aside = staged.with_suffix(".replaced")
    destination.rename(aside)
    try:
        staged.rename(destination)
    except BaseException:
        with suppress(OSError):
            aside.rename(destination)
        raise
    for name in kind.files:
        (aside / name).unlink(missing_ok=True)
    _remove_empty([aside / "figures", aside])


def _temporary(destination: Path) -> Path:
    """Name a temporary thing beside a destination, before it is made: so it is removed whenever the run is stopped."""
    return destination.parent / f"{_PREFIX}{secrets.token_hex(8)}.partial"


def _output_error(target: Path, error: OSError) -> OutputError:
    return OutputError(f"{target}: cannot be written: {error.strerror or error}; nothing was left behind")
