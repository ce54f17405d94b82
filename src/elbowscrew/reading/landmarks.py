"""Landmarks from a TOML file: markers' names, or coordinates in millimeters."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final, get_args

import numpy as np

from elbowscrew.errors import UsageError, shown, unreadable
from elbowscrew.joints import joints_of
from elbowscrew.model.anatomy import LANDMARKS, LANDMARKS_OF, BonyJoint, Landmark, LandmarkFrame, Landmarks, Side
from elbowscrew.opening import read_toml

_FARTHEST_MM: Final = 10_000.0
_SIDES: Final = get_args(Side)


def _frames(joint: BonyJoint) -> dict[str, LandmarkFrame]:
    """Words of the file for the frames, the joint's own."""
    own = joints_of(joint)[0]
    return {own.proximal.short: "proximal", own.distal.short: "distal", "lab": "lab"}


def read_landmarks(path: str | os.PathLike[str]) -> Landmarks:
    """Read the landmarks of an elbow or a knee; ``docs/explanation/anatomy.md`` says how the file looks.

    Parameters
    ----------
    path : path-like
        A TOML file.

    Returns
    -------
    Landmarks

    Raises
    ------
    UsageError
        If the file cannot be read, or does not say all that is needed; all its faults are named together.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> text = 'side = "left"' + chr(10) + "[landmarks]" + chr(10)
    >>> text += chr(10).join(f'{name} = "marker {name}"' for name in ("EL", "EM", "US", "RS", "GH"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "arm.toml")
    ...     _ = path.write_text(text)
    ...     read_landmarks(path).markers
    ('marker EL', 'marker EM', 'marker US', 'marker RS', 'marker GH')
    """
    file = Path(path)
    table = _read_toml(file)
    faults = _unknown(table, ("side", "landmarks"), "key")
    if "side" not in table:
        faults.append('side is missing: write side = "right" or side = "left" at the top')
    elif table["side"] not in _SIDES:
        faults.append(f"side: expected {_either(_SIDES)}, found {shown(table['side'])}")
    given = table.get("landmarks", {})
    if not isinstance(given, dict):
        faults.append(f"landmarks: expected a table, [landmarks] on a line of its own, found {shown(given)}")
        given = {}
    joint = _joint_of(given)
    faults += _unknown(given, LANDMARKS_OF[joint], "landmark")
    missing = [f"{name} ({LANDMARKS[name]})" for name in LANDMARKS_OF[joint] if name not in given]
    if missing:
        other = "" if given else f" (of a knee: {', '.join(LANDMARKS_OF['knee'])})"
        faults.append(f"missing in [landmarks]: {', '.join(missing)}{other}; give each {_expected(joint)}")
    found = {name: _landmark(name, given[name], joint, faults) for name in LANDMARKS_OF[joint] if name in given}
    if faults:
        msg = f"{file}: {'; '.join(faults)}"
        raise UsageError(msg)
    return Landmarks(side=table["side"], source=str(file), **{name: mark for name, mark in found.items() if mark})


def _read_toml(file: Path) -> dict[str, Any]:
    try:
        return read_toml(file)
    except OSError as error:
        raise unreadable(file, "a file of landmarks", error) from error
    except ValueError as error:
        msg = f"{file}: not TOML: {error}. Write one `key = value` a line, text in quotes"
        raise UsageError(msg) from error


def _joint_of(given: Mapping[str, Any]) -> BonyJoint:
    """Tell the joint that most of these landmarks are of; of none, an elbow."""
    return max(LANDMARKS_OF, key=lambda joint: len(set(given) & set(LANDMARKS_OF[joint])))


def _expected(joint: BonyJoint) -> str:
    return f'a marker\'s name, a list of names, or {{ body = "{next(iter(_frames(joint)))}", mm = [x, y, z] }}'


def _landmark(name: str, value: object, joint: BonyJoint, faults: list[str]) -> Landmark | None:
    """Build one landmark; what is wrong with it is added to the faults."""
    before = len(faults)
    location = f"landmarks.{name}"
    if isinstance(value, dict):
        faults += [f"{location}: {fault}" for fault in _coordinate_faults(value, _frames(joint))]
        if len(faults) > before:
            return None
        return Landmark(point=np.array(value["mm"], dtype=np.float64) / 1000.0, frame=_frames(joint)[value["body"]])
    given = value if isinstance(value, list) else [value]
    markers = tuple(marker for marker in given if isinstance(marker, str) and marker.strip())
    if not markers or len(markers) < len(given):
        faults.append(f"{location}: expected {_expected(joint)}, found {shown(value)}")
        return None
    return Landmark(markers=markers)


def _coordinate_faults(table: Mapping[str, Any], frames: Mapping[str, LandmarkFrame]) -> list[str]:
    faults = _unknown(table, ("body", "mm"), "key")
    body, mm = table.get("body"), table.get("mm")
    if not isinstance(body, str) or body not in frames:
        faults.append(f"body: expected {_either(tuple(frames))}, found {_found(table, 'body')}")
    if not isinstance(mm, list) or len(mm) != 3 or any(type(x) not in (int, float) for x in mm):
        faults.append(f"mm: expected three numbers, [x, y, z], found {_found(table, 'mm')}")
    elif not all(abs(x) <= _FARTHEST_MM for x in mm):
        faults.append(f"mm: expected numbers within {_FARTHEST_MM / 1000:g} m of the origin, found {shown(mm)}")
    return faults


def _found(table: Mapping[str, Any], key: str) -> str:
    return shown(table[key]) if key in table else "none"


def _unknown(table: Mapping[str, Any], known: Iterable[str], what: str) -> list[str]:
    names = list(known)
    folded = {name.casefold(): name for name in names}
    faults = []
    for key in table:
        if key not in names:
            close = difflib.get_close_matches(key.casefold(), folded, n=1)
            hint = f"did you mean {folded[close[0]]!r}?" if close else f"possible: {', '.join(names)}"
            faults.append(f"unknown {what} {shown(key)}; {hint}")
    return faults


def _either(words: tuple[str, ...]) -> str:
    return f"{', '.join(map(repr, words[:-1]))} or {words[-1]!r}"
