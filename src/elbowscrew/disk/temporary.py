"""Things half made stand beside their destination, held by the run that makes them; those of dead runs are swept.

A name depends on the destination alone, so that the next run to the same destination finds it without a search. The
lock is the system's and ends with the process. Where there is none (Windows, some network disks), names are random, and
only `sweep` by one who holds the folder removes them.
"""

from __future__ import annotations

import errno
import hashlib
import os
import re
import secrets
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from enum import Enum
from pathlib import Path
from typing import Final

from elbowscrew.disk.syncing import signals_held

PREFIX: Final = ".elbowscrew-"
PARTIAL, REPLACED = ".partial", ".replaced"
PLAN: Final = "plan"
"""A file in a temporary folder that has former files to put back."""
UNSETTLED: Final = "not all that was begun could be undone, so run it again"
"""Note on an error after which something is left, or not as it was."""

_OURS: Final = re.compile(re.escape(PREFIX) + r"[0-9a-f]{16}\.(partial|replaced)")


class Holder(Enum):
    """Whether somebody holds a temporary thing."""

    NOBODY = 0
    ANOTHER = 1
    UNKNOWN = 2
    ABSENT = 3


def is_temporary(name: str) -> bool:
    """Whether a name is that of a temporary thing of ours."""
    return _OURS.fullmatch(name) is not None


def partial_of(folder: Path, key: str) -> Path:
    """Where the next state of what a key stands for is made."""
    return folder / f"{PREFIX}{_token(key)}{PARTIAL}"


def replaced_of(folder: Path, key: str) -> Path:
    """Where the former state steps aside, where two things cannot change places in one step."""
    return folder / f"{PREFIX}{_token(key)}{REPLACED}"


def _token(key: str) -> str:
    return hashlib.sha256(os.fsencode(key)).hexdigest()[:16]


@contextmanager
def held_folder(folder: Path, key: str) -> Iterator[Path]:
    """Make a temporary folder inside another, hold it, and remove what is left of it when the block ends.

    Parameters
    ----------
    folder : Path
    key : str
        What is made: the name of a file or folder, or several names with slashes between them.

    Raises
    ------
    BlockingIOError
        If another run is making the same.
    OSError
        If the disk does not take it.
    """
    staged = partial_of(folder, key)
    handle, known = None, False
    try:
        with signals_held():  # none falls between making a folder and knowing that it is ours to remove
            handle = _made_and_held(staged)
            if handle is None:
                staged = folder / f"{PREFIX}{secrets.token_hex(8)}{PARTIAL}"
                handle = _made_and_held(staged)
            known = True
        yield staged
    except OSError as error:
        if known and not _cleared(staged):
            error.add_note(UNSETTLED)
        raise
    finally:
        if known:
            _cleared(staged)
        if handle is not None and handle >= 0:
            with suppress(OSError):  # nothing was written by it
                os.close(handle)


def _cleared(staged: Path) -> bool:
    """Remove a temporary folder that has nothing to put back, and say whether it is gone."""
    with signals_held():
        if os.path.lexists(staged) and not os.path.lexists(staged / PLAN):
            remove(staged)
        return not os.path.lexists(staged)


def _made_and_held(staged: Path) -> int | None:
    """Make and hold a folder; -1 where there are no locks, None if what is there is nobody's to remove."""
    if os.path.lexists(staged):
        with opened_and_locked(staged) as holder:
            if holder is Holder.ANOTHER:
                msg = "another run is writing there"
                raise BlockingIOError(errno.EAGAIN, msg)
            if holder is Holder.NOBODY and not os.path.lexists(staged / PLAN):
                remove(staged)
        if os.path.lexists(staged):
            return None
    staged.mkdir()
    try:
        handle = os.open(staged, os.O_RDONLY)
    except OSError:
        if os.name != "nt":
            remove(staged)
            raise
        return -1
    if _lock(handle) is Holder.ANOTHER or not os.path.lexists(staged):  # a sweeper was quicker than we
        os.close(handle)
        return None
    return handle


@contextmanager
def opened_and_locked(path: Path) -> Iterator[Holder]:
    """Try to hold a temporary thing for the block, and say who holds it else."""
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    except FileNotFoundError:
        yield Holder.ABSENT
        return
    except OSError:
        yield Holder.UNKNOWN
        return
    try:
        yield _lock(handle)
    finally:
        os.close(handle)


def _lock(handle: int) -> Holder:
    if sys.platform == "win32":
        return Holder.UNKNOWN
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return Holder.ANOTHER
    except OSError:
        return Holder.UNKNOWN
    return Holder.NOBODY


def remove(path: Path) -> None:
    """Remove a file or a folder of ours as far as that goes; a link is not followed."""
    with suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
