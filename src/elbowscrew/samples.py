"""Samples by name: synthetic recordings whose truth stands beside them, as they come with the program.

>>> from elbowscrew import samples
>>> samples.path("knee").name
'knee.csv'
"""

from __future__ import annotations

import filecmp
import os
from pathlib import Path
from typing import Final

from elbowscrew.disk.folders import sweep
from elbowscrew.errors import OutputError, UsageError, did_you_mean, shown
from elbowscrew.results.staging import output_error, write_files

SAMPLES: Final[dict[str, str]] = {
    "elbow_paper": "an elbow that flexes, 450 frames with the inversion at 211, as in the paper",
    "elbow_natural": "a right elbow that flexes and pronates about two axes; with landmarks",
    "elbow_left": "a left elbow; with landmarks",
    "elbow_moving_arm_mm": "an elbow whose upper arm moves, in millimeters, with frames that were not tracked",
    "elbow_row_tagged": "an elbow in the row-tagged layout",
    "knee": "a right knee; with landmarks",
    "study": "a folder: two trials of each of three subjects, with a manifest",
}
"""What there is, by name."""
_HERE: Final = Path(__file__).parent


def names() -> tuple[str, ...]:
    """Names of all samples; `SAMPLES` says what each of them is.

    Examples
    --------
    >>> names()[:2]
    ('elbow_paper', 'elbow_natural')
    """
    return tuple(SAMPLES)


def path(name: str = "") -> Path:
    """Give the file of a sample, or its folder.

    Parameters
    ----------
    name : str
        One of `SAMPLES`, or of a file that belongs to it, as ``elbow_left.landmarks.toml``; without one, the folder of
        all.

    Returns
    -------
    Path

    Raises
    ------
    UsageError
        If there is no such sample.

    Examples
    --------
    >>> path("elbow_left.landmarks.toml").exists()
    True
    """
    inside = _HERE / "sample_data"
    folder = inside if inside.is_dir() else _HERE.parent.parent / "sample_data"
    try:
        found = folder / name
        if name in SAMPLES and not found.is_dir():
            found = folder / f"{name}.csv"
        is_there = found.resolve().is_relative_to(folder.resolve()) and found.exists()
    except (TypeError, ValueError):  # no name at all, or one that no file can have
        is_there = False
    if not is_there:
        hint = did_you_mean(name, tuple(SAMPLES)) or f"; there are {', '.join(SAMPLES)}"
        msg = f"samples: there is no {shown(name)}{hint}"
        raise UsageError(msg)
    return found


def copy_to(folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Copy all samples into a folder, which is made; those that are there already are left as they are.

    Parameters
    ----------
    folder : path-like

    Returns
    -------
    tuple of Path
        The files.

    Raises
    ------
    OutputError
        If there is something else of the name of one of them, or the disk does not take them.
    """
    target, source = Path(folder), path()
    names = sorted(file.relative_to(source) for file in source.rglob("*") if file.is_file())
    for inside in {name.parent for name in names}:
        _finish_or_undo(target / inside)
    missing = [name for name in names if not _is_copied(source / name, target / name)]
    for inside in dict.fromkeys(name.parent for name in missing):
        contents = {name.name: (source / name).read_bytes() for name in missing if name.parent == inside}
        write_files(target / inside, contents, replaceable=None)
    return tuple(target / name for name in names)


def _finish_or_undo(folder: Path) -> None:
    """Clear away what an interrupted copy left."""
    try:
        if folder.is_dir():
            sweep(folder)
    except OSError as error:
        raise output_error(folder, error) from error


def _is_copied(sample: Path, copied: Path) -> bool:
    """Whether a copy is there; what else is there is the user's own."""
    if not os.path.lexists(copied):
        return False
    try:
        same = copied.is_file() and not copied.is_symlink() and filecmp.cmp(sample, copied, shallow=False)
    except OSError:
        same = False
    if not same:
        msg = f"{copied}: exists already; give another folder"
        raise OutputError(msg)
    return True
