"""Samples by name: synthetic recordings whose truth stands beside them, as they come with the program.

>>> from elbowscrew import samples
>>> samples.path("knee").name
'knee.csv'
"""

from __future__ import annotations

import difflib
import os
from pathlib import Path
from typing import Final

from elbowscrew.errors import OutputError, UsageError, shown
from elbowscrew.results.staging import write_files

SAMPLES: Final[dict[str, str]] = {
    "elbow_paper": "an elbow that flexes, 450 frames with the inversion at 211, as in the paper",
    "elbow_natural": "a right elbow that flexes and pronates about two axes; with landmarks",
    "elbow_left": "a left elbow; with landmarks",
    "elbow_moving_arm_mm": "an elbow whose upper arm moves, in millimeters, with frames that were not tracked",
    "elbow_row_tagged": "an elbow in the row-tagged layout",
    "knee": "a knee",
    "study": "a folder: two trials of each of three subjects, with a manifest",
}
"""What there is, by name."""
_HERE: Final = Path(__file__).parent


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
    found = folder / name
    if name in SAMPLES and not found.is_dir():
        found = folder / f"{name}.csv"
    if not found.resolve().is_relative_to(folder.resolve()) or not found.exists():
        near = difflib.get_close_matches(name, SAMPLES, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(SAMPLES)}"
        msg = f"samples: there is no {shown(name)}; {hint}"
        raise UsageError(msg)
    return found


def copy_to(folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Copy all samples into a folder, which is made.

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
        If one of them is there already, or the disk does not take them.
    """
    target, source = Path(folder), path()
    names = sorted(file.relative_to(source) for file in source.rglob("*") if file.is_file())
    there = [target / name for name in names if os.path.lexists(target / name)]
    if there:
        msg = f"{there[0]}: exists already; give another folder"
        raise OutputError(msg)
    for inside in dict.fromkeys(name.parent for name in names):
        contents = {name.name: (source / name).read_bytes() for name in names if name.parent == inside}
        write_files(target / inside, contents, replaceable=None)
    return tuple(target / name for name in names)
