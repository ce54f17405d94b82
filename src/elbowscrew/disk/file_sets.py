"""Files of one folder that belong together: all of them are the former ones, or all the new ones.

One file is put in its place in one step. Several are written into a temporary folder with a plan beside them; then the
former ones step aside into it, and then the new ones take their places: so a new one never stands beside a former one,
and whoever finds the plan of a run that died puts the former ones back.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from elbowscrew.disk.placing import put
from elbowscrew.disk.syncing import signals_held, sync, sync_tree
from elbowscrew.disk.temporary import PLAN, held_folder
from elbowscrew.opening import create, open_bytes, sha256_of, write_new


def write_set(folder: Path, contents: Mapping[str, bytes | Iterable[str]], check: Callable[[Path], None]) -> None:
    """Write files into a folder: all of them appear, each whole, or none.

    Parameters
    ----------
    folder : Path
    contents : mapping of str to bytes, or iterable of str
        By names; all of a file, or its lines without line ends.
    check : callable
        Told each file that is there; raises if it may not be replaced.

    Raises
    ------
    OSError
        If the disk does not take them, or another run is writing them. What was there is as it was.
    """
    names = tuple(contents)
    with held_folder(folder, "/".join(names)) as staged:
        plan = {name: _write(_new(staged, k), contents[name]) for k, name in enumerate(names)}
        if len(names) == 1:
            sync(_new(staged, 0))
            put(_new(staged, 0), folder / names[0], check)
            return
        with signals_held():
            try:
                write_new(staged / PLAN, json.dumps(plan).encode())
                sync_tree(staged)
                sync(folder)
                _move(staged, folder, names, check)
            except BaseException:
                with suppress(OSError):  # the next run has the plan
                    roll_back(staged)
                raise


def roll_back(staged: Path) -> bool:
    """Put former files back as the plan in a temporary folder says; a folder without a plan has none.

    Returns
    -------
    bool
        Whether nothing but what is half made is left in the folder. False where a former file cannot go back, as
        somebody has put another one in its place.

    Raises
    ------
    OSError
        If the disk does not take it.
    """
    plan = _plan_of(staged)
    for k, (name, digest) in enumerate(plan.items()):
        target = staged.parent / name
        moved = os.path.lexists(_former(staged, k)) or not os.path.lexists(_new(staged, k))
        if moved and _digest(target) == digest:
            target.unlink()
    stranded = False
    for k, name in enumerate(plan):
        former, target = _former(staged, k), staged.parent / name
        if os.path.lexists(former):
            if not os.path.lexists(target):
                former.rename(target)
            elif _digest(target) != _digest(former):
                stranded = True
    if plan and not stranded:
        sync(staged.parent)
        (staged / PLAN).unlink()
    return not stranded


def _move(staged: Path, folder: Path, names: Sequence[str], check: Callable[[Path], None]) -> None:
    for k, name in enumerate(names):
        target = folder / name
        if os.path.lexists(target):
            check(target)
            target.rename(_former(staged, k))
    sync(staged)
    sync(folder)
    for k, name in enumerate(names):
        if os.path.lexists(folder / name):  # somebody has just put something there
            check(folder / name)
        _new(staged, k).replace(folder / name)
    sync(folder)
    (staged / PLAN).unlink()  # from here on there is nothing to undo
    sync(staged)


def _plan_of(staged: Path) -> dict[str, str]:
    try:
        with open_bytes(staged / PLAN) as stream:
            plan = json.load(stream)
    except (OSError, ValueError):
        return {}
    names = isinstance(plan, dict) and all(isinstance(name, str) and Path(name).name == name for name in plan)
    return plan if names else {}


def _digest(path: Path) -> str | None:
    """SHA-256 of a file; None if it is not there, or is no regular file."""
    if path.is_symlink() or not path.is_file():
        return None
    return sha256_of(path)


def _write(path: Path, content: bytes | Iterable[str]) -> str:
    """Write a file and give its SHA-256."""
    digest = hashlib.sha256()
    with create(path) as stream:
        for part in (content,) if isinstance(content, bytes) else (f"{line}\n".encode() for line in content):
            digest.update(part)
            stream.write(part)
    return digest.hexdigest()


def _new(staged: Path, number: int) -> Path:
    return staged / f"{number}.new"


def _former(staged: Path, number: int) -> Path:
    return staged / f"{number}.former"
