"""What belongs together in one folder: all of it is the former state, or all of it the new one.

One file is put in its place in one step. Several are written into a temporary folder with a plan beside them; then the
former ones step aside into it, and then the new ones take their places: so a new one never stands beside a former one,
and whoever finds the plan of a run that died puts the former ones back.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Final, NamedTuple

from elbowscrew.disk.placing import put
from elbowscrew.disk.syncing import signals_held, sync, sync_tree
from elbowscrew.disk.temporary import PLAN, UNSETTLED, held_folder, remove
from elbowscrew.opening import create, open_bytes, sha256_of, write_new

_NEW: Final = "new"
_FORMER: Final = "former"


def write_set(folder: Path, contents: Mapping[str, bytes | Iterable[str]], check: Callable[[Path], None]) -> None:
    """Write files into a folder: all of them appear, each whole, or none.

    Parameters
    ----------
    folder : Path
    contents : mapping of str to bytes, or iterable of str
        By names; all of a file, or its lines without line ends.
    check : callable
        Told each file that is or was there; raises if it may not be replaced.

    Raises
    ------
    OSError
        If the disk does not take them, or another run is writing them. What was there is as it was.
    """
    names = tuple(contents)

    def check_all(former: Path) -> None:
        for path in former.iterdir():
            check(path)

    with held_folder(folder, "/".join(names)) as staged:
        new = new_in(staged)
        for name in names:
            _write(new / name, contents[name])
        if len(names) == 1:
            sync(new / names[0])
            put(new / names[0], folder / names[0], check)
        else:
            move_in(staged, names, check_all)


def new_of(staged: Path) -> Path:
    """Where in a temporary folder that is which `move_in` moves out of it."""
    return staged / _NEW


def new_in(staged: Path) -> Path:
    """Make `new_of` a temporary folder."""
    new_of(staged).mkdir()
    return new_of(staged)


def move_in(staged: Path, names: Iterable[str], check: Callable[[Path], None]) -> None:
    """Let files and folders step aside, and new ones take their places: all of them, or none.

    Parameters
    ----------
    staged : Path
        Temporary folder inside the one they are for; what is new is in `new_in`.
    names : iterable of str
        Of what is new, and of what else is to go.
    check : callable
        Told the folder of what has stepped aside, so that nobody can add to it; raises if it may not go.

    Raises
    ------
    OSError
        If the disk does not take it. What was there is as it was.
    """
    folder, new, former = staged.parent, new_of(staged), staged / _FORMER
    names = tuple(names)
    with signals_held():
        try:
            former.mkdir()
            there = [name for name in names if os.path.lexists(folder / name)]
            plan = _Plan({name: _digest(new / name) for name in names}, there)
            write_new(staged / PLAN, json.dumps(plan._asdict()).encode())
            sync_tree(staged)
            sync(folder)
            for name in there:
                (folder / name).rename(former / name)
            check(former)
            sync(former)
            sync(folder)
            for name in names:
                if os.path.lexists(folder / name):
                    raise FileExistsError(errno.EEXIST, f"somebody has just made {name}")
                if os.path.lexists(new / name):
                    (new / name).rename(folder / name)
            sync(folder)
            (staged / PLAN).unlink()
        except BaseException:
            with suppress(OSError):  # the next run has the plan
                roll_back(staged)
            raise
        try:
            sync(staged)
        except OSError as error:  # there is nothing to undo it by
            error.add_note(UNSETTLED)
            raise


def roll_back(staged: Path) -> bool:
    """Put former files and folders back as the plan in a temporary folder says; one without a plan has none.

    May be cut and done again at any moment: what is back is known by having left its place in the temporary folder,
    never by its content, which may be that of the new one.

    Returns
    -------
    bool
        Whether nothing but what is half made is left in the folder. False where what was there cannot go back, as
        somebody has put something else in its place.

    Raises
    ------
    OSError
        If the disk does not take it.
    """
    new, former = new_of(staged), staged / _FORMER
    if not os.path.lexists(staged / PLAN):
        return True
    plan = _plan_of(staged)
    if plan is None:
        return not (former.is_dir() and any(former.iterdir()))
    for name, digest in plan.new.items():
        target = staged.parent / name
        stepped = name not in plan.former or os.path.lexists(former / name)
        if stepped and digest is not None and _digest(target) == digest:
            remove(new / name)
            target.rename(new / name)
    stranded = False
    for name in plan.former:
        target = staged.parent / name
        if os.path.lexists(former / name):
            if not os.path.lexists(target):
                (former / name).rename(target)
            elif _digest(target) != _digest(former / name):
                stranded = True
    if not stranded:
        sync(staged.parent)
        (staged / PLAN).unlink()
    return not stranded


class _Plan(NamedTuple):
    """What is to be where: digests of what is new by names, None for what only goes, and names of what was there."""

    new: Mapping[str, str | None]
    former: Iterable[str]


def _plan_of(staged: Path) -> _Plan | None:
    """Read the plan in a temporary folder; None if it is none, or would lead out of the folder."""
    try:
        with open_bytes(staged / PLAN) as stream:
            told = json.load(stream)
        plan = _Plan(dict(told["new"]), list(told["former"]))
    except (OSError, ValueError, TypeError, LookupError, RecursionError):
        return None
    inside = all(isinstance(name, str) and Path(name).name == name for name in (*plan.new, *plan.former))
    return plan if inside else None


def _digest(path: Path) -> str | None:
    """SHA-256 of a file, or of all files in a folder and their names; None if it is not there, or is anything else."""
    if path.is_symlink():
        return None
    if path.is_dir():
        inner = sorted(path.iterdir())
        return hashlib.sha256(repr([(one.name, _digest(one)) for one in inner]).encode("utf-8", "replace")).hexdigest()
    if not path.is_file():
        return None
    return sha256_of(path)


def _write(path: Path, content: bytes | Iterable[str]) -> None:
    with create(path) as stream:
        for part in (content,) if isinstance(content, bytes) else (f"{line}\n".encode() for line in content):
            stream.write(part)
