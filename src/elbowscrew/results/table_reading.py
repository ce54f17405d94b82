"""Tables of a result read back: the columns of `elbowscrew.tables` in SI units and radians."""

from __future__ import annotations

import csv
from collections import deque
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from io import BytesIO, StringIO
from typing import IO, Any, Final

import numpy as np
from numpy.typing import NDArray

from elbowscrew._process import has_spare_cores
from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.errors import ResultError
from elbowscrew.geometry.arrays import Float
from elbowscrew.model.table_record import TableRecord
from elbowscrew.quantities import Quantity, as_read_back, in_si, unit_suffixes
from elbowscrew.results.proof import ProvedFile
from elbowscrew.results.summary_reading import LARGEST
from elbowscrew.tables import Column, attributes

_BLOCK_BYTES: Final = 2**22
_NO_SEPARATORS: Final = bytes(set(range(256)) - set(b',\n\r"'))
_LARGEST_WHOLE: Final = 2.0**53 - 1.0
_INTEGERS: Final = (Quantity.INTEGER, Quantity.MASKED_INTEGER, Quantity.FLAG)
_AS_THEY_ARE: Final = (*_INTEGERS, Quantity.NUMBER, Quantity.LABEL)

# Blocks that are parsed at a time: to read one and to digest it takes half as long as to parse it.
_AHEAD: Final = 2

_Values = list[NDArray[Any]]
Attributes = dict[str, NDArray[Any]]
"""Columns of a result by the attributes that they are of."""


def as_read(result: TableRecord, names: Collection[str], angle_unit: AngleUnit, length_unit: LengthUnit) -> Attributes:
    """Give attributes of a result with the numbers that its table gives when it is read back, to the last digit.

    Only the sign of a zero is lost in a table.

    Parameters
    ----------
    result : TableRecord
    names : collection of str
        Of the attributes wanted.
    angle_unit, length_unit : str
        Units of the table.

    Returns
    -------
    dict of str to ndarray
        As `read_attributes` does of the table.
    """
    quantities = {column.attribute: column.quantity for column in result.table if column.attribute in names}
    return {
        name: getattr(result, name)
        if quantity in _AS_THEY_ARE
        else as_read_back(getattr(result, name), quantity, angle_unit, length_unit)
        for name, quantity in quantities.items()
    }


def read_columns(
    source: ProvedFile, table: tuple[Column, ...], angle_unit: AngleUnit, length_unit: LengthUnit
) -> dict[str, NDArray[Any]]:
    """Read columns by their names without units; the inverse of `TableRecord.columns`.

    Parameters
    ----------
    source : ProvedFile
        A table that `elbowscrew.results.writing` wrote.
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
        If the table is missing, not as it was written, or lacks a column.
    """
    values = _read(source, table, angle_unit, length_unit)
    return {column.name: one for column, one in zip(table, values, strict=True)}


def _read(
    source: ProvedFile, table: tuple[Column, ...], angle_unit: AngleUnit, length_unit: LengthUnit
) -> list[NDArray[Any]]:
    """Read columns, in the order of the table."""
    suffixes, path = unit_suffixes(angle_unit, length_unit), source.path
    try:
        with source.opened() as stream:
            header = stream.readline().decode().rstrip("\n").split(",")
            places = [header.index(column.name + suffixes.get(column.quantity, "")) for column in table]
            quantities = [column.quantity for column in table]
            columns: list[list[NDArray[Any]]] = [[] for _ in table]
            for values in _blocks(stream, partial(_parsed, width=len(header), places=places, quantities=quantities)):
                for column, one, quantity in zip(columns, values, quantities, strict=True):
                    column.append(in_si(one, quantity, angle_unit, length_unit))
    except OSError as error:
        msg = f"{path}: cannot be read: {error.strerror or error}; analyze the trial again"
        raise ResultError(msg) from error
    except (ValueError, IndexError, csv.Error) as error:
        msg = f"{path}: not the table that was written: {error}; analyze the trial again"
        raise ResultError(msg) from error
    columns.reverse()  # so that each goes as soon as it is joined
    return [_joined(columns.pop(), column.quantity) for column in table]


def read_attributes(
    source: ProvedFile,
    table: tuple[Column, ...],
    names: Collection[str],
    angle_unit: AngleUnit,
    length_unit: LengthUnit,
) -> Attributes:
    """Read attributes of a result back from its table; columns of no other are looked at.

    Parameters
    ----------
    source : ProvedFile
    table : tuple of Column
    names : collection of str
        Of the attributes wanted.
    angle_unit, length_unit : str
        Units that the table was written in.

    Returns
    -------
    dict of str to ndarray
        Shape (N,), or (N, k) of k components; SI units and radians.

    Raises
    ------
    ResultError
        As `read_columns`.
    """
    wanted = tuple(column for column in table if column.attribute in names)
    return attributes(_read(source, wanted, angle_unit, length_unit), wanted)


def _blocks(stream: IO[bytes], parsed: Callable[..., _Values]) -> Iterator[_Values]:
    """Parse a table block by block; a long one, where there is another core, while what follows is read and digested.

    What comes of a block, be it a fault, comes when its turn has come.
    """
    block = _whole_lines(stream)
    is_long = len(block) >= _BLOCK_BYTES
    if not is_long or not has_spare_cores():
        while block:
            yield parsed(block, is_long=is_long)
            block = _whole_lines(stream)
        return
    with ThreadPoolExecutor(_AHEAD) as background:
        ahead: deque[Future[_Values]] = deque()
        while block:
            ahead.append(background.submit(parsed, block, is_long=is_long))
            block = _whole_lines(stream)
            if len(ahead) == _AHEAD:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()


def _parsed(block: bytes, width: int, places: list[int], quantities: list[Quantity], *, is_long: bool) -> _Values:
    """Columns of a block of lines.

    Raises
    ------
    ValueError, csv.Error
        If they are not as they are written.
    """
    if not block.endswith(b"\n"):
        msg = "its last line is cut"
        raise ValueError(msg)
    values = _numbers_at_once(block, width, places, quantities) if is_long else None
    if values is not None:
        return values
    return _cell_by_cell(list(StringIO(block.decode(), newline="")), width, places, quantities)


def _whole_lines(stream: IO[bytes]) -> bytes:
    """Next lines of a table, and those that a label with a line break in it goes on in."""
    parts = [stream.read(_BLOCK_BYTES), stream.readline()]
    # That there are none is told twenty times as fast as how many there are.
    quotes = sum(part.count(b'"') for part in parts if b'"' in part)
    while quotes % 2 and (more := stream.readline()):
        parts.append(more)
        quotes += more.count(b'"')
    return b"".join(parts)


def _numbers_at_once(
    lines: bytes, width: int, places: list[int], quantities: list[Quantity]
) -> list[NDArray[Any]] | None:
    """Columns of many lines by the parser of pandas, which takes longer to load than a short table to read.

    None where the lines have anything but as many numbers or empty cells as the header.
    """
    separators = lines.translate(None, _NO_SEPARATORS)
    count = len(separators) // width
    if Quantity.LABEL in quantities or separators != (b"," * (width - 1) + b"\n") * count:
        return None
    import pandas as pd

    # From 3.1 on all its converters round correctly, and it warns of the option by which one of them did before.
    exact: dict[str, Any] = {} if _version(pd.__version__) >= (3, 1) else {"float_precision": "round_trip"}
    try:
        frame = pd.read_csv(
            BytesIO(lines), header=None, usecols=places, dtype=np.float64, low_memory=False, keep_default_na=False,
            na_values=[""], quoting=csv.QUOTE_NONE, **exact,
        )  # fmt: skip
        found = [
            _integers(frame[place].to_numpy(), quantity) if quantity in _INTEGERS else frame[place].to_numpy()
            for place, quantity in zip(places, quantities, strict=True)
        ]
    except ValueError:  # which the other way tells in words of its own
        return None
    if len(frame) != count:
        return None
    for values, quantity in zip(found, quantities, strict=True):
        if quantity not in _INTEGERS:
            _check_size(values)
    return found


def _integers(values: Float, quantity: Quantity) -> NDArray[Any]:
    """Whole numbers, masked where NaN.

    Raises
    ------
    ValueError
        If they are not whole, or too large to be told from their neighbors.
    """
    missing = np.isnan(values)
    known = np.where(missing, 0.0, values)
    if (known != np.round(known)).any() or (np.abs(known) > _LARGEST_WHOLE).any():
        msg = "it has fractions where whole numbers are expected"
        raise ValueError(msg)
    whole = known.astype(np.int64)
    if quantity is Quantity.MASKED_INTEGER or missing.any():
        return np.ma.MaskedArray(whole, mask=missing)
    return whole


def _version(text: str) -> tuple[int, int]:
    major, minor = text.split(".")[:2]
    return int(major), int(minor)


def _cell_by_cell(lines: list[str], width: int, places: list[int], quantities: list[Quantity]) -> list[NDArray[Any]]:
    """Columns of lines of any kind.

    Raises
    ------
    ValueError
        If the lines are not all as long as the header, or a cell is not of its column's kind.
    """
    cells = list(zip(*_rows(lines), strict=True))
    found = [_values(cells[place], quantity) for place, quantity in zip(places, quantities, strict=True)]
    if len(cells) != width:
        msg = f"it has {len(cells)} cells where the header has {width}"
        raise ValueError(msg)
    return found


def _rows(lines: list[str]) -> Iterator[list[str]]:
    """Cells of each row; the reader of CSV, some times slower, only where a label is quoted."""
    if any('"' in line for line in lines):
        return csv.reader(lines, strict=True)
    return (line[:-1].split(",") for line in lines)


def _values(cells: tuple[str, ...], quantity: Quantity) -> NDArray[Any]:
    if quantity is Quantity.LABEL:
        return np.array(cells)
    if quantity in _INTEGERS:
        if quantity is not Quantity.MASKED_INTEGER and "" not in cells:
            return np.array([int(cell) for cell in cells], dtype=np.int64)
        missing = [not cell for cell in cells]
        return np.ma.MaskedArray([int(cell or 0) for cell in cells], mask=missing, dtype=np.int64)
    nan = float("nan")
    values = np.array([float(cell) if cell else nan for cell in cells], dtype=np.float64)
    _check_size(values)
    return values


def _check_size(values: NDArray[Any]) -> None:
    if (np.abs(values) > LARGEST).any():
        msg = f"it has numbers beyond {LARGEST:g}"
        raise ValueError(msg)


def _joined(blocks: list[NDArray[Any]], quantity: Quantity) -> NDArray[Any]:
    if not blocks:
        empty = np.array([], dtype="i8" if quantity in _INTEGERS else "U1" if quantity is Quantity.LABEL else "f8")
        return np.ma.asarray(empty) if quantity is Quantity.MASKED_INTEGER else empty
    if any(isinstance(block, np.ma.MaskedArray) for block in blocks):
        joined: NDArray[Any] = np.ma.concatenate(blocks)  # type: ignore[no-untyped-call]
        return joined
    return np.concatenate(blocks)
