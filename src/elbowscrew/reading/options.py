"""What the caller knows of a file that the file does not tell, and what is wanted of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elbowscrew.errors import RecordingError, SettingError
from elbowscrew.model import marker_matches
from elbowscrew.quantities import METERS

_UNIT_NAMES: Final = {"meters": "m", "centimeters": "cm", "millimeters": "mm"}

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
    markers : tuple of str
        Names or patterns of the markers wanted; the others are not read.
    """

    units: str | None = None
    rotation: str | None = None
    markers: tuple[str, ...] = ()

    def wants(self, marker: str) -> bool:
        """Whether a marker is among those wanted."""
        return marker_matches(marker, self.markers)


def stated_unit(path: Path, stated: str, options: ReadOptions) -> str:
    """Unit of length of a file, "m", "cm" or "mm": the one it states, or the one given if it states none.

    Raises
    ------
    RecordingError
        If it states one that is not known.
    SettingError
        If neither is there, or both and they differ.
    """
    text = stated.strip().casefold()
    unit = _UNIT_NAMES.get(text, text)
    if unit and unit not in METERS:
        msg = f"{path}: unit of length: expected {', '.join(METERS)}, found {stated!r}; export the take again"
        raise RecordingError(msg)
    if unit and options.units not in (None, unit):
        msg = f"--units {options.units}: the file states {stated} itself, which contradicts it; leave --units out"
        raise SettingError(msg)
    if not unit and options.units is None:
        msg = f"{path}: the file does not state its unit of length; give --units m, cm or mm"
        raise SettingError(msg)
    return unit or str(options.units)
