"""Tables as CSV, with digits that read back as the same float64."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from elbowscrew import tables
from elbowscrew.model import Analysis
from elbowscrew.motion.rebuilding import keyframes_of

_BLOCK_ROWS = 4096


def write_tables(folder: Path, analysis: Analysis) -> None:
    """Write ``screw.csv``, ``interpolation.csv`` and what else was asked for, in the units of the settings."""
    units = analysis.settings.angle_unit, analysis.settings.length_unit
    several = analysis.repetitions.number.size > 1
    for name, result, table in (
        ("screw", analysis.screw, tables.SCREW_COLUMNS),
        ("interpolation", analysis.interpolated, tables.INTERPOLATION_COLUMNS),
        ("keyframes", keyframes_of(analysis), tables.KEYFRAME_COLUMNS),
        ("instantaneous", analysis.instantaneous, tables.INSTANTANEOUS_COLUMNS),
        ("repetitions", analysis.repetitions, tables.REPETITION_COLUMNS),
        ("repetition_curve", analysis.repeatability if several else None, tables.CURVE_COLUMNS),
        ("steps", analysis.steps, tables.STEP_COLUMNS),
        ("anatomy", analysis.anatomy, tables.ANATOMY_COLUMNS),
    ):
        if result is not None:
            write_csv(folder / f"{name}.csv", tables.columns(result, table, *units))


def write_csv(path: Path, columns: dict[str, NDArray[Any]]) -> None:
    """Write columns of equal length; NaN and masked values become empty cells."""
    rows = len(next(iter(columns.values())))
    with path.open("wb") as stream:
        stream.write((",".join(columns) + "\n").encode())
        for start in range(0, rows, _BLOCK_ROWS):
            block = [_cells(values[start : start + _BLOCK_ROWS]) for values in columns.values()]
            stream.write(_lines(list(zip(*block, strict=True))))


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
