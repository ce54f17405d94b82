"""What the caller knows of a file that the file does not tell, and what is wanted of it."""

from __future__ import annotations

from dataclasses import dataclass

from elbowscrew.model import marker_matches


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
