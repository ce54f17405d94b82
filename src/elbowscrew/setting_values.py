"""How a single setting's value is taken and checked, where its type does not say all of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from pydantic import ValidationInfo

from elbowscrew import plug_ins
from elbowscrew.choices import EXPORT_NAMES, FRAMES, LAW_NAMES, STATED_JOINTS
from elbowscrew.errors import asked_back, shown


def frame(value: object) -> object:
    """Take the three frames, and segments' words; which end a word means is known with the joint."""
    from elbowscrew.joints import ends_called

    if not isinstance(value, str) or not (value in FRAMES or ends_called(value)):
        msg = f"expected {', '.join(FRAMES)}, or a segment's word, as forearm or shank, found {shown(value)}"
        raise ValueError(msg)
    return value


def joint_type(value: object) -> object:
    """Take the types with a hyphen, too."""
    name = value.replace("-", "_") if isinstance(value, str) else value
    if name not in ("auto", *STATED_JOINTS):
        mean = asked_back(value, STATED_JOINTS)
        msg = f"expected auto, {', '.join(STATED_JOINTS)}, found {shown(value)}{mean}"
        raise ValueError(msg)
    return name


BY_OPTIONS: Final = "by options"
"""The context of settings that are given by the names of their options, and told so."""
READ_BACK: Final = "read back"
"""The context of settings that a finished result tells of: it was made where its plug-ins were installed."""


def law(value: object, info: ValidationInfo) -> object:
    """Take our laws' names, and those of plug-ins, which are looked for where a name is none of ours."""
    if value is not None:
        _check_known(value, LAW_NAMES, plug_ins.LAWS, info)
    return value


def exports(value: object, info: ValidationInfo) -> object:
    """Take the names of our exports, and those of plug-ins."""
    for one in value if isinstance(value, Sequence) and not isinstance(value, str) else ():
        _check_known(one, EXPORT_NAMES, plug_ins.EXPORTERS, info)
    return value


def _check_known(value: object, ours: Sequence[str], group: str, info: ValidationInfo) -> None:
    """Raise `ValueError` if a name is neither one of ours nor that of a plug-in."""
    if value in ours or (isinstance(value, str) and (info.context == READ_BACK or value in plug_ins.names(group))):
        return
    known = (*ours, *plug_ins.names(group))
    msg = f"expected {', '.join(known)}, found {shown(value)}{asked_back(value, known)}"
    raise ValueError(msg)


def cutoff(value: object) -> object:
    """Take ``none`` for no filter, and numbers as text, as the command line gives them."""
    if value == "none":
        return None
    if isinstance(value, str) and value != "auto":
        try:
            value = float(value)
        except ValueError as error:
            msg = f"expected a cut-off in hertz, auto or none, found {shown(value)}"
            raise ValueError(msg) from error
    if isinstance(value, int | float) and not 0.0 < value < math.inf:
        msg = f"expected a cut-off above 0 Hz, found {shown(value)}"
        raise ValueError(msg)
    return value


def skin_motion(value: tuple[float, ...] | None) -> tuple[float, ...] | None:
    """Check millimeters, and degrees if any."""
    if value is not None and not all(0.0 <= part <= 90.0 for part in value):
        msg = f"expected millimeters, and degrees if any, from 0 to 90, found {', '.join(f'{x:g}' for x in value)}"
        raise ValueError(msg)
    return value


def read_where_named(read: Callable[[Path], object]) -> Callable[[object], object]:
    """Take the name of a file for what it holds, too."""

    def taken(value: object) -> object:
        return read(Path(value)) if isinstance(value, str | Path) else value

    return taken
