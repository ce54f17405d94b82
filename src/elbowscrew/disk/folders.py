"""A folder of files that appears whole, in the place of a former one, or not at all.

A folder that cannot change places, as where something is mounted, stays, and its content is replaced.
"""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Final

from elbowscrew.disk.file_sets import move_in, new_in, new_of, roll_back
from elbowscrew.disk.placing import put, recover
from elbowscrew.disk.syncing import sync, sync_tree
from elbowscrew.disk.temporary import (
    REPLACED,
    Holder,
    held_folder,
    is_temporary,
    opened_and_locked,
    remove,
    replaced_of,
)
from elbowscrew.opening import create, open_bytes

_REFUSED: Final = (errno.EACCES, errno.EPERM, errno.EROFS)
_STAYS: Final = (errno.EBUSY, errno.EXDEV)
"""What the system says of a folder where something is mounted."""


@contextmanager
def new_folder(destination: Path, check: Callable[[Path], None], finish: Callable[[Path], None]) -> Iterator[Path]:
    """Give a temporary folder to write into, and put it in its place when the block ends well.

    Parameters
    ----------
    destination : Path
        Resolved; folders above it are made, and go again if nothing comes of it.
    check : callable
        Told the folder that is there, if one is; raises if it may not be replaced.
    finish : callable
        Told the temporary folder when all is in it.

    Raises
    ------
    OSError
        If the disk does not take it, or another run is making the same folder. What was there is as it was.
    """
    made = make_parents(destination)
    try:
        recover(destination)
        with _room_for(destination) as (staged, inside):
            yield staged
            finish(staged)
            if os.path.lexists(destination):  # somebody may have put something there meanwhile
                check(destination)
            if inside:
                _fill(destination, staged.parent, check)
                return
            sync_tree(staged)
            try:
                put(staged, destination, check)
            except OSError as error:
                if error.errno not in _STAYS:
                    raise
                with held_folder(destination, destination.name) as inner:
                    _copy(staged, new_in(inner))
                    _fill(destination, inner, check)
        made = []
    finally:
        remove_empty(made)


@contextmanager
def _room_for(destination: Path) -> Iterator[tuple[Path, bool]]:
    """Give a temporary folder beside a destination, or inside it if it is there and the one above takes nothing."""
    with ExitStack() as held:
        try:
            staged, inside = held.enter_context(held_folder(destination.parent, destination.name)), False
        except OSError as error:
            if error.errno not in _REFUSED or not destination.is_dir():
                raise
            staged, inside = new_in(held.enter_context(held_folder(destination, destination.name))), True
        yield staged, inside


def _copy(folder: Path, other: Path) -> None:
    """Copy what is in a folder into one that is empty."""
    for path in folder.iterdir():
        target = other / path.name
        if path.is_dir():
            target.mkdir()
            _copy(path, target)
        else:
            with open_bytes(path) as source, create(target) as stream:
                shutil.copyfileobj(source, stream)


def _fill(destination: Path, staged: Path, check: Callable[[Path], None]) -> None:
    """Replace what is in a folder that cannot be replaced itself."""
    new = {path.name for path in new_of(staged).iterdir()}
    there = {path.name for path in destination.iterdir() if not is_temporary(path.name)}
    move_in(staged, sorted(new | there), check)


def straight(path: Path) -> Path:
    """Give a path without ``..``: links are followed as the system does, and no folder is made to leave it again."""
    return path.resolve() if ".." in path.parts else path


def make_parents(destination: Path) -> list[Path]:
    """Make the folders above a destination, to stay, and say which are new, the innermost first.

    Raises
    ------
    OSError
        If the disk does not take them; none is left then.
    """
    missing: list[Path] = []
    for parent in destination.parents:
        if parent.exists():
            break
        missing.append(parent)
    try:
        destination.parent.mkdir(parents=True, exist_ok=True)
        for folder in missing:
            sync(folder.parent)
    except BaseException:
        remove_empty(missing)
        raise
    return missing


def remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders that have nothing in them."""
    for folder in folders:
        with suppress(OSError):
            folder.rmdir()


def sweep(folder: Path, *, held: bool = False) -> None:
    """Undo and remove what runs that were killed have left in a folder: temporary things of ours, nothing else.

    Parameters
    ----------
    folder : Path
    held : bool
        Whether the caller alone writes there, so that things are swept of which the system cannot say who holds them.
    """
    names = [path.name for path in folder.iterdir()]
    ours = [name for name in names if is_temporary(name)]
    kept = {replaced_of(folder, name).name for name in names} if ours else set()
    for name in ours:
        path = folder / name
        if path.is_symlink():
            continue
        with opened_and_locked(path) as holder:
            if holder is Holder.ANOTHER or (holder is Holder.UNKNOWN and not held):
                continue
            if name.endswith(REPLACED) and name not in kept:  # what it was replaced by is not there: it comes back
                continue
            if roll_back(path):
                remove(path)
