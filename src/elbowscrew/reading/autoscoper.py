"""Poses that Autoscoper exports as six numbers a body and row: x, y, z, yaw, pitch, roll, without a header.

After its source the angles are degrees about the body's own z, y and x, in this order; radians and another unit of
length may be chosen on export, and the file does not say so. Bodies follow one another; "NaN" is a lost frame.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from elbowscrew.errors import RecordingError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model import QualityWarning, Recording
from elbowscrew.reading.cells import parse_number, read_blocks
from elbowscrew.reading.headerless import body_names, first_row, one_body_warnings, unit_and_rate
from elbowscrew.reading.options import ReadOptions
from elbowscrew.reading.source import TextSource
from elbowscrew.reading.table import BodyCells, TableCells, read_table

_CELLS: Final = 6
_ANGLES: Final = "ZYX"
_FULL_TURN_DEG: Final = 360.0
_FULL_TURN_RAD: Final = 2.0 * np.pi


def recognizes(cells: list[str]) -> bool:
    """Tell by six numbers a body."""
    try:
        count = len([parse_number(cell, nan_word=True) for cell in cells])
    except ValueError:
        return False
    return count > 0 and count % _CELLS == 0


def read(source: TextSource, options: ReadOptions) -> Recording:
    """Read a table of poses; see `elbowscrew.reading.registry.read_recording`."""
    unit, rate = unit_and_rate(source, options)
    width = len(first_row(source, _CELLS))
    if width % _CELLS:
        msg = f"{source.path}: expected six numbers a body in the first row, found {width} cells"
        raise RecordingError(msg)
    _check_degrees(source, width)
    names = body_names(source, width // _CELLS)
    bodies = tuple(
        BodyCells(name, tuple(range(k + 3, k + 6)), tuple(range(k, k + 3)), unit, sequence=_ANGLES, degrees=True)
        for name, k in zip(names, range(0, width, _CELLS), strict=True)
    )
    table = TableCells(
        layout="Autoscoper poses",
        lines_above=0,
        width=width,
        frame=None,
        time=None,
        rate_hz=rate,
        nan_word=True,
        bodies=bodies,
        markers=(),
    )
    message = (
        "six numbers a body are read as Autoscoper writes them: x, y, z, yaw, pitch, roll, the angles in degrees about "
        "the body's own z, y and x"
    )
    note = QualityWarning(code="autoscoper-angles", message=message, severity="note")
    return read_table(source, table, note, *one_body_warnings(source, len(bodies), options))


def _check_degrees(source: TextSource, width: int) -> None:
    """Check that the angles can be degrees, and nothing but degrees.

    Raises
    ------
    RecordingError
        If they can be radians as well, or no angles at all.
    """
    most = max((float(np.max(angles, initial=0.0)) for angles in _angles(source, width)), default=0.0)
    if _FULL_TURN_RAD < most <= _FULL_TURN_DEG:
        return
    what = (
        f"angles of {most:g} are none" if most > _FULL_TURN_DEG else "all angles are within 2 pi, as radians would be"
    )
    msg = (
        f"{source.path}: {what}, so nothing says that the six numbers a body are Autoscoper's x, y, z, yaw, pitch, "
        "roll in degrees; export matrices instead, or say what the columns are by --columns FILE.toml "
        "(docs/reference/plain-table.md)"
    )
    raise RecordingError(msg)


def _angles(source: TextSource, width: int) -> Iterator[Float]:
    """Sizes of all angles that are there, many rows at a time."""
    columns = [k for k in range(width) if k % _CELLS >= _CELLS // 2]
    for block in read_blocks(source, 0, columns, width, nan_word=True):
        yield np.abs(block[np.isfinite(block)])
