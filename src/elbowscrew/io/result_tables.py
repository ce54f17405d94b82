"""Tables of a result read back: the columns of `elbowscrew.tables` in SI units and radians."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew.errors import ResultError
from elbowscrew.tables import METERS, AngleUnit, Column, LengthUnit, Quantity

_BLOCK_LINES: Final = 4096


def read_columns(
    path: Path, table: tuple[Column, ...], angle_unit: AngleUnit, length_unit: LengthUnit
) -> dict[str, NDArray[Any]]:
    """Read columns by their names without units; the inverse of `elbowscrew.tables.columns`.

    Parameters
    ----------
    path : Path
        A table that `elbowscrew.io.writing` wrote.
    table : tuple of Column
        Those wanted; there may be more.
    angle_unit, length_unit : str
        Units that the table was written in.

    Returns
    -------
    dict of str to ndarray
        Floats are NaN, integers masked, and labels empty where the cell is empty.

    Raises
    ------
    ResultError
        If the table is missing, cut, or lacks a column.
    """
    units = {
        Quantity.ANGLE: f"_{angle_unit}",
        Quantity.LENGTH: f"_{length_unit}",
        Quantity.ANGULAR_VELOCITY: f"_{angle_unit}_s",
        Quantity.VELOCITY: f"_{length_unit}_s",
    }
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            header = stream.readline().rstrip("\n").split(",")
            places = [header.index(column.name + units.get(column.quantity, "")) for column in table]
            blocks: list[list[NDArray[Any]]] = [[] for _ in table]
            while lines := list(islice(stream, _BLOCK_LINES)):
                if not lines[-1].endswith("\n"):
                    msg = "its last line is cut"
                    raise ValueError(msg)
                cells = list(zip(*(line[:-1].split(",") for line in lines), strict=True))
                for block, place, column in zip(blocks, places, table, strict=True):
                    block.append(_values(cells[place], column.quantity))
                if len(cells) != len(header):
                    msg = f"it has {len(cells)} cells where the header has {len(header)}"
                    raise ValueError(msg)
    except OSError as error:
        msg = f"{path}: cannot be read: {error.strerror or error}; analyze the trial again"
        raise ResultError(msg) from error
    except (ValueError, IndexError) as error:
        msg = f"{path}: not the table that was written: {error}; analyze the trial again"
        raise ResultError(msg) from error
    return {
        column.name: _in_si(_joined(block, column.quantity), column.quantity, angle_unit, length_unit)
        for column, block in zip(table, blocks, strict=True)
    }


def _values(cells: tuple[str, ...], quantity: Quantity) -> NDArray[Any]:
    if quantity is Quantity.LABEL:
        return np.array(cells)
    if quantity is Quantity.INTEGER:
        if "" not in cells:
            return np.array([int(cell) for cell in cells], dtype=np.int64)
        missing = [not cell for cell in cells]
        return np.ma.MaskedArray([int(cell or 0) for cell in cells], mask=missing, dtype=np.int64)
    nan = float("nan")
    return np.array([float(cell) if cell else nan for cell in cells], dtype=np.float64)


def _joined(blocks: list[NDArray[Any]], quantity: Quantity) -> NDArray[Any]:
    if not blocks:
        return np.array([], dtype={Quantity.INTEGER: "i8", Quantity.LABEL: "U1"}.get(quantity, "f8"))
    if any(isinstance(block, np.ma.MaskedArray) for block in blocks):
        joined: NDArray[Any] = np.ma.concatenate(blocks)  # type: ignore[no-untyped-call]
        return joined
    return np.concatenate(blocks)


def _in_si(values: NDArray[Any], quantity: Quantity, angle_unit: AngleUnit, length_unit: LengthUnit) -> NDArray[Any]:
    if quantity in (Quantity.ANGLE, Quantity.ANGULAR_VELOCITY):
        return np.radians(values) if angle_unit == "deg" else values
    if quantity in (Quantity.LENGTH, Quantity.VELOCITY) and length_unit == "mm":
        return values * METERS["mm"]
    return values
