"""Tables as CSV, with digits that read back as the same float64."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import orjson
from numpy.typing import NDArray

from elbowscrew.choices import AngleUnit, LengthUnit
from elbowscrew.model import Analysis
from elbowscrew.model.table_record import TableRecord
from elbowscrew.motion.interpolation.rebuilding import keyframes_of
from elbowscrew.opening import create

BLOCK_ROWS: Final = 2048  # a text of more is new memory each time, which costs more than the calls
# What JSON would escape, what CSV quotes, and the word that JSON has for an empty cell.
_NOT_PLAIN: Final = re.compile(r'[",\\\x00-\x1f]|null')


def results_by_table(analysis: Analysis) -> dict[str, TableRecord]:
    """Give the results of an analysis that are written as tables, by the tables' names."""
    several = analysis.repetitions.number.size > 1
    found = {
        "screw": analysis.screw,
        "interpolation": analysis.interpolated,
        "keyframes": keyframes_of(analysis),
        "instantaneous": analysis.instantaneous,
        "repetitions": analysis.repetitions,
        "cycles": analysis.cycle_curves if analysis.repetitions.number.size else None,
        "repetition_curve": analysis.repeatability if several else None,
        "steps": analysis.steps,
        "anatomy": analysis.anatomy,
        "axis_path": analysis.joint_axis.path,
        "joint_angles": analysis.joint_angles,
    }
    return {name: result for name, result in found.items() if result is not None}


def write_tables(folder: Path, analysis: Analysis) -> None:
    """Write the tables of an analysis in the units of its settings, each to a file of its name."""
    for name, result in results_by_table(analysis).items():
        write_table(folder / f"{name}.csv", result, analysis.settings.angle_unit, analysis.settings.length_unit)


def write_table(path: Path, result: TableRecord, angle_unit: AngleUnit, length_unit: LengthUnit) -> None:
    """Write a result as CSV; it is converted block by block, as it may be long."""
    write_csv(path, _columns_of(result, angle_unit, length_unit))


def table_bytes(result: TableRecord, angle_unit: AngleUnit, length_unit: LengthUnit) -> bytes:
    """Give what `write_table` writes."""
    return b"".join(_csv(_columns_of(result, angle_unit, length_unit)))


def _columns_of(
    result: TableRecord, angle_unit: AngleUnit, length_unit: LengthUnit
) -> Iterator[Mapping[str, NDArray[Any]]]:
    rows = len(result.table[0].values(result))
    return (result.columns(angle_unit, length_unit, block) for block in _blocks(rows))


def _blocks(rows: int) -> list[slice]:
    """Some thousand rows each; a table without any is one block of none."""
    return [slice(start, start + BLOCK_ROWS) for start in range(0, max(rows, 1), BLOCK_ROWS)]


def write_csv(path: Path, blocks: Iterable[Mapping[str, NDArray[Any]]]) -> None:
    """Write columns of equal length, block by block; NaN and masked values become empty cells."""
    with create(path) as stream:
        for part in _csv(blocks):
            stream.write(part)


def _csv(blocks: Iterable[Mapping[str, NDArray[Any]]]) -> Iterator[bytes]:
    for k, block in enumerate(blocks):
        if k == 0:
            yield (",".join(map(quoted, block)) + "\n").encode()
        columns = [_cells(values) for values in block.values()]
        words = [
            cells for values, cells in zip(block.values(), columns, strict=True) if values.dtype.kind not in "fiub"
        ]
        if columns and columns[0]:
            yield _lines(columns) if all(map(_is_plain, words)) else _quoted_lines(columns)


def _lines(columns: list[list[Any]]) -> bytes:
    """Lines of CSV, by way of JSON: orjson writes the shortest text that reads back as the same number.

    No word of the columns may need quotes, or be changed by taking out JSON's.
    """
    text = orjson.dumps(list(zip(*columns, strict=True)))[2:-2]
    # To split and join takes half the time of `bytes.replace`.
    lines = b"\n".join(text.split(b"],["))
    return b"".join(lines.split(b"null")).replace(b'"', b"") + b"\n"


def _quoted_lines(columns: list[list[Any]]) -> bytes:
    """Lines of CSV cell by cell: slower, the same digits, and words of any kind."""
    return "".join(",".join(row) + "\n" for row in zip(*map(_texts, columns), strict=True)).encode()


def _is_plain(cells: list[Any]) -> bool:
    """Whether JSON writes the words of a column as CSV does, but for the quotes around each."""
    return not any(isinstance(cell, str) and _NOT_PLAIN.search(cell) for cell in set(cells))


def _texts(cells: list[Any]) -> list[str]:
    """Each cell of a column as it stands in the file."""
    return [quoted(cell) if isinstance(cell, str) else _number(cell) for cell in cells]


def _number(cell: object) -> str:
    return "" if cell is None else orjson.dumps(cell).decode().replace("null", "")


def lines_of(columns: list[NDArray[Any]]) -> list[str]:
    """Give columns of equal length as lines of CSV, without line ends, in the same digits as `write_csv`."""
    return [",".join(row) for row in zip(*(_texts(_cells(column)) for column in columns), strict=True)]


def quoted(word: str) -> str:
    """Give a word as a cell of CSV."""
    return '"' + word.replace('"', '""') + '"' if any(mark in word for mark in ',"\r\n') else word


def _cells(values: NDArray[Any]) -> list[Any]:
    if values.dtype.kind == "f":
        # Adding 0.0 turns -0.0 into 0.0.
        with np.errstate(invalid="ignore"):  # a NaN may be a signaling one
            values = values + 0.0
        if np.isinf(values).any():  # JSON has none and would leave the cell empty
            return [str(value) if np.isinf(value) else value for value in values.tolist()]
    cells: list[Any] = values.tolist()
    return cells
