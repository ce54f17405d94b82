"""What the caller knows of a file that the file does not tell, and what is wanted of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elbowscrew.column_file import ColumnFile
from elbowscrew.errors import (
    ElbowscrewError,
    Missing,
    MissingStatementError,
    NoBodiesError,
    SettingError,
    did_you_mean,
    told_names,
)
from elbowscrew.model import marker_matches
from elbowscrew.quantities import METERS

_UNIT_NAMES: Final = {
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("centimeter", "centimeters", "centimetre", "centimetres"), "cm"),
    **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
}
# Some systems keep only so many characters of the unit's name.
_SHORTEST_CUT: Final = 4


ASK_FOR_UNITS: Final = "--units m, cm or mm"
ASK_FOR_MARKERS: Final = "give --proximal-markers and --distal-markers"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadOptions:
    """How a file is read.

    Attributes
    ----------
    units : str or None
        Unit of length of a file that states none.
    rotation : str or None
        Rotation type of a file that states none.
    rate_hz : float or None
        Frames a second of a file that has no times.
    markers : tuple of str
        Names or patterns of the markers wanted; the others are not read.
    bones : tuple of str
        Names or patterns of the bones of a skeleton that are wanted as bodies; the others are not read.
    columns : ColumnFile or None
        What somebody says of the columns of a table.
    alone : bool
        Whether the file is all of the recording; else the other body of the joint stands in another.
    """

    units: str | None = None
    rotation: str | None = None
    rate_hz: float | None = None
    markers: tuple[str, ...] = ()
    bones: tuple[str, ...] = ()
    columns: ColumnFile | None = None
    alone: bool = True

    def wants(self, marker: str) -> bool:
        """Whether a marker is among those wanted."""
        return marker_matches(marker, self.markers)

    def wants_bone(self, bone: str) -> bool:
        """Whether a bone is among those wanted."""
        return marker_matches(bone, self.bones)


def stated_unit(path: Path, stated: str, options: ReadOptions) -> str:
    """Unit of length of a file, "m", "cm" or "mm": the one it states, or the one given if it states none that is known.

    Raises
    ------
    SettingError
        If there is neither one that is known nor one given, or both and they differ.
    """
    unit = _known_unit(stated)
    if unit is not None and options.units not in (None, unit):
        msg = (
            f"--units {options.units}: the file states {stated.strip()} itself, which contradicts it; leave --units out"
        )
        raise SettingError(msg)
    if unit is None and options.units is None:
        what = (
            f"states its unit of length as {stated[:40]!r}, which is not known"
            if stated.strip()
            else ("does not state its unit of length")
        )
        raise MissingStatementError.of(path, Missing("units", what, ASK_FOR_UNITS))
    return unit or str(options.units)


def _known_unit(stated: str) -> str | None:
    text = stated.strip(" \t\0.").casefold()
    if text in METERS:
        return text
    cut = len(text) >= _SHORTEST_CUT
    found = {unit for name, unit in _UNIT_NAMES.items() if name == text or (cut and name.startswith(text))}
    return found.pop() if len(found) == 1 else None


def check_patterns(path: Path, patterns: Sequence[str], names: Sequence[str]) -> None:
    """Check that each name or pattern of markers fits one of these names.

    Raises
    ------
    SettingError
        If one does not; it tells the names.
    """
    for pattern in patterns:
        # Markers of one name have their id behind it.
        if not any(marker_matches(one, [pattern, f"{pattern} (*)"]) for one in names):
            told = told_names(names)
            msg = f"{path}: no marker fits {pattern}{did_you_mean(pattern, names)}; the file has {told or 'no markers'}"
            raise SettingError(msg)


def nothing_wanted(path: Path, what: str, names: Sequence[str], options: ReadOptions) -> ElbowscrewError:
    """Say that a file has no rigid bodies and no marker that was asked for, whose names these are.

    Parameters
    ----------
    path : Path
    what : str
        What was not found, as in "no rigid bodies in the file".
    names : sequence of str
        The markers that are there.
    options : ReadOptions

    Returns
    -------
    SettingError or NoBodiesError
        The former if others were asked for.
    """
    told = told_names(names)
    if options.markers and names:
        mean = did_you_mean(options.markers[0], names)
        return SettingError(
            f"{path}: no marker fits {', '.join(options.markers)}{mean}; the file has {told or 'no markers'}"
        )
    return NoBodiesError(f"{path}: {what} (markers: {told or 'none'}); {ASK_FOR_MARKERS}")
