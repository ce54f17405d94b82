"""One step from the former state of a file or folder to the next."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from elbowscrew.disk.syncing import exchange, signals_held, sync
from elbowscrew.disk.temporary import (
    UNSETTLED,
    Holder,
    opened_and_locked,
    partial_of,
    remove,
    replaced_of,
)


def put(staged: Path, destination: Path, check: Callable[[Path], None]) -> None:
    """Put what is staged, and has been synced, in its place, and sync that; then the former state goes.

    At every moment the destination is the former state or the next one, whole; only where two things cannot change
    places in one step, a folder is missing for a moment, and `recover` puts it back if the run dies at that moment.

    Parameters
    ----------
    staged, destination : Path
        Two files, or two folders, on the same file system.
    check : callable
        Told the former state when it has left its place, so that nobody can add to it; raises if it may not go.

    Raises
    ------
    OSError
        If the disk does not take it; the former state is as it was.
    """
    with signals_held():
        former, back = _swap(staged, destination)
        try:
            if former is not None:
                check(former)
            sync(destination.parent)
        except BaseException as error:
            undone = False
            with suppress(OSError):
                undone = back()
            if not undone:
                error.add_note(UNSETTLED)
            raise
        if former is not None:
            remove(former)


def _swap(staged: Path, destination: Path) -> tuple[Path | None, Callable[[], bool]]:
    """Swap in as few steps as can be; give where the former state is, if there still is one, and what can undo it."""
    if not os.path.lexists(destination):
        staged.rename(destination)
        return None, lambda: _moved(destination, staged)
    if exchange(staged, destination):
        return staged, lambda: exchange(staged, destination)
    if not destination.is_dir():
        staged.replace(destination)
        return None, lambda: False
    aside = replaced_of(destination.parent, destination.name)
    destination.rename(aside)
    try:
        staged.rename(destination)
    except BaseException as error:
        if not _moved(aside, destination):
            error.add_note(UNSETTLED)
        raise
    return aside, lambda: _moved(destination, staged) and _moved(aside, destination)


def _moved(one: Path, other: Path) -> bool:
    with suppress(OSError):
        one.rename(other)
        return True
    return False


def recover(destination: Path) -> None:
    """Put back the former state of a folder that a killed run has moved aside, and sweep what else it has left.

    Does nothing while another run is making the same destination.
    """
    partial, aside = partial_of(destination.parent, destination.name), replaced_of(destination.parent, destination.name)
    with opened_and_locked(partial) as holder:
        if holder in (Holder.ANOTHER, Holder.UNKNOWN):
            return
        if os.path.lexists(aside):
            if os.path.lexists(destination):
                remove(aside)
            else:
                aside.rename(destination)
                sync(destination.parent)
        if holder is Holder.NOBODY:
            remove(partial)
