"""Tables as CSV, with digits that read back as the same float64."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.model import Analysis
from elbowscrew.motion.interpolation.rebuilding import keyframes_of

_BLOCK_ROWS = 4096


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
        "keyframes": keyframes_of(analysis),
        "instantaneous": analysis.instantaneous,
        "repetitions": analysis.repetitions,
        "cycles": analysis.cycle_curves if analysis.repetitions.number.size else None,
        "repetition_curve": analysis.repeatability if several else None,
        "steps": analysis.steps,
        "anatomy": analysis.anatomy,
    }
    return [(name, result, tables.TABLES[name]) for name, result in found.items() if result is not None]


def write_csv(path: Path, columns: dict[str, NDArray[Any]], *, quoted: bool = False) -> None:
    """Write columns of equal length; NaN and masked values become empty cells, text is quoted if that is asked for."""
    if quoted:
        with path.open("w", encoding="utf-8", newline="") as stream:
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
    with path.open("wb") as stream:
        for k, block in enumerate(blocks):
            if k == 0:
                stream.write((",".join(block) + "\n").encode())
            rows = list(zip(*(_cells(values) for values in block.values()), strict=True))
            if rows:
                stream.write(_lines(rows))


def _lines(rows: list[tuple[object, ...]]) -> bytes:
    """Lines of CSV, by way of JSON: orjson writes the shortest text that reads back as the same number.

    No word of the tables has a comma, a quote or "null" in it.
    """
    text = orjson.dumps(rows)[2:-2].replace(b"],[", b"\n")
    for word in (b"null", b'"'):
        if word in text:
            text = text.replace(word, b"")
    return text + b"\n"


def _cells(values: NDArray[Any]) -> list[Any]:
    if values.dtype.kind == "f":
        # Adding 0.0 turns -0.0 into 0.0.
        with np.errstate(invalid="ignore"):  # a NaN may be a signaling one
            values = values + 0.0
        if np.isinf(values).any():  # JSON has none and would leave the cell empty
            return [str(value) if np.isinf(value) else value for value in values.tolist()]
    cells: list[Any] = values.tolist()
    return cells
