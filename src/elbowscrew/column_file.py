"""The file of ``--columns``: which columns of a table are the clock, the bodies and the markers.

A column is meant by its name in the table's header, or as ``"#3"`` by its place, counted from 1.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, StrictBool, ValidationError, model_validator

from elbowscrew.choices import FileUnit
from elbowscrew.errors import shown, unreadable
from elbowscrew.opening import read_toml_and_digest

SECONDS: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""What a time is in seconds, by its unit."""

_ORDERS: Final = tuple(
    f"{first}{second}{third}" for first, second, third in product("XYZ", repeat=3) if first != second != third
)
_SEQUENCES: Final = (*_ORDERS, *map(str.lower, _ORDERS))

Three = tuple[str, str, str]
Four = tuple[str, str, str, str]


class _Part(BaseModel):
    """A table of the file."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)


class Layout(_Part):
    """How the lines of the table lie, where that does not show.

    Attributes
    ----------
    header, first_row : int or None
        Lines of the names and of the first numbers, counted from 1: by default the first line that has all names, and
        the one below it; line 1 where columns are meant by their places alone.
    """

    header: int | None = Field(default=None, ge=1, le=100_000)
    first_row: int | None = Field(default=None, ge=1, le=100_000)

    @model_validator(mode="after")
    def _check(self) -> Layout:
        if self.header is not None and self.first_row is not None and self.first_row <= self.header:
            msg = f"first_row ({self.first_row}) must lie below the header ({self.header})"
            raise ValueError(msg)
        return self


class ClockColumns(_Part):
    """The columns of the clock.

    Attributes
    ----------
    time : str or None
        Column of the times, in `unit`.
    unit : {"s", "ms", "us", "ns"}
    frame : str or None
        Column of whole frame numbers.
    rate_hz : float or None
        Frames a second, where there are no times; without frame numbers each row is a frame.
    """

    time: str | None = None
    unit: Literal["s", "ms", "us", "ns"] = "s"
    frame: str | None = None
    rate_hz: float | None = Field(default=None, ge=1e-3, le=1e6)

    @model_validator(mode="after")
    def _check(self) -> ClockColumns:
        if self.time is not None and self.rate_hz is not None:
            msg = "time and rate_hz both make a clock; leave rate_hz out"
            raise ValueError(msg)
        return self


class BodyColumns(_Part):
    """The columns of a body, whose pose takes its coordinates to the laboratory's.

    Attributes
    ----------
    quaternion : tuple of four str or None
    order : {"wxyz", "xyzw"} or None
        Where in the quaternion its scalar stands.
    matrix : tuple of 16, 12 or 9 str, or None
        Row by row: 4 x 4 or 3 x 4 with the position, or 3 x 3 beside one.
    euler : tuple of three str or None
        In the order of `sequence`.
    sequence : str or None
        In capitals about the body's own axes, "XYZ" being R = Rx Ry Rz; in small letters about the laboratory's.
    degrees : bool or None
        Whether they are degrees; else radians.
    position : tuple of three str or None
        None of a body whose orientation alone is known, but for matrices that hold it.
    unit : {"m", "cm", "mm"} or None
        None to go by ``--units``.
    """

    quaternion: Four | None = None
    order: Literal["wxyz", "xyzw"] | None = None
    matrix: tuple[str, ...] | None = None
    euler: Three | None = None
    sequence: str | None = None
    degrees: StrictBool | None = None
    position: Three | None = None
    unit: FileUnit | None = None

    @property
    def has_position(self) -> bool:
        """Whether positions are known, beside orientations."""
        return self.position is not None or len(self.matrix or ()) > 9

    @model_validator(mode="after")
    def _check(self) -> BodyColumns:
        rotations = [name for name in ("quaternion", "matrix", "euler") if getattr(self, name) is not None]
        cells = len(self.matrix or ())
        faults = {
            "expected one of quaternion, matrix and euler, found " + (" and ".join(rotations) or "none"): (
                len(rotations) != 1
            ),
            'quaternion needs order = "wxyz" or "xyzw": nothing else says where its scalar stands': (
                self.quaternion is not None and self.order is None
            ),
            "order is of a quaternion; leave it out": self.quaternion is None and self.order is not None,
            f"matrix: expected 16, 12 or 9 columns, found {cells}": self.matrix is not None
            and cells not in (16, 12, 9),
            "a matrix of 16 or 12 columns holds the position; leave position out": (
                cells in (16, 12) and self.position is not None
            ),
            "unit is of a position; name that, too, or leave unit out": self.unit is not None and not self.has_position,
            'euler needs sequence, as "XYZ", and degrees = true or false': (
                self.euler is not None and (self.sequence is None or self.degrees is None)
            ),
            "sequence and degrees are of euler; leave them out": (
                self.euler is None and (self.sequence is not None or self.degrees is not None)
            ),
            "sequence: expected XYZ, xyz, YXY or another order in which no axis follows itself, "
            f"found {shown(self.sequence)}": (self.sequence is not None and self.sequence not in _SEQUENCES),
        }
        fault = next((text for text, present in faults.items() if present), None)
        if fault is not None:
            raise ValueError(fault)
        return self


class MarkerColumns(_Part):
    """The columns of a marker; `unit` as of `BodyColumns`."""

    position: Three
    unit: FileUnit | None = None


class ColumnFile(_Part):
    """What a file of ``--columns`` says.

    Attributes
    ----------
    name, sha256 : str
        Of the file.
    table : Layout
    clock : ClockColumns
    bodies : dict of BodyColumns
    markers : dict of MarkerColumns
    """

    name: str
    sha256: str
    table: Layout = Layout()
    clock: ClockColumns = ClockColumns()
    bodies: dict[str, BodyColumns] = {}
    markers: dict[str, MarkerColumns] = {}

    @model_validator(mode="after")
    def _check(self) -> ColumnFile:
        twice = sorted(self.bodies.keys() & self.markers.keys())
        if not self.bodies and not self.markers:
            msg = "expected a table [bodies.NAME] or [markers.NAME], found none"
            raise ValueError(msg)
        if twice:
            msg = f"{twice[0]!r} is a body and a marker; give one of them another name"
            raise ValueError(msg)
        return self

    def columns(self) -> Iterator[tuple[str, str]]:
        """Yield each column with the key that means it, as in ``bodies.forearm.position``."""
        for key, column in (("clock.time", self.clock.time), ("clock.frame", self.clock.frame)):
            if column is not None:
                yield key, column
        for name, body in self.bodies.items():
            for part in ("quaternion", "matrix", "euler", "position"):
                yield from ((f"bodies.{name}.{part}", column) for column in getattr(body, part) or ())
        for name, marker in self.markers.items():
            yield from ((f"markers.{name}.position", column) for column in marker.position)


def read_column_file(path: Path) -> ColumnFile:
    """Read a file of ``--columns``; ``docs/reference/plain-table.md`` says how it looks.

    Raises
    ------
    ValueError
        If it cannot be read, or a key or value is not a possible one; it names the key, in one line.
    """
    try:
        given, digest = read_toml_and_digest(path)
    except OSError as error:
        raise unreadable(path, "a file of columns", error, ValueError) from error
    except ValueError as error:
        msg = f"{path}: not TOML: {error}"
        raise ValueError(msg) from error
    try:
        return ColumnFile.model_validate({**given, "name": path.name, "sha256": digest})
    except ValidationError as error:
        faults = [_sentence(fault) for fault in error.errors()]
        msg = f"{path}: {'; '.join(faults[:3])}; see docs/reference/plain-table.md"
        raise ValueError(msg) from error


def _sentence(fault: Any) -> str:
    place = [str(part) for part in fault["loc"]]
    if fault["type"] == "extra_forbidden":
        known = _keys_beside(place)
        near = difflib.get_close_matches(place[-1], known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"possible keys: {', '.join(known)}"
        return f"unknown key {'.'.join(place)!r}; {hint}"
    message = str(fault["msg"]).removeprefix("Value error, ").replace("Input should", "should")
    found = "" if fault["type"] in ("value_error", "missing") else f", found {shown(fault['input'])}"
    return f"{'.'.join(place)}: {message}{found}" if place else f"{message}{found}"


def _keys_beside(place: list[str]) -> list[str]:
    tables: dict[str, type[_Part]] = {
        "table": Layout, "clock": ClockColumns, "bodies": BodyColumns, "markers": MarkerColumns,
    }  # fmt: skip
    return list(tables) if len(place) == 1 else list(tables[place[0]].model_fields)
