"""A folder of files that appears whole, in the place of a former one, or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from elbowscrew.disk.file_sets import roll_back
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
        with held_folder(destination.parent, destination.name) as staged:
            yield staged
            finish(staged)
            if os.path.lexists(destination):  # somebody may have put something there meanwhile
                check(destination)
            sync_tree(staged)
            put(staged, destination, check)
        made = []
    finally:
        remove_empty(made)


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
