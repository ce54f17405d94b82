"""Tables as CSV, with digits that read back as the same float64."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import orjson
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.model import Analysis
from elbowscrew.motion.interpolation.rebuilding import keyframes_of
from elbowscrew.opening import create

_BLOCK_ROWS = 4096
# What JSON would escape, what CSV quotes, and the word that JSON has for an empty cell.
_NOT_PLAIN: Final = re.compile(r'[",\\\x00-\x1f]|null')


def named_tables(analysis: Analysis) -> dict[str, dict[str, NDArray[Any]]]:
    """Give the columns of ``screw``, ``interpolation`` and what else was asked for, in the units of the settings."""
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    return {name: tables.columns(result, table, *units) for name, result, table in _results(analysis)}


def write_tables(folder: Path, analysis: Analysis) -> None:
    """Write the tables of an analysis, each to a file of its name; converted block by block, as they may be long."""
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    for name, result, table in _results(analysis):
        blocks = (tables.columns(result, table, *units, rows) for rows in _blocks(len(table[0].values(result))))
        _write_blocks(folder / f"{name}.csv", blocks)


def _results(analysis: Analysis) -> list[tuple[str, object, tuple[tables.Column, ...]]]:
    """Name, result and columns of each table that there is."""
    several = analysis.repetitions.number.size > 1
    found: dict[str, object] = {
        "screw": analysis.screw,
        "interpolation": analysis.interpolated,
        "instantaneous": analysis.instantaneous,
        "repetitions": analysis.repetitions,
        "cycles": analysis.cycle_curves if analysis.repetitions.number.size else None,
        "repetition_curve": analysis.repeatability if several else None,
        "steps": analysis.steps,
        "anatomy": analysis.anatomy,
        "axis_path": analysis.joint_axis.path,
    }
    keyframes = keyframes_of(analysis)
    given = [(name, result, tables.TABLES[name]) for name, result in found.items() if result is not None]
    given.insert(2, ("keyframes", keyframes, keyframes.table))
    angles = analysis.joint_angles
    return given if angles is None else [*given, ("joint_angles", angles, angles.table)]


def write_csv(path: Path, columns: dict[str, NDArray[Any]], *, quoted: bool = False) -> None:
    """Write columns of equal length; NaN and masked values become empty cells, text is quoted if that is asked for."""
    if quoted:
        with io.TextIOWrapper(create(path), encoding="utf-8", newline="") as stream:
            table = csv.writer(stream, lineterminator="\n")
            table.writerow(columns)
            table.writerows(zip(*(_cells(values) for values in columns.values()), strict=True))
        return
    parts = _blocks(len(next(iter(columns.values()))))
    _write_blocks(path, ({name: values[rows] for name, values in columns.items()} for rows in parts))


def _blocks(rows: int) -> list[slice]:
    """Some thousand rows each; a table without any is one block of none."""
    return [slice(start, start + _BLOCK_ROWS) for start in range(0, max(rows, 1), _BLOCK_ROWS)]


def _write_blocks(path: Path, blocks: Iterable[Mapping[str, NDArray[Any]]]) -> None:
    with create(path) as stream:
        for k, block in enumerate(blocks):
            if k == 0:
                stream.write((",".join(map(_quoted, block)) + "\n").encode())
            columns = [_cells(values) for values in block.values()]
            words = [
                cells for values, cells in zip(block.values(), columns, strict=True) if values.dtype.kind not in "fiub"
            ]
            if columns and columns[0]:
                stream.write(_lines(columns) if all(map(_is_plain, words)) else _quoted_lines(columns))


def _lines(columns: list[list[Any]]) -> bytes:
    """Lines of CSV, by way of JSON: orjson writes the shortest text that reads back as the same number.

    No word of the columns may need quotes, or be changed by taking out JSON's.
    """
    text = orjson.dumps(list(zip(*columns, strict=True)))[2:-2].replace(b"],[", b"\n")
    for word in (b"null", b'"'):
        if word in text:
            text = text.replace(word, b"")
    return text + b"\n"


def _quoted_lines(columns: list[list[Any]]) -> bytes:
    """Lines of CSV cell by cell: slower, the same digits, and words of any kind."""
    return "".join(",".join(row) + "\n" for row in zip(*map(_texts, columns), strict=True)).encode()


def _is_plain(cells: list[Any]) -> bool:
    """Whether JSON writes the words of a column as CSV does, but for the quotes around each."""
    return not any(isinstance(cell, str) and _NOT_PLAIN.search(cell) for cell in set(cells))


def _texts(cells: list[Any]) -> list[str]:
    """Each cell of a column as it stands in the file."""
    return [_quoted(cell) if isinstance(cell, str) else _number(cell) for cell in cells]


def _number(cell: object) -> str:
    return "" if cell is None else orjson.dumps(cell).decode().replace("null", "")


def _quoted(word: str) -> str:
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
