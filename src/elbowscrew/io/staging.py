"""Results appear whole or not at all: written beside their place and moved there in one step."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from elbowscrew.errors import OutputError

RESULT_FILES: Final = ("screw.csv", "interpolation.csv", "summary.json", "report.html", "figures")
"""All that a result folder holds at its top level."""


@contextmanager
def result_folder(target: Path, *, force: bool) -> Iterator[Path]:
    """Give a temporary folder to write into, and make it the target when the block ends well.

    Parameters
    ----------
    target : Path
        The result folder. An empty folder is taken over; its parents are made.
    force : bool
        Replace an earlier result, but never a folder that holds anything else.

    Raises
    ------
    OutputError
        If the target exists, or the disk does not take the result. Nothing is left behind then, and an earlier
        result is as it was.
    """
    check_result_folder(target, force=force)
    staged = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        staged = Path(tempfile.mkdtemp(prefix=f".{target.name[:100]}.", suffix=".partial", dir=target.parent))
        staged.chmod(0o777 & ~_umask())
        yield staged
        _swap(staged, target)
    except OSError as error:
        raise _output_error(target, error) from error
    finally:
        if staged is not None:
            shutil.rmtree(staged, ignore_errors=True)


def check_result_folder(target: Path, *, force: bool) -> None:
    """Raise `OutputError` if the result may not be put there."""
    try:
        if not os.path.lexists(target):
            return
        if not target.is_dir():
            msg = f"{target}: exists and is no folder; give another --output"
            raise OutputError(msg)
        present = {entry.name for entry in target.iterdir()}
    except OSError as error:
        raise _output_error(target, error) from error
    if not present:
        return
    strangers = sorted(present - set(RESULT_FILES))
    if strangers or "summary.json" not in present:
        what = f"holds {strangers[0]!r}, which is not ours" if strangers else "holds files but no elbowscrew result"
        msg = f"{target}: the folder {what}; give another --output"
        raise OutputError(msg)
    if not force:
        msg = f"{target}: a result is there already; give --force to replace it, or another --output"
        raise OutputError(msg)


def write_file(target: Path, lines: Iterable[str], *, force: bool) -> None:
    """Write lines to a file that appears whole or not at all.

    Raises
    ------
    OutputError
        If the file exists and `force` is false, or the disk does not take it.
    """
    check_file(target, force=force)
    staged = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{target.name[:100]}.", suffix=".partial", dir=target.parent)
        staged = Path(name)
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as stream:
            stream.writelines(line + "\n" for line in lines)
        staged.chmod(0o666 & ~_umask())
        staged.replace(target)
    except OSError as error:
        raise _output_error(target, error) from error
    finally:
        if staged is not None:
            staged.unlink(missing_ok=True)


def check_file(target: Path, *, force: bool) -> None:
    """Raise `OutputError` if the file may not be put there."""
    if os.path.lexists(target) and not (force and target.is_file()):
        remedy = "give --force to replace it, or another name" if target.is_file() else "it is no file"
        msg = f"{target}: exists already; {remedy}"
        raise OutputError(msg)


def _swap(staged: Path, target: Path) -> None:
    """Move the staged folder into place; an earlier result steps aside and is removed after, or comes back."""
    if not target.is_dir():
        staged.rename(target)
        return
    aside = staged.with_suffix(".replaced")
    target.rename(aside)
    try:
        staged.rename(target)
    except BaseException:
        with suppress(OSError):
            aside.rename(target)
        raise
    shutil.rmtree(aside, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _output_error(target: Path, error: OSError) -> OutputError:
    return OutputError(f"{target}: cannot be written: {error.strerror or error}; nothing was left behind")
